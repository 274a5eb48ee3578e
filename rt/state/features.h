/* SPDX-License-Identifier: Apache-2.0 */
/* What a build can open, and what a world has. A build option of 0 leaves the code out; such a build refuses
 * images that need it (FRAY_BAD_VERSION). */
#ifndef FRAY_STATE_FEATURES_H
#define FRAY_STATE_FEATURES_H

#include <stdint.h>

#ifndef FRAY_TRIANGLES
#define FRAY_TRIANGLES 1 /* the membrane */
#endif
#ifndef FRAY_YARNS
#define FRAY_YARNS 1 /* woven cloth whose crossings split into yarns */
#endif
#ifndef FRAY_MESHES
#define FRAY_MESHES FRAY_TRIANGLES /* rigid meshes, and contacts of the membrane's triangles */
#endif
#ifndef FRAY_YARN_COLLISION
#define FRAY_YARN_COLLISION FRAY_MESHES /* self-collision of woven cloth */
#endif
#ifndef FRAY_TRIANGLE_COLLISION
#define FRAY_TRIANGLE_COLLISION (FRAY_TRIANGLES && FRAY_MESHES) /* self-collision of the membrane */
#endif
#ifndef FRAY_STRETCH
#define FRAY_STRETCH 1 /* yarns with a stiffness */
#endif
#ifndef FRAY_CRACKS
#define FRAY_CRACKS FRAY_TRIANGLES /* isotropic sheets: their law, their cracks */
#endif
#ifndef FRAY_HANDLES
#define FRAY_HANDLES (FRAY_TRIANGLES && FRAY_MESHES) /* bodies with mass between a hand and a membrane */
#endif

typedef struct {
  uint8_t membrane; /* the world is a membrane; else it is woven */
  uint8_t yarns;    /* crossings split */
  uint8_t elastic_yarns, rigid_meshes, yarn_collision, triangle_collision;
  uint8_t shear_lock; /* diagonals of woven cloth have a least length */
  uint8_t blades;   /* rigid meshes cut the membrane */
} world_features;

#endif
