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
 * known to 2^-24 of r^2 for rest lengths from 1/16 lu (lo^2 is left out: below 2^-23). Directions use hi alone, lengths both:
 * with 16-bit lengths the rounding alone kept a hanging sheet moving at 3 cm/s. u and f are Q20;
 * one step of f is at most one position step of the correction. The same correction is added to
 * one end and taken from the other, so a pair of equal masses keeps its momentum to the last bit.
 * Rounding is odd-symmetric, so mirrored sheets stay mirrored. */
#include "rt/stage/stage.h"

enum {
  HI_MAX = 16383,
  U_LEAST = -458752, /* -7/16 in Q20 */
  PSI_0 = 16384,     /* 1/4 in Q16 */
  PSI_1 = -12648,    /* -0.193 */
  PSI_2 = 9961       /* 0.152 */
};

/* One component of d = to - from: hi in units of 2^8, saturated, and what is left. */
typedef struct {
  int32_t hi, lo;
} split;

static inline split split_difference(int32_t from, int32_t to) {
  const int32_t d = fx_sub(to, from);
  const int32_t hi = fx_round(d, LINK_SHIFT);
  const split s = {fx_clamp(hi, -HI_MAX, HI_MAX), fx_wrap_sub(d, fx_wrap_shift(hi, LINK_SHIFT))};
  return s;
}

/* f in Q20, -1/6..1/10. */
static inline int32_t projection_factor(split x, split y, split z, const link_class *c) {
  const int32_t n = x.hi * x.hi + y.hi * y.hi + z.hi * z.hi; /* below 3 * 2^28 */
  const int32_t cross = x.hi * x.lo + y.hi * y.lo + z.hi * z.lo;
  const int32_t e = fx_min(n + fx_asr(cross, LINK_SHIFT - 1), c->n_max) - c->r2;
  const int32_t u = fx_asr(fx_mul(fx_asr(e + 16, 5), c->inverse) + (1 << 10), 11);
  const int32_t v = fx_max(u, U_LEAST);
  const int32_t v_q15 = fx_asr(v, 5);
  const int32_t psi_q16 = PSI_0 + fx_mul_q15(v_q15, PSI_1 + fx_mul_q15(v_q15, PSI_2));
  const int32_t f = fx_asr(fx_mul(v, fx_asr(psi_q16, 3)) + (1 << 12), 13);
  return v < 0 ? fx_asr(fx_mul(f, c->push), 12) : f;
}

typedef struct {
  int32_t *restrict x, *restrict y, *restrict z;
  const row_id *i, *j;
  const uint8_t *kind;
  const link_class *classes;
} link_view;

/* What end i moves by, f * d, and end j by the opposite; twice that with `down` one less. */
static inline vec3 correction(const link_view *s, uint32_t row, unsigned down) {
  const uint32_t i = s->i[row];
  const uint32_t j = s->j[row];
  const split x = split_difference(s->x[i], s->x[j]);
  const split y = split_difference(s->y[i], s->y[j]);
  const split z = split_difference(s->z[i], s->z[j]);
  const int32_t f = projection_factor(x, y, z, &s->classes[s->kind[row]]);
  return vec_make(fx_round(fx_mul(x.hi, f), down), fx_round(fx_mul(y.hi, f), down),
                  fx_round(fx_mul(z.hi, f), down));
}

/* Both ends move: equal and opposite. */
static void project_free(link_view s, uint32_t first, uint32_t end) {
  for (uint32_t row = first; row < end; ++row) {
    if (s.kind[row] == ROW_DEAD) continue;
    const vec3 c = correction(&s, row, 20 - LINK_SHIFT);
    const uint32_t i = s.i[row];
    const uint32_t j = s.j[row];
    s.x[i] = fx_add(s.x[i], c.x);
    s.y[i] = fx_add(s.y[i], c.y);
    s.z[i] = fx_add(s.z[i], c.z);
    s.x[j] = fx_sub(s.x[j], c.x);
    s.y[j] = fx_sub(s.y[j], c.y);
    s.z[j] = fx_sub(s.z[j], c.z);
  }
}

/* End i is carried by a body: end j takes the whole correction, the body gave the momentum. */
static void project_held(fray_world *w, link_view s, uint32_t first, uint32_t end) {
  for (uint32_t row = first; row < end; ++row) {
    if (s.kind[row] == ROW_DEAD) continue;
    const vec3 c = correction(&s, row, 19 - LINK_SHIFT);
    const uint32_t j = s.j[row];
    s.x[j] = fx_sub(s.x[j], c.x);
    s.y[j] = fx_sub(s.y[j], c.y);
    s.z[j] = fx_sub(s.z[j], c.z);
    body_gave(&w->motion[w->grip_body[s.i[row]]], -(int64_t)c.x * (1 << FX_SUB_BITS),
              -(int64_t)c.y * (1 << FX_SUB_BITS), -(int64_t)c.z * (1 << FX_SUB_BITS));
  }
}

void strain_run(fray_world *w) {
  const link_view view = {w->x, w->y, w->z, w->row_i, w->row_j, w->row_class, w->links};
  const uint32_t batches = (uint32_t)w->params->link_batches;
  for (int32_t sweep = 0; sweep < w->params->sweeps; ++sweep)
    for (uint32_t b = 0; b < batches; ++b) {
      const row_batch *batch = &w->batches[b];
      const uint32_t first = (uint32_t)batch->first;
      const uint32_t end = first + (uint32_t)batch->count;
      if (batch->held == BATCH_FREE) project_free(view, first, end);
      if (batch->held == BATCH_HELD) project_held(w, view, first, end);
      if (batch->held != BATCH_IDLE) w->work.projections += end - first;
    }
}
