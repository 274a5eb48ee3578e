/* SPDX-License-Identifier: Apache-2.0 */
/* The loop of one world on one bus; the same file on Linux and on targets. It reads no clock: the board's
 * platform_wait() sets the pace.
 *
 * Contract of all functions here. Context: one thread, or one interrupt level, runs a loop. NULL: never,
 * unless it says so. */
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
  uint64_t tick;          /* of the next SYNC, which carries its low 32 bits */
  uint32_t hash;          /* low 32 bits that it carries */
  uint32_t overruns;      /* ticks that came late; this and the next three saturate */
  uint32_t bus_losses;    /* SYNCs without a confirmation */
  uint32_t unsealed;      /* frames not sent, since their lane of freshness is spent */
  uint32_t frames_lost;   /* outputs that were never sent: the recording cannot be verified then */
  frame unsent[PORT_OUT]; /* of the last tick, refused by the board: sent again in the next one */
  uint8_t unsent_count;
  uint8_t halt;           /* 1: the next tick goes to SAFE: the bus was lost, a lane of TAGs failed, or
                             freshness is spent */
  uint8_t identify;       /* 1: the next SYNC has an IDENTITY before it */
  uint8_t command;        /* a fray_command of the loop's own for the next tick, or 0 */
  uint8_t command_counter;
  fray_input input;       /* of the last tick */
  fray_output output;
} loop;

typedef enum { LOOP_TICKED, LOOP_BUS_LOST, LOOP_STOPPED } loop_result;

/* Sets up a loop for a world, which stays the caller's. instance: 0..7. Cost: constant. */
void loop_begin(loop *l, fray_world *world, uint32_t instance);

/* Puts the bus under a key (rt/wire/auth_gate.h); call it after loop_begin(). Received frames pass the gate
 * before the port, and sent ones are sealed, the loop's own COMMANDs too. When a lane of TAGs fails, or one
 * of the loop's own lanes is spent while there are forces, the loop sends HALT; a RESET that is applied
 * ends the failure of TAGs. The gate stays the caller's; NULL: none. Cost: constant. */
void loop_protect(loop *l, auth_gate *g);

/* Waits for the next tick and runs it. LOOP_BUS_LOST: no tick was computed and no force was sent; the same
 * SYNC is tried again. LOOP_STOPPED: platform_wait() asked for the end. Cost: the tick's, and at most 2 *
 * PORT_OUT + 3 frames. */
loop_result loop_run(loop *l);

/* The two halves of loop_run(), for programs that compute ticks otherwise than with fray_tick(): between
 * them, after LOOP_TICKED, l->input goes into the tick and its result into l->output. */

/* Waits for the tick, sends SYNC and reads l->input. Cost: at most PORT_OUT + 3 frames. */
loop_result loop_receive(loop *l);
/* Sends l->output. Cost: at most PORT_OUT frames. */
void loop_send(loop *l);

/* Ends a session: waits for the next tick, and sends what was refused before and the closing SYNC, which gives a log
 * of the bus the hash after the last tick; no tick is computed. LOOP_TICKED: it was confirmed; LOOP_BUS_LOST: it may be
 * called again. Cost: at most PORT_OUT + 2 frames. */
loop_result loop_close(loop *l);

/* Sends a COMMAND of the loop's own, which acts in the next tick in place of one from the bus: that one is
 * dropped without an ACK. HALT after a lost bus replaces a command that was not sent yet. Send STOP before
 * the program ends. command: 1 to FRAY_COMMAND_HALT. Cost: constant. */
void loop_command(loop *l, uint8_t command);

#ifdef __cplusplus
}
#endif
#endif
