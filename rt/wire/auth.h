/* SPDX-License-Identifier: Apache-2.0 */
/* Authenticated forms of the messages. README.md says what they stop and what they do not.
 *
 * CAN FD: POSE, COMMAND, FORCE and ACK have a second form with an id of its own, 20 bytes: the 8 bytes of
 * the plain message, its E2E check included; freshness u32; the first 8 bytes of CMAC(key, id u32 || the 8
 * bytes || freshness u32), little-endian, one block of AES. A frame that does not fit is never used.
 *
 * Classic CAN: poses stay plain and are used when they arrive. After every fourth one of a hand its device
 * sends a TAG of 8 bytes: the low 16 bits of the freshness; the first 6 bytes of CMAC(key, id of the TAG
 * u32 || freshness u32 || the 8 bytes of each of the four), three blocks. A TAG that is missing or does not
 * fit is a failure, and failures add up to a failed lane.
 *
 * A lane is one message of one instance; it has one sender. Its freshness rises strictly, from 1, and never
 * wraps: after 2^32 - 1 a lane is spent and needs another key. A receiver accepts
 *   FD: every freshness above the last accepted one;
 *   classic: the smallest one above it with these low 16 bits, so 1 to 65536 above.
 * COMMAND has two senders, and so two lanes under its id: the operator's freshness is below
 * AUTH_RUNTIME_FIRST, that of the runtime's own COMMANDs (HALT, STOP) at or above it; so what the runtime
 * sent is never accepted as an operator's command. An accepted frame is never accepted again under its key.
 * After a reset both ends must go on above what was used: with a new key, or from a stored `last`
 * (README.md, "Freshness and resets").
 *
 * Contract of all functions here; nothing is part of the world. Context: any thread or interrupt, one at a
 * time for each lane, group and monitor; a key may be shared. NULL: never. instance: 0..7. hand: 0 is left,
 * 1 is right. last: any freshness. Keys must outlive what was set up with them. All counters saturate. */
#ifndef FRAY_WIRE_AUTH_H
#define FRAY_WIRE_AUTH_H

#include <stdint.h>

#include "rt/wire/cmac.h"
#include "rt/wire/dictionary.h"
#include "rt/wire/frame.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
  AUTH_TAG_FD = 8,       /* bytes of the tag */
  AUTH_TAG_CLASSIC = 6,
  AUTH_GROUP = 4,        /* poses of one TAG */
  AUTH_FAILURE = 16,     /* a failure raises the level by this, a good TAG lowers it by 1 */
  AUTH_FAILURES_MAX = 3, /* in a row */
  AUTH_LEVEL_MAX = AUTH_FAILURES_MAX * AUTH_FAILURE
};

#define AUTH_RUNTIME_FIRST UINT32_C(0x80000000)

typedef enum {
  AUTH_OK = 0,
  AUTH_ID,     /* not of this lane */
  AUTH_FLAGS,  /* a remote request or an error frame */
  AUTH_LENGTH, /* not 20 bytes of CAN FD; to auth_seal(): not 8 bytes */
  AUTH_OLD,    /* a freshness that is not above the last one, a replay; or one above the lane's max */
  AUTH_FORGED, /* the tag does not fit */
  AUTH_SPENT   /* no freshness is left under this key */
} auth_reason;

/* A constant English phrase for a reason, "a tag that does not fit"; never NULL. Cost: constant. */
const char *auth_reason_text(auth_reason reason);

/* CAN FD: one end of a lane. */
typedef struct {
  const cmac_key *key;
  uint32_t plain_id, id;
  uint32_t last;     /* freshness last sent or accepted; what an end stores */
  uint32_t max;      /* the highest allowed; a sender that stores ahead sets it to the stored one */
  uint32_t accepted; /* or sealed */
  uint32_t lost;     /* freshness that was skipped */
  uint32_t old;
  uint32_t forged;
  uint32_t malformed; /* id, flags, length */
} auth_lane;

/* Sets up one end of the lane of COMMAND, ACK, a POSE or a FORCE; a lane of any other message refuses every
 * frame. last: where this end was under this key, 0 if the key is new; of COMMAND, AUTH_RUNTIME_FIRST and
 * above is the runtime's own lane, below it the operator's. Cost: constant. */
void auth_lane_init(auth_lane *lane, const cmac_key *key, dictionary_message message, uint32_t instance,
                    uint32_t last);

/* Turns a plain frame into its protected form, with bit rate switch. On any reason but AUTH_OK *f stays as
 * it is. Cost: one block. */
auth_reason auth_seal(auth_lane *lane, frame *f);

/* Turns a protected frame into its plain form; *out is written iff AUTH_OK. out may be f.
 * Cost: at most one block. */
auth_reason auth_open(auth_lane *lane, const frame *f, frame *out);

/* Writes the plain form of a protected frame of this instance, *unchecked*: for logs and viewers without
 * the key. Returns 1, or 0 iff it is no such frame; then *out stays as it is. Cost: constant. */
int auth_strip(const frame *f, uint32_t instance, frame *out);

/* Classic CAN: the poses of a hand since its last TAG. */
typedef struct {
  const cmac_key *key;
  uint32_t pose_id, tag_id;
  uint32_t last;  /* freshness of the last TAG sent or accepted; what an end stores */
  uint32_t max;   /* as of a lane */
  uint32_t count; /* poses held, 0 to AUTH_GROUP */
  uint8_t poses[AUTH_GROUP][DICTIONARY_LENGTH];
} auth_group;

/* Sets up the sending end of a hand. Cost: constant. */
void auth_group_init(auth_group *group, const cmac_key *key, uint32_t instance, uint32_t hand, uint32_t last);

/* Adds a POSE that was sent; call it with each, in order. Returns 1 iff it was a fourth one: *tag must then
 * be sent before the next POSE. A spent lane writes no TAG any more, so it fails at the receiver. Cost: at
 * most three blocks. */
int auth_group_add(auth_group *group, const frame *pose, frame *tag);

typedef enum {
  AUTH_MONITOR_OTHER,  /* not of this hand, or no POSE that a port would accept */
  AUTH_MONITOR_POSE,   /* a POSE: use it */
  AUTH_MONITOR_GOOD,   /* a TAG that fits */
  AUTH_MONITOR_BAD,    /* a TAG that does not */
  AUTH_MONITOR_FAILED  /* the lane has failed: use nothing, bring forces to zero */
} auth_verdict;

/* The receiving end of a hand. */
typedef struct {
  auth_group group;
  uint32_t level;   /* 0..AUTH_LEVEL_MAX, see AUTH_FAILURE; the lane fails at AUTH_LEVEL_MAX */
  uint8_t failed;   /* stays until auth_monitor_clear() */
  uint32_t poses;   /* given to be used */
  uint32_t good;    /* TAGs */
  uint32_t bad;     /* TAGs: wrong, of the wrong length, or after too few poses */
  uint32_t missing; /* a fifth POSE came before the TAG */
} auth_monitor;

/* Sets up the receiving end of a hand. Cost: constant. */
void auth_monitor_init(auth_monitor *monitor, const cmac_key *key, uint32_t instance, uint32_t hand,
                       uint32_t last);

/* Judges a received frame; call it with every frame, in the order of the bus. A POSE goes on to the port iff
 * AUTH_MONITOR_POSE. At most 4 * AUTH_FAILURES_MAX poses are used without a good TAG in between.
 * Cost: at most three blocks. */
auth_verdict auth_monitor_check(auth_monitor *monitor, const frame *f);

/* Ends the failure of a lane, at an operator's command; its freshness goes on. Cost: constant. */
void auth_monitor_clear(auth_monitor *monitor);

#ifdef __cplusplus
}
#endif
#endif
