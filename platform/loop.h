/* SPDX-License-Identifier: Apache-2.0 */
/* The loop of one world on one bus; the same file on Linux and on targets. It reads no clock. */
#ifndef FRAY_PLATFORM_LOOP_H
#define FRAY_PLATFORM_LOOP_H

#include "platform/platform.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  fray_world *world;
  port in;
  port_sender out;
  uint32_t tick;          /* of the next SYNC */
  uint32_t hash;          /* low 32 bits that it carries */
  uint32_t overruns;      /* ticks that came late */
  uint32_t bus_losses;    /* SYNCs without a confirmation */
  uint32_t unsealed;      /* frames not sent, since their lane of freshness is spent */
  uint32_t frames_lost;   /* outputs that never went out: the recording cannot be verified then */
  frame unsent[PORT_OUT]; /* the last tick's, refused by the board: said once more in the next one */
  uint8_t unsent_count;
  uint8_t halt;           /* the bus was lost, a lane of TAGs failed, or freshness is spent: the next
                           * tick goes to SAFE */
  uint8_t command;        /* a verb of the loop's own for the next tick, or 0 */
  uint8_t command_counter;
  fray_input input;       /* of the last tick */
  fray_output output;
} loop;

typedef enum { LOOP_TICKED, LOOP_BUS_LOST, LOOP_STOPPED } loop_result;

/* `instance` 0..7. The world stays the caller's. */
void loop_begin(loop *l, fray_world *world, uint32_t instance);

/* Under a key (rt/wire/guard.h), called after loop_begin(): what comes in goes through the guard, and
 * what is said is sealed, the loop's own COMMANDs too. When a lane of TAGs fails, or one of the loop's
 * own is spent while there are forces, the loop says HALT; a RESET that is obeyed lets TAGs begin anew.
 * The guard stays the caller's; NULL: none. */
void loop_protect(loop *l, guard *g);

/* Waits for the next tick and runs it. LOOP_BUS_LOST: no tick was computed and no force was sent;
 * the same SYNC is tried again. LOOP_STOPPED: platform_wait() said so. */
loop_result loop_run(loop *l);

/* The same in two halves, for who computes ticks with more than fray_tick(): between them, after
 * LOOP_TICKED, l->input goes into the tick and what comes out goes to l->output. */
loop_result loop_take(loop *l);
void loop_give(loop *l);

/* The verb goes over the bus as a COMMAND of the loop's own and acts in the next tick, instead of
 * what the bus says: a COMMAND that came for this tick is dropped without an ACK. HALT after a lost
 * bus takes the place of a verb that still waits. STOP when the program ends. */
void loop_command(loop *l, uint8_t verb);

#ifdef __cplusplus
}
#endif
#endif
