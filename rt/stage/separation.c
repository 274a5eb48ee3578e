/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/stage/separation.h"

#include "rt/model/fabric.h"

static direction unit(int32_t x, int32_t y) {
  const uint64_t squared = fx_square(x) + fx_square(y);
  direction d = {0, 0};
  if (squared == 0) return d;
  const fx_root root = fx_rsqrt(squared, FX_ROOT_FINE);
  d.u = fx_root_unit(root, x);
  d.v = fx_root_unit(root, y);
  return d;
}

typedef struct {
  int64_t u, v;
} traction;

/* The integral of a stress times direction, from one direction to another, anticlockwise. */
static traction between(sym2 pull, direction from, direction to) {
  const int32_t du = fx_sub(to.v, from.v);
  const int32_t dv = fx_sub(from.u, to.u);
  const traction q = {fx_add64(fx_mul_wide(pull.xx, du), fx_mul_wide(pull.xy, dv)),
                      fx_add64(fx_mul_wide(pull.xy, du), fx_mul_wide(pull.yy, dv))};
  return q;
}

static sym2 bounded(sym2 m) {
  const int32_t most = SEPARATION_STRESS_MAX;
  const sym2 b = {fx_clamp(m.xx, -most, most), fx_clamp(m.yy, -most, most),
                  fx_clamp(m.xy, -most, most)};
  return b;
}

void separation_prepare(separation_fan *f) {
  if (f->closed != 0) f->spoke[f->count] = f->spoke[0];
  f->major = 0;
  f->before_u[0] = 0;
  f->before_v[0] = 0;
  for (uint32_t n = 0; n < f->count; ++n) {
    const sym2 m = bounded(f->pull[n]);
    f->middle[n] = unit(fx_add(f->spoke[n].u, f->spoke[n + 1u].u),
                        fx_add(f->spoke[n].v, f->spoke[n + 1u].v));
    f->spoke[n] = unit(f->spoke[n].u, f->spoke[n].v);
    f->major = fx_max(f->major, sym2_eigen_of(m).major);
    f->pull[n] = sym2_positive(m);
  }
  f->spoke[f->count] = f->closed != 0 ? f->spoke[0]
                                      : unit(f->spoke[f->count].u, f->spoke[f->count].v);
  for (uint32_t n = 0; n < f->count; ++n) {
    const traction q = between(f->pull[n], f->spoke[n], f->spoke[n + 1u]);
    f->before_u[n + 1u] = fx_add64(f->before_u[n], q.u);
    f->before_v[n + 1u] = fx_add64(f->before_v[n], q.v);
  }
}

/* Traction from spoke 0 to a direction in triangle n. */
static traction up_to(const separation_fan *f, uint32_t n, direction d) {
  traction q = between(f->pull[n], f->spoke[n], d);
  q.u = fx_add64(q.u, f->before_u[n]);
  q.v = fx_add64(q.v, f->before_v[n]);
  return q;
}

static int64_t turn(direction from, direction to) {
  return fx_mul_wide(from.u, to.v) - fx_mul_wide(from.v, to.u);
}

/* Which triangle of a closed fan a direction is in: the one whose spokes are on both sides of it, by the
 * most where rounding leaves none. */
static uint32_t triangle_of(const separation_fan *f, direction d) {
  uint32_t found = 0;
  int64_t best = INT64_MIN;
  for (uint32_t n = 0; n < f->count; ++n) {
    const int64_t after = turn(f->spoke[n], d);
    const int64_t ahead = turn(d, f->spoke[n + 1u]);
    if (after >= 0 && ahead > 0) return n;
    const int64_t least = after < ahead ? after : ahead;
    if (least <= best) continue;
    best = least;
    found = n;
  }
  return found;
}

static int32_t dot(direction a, direction b) {
  return (int32_t)fx_round64(fx_add64(fx_mul_wide(a.u, b.u), fx_mul_wide(a.v, b.v)), 30);
}

static direction stress_of(traction q) {
  const direction d = {(int32_t)fx_round64(q.u, 30), (int32_t)fx_round64(q.v, 30)};
  return d;
}

typedef struct {
  int32_t separation;
  uint32_t opposite;
  direction line;
} pulled_line;

static pulled_line pull_along(const separation_fan *f, uint32_t candidate) {
  const uint32_t n = candidate / 2u;
  const traction all = {f->before_u[f->count], f->before_v[f->count]};
  pulled_line line = {0, 0, candidate % 2u == 0 ? f->spoke[n] : f->middle[n]};
  const traction here = up_to(f, n, line.line);
  traction left = {all.u - here.u, all.v - here.v};
  if (f->closed != 0) {
    const direction back = {-line.line.u, -line.line.v};
    line.opposite = triangle_of(f, back);
    const traction there = up_to(f, line.opposite, back);
    left.u = there.u - here.u;
    left.v = there.v - here.v;
    if (line.opposite < n) {
      left.u += all.u;
      left.v += all.v;
    }
  }
  const traction right = {all.u - left.u, all.v - left.v};
  const direction q1 = stress_of(left);
  const direction q2 = stress_of(right);
  const direction q = unit(fx_sub(q1.u, q2.u), fx_sub(q1.v, q2.v));
  line.separation = fx_max(0, fx_min(dot(q1, q), -dot(q2, q)));
  return line;
}

static int32_t strength_required(const int32_t strength[SEPARATION_STRENGTHS], direction line) {
  const int flip = line.u < 0 || (line.u == 0 && line.v < 0);
  const int32_t u = flip ? -line.u : line.u;
  const int32_t v = flip ? -line.v : line.v;
  const int32_t at = fabric_direction(v, u); /* 1 is 45 degrees */
  const uint32_t row = (uint32_t)fx_asr(at, STRAIN_BITS) % SEPARATION_STRENGTHS;
  const int32_t share = at & (STRAIN_ONE - 1);
  const int32_t from = strength[row];
  const int32_t to = strength[(row + 1u) % SEPARATION_STRENGTHS];
  return from + (int32_t)fx_round64(fx_mul_wide(fx_sub(to, from), share), STRAIN_BITS);
}

separation_ratio separation_ratio_of(const separation_fan *f, uint32_t candidate,
                                     const int32_t strength[SEPARATION_STRENGTHS]) {
  const pulled_line line = pull_along(f, candidate);
  const int32_t required = strength_required(strength, line.line);
  const separation_ratio ratio = {line.separation, f->closed != 0 ? fx_add(required, required) : required,
                                  candidate, line.opposite, line.line};
  return ratio;
}
