/* SPDX-License-Identifier: Apache-2.0 */
/* Elastic yarns: the number of elastic steps that they need, and their gains. */
#include <stdio.h>

#include "tools/scene_compiler/draft.h"

/* For products of many ratios, which overflow `exact`: m * 2^power, m of 32 bits or 0, each operation
 * rounded down by less than 2^-30. */
typedef struct {
  uint64_t m;
  int power;
} rough;

static rough rough_make(uint64_t m, int power) {
  rough r = {m, power};
  for (; r.m >> 32 != 0; ++r.power) r.m >>= 1;
  for (; r.m != 0 && r.m >> 31 == 0; --r.power) r.m <<= 1;
  return r;
}
static rough rough_mul(rough a, rough b) { return rough_make(a.m * b.m, a.power + b.power); }
static rough rough_div(rough a, rough b) {
  return rough_make(b.m == 0 ? 0 : (a.m << 32) / b.m, a.power - b.power - 32);
}
static rough rough_ratio(int64_t numerator, int64_t denominator) {
  return rough_div(rough_make((uint64_t)numerator, 0), rough_make((uint64_t)denominator, 0));
}
static rough rough_of(exact v) { return rough_ratio(v.numerator, v.denominator); }
static int rough_is_less(rough a, rough b) {
  if (a.m == 0 || b.m == 0) return a.m < b.m;
  return a.power != b.power ? a.power < b.power : a.m < b.m;
}
/* v * 2^shift, at most 2^62. */
static uint64_t rough_fixed(rough v, int shift) {
  const int power = v.power + shift;
  if (v.m == 0 || power < -62) return 0;
  if (power > 30) return (uint64_t)1 << 62;
  return power >= 0 ? v.m << power : (v.m + ((uint64_t)1 << (-power - 1))) >> -power;
}

/* k / m of a link of this length, 1/s2. */
static rough pull_of(const scene *s, rough centimetres, rough grams) {
  const rough dyn = rough_mul(rough_of(s->woven.stretch), rough_ratio(100000, 1));
  return rough_div(rough_div(dyn, centimetres), grams);
}

/* Default: sqrt(m/k) / 20. For the fastest wave, as short as the spacing, 5 % of critical damping, for slow
 * ones next to nothing. Without any, bend and shear, which act once a tick, make some waves grow. */
static rough damping_time(const scene *s, rough pull) {
  if (exact_compare(s->woven.stretch_damping, exact_make(0, 1)) >= 0)
    return rough_of(s->woven.stretch_damping);
  const int odd = pull.power & 1;
  const uint32_t root = exact_sqrt(pull.m << (odd ? 31 : 30));
  const rough speed = rough_make(root, (pull.power - (odd ? 31 : 30)) / 2);
  return rough_div(rough_ratio(1, 20), speed);
}

/* An explicit step is stable below 8 g + 16 c = 4 for a chain of single yarns, or of crossings with warp
 * and weft drawn into one line: g = k h^2/m, c the share of the relative velocity that damping takes. */
static int is_stable(rough pull, rough damping, int64_t steps_a_second) {
  const rough h = rough_ratio(1, steps_a_second);
  const rough by_step = rough_mul(pull, h);
  const uint64_t g = rough_fixed(rough_mul(by_step, h), 32);
  const uint64_t c = rough_fixed(rough_mul(by_step, damping), 32);
  return g < (uint64_t)1 << 32 && c < (uint64_t)1 << 32 && g + 2 * c <= ((uint64_t)1 << 32) / 5 * 2;
}

static rough shorter_spacing(const scene *s) {
  const int by_warps = exact_compare(s->woven.warp_spacing, s->woven.weft_spacing) < 0;
  return rough_of(by_warps ? s->woven.warp_spacing : s->woven.weft_spacing);
}

static rough pull_of_shorter(const scene *s) {
  const exact area = exact_mul(s->woven.warp_spacing, s->woven.weft_spacing);
  return pull_of(s, shorter_spacing(s), rough_of(exact_mul(s->woven.density, area)));
}

static int steps_bits(const scene *s, uint32_t substeps, rough damping) {
  for (int bits = 0; bits <= YARN_ELASTIC_STEPS_BITS; ++bits)
    if (is_stable(pull_of_shorter(s), damping, (int64_t)((uint64_t)s->rate_hz * substeps << bits)))
      return bits;
  return -1;
}

int yarn_elastic_steps_bits(const scene *s, uint32_t substeps) {
  return steps_bits(s, substeps, damping_time(s, pull_of_shorter(s)));
}

uint32_t yarn_elastic_min_substeps(const scene *s) {
  uint32_t n = 1;
  while (n <= MAX_SUBSTEPS && yarn_elastic_steps_bits(s, n) < 0) ++n;
  return n;
}

/* value = mantissa * 2^-(scale + 24), with a mantissa of 30 bits; weaker ones are 0. */
static void gain(rough value, int32_t *mantissa, int32_t *scale) {
  uint64_t fixed = 0;
  for (*scale = YARN_ELASTIC_SCALE_MIN; *scale < YARN_ELASTIC_SCALE_MAX; ++*scale) {
    fixed = rough_fixed(value, *scale + 24);
    if (fixed >= YARN_ELASTIC_PULL_MIN) break;
  }
  *mantissa =
      fixed >= YARN_ELASTIC_PULL_MIN && fixed < (uint64_t)2 * YARN_ELASTIC_PULL_MIN ? (int32_t)fixed : 0;
}

static int make_class(const draft *d, const yarn_elastic_params *p, const link_class *link,
                      yarn_gain *pull) {
  const scene *s = d->scene;
  const rough length = rough_div(rough_ratio(link->rest, FX_LU), rough_of(d->lu_per_cm));
  const rough h = rough_ratio(1, (int64_t)s->rate_hz * d->substeps);
  const rough inner =
      rough_ratio(1, (int64_t)((uint64_t)s->rate_hz * d->substeps << p->steps_bits));
  const rough kicks = rough_mul(rough_mul(inner, h), rough_ratio(16, link->r2));
  const rough stretched = pull_of(s, length, rough_of(d->particle_mass));
  const rough pressed = rough_of(exact_div(s->woven.structural, d->particle_mass));
  const rough lost = rough_mul(rough_mul(stretched, inner), damping_time(s, stretched));
  const uint64_t damping = rough_fixed(rough_mul(lost, rough_ratio(1 << 25, link->r2)), 24);
  gain(rough_mul(stretched, kicks), &pull->pull, &pull->pull_scale);
  gain(rough_mul(rough_is_less(pressed, stretched) ? pressed : stretched, kicks), &pull->push,
       &pull->push_scale);
  if (pull->pull == 0)
    return draft_expected(d, BLOCK_CLOTH, "stretch",
                          "a stiffer yarn, or a lighter one, for crossings of this mass at %u Hz with %u "
                          "substeps",
                          s->rate_hz, d->substeps);
  if (damping > YARN_ELASTIC_DAMPING_MAX)
    return draft_expected(d, BLOCK_CLOTH, "stretch_damping", "a shorter time");
  pull->damping = (int32_t)damping;
  return 1;
}

/* Where damping alone makes the steps too many, its time is the cause. */
static int refuse_stiffness(const draft *d) {
  const uint32_t least = yarn_elastic_min_substeps(d->scene);
  const int damped = steps_bits(d->scene, d->substeps, rough_make(0, 0)) >= 0;
  char more[48] = "";
  if (least <= MAX_SUBSTEPS) snprintf(more, sizeof more, "at least %u substeps, ", least);
  return draft_expected(d, BLOCK_CLOTH, damped ? "stretch_damping" : "stretch",
                        "%sa heavier cloth or a %s: at %u Hz with %u substeps that needs more than %d "
                        "elastic steps a "
                        "substep",
                        more, damped ? "shorter time" : "softer yarn", d->scene->rate_hz, d->substeps,
                        1 << YARN_ELASTIC_STEPS_BITS);
}

static int stretch_words(const draft *d, yarn_elastic_params *p) {
  const scene *s = d->scene;
  char most[SOURCE_VALUE];
  int64_t word;
  p->steps_bits = yarn_elastic_steps_bits(s, d->substeps);
  if (p->steps_bits < 0)
    return refuse_stiffness(d);
  const rough pull = pull_of(s, shorter_spacing(s), rough_of(d->particle_mass));
  if (damping_time(s, pull).m == 0 &&
      rough_is_less(rough_of(exact_div(s->woven.structural, d->particle_mass)), pull))
    return draft_expected(d, BLOCK_CLOTH, "stretch_damping",
                          "more than 0 where pressed yarns ('structural') are softer than stretched ones: "
                          "steps over "
                          "that bend of the force make waves grow");
  if (s->woven.tearing != 0 && exact_compare(s->woven.tear_max, exact_make(1, 4)) > 0)
    return draft_expected(d, BLOCK_CLOTH, "tear", "at most %s for yarns with 'stretch'",
                          draft_value(d, BLOCK_CLOTH, "tear", UNIT_SHARE, exact_make(1, 4), -1, most));
  if (!exact_to_fixed(exact_mul(s->woven.stretch, exact_make(1000000, 1)), 0, &word) || word < 1 ||
      word > INT32_MAX)
    return draft_expected(d, BLOCK_CLOTH, "stretch", "a number of fewer digits");
  p->stiffness_un = (int32_t)word;
  p->damping_ns =
      (int32_t)rough_fixed(rough_mul(damping_time(s, pull), rough_ratio(1000000000, 1)), 0);
  return 1;
}

/* A free body receives the impulses of attached crossings once a substep. */
static int bodies_are_stable(const draft *d) {
  const scene *s = d->scene;
  for (uint32_t b = 0; b < s->body_count; ++b) {
    if (s->bodies[b].motion != FRAY_FREE) continue;
    int64_t links = 0;
    for (uint32_t p = 0; p < d->attached; ++p) {
      uint32_t near[4];
      if (d->holder[d->crossing[p]] != b) continue;
      draft_neighbours(d, d->crossing[p], near);
      for (uint32_t n = 0; n < 4; ++n) links += d->holder[near[n]] == DRAFT_FREE;
    }
    const rough h = rough_ratio(1, (int64_t)s->rate_hz * d->substeps);
    const rough length = rough_div(rough_ratio(d->spacing[0], FX_LU), rough_of(d->lu_per_cm));
    const rough pull = pull_of(s, length, rough_of(s->bodies[b].mass));
    const rough g = rough_mul(rough_mul(rough_mul(pull, rough_ratio(links, 1)), h), h);
    if (rough_is_less(rough_ratio(1, 1), g))
      return draft_expected(d, BLOCK_BODY + b, "mass",
                            "a greater one, or more substeps than %u: %lld yarns as stiff as these throw so "
                            "light a body",
                            d->substeps, (long long)links);
  }
  return 1;
}

int draft_yarn_elastic(const draft *d, const link_class *links, yarn_elastic_params *p, yarn_gain *pulls,
                       uint32_t classes) {
  if (!stretch_words(d, p) || !bodies_are_stable(d)) return 0;
  for (uint32_t n = 1; n < classes; ++n)
    if (!make_class(d, p, &links[n], &pulls[n])) return 0;
  return 1;
}
