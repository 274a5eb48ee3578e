/* SPDX-License-Identifier: Apache-2.0 */
/* The order of a tick. fray_tick() is in tick.c; each model has its own loop. */
#ifndef FRAY_TICK_TICK_H
#define FRAY_TICK_TICK_H

#include "rt/state/world.h"

/* Clears what belongs to one tick: *output, motion of bodies, counted work, the queue of breaks. */
void tick_start(fray_world *w, fray_output *output);
void tick_woven(fray_world *w);
void tick_membrane(fray_world *w);
/* The elastic steps of a substep of a membrane; then positions are as particles_advance() leaves them. */
void elastic_steps_run(fray_world *w, uint32_t substep);
/* Counts the tick, hashes the state, fills the output. */
void tick_report(fray_world *w, fray_output *output);

/* The same in two parts, for ticks that several workers compute: in between, the hash is taken. */
void tick_report_begin(fray_world *w, fray_output *output);
void tick_report_end(fray_world *w, uint64_t hash, fray_output *output);

#endif
