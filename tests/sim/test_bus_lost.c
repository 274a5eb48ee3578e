/* SPDX-License-Identifier: Apache-2.0 */
/* A SYNC without a confirmation: no tick, no force, the same SYNC again; then HALT over the bus, SAFE,
 * RESET, START. And the recording of all that, as the bus saw it, gives the same hashes. */
#include <stdlib.h>

#include "tests/lib/test.h"
#include "tests/sim/session_replay.h"

static session s;
static uint32_t losses;

static loop_result one_tick(void) {
  const loop_result result = session_hashed_tick(&s);
  session_poses(&s);
  return result;
}

static void begin(void) {
  session_scene(&s.f, 8, 4, "0.25");
  session_begin(&s);
  session_ticks = 0;
  losses = 0;
}

static void end(void) {
  fixture_close(&s.f);
  sim_end();
}

static void start(int16_t apart) {
  session_command(&s, FRAY_COMMAND_START);
  for (int32_t n = 0; n < 160; ++n) {
    s.apart = (int16_t)(n < 20 ? 0 : apart * (n - 20) / 160);
    CHECK_EQ_INT(one_tick(), LOOP_TICKED);
  }
  CHECK_EQ_INT(s.l.output.state, FRAY_OPERATIONAL);
  CHECK(!session_force_is_zero(&s.l.output));
}

static void begin_under_force(void) {
  begin();
  session_poses(&s);
  start(60);
}

/* `count` SYNCs are lost; `seen`: they are on the bus, and only nobody said so. */
static void lose(uint32_t count, uint32_t seen) {
  const size_t from = sim.count;
  const uint64_t known = fray_hash(s.f.w);
  const uint64_t tick = fray_get_info(s.f.w).tick;
  sim.sync_fails = count;
  sim.sync_seen = seen;
  s.silent = seen ? 0 : 3;
  for (uint32_t n = 0; n < count; ++n) {
    CHECK_EQ_INT(one_tick(), LOOP_BUS_LOST);
    s.silent = 3; /* an equal SYNC is answered once */
  }
  losses += count;
  CHECK_EQ_INT(s.l.bus_losses, losses);
  CHECK(fray_hash(s.f.w) == known);
  CHECK_EQ_INT(fray_get_info(s.f.w).tick, tick);
  for (size_t n = from; n < sim.count; ++n) {
    const sim_entry *e = &sim.entries[n];
    codec_sync sync;
    if (!e->own || (tick == 0 && n == from && e->f.id == dictionary_id(MESSAGE_IDENTITY, 0))) continue;
    CHECK_EQ_INT(codec_decode_sync(&e->f, 0, &sync), CODEC_OK); /* nothing else is sent */
    CHECK_EQ_INT(sync.tick, tick);
    CHECK(sync.hash == (uint32_t)(known & 0xFFFFFFFFu));
  }
  CHECK_EQ_INT(sim_own(from, dictionary_id(MESSAGE_SYNC, 0), !seen), count);
}

/* The bus is back: the tick's own frames are SYNC as before, COMMAND HALT, FORCE, FORCE, ACK, and STATUS
 * if the state or the faults are other ones. */
static void comes_back(void) {
  static const dictionary_message expected[] = {MESSAGE_SYNC,        MESSAGE_COMMAND, MESSAGE_FORCE_LEFT,
                                                MESSAGE_FORCE_RIGHT, MESSAGE_ACK,     MESSAGE_STATUS};
  const size_t from = sim.count;
  const uint64_t tick = fray_get_info(s.f.w).tick;
  const uint32_t frames = s.l.output.faults == FRAY_FAULT_HALTED ? 5 : 6;
  const uint32_t known = (uint32_t)(fray_hash(s.f.w) & 0xFFFFFFFFu);
  s.silent = 0;
  CHECK_EQ_INT(one_tick(), LOOP_TICKED);
  uint32_t count = 0;
  for (size_t n = from; n < sim.count && count < 6; ++n)
    if (sim.entries[n].own)
      CHECK_EQ_INT(sim.entries[n].f.id, dictionary_id(expected[count++], 0));
  CHECK_EQ_INT(count, frames);
  codec_sync sync;
  codec_command command;
  CHECK_EQ_INT(codec_decode_sync(&sim.entries[from].f, 0, &sync), CODEC_OK);
  CHECK(sync.tick == tick && sync.hash == known);
  CHECK_EQ_INT(codec_decode_command(&sim.entries[from + 1].f, 0, &command), CODEC_OK);
  CHECK_EQ_INT(command.command, FRAY_COMMAND_HALT);
  CHECK_EQ_INT(s.l.output.answered, FRAY_COMMAND_HALT);
  CHECK_EQ_INT(s.l.output.result, FRAY_RESULT_OK);
  CHECK_EQ_INT(s.l.output.state, FRAY_SAFE);
  CHECK_EQ_INT(s.l.output.faults, FRAY_FAULT_HALTED);
  for (int n = 0; n < 9; ++n) CHECK_EQ_INT(one_tick(), LOOP_TICKED);
  CHECK(session_force_is_zero(&s.l.output));
}

static void leave_safe(void) {
  session_command(&s, FRAY_COMMAND_START);
  CHECK_EQ_INT(one_tick(), LOOP_TICKED);
  CHECK_EQ_INT(s.l.output.result, FRAY_RESULT_REFUSED);
  session_command(&s, FRAY_COMMAND_RESET);
  CHECK_EQ_INT(one_tick(), LOOP_TICKED);
  CHECK_EQ_INT(s.l.output.state, FRAY_READY);
  CHECK_EQ_INT(s.l.output.faults, 0);
}

static void replays(void) {
  candump_log log;
  session_end_log(&s, &log);
  const uint32_t bad = session_replay(&s, &log);
  printf("figure bus_lost_ticks_replayed %u of %u (asked: the same hash after each)\n", session_ticks - bad,
         session_ticks);
}

static void save_bytes(const char *path, const void *data, size_t bytes) {
  FILE *const file = fopen(path, "wb");
  CHECK(file != NULL && fwrite(data, 1, bytes, file) == bytes);
  if (file != NULL) CHECK_EQ_INT(fclose(file), 0);
}

/* The same by the command, if there is one. */
static void verifies(void) {
  const char *const command = getenv("FRAY");
  const char *const build = getenv("FRAY_BUILD");
  char log_path[256];
  char image_path[256];
  char line[1024];
  size_t bytes;
  if (command == NULL || build == NULL) return;
  snprintf(log_path, sizeof log_path, "%s/tests/bus_lost.log", build);
  snprintf(image_path, sizeof image_path, "%s/tests/bus_lost.img", build);
  char *const text = sim_log(&bytes);
  save_bytes(log_path, text, bytes);
  save_bytes(image_path, s.f.image, s.f.image_bytes);
  free(text);
  snprintf(line, sizeof line, "%s verify %s --scene %s >/dev/null", command, log_path, image_path);
  fflush(stdout);
  CHECK_EQ_INT(system(line), 0);
}

static void lost_and_back(void) {
  static const uint32_t counts[] = {1, 2, 3, 10, 100};
  begin();
  session_poses(&s);
  for (uint32_t n = 0; n < 10; ++n) {
    start((int16_t)(n % 2 == 0 ? 60 : -60));
    lose(counts[n / 2], n % 2);
    comes_back();
    leave_safe();
  }
  replays();
  verifies();
  printf("figure bus_lost_syncs %u in 10 losses of 1 to 100 (asked: no tick, no FORCE, the same SYNC)\n",
         losses);
  end();
}

/* Before START, and in SAFE: HALT applies there too. */
static void lost_when_idle(void) {
  begin();
  lose(2, 0);
  comes_back();
  lose(2, 1);
  comes_back();
  leave_safe();
  replays();
  end();
}

/* HALT finds the queue full: no tick before it was said. */
static void halt_waits_until_it_was_said(void) {
  begin_under_force();
  lose(1, 0);
  sim.send_fails = 1;
  s.silent = 0;
  CHECK_EQ_INT(one_tick(), LOOP_BUS_LOST);
  comes_back();
  leave_safe();
  replays();
  end();
}

/* An operator's COMMAND in the tick of the loop's own HALT is not taken and has no ACK. */
static void an_operators_command_gives_way(void) {
  begin_under_force();
  lose(1, 0);
  session_command(&s, FRAY_COMMAND_RESET);
  const size_t from = sim.count;
  comes_back();
  CHECK_EQ_INT(sim_own(from, dictionary_id(MESSAGE_ACK, 0), 0), 1);
  CHECK_EQ_INT(s.l.output.state, FRAY_SAFE);
  leave_safe();
  replays();
  end();
}

/* STOP of the program itself, lost bus in between: HALT takes its place, the forces end all the same. */
static void stop_while_lost(void) {
  begin_under_force();
  loop_command(&s.l, FRAY_COMMAND_STOP);
  lose(3, 0);
  comes_back();
  CHECK_EQ_INT(s.l.command, FRAY_COMMAND_NONE);
  replays();
  sim.stop = 1;
  CHECK_EQ_INT(loop_run(&s.l), LOOP_STOPPED);
  end();
}

/* What the board refuses is said in the next tick, and the recording holds. */
static void a_refused_frame_is_said_again(void) {
  begin_under_force();
  for (uint32_t n = 0; n < 40; ++n) {
    const int answered = n == 14;
    if (answered) session_command(&s, FRAY_COMMAND_ZERO);
    if (n % 10 == 4) sim.send_fails = answered ? 3 : 1 + n / 20; /* FORCE, FORCE, ACK */
    CHECK_EQ_INT(one_tick(), LOOP_TICKED);
    CHECK_EQ_INT(s.l.output.answered, answered ? FRAY_COMMAND_ZERO : FRAY_COMMAND_NONE);
    CHECK_EQ_INT(s.l.unsent_count, n % 10 != 4 ? 0 : answered ? 3 : 1 + n / 20);
  }
  CHECK_EQ_INT(s.l.frames_lost, 0);
  replays();
  end();
}

/* A FORCE that is refused twice is not on the bus: the recording cannot be verified, and says where. */
static void a_lost_force_is_named(void) {
  candump_log log;
  candump_error error;
  replay r;
  begin();
  session_poses(&s);
  for (uint32_t n = 0; n < 20; ++n) {
    if (n == 10) sim.send_fails = 3; /* of tick 10 both, and the left one again */
    CHECK_EQ_INT(one_tick(), LOOP_TICKED);
  }
  CHECK_EQ_INT(s.l.frames_lost, 1);
  session_end_log(&s, &log);
  CHECK(!session_read_replay(&s, &log, &r, &error));
  CHECK(strstr(error.message, "expected that of tick 10") != NULL);
  candump_free(&log);
  end();
}

static void refuse_both_forces(void) {
  begin_under_force();
  sim.send_fails = 2;
  CHECK_EQ_INT(one_tick(), LOOP_TICKED);
  CHECK_EQ_INT(s.l.unsent_count, 2);
}

static void nothing_of_before_comes(void) {
  codec_force force;
  const size_t from = sim.count;
  CHECK_EQ_INT(s.l.unsent_count, 0);
  CHECK_EQ_INT(s.l.frames_lost, 2);
  comes_back();
  for (size_t n = from; n < sim.count; ++n)
    if (codec_decode_force(&sim.entries[n].f, 0, 0, &force) == CODEC_OK)
      CHECK_EQ_INT(force.x | force.y | force.z, 0);
}

/* The bus is lost before it could be said again: no force of before comes after. */
static void a_refused_force_is_dropped_with_the_bus(void) {
  refuse_both_forces();
  lose(1, 0);
  nothing_of_before_comes();
  end();
}

/* Nor when the bus is there and HALT has to wait. */
static void a_refused_force_does_not_wait_for_halt(void) {
  refuse_both_forces();
  s.l.halt = 1;
  sim.send_fails = 3; /* HALT, FORCE, FORCE */
  CHECK_EQ_INT(one_tick(), LOOP_BUS_LOST);
  nothing_of_before_comes();
  end();
}

int main(void) {
  TEST(lost_and_back);
  TEST(lost_when_idle);
  TEST(halt_waits_until_it_was_said);
  TEST(an_operators_command_gives_way);
  TEST(stop_while_lost);
  TEST(a_refused_frame_is_said_again);
  TEST(a_lost_force_is_named);
  TEST(a_refused_force_is_dropped_with_the_bus);
  TEST(a_refused_force_does_not_wait_for_halt);
  return test_end();
}
