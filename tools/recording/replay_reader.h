/* SPDX-License-Identifier: Apache-2.0 */
/* What the parts of replay_read() share: replay.c reads the runtime's frames, replay_poses.c and replay_commands.c
 * find the inputs that they name, replay_device.c reads a log without SYNCs. */
#ifndef FRAY_TOOLS_RECORDING_REPLAY_READER_H
#define FRAY_TOOLS_RECORDING_REPLAY_READER_H

#include "rt/wire/dictionary.h"
#include "tools/recording/replay.h"

/* A tick consumes frames that were in the queue before its SYNC. A listener may see them a little later; two
 * SYNCs later a frame is another one with the same counter, and the consumed one is missing. */
enum { REPLAY_INPUT_LATE = 2 };

/* One replay_read(). */
typedef struct {
  const char *file;
  const candump_log *log;
  const replay_setting *setting;
  replay *out;
  candump_error *error;
  int first_sync_line;
  uint32_t sync_count; /* with the closing one */
} replay_reader;

static inline const char *hand_name(uint32_t hand) { return hand == 0 ? "left" : "right"; }

static inline dictionary_message message_of(const replay_reader *r, const frame *f) {
  return f->extended || f->error ? MESSAGES : dictionary_find(f->id, r->setting->instance);
}

/* The ticks of a log. Returns 0 with an error iff there is not enough memory. */
int replay_take_ticks(replay_reader *r, size_t ticks);

/* Entries from this line on are too late to be an input of tick n. */
int replay_line_limit(const replay_reader *r, uint32_t n);

/* Each returns 1, or 0 with an error. */
int replay_find_poses(replay_reader *r, uint32_t hand);
int replay_find_commands(replay_reader *r);
int replay_read_device(replay_reader *r);

#endif
