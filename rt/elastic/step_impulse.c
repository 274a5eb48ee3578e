/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/elastic/step_impulse.h"

#include "rt/base/coulomb.h"
#include "rt/integrate/integrate.h"

enum { IMPULSE_SUM_MAX = 1 << 30, MORE = 1 << (FX_VELOCITY_BITS - ELASTIC_IMPULSE_BITS) };

int32_t step_part_of(int32_t whole, int32_t n, int32_t parts) {
  FRAY_ASSERT(n >= 0 && n < parts);
  const int64_t before = (int64_t)whole * n;
  const int64_t after = before + whole;
  const int64_t low = before >= 0 ? before / parts : -((-before + parts - 1) / parts);
  const int64_t high = after >= 0 ? after / parts : -((-after + parts - 1) / parts);
  return (int32_t)(high - low);
}

int32_t step_rise_of(const fray_world *w) {
  const uint32_t substeps_a_second = (uint32_t)w->params->rate_hz * (uint32_t)w->params->substeps;
  const uint64_t um = (uint64_t)STEP_RISE_UM_S << (FX_VELOCITY_BITS - 12);
  const uint64_t a_second = (uint64_t)fx_divide_wide(um, (uint32_t)w->params->lu_um) << 12;
  return a_second >> 30 >= substeps_a_second ? 1 << 30
                                             : (int32_t)fx_divide_wide(a_second, substeps_a_second);
}

uint32_t step_inverse_mass(const fray_world *w, uint32_t p) {
  const uint32_t body = step_body_of(w, p);
  const self_zone *z = step_zone_of(w, p);
  if (body != STEP_NO_BODY) return (uint32_t)w->rigid.bodies[body].mass_ratio >> 6;
  return z != NULL ? z->inverse_mass : (uint32_t)w->membrane.inverse_mass[p];
}

static int move_as_one(const fray_world *w, uint32_t p, uint32_t q) {
  const uint32_t body = step_body_of(w, p);
  if (body != STEP_NO_BODY) return body == step_body_of(w, q);
  return step_zone_of(w, p) != NULL && step_zone_of(w, p) == step_zone_of(w, q);
}

uint64_t step_point_inverse_mass(const fray_world *w, const uint32_t *vertex, const int32_t *weight,
                                 uint32_t count) {
  uint64_t k = 0;
  FRAY_ASSERT(count <= 4);
  for (uint32_t n = 0; n < count; ++n) {
    int32_t whole = 0; /* of all that move as one, squared once: weights of both signs leave little */
    uint32_t first = n;
    for (uint32_t m = 0; m < count; ++m) {
      if (m != n && !move_as_one(w, vertex[m], vertex[n])) continue;
      whole += weight[m];
      first = m < first ? m : first;
    }
    if (first == n) k += (fx_square(whole) >> 6) * step_inverse_mass(w, vertex[n]) >> 24;
  }
  return k;
}

int32_t step_mass_of(uint64_t k) {
  const uint64_t one = (uint64_t)1 << 40;
  FRAY_ASSERT(k != 0 && k >> 39 == 0);
  if (k <= 1u << 9) return INT32_MAX;
  if (k <= 1u << 31) return (int32_t)fx_divide_wide(one, (uint32_t)k);
  if (k <= UINT32_MAX) { /* by half of both: at most one too large */
    const uint32_t q = fx_divide_wide(one >> 1, (uint32_t)(k >> 1));
    return (int32_t)(q - ((uint64_t)q * k > one));
  }
  return (int32_t)(fx_divide_wide(one, (uint32_t)(k >> 8)) >> 8);
}

vec3 step_body_velocity(const fray_world *w, uint32_t b) {
  return b == STEP_NO_BODY ? vec_make(0, 0, 0) : vec_of(w->rigid.states[b].velocity);
}

vec64 step_gained(const fray_world *w, uint32_t p, const elastic_impulse *sum, const elastic_step *step) {
  enum { DOWN = ELASTIC_IMPULSE_BITS + ELASTIC_INVERSE_BITS - FX_VELOCITY_BITS };
  FRAY_ASSERT(p < w->p.count);
  const int32_t inverse = w->membrane.inverse_mass[p];
  const vec64 gained = {fx_round64(fx_mul_wide(sum->x, inverse), DOWN) + step->gravity[0],
                        fx_round64(fx_mul_wide(sum->y, inverse), DOWN) + step->gravity[1],
                        fx_round64(fx_mul_wide(sum->z, inverse), DOWN) + step->gravity[2]};
  return gained;
}

vec3 step_vertex_velocity(const fray_world *w, uint32_t p, const elastic_step *step) {
  const vec64 gained = step_gained(w, p, &w->membrane.impulse[p], step);
  const vec64 v = {w->p.vx[p] + gained.x, w->p.vy[p] + gained.y, w->p.vz[p] + gained.z};
  return vec_clamp64(v, INT32_MAX);
}

vec3 step_velocity(const fray_world *w, uint32_t p, const elastic_step *step) {
  const uint32_t body = step_body_of(w, p);
  const self_zone *z = step_zone_of(w, p);
  if (body != STEP_NO_BODY) return step_body_velocity(w, body);
  return z != NULL ? vec_of(z->mean) : step_vertex_velocity(w, p, step);
}

void step_push_body(fray_world *w, uint32_t b, vec64 impulse) {
  const vec64 gained = {impulse.x * MORE, impulse.y * MORE, impulse.z * MORE};
  if (b == STEP_NO_BODY) return;
  body_add_impulse(&w->rigid.motion[b], gained);
  if (w->rigid.bodies[b].motion == FRAY_FREE) body_update_velocity(w, b);
}

static int64_t add_part(int32_t *sum, int64_t impulse) {
  const int32_t before = *sum;
  *sum = (int32_t)fx_clamp64(before + impulse, -IMPULSE_SUM_MAX, IMPULSE_SUM_MAX);
  return (int64_t)*sum - before;
}

vec64 step_push_vertex(fray_world *w, uint32_t p, vec64 impulse) {
  FRAY_ASSERT(p < w->p.count && !particle_is_attached(w, p));
  elastic_impulse *sum = &w->membrane.impulse[p];
  const vec64 taken = {add_part(&sum->x, impulse.x), add_part(&sum->y, impulse.y),
                       add_part(&sum->z, impulse.z)};
  return taken;
}

static void push_zone(self_zone *z, vec64 impulse) {
  enum { UP = FX_VELOCITY_BITS - ELASTIC_IMPULSE_BITS + STEP_MASS_BITS };
  const int64_t by[3] = {impulse.x, impulse.y, impulse.z};
  FRAY_ASSERT(z->whole > 0);
  for (uint32_t n = 0; n < 3; ++n) z->mean[n] = fx_saturate(z->mean[n] + by[n] * (1 << UP) / z->whole);
}

vec64 step_push(fray_world *w, uint32_t p, vec64 impulse) {
  const uint32_t body = step_body_of(w, p);
  self_zone *z = step_zone_of(w, p);
  if (body == STEP_NO_BODY && z == NULL) return step_push_vertex(w, p, impulse);
  const vec64 back = {-impulse.x, -impulse.y, -impulse.z};
  if (body != STEP_NO_BODY)
    step_push_body(w, body, back);
  else
    push_zone(z, impulse);
  return impulse;
}

vec3 step_contact_change(vec3 velocity, vec3 normal, int32_t least, int32_t friction) {
  FRAY_ASSERT(friction >= 0);
  const int32_t speed = vec_dot_unit(velocity, normal);
  if (speed >= least) return vec_make(0, 0, 0);
  const int32_t pushed = fx_saturate((int64_t)least - speed);
  const vec3 slip = vec_sub_saturated(velocity, vec_scale_unit(normal, speed));
  return vec_sub_saturated(vec_scale_unit(normal, pushed), coulomb_limited(slip, pushed, friction));
}

vec64 step_impulse_of(int32_t mass, vec3 change) {
  enum { DOWN = FX_VELOCITY_BITS + STEP_MASS_BITS - ELASTIC_IMPULSE_BITS };
  const int64_t bound = (int64_t)1 << 40;
  const vec64 whole = vec_scale64(change, mass);
  const vec64 impulse = {fx_clamp64(fx_round64(whole.x, DOWN), -bound, bound),
                         fx_clamp64(fx_round64(whole.y, DOWN), -bound, bound),
                         fx_clamp64(fx_round64(whole.z, DOWN), -bound, bound)};
  return impulse;
}
