/* SPDX-License-Identifier: Apache-2.0 */
/* Motion of particles and rigid bodies: explicit Euler for positions, and velocities from what projections
 * and collisions made of them (Metaaphanon 2009, section 4, steps 1, 2, 4 and 8). */
#ifndef FRAY_INTEGRATE_INTEGRATE_H
#define FRAY_INTEGRATE_INTEGRATE_H

#include "rt/state/world.h"

/* The gravity of this substep; moves driven bodies along their way through the tick, and, beside projected
 * yarns, free ones by their velocity: else they move in elastic steps. substep: 0 to params.substeps - 1, in
 * order. */
void bodies_advance(fray_world *w, uint32_t substep);
/* Free bodies beside elastic yarns, in 2^more elastic steps a substep: they gain the step's part of gravity
 * and move by their velocity. bodies_step() returns 1 iff there are any. */
void bodies_steps_begin(fray_world *w, unsigned more);
int bodies_step(fray_world *w, vec3 gravity, unsigned more);
void bodies_steps_end(fray_world *w, unsigned more);
/* Free bodies gain the opposite of what the cloth gained from them in this substep. */
void bodies_update_velocity(fray_world *w);
/* The same of one, for what it gained since the last call. */
void body_update_velocity(fray_world *w, uint32_t b);
/* A free body gains an impulse along an axis, Q28, at most 2^46, that the cloth has no part in. */
void body_gain(fray_world *w, uint32_t b, uint32_t axis, int64_t impulse);

/* Free particles gain gravity and move by their velocity; predicted = position. */
void particles_advance(fray_world *w);
/* Attached particles move with their bodies. */
void particles_carry(fray_world *w);
/* Velocities take over the displacement of positions from their predictions. */
void particles_update_velocity(fray_world *w);
/* Once a tick, in its last substep: what projections pushed past the edge of the world comes back to
 * FX_EDGE_MAX, so that every saved world opens. Later stages keep to that. */
void particles_hold(fray_world *w);

/* The same of particles first to end - 1, for ticks that several workers compute. */
void particles_advance_range(fray_world *w, uint32_t first, uint32_t end);
void particles_update_velocity_range(fray_world *w, uint32_t first, uint32_t end);
void particles_hold_range(fray_world *w, uint32_t first, uint32_t end);

#endif
