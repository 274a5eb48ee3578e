/* SPDX-License-Identifier: Apache-2.0 */
/* How many inner steps the stress needs, how much of the stiffness is left where they are too many, and
 * the gains of motion that follow. */
#include <string.h>

#include "tools/build/triangles.h"

/* Of all triangles, Q24 lu: the shorter one of the shortest side and the least height times root 2, as
 * a right triangle has both. */
static int64_t least_edge(const sheet_mesh *s, int64_t *least_height, int64_t *least_area) {
  int64_t least = INT64_MAX;
  *least_height = *least_area = INT64_MAX;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t) {
    uint64_t longest = 0;
    for (uint32_t k = 0; k < 3; ++k) {
      const sheet_point a = sheet_at(s, s->triangle[t].v[k]);
      const sheet_point b = sheet_at(s, s->triangle[t].v[sheet_next(k)]);
      const uint64_t squared = fx_square(fx_sub(b.u, a.u)) + fx_square(fx_sub(b.v, a.v));
      if (squared > longest) longest = squared;
      least = fx_clamp64(exact_sqrt(squared), 0, least);
    }
    const sheet_triangle *f = &s->triangle[t];
    const int64_t twice = sheet_twice_area(sheet_at(s, f->v[0]), sheet_at(s, f->v[1]), sheet_at(s, f->v[2]));
    const int64_t height = twice / (int64_t)exact_sqrt(longest);
    *least_height = fx_clamp64(height, 0, *least_height);
    *least_area = fx_clamp64(s->area[t], 0, *least_area);
    least = fx_clamp64(height * 92682 >> 16, 0, least);
  }
  return least;
}

/* Entry by which the stress grows: where c grows with the strain, the stress does by c and by what c
 * gains, at a full level twice what c differs from that at rest. */
static exact stiffest(const fabric_draft *f) {
  exact most = exact_make(0, 1);
  for (uint32_t r = 0; r < FABRIC_ROWS; ++r)
    for (uint32_t n = 0; n < FABRIC_ENTRIES; ++n) {
      const exact c = f->stretch[r][n];
      const exact grown = exact_sub(exact_add(c, c), f->stretch[0][n]);
      if (exact_compare(c, most) > 0) most = c;
      if (exact_compare(grown, most) > 0) most = grown;
    }
  return most;
}

/* A sheet that is longer by l is stiffer by 3 l + 3/2 l^2: by the square of its length, and by its tension,
 * which turns with it. So waves are faster by at most 3/2 l, and what hangs loose by a tear has no neighbours
 * that hold it back. It is no longer than strain_limit lets it be; without one, than what tears it makes it,
 * and C l is that tension. In steps of 1/64, so that exact numbers stay short. */
static exact faster_drawn(const scene *s) {
  const fabric_draft *f = &s->triangles.cloth;
  exact l = s->triangles.strain_limit;
  int64_t steps = 0;
  exact most = exact_make(0, 1);
  for (uint32_t n = 0; n < TOUGHNESS_DIRECTIONS; ++n)
    if (exact_compare(f->strength[n], most) > 0) most = f->strength[n];
  if (l.numerator == 0) l = exact_div(most, stiffest(f));
  if (most.numerator != 0 && exact_to_fixed(exact_mul(l, exact_make(3, 2)), 6, &steps)) ++steps;
  return exact_make(64 + fx_clamp64(steps, 0, 64 * 15), 64);
}

/* N = 1.7e-3 root(C / rho) / edge in a millisecond, whatever its units, and more by what a drawn sheet takes:
 * its square, of a tick. */
static exact steps_squared(const draft *d, int64_t edge) {
  const scene *s = d->scene;
  /* N/m over g/cm2 is 1000 cm2/s2; the edge is in Q24 lu, taken to 2^-12 of it so that squares fit */
  const exact speed = exact_mul(exact_div(stiffest(&s->triangles.cloth), s->triangles.cloth.density),
                                exact_make(1000, 1));
  const exact length = exact_div(exact_make(edge >> 12, 4096), d->lu_per_cm);
  const exact per_tick = exact_mul(exact_make(17, 10 * (int64_t)s->rate_hz), faster_drawn(s));
  const exact crossed = exact_div(exact_div(speed, length), length);
  return exact_mul(crossed, exact_mul(per_tick, per_tick));
}

static int find_steps(draft *d, int64_t edge) {
  const scene *s = d->scene;
  const uint32_t most = s->triangles.inner_steps > d->substeps ? s->triangles.inner_steps : d->substeps;
  const exact squared = steps_squared(d, edge);
  const exact bound = exact_make((int64_t)most * most, 1);
  int64_t fixed;
  d->stiffness = exact_make(1, 1);
  if (!exact_valid(squared))
    return draft_refuse(d, s->triangles.line, "material: its stiffness over its density is out of range");
  if (exact_compare(squared, bound) > 0) {
    if (!exact_to_fixed(exact_div(bound, squared), 30, &fixed) || fixed < 1)
      return draft_refuse(d, s->triangles.line, "inner_steps: too few by far for this material");
    d->stiffness = exact_make(fixed, 1 << 30);
    d->inner = most / d->substeps;
    return 1;
  }
  if (!exact_to_fixed(squared, 16, &fixed))
    return draft_refuse(d, s->triangles.line, "material: its stiffness over its density is out of range");
  const uint32_t steps = (exact_sqrt((uint64_t)fixed) + 255) / 256; /* root of Q16: Q8 */
  d->inner = (steps + d->substeps - 1) / d->substeps;
  if (d->inner == 0) d->inner = 1;
  return 1;
}

/* What inner steps of this length can bear: heights of the edge that calls for them over root 2, and a
 * little for rounding. What is lower is left 7/10 of that (rt/stage/pull.c). */
static int32_t steepest(const draft *d, int64_t edge) {
  const int64_t steps = (int64_t)d->inner * d->substeps;
  const exact length = exact_make(edge >> 12, 4096);
  const exact slack = exact_div(exact_make(steps * steps, 1), exact_mul(steps_squared(d, edge), d->stiffness));
  int64_t fixed;
  if (!exact_to_fixed(exact_div(exact_div(exact_mul(slack, exact_make(21, 10)), length), length), 12, &fixed))
    return INT32_MAX;
  return (int32_t)fx_clamp64(fixed, 1 << 10, INT32_MAX);
}

static int fill_fabric(const draft *d, fabric *f) {
  const fabric_draft *from = &d->scene->triangles.cloth;
  int64_t fixed;
  memset(f, 0, sizeof *f);
  if (!exact_to_fixed(d->stiffness, 30, &fixed)) return 0;
  f->scale = (int32_t)fixed;
  for (uint32_t r = 0; r < FABRIC_ROWS; ++r)
    for (uint32_t n = 0; n < FABRIC_ENTRIES; ++n)
      if (!draft_word(d, "stretch", exact_mul(from->stretch[r][n], d->stiffness), 12, n == 1 ? 0 : 1,
                      FABRIC_STIFF_MAX, &f->stretch[r][n]))
        return 0;
  for (uint32_t b = 0; b < FABRIC_BENDS; ++b)
    for (uint32_t n = 0; n < FABRIC_CURVES; ++n)
      if (!draft_word(d, "bend", from->bend[b][n], 40, 0, INT32_MAX, &f->bend[b][n])) return 0;
  return 1;
}

static int fill_toughness(const draft *d, toughness *t) {
  const fabric_draft *from = &d->scene->triangles.cloth;
  for (uint32_t n = 0; n < TOUGHNESS_DIRECTIONS; ++n)
    if (!draft_word(d, "tear", from->strength[n], 12, 0, LIMIT_STRENGTH, &t->strength[n])) return 0;
  return draft_word(d, "relax", exact_mul(from->relax, exact_make((int64_t)d->scene->rate_hz, 1)), 0, 0,
                    LIMIT_RELAX, &t->relax);
}

/* cm/s to lu a tick */
static int fill_blades(const draft *d, blade_params *b) {
  const fabric_draft *from = &d->scene->triangles.cloth;
  const exact a_tick = exact_div(exact_mul(from->cut, d->lu_per_cm), exact_make((int64_t)d->scene->rate_hz, 1));
  for (uint32_t n = 1; n < BLADE_CLOTHS; ++n) b->speed[n] = BLADE_NEVER;
  b->cuts_max = (int32_t)d->scene->limits.cuts_per_tick;
  return draft_word(d, "cut", a_tick, 24, 0, BLADE_SPEED_MAX, &b->speed[0]);
}

/* value = mantissa * 2^-shift, with 31 bits. */
static int mantissa_of(const draft *d, const char *key, exact value, unsigned least, unsigned most,
                       int32_t *mantissa, int32_t *shift) {
  int64_t fixed = 0;
  unsigned s = least;
  while (s < most && (!exact_to_fixed(value, s, &fixed) || fixed < 1 << 30)) ++s;
  *shift = (int32_t)s;
  return draft_word(d, key, value, s, 1 << 30, INT32_MAX, mantissa);
}

/* Impulses of an inner step, as they stand in rt/stage/pull.c: h^2 / (i m) in s^2 / kg. */
static exact per_newton(const draft *d) {
  const int64_t per_second = (int64_t)d->scene->rate_hz * d->substeps;
  const exact mass = exact_mul(d->particle_mass, exact_make(d->inner, 1));
  return exact_div(exact_div(exact_div(exact_make(1000, 1), mass), exact_make(per_second, 1)),
                   exact_make(per_second, 1));
}

/* Bending comes once in so many inner steps, as far as it stays stable: a plate of stiffness D has
 * vibrations of up to root(150 D / rho) / edge^2 on such a mesh, and a step may be 1 / 1.5 of 2 over that.
 * Inner steps are made a multiple of it. Where one is too long, bending comes in each, and *share of D,
 * Q16, is left. */
static int find_bending(draft *d, int64_t edge, cloth_params *c, int64_t *share) {
  const scene *s = d->scene;
  const fabric_draft *cloth = &s->triangles.cloth;
  exact most = exact_make(0, 1);
  *share = 65536;
  for (uint32_t b = 0; b < FABRIC_BENDS; ++b)
    for (uint32_t n = 0; n < FABRIC_CURVES; ++n)
      if (exact_compare(cloth->bend[b][n], most) > 0) most = cloth->bend[b][n];
  if (most.numerator == 0) return 1;
  /* in SI: edge^2 times inner steps a second, Q16; density over D, Q4; then the square of inner steps in
   * the longest that bending can take, Q16. Rounded on the way, so that the exact numbers stay short */
  const exact length = exact_mul(exact_make(edge >> 12, 4096), exact_make(d->lu_um, 1000000));
  const exact inner = exact_make((int64_t)s->rate_hz * d->substeps * d->inner, 1);
  int64_t crossed;
  int64_t light;
  int64_t steps;
  if (!exact_to_fixed(exact_mul(exact_mul(length, length), inner), 16, &crossed) ||
      !exact_to_fixed(exact_div(exact_mul(cloth->density, exact_make(10, 1)), most), 4, &light))
    return draft_refuse(d, s->triangles.line, "bend: out of range for this density and these cells");
  const exact once = exact_make(crossed, 1 << 16);
  const exact wanted = exact_mul(exact_mul(exact_make(light, 16), exact_make(118, 10000)), exact_mul(once, once));
  if (!exact_to_fixed(wanted, 16, &steps)) steps = (int64_t)1 << 40;
  const int64_t every = (int64_t)exact_sqrt((uint64_t)(steps < 0 ? 0 : steps)) >> 8;
  c->bend_every = (int32_t)fx_clamp64(every, 1, d->inner);
  if (every == 0) *share = steps;
  const uint32_t period = (uint32_t)c->bend_every;
  d->inner = (d->inner + period - 1) / period * period;
  return 1;
}

static int fill_bending(const draft *d, int64_t share, fabric *f, cloth_params *c) {
  const exact lu = exact_make(d->lu_um, 1000000);
  if (c->bend_every == 0) return 1;
  for (uint32_t b = 0; b < FABRIC_BENDS; ++b)
    for (uint32_t n = 0; n < FABRIC_CURVES; ++n)
      f->bend[b][n] = (int32_t)fx_round64(fx_mul_wide(f->bend[b][n], (int32_t)share), 16);
  /* k = 24/5 D and sin(t/2): 24/5 every h^2 / (i m lu^2) 2^34 of 2^-40 N m */
  const exact gain = exact_mul(exact_div(exact_div(per_newton(d), lu), lu), exact_make(24 * c->bend_every, 5 * 64));
  if (!mantissa_of(d, "bend", gain, 1, 60, &c->bend_gain, &c->bend_shift)) return 0;
  /* curvature in 1 / lu to steps of 5 / m, Q24 */
  return draft_word(d, "bend", exact_div(exact_make(1, 5), lu), 24, 0, INT32_MAX, &c->curve_gain);
}

static int fill_load(const draft *d, const fray_world *w, const scene_load *from, cloth_load *to) {
  static const int32_t way[4][2] = {{0, 1}, {0, -1}, {-1, 0}, {1, 0}}; /* top bottom left right */
  const exact one = exact_make(1, 1);
  const exact h = d->scene->triangles.weft_half_tangent;
  const exact whole = exact_add(one, exact_mul(h, h));
  int64_t c;
  int64_t s;
  int64_t most = INT64_MIN;
  if (!exact_to_fixed(exact_div(exact_sub(one, exact_mul(h, h)), whole), 30, &c) ||
      !exact_to_fixed(exact_div(exact_add(h, h), whole), 30, &s))
    return 0;
  const int32_t *n = way[from->side];
  to->u = (int32_t)(n[0] * c + n[1] * s);
  to->v = (int32_t)(n[1] * c - n[0] * s);
  for (uint32_t p = 0; p < w->particles; ++p) {
    const int64_t at = fx_round64(fx_mul_wide(to->u, w->sheet.u[p]) + fx_mul_wide(to->v, w->sheet.v[p]), 30);
    if (at > most) most = at;
  }
  to->at = (int32_t)most;
  for (uint32_t a = 0; a < 3; ++a)
    if (!draft_word(d, "load", exact_mul(from->force[a], per_newton(d)), 26, -LIMIT_LOAD, LIMIT_LOAD,
                    &to->force[a]))
      return 0;
  return 1;
}

/* Air of 1.2 kg/m3; p lu^3 s / (12 m) in SI, times the coefficient, (rt/stage/blow.c). Both
 * gains with the shift of the greater. */
static int fill_wind(const draft *d, cloth_params *c) {
  const scene *s = d->scene;
  const int64_t per_second = (int64_t)s->rate_hz * d->substeps;
  const exact lu_m = exact_make(d->lu_um, 1000000);
  const exact grams = exact_mul(d->particle_mass, exact_make(12, 1));
  const exact gain = exact_mul(exact_mul(exact_div(exact_make(1200 * (int64_t)d->substeps, 1), grams), lu_m),
                               exact_mul(lu_m, lu_m));
  const exact most = exact_compare(s->triangles.wind_normal, s->triangles.wind_drag) > 0
                         ? s->triangles.wind_normal : s->triangles.wind_drag;
  int32_t mantissa;
  for (uint32_t a = 0; a < 3; ++a)
    if (!draft_word(d, "wind", exact_div(exact_mul(s->wind[a], d->lu_per_cm), exact_make(per_second, 1)), 28,
                    -LIMIT_WIND, LIMIT_WIND, &c->wind[a]))
      return 0;
  if (!s->has_wind || most.numerator == 0) return 1;
  const exact value = exact_mul(gain, exact_make(16, 1)); /* from |N| w^2 in Q24 to Q28 */
  if (!mantissa_of(d, "wind", exact_mul(value, most), 1, 61, &mantissa, &c->wind_shift)) return 0;
  const unsigned shift = (unsigned)c->wind_shift;
  return draft_word(d, "wind_normal", exact_mul(value, s->triangles.wind_normal), shift, 0, INT32_MAX,
                    &c->wind_normal) &&
         draft_word(d, "wind_drag", exact_mul(value, s->triangles.wind_drag), shift, 0, INT32_MAX, &c->wind_drag);
}

/* 64 ms, or half as much more or less. */
static int32_t habit_of(uint32_t rate_hz) {
  int32_t shift = 1;
  while (shift < 16 && ((uint64_t)1500 << shift) < (uint64_t)64 * rate_hz) ++shift;
  return shift;
}

int draft_cloths(draft *d, fray_world *w) {
  const scene *s = d->scene;
  sheet_params *mesh = WRITABLE(sheet_params, w->sheet.params);
  cloth_params *c = WRITABLE(cloth_params, w->cloths);
  int64_t height;
  int64_t area;
  int64_t share;
  const int64_t edge = least_edge(&w->sheet, &height, &area);
  mesh->triangles = w->sheet.state->triangles;
  mesh->cloths = 1;
  mesh->height_min = (int32_t)fx_clamp64(height / 4, 1 << 15, 1 << 24);
  mesh->area_min = (int32_t)fx_clamp64(area / 16, 1 << 8, 1 << 27);
  if (height < mesh->height_min || area < mesh->area_min)
    return draft_refuse(d, s->triangles.line, "mesh: a triangle that is too flat; expected cells nearer to "
                        "squares, or another seed");
  if (!find_steps(d, edge) || !find_bending(d, edge, c, &share)) return 0;
  if (!fill_fabric(d, WRITABLE(fabric, w->fabrics)) ||
      !fill_toughness(d, WRITABLE(toughness, w->toughnesses)) ||
      (world_has_blades(w) && !fill_blades(d, WRITABLE(blade_params, w->blades))))
    return 0;
  c->inner = (int32_t)d->inner;
  const exact cell = exact_mul(exact_mul(s->triangles.edge[0], d->lu_per_cm),
                               exact_mul(s->triangles.edge[1], d->lu_per_cm));
  if (!draft_word(d, "edge", exact_mul(cell, exact_make(3, 1)), 30, 1 << 8, 1 << 30, &c->unit)) return 0;
  /* gain of an area in lu^2: Q30 impulse from N/m, see stress_run */
  if (!mantissa_of(d, "material", exact_mul(per_newton(d), exact_make(1 << 18, 1)), 8, 60, &c->pull_gain,
                   &c->pull_shift))
    return 0;
  c->steep = steepest(d, edge);
  c->bend_shift = c->wind_shift = 1;
  c->habit_shift = habit_of(s->rate_hz);
  if (s->triangles.strain_limit.numerator != 0 &&
      !draft_word(d, "strain_limit", exact_add(exact_make(1, 1), s->triangles.strain_limit), 16, 1 << 16, 1 << 20,
                  &c->limit))
    return 0;
  if (!fill_wind(d, c) || !fill_bending(d, share, WRITABLE(fabric, w->fabrics), c)) return 0;
  for (uint32_t n = 0; n < s->load_count; ++n)
    if (!fill_load(d, w, &s->loads[n], &c->load[n])) return 0;
  return 1;
}
