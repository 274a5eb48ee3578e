/* SPDX-License-Identifier: Apache-2.0 */
/* SIMD twin: rt/simd/bend_shear_lanes.inl.h.
 *
 * Bend and shear springs (Metaaphanon 2009, section 3.2), explicit, once a tick on velocities, beside
 * elastic yarns once a substep: bend springs connect every other particle of a yarn; shear springs are the
 * diagonals of the cells and act under compression only. At Table 1's constants their fastest vibration takes
 * 40 ms, far above a tick. Impulses are equal and opposite; of a spring with an attached end, the body gets
 * the impulse of that end.
 *
 * With d = p_j - p_i the change of velocity is gain * s * d, s = 1 - rest/|d|. In 32-bit products: d is
 * taken in units that make the rest length 13 bits, t = |d|^2/rest^2 is Q15 and clamped to 1/32..2, s comes
 * from a series in t - 1, exact at rest and in its slope there, within 0.3% of the rest length elsewhere. A
 * spring stretched by more than 41% pulls as at 41%, one compressed to a point does not explode. Velocities
 * stay within FX_SPEED_MAX and a spring changes them by BEND_SHEAR_DV_MAX at most, so their sums fit. */
#include "rt/simd/simd.h"
#include "rt/woven/woven.h"

static inline bend_shear_view view_of(const fray_world *w) {
  const bend_shear_view view = {w->p.x, w->p.y, w->p.z, w->p.vx, w->p.vy, w->p.vz, w->woven.spring_i,
                                w->woven.spring_j, w->woven.spring_kind, w->woven.bend_shear_classes};
  return view;
}

/* 1 - 1/sqrt(t) in Q14, t in Q15. */
static inline int32_t relative_elongation(int32_t t) {
  const unsigned far_up = t < 4096 ? 4 : 0;
  const unsigned up = far_up + (fx_wrap_shift(t, far_up) < 16384 ? 2u : 0u);
  const int32_t x = fx_wrap_shift(t, up) - 32768;
  int32_t y = BEND_SHEAR_SERIES_3 + fx_asr(fx_mul(x, BEND_SHEAR_SERIES_4), 15);
  y = BEND_SHEAR_SERIES_2 + fx_asr(fx_mul(x, y), 15);
  y = BEND_SHEAR_SERIES_1 + fx_asr(fx_mul(x, y), 15);
  return 16384 - fx_wrap_shift(16384 - fx_mul_q15(x, y), up / 2);
}

/* One component of d in units of 2^down. */
static inline int32_t coarse_component(const int32_t *x, uint32_t i, uint32_t j, unsigned down) {
  return fx_clamp_rare(fx_round(fx_sub(x[j], x[i]), down), -BEND_SHEAR_HI_MAX, BEND_SHEAR_HI_MAX);
}

static inline int32_t dv_component(int32_t d, int32_t pull, const bend_shear_class *c) {
  return fx_clamp_rare(fx_round(fx_mul(d, pull), (unsigned)c->scale), -BEND_SHEAR_DV_MAX,
                       BEND_SHEAR_DV_MAX);
}

/* 1 only if the spring is slack, on cores where this test is cheaper than the force; spring_impulse() makes
 * the exact one.
 * Where |d| is at least the rest length, |d|^2 in coarse units is at least `inactive_r2`, which leaves three
 * units for the rounding of d and of R: cores that sum squares in 64 bits measure exactly. For others d is
 * rounded with halves up, so never to more than in spring_impulse(); sums may wrap, where d is far beyond any
 * rest length. `inactive_r2` of a spring that acts both ways is the largest number. */
static inline int is_slack(const bend_shear_view *s, uint32_t i, uint32_t j, const bend_shear_class *c) {
#if FX_LONG_ACCUMULATE
  if (c->compression_only == 0) return 0;
  return vec_squared(vec_sub(vec_at(s->x, s->y, s->z, j), vec_at(s->x, s->y, s->z, i))) >= fx_square(c->rest);
#elif FX_NARROW
  const unsigned down = (unsigned)c->down;
  const int32_t half = fx_wrap_shift(1, down - 1u);
  const int32_t x = fx_asr(fx_wrap_add(fx_sub(s->x[j], s->x[i]), half), down);
  const int32_t y = fx_asr(fx_wrap_add(fx_sub(s->y[j], s->y[i]), half), down);
  const int32_t z = fx_asr(fx_wrap_add(fx_sub(s->z[j], s->z[i]), half), down);
  const int32_t n = fx_wrap_add(fx_wrap_add(fx_wrap_mul(x, x), fx_wrap_mul(y, y)), fx_wrap_mul(z, z));
  return n > c->inactive_r2;
#else
  (void)s, (void)i, (void)j, (void)c;
  return 0;
#endif
}

/* dv of end i in Q28 lu per substep; end j gets the opposite. Returns 0 iff the spring is slack. */
static inline int spring_impulse(const bend_shear_view *s, uint32_t i, uint32_t j, const bend_shear_class *c,
                                 vec3 *dv) {
  if (is_slack(s, i, j, c)) return 0;
  const unsigned down = (unsigned)c->down;
  const int32_t x = coarse_component(s->x, i, j, down);
  const int32_t y = coarse_component(s->y, i, j, down);
  const int32_t z = coarse_component(s->z, i, j, down);
  const int32_t n = fx_mul(x, x) + fx_mul(y, y) + fx_mul(z, z); /* below 3 * 2^28 */
  if (n >= c->inactive_r2) return 0;
  const int32_t e = fx_min(n, 2 * c->r2) - c->r2;
  const int32_t u = fx_asr(fx_mul(fx_round(e, 12), c->inverse) + (1 << 11), 12);
  const int32_t elongation = relative_elongation(fx_max(32768 + u, BEND_SHEAR_T_MIN));
  const int32_t pull = fx_round(fx_mul(elongation, c->gain), 14);
  *dv = vec_make(dv_component(x, pull, c), dv_component(y, pull, c), dv_component(z, pull, c));
  return 1;
}

/* By the view, not by its arrays as vec_add_at(): an Armv6-M has no registers for all three. */
static inline void add_velocity(const bend_shear_view *s, uint32_t p, vec3 dv) {
  s->vx[p] = fx_add(s->vx[p], dv.x);
  s->vy[p] = fx_add(s->vy[p], dv.y);
  s->vz[p] = fx_add(s->vz[p], dv.z);
}

/* A spring with an end of half the mass, which gains twice the velocity, or an attached end, which passes the
 * impulse to its body. Out of line: most springs have neither. */
__attribute__((noinline)) static void apply_to_unequal_ends(fray_world *w, uint32_t spring, vec3 dv) {
  const bend_shear_view s = view_of(w);
  const uint32_t kind = s.kind[spring];
  const uint32_t i = s.i[spring];
  const int32_t inverse_mass_i = (kind & SPRING_HALF_I) != 0 ? 2 : 1;
  const int32_t inverse_mass_j = (kind & SPRING_HALF_J) != 0 ? 2 : 1;
  add_velocity(&s, s.j[spring], vec_mul(dv, -inverse_mass_j));
  if (i < particles_attached(w))
    body_take_impulse(&w->rigid.motion[w->p.attach_body[i]], dv);
  else
    add_velocity(&s, i, vec_mul(dv, inverse_mass_i));
}

static void apply_springs(fray_world *w, bend_shear_view s, uint32_t first, uint32_t end, int32_t attached) {
  for (uint32_t spring = first; spring < end; ++spring) {
    const int32_t kind = (int8_t)s.kind[spring];
    if (kind == SPRING_DEAD) continue;
    const uint32_t i = s.i[spring];
    const uint32_t j = s.j[spring];
    vec3 dv;
    FRAY_ASSERT(i < w->p.count && j < w->p.count && i != j);
    if (!spring_impulse(&s, i, j, &s.classes[kind & SPRING_CLASS], &dv)) continue;
    if (kind < 0 || attached == BATCH_ATTACHED) {
      apply_to_unequal_ends(w, spring, dv);
      continue;
    }
    add_velocity(&s, j, vec_negated(dv));
    add_velocity(&s, i, dv);
  }
}

/* Springs first..end-1: those of `count` successive batches, all of one kind. */
static void apply_batches(fray_world *w, const spring_batch *b, uint32_t count, uint32_t first,
                          uint32_t end) {
  FRAY_ASSERT(first >= (uint32_t)w->params->links && first <= end && end <= w->capacity[POOL_SPRINGS]);
  const bend_shear_view view = view_of(w);
  if (b->attached == BATCH_INACTIVE) return;
  if (b->attached == BATCH_ATTACHED || !simd_bend_shear(w->kernel, view, b, count))
    apply_springs(w, view, first, end, b->attached);
  w->work.springs += end - first;
}

void bend_shear_range(fray_world *w, uint32_t b, uint32_t first, uint32_t end) {
  FRAY_ASSERT(b >= (uint32_t)w->params->link_batches && b < w->capacity[POOL_BATCHES]);
  const spring_batch range = {(int32_t)first, (int32_t)(end - first), w->woven.batches[b].attached};
  apply_batches(w, &range, 1, first, end);
}

void bend_shear_apply(fray_world *w) {
  FRAY_ASSERT(!world_has_membrane(w));
  const uint32_t last = w->capacity[POOL_BATCHES];
  uint32_t b = (uint32_t)w->params->link_batches;
  while (b < last) {
    const uint32_t begun = b;
    const uint32_t end = world_batch_run(w, &b, last);
    apply_batches(w, w->woven.batches + begun, b - begun, (uint32_t)w->woven.batches[begun].first, end);
  }
}
