/* SPDX-License-Identifier: Apache-2.0 */
/* Triangles of a sheet against rigid meshes and balls, behind their vertices (Karaoz 2015, section 2.6): a
 * mesh's points against triangles, its edges against their sides, a ball's middle, with its radius for
 * thickness, against triangles. What begins apart stays apart, in three passes:
 *
 *   repulsion   what comes within the cloth's thickness is pushed out to it, along the way from the nearest
 *               points, with friction; corners move by their weights there, none farther than the nearest
 *               point is to. The side is that of where the substep began.
 *   resolution  a triangle whose way touches something nevertheless is not moved: its corners keep their
 *               places beside the body. That changes the ways of triangles around it, so they are looked at
 *               again, a few times.
 *   the rest    if that does not end, all that came near the body keeps its place beside it: the paper's
 *               rigid group. A way that is not taken goes nowhere the old one did not, so what stayed
 *               away still does.
 *
 * What there is no room or bound of work for keeps its place too, and is reported. Vertices that a body
 * holds cannot: a free body that meets them is stopped (meshes.c); where they draw a triangle through
 * something nevertheless, that is reported. Triangles at a vertex that the body itself holds pass it freely. */
#include "rt/stage/solids.h"
#include "rt/stage/stage.h"

enum { SHARE_BITS = 16, SHARE_MOST = 1 << SHARE_BITS };

/* A triangle of the sheet, as seen from the body. */
typedef struct {
  const row_id *v;
  sweep_point way[3];
  uint32_t own;   /* bit k: side from corner k on, that no triangle with a lower number has */
  uint32_t moved; /* bit k: corner k was pushed */
  uint32_t sweeps; /* that it may still take */
  int32_t skin;
  vec3 out;       /* the last push */
  solid_span span;
  solid_near near;
} flap;

static void stand_triangle(fray_world *w, const solid *t, uint32_t triangle) {
  const row_id *v = w->sheet.triangle[triangle].v;
  for (uint32_t k = 0; k < 3; ++k) {
    if (v[k] < (uint32_t)w->params->held || (w->aside[v[k]] & SOLID_STANDS) != 0) continue;
    const sweep_point way = solid_way(w, t, v[k]);
    solid_stand(w, t, v[k], &way);
    w->aside[v[k]] |= SOLID_STANDS;
  }
}

static int may_move(const fray_world *w, uint32_t triangle) {
  const row_id *v = w->sheet.triangle[triangle].v;
  for (uint32_t k = 0; k < 3; ++k)
    if (v[k] >= (uint32_t)w->params->held && (w->aside[v[k]] & SOLID_STANDS) == 0) return 1;
  return 0;
}

/* What it does not hold, cut or stay away from. */
static int is_beside(const fray_world *w, const solid *t, uint32_t triangle) {
  return !solid_misses(w, triangle) && !solid_grips(w, t, triangle) && !solid_parts(w, t, triangle);
}

/* The triangles that come near the body; those for which there is no room stand. */
static uint32_t list_beside(fray_world *w, const solid *t, uint32_t *left) {
  const uint32_t triangles = (uint32_t)w->sheet.state->triangles;
  uint32_t count = 0;
  for (uint32_t n = 0; n < triangles; ++n) {
    if (!is_beside(w, t, n)) continue;
    if (*left == 0) {
      w->state->faults |= (int32_t)FRAY_FAULT_CONTACTS_FULL;
      stand_triangle(w, t, n);
      continue;
    }
    --*left;
    w->beside[count++] = (row_id)n;
  }
  return count;
}

/* Returns 0 where it cannot be looked at. */
static int begin_flap(fray_world *w, const solid *t, uint32_t triangle, int32_t skin, flap *f) {
  const sheet_triangle *s = &w->sheet.triangle[triangle];
  f->v = s->v;
  f->own = f->moved = 0;
  f->skin = skin + (skin != 0 ? t->radius : 0);
  f->sweeps = MESH_CLOSE_SWEEPS;
  for (uint32_t k = 0; k < 3; ++k) {
    f->way[k] = solid_way(w, t, s->v[k]);
    if (solid_is_far(f->way[k].begin) || solid_is_far(f->way[k].end)) {
      w->state->faults |= (int32_t)FRAY_FAULT_LEFT_WORLD;
      return 0;
    }
    const uint32_t across = s->across[sheet_last(k)];
    if (across >= triangle || solid_grips(w, t, across) || solid_parts(w, t, across))
      f->own |= 1u << k;
  }
  f->span = solid_span_of(f->way, 3, skin);
  if (t->radius != 0) return 1;
  solid_list_near(w, t, &f->span, MESH_CLOSE, &f->near);
  if (f->near.count != SOLID_TOO_MANY) return 1;
  w->state->faults |= (int32_t)FRAY_FAULT_CROWDED;
  return 0;
}

static int32_t weighed(const int32_t weight[3], int32_t a, int32_t b, int32_t c) {
  const int64_t sum = fx_add64(fx_add64(fx_mul_wide(weight[0], a), fx_mul_wide(weight[1], b)),
                               fx_mul_wide(weight[2], c));
  return fx_saturate(fx_round64(sum, 15));
}
static vec3 point_of(const int32_t weight[3], vec3 a, vec3 b, vec3 c) {
  return vec_make(weighed(weight, a.x, b.x, c.x), weighed(weight, a.y, b.y, c.y),
                  weighed(weight, a.z, b.z, c.z));
}

/* How far each corner moves for a step of the point with these weights, at most as far; 0 where none can. By
 * masses too, vertices of slivers, a hundred times lighter, would go as much farther and tear away. */
static int shares_of(const fray_world *w, const flap *f, const int32_t weight[3], int32_t share[3]) {
  uint64_t whole = 0;
  for (uint32_t k = 0; k < 3; ++k) {
    const int moves = f->v[k] >= (uint32_t)w->params->held && (w->aside[f->v[k]] & SOLID_STANDS) == 0;
    share[k] = moves ? weight[k] : 0;
    whole += fx_square(share[k]);
  }
  if (whole == 0) return 0;
  for (uint32_t k = 0; k < 3; ++k) {
    const uint64_t part = ((uint64_t)(uint32_t)share[k] << (15 + SHARE_BITS)) / whole;
    share[k] = part > SHARE_MOST ? SHARE_MOST : (int32_t)part;
  }
  return 1;
}

static void move_corners(flap *f, const int32_t share[3], vec3 by) {
  for (uint32_t k = 0; k < 3; ++k) {
    if (share[k] == 0) continue;
    vec3 *end = &f->way[k].end;
    *end = vec_make(
        fx_clamp(fx_saturate(end->x + fx_round64(fx_mul_wide(by.x, share[k]), SHARE_BITS)), -FX_WORLD_MAX, FX_WORLD_MAX),
        fx_clamp(fx_saturate(end->y + fx_round64(fx_mul_wide(by.y, share[k]), SHARE_BITS)), -FX_WORLD_MAX, FX_WORLD_MAX),
        fx_clamp(fx_saturate(end->z + fx_round64(fx_mul_wide(by.z, share[k]), SHARE_BITS)), -FX_WORLD_MAX, FX_WORLD_MAX));
    f->moved |= 1u << k;
  }
}

/* The point with these weights goes out to the thickness from `at`, then friction takes back what it slid. */
static void push_out(const fray_world *w, const solid *t, flap *f, const int32_t weight[3], vec3 at, vec3 out) {
  int32_t share[3];
  const vec3 end = point_of(weight, f->way[0].end, f->way[1].end, f->way[2].end);
  const int64_t short_of = (int64_t)f->skin - vec_dot_unit(vec_sub(end, at), out);
  const int32_t depth = (int32_t)fx_clamp64(short_of, 0, FX_WORLD_MAX);
  if (depth <= SOLID_DEPTH_LEAST || !shares_of(w, f, weight, share)) return;
  f->out = out;
  move_corners(f, share, vec_scale_unit(out, depth));
  const vec3 begin = point_of(weight, f->way[0].begin, f->way[1].begin, f->way[2].begin);
  const vec3 moved =
      vec_sub(point_of(weight, f->way[0].end, f->way[1].end, f->way[2].end), begin);
  if ((fx_magnitude(moved.x) | fx_magnitude(moved.y) | fx_magnitude(moved.z)) >= (uint32_t)SOLID_SLIDE_MOST)
    return;
  const vec3 slip = vec_sub(moved, vec_scale_unit(out, vec_dot_unit(moved, out)));
  const int64_t most = fx_mul_wide(depth, w->bodies[t->body].friction) >> 16;
  const vec3 back = vec_limited(slip, (int32_t)fx_clamp64(most, 0, FX_WORLD_MAX));
  move_corners(f, share, vec_make(-back.x, -back.y, -back.z));
}

static int has_sweep(fray_world *w, flap *f) {
  if (f->sweeps == 0) return 0;
  --f->sweeps;
  ++w->work.mesh_sweeps;
  return 1;
}

/* 1 where it touches, or may; skin 0 only asks. */
static int meet_point(fray_world *w, const solid *t, flap *f, vec3 at) {
  const sweep_point point = {at, at};
  sweep_contact c;
  if (!has_sweep(w, f)) return 1;
  if (!sweep_point_triangle(&point, f->way, f->skin, &c)) return 0;
  if (f->skin == 0) return 1;
  const int32_t weight[3] = {fx_max(0, SWEEP_ONE - c.at[0] - c.at[1]), c.at[0], c.at[1]};
  push_out(w, t, f, weight, at, c.normal);
  return 0;
}

static int meet_edge(fray_world *w, const solid *t, flap *f, vec3 a, vec3 b) {
  const sweep_point edge[2] = {{a, a}, {b, b}};
  for (uint32_t k = 0; k < 3; ++k) {
    const uint32_t next = sheet_next(k);
    const sweep_point side[2] = {f->way[k], f->way[next]};
    sweep_contact c;
    if ((f->own >> k & 1u) == 0) continue;
    if (f->skin == 0 && solid_stays(&side[0]) && solid_stays(&side[1])) continue;
    if (!has_sweep(w, f)) return 1;
    if (!sweep_edges(edge, side, f->skin, &c)) continue;
    if (f->skin == 0) return 1;
    int32_t weight[3] = {0, 0, 0};
    weight[k] = SWEEP_ONE - c.at[1];
    weight[next] = c.at[1];
    const vec3 met = vec_make(
        a.x + (int32_t)fx_round64(fx_mul_wide(fx_sub(b.x, a.x), c.at[0]), 15),
        a.y + (int32_t)fx_round64(fx_mul_wide(fx_sub(b.y, a.y), c.at[0]), 15),
        a.z + (int32_t)fx_round64(fx_mul_wide(fx_sub(b.z, a.z), c.at[0]), 15));
    push_out(w, t, f, weight, met, c.normal);
  }
  return 0;
}

static int edge_is_near(const solid_span *s, vec3 a, vec3 b) {
  return fx_max(a.x, b.x) >= s->low[0] && fx_min(a.x, b.x) <= s->high[0] && fx_max(a.y, b.y) >= s->low[1] &&
         fx_min(a.y, b.y) <= s->high[1] && fx_max(a.z, b.z) >= s->low[2] && fx_min(a.z, b.z) <= s->high[2];
}

/* What the body has of points and edges near the triangle; each once, by the face that has it. */
static int meet_all(fray_world *w, const solid *t, flap *f) {
  if (t->radius != 0) return meet_point(w, t, f, vec_make(0, 0, 0));
  for (uint32_t n = 0; n < f->near.count; ++n) {
    const mesh_face *face = &t->m.faces[f->near.face[n]];
    for (uint32_t k = 0; k < 3; ++k) {
      const mesh_point *p = &t->m.points[face->point[k]];
      const vec3 a = mesh_vec(p->at);
      const vec3 b = mesh_vec(t->m.points[face->point[sheet_next(k)]].at);
      if (p->face == (int32_t)f->near.face[n] && solid_holds(&f->span, a) && meet_point(w, t, f, a)) return 1;
      if ((face->own >> k & 1) != 0 && edge_is_near(&f->span, a, b) && meet_edge(w, t, f, a, b)) return 1;
    }
  }
  return 0;
}

static void press(fray_world *w, const solid *t, uint32_t triangle) {
  flap f;
  if (!may_move(w, triangle)) return;
  if (!begin_flap(w, t, triangle, solid_skin(w), &f) || meet_all(w, t, &f)) {
    if (f.sweeps == 0) w->state->faults |= (int32_t)FRAY_FAULT_CROWDED;
    stand_triangle(w, t, triangle);
    return;
  }
  for (uint32_t k = 0; k < 3; ++k) {
    if ((f.moved >> k & 1u) == 0) continue;
    solid_place(w, t, f.v[k], f.way[k].end);
    if ((w->aside[f.v[k]] & SOLID_MOVED) == 0) (void)solid_add_contact(w, t, f.v[k], f.out);
    w->aside[f.v[k]] = SOLID_MOVED; /* on no side: its end may be anywhere */
  }
}

/* Told by a look at where its ways end, or begin, not by a sweep. */
static int is_within(const flap *f, int ends, int32_t radius) {
  const sweep_point middle = {{0, 0, 0}, {0, 0, 0}};
  sweep_point still[3];
  sweep_contact c;
  for (uint32_t k = 0; k < 3; ++k) {
    still[k].begin = ends != 0 ? f->way[k].end : f->way[k].begin;
    still[k].end = still[k].begin;
  }
  return sweep_point_triangle(&middle, still, radius, &c);
}

/* Ends in a ball by more than half the thickness, and did not begin there. */
static int sinks(const fray_world *w, const solid *t, const flap *f) {
  const int32_t most = fx_max(0, t->radius - w->params->thickness / 2);
  return is_within(f, 1, most) && !is_within(f, 0, most);
}

/* The ways of its corners, and its own. */
static int triangle_crosses(fray_world *w, const solid *t, uint32_t triangle) {
  flap f;
  if (!begin_flap(w, t, triangle, 0, &f)) return 1;
  if (solid_stays(&f.way[0]) && solid_stays(&f.way[1]) && solid_stays(&f.way[2])) return 0;
  return meet_all(w, t, &f) || (t->radius != 0 && sinks(w, t, &f));
}

/* Corners that were pushed may not have gone through a face. */
static void check_corners(fray_world *w, const solid *t, uint32_t triangle) {
  const row_id *v = w->sheet.triangle[triangle].v;
  for (uint32_t k = 0; k < 3; ++k) {
    if ((w->aside[v[k]] & SOLID_MOVED) == 0) continue;
    const sweep_point way = solid_way(w, t, v[k]);
    w->aside[v[k]] &= (uint8_t)~(uint32_t)SOLID_MOVED;
    if (!solid_crosses(w, t, &way)) continue;
    solid_stand(w, t, v[k], &way);
    w->aside[v[k]] |= SOLID_STANDS;
  }
}

static uint32_t holder_of(const fray_world *w, uint32_t triangle) {
  const row_id *v = w->sheet.triangle[triangle].v;
  for (uint32_t k = 0; k < 3; ++k)
    if (v[k] < (uint32_t)w->params->held) return w->grip_body[v[k]];
  return PRESS_FREE;
}

/* Returns how many triangles stand; who holds what does not let the body pass, else PRESS_FREE. */
static uint32_t resolve(fray_world *w, const solid *t, uint32_t count, uint32_t *holder) {
  uint32_t stands = 0;
  uint32_t before = 1;
  *holder = PRESS_FREE;
  for (uint32_t round = 0; round < MESH_CHECKS && before != stands; ++round) {
    before = stands;
    for (uint32_t n = 0; n < count; ++n) {
      if (!triangle_crosses(w, t, w->beside[n])) continue;
      if (!may_move(w, w->beside[n])) {
        *holder = holder_of(w, w->beside[n]);
        continue;
      }
      stand_triangle(w, t, w->beside[n]);
      ++stands;
    }
  }
  if (before != stands)
    for (uint32_t n = 0; n < count; ++n) stand_triangle(w, t, w->beside[n]);
  return stands;
}

uint32_t press_run(fray_world *w, const solid *t, uint32_t left[2]) {
  uint32_t holder;
  uint32_t count = list_beside(w, t, &left[0]);
  for (uint32_t round = 0; round < MESH_PRESSES; ++round)
    for (uint32_t n = 0; n < count; ++n) press(w, t, w->beside[n]);
  if (t->radius == 0)
    for (uint32_t n = 0; n < count; ++n) check_corners(w, t, w->beside[n]);
  count = list_beside(w, t, &left[1]); /* with those beside what was pushed */
  (void)resolve(w, t, count, &holder);
  return holder;
}

uint32_t press_look(fray_world *w, const solid *t, uint32_t *left, uint32_t *holder) {
  return resolve(w, t, list_beside(w, t, left), holder);
}

void press_stand(fray_world *w, const solid *t) {
  const uint32_t triangles = (uint32_t)w->sheet.state->triangles;
  const int32_t skin = solid_skin(w);
  for (uint32_t p = 0; p < w->particles; ++p) {
    const sweep_point way = solid_way(w, t, p);
    w->aside[p] = solid_passes(w, t, p) ? (uint8_t)SOLID_SIDES : solid_sides(t, &way, skin);
  }
  for (uint32_t n = 0; n < triangles; ++n)
    if (is_beside(w, t, n)) stand_triangle(w, t, n);
}
