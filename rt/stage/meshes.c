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
 * each may put a particle behind another: that is looked at twice more, then reported. */
#include "rt/base/sweep.h"
#include "rt/model/couples.h"
#include "rt/model/mesh.h"
#include "rt/stage/stage.h"

enum {
  PLANE_MARGIN = 64, /* steps of position: more than the errors of a normal over the world's width */
  DEPTH_LEAST = 4,   /* what rounding leaves of a push */
  SKIN_LEAST = 1024, /* of cloth without thickness: nothing may touch */
  SLIDE_MOST = 16 * FX_LU,
  NEAR_TOO_MANY = MESH_NEAR + 1
};

/* A mesh in this substep. */
typedef struct {
  uint32_t body;
  mesh_parts m;
  vec3 before, now; /* where it stood and stands */
} target;

typedef struct {
  uint32_t count;
  uint16_t face[MESH_NEAR];
} near_list;

typedef struct {
  int32_t low[3], high[3];
} span;

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

static int32_t skin_of(const fray_world *w) { return fx_max(w->params->thickness, SKIN_LEAST); }

static target target_of(const fray_world *w, uint32_t n) {
  target t;
  t.m = mesh_at(w, n);
  t.body = (uint32_t)t.m.of->body;
  t.before = w->stood[t.body];
  t.now = mesh_vec(w->body_states[t.body].position);
  return t;
}

static sweep_point way_of(const fray_world *w, const target *t, uint32_t p) {
  const sweep_point way = {vec_sub(vec_make(w->sx[p], w->sy[p], w->sz[p]), t->before),
                           vec_sub(world_position(w, p), t->now)};
  return way;
}
/* Goes nowhere beside the mesh. */
static int stays(const sweep_point *way) {
  return way->begin.x == way->end.x && way->begin.y == way->end.y && way->begin.z == way->end.z;
}
static span span_of(const sweep_point *way, int32_t skin) {
  const vec3 a = way->begin;
  const vec3 b = way->end;
  const span s = {{fx_min(a.x, b.x) - skin, fx_min(a.y, b.y) - skin, fx_min(a.z, b.z) - skin},
                  {fx_max(a.x, b.x) + skin, fx_max(a.y, b.y) + skin, fx_max(a.z, b.z) + skin}};
  return s;
}
static inline int overlap(const span *s, const mesh_box *b) {
  return s->low[0] <= b->high[0] && s->high[0] >= b->low[0] && s->low[1] <= b->high[1] &&
         s->high[1] >= b->low[1] && s->low[2] <= b->high[2] && s->high[2] >= b->low[2];
}
static int holds(const span *s, vec3 v) {
  return v.x >= s->low[0] && v.x <= s->high[0] && v.y >= s->low[1] && v.y <= s->high[1] &&
         v.z >= s->low[2] && v.z <= s->high[2];
}
/* Differences go to 122 lu, sweeps to 60; meshes to 16, so what is farther off moves absurdly fast. */
static int is_far(vec3 v) {
  return v.x < -FX_WORLD_MAX || v.x > FX_WORLD_MAX || v.y < -FX_WORLD_MAX || v.y > FX_WORLD_MAX ||
         v.z < -FX_WORLD_MAX || v.z > FX_WORLD_MAX;
}

/* The triangles whose boxes the span overlaps; count NEAR_TOO_MANY where they or the boxes are more
 * than one is held against. */
static void list_near(fray_world *w, const target *t, const span *s, near_list *near) {
  const uint32_t end = t->m.box_count;
  uint32_t visits = 0;
  uint32_t n = 0;
  near->count = 0;
  while (n < end && visits < MESH_VISITS && near->count != NEAR_TOO_MANY) {
    const mesh_box *b = &t->m.boxes[n];
    ++visits;
    if (!overlap(s, b)) {
      n = (uint32_t)b->next;
      continue;
    }
    ++n;
    if (b->face == MESH_NONE) continue;
    if (near->count < MESH_NEAR) near->face[near->count] = (uint16_t)b->face;
    ++near->count;
  }
  if (n < end) near->count = NEAR_TOO_MANY;
  w->work.mesh_boxes += visits;
}

static int32_t gap_to_plane(const target *t, uint32_t face, vec3 at) {
  return vec_dot_unit(vec_sub(at, mesh_corner(&t->m, face, 0)), mesh_vec(t->m.faces[face].normal));
}

typedef struct {
  int32_t begin, end;
} gaps;

static gaps gaps_of(const target *t, uint32_t face, const sweep_point *way) {
  const gaps g = {gap_to_plane(t, face, way->begin), gap_to_plane(t, face, way->end)};
  return g;
}
/* Both ends are at least so far on one side of the triangle's plane. */
static int is_clear(gaps g, int32_t least) {
  return (g.begin >= least && g.end >= least) || (g.begin <= -least && g.end <= -least);
}

static int meets(fray_world *w, const target *t, uint32_t face, const sweep_point *way, int32_t skin,
                 sweep_contact *c) {
  sweep_point corners[3];
  for (uint32_t k = 0; k < 3; ++k)
    corners[k].begin = corners[k].end = mesh_corner(&t->m, face, k);
  ++w->work.mesh_sweeps;
  return sweep_point_triangle(way, corners, skin, c);
}

/* Out of the triangle, where it was met; inside of it the normal is known better. */
static vec3 way_out(const target *t, uint32_t face, const sweep_point *way, const sweep_contact *c) {
  const int inside = c->at[0] > 0 && c->at[1] > 0 && c->at[0] + c->at[1] < SWEEP_ONE;
  if (!inside) return vec_make(-c->normal.x, -c->normal.y, -c->normal.z);
  const vec3 normal = mesh_vec(t->m.faces[face].normal);
  return gap_to_plane(t, face, way->begin) >= 0 ? normal : vec_make(-normal.x, -normal.y, -normal.z);
}

static vec3 part_of(vec3 a, vec3 b, int32_t share) {
  return vec_make((int32_t)fx_round64(fx_mul_wide(fx_sub(b.x, a.x), share), 15),
                  (int32_t)fx_round64(fx_mul_wide(fx_sub(b.y, a.y), share), 15),
                  (int32_t)fx_round64(fx_mul_wide(fx_sub(b.z, a.z), share), 15));
}

/* How far the way's end is short of the thickness. */
static int32_t depth_of(const target *t, uint32_t face, vec3 end, const sweep_contact *c, vec3 out,
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
static whereabouts where_is(const target *t, uint32_t face, const sweep_point *way, int32_t skin) {
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
    const int64_t most = -(longest * (skin + PLANE_MARGIN)) - rounding;
    if (begin < most && end < most) return BESIDE;
    if (begin < rounding || end < rounding) found = NEAR;
  }
  return found;
}

/* The push out of a triangle over which both ends of the way are, without a sweep. */
static push push_up(const target *t, uint32_t face, gaps g, int32_t skin) {
  const vec3 n = mesh_vec(t->m.faces[face].normal);
  const int above = g.begin >= 0;
  const int64_t begin = above ? g.begin : -(int64_t)g.begin;
  const int64_t end = above ? g.end : -(int64_t)g.end;
  push p = {0, (int32_t)fx_clamp64(skin - end, 0, FX_WORLD_MAX), n};
  if (!above) p.out = vec_make(-n.x, -n.y, -n.z);
  if (begin > skin && end < begin) p.time = (int32_t)((begin - skin) * SWEEP_ONE / (begin - end));
  return p;
}

/* The push out of one triangle, its depth at most DEPTH_LEAST where the way's end is out of it. */
__attribute__((noinline)) static push push_from(fray_world *w, const target *t, uint32_t face, const sweep_point *way) {
  const int32_t skin = skin_of(w);
  const gaps g = gaps_of(t, face, way);
  push p = {0, 0, {0, 0, 0}};
  sweep_contact c;
  if (is_clear(g, skin - DEPTH_LEAST)) return p;
  const whereabouts at = where_is(t, face, way, skin);
  if (at == OVER) return push_up(t, face, g, skin);
  if (at == BESIDE || !meets(w, t, face, way, skin, &c)) return p;
  p.time = c.time;
  p.out = way_out(t, face, way, &c);
  p.depth = depth_of(t, face, way->end, &c, p.out, skin);
  return p;
}

/* The first triangle that the way meets and its end is not out of; of several at once the deepest. */
static push first_push(fray_world *w, const target *t, const near_list *near, const sweep_point *way) {
  push first = {SWEEP_ONE + 1, 0, {0, 0, 0}};
  for (uint32_t n = 0; n < near->count; ++n) {
    const push p = push_from(w, t, near->face[n], way);
    if (p.depth <= DEPTH_LEAST || p.time > first.time ||
        (p.time == first.time && p.depth <= first.depth))
      continue;
    first = p;
  }
  return first;
}

static vec3 pushed(vec3 at, vec3 out, int32_t depth) {
  const vec3 by = vec_scale_unit(out, depth);
  return vec_make(fx_clamp(fx_saturate((int64_t)at.x + by.x), -FX_WORLD_MAX, FX_WORLD_MAX),
                  fx_clamp(fx_saturate((int64_t)at.y + by.y), -FX_WORLD_MAX, FX_WORLD_MAX),
                  fx_clamp(fx_saturate((int64_t)at.z + by.z), -FX_WORLD_MAX, FX_WORLD_MAX));
}

/* Pushes the way's end out. Returns 1 and the last push, its depth the sum of all, or 0. */
static int repel(fray_world *w, const target *t, const near_list *near, sweep_point *way, push *last) {
  int64_t sum = 0;
  for (uint32_t round = 0; round < MESH_ROUNDS; ++round) {
    const push p = first_push(w, t, near, way);
    if (p.depth == 0) break;
    way->end = pushed(way->end, p.out, p.depth);
    sum += p.depth;
    last->out = p.out;
  }
  last->depth = (int32_t)fx_clamp64(sum, 0, FX_WORLD_MAX);
  return sum != 0;
}

/* Coulomb's law, as a displacement: it takes back what slides beside the mesh, up to its share. */
static void rub(const fray_world *w, const target *t, sweep_point *way, const push *last) {
  const vec3 moved = vec_sub(way->end, way->begin);
  const uint32_t least = fx_magnitude(moved.x) | fx_magnitude(moved.y) | fx_magnitude(moved.z);
  if (least >= (uint32_t)SLIDE_MOST) return;
  const vec3 slip = vec_sub(moved, vec_scale_unit(last->out, vec_dot_unit(moved, last->out)));
  const int64_t most = fx_mul_wide(last->depth, w->bodies[t->body].friction) >> 16;
  way->end = vec_sub(way->end, vec_limited(slip, (int32_t)fx_clamp64(most, 0, FX_WORLD_MAX)));
}

/* Whether the way touches one of the triangles. */
static int crosses_near(fray_world *w, const target *t, const near_list *near, const sweep_point *way) {
  sweep_contact c;
  for (uint32_t n = 0; n < near->count; ++n)
    if (!is_clear(gaps_of(t, near->face[n], way), PLANE_MARGIN) &&
        meets(w, t, near->face[n], way, 0, &c))
      return 1;
  return 0;
}

/* Whether the way touches the mesh, or may. */
static int crosses(fray_world *w, const target *t, const sweep_point *way) {
  near_list near;
  const span s = span_of(way, 0);
  if (stays(way)) return 0;
  list_near(w, t, &s, &near);
  return near.count == NEAR_TOO_MANY || crosses_near(w, t, &near, way);
}

static int32_t within_world(fray_world *w, int64_t v) {
  const int32_t held = (int32_t)fx_clamp64(v, -FX_WORLD_MAX, FX_WORLD_MAX);
  if (held != v) w->state->faults |= (int32_t)FRAY_FAULT_LEFT_WORLD;
  return held;
}

/* Moves a particle to a place beside the mesh; the body gets what the cloth gains. */
static void place(fray_world *w, const target *t, uint32_t p, vec3 beside) {
  const vec3 was = world_position(w, p);
  w->x[p] = within_world(w, (int64_t)beside.x + t->now.x);
  w->y[p] = within_world(w, (int64_t)beside.y + t->now.y);
  w->z[p] = within_world(w, (int64_t)beside.z + t->now.z);
  const int light = world_has_yarns(w) && couple_is_light(w, p);
  const int64_t mass = light ? 1 << (FX_SUB_BITS - 1) : 1 << FX_SUB_BITS;
  body_gave(&w->motion[t->body], ((int64_t)w->x[p] - was.x) * mass, ((int64_t)w->y[p] - was.y) * mass,
            ((int64_t)w->z[p] - was.z) * mass);
}

static void stand(fray_world *w, const target *t, uint32_t p, const sweep_point *way) {
  ++w->work.mesh_stops;
  place(w, t, p, way->begin);
}

static int add_contact(fray_world *w, const target *t, uint32_t p, vec3 out) {
  if (w->contact_count == w->capacity[POOL_CONTACTS]) {
    w->state->faults |= (int32_t)FRAY_FAULT_CONTACTS_FULL;
    return 0;
  }
  contact *c = &w->contacts[w->contact_count++];
  c->particle = p;
  c->body = (uint16_t)t->body;
  c->touching = 1;
  c->normal = out;
  return 1;
}

/* A particle whose way comes near the mesh's box. */
__attribute__((noinline)) static void answer(fray_world *w, const target *t, uint32_t p, sweep_point way) {
  const sweep_point wanted = way;
  near_list near;
  push last;
  const span s = span_of(&way, skin_of(w));
  list_near(w, t, &s, &near);
  if (near.count == NEAR_TOO_MANY) {
    w->state->faults |= (int32_t)FRAY_FAULT_CROWDED;
    stand(w, t, p, &wanted);
    return;
  }
  if (!repel(w, t, &near, &way, &last)) return;
  rub(w, t, &way, &last);
  /* where its end has not left the span, the list still has all that it may touch */
  const int across = holds(&s, way.end) ? !stays(&way) && crosses_near(w, t, &near, &way)
                                        : crosses(w, t, &way);
  if (across || !add_contact(w, t, p, last.out))
    stand(w, t, p, &wanted);
  else
    place(w, t, p, way.end);
}

/* Calls for every particle whose way comes near the mesh; as many as there are contacts, others stand. */
static void repel_all(fray_world *w, const target *t, uint32_t *left) {
  const uint32_t end = w->particles;
  const int32_t skin = skin_of(w);
  for (uint32_t p = (uint32_t)w->params->held; p < end; ++p) {
    const sweep_point way = way_of(w, t, p);
    const span s = span_of(&way, skin);
    if (!overlap(&s, &t->m.boxes[0])) continue;
    if (*left == 0 || is_far(way.begin) || is_far(way.end)) {
      w->state->faults |=
          (int32_t)(*left == 0 ? FRAY_FAULT_CONTACTS_FULL : FRAY_FAULT_LEFT_WORLD);
      stand(w, t, p, &way);
      continue;
    }
    --*left;
    answer(w, t, p, way);
  }
  w->work.mesh_tests += end - (uint32_t)w->params->held;
}

/* What another mesh did may lead through this one. Returns how many stand for it. */
static uint32_t look(fray_world *w, const target *t, uint32_t *left) {
  const uint32_t end = w->particles;
  uint32_t stands = 0;
  for (uint32_t p = (uint32_t)w->params->held; p < end; ++p) {
    const sweep_point way = way_of(w, t, p);
    const span s = span_of(&way, 0);
    if (!overlap(&s, &t->m.boxes[0])) continue;
    if (stays(&way)) continue;
    const int unknown = *left == 0 || is_far(way.begin) || is_far(way.end);
    if (!unknown) --*left;
    if (!unknown && !crosses(w, t, &way)) continue;
    stand(w, t, p, &way);
    ++stands;
  }
  w->work.mesh_tests += end - (uint32_t)w->params->held;
  return stands;
}

void meshes_run(fray_world *w) {
  const uint32_t count = mesh_count(w);
  uint32_t left = w->capacity[POOL_CONTACTS];
  for (uint32_t n = 0; n < count; ++n) {
    const target t = target_of(w, n);
    repel_all(w, &t, &left);
  }
  for (uint32_t round = 0; round < mesh_looks(w); ++round) {
    uint32_t stands = 0;
    left = w->capacity[POOL_CONTACTS];
    for (uint32_t n = 0; n < count; ++n) {
      const target t = target_of(w, n);
      stands += look(w, &t, &left);
    }
    if (stands == 0) return;
    if (round + 1u == MESH_LOOKS) w->state->faults |= (int32_t)FRAY_FAULT_JAMMED;
  }
}
