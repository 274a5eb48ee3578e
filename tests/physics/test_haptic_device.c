/* SPDX-License-Identifier: Apache-2.0 */
/* When a hand may feel anything: states, verbs, poses, ramps, the last stage's clamp and rate.
 * The expected state comes from a model that is written here from the words of rt/fray.h and
 * DESIGN.md section 5, not from haptics/haptic_device.c. */
#include "tests/lib/state_model.h"
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"

/* A heavy small sheet between two hands: at rest each carries some 90 mN. */
static void open_pair(fixture *f, const char *hands) {
  fixture_print(f,
                "scene pair\nrate 1000 Hz\nsubsteps 2\niterations 1\nseed 3\n%s"
                "woven {\n warps 4\n wefts 4\n spacing 12 /cm\n density 100 g/cm2\n tear off\n"
                " structural 100000 g/s2\n drag 20 /s\n}\n"
                "sphere left {\n radius 0.05 cm\n at -0.125 0.125 0 cm\n move hand left\n"
                " attach_within 0.01 cm\n}\n"
                "sphere right {\n radius 0.05 cm\n at 0.125 0.125 0 cm\n move hand right\n"
                " attach_within 0.01 cm\n}\n",
                hands);
}

static fray_output tick_with(fixture *f, uint8_t has_pose, uint8_t verb) {
  static const int32_t origin[FRAY_HANDS][3];
  static uint32_t count;
  fray_input input = fixture_poses(f, origin, count++);
  input.has_pose = has_pose;
  input.command = verb;
  input.command_counter = (uint8_t)(count & 15u);
  return fixture_tick(f, &input);
}

static int32_t largest_force(const fray_output *out) {
  int32_t most = 0;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    for (uint32_t n = 0; n < 3; ++n)
      most = fx_max(most, (int32_t)fx_magnitude(out->force[h][n]));
  return most;
}

/* ---- by hand ---- */

static void no_force_before_start(void) {
  fixture_scoped f = {0};
  open_pair(&f, "");
  for (uint32_t tick = 0; tick < 200; ++tick) {
    const fray_output out = tick_with(&f, 3, FRAY_COMMAND_NONE);
    CHECK_EQ_INT(out.state, FRAY_READY);
    CHECK_EQ_INT(largest_force(&out), 0);
    if (tick == 199) CHECK(out.force_unlimited[0][1] < -50 && out.force_unlimited[1][1] < -50);
  }
}

/* START at once, poses from then: the 16th makes it OPERATIONAL. A gap starts the count again. */
static void sixteen_poses_in_a_row_arm(void) {
  fixture_scoped f = {0};
  open_pair(&f, "");
  for (uint32_t tick = 0; tick < 15; ++tick) {
    const fray_output out = tick_with(&f, 3, tick == 0 ? FRAY_COMMAND_START : FRAY_COMMAND_NONE);
    CHECK_EQ_INT(out.state, FRAY_READY);
    CHECK_EQ_INT(largest_force(&out), 0);
    CHECK_EQ_INT(out.answered, tick == 0 ? FRAY_COMMAND_START : 0);
    CHECK_EQ_INT(out.result, FRAY_RESULT_OK);
  }
  CHECK_EQ_INT(tick_with(&f, 1, FRAY_COMMAND_NONE).state, FRAY_READY); /* right is late */
  for (uint32_t tick = 0; tick < 15; ++tick)
    CHECK_EQ_INT(tick_with(&f, 3, FRAY_COMMAND_NONE).state, FRAY_READY);
  CHECK_EQ_INT(tick_with(&f, 3, FRAY_COMMAND_NONE).state, FRAY_OPERATIONAL);
}

static void settle(fixture *f) {
  for (uint32_t tick = 0; tick < 300; ++tick) (void)tick_with(f, 3, FRAY_COMMAND_NONE);
}

/* Up in 100 ms, in proportion; the raw force is at rest. */
static void the_force_ramps_up_in_100_ms(void) {
  fixture_scoped f = {0};
  open_pair(&f, "");
  settle(&f);
  for (int32_t tick = 1; tick <= 150; ++tick) {
    const fray_output out = tick_with(&f, 3, tick == 1 ? FRAY_COMMAND_START : FRAY_COMMAND_NONE);
    const double share = fmin(1, tick / 100.0);
    CHECK_EQ_INT(out.state, FRAY_OPERATIONAL);
    for (uint32_t h = 0; h < FRAY_HANDS; ++h)
      for (uint32_t n = 0; n < 3; ++n)
        CHECK(fabs(out.force[h][n] - share * out.force_unlimited[h][n]) <= 0.5 + 1e-3 * abs(out.force_unlimited[h][n]));
    if (tick == 150) figure("hands_force_at_rest", out.force[0][1] * 0.5, "mN", "printed");
  }
}

static uint32_t fading_ticks(fixture *f, uint8_t has_pose) {
  uint32_t ticks = 1; /* the tick that began it counts */
  while (ticks < 50 && f->w->state->ramp > 0) {
    (void)tick_with(f, has_pose, FRAY_COMMAND_NONE);
    ++ticks;
  }
  for (uint32_t n = 0; n < 30; ++n) {
    const fray_output out = tick_with(f, has_pose, FRAY_COMMAND_NONE);
    CHECK_EQ_INT(largest_force(&out), 0);
  }
  return ticks;
}

static void start_up(fixture *f) {
  (void)tick_with(f, 3, FRAY_COMMAND_START);
  settle(f);
}

/* The third tick without a pose of one hand: SAFE, its fault, zero within 10 ticks; START is
 * refused; RESET, then START, then a new ramp. */
static void a_stale_hand_makes_safe(void) {
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    fixture_scoped f = {0};
    open_pair(&f, "");
    settle(&f);
    start_up(&f);
    const uint8_t other = (uint8_t)(2u >> h); /* bit of the hand that goes on */
    fray_output out = tick_with(&f, other, FRAY_COMMAND_NONE);
    CHECK_EQ_INT(out.state, FRAY_OPERATIONAL);
    out = tick_with(&f, other, FRAY_COMMAND_NONE);
    CHECK_EQ_INT(out.state, FRAY_OPERATIONAL);
    CHECK(largest_force(&out) > 50);
    out = tick_with(&f, other, FRAY_COMMAND_NONE);
    CHECK_EQ_INT(out.state, FRAY_SAFE);
    CHECK_EQ_INT(out.faults, h == 0 ? FRAY_FAULT_STALE_LEFT : FRAY_FAULT_STALE_RIGHT);
    const uint32_t ticks = fading_ticks(&f, 3);
    figure(h == 0 ? "hands_fade_left_stale" : "hands_fade_right_stale", ticks, "ticks",
           "at most 10");
    CHECK(ticks <= MODEL_FADE);
    out = tick_with(&f, 3, FRAY_COMMAND_START);
    CHECK_EQ_INT(out.result, FRAY_RESULT_REFUSED);
    CHECK_EQ_INT(out.state, FRAY_SAFE);
    out = tick_with(&f, 3, FRAY_COMMAND_RESET);
    CHECK_EQ_INT(out.result, FRAY_RESULT_OK);
    CHECK_EQ_INT(out.state, FRAY_READY);
    CHECK_EQ_INT(out.faults, 0);
    settle(&f);
    out = tick_with(&f, 3, FRAY_COMMAND_NONE);
    CHECK_EQ_INT(out.state, FRAY_READY);
    CHECK_EQ_INT(largest_force(&out), 0);
    out = tick_with(&f, 3, FRAY_COMMAND_START);
    CHECK_EQ_INT(out.state, FRAY_OPERATIONAL);
    CHECK(largest_force(&out) <= 5);
    settle(&f);
    out = tick_with(&f, 3, FRAY_COMMAND_NONE);
    CHECK(largest_force(&out) > 50);
  }
}

static void stop_and_zero_fade_and_halt_is_zero_at_once(void) {
  static const uint8_t verbs[] = {FRAY_COMMAND_STOP, FRAY_COMMAND_ZERO, FRAY_COMMAND_HALT};
  static const uint8_t states[] = {FRAY_READY, FRAY_OPERATIONAL, FRAY_SAFE};
  static const char *const names[] = {"hands_fade_stop", "hands_fade_zero", "hands_fade_halt"};
  for (uint32_t n = 0; n < 3; ++n) {
    fixture_scoped f = {0};
    open_pair(&f, "");
    settle(&f);
    start_up(&f);
    fray_output out = tick_with(&f, 3, verbs[n]);
    CHECK_EQ_INT(out.result, FRAY_RESULT_OK);
    CHECK_EQ_INT(out.state, states[n]);
    CHECK((largest_force(&out) > 0) == (verbs[n] != FRAY_COMMAND_HALT));
    const uint32_t ticks = fading_ticks(&f, 3);
    figure(names[n], ticks, "ticks", "at most 10; the first is that of the verb");
    CHECK(ticks <= MODEL_FADE);
    if (n == 2) (void)tick_with(&f, 3, FRAY_COMMAND_RESET);
    start_up(&f);
    out = tick_with(&f, 3, FRAY_COMMAND_NONE);
    CHECK_EQ_INT(out.state, FRAY_OPERATIONAL);
    CHECK(largest_force(&out) > 50);
  }
}

/* ---- against a model, over all short sequences ---- */

enum { STEP_TICKS = 20, CHOICES_MAX = 32 };

typedef struct {
  uint8_t verb, has_pose;
} choice;

typedef struct {
  fixture f;
  choice choices[CHOICES_MAX];
  uint32_t count, depth;
  uint8_t *saved[8];
  uint32_t sequences, ticks, with_force;
} walk;

static void step(walk *k, state_model *m, choice c) {
  for (uint32_t tick = 0; tick < STEP_TICKS; ++tick) {
    const uint8_t verb = tick == 0 ? c.verb : (uint8_t)FRAY_COMMAND_NONE;
    const fray_result result = state_model_tick(m, c.has_pose, verb);
    const fray_output out = tick_with(&k->f, c.has_pose, verb);
    const int32_t force = largest_force(&out);
    CHECK_EQ_INT(out.state, m->state);
    CHECK_EQ_INT(out.result, result);
    CHECK_EQ_INT(out.answered, verb);
    CHECK_EQ_INT(out.faults, m->faults);
    if (m->since_up >= MODEL_FADE) CHECK_EQ_INT(force, 0);
    /* never more than the ramp lets out: half a step of rounding, and 1/1000 for the ramp's own */
    int32_t raw = 0;
    for (uint32_t n = 0; n < 6; ++n) raw = fx_max(raw, abs(out.force_unlimited[n / 3][n % 3]));
    CHECK(force <= (m->ramp + 0.001) * raw + 0.5);
    k->with_force += force > 0;
    ++k->ticks;
  }
}

static void descend(walk *k, uint32_t depth, const state_model *m) {
  if (depth == k->depth) {
    ++k->sequences;
    return;
  }
  memcpy(k->saved[depth], k->f.memory, k->f.memory_bytes);
  for (uint32_t n = 0; n < k->count; ++n) {
    state_model own = *m;
    if (n > 0) memcpy(k->f.memory, k->saved[depth], k->f.memory_bytes);
    step(k, &own, k->choices[n]);
    descend(k, depth + 1, &own);
  }
}

static void walk_all(const char *label, uint32_t depth, uint32_t pose_kinds, int unknown) {
  static const uint8_t kinds[] = {3, 0, 1};
  walk k = {0};
  char name[64];
  char asked[96];
  open_pair(&k.f, "");
  for (uint32_t tick = 0; tick < 200; ++tick) (void)tick_with(&k.f, 0, FRAY_COMMAND_NONE);
  for (uint32_t p = 0; p < pose_kinds; ++p) {
    for (uint8_t verb = 0; verb <= FRAY_COMMAND_HALT; ++verb)
      k.choices[k.count++] = (choice){verb, kinds[p]};
    if (unknown) k.choices[k.count++] = (choice){MODEL_UNKNOWN_VERB, kinds[p]};
  }
  k.depth = depth;
  for (uint32_t n = 0; n < depth; ++n) {
    k.saved[n] = malloc(k.f.memory_bytes);
    if (k.saved[n] == NULL) fixture_give_up("walk", "out of memory");
  }
  const state_model start = {FRAY_READY, 0, 0, {0, 0}, {200, 200}, 1000, 0, 0};
  descend(&k, 0, &start);
  snprintf(name, sizeof name, "hands_%s_sequences", label);
  snprintf(asked, sizeof asked, "all as the model; %u ticks, %u with force", k.ticks, k.with_force);
  figure(name, k.sequences, "", asked);
  CHECK(k.with_force > 100);
  CHECK(k.with_force < k.ticks / 2);
  for (uint32_t n = 0; n < depth; ++n) free(k.saved[n]);
  fixture_close(&k.f);
}

static void every_sequence_of_four(void) { walk_all("depth_4", 4, 2, 0); }
static void every_sequence_of_three_with_one_hand_and_unknown_verbs(void) {
  walk_all("depth_3", 3, 3, 1);
}

/* ---- the last stage ---- */

/* Poses thrown about over all of int16: never more than the clamp; never a step of more than the
 * rate, but for the one to zero when a fade ends. */
static void throw_poses(const char *label, const char *hands, int32_t clamp, int32_t rate) {
  fixture_scoped f = {0};
  uint64_t seed = 5;
  int32_t most = 0;
  int32_t most_step = 0;
  int16_t before[FRAY_HANDS][3] = {{0}};
  char name[64];
  char asked[64];
  open_pair(&f, hands);
  CHECK_EQ_INT(f.w->params->force_clamp, clamp);
  CHECK_EQ_INT(f.w->params->force_rate, rate);
  (void)fixture_start_hands(&f, 150);
  memcpy(before, (int16_t[FRAY_HANDS][3]){{0}}, sizeof before);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    for (uint32_t n = 0; n < 3; ++n) before[h][n] = (int16_t)f.w->state->hand[h].sent[n];
  for (uint32_t tick = 0; tick < 4000; ++tick) {
    fray_input input = fixture_idle;
    input.has_pose = tick % 1000 < 980 ? 3 : 0;
    if (tick % 1000 == 995) input.command = FRAY_COMMAND_RESET;
    if (tick % 1000 == 0 && tick > 0) input.command = FRAY_COMMAND_START;
    for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
      const uint64_t r = splitmix64(&seed);
      const int corner = tick / 500 % 2 == 0; /* extremes, then anything */
      int16_t v[3];
      for (uint32_t n = 0; n < 3; ++n)
        v[n] = (int16_t)(corner ? (r >> n & 1 ? INT16_MAX : INT16_MIN)
                                : (int16_t)(r >> 16 * n & 0xFFFFu));
      input.pose[h] = (fray_pose){v[0], v[1], v[2], (uint8_t)(tick & 15u), 0};
    }
    const fray_output out = fixture_tick(&f, &input);
    for (uint32_t h = 0; h < FRAY_HANDS; ++h)
      for (uint32_t n = 0; n < 3; ++n) {
        const int32_t moved = abs(out.force[h][n] - before[h][n]);
        before[h][n] = out.force[h][n];
        most = fx_max(most, abs(out.force[h][n]));
        if (f.w->state->ramp == 0) {
          CHECK_EQ_INT(out.force[h][n], 0);
        } else {
          most_step = fx_max(most_step, moved);
        }
      }
  }
  snprintf(name, sizeof name, "hands_%s_largest_force", label);
  snprintf(asked, sizeof asked, "at most %d", clamp);
  figure(name, most, "0.5_mN", asked);
  CHECK(most <= clamp);
  CHECK(most > clamp / 4);
  snprintf(name, sizeof name, "hands_%s_largest_step", label);
  snprintf(asked, sizeof asked, "at most %d", rate);
  figure(name, most_step, "0.5_mN", asked);
  CHECK(most_step <= rate);
  CHECK(most_step > rate / 2);
}

static void extreme_poses_stay_within_clamp_and_rate(void) {
  throw_poses("8N", "hands {\n force_limit 8 N\n force_rate 4 N/ms\n}\n", 16000, 8000);
  throw_poses("1N", "hands {\n force_limit 1 N\n force_rate 0.05 N/ms\n}\n", 2000, 100);
}

int main(void) {
  TEST(no_force_before_start);
  TEST(sixteen_poses_in_a_row_arm);
  TEST(the_force_ramps_up_in_100_ms);
  TEST(a_stale_hand_makes_safe);
  TEST(stop_and_zero_fade_and_halt_is_zero_at_once);
  TEST(every_sequence_of_four);
  TEST(every_sequence_of_three_with_one_hand_and_unknown_verbs);
  TEST(extreme_poses_stay_within_clamp_and_rate);
  return test_end();
}
