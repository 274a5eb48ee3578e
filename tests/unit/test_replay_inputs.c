/* SPDX-License-Identifier: Apache-2.0 */
/* Poses with counters as a bad bus and a bad device make them go through a port, a log of that bus
 * through a replay: every tick gets the same pose from both. */
#include "rt/wire/codec.h"
#include "rt/wire/port.h"
#include "tests/lib/test.h"
#include "tools/recording/replay.h"

enum { SESSIONS = 2000, TICKS = 100, POSES = 12, BEFORE = 64, ENTRIES = TICKS * (POSES + 2) + BEFORE + 1 };

static candump_entry entries[ENTRIES];
static candump_log log_of_bus;
static fray_input taken[TICKS];
static uint64_t seed;
static port p;
static long poses_taken;

static uint32_t random_below(uint32_t n) {
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (uint32_t)(seed >> 33) % n;
}

static frame *add_entry(void) {
  candump_entry *e = &entries[log_of_bus.count];
  memset(e, 0, sizeof *e);
  log_of_bus.count += 1;
  e->line = (int)log_of_bus.count;
  return &e->frame;
}

/* Mostly the next counter; else any, by as much as `disorder` in 100 says. */
static void say_poses(uint8_t *counter, uint32_t disorder, uint32_t most) {
  const uint32_t count = random_below(3) == 0 ? random_below(most + 1) : 1;
  for (uint32_t n = 0; n < count; ++n) {
    frame *f = add_entry();
    *counter = (uint8_t)((*counter + (random_below(100) < disorder ? random_below(16) : 1)) & 15u);
    const fray_pose pose = {(int16_t)log_of_bus.count, 0, 0, *counter, 0};
    codec_encode_pose(f, 0, 0, &pose);
    if (random_below(100) < disorder) f->data[2] ^= 1;
    port_push(&p, f);
  }
}

/* `before`: so many poses that the log has, from a time when there was no port. */
static void record_session(uint32_t disorder, uint32_t before) {
  uint8_t counter = 0, consumed = 0;
  log_of_bus.entries = entries;
  log_of_bus.count = 0;
  for (uint32_t n = 0; n < before; ++n) {
    counter = (uint8_t)((counter + 1u) & 15u);
    const fray_pose pose = {(int16_t)(-1 - (int)n), 0, 0, counter, 0};
    codec_encode_pose(add_entry(), 0, 0, &pose);
  }
  port_init(&p, 0, 1, NULL);
  for (uint32_t tick = 0; tick < TICKS; ++tick) {
    say_poses(&counter, disorder, before == 0 ? POSES : 3);
    port_take(&p, &taken[tick]);
    const codec_sync sync = {tick, 0};
    codec_encode_sync(add_entry(), 0, &sync);
    if (taken[tick].has_pose) consumed = taken[tick].pose[0].counter;
    poses_taken += taken[tick].has_pose;
    const codec_force force = {0, 0, 0, (uint8_t)(tick & 15u), consumed};
    codec_encode_force(add_entry(), 0, 0, &force);
  }
  codec_encode_sync(add_entry(), 0, &(codec_sync){TICKS, 0});
}

static void is_found(void) {
  static const replay_setting LEFT = {0, 1, 1000, 0, {0, 0}, 0, 0};
  replay run;
  candump_error error;
  const int good = replay_read("r.log", &log_of_bus, &LEFT, &run, &error);
  CHECK(good);
  if (!good) return;
  CHECK_EQ_INT(run.count, TICKS);
  for (uint32_t n = 0; n < run.count; ++n) {
    CHECK_EQ_INT(run.ticks[n].input.has_pose, taken[n].has_pose);
    CHECK_EQ_INT(run.ticks[n].input.pose[0].x, taken[n].pose[0].x);
  }
  replay_free(&run);
}

/* What waits for a later tick stands before its SYNC all the same, so only the tick may differ. */
static void what_a_port_took_is_found(void) {
  for (uint32_t session = 0; session < SESSIONS; ++session) {
    seed = session;
    record_session(session % 50, 0);
    is_found();
  }
}

/* A device that ran free before the runtime came: the same counters stand in the log before. */
static void what_was_said_before_is_not_taken(void) {
  for (uint32_t before = 0; before <= BEFORE - 1; ++before) {
    seed = before;
    record_session(0, before);
    is_found();
  }
}

int main(void) {
  TEST(what_a_port_took_is_found);
  TEST(what_was_said_before_is_not_taken);
  printf("figure replay_inputs %ld poses in %d sessions, 0 to 49 %% of the counters at random\n",
         poses_taken, SESSIONS);
  return test_end();
}
