/* SPDX-License-Identifier: Apache-2.0 */
/* A small cloth on two hands, its loop on the simulated bus, and a device that answers each SYNC. */
#ifndef FRAY_TESTS_SIM_SIM_SESSION_H
#define FRAY_TESTS_SIM_SIM_SESSION_H

#include "rt/wire/codec.h"
#include "rt/wire/dictionary.h"
#include "tests/lib/world_fixture.h"
#include "tests/sim/sim_board.h"

/* `wide` warps and wefts; a heavy cloth pulls harder. The hands hold its upper corners. */
FIXTURE void session_scene(fixture *f, uint32_t wide, uint32_t substeps, const char *density) {
  const double corner = (wide - 1) / 24.0;
  fixture_print(f,
                "scene sim\nrate 1000 Hz\nsubsteps %u\niterations 1\ngravity 0 -981 0 cm/s2\nseed 1\n"
                "woven {\n warps %u\n wefts %u\n spacing 12 /cm\n density %s g/cm2\n"
                " thickness 0.01 cm\n structural 6000 g/s2\n bend 5 g/s2\n shear 2 g/s2\n tear off\n}\n"
                "sphere left {\n radius 0.1 cm\n at %.4f %.4f 0 cm\n move hand left\n attach_within 0.01 cm\n}\n"
                "sphere right {\n radius 0.1 cm\n at %.4f %.4f 0 cm\n move hand right\n"
                " attach_within 0.01 cm\n}\n",
                substeps, wide, wide, density, -corner, corner, corner, corner);
}

typedef struct {
  fixture f;
  loop l;
  uint8_t counter[FRAY_HANDS], command;
  int16_t apart;      /* each hand's way out, device steps */
  uint8_t silent;     /* bit h: hand h says nothing */
} session;

/* The world is built or opened before; counters go on where the world left off. */
FIXTURE void session_begin(session *s) {
  const fray_info facts = fray_get_info(s->f.w);
  sim_begin(facts.rate_hz);
  loop_begin(&s->l, s->f.w, 0);
  memcpy(s->counter, facts.consumed, sizeof s->counter);
  s->command = 0;
  s->silent = 0;
}

FIXTURE void session_poses(session *s) {
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    if (((uint32_t)s->silent >> h & 1u) != 0) continue;
    s->counter[h] = (uint8_t)((s->counter[h] + 1u) & 15u);
    sim_pose(h, s->counter[h], (int16_t)(h == 0 ? -s->apart : s->apart), 0, 0);
  }
}

FIXTURE void session_command(session *s, uint8_t verb) {
  s->command = (uint8_t)((s->command + 1u) & 15u);
  sim_command(s->command, verb);
}

/* One tick: the device answers its SYNC, for the next one. */
FIXTURE loop_result session_tick(session *s) {
  const loop_result result = loop_run(&s->l);
  session_poses(s);
  return result;
}

FIXTURE int session_force_is_zero(const fray_output *o) {
  static const int16_t zero[FRAY_HANDS][3];
  return memcmp(o->force, zero, sizeof zero) == 0;
}

/* START, `ticks` ticks with the hands moving apart to `apart`. */
FIXTURE void session_start(session *s, uint32_t ticks, int16_t apart) {
  session_poses(s);
  session_command(s, FRAY_COMMAND_START);
  for (uint32_t n = 0; n < ticks; ++n) {
    const int32_t displacement = n < 20 ? 0 : apart * (int32_t)(n - 20) / (int32_t)ticks;
    s->apart = (int16_t)displacement;
    (void)session_tick(s);
  }
}

/* A copy of a small session with both hands under force. */
FIXTURE void session_under_force(fixture *saved) {
  fixture_scoped f = {0};
  session_scene(&f, 4, 1, "0.25");
  const fray_output o = fixture_start_hands(&f, 150);
  CHECK_EQ_INT(o.state, FRAY_OPERATIONAL);
  fixture_copy(saved, &f);
}

#endif
