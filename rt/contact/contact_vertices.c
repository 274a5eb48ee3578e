/* SPDX-License-Identifier: Apache-2.0 */
/* Particles against rigid meshes, in each substep, after everything else that moves them (Karaoz 2015,
 * section 2.6). Relative to a mesh, which only translates, a particle moves on a straight path from where
 * the substep began: that position tells the side on which it stays.
 *
 *   repulsion   of the triangles that its path comes within the cloth's thickness of, the first one
 *               pushes the path's end out to that thickness, along the way from the nearest point; a few
 *               rounds, then friction
 *   resolution  a path that touches a triangle nevertheless is not taken: the particle is pinned, that
 *               is, it keeps its position relative to the mesh; so is one that exceeds a budget or the
 *               pool of contacts
 *
 * A push keeps a path from crossing that triangle: the plane through the nearest point, across the push,
 * has all of the triangle on one side and both ends of the path on the other. A path that needs no push
 * crosses nothing. So what begins on one side of a triangle never ends on the other. Where several meshes
 * move, each may push a particle through another one: that is tested twice more; then the free bodies
 * that take part are stopped and everything is done again; what is left is reported. Released particles
 * pass (woven/overstretched_links.c). */
#include "rt/contact/contact.h"
#include "rt/contact/contact_triangles.h"
#include "rt/contact/mesh_push.h"

static void copy(int32_t *restrict to, const int32_t *restrict from, uint32_t count) {
  for (uint32_t p = 0; p < count; ++p) to[p] = from[p];
}

void contact_vertices_begin(fray_world *w) {
  FRAY_ASSERT(world_has_rigid_meshes(w));
  w->contact.count = w->contact.gathered;
  copy(w->contact.start_x, w->p.x, w->p.count);
  copy(w->contact.start_y, w->p.y, w->p.count);
  copy(w->contact.start_z, w->p.z, w->p.count);
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    w->rigid.start[b] = vec_of(w->rigid.states[b].position);
}

/* ---- one particle ---- */

/* Pushes the path's end out. Returns 1 and the last push, with the depth of all of them, or 0. */
static int push_path(fray_world *w, const collider *t, const collider_near *near, ccd_path *path,
                     mesh_push *last) {
  int64_t sum = 0;
  for (uint32_t round = 0; round < RIGID_MESH_ROUNDS; ++round) {
    const mesh_push p = mesh_push_first(w, t, near, path, collider_skin(w));
    if (p.depth == 0) break;
    path->end = collider_pushed(path->end, p.out, p.depth);
    sum += p.depth;
    last->out = p.out;
  }
  last->depth = (int32_t)fx_clamp64(sum, 0, FX_WORLD_MAX);
  return sum != 0;
}

/* A particle with a path near the mesh's box. */
__attribute__((noinline)) static void push_particle(fray_world *w, const collider *t, uint32_t p,
                                                    ccd_path path) {
  const ccd_path unpushed = path;
  collider_near near;
  mesh_push last;
  const collider_box span = collider_box_of(&path, 1, collider_skin(w));
  collider_list_near(w, t, &span, RIGID_MESH_NEAR, &near);
  if (near.has_more) {
    world_fault(w, FRAY_FAULT_MESH_QUERY_BUDGET);
    collider_pin(w, t, p, &unpushed);
    return;
  }
  if (!push_path(w, t, &near, &path, &last)) return;
  const vec3 moved = vec_sub(path.end, path.begin);
  path.end = vec_sub(path.end, collider_friction(w, t, moved, last.out, last.depth));

  /* while its end has not left the span, the list still has every triangle that it may touch */
  int pinned = collider_contains(&span, path.end)
                   ? !collider_path_is_point(&path) && collider_crosses_near(w, t, &near, &path)
                   : collider_crosses(w, t, &path);
  if (!pinned && !collider_add_contact(w, t, p, last.out)) {
    world_fault(w, FRAY_FAULT_CONTACTS_FULL);
    pinned = 1;
  }
  if (pinned)
    collider_pin(w, t, p, &unpushed);
  else
    collider_place(w, t, p, path.end);
}

/* ---- all particles and one collider ---- */

/* Sets side_mask and pushes every particle with a path near the body; those beyond the budget are
 * pinned. */
static void push_all(fray_world *w, const collider *t, uint32_t *budget) {
  const uint32_t end = w->p.count;
  const uint32_t attached = particles_attached(w);
  const int32_t skin = collider_skin(w);
  for (uint32_t p = 0; p < end; ++p) {
    const ccd_path path = collider_path(w, t, p);
    if (world_is_released(w, p) && collider_sides(t, &path, skin) == 0)
      world_fault(w, FRAY_FAULT_CONTACT_UNRESOLVED);
    w->contact.side_mask[p] = collider_mask_of(w, t, p, &path, skin);
    if (w->contact.side_mask[p] != 0 || p < attached) continue;
    if (*budget == 0 || collider_is_far(path.begin) || collider_is_far(path.end)) {
      world_fault(w, *budget == 0 ? FRAY_FAULT_CONTACTS_FULL : FRAY_FAULT_OUT_OF_WORLD);
      collider_pin(w, t, p, &path);
      continue;
    }
    --*budget;
    push_particle(w, t, p, path);
  }
  w->work.mesh_tests += end;
}

/* Tests all paths again, as another body may have pushed one through this mesh. Returns how many were
 * pinned. */
static uint32_t check_all(fray_world *w, const collider *t, uint32_t *budget) {
  const uint32_t end = w->p.count;
  const uint32_t attached = particles_attached(w);
  uint32_t pinned = 0;
  for (uint32_t p = 0; p < end; ++p) {
    const ccd_path path = collider_path(w, t, p);
    w->contact.side_mask[p] = collider_mask_of(w, t, p, &path, 0);
    if (w->contact.side_mask[p] != 0 || p < attached) continue;
    if (t->radius != 0 || collider_path_is_point(&path)) continue;
    const int unknown = *budget == 0 || collider_is_far(path.begin) || collider_is_far(path.end);
    if (!unknown) --*budget;
    if (!unknown && !collider_crosses(w, t, &path)) continue;
    collider_pin(w, t, p, &path);
    ++pinned;
  }
  w->work.mesh_tests += end;
  return pinned;
}

/* ---- all colliders ---- */

/* Colliders that still pin something, or that meet vertices attached to another body. */
typedef struct {
  uint32_t colliders; /* a bit each */
  uint32_t holder;    /* the body with such vertices, or CONTACT_TRIANGLES_FREE */
} jam;

__attribute__((noinline)) static void push_off_collider(fray_world *w, uint32_t n, uint32_t *budget) {
  const collider t = collider_at(w, n);
  push_all(w, &t, budget);
}

__attribute__((noinline)) static uint32_t check_collider(fray_world *w, uint32_t n, uint32_t budget[2],
                                                         jam *found) {
  const collider t = collider_at(w, n);
  uint32_t holder = CONTACT_TRIANGLES_FREE;
  uint32_t pinned = check_all(w, &t, &budget[0]);
  if (rigid_mesh_meets_triangles(w)) pinned += contact_triangles_check(w, &t, &budget[1], &holder);
  if (holder != CONTACT_TRIANGLES_FREE) found->holder = holder;
  if (pinned != 0 || holder != CONTACT_TRIANGLES_FREE) found->colliders |= 1u << n;
  return pinned;
}

/* Returns 1 iff it ended: the last tests pinned nothing, and met nothing that cannot be pinned. */
static int resolve(fray_world *w, jam *found) {
  const uint32_t max = w->capacity[POOL_CONTACTS];
  const uint32_t count = collider_count(w);
  uint32_t pinned = 0;
  uint32_t budget[2] = {max, RIGID_MESH_TRIANGLES * max};
  FRAY_ASSERT(count <= MAX_BODIES);
  found->colliders = 0;
  found->holder = CONTACT_TRIANGLES_FREE;
  if (world_is_projected(w))
    for (uint32_t n = 0; n < count; ++n) push_off_collider(w, n, budget);
  for (uint32_t round = 0; round < collider_checks(w); ++round) {
    pinned = 0;
    budget[0] = max;
    budget[1] = RIGID_MESH_TRIANGLES * max;
    for (uint32_t n = 0; n < count; ++n) pinned += check_collider(w, n, budget, found);
    if (pinned == 0) break;
  }
  return pinned == 0 && found->holder == CONTACT_TRIANGLES_FREE;
}

static int has_missed(const fray_world *w) {
  return !world_is_projected(w) && w->membrane.constraints_missed != 0;
}

uint32_t contact_vertices_check(fray_world *w) {
  uint32_t pinned = 0;
  uint32_t budget[2] = {w->capacity[POOL_CONTACTS], RIGID_MESH_TRIANGLES * w->capacity[POOL_CONTACTS]};
  jam found = {0, CONTACT_TRIANGLES_FREE};
  FRAY_ASSERT(world_has_rigid_meshes(w));
  if (has_missed(w)) return 0;
  for (uint32_t n = 0; n < collider_count(w); ++n) pinned += check_collider(w, n, budget, &found);
  if (found.holder != CONTACT_TRIANGLES_FREE) world_fault(w, FRAY_FAULT_CONTACT_UNRESOLVED);
  return pinned;
}

/* ---- free bodies in a jam ---- */

/* Moves a free body back to where the substep began and stops it; its remaining momentum goes to `other`. */
static void stop_body(fray_world *w, const collider *t, uint32_t other) {
  body_state *s = &w->rigid.states[t->body];
  body_motion *m = &w->rigid.motion[t->body];
  const int64_t max = (int64_t)1 << 48;
  const int32_t mass_ratio = fx_max(1, w->rigid.bodies[t->body].mass_ratio);
  FRAY_ASSERT(other == CONTACT_TRIANGLES_FREE || other < w->capacity[POOL_BODIES]);
  for (uint32_t n = 0; n < 3; ++n) {
    const int64_t had = fx_clamp64(((int64_t)s->velocity[n] * (1 << 30)) / mass_ratio, -max, max);
    const int64_t rest = fx_add64(had, -fx_add64(m->impulse[n], -m->applied[n]));
    m->impulse[n] = fx_add64(m->impulse[n], rest);
    m->applied[n] = m->impulse[n];
    if (other != CONTACT_TRIANGLES_FREE) {
      int64_t *impulse = &w->rigid.motion[other].impulse[n];
      *impulse = fx_add64(*impulse, -rest);
    }
    s->velocity[n] = 0;
  }
  vec_store(s->position, t->start);
  m->moved = vec_make(0, 0, 0);
}

/* The body that takes the momentum: the one that holds the vertices in the way, else one in the jam that
 * is not free. */
static uint32_t counterpart_of(const fray_world *w, const jam *found) {
  if (found->holder != CONTACT_TRIANGLES_FREE) return found->holder;
  for (uint32_t n = 0; n < collider_count(w); ++n) {
    const collider t = collider_at(w, n);
    if ((found->colliders >> n & 1u) != 0 && w->rigid.bodies[t.body].motion != FRAY_FREE) return t.body;
  }
  return CONTACT_TRIANGLES_FREE;
}

/* Returns 1 iff a body was stopped. */
__attribute__((noinline)) static int stop_bodies(fray_world *w, const jam *found) {
  int stopped = 0;
  for (uint32_t n = 0; n < collider_count(w); ++n) {
    const collider t = collider_at(w, n);
    if ((found->colliders >> n & 1u) == 0 || w->rigid.bodies[t.body].motion != FRAY_FREE) continue;
    stop_body(w, &t, counterpart_of(w, found));
    stopped = 1;
  }
  return stopped;
}

/* Pins everything between the bodies of a jam. Returns 1 iff none of them moves. */
__attribute__((noinline)) static int pin_between(fray_world *w, const jam *found) {
  int still = 1;
  for (uint32_t n = 0; n < collider_count(w); ++n) {
    const collider t = collider_at(w, n);
    if ((found->colliders >> n & 1u) == 0) continue;
    contact_triangles_pin(w, &t);
    still = still && vec_is_equal(t.start, t.now);
  }
  return still;
}

void contact_vertices_solve(fray_world *w) {
  const uint32_t contacts = w->contact.gathered;
  jam found;
  FRAY_ASSERT(world_has_rigid_meshes(w) && contacts <= w->capacity[POOL_CONTACTS]);
  w->contact.count = contacts;
  if (has_missed(w)) return;
  if (resolve(w, &found)) return;
  if (rigid_mesh_meets_triangles(w) && stop_bodies(w, &found)) {
    w->contact.count = contacts;
    if (resolve(w, &found) || (found.holder == CONTACT_TRIANGLES_FREE && pin_between(w, &found))) return;
  }
  world_fault(w, FRAY_FAULT_CONTACT_UNRESOLVED);
}
