/* SPDX-License-Identifier: Apache-2.0 */
/* A crack goes on in any direction through the trimesh, and leaves stout triangles: trimesh_advance.c has the
 * way, trimesh_snap.c the vertex that moves onto it. */
#ifndef FRAY_TRIMESH_TRIMESH_ADVANCE_H
#define FRAY_TRIMESH_TRIMESH_ADVANCE_H

#include "rt/trimesh/trimesh_split.h"

typedef enum { TRIMESH_ALONG, TRIMESH_SNAPPED, TRIMESH_DIVIDED } trimesh_way;

typedef struct {
  uint32_t end;         /* vertex up to which an edge was opened */
  int end_was_boundary; /* it has met a boundary: no tip */
  trimesh_way way;
} trimesh_step;

/* From a vertex to the edge ahead, between the ends of its ring edges n and n + 1. */
typedef struct {
  uint32_t vertex;
  trimesh_ring ring;
  uint32_t n, fraction; /* Q16 of that edge */
  uint32_t norm2_most;  /* of the triangles that it makes, see trimesh_is_stout() */
  uint32_t end[2];
  int can_open[2];
} trimesh_path;

/* A vertex that moves along an edge, at rest and in space, and what that makes of its one-ring. */
typedef struct {
  uint32_t vertex;
  trimesh_ring ring; /* closed */
  trimesh_point at;
  int64_t place[3];     /* Q28 lu */
  int32_t predicted[3]; /* Q24 lu */
  uint32_t area[TRIMESH_RING_MAX];
  int32_t velocity[3], remainder[3];
} trimesh_snap;

/* The way in the direction (du, dv) of rest coordinates, |du|, |dv| <= 2^30; norm2_most: any, for
 * trimesh_is_stout(). TRIMESH_NO_PATH, or the pool that has no room for a step of it. Cost: a one-ring. */
trimesh_result trimesh_path_find(const fray_world *w, uint32_t vertex, int32_t du, int32_t dv,
                                 uint32_t norm2_most, trimesh_path *path);

/* End m of the edge ahead moves onto the path. Returns 0 where none has to, it is too far, or
 * trimesh_snap_plan() says no. */
int trimesh_path_snap(const fray_world *w, const trimesh_path *path, uint32_t m, trimesh_snap *snap);
static inline uint32_t trimesh_path_nearer(const trimesh_path *path) {
  return path->fraction < TRIMESH_WEIGHT_ONE / 2 ? 0 : 1;
}

/* Opens an edge along a path that was just found: up to the vertex that moves onto it, if there is one (else
 * NULL). If not, the edge ahead is divided there, if the parts are stout; else an edge beside it is taken.
 * Cost: a one-ring, and trimesh_open_edge(). */
trimesh_result trimesh_path_open(fray_world *w, const trimesh_path *path, const trimesh_snap *snap,
                                 trimesh_mark mark, trimesh_step *step);

/* No angle is below 15 degrees, the triangle is no sliver, and its trimesh_norm2() is at most this. */
int trimesh_is_stout(const trimesh *s, uint32_t norm2_most, trimesh_point a, trimesh_point b,
                     trimesh_point c);

/* A free vertex inside of the sheet moves along its edge to vertex `to`, at `fraction` of the way, Q16. Areas
 * of its one-ring are shared out anew, the largest triangle takes what rounding leaves; its velocity is that
 * which keeps the momentum, which rounding leaves to momentum_remainder. Returns 0 where a triangle would not
 * be stout, or the velocity out of range. */
int trimesh_snap_plan(const fray_world *w, uint32_t vertex, uint32_t to, uint32_t fraction,
                      uint32_t norm2_most, trimesh_snap *p);
/* In the format of trimesh.mass: of the vertex at the end of ring edge n. */
int32_t trimesh_snap_mass_gained(const trimesh *s, const trimesh_snap *p, uint32_t n);
void trimesh_snap_apply(fray_world *w, const trimesh_snap *p);

#endif
