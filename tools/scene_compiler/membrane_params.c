/* SPDX-License-Identifier: Apache-2.0 */
/* The number of elastic steps that the stress needs, the factor of the stiffness where they would be too
 * many, and the gains that follow. */
#include <string.h>

#include "rt/membrane/membrane.h"
#include "tools/scene_compiler/membrane.h"

/* Over all triangles, Q24 lu: the minimum of the edges and of the heights times root 2 (in a right isosceles
 * triangle both are the same). */
static int64_t min_edge(const trimesh *s, int64_t *min_height, int64_t *min_area) {
  int64_t min = INT64_MAX;
  *min_height = *min_area = INT64_MAX;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t) {
    uint64_t longest = 0;
    for (uint32_t k = 0; k < 3; ++k) {
      const trimesh_point a = trimesh_at(s, s->triangle[t].v[k]);
      const trimesh_point b = trimesh_at(s, s->triangle[t].v[trimesh_next(k)]);
      const uint64_t squared = fx_square(fx_sub(b.u, a.u)) + fx_square(fx_sub(b.v, a.v));
      if (squared > longest) longest = squared;
      min = fx_clamp64(exact_sqrt(squared), 0, min);
    }
    const trimesh_triangle *f = &s->triangle[t];
    const int64_t twice =
        trimesh_twice_area(trimesh_at(s, f->v[0]), trimesh_at(s, f->v[1]), trimesh_at(s, f->v[2]));
    const int64_t height = twice / (int64_t)exact_sqrt(longest);
    *min_height = fx_clamp64(height, 0, *min_height);
    *min_area = fx_clamp64(s->area[t], 0, *min_area);
    min = fx_clamp64(height * 92682 >> 16, 0, min);
  }
  return min;
}

static exact larger(exact a, exact b) { return exact_compare(a, b) > 0 ? a : b; }

/* Of 20 bits, and a little more, so that products stay short. Not exact_valid() above 2^63. */
static exact rounded_up(exact a) {
  unsigned shift = 0;
  int64_t fixed = 0;
  if (!exact_to_fixed(a, 0, &fixed)) return exact_make(0, 0);
  while (shift < 40 && fixed < 1 << 20 && exact_to_fixed(a, shift + 1, &fixed)) ++shift;
  return exact_make(fixed + 1, (int64_t)1 << shift);
}

/* What c times the largest entry of its row, Q30 of 0..1, resists at most: the greater eigenvalue of c11, c12
 * and c22, of a strain both ways, or 2 c33, of shear. Rounded up to 1/4096. */
static exact stiffest_mode(const int64_t c[MATERIAL_ENTRIES]) {
  const int64_t apart = (c[0] - c[2]) / 2;
  const uint64_t squared = (uint64_t)(apart * apart) + (uint64_t)(c[1] * c[1]);
  const int64_t both = (c[0] + c[2]) / 2 + (int64_t)exact_sqrt(squared) + 2;
  const int64_t most = fx_clamp64(both, 2 * c[3], INT64_MAX);
  return exact_make((most + (1 << 18) - 1) >> 18, 4096);
}

/* The steepest slope of stress over strain: the stiffest mode of a row, the entry c itself, and where c grows
 * with the strain also 2 c - c(rest): c plus the growth of c, at the end of the table's range. */
static int find_stiffest(const material_spec *f, exact *stiffest) {
  exact max = exact_make(0, 1);
  for (uint32_t r = 0; r < MATERIAL_ROWS; ++r) {
    const exact *row = f->stretch[r];
    exact entry = exact_make(0, 1);
    int64_t c[MATERIAL_ENTRIES];
    for (uint32_t n = 0; n < MATERIAL_ENTRIES; ++n) {
      const exact grown = exact_sub(exact_add(row[n], row[n]), f->stretch[0][n]);
      if (!exact_valid(row[n]) || !exact_valid(grown)) return 0;
      entry = larger(entry, row[n]);
      max = larger(max, grown);
    }
    for (uint32_t n = 0; n < MATERIAL_ENTRIES; ++n)
      if (!exact_to_fixed(exact_div(row[n], entry), 30, &c[n])) return 0;
    const exact mode = rounded_up(exact_mul(entry, stiffest_mode(c)));
    if (!exact_valid(mode)) return 0;
    max = larger(max, entry);
    const exact near = exact_mul(max, exact_make(4097, 4096)); /* of which mode is rounded */
    if (!exact_valid(near) || exact_compare(mode, near) > 0) max = mode;
  }
  *stiffest = max;
  return 1;
}

/* The softest of c11, c22 and 2 c33 of drawn cloth: what resists a strain of each kind. */
static exact softest_mode(const material_spec *f) {
  exact softest = exact_make(0, 1);
  for (uint32_t r = 1; r < MATERIAL_ROWS; ++r)
    for (uint32_t n = 0; n < MATERIAL_ENTRIES; ++n) {
      const exact c = n == 3 ? exact_add(f->stretch[r][n], f->stretch[r][n]) : f->stretch[r][n];
      if (n == 1 || c.numerator <= 0) continue;
      if (softest.numerator == 0 || exact_compare(c, softest) < 0) softest = c;
    }
  return softest;
}

/* The strain to which the largest load may draw cloth. */
static exact loaded_strain(const scene *s) {
  enum { BITS = 6 };
  const exact softest = softest_mode(&s->membrane.cloth);
  uint64_t most = 0;
  for (uint32_t n = 0; n < s->load_count; ++n) {
    uint64_t squared = 0;
    for (uint32_t a = 0; a < 3; ++a) {
      int64_t part = 0;
      (void)exact_to_fixed(s->loads[n].force[a], BITS, &part);
      squared += (uint64_t)(part * part);
    }
    if (squared > most) most = squared;
  }
  if (most == 0 || softest.numerator == 0) return exact_make(0, 1);
  return exact_div(exact_make((int64_t)exact_sqrt(most) + 1, 1 << BITS), rounded_up(softest));
}

/* Cloth stretched by l is stiffer by 3 l + 3/2 l^2: by the square of its length, and by its tension,
 * which rotates with it. Waves are then faster by at most 3/2 l, which matters along tears, where no
 * neighbour restrains a vertex. l is at most strain_limit; without one, the strain at which it tears:
 * tension C l is the strength; or what loads draw it to. In steps of 1/64, so that exact numbers stay short. */
static exact faster_drawn(exact l) {
  int64_t steps = 0;
  if (!exact_to_fixed(exact_mul(l, exact_make(3, 2)), 6, &steps)) return exact_make(16, 1);
  return exact_make(64 + fx_clamp64(steps + 1, 0, 64 * 15), 64);
}

static exact strength_of(const material_spec *f) {
  exact max = exact_make(0, 1);
  for (uint32_t n = 0; n < TEAR_STRENGTH_DIRECTIONS; ++n) max = larger(max, f->strength[n]);
  return max;
}

/* Of cloth that tears or has a limit. */
static exact faster_torn(const scene *s, exact stiffest) {
  const exact max = strength_of(&s->membrane.cloth);
  exact l = s->membrane.strain_limit;
  /* its slope does not grow, but for a triangle that is drawn far one way and pressed flat the other */
  if (s->membrane.cloth.corotational)
    return exact_compare(s->membrane.cloth.poisson, exact_make(2, 5)) > 0 ? exact_make(11, 10) : exact_make(1, 1);
  if (max.numerator == 0 && l.numerator == 0) return exact_make(1, 1);
  if (l.numerator == 0) l = exact_div(max, stiffest);
  if (!exact_valid(l)) l = exact_div(rounded_up(max), rounded_up(stiffest));
  return faster_drawn(l);
}

/* Of other cloth, which loads draw: the factor of its steps that lets strain_law.h begin beyond that. */
static exact faster_loaded(const scene *s) {
  const exact max = strength_of(&s->membrane.cloth);
  if (s->membrane.cloth.corotational || s->load_count == 0 || max.numerator != 0 || s->membrane.strain_limit.numerator != 0)
    return exact_make(1, 1);
  return faster_drawn(loaded_strain(s));
}

/* The edge of a right isosceles triangle that is as stiff as the stiffest of these, Q24 lu. */
static int64_t stress_edge(const trimesh *s, int64_t edge) {
  int64_t min = edge;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t) {
    const trimesh_weights weights = trimesh_weights_of(s, t);
    const trimesh_gram gram = trimesh_gram_of(&weights);
    const int64_t as = exact_sqrt(((uint64_t)3 << 60) / trimesh_norm2(&gram));
    /* it is rounded: square cells keep their own edge */
    if (as < min - min / 1024) min = as;
  }
  return min;
}

/* The square of the steps of a tick. N = 1.7e-3 root(C / rho) / edge in a millisecond, in SI, times the
 * factor of stretched cloth. */
static exact steps_squared(const draft *d, int64_t edge, exact stiffest) {
  const scene *s = d->scene;
  /* N/m over g/cm2 is 1000 cm2/s2; the edge is in Q24 lu, taken to 2^-12 of it so that squares fit */
  const exact speed = exact_mul(exact_div(stiffest, s->membrane.cloth.density), exact_make(1000, 1));
  const exact length = exact_div(exact_make(edge >> 12, 4096), d->lu_per_cm);
  const exact per_tick = exact_mul(exact_make(17, 10 * (int64_t)s->rate_hz), faster_torn(s, stiffest));
  const exact crossed = exact_div(exact_div(speed, length), length);
  return exact_mul(crossed, exact_mul(per_tick, per_tick));
}

static int refuse_stiffness(const draft *d) {
  const char *key = "stretch";
  const uint32_t block = draft_material(d, &key);
  return draft_expected(d, block, key,
                        "a stiffness over a density that measured cloths come near to, in numbers of "
                        "fewer digits");
}

enum { STEPS_BITS = 30, SCALE_MIN = 64 /* Q30: rounded by less than 1 % */ };

static uint32_t elastic_steps_max(const draft *d) {
  const uint32_t max = d->scene->membrane.elastic_steps_max;
  return max > d->substeps ? max / d->substeps : 1;
}

/* And the square of the steps that the stress wants in a tick, STEPS_BITS, once the stiffness is scaled. */
static int find_steps(draft *d, int64_t edge, int64_t *wanted) {
  const scene *s = d->scene;
  const int64_t steps_max = (int64_t)elastic_steps_max(d) * d->substeps;
  const exact bound = exact_make(steps_max * steps_max, 1);
  exact stiffest;
  int64_t fixed;
  d->stiffness = exact_make(1, 1);
  if (!find_stiffest(&s->membrane.cloth, &stiffest)) return refuse_stiffness(d);
  exact squared = steps_squared(d, edge, stiffest);
  if (!exact_valid(squared)) squared = steps_squared(d, edge, rounded_up(stiffest));
  if (!exact_valid(squared)) return refuse_stiffness(d);
  if (exact_compare(squared, bound) > 0) {
    if (!exact_to_fixed(exact_div(bound, squared), 30, &fixed) || fixed < SCALE_MIN)
      return draft_expected(d, BLOCK_CLOTH, "elastic_steps_max",
                            "more for so stiff a material, or a softer one");
    d->stiffness = exact_make(fixed, 1 << 30);
    d->elastic_steps = elastic_steps_max(d);
    *wanted = steps_max * steps_max * ((int64_t)1 << STEPS_BITS);
    return 1;
  }
  const exact faster = faster_loaded(s);
  const exact loaded = exact_mul(rounded_up(squared), exact_mul(faster, faster));
  if (faster.numerator != faster.denominator)
    squared = exact_valid(loaded) && exact_compare(loaded, bound) < 0 ? loaded : bound; /* loads scale no stiffness */
  if (!exact_to_fixed(squared, STEPS_BITS, wanted) || !exact_to_fixed(squared, 16, &fixed))
    return refuse_stiffness(d);
  const uint32_t steps = (exact_sqrt((uint64_t)fixed) + 255) / 256; /* root of Q16: Q8 */
  d->elastic_steps = (steps + d->substeps - 1) / d->substeps;
  if (d->elastic_steps == 0) d->elastic_steps = 1;
  return 1;
}

/* The largest trimesh_norm2() that elastic steps of this length bear: 3 over the square of that edge, and
 * 1/20 more for rounding. What is beyond the word is more than a triangle may have. */
static int32_t norm2_borne(const draft *d, int64_t edge, int64_t wanted) {
  const int64_t steps = (int64_t)d->elastic_steps * d->substeps;
  const int64_t length = edge >> 12;
  int64_t more; /* of the square of the steps, Q16 */
  int64_t borne;
  if (!exact_mul_div(steps * steps, (int64_t)1 << (STEPS_BITS + 16), fx_clamp64(wanted, 1, INT64_MAX), &more) ||
      !exact_mul_div(more, (int64_t)63 << 20, 20 * length * length, &borne))
    return INT32_MAX;
  return (int32_t)fx_clamp64(borne, 1 << 10, INT32_MAX);
}

/* A number of the material: of its own key, or of the word behind `material`. */
static draft_number number_of(const draft *d, const char *key, unit_quantity quantity, exact given) {
  const uint32_t block = draft_material(d, &key);
  return draft_given(block, key, quantity, given);
}

static int fill_material(const draft *d, material_table *f) {
  const exact grams = exact_make(1000, 1); /* N/m to g/s2, the unit of scene.h's ranges */
  const material_spec *from = &d->scene->membrane.cloth;
  int64_t fixed;
  memset(f, 0, sizeof *f);
  if (!exact_to_fixed(d->stiffness, 30, &fixed)) return 0;
  f->scale = (int32_t)fixed;
  for (uint32_t r = 0; r < MATERIAL_ROWS; ++r)
    for (uint32_t n = 0; n < MATERIAL_ENTRIES; ++n)
      if (!draft_fixed_point(d,
                             number_of(d, "stretch", UNIT_STIFFNESS, exact_mul(from->stretch[r][n], grams)),
                             exact_mul(from->stretch[r][n], d->stiffness), 12, n == 1 ? 0 : 1,
                             MATERIAL_STIFF_MAX, &f->stretch[r][n]))
        return 0;
  return 1;
}

static int fill_tear_strength(const draft *d, tear_strength *t) {
  const material_spec *from = &d->scene->membrane.cloth;
  for (uint32_t n = 0; n < TEAR_STRENGTH_DIRECTIONS; ++n)
    if (!draft_fixed_point(
            d, number_of(d, "tear", UNIT_STIFFNESS, exact_mul(from->strength[n], exact_make(1000, 1))),
            from->corotational ? exact_mul(from->strength[n], d->stiffness) : from->strength[n], 12, 0,
            MAX_TEAR_STRENGTH, &t->strength[n]))
      return 0;
  return draft_fixed_point(d, number_of(d, "tear_interval", UNIT_TIME, from->tear_interval),
                           exact_mul(from->tear_interval, exact_make((int64_t)d->scene->rate_hz, 1)), 0, 0,
                           MAX_TEAR_COOLDOWN, &t->cooldown);
}

/* cm/s to lu a tick */
static int fill_blades(const draft *d, blade_params *b) {
  const material_spec *from = &d->scene->membrane.cloth;
  const exact a_tick =
      exact_div(exact_mul(from->cut_speed, d->lu_per_cm), exact_make((int64_t)d->scene->rate_hz, 1));
  for (uint32_t n = 1; n < BLADE_CLOTHS; ++n) b->speed[n] = BLADE_NEVER;
  b->tears_max = (int32_t)d->scene->limits.tears_per_tick;
  return draft_fixed_point(d, number_of(d, "cut_speed", UNIT_SPEED, from->cut_speed), a_tick, 24, 0,
                           BLADE_SPEED_MAX, &b->speed[0]);
}

/* Strength as stiffness is scaled; the length is at least two cells, and at most what
 * STRESS_AVERAGE_TRIANGLES cover: a circle of pi 32 cells. */
static int fill_cracks(const draft *d, crack_params *c) {
  const material_spec *from = &d->scene->membrane.cloth;
  const exact *cell = d->scene->membrane.cell;
  const exact least = exact_mul(larger(cell[0], cell[1]), exact_make(2, 1));
  const exact length = from->average.numerator != 0 ? from->average : least;
  const exact strength = exact_mul(exact_mul(from->breaks, from->thickness), exact_make(1, 100));
  const exact most = exact_mul(exact_mul(cell[0], cell[1]), exact_make(32, 1));
  c->many = from->many_cracks;
  if (exact_compare(length, least) < 0 || exact_compare(exact_mul(length, length), most) > 0) {
    const char *key = "average";
    const uint32_t block = draft_material(d, &key);
    return draft_expected(d, block, key, "a length of 2 to 5 cells");
  }
  return draft_fixed_point(d, number_of(d, "breaks", UNIT_PRESSURE, from->breaks),
                           exact_mul(strength, d->stiffness), 12, 1, MAX_TEAR_STRENGTH, &c->breaks) &&
         draft_fixed_point(d, number_of(d, "average", UNIT_LENGTH, length), exact_mul(length, d->lu_per_cm), 24,
                           1 << 10, CRACK_AVERAGE_MAX, &c->average);
}

/* value = mantissa * 2^-shift, with 31 bits. */
static int mantissa_of(const draft *d, draft_number n, exact value, unsigned min, unsigned max,
                       int32_t *mantissa, int32_t *shift) {
  int64_t fixed = 0;
  unsigned s = min;
  while (s < max && (!exact_to_fixed(value, s, &fixed) || fixed < 1 << 30)) ++s;
  *shift = (int32_t)s;
  return draft_fixed_point(d, n, value, s, 1 << 30, INT32_MAX, mantissa);
}

/* Impulses of an elastic step as in rt/membrane/membrane_gains.c: h^2 / (i m) in s^2 / kg. */
static exact per_newton(const draft *d) {
  const int64_t per_second = (int64_t)d->scene->rate_hz * d->substeps;
  const exact mass = exact_mul(d->particle_mass, exact_make(d->elastic_steps, 1));
  return exact_div(exact_div(exact_div(exact_make(1000, 1), mass), exact_make(per_second, 1)),
                   exact_make(per_second, 1));
}

/* Stiffness of the plate, 2^-40 N m: along the weft, along the warp, of twist (rt/membrane/bend_prepare.c). */
typedef struct {
  int32_t c[MATERIAL_BENDS][MATERIAL_CURVES];
  int64_t most; /* over all directions and curvatures: N C N of bend_prepare.c */
} plate;

/* D at 45 degrees is that of a strip, 4 / D = 1 / C11 + 1 / C22 + 1 / C33, so it cannot be any number. At its
 * bound the twist is infinitely stiff; here it is at most 5 D. */
static int find_twist(const draft *d, const int32_t strip[3], const exact bend, int32_t *twist) {
  const uint64_t four = (uint64_t)4 << 28;
  const uint64_t middle = (uint64_t)(uint32_t)strip[1] << 28;
  *twist = 0;
  if (strip[1] == 0) return 1;
  const uint64_t taken = strip[0] == 0 || strip[2] == 0
                             ? UINT64_MAX
                             : middle / (uint32_t)strip[0] + middle / (uint32_t)strip[2];
  if (taken > four - ((uint64_t)1 << 28) / 5)
    return draft_expected(d, number_of(d, "bend", UNIT_BENDING, bend).block,
                          number_of(d, "bend", UNIT_BENDING, bend).key,
                          "a stiffness at 45 degrees below 3.8 / (1 / that at 0 + 1 / that at 90)");
  *twist = (int32_t)fx_clamp64((int64_t)(middle / (four - taken)), 0, INT32_MAX);
  return 1;
}

/* Rows of the table are by the direction of the fold line: the one along the warp is that of a strip along the
 * weft. */
static int find_plate(const draft *d, plate *p) {
  const material_spec *from = &d->scene->membrane.cloth;
  p->most = 0;
  for (uint32_t n = 0; n < MATERIAL_CURVES; ++n) {
    int32_t strip[3];
    for (uint32_t b = 0; b < 3; ++b)
      if (!draft_fixed_point(d, number_of(d, "bend", UNIT_BENDING, from->bend[b][n]), from->bend[b][n], 40, 0,
                             INT32_MAX, &strip[b]))
        return 0;
    p->c[0][n] = strip[2];
    p->c[1][n] = strip[0];
    if (!find_twist(d, strip, from->bend[1][n], &p->c[2][n])) return 0;
    const int64_t across = (p->c[0][n] + (int64_t)p->c[1][n]) / 4 + p->c[2][n];
    p->most = fx_clamp64(p->most, across, INT64_MAX);
    p->most = fx_clamp64(p->most, fx_max(strip[0], strip[2]), INT64_MAX);
  }
  return 1;
}

enum { BEND_EVERY_MAX = 8 };

/* As many elastic steps as there may be, until bending bears one: *steps is the square of those in the longest
 * that it bears, Q16, below 1. */
static void take_more_steps(draft *d, int64_t *steps) {
  const uint64_t root = exact_sqrt((uint64_t)fx_clamp64(*steps, 1, 65536)); /* Q8 */
  const uint64_t before = d->elastic_steps;
  const uint64_t wanted = ((before << 8) + root - 1) / root;
  const uint64_t max = elastic_steps_max(d);
  const uint64_t taken = wanted < max ? wanted : max;
  if (taken <= before) return;
  d->elastic_steps = (uint32_t)taken;
  *steps = fx_clamp64(*steps * (int64_t)(taken * taken) / (int64_t)(before * before), 0, 65536);
}

/* Bending acts once in as many elastic steps as stay stable: a plate of stiffness D vibrates on such a mesh
 * at up to root(150 D / rho) / edge^2, and a step may be 2 / 1.5 over that; but in no more than
 * BEND_EVERY_MAX, as impulses that come with half a period of stretch, or a multiple of it, feed that. The
 * number of elastic steps is rounded up to equal intervals. Where a single step is too long, there are more, and
 * where `elastic_steps_max` does not allow enough, bending acts in each with *share of D, Q16. */
static int find_bending(draft *d, int64_t edge, const plate *p, membrane_params *c, int64_t *share) {
  const scene *s = d->scene;
  const material_spec *cloth = &s->membrane.cloth;
  *share = 65536;
  if (p->most == 0) return 1;
  const exact max = exact_make(p->most >> 4, (int64_t)1 << 36);
  /* in SI: edge^2 times elastic steps a second, Q16; density over D, Q4; then the square of elastic steps in
   * the longest that bending can take, Q16. Rounded on the way, so that the exact numbers stay short */
  const exact length = exact_mul(exact_make(edge >> 12, 4096), exact_make(d->lu_um, 1000000));
  const exact inner = exact_make((int64_t)s->rate_hz * d->substeps * d->elastic_steps, 1);
  int64_t crossed;
  int64_t light;
  int64_t steps;
  if (!exact_to_fixed(exact_mul(exact_mul(length, length), inner), 16, &crossed) ||
      !exact_to_fixed(exact_div(exact_mul(cloth->density, exact_make(10, 1)), max), 4, &light))
    return draft_expected(d, number_of(d, "bend", UNIT_BENDING, max).block,
                          number_of(d, "bend", UNIT_BENDING, max).key,
                          "a number of fewer digits, or one nearer to measured ones");
  const exact once = exact_make(crossed, 1 << 16);
  const exact wanted =
      exact_mul(exact_mul(exact_make(light, 16), exact_make(118, 10000)), exact_mul(once, once));
  if (!exact_to_fixed(wanted, 16, &steps)) steps = (int64_t)1 << 40;
  if (steps < 65536) take_more_steps(d, &steps);
  const int64_t every = (int64_t)exact_sqrt((uint64_t)(steps < 0 ? 0 : steps)) >> 8;
  const uint32_t longest = (uint32_t)fx_clamp64(every, 1, BEND_EVERY_MAX);
  const uint32_t intervals = (d->elastic_steps + longest - 1) / longest;
  const uint32_t period = (d->elastic_steps + intervals - 1) / intervals;
  if (every == 0) *share = steps;
  c->bend_every = (int32_t)period;
  d->elastic_steps = intervals * period;
  return 1;
}

/* The largest e^2 / A of a side, Q8. */
static int64_t longest_side(const fray_world *w) {
  int64_t most = 0;
  for (uint32_t t = 0; t < triangles_in_use(w); ++t)
    for (uint32_t k = 0; k < 3; ++k) {
      const int32_t *side = w->membrane.bend_shapes[t].side[k];
      const int64_t length = fx_add_saturated(side[0], side[1]);
      most = fx_clamp64(most, fx_round64(length * length, 2 * 26 - 8), INT64_MAX);
    }
  return most;
}

/* The row of the mesh as built, with 17 to 18 bits. */
static void find_rows(fray_world *w, membrane_params *c) {
  uint32_t most;
  c->bend_row_max = 1;
  for (c->bend_row_shift = 0; c->bend_row_shift < 40; ++c->bend_row_shift) {
    most = bend_folds_find(w);
    if (most < 1u << 18) break;
  }
  c->bend_row_max = (int32_t)fx_clamp64((int64_t)most, 1, INT32_MAX);
}

/* Stiffness in units of moments, with the format in which the largest entry of H has 26 bits. */
static int fill_bending(const draft *d, const plate *p, int64_t share, fray_world *w, membrane_params *c) {
  const exact lu = exact_make(d->lu_um, 1000000);
  material_table *f = WRITABLE(material_table, w->membrane.materials);
  int32_t mantissa;
  int32_t shift;
  if (c->bend_every == 0) return 1;
  trimesh_derive(w);
  /* every h^2 / (i m lu^2) 2^-6 = mantissa 2^-shift, of 2^-40 N m */
  const exact gain = exact_mul(exact_div(exact_div(per_newton(d), lu), lu), exact_make(c->bend_every, 64));
  const draft_number n = number_of(d, "density", UNIT_AREAL_DENSITY, d->scene->membrane.cloth.density);
  if (!mantissa_of(d, n, gain, 1, 60, &mantissa, &shift)) return 0;
  const int64_t largest = ((p->most >> 8) + 1) * longest_side(w) * share >> 16; /* below 2^36 */
  int32_t down = 8;
  while (largest * (mantissa >> 8) >> (down - 8) >= (int64_t)1 << 26) ++down;
  down = fx_max(down, shift + 34 - 74);
  c->bend_bits = shift + 34 - down;
  if (c->bend_bits < 13)
    return draft_expected(d, number_of(d, "bend", UNIT_BENDING, d->scene->membrane.cloth.bend[0][0]).block,
                          number_of(d, "bend", UNIT_BENDING, d->scene->membrane.cloth.bend[0][0]).key,
                          "a softer material, or a heavier one");
  for (uint32_t b = 0; b < MATERIAL_BENDS; ++b)
    for (uint32_t k = 0; k < MATERIAL_CURVES; ++k) {
      const int32_t part = (int32_t)fx_round64(fx_mul_wide(p->c[b][k], (int32_t)share), 16);
      f->bend[b][k] = (int32_t)fx_clamp64(fx_round64(fx_mul_wide(part, mantissa), (unsigned)down), 0, MATERIAL_BEND_MAX);
    }
  find_rows(w, c);
  /* curvature in 1 / lu to steps of 5 / m, Q24 */
  return draft_fixed_point(d, n, exact_div(exact_make(1, 5), lu), 24, 0, INT32_MAX, &c->curve_gain);
}

static int fill_load(const draft *d, const fray_world *w, const scene_load *from, membrane_load *to) {
  static const int32_t way[4][2] = {{0, 1}, {0, -1}, {-1, 0}, {1, 0}}; /* top bottom left right */
  const exact one = exact_make(1, 1);
  const exact h = d->scene->membrane.weft_half_tangent;
  const exact whole = exact_add(one, exact_mul(h, h));
  int64_t c;
  int64_t s;
  int64_t max = INT64_MIN;
  if (!exact_to_fixed(exact_div(exact_sub(one, exact_mul(h, h)), whole), 30, &c) ||
      !exact_to_fixed(exact_div(exact_add(h, h), whole), 30, &s))
    return 0;
  const int32_t *n = way[from->edge];
  to->u = (int32_t)(n[0] * c + n[1] * s);
  to->v = (int32_t)(n[1] * c - n[0] * s);
  for (uint32_t p = 0; p < w->p.count; ++p) {
    const int64_t at =
        fx_round64(fx_mul_wide(to->u, w->trimesh.u[p]) + fx_mul_wide(to->v, w->trimesh.v[p]), 30);
    if (at > max) max = at;
  }
  to->at = (int32_t)max;
  for (uint32_t a = 0; a < 3; ++a)
    if (!draft_fixed_point(
            d,
            draft_given(BLOCK_SCENE, "load", UNIT_STIFFNESS, exact_mul(from->force[a], exact_make(1000, 1))),
            exact_mul(from->force[a], per_newton(d)), 26, -MAX_LOAD, MAX_LOAD, &to->force[a]))
      return 0;
  return 1;
}

/* Air of 1.2 kg/m3; p lu^3 s / (12 m) in SI, times the coefficient, (rt/membrane/wind.c). Both
 * gains have the shift of the larger. */
static int fill_wind(const draft *d, membrane_params *c) {
  const scene *s = d->scene;
  const int64_t per_second = (int64_t)s->rate_hz * d->substeps;
  const exact lu_m = exact_make(d->lu_um, 1000000);
  const exact grams = exact_mul(d->particle_mass, exact_make(12, 1));
  const exact gain = exact_mul(exact_mul(exact_div(exact_make(1200 * (int64_t)d->substeps, 1), grams), lu_m),
                               exact_mul(lu_m, lu_m));
  const exact max = exact_compare(s->membrane.wind_normal, s->membrane.wind_drag) > 0
                         ? s->membrane.wind_normal : s->membrane.wind_drag;
  int32_t mantissa;
  for (uint32_t a = 0; a < 3; ++a)
    if (!draft_fixed_point(d, draft_given(BLOCK_SCENE, "wind", UNIT_SPEED, s->wind[a]),
                           exact_div(exact_mul(s->wind[a], d->lu_per_cm), exact_make(per_second, 1)), 28,
                           -MAX_WIND, MAX_WIND, &c->wind[a]))
      return 0;
  if (!s->has_wind || max.numerator == 0) return 1;
  const exact value = exact_mul(gain, exact_make(16, 1)); /* from |N| w^2 in Q24 to Q28 */
  const draft_number density = number_of(d, "density", UNIT_AREAL_DENSITY, s->membrane.cloth.density);
  if (!mantissa_of(d, density, exact_mul(value, max), 1, 61, &mantissa, &c->wind_shift)) return 0;
  const unsigned shift = (unsigned)c->wind_shift;
  return draft_fixed_point(d, draft_given(BLOCK_CLOTH, "wind_normal", UNIT_NONE, s->membrane.wind_normal),
                           exact_mul(value, s->membrane.wind_normal), shift, 0, INT32_MAX, &c->wind_normal) &&
         draft_fixed_point(d, draft_given(BLOCK_CLOTH, "wind_drag", UNIT_NONE, s->membrane.wind_drag),
                           exact_mul(value, s->membrane.wind_drag), shift, 0, INT32_MAX, &c->wind_drag);
}

/* 64 ms, or half as much more or less. */
static int32_t lowpass_shift_of(uint32_t rate_hz) {
  int32_t shift = 1;
  while (shift < 16 && ((uint64_t)1500 << shift) < (uint64_t)64 * rate_hz) ++shift;
  return shift;
}

/* A strain of 1/2 both ways has an energy below MATERIAL_ENERGY_MAX. */
static int32_t energy_shift_of(const material_table *f) {
  int32_t most = 1;
  int32_t bits = 1;
  for (uint32_t r = 0; r < MATERIAL_ROWS; ++r)
    for (uint32_t n = 0; n < MATERIAL_ENTRIES; ++n) most = fx_max(most, f->stretch[r][n]);
  while (most >> bits != 0) ++bits;
  return bits;
}

int draft_membrane_params(draft *d, fray_world *w) {
  const scene *s = d->scene;
  trimesh_params *mesh = WRITABLE(trimesh_params, w->trimesh.params);
  membrane_params *c = WRITABLE(membrane_params, w->membrane.constants);
  int64_t height;
  int64_t area;
  int64_t share;
  int64_t wanted;
  plate bending;
  const int64_t edge = min_edge(&w->trimesh, &height, &area);
  mesh->triangles = w->trimesh.state->triangles;
  mesh->materials = 1;
  mesh->height_min = (int32_t)fx_clamp64(height / 4, 1 << 15, 1 << 24);
  mesh->area_min = (int32_t)fx_clamp64(area / 16, 1 << 8, 1 << 27);
  if (height < mesh->height_min || area < mesh->area_min)
    return draft_expected(d, BLOCK_CLOTH, "pattern",
                          "cells nearer to squares, or another %s: a triangle is too flat",
                          s->membrane.pattern == PATTERN_IRREGULAR ? "seed" : "angle");
  const int64_t stressed = stress_edge(&w->trimesh, edge);
  if (!find_steps(d, stressed, &wanted) || !find_plate(d, &bending) ||
      !find_bending(d, edge, &bending, c, &share))
    return 0;
  if (!fill_material(d, WRITABLE(material_table, w->membrane.materials)) ||
      !fill_tear_strength(d, WRITABLE(tear_strength, w->membrane.tear_strengths)) ||
      (world_has_cracks(w) && !fill_cracks(d, WRITABLE(crack_params, w->membrane.crack_constants))) ||
      (world_has_blades(w) && !fill_blades(d, WRITABLE(blade_params, w->membrane.blades))))
    return 0;
  c->steps = (int32_t)d->elastic_steps;
  const exact cell = exact_mul(exact_mul(s->membrane.cell[0], d->lu_per_cm),
                               exact_mul(s->membrane.cell[1], d->lu_per_cm));
  if (!draft_fixed_point(d, draft_given(BLOCK_CLOTH, "cell", UNIT_LENGTH, s->membrane.cell[0]),
                         exact_mul(cell, exact_make(3, 1)), 30, 1 << 8, 1 << 30, &c->mass_unit))
    return 0;
  /* gain of an area in lu^2: Q30 impulse from N/m, see membrane_stress_update */
  if (!mantissa_of(d, number_of(d, "density", UNIT_AREAL_DENSITY, s->membrane.cloth.density),
                   exact_mul(per_newton(d), exact_make(1 << 18, 1)), 8, 60, &c->force_gain, &c->force_shift))
    return 0;
  c->norm2_max = norm2_borne(d, stressed, wanted);
  c->wind_shift = c->bend_row_max = 1;
  c->bend_bits = 13;
  c->energy_shift = energy_shift_of(w->membrane.materials);
  c->smoothing_shift = lowpass_shift_of(s->rate_hz);
  if (s->membrane.strain_limit.numerator != 0 &&
      !draft_fixed_point(d, draft_given(BLOCK_CLOTH, "strain_limit", UNIT_SHARE, s->membrane.strain_limit),
                         exact_add(exact_make(1, 1), s->membrane.strain_limit), 16, 1 << 16, 1 << 20,
                         &c->edge_limit))
    return 0;
  if (!fill_wind(d, c) || !fill_bending(d, &bending, share, w, c)) return 0;
  for (uint32_t n = 0; n < s->load_count; ++n)
    if (!fill_load(d, w, &s->loads[n], &c->load[n])) return 0;
  return 1;
}
