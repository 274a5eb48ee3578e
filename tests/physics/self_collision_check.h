/* SPDX-License-Identifier: Apache-2.0 */
/* What tests of both self-collisions share: where particles were when a tick began, boxes of what moves, touches in
 * exact arithmetic, particles thrown anywhere, saves on the way. */
#ifndef FRAY_TESTS_PHYSICS_SELF_COLLISION_CHECK_H
#define FRAY_TESTS_PHYSICS_SELF_COLLISION_CHECK_H

#include "rt/base/vec.h"
#include "tests/lib/damage.h"
#include "tests/physics/exact_ccd.h"

enum { PARTICLES_MOST = 4096 };

static vec3 began[PARTICLES_MOST];

static inline void keep_begin(const fray_world *w) {
  for (uint32_t p = 0; p < w->p.count; ++p) began[p] = world_position(w, p);
}

/* What ways take up at the tick's begin and at its end. */
typedef struct {
  int32_t low[2][3], high[2][3];
} span;

static inline span span_of(const fray_world *w, const uint32_t *p, uint32_t count) {
  span s;
  for (uint32_t n = 0; n < 2; ++n)
    for (uint32_t m = 0; m < count; ++m) {
      const vec3 at = n != 0 ? world_position(w, p[m]) : began[p[m]];
      const int32_t x[3] = {at.x, at.y, at.z};
      for (uint32_t k = 0; k < 3; ++k) {
        s.low[n][k] = m == 0 ? x[k] : fx_min(s.low[n][k], x[k]);
        s.high[n][k] = m == 0 ? x[k] : fx_max(s.high[n][k], x[k]);
      }
    }
  return s;
}

/* One beyond the other along an axis, all the way. */
static inline int is_beyond(const span *a, const span *b) {
  for (uint32_t k = 0; k < 3; ++k)
    if (a->high[0][k] < b->low[0][k] && a->high[1][k] < b->low[1][k]) return 1;
  return 0;
}
static inline int are_apart(const span *a, const span *b) { return is_beyond(a, b) || is_beyond(b, a); }

/* On their ways; what touched when the tick began, as yarns of one crossing may that comes apart, has no side to
 * leave. */
static inline int touch(const fray_world *w, const uint32_t p[4], int triangle) {
  moving_point ways[4];
  moving_point still[4];
  for (uint32_t n = 0; n < 4; ++n) {
    const vec3 end = world_position(w, p[n]);
    const moving_point made = {{began[p[n]].x, began[p[n]].y, began[p[n]].z}, {end.x, end.y, end.z}};
    ways[n] = still[n] = made;
    memcpy(still[n].end, made.begin, sizeof made.begin);
  }
  return exact_ccd_touches(ways, triangle) && !exact_ccd_touches(still, triangle);
}

/* A touch of what bodies hold does not count where pools were short: bodies carry it through what moves as one. */
static inline uint32_t passes(const fray_world *w, const uint32_t p[4], int triangle) {
  for (uint32_t n = 0; n < 4 && (w->state->faults & (int32_t)FRAY_FAULT_SELF_COLLISION_BUDGET) != 0; ++n)
    if (p[n] < (uint32_t)w->params->attached) return 0;
  return (uint32_t)touch(w, p, triangle);
}

/* From where they began, each by up to `far` along each axis, with `gain` times the speed of that way. */
static inline void throw_particles(fray_world *w, int32_t far, int32_t gain, uint64_t *seed) {
  int32_t *const at[3] = {w->p.x, w->p.y, w->p.z};
  int32_t *const speed[3] = {w->p.vx, w->p.vy, w->p.vz};
  for (uint32_t p = 0; p < w->p.count; ++p)
    for (uint32_t k = 0; k < 3; ++k) {
      const int32_t way = (int32_t)(splitmix64(seed) % (2u * (uint32_t)far)) - far;
      at[k][p] += way;
      speed[k][p] = gain * way;
    }
}

static inline void open_case(fixture *f, const char *text, const char *limits, const char *more) {
  static char scene_text[4096];
  snprintf(scene_text, sizeof scene_text, text, limits, more);
  fixture_text(f, scene_text);
}

/* Saved every so many ticks and opened again: the same from there on. Closes the world. */
static inline void saved_on_the_way(fixture *f, uint32_t ticks, uint32_t every) {
  for (uint32_t tick = 0; tick < ticks; ++tick) {
    fixture other;
    fixture_tick(f, &fixture_idle);
    if (tick % every != every - 1) continue;
    fixture_copy(&other, f);
    for (uint32_t n = 0; n < 20; ++n)
      CHECK(fixture_tick(f, &fixture_idle).hash == fixture_tick(&other, &fixture_idle).hash);
    fixture_close(f);
    *f = other;
  }
  fixture_close(f);
}

#endif
