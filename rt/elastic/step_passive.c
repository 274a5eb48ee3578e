/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/elastic/step_passive.h"

#include "rt/base/wide.h"

/* Costs are m u^2, twice an energy: of a particle's mass at 2^-19.5 lu per substep. Speeds are squared in
 * Q26, so that they fit; the state has two words of 31 bits. */
enum { SPEED_DOWN = 2, COST_BITS = 64 - 2 * SPEED_DOWN, TANK_BITS = 31, LEAK_BITS = 4 };

static int64_t tank_of(const fray_world *w) {
  const int32_t *b = w->trimesh.state->contact_tank;
  return ((int64_t)b[0] << TANK_BITS) + b[1];
}

static void tank_set(fray_world *w, int64_t tank) {
  const int64_t kept = fx_clamp64(tank, 0, ((int64_t)1 << 2 * TANK_BITS) - 1);
  w->trimesh.state->contact_tank[0] = (int32_t)(kept >> TANK_BITS);
  w->trimesh.state->contact_tank[1] = (int32_t)(kept & INT32_MAX);
}

void step_passive_begin(fray_world *w) {
  const int64_t tank = tank_of(w);
  tank_set(w, tank - fx_asr64(tank + (1 << LEAK_BITS) - 1, LEAK_BITS));
}

void step_passive_mark(fray_world *w) {
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b) {
    elastic_body *e = &w->membrane.bodies[b];
    for (uint32_t n = 0; n < 3; ++n)
      e->half[n] = (int32_t)(((int64_t)w->rigid.states[b].velocity[n] - e->before[n]) / 2);
  }
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p)
    w->membrane.forced[p] = w->membrane.impulse[p];
}

vec3 step_body_half_of(const fray_world *w, uint32_t b) {
  return b == STEP_NO_BODY ? vec_make(0, 0, 0) : vec_of(w->membrane.bodies[b].half);
}

vec3 step_vertex_half_of(const fray_world *w, uint32_t p, const elastic_step *step) {
  const vec64 gained = step_gained(w, p, &w->membrane.forced[p], step);
  return vec_make(fx_saturate(gained.x / 2), fx_saturate(gained.y / 2), fx_saturate(gained.z / 2));
}

vec3 step_half_of(const fray_world *w, uint32_t p, const elastic_step *step) {
  const uint32_t body = step_body_of(w, p);
  const self_zone *z = step_zone_of(w, p);
  if (body != STEP_NO_BODY) return step_body_half_of(w, body);
  return z != NULL ? vec_of(z->half) : step_vertex_half_of(w, p, step);
}

int32_t step_passive_speed(int32_t wanted, int32_t speed, int32_t half) {
  const int64_t u = (int64_t)speed - half;
  const int64_t most = u < 0 ? -u : u;
  return fx_saturate(fx_clamp64(wanted, half - most, half + most));
}

/* Rounded up. */
static int64_t cost_of(int32_t mass, vec3 u, vec3 change) {
  const vec3 by = vec_asr(change, SPEED_DOWN);
  const vec3 a = vec_asr(u, SPEED_DOWN);
  const int64_t grows = fx_mul_wide(by.x, 2 * a.x + by.x) + fx_mul_wide(by.y, 2 * a.y + by.y) +
                        fx_mul_wide(by.z, 2 * a.z + by.z);
  const wide_number cost = wide_product(mass, grows, COST_BITS);
  const int64_t most = ((int64_t)1 << TANK_BITS) - 1;
  return fx_clamp64(cost.whole, -most, most) * ((int64_t)1 << TANK_BITS) +
         (int64_t)(cost.part >> (64 - TANK_BITS)) + 1;
}

static uint64_t square_paid(int64_t tank, int32_t mass) {
  const uint64_t most = (uint64_t)1 << 62;
  const wide_number wide = {tank >> TANK_BITS, (uint64_t)(tank & INT32_MAX) << (64 - TANK_BITS)};
  const wide_number square = wide_over(wide, (uint32_t)mass);
  return square.whole != 0 || square.part > most ? most : square.part;
}

/* Along the change: from u to as far as the tank pays for. */
static vec3 paid_change(int64_t tank, int32_t mass, vec3 u, vec3 change) {
  const fx_root root = fx_rsqrt(vec_squared(change), FX_ROOT_FINE);
  const vec3 unit = vec_root_unit(root, change);
  const int64_t size = fx_root_length(root);
  const int64_t from = vec_dot_unit(u, unit);
  const uint64_t squared = (uint64_t)(from * from) + square_paid(tank, mass);
  const int64_t most = squared == 0 ? 0 : (int64_t)fx_root_length(fx_rsqrt(squared, FX_ROOT_FINE));
  return vec_scale_unit(unit, fx_saturate(fx_clamp64(most - from, 0, size)));
}

vec3 step_passive_change(fray_world *w, int32_t mass, vec3 u, vec3 change) {
  const int64_t tank = tank_of(w);
  vec3 paid = change;
  FRAY_ASSERT(mass >= 0);
  if (mass == 0 || vec_span(change) == 0) return change;
  int64_t cost = cost_of(mass, u, change);
  if (cost > tank) {
    paid = paid_change(tank, mass, u, change);
    cost = cost_of(mass, u, paid);
  }
  tank_set(w, tank - cost);
  return paid;
}
