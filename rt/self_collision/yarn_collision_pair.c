/* SPDX-License-Identifier: Apache-2.0 */
/* Two segments that come near each other in a tick: push, impulse, and whether they still touch. */
#include "rt/self_collision/yarn_collision.h"
#include "rt/state/crossing.h"
#include "rt/woven/yarn_pair.h"

static collision_pair pair_of(const fray_world *w, const self_pair *pair) {
  collision_pair m = {{w->woven.spring_i[pair->a], w->woven.spring_j[pair->a], w->woven.spring_i[pair->b],
                       w->woven.spring_j[pair->b]},
                      {{{0, 0, 0}, {0, 0, 0}}}};
  for (uint32_t n = 0; n < 4; ++n) m.path[n] = collision_pair_path(w, m.p[n]);
  return m;
}

static int are_apart(const collision_pair *m, int32_t by) {
  return yarn_collision_paths_apart(&m->path[0], &m->path[1], &m->path[2], &m->path[3], by);
}

/* The gap along the normal. Each of the two points is rounded, where triangles round their difference. */
static int32_t gap_along(const vec3 at[4], const ccd_contact *c) {
  const vec3 a = vec_lerp_q15(at[0], at[1], c->weight[0]);
  const vec3 b = vec_lerp_q15(at[2], at[3], c->weight[1]);
  return vec_dot_unit(vec_sub(b, a), c->normal);
}

/* ---- the impulse: masses in half crossings, so that it is exact in whole numbers ---- */

/* Gives a segment twice the momentum `half`, in half crossings, so an even one; each end gets an even
 * part of it. */
static void push_segment(fray_world *w, const uint32_t ends[2], int32_t at, vec3 half) {
  const vec3 far = vec_scale_q15(half, at);
  const vec3 parts[2] = {vec_sub(half, far), far};
  for (uint32_t n = 0; n < 2; ++n) {
    const uint32_t p = ends[n];
    const int32_t inverse_mass = particle_free_inverse_mass(w, p);
    if (inverse_mass == 0) {
      body_take_impulse(&w->rigid.motion[w->p.attach_body[p]], parts[n]);
      continue;
    }
    const vec3 by = vec_mul(parts[n], inverse_mass);
    world_set_velocity(w, p, vec_add_clamped(world_velocity(w, p), by, FX_SPEED_MAX));
  }
}

/* Of the gap: the sum of b^2 / m, Q15. */
static int32_t inverse_mass_along(const fray_world *w, const collision_pair *m, const int32_t b[4]) {
  int32_t sum = 0;
  for (uint32_t n = 0; n < 4; ++n) {
    const int32_t weight = (int32_t)fx_magnitude(b[n]);
    sum += particle_free_inverse_mass(w, m->p[n]) * fx_asr(weight * (weight / 2), 14);
  }
  return sum;
}

/* Removes the speed at which they approach. */
static void stop_approach(fray_world *w, const collision_pair *m, const ccd_contact *c) {
  int32_t b[4];
  collision_pair_weights(2, c, b);
  const int64_t speed = collision_pair_speed(w, m->p, b, c->normal);
  const int32_t inverse_mass = inverse_mass_along(w, m, b);
  if (speed >= 0 || inverse_mass < CCD_ONE / 8) return;
  const int32_t amount = fx_saturate(-speed * CCD_ONE / inverse_mass);
  const vec3 half = vec_scale_unit(c->normal, fx_min(amount, FX_SPEED_MAX / 4));
  push_segment(w, &m->p[0], c->weight[0], vec_negated(half));
  push_segment(w, &m->p[2], c->weight[1], half);
}

/* ---- push and touch ---- */

int yarn_collision_push(fray_world *w, self_pair *pair) {
  const collision_pair m = pair_of(w, pair);
  const vec3 begin[4] = {m.path[0].begin, m.path[1].begin, m.path[2].begin, m.path[3].begin};
  const vec3 end[4] = {m.path[0].end, m.path[1].end, m.path[2].end, m.path[3].end};
  const int32_t thickness = w->self.constants->thickness;
  ccd_contact c;
  FRAY_ASSERT(w->woven.spring_kind[pair->a] != SPRING_DEAD && w->woven.spring_kind[pair->b] != SPRING_DEAD);

  pair->near = 0;
  if (are_apart(&m, thickness)) return 0;
  ++w->work.self_ccd;
  if (!ccd_edges(&m.path[0], &m.path[2], thickness, &c)) return 0;
  pair->near = 1;

  /* a pair that began nearer than the thickness gains an eighth of it in a tick */
  int32_t wanted = thickness;
  if (c.time == 0) wanted = fx_clamp(gap_along(begin, &c), 0, thickness - thickness / 8) + thickness / 8;
  const int64_t missing = (int64_t)wanted - gap_along(end, &c);
  stop_approach(w, &m, &c);
  if (missing <= 0) return 0;

  const vec3 by = vec_scale_unit(c.normal, (int32_t)(missing < FX_LU / 8 ? missing : FX_LU / 8));
  const yarn_pair ends = {{m.p[2], m.p[3], m.p[0], m.p[1]},
                               {CCD_ONE - c.weight[1], c.weight[1], CCD_ONE - c.weight[0], c.weight[0]}};
  if (!yarn_pair_move(w, &ends, by, 1)) return 0;
  for (uint32_t n = 0; n < 4; ++n) {
    impact_zones_hold(w, m.p[n]);
    w->self.moved_round[m.p[n]] = w->self.round;
  }
  return 1;
}

int yarn_collision_touches(fray_world *w, const self_pair *pair) {
  FRAY_ASSERT(pair->a != pair->b);
  FRAY_ASSERT(pair->a < (uint32_t)w->params->links && pair->b < (uint32_t)w->params->links);
  const collision_pair m = pair_of(w, pair);
  ccd_contact c;
  if (are_apart(&m, 0)) return 0;
  ++w->work.self_ccd;
  return ccd_edges(&m.path[0], &m.path[2], 0, &c) && !collision_pair_is_beyond(m.path, 2, c.normal);
}
