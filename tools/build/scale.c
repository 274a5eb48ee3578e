/* SPDX-License-Identifier: Apache-2.0 */
/* Units: the size of an lu, masses, gains, and every scalar of the world. */
#include <stdarg.h>
#include <stdio.h>

#include "tools/build/draft.h"

int draft_refuse(const draft *d, int line, const char *format, ...) {
  va_list list;
  scene_error *e = d->error;
  snprintf(e->file, sizeof e->file, "%s", d->file);
  e->line = line;
  e->column = 0;
  va_start(list, format);
  vsnprintf(e->message, sizeof e->message, format, list);
  va_end(list);
  return 0;
}

int draft_length(const draft *d, int line, exact centimetres, int32_t *lu) {
  int64_t fixed;
  const int fits = exact_to_fixed(exact_mul(centimetres, d->lu_per_cm), FX_POSITION_BITS, &fixed);
  if (!fits || fixed > FX_WORLD_MAX || fixed < -FX_WORLD_MAX)
    return draft_refuse(d, line, "a length outside of the world: it spans %u mm around the origin, "
                        "because yarns are this close", 120u * d->lu_um / 1000u);
  *lu = (int32_t)fixed;
  return 1;
}

int draft_place(const draft *d, int line, const exact at[3], vec3 *place) {
  return draft_length(d, line, at[0], &place->x) && draft_length(d, line, at[1], &place->y) &&
         draft_length(d, line, at[2], &place->z);
}

/* The smallest lu in which the wider spacing has at most LINK_UNITS_MAX direction units: just
 * below 1/8 lu, and above 1/20 lu by the steps of the table. */
int draft_scale(draft *d) {
  static const uint32_t sizes_um[] = {50,   100,  200,   500,   1000,
                                      2000, 5000, 10000, 20000, 50000};
  const exact wide = exact_compare(d->scene->sheet.warp_spacing, d->scene->sheet.weft_spacing) > 0
                         ? d->scene->sheet.warp_spacing
                         : d->scene->sheet.weft_spacing;
  const int line = d->scene->sheet.line;
  const exact crimp = exact_mul(d->scene->sheet.thickness, exact_make(1, 2)); /* at most */
  const exact longest = d->scene->sheet.yarns != 0 ? exact_add(wide, crimp) : wide;
  uint32_t n = 0;
  while (n < 10 && exact_compare(exact_mul(longest, exact_make(10000, sizes_um[n])),
                                 exact_make(LINK_UNITS_MAX, 1 << 16)) > 0)
    ++n;
  if (n == 10) return draft_refuse(d, line, "spacing: expected at most 6.2 mm between yarns");
  d->lu_um = sizes_um[n];
  d->lu_per_cm = exact_make(10000, d->lu_um);
  if (!draft_length(d, line, d->scene->sheet.warp_spacing, &d->spacing[0]) ||
      !draft_length(d, line, d->scene->sheet.weft_spacing, &d->spacing[1]))
    return 0;
  if (fx_min(d->spacing[0], d->spacing[1]) < LINK_UNITS_MIN << LINK_SHIFT)
    return draft_refuse(d, line, "spacing: expected warp and weft spacings within a factor of 3");
  d->particle_mass = exact_mul(d->scene->sheet.density, exact_mul(d->scene->sheet.warp_spacing,
                                                                  d->scene->sheet.weft_spacing));
  return 1;
}

int draft_word(const draft *d, const char *key, exact value, unsigned shift, int64_t least,
               int64_t most, int32_t *out) {
  int64_t fixed;
  if (!exact_to_fixed(value, shift, &fixed) || fixed < least || fixed > most)
    return draft_refuse(d, d->scene->sheet.line,
                        "%s: does not fit the runtime's range at %u Hz with %u substeps, for %s of this "
                        "mass; expected a value nearer to %s, or another rate",
                        key, d->scene->rate_hz, d->substeps,
                        d->scene->triangles.present ? "vertices" : "crossings",
                        d->scene->triangles.present ? "measured ones" : "Table 1's");
  *out = (int32_t)fixed;
  return 1;
}

/* Q28 per substep, each substep: whole part and 2^-32 of it. */
static int gravity_word(const draft *d, exact cm_s2, int32_t *whole, int32_t *rest) {
  const int64_t per_second = (int64_t)d->scene->rate_hz * d->substeps;
  const exact lu = exact_mul(cm_s2, d->lu_per_cm);
  const exact step = exact_div(exact_div(lu, exact_make(per_second, 1)), exact_make(per_second, 1));
  int64_t fixed;
  if (!exact_to_fixed(step, 60, &fixed) || fixed < -((int64_t)1 << 55) || fixed > (int64_t)1 << 55)
    return draft_refuse(d, 0, "gravity: too strong for %u Hz with %u substeps; expected less than 1/32 "
                        "lu (%u um) a substep, each substep",
                        d->scene->rate_hz, d->substeps, d->lu_um / 32u);
  *whole = (int32_t)fx_asr64(fixed, 32);
  *rest = (int32_t)(uint32_t)((uint64_t)fixed & 0xFFFFFFFFu);
  return 1;
}

/* force [0.5 mN] = impulse * 2^-28 * R, R = m lu n F^2 / 50 (rt/stage/force.c): R with 23 bits. */
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
    return draft_refuse(d, d->scene->sheet.line,
                        "density: a particle's mass does not fit the range of forces");
  p->force_gain = (int32_t)fixed;
  p->force_shift = shift;
  return 1;
}

static int ticks(const draft *d, const char *key, exact seconds, int32_t *out) {
  return draft_word(d, key, exact_mul(seconds, exact_make(d->scene->rate_hz, 1)), 0, 1, 10000, out);
}

static int hand_words(const draft *d, params *p) {
  const scene *s = d->scene;
  const exact rate = exact_make(s->rate_hz, 1);
  const exact steps = exact_make(2000, 1); /* 0.5 mN in a newton */
  int32_t force_rate = 0;
  for (uint32_t n = 0; n < s->body_count; ++n)
    if (s->bodies[n].motion == FRAY_HAND) p->hands |= 1 << s->bodies[n].hand;
  p->stale_ticks = 3;
  p->arm_poses = 16;
  const exact lu_per_step = exact_make(2, d->lu_um);
  if (!draft_word(d, "hands", lu_per_step, FX_POSITION_BITS + 8, 1, INT32_MAX, &p->pose_gain) ||
      !draft_word(d, "speed", exact_div(exact_mul(s->hands.speed, d->lu_per_cm), rate),
            FX_POSITION_BITS, 1, 1 << 28, &p->hand_speed) ||
      !draft_word(d, "force_limit", exact_mul(s->hands.force_limit, steps), 0, 0, 32767,
            &p->force_clamp) ||
      !draft_word(d, "force_rate", exact_div(exact_mul(s->hands.force_rate, steps), rate), 0, 0,
            INT32_MAX, &force_rate))
    return 0;
  p->force_rate = fx_clamp(force_rate, 1, 32767);
  return ticks(d, "ramp", s->hands.ramp, &p->ramp_ticks) &&
         ticks(d, "fade", s->hands.fade, &p->fade_ticks) && force_words(d, p);
}

static void weave_words(const scene *s, params *p) {
  uint64_t bits = 0;
  for (uint32_t r = 0; r < s->sheet.weave_rows; ++r)
    for (uint32_t c = 0; c < s->sheet.weave_columns; ++c)
      if (s->sheet.weave[r][c] != 0) bits |= (uint64_t)1 << (r * 8u + c);
  p->weave_columns = (int32_t)s->sheet.weave_columns;
  p->weave_rows = (int32_t)s->sheet.weave_rows;
  p->weave_low = (int32_t)(uint32_t)(bits & 0xFFFFFFFFu);
  p->weave_high = (int32_t)(uint32_t)(bits >> 32);
}

static int sheet_words(const draft *d, params *p) {
  const scene *s = d->scene;
  const exact rate = exact_make(s->rate_hz, 1);
  weave_words(s, p);
  p->tearing = s->sheet.tearing;
  p->tear_mirrored = s->sheet.tear_mirrored;
  p->cuts_max = (int32_t)s->limits.cuts_per_tick;
  p->seed = (int32_t)s->seed;
  p->contact_margin = fx_min(d->spacing[0], d->spacing[1]);
  return draft_word(d, "drag", exact_div(s->sheet.drag, rate), 24, 0, 1 << 24, &p->drag) &&
         draft_word(d, "damping", exact_div(s->sheet.damping, rate), 24, 0, 1 << 24,
              &p->relative_damping) &&
         draft_word(d, "tear", s->sheet.tear_min, 16, 0, 1 << 18, &p->tear_min) &&
         draft_word(d, "tear", s->sheet.tear_max, 16, 0, 1 << 18, &p->tear_max) &&
         draft_word(d, "thickness", exact_mul(s->sheet.thickness, d->lu_per_cm), FX_POSITION_BITS, 0,
              FX_LU, &p->thickness) &&
         draft_word(d, "density", exact_mul(d->particle_mass, exact_make(1000000000, 1)), 0, 1,
              INT32_MAX, &p->particle_mass_ng);
}

int draft_params(const draft *d, params *p) {
  const scene *s = d->scene;
  p->rate_hz = (int32_t)s->rate_hz;
  p->substeps = (int32_t)d->substeps;
  p->sweeps = (int32_t)d->sweeps;
  p->warps = (int32_t)d->grid.warps;
  p->wefts = (int32_t)d->grid.wefts;
  p->lu_um = (int32_t)d->lu_um;
  p->held = (int32_t)d->held;
  p->particles = (int32_t)d->crossings;
  p->links = (int32_t)d->family_rows[FRAY_STRUCTURAL];
  p->bends = (int32_t)d->family_rows[FRAY_BEND];
  p->shears = (int32_t)d->family_rows[FRAY_SHEAR];
  p->link_batches = (int32_t)d->family_batches[FRAY_STRUCTURAL];
  p->bend_batches = (int32_t)d->family_batches[FRAY_BEND];
  p->shear_batches = (int32_t)d->family_batches[FRAY_SHEAR];
  p->bodies = (int32_t)d->bodies;
  return gravity_word(d, s->gravity[0], &p->gravity_x, &p->gravity_rest_x) &&
         gravity_word(d, s->gravity[1], &p->gravity_y, &p->gravity_rest_y) &&
         gravity_word(d, s->gravity[2], &p->gravity_z, &p->gravity_rest_z) &&
         sheet_words(d, p) && hand_words(d, p);
}

int draft_yarns(const draft *d, yarn_params *y) {
  const scene *s = d->scene;
  /* F h^2 / m of both yarns, each of half a crossing: they part by 4 F h^2 / m; dyn from newtons */
  const exact per_second = exact_make((int64_t)s->rate_hz * d->substeps, 1);
  const exact dyn = exact_mul(s->sheet.slip_grip, exact_make(400000, 1));
  const exact way = exact_div(exact_div(exact_div(dyn, d->particle_mass), per_second), per_second);
  const exact grip = exact_mul(way, d->lu_per_cm);
  y->all_yarn = s->sheet.yarns == 2;
  y->loose_by_particles = s->sheet.loose_by_particles;
  if (!draft_word(d, "transition", s->sheet.transition_min, 16, 0, 1 << 18, &y->transition_min) ||
      !draft_word(d, "transition", s->sheet.transition_max, 16, 0, 1 << 18, &y->transition_max) ||
      !draft_word(d, "loose", exact_mul(s->sheet.loose, d->lu_per_cm), FX_POSITION_BITS, 1, 1 << 26,
            &y->loose_max) ||
      !draft_word(d, "slip_grip", grip, FX_POSITION_BITS, 0, 1 << 24, &y->slip_grip) ||
      !draft_word(d, "slip_friction", s->sheet.slip_friction, 16, 0, 16 << 16, &y->slip_friction))
    return 0;
  if (exact_compare(s->sheet.loose, s->sheet.thickness) <= 0)
    return draft_refuse(d, s->sheet.line, "loose: expected more than the thickness of the cloth, at "
                        "which couples rest");
  const exact spread = exact_sub(s->sheet.transition_max, s->sheet.transition_min);
  if (exact_compare(s->sheet.transition_min, s->sheet.tear_min) >= 0 ||
      exact_compare(spread, exact_sub(s->sheet.tear_max, s->sheet.tear_min)) > 0)
    return draft_refuse(d, s->sheet.line, "transition: expected strains below those of 'tear', over a "
                        "range that is no wider, so that every spring splits its ends before it tears");
  return 1;
}

int draft_selves(const draft *d, selves_params *k) {
  const scene *s = d->scene;
  const int32_t near = fx_min(d->spacing[0], d->spacing[1]);
  if (!draft_word(d, "self_thickness", exact_mul(s->sheet.self_thickness, d->lu_per_cm),
                  FX_POSITION_BITS, 1, INT32_MAX, &k->thickness))
    return 0;
  if (k->thickness > fx_min(near / 2, SELVES_THICKNESS_MAX))
    return draft_refuse(d, s->sheet.line, "self_thickness: expected at most half of the spacing, so that "
                        "yarns that lie side by side do not meet");
  k->slack = near / 32;
  return 1;
}

/* dv = k/m T h per length, with 16 bits. */
static int make_spring(const draft *d, const char *key, exact k, int32_t rest,
                       int32_t compression_only, spring_class *c) {
  const int64_t rate = d->scene->rate_hz;
  const exact per_tick = exact_div(exact_div(k, d->particle_mass), exact_make(rate * rate, 1));
  const exact gain = exact_div(per_tick, exact_make(d->substeps, 1));
  int32_t mantissa = 0;
  int32_t shift = 16;
  while (mantissa < 1 << 15 && shift < 46)
    if (!draft_word(d, key, gain, (unsigned)++shift, 0, 65535, &mantissa)) return 0;
  if (mantissa < 1 << 15) mantissa = 0; /* too weak to move anything */
  *c = spring_class_make(rest, mantissa, shift, compression_only);
  return 1;
}

/* 2 k h^2 / m in Q12, at most a whole projection. */
static int push_share(const draft *d, int32_t *push) {
  const int64_t per_second = (int64_t)d->scene->rate_hz * d->substeps;
  const exact twice = exact_mul(exact_div(d->scene->sheet.structural, d->particle_mass),
                                exact_make(2, per_second));
  const exact share = exact_div(twice, exact_make(per_second, 1));
  *push = 4096;
  return exact_compare(share, exact_make(1, 1)) >= 0 ||
         draft_word(d, "structural", share, 12, 0, 4096, push);
}

/* The rest length of a link that changes sides by `across`: the crimp's share, Q16, of the way that
 * this is longer. */
static int32_t crimped(int32_t spacing, int32_t across, int32_t share) {
  const int64_t way =
      (int64_t)exact_sqrt((uint64_t)((int64_t)spacing * spacing + (int64_t)across * across));
  return (int32_t)(spacing + fx_round64((way - spacing) * share, 16));
}

/* The same for yarns with a stiffness: the strain, and so the tension, is the same before and after a
 * split if the strain is in the middle of what splits. */
static int32_t kept(const draft *d, int32_t spacing, int32_t across) {
  const exact sum = exact_add(d->scene->sheet.transition_min, d->scene->sheet.transition_max);
  const exact stretched = exact_add(exact_make(1, 1), exact_div(sum, exact_make(2, 1)));
  int64_t apart = across;
  (void)exact_to_fixed(exact_div(exact_make(across, 1), stretched), 0, &apart);
  return crimped(spacing, (int32_t)apart, 65536);
}

int draft_classes(const draft *d, link_class *links, spring_class *springs) {
  int32_t push = 0;
  int32_t thickness = 0;
  int32_t crimp = 0;
  if (!push_share(d, &push) || !draft_length(d, 0, d->scene->sheet.thickness, &thickness) ||
      !draft_word(d, "crimp", d->scene->sheet.crimp, 16, 0, 65536, &crimp))
    return 0;
  for (uint32_t axis = 0; axis < 2; ++axis) {
    links[CLASS_WEFT + axis] = link_class_make(d->spacing[axis], push);
    for (uint32_t halves = 1; halves < 3 && d->scene->sheet.yarns != 0; ++halves) {
      const int32_t across = (int32_t)halves * (thickness / 2);
      const int keeps = scene_has_stretch(d->scene) && !d->scene->sheet.has_crimp;
      links[CLASS_WEFT + axis + halves * CLASS_CRIMP] =
          link_class_make(keeps ? kept(d, d->spacing[axis], across)
                                : crimped(d->spacing[axis], across, crimp),
                          push);
    }
    if (!make_spring(d, "bend", d->scene->sheet.bend, 2 * d->spacing[axis], 0, &springs[1 + axis]))
      return 0;
  }
  const uint64_t diagonal2 = (uint64_t)((int64_t)d->spacing[0] * d->spacing[0]) +
                             (uint64_t)((int64_t)d->spacing[1] * d->spacing[1]);
  const int32_t diagonal = (int32_t)exact_sqrt(diagonal2);
  if (!make_spring(d, "shear", d->scene->sheet.shear, diagonal, 1, &springs[CLASS_SHEAR])) return 0;
  return d->scene->sheet.yarns == 0 ||
         make_spring(d, "shear", exact_div(d->scene->sheet.shear, exact_make(2, 1)), diagonal, 1,
                     &springs[CLASS_SHEAR_HALF]);
}
