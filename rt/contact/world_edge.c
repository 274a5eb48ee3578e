/* SPDX-License-Identifier: Apache-2.0 */
/* The edge of the world for vertices of a membrane: what would pass it within an elastic step is stopped, at
 * the velocity, with no more energy than contact has taken (elastic/step_passive.h). Vertices stop LU / 16
 * before the edge, and are looked after from half a lu on: one at rest may be driven there by what still
 * comes. */
#include "rt/contact/constraints.h"
#include "rt/elastic/step_passive.h"

enum { NEAR = FX_WORLD_MAX - FX_LU / 2, EDGE = FX_WORLD_MAX - FX_LU / 16 };

static int is_at_edge(int32_t at, int32_t speed) {
  const int64_t end = (int64_t)at + fx_asr(speed, FX_SUB_BITS - 1);
  return at <= -NEAR || at >= NEAR || end <= -NEAR || end >= NEAR;
}

static int is_vertex_at_edge(const fray_world *w, uint32_t p) {
  return is_at_edge(w->p.x[p], w->p.vx[p]) || is_at_edge(w->p.y[p], w->p.vy[p]) ||
         is_at_edge(w->p.z[p], w->p.vz[p]);
}

void world_edge_find(fray_world *w) {
  int any = 0;
  FRAY_ASSERT(world_has_membrane(w));
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) any |= is_vertex_at_edge(w, p);
  w->membrane.at_edge = (uint8_t)any;
}

/* What changes of a speed along an axis, from where it began the substep and is now, Q28. */
static int32_t change_of(int32_t start, int32_t at, int32_t speed, int32_t steps, int32_t rise) {
  const int32_t way = start < 0 ? -1 : 1;
  const int32_t moved = fx_wrap_sub(at, fx_wrap_shift(start, FX_SUB_BITS));
  const int64_t room = ((int64_t)EDGE - (int64_t)start * way) * (1 << FX_SUB_BITS) - (int64_t)moved * way;
  const int64_t most = -(int64_t)step_speed_min(fx_saturate(room), steps, rise);
  const int64_t outward = (int64_t)speed * way;
  return outward <= most ? 0 : fx_saturate((most - outward) * way);
}

static void solve_vertex(fray_world *w, uint32_t p, const elastic_step *step) {
  const int32_t steps = w->membrane.constants->steps;
  const int32_t *at = w->membrane.positions[p].at;
  const vec3 speed = step_velocity(w, p, step);
  const vec3 wanted = {change_of(w->p.x[p], at[0], speed.x, steps, step->rise),
                       change_of(w->p.y[p], at[1], speed.y, steps, step->rise),
                       change_of(w->p.z[p], at[2], speed.z, steps, step->rise)};
  const uint32_t inverse = step_inverse_mass(w, p);
  if (vec_span(wanted) == 0 || inverse == 0) return;
  const int32_t mass = step_mass_of(inverse);
  const vec3 u = vec_sub_saturated(speed, step_half_of(w, p, step));
  (void)step_push(w, p, step_impulse_of(mass, step_passive_change(w, mass, u, wanted)));
  world_fault(w, FRAY_FAULT_OUT_OF_WORLD);
}

void world_edge_solve(fray_world *w, const elastic_step *step) {
  FRAY_ASSERT(world_has_membrane(w));
  if (w->membrane.at_edge == 0) return;
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p)
    if (is_vertex_at_edge(w, p)) solve_vertex(w, p, step);
}
