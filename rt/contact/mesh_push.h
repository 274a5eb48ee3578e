/* SPDX-License-Identifier: Apache-2.0 */
/* The way out of a rigid mesh for the path of a particle, see contact_vertices.c. */
#ifndef FRAY_CONTACT_MESH_PUSH_H
#define FRAY_CONTACT_MESH_PUSH_H

#include "rt/contact/collider.h"

/* A push of a path's end: when the path came near, how deep it ends, the way out. */
typedef struct {
  int32_t time;  /* Q15 */
  int32_t depth; /* Q24 lu */
  vec3 out;      /* Q30 */
} mesh_push;

/* The first push along the path out of the listed faces, to a distance of `skin`; of several at one
 * time the deepest; depth is 0 where there is none. */
mesh_push mesh_push_first(fray_world *w, const collider *t, const collider_near *near,
                          const ccd_path *path, int32_t skin);

#endif
