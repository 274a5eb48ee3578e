/* SPDX-License-Identifier: Apache-2.0 */
/* A flood on the bus, besides good poses: ids that nobody has, and frames that look like poses with a
 * wrong CRC. The rest of a tick's frames waits; the ticks go on.
 *
 * At 20 a tick (the most that a bus of 1 Mbit/s carries is 21) nothing waits at all. At 200 a tick, 100
 * of them for the queue, 64 are looked at and 36 are left over: the queue of 256 is full after 7 ticks
 * and then drops what comes, poses among it, until a hand is stale. That is another bus than CAN. */
#include "tests/lib/test.h"
#include "tests/sim/sim_session.h"

enum { TICKS = 2000, CALM = 100, FLOODED = TICKS - CALM };

static session s;
static uint64_t seed;

/* One of two is for nobody, the other has the id of a hand's POSE. */
static void flood(uint32_t count) {
  for (uint32_t n = 0; n < count; ++n) {
    frame f = {0};
    f.length = 8;
    f.id = n % 2 == 0 ? 0x7A0 : dictionary_id(dictionary_pose(n / 2 % 2), 0);
    const uint64_t bits = splitmix64(&seed);
    memcpy(f.data, &bits, 8);
    fray_pose pose;
    if (n % 2 != 0 && codec_read_pose(f.data, 0, n / 2 % 2, &pose) == CODEC_OK) f.data[0] ^= 1;
    sim_inject(&f);
  }
}

static uint32_t looked_at(const port_statistics *p) {
  return p->accepted + p->repeated + p->old + p->wrong_crc + p->wrong_field;
}

typedef struct {
  uint32_t looked_most, delayed_most;
  uint32_t without;   /* hands and ticks without a pose */
  uint32_t safe_tick; /* 0: never */
} outcome;

/* Poses anywhere in the flood; their x is the number of their tick, which says when they were taken. */
static outcome run(uint32_t a_tick) {
  outcome o = {0, 0, 0, 0};
  seed = a_tick;
  session_scene(&s.f, 8, 4, "0.25");
  session_begin(&s);
  for (uint32_t tick = 0; tick < TICKS; ++tick) {
    const uint32_t before = looked_at(&s.l.in.statistics);
    const uint32_t all = tick < CALM ? 0 : a_tick;
    const uint32_t first = (uint32_t)(splitmix64(&seed) % (all / 2 + 1u)) * 2;
    flood(first);
    for (uint32_t h = 0; h < FRAY_HANDS; ++h)
      sim_pose(h, (uint8_t)(tick + 1), (int16_t)tick, 0, 0);
    if (tick == 0) session_command(&s, FRAY_COMMAND_START);
    flood(all - first);
    CHECK_EQ_INT(loop_run(&s.l), LOOP_TICKED);
    CHECK_EQ_INT(s.l.output.tick, tick);
    const uint32_t looked = looked_at(&s.l.in.statistics) - before;
    if (looked > o.looked_most) o.looked_most = looked;
    for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
      if (((uint32_t)s.l.input.has_pose >> h & 1u) == 0) {
        ++o.without;
        continue;
      }
      const uint32_t late = (uint32_t)((int32_t)tick - s.l.input.pose[h].x);
      if (late > o.delayed_most) o.delayed_most = late;
    }
    if (o.safe_tick == 0 && s.l.output.state == FRAY_SAFE) o.safe_tick = tick;
  }
  CHECK_EQ_INT(s.l.overruns, 0);
  CHECK_EQ_INT(s.l.bus_losses, 0);
  CHECK_EQ_INT(sim_own(0, dictionary_id(MESSAGE_SYNC, 0), 0), TICKS);
  CHECK_EQ_INT(sim_own(0, dictionary_id(MESSAGE_FORCE_LEFT, 0), 0), TICKS);
  CHECK_EQ_INT(sim_own(0, dictionary_id(MESSAGE_FORCE_RIGHT, 0), 0), TICKS);
  const port_statistics *p = &s.l.in.statistics;
  CHECK_EQ_INT(p->unknown_id, a_tick / 2 * FLOODED);
  CHECK_EQ_INT(p->wrong_length + p->wrong_flags, 0);
  CHECK_EQ_INT(p->wrong_field, 0);
  /* every frame is in one counter or still waits */
  CHECK_EQ_INT(looked_at(p) + p->queue_full + s.l.in.pending.count,
               a_tick / 2 * FLOODED + 2 * TICKS + 1);
  CHECK(o.looked_most <= PORT_FRAMES_PER_TICK);
  return o;
}

static void finish(void) {
  fixture_close(&s.f);
  sim_end();
}

static void twenty_a_tick(void) {
  const outcome o = run(20);
  const port_statistics *p = &s.l.in.statistics;
  CHECK_EQ_INT(p->accepted, 2 * TICKS + 1);
  CHECK_EQ_INT(p->lost + p->repeated + p->queue_full, 0);
  CHECK_EQ_INT(p->wrong_crc, 10 * FLOODED);
  CHECK(o.delayed_most <= 1);
  CHECK_EQ_INT(o.without, 0);
  CHECK_EQ_INT(o.safe_tick, 0);
  CHECK_EQ_INT(s.l.output.state, FRAY_OPERATIONAL);
  figure("flood_20_pose_delay_worst", o.delayed_most, "ticks", "1");
  figure("flood_20_looked_at_worst", o.looked_most, "frames", "64");
  finish();
}

static void two_hundred_a_tick(void) {
  const outcome o = run(200);
  const port_statistics *p = &s.l.in.statistics;
  CHECK_EQ_INT(o.looked_most, PORT_FRAMES_PER_TICK);
  CHECK(o.delayed_most <= QUEUE_CAPACITY / PORT_FRAMES_PER_TICK);
  CHECK(p->queue_full > 0);
  figure("flood_200_pose_delay_worst", o.delayed_most, "ticks", "stated: the queue, 4");
  figure("flood_200_poses_dropped", 2.0 * TICKS - (p->accepted - 1.0), "of 3800", "stated");
  if (o.safe_tick != 0) CHECK_EQ_INT(s.l.output.state, FRAY_SAFE);
  figure("flood_200_safe_after", o.safe_tick == 0 ? -1.0 : (double)o.safe_tick - CALM, "ticks",
         "stated; -1: never");
  figure("flood_200_looked_at_worst", o.looked_most, "frames", "64");
  finish();
}

int main(void) {
  TEST(twenty_a_tick);
  TEST(two_hundred_a_tick);
  return test_end();
}
