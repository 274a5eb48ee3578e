/* SPDX-License-Identifier: Apache-2.0 */
/* Authenticated forms of the messages. README.md says what they stop and what they do not.
 *
 * CAN FD: POSE, COMMAND, FORCE and ACK have a second form with an id of its own, 20 bytes: the 8
 * bytes of the plain message, its E2E check included; freshness u32; the first 8 bytes of
 * CMAC(key, id u32 || the 8 bytes || freshness u32), little-endian, one block of AES. Nothing that
 * does not fit is ever used.
 *
 * Classic CAN: poses stay plain and are used when they arrive. After every fourth one of a hand
 * its device sends a TAG of 8 bytes: the low 16 bits of the freshness; the first 6 bytes of
 * CMAC(key, id of the TAG u32 || freshness u32 || the 8 bytes of each of the four), three blocks.
 * A TAG that is missing or does not fit is a failure, and failures add up to a failed lane.
 *
 * Freshness rises strictly in each lane (one message of one instance; it has one sender), from 1,
 * and never wraps: after 2^32 - 1 a lane is spent and needs another key. A receiver takes
 *   FD: every freshness above the last accepted one;
 *   classic: the smallest one above it with these low 16 bits, so 1 to 65536 above.
 * COMMAND has two senders, and so two lanes under its id: the operator's freshness is below
 * AUTH_OWN, that of the runtime's own COMMANDs (HALT, STOP) above; what the runtime said never
 * comes back to it as an operator's word.
 * What is accepted is never accepted again under its key. After a reset both ends must go on
 * above what was used: with a new key, or from a stored `last` (README.md, "Freshness and resets").
 *
 * Nothing here is part of the world. One lane belongs to one thread or interrupt level at a time. */
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

#define AUTH_OWN UINT32_C(0x80000000)

typedef enum {
  AUTH_OK = 0,
  AUTH_ID,     /* not of this lane */
  AUTH_FLAGS,  /* a remote request or an error frame */
  AUTH_LENGTH, /* not 20 bytes of CAN FD; to auth_seal(): not 8 bytes */
  AUTH_OLD,    /* a freshness that is not above the last: a replay; or above the lane's most */
  AUTH_FORGED, /* the tag does not fit */
  AUTH_SPENT   /* no freshness is left under this key */
} auth_reason;

/* A constant English phrase for a reason: "a tag that does not fit". */
const char *auth_reason_text(auth_reason reason);

/* CAN FD: one end of a lane. All counters saturate. */
typedef struct {
  const cmac_key *key;
  uint32_t plain_id, id;
  uint32_t last;     /* freshness last sent or accepted; what a device stores */
  uint32_t most;     /* none above it; a sender that stores ahead sets it to what is stored */
  uint32_t accepted; /* or sealed */
  uint32_t lost;     /* freshness skipped before an accepted one */
  uint32_t old;
  uint32_t forged;
  uint32_t malformed; /* id, flags, length */
} auth_lane;

/* `message`: COMMAND, ACK, POSE_ or FORCE_; a lane of any other takes no frame. The key must
 * outlive the lane. `last`: where this end was under this key, 0 if it is new; of a COMMAND,
 * AUTH_OWN and above is the runtime's own lane, and below it the operator's. */
void auth_lane_init(auth_lane *lane, const cmac_key *key, dictionary_message message,
                    uint32_t instance, uint32_t last);

/* A plain frame becomes its protected form, with bit rate switch. Unless AUTH_OK *f stays as it is.
 * Cost: one block. */
auth_reason auth_seal(auth_lane *lane, frame *f);

/* A protected frame becomes its plain form; *out is written iff AUTH_OK. out may be f.
 * Cost: at most one block. */
auth_reason auth_open(auth_lane *lane, const frame *f, frame *out);

/* The plain form of a protected frame of this instance, *unchecked*: for logs and viewers without
 * the key. Returns 1, or 0 iff it is none; then *out stays as it is. */
int auth_strip(const frame *f, uint32_t instance, frame *out);

/* Classic CAN: the last poses, since the last TAG. */
typedef struct {
  const cmac_key *key;
  uint32_t pose_id, tag_id;
  uint32_t last; /* freshness of the last TAG sent or accepted; what a device stores */
  uint32_t most; /* as of a lane */
  uint32_t held;
  uint8_t poses[AUTH_GROUP][DICTIONARY_LENGTH];
} auth_group;

/* The sending end of a hand. */
void auth_group_init(auth_group *group, const cmac_key *key, uint32_t instance, uint32_t hand,
                     uint32_t last);

/* Call it with each POSE that is sent, in order. Returns 1 iff it was a fourth one: *tag is then to
 * be sent before the next POSE. When the lane is spent no TAG comes any more, which fails it.
 * Cost: at most three blocks. */
int auth_group_add(auth_group *group, const frame *pose, frame *tag);

typedef enum {
  AUTH_WATCH_OTHER,  /* not for this hand, or no pose that a port would take */
  AUTH_WATCH_POSE,   /* a POSE: use it */
  AUTH_WATCH_GOOD,   /* a TAG that fits */
  AUTH_WATCH_BAD,    /* a TAG that does not */
  AUTH_WATCH_FAILED  /* the lane has failed: use nothing, ramp forces to zero */
} auth_verdict;

/* The receiving end of a hand. All counters saturate. */
typedef struct {
  auth_group group;
  uint32_t level;    /* 0..AUTH_LEVEL_MAX, see AUTH_FAILURE; the lane fails at AUTH_LEVEL_MAX */
  uint8_t failed;    /* stays until auth_watch_clear() */
  uint32_t poses;    /* to be used */
  uint32_t good;     /* TAGs */
  uint32_t bad;      /* TAGs: wrong, of the wrong length, or after too few poses */
  uint32_t missing;  /* a fifth POSE came before the TAG */
} auth_watch;

void auth_watch_init(auth_watch *watch, const cmac_key *key, uint32_t instance, uint32_t hand,
                     uint32_t last);

/* Call it with every frame, in the order of the bus; a POSE goes on to the port iff
 * AUTH_WATCH_POSE. At most 4 * AUTH_FAILURES_MAX of them are used with no good TAG in between.
 * Cost: at most three blocks. */
auth_verdict auth_watch_take(auth_watch *watch, const frame *f);

/* Lets a failed lane begin anew, at an operator's word; freshness goes on. */
void auth_watch_clear(auth_watch *watch);

#ifdef __cplusplus
}
#endif
#endif
