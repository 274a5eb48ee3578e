/* SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include "tools/recording/replay_reader.h"

/* floor((time - start) * rate); -1: before the start. */
static int64_t tick_at(const replay_reader *r, int64_t time_us) {
  const int64_t rate = r->setting->rate_hz;
  const int64_t since = time_us - r->log->entries[0].time_us;
  return since < 0 ? -1 : since / 1000000 * rate + since % 1000000 * rate / 1000000;
}

static void count_absent(replay_reader *r, const frame *f) {
  const dictionary_message message = message_of(r, f);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    if ((r->setting->hands >> h & 1u) == 0 && message == dictionary_pose(h)) ++r->out->absent[h];
}

int replay_read_device(replay_reader *r) {
  replay *out = r->out;
  const size_t entries = r->log->count;
  int64_t last = -1;
  for (size_t n = 0; n < entries; ++n) {
    if (r->log->entries[n].time_us == CANDUMP_NO_TIME) {
      return candump_fail(r->error, r->file, r->log->entries[n].line, 0,
                          "a frame without a time in a log without SYNCs, expected one of candump -L or -t a");
    }
    const int64_t since = r->log->entries[n].time_us - r->log->entries[0].time_us;
    const int64_t tick = since / 1000000 > REPLAY_DEVICE_TICKS_MAX ? REPLAY_DEVICE_TICKS_MAX : tick_at(r, r->log->entries[n].time_us);
    if (tick >= REPLAY_DEVICE_TICKS_MAX) {
      return candump_fail(r->error, r->file, r->log->entries[n].line, 0,
                          "more than %d ticks after the first frame", (int)REPLAY_DEVICE_TICKS_MAX);
    }
    if (tick < last && out->back_line == 0) out->back_line = r->log->entries[n].line;
    if (tick > last) last = tick;
  }
  if (!replay_take_ticks(r, (size_t)(last + 1))) return 0;
  out->count = (uint32_t)(last + 1);
  port *p = malloc(sizeof *p);
  if (p == NULL) return candump_fail(r->error, r->file, 0, 0, "not enough memory");
  port_init(p, r->setting->instance, r->setting->hands, r->setting->consumed);
  const uint32_t counted = r->setting->counted != 0 ? r->setting->counted : out->count;
  size_t at = 0;
  for (uint32_t n = 0; n < out->count; ++n) {
    for (; at < entries; ++at) {
      if (tick_at(r, r->log->entries[at].time_us) > (int64_t)n) break;
      if (n < counted) count_absent(r, &r->log->entries[at].frame);
      port_push(p, &r->log->entries[at].frame);
    }
    port_take(p, &out->ticks[n].input);
    if (n < counted) out->port = p->statistics;
  }
  free(p);
  return 1;
}
