/* SPDX-License-Identifier: Apache-2.0 */
/* Refuses cloth that begins too near to the meshes and spheres with which it collides. */
#include "rt/geometry/ccd.h"
#include "tools/scene_compiler/draft.h"

static int box_is_near(const rigid_mesh_box *b, const ccd_path *points, uint32_t count, int32_t skin) {
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

/* As the path of a point along the edge. */
static int edge_touches(const ccd_path *from, const ccd_path *to, const ccd_path triangle[3],
                        int32_t skin) {
  const ccd_path edge = {from->begin, to->begin};
  ccd_contact c;
  return ccd_point_triangle(&edge, triangle, skin, &c);
}

/* One point of the cloth, or a triangle, against a face of the mesh. */
static int touches_face(const ccd_path *points, uint32_t count, const ccd_path face[3], int32_t skin) {
  ccd_contact c;
  if (count == 1) return ccd_point_triangle(&points[0], face, skin, &c);
  for (uint32_t n = 0; n < 3; ++n) {
    const uint32_t next = (n + 1) % 3;
    const ccd_path edge[2] = {face[n], face[next]};
    if (edge_touches(&points[n], &points[next], face, skin) ||
        edge_touches(&face[n], &face[next], points, skin))
      return 1;
    for (uint32_t k = 0; k < 3; ++k) {
      const ccd_path side[2] = {points[k], points[(k + 1) % 3]};
      if (ccd_edges(edge, side, skin, &c)) return 1;
    }
  }
  return 0;
}

static int touches(const rigid_mesh_parts *m, const ccd_path *points, uint32_t count, int32_t skin) {
  for (uint32_t n = 0; n < m->box_count;) {
    const rigid_mesh_box *b = &m->boxes[n];
    if (!box_is_near(b, points, count, skin)) {
      n = (uint32_t)b->next;
      continue;
    }
    ++n;
    if (b->face == RIGID_MESH_NONE) continue;
    ccd_path face[3];
    for (uint32_t k = 0; k < 3; ++k) face[k].begin = face[k].end = rigid_mesh_corner(m, (uint32_t)b->face, k);
    if (touches_face(points, count, face, skin)) return 1;
  }
  return 0;
}

static int is_attached(const fray_world *w, uint32_t p, uint32_t b) {
  return p < w->capacity[POOL_ATTACHED] && w->p.attach_body[p] == b;
}

/* The triangle relative to a body; 0 where a corner is attached to that body. */
static int triangle_near(const fray_world *w, uint32_t t, uint32_t b, ccd_path points[3]) {
  const index_t *v = w->trimesh.triangle[t].v;
  for (uint32_t k = 0; k < 3; ++k) {
    points[k].begin = points[k].end =
        vec_sub(world_position(w, v[k]), vec_of(w->rigid.bodies[b].start));
    if (is_attached(w, v[k], b)) return 0;
  }
  return 1;
}

static int refuse_triangle(const draft *d, const fray_world *w, uint32_t n, uint32_t t) {
  const trimesh_point at = trimesh_at(&w->trimesh, w->trimesh.triangle[t].v[0]);
  char along[2][SOURCE_VALUE];
  const exact lu = exact_mul(d->lu_per_cm, exact_make(FX_LU, 1));
  return draft_expected(
      d, BLOCK_BODY + n, w->rigid.bodies[n].motion == FRAY_PATH ? "move" : "at",
      "%s: at tick 0 it is in the membrane, %s along its weft, %s along its warp",
      body_is_mesh(&w->rigid.bodies[n]) ? "a place apart from the cloth by a quarter of its thickness at "
                                          "least"
                                        : "its middle beside the cloth",
      draft_value(d, BLOCK_BODY + n, "at", UNIT_LENGTH, exact_div(exact_make(at.u, 1), lu), 0, along[0]),
      draft_value(d, BLOCK_BODY + n, "at", UNIT_LENGTH, exact_div(exact_make(at.v, 1), lu), 0, along[1]));
}

static int triangles_apart(const draft *d, const fray_world *w, int32_t skin) {
  const ccd_path middle = {{0, 0, 0}, {0, 0, 0}};
  ccd_path points[3];
  ccd_contact c;
  for (uint32_t b = 0; b < w->capacity[POOL_BODIES]; ++b) {
    const int is_mesh = body_is_mesh(&w->rigid.bodies[b]);
    if (!is_mesh && !body_is_sphere_collider(&w->rigid.bodies[b])) continue;
    const rigid_mesh_parts none = {NULL, NULL, NULL, NULL, NULL, 0};
    const rigid_mesh_parts m = is_mesh ? rigid_mesh_at(w, rigid_mesh_of_body(w, b)) : none;
    for (uint32_t t = 0; t < (uint32_t)w->trimesh.state->triangles; ++t) {
      if (!triangle_near(w, t, b, points)) continue;
      if (is_mesh ? touches(&m, points, 3, skin) : ccd_point_triangle(&middle, points, skin, &c))
        return refuse_triangle(d, w, b, t);
    }
  }
  return 1;
}

int draft_mesh_clearance(const draft *d, const fray_world *w) {
  const int32_t skin = fx_max(w->params->thickness / 4, 1);
  if (world_has_membrane(w)) return !world_has_rigid_meshes(w) || triangles_apart(d, w, skin);
  for (uint32_t n = 0; n < rigid_mesh_count(w); ++n) {
    const rigid_mesh_parts m = rigid_mesh_at(w, n);
    const vec3 stands = vec_of(w->rigid.bodies[m.of->body].start);
    for (uint32_t p = d->attached; p < w->p.count; ++p) {
      ccd_path point;
      point.begin = point.end = vec_sub(world_position(w, p), stands);
      if (!touches(&m, &point, 1, skin)) continue;
      return draft_expected(d, BLOCK_BODY + (uint32_t)m.of->body,
                            w->rigid.bodies[m.of->body].motion == FRAY_PATH ? "move" : "at",
                            "a place apart from the cloth by a quarter of its thickness at least: at tick 0 "
                            "it is at "
                            "warp %u, weft %u",
                            d->crossing[p] % d->grid.warps, d->crossing[p] / d->grid.warps);
    }
  }
  return 1;
}
