/* SPDX-License-Identifier: Apache-2.0 */
#define _GNU_SOURCE

#include "tools/bus/hand_live.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "platform/linux/can_socket.h"
#include "platform/linux/timer.h"
#include "rt/base/random.h"
#include "rt/wire/codec.h"
#include "rt/wire/dictionary.h"
#include "tools/terminal/signals.h"

enum { WAIT_NS = 10000000 };

typedef struct {
  const hand_live_options *o;
  const script *script;
  simulated_device simulated_device;
  bus_key *key; /* NULL: the bus is plain */
  can_socket can;
  timer_grid timer;
  int64_t last_sync_ns, flood_next_ns;
  uint64_t syncs, sent, refused, flooded;
  uint32_t flooded_since_sync;
  uint32_t last_tick; /* as in its SYNC */
  frame unsent_tags[FRAY_HANDS];
  uint32_t unsent_tag_count;
} hand_live;

static int send_frame(hand_live *l, const frame *f) {
  const int good = can_send(&l->can, f);
  l->sent += good != 0;
  l->refused += good == 0;
  return good;
}

/* A missing TAG fails its lane, so one that the queue refused is sent again before the next POSE. */
static void send_tag(hand_live *l, const frame *tag) {
  if (!send_frame(l, tag) && l->unsent_tag_count < FRAY_HANDS)
    l->unsent_tags[l->unsent_tag_count++] = *tag;
}

static void send_unsent_tags(hand_live *l) {
  for (uint32_t n = 0; n < l->unsent_tag_count; ++n) (void)send_frame(l, &l->unsent_tags[n]);
  l->unsent_tag_count = 0;
}

static void send_step(hand_live *l) {
  frame frames[SIMULATED_DEVICE_FRAMES];
  frame tag;
  send_unsent_tags(l);
  const uint32_t count = simulated_device_step(&l->simulated_device, frames);
  for (uint32_t n = 0; n < count; ++n) {
    if (l->key != NULL && !auth_gate_seal(&l->key->g, &frames[n])) {
      ++l->refused;
      continue;
    }
    if (!send_frame(l, &frames[n])) continue;
    if (l->key != NULL && auth_gate_tag(&l->key->g, &frames[n], &tag)) send_tag(l, &tag);
  }
}

/* A received frame as the device sees it; NULL: refused. A host has time to check every tag. */
static const frame *listen_to(hand_live *l, const frame *f, frame *plain) {
  if (l->key == NULL) return f;
  auth_gate_begin_tick(&l->key->g);
  return auth_gate_receive(&l->key->g, f, plain);
}

/* Behind a tenth of a second's frames it waits for a SYNC: on a starved machine a flood by the clock alone would
 * leave the runtime no time, and logs no room. */
static int may_flood(const hand_live *l) { return l->flooded_since_sync < (l->o->flood_hz + 9u) / 10u; }

/* A repeated SYNC is answered once. */
static void answer_sync(hand_live *l, const codec_sync *sync) {
  l->last_sync_ns = timer_now_ns();
  if (!may_flood(l)) l->flood_next_ns = l->last_sync_ns;
  l->flooded_since_sync = 0;
  if (l->syncs != 0 && sync->tick == l->last_tick) return;
  l->last_tick = sync->tick;
  ++l->syncs;
  if (!l->o->free_running) send_step(l);
}

static void read_all(hand_live *l) {
  frame f, plain;
  int64_t time_us;
  codec_sync sync;
  can_event event;
  while ((event = can_receive(&l->can, &f, &time_us)) != CAN_NOTHING) {
    const frame *heard = event == CAN_RECEIVED ? listen_to(l, &f, &plain) : NULL;
    if (heard == NULL) continue;
    simulated_device_receive(&l->simulated_device, heard);
    if (codec_decode_sync(heard, l->script->instance, &sync) == CODEC_OK) answer_sync(l, &sync);
  }
}

/* A plausible next POSE with an invalid tag. */
static void forge(const hand_live *l, uint32_t bits, frame *f) {
  if ((bits & 1u) == 0) return;
  f->id = dictionary_id(dictionary_auth(MESSAGE_POSE_LEFT), l->script->instance);
  f->fd = FRAME_FD | FRAME_FD_BRS;
  f->length = DICTIONARY_LENGTH_AUTH;
  for (uint32_t n = 8; n < f->length; ++n) f->data[n] = (uint8_t)(random_bits(bits, n) & 0xFFu);
}

/* Well-formed poses with a wrong CRC, and unused ids. */
static void flood(hand_live *l) {
  const int64_t now = timer_now_ns();
  while (may_flood(l) && l->flood_next_ns <= now) {
    ++l->flooded_since_sync;
    const uint32_t bits = random_bits(l->simulated_device.faults.seed + 2u, (uint32_t)(l->flooded++ & UINT32_MAX));
    frame f;
    memset(&f, 0, sizeof f);
    f.id = (bits & 1u) != 0 ? dictionary_id(MESSAGE_POSE_LEFT, l->script->instance)
                            : 0x400u + (bits >> 8 & 0xFFu);
    f.length = 8;
    for (uint32_t n = 0; n < 8; ++n) f.data[n] = (uint8_t)(random_bits(bits, n) & 0xFFu);
    fray_pose pose;
    if (codec_decode_pose(&f, l->script->instance, 0, &pose) == CODEC_OK) f.data[0] ^= 1u;
    if (l->key != NULL && !l->o->key.classic_tags) forge(l, bits, &f);
    (void)can_send(&l->can, &f);
    l->flood_next_ns += 1000000000 / (int64_t)l->o->flood_hz;
  }
}

static int64_t earlier(int64_t a_ns, int64_t b_ns) { return a_ns < b_ns ? a_ns : b_ns; }

/* Until something is to be sent, or the runtime has been silent for too long. */
static int64_t until_due_us(const hand_live *l) {
  const int64_t now = timer_now_ns();
  int64_t due = now + WAIT_NS;
  if (may_flood(l)) due = earlier(due, l->flood_next_ns);
  if (l->o->free_running) due = earlier(due, l->timer.next_ns);
  if (l->o->timeout_ms != 0) due = earlier(due, l->last_sync_ns + (int64_t)l->o->timeout_ms * 1000000);
  return due > now ? (due - now) / 1000 : 0;
}

static int fell_silent(const hand_live *l) {
  const int64_t quiet_ns = timer_now_ns() - l->last_sync_ns;
  return l->o->timeout_ms != 0 && quiet_ns > (int64_t)l->o->timeout_ms * 1000000;
}

/* Returns 0 iff the runtime stopped sending. */
static int run(hand_live *l) {
  while (signals_seen() == 0 && !simulated_device_done(&l->simulated_device)) {
    (void)can_wait(&l->can, until_due_us(l));
    read_all(l);
    flood(l);
    if (l->o->free_running && timer_now_ns() >= l->timer.next_ns) {
      (void)timer_wait(&l->timer);
      send_step(l);
    }
    if (fell_silent(l)) return 0;
    if (l->key != NULL && !bus_key_tick(l->key)) return 1;
  }
  return 1;
}

static int open_bus(hand_live *l) {
  can_setting setting;
  memset(&setting, 0, sizeof setting);
  const uint32_t instance = l->script->instance;
  const int fd = l->key != NULL && !l->o->key.classic_tags;
  setting.ids[setting.count++] = (uint16_t)dictionary_id(MESSAGE_SYNC, instance);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    const dictionary_message force = dictionary_force(h);
    setting.ids[setting.count++] = (uint16_t)dictionary_id(force, instance);
    if (fd) setting.ids[setting.count++] = (uint16_t)dictionary_id(dictionary_auth(force), instance);
  }
  if (fd) setting.ids[setting.count++] = (uint16_t)dictionary_id(MESSAGE_ACK_AUTH, instance);
  setting.fd = setting.sends_fd = fd;
  return can_open(&l->can, l->o->interface, &setting);
}

/* The arms' own account; below 0 they were given. */
static void print_arms(const hand_live *l) {
  if (l->script->arm_mass_mg == 0) return;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    printf("arm          %s gave %.3f mJ\n", h == 0 ? "left" : "right", l->simulated_device.handle[h].arm.given * 1e3);
}

static int run_on_bus(hand_live *l) {
  if (!open_bus(l)) return 2;
  timer_begin(&l->timer, l->script->rate_hz);
  l->last_sync_ns = l->flood_next_ns = timer_now_ns();
  const int good = run(l);
  can_close(&l->can);
  printf("hand         %s: %" PRIu64 " SYNCs, %" PRIu64 " frames sent, %" PRIu64 " refused, %" PRIu64 " flooded\n", l->can.name,
         l->syncs, l->sent, l->refused, l->flooded);
  print_arms(l);
  if (l->key != NULL) {
    const char *why = bus_key_complaint(l->key);
    bus_key_print(l->key, stdout);
    if (why != NULL) fprintf(stderr, "%s: %s\n", l->can.name, why);
  }
  if (!good) fprintf(stderr, "%s: no SYNC for %u ms\n", l->o->interface, l->o->timeout_ms);
  return good ? 0 : 1;
}

int hand_live_run(const script *s, const device_faults *faults, const hand_live_options *o) {
  static hand_live l;
  static bus_key key;
  memset(&l, 0, sizeof l);
  signals_note(SIGNALS_ALL, NULL);
  l.o = o;
  l.script = s;
  simulated_device_begin(&l.simulated_device, s, faults);
  if (o->key.file == NULL) return run_on_bus(&l);
  if (!bus_key_open(&key, &o->key, AUTH_GATE_DEVICE, s->instance, 0)) return 2;
  l.key = &key;
  const int code = run_on_bus(&l);
  const int kept = bus_key_close(&key);
  return code != 0 || kept ? code : 1;
}
