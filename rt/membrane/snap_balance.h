/* SPDX-License-Identifier: Apache-2.0 */
/* A vertex that snaps onto the path of a crack makes the field around it another one, which mostly stores
 * more than the one that was in balance. The edge that opens behind it has a force to give: its two sides
 * part by as much as pays for that, and where they cannot there is no snap. */
#ifndef FRAY_MEMBRANE_SNAP_BALANCE_H
#define FRAY_MEMBRANE_SNAP_BALANCE_H

#include "rt/trimesh/trimesh_advance.h"

/* How far the vertex at the beginning of the path moves, and the one that it gives to the other side; Q28 lu,
 * below 1/2 lu. */
typedef struct {
  vec3 side[2];
} snap_parting;

/* Returns 1 iff the snap, the edge that opens up to it and the parting, which may be none, together make no
 * energy: that of stress and of motion. Cost: 56 to 180 stresses of triangles. */
int snap_balance(const fray_world *w, const trimesh_path *path, const trimesh_snap *snap,
                 snap_parting *parting);

/* The edge has opened, and `added` is the new vertex of its second side. */
void snap_part(fray_world *w, uint32_t vertex, uint32_t added, const snap_parting *parting);

#endif
