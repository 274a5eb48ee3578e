/* SPDX-License-Identifier: Apache-2.0 */
/* Sharp points and edges of rigid meshes cut the membrane (Karaoz 2015, section 3.3), once a tick, after the
 * tears and before all contacts, as cut cloth does not collide with the blade:
 *
 *   sharp edge    hits an edge of a triangle: that is divided there, and the cloth opened to both sides along
 *                 the line in which the plane of the blade's motion in this tick intersects it
 *   sharp point   hits a triangle: that becomes three, with open edges between them
 *
 * They hit where, on their paths of this tick, they come within the cloth's thickness of each other, and cut
 * if they approach at least at the material's speed. Speed is the "impact power" here: it is the same at any
 * tick length and on any mesh, where an impulse is not. Only the first hit of a triangle cuts. A hit that is
 * too slow, or a cut that is impossible, is a contact (contact/contact_triangles.c), under which the cloth
 * may tear.
 *
 * The triangles around a cut are marked as passing a blade (TRIMESH_PASSING_BLADE, a bit of the state):
 * blades go through them, and do not cut them again, until they are outside the boxes of all sharp meshes. A
 * vertex passes if all of its triangles do. */
#include "rt/contact/collider_triangle.h"
#include "rt/geometry/closest_point.h"
#include "rt/membrane/membrane.h"
#include "rt/trimesh/trimesh_split.h"

enum { UNIT_BITS = 30, NARROW_BITS = 14, DIRECTION_MIN = 1 << 16 };

/* A triangle of the membrane and a blade, on their paths of this tick. */
typedef struct {
  uint32_t triangle;
  collider_triangle_query q;
  int32_t min_speed; /* of approach, at which the blade cuts */
} blade_query;

/* The first hit of a triangle. */
typedef struct {
  int32_t time;      /* Q15 of the tick; above CCD_ONE: none */
  uint32_t corner;   /* the first of the edge that is hit; 3: the triangle itself */
  int32_t weight[2]; /* Q15: edge: of both ends of the blade's edge and of it; triangle: of corners 1 and 2 */
  vec3 edge;         /* of the blade; 0: a point */
  vec3 travel;       /* of the cloth there, relative to the blade */
} blade_hit;

/* ---- paths of a tick ---- */

/* Where a vertex would be at the end of this tick. */
static vec3 tick_end(const fray_world *w, uint32_t p) {
  return vec_at(w->p.tick_end[0], w->p.tick_end[1], w->p.tick_end[2], p);
}

static int32_t predict(int32_t x, int32_t v, int32_t substeps) {
  return fx_clamp_wide(x + fx_asr64(fx_mul_wide(v, substeps), FX_SUB_BITS), FX_WORLD_MAX);
}

static void predict_tick_ends(fray_world *w) {
  int32_t *const *ends = w->p.tick_end;
  const int32_t substeps = w->params->substeps;
  for (uint32_t p = 0; p < w->p.count; ++p) {
    ends[0][p] = predict(w->p.x[p], w->p.vx[p], substeps);
    ends[1][p] = predict(w->p.y[p], w->p.vy[p], substeps);
    ends[2][p] = predict(w->p.z[p], w->p.vz[p], substeps);
  }
}

static ccd_path tick_path(const fray_world *w, const collider *blade, uint32_t p) {
  const ccd_path path = {vec_sub(world_position(w, p), blade->start), vec_sub(tick_end(w, p), blade->now)};
  return path;
}

/* On its path of the whole tick; that of a free body is predicted, and ends in the world. */
static collider blade_at(const fray_world *w, uint32_t n) {
  FRAY_ASSERT(n < collider_count(w));
  collider blade = collider_at(w, n);
  const body_motion *m = &w->rigid.motion[blade.body];
  const int32_t *v = w->rigid.states[blade.body].velocity;
  const int32_t substeps = w->params->substeps;
  blade.start = m->from;
  blade.now = m->to;
  if (w->rigid.bodies[blade.body].motion == FRAY_FREE)
    blade.now = vec_make(predict(m->from.x, v[0], substeps), predict(m->from.y, v[1], substeps),
                         predict(m->from.z, v[2], substeps));
  return blade;
}

/* Which sides of the blade's box the paths of vertices stay on: collider_misses() asks. */
static void update_side_masks(fray_world *w, const collider *blade, uint32_t first) {
  const int32_t skin = collider_skin(w);
  for (uint32_t p = first; p < w->p.count; ++p) {
    const ccd_path path = tick_path(w, blade, p);
    w->contact.side_mask[p] = collider_sides(blade, &path, skin);
  }
  w->work.mesh_tests += w->p.count - first;
}

static int is_sharp(const fray_world *w, uint32_t n) { return (w->rigid.sharp_meshes >> n & 1u) != 0; }

/* ---- passing blades ---- */

/* Triangles that no sharp mesh is near any more stop passing. */
static void stop_passing(fray_world *w) {
  const trimesh *s = &w->trimesh;
  const uint32_t triangles = triangles_in_use(w);
  uint8_t *near = w->membrane.near_blade;
  uint32_t passing = 0;
  for (uint32_t t = 0; t < triangles; ++t) {
    near[t] = 0;
    passing |= (uint32_t)trimesh_is_passing_blade(s, t);
  }
  if (passing == 0) return;
  for (uint32_t n = 0; n < rigid_mesh_count(w); ++n) {
    if (!is_sharp(w, n)) continue;
    const collider blade = blade_at(w, n);
    update_side_masks(w, &blade, 0);
    for (uint32_t t = 0; t < triangles; ++t)
      if (trimesh_is_passing_blade(s, t) && !collider_misses(w, t)) near[t] = 1;
  }
  for (uint32_t t = 0; t < triangles; ++t)
    if (near[t] == 0) trimesh_set_passing_blade(w, t, 0);
}

static void update_passing_vertices(fray_world *w) {
  for (uint32_t p = 0; p < w->p.count; ++p) w->membrane.passing_blade[p] = 1;
  for (uint32_t t = 0; t < triangles_in_use(w); ++t)
    for (uint32_t k = 0; k < 3 && !trimesh_is_passing_blade(&w->trimesh, t); ++k)
      w->membrane.passing_blade[w->trimesh.triangle[t].v[k]] = 0;
}

static void set_passing_around(fray_world *w, uint32_t vertex) {
  FRAY_ASSERT(vertex < w->p.count);
  trimesh_ring ring;
  trimesh_ring_of(&w->trimesh, vertex, &ring);
  for (uint32_t n = 0; n < ring.count; ++n) trimesh_set_passing_blade(w, ring.triangle[n], 1);
}

/* ---- the first hit ---- */

static int begin_query(fray_world *w, const collider *blade, uint32_t triangle, blade_query *f) {
  const trimesh_triangle *s = &w->trimesh.triangle[triangle];
  f->triangle = triangle;
  f->min_speed = w->membrane.blades->speed[w->trimesh.material[triangle]];
  f->q.own_edges = 0;
  f->q.skin = collider_skin(w);
  for (uint32_t k = 0; k < 3; ++k) {
    f->q.path[k] = tick_path(w, blade, s->v[k]);
    const uint32_t neighbour = s->neighbour[trimesh_previous(k)];
    if (neighbour >= triangle || trimesh_is_passing_blade(&w->trimesh, neighbour)) f->q.own_edges |= 1u << k;
  }
  return collider_triangle_begin(w, blade, f->q.skin, &f->q);
}

/* How far the point with these weights moves. */
static vec3 travel_at(const blade_query *f, const int32_t weight[3]) {
  const ccd_path *path = f->q.path;
  return collider_weighted(weight, vec_sub(path[0].end, path[0].begin), vec_sub(path[1].end, path[1].begin),
                           vec_sub(path[2].end, path[2].begin));
}

/* A query that would exceed the budget is a fault. */
/* Keeps a hit that is earlier and fast enough. */
static void keep_first(const blade_query *f, uint32_t corner, const ccd_contact *c, const int32_t weight[3],
                       vec3 edge, blade_hit *first) {
  if (c->time >= first->time) return;
  const vec3 travel = travel_at(f, weight);
  const int32_t approach = fx_sub(0, vec_dot_unit(travel, c->normal));
  if (approach <= 0 || approach < f->min_speed) return;
  first->time = c->time;
  first->corner = corner;
  first->weight[0] = c->weight[0];
  first->weight[1] = c->weight[1];
  first->edge = edge;
  first->travel = travel;
}

static void test_point(fray_world *w, blade_query *f, vec3 at, blade_hit *first) {
  const ccd_path point = {at, at};
  ccd_contact c;
  if (!collider_triangle_take_ccd(w, &f->q) || !ccd_point_triangle(&point, f->q.path, f->q.skin, &c)) return;
  int32_t weight[3];
  collider_triangle_weights(&c, weight);
  keep_first(f, 3, &c, weight, vec_make(0, 0, 0), first);
}

static void test_edge(fray_world *w, blade_query *f, vec3 a, vec3 b, blade_hit *first) {
  const ccd_path blade_edge[2] = {{a, a}, {b, b}};
  for (uint32_t k = 0; k < 3; ++k) {
    const ccd_path edge[2] = {f->q.path[k], f->q.path[trimesh_next(k)]};
    ccd_contact c;
    if ((f->q.own_edges >> k & 1u) == 0 || !collider_triangle_take_ccd(w, &f->q) ||
        !ccd_edges(blade_edge, edge, f->q.skin, &c))
      continue;
    int32_t weight[3];
    collider_triangle_edge_weights(k, c.weight[1], weight);
    keep_first(f, k, &c, weight, vec_sub(b, a), first);
  }
}

/* Each sharp point and edge is tested once, by the face that owns it. */
static void find_first_hit(fray_world *w, const collider *blade, blade_query *f, blade_hit *first) {
  for (uint32_t n = 0; n < f->q.near.count; ++n) {
    const rigid_mesh_face *face = &blade->m.faces[f->q.near.face[n]];
    for (uint32_t k = 0; k < 3; ++k) {
      const rigid_mesh_point *p = &blade->m.points[face->point[k]];
      if (p->sharp != 0 && p->face == (int32_t)f->q.near.face[n])
        test_point(w, f, vec_of(p->at), first);
      if ((face->owned_edges >> k & 1) != 0 && rigid_mesh_edge_is_sharp(&blade->m, face, k))
        test_edge(w, f, vec_of(p->at), vec_of(blade->m.points[face->point[trimesh_next(k)]].at), first);
    }
  }
}

/* ---- the direction of the cut ---- */

/* a by_a - b by_b */
static vec3 combine(vec3 a, int32_t by_a, vec3 b, int32_t by_b) {
  return vec_round_saturated(vec_add64(vec_scale64(a, by_a), vec_scale64(b, -by_b)), UNIT_BITS);
}

/* The line in which the plane of an edge e and its motion m intersects the cloth, n its normal: n x (e x m);
 * of a point, and of an edge that moves along itself, the part of its motion that lies in the cloth. Q30,
 * about. */
static vec3 cut_line(vec3 edge, vec3 motion, vec3 n) {
  const vec3 e = vec_unit(edge, edge);
  const vec3 m = vec_unit(motion, motion);
  const int32_t m_n = vec_dot_unit(m, n);
  const vec3 line = combine(e, m_n, m, vec_dot_unit(e, n));
  return vec_is_within(line, DIRECTION_MIN - 1) ? combine(m, 1 << UNIT_BITS, n, m_n) : line;
}

/* Shifts both right until they have at most so many bits. */
static void shift_to(unsigned bits, int64_t *a, int64_t *b) {
  const uint64_t span = (uint64_t)(*a ^ fx_asr64(*a, 63)) | (uint64_t)(*b ^ fx_asr64(*b, 63)) | 1u;
  const unsigned width = 64u - fx_leading_zeros64(span);
  if (width <= bits) return;
  *a = fx_asr64(*a, width - bits);
  *b = fx_asr64(*b, width - bits);
}

/* A line in rest coordinates, by its components along two edges of the triangle: solves the normal equations
 * of p a + q b = line. Returns 0 where that is 0. */
static int rest_line(const trimesh *s, const blade_query *f, vec3 line, int32_t *du, int32_t *dv) {
  const index_t *v = s->triangle[f->triangle].v;
  const vec3 edge_a = vec_sub(f->q.path[1].begin, f->q.path[0].begin);
  const vec3 edge_b = vec_sub(f->q.path[2].begin, f->q.path[0].begin);
  const unsigned shift = closest_excess(closest_span(edge_a) | closest_span(edge_b), NARROW_BITS);
  const vec3 a = closest_shifted(edge_a, shift);
  const vec3 b = closest_shifted(edge_b, shift);
  const vec3 d = closest_narrow(line, NARROW_BITS);
  const int32_t aa = vec_dot(a, a);
  const int32_t ab = vec_dot(a, b);
  const int32_t bb = vec_dot(b, b);
  const int32_t da = vec_dot(d, a);
  const int32_t db = vec_dot(d, b);
  int64_t along_a = fx_add64(fx_mul_wide(da, bb), -fx_mul_wide(db, ab));
  int64_t along_b = fx_add64(fx_mul_wide(db, aa), -fx_mul_wide(da, ab));
  shift_to(30, &along_a, &along_b);
  const int32_t p = (int32_t)along_a;
  const int32_t q = (int32_t)along_b;
  int64_t line_u = fx_add64(fx_mul_wide(fx_sub(s->u[v[1]], s->u[v[0]]), p),
                            fx_mul_wide(fx_sub(s->u[v[2]], s->u[v[0]]), q));
  int64_t line_v = fx_add64(fx_mul_wide(fx_sub(s->v[v[1]], s->v[v[0]]), p),
                            fx_mul_wide(fx_sub(s->v[v[2]], s->v[v[0]]), q));
  shift_to(29, &line_u, &line_v);
  *du = (int32_t)line_u;
  *dv = (int32_t)line_v;
  return line_u != 0 || line_v != 0;
}

/* Of a point that moves along the normal: away from the nearest edge. */
static void away_from_edge(const trimesh *s, const blade_query *f, const blade_hit *hit, int32_t *du,
                           int32_t *dv) {
  const index_t *v = s->triangle[f->triangle].v;
  const int32_t weight[3] = {CCD_ONE - hit->weight[0] - hit->weight[1], hit->weight[0], hit->weight[1]};
  uint32_t k = 0;
  for (uint32_t n = 1; n < 3; ++n)
    if (weight[n] < weight[k]) k = n;
  const trimesh_point middle = trimesh_point_on(
      trimesh_at(s, v[trimesh_next(k)]), trimesh_at(s, v[trimesh_previous(k)]), TRIMESH_WEIGHT_ONE / 2);
  *du = fx_sub(s->u[v[k]], middle.u);
  *dv = fx_sub(s->v[v[k]], middle.v);
}

/* ---- the cut ---- */

static trimesh_result cut_at(fray_world *w, const blade_query *f, const blade_hit *hit,
                             trimesh_cut_vertices *cut) {
  const ccd_path *path = f->q.path;
  const vec3 n = rigid_mesh_normal(vec_make(0, 0, 0), vec_sub(path[1].begin, path[0].begin),
                                   vec_sub(path[2].begin, path[0].begin));
  const vec3 motion = vec_negated(hit->travel);
  int32_t du;
  int32_t dv;
  if (!rest_line(&w->trimesh, f, cut_line(hit->edge, motion, n), &du, &dv)) {
    if (hit->corner != 3) return TRIMESH_NO_PATH;
    away_from_edge(&w->trimesh, f, hit, &du, &dv);
  }
  if (hit->corner == 3) {
    const uint32_t weight0 = (uint32_t)fx_max(0, CCD_ONE - hit->weight[0] - hit->weight[1]);
    const uint32_t weight1 = (uint32_t)fx_min(hit->weight[0], CCD_ONE - (int32_t)weight0);
    return trimesh_cut_triangle(w, f->triangle, 2u * weight0, 2u * weight1, du, dv, cut);
  }
  return trimesh_cut_edge(w, f->triangle, trimesh_previous(hit->corner), 2u * (uint32_t)hit->weight[1], du,
                          dv, cut);
}

static void count_cut(fray_world *w, const collider *blade, const trimesh_cut_vertices *cut,
                      uint32_t first_new) {
  FRAY_ASSERT(cut->count >= 1 && cut->count <= TRIMESH_CUT_VERTICES);
  for (uint32_t n = 0; n < cut->count; ++n) set_passing_around(w, cut->vertex[n]);
  update_side_masks(w, blade, first_new);
  if (w->work.tears == 0) w->first_tear = cut->vertex[0];
  ++w->work.tears;
  ++w->work.blade_cuts;
  world_count_tears(w, 1);
}

static void cut_triangle(fray_world *w, const collider *blade, uint32_t triangle) {
  FRAY_ASSERT(triangle < triangles_in_use(w));
  blade_query f;
  trimesh_cut_vertices cut;
  blade_hit first = {CCD_ONE + 1, 0, {0, 0}, {0, 0, 0}, {0, 0, 0}};
  if (!begin_query(w, blade, triangle, &f)) return;
  find_first_hit(w, blade, &f, &first);
  if (first.time > CCD_ONE) return;
  if (w->work.blade_cuts == (uint32_t)w->membrane.blades->tears_max) {
    world_fault(w, FRAY_FAULT_BREAK_BUDGET);
    return;
  }
  const uint32_t first_new = w->p.count;
  const trimesh_result result = cut_at(w, &f, &first, &cut);
  if (result == TRIMESH_NO_PARTICLES) world_fault(w, FRAY_FAULT_PARTICLES_FULL);
  if (result == TRIMESH_NO_TRIANGLES) world_fault(w, FRAY_FAULT_TRIANGLES_FULL);
  if (result == TRIMESH_DONE) count_cut(w, blade, &cut, first_new);
}

/* Cuts also the triangles that it makes meanwhile, at the end of the pool. */
static void cut_with(fray_world *w, uint32_t n) {
  const collider blade = blade_at(w, n);
  uint32_t budget = w->capacity[POOL_CONTACTS];
  FRAY_ASSERT(blade.radius == 0 && blade.sharp != 0);
  update_side_masks(w, &blade, 0);
  for (uint32_t t = 0; t < triangles_in_use(w); ++t) {
    if (collider_misses(w, t) || trimesh_is_passing_blade(&w->trimesh, t) || collider_holds(w, &blade, t) ||
        w->membrane.blades->speed[w->trimesh.material[t]] == BLADE_NEVER)
      continue;
    if (budget == 0) {
      world_fault(w, FRAY_FAULT_CONTACTS_FULL);
      return;
    }
    --budget;
    cut_triangle(w, &blade, t);
  }
}

void blade_cut_apply(fray_world *w) {
  FRAY_ASSERT(world_has_blades(w));
  predict_tick_ends(w);
  stop_passing(w);
  for (uint32_t n = 0; n < rigid_mesh_count(w); ++n)
    if (is_sharp(w, n)) cut_with(w, n);
  update_passing_vertices(w);
}
