/* SPDX-License-Identifier: Apache-2.0 */
/* The message table of the bus. This header and dictionary.c alone have ids, lengths and cycle times;
 * signals.h adds names, bits, units and comments for people and tools. fray.dbc and the tables of README.md
 * are written from the two (tests/unit/test_dictionary.c), and the codec is tested against fray.dbc
 * (tests/unit/test_dbc.c). The format is frozen; README.md says how it may grow.
 *
 * Contract of all functions here. Context: any thread or interrupt, at the same time too: the table is
 * constant. NULL: no pointer is taken. instance: 0..7, a runtime on the bus. hand: 0 is left, 1 is right.
 * Errors: none but the result. */
#ifndef FRAY_WIRE_DICTIONARY_H
#define FRAY_WIRE_DICTIONARY_H

#include <stdint.h>

#include "rt/base/assert.h"

#ifdef __cplusplus
extern "C" {
#endif

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
  MESSAGE_COMMAND_AUTH, /* the protected forms, see auth.h */
  MESSAGE_ACK_AUTH,
  MESSAGE_POSE_LEFT_AUTH,
  MESSAGE_POSE_RIGHT_AUTH,
  MESSAGE_FORCE_LEFT_AUTH,
  MESSAGE_FORCE_RIGHT_AUTH,
  MESSAGE_TAG_LEFT,
  MESSAGE_TAG_RIGHT,
  MESSAGE_IDENTITY,
  MESSAGES /* their number; as a result: none */
} dictionary_message;

enum {
  DICTIONARY_INSTANCES = 8, /* runtimes on one bus */
  DICTIONARY_LENGTH = 8,    /* bytes of every message but the protected forms */
  DICTIONARY_LENGTH_AUTH = 20, /* of those, CAN FD only */
  DICTIONARY_POSE_UM = 2,   /* micrometres a step: +-65.534 mm */
  DICTIONARY_FORCE_UN = 500, /* micronewtons a step: +-16.3835 N */
  DICTIONARY_NO_E2E = 0xFF
};

typedef struct {
  uint16_t id;       /* of instance 0 */
  uint8_t id_step;   /* between the ids of two instances */
  uint8_t e2e_kind;  /* number of its id list, or DICTIONARY_NO_E2E; a protected form carries the check of the
                        message that it protects */
  uint16_t cycle_ms; /* at a rate of 1 kHz; 0: sent on an event */
  uint8_t protects;  /* of a protected form: the message that it carries; else MESSAGES */
} dictionary_entry;

extern const dictionary_entry DICTIONARY[MESSAGES];

/* The 11-bit id of a message, which is not MESSAGES. Cost: constant. */
static inline uint32_t dictionary_id(dictionary_message message, uint32_t instance) {
  FRAY_ASSERT(message < MESSAGES);
  FRAY_ASSERT(instance < DICTIONARY_INSTANCES);
  return (uint32_t)DICTIONARY[message].id + (uint32_t)DICTIONARY[message].id_step * instance;
}

/* The message of this instance with that id; MESSAGES iff there is none. id: any. Cost: 18 comparisons. */
static inline dictionary_message dictionary_find(uint32_t id, uint32_t instance) {
  FRAY_ASSERT(instance < DICTIONARY_INSTANCES);
  for (uint32_t m = 0; m < (uint32_t)MESSAGES; ++m) {
    if (dictionary_id((dictionary_message)m, instance) == id) return (dictionary_message)m;
  }
  return MESSAGES;
}

/* Base of the id list of a message with an E2E check: all 48 differ and fit a byte (236 at most).
 * Cost: constant. */
static inline uint8_t dictionary_e2e_base(dictionary_message message, uint32_t instance) {
  FRAY_ASSERT(message < MESSAGES && DICTIONARY[message].e2e_kind != DICTIONARY_NO_E2E);
  FRAY_ASSERT(instance < DICTIONARY_INSTANCES);
  const uint32_t index = (uint32_t)DICTIONARY[message].e2e_kind * 8u + instance;
  return (uint8_t)(1u + 5u * index);
}

/* Bytes of a message, which is not MESSAGES. Cost: constant. */
static inline uint32_t dictionary_length(dictionary_message message) {
  FRAY_ASSERT(message < MESSAGES);
  return DICTIONARY[message].protects != MESSAGES ? DICTIONARY_LENGTH_AUTH : DICTIONARY_LENGTH;
}

/* The protected form of a message; MESSAGES iff it has none, or for MESSAGES. Cost: 18 comparisons. */
static inline dictionary_message dictionary_auth(dictionary_message message) {
  FRAY_ASSERT(message <= MESSAGES);
  for (uint32_t m = 0; m < (uint32_t)MESSAGES; ++m) {
    if (message != MESSAGES && DICTIONARY[m].protects == message) return (dictionary_message)m;
  }
  return MESSAGES;
}

/* POSE_LEFT or POSE_RIGHT. Cost: constant. */
static inline dictionary_message dictionary_pose(uint32_t hand) {
  FRAY_ASSERT(hand < 2);
  return hand == 0 ? MESSAGE_POSE_LEFT : MESSAGE_POSE_RIGHT;
}

/* FORCE_LEFT or FORCE_RIGHT. Cost: constant. */
static inline dictionary_message dictionary_force(uint32_t hand) {
  FRAY_ASSERT(hand < 2);
  return hand == 0 ? MESSAGE_FORCE_LEFT : MESSAGE_FORCE_RIGHT;
}

/* TAG_LEFT or TAG_RIGHT. Cost: constant. */
static inline dictionary_message dictionary_tag(uint32_t hand) {
  FRAY_ASSERT(hand < 2);
  return hand == 0 ? MESSAGE_TAG_LEFT : MESSAGE_TAG_RIGHT;
}

#ifdef __cplusplus
}
#endif
#endif
