/* SPDX-License-Identifier: Apache-2.0 */
/* A session over the two controllers of the board: the runtime on CAN 0, the device on CAN 1. The
 * first word that the program is started with names what goes wrong. Prints `key value` lines, then
 * the log of the bus. */
#include "platform/loop.h"
#include "platform/platform.h"
#include "platform/zcu102/board.h"
#include "platform/zcu102/can.h"
#include "platform/zcu102/console.h"
#include "platform/zcu102/semihost.h"
#include "tests/determinism/cases.h"
#include "tests/target/zcu102/device.h"
#include "tests/target/zcu102/recorder.h"
#include "tests/target/zcu102/wire.h"

enum { WORLD_BYTES = 64 * 1024, WORD = 32, ATTEMPTS = 10000, LATE_LOSSES = 10, QUIET_US = 2000 };

static const device_plan plans[] = {
    {.name = "session", .ticks = 800},
    {.name = "silent", .ticks = 600, .silent_from = 330, .silent_for = 40},
    {.name = "flood", .ticks = 500, .flood_at = 330},
    {.name = "off", .ticks = 600, .off_from = 330, .off_us = 21300, .off_base = CAN0_BASE},
    {.name = "late", .ticks = 600, .off_from = 330, .off_base = CAN0_BASE},
    {.name = "alone", .ticks = 600, .off_from = 330, .off_us = 21300, .off_base = CAN1_BASE},
    {.name = "full"},
    {.name = "stack"},
    {.name = "flash"},
};

static _Alignas(FRAY_ALIGN) uint8_t memory[WORLD_BYTES];
static loop runtime;

/* Ticks are counted from 1 here: 0 is never. */
static struct {
  uint32_t operational, safe, force, quiet; /* the first; quiet: after the last force */
  uint32_t again;                           /* OPERATIONAL once more, after SAFE */
  uint32_t peak;
} seen;

static int same_word(const char *a, const char *b) {
  while (*a != 0 && *a == *b) ++a, ++b;
  return *a == *b;
}

static const device_plan *find_plan(void) {
  char word[WORD];
  semihost_arguments(word, sizeof word);
  for (uint32_t n = 0; n < sizeof plans / sizeof plans[0]; ++n)
    if (same_word(word, plans[n].name)) return &plans[n];
  return 0;
}

static uint32_t largest_force(const fray_output *o) {
  uint32_t most = 0;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    for (uint32_t n = 0; n < 3; ++n) {
      const int32_t v = o->force[h][n];
      const uint32_t size = (uint32_t)(v < 0 ? -v : v);
      if (size > most) most = size;
    }
  return most;
}

static void look(const fray_output *o) {
  const uint32_t tick = (uint32_t)o->tick + 1u;
  const uint32_t force = largest_force(o);
  if (o->state == FRAY_OPERATIONAL && seen.operational == 0) seen.operational = tick;
  if (o->state == FRAY_OPERATIONAL && seen.safe != 0 && seen.again == 0) seen.again = tick;
  if (o->state == FRAY_SAFE && seen.safe == 0) seen.safe = tick;
  if (o->state == FRAY_SAFE && force != 0) seen.quiet = tick + 1u;
  if (force != 0 && seen.force == 0) seen.force = tick;
  if (force > seen.peak) seen.peak = force;
}

static void print(const char *key, uint64_t value) {
  platform_print(key);
  platform_print(" ");
  console_number(value, 1);
  platform_print("\n");
}

static void print_runtime(void) {
  print("ticks", runtime.tick);
  print("cuts", runtime.output.tears_total);
  print("faults", runtime.output.faults);
  print("state", runtime.output.state);
  print("operational", seen.operational);
  print("force", seen.force);
  print("peak", seen.peak);
  print("safe", seen.safe);
  print("quiet", seen.quiet);
  print("again", seen.again);
  print("overruns", runtime.overruns);
  print("losses", runtime.bus_losses);
  print("accepted", runtime.in.statistics.accepted);
  print("wrong_crc", runtime.in.statistics.wrong_crc);
}

static void print_board(void) {
  print("worst_us", zcu102_board.grid.worst_us);
  print("overflows", zcu102_board.overflows);
  print("dropped", zcu102_board.sends_dropped);
  print("late", zcu102_board.late);
  print("drained", zcu102_board.drained_most);
  print("stack", board_stack_used());
  print("stack_bytes", board_stack_bytes());
  print("unexpected", zcu102_board.unexpected);
  print("early", wire_early());
  print("crossed", wire_crossed());
  print("busy_us", wire_busy_us());
  print("syncs", device_felt.syncs);
  print("forces", device_felt.forces);
  print("bad", device_felt.bad);
  print("gaps", device_felt.gaps);
  print("off_tick", device_felt.off_tick);
  print("zeroed", device_felt.zeroed);
  print("zeroed_us", device_felt.zeroed_us);
}

static int open_world(fray_world **world) {
  const replay_case *c = &replay_cases[0];
  fray_error error;
  const fray_status status =
      fray_open(c->image, c->image_bytes, memory, sizeof memory, world, &error);
  if (status == FRAY_OK) return 1;
  platform_print("refused: ");
  platform_print(error.what);
  platform_print("\n");
  return 0;
}

static int run(const device_plan *plan) {
  fray_world *world;
  if (!open_world(&world)) return 1;
  loop_begin(&runtime, world, 0);
  simulated_device_begin(plan, replay_cases[0].inputs, replay_cases[0].input_count);
  board_open(0, fray_get_info(world).rate_hz);
  for (uint32_t n = 0; n < ATTEMPTS && runtime.tick < plan->ticks; ++n) {
    if (loop_run(&runtime) == LOOP_TICKED) look(&runtime.output);
    /* between two tries of a SYNC: it goes out while nobody waits for it */
    if (plan->off_us == 0 && runtime.bus_losses == LATE_LOSSES) can_join(plan->off_base);
  }
  (void)loop_close(&runtime);
  zcu102_board.stopping = 1;
  const int stopped = loop_run(&runtime) == LOOP_STOPPED;
  timer_sleep(timer_now() + timer_counts(QUIET_US), 0);
  print_runtime();
  print_board();
  platform_print("hash ");
  console_hex(runtime.output.hash, 16);
  platform_print("\n");
  return recorder_print() && stopped ? 0 : 1;
}

/* More than the controller can hold while it is off the bus. */
static int fill(const device_plan *plan) {
  static const frame f = {.id = FRAME_ID_MAX, .length = FRAME_DATA_CLASSIC};
  uint32_t sent = 0;
  simulated_device_begin(plan, replay_cases[0].inputs, replay_cases[0].input_count);
  board_open(0, 1000);
  can_leave(CAN0_BASE);
  for (uint32_t n = 0; n < DEVICE_FLOOD; ++n) sent += platform_send(&f) == PLATFORM_SENT;
  print("sent", sent);
  print("dropped", zcu102_board.sends_dropped);
  can_join(CAN0_BASE);
  print("again", platform_send(&f) == PLATFORM_SENT);
  return 0;
}

static uint32_t dig(volatile uint32_t depth) {
  return depth == 0 ? 0 : dig(depth - 1u) + depth;
}

int main(void) {
  const device_plan *plan = find_plan();
  if (plan == 0) {
    platform_print("expected one word, the name of a plan\n");
    return 2;
  }
  if (same_word(plan->name, "stack")) return (int)dig(1u << 20);
  if (same_word(plan->name, "flash")) {
    *(volatile uint8_t *)(uintptr_t)replay_cases[0].image = 0;
    return 1;
  }
  return same_word(plan->name, "full") ? fill(plan) : run(plan);
}
