/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts of yarns: momentum to the last bit and energy that only falls, over random sheets; what friction
 * holds, slides and lets go; that places stay in order; and that a break does not jolt. */
#include "tests/lib/test.h"

#include "rt/woven/woven.h"
#include "rt/woven/yarn_slip.h"
#include "tests/lib/yarn_check.h"

enum { WARPS = 8, WEFTS = 8, CROSSINGS = WARPS * WEFTS, SHEETS = 2000 };

static yarn_params *constants_of(const fray_world *w) {
  return (yarn_params *)(uintptr_t)w->woven.yarn_constants;
}

/* A row held along the top; below it one of `in` crossings is split. */
static void open_sheet(fixture *f, uint32_t in, const char *more) {
  fixture_print(f, "scene slip\nrate 1000 Hz\nsubsteps 4\nseed 5\nwoven {\n warps 8\n wefts 8\n"
                   " spacing 12 /cm\n yarns on\n%s}\npin row top\n", more);
  for (uint32_t c = 0; c < CROSSINGS; ++c)
    if (!crossing_is_attached(f->w, c) && c % in == 0) {
      crossing_split(f->w, c, FRAY_LOOSE);
      yarn_slip_begin(f->w, crossing_contact(f->w, c));
    }
}

static int32_t within(uint64_t *seed, int32_t range) {
  return (int32_t)(splitmix64(seed) % (2u * (uint32_t)range + 1u)) - range;
}

static void shake(fray_world *w, uint64_t *seed, int32_t away, int32_t speed) {
  int32_t *const at[3] = {w->p.x, w->p.y, w->p.z};
  int32_t *const q[3] = {w->p.qx, w->p.qy, w->p.qz};
  int32_t *const v[3] = {w->p.vx, w->p.vy, w->p.vz};
  for (uint32_t axis = 0; axis < 3; ++axis)
    for (uint32_t p = 0; p < w->p.count; ++p) {
      const int held = p < particles_attached(w);
      at[axis][p] += held ? 0 : within(seed, away);
      q[axis][p] = held ? at[axis][p] : at[axis][p] + within(seed, speed);
      v[axis][p] = held ? 0 : within(seed, 16 * speed);
    }
}

/* Half crossings x Q28; what bodies gave taken away. */
static void momentum(const fray_world *w, int64_t sum[3]) {
  const int32_t *const at[3] = {w->p.x, w->p.y, w->p.z};
  const int32_t *const q[3] = {w->p.qx, w->p.qy, w->p.qz};
  const int32_t *const v[3] = {w->p.vx, w->p.vy, w->p.vz};
  for (uint32_t axis = 0; axis < 3; ++axis) {
    sum[axis] = -2 * w->rigid.motion[0].impulse[axis];
    for (uint32_t p = particles_attached(w); p < w->p.count; ++p)
      sum[axis] += (particle_is_half(w, p) ? 1 : 2) * (((int64_t)at[axis][p] - q[axis][p]) * 16 + v[axis][p]);
  }
}

/* Of velocities and of what positions were moved by, in half crossings and position steps a substep. */
static double kinetic(const fray_world *w) {
  const int32_t *const at[3] = {w->p.x, w->p.y, w->p.z};
  const int32_t *const q[3] = {w->p.qx, w->p.qy, w->p.qz};
  const int32_t *const v[3] = {w->p.vx, w->p.vy, w->p.vz};
  double sum = 0;
  for (uint32_t axis = 0; axis < 3; ++axis)
    for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
      const double speed = ((double)at[axis][p] - q[axis][p]) + v[axis][p] / 16.0;
      sum += (particle_is_half(w, p) ? 0.5 : 1) * speed * speed;
    }
  return sum;
}

static double speed_sum(const fray_world *w) { return sqrt(2 * kinetic(w) * CROSSINGS); }

/* Contacts slid towards others, down to a tenth of a spacing, within the sheet. */
static void crowd(fray_world *w, uint64_t *seed) {
  for (uint32_t n = 0; n < (uint32_t)w->woven.yarn_counts->split; ++n)
    for (uint32_t axis = 0; axis < 2; ++axis) {
      const int32_t by = within(seed, YARN_PLACE_ONE * 9 / 20);
      const uint32_t home = w->woven.contacts[n].place[axis];
      const uint32_t to = home + (uint32_t)by;
      if (to > yarn_place_of(0) && to < yarn_place_of(7)) w->woven.contacts[n].place[axis] = to;
    }
}

static void momentum_is_exact_and_energy_falls(void) {
  static const char *const kinds[] = {"", " stretch 0.5 N\n"};
  uint64_t seed = 20261;
  for (uint32_t kind = 0; kind < 2; ++kind) {
    uint32_t lost = 0;
    uint32_t rises = 0;
    double most = 0;
    for (uint32_t n = 0; n < SHEETS / TEST_FEWER; ++n) {
      fixture_scoped f = {0};
      int64_t before[3];
      int64_t after[3];
      open_sheet(&f, 1 + n % 3, kinds[kind]);
      constants_of(f.w)->crossing_friction = within(&seed, 5000) + 5000;
      constants_of(f.w)->slip_friction = within(&seed, 1 << 15) + (1 << 15);
      shake(f.w, &seed, 1 << (8 + n % 9), 1 << (2 + n % 13));
      if (n % 2 != 0) crowd(f.w, &seed);
      yarn_grip_update(f.w);
      for (uint32_t pass = 0; pass < 4; ++pass) {
        memset(f.w->rigid.motion, 0, f.w->capacity[POOL_BODIES] * sizeof *f.w->rigid.motion);
        momentum(f.w, before);
        const double energy = kinetic(f.w);
        const double rounding = 2 * speed_sum(f.w) + CROSSINGS;
        yarn_slip_apply(f.w);
        momentum(f.w, after);
        lost += memcmp(before, after, sizeof before) != 0;
        if (kind != 0) continue; /* elastic: see friction_only_takes() */
        rises += kinetic(f.w) > energy + rounding;
        most = fmax(most, (kinetic(f.w) - energy) / rounding);
      }
    }
    CHECK_EQ_INT(lost, 0);
    CHECK_EQ_INT(rises, 0);
    if (kind == 0) figure("slip_energy_made_at_most", most, "of_what_rounding_makes", "1");
  }
}

/* Contacts of elastic yarns store energy; in each tick slides take from it, and all rows together make none. */
static void friction_only_takes(void) {
  uint64_t seed = 77;
  double slip = 0;
  double made = 0;
  for (uint32_t n = 0; n < 60 / TEST_FEWER; ++n) {
    fixture_scoped f = {0};
    open_sheet(&f, 1 + n % 3, " stretch 0.5 N\n");
    constants_of(f.w)->crossing_friction = within(&seed, 5000) + 5000;
    shake(f.w, &seed, 1 << (8 + n % 9), 1 << (2 + n % 9));
    fray_energy_watch(f.w);
    for (uint32_t tick = 0; tick < 50; ++tick) (void)fixture_tick(&f, &fixture_idle);
    const fray_energy_account a = fray_energy(f.w);
    const double high = (double)a.gravity + (double)a.stored[FRAY_STORED_POTENTIAL]; /* at first */
    const double turned = (double)a.begun - high + fabs((double)a.gravity);
    double net = 0;
    for (uint32_t stage = 0; stage < FRAY_ENERGY_STAGES; ++stage) net += (double)a.made[stage] - (double)a.lost[stage];
    slip = fmax(slip, (double)a.made[FRAY_ENERGY_SLIP] / turned);
    made = fmax(made, net / turned);
  }
  figure("friction_gives", slip, "of_the_energy", "0.001");
  figure("stretch_sheets_make", made, "of_the_energy", "0.01");
  CHECK(slip < 0.001 && made < 0.01);
}

/* The warp's particle at a crossing moved along the warp: how far its contact slides in a pass. */
static double slid(uint32_t moved, int32_t friction, uint32_t passes) {
  fixture_scoped f = {0};
  const uint32_t c = 4 * WARPS + 3;
  open_sheet(&f, 1, "");
  fray_world *w = f.w;
  const uint32_t n = crossing_contact(w, c);
  constants_of(w)->crossing_friction = friction;
  constants_of(w)->slip_friction = 0;
  for (uint32_t j = 1; j < WEFTS; ++j) /* the whole warp, so that it stays straight */
    w->p.y[w->woven.warp_particle[j * WARPS + 3]] -= (int32_t)moved;
  yarn_grip_update(w);
  const uint32_t from = w->woven.contacts[n].place[FRAY_WARP];
  for (uint32_t pass = 0; pass < passes; ++pass) yarn_slip_apply(w);
  CHECK_EQ_INT(w->woven.contacts[n].place[FRAY_WEFT], yarn_place_of(3));
  return (double)(int32_t)(w->woven.contacts[n].place[FRAY_WARP] - from) * 0x1p-20 *
         w->woven.link_classes[CLASS_WARP].rest;
}

static void what_is_over_the_limit_slides(void) {
  CHECK(slid(0, 1000, 1) == 0);
  CHECK(fabs(slid(20000, 0, 1)) > 0.98 * 20000 && fabs(slid(20000, 0, 1)) < 1.01 * 20000);
  /* crossing_friction is 4 F h^2 / m, a contact holds F with 5/4 of it */
  CHECK(fabs(slid(20000, 8000, 1)) > 0.99 * 10000 && fabs(slid(20000, 8000, 1)) < 1.01 * 10000);
  CHECK(slid(20000, 16100, 1) == 0);
  CHECK(slid(20000, 1 << 24, 50) == 0);
}

/* A yarn at rest is held by static_friction times as much as one that slid in the tick before. */
static void what_rests_holds_more(void) {
  for (uint32_t slides = 0; slides < 2; ++slides) {
    fixture_scoped f = {0};
    const uint32_t c = 4 * WARPS + 3;
    open_sheet(&f, 1, "");
    fray_world *w = f.w;
    yarn_contact *k = &w->woven.contacts[crossing_contact(w, c)];
    constants_of(w)->crossing_friction = 8000; /* holds 10,000, see above */
    constants_of(w)->slip_friction = 0;
    constants_of(w)->static_friction = 91750;
    for (uint32_t j = 1; j < WEFTS; ++j) w->p.y[w->woven.warp_particle[j * WARPS + 3]] -= 13000;
    k->grip |= slides << FRAY_WARP;
    yarn_grip_update(w);
    yarn_slip_apply(w);
    CHECK_EQ_INT(k->place[FRAY_WARP] != yarn_place_of(4), slides);
    CHECK_EQ_INT(k->grip >> FRAY_WARP & 1u, slides);
  }
}

/* A bundle of wefts pushed along a warp by the first of them: none passes another. */
static void places_stay_in_order(void) {
  fixture_scoped f = {0};
  open_sheet(&f, 1, "");
  fray_world *w = f.w;
  uint64_t seed = 3;
  int32_t nearest = INT32_MAX;
  for (uint32_t tick = 0; tick < 200; ++tick) {
    shake(w, &seed, 1 << 18, 1 << 10);
    yarn_grip_update(w);
    for (uint32_t pass = 0; pass < 16; ++pass) yarn_slip_apply(w);
    for (uint32_t c = WARPS; c + WARPS < CROSSINGS; ++c) {
      if (crossing_state_at(w, c) != FRAY_LOOSE || crossing_state_at(w, c + WARPS) != FRAY_LOOSE) continue;
      const uint32_t a = w->woven.contacts[crossing_contact(w, c)].place[FRAY_WARP];
      const uint32_t b = w->woven.contacts[crossing_contact(w, c + WARPS)].place[FRAY_WARP];
      nearest = fx_min(nearest, (int32_t)(b - a));
    }
  }
  figure("places_nearest", nearest * 0x1p-20, "spacings", "above 0");
  CHECK(nearest > 0);
}

/* In bent cloth a new contact has no gap, and a break leaves the others theirs. */
static void nothing_jolts(void) {
  fixture_scoped f = {0};
  uint64_t seed = 8;
  uint32_t jolts = 0;
  open_sheet(&f, 1, "");
  fray_world *w = f.w;
  shake(w, &seed, 1 << 14, 0);
  yarn_touch before[CROSSINGS];
  uint32_t acts[CROSSINGS];
  yarn_grip_update(w);
  for (uint32_t n = 0; n < (uint32_t)w->woven.yarn_counts->split; ++n) acts[n] = (uint32_t)yarn_touch_at(w, n, &before[n]);
  w->woven.tear_count = 3;
  for (uint32_t k = 0; k < 3; ++k) w->woven.tear_queue[k] = (torn_spring){20 + 17 * k, 1 + k};
  yarn_slip_before_breaks(w);
  spring_break_apply(w);
  yarn_slip_after_breaks(w);
  for (uint32_t n = 0; n < (uint32_t)w->woven.yarn_counts->split; ++n) {
    yarn_touch now;
    if (!acts[n] || !yarn_contact_acts(w, n) || !yarn_touch_at(w, n, &now)) continue;
    jolts += !vec_is_equal(now.gap, before[n].gap);
  }
  CHECK_EQ_INT(jolts, 0);
  fixture_scoped bent = {0};
  open_sheet(&bent, 64, "");
  shake(bent.w, &seed, 1 << 14, 0);
  const uint32_t c = 3 * WARPS + 4;
  yarn_touch born;
  crossing_split(bent.w, c, FRAY_LOOSE);
  yarn_slip_begin(bent.w, crossing_contact(bent.w, c));
  CHECK(yarn_touch_at(bent.w, crossing_contact(bent.w, c), &born) && vec_squared(born.gap) == 0);
}

/* A contact that is pushed against a whole crossing splits it; one that friction holds there does not. */
static void a_jam_splits(void) {
  for (uint32_t held = 0; held < 2; ++held) {
    fixture_scoped f = {0};
    open_sheet(&f, 64, "");
    fray_world *w = f.w;
    const uint32_t c = 4 * WARPS + 3;
    crossing_split(w, c, FRAY_LOOSE);
    constants_of(w)->crossing_friction = held != 0 ? 1 << 24 : 0;
    w->woven.contacts[crossing_contact(w, c)].place[FRAY_WARP] = yarn_place_of(5) - YARN_PLACE_ONE / 4;
    yarn_slip_begin(w, crossing_contact(w, c));
    yarn_grip_update(w);
    crossing_transition_find(w);
    for (uint32_t other = 0; other < CROSSINGS; ++other)
      CHECK_EQ_INT((w->woven.crossing_state[other] & CROSSING_PENDING) != 0, other == c + WARPS && held == 0);
  }
}

/* Cut off on both sides the warp slides off: the contact leaves, its crossing is disconnected. */
static void a_piece_without_a_yarn_leaves(void) {
  fixture_scoped f = {0};
  open_sheet(&f, 1, "");
  fray_world *w = f.w;
  const uint32_t c = 4 * WARPS + 3;
  const yarn_line warp = yarn_line_of(w, FRAY_WARP, 3);
  CHECK(w->params->tears_max >= 2);
  w->woven.tear_count = 2;
  for (uint32_t k = 0; k < 2; ++k)
    w->woven.tear_queue[k] = (torn_spring){w->woven.spring_of[warp.link + (3 + k) * warp.link_stride], 1 + k};
  yarn_grip_update(w);
  yarn_slip_before_breaks(w);
  spring_break_apply(w);
  yarn_slip_after_breaks(w);
  CHECK_EQ_INT(w->woven.crossing_state[c] & CROSSING_LEFT, CROSSING_LEFT);
  CHECK_EQ_INT(crossing_state_at(w, c), FRAY_LOOSE);
  crossing_transition_find(w);
  CHECK_EQ_INT(crossing_state_at(w, c), FRAY_DISCONNECTED);
  CHECK_EQ_INT(w->woven.contacts[crossing_contact(w, c)].place[0], 0);
}

int main(void) {
  TEST(momentum_is_exact_and_energy_falls);
  TEST(what_is_over_the_limit_slides);
  TEST(friction_only_takes);
  TEST(what_rests_holds_more);
  TEST(places_stay_in_order);
  TEST(nothing_jolts);
  TEST(a_piece_without_a_yarn_leaves);
  TEST(a_jam_splits);
  return test_end();
}
