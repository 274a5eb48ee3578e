/* SPDX-License-Identifier: Apache-2.0 */
/* Model 1, woven cloth (Metaaphanon, Bando, Chen, Nishita 2009): the stages of its tick, in their order.
 * Sections, steps and equations named in this folder are the paper's.
 *
 * Every stage takes a world that is woven (no membrane) and changes nothing but its arguments. Costs are per
 * call; fray_work counts the same. */
#ifndef FRAY_WOVEN_WOVEN_H
#define FRAY_WOVEN_WOVEN_H

#include "rt/state/world.h"

/* Once a tick, before the substeps. Velocities are Q28 lu per substep. */

/* Marks the ends of links that are drawn too far, for world_is_released(); where there are any,
 * tethers_apply(). Needs projected links. Cost: linear in the links, where overstretched_links_may_be(). */
void overstretched_links_apply(fray_world *w);
/* Stops free bodies that are farther from what holds whole cloth than it reaches. Cost: linear in the
 * crossings for each free body. */
void tethers_apply(fray_world *w);
/* 1 iff a body has a surface, or moves. */
int overstretched_links_may_be(const fray_world *w);
/* Relative damping and drag (step 3). Cost: linear in the particles. */
void damp_apply(fray_world *w);
/* Bend and shear springs, explicit (section 3.2); of elastic yarns once a substep, else waves of those would
 * grow. Cost: linear in the springs that are not links. */
void bend_shear_apply(fray_world *w);
/* Finds the neighbours of the contacts of yarns, and what friction holds of each. Needs yarns. Cost: linear
 * in the split crossings; neighbours are looked for over disconnected crossings, each of which is passed
 * four times at most. */
void yarn_grip_update(fray_world *w);

/* Each substep. */

/* Moves the particles of elastic yarns, instead of particles_advance(); slides their crossings in each
 * elastic step. Cost: elastic steps times (links + particles + split crossings). */
void yarn_stretch_run(fray_world *w);
/* Projects structural links (section 4.1), then diagonals shorter than a shear lock allows. Cost: iterations
 * times links, and diagonals of worlds with a lock. */
void strain_limit_apply(fray_world *w);
/* Keeps the yarns of split crossings together and slides them along each other (instead of section 3.3's
 * equation 1). Of elastic yarns yarn_stretch_run() calls it. Needs yarns. Cost: linear in the split
 * crossings. */
void yarn_slip_apply(fray_world *w);

/* Once a tick, in the last substep, between collisions and velocities (step 7). */

/* Marks crossings that are to split or to become loose, disconnects those too far apart (section 3.4). Needs
 * yarns. Cost: linear in the links and the split particles. */
void crossing_transition_find(fray_world *w);
/* Applies the marks, at most capacity[POOL_SPLITS] of them. Needs yarns. Cost: linear in the crossings while
 * any is marked, else constant. */
void crossing_split_apply(fray_world *w);
/* Fills the tear queue with springs over their tear strain. Cost: linear in the links, and the logarithm of
 * tears_max for each of those found. */
void spring_tear_find(fray_world *w);
/* Around breaks: contacts of yarns stay on what is left, and keep their force. Needs yarns. Cost: linear in
 * the split crossings in a tick that breaks springs, else constant. */
void yarn_slip_before_breaks(fray_world *w);
void yarn_slip_after_breaks(fray_world *w);
/* Breaks the springs of the queue, and releases bend and shear springs around them. Cost: linear in
 * tear_count. */
void spring_break_apply(fray_world *w);
/* The canonical id of the queued spring farthest over its tear strain. tear_count is not 0. Cost: linear in
 * tear_count. */
uint32_t spring_tear_worst(const fray_world *w);

/* Ranges of stages, for ticks computed by several workers (rt/workers): all ranges in order do what the
 * stage does. first <= end. */
void damp_begin(fray_world *w); /* relative damping, of all particles */
/* Drag of particles first..end-1, none attached. */
void damp_range(fray_world *w, uint32_t first, uint32_t end);
/* Springs first..end-1 of batch b: link_batches <= b < capacity[POOL_BATCHES]. */
void bend_shear_range(fray_world *w, uint32_t b, uint32_t first, uint32_t end);
/* One iteration of the links of batches b..batches-1; batches <= link_batches. */
void strain_limit_range(fray_world *w, uint32_t b, uint32_t batches);
/* Links first..end-1; end <= params.links. */
void spring_tear_find_range(fray_world *w, uint32_t first, uint32_t end);

#endif
