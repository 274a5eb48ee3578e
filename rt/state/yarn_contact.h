/* SPDX-License-Identifier: Apache-2.0 */
/* The contact of the two yarns of a split crossing: a place on each, which slides (woven/yarn_slip.c).
 * Contacts are numbered as the warp particles of split crossings are: contact n belongs to the crossing of
 * particle params.particles + n. */
#ifndef FRAY_STATE_YARN_CONTACT_H
#define FRAY_STATE_YARN_CONTACT_H

#include <stdint.h>

#include "rt/state/spring.h"

/* Places along a yarn: Q20 spacings from half a spacing before its first particle, so that the whole part is
 * the number of the nearest particle. Beyond a yarn's end or a break there is a quarter of a spacing more:
 * crossings stand for the cloth half a spacing around them. */
enum {
  YARN_PLACE_BITS = 20,
  YARN_PLACE_ONE = 1 << YARN_PLACE_BITS,
  YARN_PLACE_HALF = YARN_PLACE_ONE / 2,
  YARN_PLACE_BEYOND = YARN_PLACE_ONE / 4
};

/* The place of a yarn's particle k, and how far a place is from its nearest particle, +-1/2. */
static inline uint32_t yarn_place_of(uint32_t k) {
  return (k << YARN_PLACE_BITS) + (uint32_t)YARN_PLACE_HALF;
}
static inline int32_t yarn_place_past(uint32_t place) {
  return (int32_t)(place & ((uint32_t)YARN_PLACE_ONE - 1u)) - YARN_PLACE_HALF;
}
static inline uint32_t yarn_place_moved(uint32_t place, int32_t by) {
  return by < 0 ? place - (uint32_t)-by : place + (uint32_t)by;
}
/* Both on one yarn. */
static inline uint32_t yarn_places_apart(uint32_t a, uint32_t b) { return a < b ? b - a : a - b; }

enum { YARN_OFFSET_MAX = 1 << 22, YARN_PRESSED_MAX = 1 << 24 };

/* State; all words are 0 once the crossing is disconnected. */
typedef struct {
  uint32_t place[2]; /* by fray_axis: on its weft, on its warp */
  int32_t offset[3]; /* Q24 lu, +-YARN_OFFSET_MAX: what the yarns were apart, from weft to warp; it fades */
  uint32_t grip;     /* yarn_contact_pressed() << 2 | 1 << axis, where it slid along the yarn in this tick */
} yarn_contact;

/* Force that presses the yarns, as the length in Q24 lu that the contact gives way by. */
static inline int32_t yarn_contact_pressed(const yarn_contact *c) { return (int32_t)(c->grip >> 2); }

/* A neighbour along a yarn: another contact, by its number; a crossing that is whole, by its number on the
 * yarn; or none. */
#define YARN_NEIGHBOUR_WHOLE ((index_t)(1u << (sizeof(index_t) * 8u - 1u)))
#define YARN_NEIGHBOUR_NONE ((index_t)~(index_t)0)

/* Of one tick. */
typedef struct {
  index_t number[2];    /* of its weft and its warp: a contact is on weft number[0] */
  index_t neighbour[4]; /* by direction, see yarn_grid_step() */
  int32_t limit[2];     /* Q20 spacings: what friction holds along a yarn; YARN_CONTACT_FIXED */
  uint32_t next[2];     /* places after this substep */
  int32_t impulse[3];   /* on the weft, in half crossings: Q24 lu a substep, of elastic yarns Q28 lu per
                         * substep; the warp gets the opposite */
  int32_t quiet[3];     /* the same, of what moves them without changing a velocity. Gap before breaks */
} yarn_contact_step;

#define YARN_CONTACT_FIXED INT32_MAX

enum { YARN_CONTACT_WORDS = sizeof(yarn_contact) / 4 };

#endif
