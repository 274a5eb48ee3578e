/* SPDX-License-Identifier: Apache-2.0 */
/* Contact makes no energy, whatever the order of its constraints and whether or not they undo each other.
 *
 * An impulse J of a leapfrog step adds J (v- + v+) / 2 to the energy, with the velocity where it acts
 * before the step's forces, v-, and behind all impulses, v+. With c half of what forces change of that and
 * u = v - c, all impulses of a step add what the sum of m u^2 / 2 changes by. So each is booked when it is
 * given: what takes energy fills an energy tank, what needs some has as much as is left there. Stiff cloth
 * that rings against a body fills it in one tick and needs it in another, so the tank is state; it leaks a
 * sixteenth each tick, lest what was taken long ago comes back at once. */
#ifndef FRAY_ELASTIC_STEP_PASSIVE_H
#define FRAY_ELASTIC_STEP_PASSIVE_H

#include "rt/elastic/step_impulse.h"

/* Before the first elastic step of a tick. */
void step_passive_begin(fray_world *w);
/* Behind the forces of a step. */
void step_passive_mark(fray_world *w);

/* c, Q28 lu per substep: of a vertex that moves itself, of what moves one, of a body; 0 for STEP_NO_BODY. */
vec3 step_vertex_half_of(const fray_world *w, uint32_t p, const elastic_step *step);
vec3 step_half_of(const fray_world *w, uint32_t p, const elastic_step *step);
vec3 step_body_half_of(const fray_world *w, uint32_t b);

/* Along a line: the speed nearest to `wanted` that leaves |u| no larger, from `speed`, with `half` of c. */
int32_t step_passive_speed(int32_t wanted, int32_t speed, int32_t half);
/* The part of a change of u that the tank pays for, and books it; `mass` in Q16 of a particle's mass. */
vec3 step_passive_change(fray_world *w, int32_t mass, vec3 u, vec3 change);

#endif
