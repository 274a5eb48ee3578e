/* SPDX-License-Identifier: Apache-2.0 */
/* One end of an instance under a key: the gate between the bus and a port (or a device). It decides which
 * received frames are used, and seals what is sent; auth.h has the forms and what they stop.
 *
 *   FD       POSE, COMMAND, FORCE and ACK are received and sent in their _AUTH form only; a plain one is
 *            counted and dropped. SYNC, TEAR, STATUS and IDENTITY are plain.
 *   CLASSIC  everything is plain; once a hand's lane of TAGs has failed, its poses are dropped.
 *
 * The caller owns the gate, sets it up and gives it to loop_protect(); without one nothing here runs.
 * -DFRAY_NO_AUTH links no cipher: a port then ignores its gate.
 *
 * Contract of all functions here; nothing is part of the world. Context: any thread or interrupt, one at a
 * time for each gate. NULL: never. instance: 0..7. hands: bit h is set iff the world uses hand h. The key
 * must outlive the gate. Errors: none but the result; counters count what was refused, and saturate. */
#ifndef FRAY_WIRE_AUTH_GATE_H
#define FRAY_WIRE_AUTH_GATE_H

#include <stddef.h>
#include <stdint.h>

#include "rt/fray.h"
#include "rt/wire/auth.h"

#ifdef __cplusplus
extern "C" {
#endif

#ifdef FRAY_NO_AUTH
#define AUTH_GATE_SET(gate) 0
#else
#define AUTH_GATE_SET(gate) ((gate) != NULL)
#endif

typedef enum { AUTH_GATE_FD, AUTH_GATE_CLASSIC } auth_gate_form;
typedef enum { AUTH_GATE_RUNTIME, AUTH_GATE_DEVICE } auth_gate_end; /* a device may also send COMMANDs */

enum {
  AUTH_GATE_IN = 3,  /* FD: runtime COMMAND, POSE, POSE; device ACK, FORCE, FORCE */
  AUTH_GATE_OUT = 4, /* FD: runtime ACK, FORCE, FORCE, its own COMMAND; device COMMAND, POSE, POSE */
  AUTH_GATE_LANES = AUTH_GATE_IN + AUTH_GATE_OUT,
  AUTH_GATE_TAGS_PER_TICK = 64 /* computed between two auth_gate_begin_tick() */
};

typedef struct auth_gate {
  uint8_t form, end, instance;
  uint8_t hands;        /* CLASSIC, runtime: the hands that are monitored */
  uint8_t failed;       /* CLASSIC, runtime: bit h iff the lane of hand h has failed */
  uint8_t alarm_raised; /* auth_gate_alarm() has returned 1 for it */
  uint32_t in_count, out_count; /* 0 in CLASSIC */
  auth_lane in[AUTH_GATE_IN];
  auth_lane out[AUTH_GATE_OUT];
  auth_monitor monitor[FRAY_HANDS]; /* CLASSIC, runtime */
  auth_group group[FRAY_HANDS];     /* CLASSIC, device */
  uint32_t tags;        /* computed since auth_gate_begin_tick() */
  uint32_t plain;       /* dropped: no tag where one is needed; CLASSIC: poses after a failure */
  uint32_t over_budget; /* dropped: AUTH_GATE_TAGS_PER_TICK was reached */
} auth_gate;

/* Sets up a gate with new lanes; see auth_gate_lanes() for stored ones. Cost: constant. */
void auth_gate_init(auth_gate *g, const cmac_key *key, auth_gate_form form, auth_gate_end end,
                    uint32_t instance, uint32_t hands);

/* A lane's freshness, for a program that stores it: set *last (and a sender's *max) after auth_gate_init().
 * */
typedef struct {
  dictionary_message message; /* the _AUTH form, or the TAG */
  uint8_t sends;
  uint32_t *last;
  uint32_t *max; /* the highest freshness of the lane, or what a sender has stored */
} auth_gate_lane;

/* Writes the lanes, always in the same order for one form and end, and returns their number. Cost:
 * constant. */
uint32_t auth_gate_lanes(auth_gate *g, auth_gate_lane lanes[AUTH_GATE_LANES]);

/* Starts a tick: AUTH_GATE_TAGS_PER_TICK tags may be computed again. Cost: constant. */
void auth_gate_begin_tick(auth_gate *g);

/* Judges a received frame; call it with every frame, in the order of the bus. Returns the frame to use: f
 * itself, its plain form in *plain, or NULL iff none is to be used. Cost: FD one block; CLASSIC three. */
const frame *auth_gate_receive(auth_gate *g, const frame *f, frame *plain);

/* Prepares a frame that is about to be sent; FD: it becomes its protected form. Returns 1, or 0 iff it must
 * not be sent: the lane is spent. Cost: at most one block. */
int auth_gate_seal(auth_gate *g, frame *f);

/* CLASSIC, device: call it with each POSE that was sent. Returns 1 iff *tag is to be sent now.
 * Cost: at most three blocks. */
int auth_gate_tag(auth_gate *g, const frame *pose, frame *tag);

/* Returns 1, once, iff a lane has failed since the last auth_gate_clear(): the caller then halts.
 * Cost: constant. */
int auth_gate_alarm(auth_gate *g);

/* Ends the failure of lanes: a RESET was applied. Cost: constant. */
void auth_gate_clear(auth_gate *g);

#ifdef __cplusplus
}
#endif
#endif
