/* SPDX-License-Identifier: Apache-2.0 */
/* What acts on a triangle sheet from outside, once a tick: loads along its border, and wind.
 *
 * A load is a force per length at rest; each end of a side gets half of it, in every inner step.
 *
 * Wind: air of velocity a, of the density p, on a triangle with normal n, area A and velocity b,
 * the mean of its corners, w = a - b, gives
 *
 *   p A / 2 (c_n |w.n| (w.n) n + c_d |w_t| w_t),  w_t = w - (w.n) n
 *
 * a third to each corner. In masses m of a particle and Q28 lu per substep, with w in lu per
 * substep, s substeps a tick and |N| = 2 A, the impulse of a corner in a tick is
 *
 *   |N| w^2 gain,  gain = p c lu^3 s / (12 m) 2^28 */
#include "rt/base/bytes.h"
#include "rt/model/element.h"
#include "rt/stage/stage.h"
#include "rt/wide/wide.h"

enum { BLOW_MAX = 1 << 26, LOAD_NEAR = 64 /* position steps off its line */ };

static int is_near(const cloth_load *load, const sheet_mesh *s, uint32_t p) {
  const int64_t at = fx_mul_wide(load->u, s->u[p]) + fx_mul_wide(load->v, s->v[p]);
  const int64_t off = fx_round64(at, 30) - load->at;
  return off >= -LOAD_NEAR && off <= LOAD_NEAR;
}

static int32_t more(int32_t given, int64_t impulse) {
  return (int32_t)fx_clamp64(given + impulse, -BLOW_MAX, BLOW_MAX);
}
static void give(inner_sum *sum, int64_t x, int64_t y, int64_t z) {
  sum->x = more(sum->x, x);
  sum->y = more(sum->y, y);
  sum->z = more(sum->z, z);
}

static void load_side(fray_world *w, const cloth_load *load, uint32_t from, uint32_t to) {
  const sheet_mesh *s = &w->sheet;
  if (!is_near(load, s, from) || !is_near(load, s, to)) return;
  const uint64_t squared =
      fx_square(fx_sub(s->u[to], s->u[from])) + fx_square(fx_sub(s->v[to], s->v[from]));
  const int32_t length = (int32_t)fx_root_length(fx_rsqrt(squared, FX_ROOT_FINE));
  int64_t half[3];
  for (uint32_t n = 0; n < 3; ++n)
    half[n] = fx_round64(fx_mul_wide(load->force[n], length), FX_POSITION_BITS + 1);
  give(&w->given[from], half[0], half[1], half[2]);
  give(&w->given[to], half[0], half[1], half[2]);
}

static void load_border(fray_world *w) {
  const sheet_mesh *s = &w->sheet;
  bytes_zero(w->given, w->particles * sizeof *w->given);
  for (uint32_t n = 0; n < CLOTH_LOADS; ++n) {
    const cloth_load *load = &w->cloths->load[n];
    if (load->u == 0 && load->v == 0) continue;
    for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t)
      for (uint32_t k = 0; k < 3; ++k)
        if (sheet_across(s, t, k) == SHEET_NONE)
          load_side(w, load, s->triangle[t].v[sheet_next(k)], s->triangle[t].v[sheet_last(k)]);
  }
}

/* |N| Q24, w^2 Q28, a unit Q30 along the impulse. */
static int32_t share(int64_t area_wind, int32_t gain, unsigned shift) {
  return (int32_t)fx_clamp64(
      fx_round64(fx_mul_wide(fx_saturate(fx_round64(area_wind, 28)), gain), shift), -BLOW_MAX,
      BLOW_MAX);
}

static int32_t third(const int32_t *v, const row_id *of) {
  return (int32_t)(((int64_t)v[of[0]] + v[of[1]] + v[of[2]]) / 3);
}

static vec3 face_unit(vec3 v, uint32_t *length) {
  const fx_root root = fx_rsqrt(vec_squared(v), FX_ROOT_FINE);
  *length = fx_root_length(root);
  return vec_make(fx_root_unit(root, v.x), fx_root_unit(root, v.y), fx_root_unit(root, v.z));
}

/* Q48 of two Q24 vectors of at most 4 lu, to Q24. */
static vec3 cross(vec3 a, vec3 b) {
  return vec_make(
      (int32_t)fx_round64(fx_mul_wide(a.y, b.z) - fx_mul_wide(a.z, b.y), FX_POSITION_BITS),
      (int32_t)fx_round64(fx_mul_wide(a.z, b.x) - fx_mul_wide(a.x, b.z), FX_POSITION_BITS),
      (int32_t)fx_round64(fx_mul_wide(a.x, b.y) - fx_mul_wide(a.y, b.x), FX_POSITION_BITS));
}

static int64_t squared_q28(int32_t v) { return fx_round64(fx_mul_wide(v, v), 28); }

static void blow_triangle(fray_world *w, uint32_t t) {
  const cloth_params *c = w->cloths;
  const row_id *of = w->sheet.triangle[t].v;
  const vec3 d1 = {element_way(w->x, of[0], of[1]), element_way(w->y, of[0], of[1]),
                   element_way(w->z, of[0], of[1])};
  const vec3 d2 = {element_way(w->x, of[0], of[2]), element_way(w->y, of[0], of[2]),
                   element_way(w->z, of[0], of[2])};
  const vec3 normal = cross(d1, d2);
  uint32_t area;
  uint32_t speed;
  if (vec_squared(normal) == 0) return;
  const vec3 n = face_unit(normal, &area);
  const vec3 wind = {fx_saturate((int64_t)c->wind[0] - third(w->vx, of)),
                     fx_saturate((int64_t)c->wind[1] - third(w->vy, of)),
                     fx_saturate((int64_t)c->wind[2] - third(w->vz, of))};
  const int32_t across = fx_clamp(vec_dot_unit(wind, n), -FX_SPEED_MAX, FX_SPEED_MAX);
  const int64_t pressed = squared_q28(across) * (across < 0 ? -1 : 1);
  const int32_t push = share(fx_mul64(pressed, area), c->wind_normal, (unsigned)c->wind_shift);
  vec3 j = vec_scale_unit(n, push);
  const vec3 normal_part = vec_scale_unit(n, across);
  const vec3 along = {fx_clamp(fx_wrap_sub(wind.x, normal_part.x), -FX_SPEED_MAX, FX_SPEED_MAX),
                      fx_clamp(fx_wrap_sub(wind.y, normal_part.y), -FX_SPEED_MAX, FX_SPEED_MAX),
                      fx_clamp(fx_wrap_sub(wind.z, normal_part.z), -FX_SPEED_MAX, FX_SPEED_MAX)};
  if (c->wind_drag != 0 && vec_squared(along) != 0) {
    const vec3 way = face_unit(along, &speed);
    const int32_t slow = fx_saturate(speed);
    const int32_t drawn =
        share(fx_mul64(squared_q28(slow), area), c->wind_drag, (unsigned)c->wind_shift);
    j = vec_add(j, vec_scale_unit(way, drawn));
  }
  for (uint32_t k = 0; k < 3; ++k) give(&w->sums[of[k]], j.x, j.y, j.z);
}

static int32_t blown(int32_t v, int32_t sum, int32_t inverse) {
  return (int32_t)fx_clamp64(v + fx_round64(fx_mul_wide(sum, inverse), 24), -FX_SPEED_MAX,
                             FX_SPEED_MAX);
}

static void blow_wind(fray_world *w) {
  const uint32_t held = (uint32_t)w->params->held;
  const uint32_t triangles = (uint32_t)w->sheet.state->triangles;
  const blow_view view = {{w->x, w->y, w->z}, {w->vx, w->vy, w->vz}, w->sheet.triangle, w->cloths, w->sums};
  bytes_zero(w->sums, w->particles * sizeof *w->sums);
  /* once one is left to this code, sums may be held to a bound: so are all after it */
  for (uint32_t t = wide_blow(w->kernel, &view, 0, triangles); t < triangles; ++t) blow_triangle(w, t);
  for (uint32_t p = 0; p < held; ++p)
    body_gave(&w->motion[w->grip_body[p]], -(int64_t)w->sums[p].x, -(int64_t)w->sums[p].y,
              -(int64_t)w->sums[p].z);
  for (uint32_t p = held; p < w->particles; ++p) {
    w->vx[p] = blown(w->vx[p], w->sums[p].x, w->inverse[p]);
    w->vy[p] = blown(w->vy[p], w->sums[p].y, w->inverse[p]);
    w->vz[p] = blown(w->vz[p], w->sums[p].z, w->inverse[p]);
  }
}

void blow_run(fray_world *w) {
  if (!world_has_sheet(w)) return;
  load_border(w);
  if (w->cloths->wind_normal != 0 || w->cloths->wind_drag != 0) blow_wind(w);
}
