/* SPDX-License-Identifier: Apache-2.0 */
/* A world driven as by a hostile device: poses that jump over the whole range, commands at any time. Every
 * output is within its bounds, every view can be read, and a save opens and goes on with the same hashes. */
#ifndef FRAY_TESTS_LIB_HOSTILE_RUN_H
#define FRAY_TESTS_LIB_HOSTILE_RUN_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rt/fray.h"
#include "rt/state/world.h"
#include "tests/lib/splitmix64.h"

typedef struct {
  fray_world *w;
  void *memory;
  uint8_t *image; /* its own, or NULL */
} hostile_world;

__attribute__((noreturn)) static inline void hostile_fail(const char *what) {
  fprintf(stderr, "ERROR: hostile run: %s\n", what);
  abort();
}

static inline uint32_t hostile_draw(uint64_t *draws, uint32_t below) {
  return (uint32_t)((splitmix64(draws) >> 32) * below >> 32);
}

static inline fray_input hostile_input(uint64_t *draws, uint32_t tick) {
  static const int16_t ends[] = {-32768, -32767, 0, 1, 32767, 1000, -1000};
  fray_input input;
  memset(&input, 0, sizeof input);
  input.has_pose = hostile_draw(draws, 8) == 0 ? (uint8_t)hostile_draw(draws, 4) : 3;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    int16_t at[3];
    const uint32_t anywhere = hostile_draw(draws, 3) == 0;
    for (uint32_t n = 0; n < 3; ++n)
      at[n] = anywhere ? (int16_t)((int32_t)hostile_draw(draws, 65536) - 32768) : ends[hostile_draw(draws, 7)];
    const fray_pose pose = {at[0], at[1], at[2], (uint8_t)(tick & 15u), (uint8_t)hostile_draw(draws, 16)};
    input.pose[h] = pose;
  }
  if (tick == 0 || hostile_draw(draws, 30) == 0)
    input.command = FRAY_COMMAND_START;
  else if (hostile_draw(draws, 40) == 0)
    input.command = (uint8_t)hostile_draw(draws, 8);
  input.command_counter = (uint8_t)(tick & 15u);
  return input;
}

/* Opens an image in memory that is not zero. The world owns `image` iff it opens. */
static inline fray_status hostile_open(hostile_world *h, uint8_t *image, size_t bytes, fray_error *error) {
  size_t needed = 0;
  memset(h, 0, sizeof *h);
  fray_status status = fray_memory_size(image, bytes, &needed, error);
  if (status != FRAY_OK) return status;
  needed = (needed + FRAY_ALIGN - 1) / FRAY_ALIGN * FRAY_ALIGN;
  h->memory = aligned_alloc(FRAY_ALIGN, needed);
  if (h->memory == NULL) hostile_fail("no memory");
  memset(h->memory, 0xA5, needed);
  status = fray_open(image, bytes, h->memory, needed, &h->w, error);
  h->image = image;
  if (status == FRAY_OK) return FRAY_OK;
  free(h->memory);
  memset(h, 0, sizeof *h);
  return status;
}

static inline void hostile_close(hostile_world *h) {
  free(h->memory);
  free(h->image);
  memset(h, 0, sizeof *h);
}

/* What fray_save() writes of a world, opened. */
static inline void hostile_reopen(hostile_world *to, const fray_world *from) {
  const size_t bytes = fray_save_bytes(from);
  uint8_t *saved = malloc(bytes);
  fray_error error = {FRAY_OK, 0, 0, ""};
  if (saved == NULL || fray_save(from, saved, bytes) != bytes) hostile_fail("not saved");
  if (hostile_open(to, saved, bytes, &error) != FRAY_OK) {
    fprintf(stderr, "section %u, element %u: expected %s\n", error.section, error.index, error.what);
    hostile_fail("a save is refused");
  }
  if (fray_hash(to->w) != fray_hash(from)) hostile_fail("a save has another hash");
}

static inline void hostile_look(const fray_world *w) {
  const fray_info info = fray_get_info(w);
  const fray_weave weave = fray_view_weave(w);
  const fray_particles particles = fray_view_particles(w);
  fray_mesh mesh;
  fray_pool pool;
  volatile uint32_t sink = 0;
  (void)sink;
  for (uint32_t kind = 0; kind < 3; ++kind)
    for (uint32_t n = 0; n < info.springs[kind]; ++n) sink += fray_view_spring(w, (fray_spring_kind)kind, n).i;
  for (uint32_t n = 0; n < weave.warps * weave.wefts; ++n)
    sink += fray_crossing_particle(w, n) + (uint32_t)fray_crossing_state_at(w, n) + fray_yarn_particle(w, n, FRAY_WARP);
  for (uint32_t n = 0; n < info.triangles; ++n) sink += fray_view_triangle(w, n).vertex[0];
  for (uint32_t n = 0; n < info.bodies; ++n)
    sink += (uint32_t)fray_view_body(w, n).radius + (uint32_t)fray_view_mesh(w, n, &mesh);
  for (uint32_t n = 0; n < particles.attached; ++n) sink += fray_attached_body(w, n);
  for (uint32_t n = 0; fray_view_pool(w, n, &pool); ++n) sink += pool.count;
}

/* About as long as it takes: a pair that may meet is some tests of motion, each as long as 20 of what else counts. */
static inline uint64_t hostile_work(const fray_work *k) {
  enum { OF_A_PAIR = 20 };
  const uint32_t *counts = (const uint32_t *)(const void *)k;
  uint64_t sum = 0;
  for (size_t n = 0; n < sizeof *k / 4; ++n) sum += counts[n];
  return sum + (OF_A_PAIR - 1) * ((uint64_t)k->self_pairs + k->self_ccd);
}

static inline void hostile_check(const fray_world *w, const fray_output *out) {
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    for (uint32_t n = 0; n < 3; ++n)
      if (abs(out->force[h][n]) > w->params->force_clamp) hostile_fail("a force over its clamp");
  if (out->hash != fray_hash(w)) hostile_fail("the hash of the output");
}

static inline void hostile_compare(const fray_output *a, const fray_output *b) {
  if (a->hash != b->hash) hostile_fail("hashes differ");
  if (memcmp(a->force, b->force, sizeof a->force) != 0) hostile_fail("forces differ");
  if (a->faults != b->faults || a->tears_total != b->tears_total) hostile_fail("outputs differ");
}

/* What was saved of a world, by another kernel beside it. */
static inline void hostile_twin(hostile_world *twin, const fray_world *w, fray_kernel kernel) {
  hostile_world again;
  hostile_reopen(&again, twin->w != NULL ? twin->w : w);
  (void)fray_set_kernel(again.w, kernel);
  hostile_close(twin);
  *twin = again;
}

/* Returns the work that was counted. */
static inline uint64_t hostile_tick(fray_world *w, fray_world *twin, uint64_t *draws, uint32_t tick) {
  const fray_input input = hostile_input(draws, tick);
  fray_output out;
  fray_output other;
  fray_tick(w, &input, &out);
  hostile_check(w, &out);
  if (twin == NULL) return hostile_work(&out.work);
  fray_tick(twin, &input, &other);
  hostile_compare(&out, &other);
  return hostile_work(&out.work);
}

/* Runs a world for some ticks, or until so much work was counted; then it is saved, opened again, and both go on.
 * In lockstep what was saved, and is saved again now and then, runs beside it all the time. Returns the ticks. */
static inline uint32_t hostile_run(fray_world *w, uint32_t ticks, uint64_t work_max, int in_lockstep, fray_kernel kernel,
                                   uint64_t seed) {
  enum { BETWEEN_SAVES = 61, GOES_ON = 3 };
  hostile_world twin = {NULL, NULL, NULL};
  uint64_t draws = seed;
  uint64_t work = 0;
  uint32_t n = 0;
  hostile_look(w);
  for (; n < ticks && work <= work_max; ++n) {
    if (in_lockstep && n % BETWEEN_SAVES == 0) hostile_twin(&twin, w, kernel);
    work += hostile_tick(w, twin.w, &draws, n);
  }
  hostile_look(w);
  hostile_twin(&twin, w, kernel);
  for (uint32_t end = n + (work > work_max ? 1 : GOES_ON); n < end; ++n) (void)hostile_tick(w, twin.w, &draws, n);
  hostile_twin(&twin, w, kernel);
  hostile_close(&twin);
  return n;
}

#endif
