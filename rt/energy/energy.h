/* SPDX-License-Identifier: Apache-2.0 */
/* The energy ledger: what a world stores, what is supplied, and what each stage of a tick makes or
 * loses.
 *
 * A tick calls energy_stage() behind each stage. It measures the total and puts the difference
 * since the last call, less the work of bodies since then, into the row of that stage: so the rows
 * add up to the change of the total, whatever a stage does. Where it is not watched this is one
 * comparison; where FRAY_ENERGY is 0 it is nothing. README.md says what each row means. */
#ifndef FRAY_ENERGY_ENERGY_H
#define FRAY_ENERGY_ENERGY_H

#include "rt/state/world.h"

#if FRAY_ENERGY
void energy_close_stage(fray_world *w, fray_energy_stage stage);
void energy_close_wind(fray_world *w);
void energy_close_bodies(fray_world *w);
void energy_close_moves(fray_world *w);
void energy_close_velocities(fray_world *w);
void energy_add_slide(fray_world *w, vec3 by);
void energy_close_steps_of_slides(fray_world *w);
void energy_close_slides(fray_world *w);
void energy_add_step_mark(fray_world *w, uint32_t mark);
void energy_book_step(fray_world *w, vec3 gravity);
void energy_open_tick(fray_world *w);
void energy_close_tick(fray_world *w);
#define ENERGY_HOOK(call) \
  if (__builtin_expect(w->energy.watched, 0)) call
#else
#define ENERGY_HOOK(call) (void)w
#endif

static inline int energy_is_watched(const fray_world *w) {
#if FRAY_ENERGY
  return w->energy.watched;
#else
  (void)w;
  return 0;
#endif
}

/* What a stage did since the last call. */
static inline void energy_stage(fray_world *w, fray_energy_stage stage) {
  (void)stage;
  ENERGY_HOOK(energy_close_stage(w, stage));
}
/* The wind has blown. */
static inline void energy_wind(fray_world *w) { ENERGY_HOOK(energy_close_wind(w)); }
/* Bodies have moved. */
static inline void energy_bodies(fray_world *w) { ENERGY_HOOK(energy_close_bodies(w)); }
/* Particles have moved: from here on velocities are to follow what changes positions. */
static inline void energy_moves(fray_world *w) { ENERGY_HOOK(energy_close_moves(w)); }
/* Velocities have followed. */
static inline void energy_velocities(fray_world *w) { ENERGY_HOOK(energy_close_velocities(w)); }
/* Elastic yarns have pulled: until particles have moved by an elastic step, the velocity of before counts. */
static inline void energy_pulled(fray_world *w) {
  (void)w;
#if FRAY_ENERGY
  w->energy.pulled = 1;
#endif
}
static inline void energy_elastic_step(fray_world *w) {
  (void)w;
#if FRAY_ENERGY
  w->energy.pulled = 0;
  w->energy.passed += 1;
#endif
}
/* In an elastic step of yarns. */
static inline void energy_step_mark(fray_world *w, uint32_t mark) {
  (void)mark;
  ENERGY_HOOK(energy_add_step_mark(w, mark));
}
/* Behind its contact, with the gravity of the step. */
static inline void energy_step(fray_world *w, vec3 gravity) {
  (void)gravity;
  ENERGY_HOOK(energy_book_step(w, gravity));
}
/* Bend and shear springs have acted. */
static inline void energy_springs(fray_world *w) {
#if FRAY_ENERGY
  w->energy.passed = 0;
#endif
  energy_stage(w, FRAY_ENERGY_STEPS);
}
/* The gap of a contact of elastic yarns is about to change from g - by to g, by the slides of both its yarns.
 * The work of friction is k g.by, the force behind the slides times the way; the contact loses k by^2 / 2
 * more: so much the step before has stored too much, as the force was k g all along. Of both slides at once:
 * yarns of sheared cloth are not square, and the squares of two slides are not that of their sum. */
static inline void energy_slide(fray_world *w, vec3 by) {
  (void)by;
  ENERGY_HOOK(energy_add_slide(w, by));
}
/* All slides of a pass are known; and made. */
static inline void energy_slides_found(fray_world *w) { ENERGY_HOOK(energy_close_steps_of_slides(w)); }
static inline void energy_slides_made(fray_world *w) { ENERGY_HOOK(energy_close_slides(w)); }
/* A tick begins, when impulses of bodies are 0; and ends. */
static inline void energy_begin(fray_world *w) { ENERGY_HOOK(energy_open_tick(w)); }
static inline void energy_end(fray_world *w) { ENERGY_HOOK(energy_close_tick(w)); }

#endif
