/* SPDX-License-Identifier: Apache-2.0 */
/* Colliders as paths of the cloth see them: rigid meshes, and spheres where triangles of the membrane
 * meet them. A path runs from the position at the start of the substep to the current one. Bodies only
 * translate, so paths are taken relative to the body, which is then at rest. */
#ifndef FRAY_CONTACT_COLLIDER_H
#define FRAY_CONTACT_COLLIDER_H

#include "rt/geometry/ccd.h"
#include "rt/state/rigid_mesh.h"

enum {
  COLLIDER_DEPTH_MIN = 4,   /* depth that rounding leaves of a push */
  COLLIDER_SKIN_MIN = 1024, /* of cloth without thickness: it does not touch */
  COLLIDER_PLANE_MARGIN = 64, /* Q24 lu: more than the error of a normal over the world's width */
  COLLIDER_SLIDE_MAX = 16 * FX_LU
};

/* Bits of contact.side_mask: sides of the collider's box beyond which the whole path of a particle
 * stays. What several particles have in common keeps everything between them away as well. CONTACT_RELEASED
 * stays for the tick. */
enum { COLLIDER_SIDES = 63, COLLIDER_PINNED = 64 };

/* A body in this substep. */
typedef struct {
  uint32_t body;
  int32_t radius;        /* of a sphere, which is a point with this thickness; 0: a mesh */
  int32_t sharp;         /* of a mesh: it cuts */
  rigid_mesh_parts m;    /* of a mesh */
  rigid_mesh_box bounds;
  vec3 start, now;       /* positions of the body */
} collider;

/* Triangles of a mesh near a path. */
typedef struct {
  uint32_t count;
  int has_more; /* than are listed */
  uint16_t face[RIGID_MESH_CLOSE];
} collider_near;

typedef struct {
  int32_t low[3], high[3];
} collider_box;

/* n below collider_count(): meshes first, then spheres, each in the order of bodies. */
collider collider_at(const fray_world *w, uint32_t n);
/* Distance that the cloth keeps from colliders. */
int32_t collider_skin(const fray_world *w);

/* Triangles at a blade cut, and vertices that only have such triangles, let sharp meshes pass. */
static inline int collider_passes_triangle(const fray_world *w, const collider *t, uint32_t triangle) {
  return t->sharp != 0 && trimesh_is_passing_blade(&w->trimesh, triangle);
}
static inline int collider_passes_vertex(const fray_world *w, const collider *t, uint32_t p) {
  return t->sharp != 0 && w->membrane.passing_blade[p] != 0;
}

/* All three vertices stay beyond one side of the collider's box, by side_mask: so does the triangle. */
static inline int collider_misses(const fray_world *w, uint32_t triangle) {
  const index_t *v = w->trimesh.triangle[triangle].v;
  const uint8_t *mask = w->contact.side_mask;
  return (mask[v[0]] & mask[v[1]] & mask[v[2]] & COLLIDER_SIDES) != 0;
}
/* A vertex of the triangle is attached to the body. */
static inline int collider_holds(const fray_world *w, const collider *t, uint32_t triangle) {
  const index_t *v = w->trimesh.triangle[triangle].v;
  for (uint32_t k = 0; k < 3; ++k)
    if (v[k] < particles_attached(w) && w->p.attach_body[v[k]] == t->body) return 1;
  return 0;
}

/* The path of a particle in this substep, relative to the body. */
static inline ccd_path collider_path(const fray_world *w, const collider *t, uint32_t p) {
  FRAY_ASSERT(p < w->p.count);
  const contact_state *c = &w->contact;
  const ccd_path path = {vec_sub(vec_at(c->start_x, c->start_y, c->start_z, p), t->start),
                         vec_sub(world_position(w, p), t->now)};
  return path;
}
static inline int collider_path_is_point(const ccd_path *path) {
  return vec_is_equal(path->begin, path->end);
}

/* Around paths, widened by `skin`. */
collider_box collider_box_of(const ccd_path *paths, uint32_t count, int32_t skin);
static inline int collider_overlap(const collider_box *s, const rigid_mesh_box *b) {
  return s->low[0] <= b->high[0] && s->high[0] >= b->low[0] && s->low[1] <= b->high[1] &&
         s->high[1] >= b->low[1] && s->low[2] <= b->high[2] && s->high[2] >= b->low[2];
}
static inline int collider_contains(const collider_box *s, vec3 v) {
  return v.x >= s->low[0] && v.x <= s->high[0] && v.y >= s->low[1] && v.y <= s->high[1] &&
         v.z >= s->low[2] && v.z <= s->high[2];
}

/* Farther from the body than CCD allows. Differences go to 122 lu, CCD to 60; a mesh is within 16 lu of
 * its body, so only absurd speeds lead there. */
static inline int collider_is_far(vec3 v) {
  return v.x < -FX_WORLD_MAX || v.x > FX_WORLD_MAX || v.y < -FX_WORLD_MAX || v.y > FX_WORLD_MAX ||
         v.z < -FX_WORLD_MAX || v.z > FX_WORLD_MAX;
}

/* Sides of the collider's box, widened by `skin`, beyond which the whole path stays, a bit each; 0: it
 * may be near. */
uint8_t collider_sides(const collider *t, const ccd_path *path, int32_t skin);
/* The same for side_mask: vertices that let the blade pass are nowhere near, nor is what bodies let pass. */
static inline uint8_t collider_mask_of(const fray_world *w, const collider *t, uint32_t p,
                                       const ccd_path *path, int32_t skin) {
  if (world_is_released(w, p)) return CONTACT_RELEASED | COLLIDER_SIDES;
  return collider_passes_vertex(w, t, p) ? (uint8_t)COLLIDER_SIDES : collider_sides(t, path, skin);
}

/* Lists the triangles of a mesh with boxes that overlap the span: as many as `max` and RIGID_MESH_VISITS
 * boxes allow. */
void collider_list_near(fray_world *w, const collider *t, const collider_box *s, uint32_t max,
                        collider_near *near);

/* 1 if the path of a particle touches the mesh, or may; of listed triangles only. Where a membrane is near
 * more than are listed it passes the others, and a fault says so. */
int collider_crosses(fray_world *w, const collider *t, const ccd_path *path);
int collider_crosses_near(fray_world *w, const collider *t, const collider_near *near, const ccd_path *path);
/* CCD of a particle's path and one triangle. */
int collider_ccd(fray_world *w, const collider *t, uint32_t face, const ccd_path *path, int32_t skin,
                 ccd_contact *c);

/* Distance from the plane of a triangle of the mesh. */
static inline int32_t collider_gap(const collider *t, uint32_t face, vec3 at) {
  const vec3 normal = vec_of(t->m.faces[face].normal);
  return vec_dot_unit(vec_sub(at, rigid_mesh_corner(&t->m, face, 0)), normal);
}

/* Those of both ends of a path. */
typedef struct {
  int32_t begin, end;
} collider_gaps;
static inline collider_gaps collider_gaps_of(const collider *t, uint32_t face, const ccd_path *path) {
  const collider_gaps g = {collider_gap(t, face, path->begin), collider_gap(t, face, path->end)};
  return g;
}
/* Both ends are on one side of the plane, at least `margin` away. */
static inline int collider_is_on_one_side(collider_gaps g, int32_t margin) {
  return (g.begin >= margin && g.end >= margin) || (g.begin <= -margin && g.end <= -margin);
}

/* `at`, moved by `depth` along a unit vector. */
vec3 collider_pushed(vec3 at, vec3 out, int32_t depth);
/* Moves a particle to a position relative to the body; the body gets the opposite of the momentum gained. */
void collider_place(fray_world *w, const collider *t, uint32_t p, vec3 relative);
/* Moves a particle back to where its path began, relative to the body. */
void collider_pin(fray_world *w, const collider *t, uint32_t p, const ccd_path *path);
/* Returns 0 where the pool is full. */
int collider_add_contact(fray_world *w, const collider *t, uint32_t p, vec3 out);
/* What friction takes back of a path's motion after a push of this depth along `out`. */
vec3 collider_friction(const fray_world *w, const collider *t, vec3 moved, vec3 out, int32_t depth);

#endif
