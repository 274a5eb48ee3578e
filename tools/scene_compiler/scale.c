/* SPDX-License-Identifier: Apache-2.0 */
/* Units: the size of an lu, masses, gains, and every scalar of the world. */
#include "tools/scene_compiler/draft.h"

/* `most` between yarns, cm. */
static int refuse_spacing(const draft *d, exact most) {
  const source_key *k = source_find(&d->scene->source, BLOCK_CLOTH, "spacing");
  const int counts = k != NULL && k->quantity == UNIT_PER_LENGTH;
  char bound[SOURCE_VALUE];
  draft_value(d, BLOCK_CLOTH, "spacing", counts ? UNIT_PER_LENGTH : UNIT_LENGTH,
              counts ? exact_div(exact_make(1, 1), most) : most, counts ? 1 : -1, bound);
  return draft_expected(d, BLOCK_CLOTH, "spacing", counts ? "at least %s" : "at most %s between yarns",
                        bound);
}

/* The smallest lu in which the wider spacing has at most LINK_UNITS_MAX direction units: just
 * below 1/8 lu, and above 1/20 lu by the steps of the table. */
int draft_scale(draft *d) {
  static const uint32_t sizes_um[] = {50,   100,  200,   500,   1000,
                                      2000, 5000, 10000, 20000, 50000};
  const exact wide = exact_compare(d->scene->woven.warp_spacing, d->scene->woven.weft_spacing) > 0
                         ? d->scene->woven.warp_spacing
                         : d->scene->woven.weft_spacing;
  uint32_t n = 0;
  while (n < 10 && exact_compare(exact_mul(wide, exact_make(10000, sizes_um[n])),
                                 exact_make(LINK_UNITS_MAX, 1 << 16)) > 0)
    ++n;
  if (n == 10) return refuse_spacing(d, exact_make(5 * LINK_UNITS_MAX, 1 << 16));
  d->lu_um = sizes_um[n];
  d->lu_per_cm = exact_make(10000, d->lu_um);
  if (!draft_length(d, BLOCK_CLOTH, "spacing", d->scene->woven.warp_spacing, &d->spacing[0]) ||
      !draft_length(d, BLOCK_CLOTH, "spacing", d->scene->woven.weft_spacing, &d->spacing[1]))
    return 0;
  if (fx_min(d->spacing[0], d->spacing[1]) < LINK_UNITS_MIN << LINK_SHIFT)
    return draft_expected(d, BLOCK_CLOTH, "spacing", "spacings of warps and wefts within a factor of 3");
  d->particle_mass = exact_mul(d->scene->woven.density, exact_mul(d->scene->woven.warp_spacing,
                                                                  d->scene->woven.weft_spacing));
  return 1;
}

/* Of gravity, or of the rate where gravity is the default. */
static int refuse_gravity(const draft *d) {
  const int by_rate = source_find(&d->scene->source, BLOCK_SCENE, "gravity") == NULL;
  const int64_t per_second = (int64_t)d->scene->rate_hz * d->substeps;
  const exact most =
      exact_div(exact_mul(exact_make(per_second, 32), exact_make(per_second, 1)), d->lu_per_cm);
  char text[SOURCE_VALUE];
  if (by_rate)
    return draft_expected(d, BLOCK_SCENE, "rate",
                          "more ticks a second than %u, or more substeps than %u, for cloth as fine as this "
                          "under gravity",
                          d->scene->rate_hz, d->substeps);
  return draft_expected(d, BLOCK_SCENE, "gravity",
                        "less than %s, 1/32 lu a substep in each, at %u Hz with %u substep%s",
                        draft_value(d, BLOCK_SCENE, "gravity", UNIT_ACCELERATION, most, -1, text),
                        d->scene->rate_hz, d->substeps, d->substeps == 1 ? "" : "s");
}

/* Q28 per substep, each substep: whole part and 2^-32 of it. */
static int gravity_word(const draft *d, exact cm_s2, int32_t *whole, int32_t *rest) {
  const int64_t per_second = (int64_t)d->scene->rate_hz * d->substeps;
  const exact lu = exact_mul(cm_s2, d->lu_per_cm);
  const exact step = exact_div(exact_div(lu, exact_make(per_second, 1)), exact_make(per_second, 1));
  int64_t fixed;
  if (!exact_to_fixed(step, 60, &fixed) || fixed < -((int64_t)1 << 55) || fixed > (int64_t)1 << 55)
    return refuse_gravity(d);
  *whole = (int32_t)fx_asr64(fixed, 32);
  *rest = (int32_t)(uint32_t)((uint64_t)fixed & 0xFFFFFFFFu);
  return 1;
}

static int refuse_mass(const draft *d, int heavy) {
  const char *key = "density";
  const uint32_t block = d->scene->membrane.present ? draft_material(d, &key) : BLOCK_CLOTH;
  return draft_expected(
      d, block, key, "a %s cloth, or %s rate than %u Hz with %u substeps, for the range of forces",
      heavy ? "lighter" : "heavier", heavy ? "a lower" : "a higher", d->scene->rate_hz, d->substeps);
}

/* force [0.5 mN] = impulse * 2^-28 * R, R = m lu n F^2 / 50 (rt/haptics/haptic_force.c): R with 23 bits. */
static int force_words(const draft *d, params *p) {
  const int64_t rate = d->scene->rate_hz;
  exact r = exact_div(exact_mul(d->particle_mass, exact_make((int64_t)d->substeps * rate, 1)),
                      d->lu_per_cm);
  r = exact_mul(r, exact_make(rate, 50));
  int32_t shift = 28;
  int64_t fixed;
  while (exact_to_fixed(r, (unsigned)(shift - 28), &fixed) && fixed < 1 << 22 && shift < 62)
    ++shift;
  if (!exact_to_fixed(r, (unsigned)(shift - 28), &fixed) || fixed < 1 || fixed > 1 << 23)
    return refuse_mass(d, fixed > 1);
  p->force_gain = (int32_t)fixed;
  p->force_shift = shift;
  return 1;
}

static int ticks(const draft *d, const char *key, exact seconds, int32_t *out) {
  return draft_fixed_point(d, draft_given(BLOCK_HANDS, key, UNIT_TIME, seconds),
                           exact_mul(seconds, exact_make(d->scene->rate_hz, 1)), 0, 1, 10000, out);
}

static int hand_words(const draft *d, params *p) {
  const scene *s = d->scene;
  const exact rate = exact_make(s->rate_hz, 1);
  const exact steps = exact_make(2000, 1); /* 0.5 mN in a newton */
  int32_t force_rate = 0;
  for (uint32_t n = 0; n < s->body_count; ++n)
    if (s->bodies[n].motion == FRAY_HAND || s->bodies[n].is_handle) p->hands |= 1 << s->bodies[n].hand;
  p->stale_ticks = 3;
  p->arm_poses = 16;
  const exact lu_per_step = exact_make(2, d->lu_um);
  const draft_number speed = draft_given(BLOCK_HANDS, "speed", UNIT_SPEED, s->hands.speed);
  if (!draft_fixed_point(d, speed, lu_per_step, FX_POSITION_BITS + 8, 1, INT32_MAX, &p->pose_gain) ||
      !draft_fixed_point(d, speed, exact_div(exact_mul(s->hands.speed, d->lu_per_cm), rate), FX_POSITION_BITS,
                         1, 1 << 28, &p->hand_speed) ||
      !draft_fixed_point(d, draft_given(BLOCK_HANDS, "force_limit", UNIT_FORCE, s->hands.force_limit),
                         exact_mul(s->hands.force_limit, steps), 0, 0, 32767, &p->force_clamp) ||
      !draft_fixed_point(d, draft_given(BLOCK_HANDS, "force_rate", UNIT_FORCE_RATE, s->hands.force_rate),
                         exact_div(exact_mul(s->hands.force_rate, steps), rate), 0, 0, INT32_MAX,
                         &force_rate))
    return 0;
  p->force_rate = fx_clamp(force_rate, 1, 32767);
  return ticks(d, "ramp_up", s->hands.ramp_up, &p->ramp_ticks) &&
         ticks(d, "ramp_down", s->hands.ramp_down, &p->fade_ticks) && force_words(d, p);
}

static void weave_words(const scene *s, params *p) {
  uint64_t bits = 0;
  for (uint32_t r = 0; r < s->woven.weave_rows; ++r)
    for (uint32_t c = 0; c < s->woven.weave_columns; ++c)
      if (s->woven.weave[r][c] != 0) bits |= (uint64_t)1 << (r * 8u + c);
  p->weave_columns = (int32_t)s->woven.weave_columns;
  p->weave_rows = (int32_t)s->woven.weave_rows;
  p->weave_low = (int32_t)(uint32_t)(bits & 0xFFFFFFFFu);
  p->weave_high = (int32_t)(uint32_t)(bits >> 32);
}

static draft_number of_cloth(const char *key, unit_quantity quantity, exact given) {
  return draft_given(BLOCK_CLOTH, key, quantity, given);
}

static int woven_words(const draft *d, params *p) {
  const scene *s = d->scene;
  const exact rate = exact_make(s->rate_hz, 1);
  weave_words(s, p);
  p->tearing = s->woven.tearing;
  p->tear_mirrored = s->woven.tear_mirrored;
  p->tears_max = (int32_t)s->limits.tears_per_tick;
  p->seed = (int32_t)s->seed;
  p->contact_margin = fx_min(d->spacing[0], d->spacing[1]);
  const char *key = "density";
  const uint32_t block = s->membrane.present ? draft_material(d, &key) : BLOCK_CLOTH;
  return draft_fixed_point(d, of_cloth("drag", UNIT_RATE, s->woven.drag), exact_div(s->woven.drag, rate), 24,
                           0, 1 << 24, &p->drag) &&
         draft_fixed_point(d, of_cloth("damping", UNIT_RATE, s->woven.damping),
                           exact_div(s->woven.damping, rate), 24, 0, 1 << 24, &p->relative_damping) &&
         draft_fixed_point(d, of_cloth("tear", UNIT_SHARE, s->woven.tear_min), s->woven.tear_min, 16, 0,
                           1 << 18, &p->tear_min) &&
         draft_fixed_point(d, of_cloth("tear", UNIT_SHARE, s->woven.tear_max), s->woven.tear_max, 16, 0,
                           1 << 18, &p->tear_max) &&
         draft_fixed_point(d, of_cloth("thickness", UNIT_LENGTH, s->woven.thickness),
                           exact_mul(s->woven.thickness, d->lu_per_cm), FX_POSITION_BITS, 0, FX_LU,
                           &p->thickness) &&
         draft_fixed_point(d, draft_given(block, key, UNIT_AREAL_DENSITY, s->woven.density),
                           exact_mul(d->particle_mass, exact_make(1000000000, 1)), 0, 1, INT32_MAX,
                           &p->particle_mass_ng);
}

int draft_params(const draft *d, params *p) {
  const scene *s = d->scene;
  p->rate_hz = (int32_t)s->rate_hz;
  p->substeps = (int32_t)d->substeps;
  p->iterations = (int32_t)d->iterations;
  p->warps = (int32_t)d->grid.warps;
  p->wefts = (int32_t)d->grid.wefts;
  p->lu_um = (int32_t)d->lu_um;
  p->attached = (int32_t)d->attached;
  p->particles = (int32_t)d->crossings;
  p->links = (int32_t)d->springs_of_kind[FRAY_STRUCTURAL];
  p->bends = (int32_t)d->springs_of_kind[FRAY_BEND];
  p->shears = (int32_t)d->springs_of_kind[FRAY_SHEAR];
  p->link_batches = (int32_t)d->batches_of_kind[FRAY_STRUCTURAL];
  p->bend_batches = (int32_t)d->batches_of_kind[FRAY_BEND];
  p->shear_batches = (int32_t)d->batches_of_kind[FRAY_SHEAR];
  p->bodies = (int32_t)d->bodies;
  return gravity_word(d, s->gravity[0], &p->gravity_x, &p->gravity_rest_x) &&
         gravity_word(d, s->gravity[1], &p->gravity_y, &p->gravity_rest_y) &&
         gravity_word(d, s->gravity[2], &p->gravity_z, &p->gravity_rest_z) &&
         woven_words(d, p) && hand_words(d, p);
}

/* Whichever of the two keys the scene has. */
static int refuse_disconnect(const draft *d) {
  const scene *s = d->scene;
  const int written = source_find(&s->source, BLOCK_CLOTH, "disconnect_at") != NULL;
  const char *key = written ? "disconnect_at" : "thickness";
  char bound[SOURCE_VALUE];
  draft_value(d, BLOCK_CLOTH, key, UNIT_LENGTH, written ? s->woven.thickness : s->woven.disconnect_at, 0,
              bound);
  return draft_expected(d, BLOCK_CLOTH, key,
                        written ? "more than %s, the thickness of the cloth, at which crossings rest"
                                : "less than %s, the distance of 'disconnect_at'",
                        bound);
}

int draft_yarns(const draft *d, yarn_params *y) {
  const scene *s = d->scene;
  /* F h^2 / m of both yarns, each of half a mass: their distance changes by 4 F h^2 / m; dyn from newtons */
  const exact per_second = exact_make((int64_t)s->rate_hz * d->substeps, 1);
  const exact dyn = exact_mul(s->woven.crossing_friction, exact_make(400000, 1));
  const exact distance = exact_div(exact_div(exact_div(dyn, d->particle_mass), per_second), per_second);
  const exact friction = exact_mul(distance, d->lu_per_cm);
  char least[SOURCE_VALUE];
  char wide[SOURCE_VALUE];
  y->all_yarn = s->woven.yarns == 2;
  y->disconnect_by_particles = s->woven.disconnect_by_particles;
  y->spread_splits = s->woven.spread_splits;
  if (!draft_fixed_point(d, of_cloth("split_strain", UNIT_SHARE, s->woven.split_strain_min),
                         s->woven.split_strain_min, 16, 0, 1 << 18, &y->split_min) ||
      !draft_fixed_point(d, of_cloth("split_strain", UNIT_SHARE, s->woven.split_strain_max),
                         s->woven.split_strain_max, 16, 0, 1 << 18, &y->split_max) ||
      !draft_fixed_point(d, of_cloth("disconnect_at", UNIT_LENGTH, s->woven.disconnect_at),
                         exact_mul(s->woven.disconnect_at, d->lu_per_cm), FX_POSITION_BITS, 1, 1 << 26,
                         &y->disconnect_distance) ||
      !draft_fixed_point(d, of_cloth("crossing_friction", UNIT_FORCE, s->woven.crossing_friction), friction,
                         FX_POSITION_BITS, 0, 1 << 24, &y->crossing_friction) ||
      !draft_fixed_point(d, of_cloth("slip_friction", UNIT_NONE, s->woven.slip_friction),
                         s->woven.slip_friction, 16, 0, 16 << 16, &y->slip_friction) ||
      !draft_fixed_point(d, of_cloth("static_friction", UNIT_NONE, s->woven.static_friction),
                         s->woven.static_friction, 16, 1 << 16, 4 << 16, &y->static_friction))
    return 0;
  if (exact_compare(s->woven.disconnect_at, s->woven.thickness) <= 0) return refuse_disconnect(d);
  const exact spread = exact_sub(s->woven.split_strain_max, s->woven.split_strain_min);
  if (exact_compare(s->woven.split_strain_min, s->woven.tear_min) >= 0 ||
      exact_compare(spread, exact_sub(s->woven.tear_max, s->woven.tear_min)) > 0)
    return draft_expected(
        d, BLOCK_CLOTH, "split_strain",
        "a minimum below %s and a range no wider than %s, as 'tear' has, so that every spring splits "
        "its ends before it tears",
        draft_value(d, BLOCK_CLOTH, "split_strain", UNIT_SHARE, s->woven.tear_min, 0, least),
        draft_value(d, BLOCK_CLOTH, "split_strain", UNIT_SHARE,
                    exact_sub(s->woven.tear_max, s->woven.tear_min), 0, wide));
  return 1;
}

int draft_yarn_collision(const draft *d, self_params *k) {
  const scene *s = d->scene;
  const int32_t near = fx_min(d->spacing[0], d->spacing[1]);
  const char *key = s->woven.has_self_thickness ? "self_thickness" : "thickness";
  const int32_t max = fx_min(near / 2, SELF_THICKNESS_MAX);
  char most[SOURCE_VALUE];
  if (!draft_fixed_point(d, of_cloth(key, UNIT_LENGTH, s->woven.self_thickness),
                         exact_mul(s->woven.self_thickness, d->lu_per_cm), FX_POSITION_BITS, 1, INT32_MAX,
                         &k->thickness))
    return 0;
  if (k->thickness > max)
    return draft_expected(d, BLOCK_CLOTH, key,
                          "at most %s with 'self_collision', half of the spacing, so that yarns side by side "
                          "do not meet",
                          draft_value(d, BLOCK_CLOTH, key, UNIT_LENGTH,
                                      exact_div(exact_make(max, FX_LU), d->lu_per_cm), -1, most));
  k->slack = near / 32;
  return 1;
}

/* A chain of springs k between masses m vibrates at up to 2 root(k / m). Explicit pulls with a time T between
 * them bear 2 / T along a line. At finite bends springs of both directions add up and made energy near that,
 * but none at half of it. A yarn of a split crossing has half of its mass. A default is made smaller. */
static int bear_spring(const draft *d, const char *key, int is_given, exact *k) {
  const int is_split = d->scene->woven.yarns != 0;
  const int64_t rate = (int64_t)d->scene->rate_hz * (scene_has_stretch(d->scene) ? d->substeps : 1);
  const exact lightest = exact_mul(d->particle_mass, exact_make(1, is_split ? 2 : 1));
  const exact most = exact_mul(lightest, exact_make(rate * rate, 4));
  char most_text[SOURCE_VALUE];
  if (exact_compare(*k, most) <= 0) return 1;
  if (!is_given) {
    *k = most;
    return 1;
  }
  return draft_expected(d, BLOCK_CLOTH, key,
                        "at most %s: what acts %lld times a second on %s of a crossing would make energy",
                        draft_value(d, BLOCK_CLOTH, key, UNIT_STIFFNESS, most, -1, most_text), (long long)rate,
                        is_split ? "half the mass" : "the mass");
}

/* dv = k/m T h per length, with 16 bits; T is the time between two pulls, h a substep. */
static int make_spring(const draft *d, const char *key, exact k, int32_t rest,
                       int32_t compression_only, bend_shear_class *c) {
  const int64_t rate = d->scene->rate_hz;
  const int64_t pulls = scene_has_stretch(d->scene) ? d->substeps : 1; /* a tick */
  const exact per_tick = exact_div(exact_div(k, d->particle_mass), exact_make(rate * rate, 1));
  const exact gain = exact_div(per_tick, exact_make(d->substeps * pulls, 1));
  int32_t mantissa = 0;
  int32_t shift = 16;
  while (mantissa < 1 << 15 && shift < 46)
    if (!draft_fixed_point(d, of_cloth(key, UNIT_STIFFNESS, k), gain, (unsigned)++shift, 0, 65535, &mantissa))
      return 0;
  if (mantissa < 1 << 15) mantissa = 0; /* too weak for any effect */
  *c = bend_shear_class_make(rest, mantissa, shift, compression_only);
  return 1;
}

/* 2 k h^2 / m in Q12, at most a whole projection. */
static int push_share(const draft *d, int32_t *push) {
  const int64_t per_second = (int64_t)d->scene->rate_hz * d->substeps;
  const exact twice = exact_mul(exact_div(d->scene->woven.structural, d->particle_mass),
                                exact_make(2, per_second));
  const exact share = exact_div(twice, exact_make(per_second, 1));
  *push = 4096;
  return exact_compare(share, exact_make(1, 1)) >= 0 ||
         draft_fixed_point(d, of_cloth("structural", UNIT_STIFFNESS, d->scene->woven.structural), share, 12,
                           0, 4096, push);
}

/* A cell of sides a and b, sheared by the angle s of half tangent t, has a diagonal of
 * a^2 + b^2 - 2 a b sin s, squared; sin s = 2 t / (1 + t^2). */
static int shear_lock(const draft *d, link_class *locks) {
  const exact t = d->scene->woven.shear_lock;
  if (t.numerator == 0) return 1;
  if (scene_has_stretch(d->scene))
    return draft_expected(d, BLOCK_CLOTH, "shear_lock", "none with 'stretch': its yarns are not projected");
  const exact one = exact_make(1, 1);
  const exact sine = exact_div(exact_mul(exact_make(2, 1), t), exact_add(one, exact_mul(t, t)));
  int64_t across = 0;
  const int64_t a = d->spacing[0];
  const int64_t b = d->spacing[1];
  (void)exact_to_fixed(exact_mul(sine, exact_make(2 * a, 1)), 0, &across);
  const int32_t least = (int32_t)exact_sqrt((uint64_t)(a * a + b * b - across * b));
  locks[0] = locks[1] = link_class_of_lock(least);
  return (least >= LOCK_UNITS_MIN << LINK_SHIFT && least <= LINK_UNITS_MAX << LINK_SHIFT) ||
         draft_expected(d, BLOCK_CLOTH, "shear_lock",
                        "an angle that leaves diagonals of 1/512 to 1/8 of the cloth's unit of length");
}

int draft_classes(const draft *d, link_class *links, bend_shear_class *springs) {
  int32_t push = 0;
  exact bend = d->scene->woven.bend;
  exact shear = d->scene->woven.shear;
  if (!push_share(d, &push) || !bear_spring(d, "bend", d->scene->woven.has_bend, &bend) ||
      !bear_spring(d, "shear", d->scene->woven.has_shear, &shear))
    return 0;
  for (uint32_t axis = 0; axis < 2; ++axis) {
    links[CLASS_WEFT + axis] = link_class_make(d->spacing[axis], push);
    if (!make_spring(d, "bend", bend, 2 * d->spacing[axis], 0, &springs[1 + axis]))
      return 0;
  }
  const uint64_t diagonal2 = (uint64_t)((int64_t)d->spacing[0] * d->spacing[0]) +
                             (uint64_t)((int64_t)d->spacing[1] * d->spacing[1]);
  const int32_t diagonal = (int32_t)exact_sqrt(diagonal2);
  if (!shear_lock(d, &links[CLASS_LOCK]) ||
      !make_spring(d, "shear", shear, diagonal, 1, &springs[CLASS_SHEAR]))
    return 0;
  return d->scene->woven.yarns == 0 ||
         make_spring(d, "shear", exact_div(shear, exact_make(2, 1)), diagonal, 1,
                     &springs[CLASS_SHEAR_HALF]);
}
