/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/wire/port.h"

#include "rt/wire/dictionary.h"
#include "tests/lib/test.h"

static port p;
static fray_input input;

static void push_pose(uint32_t hand, uint8_t counter, int16_t x) {
  frame f;
  const fray_pose pose = {x, 0, 0, counter, 0};
  codec_encode_pose(&f, 0, hand, &pose);
  port_push(&p, &f);
}

static void push_command(uint8_t counter, uint8_t verb) {
  frame f;
  const codec_command command = {counter, verb, 0};
  codec_encode_command(&f, 0, &command);
  port_push(&p, &f);
}

static void one_pose_a_hand(void) {
  port_init(&p, 0, 3, NULL);
  push_pose(0, 1, 11);
  push_pose(1, 1, 22);
  port_take(&p, &input);
  CHECK_EQ_INT(input.has_pose, 3);
  CHECK_EQ_INT(input.pose[0].x, 11);
  CHECK_EQ_INT(input.pose[1].x, 22);
  CHECK_EQ_INT(input.pose[1].counter, 1);
  CHECK_EQ_INT(input.command, 0);
  port_take(&p, &input);
  CHECK_EQ_INT(input.has_pose, 0);
  CHECK_EQ_INT(p.statistics.accepted, 2);
}

static void newest_pose_wins(void) {
  port_init(&p, 0, 1, NULL);
  push_pose(0, 1, 11);
  push_pose(0, 2, 12);
  push_pose(0, 3, 13);
  port_take(&p, &input);
  CHECK_EQ_INT(input.pose[0].x, 13);
  CHECK_EQ_INT(p.statistics.accepted, 3);
  CHECK_EQ_INT(p.statistics.lost, 0);
}

static void repeated_lost_and_old(void) {
  port_init(&p, 0, 1, NULL);
  push_pose(0, 0, 10); /* a port has seen 0 */
  push_pose(0, 1, 11);
  push_pose(0, 1, 12);
  push_pose(0, 4, 14); /* 2 and 3 are lost */
  port_take(&p, &input);
  CHECK_EQ_INT(input.pose[0].x, 14);
  CHECK_EQ_INT(p.statistics.repeated, 2);
  CHECK_EQ_INT(p.statistics.lost, 2);
  CHECK_EQ_INT(p.statistics.accepted, 2);
  push_pose(0, 3, 23); /* overtaken by 4 */
  push_pose(0, 12, 32);
  port_take(&p, &input);
  CHECK_EQ_INT(input.pose[0].x, 32);
  CHECK_EQ_INT(p.statistics.old, 1);
  CHECK_EQ_INT(p.statistics.lost, 9);
}

/* 5 is consumed, then 13 and another 5 come: FORCE could not tell the second 5 from the first. */
static void consumed_counter_does_not_return_at_once(void) {
  port_init(&p, 0, 1, NULL);
  push_pose(0, 5, 1);
  port_take(&p, &input);
  push_pose(0, 13, 2);
  push_pose(0, 5, 3);
  port_take(&p, &input);
  CHECK_EQ_INT(input.pose[0].counter, 13);
  port_take(&p, &input);
  CHECK_EQ_INT(input.pose[0].x, 3);
  CHECK_EQ_INT(p.statistics.old, 0);
}

/* 14 is 9 ahead of 5. */
static void a_device_that_begins_anew(void) {
  port_init(&p, 0, 1, NULL);
  push_pose(0, 5, 1);
  port_take(&p, &input);
  for (uint8_t counter = 14; counter < 16; ++counter) {
    push_pose(0, counter, 2);
    port_take(&p, &input);
    CHECK_EQ_INT(input.has_pose, 0);
  }
  push_pose(0, 14, 3); /* not the next one: begins anew */
  push_pose(0, 15, 4);
  port_take(&p, &input);
  CHECK_EQ_INT(input.has_pose, 0);
  push_pose(0, 0, 5);
  port_take(&p, &input);
  CHECK_EQ_INT(input.pose[0].x, 5);
  CHECK_EQ_INT(p.statistics.old, 4);
  CHECK_EQ_INT(p.statistics.lost, 4);
}

static void goes_on_after_a_save(void) {
  static const uint8_t CONSUMED[FRAY_HANDS] = {7, 3};
  port_init(&p, 0, 3, CONSUMED);
  push_pose(0, 7, 1);
  push_pose(1, 4, 2);
  port_take(&p, &input);
  CHECK_EQ_INT(input.has_pose, 2);
  CHECK_EQ_INT(p.statistics.lost, 0);
}

static void one_command_a_tick(void) {
  port_init(&p, 0, 1, NULL);
  push_command(1, FRAY_COMMAND_START);
  push_command(2, FRAY_COMMAND_STOP);
  push_pose(0, 1, 11);
  port_take(&p, &input);
  CHECK_EQ_INT(input.command, FRAY_COMMAND_START);
  CHECK_EQ_INT(input.command_counter, 1);
  CHECK_EQ_INT(input.pose[0].x, 11); /* not held up by the command that waits */
  push_command(2, FRAY_COMMAND_RESET);  /* repeated: drops out after STOP */
  port_take(&p, &input);
  CHECK_EQ_INT(input.command, FRAY_COMMAND_STOP);
  port_take(&p, &input);
  CHECK_EQ_INT(input.command, 0);
  CHECK_EQ_INT(p.statistics.repeated, 1);
}

static void eight_poses_a_tick(void) {
  port_init(&p, 0, 3, NULL);
  for (int n = 1; n <= 11; ++n) push_pose(0, (uint8_t)n, (int16_t)n);
  push_pose(1, 1, 100);
  port_take(&p, &input);
  CHECK_EQ_INT(input.pose[0].x, 8);
  CHECK_EQ_INT(input.pose[1].x, 100);
  CHECK_EQ_INT(p.pending.count, 3);
  port_take(&p, &input);
  CHECK_EQ_INT(input.has_pose, 1);
  CHECK_EQ_INT(input.pose[0].x, 11);
  CHECK_EQ_INT(p.statistics.lost, 0);
}

/* Bad frames cost their share of the 64, so the work of a tick is bounded. */
static void sixty_four_frames_a_tick(void) {
  const frame bad = {0x101, 0, 0, 0, 0, 8, {0}};
  port_init(&p, 0, 1, NULL);
  for (int n = 0; n < 64; ++n) port_push(&p, &bad);
  push_pose(0, 1, 11);
  port_take(&p, &input);
  CHECK_EQ_INT(input.has_pose, 0);
  CHECK_EQ_INT(p.statistics.wrong_crc, 64);
  port_take(&p, &input);
  CHECK_EQ_INT(input.pose[0].x, 11);
}

static void full_queue(void) {
  port_init(&p, 0, 1, NULL);
  for (int n = 1; n <= 260; ++n) push_pose(0, (uint8_t)(n & 15), (int16_t)n);
  CHECK_EQ_INT(p.statistics.queue_full, 4);
  for (int tick = 1; tick <= 32; ++tick) {
    port_take(&p, &input);
    CHECK_EQ_INT(input.pose[0].x, 8 * tick);
  }
  port_take(&p, &input);
  CHECK_EQ_INT(input.has_pose, 0);
}

static void waiting_frames_keep_their_order_round_the_end(void) {
  port_init(&p, 0, 1, NULL);
  int next = 1, verb = 1;
  for (int round = 0; round < 200; ++round) {
    push_command((uint8_t)(next & 15), (uint8_t)(1 + (next & 3)));
    push_command((uint8_t)((next + 1) & 15), (uint8_t)(1 + ((next + 1) & 3)));
    push_pose(0, (uint8_t)((round + 1) & 15), (int16_t)round);
    next += 2;
    for (int n = 0; n < 2; ++n) {
      port_take(&p, &input);
      CHECK_EQ_INT(input.command, 1 + (verb & 3));
      CHECK_EQ_INT(input.has_pose, n == 0);
      verb += 1;
    }
  }
  CHECK_EQ_INT(p.statistics.repeated, 0);
  CHECK_EQ_INT(p.statistics.lost, 0);
}

static void filter(void) {
  port_init(&p, 1, 1, NULL);
  const frame mine = {0x111, 0, 0, 0, 0, 8, {0}};
  frame f = mine;
  port_push(&p, &f);
  CHECK_EQ_INT(p.pending.count, 1);
  f.length = 7;
  port_push(&p, &f);
  CHECK_EQ_INT(p.statistics.wrong_length, 1);
  f = mine;
  f.rtr = 1;
  port_push(&p, &f);
  CHECK_EQ_INT(p.statistics.wrong_flags, 1);
  f = mine;
  f.extended = 1;
  port_push(&p, &f);
  f = mine;
  f.error = 1;
  port_push(&p, &f);
  f = mine;
  f.id = 0x101; /* another instance */
  port_push(&p, &f);
  f.id = 0x112; /* a hand that is not in use */
  port_push(&p, &f);
  f.id = 0x081; /* the own SYNC, read back */
  port_push(&p, &f);
  CHECK_EQ_INT(p.statistics.unknown_id, 5);
  CHECK_EQ_INT(p.pending.count, 1);
}

static void wrong_field(void) {
  const frame verb_0 = {0x010, 0, 0, 0, 0, 8, {0x18, 0x01}};
  port_init(&p, 0, 1, NULL);
  port_push(&p, &verb_0);
  port_take(&p, &input);
  CHECK_EQ_INT(input.command, 0);
  CHECK_EQ_INT(p.statistics.wrong_field, 1);
  CHECK_EQ_INT(p.statistics.accepted, 0);
}

static void outputs(void) {
  port_sender s;
  frame f[PORT_OUT];
  codec_force force;
  codec_ack ack;
  codec_tear tear;
  codec_status status;
  fray_output o = {0};
  port_sender_init(&s, 0, 3, 1000);
  o.state = FRAY_READY;
  CHECK_EQ_INT(port_encode(&s, &o, f), 3); /* the first STATUS */
  CHECK_EQ_INT(f[0].id, 0x181);
  CHECK_EQ_INT(f[1].id, 0x182);
  CHECK_EQ_INT(f[2].id, 0x701);
  o.tick = 1;
  CHECK_EQ_INT(port_encode(&s, &o, f), 2);
  o.tick = 18;
  o.force[1][2] = -5;
  o.consumed[1] = 9;
  o.answered = FRAY_COMMAND_START;
  o.answer_counter = 6;
  o.work.tears = 3;
  o.first_tear = 77;
  o.tears_total = 70000;
  o.state = FRAY_OPERATIONAL;
  CHECK_EQ_INT(port_encode(&s, &o, f), 5);
  CHECK_EQ_INT(codec_decode_force(&f[1], 0, 1, &force), CODEC_OK);
  CHECK_EQ_INT(force.z, -5);
  CHECK_EQ_INT(force.counter, 2);
  CHECK_EQ_INT(force.consumed, 9);
  CHECK_EQ_INT(codec_decode_ack(&f[2], 0, &ack), CODEC_OK);
  CHECK_EQ_INT(ack.command_counter, 6);
  CHECK_EQ_INT(ack.tick, 18);
  CHECK_EQ_INT(codec_decode_tear(&f[3], 0, &tear), CODEC_OK);
  CHECK_EQ_INT(tear.more, 2);
  CHECK_EQ_INT(tear.element, 77);
  CHECK_EQ_INT(tear.kind, CODEC_TEAR_STRUCTURAL);
  CHECK_EQ_INT(codec_decode_status(&f[4], 0, &status), CODEC_OK);
  CHECK_EQ_INT(status.tears, 65535);
  o.tick = 34;
  o.work.tear_candidates = 12;
  CHECK_EQ_INT(port_encode(&s, &o, f), 4);
  CHECK_EQ_INT(codec_decode_tear(&f[3], 0, &tear), CODEC_OK);
  CHECK_EQ_INT(tear.kind, CODEC_TEAR_TRIANGLES);
  CHECK_EQ_INT(tear.element, 77);
}

static void status_when_due(void) {
  port_sender s;
  frame f[PORT_OUT];
  fray_output o = {0};
  int sent = 0;
  port_sender_init(&s, 0, 0, 1000);
  o.state = FRAY_READY;
  for (o.tick = 0; o.tick < 1000; ++o.tick) {
    o.tears_total += 1;
    if (o.tick == 550) o.faults = FRAY_FAULT_BREAK_BUDGET;
    sent += (int)port_encode(&s, &o, f);
  }
  CHECK_EQ_INT(sent, 11);
}

/* Never more than a tenth of a second apart, where the tick's low word wraps too. */
static void status_across_the_wrap(void) {
  port_sender s;
  frame f[PORT_OUT];
  fray_output o = {0};
  uint64_t last = (UINT64_C(1) << 32) - 500;
  uint32_t farthest = 0;
  port_sender_init(&s, 0, 0, 1000);
  o.state = FRAY_READY;
  for (o.tick = last; o.tick < (UINT64_C(1) << 32) + 500; ++o.tick) {
    if (port_encode(&s, &o, f) == 0) continue;
    farthest = o.tick - last > farthest ? (uint32_t)(o.tick - last) : farthest;
    last = o.tick;
  }
  CHECK_EQ_INT(farthest, 100);
  o.tick = (UINT64_C(1) << 32) + 18;
  o.answered = FRAY_COMMAND_STOP;
  CHECK_EQ_INT(port_encode(&s, &o, f), 1);
  codec_ack ack;
  CHECK_EQ_INT(codec_decode_ack(&f[0], 0, &ack), CODEC_OK);
  CHECK_EQ_INT(ack.tick, 18);
}

int main(void) {
  TEST(one_pose_a_hand);
  TEST(newest_pose_wins);
  TEST(repeated_lost_and_old);
  TEST(consumed_counter_does_not_return_at_once);
  TEST(a_device_that_begins_anew);
  TEST(goes_on_after_a_save);
  TEST(one_command_a_tick);
  TEST(eight_poses_a_tick);
  TEST(sixty_four_frames_a_tick);
  TEST(full_queue);
  TEST(waiting_frames_keep_their_order_round_the_end);
  TEST(filter);
  TEST(wrong_field);
  TEST(outputs);
  TEST(status_when_due);
  TEST(status_across_the_wrap);
  return test_end();
}
