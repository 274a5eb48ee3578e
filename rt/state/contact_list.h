/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts of one tick: particles that may touch a body before the tick ends. */
#ifndef FRAY_STATE_CONTACT_LIST_H
#define FRAY_STATE_CONTACT_LIST_H

#include "rt/base/vec.h"

enum { CONTACT_APART, CONTACT_TOUCHES, CONTACT_GROUND /* the normal is (0, 1, 0) and is not stored */ };

/* How much deeper in a body a particle may be behind a motion relative to it, at most: its length, from its
 * greatest component. */
static inline uint32_t contact_depth_made(int32_t x, int32_t y, int32_t z) {
  uint32_t most = fx_magnitude(x);
  if (fx_magnitude(y) > most) most = fx_magnitude(y);
  if (fx_magnitude(z) > most) most = fx_magnitude(z);
  return most < 1u << 30 ? 2u * most : 1u << 31;
}

/* In contact.side_mask: bodies let the particle pass in this tick. */
enum { CONTACT_RELEASED = 128 };

typedef struct {
  uint32_t particle;
  uint16_t body;
  union {
    uint16_t touching; /* in this substep: CONTACT_APART, _TOUCHES or _GROUND */
    int16_t plane_gap; /* of a mesh beside elastic yarns: see contact_plane_gap() */
  };
  vec3 normal;       /* Q30, from the body to the particle; valid for CONTACT_TOUCHES, and of meshes. Beside
                        elastic yarns, of primitives: Q28, a velocity; contact_steps_mark(), _pulled() */
} contact;

/* How far a particle is from the plane that it meets where a substep begins, Q24 lu, held to 4 lu: 12 bits
 * and an exponent, rounded down by less than 1 / 1024 of it. */
enum { CONTACT_GAP_MAX = (1 << 26) - 1, CONTACT_GAP_EXPONENT = 15 };
static inline int16_t contact_plane_gap(int64_t gap) {
  int32_t part = (int32_t)fx_clamp64(gap, -CONTACT_GAP_MAX, CONTACT_GAP_MAX);
  int32_t exponent = 0;
  for (; part >= 1 << 11 || part < -(1 << 11); part = fx_asr(part, 1)) ++exponent;
  return (int16_t)(part * 16 + exponent);
}
static inline int32_t contact_gap_of(int16_t plane_gap) {
  return fx_asr(plane_gap, 4) * (1 << (plane_gap & CONTACT_GAP_EXPONENT));
}

#endif
