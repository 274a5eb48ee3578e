/* SPDX-License-Identifier: Apache-2.0 */
/* The edge of one instance: frames in, one fray_input a tick out; and the frames of a tick's
 * outputs. Nothing here is part of the world: what is refused is counted and forgotten.
 *
 * A POSE is accepted iff its E2E check passes and its counter is new (rt/wire/sequence.h); so a
 * FORCE whose `consumed` changed names exactly one POSE, and a log of the bus says which tick
 * consumed what. Of the poses accepted for one tick the newest is given. A COMMAND is accepted iff
 * its counter differs from the last accepted one: operators come and go, and each is answered.
 *
 * Threads: one port belongs to one thread or interrupt level at a time. */
#ifndef FRAY_WIRE_PORT_H
#define FRAY_WIRE_PORT_H

#include <stdint.h>

#include "rt/fray.h"
#include "rt/wire/codec.h"
#include "rt/wire/guard.h"
#include "rt/wire/queue.h"
#include "rt/wire/sequence.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
  PORT_FRAMES_PER_TICK = 64, /* looked at in one port_take() */
  PORT_POSES_PER_TICK = 8,   /* accepted of one hand */
  PORT_OUT = 5               /* frames of one port_encode() at most */
};

/* All saturate. */
typedef struct {
  uint32_t accepted;     /* POSE and COMMAND */
  uint32_t repeated;     /* dropped: the counter of the last one accepted */
  uint32_t old;          /* dropped: a POSE that came too late */
  uint32_t lost;         /* skipped counters */
  uint32_t wrong_crc;
  uint32_t wrong_length;
  uint32_t wrong_flags;  /* remote requests */
  uint32_t wrong_field;  /* passes E2E, but a field is out of range or reserved */
  uint32_t unknown_id;   /* not for this instance; its own frames read back are among them */
  uint32_t queue_full;   /* dropped: nobody took the frames before */
} port_statistics;

typedef struct {
  uint8_t instance;
  uint8_t hands;         /* bit h: hand h is in use */
  uint8_t command;       /* counter of the last COMMAND accepted */
  sequence pose[FRAY_HANDS];
  struct guard *guard;   /* the caller's, set after port_init(); NULL: frames are plain */
  queue waiting;
  port_statistics statistics;
} port;

/* instance 0..7. `hands`: bit h is set iff a body of the world follows hand h; poses of other
 * hands are unknown ids. `consumed`: the world's last consumed counters when it was opened from
 * a save; NULL: zeros, a world at tick 0. */
void port_init(port *p, uint32_t instance, uint32_t hands, const uint8_t *consumed);

/* Takes a frame from the bus, through the guard if there is one. Cost: constant, and the guard's. */
void port_push(port *p, const frame *f);

/* The input of the next tick. What does not fit (a second COMMAND; a ninth POSE of a hand, or one
 * more than 15 counters ahead of the one consumed before; anything after 64 frames) waits for the
 * next tick, in its order.
 * Cost: at most 64 frames. */
void port_take(port *p, fray_input *input);

/* What sends a world's outputs: set once, then kept by port_encode(). */
typedef struct {
  uint8_t instance;       /* 0..7 */
  uint8_t hands;          /* bit h: FORCE of hand h is sent */
  uint32_t contacts_max;  /* fray_limits().contacts: what 100 % of PoolFill is; 0: it says 0 */
  uint16_t overruns;      /* the caller's count, saturated */
  uint32_t status_ticks;  /* a STATUS at least every so many ticks: rate / 10, at least 1 */
  uint8_t has_sent;       /* a STATUS was sent */
  codec_status sent;      /* the last one */
} port_sender;

void port_sender_init(port_sender *s, uint32_t instance, uint32_t hands, uint32_t rate_hz);

/* The frames that answer one tick: FORCE of each hand in use, ACK if a verb was answered, TEAR
 * if springs were cut, STATUS on a change of state or faults and when it is due.
 * Returns how many, at most PORT_OUT. The SYNC of the next tick is the caller's. */
uint32_t port_encode(port_sender *s, const fray_output *output, frame frames[PORT_OUT]);

#ifdef __cplusplus
}
#endif
#endif
