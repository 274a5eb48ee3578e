/* SPDX-License-Identifier: Apache-2.0 */
/* Which contact constraints a membrane has in a substep: points of it that may meet a body, by the
 * velocities with which it begins; and which particles of elastic yarns may meet a mesh.
 *
 *   primitives        the vertices that contact_gather() listed
 *   meshes            vertices, as contact_vertices.c would push them, and triangles
 *   spheres           triangles too
 *
 * Nothing here is state. What is missed, because it is fast only later, is for
 * contact_guard_apply() and the tests of paths behind the elastic steps. */
#include "rt/contact/constraints.h"
#include "rt/contact/contact.h"
#include "rt/contact/contact_triangles.h"
#include "rt/contact/mesh_push.h"
#include "rt/contact/shape.h"

int32_t contact_effective_mass(const fray_world *w, uint32_t body, const uint32_t vertex[3],
                               const int32_t weight[3]) {
  const uint64_t k = ((uint64_t)(uint32_t)w->rigid.bodies[body].mass_ratio >> 6) +
                     step_point_inverse_mass(w, vertex, weight, 3);
  return k == 0 ? 0 : step_mass_of(k);
}

void contact_constraint_miss(fray_world *w) {
  FRAY_ASSERT(!world_is_projected(w));
  w->membrane.constraints_missed = 1;
  world_fault(w, FRAY_FAULT_CONTACTS_FULL);
}

void contact_constraint_add(fray_world *w, uint32_t body, constraint_kind kind,
                            const uint32_t vertex[3], const int32_t weight[3], vec3 normal,
                            int64_t gap) {
  FRAY_ASSERT(body < w->capacity[POOL_BODIES]);
  const int32_t mass = contact_effective_mass(w, body, vertex, weight);
  if (mass == 0) return;
  if (w->membrane.constraint_count == CONSTRAINTS_PER_CONTACT * w->capacity[POOL_CONTACTS]) {
    contact_constraint_miss(w);
    return;
  }
  contact_constraint *c = &w->membrane.constraints[w->membrane.constraint_count++];
  for (uint32_t k = 0; k < 3; ++k) {
    c->vertex[k] = vertex[k];
    c->weight[k] = weight[k];
  }
  c->normal = normal;
  c->gap = fx_saturate(gap * (1 << FX_SUB_BITS));
  c->low = 0;
  c->mass = mass;
  c->body = (uint16_t)body;
  c->kind = (uint16_t)kind;
}

void contact_constraint_add_vertex(fray_world *w, uint32_t body, constraint_kind kind,
                                   uint32_t vertex, vec3 normal, int64_t gap) {
  const uint32_t all[3] = {vertex, vertex, vertex};
  const int32_t weight[3] = {CONSTRAINT_ONE, 0, 0};
  contact_constraint_add(w, body, kind, all, weight, normal, gap);
}

/* ---- primitives ---- */

/* How far beyond its thickness cloth is looked for. */
static int32_t room_of(const fray_world *w) {
  return fx_max(w->params->contact_margin / 8, COLLIDER_SKIN_MIN);
}

static int32_t approach_of(const fray_world *w, uint32_t p, uint32_t b, vec3 normal) {
  const vec3 velocity =
      vec_sub_saturated(world_velocity(w, p), vec_of(w->rigid.states[b].velocity));
  return fx_asr(fx_min(vec_dot_unit(velocity, normal), 0), FX_SUB_BITS);
}

static void find_primitive(fray_world *w, const contact *k) {
  const rigid_body *s = &w->rigid.bodies[k->body];
  const int32_t margin = w->params->contact_margin;
  const vec3 d = vec_sub(world_position(w, k->particle), w->membrane.bodies[k->body].start);
  vec3 normal = vec_make(0, 1 << 30, 0);
  const int32_t depth = shape_depth_at(s, d, fx_add(w->params->thickness, margin), &normal);
  if (depth <= 0) return;
  const int32_t gap = margin - depth;
  if (gap + 2 * (int64_t)approach_of(w, k->particle, k->body, normal) >
      fx_max(room_of(w), w->params->thickness))
    return;
  contact_constraint_add_vertex(w, k->body, s->radius != 0 ? CONSTRAINT_VERTEX : CONSTRAINT_FLAT,
                                k->particle, normal, gap);
}

/* ---- meshes ---- */

/* Of elastic yarns. What has no room beside the first is left to the tests of paths. */
static int add_plane(fray_world *w, const collider *t, uint32_t p, vec3 out, int64_t gap, int is_first) {
  const int has_room = collider_add_contact(w, t, p, out);
  if (has_room)
    w->contact.list[w->contact.count - 1u].plane_gap = contact_plane_gap(gap);
  else if (is_first)
    contact_constraint_miss(w);
  return has_room;
}

static void find_vertex(fray_world *w, const collider *t, uint32_t p, ccd_path path, int32_t room) {
  const int32_t skin = collider_skin(w) + room;
  const vec3 begin = path.begin;
  const collider_box span = collider_box_of(&path, 1, skin);
  collider_near near;
  collider_list_near(w, t, &span, RIGID_MESH_NEAR, &near);
  for (uint32_t round = 0; round < RIGID_MESH_ROUNDS; ++round) {
    const mesh_push push = mesh_push_first(w, t, &near, &path, skin);
    if (push.depth == 0) return;
    const int64_t gap =
        (int64_t)vec_dot_unit(vec_sub(begin, path.end), push.out) + room - push.depth;
    if (world_has_membrane(w))
      contact_constraint_add_vertex(w, t->body, CONSTRAINT_FLAT, p, push.out, gap);
    else if (!add_plane(w, t, p, push.out, gap, round == 0))
      return;
    path.end = collider_pushed(path.end, push.out, push.depth);
  }
}

static void find_collider(fray_world *w, const collider *t, int32_t room) {
  const int32_t skin = collider_skin(w) + room;
  uint32_t budget[2] = {w->capacity[POOL_CONTACTS],
                        RIGID_MESH_TRIANGLES * w->capacity[POOL_CONTACTS]};
  for (uint32_t p = 0; p < w->p.count; ++p) {
    const ccd_path path = collider_path(w, t, p);
    w->contact.side_mask[p] = collider_mask_of(w, t, p, &path, skin);
    if (w->contact.side_mask[p] != 0 || particle_is_attached(w, p) || t->radius != 0) continue;
    if (collider_is_far(path.begin) || collider_is_far(path.end)) continue;
    if (budget[0] == 0) {
      contact_constraint_miss(w);
      continue;
    }
    --budget[0];
    find_vertex(w, t, p, path, room);
  }
  w->work.mesh_tests += w->p.count;
  if (rigid_mesh_meets_triangles(w)) contact_triangles_constrain(w, t, room, &budget[1]);
}

static void move_axis(int32_t *x, const int32_t *v, uint32_t end) {
  for (uint32_t p = 0; p < end; ++p)
    x[p] = fx_clamp(fx_add(x[p], fx_round(v[p], FX_SUB_BITS)), -FX_WORLD_MAX, FX_WORLD_MAX);
}

/* Behind the pull of the first of 2^bits steps, of which each pulls alike. */
static void move_pulled_axis(int32_t *x, const int32_t *v, const int32_t *unpulled, uint32_t end,
                             unsigned bits) {
  const int64_t later = ((int64_t)1 << bits) - 1;
  for (uint32_t p = 0; p < end; ++p) {
    const int64_t way = v[p] + fx_asr64(((int64_t)v[p] - unpulled[p]) * later, 1);
    x[p] = (int32_t)fx_clamp64(x[p] + fx_round64(way, FX_SUB_BITS), -FX_WORLD_MAX, FX_WORLD_MAX);
  }
}

static void move_pulled(fray_world *w) {
  const unsigned bits = (unsigned)w->woven.elastic_params->steps_bits;
  move_pulled_axis(w->p.x, w->p.vx, w->p.unpulled[0], w->p.count, bits);
  move_pulled_axis(w->p.y, w->p.vy, w->p.unpulled[1], w->p.count, bits);
  move_pulled_axis(w->p.z, w->p.vz, w->p.unpulled[2], w->p.count, bits);
}

/* To where everything would be at the end of the substep. */
static void move_ahead(fray_world *w) {
  for (uint32_t p = 0; p < particles_attached(w); ++p)
    world_set_velocity(w, p, world_body_velocity(w, w->p.attach_body[p]));
  if (world_has_elastic_yarns(w)) {
    move_pulled(w);
    return;
  }
  move_axis(w->p.x, w->p.vx, w->p.count);
  move_axis(w->p.y, w->p.vy, w->p.count);
  move_axis(w->p.z, w->p.vz, w->p.count);
}

static void move_back(fray_world *w) {
  const contact_state *c = &w->contact;
  for (uint32_t p = 0; p < w->p.count; ++p) {
    w->p.x[p] = c->start_x[p];
    w->p.y[p] = c->start_y[p];
    w->p.z[p] = c->start_z[p];
  }
}

static void find_meshes(fray_world *w) {
  move_ahead(w);
  for (uint32_t n = 0; n < collider_count(w); ++n) {
    collider t = collider_at(w, n);
    if (w->rigid.bodies[t.body].motion == FRAY_FREE)
      t.now = vec_add_clamped(t.start, vec_round(world_body_velocity(w, t.body), FX_SUB_BITS),
                              FX_WORLD_MAX);
    find_collider(w, &t, room_of(w));
  }
  move_back(w);
}

void contact_yarn_planes_begin(fray_world *w) {
  FRAY_ASSERT(world_has_elastic_yarns(w) && world_has_rigid_meshes(w));
  for (uint32_t p = 0; p < w->p.count; ++p) {
    w->p.unpulled[0][p] = w->p.vx[p];
    w->p.unpulled[1][p] = w->p.vy[p];
    w->p.unpulled[2][p] = w->p.vz[p];
  }
}

void contact_yarn_planes_find(fray_world *w) {
  FRAY_ASSERT(world_has_elastic_yarns(w) && world_has_rigid_meshes(w));
  w->contact.count = w->contact.gathered;
  w->membrane.constraints_missed = 0;
  find_meshes(w);
}

void contact_constraints_find(fray_world *w) {
  FRAY_ASSERT(world_has_membrane(w) && w->contact.gathered <= w->capacity[POOL_CONTACTS]);
  w->membrane.constraint_count = 0;
  w->membrane.constraints_missed = 0;
  for (uint32_t n = 0; n < w->contact.gathered; ++n) find_primitive(w, &w->contact.list[n]);
  if (world_has_rigid_meshes(w)) find_meshes(w);
  contact_planes_find(w);
}
