/* SPDX-License-Identifier: Apache-2.0 */
/* A vertex and a triangle, or two edges, that come near each other in a tick: push, impulse, and whether
 * they still touch. The nearest points of the two are weighted sums of their vertices; with the weights
 * of the first negative, one sum over all four gives the gap vector from the first point to the second
 * (collision_pair_weights()). */
#include "rt/self_collision/triangle_collision.h"

#include "rt/elastic/step_impulse.h"

enum {
  RATIO_BITS = 16,
  RATIO_ONE = 1 << RATIO_BITS,
  RATIO_MAX = 4 << RATIO_BITS,
  OUT_TICKS_BITS = 5 /* what is nearer than the thickness gets a 32nd of what it lacks in a tick */
};

static collision_pair pair_of(const fray_world *w, const triangle_pair *pair) {
  collision_pair m;
  for (uint32_t n = 0; n < 4; ++n) {
    m.p[n] = pair->p[n];
    m.path[n] = collision_pair_path(w, m.p[n]);
  }
  return m;
}

ccd_gap triangle_collision_gap(const fray_world *w, const triangle_pair *pair) {
  FRAY_ASSERT(pair->triangle[0] < triangles_in_use(w) && pair->triangle[1] < triangles_in_use(w));
  const collision_pair m = pair_of(w, pair);
  return triangle_pair_firsts(pair) == 2 ? ccd_gap_edges(&m.path[0], &m.path[2])
                                         : ccd_gap_point_triangle(&m.path[0], &m.path[1]);
}

static int ccd_of(fray_world *w, const triangle_pair *pair, const collision_pair *m, int32_t thickness,
                  ccd_contact *c) {
  ++w->work.self_ccd;
  return triangle_pair_firsts(pair) == 2 ? ccd_edges(&m->path[0], &m->path[2], thickness, c)
                                         : ccd_point_triangle(&m->path[0], &m->path[1], thickness, c);
}

/* The gap along the normal. Positions are taken relative to the first vertex, so that differences fit. */
static int32_t gap_along(const vec3 at[4], const int32_t b[4], vec3 normal) {
  vec64 sum = {0, 0, 0};
  for (uint32_t n = 1; n < 4; ++n) sum = vec_add64(sum, vec_scale64(vec_sub(at[n], at[0]), b[n]));
  return vec_dot_unit(vec_round_saturated(sum, 15), normal);
}

/* ---- the impulse ---- */

/* Change of each vertex's speed for a change of the gap's speed by one, Q16: b_n / m_n over the sum of
 * b_n^2 / m_n. Returns 0 where no vertex can move. */
static int ratios_of(const fray_world *w, const uint32_t p[4], const int32_t b[4], int32_t ratio[4]) {
  const int32_t *inverse = w->membrane.inverse_mass;
  int64_t of[4];
  int64_t whole = 0;
  for (uint32_t n = 0; n < 4; ++n) {
    of[n] = particle_is_attached(w, p[n]) ? 0 : fx_round64(fx_mul_wide(inverse[p[n]], b[n]), 15);
    whole = fx_add64(whole, fx_round64(fx_mul_wide((int32_t)of[n], b[n]), 15));
  }
  if (whole <= 0) return 0;
  for (uint32_t n = 0; n < 4; ++n) ratio[n] = fx_clamp_wide(of[n] * RATIO_ONE / whole, RATIO_MAX);
  return 1;
}

/* The heaviest vertex that is not attached takes what rounding leaves over; 4: all are attached. */
static uint32_t heaviest_of(const fray_world *w, const uint32_t p[4]) {
  uint32_t found = 4;
  for (uint32_t n = 0; n < 4; ++n)
    if (!particle_is_attached(w, p[n]) && (found == 4 || w->trimesh.mass[p[n]] > w->trimesh.mass[p[found]]))
      found = n;
  return found;
}

static int64_t divide_rounded(int64_t n, int64_t by) {
  FRAY_ASSERT(by > 0);
  return n < 0 ? -((by / 2 - n) / by) : (n + by / 2) / by;
}

/* Changes speeds along one axis. Where no vertex is attached, the vertex `last` balances the momentum,
 * and what its mass does not divide is carried in *remainder; returns 0. Else returns the momentum that
 * the cloth gained, vertex mass times speed, which the body that holds it loses. */
static int64_t change_axis(fray_world *w, const uint32_t p[4], const int32_t change[4], uint32_t last,
                           int32_t *speed, int32_t *remainder, int is_free) {
  int64_t gained = 0;
  for (uint32_t n = 0; n < 4; ++n) {
    if (particle_is_attached(w, p[n]) || (is_free && n == last)) continue;
    speed[p[n]] = fx_add(speed[p[n]], change[n]);
    gained = fx_add64(gained, (int64_t)w->trimesh.mass[p[n]] * change[n]);
  }
  if (!is_free) return gained;

  const int64_t mass = (int64_t)w->trimesh.mass[p[last]];
  const int64_t lost = fx_add64(gained, -(int64_t)*remainder);
  const int64_t back = divide_rounded(lost, mass);
  *remainder = (int32_t)(back * mass - lost);
  speed[p[last]] = fx_add(speed[p[last]], (int32_t)-back);
  return 0;
}

static int is_too_fast(const fray_world *w, const uint32_t p[4]) {
  for (uint32_t n = 0; n < 4; ++n)
    if (!vec_is_within(world_velocity(w, p[n]), FX_SPEED_MAX / 2)) return 1;
  return 0;
}

static void add_body_impulse(fray_world *w, const uint32_t p[4], const int64_t gained[3]) {
  const int64_t unit = w->membrane.constants->mass_unit;
  uint32_t n = 0;
  while (!particle_is_attached(w, p[n])) ++n;
  FRAY_ASSERT(n < 4 && w->p.attach_body[p[n]] < w->capacity[POOL_BODIES]);
  const vec64 impulse = {gained[0] / unit, gained[1] / unit, gained[2] / unit};
  body_add_impulse(&w->rigid.motion[w->p.attach_body[p[n]]], impulse);
}

/* Relative speed along the normal is at least `out` from here on. Of a pair that is nearer than the
 * thickness it is that: at the end of the tick what has collided may already swing back, and faster.
 * Returns 1 iff a speed has changed. */
static int push_apart(fray_world *w, const uint32_t p[4], const int32_t b[4], const int32_t ratio[4],
                      vec3 normal, int32_t out) {
  const int64_t missing = out - collision_pair_speed(w, p, b, normal);
  const uint32_t last = heaviest_of(w, p);
  if (missing == 0 || (missing < 0 && out == 0) || last == 4 || is_too_fast(w, p)) return 0;

  int32_t change[3][4];
  int is_free = 1;
  const int32_t amount = fx_clamp_wide(missing, FX_SPEED_MAX / 16);
  for (uint32_t n = 0; n < 4; ++n) {
    const vec3 by = vec_scale_unit(normal, fx_mul_round(amount, ratio[n], RATIO_BITS));
    change[0][n] = by.x;
    change[1][n] = by.y;
    change[2][n] = by.z;
    is_free = is_free && !particle_is_attached(w, p[n]);
  }

  int64_t gained[3];
  int32_t *const speeds[3] = {w->p.vx, w->p.vy, w->p.vz};
  int32_t *const remainder = w->trimesh.state->momentum_remainder;
  for (uint32_t k = 0; k < 3; ++k)
    gained[k] = change_axis(w, p, change[k], last, speeds[k], &remainder[k], is_free);
  if (!is_free) add_body_impulse(w, p, gained);
  for (uint32_t n = 0; n < 4; ++n) w->self.moved_round[p[n]] = w->self.round;
  return 1;
}

/* ---- the push ---- */

/* Q28 lu per substep, for what is missing to the thickness, Q24 lu. */
static int32_t speed_out(const fray_world *w, int32_t missing) {
  if (missing <= 0) return 0;
  const int64_t a_tick = (int64_t)missing * (1 << FX_SUB_BITS) >> OUT_TICKS_BITS;
  return (int32_t)fx_clamp64(a_tick / w->params->substeps, 1, step_rise_of(w));
}

int triangle_collision_push(fray_world *w, triangle_pair *pair) {
  FRAY_ASSERT(pair->kind < TRIANGLE_PAIR_CORNERS + 9u && pair->triangle[0] > pair->triangle[1]);
  const collision_pair m = pair_of(w, pair);
  const vec3 end[4] = {m.path[0].end, m.path[1].end, m.path[2].end, m.path[3].end};
  const int32_t thickness = w->self.constants->thickness;
  int32_t b[4];
  int32_t ratio[4];
  ccd_contact c;

  pair->near = 0;
  if (!ccd_of(w, pair, &m, thickness, &c)) return 0;
  pair->near = 1;
  collision_pair_weights(triangle_pair_firsts(pair), &c, b);

  if (!ratios_of(w, m.p, b, ratio)) return 0;
  return push_apart(w, m.p, b, ratio, c.normal, speed_out(w, thickness - gap_along(end, b, c.normal)));
}

void triangle_collision_constrain(fray_world *w, const triangle_pair *pair) {
  const collision_pair m = pair_of(w, pair);
  const vec3 begin[4] = {m.path[0].begin, m.path[1].begin, m.path[2].begin, m.path[3].begin};
  const int32_t thickness = w->self.constants->thickness;
  int32_t b[4];
  ccd_contact c;
  if (!ccd_of(w, pair, &m, thickness, &c)) return;
  collision_pair_weights(triangle_pair_firsts(pair), &c, b);
  self_constraint_add(w, m.p, b, c.normal, (int64_t)gap_along(begin, b, c.normal) - thickness);
}

/* ---- touching ---- */

int triangle_collision_touches(fray_world *w, const triangle_pair *pair) {
  FRAY_ASSERT(pair->kind < TRIANGLE_PAIR_CORNERS + 9u && pair->triangle[0] > pair->triangle[1]);
  const collision_pair m = pair_of(w, pair);
  ccd_contact c;
  return ccd_of(w, pair, &m, 0, &c) &&
         !collision_pair_is_beyond(m.path, triangle_pair_firsts(pair), c.normal);
}
