/* SPDX-License-Identifier: Apache-2.0 */
/* SIMD twin: rt/simd/strain_limit_lanes.inl.h; both share rt/simd/link_terms.h.
 *
 * Strain limiting: structural links are projected to their rest length, one after the other, in order of
 * distance from the attached particles (Metaaphanon 2009, section 4.1; the projection is that of Mueller et
 * al. 2007).
 *
 * A projection moves both ends by f * d, where d = p_j - p_i and f = (1 - r/|d|) / 2. With
 * u = |d|^2/r^2 - 1 this is f = u * psi(u), psi(u) = (1 - 1/sqrt(1+u)) / (2u), a smooth function
 * that needs no square root: a quadratic is within 0.25% of it for strains up to 10% and within 7%
 * over the whole range used here, u in [-7/16, 9/16]. A link stretched or compressed by more than 25%
 * is corrected by the step of 25%. The fixed point u = 0 is exact whatever psi is.
 *
 * Strain limiting is against stretch. Against compression the paper has the structural spring of
 * k_struct alone: its explicit force moves a pair by 2 k h^2/m of its shortening in a substep h, so
 * a compressed link gets that fraction (`push`) of a projection, at most all of it.
 *
 * A shear lock is a least length of the diagonals of the cells: behind the links, each diagonal that is
 * shorter is projected to it, as a compressed link of push 1. Most are far longer, which a sum of three sizes
 * shows.
 *
 * Formats: 32-bit products only, good on small targets and wide units. A difference d in Q24 is
 * split into hi, 15 bits in units of 2^8, and the rest lo, so that |d|^2 = hi^2 + 2 hi lo + ... is
 * known to 2^-24 of r^2 for rest lengths from 1/16 lu (lo^2 is left out: below 2^-23). Directions
 * use hi alone, lengths both: with 16-bit lengths the rounding alone kept a hanging cloth moving at
 * 3 cm/s. u and f are Q20; one step of f is at most one position step of the correction. The same
 * correction is added to one end and subtracted from the other, so a pair of equal masses keeps its
 * momentum to the last bit. Rounding is odd-symmetric, so mirrored cloths stay mirrored. */
#include "rt/simd/simd.h"
#include "rt/woven/woven.h"
#include "rt/woven/woven_links.h"

enum { WHOLE_CORRECTION = 4096 }; /* Q12 */

/* u * psi(u) in Q20. */
static inline int32_t half_strain(int32_t u) {
  const int32_t u_q15 = fx_asr(u, 5);
  const int32_t slope = fx_asr(fx_mul(u_q15, LINK_PSI_2) + LINK_HORNER_1, 15);
  const int32_t psi_q13 = fx_asr(fx_mul(u_q15, slope) + LINK_HORNER_0, 18);
  return fx_asr(fx_mul(u, psi_q13) + (1 << 12), 13);
}

/* f in Q20, -1/6..1/10, from e = |d|^2 - r^2. Where the ends are less than 4 units apart the product may
 * fall below -2^31 and wrap: such ends move by at most 3 f, in whichever direction. */
static inline int32_t projection_factor(int32_t e, const link_class *c) {
  const int32_t u = fx_asr(fx_wrap_add(fx_wrap_mul(fx_asr(e + 16, 5), c->inverse), 1 << 10), 11);
  if (__builtin_expect(u >= 0, 1)) return half_strain(u);
  return fx_asr(fx_mul(half_strain(fx_max(u, LINK_U_LEAST)), c->push), 12);
}

/* f * d from i to j, 2^(20 - LINK_SHIFT) for one step of a position, times `fraction`, Q12. Forced inline:
 * compilers for small targets would pass it through memory. */
__attribute__((always_inline)) static inline vec3 correction(const link_view *s, uint32_t i, uint32_t j,
                                                             const link_class *c, int32_t fraction) {
  const vec3 d = link_vec(s, i, j);
  vec3 hi = link_coarse_vec(d);
  uint32_t n = link_squared(d, hi);
  if (__builtin_expect(n > (uint32_t)c->n_max, 0)) {
    n = (uint32_t)c->n_max;
    hi = vec_clamp(hi, LINK_HI_MAX);
  }
  int32_t f = projection_factor((int32_t)n - c->r2, c);
  if (fraction != WHOLE_CORRECTION) f = fx_asr(fx_mul(f, fraction) + (1 << 11), 12);
  return vec_mul(hi, f);
}

/* Moves both ends by half of the correction, equal and opposite; an end of half the mass by twice that. */
static inline void move_both(int32_t *restrict x, uint32_t i, uint32_t j, int32_t product,
                             int32_t inverse_mass_i, int32_t inverse_mass_j) {
  FRAY_ASSERT(i != j);
  const int32_t c = fx_round(product, 20 - LINK_SHIFT);
  x[i] = fx_add(x[i], c * inverse_mass_i);
  x[j] = fx_sub(x[j], c * inverse_mass_j);
}

/* One link. Where one end has half the mass of the other, that end moves by two thirds, the other by one
 * third. The correction is computed once, so momentum is kept to the last bit here too. Out of line: rare. */
__attribute__((noinline)) static void project_one(link_view s, uint32_t spring) {
  const uint32_t kind = s.kind[spring];
  const uint32_t i = s.i[spring];
  const uint32_t j = s.j[spring];
  const int32_t inverse_mass_i = (kind & SPRING_HALF_I) != 0 ? 2 : 1;
  const int32_t inverse_mass_j = (kind & SPRING_HALF_J) != 0 ? 2 : 1;
  const int32_t fraction = (kind & SPRING_HALF_MASS) != 0 ? LINK_THIRD : WHOLE_CORRECTION;
  const vec3 c = correction(&s, i, j, &s.classes[kind & SPRING_CLASS], fraction);
  move_both(s.x, i, j, c.x, inverse_mass_i, inverse_mass_j);
  move_both(s.y, i, j, c.y, inverse_mass_i, inverse_mass_j);
  move_both(s.z, i, j, c.z, inverse_mass_i, inverse_mass_j);
}

static void project_free(link_view s, uint32_t first, uint32_t end) {
  for (uint32_t spring = first; spring < end; ++spring) {
    const int32_t kind = (int8_t)s.kind[spring];
    if (kind <= SPRING_DEAD) {
      if (kind != SPRING_DEAD) project_one(s, spring);
      continue;
    }
    const uint32_t i = s.i[spring];
    const uint32_t j = s.j[spring];
    FRAY_ASSERT(i != j);
    const vec3 c = correction(&s, i, j, &s.classes[kind], WHOLE_CORRECTION);
    move_both(s.x, i, j, c.x, 1, 1);
    move_both(s.y, i, j, c.y, 1, 1);
    move_both(s.z, i, j, c.z, 1, 1);
  }
}

static inline int32_t lock_size(int32_t d) { return fx_asr(d < 0 ? -d : d, LOCK_FAR_SHIFT); }
static inline int lock_is_far(vec3 d, const link_class *lock) {
  return lock_size(d.x) + lock_size(d.y) + lock_size(d.z) >= lock_far(lock);
}

/* Links with end i carried by a body: end j moves by the whole correction, the body gets the opposite
 * momentum, half as much where j has half the mass. */
static void project_attached(fray_world *w, link_view s, uint32_t first, uint32_t end) {
  for (uint32_t spring = first; spring < end; ++spring) {
    const uint32_t kind = s.kind[spring];
    if (kind == SPRING_DEAD) continue;
    const uint32_t i = s.i[spring];
    const uint32_t j = s.j[spring];
    FRAY_ASSERT(i < particles_attached(w) && j >= particles_attached(w));
    if (s.is_lock && lock_is_far(link_vec(&s, i, j), &s.classes[CLASS_SHEAR])) continue;
    const vec3 twice = correction(&s, i, j, &s.classes[kind & SPRING_CLASS], WHOLE_CORRECTION);
    const int32_t mass = (kind & SPRING_HALF_MASS) != 0 ? 1 << (FX_SUB_BITS - 1) : 1 << FX_SUB_BITS;
    const vec3 c = vec_negated(vec_round(twice, 19 - LINK_SHIFT));
    vec_add_at(s.x, s.y, s.z, j, c);
    body_add_impulse(&w->rigid.motion[w->p.attach_body[i]], vec_scale64(c, mass));
  }
}

/* Diagonals of free particles; few of them may be too short. */
static void lock_free(link_view s, uint32_t first, uint32_t end) {
  const link_class *const lock = &s.classes[CLASS_SHEAR];
  for (uint32_t spring = first; spring < end; ++spring) {
    if (s.kind[spring] == SPRING_DEAD) continue;
    const vec3 d = link_vec(&s, s.i[spring], s.j[spring]);
    if (!lock_is_far(d, lock) && link_squared(d, link_coarse_vec(d)) < (uint32_t)lock->r2)
      project_one(s, spring);
  }
}

static void project_batches(fray_world *w, link_view view, uint32_t b, uint32_t batches) {
  FRAY_ASSERT(!world_has_membrane(w) && b <= batches);
  while (b < batches) {
    const int32_t attached = w->woven.batches[b].attached;
    const uint32_t first = (uint32_t)w->woven.batches[b].first;
    const uint32_t begun = b;
    const uint32_t end = world_batch_run(w, &b, batches);
    FRAY_ASSERT(first <= end && end <= w->capacity[POOL_SPRINGS]);
    if (attached == BATCH_INACTIVE) continue;
    if (attached == BATCH_ATTACHED) {
      project_attached(w, view, first, end);
    } else if (!simd_strain_limit(w->kernel, view, w->woven.batches + begun, b - begun)) {
      if (view.is_lock)
        lock_free(view, first, end);
      else
        project_free(view, first, end);
    }
    w->work.projections += end - first;
  }
}

void strain_limit_range(fray_world *w, uint32_t b, uint32_t batches) {
  FRAY_ASSERT(batches <= (uint32_t)w->params->link_batches);
  project_batches(w, woven_links(w), b, batches);
}

/* Second springs of diagonals, behind the first, are dead before a crossing splits. */
static void lock_diagonals(fray_world *w) {
  const params *const p = w->params;
  const uint32_t begin = (uint32_t)(p->link_batches + p->bend_batches);
  const int has_split = w->p.count != (uint32_t)p->particles;
  project_batches(w, woven_diagonals(w), begin,
                  has_split ? w->capacity[POOL_BATCHES] : begin + (uint32_t)p->shear_batches);
}

void strain_limit_apply(fray_world *w) {
  FRAY_ASSERT(w->params->iterations > 0);
  for (int32_t iteration = 0; iteration < w->params->iterations; ++iteration) {
    if (world_is_projected(w)) strain_limit_range(w, 0, (uint32_t)w->params->link_batches);
    if (world_has_shear_lock(w)) lock_diagonals(w);
  }
}
