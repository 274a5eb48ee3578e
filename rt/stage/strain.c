/* SPDX-License-Identifier: Apache-2.0 */
/* Strain limiting: structural links are projected to their rest length, one after the other, in
 * order of distance from the held particles (Metaaphanon 2009, section 4.1; the projection is that
 * of Mueller et al. 2007).
 *
 * A projection moves both ends by f * d, where d = p_j - p_i and f = (1 - r/|d|) / 2. With
 * u = |d|^2/r^2 - 1 this is f = u * psi(u), psi(u) = (1 - 1/sqrt(1+u)) / (2u), a smooth function
 * that needs no square root: a quadratic is within 0.25% of it for strains up to 10% and within 7%
 * over the whole range taken here, u in [-7/16, 9/16]. What is stretched or squeezed beyond 25% is
 * corrected by the step of 25%. The fixed point u = 0 is exact whatever psi is.
 *
 * Strain limiting is against stretch. Against compression the paper has the structural spring of
 * k_struct alone: its explicit force moves a pair by 2 k h^2/m of its shortening in a substep h, so
 * a compressed link gets that share (`push`) of a projection, at most all of it.
 *
 * Formats: 32-bit products only, good on small targets and wide units. A difference d in Q24 is
 * split into hi, 15 bits in units of 2^8, and the rest lo, so that |d|^2 = hi^2 + 2 hi lo + ... is
 * known to 2^-24 of r^2 for rest lengths from 1/16 lu (lo^2 is left out: below 2^-23). Directions
 * use hi alone, lengths both: with 16-bit lengths the rounding alone kept a hanging sheet moving at
 * 3 cm/s. u and f are Q20; one step of f is at most one position step of the correction. The same
 * correction is added to one end and taken from the other, so a pair of equal masses keeps its
 * momentum to the last bit. Rounding is odd-symmetric, so mirrored sheets stay mirrored. */
#include "rt/stage/stage.h"
#include "rt/wide/wide.h"

/* u * psi(u) in Q20. */
static inline int32_t half_strain(int32_t u) {
  const int32_t u_q15 = fx_asr(u, 5);
  const int32_t slope = fx_asr(fx_mul(u_q15, LINK_PSI_2) + LINK_HORNER_1, 15);
  const int32_t psi_q13 = fx_asr(fx_mul(u_q15, slope) + LINK_HORNER_0, 18);
  return fx_asr(fx_mul(u, psi_q13) + (1 << 12), 13);
}

/* f in Q20, -1/6..1/10, from e = |d|^2 - r^2. Of ends less than 4 units apart the product may come
 * out below -2^31 and wrap: they are moved by at most 3 f, whichever way. */
static inline int32_t projection_factor(int32_t e, const link_class *c) {
  const int32_t u = fx_asr(fx_wrap_add(fx_wrap_mul(fx_asr(e + 16, 5), c->inverse), 1 << 10), 11);
  if (__builtin_expect(u >= 0, 1)) return half_strain(u);
  return fx_asr(fx_mul(half_strain(fx_max(u, LINK_U_LEAST)), c->push), 12);
}

/* f * d from i to j, 2^(20 - LINK_SHIFT) for one step of a position; `share` of it, Q12. Inlined by
 * order: compilers for small targets would pass it through memory. */
__attribute__((always_inline)) static inline vec3 correction(const link_view *s, uint32_t i,
                                                             uint32_t j, const link_class *c,
                                                             int32_t share) {
  const vec3 d = vec_make(fx_sub(s->x[j], s->x[i]), fx_sub(s->y[j], s->y[i]),
                          fx_sub(s->z[j], s->z[i]));
  vec3 hi = vec_make(link_coarse(d.x), link_coarse(d.y), link_coarse(d.z));
  uint32_t n = link_squared(d, hi);
  if (__builtin_expect(n > (uint32_t)c->n_max, 0)) {
    n = (uint32_t)c->n_max;
    hi = vec_make(fx_clamp(hi.x, -LINK_HI_MAX, LINK_HI_MAX), fx_clamp(hi.y, -LINK_HI_MAX, LINK_HI_MAX),
                  fx_clamp(hi.z, -LINK_HI_MAX, LINK_HI_MAX));
  }
  int32_t f = projection_factor((int32_t)n - c->r2, c);
  if (share != 4096) f = fx_asr(fx_mul(f, share) + (1 << 11), 12);
  return vec_make(fx_mul(hi.x, f), fx_mul(hi.y, f), fx_mul(hi.z, f));
}

/* Both ends move by half: equal and opposite; a light end by twice that. */
static inline void move_both(int32_t *restrict x, uint32_t i, uint32_t j, int32_t product,
                             int32_t weight_i, int32_t weight_j) {
  const int32_t c = fx_round(product, 20 - LINK_SHIFT);
  x[i] = fx_add(x[i], c * weight_i);
  x[j] = fx_sub(x[j], c * weight_j);
}

/* One end has half the mass of the other: it takes two thirds, the other one third. The correction
 * is computed once, so momentum is kept to the last bit here too. Rare, so out of the way. */
__attribute__((noinline)) static void project_light(link_view s, uint32_t row) {
  const uint32_t kind = s.kind[row];
  const uint32_t i = s.i[row];
  const uint32_t j = s.j[row];
  const int32_t weight_i = (kind & ROW_UP_I) != 0 ? 2 : 1;
  const int32_t weight_j = (kind & ROW_UP_J) != 0 ? 2 : 1;
  const vec3 c = correction(&s, i, j, &s.classes[kind & ROW_CLASS], LINK_THIRD);
  move_both(s.x, i, j, c.x, weight_i, weight_j);
  move_both(s.y, i, j, c.y, weight_i, weight_j);
  move_both(s.z, i, j, c.z, weight_i, weight_j);
}

static void project_free(link_view s, uint32_t first, uint32_t end) {
  for (uint32_t row = first; row < end; ++row) {
    const int32_t kind = (int8_t)s.kind[row];
    if (kind <= ROW_DEAD) {
      if (kind != ROW_DEAD) project_light(s, row);
      continue;
    }
    const uint32_t i = s.i[row];
    const uint32_t j = s.j[row];
    const vec3 c = correction(&s, i, j, &s.classes[kind], 4096);
    move_both(s.x, i, j, c.x, 1, 1);
    move_both(s.y, i, j, c.y, 1, 1);
    move_both(s.z, i, j, c.z, 1, 1);
  }
}

/* End i is carried by a body: end j takes the whole correction, the body gave the momentum, half as
 * much to a light end. */
static void project_held(fray_world *w, link_view s, uint32_t first, uint32_t end) {
  for (uint32_t row = first; row < end; ++row) {
    const uint32_t kind = s.kind[row];
    if (kind == ROW_DEAD) continue;
    const uint32_t i = s.i[row];
    const uint32_t j = s.j[row];
    const vec3 twice = correction(&s, i, j, &s.classes[kind & ROW_CLASS], 4096);
    const int64_t mass = (kind & ROW_LIGHT) != 0 ? 1 << (FX_SUB_BITS - 1) : 1 << FX_SUB_BITS;
    const vec3 c = vec_make(fx_round(twice.x, 19 - LINK_SHIFT), fx_round(twice.y, 19 - LINK_SHIFT),
                            fx_round(twice.z, 19 - LINK_SHIFT));
    s.x[j] = fx_sub(s.x[j], c.x);
    s.y[j] = fx_sub(s.y[j], c.y);
    s.z[j] = fx_sub(s.z[j], c.z);
    body_gave(&w->motion[w->grip_body[i]], -c.x * mass, -c.y * mass, -c.z * mass);
  }
}

void strain_part(fray_world *w, uint32_t b, uint32_t batches) {
  const link_view view = {w->x, w->y, w->z, w->row_i, w->row_j, w->row_class,
                          world_has_stretch(w) ? w->limits : w->links,
                          w->capacity[POOL_LINK_CLASSES]};
  while (b < batches) {
    const int32_t held = w->batches[b].held;
    const uint32_t first = (uint32_t)w->batches[b].first;
    const uint32_t begun = b;
    const uint32_t end = world_run_of_batches(w, &b, batches);
    if (held == BATCH_IDLE) continue;
    if (held == BATCH_HELD)
      project_held(w, view, first, end);
    else if (!wide_project(w->kernel, view, w->batches + begun, b - begun))
      project_free(view, first, end);
    w->work.projections += end - first;
  }
}

void strain_run(fray_world *w) {
  for (int32_t sweep = 0; sweep < w->params->sweeps; ++sweep)
    strain_part(w, 0, (uint32_t)w->params->link_batches);
}
