/* SPDX-License-Identifier: Apache-2.0 */
/* Limits of edges, in each elastic step at the velocity: impulses on both ends. Each by itself
 * makes no energy (elastic/step_passive.h): where they could spend what others take, edges that bodies draw
 * went on to four times their length.
 *
 *   length   no edge grows longer than `edge_limit` times its rest length, or than three times where there is
 *            none, as strains beyond that are not told apart. The limit is above the strain at which cloth
 *            tears, and so hides no stress below that. An edge near it separates no faster than its room
 *            allows, and comes back slowly where it has none.
 *   rate     no edge changes by more than an eighth of its rest length in a step. Where a triangle is another
 *            one after each step leapfrog does not keep its energy, however small w h is: splinters gained
 *            speed without end. Behind contact: what a body stops has no rate to take.
 *
 * Those that may get there are found once a substep. No SIMD twin: edges follow one another. */
#include "rt/elastic/step_passive.h"
#include "rt/membrane/membrane.h"
#include "rt/state/deformation.h"

enum { LENGTH_MAX = 3 << 16 }; /* Q16 */
/* An edge is looked after from 29/32 of the limit on. */
enum { NEAR_SQUARED = 210, NEAR_BITS = 8 };
/* And from a quarter of the greatest rate on. */
enum { RATE_BITS = 3, NEAR_RATE_BITS = 5 };

static uint32_t limit_of(const fray_world *w) {
  const int32_t given = w->membrane.constants->edge_limit;
  return (uint32_t)(given != 0 ? given : LENGTH_MAX);
}

/* By squares, Q48; `limit` is Q16. */
static int is_near_limit(uint64_t length2, uint64_t rest2, uint32_t limit) {
  const uint64_t limit2 = fx_mul_wide_u(limit >> 4, limit >> 4) >> NEAR_BITS; /* Q16 */
  return length2 >> 24 >= ((rest2 >> 24) * limit2 >> 16) * NEAR_SQUARED >> NEAR_BITS;
}

/* By squares: the relative velocity in Q24 lu per substep, so that they fit. */
static int is_near_rate(const fray_world *w, uint32_t i, uint32_t j, uint64_t rest2) {
  const vec3 apart = vec_sub_saturated(world_velocity(w, j), world_velocity(w, i));
  const uint32_t steps = (uint32_t)w->membrane.constants->steps;
  const uint64_t speed2 = vec_squared(vec_asr(apart, FX_SUB_BITS));
  return speed2 >> 6 > (rest2 >> (6 + 2 * NEAR_RATE_BITS)) * (steps * steps);
}

static void find_edge(fray_world *w, uint32_t i, uint32_t j) {
  FRAY_ASSERT(i < w->p.count && j < w->p.count && i != j);
  const trimesh *s = &w->trimesh;
  const uint64_t rest2 = fx_square(fx_sub(s->u[j], s->u[i])) + fx_square(fx_sub(s->v[j], s->v[i]));
  const int is_long = is_near_limit(vec_squared(deformation_edge(w, i, j)), rest2, limit_of(w));
  if (rest2 == 0 || !(is_long || is_near_rate(w, i, j, rest2))) return;
  limited_edge *e = &w->membrane.limited_edges[w->membrane.limited_edge_count++];
  e->i = (index_t)i;
  e->j = (index_t)j;
  e->rest = fx_root_length(fx_rsqrt(rest2, FX_ROOT_FINE));
}

void edge_limits_find(fray_world *w) {
  const trimesh *s = &w->trimesh;
  FRAY_ASSERT(world_has_membrane(w));
  w->membrane.limited_edge_count = 0;
  for (uint32_t t = 0; t < triangles_in_use(w); ++t)
    for (uint32_t k = 0; k < 3; ++k)
      if (s->triangle[t].neighbour[k] >= t)
        find_edge(w, s->triangle[t].v[trimesh_next(k)], s->triangle[t].v[trimesh_previous(k)]);
}

static vec3 edge_now(const fray_world *w, const limited_edge *e) {
  const elastic_position *place = w->membrane.positions;
  return vec_wrap_sub(vec_of(place[e->j].at), vec_of(place[e->i].at));
}

/* Whether neither limit can be met in this step, by squares: slower than the rate in any direction, and so
 * far from the length that this does not reach it. Then there is nothing to solve. Roots are within 2^-28 of
 * what is below 2^31. */
static int is_clear(uint64_t squared, vec3 velocity, int64_t longest, int64_t rate, int64_t in_a_step) {
  enum { ROUNDING = 16 };
  const int64_t slow = fx_clamp64(rate - ROUNDING, 0, INT32_MAX);
  const int64_t near = fx_clamp64(longest - in_a_step - ROUNDING, 0, INT32_MAX);
  return vec_squared(velocity) < (uint64_t)(slow * slow) && squared < (uint64_t)(near * near);
}

static void solve_edge(fray_world *w, const limited_edge *e, const elastic_step *step, edge_limit limit) {
  const vec3 d = edge_now(w, e);
  const uint64_t k = (uint64_t)step_inverse_mass(w, e->i) + step_inverse_mass(w, e->j);
  const uint64_t squared = vec_squared(d);
  if (squared == 0 || k == 0) return;
  const vec3 velocity = vec_sub_saturated(step_velocity(w, e->j, step), step_velocity(w, e->i, step));
  const int64_t longest =
      (int64_t)((uint64_t)e->rest * limit_of(w) >> (16 - FX_SUB_BITS)); /* Q28 */
  const int64_t in_a_step = (int64_t)e->rest << FX_SUB_BITS >> RATE_BITS;
  const int32_t rate = fx_saturate(in_a_step * w->membrane.constants->steps);
  if (is_clear(squared, velocity, longest, rate, in_a_step)) return;
  const fx_root root = fx_rsqrt(squared, FX_ROOT_FINE);
  const vec3 unit = vec_root_unit(root, d);
  const int32_t separating = vec_dot_unit(velocity, unit);
  const int32_t room = fx_saturate(longest - fx_root_length(root));
  const int32_t by_room = -step_speed_min(room, w->membrane.constants->steps, step->rise);
  const vec3 halves = vec_sub_saturated(step_half_of(w, e->j, step), step_half_of(w, e->i, step));
  const int32_t half = vec_dot_unit(halves, unit);
  const int32_t fitting =
      limit == EDGE_LENGTH ? fx_min(separating, by_room) : fx_clamp(separating, -rate, rate);
  const int32_t wanted = step_passive_speed(fitting, separating, half);
  if (wanted == separating) return;
  const int32_t mass = step_mass_of(k);
  const vec3 change = vec_scale_unit(unit, fx_saturate((int64_t)wanted - separating));
  const vec64 impulse = step_impulse_of(mass, change);
  const vec64 back = {-impulse.x, -impulse.y, -impulse.z};
  (void)step_push(w, e->j, impulse);
  (void)step_push(w, e->i, back);
}

void edge_limits_solve(fray_world *w, const elastic_step *step, edge_limit limit) {
  limited_edge *e = w->membrane.limited_edges;
  FRAY_ASSERT(w->membrane.limited_edge_count <=
              (uint32_t)LIMITED_EDGES_PER_TRIANGLE * w->capacity[POOL_TRIANGLES]);
  for (uint32_t n = 0; n < w->membrane.limited_edge_count; ++n) solve_edge(w, &e[n], step, limit);
}
