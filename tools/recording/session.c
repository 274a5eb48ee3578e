/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/recording/session.h"

#include <inttypes.h>
#include <string.h>

#include "tools/recording/log_file.h"
#include "tools/recording/unseal.h"

static int read_log(session *s, const session_log *from) {
  const char *path = from->file;
  candump_log log;
  candump_error error;
  memset(&error, 0, sizeof error);
  if (log_file_load(path, from->cut, &log, stderr) != LOG_FILE_GOOD) return 0;
  if (!unseal_log(path, &log, from->key, s->instance, s->facts.hands, stderr)) {
    candump_free(&log);
    return 0;
  }
  const replay_setting setting = {s->instance,
                                  s->facts.hands,
                                  s->facts.rate_hz,
                                  s->facts.tick,
                                  {s->facts.consumed[0], s->facts.consumed[1]},
                                  1,
                                  from->ticks};
  int good = replay_read(path, &log, &setting, &s->log, &error);
  candump_free(&log);
  if (good && s->log.back_line != 0)
    fprintf(stderr, "%s:%d: note: the time goes back, so that the frame is in the tick of the one above it; expected "
            "times as of candump -L or -t a\n", path, s->log.back_line);
  if (!good) {
    candump_print_error(stderr, &error);
  } else if (s->log.count == 0) {
    fprintf(stderr, "%s: holds no ticks, expected a device log or a recording\n", path);
    replay_free(&s->log);
    good = 0;
  }
  return good;
}

int session_open(session *s, const char *file, const session_log *log, uint32_t instance) {
  memset(s, 0, sizeof *s);
  s->instance = instance;
  const int code = world_file_open(file, &s->world_file, stderr);
  if (code != 0) return code;
  s->facts = fray_get_info(s->world_file.world);
  if (log->file != NULL && !read_log(s, log)) {
    world_file_close(&s->world_file);
    return 2;
  }
  return 0;
}

const fray_input *session_input(const session *s, uint64_t n) {
  static const fray_input nothing;
  return n < s->log.count ? &s->log.ticks[n].input : &nothing;
}

void session_close(session *s) {
  replay_free(&s->log);
  world_file_close(&s->world_file);
}
