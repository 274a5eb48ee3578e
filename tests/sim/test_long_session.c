/* SPDX-License-Identifier: Apache-2.0 */
/* Sessions across 2^26, 2^31 and 2^32 ticks: SYNC has the low word, a hand that falls silent across it is found
 * silent, and the log replays. Counters of the loop saturate. */
#include "tests/lib/set_tick.h"
#include "tests/lib/test.h"
#include "tests/sim/session_replay.h"

enum { BEFORE = 200, TICKS = 400, SILENT_FROM = 198, STALE_TICKS = 3 };

static session s;

static void begin_at(uint64_t tick) {
  fixture_scoped f = {0};
  session_under_force(&f);
  set_tick(f.w, tick);
  fixture_copy(&s.f, &f);
  session_begin(&s);
  session_ticks = 0;
  s.apart = 0;
}

static void check_syncs(uint64_t start) {
  uint32_t count = 0;
  for (size_t n = 0; n < sim.count; ++n) {
    codec_sync sync;
    if (!sim.entries[n].own || codec_decode_sync(&sim.entries[n].f, 0, &sync) != CODEC_OK) continue;
    CHECK_EQ_INT(sync.tick, (uint32_t)((start + count) & UINT32_MAX));
    ++count;
  }
  CHECK_EQ_INT(count, TICKS);
}

static void across(uint64_t wrap) {
  const uint64_t start = wrap - BEFORE;
  uint32_t safe = 0, forces = 0;
  int loaded = 0;
  candump_log log;
  begin_at(start);
  session_poses(&s);
  session_command(&s, FRAY_COMMAND_START);
  for (uint32_t n = 0; n < TICKS; ++n) {
    s.apart = (int16_t)(n < 20 ? 0 : n < 220 ? n - 20 : 200);
    s.silent = n >= SILENT_FROM ? 1 : 0;
    CHECK_EQ_INT(session_hashed_tick(&s), LOOP_TICKED);
    session_poses(&s);
    CHECK(s.l.output.tick == start + n && s.l.tick == start + n + 1u);
    if (n == SILENT_FROM) loaded = !session_force_is_zero(&s.l.output);
    forces += !session_force_is_zero(&s.l.output);
    if (safe == 0 && s.l.output.state == FRAY_SAFE) safe = n;
  }
  CHECK_EQ_INT(safe, SILENT_FROM + STALE_TICKS); /* the pose of the tick before is used in SILENT_FROM */
  CHECK_EQ_INT(s.l.output.faults, FRAY_FAULT_STALE_LEFT);
  CHECK(forces > 50 && loaded && session_force_is_zero(&s.l.output));
  check_syncs(start);
  session_end_log(&s, &log);
  CHECK_EQ_INT(session_replay(&s, &log), 0);
  fixture_close(&s.f);
  sim_end();
}

static void sessions_across(void) {
  across(UINT64_C(1) << 26);
  across(UINT64_C(1) << 31);
  across(UINT64_C(1) << 32);
}

static void counters_saturate(void) {
  begin_at(0);
  s.l.overruns = s.l.bus_losses = s.l.frames_lost = UINT32_MAX - 1u;
  (void)session_tick(&s);
  for (uint32_t n = 0; n < 3; ++n) {
    sim.now_us += 5 * sim.period_us;
    sim.send_fails = 4;
    (void)session_tick(&s);
    sim.sync_fails = 1;
    (void)session_tick(&s);
  }
  CHECK(s.l.overruns == UINT32_MAX && s.l.bus_losses == UINT32_MAX && s.l.frames_lost == UINT32_MAX);
  CHECK_EQ_INT(s.l.out.overruns, 65535);
  fixture_close(&s.f);
  sim_end();
}

int main(void) {
  TEST(sessions_across);
  TEST(counters_saturate);
  return test_end();
}
