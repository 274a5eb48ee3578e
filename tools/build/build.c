/* SPDX-License-Identifier: Apache-2.0 */
/* The compiler's last stages: fill a world from the draft, find its substeps, save it. */
#include "tools/build/build.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rt/model/couples.h"
#include "rt/model/image.h"
#include "tools/build/draft.h"
#include "tools/build/settle.h"

void scene_refuse(scene_error *error, const char *file, int line, const char *message) {
  snprintf(error->file, sizeof error->file, "%s", file);
  error->line = line;
  error->column = 0;
  snprintf(error->message, sizeof error->message, "%s", message);
}

static void free_draft(draft *d) {
  free(d->place);
  free(d->holder);
  free(d->level);
  free(d->source);
  free(d->particle);
  free(d->crossing);
  free(d->rows);
  free(d->batches);
  free(d->meshes.points);
  free(d->meshes.edges);
  free(d->meshes.faces);
  free(d->meshes.boxes);
}

static int begin_draft(draft *d) {
  d->grid.warps = d->scene->sheet.warps;
  d->grid.wefts = d->scene->sheet.wefts;
  d->crossings = d->grid.warps * d->grid.wefts;
  const size_t rows = weave_rows(d->grid) + weave_shears(d->grid);
  d->place = calloc(d->crossings, sizeof *d->place);
  d->holder = calloc(d->crossings, sizeof *d->holder);
  d->level = calloc(d->crossings, sizeof *d->level);
  d->source = calloc(d->crossings, sizeof *d->source);
  d->particle = calloc(d->crossings, sizeof *d->particle);
  d->crossing = calloc(d->crossings, sizeof *d->crossing);
  d->rows = calloc(rows, sizeof *d->rows);
  d->batches = calloc(LIMIT_BATCHES, sizeof *d->batches);
  if (d->place == NULL || d->holder == NULL || d->level == NULL || d->source == NULL || d->particle == NULL ||
      d->crossing == NULL || d->rows == NULL || d->batches == NULL)
    return draft_refuse(d, 0, "out of memory");
  return 1;
}

static uint32_t all_rows(const draft *d) {
  return d->family_rows[0] + d->family_rows[1] + d->family_rows[2] + d->family_rows[DRAFT_SHADOWS];
}

static void plan_capacity(const draft *d, uint32_t capacity[POOLS]) {
  const scene *s = d->scene;
  capacity[POOL_PARAMS] = 1;
  capacity[POOL_STATE] = 1;
  capacity[POOL_PARTICLES] = d->crossings + s->limits.spare_particles;
  capacity[POOL_HELD] = d->held;
  capacity[POOL_CROSSINGS] = d->crossings;
  capacity[POOL_ROWS] = all_rows(d);
  capacity[POOL_BATCHES] = d->batch_count;
  capacity[POOL_LINK_CLASSES] = s->sheet.yarns != 0 ? CLASS_LINKS + 1 : CLASS_WARP + 1;
  capacity[POOL_SPRING_CLASSES] = s->sheet.yarns != 0 ? CLASS_SHEAR_HALF + 1 : CLASS_SHEAR + 1;
  capacity[POOL_BODIES] = d->bodies;
  capacity[POOL_KEYS] = s->key_count;
  capacity[POOL_CONTACTS] = s->limits.has_contacts ? s->limits.contacts : d->crossings;
  capacity[POOL_CUTS] = s->limits.cuts_per_tick;
  capacity[POOL_MESH_WORDS] = draft_mesh_words(d);
  capacity[POOL_BLADES] = 0;
  capacity[POOL_SPLITS] = s->sheet.yarns != 0 ? s->limits.splits_per_tick : 0;
  capacity[POOL_STRETCH] = scene_has_stretch(s) ? capacity[POOL_LINK_CLASSES] : 0;
  capacity[POOL_TRIANGLES] = capacity[POOL_LAYERS] = capacity[POOL_TILES] = capacity[POOL_BESIDE] = 0;
  capacity[POOL_PAIRS] = s->sheet.selves ? s->limits.self_pairs : 0;
}

static void fill_particles(const draft *d, fray_world *w) {
  for (uint32_t p = 0; p < d->crossings; ++p) {
    const vec3 at = d->place[d->crossing[p]];
    w->x[p] = at.x;
    w->y[p] = at.y;
    w->z[p] = at.z;
  }
  for (uint32_t c = 0; c < d->crossings; ++c)
    WRITABLE(row_id, w->crossing)[c] = (row_id)d->particle[c];
  for (uint32_t p = 0; p < d->held; ++p) {
    const uint8_t b = d->holder[d->crossing[p]];
    WRITABLE(uint8_t, w->grip_body)[p] = b;
    WRITABLE(int32_t, w->grip_x)[p] = w->x[p] - w->body_states[b].position[0];
    WRITABLE(int32_t, w->grip_y)[p] = w->y[p] - w->body_states[b].position[1];
    WRITABLE(int32_t, w->grip_z)[p] = w->z[p] - w->body_states[b].position[2];
  }
}

static void fill_rows(const draft *d, fray_world *w) {
  const uint32_t bends_from = d->family_rows[FRAY_STRUCTURAL];
  const uint32_t shears_from = bends_from + d->family_rows[FRAY_BEND];
  for (uint32_t row = 0; row < all_rows(d); ++row) {
    const draft_row *r = &d->rows[row];
    uint32_t a;
    uint32_t b;
    weave_ends(d->grid, r->canonical, &a, &b);
    w->row_i[row] = (row_id)r->i;
    w->row_j[row] = (row_id)r->j;
    /* where warps lie as close as wefts both have one class, and go side by side in wide kernels */
    const int along_warp = a / d->grid.warps != b / d->grid.warps;
    w->row_class[row] = row >= shears_from                                  ? CLASS_SHEAR
                        : along_warp && d->spacing[0] != d->spacing[1] ? CLASS_WARP
                                                                         : CLASS_WEFT;
    WRITABLE(row_id, w->home)[row] = (row_id)r->canonical;
    WRITABLE(row_id, w->row_of)[r->canonical] = (row_id)row;
  }
  for (uint32_t b = 0; b < d->batch_count; ++b)
    WRITABLE(row_batch, w->batches)[b] = d->batches[b];
}

static int fill_key(const draft *d, const scene_body *b, const scene_key *from, body_key *to) {
  int64_t tick;
  vec3 at;
  if (!exact_to_fixed(exact_mul(from->time, exact_make(d->scene->rate_hz, 1)), 0, &tick) ||
      tick < 0 || tick > INT32_MAX)
    return draft_refuse(d, b->line, "path: a time that the tick counter does not reach");
  if (!draft_place(d, b->line, from->at, &at)) return 0;
  to->tick = (int32_t)tick;
  to->position[0] = at.x;
  to->position[1] = at.y;
  to->position[2] = at.z;
  return 1;
}

int draft_fill_bodies(const draft *d, fray_world *w) {
  for (uint32_t n = 0; n < d->bodies; ++n) {
    WRITABLE(body, w->bodies)[n] = d->body[n];
    for (uint32_t a = 0; a < 3; ++a) w->body_states[n].position[a] = d->body[n].home[a];
  }
  for (uint32_t n = 0; n < d->scene->body_count; ++n) {
    const scene_body *b = &d->scene->bodies[n];
    body_key *keys = WRITABLE(body_key, w->keys);
    for (uint32_t k = b->key_first; k < b->key_first + b->keys; ++k) {
      if (!fill_key(d, b, &d->scene->keys[k], &keys[k])) return 0;
      if (k > b->key_first && keys[k].tick <= keys[k - 1].tick)
        return draft_refuse(d, b->line, "path: expected keys at least one tick apart");
    }
    const int64_t per_second = (int64_t)d->scene->rate_hz * d->substeps;
    for (uint32_t a = 0; a < 3 && b->motion == FRAY_FREE; ++a) {
      int64_t v;
      const exact lu = exact_mul(b->velocity[a], d->lu_per_cm);
      if (!exact_to_fixed(exact_div(lu, exact_make(per_second, 1)), FX_VELOCITY_BITS, &v) ||
          v > INT32_MAX / 2 || v < -(INT32_MAX / 2))
        return draft_refuse(d, b->line, "velocity: expected less than 4 lu per substep");
      w->body_states[n].velocity[a] = (int32_t)v;
    }
  }
  return 1;
}

/* Whole crossings, shadows not born; then, where all is yarn, couples of all that are free. */
static int fill_yarns(const draft *d, fray_world *w) {
  if (!world_has_yarns(w)) return 1;
  if (!draft_yarns(d, WRITABLE(yarn_params, w->yarns))) return 0;
  for (uint32_t c = 0; c < d->crossings; ++c) {
    w->warp_at[c] = w->crossing[c];
    w->place[w->crossing[c]] = (row_id)c;
  }
  for (uint32_t row = all_rows(d) - d->family_rows[DRAFT_SHADOWS]; row < all_rows(d); ++row)
    world_kill_row(w, row);
  for (uint32_t c = 0; c < d->crossings && w->yarns->all_yarn != 0; ++c)
    if (!couple_is_held(w, c) && !couple_split(w, c, FRAY_CONNECTED))
      return draft_refuse(d, d->scene->sheet.line,
                          "spare_particles: expected one for each free crossing of a sheet that is "
                          "all yarn");
  return 1;
}

static void begin_hash(fray_world *w) {
  const uint64_t now = world_hash(w);
  w->state->hash[0] = (int32_t)(uint32_t)(now & 0xFFFFFFFFu);
  w->state->hash[1] = (int32_t)(uint32_t)(now >> 32);
}

static int finish(const draft *d, fray_world *w) {
  w->state->mode = FRAY_READY;
  begin_hash(w);
  fray_error refused;
  if (image_validate(w, &refused) != FRAY_OK)
    return draft_refuse(d, 0, "the compiled world is not valid: section %u, element %u: %s",
                        refused.section, refused.index, refused.what);
  return 1;
}

static int fill(draft *d, void **memory, fray_world **world) {
  uint32_t capacity[POOLS];
  if (!begin_draft(d) || !draft_scale(d) || !draft_bodies(d) || !draft_crossings(d) ||
      !draft_order(d) || !draft_rows(d))
    return 0;
  plan_capacity(d, capacity);
  const size_t bytes = image_blank(capacity, NULL, NULL);
  *memory = aligned_alloc(64, (bytes + 63) / 64 * 64);
  if (*memory == NULL) return draft_refuse(d, 0, "out of memory");
  fray_world *w = NULL;
  image_blank(capacity, *memory, &w);
  *world = w;
  if (!draft_fill_bodies(d, w)) return 0;
  draft_mesh_fill(d, WRITABLE(int32_t, w->meshes));
  fill_particles(d, w);
  fill_rows(d, w);
  if (!draft_params(d, WRITABLE(params, w->params)) ||
      !draft_classes(d, WRITABLE(link_class, w->links), WRITABLE(spring_class, w->springs)))
    return 0;
  if (world_has_stretch(w) &&
      !draft_stretch(d, w->links, WRITABLE(stretch_params, w->stretch), WRITABLE(stretch_class, w->pulls),
                     WRITABLE(link_class, w->limits), capacity[POOL_STRETCH]))
    return 0;
  if (world_has_selves(w) && !draft_selves(d, WRITABLE(selves_params, w->selves))) return 0;
  w->particles = d->crossings;
  return draft_mesh_apart(d, w) && fill_yarns(d, w) && draft_slits(d, w);
}

int fill_world(const scene *s, const char *file, uint32_t substeps, uint32_t sweeps, void **memory,
               fray_world **world, scene_error *error) {
  draft *d = calloc(1, sizeof *d);
  if (d == NULL) return 0;
  d->scene = s;
  d->file = file;
  d->error = error;
  d->substeps = substeps;
  d->sweeps = sweeps;
  *memory = NULL;
  const int filled =
      (s->triangles.present ? draft_triangles(d, memory, world) : fill(d, memory, world)) &&
      finish(d, *world);
  if (!filled) {
    free(*memory);
    *memory = NULL;
  }
  free_draft(d);
  free(d);
  return filled;
}

static void free_rest(settle_rest *rest) {
  for (uint32_t n = 0; n < 3; ++n) free(rest->particles[n]);
}

/* The settled places become tick 0; paths and thrown bodies start where the scene says. */
static void start_at_rest(fray_world *w, const settle_rest *rest) {
  const uint32_t particles = w->particles;
  if (rest->particles[0] == NULL) return;
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    for (uint32_t n = 0; n < 3 && w->bodies[b].motion == FRAY_FREE; ++n)
      w->body_states[b].position[n] = rest->bodies[b][n];
  memcpy(w->x, rest->particles[0], particles * sizeof *w->x);
  memcpy(w->y, rest->particles[1], particles * sizeof *w->y);
  memcpy(w->z, rest->particles[2], particles * sizeof *w->z);
}

/* Along the axis on which it pulls most. */
static uint32_t fall_steps(const params *p) {
  const uint32_t x = fx_magnitude(p->gravity_x);
  const uint32_t y = fx_magnitude(p->gravity_y);
  const uint32_t z = fx_magnitude(p->gravity_z);
  return (x > y ? (x > z ? x : z) : (y > z ? y : z)) >> FX_SUB_BITS;
}

static int find_work(const scene *s, const char *file, build_report *report, settle_rest *rest,
                     build_progress *progress, void *context, scene_error *error) {
  settle_plan plan = {file, 0, 0, 0, progress, context};
  int64_t ticks;
  int64_t bound;
  int64_t tear_min;
  report->substeps = s->substeps == 0 && s->triangles.present ? TRIANGLE_SUBSTEPS : s->substeps;
  report->sweeps = s->sweeps;
  report->searched = !s->triangles.present && (s->substeps == 0 || s->sweeps == 0);
  if (!exact_to_fixed(exact_mul(s->settle, exact_make(s->rate_hz, 1)), 0, &ticks) || ticks < 0 ||
      ticks > 100000 || !exact_to_fixed(s->rest_strain, 16, &bound) || bound < 1 ||
      !exact_to_fixed(s->sheet.tear_min, 16, &tear_min)) {
    scene_refuse(error, file, 0, "settle: expected 0 to 100000 ticks, and a rest_strain above 0");
    return 0;
  }
  plan.rest_ticks = (uint32_t)ticks;
  plan.ticks = report->searched ? s->rate_hz / 2 : 0;
  plan.strain_max_q16 = (int32_t)(s->sheet.tearing && tear_min < bound ? tear_min : bound);
  if (!report->searched && ticks == 0) return 1;
  return settle_scene(s, &plan, report, rest, error);
}

int build_image(const scene *s, const char *file, uint8_t **image, size_t *image_bytes,
                build_report *report, build_progress *progress, void *context,
                scene_error *error) {
  void *memory = NULL;
  fray_world *w = NULL;
  settle_rest rest;
  memset(&rest, 0, sizeof rest);
  memset(report, 0, sizeof *report);
  *image = NULL;
  if (find_work(s, file, report, &rest, progress, context, error) &&
      fill_world(s, file, report->substeps, report->sweeps, &memory, &w, error)) {
    start_at_rest(w, &rest);
    begin_hash(w);
    report->stretch_steps = fray_describe(w).stretch_steps;
    report->fall_steps = fall_steps(w->params);
    *image_bytes = fray_save_bytes(w);
    *image = malloc(*image_bytes);
    if (*image == NULL)
      scene_refuse(error, file, 0, "out of memory");
    else
      (void)fray_save(w, *image, *image_bytes);
  }
  free_rest(&rest);
  free(memory);
  return *image != NULL;
}
