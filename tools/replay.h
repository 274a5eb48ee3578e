/* SPDX-License-Identifier: Apache-2.0 */
/* From a log of the bus to the inputs of every tick.
 *
 * A recording is a log with SYNCs. Its inputs are found by what the runtime itself said, never
 * by where a frame stands in the log, since another listener may see another order:
 *   - ticks exist by SYNC; the numbers rise by one; of equal numbers the last counts;
 *   - the n-th FORCE of a hand is that of the n-th tick (its counter is the tick & 15); when its
 *     `consumed` differs from the tick before, that tick consumed the next POSE with this
 *     counter among the hand's POSEs that pass E2E;
 *   - an ACK names its tick and the counter of the COMMAND that the tick took.
 * The last SYNC closes the log if nothing of its tick follows: it only carries the last hash.
 *
 * A device log has no SYNC: its frames go through a port (rt/wire/port.h) in the ticks that
 * their times say, floor((t - t_first) * rate). */
#ifndef FRAY_TOOLS_REPLAY_H
#define FRAY_TOOLS_REPLAY_H

#include <stddef.h>
#include <stdint.h>

#include "platform/log/candump.h"
#include "rt/wire/port.h"

enum { REPLAY_TICKS_MAX = 1 << 26 };

/* One tick. Lines are 0 for what is not there. */
typedef struct {
  fray_input input;
  int sync_line;
  int hash_line; /* SYNC of the next tick */
  uint32_t hash; /* what it says: low 32 bits of the hash after this tick */
  int force_line[FRAY_HANDS];
  uint8_t force[FRAY_HANDS][8];
  int ack_line;
  uint8_t ack[8];
} replay_tick;

typedef struct {
  int line;
  uint8_t data[8];
} replay_tear;

typedef struct {
  int recording;        /* 1: it had SYNCs; 0: a device log */
  uint32_t first;       /* number of the first tick */
  uint32_t start_hash;  /* recording: low 32 bits of the hash before the first tick */
  uint32_t count;
  replay_tick *ticks;   /* [count] */
  size_t tear_count;
  replay_tear *tears;   /* [tear_count]: in order; a TEAR does not name its tick */
  port_statistics port; /* device log */
} replay;

/* What the log is read for. */
typedef struct {
  uint32_t instance;            /* 0..7 */
  uint32_t hands;               /* bit h: the world uses hand h */
  uint32_t rate_hz;             /* device log: ticks a second, at least 1 */
  uint8_t consumed[FRAY_HANDS]; /* the world's last consumed counters before the first tick */
} replay_setting;

/* Whether a log has a SYNC of this instance. */
int replay_is_recording(const candump_log *log, uint32_t instance);

/* Returns 1, or 0 with *error (with the line of `file`); *out is then empty. *out owns its
 * arrays and does not refer to the log. */
int replay_read(const char *file, const candump_log *log, const replay_setting *setting,
                replay *out, candump_error *error);
void replay_free(replay *r);

#endif
