/* SPDX-License-Identifier: Apache-2.0 */
/* Sharp points and edges of rigid meshes cut triangle sheets (Karaoz 2015, section 3.3), once a tick, behind
 * the tears and before anything is held apart, as cut cloth does not collide with what cut it:
 *
 *   sharp edge    that meets a triangle's side: the side is divided there, and the cloth opened to both
 *                 sides along the line in which the blade's way in this tick goes through it
 *   sharp point   that meets a triangle: that becomes three, with open sides between them
 *
 * They meet where, on their ways of this tick, they come within the cloth's thickness of each other, and cut if
 * they approach as fast as the cloth's threshold says. Speed is the "impact power" here: it is the same at
 * any tick and on any mesh, where an impulse is not. Of a triangle what is met first is cut; what is too slow,
 * or has no way, is held apart as by anything blunt (press.c), and so it may tear.
 *
 * What a cut opened around is parted: blades pass it, and do not cut it again, until no box of a sharp mesh
 * has anything of it. Only triangles know that, one bit in the state; a vertex passes if all of its fan does. */
#include "rt/base/facet.h"
#include "rt/model/sheet_split.h"
#include "rt/stage/solids.h"
#include "rt/stage/stage.h"

enum { UNIT_BITS = 30, SHARE_BITS = 14, DIRECTION_LEAST = 1 << 16 };

/* A triangle of the sheet as the blade sees it in this tick. */
typedef struct {
  uint32_t triangle;
  sweep_point way[3];
  uint32_t own; /* bit k: side from corner k on, that no triangle with a lower number looks at */
  uint32_t sweeps; /* that it may still take */
  int32_t skin, speed;
  solid_span span;
  solid_near near;
} leaf;

/* What is met first. */
typedef struct {
  int32_t time; /* above SWEEP_ONE: nothing */
  uint32_t corner; /* of a side the first; 3: the triangle itself */
  int32_t at[2];
  vec3 edge;    /* of the blade; 0: a point */
  vec3 moved;   /* the cloth there, beside the blade */
} bite;

/* ---- who passes ---- */

static sweep_point way_of(const fray_world *w, const solid *t, uint32_t p) {
  const sweep_point way = {vec_sub(world_position(w, p), t->before),
                           vec_sub(vec_make(w->qx[p], w->qy[p], w->qz[p]), t->now)};
  return way;
}

static void look_aside(fray_world *w, const solid *t, uint32_t first) {
  const int32_t skin = solid_skin(w);
  for (uint32_t p = first; p < w->particles; ++p) {
    const sweep_point way = way_of(w, t, p);
    w->aside[p] = solid_sides(t, &way, skin);
  }
  w->work.mesh_tests += w->particles - first;
}

/* On its way of the whole tick; where free bodies go is only known when they are there. */
static solid blade_at(const fray_world *w, uint32_t n) {
  solid t = solid_at(w, n);
  const body_motion *m = &w->motion[t.body];
  const int32_t *v = w->body_states[t.body].velocity;
  const int32_t substeps = w->params->substeps;
  t.before = m->from;
  t.now = m->to;
  if (w->bodies[t.body].motion == FRAY_FREE)
    t.now = vec_make(fx_saturate(m->from.x + fx_asr64(fx_mul_wide(v[0], substeps), FX_SUB_BITS)),
                     fx_saturate(m->from.y + fx_asr64(fx_mul_wide(v[1], substeps), FX_SUB_BITS)),
                     fx_saturate(m->from.z + fx_asr64(fx_mul_wide(v[2], substeps), FX_SUB_BITS)));
  return t;
}

static int32_t foreseen(int32_t x, int32_t v, int32_t substeps) {
  const int64_t at = x + fx_asr64(fx_mul_wide(v, substeps), FX_SUB_BITS);
  return (int32_t)fx_clamp64(at, -FX_WORLD_MAX, FX_WORLD_MAX);
}

/* Where vertices go, in the places that substeps predict into. */
static void foresee(fray_world *w) {
  const int32_t substeps = w->params->substeps;
  for (uint32_t p = 0; p < w->particles; ++p) {
    w->qx[p] = foreseen(w->x[p], w->vx[p], substeps);
    w->qy[p] = foreseen(w->y[p], w->vy[p], substeps);
    w->qz[p] = foreseen(w->z[p], w->vz[p], substeps);
  }
}

/* What no sharp mesh is near any more comes together again. A bit that no state has says what one is near. */
static void close_up(fray_world *w) {
  const sheet_mesh *s = &w->sheet;
  const uint32_t triangles = (uint32_t)s->state->triangles;
  const uint32_t near = 2u * SHEET_PARTED;
  uint32_t parted = 0;
  for (uint32_t t = 0; t < triangles; ++t) parted |= (uint32_t)sheet_is_parted(s, t);
  if (parted == 0) return;
  for (uint32_t n = 0; n < mesh_count(w); ++n) {
    if ((w->sharp >> n & 1u) == 0) continue;
    const solid blade = blade_at(w, n);
    look_aside(w, &blade, 0);
    for (uint32_t t = 0; t < triangles; ++t)
      if (sheet_is_parted(s, t) && !solid_misses(w, t)) s->mark[t] = (uint8_t)(s->mark[t] | near);
  }
  for (uint32_t t = 0; t < triangles; ++t) {
    const uint32_t stays = (uint32_t)s->mark[t] & near;
    s->mark[t] = (uint8_t)(s->mark[t] ^ stays);
    if (stays == 0) sheet_part(w, t, 0);
  }
}

static void tell_vertices(fray_world *w) {
  for (uint32_t p = 0; p < w->particles; ++p) w->parted[p] = 1;
  for (uint32_t t = 0; t < (uint32_t)w->sheet.state->triangles; ++t)
    for (uint32_t k = 0; k < 3 && !sheet_is_parted(&w->sheet, t); ++k)
      w->parted[w->sheet.triangle[t].v[k]] = 0;
}

/* ---- what is met ---- */

static int begin_leaf(fray_world *w, const solid *t, uint32_t triangle, leaf *f) {
  const sheet_triangle *s = &w->sheet.triangle[triangle];
  f->triangle = triangle;
  f->own = 0;
  f->skin = solid_skin(w);
  f->speed = w->blades->speed[w->sheet.cloth[triangle]];
  f->sweeps = MESH_CLOSE_SWEEPS;
  for (uint32_t k = 0; k < 3; ++k) {
    f->way[k] = way_of(w, t, s->v[k]);
    if (solid_is_far(f->way[k].begin) || solid_is_far(f->way[k].end)) {
      w->state->faults |= (int32_t)FRAY_FAULT_LEFT_WORLD;
      return 0;
    }
    const uint32_t across = s->across[sheet_last(k)];
    if (across >= triangle || sheet_is_parted(&w->sheet, across)) f->own |= 1u << k;
  }
  f->span = solid_span_of(f->way, 3, f->skin);
  solid_list_near(w, t, &f->span, MESH_CLOSE, &f->near);
  if (f->near.count != SOLID_TOO_MANY) return 1;
  w->state->faults |= (int32_t)FRAY_FAULT_CROWDED;
  return 0;
}

static int32_t mixed(int32_t a, int32_t b, int32_t c, const int32_t share[3]) {
  const int64_t sum = fx_add64(fx_add64(fx_mul_wide(a, share[0]), fx_mul_wide(b, share[1])), fx_mul_wide(c, share[2]));
  return fx_saturate(fx_round64(sum, 15));
}
/* How far the place with these weights goes. */
static vec3 moved_at(const leaf *f, const int32_t share[3]) {
  const vec3 a = vec_sub(f->way[0].end, f->way[0].begin);
  const vec3 b = vec_sub(f->way[1].end, f->way[1].begin);
  const vec3 c = vec_sub(f->way[2].end, f->way[2].begin);
  return vec_make(mixed(a.x, b.x, c.x, share), mixed(a.y, b.y, c.y, share), mixed(a.z, b.z, c.z, share));
}

static int has_sweep(fray_world *w, leaf *f) {
  if (f->sweeps == 0) {
    w->state->faults |= (int32_t)FRAY_FAULT_CROWDED;
    return 0;
  }
  --f->sweeps;
  ++w->work.mesh_sweeps;
  return 1;
}

/* Keeps what is met earlier and comes fast enough. */
static void keep_first(const leaf *f, uint32_t corner, const sweep_contact *c, const int32_t share[3], vec3 edge,
                       bite *first) {
  if (c->time >= first->time) return;
  const vec3 moved = moved_at(f, share);
  const int32_t approach = fx_sub(0, vec_dot_unit(moved, c->normal));
  if (approach <= 0 || approach < f->speed) return;
  first->time = c->time;
  first->corner = corner;
  first->at[0] = c->at[0];
  first->at[1] = c->at[1];
  first->edge = edge;
  first->moved = moved;
}

static void meet_point(fray_world *w, leaf *f, vec3 at, bite *first) {
  const sweep_point point = {at, at};
  sweep_contact c;
  if (!has_sweep(w, f) || !sweep_point_triangle(&point, f->way, f->skin, &c)) return;
  const int32_t share[3] = {fx_max(0, SWEEP_ONE - c.at[0] - c.at[1]), c.at[0], c.at[1]};
  keep_first(f, 3, &c, share, vec_make(0, 0, 0), first);
}

static void meet_edge(fray_world *w, leaf *f, vec3 a, vec3 b, bite *first) {
  const sweep_point edge[2] = {{a, a}, {b, b}};
  for (uint32_t k = 0; k < 3; ++k) {
    const sweep_point side[2] = {f->way[k], f->way[sheet_next(k)]};
    sweep_contact c;
    if ((f->own >> k & 1u) == 0 || !has_sweep(w, f) || !sweep_edges(edge, side, f->skin, &c)) continue;
    int32_t share[3] = {0, 0, 0};
    share[k] = SWEEP_ONE - c.at[1];
    share[sheet_next(k)] = c.at[1];
    keep_first(f, k, &c, share, vec_sub(b, a), first);
  }
}

/* Each point and edge once, by the face that has it. */
static void meet_all(fray_world *w, const solid *t, leaf *f, bite *first) {
  for (uint32_t n = 0; n < f->near.count; ++n) {
    const mesh_face *face = &t->m.faces[f->near.face[n]];
    for (uint32_t k = 0; k < 3; ++k) {
      const mesh_point *p = &t->m.points[face->point[k]];
      if (p->sharp != 0 && p->face == (int32_t)f->near.face[n]) meet_point(w, f, mesh_vec(p->at), first);
      if ((face->own >> k & 1) != 0 && mesh_side_is_sharp(&t->m, face, k))
        meet_edge(w, f, mesh_vec(p->at), mesh_vec(t->m.points[face->point[sheet_next(k)]].at), first);
    }
  }
}

/* ---- where it goes ---- */

static vec3 slash_unit(vec3 v) {
  const uint64_t squared = vec_squared(v);
  if (squared == 0) return v;
  const fx_root root = fx_rsqrt(squared, FX_ROOT_FINE);
  return vec_make(fx_root_unit(root, v.x), fx_root_unit(root, v.y), fx_root_unit(root, v.z));
}

static int32_t weighed(int32_t a, int32_t by_a, int32_t b, int32_t by_b) {
  return fx_saturate(fx_round64(fx_add64(fx_mul_wide(a, by_a), -fx_mul_wide(b, by_b)), UNIT_BITS));
}

/* The line in which the plane of an edge and its way goes through the cloth, n its normal: n x (e x m); of a
 * point, and of an edge that goes along itself, the part of its way that lies in the cloth. Q30, about. */
static vec3 line_of(vec3 edge, vec3 way, vec3 n) {
  const vec3 e = slash_unit(edge);
  const vec3 m = slash_unit(way);
  const int32_t down = vec_dot_unit(m, n);
  const int32_t up = vec_dot_unit(e, n);
  const vec3 line = vec_make(weighed(e.x, down, m.x, up), weighed(e.y, down, m.y, up), weighed(e.z, down, m.z, up));
  if (fx_magnitude(line.x) >= DIRECTION_LEAST || fx_magnitude(line.y) >= DIRECTION_LEAST ||
      fx_magnitude(line.z) >= DIRECTION_LEAST)
    return line;
  const int32_t one = 1 << UNIT_BITS;
  return vec_make(weighed(m.x, one, n.x, down), weighed(m.y, one, n.y, down), weighed(m.z, one, n.z, down));
}

/* Both as long as they are to one another, of at most so many bits. */
static void narrow(int64_t *a, int64_t *b, unsigned bits) {
  const uint64_t span = (uint64_t)(*a ^ fx_asr64(*a, 63)) | (uint64_t)(*b ^ fx_asr64(*b, 63)) | 1u;
  const unsigned width = 64u - fx_leading_zeros64(span);
  if (width <= bits) return;
  *a = fx_asr64(*a, width - bits);
  *b = fx_asr64(*b, width - bits);
}

/* A line in rest coordinates: its shares along two sides of the triangle. Returns 0 where it has none. */
static int rest_line(const sheet_mesh *s, const leaf *f, vec3 line, int32_t *du, int32_t *dv) {
  const row_id *v = s->triangle[f->triangle].v;
  vec3 a = vec_sub(f->way[1].begin, f->way[0].begin);
  vec3 b = vec_sub(f->way[2].begin, f->way[0].begin);
  const unsigned shift = facet_excess(facet_span(a) | facet_span(b), SHARE_BITS);
  a = facet_shifted(a, shift);
  b = facet_shifted(b, shift);
  const vec3 d = facet_narrow(line, SHARE_BITS);
  const int32_t aa = facet_dot(a, a);
  const int32_t ab = facet_dot(a, b);
  const int32_t bb = facet_dot(b, b);
  const int32_t da = facet_dot(d, a);
  const int32_t db = facet_dot(d, b);
  int64_t along_a = fx_add64(fx_mul_wide(da, bb), -fx_mul_wide(db, ab));
  int64_t along_b = fx_add64(fx_mul_wide(db, aa), -fx_mul_wide(da, ab));
  narrow(&along_a, &along_b, 30);
  const int32_t p = (int32_t)along_a;
  const int32_t q = (int32_t)along_b;
  int64_t u = fx_add64(fx_mul_wide(fx_sub(s->u[v[1]], s->u[v[0]]), p), fx_mul_wide(fx_sub(s->u[v[2]], s->u[v[0]]), q));
  int64_t w = fx_add64(fx_mul_wide(fx_sub(s->v[v[1]], s->v[v[0]]), p), fx_mul_wide(fx_sub(s->v[v[2]], s->v[v[0]]), q));
  narrow(&u, &w, 29);
  *du = (int32_t)u;
  *dv = (int32_t)w;
  return u != 0 || w != 0;
}

/* A point that comes straight at the cloth: away from the side that is nearest. */
static void away_from_side(const sheet_mesh *s, const leaf *f, const bite *b, int32_t *du, int32_t *dv) {
  const row_id *v = s->triangle[f->triangle].v;
  const int32_t weight[3] = {SWEEP_ONE - b->at[0] - b->at[1], b->at[0], b->at[1]};
  uint32_t k = 0;
  for (uint32_t n = 1; n < 3; ++n)
    if (weight[n] < weight[k]) k = n;
  const sheet_point foot = sheet_between(sheet_at(s, v[sheet_next(k)]), sheet_at(s, v[sheet_last(k)]), SHEET_SHARE / 2);
  *du = fx_sub(s->u[v[k]], foot.u);
  *dv = fx_sub(s->v[v[k]], foot.v);
}

/* ---- the cut ---- */

static sheet_result cut_leaf(fray_world *w, const leaf *f, const bite *b, sheet_lips *lips) {
  const vec3 n = mesh_normal(vec_make(0, 0, 0), vec_sub(f->way[1].begin, f->way[0].begin),
                             vec_sub(f->way[2].begin, f->way[0].begin));
  const vec3 way = vec_make(fx_sub(0, b->moved.x), fx_sub(0, b->moved.y), fx_sub(0, b->moved.z));
  int32_t du;
  int32_t dv;
  if (!rest_line(&w->sheet, f, line_of(b->edge, way, n), &du, &dv)) {
    if (b->corner != 3) return SHEET_NO_WAY;
    away_from_side(&w->sheet, f, b, &du, &dv);
  }
  if (b->corner == 3) {
    const uint32_t share0 = (uint32_t)fx_max(0, SWEEP_ONE - b->at[0] - b->at[1]);
    return sheet_cut_triangle(w, f->triangle, 2u * share0, 2u * (uint32_t)fx_min(b->at[0], SWEEP_ONE - (int32_t)share0),
                              du, dv, lips);
  }
  return sheet_cut_side(w, f->triangle, sheet_last(b->corner), 2u * (uint32_t)b->at[1], du, dv, lips);
}

static void part_around(fray_world *w, uint32_t vertex) {
  sheet_fan fan;
  sheet_walk(&w->sheet, vertex, &fan);
  for (uint32_t n = 0; n < fan.count; ++n) sheet_part(w, fan.triangle[n], 1);
}

static void count_cut(fray_world *w, const solid *t, const sheet_lips *lips, uint32_t born) {
  for (uint32_t n = 0; n < lips->count; ++n) part_around(w, lips->vertex[n]);
  look_aside(w, t, born);
  if (w->work.cuts == 0) w->cut_first = lips->vertex[0];
  ++w->work.cuts;
  ++w->work.slashes;
  ++w->state->cuts_total;
}

static void slash_triangle(fray_world *w, const solid *t, uint32_t triangle) {
  leaf f;
  sheet_lips lips;
  bite first = {SWEEP_ONE + 1, 0, {0, 0}, {0, 0, 0}, {0, 0, 0}};
  if (!begin_leaf(w, t, triangle, &f)) return;
  meet_all(w, t, &f, &first);
  if (first.time > SWEEP_ONE) return;
  if (w->work.slashes == (uint32_t)w->blades->cuts_max) {
    w->state->faults |= (int32_t)FRAY_FAULT_CUTS_WAIT;
    return;
  }
  const uint32_t born = w->particles;
  const sheet_result result = cut_leaf(w, &f, &first, &lips);
  if (result == SHEET_NO_PARTICLES) w->state->faults |= (int32_t)FRAY_FAULT_SPARES_FULL;
  if (result == SHEET_NO_TRIANGLES) w->state->faults |= (int32_t)FRAY_FAULT_TRIANGLES_FULL;
  if (result == SHEET_DONE) count_cut(w, t, &lips, born);
}

/* Also what is made on the way, at the end of the pool. */
static void slash_by(fray_world *w, uint32_t n) {
  const solid t = blade_at(w, n);
  uint32_t left = w->capacity[POOL_CONTACTS];
  look_aside(w, &t, 0);
  for (uint32_t triangle = 0; triangle < (uint32_t)w->sheet.state->triangles; ++triangle) {
    if (solid_misses(w, triangle) || sheet_is_parted(&w->sheet, triangle) || solid_grips(w, &t, triangle) ||
        w->blades->speed[w->sheet.cloth[triangle]] == BLADE_NEVER)
      continue;
    if (left == 0) {
      w->state->faults |= (int32_t)FRAY_FAULT_CONTACTS_FULL;
      return;
    }
    --left;
    slash_triangle(w, &t, triangle);
  }
}

void slash_run(fray_world *w) {
  if (!world_has_blades(w)) return;
  foresee(w);
  close_up(w);
  for (uint32_t n = 0; n < mesh_count(w); ++n)
    if ((w->sharp >> n & 1u) != 0) slash_by(w, n);
  tell_vertices(w);
}
