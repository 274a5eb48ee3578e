/* SPDX-License-Identifier: Apache-2.0 */
/* One end of an instance under a key: what stands between the bus and a port (or a device), and
 * between its outputs and the bus. It decides what is listened to and seals what is said; auth.h
 * has the forms and what they stop.
 *
 *   FD       POSE, COMMAND, FORCE and ACK are heard and said in their _AUTH form only; a plain one
 *            is counted and dropped. SYNC, TEAR and STATUS are plain.
 *   CLASSIC  everything is plain; poses of a hand whose lane of TAGs has failed are dropped.
 *
 * A caller owns it, sets it up, and hands it to loop_protect(); without one nothing here runs.
 * -DFRAY_NO_AUTH links no cipher: a guard that is set is then not looked at.
 * It is no part of the world. One guard belongs to one thread or interrupt level at a time. */
#ifndef FRAY_WIRE_GUARD_H
#define FRAY_WIRE_GUARD_H

#include <stddef.h>
#include <stdint.h>

#include "rt/fray.h"
#include "rt/wire/auth.h"

#ifdef __cplusplus
extern "C" {
#endif

#ifdef FRAY_NO_AUTH
#define GUARD_SET(guard) 0
#else
#define GUARD_SET(guard) ((guard) != NULL)
#endif

typedef enum { GUARD_FD, GUARD_CLASSIC } guard_form;
typedef enum { GUARD_RUNTIME, GUARD_DEVICE } guard_end; /* a device also has the operator's word */

enum {
  GUARD_IN = 3,  /* FD: runtime COMMAND, POSE, POSE; device ACK, FORCE, FORCE */
  GUARD_OUT = 4, /* FD: runtime ACK, FORCE, FORCE, its own COMMAND; device COMMAND, POSE, POSE */
  GUARD_LANES = GUARD_IN + GUARD_OUT,
  GUARD_LOOKS = 64 /* tags computed between two guard_tick() */
};

/* All counters saturate. */
typedef struct guard {
  uint8_t form, end, instance;
  uint8_t hands;   /* CLASSIC, runtime: bit h iff the world uses hand h; others are not watched */
  uint8_t failed;  /* CLASSIC, runtime: bit h iff the lane of hand h has failed */
  uint8_t told;    /* guard_alarm() has said so */
  uint32_t in_count, out_count; /* 0 in CLASSIC */
  auth_lane in[GUARD_IN];
  auth_lane out[GUARD_OUT];
  auth_watch watch[FRAY_HANDS]; /* CLASSIC, runtime */
  auth_group group[FRAY_HANDS]; /* CLASSIC, device */
  uint32_t looked; /* since guard_tick() */
  uint32_t plain;  /* frames without a tag that should have had one; CLASSIC: poses after a failure */
  uint32_t unread; /* dropped: GUARD_LOOKS was reached */
} guard;

/* The key must outlive it. instance 0..7; every lane is new, see guard_lanes(). */
void guard_init(guard *g, const cmac_key *key, guard_form form, guard_end end, uint32_t instance,
                uint32_t hands);

/* A lane's freshness, for whoever stores it: set *last (and a sender's *most) after guard_init(). */
typedef struct {
  dictionary_message message; /* the _AUTH form, or the TAG */
  uint8_t sends;
  uint32_t *last;
  uint32_t *most; /* the highest freshness of the lane, or what a sender has stored */
} guard_lane;

/* Returns how many, always in the same order for one form and end. */
uint32_t guard_lanes(guard *g, guard_lane lanes[GUARD_LANES]);

/* Opens a tick: GUARD_LOOKS tags may be computed anew. */
void guard_tick(guard *g);

/* The frame to go on with: f itself, its plain form in *plain, or 0 iff it is not to be used.
 * Call it with every frame, in the order of the bus. Cost: FD one block; CLASSIC three. */
const frame *guard_take(guard *g, const frame *f, frame *plain);

/* A frame that is about to be sent; FD: it becomes its protected form. Returns 1, or 0 iff it must
 * not be sent: the lane is spent. Cost: at most one block. */
int guard_seal(guard *g, frame *f);

/* CLASSIC, device: call it with each POSE that was sent. Returns 1 iff *tag is to be sent now.
 * Cost: at most three blocks. */
int guard_tag(guard *g, const frame *pose, frame *tag);

/* 1 iff a lane has failed since the last guard_clear(), once: the caller says HALT. */
int guard_alarm(guard *g);

/* An operator's RESET was obeyed: failed lanes begin anew. */
void guard_clear(guard *g);

#ifdef __cplusplus
}
#endif
#endif
