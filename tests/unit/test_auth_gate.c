/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/wire/auth_gate.h"

#include "rt/wire/codec.h"
#include "rt/wire/port.h"
#include "tests/lib/rfc4493_key.h"
#include "tests/lib/test.h"

static cmac_key key;
static auth_gate runtime, device;

static void begin(auth_gate_form form, uint32_t instance, uint32_t hands) {
  auth_gate_init(&runtime, &key, form, AUTH_GATE_RUNTIME, instance, hands);
  auth_gate_init(&device, &key, form, AUTH_GATE_DEVICE, instance, 0);
}

static frame plain_frame(dictionary_message message, uint32_t instance) {
  frame f = {0};
  f.id = dictionary_id(message, instance);
  f.length = 8;
  f.data[3] = (uint8_t)message;
  return f;
}

/* Which messages each end seals, and which it opens when the other has sealed them. */
static void who_says_what(void) {
  for (uint32_t instance = 0; instance < 8; instance += 7) {
    begin(AUTH_GATE_FD, instance, 3);
    for (uint32_t m = 0; m < MESSAGES; ++m) {
      const dictionary_message form = dictionary_auth((dictionary_message)m);
      const int runtimes = m == MESSAGE_ACK || m == MESSAGE_FORCE_LEFT || m == MESSAGE_FORCE_RIGHT;
      auth_gate *from = runtimes ? &runtime : &device;
      auth_gate *to = runtimes ? &device : &runtime;
      const frame plain = plain_frame((dictionary_message)m, instance);
      frame f = plain, out;
      CHECK_EQ_INT(auth_gate_seal(from, &f), 1);
      if (form == MESSAGES) {
        CHECK(memcmp(&f, &plain, sizeof f) == 0);
        continue;
      }
      CHECK_EQ_INT(f.id, dictionary_id(form, instance));
      CHECK(auth_gate_receive(from, &f, &out) == &f); /* its own, read back: the port counts it */
      CHECK(auth_gate_receive(to, &f, &out) == &out);
      CHECK(memcmp(&out, &plain, sizeof out) == 0);
      CHECK(auth_gate_receive(to, &f, &out) == 0);
      CHECK(auth_gate_receive(to, &plain, &out) == 0);
    }
    CHECK_EQ_INT(runtime.plain, 3);
    CHECK_EQ_INT(device.plain, 3);
  }
}

static void what_has_no_tag_goes_through(void) {
  static const dictionary_message FREE[] = {MESSAGE_SYNC, MESSAGE_TEAR, MESSAGE_STATUS, MESSAGE_IDENTITY};
  frame out;
  begin(AUTH_GATE_FD, 0, 3);
  for (int n = 0; n < 4; ++n) {
    const frame f = plain_frame(FREE[n], 0);
    CHECK(auth_gate_receive(&device, &f, &out) == &f);
  }
  frame other = plain_frame(MESSAGE_POSE_LEFT, 1);
  CHECK(auth_gate_receive(&runtime, &other, &out) == &other);
  other = plain_frame(MESSAGE_POSE_LEFT, 0);
  other.extended = 1;
  CHECK(auth_gate_receive(&runtime, &other, &out) == &other);
}

static void lanes_in_their_order(void) {
  static const uint32_t RUNTIME[] = {0x024, 0x129, 0x12A, 0x025, 0x1A9, 0x1AA, 0x024};
  static const uint32_t DEVICE[] = {0x025, 0x1A9, 0x1AA, 0x024, 0x129, 0x12A};
  auth_gate_lane lanes[AUTH_GATE_LANES];
  begin(AUTH_GATE_FD, 2, 3);
  CHECK_EQ_INT(auth_gate_lanes(&runtime, lanes), 7);
  for (uint32_t n = 0; n < 7; ++n) {
    CHECK_EQ_INT(dictionary_id(lanes[n].message, 2), RUNTIME[n]);
    CHECK_EQ_INT(lanes[n].sends, n >= 3);
    CHECK_EQ_INT(*lanes[n].last, n == 6 ? AUTH_RUNTIME_FIRST : 0);
    CHECK_EQ_INT(*lanes[n].max, n == 0 ? AUTH_RUNTIME_FIRST - 1 : UINT32_MAX);
  }
  CHECK_EQ_INT(auth_gate_lanes(&device, lanes), 6);
  for (uint32_t n = 0; n < 6; ++n) CHECK_EQ_INT(dictionary_id(lanes[n].message, 2), DEVICE[n]);
  CHECK_EQ_INT(*lanes[3].max, AUTH_RUNTIME_FIRST - 1);
  begin(AUTH_GATE_CLASSIC, 2, 3);
  CHECK_EQ_INT(auth_gate_lanes(&runtime, lanes), 2);
  CHECK_EQ_INT(dictionary_id(lanes[1].message, 2), 0x322);
  CHECK_EQ_INT(lanes[1].sends, 0);
  *lanes[1].last = 7;
  CHECK_EQ_INT(runtime.monitor[1].group.last, 7);
  CHECK_EQ_INT(auth_gate_lanes(&device, lanes), 2);
  CHECK_EQ_INT(lanes[0].sends, 1);
}

/* 1,000,000 frames to a port under a key: every kind of forgery, and each good one again. */
static void a_million_hostile_frames_to_a_port(void) {
  enum { ROUNDS = 200000 };
  static port p;
  uint32_t state = 1, evil = 0, good = 0;
  begin(AUTH_GATE_FD, 0, 3);
  port_init(&p, 0, 3, 0);
  p.gate = &runtime;
  for (uint32_t n = 0; n < ROUNDS; ++n) {
    const uint32_t h = n & 1u;
    const fray_pose pose = {(int16_t)(n % 1000), 0, 0, (uint8_t)((n / 2 + 1) & 15u), 0};
    const fray_pose lie = {30000, 0, 0, pose.counter, 0};
    fray_input input;
    frame f, g;
    auth_gate_begin_tick(&runtime);
    codec_encode_pose(&f, 0, h, &pose);
    CHECK(auth_gate_seal(&device, &f));
    for (uint32_t kind = 0; kind < 4; ++kind) {
      state = state * 1664525u + 1013904223u;
      codec_encode_pose(&g, 0, h, &lie);
      if (kind != 3) {
        memcpy(g.data + 8, f.data + 8, 12);
        g.id = f.id;
        g.fd = f.fd;
        g.length = f.length;
      }
      if (kind == 1) memcpy(g.data + 12, &state, 4);
      if (kind == 2) g.data[8 + (state >> 8) % 4] ^= (uint8_t)(1u << (state >> 16) % 8);
      port_push(&p, &g);
    }
    port_push(&p, &f);
    port_push(&p, &f);
    port_take(&p, &input);
    evil += input.pose[0].x == 30000 || input.pose[1].x == 30000;
    good += ((uint32_t)input.has_pose >> h & 1u) != 0 && input.pose[h].x == pose.x;
  }
  CHECK_EQ_INT(evil, 0);
  CHECK_EQ_INT(good, ROUNDS);
  CHECK_EQ_INT(runtime.plain, ROUNDS);
  CHECK_EQ_INT(p.statistics.accepted, ROUNDS);
  CHECK_EQ_INT(runtime.in[1].forged + runtime.in[1].old + runtime.in[2].forged + runtime.in[2].old,
               4 * ROUNDS);
  printf("figure auth_port_hostile %d forged, replayed or plain frames to a port, %u used (asked: 0)\n",
         5 * ROUNDS, evil);
}

static void tags_of_hands_that_the_world_has(void) {
  frame f, tag, out;
  begin(AUTH_GATE_CLASSIC, 0, 2);
  for (int n = 0; n < 9; ++n) { /* no TAG of the left hand, which nobody uses */
    f = plain_frame(MESSAGE_POSE_LEFT, 0);
    CHECK(auth_gate_receive(&runtime, &f, &out) == &f);
    f = plain_frame(MESSAGE_POSE_RIGHT, 0);
    CHECK(auth_gate_receive(&runtime, &f, &out) == &f);
    if (auth_gate_tag(&device, &f, &tag)) CHECK(auth_gate_receive(&runtime, &tag, &out) == 0);
  }
  CHECK_EQ_INT(runtime.monitor[1].good, 2);
  CHECK_EQ_INT(auth_gate_alarm(&runtime), 0);
  for (int n = 0; n < 20; ++n) (void)auth_gate_receive(&runtime, &f, &out);
  CHECK_EQ_INT(runtime.failed, 2);
  CHECK_EQ_INT(auth_gate_alarm(&runtime), 1);
  CHECK_EQ_INT(auth_gate_alarm(&runtime), 0);
  CHECK(auth_gate_receive(&runtime, &f, &out) == 0);
  auth_gate_clear(&runtime);
  CHECK(auth_gate_receive(&runtime, &f, &out) == &f);
  CHECK_EQ_INT(auth_gate_alarm(&runtime), 0);
}

int main(void) {
  cmac_key_init(&key, RFC4493_KEY);
  TEST(who_says_what);
  TEST(what_has_no_tag_goes_through);
  TEST(lanes_in_their_order);
  TEST(a_million_hostile_frames_to_a_port);
  TEST(tags_of_hands_that_the_world_has);
  return test_end();
}
