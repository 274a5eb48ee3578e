/* SPDX-License-Identifier: Apache-2.0 */
/* Bend and shear springs, once a tick, as explicit forces (Metaaphanon 2009, section 3.2):
 * bend springs connect every other particle of a yarn; shear springs are the diagonals of the
 * cells and act under compression only. At Table 1's constants their fastest vibration takes
 * 40 ms, far above a tick. Impulses are equal and opposite; a row with a held end gives the other
 * half to the body. */
#include "rt/stage/stage.h"

/* dv of end i in Q28 lu per substep; end j gets the opposite. With s = 1 - rest/|d| in Q28 this is
 * d * s * gain; rest/|d| is bounded by 8, so that a spring pressed to a point does not explode. */
static int spring_impulse(const fray_world *w, uint32_t row, const spring_class *c, int32_t dv[3]) {
  const vec3 d = vec_sub(world_position(w, w->row_j[row]), world_position(w, w->row_i[row]));
  const uint64_t n = vec_squared(d);
  const uint64_t rest2 = (uint64_t)fx_mul_wide(c->rest, c->rest);
  if (n == 0 || (c->compression_only != 0 && n >= rest2)) return 0;
  const fx_root root = fx_rsqrt(n, FX_ROOT_COARSE);
  const uint64_t ratio = ((uint64_t)(uint32_t)c->rest * root.inverse) >> (3u + root.h);
  const int64_t s = ((int64_t)1 << 28) - (int64_t)(ratio < (8u << 28) ? ratio : 8u << 28);
  const int64_t share = fx_asr64(fx_mul64(s, c->mantissa), 16);
  const unsigned down = 8u + (unsigned)c->shift;
  dv[0] = fx_saturate(fx_round64(fx_mul64(d.x, share), down));
  dv[1] = fx_saturate(fx_round64(fx_mul64(d.y, share), down));
  dv[2] = fx_saturate(fx_round64(fx_mul64(d.z, share), down));
  return 1;
}

static void push(fray_world *w, uint32_t p, const int32_t dv[3], int64_t sign) {
  w->vx[p] = fx_saturate(w->vx[p] + sign * dv[0]);
  w->vy[p] = fx_saturate(w->vy[p] + sign * dv[1]);
  w->vz[p] = fx_saturate(w->vz[p] + sign * dv[2]);
}

static void run_batch(fray_world *w, const row_batch *batch) {
  const uint32_t first = (uint32_t)batch->first;
  const uint32_t end = first + (uint32_t)batch->count;
  for (uint32_t row = first; row < end; ++row) {
    const uint32_t kind = w->row_class[row];
    int32_t dv[3];
    if (kind == ROW_DEAD || !spring_impulse(w, row, &w->springs[kind], dv)) continue;
    push(w, w->row_j[row], dv, -1);
    if (batch->held == BATCH_HELD)
      body_gave(&w->motion[w->grip_body[w->row_i[row]]], -(int64_t)dv[0], -(int64_t)dv[1],
                -(int64_t)dv[2]);
    else
      push(w, w->row_i[row], dv, 1);
  }
  w->work.springs += end - first;
}

void springs_run(fray_world *w) {
  const uint32_t first = (uint32_t)w->params->link_batches;
  const uint32_t end =
      first + (uint32_t)w->params->bend_batches + (uint32_t)w->params->shear_batches;
  for (uint32_t b = first; b < end; ++b)
    if (w->batches[b].held != BATCH_IDLE) run_batch(w, &w->batches[b]);
}
