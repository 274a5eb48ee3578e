/* SPDX-License-Identifier: Apache-2.0 */
/* Particles against rigid meshes, in each substep, behind all else that moves them (Karaoz 2015,
 * section 2.6). Seen from a mesh, which only translates, a particle moves on a straight line from where
 * the substep began: that place is the side that it stays on.
 *
 *   repulsion   of the triangles that its way comes within the cloth's thickness of, the first one
 *               pushes where it ends out to that thickness, along the way from the nearest point; a few
 *               rounds, then friction
 *   resolution  a way that touches a triangle nevertheless is not taken: the particle keeps its place
 *               beside the mesh, as does one for which the work is bounded too low, or no contact is left
 *
 * A push keeps a way from crossing that triangle: the plane through the nearest point, across the push,
 * has all of the triangle on one side and both ends of the way on the other. A way that needs no push
 * crosses nothing. So what begins beside a triangle never ends behind it. Where several meshes move,
 * each may put a particle behind another: that is looked at twice more; then free bodies that take part are
 * stopped and all is done again, then reported. */
#include "rt/stage/solids.h"
#include "rt/stage/stage.h"

enum { MARGIN = 64 }; /* steps of position: more than the errors of a normal over the world's width */

static void keep(int32_t *restrict to, const int32_t *restrict from, uint32_t count) {
  for (uint32_t p = 0; p < count; ++p) to[p] = from[p];
}

void meshes_begin(fray_world *w) {
  if (!world_has_meshes(w)) return;
  w->contact_count = w->gathered;
  keep(w->sx, w->x, w->particles);
  keep(w->sy, w->y, w->particles);
  keep(w->sz, w->z, w->particles);
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    w->stood[b] = mesh_vec(w->body_states[b].position);
}

typedef struct {
  int32_t begin, end;
} gaps;

static gaps gaps_of(const solid *t, uint32_t face, const sweep_point *way) {
  const gaps g = {solid_gap(t, face, way->begin), solid_gap(t, face, way->end)};
  return g;
}
/* Both ends are at least so far on one side of the triangle's plane. */
static int is_clear(gaps g, int32_t least) {
  return (g.begin >= least && g.end >= least) || (g.begin <= -least && g.end <= -least);
}

/* Out of the triangle, where it was met; inside of it the normal is known better. */
static vec3 way_out(const solid *t, uint32_t face, const sweep_point *way, const sweep_contact *c) {
  const int inside = c->at[0] > 0 && c->at[1] > 0 && c->at[0] + c->at[1] < SWEEP_ONE;
  if (!inside) return vec_make(-c->normal.x, -c->normal.y, -c->normal.z);
  const vec3 normal = mesh_vec(t->m.faces[face].normal);
  return solid_gap(t, face, way->begin) >= 0 ? normal : vec_make(-normal.x, -normal.y, -normal.z);
}

static vec3 part_of(vec3 a, vec3 b, int32_t share) {
  return vec_make((int32_t)fx_round64(fx_mul_wide(fx_sub(b.x, a.x), share), 15),
                  (int32_t)fx_round64(fx_mul_wide(fx_sub(b.y, a.y), share), 15),
                  (int32_t)fx_round64(fx_mul_wide(fx_sub(b.z, a.z), share), 15));
}

/* How far the way's end is short of the thickness. */
static int32_t depth_of(const solid *t, uint32_t face, vec3 end, const sweep_contact *c, vec3 out,
                        int32_t skin) {
  const vec3 a = mesh_corner(&t->m, face, 0);
  const vec3 met = vec_add(vec_add(a, part_of(a, mesh_corner(&t->m, face, 1), c->at[0])),
                           part_of(a, mesh_corner(&t->m, face, 2), c->at[1]));
  return (int32_t)fx_clamp64((int64_t)skin - vec_dot_unit(vec_sub(end, met), out), -FX_LU, FX_WORLD_MAX);
}

typedef struct {
  int32_t time, depth;
  vec3 out;
} push;

/* Q30 and Q24 to Q24. */
static int32_t minor_unit(int32_t ax, int32_t ay, int32_t bx, int32_t by) {
  return (int32_t)fx_asr64(fx_add64(fx_mul_wide(ax, by), -fx_mul_wide(ay, bx)), 30);
}
static int64_t dot_wide(vec3 a, vec3 b) {
  return fx_add64(fx_add64(fx_mul_wide(a.x, b.x), fx_mul_wide(a.y, b.y)), fx_mul_wide(a.z, b.z));
}

typedef enum { OVER, BESIDE, NEAR } whereabouts;

/* Both ends of the way are over the triangle, on the inner side of its three sides; or both are farther
 * than `skin` beyond one of them; by more than rounding. */
static whereabouts where_is(const solid *t, uint32_t face, const sweep_point *way, int32_t skin) {
  const vec3 n = mesh_vec(t->m.faces[face].normal);
  const int64_t rounding = (int64_t)1 << 32;
  whereabouts found = OVER;
  for (uint32_t k = 0; k < 3; ++k) {
    const vec3 a = mesh_corner(&t->m, face, k);
    const vec3 e = vec_sub(mesh_corner(&t->m, face, (k + 1u) % 3u), a);
    const vec3 inward = vec_make(minor_unit(n.y, n.z, e.y, e.z), minor_unit(n.z, n.x, e.z, e.x),
                                 minor_unit(n.x, n.y, e.x, e.y)); /* as long as the side */
    const int64_t begin = dot_wide(inward, vec_sub(way->begin, a));
    const int64_t end = dot_wide(inward, vec_sub(way->end, a));
    const int64_t longest = (int64_t)fx_magnitude(e.x) + fx_magnitude(e.y) + fx_magnitude(e.z);
    const int64_t most = -(longest * (skin + MARGIN)) - rounding;
    if (begin < most && end < most) return BESIDE;
    if (begin < rounding || end < rounding) found = NEAR;
  }
  return found;
}

/* The push out of a triangle over which both ends of the way are, without a sweep. */
static push push_up(const solid *t, uint32_t face, gaps g, int32_t skin) {
  const vec3 n = mesh_vec(t->m.faces[face].normal);
  const int above = g.begin >= 0;
  const int64_t begin = above ? g.begin : -(int64_t)g.begin;
  const int64_t end = above ? g.end : -(int64_t)g.end;
  push p = {0, (int32_t)fx_clamp64(skin - end, 0, FX_WORLD_MAX), n};
  if (!above) p.out = vec_make(-n.x, -n.y, -n.z);
  if (begin > skin && end < begin) p.time = (int32_t)((begin - skin) * SWEEP_ONE / (begin - end));
  return p;
}

/* The push out of one triangle, its depth at most SOLID_DEPTH_LEAST where the way's end is out of it. */
__attribute__((noinline)) static push push_from(fray_world *w, const solid *t, uint32_t face, const sweep_point *way) {
  const int32_t skin = solid_skin(w);
  const gaps g = gaps_of(t, face, way);
  push p = {0, 0, {0, 0, 0}};
  sweep_contact c;
  if (is_clear(g, skin - SOLID_DEPTH_LEAST)) return p;
  const whereabouts at = where_is(t, face, way, skin);
  if (at == OVER) return push_up(t, face, g, skin);
  if (at == BESIDE || !solid_meets(w, t, face, way, skin, &c)) return p;
  p.time = c.time;
  p.out = way_out(t, face, way, &c);
  p.depth = depth_of(t, face, way->end, &c, p.out, skin);
  return p;
}

/* The first triangle that the way meets and its end is not out of; of several at once the deepest. */
static push first_push(fray_world *w, const solid *t, const solid_near *near, const sweep_point *way) {
  push first = {SWEEP_ONE + 1, 0, {0, 0, 0}};
  for (uint32_t n = 0; n < near->count; ++n) {
    const push p = push_from(w, t, near->face[n], way);
    if (p.depth <= SOLID_DEPTH_LEAST || p.time > first.time ||
        (p.time == first.time && p.depth <= first.depth))
      continue;
    first = p;
  }
  return first;
}

/* Pushes the way's end out. Returns 1 and the last push, its depth the sum of all, or 0. */
static int repel(fray_world *w, const solid *t, const solid_near *near, sweep_point *way, push *last) {
  int64_t sum = 0;
  for (uint32_t round = 0; round < MESH_ROUNDS; ++round) {
    const push p = first_push(w, t, near, way);
    if (p.depth == 0) break;
    way->end = solid_pushed(way->end, p.out, p.depth);
    sum += p.depth;
    last->out = p.out;
  }
  last->depth = (int32_t)fx_clamp64(sum, 0, FX_WORLD_MAX);
  return sum != 0;
}

/* Coulomb's law, as a displacement: it takes back what slides beside the mesh, up to its share. */
static void rub(const fray_world *w, const solid *t, sweep_point *way, const push *last) {
  const vec3 moved = vec_sub(way->end, way->begin);
  const uint32_t least = fx_magnitude(moved.x) | fx_magnitude(moved.y) | fx_magnitude(moved.z);
  if (least >= (uint32_t)SOLID_SLIDE_MOST) return;
  const vec3 slip = vec_sub(moved, vec_scale_unit(last->out, vec_dot_unit(moved, last->out)));
  const int64_t most = fx_mul_wide(last->depth, w->bodies[t->body].friction) >> 16;
  way->end = vec_sub(way->end, vec_limited(slip, (int32_t)fx_clamp64(most, 0, FX_WORLD_MAX)));
}

/* A particle whose way comes near the mesh's box. */
__attribute__((noinline)) static void answer(fray_world *w, const solid *t, uint32_t p, sweep_point way) {
  const sweep_point wanted = way;
  solid_near near;
  push last;
  const solid_span s = solid_span_of(&way, 1, solid_skin(w));
  solid_list_near(w, t, &s, MESH_NEAR, &near);
  if (near.count == SOLID_TOO_MANY) {
    w->state->faults |= (int32_t)FRAY_FAULT_CROWDED;
    solid_stand(w, t, p, &wanted);
    return;
  }
  if (!repel(w, t, &near, &way, &last)) return;
  rub(w, t, &way, &last);
  /* where its end has not left the span, the list still has all that it may touch */
  int stands = solid_holds(&s, way.end) ? !solid_stays(&way) && solid_crosses_near(w, t, &near, &way)
                                        : solid_crosses(w, t, &way);
  if (!stands && !solid_add_contact(w, t, p, last.out)) {
    w->state->faults |= (int32_t)FRAY_FAULT_CONTACTS_FULL;
    stands = 1;
  }
  if (stands)
    solid_stand(w, t, p, &wanted);
  else
    solid_place(w, t, p, way.end);
}

/* Balls push particles out of where they are (collide.c): one that a fast ball has gone past is brought back
 * to the side that it came from. */
static void answer_ball(fray_world *w, const solid *t, uint32_t p, sweep_point way) {
  const sweep_point middle = {{0, 0, 0}, {0, 0, 0}};
  const sweep_point corners[3] = {middle, middle, middle};
  const vec3 moved = vec_sub(way.end, way.begin);
  sweep_contact c;
  if ((fx_magnitude(moved.x) | fx_magnitude(moved.y) | fx_magnitude(moved.z)) < (uint32_t)t->radius / 4)
    return;
  ++w->work.mesh_sweeps;
  if (!sweep_point_triangle(&way, corners, t->radius, &c)) return;
  const vec3 out = vec_make(-c.normal.x, -c.normal.y, -c.normal.z);
  const int64_t depth = (int64_t)t->radius + solid_skin(w) - vec_dot_unit(way.end, out);
  if (depth <= SOLID_DEPTH_LEAST) return;
  solid_place(w, t, p, solid_pushed(way.end, out, (int32_t)fx_clamp64(depth, 0, FX_WORLD_MAX)));
}

/* Calls for every particle whose way comes near the body; as many as there are contacts, others stand. */
static void repel_all(fray_world *w, const solid *t, uint32_t *left) {
  const uint32_t end = w->particles;
  const uint32_t held = (uint32_t)w->params->held;
  const int32_t skin = solid_skin(w);
  for (uint32_t p = 0; p < end; ++p) {
    const sweep_point way = solid_way(w, t, p);
    w->aside[p] = solid_passes(w, t, p) ? (uint8_t)SOLID_SIDES : solid_sides(t, &way, skin);
    if (w->aside[p] != 0 || p < held) continue;
    if (*left == 0 || solid_is_far(way.begin) || solid_is_far(way.end)) {
      w->state->faults |=
          (int32_t)(*left == 0 ? FRAY_FAULT_CONTACTS_FULL : FRAY_FAULT_LEFT_WORLD);
      solid_stand(w, t, p, &way);
      continue;
    }
    --*left;
    if (t->radius == 0)
      answer(w, t, p, way);
    else
      answer_ball(w, t, p, way);
  }
  w->work.mesh_tests += end;
}

/* What another body did may lead through this one. Returns how many stand for it. */
static uint32_t look(fray_world *w, const solid *t, uint32_t *left) {
  const uint32_t end = w->particles;
  const uint32_t held = (uint32_t)w->params->held;
  uint32_t stands = 0;
  for (uint32_t p = 0; p < end; ++p) {
    const sweep_point way = solid_way(w, t, p);
    w->aside[p] = solid_passes(w, t, p) ? (uint8_t)SOLID_SIDES : solid_sides(t, &way, 0);
    if (w->aside[p] != 0 || p < held || t->radius != 0 || solid_stays(&way)) continue;
    const int unknown = *left == 0 || solid_is_far(way.begin) || solid_is_far(way.end);
    if (!unknown) --*left;
    if (!unknown && !solid_crosses(w, t, &way)) continue;
    solid_stand(w, t, p, &way);
    ++stands;
  }
  w->work.mesh_tests += end;
  return stands;
}

/* Bodies for which something stands in a look, or that met what another one holds: a bit each. */
typedef struct {
  uint32_t bodies;
  uint32_t holder; /* of vertices that would have to give way, or PRESS_FREE */
} jam;

/* A free body goes back to where it stood, and what it has left of momentum to `other`. */
static void stop_body(fray_world *w, const solid *t, uint32_t other) {
  body_state *s = &w->body_states[t->body];
  body_motion *m = &w->motion[t->body];
  const int64_t most = (int64_t)1 << 48;
  const int32_t yield = fx_max(1, w->bodies[t->body].yield);
  for (uint32_t n = 0; n < 3; ++n) {
    const int64_t had = fx_clamp64(((int64_t)s->velocity[n] * (1 << 30)) / yield, -most, most);
    const int64_t left = fx_add64(had, -fx_add64(m->impulse[n], -m->settled[n]));
    m->impulse[n] = fx_add64(m->impulse[n], left);
    m->settled[n] = m->impulse[n];
    if (other != PRESS_FREE) w->motion[other].impulse[n] = fx_add64(w->motion[other].impulse[n], -left);
    s->velocity[n] = 0;
  }
  s->position[0] = t->before.x;
  s->position[1] = t->before.y;
  s->position[2] = t->before.z;
  m->moved = vec_make(0, 0, 0);
}

__attribute__((noinline)) static void push_off(fray_world *w, uint32_t n, uint32_t left[3], jam *found) {
  const solid t = solid_at(w, n);
  repel_all(w, &t, &left[0]);
  const uint32_t holder = mesh_is_whole(w) ? press_run(w, &t, &left[1]) : (uint32_t)PRESS_FREE;
  if (holder == PRESS_FREE) return;
  found->bodies |= 1u << n;
  found->holder = holder;
}

__attribute__((noinline)) static uint32_t look_again(fray_world *w, uint32_t n, uint32_t left[2], jam *found) {
  const solid t = solid_at(w, n);
  uint32_t holder = PRESS_FREE;
  uint32_t stands = look(w, &t, &left[0]);
  if (mesh_is_whole(w)) stands += press_look(w, &t, &left[1], &holder);
  if (holder != PRESS_FREE) found->holder = holder;
  if (stands != 0 || holder != PRESS_FREE) found->bodies |= 1u << n;
  return stands;
}

/* Whether it ended: nothing had to give way that cannot. */
static int keep_apart(fray_world *w, jam *found) {
  const uint32_t most = w->capacity[POOL_CONTACTS];
  const uint32_t count = mesh_solids(w);
  uint32_t stands = 0;
  uint32_t left[3] = {most, most, most};
  found->bodies = 0;
  found->holder = PRESS_FREE;
  for (uint32_t n = 0; n < count; ++n) push_off(w, n, left, found);
  for (uint32_t round = 0; round < mesh_looks(w); ++round) {
    stands = 0;
    left[0] = left[1] = most;
    for (uint32_t n = 0; n < count; ++n) stands += look_again(w, n, left, found);
    if (stands == 0) break;
  }
  return stands == 0 && found->holder == PRESS_FREE;
}

uint32_t meshes_look(fray_world *w) {
  uint32_t stands = 0;
  uint32_t left[2] = {w->capacity[POOL_CONTACTS], w->capacity[POOL_CONTACTS]};
  jam found = {0, PRESS_FREE};
  for (uint32_t n = 0; n < mesh_solids(w); ++n) stands += look_again(w, n, left, &found);
  if (found.holder != PRESS_FREE) w->state->faults |= (int32_t)FRAY_FAULT_JAMMED;
  return stands;
}

/* Who takes the momentum: who holds what does not give way, else a body that is not free. */
static uint32_t other_of(const fray_world *w, const jam *found) {
  if (found->holder != PRESS_FREE) return found->holder;
  for (uint32_t n = 0; n < mesh_solids(w); ++n) {
    const solid t = solid_at(w, n);
    if ((found->bodies >> n & 1u) != 0 && w->bodies[t.body].motion != FRAY_FREE) return t.body;
  }
  return PRESS_FREE;
}

/* Returns whether one was stopped. */
__attribute__((noinline)) static int stop_bodies(fray_world *w, const jam *found) {
  int stopped = 0;
  for (uint32_t n = 0; n < mesh_solids(w); ++n) {
    const solid t = solid_at(w, n);
    if ((found->bodies >> n & 1u) == 0 || w->bodies[t.body].motion != FRAY_FREE) continue;
    stop_body(w, &t, other_of(w, found));
    stopped = 1;
  }
  return stopped;
}

/* What lies between bodies that do not move keeps its place. Returns whether they all stand still. */
__attribute__((noinline)) static int stand_between(fray_world *w, const jam *found) {
  int still = 1;
  for (uint32_t n = 0; n < mesh_solids(w); ++n) {
    const solid t = solid_at(w, n);
    if ((found->bodies >> n & 1u) == 0) continue;
    press_stand(w, &t);
    still = still && t.before.x == t.now.x && t.before.y == t.now.y && t.before.z == t.now.z;
  }
  return still;
}

void meshes_run(fray_world *w) {
  const uint32_t contacts = w->contact_count;
  jam found;
  if (!world_has_meshes(w) || keep_apart(w, &found)) return;
  if (mesh_is_whole(w) && stop_bodies(w, &found)) {
    w->contact_count = contacts;
    if (keep_apart(w, &found) || (found.holder == PRESS_FREE && stand_between(w, &found))) return;
  }
  w->state->faults |= (int32_t)FRAY_FAULT_JAMMED;
}
