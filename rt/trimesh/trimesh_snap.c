/* SPDX-License-Identifier: Apache-2.0 */
/* trimesh_advance.h has the contract. The area of the one-ring stays, and with it the mass of the vertex that
 * moves: only the masses around it change, by d. So its momentum changes by - sum of d v. */
#include "rt/trimesh/trimesh_advance.h"

#if FRAY_CRACKS

enum { TANGENT_15 = 17560 /* of 15 degrees, Q16 */ };

/* At corner a: the tangent of the angle is cross over dot. */
static int is_wide(trimesh_point a, trimesh_point b, trimesh_point c) {
  const int64_t dot = fx_add64(fx_mul_wide(fx_sub(b.u, a.u), fx_sub(c.u, a.u)),
                               fx_mul_wide(fx_sub(b.v, a.v), fx_sub(c.v, a.v)));
  return dot <= 0 || fx_asr64(trimesh_twice_area(a, b, c), 16) >= fx_mul64(fx_asr64(dot, 32), TANGENT_15);
}

int trimesh_is_stout(const trimesh *s, uint32_t norm2_most, trimesh_point a, trimesh_point b,
                     trimesh_point c) {
  if (!trimesh_has_quality(s, a, b, c)) return 0;
  if (!is_wide(a, b, c) || !is_wide(b, c, a) || !is_wide(c, a, b)) return 0;
  const trimesh_weights weights = trimesh_weights_between(a, b, c);
  const trimesh_gram gram = trimesh_gram_of(&weights);
  return trimesh_gram_is_within(&gram, norm2_most);
}

static int plan_areas(const trimesh *s, uint32_t norm2_most, trimesh_snap *p) {
  uint32_t whole = 0;
  uint32_t sum = 0;
  uint32_t largest = 0;
  for (uint32_t n = 0; n < p->ring.count; ++n) {
    const trimesh_point a = trimesh_at(s, trimesh_ring_end(s, &p->ring, n));
    const trimesh_point b = trimesh_at(s, trimesh_ring_end(s, &p->ring, n + 1u));
    if (!trimesh_is_stout(s, norm2_most, p->at, a, b)) return 0;
    const int64_t area = fx_round64(trimesh_twice_area(p->at, a, b), 19);
    if (area < 1 || area >= TRIMESH_AREA_MAX) return 0;
    p->area[n] = (uint32_t)area;
    if (p->area[n] > p->area[largest]) largest = n;
    whole += s->area[p->ring.triangle[n]];
    sum += p->area[n];
  }
  const int64_t rest = (int64_t)p->area[largest] + whole - sum;
  p->area[largest] = (uint32_t)fx_clamp64(rest, 0, TRIMESH_AREA_MAX);
  return rest > 0 && rest < TRIMESH_AREA_MAX;
}

int32_t trimesh_snap_mass_gained(const trimesh *s, const trimesh_snap *p, uint32_t n) {
  const uint32_t m = n == 0 ? p->ring.count - 1u : n - 1u;
  return (int32_t)p->area[n] - (int32_t)s->area[p->ring.triangle[n]] + (int32_t)p->area[m] -
         (int32_t)s->area[p->ring.triangle[m]];
}

static int plan_velocity(const fray_world *w, trimesh_snap *p) {
  const trimesh *s = &w->trimesh;
  const int32_t *const v[3] = {w->p.vx, w->p.vy, w->p.vz};
  const int64_t mass = s->mass[p->vertex];
  for (uint32_t axis = 0; axis < 3; ++axis) {
    int64_t momentum = fx_add64(fx_mul64(mass, v[axis][p->vertex]), s->state->momentum_remainder[axis]);
    for (uint32_t n = 0; n < p->ring.count; ++n)
      momentum = fx_add64(momentum, -fx_mul_wide(trimesh_snap_mass_gained(s, p, n),
                                                 v[axis][trimesh_ring_end(s, &p->ring, n)]));
    const uint64_t size = momentum < 0 ? (uint64_t)-momentum : (uint64_t)momentum;
    if (mass > INT32_MAX || size / (uint64_t)mass >= FX_SPEED_MAX) return 0;
    const int64_t speed = (int64_t)fx_divide_wide(size + (uint64_t)mass / 2u, (uint32_t)mass);
    p->velocity[axis] = (int32_t)(momentum < 0 ? -speed : speed);
    p->remainder[axis] = (int32_t)(momentum - fx_mul64(mass, p->velocity[axis])); /* half the mass at most */
  }
  return 1;
}

static void plan_axis(const int32_t *x, const int32_t *q, const int8_t *r, uint32_t to, uint32_t fraction,
                      uint32_t axis, trimesh_snap *p) {
  const int64_t from = (int64_t)x[p->vertex] * 16 + r[p->vertex];
  const int64_t way = (int64_t)x[to] * 16 + r[to] - from;
  const int64_t predicted = (int64_t)q[to] - q[p->vertex];
  p->place[axis] = from + fx_round64(way * fraction, 16);
  p->predicted[axis] = (int32_t)(q[p->vertex] + fx_round64(predicted * fraction, 16));
}

static void toggle_fan(fray_world *w, uint32_t vertex, const trimesh_ring *ring) {
  world_toggle_entry(w, trimesh_vertex_entry(&w->trimesh, vertex));
  for (uint32_t n = 0; n < ring->count; ++n)
    world_toggle_entry(w, trimesh_triangle_entry(&w->trimesh, ring->triangle[n]));
}

static void place_axis(int32_t *x, int32_t *q, int8_t *r, uint32_t axis, const trimesh_snap *p) {
  x[p->vertex] = (int32_t)fx_round64(p->place[axis], FX_SUB_BITS);
  r[p->vertex] = (int8_t)(p->place[axis] - (int64_t)x[p->vertex] * 16);
  q[p->vertex] = p->predicted[axis];
}

int trimesh_snap_plan(const fray_world *w, uint32_t vertex, uint32_t to, uint32_t fraction,
                      uint32_t norm2_most, trimesh_snap *p) {
  FRAY_ASSERT(vertex < w->p.count && to < w->p.count && fraction <= TRIMESH_WEIGHT_ONE);
  if (particle_is_attached(w, vertex) || particle_is_attached(w, to)) return 0;
  p->vertex = vertex;
  trimesh_ring_of(&w->trimesh, vertex, &p->ring);
  p->at = trimesh_point_on(trimesh_at(&w->trimesh, vertex), trimesh_at(&w->trimesh, to), fraction);
  plan_axis(w->p.x, w->p.qx, w->p.rx, to, fraction, 0, p);
  plan_axis(w->p.y, w->p.qy, w->p.ry, to, fraction, 1, p);
  plan_axis(w->p.z, w->p.qz, w->p.rz, to, fraction, 2, p);
  return p->ring.closed != 0 && plan_areas(&w->trimesh, norm2_most, p) && plan_velocity(w, p);
}

void trimesh_snap_apply(fray_world *w, const trimesh_snap *p) {
  trimesh *s = &w->trimesh;
  const uint32_t vertex = p->vertex;
  int32_t *const v[3] = {w->p.vx, w->p.vy, w->p.vz};
  FRAY_ASSERT(vertex < w->p.count);
  toggle_fan(w, vertex, &p->ring);
  for (uint32_t n = 0; n < p->ring.count; ++n) {
    uint32_t *mass = &s->mass[trimesh_ring_end(s, &p->ring, n)];
    *mass = (uint32_t)fx_wrap_add((int32_t)*mass, trimesh_snap_mass_gained(s, p, n));
  }
  for (uint32_t n = 0; n < p->ring.count; ++n) s->area[p->ring.triangle[n]] = p->area[n];
  for (uint32_t axis = 0; axis < 3; ++axis) {
    v[axis][vertex] = p->velocity[axis];
    s->state->momentum_remainder[axis] = p->remainder[axis];
  }
  place_axis(w->p.x, w->p.qx, w->p.rx, 0, p);
  place_axis(w->p.y, w->p.qy, w->p.ry, 1, p);
  place_axis(w->p.z, w->p.qz, w->p.rz, 2, p);
  s->u[vertex] = p->at.u;
  s->v[vertex] = p->at.v;
  for (uint32_t n = 0; n < p->ring.count; ++n) {
    const uint32_t t = p->ring.triangle[n];
    s->weights[t] = trimesh_weights_of(s, t);
    w->membrane.bend_shapes[t] = bend_shape_of(s, t);
  }
  toggle_fan(w, vertex, &p->ring);
  w->membrane.bend_current = 0;
  if (world_has_triangle_collision(w)) w->tri.list->valid = 0; /* it has jumped */
}

#endif
