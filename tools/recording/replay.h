/* SPDX-License-Identifier: Apache-2.0 */
/* From a log of the bus to the inputs of every tick.
 *
 * A recording is a log with SYNCs. Its inputs are found by the runtime's own frames, never by positions in
 * the log, since another listener may see another order:
 *   - ticks exist by SYNC; the numbers rise by one, modulo 2^32; a repeated one has the same hash;
 *   - the n-th FORCE of a hand is that of the n-th tick (its counter is the tick & 15); when its
 *     `consumed` differs from the tick before, that tick consumed the next POSE with this
 *     counter among the hand's POSEs that pass E2E;
 *   - an ACK names its tick and the counter of the COMMAND that the tick took, and every COMMAND that a
 *     runtime takes has an ACK.
 * The last SYNC closes the log: nothing of its tick follows, it only carries the last hash.
 *
 * A device log has no SYNC: its frames go through a port (rt/wire/port.h) in the ticks of their times,
 * floor((t - t_first) * rate). */
#ifndef FRAY_TOOLS_RECORDING_REPLAY_H
#define FRAY_TOOLS_RECORDING_REPLAY_H

#include <stddef.h>
#include <stdint.h>

#include "platform/log/candump.h"
#include "rt/wire/port.h"

/* Of a device log, whose ticks take memory with frames or without. A recording has as many as fit in memory. */
enum { REPLAY_DEVICE_TICKS_MAX = 1 << 26 };

/* One tick. Line 0: the log has no such frame. */
typedef struct {
  fray_input input;
  int sync_line;
  int hash_line; /* SYNC of the next tick */
  uint32_t hash; /* in it: low 32 bits of the hash after this tick */
  int force_line[FRAY_HANDS];
  uint8_t force[FRAY_HANDS][8];
  int ack_line;
  uint8_t ack[8];
} replay_tick;

/* Messages that do not name their tick, in their order. */
typedef struct {
  size_t count;
  struct replay_message {
    int line;
    uint8_t data[8];
  } *of; /* [count] */
} replay_list;

typedef struct {
  int recording;        /* 1: it had SYNCs; 0: a device log */
  uint64_t first;       /* recording: number of the first tick, see replay_tick_number() */
  uint32_t start_hash;  /* recording: low 32 bits of the hash before the first tick */
  uint32_t count;
  replay_tick *ticks;   /* [count] */
  int cut_line;         /* SYNC of the first tick that was left out since it is not whole; 0: none */
  replay_list tears, statuses, identities;
  int back_line;        /* device log: first frame a tick or more before the frame above it; 0: none */
  port_statistics port; /* device log; its unknown ids count poses of absent hands too */
  uint32_t absent[FRAY_HANDS]; /* device log: poses of a hand that the world does not use */
} replay;

/* The world for which the log is read. */
typedef struct {
  uint32_t instance;            /* 0..7 */
  uint32_t hands;               /* bit h: the world uses hand h */
  uint32_t rate_hz;             /* device log: ticks a second, at least 1 */
  uint64_t tick;                /* the world's, before the first tick */
  uint8_t consumed[FRAY_HANDS]; /* the world's last consumed counters before the first tick */
  int cut;                      /* recording: it may end anywhere; ticks without a FORCE or a SYNC behind them
                                   are left out at its end */
  uint32_t counted;             /* device log: `port` and `absent` count those of so many ticks; 0: of all */
} replay_setting;

/* The number with these low 32 bits, which is all that a SYNC carries, that is nearest to `near`. */
uint64_t replay_tick_number(uint32_t low, uint64_t near);

/* Whether a log has a SYNC of this instance. */
int replay_is_recording(const candump_log *log, uint32_t instance);

/* Returns 1, or 0 with *error (with the line of `file`); *out is then empty. *out owns its
 * arrays and does not refer to the log. */
int replay_read(const char *file, const candump_log *log, const replay_setting *setting,
                replay *out, candump_error *error);
void replay_free(replay *r);

#endif
