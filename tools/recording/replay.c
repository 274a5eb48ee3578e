/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/recording/replay.h"

#include <inttypes.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "tools/recording/replay_reader.h"

/* A FORCE is sent in its tick; on a busy bus it may follow the next SYNC, as its id loses to that. One
 * that is this many SYNCs late belongs to another tick. */
enum { LATE_TICKS = 8 };

static int refuse_frame(const replay_reader *r, const candump_entry *entry, const char *name,
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

static int no_memory(replay_reader *r) {
  return candump_fail(r->error, r->file, 0, 0, "not enough memory for a log of this length");
}

int replay_take_ticks(replay_reader *r, size_t ticks) {
  r->out->ticks = calloc(ticks + 1, sizeof *r->out->ticks);
  return r->out->ticks != NULL || no_memory(r);
}

static int take_list(replay_reader *r, replay_list *list, size_t room) {
  list->of = calloc(room + 1, sizeof *list->of);
  return list->of != NULL || no_memory(r);
}

uint64_t replay_tick_number(uint32_t low, uint64_t near) {
  const int64_t away = (int32_t)(low - (uint32_t)near);
  return away < 0 && near < (uint64_t)-away ? low : near + (uint64_t)away;
}

static uint32_t low_of(uint64_t tick) { return (uint32_t)(tick & UINT32_MAX); }

/* The tick with these low bits; NULL iff the recording has none. */
static replay_tick *tick_of(const replay *out, uint32_t low) {
  const uint32_t n = low - low_of(out->first);
  return n < out->count ? &out->ticks[n] : NULL;
}

/* A runtime repeats a SYNC that was not confirmed; no tick was computed in between. */
static int check_again(replay_reader *r, const candump_entry *entry, const codec_sync *sync) {
  const replay *out = r->out;
  const uint32_t hash = out->count == 1 ? out->start_hash : out->ticks[out->count - 2].hash;
  if (sync->hash == hash) return 1;
  return candump_fail(r->error, r->file, entry->line, 0,
                      "SYNC of tick %" PRIu64 " says %08" PRIx32 ", expected %08" PRIx32
                      " as in line %d: a repeated SYNC has the same hash",
                      out->first + out->count - 1u, sync->hash, hash, out->ticks[out->count - 1].sync_line);
}

/* One SYNC: a new tick, or a repetition. */
static int add_sync(replay_reader *r, const candump_entry *entry) {
  replay *out = r->out;
  codec_sync sync;
  const codec_reason reason = codec_decode_sync(&entry->frame, r->setting->instance, &sync);
  if (reason != CODEC_OK) return refuse_frame(r, entry, "SYNC", reason);
  if (out->count == 0) {
    out->first = replay_tick_number(sync.tick, r->setting->tick);
    r->first_sync_line = entry->line;
    if (out->first != r->setting->tick)
      return candump_fail(r->error, r->file, entry->line, 0,
                          "the recording starts with tick %" PRIu64 ", the image with tick %" PRIu64, out->first,
                          r->setting->tick);
  }
  const uint64_t expected = out->first + out->count;
  const int again = out->count > 0 && sync.tick == low_of(expected - 1u);
  if (!again && sync.tick != low_of(expected)) {
    return candump_fail(r->error, r->file, entry->line, 0,
                        "SYNC of tick %" PRIu64 ", expected tick %" PRIu64 ": a SYNC is missing",
                        replay_tick_number(sync.tick, expected), expected);
  }
  if (again) return check_again(r, entry, &sync);
  out->ticks[out->count].sync_line = entry->line;
  out->count += 1;
  if (out->count == 1) {
    out->start_hash = sync.hash;
  } else {
    out->ticks[out->count - 2].hash = sync.hash;
    out->ticks[out->count - 2].hash_line = entry->line;
  }
  return 1;
}

static int read_syncs(replay_reader *r) {
  size_t syncs = 0, tears = 0, statuses = 0, identities = 0;
  for (size_t n = 0; n < r->log->count; ++n) {
    const dictionary_message message = message_of(r, &r->log->entries[n].frame);
    syncs += message == MESSAGE_SYNC;
    tears += message == MESSAGE_TEAR;
    statuses += message == MESSAGE_STATUS;
    identities += message == MESSAGE_IDENTITY;
  }
  if (syncs > UINT32_MAX) return candump_fail(r->error, r->file, 0, 0, "more than %u SYNCs", UINT32_MAX);
  if (!replay_take_ticks(r, syncs) || !take_list(r, &r->out->tears, tears) ||
      !take_list(r, &r->out->statuses, statuses) || !take_list(r, &r->out->identities, identities))
    return 0;
  for (size_t n = 0; n < r->log->count; ++n) {
    const candump_entry *entry = &r->log->entries[n];
    if (message_of(r, &entry->frame) == MESSAGE_SYNC && !add_sync(r, entry)) return 0;
  }
  r->sync_count = r->out->count;
  return 1;
}

/* The n-th FORCE of a hand; *next counts the ticks that have one. */
static int add_force(replay_reader *r, uint32_t hand, const candump_entry *entry, uint32_t *next) {
  replay *out = r->out;
  codec_force force;
  const codec_reason reason = codec_decode_force(&entry->frame, r->setting->instance, hand, &force);
  if (reason != CODEC_OK) return refuse_frame(r, entry, "FORCE", reason);
  const uint64_t tick = out->first + *next;
  if ((r->setting->hands >> hand & 1u) == 0)
    return candump_fail(r->error, r->file, entry->line, 0, "FORCE %s: the world does not have this hand",
                        hand_name(hand));
  /* or sent twice by a controller */
  if (*next > 0 && memcmp(out->ticks[*next - 1].force[hand], entry->frame.data, 8) == 0) return 1;
  const uint64_t late = (uint64_t)*next + LATE_TICKS;
  if (*next == out->count || force.counter != (tick & 15u) ||
      (late < out->count && entry->line > out->ticks[late].sync_line)) {
    return candump_fail(r->error, r->file, entry->line, 0,
                        "FORCE %s with counter %d, expected that of tick %" PRIu64 ", %d: a FORCE or "
                        "a SYNC is missing",
                        hand_name(hand), force.counter, tick, (int)(tick & 15u));
  }
  out->ticks[*next].force_line[hand] = entry->line;
  memcpy(out->ticks[*next].force[hand], entry->frame.data, 8);
  *next += 1;
  return 1;
}

static int add_ack(replay_reader *r, const candump_entry *entry) {
  codec_ack ack;
  const codec_reason reason = codec_decode_ack(&entry->frame, r->setting->instance, &ack);
  if (reason != CODEC_OK) return refuse_frame(r, entry, "ACK", reason);
  replay_tick *tick = tick_of(r->out, ack.tick);
  if (tick == NULL)
    return candump_fail(r->error, r->file, entry->line, 0, "ACK of tick %" PRIu64 ", which has no SYNC",
                        replay_tick_number(ack.tick, r->out->first));
  if (tick->ack_line != 0 && memcmp(tick->ack, entry->frame.data, 8) != 0) {
    return candump_fail(r->error, r->file, entry->line, 0,
                        "a second ACK of tick %" PRIu64 ", the first is in line %d",
                        replay_tick_number(ack.tick, r->out->first), tick->ack_line);
  }
  if (tick->ack_line == 0) tick->ack_line = entry->line;
  memcpy(tick->ack, entry->frame.data, 8);
  return 1;
}

static void add_to(replay_list *list, const candump_entry *entry) {
  list->of[list->count].line = entry->line;
  memcpy(list->of[list->count].data, entry->frame.data, 8);
  list->count += 1;
}

static int add_tear(replay_reader *r, const candump_entry *entry) {
  codec_tear tear;
  const codec_reason reason = codec_decode_tear(&entry->frame, r->setting->instance, &tear);
  if (reason != CODEC_OK) return refuse_frame(r, entry, "TEAR", reason);
  add_to(&r->out->tears, entry);
  return 1;
}

static int add_status(replay_reader *r, const candump_entry *entry) {
  codec_status status;
  const codec_reason reason = codec_decode_status(&entry->frame, r->setting->instance, &status);
  if (reason != CODEC_OK) return refuse_frame(r, entry, "STATUS", reason);
  add_to(&r->out->statuses, entry);
  return 1;
}

static int add_identity(replay_reader *r, const candump_entry *entry) {
  codec_identity identity;
  const codec_reason reason = codec_decode_identity(&entry->frame, r->setting->instance, &identity);
  if (reason != CODEC_OK) return refuse_frame(r, entry, "IDENTITY", reason);
  const replay_list *list = &r->out->identities;
  const int twice = list->count > 0 && memcmp(list->of[list->count - 1].data, entry->frame.data, 8) == 0;
  if (!twice) add_to(&r->out->identities, entry); /* else sent twice by a controller */
  return 1;
}

/* Of a tick; IDENTITY stands before the first one. */
static const char *output_name(dictionary_message m) {
  switch (m) {
    case MESSAGE_FORCE_LEFT:
    case MESSAGE_FORCE_RIGHT: return "FORCE";
    case MESSAGE_ACK: return "ACK";
    case MESSAGE_TEAR: return "TEAR";
    case MESSAGE_STATUS: return "STATUS";
    default: return NULL;
  }
}

/* Frames of the runtime: FORCE, ACK, TEAR, STATUS, IDENTITY. */
static int read_outputs(replay_reader *r) {
  uint32_t forces[FRAY_HANDS] = {0, 0};
  for (size_t n = 0; n < r->log->count; ++n) {
    const candump_entry *entry = &r->log->entries[n];
    const dictionary_message message = message_of(r, &entry->frame);
    const char *name = output_name(message);
    int good = 1;
    if (name != NULL && entry->line < r->first_sync_line)
      return candump_fail(r->error, r->file, entry->line, 0, "%s before the first SYNC, of another session", name);
    switch (message) {
      case MESSAGE_FORCE_LEFT: good = add_force(r, 0, entry, &forces[0]); break;
      case MESSAGE_FORCE_RIGHT: good = add_force(r, 1, entry, &forces[1]); break;
      case MESSAGE_ACK: good = add_ack(r, entry); break;
      case MESSAGE_TEAR: good = add_tear(r, entry); break;
      case MESSAGE_STATUS: good = add_status(r, entry); break;
      case MESSAGE_IDENTITY: good = add_identity(r, entry); break;
      default: break;
    }
    if (!good) return 0;
  }
  return 1;
}

/* Its FORCEs are there, and the SYNC behind it. */
static int is_whole(const replay_reader *r, const replay_tick *tick) {
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    if ((r->setting->hands >> h & 1u) != 0 && tick->force_line[h] == 0) return 0;
  return tick->hash_line != 0;
}

/* The last SYNC closes the recording: it belongs to no tick. */
static int end_ticks(replay_reader *r) {
  replay *out = r->out;
  const replay_tick *last = &out->ticks[out->count - 1];
  const int is_bare = last->force_line[0] == 0 && last->force_line[1] == 0 && last->ack_line == 0;
  if (!is_bare && !r->setting->cut) {
    return candump_fail(r->error, r->file, last->sync_line, 0,
                        "tick %" PRIu64 " has no hash, expected a closing SYNC behind it: the recording was cut "
                        "off (--cut takes the ticks that are whole)",
                        out->first + out->count - 1u);
  }
  out->count -= 1;
  uint32_t late = 0;
  for (; r->setting->cut && out->count > 0 && late < LATE_TICKS && !is_whole(r, last - 1); ++late) {
    out->count -= 1;
    --last;
  }
  if (!is_bare || late > 0) out->cut_line = last->sync_line;
  return 1;
}

/* Ends the ticks, then checks that every FORCE is there. */
static int close_ticks(replay_reader *r) {
  replay *out = r->out;
  if (!end_ticks(r)) return 0;
  for (uint32_t n = 0; n < out->count; ++n) {
    for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
      const int used = (r->setting->hands >> h & 1u) != 0;
      if (!used || out->ticks[n].force_line[h] != 0) continue;
      return candump_fail(r->error, r->file, out->ticks[n].sync_line, 0,
                          "tick %" PRIu64 " has no FORCE %s", out->first + n, hand_name(h));
    }
  }
  return 1;
}

int replay_line_limit(const replay_reader *r, uint32_t n) {
  const uint64_t late = (uint64_t)n + REPLAY_INPUT_LATE;
  return late < r->sync_count ? r->out->ticks[late].sync_line : INT_MAX;
}

static int read_recording(replay_reader *r) {
  r->out->recording = 1;
  if (!read_syncs(r) || !read_outputs(r) || !close_ticks(r)) return 0;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    if ((r->setting->hands >> h & 1u) != 0 && !replay_find_poses(r, h)) return 0;
  }
  return replay_find_commands(r);
}

int replay_read(const char *file, const candump_log *log, const replay_setting *setting,
                replay *out, candump_error *error) {
  replay_reader r = {file, log, setting, out, error, 0, 0};
  memset(out, 0, sizeof *out);
  const int good = replay_is_recording(log, setting->instance) ? read_recording(&r)
                                                               : replay_read_device(&r);
  if (!good) replay_free(out);
  return good;
}

void replay_free(replay *r) {
  free(r->ticks);
  free(r->tears.of);
  free(r->statuses.of);
  free(r->identities.of);
  memset(r, 0, sizeof *r);
}
