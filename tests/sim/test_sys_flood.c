/* SPDX-License-Identifier: Apache-2.0 */
/* A flood of 20,000 frames/s, as much as 1 Mbit/s carries, through the Linux board in virtual time, with
 * system calls that take 15 us each, as in a slow guest: half of them look like POSEs of the left hand
 * and fail the check, half have ids of nobody. Beside it the same run without a flood. */
#include "tests/lib/test.h"
#include "tests/sim/sys_session.h"

enum {
  TICKS = 3000,
  FLOOD_US = 50,
  CALL_NS = 15000,
  READS_MAX = 20, /* 10 of the flood, 2 poses, echoes: SYNC, 2 FORCE, STATUS; and some to spare */
  AHEAD_NS = 3000000
};

static uint64_t seed;
static uint32_t damaged, foreign;
static int64_t next_flood_ns;

typedef struct {
  uint32_t reads_most, without, older, halted;
  int64_t late_most_ns;
} outcome;

static void begin(void) {
  CHECK(sys_session_begin(CALL_NS));
  next_flood_ns = sys.now_ns;
  damaged = foreign = 0;
  seed = 7;
}

/* What comes until well after the next tick. */
static void flood(void) {
  for (; next_flood_ns < sys.now_ns + AHEAD_NS; next_flood_ns += FLOOD_US * 1000) {
    const uint64_t bits = splitmix64(&seed);
    fray_pose pose;
    frame f = {0};
    f.length = 8;
    memcpy(f.data, &bits, 8);
    f.id = dictionary_id(MESSAGE_POSE_LEFT, 0);
    if (codec_decode_pose(&f, 0, 0, &pose) == CODEC_OK) f.data[0] ^= 1u;
    const int is_foreign = next_flood_ns / 1000 / FLOOD_US % 2 != 0;
    if (is_foreign) f.id = 0x400u + (uint32_t)(bits & 0xFFu);
    if (next_flood_ns < sys.now_ns) continue;
    damaged += !is_foreign;
    foreign += is_foreign != 0;
    sys_inject(&f, next_flood_ns - sys.now_ns);
  }
}

static outcome run(int flooded) {
  outcome o = {0, 0, 0, 0, 0};
  begin();
  for (uint32_t tick = 0; tick < TICKS; ++tick) {
    const uint64_t before = sys.reads;
    const uint8_t answered = sys.counter; /* what the device said after the SYNC before this one */
    if (flooded) flood();
    CHECK_EQ_INT(loop_run(&l), LOOP_TICKED);
    const uint32_t reads = (uint32_t)(sys.reads - before);
    if (reads > o.reads_most) o.reads_most = reads;
    o.halted += l.output.state == FRAY_SAFE;
    if (tick == 0) continue;
    o.without += l.input.has_pose != 3;
    for (uint32_t h = 0; h < FRAY_HANDS; ++h) o.older += l.input.pose[h].counter != answered;
  }
  o.late_most_ns = linux_board.timer.worst_ns;
  CHECK_EQ_INT(l.overruns, 0);
  CHECK_EQ_INT(l.bus_losses, 0);
  CHECK_EQ_INT(o.without + o.older + o.halted, 0);
  return o;
}

/* Each frame that the interface gave is in one counter. */
static void counters_fit(void) {
  const port_statistics *p = &l.in.statistics;
  uint32_t ahead = 0;
  for (uint32_t n = sys.rx_taken; n < sys.rx_count; ++n) {
    fray_pose pose;
    const int is_left = sys.rx[n].f.id == dictionary_id(MESSAGE_POSE_LEFT, 0);
    ahead += is_left && codec_decode_pose(&sys.rx[n].f, 0, 0, &pose) != CODEC_OK;
  }
  CHECK_EQ_INT(p->wrong_crc, damaged - ahead);
  CHECK_EQ_INT(p->accepted, 2 * (TICKS - 1));
  CHECK_EQ_INT(p->repeated + p->lost + p->wrong_length + p->wrong_flags + p->wrong_field, 0);
  CHECK_EQ_INT(p->queue_full, 0);
  CHECK_EQ_INT(p->unknown_id, 0); /* the filters keep them out */
}

static void flooded_or_not(void) {
  const outcome quiet = run(0);
  board_close(0);
  const outcome o = run(1);
  counters_fit();
  board_close(0);
  CHECK(damaged > 9 * TICKS && foreign > 9 * TICKS);
  CHECK(o.reads_most <= READS_MAX);
  CHECK(o.late_most_ns == quiet.late_most_ns);
  figure("sys_flood_frames", damaged + foreign, "", "20 a tick, 3000 ticks");
  figure("sys_flood_reads_worst", o.reads_most, "a tick", "20; quiet 6");
  figure("sys_flood_reads_worst_quiet", quiet.reads_most, "a tick", "beside it");
  figure("sys_flood_foreign_ids_read", l.in.statistics.unknown_id, "", "0");
  figure("sys_flood_poses_later", o.older + o.without, "of 5998", "none later than the next tick");
  figure("sys_flood_late_more", (double)(o.late_most_ns - quiet.late_most_ns) / 1e3, "us", "0");
}

int main(void) {
  TEST(prepare);
  TEST(flooded_or_not);
  return sys_session_end();
}
