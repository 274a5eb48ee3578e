/* SPDX-License-Identifier: Apache-2.0 */
/* Where the yarns of a sheet run: from end to end, a point at every crossing, a piece between two
 * points that lives or is cut. */
#ifndef FRAY_TOOLS_RENDER_YARN_AXES_H
#define FRAY_TOOLS_RENDER_YARN_AXES_H

#include "tools/render/picture_source.h"

typedef struct {
  const picture_source *source;
  v3 *normal;  /* of the cloth, per crossing, unit: from where the warp is over, out of the cloth */
  float apart; /* mm between the two yarns of a crossing that has not split */
} yarn_axes;

int yarn_axes_open(yarn_axes *a, const picture_source *source); /* 0 iff memory ran out */
void yarn_axes_close(yarn_axes *a);

/* The point of a crossing's yarn: its own particle, or, where the crossing has not split, half the
 * thickness off the node along the cloth's normal, to the side that the weave says. */
v3 yarn_axes_at(const yarn_axes *a, int axis, uint32_t crossing);
/* +1 where this yarn lies on the normal's side, else -1. */
float yarn_axes_side(const yarn_axes *a, int axis, uint32_t crossing);

typedef struct {
  const yarn_axes *axes;
  int axis;
  uint32_t number, count; /* which of its kind; points */
} yarn_path;

uint32_t yarn_paths(const picture_source *source, int axis);
yarn_path yarn_path_of(const yarn_axes *a, int axis, uint32_t number);
uint32_t yarn_path_crossing(const yarn_path *path, uint32_t point);
v3 yarn_path_at(const yarn_path *path, uint32_t point);
/* The same without the wave of the weave. */
v3 yarn_path_particle(const yarn_path *path, uint32_t point);
/* The spring between a point and the next one; UINT32_MAX behind the last. */
uint32_t yarn_path_spring(const yarn_path *path, uint32_t point);
int yarn_path_joined(const yarn_path *path, uint32_t point);
/* Per piece: as a spline through the points of the living run (Catmull and Rom's tangents). */
v3 yarn_path_tangent(const yarn_path *path, uint32_t point);

#endif
