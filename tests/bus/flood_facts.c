/* SPDX-License-Identifier: Apache-2.0 */
/* flood_facts FRAYS_OWN.log: what passed a runtime's socket under a flood, in the order in which the
 * socket had it, and what a port must have made of it, as NAME=VALUE for the shell:
 *   foreign  frames of ids that no message of instance 0 has: the filters let them in
 *   taken    POSEs and COMMANDs of others that came before the last SYNC; `good` pass the check
 *   waiting  of these, what a queue of 256 that is looked at 64 a tick still holds at the end: the last SYNC
 *            closes the recording, and has no tick
 *   ticks, busiest: the most frames for one tick; crowded: ticks that left some for a later one
 *   behind   ticks that had consumed nothing as new as the newest right-hand POSE before the SYNC of
 *            the tick before, though that was among the frames looked at by then
 *   consumed ticks with a new right-hand POSE
 * The flooder damages POSEs of the left hand only: every right one is good. */
#include <stdio.h>
#include <string.h>

#include "platform/log/candump.h"
#include "rt/wire/codec.h"
#include "rt/wire/dictionary.h"
#include "rt/wire/port.h"
#include "rt/wire/queue.h"

enum { RIGHT = 1, COUNTERS = 16 };

typedef struct {
  uint32_t others, good; /* so far */
  uint32_t poses;        /* of the right hand */
} seen;

typedef struct {
  uint32_t foreign, ticks, busiest, crowded, behind, consumed;
  uint32_t waiting;        /* left by the last tick */
  uint32_t waiting_before; /* and by the one before it */
  uint32_t queued;         /* when the last SYNC came */
  uint32_t arrived;        /* since the last SYNC */
  seen now, sync, sync_before; /* now, and when the last two ticks began */
  uint32_t newest[COUNTERS];   /* number of the last right-hand POSE with this counter */
  uint32_t last_tick;
  uint8_t last_consumed;
} facts;

static uint32_t least(uint32_t a, uint32_t b) { return a < b ? a : b; }

static void on_sync(facts *f, const codec_sync *sync) {
  if (f->ticks != 0 && sync->tick == f->last_tick) return; /* sent again; its first echo counted */
  f->ticks += 1;
  f->last_tick = sync->tick;
  f->sync_before = f->sync;
  f->sync = f->now;
  if (f->arrived > f->busiest) f->busiest = f->arrived;
  f->waiting_before = f->waiting;
  f->waiting += f->arrived;
  f->queued = f->waiting;
  f->waiting -= least(f->waiting, PORT_FRAMES_PER_TICK);
  f->crowded += f->waiting != 0;
  f->arrived = 0;
}

static void on_force(facts *f, const codec_force *force) {
  f->consumed += force->consumed != f->last_consumed;
  f->last_consumed = force->consumed;
  if (f->sync_before.poses == 0 || f->waiting_before > PORT_FRAMES_PER_TICK) return;
  f->behind += f->newest[force->consumed] < f->sync_before.poses;
}

static void on_input(facts *f, const frame *in) {
  fray_pose pose;
  codec_command command;
  const int is_command = codec_decode_command(in, 0, &command) == CODEC_OK;
  const int runtimes_own =
      is_command && (command.command == FRAY_COMMAND_STOP || command.command == FRAY_COMMAND_HALT);
  if (runtimes_own) return;
  f->now.others += 1;
  f->now.good += is_command || codec_decode_pose(in, 0, 0, &pose) == CODEC_OK;
  if (codec_decode_pose(in, 0, RIGHT, &pose) == CODEC_OK) {
    f->now.good += 1;
    f->newest[pose.counter] = ++f->now.poses;
  }
  if (f->waiting + f->arrived < QUEUE_CAPACITY) f->arrived += 1;
}

static void take(facts *f, const frame *in) {
  codec_sync sync;
  codec_force force;
  switch (in->extended || in->error ? MESSAGES : dictionary_find(in->id, 0)) {
    case MESSAGES: f->foreign += 1; break;
    case MESSAGE_POSE_LEFT:
    case MESSAGE_POSE_RIGHT:
    case MESSAGE_COMMAND: on_input(f, in); break;
    case MESSAGE_SYNC:
      if (codec_decode_sync(in, 0, &sync) == CODEC_OK) on_sync(f, &sync);
      break;
    case MESSAGE_FORCE_RIGHT:
      if (codec_decode_force(in, 0, RIGHT, &force) == CODEC_OK) on_force(f, &force);
      break;
    default: break;
  }
}

int main(int argc, char **argv) {
  candump_log log;
  candump_error error;
  facts f = {0};
  if (argc != 2) {
    fprintf(stderr, "usage: flood_facts FRAYS_OWN.log\n");
    return 2;
  }
  if (!candump_load(argv[1], &log, &error)) {
    candump_print_error(stderr, &error);
    return 2;
  }
  for (size_t n = 0; n < log.count; ++n) take(&f, &log.entries[n].frame);
  printf("foreign=%u taken=%u good=%u waiting=%u ticks=%u busiest=%u crowded=%u behind=%u "
         "consumed=%u\n",
         f.foreign, f.sync.others, f.sync.good, f.queued, f.ticks - 1, f.busiest,
         f.crowded, f.behind, f.consumed);
  candump_free(&log);
  return 0;
}
