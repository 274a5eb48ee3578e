/* SPDX-License-Identifier: Apache-2.0 */
/* Poses at the ends of int16, and jumps over the whole range in every tick: what is sent keeps to the
 * clamp and to the rate limit, and the world stays one that the loader takes. */
#include <stdlib.h>

#include "rt/image/state_hash.h"
#include "tests/lib/test.h"
#include "tests/sim/sim_session.h"

enum { JUMPS = 2000, SAVE_EVERY = 100, POINTS = 27, HOLD = 8 };

static fixture f;
static int32_t sent[FRAY_HANDS][3];
static int32_t worst, worst_step;
static uint32_t ticks, saves, at_clamp, cuts;
static uint64_t bad;

static int32_t end_of(uint32_t digit) {
  return digit == 0 ? INT16_MIN : digit == 1 ? 0 : INT16_MAX;
}

static void place(int32_t at[3], uint32_t point) {
  at[0] = end_of(point % 3);
  at[1] = end_of(point / 3 % 3);
  at[2] = end_of(point / 9 % 3);
}

static void look(const fray_output *o) {
  const params *p = f.w->params;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    for (uint32_t n = 0; n < 3; ++n) {
      const int32_t now = o->force[h][n];
      const int32_t change = abs(now - sent[h][n]);
      if (abs(now) > worst) worst = abs(now);
      if (o->state == FRAY_OPERATIONAL && change > worst_step) worst_step = change;
      at_clamp += abs(now) == p->force_clamp;
      bad += abs(now) > p->force_clamp;
      bad += change > p->force_rate;
      sent[h][n] = now;
    }
}

static void tick(uint32_t left, uint32_t right) {
  int32_t at[FRAY_HANDS][3];
  place(at[0], left);
  place(at[1], right);
  const fray_input input = fixture_poses(&f, (const int32_t(*)[3])at, ticks++);
  const fray_output o = fixture_tick(&f, &input);
  look(&o);
  cuts = o.tears_total;
  bad += o.state != FRAY_OPERATIONAL;
}

static void save(void) {
  fixture copy;
  fixture_copy(&copy, &f); /* ends the program if the loader refuses it */
  bad += fray_hash(copy.w) != fray_hash(f.w) || state_hash(copy.w) != state_hash(f.w);
  fixture_close(&copy);
  ++saves;
}

static void begin(void) {
  memset(sent, 0, sizeof sent);
  bad = 0;
  const fray_output o = fixture_start_hands(&f, 160);
  CHECK_EQ_INT(o.state, FRAY_OPERATIONAL);
  look(&o);
  bad = 0;
  ticks = 160;
}

static void end(void) {
  CHECK_EQ_INT(bad, 0);
  fixture_close(&f);
}

/* Both hands at every end of every axis, in all pairs. */
static void every_corner(void) {
  session_scene(&f, 8, 4, "0.25");
  begin();
  for (uint32_t pair = 0; pair < POINTS * POINTS; ++pair) {
    for (uint32_t n = 0; n < HOLD; ++n) tick(pair % POINTS, pair / POINTS);
    if (pair % 16 == 0) save();
  }
  save();
  end();
}

static void jump(void) {
  uint64_t seed = 7;
  begin();
  for (uint32_t n = 0; n < JUMPS; ++n) {
    const uint32_t corner = (uint32_t)(splitmix64(&seed) % 64u);
    const uint32_t left = n % 2 == 0 ? 0 : 26; /* (min,min,min) to (max,max,max) and back */
    const uint32_t right = (corner & 1u) * 2 + (corner >> 1 & 1u) * 6 + (corner >> 2 & 1u) * 18;
    tick(n < JUMPS / 2 ? left : 26 - right, n < JUMPS / 2 ? 26 - left : right);
    if (n % SAVE_EVERY == SAVE_EVERY - 1) save();
  }
  end();
}

static void jumps_of_a_small_sheet(void) {
  session_scene(&f, 8, 4, "0.25");
  jump();
}

/* Heavy enough to be at the clamp. */
static void jumps_of_a_heavy_sheet(void) {
  session_scene(&f, 8, 8, "100");
  at_clamp = 0;
  jump();
  CHECK(at_clamp > 0);
}

/* The scene that tears, as small as it goes. */
static void jumps_that_tear(void) {
  fixture_file(&f, "tests/scenes/two_hands.scene", "warps 80", "warps 16", "wefts 40", "wefts 8",
               "spacing 12 /cm", "spacing 2.4 /cm", "substeps auto", "substeps 8", "settle 1 s",
               "", "max_rest_strain 0.7 %\n", "\n", NULL);
  jump();
  CHECK(cuts > 0);
}

int main(void) {
  TEST(every_corner);
  TEST(jumps_of_a_small_sheet);
  TEST(jumps_of_a_heavy_sheet);
  TEST(jumps_that_tear);
  figure("extreme_force_worst", worst * 0.5e-3, "N", "the clamp, 8");
  figure("extreme_force_change_worst", worst_step * 0.5e-3, "N/ms", "the rate limit, 4");
  figure("extreme_saves_reloaded", saves, "", "all");
  return test_end();
}
