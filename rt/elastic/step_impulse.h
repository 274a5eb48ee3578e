/* SPDX-License-Identifier: Apache-2.0 */
/* Impulses of constraints within an elastic step: behind its forces, before its vertices move. Each
 * constraint sees the velocities that those before it lead to. */
#ifndef FRAY_ELASTIC_STEP_IMPULSE_H
#define FRAY_ELASTIC_STEP_IMPULSE_H

#include "rt/elastic/step_zone.h"

/* What an elastic step is, to a constraint. */
typedef struct {
  int32_t gravity[3]; /* Q28 lu per substep */
  int32_t part;       /* Q31: the step's share of the substep */
  int32_t rise;       /* Q28: see step_speed_min() */
} elastic_step;

enum {
  STEP_MASS_BITS = 16,
  STEP_RISE_UM_S = 20000 /* how fast what is beyond a limit already comes back */
};

/* Part n of a whole that is divided into so many parts: floors, which add up to the whole. */
int32_t step_part_of(int32_t whole, int32_t n, int32_t parts);

/* STEP_RISE_UM_S in Q28 lu per substep. */
int32_t step_rise_of(const fray_world *w);

/* The least speed away from a limit at this distance from it, both Q28: none that would pass it
 * within the step; from beyond it, back, at most at `rise`. */
static inline int32_t step_speed_min(int32_t gap, int32_t steps, int32_t rise) {
  FRAY_ASSERT(steps > 0 && rise >= 0);
  return (int32_t)fx_clamp64(-(int64_t)gap * steps, -INT32_MAX, rise);
}

/* Inverse mass of a vertex, Q24 of 1 / particle mass, or of what moves it. 0: nothing does. */
uint32_t step_inverse_mass(const fray_world *w, uint32_t p);
/* The same of a point between vertices, by weights in Q15 that may have signs. */
uint64_t step_point_inverse_mass(const fray_world *w, const uint32_t *vertex, const int32_t *weight,
                                 uint32_t count);
/* 1 / K in Q16 of a particle's mass, for a K in Q24 that is not 0. */
int32_t step_mass_of(uint64_t k);

/* Velocity of a body, or 0 for STEP_NO_BODY. */
vec3 step_body_velocity(const fray_world *w, uint32_t b);
/* What a sum of impulses and gravity change of the velocity of a vertex that is not attached, Q28. */
vec64 step_gained(const fray_world *w, uint32_t p, const elastic_impulse *sum, const elastic_step *step);
/* The velocity that the impulses so far lead to, Q28: of a vertex that moves itself, of what moves one. */
vec3 step_vertex_velocity(const fray_world *w, uint32_t p, const elastic_step *step);
vec3 step_velocity(const fray_world *w, uint32_t p, const elastic_step *step);
/* An impulse, Q26, on a vertex that moves itself, and on what moves one. Returns what it took: sums
 * saturate. */
vec64 step_push_vertex(fray_world *w, uint32_t p, vec64 impulse);
vec64 step_push(fray_world *w, uint32_t p, vec64 impulse);
/* A body gives the cloth an impulse, Q26; a free one feels it at once. */
void step_push_body(fray_world *w, uint32_t b, vec64 impulse);
/* The change that keeps a relative velocity from being below `least` along the normal, with Coulomb
 * friction, Q16, against what slips beside it: 0 where it is not below. */
vec3 step_contact_change(vec3 velocity, vec3 normal, int32_t least, int32_t friction);
/* A mass in Q16 times a change of velocity in Q28: Q26. */
vec64 step_impulse_of(int32_t mass, vec3 change);

#endif
