/* SPDX-License-Identifier: Apache-2.0 */
/* Bend and shear springs (Metaaphanon 2009, section 3.2), explicit, once a tick on velocities:
 * bend springs connect every other particle of a yarn; shear springs are the diagonals of the
 * cells and act under compression only. At Table 1's constants their fastest vibration takes
 * 40 ms, far above a tick. Impulses are equal and opposite; a row with a held end gives the other
 * half to the body.
 *
 * With d = p_j - p_i the change of velocity is gain * s * d, s = 1 - rest/|d|. In 32-bit products:
 * d is taken in units that make the rest length 13 bits, t = |d|^2/rest^2 is Q15 and held in
 * 1/32..2, s comes from a series in t - 1, exact at rest and in its slope there, within 0.3% of the
 * rest length elsewhere. One drawn by more than 41% pulls as at 41%, one pressed to a point does not
 * explode. Velocities stay within FX_SPEED_MAX and a spring changes them by SPRING_DV_MAX at most, so
 * their sums fit. */
#include "rt/stage/stage.h"
#include "rt/wide/wide.h"

/* 1 - 1/sqrt(t) in Q14, t in Q15. */
static inline int32_t spring_share(int32_t t) {
  const unsigned far_up = t < 4096 ? 4 : 0;
  const unsigned up = far_up + (fx_wrap_shift(t, far_up) < 16384 ? 2u : 0u);
  const int32_t x = fx_wrap_shift(t, up) - 32768;
  int32_t y = SPRING_SERIES_3 + fx_asr(fx_mul(x, SPRING_SERIES_4), 15);
  y = SPRING_SERIES_2 + fx_asr(fx_mul(x, y), 15);
  y = SPRING_SERIES_1 + fx_asr(fx_mul(x, y), 15);
  return 16384 - fx_wrap_shift(16384 - fx_mul_q15(x, y), up / 2);
}

static inline int32_t spring_coarse(const int32_t *x, uint32_t i, uint32_t j, unsigned down) {
  return fx_clamp_rare(fx_round(fx_sub(x[j], x[i]), down), -SPRING_HI_MAX, SPRING_HI_MAX);
}

static inline int32_t spring_axis(int32_t d, int32_t pull, const spring_class *c) {
  return fx_clamp_rare(fx_round(fx_mul(d, pull), (unsigned)c->scale), -SPRING_DV_MAX,
                       SPRING_DV_MAX);
}

/* Whether it does nothing, on cores that see it sooner than they work out what it does; what is not
 * loose here may still be so below.
 * Where |d| is at least the rest length, |d|^2 in coarse units is at least `idle`, which leaves three
 * units for the rounding of d and of R: cores that sum squares in 64 bits measure exactly. For others d is
 * rounded with halves up, so never to more than below; sums may wrap, where d is far beyond any rest
 * length. Idle of a spring that acts both ways is the largest number. */
static inline int spring_is_loose(const spring_view *s, uint32_t i, uint32_t j, const spring_class *c) {
#if FX_LONG_ACCUMULATE
  if (c->compression_only == 0) return 0;
  const vec3 d = vec_make(fx_sub(s->x[j], s->x[i]), fx_sub(s->y[j], s->y[i]),
                          fx_sub(s->z[j], s->z[i]));
  return vec_squared(d) >= fx_square(c->rest);
#elif FX_NARROW
  const unsigned down = (unsigned)c->down;
  const int32_t half = fx_wrap_shift(1, down - 1u);
  const int32_t x = fx_asr(fx_wrap_add(fx_sub(s->x[j], s->x[i]), half), down);
  const int32_t y = fx_asr(fx_wrap_add(fx_sub(s->y[j], s->y[i]), half), down);
  const int32_t z = fx_asr(fx_wrap_add(fx_sub(s->z[j], s->z[i]), half), down);
  const int32_t n = fx_wrap_add(fx_wrap_add(fx_wrap_mul(x, x), fx_wrap_mul(y, y)), fx_wrap_mul(z, z));
  return n > c->idle;
#else
  (void)s, (void)i, (void)j, (void)c;
  return 0;
#endif
}

/* dv of end i in Q28 lu per substep; end j gets the opposite. */
static inline int spring_impulse(const spring_view *s, uint32_t i, uint32_t j,
                                 const spring_class *c, vec3 *dv) {
  if (spring_is_loose(s, i, j, c)) return 0;
  const unsigned down = (unsigned)c->down;
  const int32_t x = spring_coarse(s->x, i, j, down);
  const int32_t y = spring_coarse(s->y, i, j, down);
  const int32_t z = spring_coarse(s->z, i, j, down);
  const int32_t n = fx_mul(x, x) + fx_mul(y, y) + fx_mul(z, z); /* below 3 * 2^28 */
  if (n >= c->idle) return 0;
  const int32_t e = fx_min(n, 2 * c->r2) - c->r2;
  const int32_t u = fx_asr(fx_mul(fx_round(e, 12), c->inverse) + (1 << 11), 12);
  const int32_t share = spring_share(fx_max(32768 + u, SPRING_T_LEAST));
  const int32_t pull = fx_round(fx_mul(share, c->pull), 14);
  *dv = vec_make(spring_axis(x, pull, c), spring_axis(y, pull, c), spring_axis(z, pull, c));
  return 1;
}

static inline void push(const spring_view *s, uint32_t p, int32_t x, int32_t y, int32_t z) {
  s->vx[p] = fx_add(s->vx[p], x);
  s->vy[p] = fx_add(s->vy[p], y);
  s->vz[p] = fx_add(s->vz[p], z);
}

/* Out of the way of the rows between free particles that both weigh a whole crossing, which are most. A
 * light end gains twice the velocity from the same impulse; a held one gives it to the body. */
__attribute__((noinline)) static void push_other(fray_world *w, uint32_t row, vec3 dv) {
  const spring_view s = {w->x,  w->y,     w->z,     w->vx,        w->vy,
                         w->vz, w->row_i, w->row_j, w->row_class, w->springs};
  const uint32_t kind = s.kind[row];
  const uint32_t i = s.i[row];
  const int32_t of_i = (kind & ROW_UP_I) != 0 ? 2 : 1;
  const int32_t of_j = (kind & ROW_UP_J) != 0 ? 2 : 1;
  push(&s, s.j[row], -dv.x * of_j, -dv.y * of_j, -dv.z * of_j);
  if (i < (uint32_t)w->params->held)
    body_gave(&w->motion[w->grip_body[i]], -(int64_t)dv.x, -(int64_t)dv.y, -(int64_t)dv.z);
  else
    push(&s, i, dv.x * of_i, dv.y * of_i, dv.z * of_i);
}

static void run_rows(fray_world *w, spring_view s, uint32_t first, uint32_t end, int32_t held) {
  for (uint32_t row = first; row < end; ++row) {
    const int32_t kind = (int8_t)s.kind[row];
    if (kind == ROW_DEAD) continue;
    const uint32_t i = s.i[row];
    const uint32_t j = s.j[row];
    vec3 dv;
    if (!spring_impulse(&s, i, j, &s.classes[kind & ROW_CLASS], &dv)) continue;
    if (kind < 0 || held == BATCH_HELD) {
      push_other(w, row, dv);
      continue;
    }
    push(&s, j, -dv.x, -dv.y, -dv.z);
    push(&s, i, dv.x, dv.y, dv.z);
  }
}

/* Rows first..end-1, which are of `count` batches from b on, all of one kind. */
static void run_batches(fray_world *w, const row_batch *b, uint32_t count, uint32_t first,
                        uint32_t end) {
  const spring_view view = {w->x,  w->y,     w->z,     w->vx,        w->vy,
                            w->vz, w->row_i, w->row_j, w->row_class, w->springs};
  if (b->held == BATCH_IDLE) return;
  if (b->held == BATCH_HELD || !wide_push(w->kernel, view, b, count))
    run_rows(w, view, first, end, b->held);
  w->work.springs += end - first;
}

void springs_part(fray_world *w, uint32_t b, uint32_t first, uint32_t end) {
  const row_batch part = {(int32_t)first, (int32_t)(end - first), w->batches[b].held};
  run_batches(w, &part, 1, first, end);
}

void springs_run(fray_world *w) {
  const uint32_t last = w->capacity[POOL_BATCHES];
  uint32_t b = (uint32_t)w->params->link_batches;
  while (b < last) {
    const uint32_t begun = b;
    const uint32_t end = world_run_of_batches(w, &b, last);
    run_batches(w, w->batches + begun, b - begun, (uint32_t)w->batches[begun].first, end);
  }
}
