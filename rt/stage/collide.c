/* SPDX-License-Identifier: Apache-2.0 */
/* Cloth particles against rigid bodies (Metaaphanon 2009, section 4.2, first half).
 *
 * gather, once a tick: the particles that may reach a body before the tick ends, by boxes widened
 * by what both will move. The pool is bounded; what does not fit is left out in order of body and
 * particle, and reported.
 * run, each substep: a particle closer to a body than the cloth's thickness is pushed out along
 * the body's normal, and held back along the surface by Coulomb friction, as a displacement. */
#include "rt/model/couples.h"
#include "rt/model/heft.h"
#include "rt/model/mesh.h"
#include "rt/stage/stage.h"
#include "rt/wide/wide.h"

/* How far a body will move in this tick, along each axis. */
static vec3 body_travel(const fray_world *w, uint32_t b, uint32_t fastest) {
  const body_motion *m = &w->motion[b];
  const int32_t *v = w->body_states[b].velocity;
  const uint32_t substeps = (uint32_t)w->params->substeps;
  if (w->bodies[b].motion == FRAY_FREE)
    return vec_make((int32_t)reach_travel(v[0], substeps, fastest),
                    (int32_t)reach_travel(v[1], substeps, fastest),
                    (int32_t)reach_travel(v[2], substeps, fastest));
  const vec3 way = vec_sub(m->to, m->from);
  return vec_make((int32_t)fx_magnitude(way.x), (int32_t)fx_magnitude(way.y),
                  (int32_t)fx_magnitude(way.z));
}

/* Returns 0 where the pool is full. */
__attribute__((noinline)) static int add_contact(fray_world *w, uint32_t b, uint32_t p) {
  if (w->contact_count == w->capacity[POOL_CONTACTS]) {
    w->state->faults |= (int32_t)FRAY_FAULT_CONTACTS_FULL;
    return 0;
  }
  contact *c = &w->contacts[w->contact_count++];
  c->particle = p;
  c->body = (uint16_t)b;
  c->touching = 0;
  return 1;
}

/* Wide kernels rule out whole stretches of particles. */
enum { GATHER_STRETCH = 64 };

static void gather_plane(fray_world *w, uint32_t b, const reach *g, uint32_t first, uint32_t end) {
  for (uint32_t p = first; p < end; ++p)
    if (reach_above(g, world_position(w, p), vec_make(w->vx[p], w->vy[p], w->vz[p])) &&
        !add_contact(w, b, p))
      return;
}

static void gather_box(fray_world *w, uint32_t b, const reach *g, uint32_t first, uint32_t end) {
  for (uint32_t p = first; p < end; ++p)
    if (reach_along(g, 0, w->x[p], w->vx[p]) && reach_along(g, 1, w->y[p], w->vy[p]) &&
        reach_along(g, 2, w->z[p], w->vz[p]) && !add_contact(w, b, p))
      return;
}

static reach reach_of(const fray_world *w, uint32_t b) {
  const params *k = w->params;
  const body *s = &w->bodies[b];
  const int32_t *at = w->body_states[b].position;
  const uint32_t fastest = (uint32_t)FX_WORLD_MAX / (uint32_t)k->substeps;
  const vec3 travelled = body_travel(w, b, fastest);
  const int32_t way[3] = {travelled.x, travelled.y, travelled.z};
  reach g = {{at[0], at[1], at[2]}, {0, 0, 0}, vec_make(s->axes[3], s->axes[4], s->axes[5]),
             0, (uint32_t)k->substeps, fastest};
  for (uint32_t n = 0; n < 3; ++n) {
    const int64_t along = (int64_t)k->thickness + k->contact_margin + s->reach[n] + way[n];
    g.half[n] = (uint32_t)fx_clamp64(along, 0, (int64_t)1 << 31);
    g.above += along;
  }
  return g;
}

static void gather(fray_world *w, uint32_t b) {
  const uint32_t end = w->particles;
  const uint32_t first = (uint32_t)w->params->held;
  const uint32_t stretch = w->kernel == FRAY_KERNEL_SCALAR ? end : GATHER_STRETCH;
  const int is_plane = w->bodies[b].shape == FRAY_PLANE;
  const reach g = reach_of(w, b);
  w->work.gathers += end - first;
  for (uint32_t p = first; p < end;) {
    const uint32_t last = end - p < stretch ? end : p + stretch;
    if (is_plane) {
      if (wide_near_plane(w->kernel, &g, w->x, w->y, w->z, w->vx, w->vy, w->vz, p, last))
        gather_plane(w, b, &g, p, last);
    } else if (wide_near_box(w->kernel, &g, w->x, w->y, w->z, w->vx, w->vy, w->vz, p, last)) {
      gather_box(w, b, &g, p, last);
    }
    p = last;
  }
}

void collide_gather(fray_world *w) {
  w->contact_count = 0;
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    if (body_is_solid(&w->bodies[b])) gather(w, b);
  w->gathered = w->contact_count;
}

static vec3 body_axis(const body *s, uint32_t n) {
  return vec_make(s->axes[3 * n], s->axes[3 * n + 1], s->axes[3 * n + 2]);
}

/* Depth below the surface of a ball around the origin, `skin` included; the normal if positive. */
static int32_t ball_depth(vec3 d, int32_t radius, vec3 *normal) {
  const uint64_t n = vec_squared(d);
  if (n >= fx_square(radius)) return 0;
  if (n == 0) {
    *normal = vec_make(0, 1 << 30, 0);
    return radius;
  }
  const fx_root root = fx_rsqrt(n, FX_ROOT_FINE);
  *normal =
      vec_make(fx_root_unit(root, d.x), fx_root_unit(root, d.y), fx_root_unit(root, d.z));
  return fx_max(0, radius - (int32_t)fx_root_length(root));
}

static int32_t box_depth(const body *s, vec3 d, int32_t skin, vec3 *normal) {
  int32_t least = INT32_MAX;
  for (uint32_t n = 0; n < 3; ++n) {
    const vec3 axis = body_axis(s, n);
    const int32_t along = vec_dot_unit(d, axis);
    const int64_t depth = (int64_t)s->half[n] + skin - fx_magnitude(along);
    if (depth <= 0) return 0;
    if (depth < least) {
      least = (int32_t)depth;
      *normal = along < 0 ? vec_make(-axis.x, -axis.y, -axis.z) : axis;
    }
  }
  return least;
}

static int32_t depth_in(const body *s, vec3 d, int32_t skin, vec3 *normal) {
  switch (s->shape) {
    case FRAY_BALL:
      return ball_depth(d, s->radius + skin, normal);
    case FRAY_BAR: {
      const vec3 axis = body_axis(s, 0);
      const int32_t along = fx_clamp(vec_dot_unit(d, axis), -s->half[0], s->half[0]);
      return ball_depth(vec_sub(d, vec_scale_unit(axis, along)), s->radius + skin, normal);
    }
    case FRAY_BOX:
      return box_depth(s, d, skin, normal);
    case FRAY_PLANE:
      *normal = body_axis(s, 1);
      return (int32_t)fx_clamp64((int64_t)skin - vec_dot_unit(d, *normal), 0, INT32_MAX);
    default:
      return 0;
  }
}

/* Moves a coordinate as far as the world goes; returns how far that was. */
static int32_t move_within(fray_world *w, int32_t *at, int32_t by) {
  const int32_t before = *at;
  const int32_t wanted = fx_saturate((int64_t)before + by);
  *at = fx_clamp(wanted, fx_min(before, -FX_WORLD_MAX), fx_max(before, FX_WORLD_MAX));
  if (*at != wanted) w->state->faults |= (int32_t)FRAY_FAULT_LEFT_WORLD;
  return *at - before;
}

/* A body as its contacts meet it in a substep. Narrow cores take every contact by the longest way:
 * short cuts would make it longer, and that is what bounds their ticks. */
typedef struct {
  const body *shape;
  vec3 at, moved;
  uint64_t touch; /* squared: a ball that is not nearer is apart; 0 for others */
  int32_t skin;
  int level;      /* a plane that faces up: its normal is (0, 1, 0) */
  const heft *weighs;
} encounter;

static inline int is_level(const encounter *e) { return !FX_NARROW && e->level; }

static void begin_encounter(const fray_world *w, uint32_t b, const heft *weighs, encounter *e) {
  const body *s = &w->bodies[b];
  const int32_t *at = w->body_states[b].position;
  const vec3 *moved = &w->motion[b].moved;
  e->shape = s;
  e->at = vec_make(at[0], at[1], at[2]);
  e->moved = vec_make(moved->x, moved->y, moved->z);
  e->skin = w->params->thickness;
  e->weighs = weighs;
  e->touch = !FX_NARROW && s->shape == FRAY_BALL ? fx_square(s->radius + e->skin) : 0;
  e->level = !FX_NARROW && s->shape == FRAY_PLANE && s->axes[3] == 0 && s->axes[4] == 1 << 30 &&
             s->axes[5] == 0;
}

/* Products with (0, 1, 0) are exact: where the normal is that, they are left out. */
__attribute__((always_inline)) static inline void resolve(fray_world *w, const encounter *e, contact *c, vec3 d) {
  const uint32_t p = c->particle;
  const int32_t depth = is_level(e) ? (int32_t)fx_clamp64((int64_t)e->skin - d.y, 0, INT32_MAX)
                                 : depth_in(e->shape, d, e->skin, &c->normal);
  if (depth <= 0) {
    c->touching = CONTACT_APART;
    return;
  }
  c->touching = is_level(e) ? CONTACT_LEVEL : CONTACT_TOUCHES;
  const vec3 out = is_level(e) ? vec_make(0, depth, 0) : vec_scale_unit(c->normal, depth);
  /* what the particle moved in this substep against the body: step, projections, this push */
  const vec3 step = vec_make(fx_round(w->vx[p], FX_SUB_BITS), fx_round(w->vy[p], FX_SUB_BITS),
                             fx_round(w->vz[p], FX_SUB_BITS));
  const vec3 since = vec_sub(world_position(w, p), vec_make(w->qx[p], w->qy[p], w->qz[p]));
  const vec3 moved = vec_sub(vec_add(vec_add(step, since), out), e->moved);
  const vec3 along = is_level(e) ? vec_make(0, fx_max(moved.y, -INT32_MAX), 0)
                              : vec_scale_unit(c->normal, vec_dot_unit(moved, c->normal));
  const int32_t limit = fx_saturate(fx_mul_wide(depth, e->shape->friction) >> 16);
  /* friction takes back all of the slip within the cone, else `limit` of it */
  const vec3 wanted = vec_sub(out, vec_limited(vec_sub(moved, along), limit));
  const vec3 push = vec_make(move_within(w, &w->x[p], wanted.x), move_within(w, &w->y[p], wanted.y),
                             move_within(w, &w->z[p], wanted.z));
  if (e->weighs->per_mass != 0) {
    const int32_t mass = heft_at(e->weighs, p);
    body_gave(&w->motion[c->body], heft_times(mass, push.x, FX_SUB_BITS), heft_times(mass, push.y, FX_SUB_BITS),
              heft_times(mass, push.z, FX_SUB_BITS));
    return;
  }
  const int light = world_has_yarns(w) && couple_is_light(w, p);
  const int64_t mass = light ? 1 << (FX_SUB_BITS - 1) : 1 << FX_SUB_BITS;
  body_gave(&w->motion[c->body], push.x * mass, push.y * mass, push.z * mass);
}

/* How far a body goes down from its middle, where the normal is up. */
static int64_t below(const body *s, vec3 normal) {
  int64_t extent = s->radius;
  for (uint32_t n = 0; n < 3; ++n)
    extent += fx_magnitude(vec_dot_unit(vec_scale_unit(body_axis(s, n), s->half[n]), normal));
  return extent;
}
static int64_t mesh_below(const fray_world *w, uint32_t b, vec3 normal) {
  const mesh_parts m = mesh_at(w, mesh_of_body(w, b));
  return mesh_extent(&m, vec_make(-normal.x, -normal.y, -normal.z));
}

/* A free body on a plane: it stops there. */
static void rest_on_planes(fray_world *w, uint32_t b) {
  const body *s = &w->bodies[b];
  body_state *own = &w->body_states[b];
  for (uint32_t g = 0; g < (uint32_t)w->params->bodies; ++g) {
    if (w->bodies[g].shape != FRAY_PLANE) continue;
    const vec3 normal = body_axis(&w->bodies[g], 1);
    const int32_t *at = w->body_states[g].position;
    const int64_t extent = world_has_meshes(w) && s->shape == FRAY_MESH ? mesh_below(w, b, normal) : below(s, normal);
    const vec3 d = vec_make(fx_sub(own->position[0], at[0]), fx_sub(own->position[1], at[1]),
                            fx_sub(own->position[2], at[2]));
    const int64_t depth = extent - vec_dot_unit(d, normal);
    if (depth <= 0) continue;
    const vec3 out = vec_scale_unit(normal, (int32_t)fx_clamp64(depth, 0, FX_WORLD_MAX));
    const int32_t out_words[3] = {out.x, out.y, out.z};
    for (uint32_t n = 0; n < 3; ++n) {
      own->position[n] = fx_clamp(fx_add(own->position[n], out_words[n]), -FX_WORLD_MAX,
                                    FX_WORLD_MAX);
      own->velocity[n] = 0;
    }
  }
}

static uint32_t meet_level(fray_world *w, const encounter *e, uint32_t b, uint32_t first, uint32_t end) {
  level_view v = {{w->x, w->y, w->z}, {w->vx, w->vy, w->vz}, {w->qx, w->qy, w->qz}, w->contacts,
                  e->moved, e->at.y, e->skin, e->shape->friction, w->couple, w->place, {0, 0, 0}, 0};
  const uint32_t taken = wide_level(w->kernel, &v, first, end);
  if (taken == 0) return 0;
  if (v.held_back != 0) w->state->faults |= (int32_t)FRAY_FAULT_LEFT_WORLD;
  const int64_t half = 1 << (FX_SUB_BITS - 1);
  body_gave(&w->motion[b], v.pushed[0] * half, v.pushed[1] * half, v.pushed[2] * half);
  return taken;
}

static inline void meet(fray_world *w, const encounter *e, contact *c) {
  const vec3 d = vec_sub(world_position(w, c->particle), e->at);
  if (FX_NARROW || (is_level(e) ? d.y < e->skin : e->touch == 0 || vec_squared(d) < e->touch))
    resolve(w, e, c, d);
  else
    c->touching = CONTACT_APART;
}

/* Contacts of body b, from `first` on; returns where they end. */
static inline uint32_t meet_body(fray_world *w, const heft *weighs, uint32_t b, uint32_t first, uint32_t end) {
  encounter e;
  uint32_t n = first;
  begin_encounter(w, b, weighs, &e);
  if (is_level(&e) && w->kernel != FRAY_KERNEL_SCALAR && !world_has_sheet(w)) {
    uint32_t last = first;
    while (last < end && w->contacts[last].body == b) ++last;
    n += meet_level(w, &e, b, first, last);
  }
  for (; n < end && w->contacts[n].body == b; ++n) meet(w, &e, &w->contacts[n]);
  return n;
}

void collide_part(fray_world *w, uint32_t first, uint32_t end) {
  const heft weighs = heft_of(w);
  if (FX_NARROW) {
    for (uint32_t n = first; n < end; ++n) {
      encounter e;
      begin_encounter(w, w->contacts[n].body, &weighs, &e);
      meet(w, &e, &w->contacts[n]);
    }
  } else {
    for (uint32_t n = first; n < end;) n = meet_body(w, &weighs, w->contacts[n].body, n, end);
  }
  w->work.contacts += end - first;
}

void collide_run(fray_world *w) {
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    if (w->bodies[b].motion == FRAY_FREE) rest_on_planes(w, b);
  collide_part(w, 0, w->contact_count);
}
