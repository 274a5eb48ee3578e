/* SPDX-License-Identifier: Apache-2.0 */
/* The message table of the bus: the one place that knows ids, lengths and cycle times.
 * fray.dbc says the same for instance 0; tests/unit/test_dbc.c holds the two together.
 * The format is frozen: see README.md. */
#ifndef FRAY_WIRE_DICTIONARY_H
#define FRAY_WIRE_DICTIONARY_H

#include <stdint.h>

typedef enum {
  MESSAGE_SYNC,
  MESSAGE_COMMAND,
  MESSAGE_ACK,
  MESSAGE_POSE_LEFT,
  MESSAGE_POSE_RIGHT,
  MESSAGE_FORCE_LEFT,
  MESSAGE_FORCE_RIGHT,
  MESSAGE_TEAR,
  MESSAGE_STATUS,
  MESSAGES /* none of them */
} dictionary_message;

enum {
  DICTIONARY_INSTANCES = 8, /* runtimes on one bus */
  DICTIONARY_LENGTH = 8,    /* bytes of every message */
  DICTIONARY_POSE_UM = 2,   /* micrometres a step: +-65.534 mm */
  DICTIONARY_FORCE_UN = 500, /* micronewtons a step: +-16.3835 N */
  DICTIONARY_NO_E2E = 0xFF
};

typedef struct {
  uint16_t id;       /* of instance 0 */
  uint8_t id_step;   /* from instance to instance */
  uint8_t e2e_kind;  /* row of the id-list bases, or DICTIONARY_NO_E2E */
  uint16_t cycle_ms; /* at 1 kHz; 0: on an event */
} dictionary_entry;

static const dictionary_entry DICTIONARY[MESSAGES] = {
    [MESSAGE_SYNC] = {0x080, 1, DICTIONARY_NO_E2E, 1},
    [MESSAGE_COMMAND] = {0x010, 2, 4, 0},
    [MESSAGE_ACK] = {0x011, 2, 5, 0},
    [MESSAGE_POSE_LEFT] = {0x101, 16, 0, 1},
    [MESSAGE_POSE_RIGHT] = {0x102, 16, 1, 1},
    [MESSAGE_FORCE_LEFT] = {0x181, 16, 2, 1},
    [MESSAGE_FORCE_RIGHT] = {0x182, 16, 3, 1},
    [MESSAGE_TEAR] = {0x200, 1, DICTIONARY_NO_E2E, 0},
    [MESSAGE_STATUS] = {0x701, 1, DICTIONARY_NO_E2E, 100},
};

/* The 11-bit id of a message of instance 0..7. */
static inline uint32_t dictionary_id(dictionary_message message, uint32_t instance) {
  return (uint32_t)DICTIONARY[message].id + (uint32_t)DICTIONARY[message].id_step * instance;
}

/* Which message of this instance an 11-bit id is; MESSAGES iff none. */
static inline dictionary_message dictionary_find(uint32_t id, uint32_t instance) {
  for (uint32_t m = 0; m < (uint32_t)MESSAGES; ++m) {
    if (dictionary_id((dictionary_message)m, instance) == id) return (dictionary_message)m;
  }
  return MESSAGES;
}

/* Base of a message's id list: all 48 differ, and fit a byte (236 at most). */
static inline uint8_t dictionary_e2e_base(dictionary_message message, uint32_t instance) {
  const uint32_t index = (uint32_t)DICTIONARY[message].e2e_kind * 8u + instance;
  return (uint8_t)(1u + 5u * index);
}

/* hand 0 is left, 1 is right. */
static inline dictionary_message dictionary_pose(uint32_t hand) {
  return hand == 0 ? MESSAGE_POSE_LEFT : MESSAGE_POSE_RIGHT;
}
static inline dictionary_message dictionary_force(uint32_t hand) {
  return hand == 0 ? MESSAGE_FORCE_LEFT : MESSAGE_FORCE_RIGHT;
}

#endif
