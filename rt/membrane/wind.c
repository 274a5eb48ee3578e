/* SPDX-License-Identifier: Apache-2.0 */
/* Outer loads of the membrane, once a tick: along its boundary, and of wind. SIMD twin of the wind:
 * rt/simd/wind_lanes.inl.h.
 *
 * A load is a force per length at rest; each end of an edge gets half of it, in every elastic step.
 *
 * Wind: air of velocity a, of the density p, on a triangle with normal n, area A and velocity b,
 * the mean of its corners, w = a - b, gives
 *
 *   p A / 2 (c_n |w.n| (w.n) n + c_d |w_t| w_t),  w_t = w - (w.n) n
 *
 * a third to each corner. In masses m of a particle and Q28 lu per substep, with w in lu per
 * substep, s substeps a tick and |N| = 2 A, the impulse of a corner in a tick is
 *
 *   |N| w^2 gain,  gain = p c lu^3 s / (12 m) 2^28
 *
 * Once a tick that would turn w round on cloth of a few g/m2. So air takes at most half of w from a triangle
 * in a tick, along the normal and across it: a corner has its own part M of its vertex's mass, the square of
 * a vertex's J over its mass is at most the sum of theirs, and with J = s M w, s below 2, air at rest takes
 * energy. */
#include "rt/base/bytes.h"
#include "rt/membrane/membrane.h"
#include "rt/simd/simd.h"
#include "rt/state/deformation.h"

enum { DRAG_SPEED_MAX = FX_SPEED_MAX / 2 * 3 }; /* its square times the largest area fits */
enum { IMPULSE_MAX = 1 << 26, LOAD_TOLERANCE = 64 /* Q24 off the load's line */ };

static void add_wind(elastic_impulse *sum, vec3 j) {
  const vec3 limited = vec_add_clamped(elastic_impulse_vec(sum), j, IMPULSE_MAX);
  sum->x = limited.x;
  sum->y = limited.y;
  sum->z = limited.z;
}

/* ---- loads ---- */

static int is_on_line(const membrane_load *load, const trimesh *s, uint32_t p) {
  const int64_t at = fx_mul_wide(load->u, s->u[p]) + fx_mul_wide(load->v, s->v[p]);
  const int64_t off = fx_round64(at, 30) - load->at;
  return off >= -LOAD_TOLERANCE && off <= LOAD_TOLERANCE;
}

static void load_edge(fray_world *w, const membrane_load *load, uint32_t from, uint32_t to) {
  FRAY_ASSERT(from < w->p.count && to < w->p.count && from != to);
  const trimesh *s = &w->trimesh;
  if (!is_on_line(load, s, from) || !is_on_line(load, s, to)) return;
  const uint64_t squared =
      fx_square(fx_sub(s->u[to], s->u[from])) + fx_square(fx_sub(s->v[to], s->v[from]));
  const int32_t length = (int32_t)fx_root_length(fx_rsqrt(squared, FX_ROOT_FINE));
  const vec3 half = vec_round_saturated(vec_scale64(vec_of(load->force), length), FX_POSITION_BITS + 1);
  add_wind(&w->membrane.external_impulse[from], half);
  add_wind(&w->membrane.external_impulse[to], half);
}

static void load_boundary(fray_world *w) {
  const trimesh *s = &w->trimesh;
  bytes_zero(w->membrane.external_impulse, w->p.count * sizeof *w->membrane.external_impulse);
  for (uint32_t n = 0; n < MEMBRANE_LOADS; ++n) {
    const membrane_load *load = &w->membrane.constants->load[n];
    if (load->u == 0 && load->v == 0) continue;
    for (uint32_t t = 0; t < triangles_in_use(w); ++t)
      for (uint32_t k = 0; k < 3; ++k)
        if (trimesh_neighbour(s, t, k) == TRIMESH_NONE)
          load_edge(w, load, s->triangle[t].v[trimesh_next(k)], s->triangle[t].v[trimesh_previous(k)]);
  }
}

/* ---- wind ---- */

/* |N| Q24 times w^2 Q28 to an impulse. */
static int32_t impulse_of(int64_t area_wind, int32_t gain, unsigned shift) {
  const int32_t load = fx_saturate(fx_round64(area_wind, 28));
  return fx_clamp_wide(fx_round64(fx_mul_wide(load, gain), shift), IMPULSE_MAX);
}

/* Mean velocity of the corners along an axis. */
static int32_t mean(const int32_t *v, const index_t *corner) {
  return (int32_t)(((int64_t)v[corner[0]] + v[corner[1]] + v[corner[2]]) / 3);
}

/* To what takes half of this speed from a triangle: M = area / mass_unit. */
static int32_t limit_impulse(const fray_world *w, uint32_t t, int32_t impulse, int32_t speed) {
  const uint64_t most = fx_mul_wide_u(w->trimesh.area[t], (uint32_t)speed) / 2;
  const uint32_t unit = (uint32_t)w->membrane.constants->mass_unit;
  FRAY_ASSERT(impulse >= 0 && speed >= 0);
  return fx_mul_wide_u((uint32_t)impulse, unit) <= most ? impulse : (int32_t)fx_divide_wide(most, unit);
}

static int64_t square_q28(int32_t v) { return fx_round64(fx_mul_wide(v, v), 28); }

static void wind_triangle(fray_world *w, uint32_t t) {
  FRAY_ASSERT(t < triangles_in_use(w));
  const membrane_params *c = w->membrane.constants;
  const index_t *v = w->trimesh.triangle[t].v;
  const vec3 normal = vec_cross_q24(deformation_edge(w, v[0], v[1]), deformation_edge(w, v[0], v[2]));
  if (vec_squared(normal) == 0) return;
  const vec_direction n = vec_direction_of(normal);
  const vec3 velocity = vec_make(mean(w->p.vx, v), mean(w->p.vy, v), mean(w->p.vz, v));
  const vec3 wind = vec_sub_saturated(vec_of(c->wind), velocity);
  const int32_t normal_speed = fx_clamp(vec_dot_unit(wind, n.unit), -FX_SPEED_MAX, FX_SPEED_MAX);
  const int64_t pressure = square_q28(normal_speed);
  const int32_t push =
      limit_impulse(w, t, impulse_of(fx_mul64(pressure, n.length), c->wind_normal, (unsigned)c->wind_shift),
                    (int32_t)fx_magnitude(normal_speed));
  vec3 j = vec_scale_unit(n.unit, normal_speed < 0 ? -push : push);
  const vec3 normal_part = vec_scale_unit(n.unit, normal_speed);
  const vec3 tangential = vec_clamp(vec_wrap_sub(wind, normal_part), FX_SPEED_MAX);
  if (c->wind_drag != 0 && vec_squared(tangential) != 0) {
    const vec_direction along = vec_direction_of(tangential);
    const uint64_t speed = along.length < DRAG_SPEED_MAX ? along.length : DRAG_SPEED_MAX;
    const int64_t squared = square_q28((int32_t)speed);
    const int32_t drag =
        limit_impulse(w, t, impulse_of(fx_mul64(squared, n.length), c->wind_drag, (unsigned)c->wind_shift),
                      (int32_t)speed);
    j = vec_add(j, vec_scale_unit(along.unit, drag));
  }
  for (uint32_t k = 0; k < 3; ++k) add_wind(&w->membrane.impulse[v[k]], j);
}

static int32_t accelerated(int32_t v, int32_t impulse, int32_t inverse_mass) {
  return fx_clamp_wide(v + fx_round64(fx_mul_wide(impulse, inverse_mass), 24), FX_SPEED_MAX);
}

static void apply_wind(fray_world *w) {
  const uint32_t attached = particles_attached(w);
  const uint32_t triangles = triangles_in_use(w);
  elastic_impulse *sum = w->membrane.impulse; /* elastic steps begin it anew */
  const wind_view view = {
      {w->p.x, w->p.y, w->p.z}, {w->p.vx, w->p.vy, w->p.vz}, w->trimesh.triangle, w->trimesh.area,
      w->membrane.constants, sum};
  bytes_zero(sum, w->p.count * sizeof *sum);
  /* the first triangle left to this code may saturate a sum, so all that follow are left to it too */
  for (uint32_t t = simd_wind(w->kernel, &view, 0, triangles); t < triangles; ++t) wind_triangle(w, t);
  for (uint32_t p = 0; p < attached; ++p)
    body_take_impulse(&w->rigid.motion[w->p.attach_body[p]], elastic_impulse_vec(&sum[p]));
  for (uint32_t p = attached; p < w->p.count; ++p) {
    w->p.vx[p] = accelerated(w->p.vx[p], sum[p].x, w->membrane.inverse_mass[p]);
    w->p.vy[p] = accelerated(w->p.vy[p], sum[p].y, w->membrane.inverse_mass[p]);
    w->p.vz[p] = accelerated(w->p.vz[p], sum[p].z, w->membrane.inverse_mass[p]);
  }
}

void wind_apply(fray_world *w) {
  FRAY_ASSERT(world_has_membrane(w) && particles_attached(w) <= w->p.count);
  load_boundary(w);
  if (w->membrane.constants->wind_normal != 0 || w->membrane.constants->wind_drag != 0) apply_wind(w);
}
