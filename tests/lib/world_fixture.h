/* SPDX-License-Identifier: Apache-2.0 */
/* Worlds for tests: a scene's text (or file, with words of it replaced) compiled and opened, ticks
 * with and without hands, and what tests measure on a world in double precision.
 *
 *   fixture_scoped f = {0};
 *   fixture_file(&f, "tests/scenes/small.scene", "substeps 8", "substeps 4", NULL);
 *   fray_output out = fixture_tick(&f, &fixture_idle);
 *
 * What cannot be built ends the program: a test of physics has nothing to say then. */
#ifndef FRAY_TESTS_LIB_WORLD_FIXTURE_H
#define FRAY_TESTS_LIB_WORLD_FIXTURE_H

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rt/fray.h"
#include "rt/image/image.h"
#include "rt/state/world.h"
#include "tests/lib/splitmix64.h"
#include "tests/lib/test.h"
#include "tools/scene_compiler/compile.h"

/* Not every test uses every helper. */
#define FIXTURE static inline __attribute__((unused))

typedef struct {
  uint8_t *image; /* outlives the world */
  size_t image_bytes;
  void *memory;
  size_t memory_bytes;
  fray_world *w;
  fray_info facts; /* when it was opened */
  compile_report report;
} fixture;

static const fray_input fixture_idle;

/* One line a figure, so that it can be collected. */
FIXTURE void figure(const char *name, double value, const char *unit, const char *asked) {
  printf("figure %s %.6g %s (asked: %s)\n", name, value, unit, asked);
}

__attribute__((noreturn)) FIXTURE void fixture_give_up(const char *where, const char *what) {
  printf("%s: %s\n0 passed, 1 failed\n", where, what);
  exit(1);
}

/* Opens f->image, which is malloc'ed and filled. */
FIXTURE void fixture_open_image(fixture *f) {
  fray_error error;
  memset(&error, 0, sizeof error);
  if (fray_memory_size(f->image, f->image_bytes, &f->memory_bytes, &error) != FRAY_OK)
    fixture_give_up("fray_memory_size", error.what);
  f->memory_bytes = (f->memory_bytes + 63) / 64 * 64;
  f->memory = aligned_alloc(64, f->memory_bytes);
  if (f->memory == NULL) fixture_give_up("fixture", "out of memory");
  if (fray_open(f->image, f->image_bytes, f->memory, f->memory_bytes, &f->w, &error) != FRAY_OK)
    fixture_give_up("fray_open", error.what);
  f->facts = fray_get_info(f->w);
}

/* The text of a scene as if it stood in `file`: where the meshes are that it names. */
FIXTURE int fixture_compile(fixture *f, const char *file, const char *text, scene_error *error) {
  scene *s = malloc(sizeof *s);
  memset(f, 0, sizeof *f);
  memset(error, 0, sizeof *error);
  if (s == NULL) fixture_give_up("fixture", "out of memory");
  const int good = scene_parse(file, text, strlen(text), s, error) &&
                   compile_image(s, file, &f->image, &f->image_bytes, &f->report, NULL, NULL, error);
  free(s);
  return good;
}
FIXTURE void fixture_text_of(fixture *f, const char *file, const char *text) {
  scene_error error;
  if (!fixture_compile(f, file, text, &error)) {
    printf("%s\n", text);
    fixture_give_up("scene", error.message);
  }
  fixture_open_image(f);
}
FIXTURE void fixture_text(fixture *f, const char *text) { fixture_text_of(f, "test", text); }

/* A scene's text from printf arguments. */
__attribute__((format(printf, 2, 3))) FIXTURE void fixture_print(fixture *f, const char *format,
                                                                 ...) {
  static char text[16384];
  va_list list;
  va_start(list, format);
  vsnprintf(text, sizeof text, format, list);
  va_end(list);
  fixture_text(f, text);
}

FIXTURE char *fixture_read(const char *path) {
  FILE *file = fopen(path, "rb");
  char *text = calloc(1, 65536);
  if (file == NULL || text == NULL) fixture_give_up(path, "cannot be read");
  const size_t bytes = fread(text, 1, 65535, file);
  fclose(file);
  text[bytes] = 0;
  return text;
}

/* Replaces the first place of `from`; frees the old text. *found is 0 if it is not there. */
FIXTURE char *fixture_replace(char *text, const char *from, const char *to, int *found) {
  char *place = strstr(text, from);
  *found = place != NULL;
  if (place == NULL) return text;
  const size_t bytes = strlen(text) + strlen(to) + 1;
  char *result = malloc(bytes);
  if (result == NULL) fixture_give_up("fixture", "out of memory");
  *place = 0;
  snprintf(result, bytes, "%s%s%s", text, to, place + strlen(from));
  free(text);
  return result;
}

/* A scene file with edits: pairs (from, to), ended by NULL. Every `from` must be there. */
FIXTURE void fixture_file(fixture *f, const char *path, ...) {
  char *text = fixture_read(path);
  va_list list;
  va_start(list, path);
  for (const char *from = va_arg(list, const char *); from != NULL;
       from = va_arg(list, const char *)) {
    int found;
    text = fixture_replace(text, from, va_arg(list, const char *), &found);
    if (!found) fixture_give_up(path, from);
  }
  va_end(list);
  fixture_text_of(f, path, text);
  free(text);
}

FIXTURE void fixture_close(fixture *f) {
  free(f->memory);
  free(f->image);
  memset(f, 0, sizeof *f);
}

/* One that is closed where its block ends. */
#define fixture_scoped CLOSED_BY(fixture_close) fixture

/* A second world from a save of the first. */
FIXTURE void fixture_copy(fixture *to, const fixture *from) {
  memset(to, 0, sizeof *to);
  to->image_bytes = fray_save_bytes(from->w);
  to->image = malloc(to->image_bytes);
  if (to->image == NULL || fray_save(from->w, to->image, to->image_bytes) != to->image_bytes)
    fixture_give_up("fray_save", "did not save");
  fixture_open_image(to);
}

/* Every kind of counted work is at most what the image says. */
FIXTURE int fixture_within_bound(const fray_work *k, const fray_work *most) {
  return k->particle_steps <= most->particle_steps && k->projections <= most->projections &&
         k->springs <= most->springs && k->contacts <= most->contacts &&
         k->broad_phase_tests <= most->broad_phase_tests && k->tear_tests <= most->tear_tests &&
         k->over_threshold <= most->over_threshold && k->tears <= most->tears && k->slips <= most->slips &&
         k->yarn_forces <= most->yarn_forces &&
         k->transitions <= most->transitions && k->splits <= most->splits &&
         k->tear_candidates <= most->tear_candidates && k->eigenvalues <= most->eigenvalues && k->element_forces <= most->element_forces && k->bend_forces <= most->bend_forces &&
         k->self_box_tests <= most->self_box_tests && k->self_pairs <= most->self_pairs &&
         k->self_ccd <= most->self_ccd && k->self_merged <= most->self_merged &&
         k->mesh_tests <= most->mesh_tests && k->mesh_boxes <= most->mesh_boxes &&
         k->mesh_ccd <= most->mesh_ccd && k->mesh_pins <= most->mesh_pins && k->blade_cuts <= most->blade_cuts &&
         k->contact_constraints <= most->contact_constraints;
}

FIXTURE fray_output fixture_tick(fixture *f, const fray_input *input) {
  fray_output out;
  fray_tick(f->w, input, &out);
  return out;
}

/* The sheet of tests/scenes/hanging.scene, with its own choice of the rest: held along its top. */
FIXTURE void fixture_hanging(fixture *f, uint32_t warps, uint32_t wefts, uint32_t substeps,
                             const char *settle, const char *gather, const char *drag) {
  fixture_print(f,
                "scene hanging\nrate 1000 Hz\nsubsteps %u\niterations 1\nsettle %s\n"
                "gravity 0 -981 0 cm/s2\nseed 1\nwoven {\n warps %u\n wefts %u\n spacing 12 /cm\n"
                " density 0.25 g/cm2\n thickness 0.01 cm\n structural 6000 g/s2\n bend 5 g/s2\n"
                " shear 2 g/s2\n tear off\n gather %s pleats 8\n drag %s\n}\npin row top\n",
                substeps, settle, warps, wefts, gather, drag);
}

/* What the builder owns and tests bend: the world's constants lie in f->image, which is ours. */
FIXTURE params *fixture_params(fixture *f) { return (params *)(uintptr_t)f->w->params; }

/* The topology's hash that is kept by the way is that of the whole. */
FIXTURE int fixture_topology_holds(const fray_world *w) {
  return world_topology(w) == ((uint64_t)(uint32_t)w->state->topology[1] << 32 | (uint32_t)w->state->topology[0]);
}

/* ---- hands ---- */

/* A pose for every hand of the world: x[h], y, z in device steps of 2 um, counters by tick. */
FIXTURE fray_input fixture_poses(const fixture *f, const int32_t at[FRAY_HANDS][3],
                                 uint32_t tick) {
  fray_input input = fixture_idle;
  input.has_pose = (uint8_t)f->facts.hands;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    input.pose[h].x = (int16_t)at[h][0];
    input.pose[h].y = (int16_t)at[h][1];
    input.pose[h].z = (int16_t)at[h][2];
    input.pose[h].counter = (uint8_t)(tick & 15u);
  }
  return input;
}

/* START, then poses at the origin until the hands are armed and the ramp is up: `ticks` ticks. */
FIXTURE fray_output fixture_start_hands(fixture *f, uint32_t ticks) {
  static const int32_t origin[FRAY_HANDS][3];
  fray_output out;
  memset(&out, 0, sizeof out);
  for (uint32_t tick = 0; tick < ticks; ++tick) {
    fray_input input = fixture_poses(f, origin, tick);
    if (tick == 0) input.command = FRAY_COMMAND_START;
    out = fixture_tick(f, &input);
  }
  return out;
}

/* ---- measures, in double ---- */

FIXTURE double fixture_lu_cm(const fixture *f) { return f->facts.lu_um * 1e-4; }
/* Q28 lu per substep to cm/s. */
FIXTURE double fixture_speed(const fixture *f) {
  return fixture_lu_cm(f) * 0x1p-28 * f->facts.rate_hz * f->facts.substeps;
}
FIXTURE double fixture_mass_g(const fixture *f) { return f->facts.particle_mass_ng * 1e-9; }

FIXTURE double fixture_length(const fray_world *w, uint32_t row) {
  const uint32_t i = w->woven.spring_i[row];
  const uint32_t j = w->woven.spring_j[row];
  const double x = (double)w->p.x[j] - w->p.x[i];
  const double y = (double)w->p.y[j] - w->p.y[i];
  const double z = (double)w->p.z[j] - w->p.z[i];
  return sqrt(x * x + y * y + z * z);
}

/* Rest length of a structural row, also of a dead one. */
FIXTURE double fixture_rest(const fray_world *w, uint32_t row) {
  uint32_t a;
  uint32_t b;
  yarn_grid_ends(world_yarn_grid(w), w->woven.canonical_id[row], &a, &b);
  return w->woven.link_classes[b == a + 1 ? 1 : 2].rest;
}
FIXTURE double fixture_strain(const fray_world *w, uint32_t row) {
  return fixture_length(w, row) / fixture_rest(w, row) - 1;
}

/* Rows between two held particles are nobody's. */
FIXTURE int fixture_spring_moves(const fray_world *w, uint32_t row) {
  return w->woven.spring_j[row] >= (uint32_t)w->params->attached || w->woven.spring_i[row] >= (uint32_t)w->params->attached;
}

/* The live structural row with the largest strain. */
FIXTURE double fixture_largest_strain(const fray_world *w, uint32_t *at) {
  double most = -1;
  for (uint32_t row = 0; row < (uint32_t)w->params->links; ++row) {
    if (w->woven.spring_kind[row] == SPRING_DEAD || !fixture_spring_moves(w, row)) continue;
    const double strain = fixture_strain(w, row);
    if (strain <= most) continue;
    most = strain;
    if (at != NULL) *at = row;
  }
  return most;
}

/* Kinetic and potential energy of the free particles, in erg (g cm2/s2); the explicit springs of
 * bend and shear are counted, the structural ones have none. */
FIXTURE double fixture_energy(const fixture *f, double bend, double shear) {
  const fray_world *w = f->w;
  const params *p = w->params;
  const double speed = fixture_speed(f);
  const double cm = fixture_lu_cm(f) * 0x1p-24;
  const double per_second = (double)p->rate_hz * p->substeps;
  const double mass = fixture_mass_g(f);
  const double unit = 0x1p-60 * fixture_lu_cm(f) * per_second * per_second;
  const double g[3] = {((double)p->gravity_x * 0x1p32 + (uint32_t)p->gravity_rest_x) * unit,
                       ((double)p->gravity_y * 0x1p32 + (uint32_t)p->gravity_rest_y) * unit,
                       ((double)p->gravity_z * 0x1p32 + (uint32_t)p->gravity_rest_z) * unit};
  double total = 0;
  for (uint32_t n = (uint32_t)p->attached; n < (uint32_t)p->particles; ++n) {
    const double v2 = (double)w->p.vx[n] * w->p.vx[n] + (double)w->p.vy[n] * w->p.vy[n] +
                      (double)w->p.vz[n] * w->p.vz[n];
    total += mass * (0.5 * v2 * speed * speed -
                     (g[0] * w->p.x[n] + g[1] * w->p.y[n] + g[2] * w->p.z[n]) * cm);
  }
  for (uint32_t row = (uint32_t)p->links; row < w->capacity[POOL_SPRINGS]; ++row) {
    if (w->woven.spring_kind[row] == SPRING_DEAD) continue;
    const bend_shear_class *c = &w->woven.bend_shear_classes[w->woven.spring_kind[row] & SPRING_CLASS];
    const double away = (fixture_length(w, row) - c->rest) * cm;
    if (c->compression_only != 0 && away > 0) continue;
    total += 0.5 * (c->compression_only != 0 ? shear : bend) * away * away;
  }
  return total;
}

#endif
