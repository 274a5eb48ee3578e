/* SPDX-License-Identifier: Apache-2.0 */
/* Every order of commands, with and without poses, against a model of rt/fray.h's words about states:
 * all sequences of STEPS steps, each step one tick, from several places; and shorter ones of longer
 * steps, in which hands arm and fall silent. */
#include <stdlib.h>

#include "tests/lib/state_model.h"
#include "tests/lib/test.h"
#include "tests/sim/sim_session.h"

enum { STEPS = 5, LONG_STEPS = 3, LONG_TICKS = 17, VERBS = 7 };

static const uint8_t verbs[VERBS] = {FRAY_COMMAND_NONE,  FRAY_COMMAND_START, FRAY_COMMAND_STOP, FRAY_COMMAND_RESET,
                                     FRAY_COMMAND_ZERO, FRAY_COMMAND_HALT,  MODEL_UNKNOWN_VERB};

static fixture f;
static state_model now;
static uint64_t ticks_tried, dark_forces, shown, forces_seen;
static int32_t reach; /* each hand's way out */

static void complain(const char *what, long long is, long long expected) {
  ++test_bad_checks;
  if (shown++ < 10) printf("tick %llu: %s %lld, expected %lld\n", (unsigned long long)f.facts.tick, what, is, expected);
}

static void step(uint8_t verb, int has_poses) {
  const int32_t at[FRAY_HANDS][3] = {{-reach, 0, 0}, {reach, 0, 0}};
  fray_input input = fixture_poses(&f, at, now.good[0]);
  if (!has_poses) input.has_pose = 0;
  input.command = verb;
  input.command_counter = 5;
  const fray_output o = fixture_tick(&f, &input);
  const fray_result result = state_model_tick(&now, has_poses ? 3 : 0, verb);
  ++ticks_tried;
  if (o.state != now.state) complain("state", o.state, now.state);
  if (o.faults != now.faults) complain("faults", o.faults, now.faults);
  if (o.answered != verb) complain("acked", o.answered, verb);
  if (o.result != result) complain("result", o.result, result);
  if (verb != FRAY_COMMAND_NONE && o.answer_counter != 5) complain("counter", o.answer_counter, 5);
  if (now.since_up == 0 && f.w->state->ramp == 0) complain("no force let out in state", o.state, 0);
  if (session_force_is_zero(&o)) return;
  ++forces_seen;
  if (now.since_up < MODEL_FADE) return;
  ++dark_forces;
  complain("force without a right to it, ticks", now.since_up, 0);
}

/* A world is the memory it was opened in: a copy of it is the world at that tick. */
static void walk(uint32_t depth, uint32_t ticks, void *const *saves) {
  if (depth == 0) return;
  const state_model before = now;
  memcpy(saves[depth], f.memory, f.memory_bytes);
  for (uint32_t n = 0; n < 2 * VERBS; ++n) {
    step(verbs[n / 2], n % 2 == 0);
    for (uint32_t more = 1; more < ticks; ++more) step(FRAY_COMMAND_NONE, n % 2 == 0);
    walk(depth - 1, ticks, saves);
    memcpy(f.memory, saves[depth], f.memory_bytes);
    now = before;
  }
}

/* Where the walks begin. `verb` ends the way there. */
static void go_to(uint32_t poses, int start, uint8_t verb, int loaded) {
  session_scene(&f, 4, 1, "100");
  memset(&now, 0, sizeof now);
  now.state = FRAY_READY;
  now.since_up = MODEL_FADE;
  reach = 0;
  if (start) step(FRAY_COMMAND_START, 1);
  for (uint32_t n = 0; n < poses; ++n) {
    if (loaded && n > 20 && n % 4 == 0) reach += 1;
    step(FRAY_COMMAND_NONE, 1);
  }
  if (verb != FRAY_COMMAND_NONE) step(verb, 1);
}

static void walk_from(const char *name, uint32_t depth, uint32_t ticks) {
  void *saves[STEPS + 1];
  const uint64_t before = ticks_tried;
  for (uint32_t n = 0; n <= STEPS; ++n) {
    saves[n] = malloc(f.memory_bytes);
    if (saves[n] == NULL) fixture_give_up("walk", "out of memory");
  }
  walk(depth, ticks, saves);
  for (uint32_t n = 0; n <= STEPS; ++n) free(saves[n]);
  printf("  from %-28s %u steps of %2u ticks: %8llu ticks\n", name, depth, ticks,
         (unsigned long long)(ticks_tried - before));
  fixture_close(&f);
}

static void every_order_of_commands(void) {
  go_to(0, 0, FRAY_COMMAND_NONE, 0);
  walk_from("a new world", STEPS, 1);
  go_to(MODEL_ARM - 3, 1, FRAY_COMMAND_NONE, 0);
  walk_from("START, two poses short", STEPS, 1);
  go_to(200, 1, FRAY_COMMAND_NONE, 1);
  CHECK_EQ_INT(now.state, FRAY_OPERATIONAL);
  walk_from("OPERATIONAL under force", STEPS, 1);
  go_to(200, 1, FRAY_COMMAND_ZERO, 1);
  walk_from("ZERO, force fading", STEPS, 1);
  go_to(200, 1, FRAY_COMMAND_STOP, 1);
  walk_from("STOP, force fading", STEPS, 1);
  go_to(200, 1, FRAY_COMMAND_HALT, 1);
  CHECK_EQ_INT(now.state, FRAY_SAFE);
  walk_from("SAFE, force fading", STEPS, 1);
}

/* Long enough a step to arm the hands, to find them stale, and to fade. */
static void every_order_of_long_steps(void) {
  go_to(0, 0, FRAY_COMMAND_NONE, 0);
  walk_from("a new world", LONG_STEPS + 1, LONG_TICKS);
  go_to(200, 1, FRAY_COMMAND_NONE, 1);
  walk_from("OPERATIONAL under force", LONG_STEPS + 1, LONG_TICKS);
  go_to(200, 1, FRAY_COMMAND_HALT, 1);
  walk_from("SAFE, force fading", LONG_STEPS, LONG_TICKS);
  CHECK(forces_seen > 1000);
  CHECK_EQ_INT(dark_forces, 0);
  figure("state_ticks_tried", (double)ticks_tried, "ticks", "every order to length 5");
  figure("state_ticks_with_force", (double)forces_seen, "ticks", "some");
  figure("state_forces_without_right", (double)dark_forces, "", "0");
}

int main(void) {
  TEST(every_order_of_commands);
  TEST(every_order_of_long_steps);
  return test_end();
}
