/* SPDX-License-Identifier: Apache-2.0 */
/* Where a sheet begins: apart from the meshes and balls that it is to stay apart from. */
#include "rt/base/sweep.h"
#include "tools/build/draft.h"

static int box_is_near(const mesh_box *b, const sweep_point *points, uint32_t count, int32_t skin) {
  for (uint32_t k = 0; k < 3; ++k) {
    int32_t low = INT32_MAX;
    int32_t high = INT32_MIN;
    for (uint32_t n = 0; n < count; ++n) {
      const int32_t at[3] = {points[n].begin.x, points[n].begin.y, points[n].begin.z};
      low = fx_min(low, at[k]);
      high = fx_max(high, at[k]);
    }
    if (high < b->low[k] - skin || low > b->high[k] + skin) return 0;
  }
  return 1;
}

/* As a point that goes from one end of the edge to the other. */
static int edge_touches(const sweep_point *from, const sweep_point *to, const sweep_point triangle[3],
                        int32_t skin) {
  const sweep_point edge = {from->begin, to->begin};
  sweep_contact c;
  return sweep_point_triangle(&edge, triangle, skin, &c);
}

/* One point of the sheet, or three corners, against a face of the mesh. */
static int touches_face(const sweep_point *points, uint32_t count, const sweep_point face[3], int32_t skin) {
  sweep_contact c;
  if (count == 1) return sweep_point_triangle(&points[0], face, skin, &c);
  for (uint32_t n = 0; n < 3; ++n) {
    const uint32_t next = (n + 1) % 3;
    const sweep_point edge[2] = {face[n], face[next]};
    if (edge_touches(&points[n], &points[next], face, skin) || edge_touches(&face[n], &face[next], points, skin))
      return 1;
    for (uint32_t k = 0; k < 3; ++k) {
      const sweep_point side[2] = {points[k], points[(k + 1) % 3]};
      if (sweep_edges(edge, side, skin, &c)) return 1;
    }
  }
  return 0;
}

static int touches(const mesh_parts *m, const sweep_point *points, uint32_t count, int32_t skin) {
  for (uint32_t n = 0; n < m->box_count;) {
    const mesh_box *b = &m->boxes[n];
    if (!box_is_near(b, points, count, skin)) {
      n = (uint32_t)b->next;
      continue;
    }
    ++n;
    if (b->face == MESH_NONE) continue;
    sweep_point face[3];
    for (uint32_t k = 0; k < 3; ++k) face[k].begin = face[k].end = mesh_corner(m, (uint32_t)b->face, k);
    if (touches_face(points, count, face, skin)) return 1;
  }
  return 0;
}

static int grips(const fray_world *w, uint32_t p, uint32_t b) {
  return p < w->capacity[POOL_HELD] && w->grip_body[p] == b;
}

/* The triangle as seen from a body; 0 where that holds a corner of it. */
static int triangle_beside(const fray_world *w, uint32_t t, uint32_t b, sweep_point points[3]) {
  const row_id *v = w->sheet.triangle[t].v;
  for (uint32_t k = 0; k < 3; ++k) {
    points[k].begin = points[k].end = vec_sub(world_position(w, v[k]), mesh_vec(w->bodies[b].home));
    if (grips(w, v[k], b)) return 0;
  }
  return 1;
}

static int whole_mm(const draft *d, int32_t lu) {
  return (int)fx_round64((int64_t)lu * d->lu_um / 1000, FX_POSITION_BITS);
}

static int refuse_triangle(const draft *d, const fray_world *w, uint32_t n, uint32_t t) {
  const scene_body *b = &d->scene->bodies[n];
  const sheet_point at = sheet_at(&w->sheet, w->sheet.triangle[t].v[0]);
  return draft_refuse(d, b->line, "%s: found it at the triangles, at %d mm along their weft, %d mm along their "
                      "warp, expected %s", b->name, whole_mm(d, at.u),
                      whole_mm(d, at.v),
                      b->shape == FRAY_MESH ? "them apart by a quarter of their thickness at least"
                                            : "its middle to be beside them");
}

static int triangles_apart(const draft *d, const fray_world *w, int32_t skin) {
  const sweep_point middle = {{0, 0, 0}, {0, 0, 0}};
  sweep_point points[3];
  sweep_contact c;
  for (uint32_t b = 0; b < w->capacity[POOL_BODIES]; ++b) {
    if (w->bodies[b].shape != FRAY_BALL && w->bodies[b].shape != FRAY_MESH) continue;
    const int is_mesh = w->bodies[b].shape == FRAY_MESH;
    const mesh_parts none = {NULL, NULL, NULL, NULL, NULL, 0};
    const mesh_parts m = is_mesh ? mesh_at(w, mesh_of_body(w, b)) : none;
    for (uint32_t t = 0; t < (uint32_t)w->sheet.state->triangles; ++t) {
      if (!triangle_beside(w, t, b, points)) continue;
      if (is_mesh ? touches(&m, points, 3, skin) : sweep_point_triangle(&middle, points, skin, &c))
        return refuse_triangle(d, w, b, t);
    }
  }
  return 1;
}

int draft_mesh_apart(const draft *d, const fray_world *w) {
  const int32_t skin = fx_max(w->params->thickness / 4, 1);
  if (world_has_sheet(w)) return !world_has_meshes(w) || triangles_apart(d, w, skin);
  for (uint32_t n = 0; n < mesh_count(w); ++n) {
    const mesh_parts m = mesh_at(w, n);
    const scene_body *b = &d->scene->bodies[m.of->body];
    const vec3 stands = mesh_vec(w->bodies[m.of->body].home);
    for (uint32_t p = d->held; p < w->particles; ++p) {
      sweep_point point;
      point.begin = point.end = vec_sub(world_position(w, p), stands);
      if (!touches(&m, &point, 1, skin)) continue;
      return draft_refuse(d, b->line, "%s: found it at warp %u, weft %u of the sheet, expected them "
                          "apart by a quarter of the sheet's thickness at least",
                          b->name, d->crossing[p] % d->grid.warps, d->crossing[p] / d->grid.warps);
    }
  }
  return 1;
}
