/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/replay.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "rt/wire/dictionary.h"
#include "rt/wire/sequence.h"

/* A FORCE is sent in its tick; on a crowded bus it may come after the next SYNC, whose id wins
 * the arbitration. One that comes so many SYNCs later is another tick's. */
enum { FORCE_LATE_TICKS = 8, COMMAND_WINDOW = 4096 /* entries before an ACK */ };

/* What a tick took stood in the queue before its SYNC. A listener may see it a little later; two
 * SYNCs later it is another one with the same counter, and the one that was taken is missing. */
enum { INPUT_LATE_TICKS = 2 };

/* One replay_read(). */
typedef struct {
  const char *file;
  const candump_log *log;
  const replay_setting *setting;
  replay *out;
  candump_error *error;
  int first_sync_line;
  uint32_t sync_count; /* with the closing one */
} reader;

static const char *hand_name(uint32_t hand) { return hand == 0 ? "left" : "right"; }

static dictionary_message message_of(const reader *r, const frame *f) {
  return f->extended || f->error ? MESSAGES : dictionary_find(f->id, r->setting->instance);
}

static int refuse_frame(const reader *r, const candump_entry *entry, const char *name,
                        codec_reason reason) {
  return candump_fail(r->error, r->file, entry->line, 0, "%s has %s", name,
                      codec_reason_text(reason));
}

int replay_is_recording(const candump_log *log, uint32_t instance) {
  for (size_t n = 0; n < log->count; ++n) {
    const frame *f = &log->entries[n].frame;
    if (!f->extended && !f->error && f->id == dictionary_id(MESSAGE_SYNC, instance)) return 1;
  }
  return 0;
}

static int take_memory(reader *r, size_t ticks, size_t tears) {
  r->out->ticks = calloc(ticks + 1, sizeof *r->out->ticks);
  r->out->tears = calloc(tears + 1, sizeof *r->out->tears);
  if (r->out->ticks != NULL && r->out->tears != NULL) return 1;
  return candump_fail(r->error, r->file, 0, 0, "not enough memory for a log of this length");
}

/* The tick of the recording with this number; NULL iff there is none. */
static replay_tick *tick_of(const replay *out, uint32_t tick) {
  const int64_t n = (int64_t)tick - (int64_t)out->first;
  return n >= 0 && n < (int64_t)out->count ? &out->ticks[n] : NULL;
}

/* One SYNC: a new tick, or the same once more. */
static int add_sync(reader *r, const candump_entry *entry) {
  replay *out = r->out;
  codec_sync sync;
  const codec_reason reason = codec_decode_sync(&entry->frame, r->setting->instance, &sync);
  if (reason != CODEC_OK) return refuse_frame(r, entry, "SYNC", reason);
  if (out->count == 0) {
    out->first = sync.tick;
    r->first_sync_line = entry->line;
  }
  const int64_t expected = (int64_t)out->first + out->count;
  const int again = out->count > 0 && (int64_t)sync.tick == expected - 1;
  if (!again && (int64_t)sync.tick != expected) {
    return candump_fail(r->error, r->file, entry->line, 0,
                        "SYNC of tick %lu, expected tick %lld: a SYNC is missing",
                        (unsigned long)sync.tick, (long long)expected);
  }
  if (!again) {
    out->ticks[out->count].sync_line = entry->line;
    out->count += 1;
  }
  if (out->count == 1) {
    out->start_hash = sync.hash;
  } else {
    out->ticks[out->count - 2].hash = sync.hash;
    out->ticks[out->count - 2].hash_line = entry->line;
  }
  return 1;
}

static int read_syncs(reader *r) {
  size_t syncs = 0, tears = 0;
  for (size_t n = 0; n < r->log->count; ++n) {
    const dictionary_message message = message_of(r, &r->log->entries[n].frame);
    syncs += message == MESSAGE_SYNC;
    tears += message == MESSAGE_TEAR;
  }
  if (syncs > REPLAY_TICKS_MAX) {
    return candump_fail(r->error, r->file, 0, 0, "more than %d SYNCs", (int)REPLAY_TICKS_MAX);
  }
  if (!take_memory(r, syncs, tears)) return 0;
  for (size_t n = 0; n < r->log->count; ++n) {
    const candump_entry *entry = &r->log->entries[n];
    if (message_of(r, &entry->frame) == MESSAGE_SYNC && !add_sync(r, entry)) return 0;
  }
  r->sync_count = r->out->count;
  return 1;
}

/* The n-th FORCE of a hand; *next counts the ticks that have theirs. */
static int add_force(reader *r, uint32_t hand, const candump_entry *entry, uint32_t *next) {
  replay *out = r->out;
  codec_force force;
  const codec_reason reason = codec_decode_force(&entry->frame, r->setting->instance, hand, &force);
  if (reason != CODEC_OK) return refuse_frame(r, entry, "FORCE", reason);
  const uint32_t tick = out->first + *next;
  const replay_tick *before = *next > 0 ? &out->ticks[*next - 1] : NULL;
  /* Of the tick before the first SYNC; or sent twice by a controller. */
  if (before == NULL && entry->line < r->first_sync_line) return 1;
  if (before != NULL && memcmp(before->force[hand], entry->frame.data, 8) == 0) return 1;
  if (before == NULL && force.counter == ((tick + 15u) & 15u)) return 1;
  const uint32_t late = *next + FORCE_LATE_TICKS;
  if (*next == out->count || force.counter != (tick & 15u) ||
      (late < out->count && entry->line > out->ticks[late].sync_line)) {
    return candump_fail(r->error, r->file, entry->line, 0,
                        "FORCE %s with counter %d, expected that of tick %lu, %lu: a FORCE or "
                        "a SYNC is missing",
                        hand_name(hand), force.counter, (unsigned long)tick,
                        (unsigned long)(tick & 15u));
  }
  out->ticks[*next].force_line[hand] = entry->line;
  memcpy(out->ticks[*next].force[hand], entry->frame.data, 8);
  *next += 1;
  return 1;
}

static int add_ack(reader *r, const candump_entry *entry) {
  codec_ack ack;
  const codec_reason reason = codec_decode_ack(&entry->frame, r->setting->instance, &ack);
  if (reason != CODEC_OK) return refuse_frame(r, entry, "ACK", reason);
  replay_tick *tick = tick_of(r->out, ack.tick);
  if (tick == NULL) {
    if (ack.tick + 1u == r->out->first) return 1;
    return candump_fail(r->error, r->file, entry->line, 0, "ACK of tick %lu, which has no SYNC",
                        (unsigned long)ack.tick);
  }
  if (tick->ack_line != 0 && memcmp(tick->ack, entry->frame.data, 8) != 0) {
    return candump_fail(r->error, r->file, entry->line, 0,
                        "a second ACK of tick %lu, the first is in line %d",
                        (unsigned long)ack.tick, tick->ack_line);
  }
  if (tick->ack_line == 0) tick->ack_line = entry->line;
  memcpy(tick->ack, entry->frame.data, 8);
  return 1;
}

static int add_tear(reader *r, const candump_entry *entry) {
  codec_tear tear;
  const codec_reason reason = codec_decode_tear(&entry->frame, r->setting->instance, &tear);
  if (reason != CODEC_OK) return refuse_frame(r, entry, "TEAR", reason);
  if (entry->line < r->first_sync_line) return 1;
  r->out->tears[r->out->tear_count].line = entry->line;
  memcpy(r->out->tears[r->out->tear_count].data, entry->frame.data, 8);
  r->out->tear_count += 1;
  return 1;
}

/* What the runtime said: FORCE, ACK, TEAR. */
static int read_outputs(reader *r) {
  uint32_t forces[FRAY_HANDS] = {0, 0};
  for (size_t n = 0; n < r->log->count; ++n) {
    const candump_entry *entry = &r->log->entries[n];
    int good = 1;
    switch (message_of(r, &entry->frame)) {
      case MESSAGE_FORCE_LEFT: good = add_force(r, 0, entry, &forces[0]); break;
      case MESSAGE_FORCE_RIGHT: good = add_force(r, 1, entry, &forces[1]); break;
      case MESSAGE_ACK: good = add_ack(r, entry); break;
      case MESSAGE_TEAR: good = add_tear(r, entry); break;
      default: break;
    }
    if (!good) return 0;
  }
  return 1;
}

/* Drops the last tick if only its SYNC is there, then wants every FORCE. */
static int close_ticks(reader *r) {
  replay *out = r->out;
  const replay_tick *last = &out->ticks[out->count - 1];
  if (last->force_line[0] == 0 && last->force_line[1] == 0 && last->ack_line == 0) out->count -= 1;
  for (uint32_t n = 0; n < out->count; ++n) {
    for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
      const int used = (r->setting->hands >> h & 1u) != 0;
      if (!used || out->ticks[n].force_line[h] != 0) continue;
      return candump_fail(r->error, r->file, out->ticks[n].sync_line, 0,
                          "tick %lu has no FORCE %s", (unsigned long)(out->first + n),
                          hand_name(h));
    }
  }
  return 1;
}

/* Entries from this line on are too late for tick n. */
static int line_limit(const reader *r, uint32_t n) {
  const uint32_t late = n + INPUT_LATE_TICKS;
  return late < r->sync_count ? r->out->ticks[late].sync_line : INT_MAX;
}

/* Where a search for the POSEs of one hand stands. */
typedef struct {
  size_t at; /* the next entry */
  sequence counters;
} pose_search;

/* The next POSE with this counter, before line `limit`, that a port accepts. */
static int find_accepted(const reader *r, uint32_t hand, uint8_t counter, int limit,
                         pose_search *from, fray_pose *pose) {
  pose_search s = *from;
  for (; s.at < r->log->count && r->log->entries[s.at].line < limit; ++s.at) {
    const frame *f = &r->log->entries[s.at].frame;
    if (codec_decode_pose(f, r->setting->instance, hand, pose) != CODEC_OK) continue;
    if (sequence_take(&s.counters, pose->counter) != SEQUENCE_NEW) continue;
    if (pose->counter != counter) continue;
    s.at += 1;
    *from = s;
    return 1;
  }
  return 0;
}

/* The next one at all, for a log whose listener saw another order: skipping up to 15 counters. */
static int find_any(const reader *r, uint32_t hand, uint8_t counter, int limit,
                    pose_search *from, fray_pose *pose) {
  uint32_t skipped = 0;
  int last = -1;
  for (size_t at = from->at; at < r->log->count && skipped < 16; ++at) {
    if (r->log->entries[at].line >= limit) return 0;
    const frame *f = &r->log->entries[at].frame;
    if (codec_decode_pose(f, r->setting->instance, hand, pose) != CODEC_OK) continue;
    if (pose->counter == counter) {
      from->at = at + 1;
      sequence_begin(&from->counters, counter);
      return 1;
    }
    skipped += pose->counter != last; /* a port drops repeated ones too */
    last = pose->counter;
  }
  return 0;
}

/* The entry from which on each counter comes once before this line; *more: there are POSEs before. */
static size_t last_round(const reader *r, uint32_t hand, int line, int *more) {
  uint32_t poses = 0;
  size_t at = 0;
  while (at < r->log->count && r->log->entries[at].line < line) ++at;
  for (*more = 0; at > 0; --at) {
    fray_pose pose;
    const frame *f = &r->log->entries[at - 1].frame;
    if (codec_decode_pose(f, r->setting->instance, hand, &pose) != CODEC_OK) continue;
    if (++poses < 16) continue;
    *more = 1;
    break;
  }
  return at;
}

/* A device that runs free can have been there before the runtime, and a listener too. The first POSE
 * that was taken is then the last with its counter before its tick, not the first in the log. */
static int find_first(const reader *r, uint32_t hand, uint32_t n, pose_search *search,
                      fray_pose *pose) {
  const replay_tick *tick = &r->out->ticks[n];
  int more;
  const size_t at = last_round(r, hand, tick->sync_line, &more);
  if (!more) return 0;
  search->at = at;
  return find_any(r, hand, (uint8_t)(tick->force[hand][1] >> 4), line_limit(r, n), search, pose);
}

static int assign_poses(reader *r, uint32_t hand) {
  replay *out = r->out;
  uint8_t consumed = r->setting->consumed[hand];
  pose_search search = {0, {0, 0, 0}};
  int is_first = 1;
  sequence_begin(&search.counters, consumed);
  for (uint32_t n = 0; n < out->count; ++n) {
    replay_tick *tick = &out->ticks[n];
    if (tick->force_line[hand] == 0) continue;
    const uint8_t says = (uint8_t)(tick->force[hand][1] >> 4);
    if (says == consumed) continue;
    fray_pose *pose = &tick->input.pose[hand];
    const int limit = line_limit(r, n);
    const int found = is_first && find_first(r, hand, n, &search, pose);
    is_first = 0;
    if (!found && !find_accepted(r, hand, says, limit, &search, pose) &&
        !find_any(r, hand, says, limit, &search, pose)) {
      return candump_fail(r->error, r->file, tick->force_line[hand], 0,
                          "tick %lu consumed a POSE %s with counter %d, which is not in the log",
                          (unsigned long)(out->first + n), hand_name(hand), says);
    }
    tick->input.has_pose = (uint8_t)(tick->input.has_pose | 1u << hand);
    consumed = says;
  }
  return 1;
}

/* Whether entry `at` is this COMMAND and has not been answered before. */
static int is_open_command(const reader *r, const uint8_t *answered, size_t at, uint8_t verb,
                           uint8_t counter) {
  codec_command command;
  return !answered[at] &&
         codec_decode_command(&r->log->entries[at].frame, r->setting->instance, &command) ==
             CODEC_OK &&
         command.counter == counter && command.verb == verb;
}

/* The newest one: the runtime's own HALT overtakes what an operator has said before it. */
static int answer_command(const reader *r, uint8_t *answered, uint32_t n) {
  replay_tick *tick = &r->out->ticks[n];
  const uint8_t counter = (uint8_t)(tick->ack[1] >> 4);
  const int limit = line_limit(r, n);
  const candump_entry *entries = r->log->entries;
  size_t end = r->log->count;
  while (end > 0 && entries[end - 1].line >= limit) --end;
  uint32_t before = 0; /* behind the ACK a crowded bus may go on without SYNCs */
  for (size_t at = end; at > 0 && before < COMMAND_WINDOW; --at) {
    before += entries[at - 1].line < tick->ack_line;
    if (is_open_command(r, answered, at - 1, tick->ack[2], counter)) {
      answered[at - 1] = 1;
      tick->input.verb = tick->ack[2];
      tick->input.verb_counter = counter;
      return 1;
    }
  }
  return candump_fail(r->error, r->file, tick->ack_line, 0,
                      "ACK of verb %d with counter %d, whose COMMAND is not in the log",
                      tick->ack[2], counter);
}

static int assign_commands(reader *r) {
  uint8_t *answered = calloc(r->log->count + 1, 1);
  int good = answered != NULL;
  if (!good) (void)candump_fail(r->error, r->file, 0, 0, "not enough memory");
  for (uint32_t n = 0; good && n < r->out->count; ++n)
    if (r->out->ticks[n].ack_line != 0) good = answer_command(r, answered, n);
  free(answered);
  return good;
}

static int read_recording(reader *r) {
  r->out->recording = 1;
  if (!read_syncs(r) || !read_outputs(r) || !close_ticks(r)) return 0;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    if ((r->setting->hands >> h & 1u) != 0 && !assign_poses(r, h)) return 0;
  }
  return assign_commands(r);
}

/* floor((time - start) * rate), never before the tick of the frame before. */
static int64_t tick_at(const reader *r, int64_t time_us, int64_t before) {
  const int64_t rate = r->setting->rate_hz;
  const int64_t since = time_us - r->log->entries[0].time_us;
  if (since < 0) return before;
  const int64_t tick = since / 1000000 * rate + since % 1000000 * rate / 1000000;
  return tick < before ? before : tick;
}

static int read_device(reader *r) {
  replay *out = r->out;
  const size_t entries = r->log->count;
  int64_t last = -1;
  for (size_t n = 0; n < entries; ++n) {
    const int64_t since = r->log->entries[n].time_us - r->log->entries[0].time_us;
    if (since / 1000000 > REPLAY_TICKS_MAX || tick_at(r, r->log->entries[n].time_us, 0) >=
                                                  REPLAY_TICKS_MAX) {
      return candump_fail(r->error, r->file, r->log->entries[n].line, 0,
                          "more than %d ticks after the first frame", (int)REPLAY_TICKS_MAX);
    }
    last = tick_at(r, r->log->entries[n].time_us, last < 0 ? 0 : last);
  }
  if (!take_memory(r, (size_t)(last + 1), 0)) return 0;
  out->count = (uint32_t)(last + 1);
  port *p = malloc(sizeof *p);
  if (p == NULL) return candump_fail(r->error, r->file, 0, 0, "not enough memory");
  port_init(p, r->setting->instance, r->setting->hands, r->setting->consumed);
  size_t at = 0;
  int64_t now = 0;
  for (uint32_t n = 0; n < out->count; ++n) {
    for (; at < entries; ++at) {
      const int64_t tick = tick_at(r, r->log->entries[at].time_us, now);
      if (tick > (int64_t)n) break;
      now = tick;
      port_push(p, &r->log->entries[at].frame);
    }
    port_take(p, &out->ticks[n].input);
  }
  out->port = p->statistics;
  free(p);
  return 1;
}

int replay_read(const char *file, const candump_log *log, const replay_setting *setting,
                replay *out, candump_error *error) {
  reader r = {file, log, setting, out, error, 0, 0};
  memset(out, 0, sizeof *out);
  const int good = replay_is_recording(log, setting->instance) ? read_recording(&r)
                                                               : read_device(&r);
  if (!good) replay_free(out);
  return good;
}

void replay_free(replay *r) {
  free(r->ticks);
  free(r->tears);
  memset(r, 0, sizeof *r);
}
