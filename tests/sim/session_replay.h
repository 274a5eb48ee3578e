/* SPDX-License-Identifier: Apache-2.0 */
/* The log of a session on the simulated bus, replayed in a world opened anew: the same hash after each tick. */
#ifndef FRAY_TESTS_SIM_SESSION_REPLAY_H
#define FRAY_TESTS_SIM_SESSION_REPLAY_H

#include "tests/sim/sim_session.h"
#include "tools/recording/replay.h"

enum { SESSION_TICKS_MAX = 8192 };

static uint32_t session_hashes[SESSION_TICKS_MAX], session_ticks;

/* One tick of the loop, its hash kept. */
static inline loop_result session_hashed_tick(session *s) {
  const loop_result result = loop_run(&s->l);
  if (result == LOOP_TICKED && session_ticks < SESSION_TICKS_MAX)
    session_hashes[session_ticks++] = (uint32_t)(s->l.output.hash & 0xFFFFFFFFu);
  return result;
}

/* Closes the session; its log is the recording. */
static inline void session_end_log(session *s, candump_log *log) {
  size_t bytes;
  candump_error error;
  CHECK_EQ_INT(loop_close(&s->l), LOOP_TICKED);
  char *const text = sim_log(&bytes);
  CHECK(candump_parse_all("sim", text, bytes, log, &error));
  free(text);
}

static inline int session_read_replay(const session *s, const candump_log *log, replay *r, candump_error *error) {
  const replay_setting setting = {0, s->f.facts.hands, s->f.facts.rate_hz, s->f.facts.tick, {0, 0}, 0, 0};
  memset(error, 0, sizeof *error);
  return replay_read("sim", log, &setting, r, error);
}

/* Every hash that the world and the bus said; returns how many ticks have another one. Frees the log. */
static inline uint32_t session_replay(const session *s, candump_log *log) {
  candump_error error;
  replay r;
  fixture again = s->f;
  uint32_t bad = 0;
  const int good = session_read_replay(s, log, &r, &error);
  CHECK(good);
  candump_free(log);
  if (!good) {
    candump_print_error(stdout, &error);
    return session_ticks;
  }
  fixture_open_image(&again);
  CHECK_EQ_INT(r.count, session_ticks);
  for (uint32_t n = 0; n < r.count && n < session_ticks; ++n) {
    const uint32_t found = (uint32_t)(fixture_tick(&again, &r.ticks[n].input).hash & 0xFFFFFFFFu);
    bad += found != session_hashes[n] || r.ticks[n].hash != found;
  }
  CHECK_EQ_INT(bad, 0);
  free(again.memory);
  replay_free(&r);
  return bad;
}

#endif
