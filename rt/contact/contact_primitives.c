/* SPDX-License-Identifier: Apache-2.0 */
/* Particles of woven cloth against spheres, capsules, boxes and planes (Metaaphanon 2009, section 4.2, first
 * half).
 *
 *   contact_gather()            once a tick, of elastic yarns once a substep: the particles that may reach a
 *                               body before it ends, by boxes widened by the travel of both. When the pool
 *                               is full, the rest is skipped in the order of bodies and particles, and
 *                               reported.
 *   contact_primitives_solve()  each substep: a particle closer to a body than the cloth's thickness is
 *                               pushed out along the body's normal, and Coulomb friction holds it back
 *                               along the surface, as a displacement. */
#include "rt/base/coulomb.h"
#include "rt/contact/contact.h"
#include "rt/contact/shape.h"
#include "rt/elastic/step_impulse.h"
#include "rt/simd/simd.h"
#include "rt/state/crossing.h"
#include "rt/state/rigid_mesh.h"

/* ---- broad phase ---- */

/* How far a body will move in this tick, along each axis. */
static vec3 body_travel(const fray_world *w, uint32_t b, uint32_t fastest) {
  const body_motion *m = &w->rigid.motion[b];
  const int32_t *v = w->rigid.states[b].velocity;
  const uint32_t substeps = (uint32_t)w->params->substeps;
  if (w->rigid.bodies[b].motion == FRAY_FREE)
    return vec_make((int32_t)broad_phase_travel(v[0], substeps, fastest),
                    (int32_t)broad_phase_travel(v[1], substeps, fastest),
                    (int32_t)broad_phase_travel(v[2], substeps, fastest));
  const vec3 path = vec_sub(m->to, m->from);
  return vec_make((int32_t)fx_magnitude(path.x), (int32_t)fx_magnitude(path.y),
                  (int32_t)fx_magnitude(path.z));
}

/* Returns 0 where the pool is full. */
__attribute__((noinline)) static int add_contact(fray_world *w, uint32_t b, uint32_t p) {
  FRAY_ASSERT(w->contact.count <= w->capacity[POOL_CONTACTS] && p >= particles_attached(w) && p < w->p.count);
  if (w->contact.count == w->capacity[POOL_CONTACTS]) {
    world_fault(w, FRAY_FAULT_CONTACTS_FULL);
    return 0;
  }
  if (world_is_released(w, p)) {
    world_fault(w, FRAY_FAULT_CONTACT_UNRESOLVED);
    return 1;
  }
  contact *c = &w->contact.list[w->contact.count++];
  c->particle = p;
  c->body = (uint16_t)b;
  c->touching = CONTACT_APART;
  return 1;
}

/* Kernels rule out whole blocks of particles. */
enum { GATHER_BLOCK = 64 };

static void gather_plane(fray_world *w, uint32_t b, const broad_phase *g, uint32_t first, uint32_t end) {
  for (uint32_t p = first; p < end; ++p)
    if (broad_phase_near_plane(g, world_position(w, p), world_velocity(w, p)) && !add_contact(w, b, p))
      return;
}

static void gather_box(fray_world *w, uint32_t b, const broad_phase *g, uint32_t first, uint32_t end) {
  for (uint32_t p = first; p < end; ++p)
    if (broad_phase_near_axis(g, 0, w->p.x[p], w->p.vx[p]) &&
        broad_phase_near_axis(g, 1, w->p.y[p], w->p.vy[p]) &&
        broad_phase_near_axis(g, 2, w->p.z[p], w->p.vz[p]) && !add_contact(w, b, p))
      return;
}

static broad_phase broad_phase_of(const fray_world *w, uint32_t b) {
  const params *k = w->params;
  const rigid_body *s = &w->rigid.bodies[b];
  const int32_t *at = w->rigid.states[b].position;
  const uint32_t fastest = (uint32_t)FX_WORLD_MAX / (uint32_t)k->substeps;
  const vec3 travelled = body_travel(w, b, fastest);
  const int32_t travel[3] = {travelled.x, travelled.y, travelled.z};
  broad_phase g = {{at[0], at[1], at[2]}, {0, 0, 0}, shape_plane_normal(s),
                   0, (uint32_t)k->substeps, fastest};
  for (uint32_t n = 0; n < 3; ++n) {
    const int64_t along = (int64_t)k->thickness + k->contact_margin + s->aabb_half[n] + travel[n];
    g.half[n] = (uint32_t)fx_clamp64(along, 0, (int64_t)1 << 31);
    g.above += along;
  }
  return g;
}

static void gather_body(fray_world *w, uint32_t b) {
  FRAY_ASSERT(b < (uint32_t)w->params->bodies);
  const uint32_t end = w->p.count;
  const uint32_t first = particles_attached(w);
  const uint32_t block = w->kernel == FRAY_KERNEL_SCALAR ? end : GATHER_BLOCK;
  const int is_plane = shape_is_plane(&w->rigid.bodies[b]);
  const broad_phase g = broad_phase_of(w, b);
  w->work.broad_phase_tests += end - first;
  for (uint32_t p = first; p < end;) {
    const uint32_t last = end - p < block ? end : p + block;
    if (is_plane) {
      if (simd_near_plane(w->kernel, &g, w->p.x, w->p.y, w->p.z, w->p.vx, w->p.vy, w->p.vz, p, last))
        gather_plane(w, b, &g, p, last);
    } else if (simd_near_box(w->kernel, &g, w->p.x, w->p.y, w->p.z, w->p.vx, w->p.vy, w->p.vz, p, last)) {
      gather_box(w, b, &g, p, last);
    }
    p = last;
  }
}

void contact_gather(fray_world *w) {
  FRAY_ASSERT(particles_attached(w) <= w->p.count && w->p.count <= w->capacity[POOL_PARTICLES]);
  w->contact.count = 0;
  w->contact.rise = fx_round(step_rise_of(w), FX_SUB_BITS);
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    if (body_is_primitive(&w->rigid.bodies[b])) gather_body(w, b);
  w->contact.gathered = w->contact.count;
}

/* ---- narrow phase ---- */

/* Moves a coordinate, at most to the end of the world; returns how far. */
static int32_t move_within(fray_world *w, int32_t *at, int32_t by) {
  const int32_t before = *at;
  const int32_t wanted = fx_add_saturated(before, by);
  *at = fx_clamp(wanted, fx_min(before, -FX_WORLD_MAX), fx_max(before, FX_WORLD_MAX));
  if (*at != wanted) world_fault(w, FRAY_FAULT_OUT_OF_WORLD);
  return *at - before;
}

/* A body, as its contacts need it in a substep. Narrow cores take the general path for every contact:
 * shortcuts would make that one longer, and it is what bounds their ticks. */
typedef struct {
  const rigid_body *shape;
  vec3 at, moved;
  uint64_t apart; /* see shape_apart_squared() */
  int32_t skin, rise;
  int faces_up;   /* a plane with the normal (0, 1, 0) */
} contact_body;

static inline int is_ground(const contact_body *e) { return !FX_NARROW && e->faces_up; }

static void begin_body(const fray_world *w, uint32_t b, contact_body *e) {
  const rigid_body *s = &w->rigid.bodies[b];
  FRAY_ASSERT(b < w->capacity[POOL_BODIES]);
  e->shape = s;
  e->at = vec_of(w->rigid.states[b].position);
  e->moved = w->rigid.motion[b].moved;
  e->skin = w->params->thickness;
  e->rise = w->contact.rise;
  e->apart = FX_NARROW ? 0 : shape_apart_squared(s, e->skin);
  e->faces_up = !FX_NARROW && shape_faces_up(s);
}

/* What the particle moved in this substep relative to the body: step and projections. Of a body that leaps
 * through the whole world it goes round, here and in the twin: that only is where friction points, and how
 * much of the depth a push takes. */
static inline vec3 moved_of(const fray_world *w, const contact_body *e, uint32_t p) {
  const vec3 step = vec_round(world_velocity(w, p), FX_SUB_BITS);
  const vec3 since = vec_wrap_sub(world_position(w, p), vec_at(w->p.qx, w->p.qy, w->p.qz, p));
  return vec_wrap_sub(vec_wrap_add(step, since), e->moved);
}

/* All of the depth that the substep can have made; what was deep before rises slowly, else it would be thrown
 * out. */
static inline int32_t depth_pushed(const contact_body *e, int32_t depth, vec3 moved) {
  const uint32_t most = contact_depth_made(moved.x, moved.y, moved.z) + (uint32_t)e->rise;
  return (uint32_t)depth > most ? (int32_t)most : depth;
}

static inline void add_push(fray_world *w, const contact *c, vec3 push) {
  FRAY_ASSERT(c->body < w->capacity[POOL_BODIES]);
  body_add_impulse(&w->rigid.motion[c->body],
                   vec_scale64(push, particle_half_masses(w, c->particle) << (FX_SUB_BITS - 1)));
}

/* Pushes a particle at d from the body out, with friction. Products with (0, 1, 0) are exact: on the
 * ground they are left out. */
__attribute__((always_inline)) static inline void push_out(fray_world *w, const contact_body *e, contact *c,
                                                           vec3 d) {
  const uint32_t p = c->particle;
  const int32_t depth = is_ground(e) ? (int32_t)fx_clamp64((int64_t)e->skin - d.y, 0, INT32_MAX)
                                     : shape_depth(e->shape, d, e->skin, &c->normal);
  if (depth <= 0) {
    c->touching = CONTACT_APART;
    return;
  }
  c->touching = is_ground(e) ? CONTACT_GROUND : CONTACT_TOUCHES;

  const vec3 before = moved_of(w, e, p);
  const int32_t pushed = depth_pushed(e, depth, before);
  const vec3 out = is_ground(e) ? vec_make(0, pushed, 0) : vec_scale_unit(c->normal, pushed);
  const vec3 moved = vec_wrap_add(before, out);
  const vec3 along = is_ground(e) ? vec_make(0, fx_max(moved.y, -INT32_MAX), 0)
                                  : vec_scale_unit(c->normal, vec_dot_unit(moved, c->normal));
  const vec3 slip = coulomb_limited(vec_wrap_sub(moved, along), pushed, e->shape->friction);
  const vec3 wanted = vec_wrap_sub(out, slip);

  const vec3 push = vec_make(move_within(w, &w->p.x[p], wanted.x), move_within(w, &w->p.y[p], wanted.y),
                             move_within(w, &w->p.z[p], wanted.z));
  add_push(w, c, push);
}

/* Contacts with the ground in a kernel, as many as it takes from the front. */
static uint32_t solve_ground(fray_world *w, const contact_body *e, uint32_t b, uint32_t first, uint32_t end) {
  FRAY_ASSERT(first <= end && end <= w->contact.count);
  ground_contact_view v = {{w->p.x, w->p.y, w->p.z}, {w->p.vx, w->p.vy, w->p.vz}, {w->p.qx, w->p.qy, w->p.qz},
                   w->contact.list, e->moved, e->at.y, e->skin, e->rise, e->shape->friction,
                   w->woven.crossing_state, w->woven.crossing_of, {0, 0, 0}, 0};
  const uint32_t taken = simd_ground_contact(w->kernel, &v, first, end);
  if (taken == 0) return 0;
  if (v.held_back != 0) world_fault(w, FRAY_FAULT_OUT_OF_WORLD);
  const int64_t half = 1 << (FX_SUB_BITS - 1);
  const vec64 pushed = {v.pushed[0] * half, v.pushed[1] * half, v.pushed[2] * half};
  body_add_impulse(&w->rigid.motion[b], pushed);
  return taken;
}

static inline void solve_contact(fray_world *w, const contact_body *e, contact *c) {
  FRAY_ASSERT(c->particle >= particles_attached(w) && c->particle < w->p.count);
  const vec3 d = vec_sub(world_position(w, c->particle), e->at);
  if (FX_NARROW || (is_ground(e) ? d.y < e->skin : e->apart == 0 || vec_squared(d) < e->apart))
    push_out(w, e, c, d);
  else
    c->touching = CONTACT_APART;
}

/* Contacts of body b, from `first` on; returns where they end. */
static inline uint32_t solve_body(fray_world *w, uint32_t b, uint32_t first, uint32_t end) {
  contact_body e;
  uint32_t n = first;
  begin_body(w, b, &e);
  if (is_ground(&e) && w->kernel != FRAY_KERNEL_SCALAR) {
    uint32_t last = first;
    while (last < end && w->contact.list[last].body == b) ++last;
    n += solve_ground(w, &e, b, first, last);
  }
  for (; n < end && w->contact.list[n].body == b; ++n) solve_contact(w, &e, &w->contact.list[n]);
  return n;
}

void contact_primitives_range(fray_world *w, uint32_t first, uint32_t end) {
  FRAY_ASSERT(first <= end && end <= w->contact.count && w->contact.count <= w->capacity[POOL_CONTACTS]);
  if (FX_NARROW) {
    for (uint32_t n = first; n < end; ++n) {
      contact_body e;
      begin_body(w, w->contact.list[n].body, &e);
      solve_contact(w, &e, &w->contact.list[n]);
    }
  } else {
    for (uint32_t n = first; n < end;) n = solve_body(w, w->contact.list[n].body, n, end);
  }
  w->work.contacts += end - first;
}

void contact_primitives_solve(fray_world *w) {
  if (world_has_elastic_yarns(w)) return; /* contact_steps.c */
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    if (w->rigid.bodies[b].motion == FRAY_FREE) contact_planes_push(w, b);
  contact_primitives_range(w, 0, w->contact.count);
}
