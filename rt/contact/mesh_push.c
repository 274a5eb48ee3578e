/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/contact/mesh_push.h"

/* The way out where the path met the triangle; inside the triangle its own normal is more exact. */
static vec3 direction_out(const collider *t, uint32_t face, const ccd_path *path, const ccd_contact *c) {
  const int inside = c->weight[0] > 0 && c->weight[1] > 0 && c->weight[0] + c->weight[1] < CCD_ONE;
  if (!inside) return vec_negated(c->normal);
  const vec3 normal = vec_of(t->m.faces[face].normal);
  return collider_gap(t, face, path->begin) >= 0 ? normal : vec_negated(normal);
}

/* How far the path's end is short of the thickness. */
static int32_t push_depth(const collider *t, uint32_t face, vec3 end, const ccd_contact *c, vec3 out,
                          int32_t skin) {
  const vec3 a = rigid_mesh_corner(&t->m, face, 0);
  const vec3 along1 = vec_scale_q15(vec_sub(rigid_mesh_corner(&t->m, face, 1), a), c->weight[0]);
  const vec3 along2 = vec_scale_q15(vec_sub(rigid_mesh_corner(&t->m, face, 2), a), c->weight[1]);
  const vec3 met = vec_add(vec_add(a, along1), along2);
  return (int32_t)fx_clamp64((int64_t)skin - vec_dot_unit(vec_sub(end, met), out), -FX_LU, FX_WORLD_MAX);
}

typedef enum { OVER_FACE, BEYOND_FACE, NEAR_FACE } face_position;

/* OVER_FACE: both ends of the path are on the inner side of all three edges. BEYOND_FACE: both are
 * farther than `skin` outside of one edge. Both by more than rounding. */
static face_position face_position_of(const collider *t, uint32_t face, const ccd_path *path, int32_t skin) {
  const vec3 n = vec_of(t->m.faces[face].normal);
  const int64_t rounding = (int64_t)1 << 32;
  face_position found = OVER_FACE;
  for (uint32_t k = 0; k < 3; ++k) {
    const vec3 a = rigid_mesh_corner(&t->m, face, k);
    const vec3 e = vec_sub(rigid_mesh_corner(&t->m, face, (k + 1u) % 3u), a);
    const vec3 inward = vec_cross_unit(n, e); /* as long as the edge */
    const int64_t begin = vec_dot64(inward, vec_sub(path->begin, a));
    const int64_t end = vec_dot64(inward, vec_sub(path->end, a));
    const int64_t length_max = (int64_t)fx_magnitude(e.x) + fx_magnitude(e.y) + fx_magnitude(e.z);
    const int64_t outside = -(length_max * (skin + COLLIDER_PLANE_MARGIN)) - rounding;
    if (begin < outside && end < outside) return BEYOND_FACE;
    if (begin < rounding || end < rounding) found = NEAR_FACE;
  }
  return found;
}

/* The push out of a triangle over which both ends of the path are: no CCD is needed. */
static mesh_push push_along_normal(const collider *t, uint32_t face, collider_gaps g, int32_t skin) {
  const vec3 n = vec_of(t->m.faces[face].normal);
  const int above = g.begin >= 0;
  const int64_t begin = above ? g.begin : -(int64_t)g.begin;
  const int64_t end = above ? g.end : -(int64_t)g.end;
  mesh_push p = {0, (int32_t)fx_clamp64(skin - end, 0, FX_WORLD_MAX), n};
  if (!above) p.out = vec_negated(n);
  if (begin > skin && end < begin) p.time = (int32_t)((begin - skin) * CCD_ONE / (begin - end));
  return p;
}

/* The push out of one triangle; its depth is at most COLLIDER_DEPTH_MIN where the path's end is outside. */
__attribute__((noinline)) static mesh_push push_out_of_face(fray_world *w, const collider *t, uint32_t face,
                                                            const ccd_path *path, int32_t skin) {
  const collider_gaps g = collider_gaps_of(t, face, path);
  mesh_push p = {0, 0, {0, 0, 0}};
  ccd_contact c;
  if (collider_is_on_one_side(g, skin - COLLIDER_DEPTH_MIN)) return p;
  const face_position at = face_position_of(t, face, path, skin);
  if (at == OVER_FACE) return push_along_normal(t, face, g, skin);
  if (at == BEYOND_FACE || !collider_ccd(w, t, face, path, skin, &c)) return p;
  p.time = c.time;
  p.out = direction_out(t, face, path, &c);
  p.depth = push_depth(t, face, path->end, &c, p.out, skin);
  return p;
}

mesh_push mesh_push_first(fray_world *w, const collider *t, const collider_near *near, const ccd_path *path,
                          int32_t skin) {
  mesh_push first = {CCD_ONE + 1, 0, {0, 0, 0}};
  for (uint32_t n = 0; n < near->count; ++n) {
    const mesh_push p = push_out_of_face(w, t, near->face[n], path, skin);
    if (p.depth <= COLLIDER_DEPTH_MIN || p.time > first.time ||
        (p.time == first.time && p.depth <= first.depth))
      continue;
    first = p;
  }
  return first;
}
