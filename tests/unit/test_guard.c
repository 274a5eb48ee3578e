/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/wire/guard.h"

#include "rt/wire/codec.h"
#include "rt/wire/port.h"
#include "tests/lib/test.h"

static const uint8_t KEY_BYTES[16] = {0x2b, 0x7e, 0x15, 0x16, 0x28, 0xae, 0xd2, 0xa6,
                                      0xab, 0xf7, 0x15, 0x88, 0x09, 0xcf, 0x4f, 0x3c};
static cmac_key key;
static guard runtime, device;

static void begin(guard_form form, uint32_t instance, uint32_t hands) {
  guard_init(&runtime, &key, form, GUARD_RUNTIME, instance, hands);
  guard_init(&device, &key, form, GUARD_DEVICE, instance, 0);
}

static frame plain_frame(dictionary_message message, uint32_t instance) {
  frame f;
  memset(&f, 0, sizeof f);
  f.id = dictionary_id(message, instance);
  f.length = 8;
  f.data[3] = (uint8_t)message;
  return f;
}

/* Which messages each end seals, and which it opens when the other has sealed them. */
static void who_says_what(void) {
  for (uint32_t instance = 0; instance < 8; instance += 7) {
    begin(GUARD_FD, instance, 3);
    for (uint32_t m = 0; m < MESSAGES; ++m) {
      const dictionary_message form = dictionary_auth((dictionary_message)m);
      const int runtimes = m == MESSAGE_ACK || m == MESSAGE_FORCE_LEFT || m == MESSAGE_FORCE_RIGHT;
      guard *from = runtimes ? &runtime : &device;
      guard *to = runtimes ? &device : &runtime;
      const frame plain = plain_frame((dictionary_message)m, instance);
      frame f = plain, out;
      CHECK_EQ_INT(guard_seal(from, &f), 1);
      if (form == MESSAGES) {
        CHECK(memcmp(&f, &plain, sizeof f) == 0);
        continue;
      }
      CHECK_EQ_INT(f.id, dictionary_id(form, instance));
      CHECK(guard_take(from, &f, &out) == &f); /* its own, read back: the port counts it */
      CHECK(guard_take(to, &f, &out) == &out);
      CHECK(memcmp(&out, &plain, sizeof out) == 0);
      CHECK(guard_take(to, &f, &out) == 0);
      CHECK(guard_take(to, &plain, &out) == 0);
    }
    CHECK_EQ_INT(runtime.plain, 3);
    CHECK_EQ_INT(device.plain, 3);
  }
}

static void what_has_no_tag_goes_through(void) {
  static const dictionary_message FREE[] = {MESSAGE_SYNC, MESSAGE_TEAR, MESSAGE_STATUS};
  frame out;
  begin(GUARD_FD, 0, 3);
  for (int n = 0; n < 3; ++n) {
    const frame f = plain_frame(FREE[n], 0);
    CHECK(guard_take(&device, &f, &out) == &f);
  }
  frame other = plain_frame(MESSAGE_POSE_LEFT, 1);
  CHECK(guard_take(&runtime, &other, &out) == &other);
  other = plain_frame(MESSAGE_POSE_LEFT, 0);
  other.extended = 1;
  CHECK(guard_take(&runtime, &other, &out) == &other);
}

static void lanes_in_their_order(void) {
  static const uint32_t RUNTIME[] = {0x024, 0x129, 0x12A, 0x025, 0x1A9, 0x1AA, 0x024};
  static const uint32_t DEVICE[] = {0x025, 0x1A9, 0x1AA, 0x024, 0x129, 0x12A};
  guard_lane lanes[GUARD_LANES];
  begin(GUARD_FD, 2, 3);
  CHECK_EQ_INT(guard_lanes(&runtime, lanes), 7);
  for (uint32_t n = 0; n < 7; ++n) {
    CHECK_EQ_INT(dictionary_id(lanes[n].message, 2), RUNTIME[n]);
    CHECK_EQ_INT(lanes[n].sends, n >= 3);
    CHECK_EQ_INT(*lanes[n].last, n == 6 ? AUTH_OWN : 0);
    CHECK_EQ_INT(*lanes[n].most, n == 0 ? AUTH_OWN - 1 : UINT32_MAX);
  }
  CHECK_EQ_INT(guard_lanes(&device, lanes), 6);
  for (uint32_t n = 0; n < 6; ++n) CHECK_EQ_INT(dictionary_id(lanes[n].message, 2), DEVICE[n]);
  CHECK_EQ_INT(*lanes[3].most, AUTH_OWN - 1);
  begin(GUARD_CLASSIC, 2, 3);
  CHECK_EQ_INT(guard_lanes(&runtime, lanes), 2);
  CHECK_EQ_INT(dictionary_id(lanes[1].message, 2), 0x322);
  CHECK_EQ_INT(lanes[1].sends, 0);
  *lanes[1].last = 7;
  CHECK_EQ_INT(runtime.watch[1].group.last, 7);
  CHECK_EQ_INT(guard_lanes(&device, lanes), 2);
  CHECK_EQ_INT(lanes[0].sends, 1);
}

/* 1,000,000 frames to a port under a key: every kind of forgery, and each good one again. */
static void a_million_hostile_frames_to_a_port(void) {
  enum { ROUNDS = 200000 };
  static port p;
  uint32_t state = 1, evil = 0, good = 0;
  begin(GUARD_FD, 0, 3);
  port_init(&p, 0, 3, 0);
  p.guard = &runtime;
  for (uint32_t n = 0; n < ROUNDS; ++n) {
    const uint32_t h = n & 1u;
    const fray_pose pose = {(int16_t)(n % 1000), 0, 0, (uint8_t)((n / 2 + 1) & 15u), 0};
    const fray_pose lie = {30000, 0, 0, pose.counter, 0};
    fray_input input;
    frame f, g;
    guard_tick(&runtime);
    codec_encode_pose(&f, 0, h, &pose);
    CHECK(guard_seal(&device, &f));
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
  begin(GUARD_CLASSIC, 0, 2);
  for (int n = 0; n < 9; ++n) { /* no TAG of the left hand, which nobody uses */
    f = plain_frame(MESSAGE_POSE_LEFT, 0);
    CHECK(guard_take(&runtime, &f, &out) == &f);
    f = plain_frame(MESSAGE_POSE_RIGHT, 0);
    CHECK(guard_take(&runtime, &f, &out) == &f);
    if (guard_tag(&device, &f, &tag)) CHECK(guard_take(&runtime, &tag, &out) == 0);
  }
  CHECK_EQ_INT(runtime.watch[1].good, 2);
  CHECK_EQ_INT(guard_alarm(&runtime), 0);
  for (int n = 0; n < 20; ++n) (void)guard_take(&runtime, &f, &out);
  CHECK_EQ_INT(runtime.failed, 2);
  CHECK_EQ_INT(guard_alarm(&runtime), 1);
  CHECK_EQ_INT(guard_alarm(&runtime), 0);
  CHECK(guard_take(&runtime, &f, &out) == 0);
  guard_clear(&runtime);
  CHECK(guard_take(&runtime, &f, &out) == &f);
  CHECK_EQ_INT(guard_alarm(&runtime), 0);
}

int main(void) {
  cmac_key_init(&key, KEY_BYTES);
  TEST(who_says_what);
  TEST(what_has_no_tag_goes_through);
  TEST(lanes_in_their_order);
  TEST(a_million_hostile_frames_to_a_port);
  TEST(tags_of_hands_that_the_world_has);
  return test_end();
}
