/* SPDX-License-Identifier: Apache-2.0 */
/* Bend and shear springs, once a tick, as explicit forces (Metaaphanon 2009, section 3.2):
 * bend springs connect every other particle of a yarn; shear springs are the diagonals of the
 * cells and act under compression only. At Table 1's constants their fastest vibration takes
 * 40 ms, far above a tick. Impulses are equal and opposite; a row with a held end gives the other
 * half to the body. */
#include "rt/stage/stage.h"

/* d * share * 2^-down, rounded. Above 32 bits of shift the upper word has it all, and it fits. */
static inline int32_t scale_far(int32_t d, int32_t share, unsigned down) {
  const int64_t product = fx_mul_wide(d, share);
  const int64_t sum = product + fx_asr64(product, 63) + ((int64_t)1 << (down - 1u));
  return fx_asr((int32_t)fx_asr64(sum, 32), down - 32u);
}
static int32_t scale_near(int32_t d, int32_t share, unsigned down) {
  return fx_saturate(fx_round64(fx_mul_wide(d, share), down));
}
/* Springs this strong are rare. */
__attribute__((noinline)) static void impulse_near(vec3 d, int32_t share, unsigned down, vec3 *dv) {
  *dv = vec_make(scale_near(d.x, share, down), scale_near(d.y, share, down),
                 scale_near(d.z, share, down));
}

/* dv of end i in Q28 lu per substep; end j gets the opposite. With s = 1 - rest/|d| in Q28 this is
 * d * s * gain; rest/|d| is bounded by 8, so that a spring pressed to a point does not explode. */
static inline int spring_impulse(vec3 d, const spring_class *c, vec3 *dv) {
  const uint64_t n = vec_squared(d);
  if (c->compression_only != 0 && n >= fx_square(c->rest)) return 0;
  if (n == 0) return 0;
  const fx_root root = fx_rsqrt(n, FX_ROOT_COARSE);
  const uint64_t ratio = fx_mul_wide_u((uint32_t)c->rest, root.inverse) >> (3u + root.h);
  const uint32_t ratio_max = 0x80000000u; /* 8 in Q28 */
  const uint32_t bounded = ratio < ratio_max ? (uint32_t)ratio : ratio_max;
  const int32_t s = fx_wrap_sub(1 << 28, (int32_t)bounded);
  const int32_t share = (int32_t)fx_asr64(fx_mul_wide(s, c->mantissa), 16);
  const unsigned down = 8u + (unsigned)c->shift;
  if (__builtin_expect(down > 32u, 1))
    *dv = vec_make(scale_far(d.x, share, down), scale_far(d.y, share, down),
                   scale_far(d.z, share, down));
  else
    impulse_near(d, share, down, dv);
  return 1;
}

static inline void push(fray_world *w, uint32_t p, int32_t x, int32_t y, int32_t z) {
  w->vx[p] = fx_add_saturated(w->vx[p], x);
  w->vy[p] = fx_add_saturated(w->vy[p], y);
  w->vz[p] = fx_add_saturated(w->vz[p], z);
}

/* Out of the way of the rows between free particles, which are most. */
__attribute__((noinline)) static void give_body(fray_world *w, uint32_t i, const vec3 *dv) {
  body_gave(&w->motion[w->grip_body[i]], -(int64_t)dv->x, -(int64_t)dv->y, -(int64_t)dv->z);
}

static void run_rows(fray_world *w, uint32_t first, uint32_t end, int32_t held) {
  for (uint32_t row = first; row < end; ++row) {
    const uint32_t kind = w->row_class[row];
    if (kind == ROW_DEAD) continue;
    const uint32_t i = w->row_i[row];
    const uint32_t j = w->row_j[row];
    vec3 dv;
    if (!spring_impulse(vec_sub(world_position(w, j), world_position(w, i)), &w->springs[kind], &dv))
      continue;
    push(w, j, -dv.x, -dv.y, -dv.z);
    if (held == BATCH_HELD)
      give_body(w, i, &dv);
    else
      push(w, i, dv.x, dv.y, dv.z);
  }
  w->work.springs += end - first;
}

void springs_run(fray_world *w) {
  const uint32_t last = (uint32_t)w->params->link_batches + (uint32_t)w->params->bend_batches +
                        (uint32_t)w->params->shear_batches;
  uint32_t b = (uint32_t)w->params->link_batches;
  while (b < last) {
    const int32_t held = w->batches[b].held;
    const uint32_t first = (uint32_t)w->batches[b].first;
    const uint32_t end = world_run_of_batches(w, &b, last);
    if (held != BATCH_IDLE) run_rows(w, first, end, held);
  }
}
