/* SPDX-License-Identifier: Apache-2.0 */
#include <inttypes.h>
#include <stddef.h>

#include "rt/wire/sequence.h"
#include "tools/recording/replay_reader.h"

/* The state of a search for the POSEs of one hand. */
typedef struct {
  size_t at; /* the next entry */
  sequence counters;
} pose_search;

/* The next POSE with this counter, before line `limit`, that a port accepts. */
static int find_accepted(const replay_reader *r, uint32_t hand, uint8_t counter, int limit,
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

/* The next POSE of any counter, for a log in another order: skips up to 15 counters. */
static int find_any(const replay_reader *r, uint32_t hand, uint8_t counter, int limit,
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

/* The first entry from which each counter occurs once before this line; *more: there are earlier POSEs. */
static size_t last_round(const replay_reader *r, uint32_t hand, int line, int *more) {
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

/* A free-running device, and the listener, may have started before the runtime. The first consumed POSE is
 * then the last with its counter before its tick, not the first in the log. */
static int find_first(const replay_reader *r, uint32_t hand, uint32_t n, pose_search *search,
                      fray_pose *pose) {
  const replay_tick *tick = &r->out->ticks[n];
  int more;
  const size_t at = last_round(r, hand, tick->sync_line, &more);
  if (!more) return 0;
  search->at = at;
  return find_any(r, hand, (uint8_t)(tick->force[hand][1] >> 4), replay_line_limit(r, n), search, pose);
}

int replay_find_poses(replay_reader *r, uint32_t hand) {
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
    const int limit = replay_line_limit(r, n);
    const int found = is_first && find_first(r, hand, n, &search, pose);
    is_first = 0;
    if (!found && !find_accepted(r, hand, says, limit, &search, pose) &&
        !find_any(r, hand, says, limit, &search, pose)) {
      return candump_fail(r->error, r->file, tick->force_line[hand], 0,
                          "tick %" PRIu64 " consumed a POSE %s with counter %d, which is not in the log",
                          out->first + n, hand_name(hand), says);
    }
    tick->input.has_pose = (uint8_t)(tick->input.has_pose | 1u << hand);
    consumed = says;
  }
  return 1;
}
