/* SPDX-License-Identifier: Apache-2.0 */
/* The bus side of one instance: received frames become one fray_input a tick, and the outputs of a tick
 * become frames. Nothing here is part of the world: refused frames are counted and dropped.
 *
 * A POSE is accepted iff its E2E check passes and its counter is new (rt/wire/sequence.h); so a FORCE with
 * a new `consumed` names exactly one POSE, and a log of the bus says which tick consumed what. The newest
 * POSE accepted for a tick is the one that the world gets. A COMMAND is accepted iff its counter differs
 * from the last accepted one: there may be several operators, and each is answered.
 *
 * Contract of all functions here. Context: any thread or interrupt, one at a time for each port and each
 * port_sender; where an interrupt pushes frames, mask it around port_take(). NULL: never, unless it says
 * so. instance: 0..7. hands: bit h is set iff hand h is in use. Errors: none; statistics count what was
 * refused. */
#ifndef FRAY_WIRE_PORT_H
#define FRAY_WIRE_PORT_H

#include <stdint.h>

#include "rt/fray.h"
#include "rt/wire/codec.h"
#include "rt/wire/auth_gate.h"
#include "rt/wire/queue.h"
#include "rt/wire/sequence.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
  PORT_FRAMES_PER_TICK = 64, /* read by one port_take() */
  PORT_POSES_PER_TICK = 8,   /* accepted of one hand */
  PORT_OUT = 5               /* frames of one port_encode() at most */
};

/* All saturate. */
typedef struct {
  uint32_t accepted;     /* POSE and COMMAND */
  uint32_t repeated;     /* dropped: the counter of the last accepted one */
  uint32_t old;          /* dropped: a POSE that arrived too late */
  uint32_t lost;         /* counters that were skipped */
  uint32_t wrong_crc;
  uint32_t wrong_length;
  uint32_t wrong_flags;  /* remote requests */
  uint32_t wrong_field;  /* passes E2E, but a field is out of range, or a reserved one is not 0 */
  uint32_t unknown_id;   /* not for this instance; among them its own frames, read back */
  uint32_t queue_full;   /* dropped: the queue was full */
} port_statistics;

typedef struct {
  uint8_t instance;
  uint8_t hands;         /* bit h: hand h is in use */
  uint8_t command;       /* counter of the last accepted COMMAND */
  sequence pose[FRAY_HANDS];
  struct auth_gate *gate; /* the caller's, set after port_init(); NULL: frames are plain */
  queue pending;
  port_statistics statistics;
} port;

/* Starts a port without a gate. hands: as fray_info.hands; poses of other hands are unknown ids.
 * `consumed`: the counters that the world consumed last, FRAY_HANDS of them, when it was opened from a
 * save; NULL: zeros, a world at tick 0. Cost: constant. */
void port_init(port *p, uint32_t instance, uint32_t hands, const uint8_t *consumed);

/* Adds a received frame, through the gate if there is one. Cost: constant, and the gate's. */
void port_push(port *p, const frame *f);

/* Writes the input of the next tick. What does not fit (a second COMMAND; a ninth POSE of a hand, or one
 * more than 15 counters ahead of the one consumed before; anything behind 64 frames) stays in the queue, in
 * its order. Cost: at most 64 frames, 64 steps of a CRC each. */
void port_take(port *p, fray_input *input);

/* The sending side: set once, then kept by port_encode(). */
typedef struct {
  uint8_t instance;       /* 0..7 */
  uint8_t hands;          /* bit h: FORCE of hand h is sent */
  uint32_t contacts_max;  /* fray_work_bound().contacts, 100 % of PoolFill; 0: PoolFill is 0 */
  uint16_t overruns;      /* the caller's count, saturated */
  uint32_t status_ticks;  /* ticks between two STATUS at most: rate / 10, at least 1 */
  uint8_t has_sent;       /* a STATUS was sent */
  codec_status sent;      /* the last one */
} port_sender;

/* Starts a sender. rate_hz >= 1: ticks a second. Cost: constant. */
void port_sender_init(port_sender *s, uint32_t instance, uint32_t hands, uint32_t rate_hz);

/* Writes the frames that answer one tick: FORCE of each hand in use, ACK if a command was answered, TEAR if
 * cloth tore, STATUS on a change of state or faults and when it is due. Returns their number, at most
 * PORT_OUT. The SYNC of the next tick is the caller's. Cost: constant. */
uint32_t port_encode(port_sender *s, const fray_output *output, frame frames[PORT_OUT]);

#ifdef __cplusplus
}
#endif
#endif
