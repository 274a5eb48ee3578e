/* SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>

#include "tools/recording/replay_reader.h"

enum { COMMAND_WINDOW = 4096 /* entries before an ACK */ };

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

/* The newest one: the runtime's own HALT overtakes earlier commands of an operator. */
static int answer_command(const replay_reader *r, uint8_t *answered, uint32_t n) {
  replay_tick *tick = &r->out->ticks[n];
  const uint8_t counter = (uint8_t)(tick->ack[1] >> 4);
  const int limit = replay_line_limit(r, n);
  const candump_entry *entries = r->log->entries;
  size_t end = r->log->count;
  while (end > 0 && entries[end - 1].line >= limit) --end;
  uint32_t before = 0; /* after the ACK a busy bus may continue without SYNCs */
  for (size_t at = end; at > 0 && before < COMMAND_WINDOW; --at) {
    codec_command command;
    before += entries[at - 1].line < tick->ack_line;
    if (answered[at - 1] || !decode(r, at - 1, &command)) continue;
    if (command.counter != counter || command.command != tick->ack[2]) continue;
    answered[at - 1] = 1;
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
 * or STOP in the place of another COMMAND, and more frames than it reads in a tick fill its queue. */
static int may_be_left_out(const replay_reader *r, size_t at, uint32_t n) {
  const replay *out = r->out;
  if (n >= out->count) return 1;
  for (uint32_t k = n > 0 ? n - 1 : 0; k <= n + 1 && k < out->count; ++k)
    if (has_own_command(&out->ticks[k])) return 1;
  const uint32_t from = n > REPLAY_INPUT_LATE ? n - REPLAY_INPUT_LATE : 0;
  uint32_t frames = 0;
  for (; at > 0 && r->log->entries[at - 1].line > out->ticks[from].sync_line; --at) {
    const dictionary_message m = message_of(r, &r->log->entries[at - 1].frame);
    frames += m == MESSAGE_POSE_LEFT || m == MESSAGE_POSE_RIGHT || m == MESSAGE_COMMAND;
  }
  return frames > PORT_FRAMES_PER_TICK;
}

/* The frame that begins the session; what stands before it may have been sent before the runtime listened. */
static int first_line(const replay *out) {
  const int sync = out->count > 0 ? out->ticks[0].sync_line : 0;
  const int identity = out->identities.count > 0 ? out->identities.of[0].line : sync;
  return identity < sync ? identity : sync;
}

/* The next COMMAND that was answered is this frame again. */
static int is_taken_later(const replay_reader *r, const uint8_t *answered, size_t at) {
  const candump_entry *entries = r->log->entries;
  size_t next = at + 1;
  while (next < r->log->count && !answered[next]) ++next;
  return next < r->log->count && memcmp(entries[next].frame.data, entries[at].frame.data, 8) == 0;
}

/* A COMMAND that no tick took: a port drops one with the counter of the one before it; the runtime's own do not
 * count there. */
static int check_unanswered(const replay_reader *r, const uint8_t *answered) {
  uint8_t last[2] = {0, 0}; /* counters of the last two that were answered */
  const int first = first_line(r->out);
  uint32_t n = 0;
  for (size_t at = 0; at < r->log->count; ++at) {
    const candump_entry *entry = &r->log->entries[at];
    codec_command command;
    if (!decode(r, at, &command)) continue;
    while (n < r->out->count && r->out->ticks[n].sync_line < entry->line) ++n;
    if (answered[at]) {
      last[0] = last[1];
      last[1] = command.counter;
    } else if (entry->line > first && command.counter != last[0] && command.counter != last[1] &&
               !is_taken_later(r, answered, at) && !may_be_left_out(r, at, n)) {
      return candump_fail(r->error, r->file, entry->line, 0, "COMMAND %d with counter %d has no ACK",
                          command.command, command.counter);
    }
  }
  return 1;
}

int replay_find_commands(replay_reader *r) {
  uint8_t *answered = calloc(r->log->count + 1, 1);
  int good = answered != NULL;
  if (!good) (void)candump_fail(r->error, r->file, 0, 0, "not enough memory");
  for (uint32_t n = 0; good && n < r->out->count; ++n)
    if (r->out->ticks[n].ack_line != 0) good = answer_command(r, answered, n);
  if (good) good = check_unanswered(r, answered);
  free(answered);
  return good;
}
