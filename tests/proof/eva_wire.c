/* SPDX-License-Identifier: Apache-2.0 */
/* The edge of the bus: any frame, in any order, to a port of any instance; every decode of any
 * frame; every encode of any message; the outputs of any tick; the counters of a hand; authenticated
 * lanes; guards of both forms and ends. */
#include "rt/wire/auth.h"
#include "rt/wire/e2e.h"
#include "rt/wire/auth_gate.h"
#include "rt/wire/port.h"
#include "rt/wire/sequence.h"
#include "tests/proof/any.h"

static frame any_frame(void) {
  frame f;
  any_bytes(&f, sizeof f);
  return f;
}

static uint32_t any_instance(void) { return any_between(0, DICTIONARY_INSTANCES - 1); }
static uint32_t any_hand(void) { return any_between(0, FRAY_HANDS - 1); }

void decodes(void) {
  const frame f = any_frame();
  const uint32_t instance = any_instance();
  codec_sync sync;
  fray_pose pose;
  codec_force force;
  codec_command command;
  codec_ack ack;
  codec_tear tear;
  codec_status status;
  codec_identity identity;
  (void)codec_decode_identity(&f, instance, &identity);
  (void)codec_decode_sync(&f, instance, &sync);
  if (codec_decode_pose(&f, instance, any_hand(), &pose) == CODEC_OK) {
    /*@ assert pose.counter <= 15 && pose.buttons <= 15; */
  }
  if (codec_decode_force(&f, instance, any_hand(), &force) == CODEC_OK) {
    /*@ assert force.counter <= 15 && force.consumed <= 15; */
  }
  (void)codec_decode_command(&f, instance, &command);
  (void)codec_read_command(f.data, instance, &command);
  if (codec_decode_ack(&f, instance, &ack) == CODEC_OK) {
    /*@ assert ack.command_counter <= 15 && ack.command != 0 && ack.result <= 2; */
  }
  if (codec_decode_tear(&f, instance, &tear) == CODEC_OK) {
    /*@ assert tear.kind >= CODEC_TEAR_STRUCTURAL && tear.kind <= CODEC_TEAR_CUT; */
  }
  if (codec_decode_status(&f, instance, &status) == CODEC_OK) {
    /*@ assert status.state <= 3 && status.fill_percent <= 100; */
  }
  (void)codec_reason_text((codec_reason)any_between(0, CODEC_FIELD));
}

void encodes(void) {
  const uint32_t instance = any_instance();
  frame f;
  codec_sync sync;
  fray_pose pose;
  codec_force force;
  codec_command command;
  codec_ack ack;
  codec_tear tear;
  codec_status status;
  codec_identity identity;
  any_bytes(&sync, sizeof sync);
  any_bytes(&pose, sizeof pose);
  any_bytes(&force, sizeof force);
  any_bytes(&command, sizeof command);
  any_bytes(&ack, sizeof ack);
  any_bytes(&tear, sizeof tear);
  any_bytes(&status, sizeof status);
  any_bytes(&identity, sizeof identity);
  codec_encode_sync(&f, instance, &sync);
  codec_encode_pose(&f, instance, any_hand(), &pose);
  codec_encode_force(&f, instance, any_hand(), &force);
  codec_encode_command(&f, instance, &command);
  codec_encode_ack(&f, instance, &ack);
  codec_encode_tear(&f, instance, &tear);
  codec_encode_status(&f, instance, &status);
  codec_encode_identity(&f, instance, &identity);
  /*@ assert f.id <= FRAME_ID_MAX && f.length == 8; */
}

/* Pushes and takes in any order and number: the loop has no bound. */
static port p; /* zeros, so that port_init() leaves no byte of it unknown */

void ports(void) {
  uint8_t consumed[FRAY_HANDS];
  any_bytes(consumed, sizeof consumed);
  port_init(&p, any_word(), any_word(), any_word() != 0 ? consumed : 0);
  while (any_word() != 0) {
    const frame f = any_frame();
    fray_input input;
    if (any_word() != 0) {
      port_push(&p, &f);
    } else {
      port_take(&p, &input);
      /*@ assert input.has_pose <= 3 && input.command_counter <= 15; */
    }
  }
}

/* Any counters, on from any first one. */
void sequences(void) {
  sequence s;
  sequence_begin(&s, (uint8_t)any_between(0, 255));
  while (any_word() != 0) {
    const uint8_t counter = (uint8_t)any_between(0, 15);
    const uint32_t ahead = sequence_ahead(&s, counter);
    (void)sequence_take(&s, counter);
    /*@ assert ahead <= 15 && s.last <= 15 && s.old_next <= 15 && s.old_run < SEQUENCE_RESTART; */
  }
}

void senders(void) {
  port_sender s;
  fray_output output;
  frame frames[PORT_OUT];
  port_sender_init(&s, any_word(), any_word(), any_word());
  while (any_word() != 0) {
    any_bytes(&output, sizeof output);
    s.contacts_max = any_word();
    const uint32_t count = port_encode(&s, &output, frames);
    /*@ assert count <= PORT_OUT; */
  }
}

/* Seals, opens, strips in any order and number. */
static void lane_of(dictionary_message message, const cmac_key *key) {
  auth_lane lane;
  auth_lane_init(&lane, key, message, any_instance(), any_word());
  while (any_word() != 0) {
    frame f = any_frame();
    frame out;
    (void)auth_open(&lane, &f, &out);
    (void)auth_strip(&f, any_instance(), &out);
    (void)auth_seal(&lane, &f);
  }
}

void lanes(void) {
  cmac_key key;
  uint8_t bytes[CMAC_KEY];
  any_bytes(bytes, sizeof bytes);
  cmac_key_init(&key, bytes);
  lane_of(MESSAGE_COMMAND, &key);
  lane_of(MESSAGE_FORCE_RIGHT, &key);
  lane_of(MESSAGE_TEAR, &key); /* which has no protected form */
  lane_of(MESSAGES, &key);
  (void)auth_reason_text((auth_reason)any_between(0, AUTH_SPENT));
}

void groups(void) {
  cmac_key key;
  auth_group group;
  auth_monitor watch;
  frame tag;
  any_bytes(&key, sizeof key);
  auth_group_init(&group, &key, any_instance(), any_hand(), any_word());
  auth_monitor_init(&watch, &key, any_instance(), any_hand(), any_word());
  while (any_word() != 0) {
    const frame f = any_frame();
    (void)auth_group_add(&group, &f, &tag);
    (void)auth_monitor_check(&watch, &f);
    if (any_word() != 0) auth_monitor_clear(&watch);
  }
}

/* All calls of a gate, in any order and number. */
static auth_gate g;

static void auth_gate_of(auth_gate_form form, auth_gate_end end) {
  cmac_key key;
  auth_gate_lane of[AUTH_GATE_LANES];
  frame tag;
  any_bytes(&key, sizeof key);
  auth_gate_init(&g, &key, form, end, any_word(), any_word());
  const uint32_t count = auth_gate_lanes(&g, of);
  /*@ assert count <= AUTH_GATE_LANES; */
  for (uint32_t n = 0; n < AUTH_GATE_IN; ++n) {
    g.in[n].last = any_word();
    g.in[n].max = any_word();
  }
  for (uint32_t n = 0; n < AUTH_GATE_OUT; ++n) {
    g.out[n].last = any_word();
    g.out[n].max = any_word();
  }
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    g.monitor[h].group.last = any_word();
    g.group[h].last = any_word();
  }
  while (any_word() != 0) {
    const frame f = any_frame();
    frame out = f;
    frame plain;
    auth_gate_begin_tick(&g);
    while (any_word() != 0) (void)auth_gate_receive(&g, &f, &plain);
    (void)auth_gate_seal(&g, &out);
    (void)auth_gate_tag(&g, &f, &tag);
    (void)auth_gate_alarm(&g);
    if (any_word() != 0) auth_gate_clear(&g);
  }
}

void auth_gates_fd(void) {
  auth_gate_of(AUTH_GATE_FD, AUTH_GATE_RUNTIME);
  auth_gate_of(AUTH_GATE_FD, AUTH_GATE_DEVICE);
}

void auth_gates_classic(void) {
  auth_gate_of(AUTH_GATE_CLASSIC, AUTH_GATE_RUNTIME);
  auth_gate_of(AUTH_GATE_CLASSIC, AUTH_GATE_DEVICE);
}
