/* SPDX-License-Identifier: Apache-2.0 */
/* Triangles of the membrane against one rigid mesh or sphere. Called by contact_vertices.c, which has
 * set side_mask of every vertex by collider_sides(). */
#ifndef FRAY_CONTACT_CONTACT_TRIANGLES_H
#define FRAY_CONTACT_CONTACT_TRIANGLES_H

#include "rt/contact/collider.h"

enum { CONTACT_TRIANGLES_FREE = 0xFFFF }; /* instead of a body: no attached vertex is in the way */

/* Adds the constraints of triangles that come within the thickness and `room` of the body. *budget: how many
 * triangles may be tested still. */
void contact_triangles_constrain(fray_world *w, const collider *t, int32_t room, uint32_t *budget);
/* Pins triangles that cross the body. Returns how many; *budget: how many may be tested; *holder:
 * CONTACT_TRIANGLES_FREE, or the body that holds vertices which would have to move for this one. */
uint32_t contact_triangles_check(fray_world *w, const collider *t, uint32_t *budget, uint32_t *holder);
/* Pins every triangle near the body. */
void contact_triangles_pin(fray_world *w, const collider *t);

#endif
