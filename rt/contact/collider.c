/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/contact/collider.h"

#include "rt/base/coulomb.h"
#include "rt/state/crossing.h"
#include "rt/state/vertex_mass.h"

int32_t collider_skin(const fray_world *w) { return fx_max(w->params->thickness, COLLIDER_SKIN_MIN); }

/* The body of sphere n. */
static uint32_t sphere_at(const fray_world *w, uint32_t n) {
  uint32_t b = 0;
  uint32_t spheres = 0;
  while (b + 1u < w->capacity[POOL_BODIES]) {
    if (body_is_sphere_collider(&w->rigid.bodies[b]) && spheres++ == n) return b;
    ++b;
  }
  return b;
}

collider collider_at(const fray_world *w, uint32_t n) {
  FRAY_ASSERT(n < collider_count(w));
  const uint32_t meshes = rigid_mesh_count(w);
  const rigid_mesh_parts none = {NULL, NULL, NULL, NULL, NULL, 0};
  collider t;
  if (n < meshes) {
    t.m = rigid_mesh_at(w, n);
    t.body = (uint32_t)t.m.of->body;
    t.radius = 0;
    t.sharp = world_has_blades(w) && (w->rigid.sharp_meshes >> n & 1u) != 0;
    t.bounds = t.m.boxes[0];
  } else {
    t.m = none;
    t.body = sphere_at(w, n - meshes);
    const int32_t r = w->rigid.bodies[t.body].radius;
    const rigid_mesh_box bounds = {{-r, -r, -r}, {r, r, r}, 0, 0};
    t.radius = r;
    t.sharp = 0;
    t.bounds = bounds;
  }
  t.start = w->rigid.start[t.body];
  t.now = vec_of(w->rigid.states[t.body].position);
  return t;
}

collider_box collider_box_of(const ccd_path *paths, uint32_t count, int32_t skin) {
  vec3 low = paths[0].begin;
  vec3 high = low;
  for (uint32_t n = 0; n < 2 * count; ++n) {
    const vec3 v = (n & 1u) != 0 ? paths[n / 2].end : paths[n / 2].begin;
    low = vec_min(low, v);
    high = vec_max(high, v);
  }
  const collider_box s = {{low.x - skin, low.y - skin, low.z - skin},
                          {high.x + skin, high.y + skin, high.z + skin}};
  FRAY_ASSERT(s.low[0] <= s.high[0] && s.low[1] <= s.high[1] && s.low[2] <= s.high[2]);
  return s;
}

static inline uint32_t sides_of_axis(int32_t begin, int32_t end, int32_t low, int32_t high) {
  return (begin < low && end < low ? 1u : 0u) | (begin > high && end > high ? 2u : 0u);
}
uint8_t collider_sides(const collider *t, const ccd_path *path, int32_t skin) {
  FRAY_ASSERT(skin >= 0);
  const int32_t *low = t->bounds.low;
  const int32_t *high = t->bounds.high;
  return (uint8_t)(
      sides_of_axis(path->begin.x, path->end.x, low[0] - skin, high[0] + skin) |
      sides_of_axis(path->begin.y, path->end.y, low[1] - skin, high[1] + skin) << 2 |
      sides_of_axis(path->begin.z, path->end.z, low[2] - skin, high[2] + skin) << 4);
}

void collider_list_near(fray_world *w, const collider *t, const collider_box *s, uint32_t max,
                        collider_near *near) {
  FRAY_ASSERT(t->radius == 0 && max <= RIGID_MESH_CLOSE);
  const uint32_t end = t->m.box_count;
  uint32_t visits = 0;
  uint32_t n = 0;
  uint32_t count = 0;
  while (n < end && visits < RIGID_MESH_VISITS && count <= max) {
    const rigid_mesh_box *b = &t->m.boxes[n];
    ++visits;
    if (!collider_overlap(s, b)) {
      n = (uint32_t)b->next;
      continue;
    }
    ++n;
    if (b->face == RIGID_MESH_NONE) continue;
    if (count < max) near->face[count] = (uint16_t)b->face;
    ++count;
  }
  near->has_more = n < end || count > max;
  near->count = count > max ? max : count;
  w->work.mesh_boxes += visits;
}

int collider_ccd(fray_world *w, const collider *t, uint32_t face, const ccd_path *path, int32_t skin,
                 ccd_contact *c) {
  FRAY_ASSERT(face < (uint32_t)t->m.of->faces);
  ccd_path corners[3];
  for (uint32_t k = 0; k < 3; ++k) {
    corners[k].begin = rigid_mesh_corner(&t->m, face, k);
    corners[k].end = corners[k].begin;
  }
  ++w->work.mesh_ccd;
  return ccd_point_triangle(path, corners, skin, c);
}

int collider_crosses_near(fray_world *w, const collider *t, const collider_near *near, const ccd_path *path) {
  ccd_contact c;
  for (uint32_t n = 0; n < near->count; ++n) {
    const collider_gaps gaps = collider_gaps_of(t, near->face[n], path);
    if (!collider_is_on_one_side(gaps, COLLIDER_PLANE_MARGIN) &&
        collider_ccd(w, t, near->face[n], path, 0, &c))
      return 1;
  }
  return 0;
}

int collider_crosses(fray_world *w, const collider *t, const ccd_path *path) {
  collider_near near;
  const collider_box s = collider_box_of(path, 1, 0);
  if (collider_path_is_point(path)) return 0;
  collider_list_near(w, t, &s, RIGID_MESH_NEAR, &near);
  if (near.has_more && !world_has_membrane(w)) return 1;
  if (near.has_more) world_fault(w, FRAY_FAULT_MESH_QUERY_BUDGET);
  return collider_crosses_near(w, t, &near, path);
}

vec3 collider_pushed(vec3 at, vec3 out, int32_t depth) {
  return vec_add_clamped(at, vec_scale_unit(out, depth), FX_WORLD_MAX);
}

/* In particles, Q16. */
static int32_t mass_q16(const fray_world *w, uint32_t p) {
  if (world_has_membrane(w)) {
    const uint64_t unit = (uint32_t)w->membrane.constants->mass_unit;
    const uint64_t mass = w->trimesh.mass[p];
    return mass >= unit << 14 ? 1 << 30 : (int32_t)fx_divide_wide(mass << 16, (uint32_t)unit);
  }
  return particle_half_masses(w, p) << 15;
}

void collider_place(fray_world *w, const collider *t, uint32_t p, vec3 relative) {
  FRAY_ASSERT(p >= particles_attached(w) && p < w->p.count);
  const vec3 was = world_position(w, p);
  const vec3 wanted = vec_add_clamped(relative, t->now, INT32_MAX);
  const vec3 at = vec_clamp(wanted, FX_WORLD_MAX);
  if (!vec_is_equal(at, wanted)) world_fault(w, FRAY_FAULT_OUT_OF_WORLD);
  w->p.x[p] = at.x;
  w->p.y[p] = at.y;
  w->p.z[p] = at.z;
  if (!world_is_projected(w)) return;
  body_add_impulse(&w->rigid.motion[t->body],
                   vertex_mass_impulse(mass_q16(w, p), vec_sub(at, was), FX_SUB_BITS));
}

/* What moves in elastic steps goes on as the body does: its velocity is not that of its path. */
static void stop_vertex(fray_world *w, const collider *t, uint32_t p, vec3 was) {
  const vec3 goes = world_body_velocity(w, t->body);
  const vec3 change = vec_sub_saturated(goes, world_velocity(w, p));
  world_set_velocity(w, p, goes);
  world_shift_predicted(w, p, vec_sub(world_position(w, p), was));
  body_add_impulse(&w->rigid.motion[t->body], vertex_mass_impulse(mass_q16(w, p), change, 0));
}

void collider_pin(fray_world *w, const collider *t, uint32_t p, const ccd_path *path) {
  const vec3 was = world_position(w, p);
  ++w->work.mesh_pins;
  if (world_repeats_ticks(w)) {
    w->attempt.vertices[p].pinned = 1;
    w->attempt.vertices[p].pinned_to = (uint8_t)t->body;
  }
  collider_place(w, t, p, path->begin);
  if (!world_is_projected(w)) stop_vertex(w, t, p, was);
}

/* 0 where the path is too long for its arithmetic. */
vec3 collider_friction(const fray_world *w, const collider *t, vec3 moved, vec3 out, int32_t depth) {
  if (vec_span(moved) >= (uint32_t)COLLIDER_SLIDE_MAX) return vec_make(0, 0, 0);
  const vec3 slip = vec_sub(moved, vec_scale_unit(out, vec_dot_unit(moved, out)));
  return coulomb_limited(slip, depth, w->rigid.bodies[t->body].friction);
}

int collider_add_contact(fray_world *w, const collider *t, uint32_t p, vec3 out) {
  FRAY_ASSERT(w->contact.count <= w->capacity[POOL_CONTACTS] && p < w->p.count);
  if (w->contact.count == w->capacity[POOL_CONTACTS]) return 0;
  contact *c = &w->contact.list[w->contact.count++];
  c->particle = p;
  c->body = (uint16_t)t->body;
  c->touching = CONTACT_TOUCHES;
  c->normal = out;
  return 1;
}
