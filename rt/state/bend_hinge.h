/* SPDX-License-Identifier: Apache-2.0 */
/* Per-tick constants of a bending hinge, an edge shared by two triangles: see membrane/bend_prepare.c. */
#ifndef FRAY_STATE_BEND_HINGE_H
#define FRAY_STATE_BEND_HINGE_H

#include "rt/state/material.h"

enum {
  HINGE_REACH = FX_LU * 16, /* Q28: corners farther apart along an axis are taken as a lu apart */
  HINGE_MIN = 1 << 16       /* Q56: squared areas and edges below that are degenerate */
};

typedef struct {
  uint32_t vertex[4];                 /* opposite the edge in each triangle, then its ends, 3 and 4 */
  int32_t stiffness[MATERIAL_CURVES]; /* by curvature: impulse times height over sin(t/2), Q34 */
  int32_t curvature_scale;            /* curvature over sin(t/2), Q22 of the steps of `stiffness` */
  int32_t height[2];                  /* inverse of the first two's heights over the edge, Q16 of 1 / lu */
  int32_t foot[2];                    /* of these heights on the edge, Q24: 0 at its end 4, 1 at its end 3 */
} bend_hinge;

/* The number of the material, which curvature_scale holds until bend_prepare() has computed it. */
static inline void bend_hinge_set_material(bend_hinge *c, uint8_t material) { c->curvature_scale = material; }
static inline uint32_t bend_hinge_material(const bend_hinge *c) { return (uint32_t)c->curvature_scale; }

/* A triangle has three edges, each in common with another one. */
typedef struct {
  uint32_t words[3 * sizeof(bend_hinge) / 2 / sizeof(uint32_t)];
} bend_hinge_per_triangle;

#endif
