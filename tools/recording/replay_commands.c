/* SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>

#include "tools/recording/replay_reader.h"

/* The commands of one log; taken[at]: 1 + the tick that took entry `at`, 0: none. */
typedef struct {
  const replay_reader *r;
  uint32_t *taken;
} search;

/* What a port may remember: the counter of the COMMAND before. */
typedef struct {
  uint32_t last;      /* bit c: it may be c */
  uint32_t until[16]; /* it was c before: until this tick a listener may see a frame of then */
} memory;

/* One COMMAND of the log. */
static int decode(const replay_reader *r, size_t at, codec_command *out) {
  return codec_decode_command(&r->log->entries[at].frame, r->setting->instance, out) == CODEC_OK;
}

static int take_command(const replay_reader *r, replay_tick *tick, int line, const codec_command *command) {
  tick->input.command = command->command;
  tick->input.command_counter = command->counter;
  if (command->argument == 0) return 1;
  return candump_fail(r->error, r->file, line, 0, "COMMAND has the argument %lu, expected 0: no command has one",
                      (unsigned long)command->argument);
}

/* The first tick whose SYNC stands behind this entry; with the closing SYNC. */
static uint32_t tick_behind(const replay_reader *r, size_t at) {
  const int line = r->log->entries[at].line;
  uint32_t low = 0, high = r->sync_count;
  while (low < high) {
    const uint32_t middle = low + (high - low) / 2;
    if (r->out->ticks[middle].sync_line > line)
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

/* Whether more frames stand before entry `at`, which stands before the SYNC of tick n, than a port reads in a tick: in
 * three ticks, or in more at the rate at which it takes POSEs. Then frames wait, and some find the queue full. */
static int is_flooded(const replay_reader *r, size_t at, uint32_t n) {
  uint32_t frames = 0, most = PORT_FRAMES_PER_TICK;
  for (uint32_t ticks = 0; at > 0 && ticks <= QUEUE_CAPACITY / PORT_POSES_PER_TICK; --at) {
    const candump_entry *entry = &r->log->entries[at - 1];
    const dictionary_message m = message_of(r, &entry->frame);
    frames += m == MESSAGE_POSE_LEFT || m == MESSAGE_POSE_RIGHT || m == MESSAGE_COMMAND;
    if (frames > most) return 1;
    if (n == 0 || entry->line != r->out->ticks[n - 1].sync_line) continue;
    if (--n == 0) return 0;
    if (++ticks >= 3) most += PORT_POSES_PER_TICK;
  }
  return 0;
}

/* Whether the COMMAND of entry `at` may have waited until tick n: a tick takes one, so others go before it; of a full
 * queue at least one frame goes in each tick. */
static int may_wait(const replay_reader *r, size_t at, uint32_t n) {
  const uint32_t from = tick_behind(r, at);
  uint32_t idle = 0;
  for (uint32_t k = from; k < n && idle <= REPLAY_INPUT_LATE; ++k) idle += r->out->ticks[k].ack_line == 0;
  return idle <= REPLAY_INPUT_LATE || (n - from < QUEUE_CAPACITY && is_flooded(r, at, from));
}

/* The newest one: the runtime's own HALT overtakes earlier commands of an operator. */
static int answer_command(const search *s, uint32_t n) {
  const replay_reader *r = s->r;
  replay_tick *tick = &r->out->ticks[n];
  const uint8_t counter = (uint8_t)(tick->ack[1] >> 4);
  const int limit = replay_line_limit(r, n);
  const int first = n < QUEUE_CAPACITY ? 0 : r->out->ticks[n - QUEUE_CAPACITY].sync_line;
  const candump_entry *entries = r->log->entries;
  size_t at = r->log->count;
  while (at > 0 && entries[at - 1].line >= limit) --at;
  for (; at > 0 && entries[at - 1].line > first; --at) {
    codec_command command;
    if (s->taken[at - 1] != 0 || !decode(r, at - 1, &command)) continue;
    if (command.counter != counter || command.command != tick->ack[2] || !may_wait(r, at - 1, n)) continue;
    s->taken[at - 1] = n + 1;
    return take_command(r, tick, entries[at - 1].line, &command);
  }
  return candump_fail(r->error, r->file, tick->ack_line, 0,
                      "ACK of command %d with counter %d, whose COMMAND is not in the log",
                      tick->ack[2], counter);
}

static int has_own_command(const replay_tick *tick) {
  return tick->input.command == FRAY_COMMAND_HALT || tick->input.command == FRAY_COMMAND_STOP;
}

/* Whether a runtime may leave out the COMMAND of entry `at`, which stands before the SYNC of tick n: it sends a HALT
 * or STOP in the place of another COMMAND, a full queue drops it, and no tick is left at the end. */
static int may_be_left_out(const replay_reader *r, size_t at, uint32_t n) {
  const replay *out = r->out;
  uint32_t idle = 0, k = n > 0 ? n - 1 : 0;
  for (; k < out->count && idle < REPLAY_INPUT_LATE; ++k) {
    if (has_own_command(&out->ticks[k])) return 1;
    idle += k >= n && out->ticks[k].ack_line == 0;
  }
  return (k >= out->count && idle == 0) || is_flooded(r, at, n);
}

/* The frame that begins the session; what stands before it may have been sent before the runtime listened. */
static int first_line(const replay *out) {
  const int sync = out->count > 0 ? out->ticks[0].sync_line : 0;
  const int identity = out->identities.count > 0 ? out->identities.of[0].line : sync;
  return identity < sync ? identity : sync;
}

/* The next COMMAND that was taken is this frame again, as near as listeners see other orders. */
static int is_taken_later(const search *s, size_t at, uint32_t n) {
  const replay_reader *r = s->r;
  const candump_entry *entries = r->log->entries;
  size_t next = at + 1;
  while (next < r->log->count && s->taken[next] == 0) ++next;
  return next < r->log->count && tick_behind(r, next) <= n + REPLAY_INPUT_LATE &&
         memcmp(entries[next].frame.data, entries[at].frame.data, 8) == 0;
}

/* A COMMAND that a tick took and that stands before the SYNC of tick n. The runtime sends its own behind the SYNC of
 * their tick, and its port does not remember them. */
static void remember(memory *m, const search *s, size_t at, uint32_t n, uint8_t counter) {
  const uint32_t tick = s->taken[at] - 1;
  if (n <= tick || !has_own_command(&s->r->out->ticks[tick])) {
    for (uint32_t c = 0; c < 16; ++c)
      if ((m->last >> c & 1u) != 0) m->until[c] = n + REPLAY_INPUT_LATE + 1u;
    m->last = 0;
  }
  m->last |= 1u << counter;
}

/* A port drops a COMMAND with the counter of the one before it. */
static int is_repeated(const memory *m, uint32_t n, uint8_t counter) {
  return (m->last >> counter & 1u) != 0 || n < m->until[counter];
}

/* A COMMAND that no tick took, though a port takes each whose counter is not that of the one before it. */
static int check_unanswered(const search *s) {
  const replay_reader *r = s->r;
  memory m = {1, {0}};
  const int first = first_line(r->out);
  for (size_t at = 0; at < r->log->count; ++at) {
    const candump_entry *entry = &r->log->entries[at];
    codec_command command;
    if (!decode(r, at, &command)) continue;
    const uint32_t n = tick_behind(r, at);
    if (s->taken[at] != 0) {
      remember(&m, s, at, n, command.counter);
    } else if (entry->line > first && !is_repeated(&m, n, command.counter) && !is_taken_later(s, at, n)) {
      if (!may_be_left_out(r, at, n))
        return candump_fail(r->error, r->file, entry->line, 0, "COMMAND %d with counter %d has no ACK",
                            command.command, command.counter);
      m.last |= 1u << command.counter; /* a port remembers what a HALT or STOP replaced */
    }
  }
  return 1;
}

int replay_find_commands(replay_reader *r) {
  const search s = {r, calloc(r->log->count + 1, sizeof *s.taken)};
  int good = s.taken != NULL;
  if (!good) (void)candump_fail(r->error, r->file, 0, 0, "not enough memory");
  for (uint32_t n = 0; good && n < r->out->count; ++n)
    if (r->out->ticks[n].ack_line != 0) good = answer_command(&s, n);
  if (good) good = check_unanswered(&s);
  free(s.taken);
  return good;
}
