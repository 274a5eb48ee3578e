/* SPDX-License-Identifier: Apache-2.0 */
/* Sliding contacts of yarns (state/yarn_contact.h): what the stages around yarn_slip_apply() share. n is a
 * contact in use, below yarn_counts->split. */
#ifndef FRAY_WOVEN_YARN_SLIP_H
#define FRAY_WOVEN_YARN_SLIP_H

#include "rt/state/yarn_touch.h"

/* Contacts of a yarn that are nearer than that push each other on along it: half a spacing, Q20. */
enum { YARN_SLIP_NEAR = YARN_PLACE_HALF };

/* From a contact to its neighbour in a direction (state/yarn_grid.h), Q20 spacings, at most some. Cost:
 * constant. */
int32_t yarn_slip_distance(const fray_world *w, uint32_t n, uint32_t direction);

/* 1 iff friction holds what a whole crossing carries from yarn to yarn: half of what the sums of their links'
 * forces differ by. Cost: as yarn_grip_update() of one contact. */
int yarn_grip_holds(const fray_world *w, uint32_t crossing);

/* The contact of a crossing that has just split: what its yarns are apart in bent cloth is its offset. Cost:
 * constant. */
void yarn_slip_begin(fray_world *w, uint32_t n);

#endif
