/* SPDX-License-Identifier: Apache-2.0 */
/* Yarns with a stiffness: how many inner steps they need, and their gains. */
#include "tools/build/draft.h"

/* Products of many ratios leave what `exact` holds: m * 2^power, m of 32 bits or 0, each step
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
  const rough dyn = rough_mul(rough_of(s->sheet.stretch), rough_ratio(100000, 1));
  return rough_div(rough_div(dyn, centimetres), grams);
}

/* A twentieth of sqrt(m/k) where the scene does not say: of the fastest wave, as short as the
 * spacing, 5 % of what would stop it, and next to nothing of a slow one. Bend and shear, which act
 * once a tick, would make some waves grow without any. */
static rough damping_time(const scene *s, rough pull) {
  if (exact_compare(s->sheet.stretch_damping, exact_make(0, 1)) >= 0)
    return rough_of(s->sheet.stretch_damping);
  const int odd = pull.power & 1;
  const uint32_t root = exact_sqrt(pull.m << (odd ? 31 : 30));
  const rough speed = rough_make(root, (pull.power - (odd ? 31 : 30)) / 2);
  return rough_div(rough_ratio(1, 20), speed);
}

/* An explicit step is stable below 8 g + 16 c = 4 for a chain of single yarns, or of crossings
 * whose warps and wefts have been drawn into line: g = k h^2/m, c what damping takes of the speed
 * apart. */
static int is_stable(const scene *s, rough pull, int64_t steps_a_second) {
  const rough h = rough_ratio(1, steps_a_second);
  const rough by_step = rough_mul(pull, h);
  const uint64_t g = rough_fixed(rough_mul(by_step, h), 32);
  const uint64_t c = rough_fixed(rough_mul(by_step, damping_time(s, pull)), 32);
  return g < (uint64_t)1 << 32 && c < (uint64_t)1 << 32 && g + 2 * c <= ((uint64_t)1 << 32) / 5 * 2;
}

static rough shorter_spacing(const scene *s) {
  const int by_warps = exact_compare(s->sheet.warp_spacing, s->sheet.weft_spacing) < 0;
  return rough_of(by_warps ? s->sheet.warp_spacing : s->sheet.weft_spacing);
}

int stretch_steps_bits(const scene *s, uint32_t substeps) {
  const exact area = exact_mul(s->sheet.warp_spacing, s->sheet.weft_spacing);
  const rough pull = pull_of(s, shorter_spacing(s), rough_of(exact_mul(s->sheet.density, area)));
  for (int bits = 0; bits <= STRETCH_STEPS_BITS; ++bits)
    if (is_stable(s, pull, (int64_t)((uint64_t)s->rate_hz * substeps << bits))) return bits;
  return -1;
}

uint32_t stretch_substeps_least(const scene *s) {
  uint32_t n = 1;
  while (n <= LIMIT_SUBSTEPS && stretch_steps_bits(s, n) < 0) ++n;
  return n;
}

/* value = mantissa * 2^-(scale + 24), with a mantissa of 30 bits; what is too weak is nothing. */
static void gain(rough value, int32_t *mantissa, int32_t *scale) {
  uint64_t fixed = 0;
  for (*scale = STRETCH_SCALE_LEAST; *scale < STRETCH_SCALE_MOST; ++*scale) {
    fixed = rough_fixed(value, *scale + 24);
    if (fixed >= STRETCH_PULL_LEAST) break;
  }
  *mantissa =
      fixed >= STRETCH_PULL_LEAST && fixed < (uint64_t)2 * STRETCH_PULL_LEAST ? (int32_t)fixed : 0;
}

static int make_class(const draft *d, const stretch_params *p, const link_class *link,
                      stretch_class *pull, link_class *limit) {
  const scene *s = d->scene;
  const rough length = rough_div(rough_ratio(link->rest, FX_LU), rough_of(d->lu_per_cm));
  const rough h = rough_ratio(1, (int64_t)s->rate_hz * d->substeps);
  const rough inner =
      rough_ratio(1, (int64_t)((uint64_t)s->rate_hz * d->substeps << p->steps_bits));
  const rough kicks = rough_mul(rough_mul(inner, h), rough_ratio(16, link->r2));
  const rough stretched = pull_of(s, length, rough_of(d->particle_mass));
  const rough pressed = rough_of(exact_div(s->sheet.structural, d->particle_mass));
  const rough lost = rough_mul(rough_mul(stretched, inner), damping_time(s, stretched));
  const uint64_t damping = rough_fixed(rough_mul(lost, rough_ratio(1 << 25, link->r2)), 24);
  gain(rough_mul(stretched, kicks), &pull->pull, &pull->pull_scale);
  gain(rough_mul(rough_is_less(pressed, stretched) ? pressed : stretched, kicks), &pull->push,
       &pull->push_scale);
  if (pull->pull == 0)
    return draft_refuse(d, s->sheet.line,
                        "stretch: too weak for crossings of this mass at %u Hz with "
                        "%u substeps; expected a stiffer or lighter yarn",
                        s->rate_hz, d->substeps);
  if (damping > STRETCH_DAMPING_MOST)
    return draft_refuse(d, s->sheet.line, "stretch_damping: expected a shorter time");
  pull->damping = (int32_t)damping;
  *limit =
      link_class_make(link->rest + (int32_t)fx_round64(fx_mul_wide(link->rest, p->limit), 16), 0);
  return 1;
}

static int stretch_words(const draft *d, stretch_params *p) {
  const scene *s = d->scene;
  int64_t word;
  const exact over = exact_add(exact_mul(s->sheet.tear_max, exact_make(5, 4)), exact_make(1, 100));
  const exact limit = s->sheet.tearing != 0 ? over : exact_make(1, 5);
  p->steps_bits = stretch_steps_bits(s, d->substeps);
  if (p->steps_bits < 0)
    return draft_refuse(d, s->sheet.line,
                        "stretch: at %u Hz with %u substeps these yarns are too stiff for %d inner "
                        "steps a substep; expected at least %u substeps%s, a heavier cloth or a "
                        "softer yarn",
                        s->rate_hz, d->substeps, 1 << STRETCH_STEPS_BITS, stretch_substeps_least(s),
                        stretch_substeps_least(s) > LIMIT_SUBSTEPS ? " (more than there are)" : "");
  const rough pull = pull_of(s, shorter_spacing(s), rough_of(d->particle_mass));
  if (damping_time(s, pull).m == 0 &&
      rough_is_less(rough_of(exact_div(s->sheet.structural, d->particle_mass)), pull))
    return draft_refuse(d, s->sheet.line,
                        "stretch_damping: expected more than 0 where pressed yarns are "
                        "softer than stretched ones: steps over that bend make waves grow");
  if (!exact_to_fixed(limit, 16, &word) || word >= 1 << 14)
    return draft_refuse(d, s->sheet.line,
                        "tear: expected at most 19 %% for yarns with a stiffness");
  p->limit = (int32_t)word;
  if (!exact_to_fixed(exact_mul(s->sheet.stretch, exact_make(1000000, 1)), 0, &word) || word < 1 ||
      word > INT32_MAX)
    return draft_refuse(d, s->sheet.line, "stretch: expected 0.1 mN to 2 kN");
  p->stiffness_un = (int32_t)word;
  p->damping_ns =
      (int32_t)rough_fixed(rough_mul(damping_time(s, pull), rough_ratio(1000000000, 1)), 0);
  return 1;
}

/* A free body that grips crossings is pushed once a substep. */
static int bodies_are_stable(const draft *d) {
  const scene *s = d->scene;
  for (uint32_t b = 0; b < s->body_count; ++b) {
    if (s->bodies[b].motion != FRAY_FREE) continue;
    int64_t links = 0;
    for (uint32_t p = 0; p < d->held; ++p) {
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
      return draft_refuse(d, s->bodies[b].line,
                          "%s: %lld yarns as stiff as these throw so light a body; "
                          "expected more substeps than %u, or a greater mass",
                          s->bodies[b].name, (long long)links, d->substeps);
  }
  return 1;
}

int draft_stretch(const draft *d, const link_class *links, stretch_params *p, stretch_class *pulls,
                  link_class *limits, uint32_t classes) {
  if (!stretch_words(d, p) || !bodies_are_stable(d)) return 0;
  for (uint32_t n = 1; n < classes; ++n)
    if (!make_class(d, p, &links[n], &pulls[n], &limits[n])) return 0;
  return 1;
}
