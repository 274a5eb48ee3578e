/* SPDX-License-Identifier: Apache-2.0 */
/* The message table of the bus: it (dictionary.c) alone knows ids, lengths and cycle times; signals.h
 * adds names, bits, units and words for people and tools. From the two, fray.dbc and the tables of
 * README.md are written (tests/unit/test_dictionary.c); tests/unit/test_dbc.c holds the codec
 * against fray.dbc. The format is frozen: see README.md. */
#ifndef FRAY_WIRE_DICTIONARY_H
#define FRAY_WIRE_DICTIONARY_H

#include <stdint.h>

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
  MESSAGES /* none of them */
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
  uint8_t id_step;   /* from instance to instance */
  uint8_t e2e_kind;  /* row of the id-list bases, or DICTIONARY_NO_E2E; a protected form has in it
                        the bytes of the message that it protects, with that one's check */
  uint16_t cycle_ms; /* at 1 kHz; 0: on an event */
  uint8_t protects;  /* a protected form: the message whose 8 bytes it carries; else MESSAGES */
} dictionary_entry;

extern const dictionary_entry DICTIONARY[MESSAGES];

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

static inline uint32_t dictionary_length(dictionary_message message) {
  return DICTIONARY[message].protects != MESSAGES ? DICTIONARY_LENGTH_AUTH : DICTIONARY_LENGTH;
}

/* The protected form of a message; MESSAGES iff it has none. */
static inline dictionary_message dictionary_auth(dictionary_message message) {
  for (uint32_t m = 0; m < (uint32_t)MESSAGES; ++m) {
    if (message != MESSAGES && DICTIONARY[m].protects == message) return (dictionary_message)m;
  }
  return MESSAGES;
}

/* hand 0 is left, 1 is right. */
static inline dictionary_message dictionary_pose(uint32_t hand) {
  return hand == 0 ? MESSAGE_POSE_LEFT : MESSAGE_POSE_RIGHT;
}
static inline dictionary_message dictionary_force(uint32_t hand) {
  return hand == 0 ? MESSAGE_FORCE_LEFT : MESSAGE_FORCE_RIGHT;
}
static inline dictionary_message dictionary_tag(uint32_t hand) {
  return hand == 0 ? MESSAGE_TAG_LEFT : MESSAGE_TAG_RIGHT;
}

#ifdef __cplusplus
}
#endif
#endif
