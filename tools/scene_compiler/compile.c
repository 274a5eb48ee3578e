/* SPDX-License-Identifier: Apache-2.0 */
/* The compiler's last stages: fill a world from the draft, find its substeps, save it. */
#include "tools/scene_compiler/compile.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rt/state/crossing.h"
#include "rt/woven/yarn_slip.h"
#include "rt/image/image.h"
#include "rt/image/state_hash.h"
#include "tools/scene_compiler/draft.h"
#include "tools/scene_compiler/settle.h"

static void free_draft(draft *d) {
  free(d->place);
  free(d->holder);
  free(d->level);
  free(d->source);
  free(d->particle);
  free(d->crossing);
  free(d->springs);
  free(d->batches);
  free(d->meshes.points);
  free(d->meshes.edges);
  free(d->meshes.faces);
  free(d->meshes.boxes);
}

static int begin_draft(draft *d) {
  d->grid.warps = d->scene->woven.warps;
  d->grid.wefts = d->scene->woven.wefts;
  d->crossings = d->grid.warps * d->grid.wefts;
  const size_t springs = yarn_grid_springs(d->grid) + yarn_grid_shears(d->grid);
  d->place = calloc(d->crossings, sizeof *d->place);
  d->holder = calloc(d->crossings, sizeof *d->holder);
  d->level = calloc(d->crossings, sizeof *d->level);
  d->source = calloc(d->crossings, sizeof *d->source);
  d->particle = calloc(d->crossings, sizeof *d->particle);
  d->crossing = calloc(d->crossings, sizeof *d->crossing);
  d->springs = calloc(springs, sizeof *d->springs);
  d->batches = calloc(MAX_BATCHES, sizeof *d->batches);
  if (d->place == NULL || d->holder == NULL || d->level == NULL || d->source == NULL || d->particle == NULL ||
      d->crossing == NULL || d->springs == NULL || d->batches == NULL)
    return draft_no_memory(d);
  return 1;
}

static uint32_t all_springs(const draft *d) {
  return d->springs_of_kind[0] + d->springs_of_kind[1] + d->springs_of_kind[2] +
         d->springs_of_kind[DRAFT_SHADOWS];
}

static void plan_capacity(const draft *d, uint32_t capacity[POOLS]) {
  const scene *s = d->scene;
  capacity[POOL_PARAMS] = 1;
  capacity[POOL_STATE] = 1;
  capacity[POOL_PARTICLES] = d->crossings + s->limits.spare_particles;
  capacity[POOL_ATTACHED] = d->attached;
  capacity[POOL_CROSSINGS] = d->crossings;
  capacity[POOL_SPRINGS] = all_springs(d);
  capacity[POOL_BATCHES] = d->batch_count;
  capacity[POOL_LINK_CLASSES] = s->woven.shear_lock.numerator != 0 ? CLASSES_WITH_LOCK : CLASS_WARP + 1;
  capacity[POOL_BEND_SHEAR_CLASSES] = s->woven.yarns != 0 ? CLASS_SHEAR_HALF + 1 : CLASS_SHEAR + 1;
  capacity[POOL_BODIES] = d->bodies;
  capacity[POOL_KEYS] = s->key_count;
  capacity[POOL_CONTACTS] = s->limits.contacts;
  capacity[POOL_BREAKS] = s->limits.tears_per_tick;
  capacity[POOL_RIGID_MESH_WORDS] = draft_rigid_mesh_words(d);
  capacity[POOL_BLADES] = 0;
  capacity[POOL_SPLITS] = s->woven.yarns != 0 ? s->limits.splits_per_tick : 0;
  capacity[POOL_YARN_GAINS] = scene_has_stretch(s) ? capacity[POOL_LINK_CLASSES] : 0;
  capacity[POOL_HANDLES] = capacity[POOL_TRIANGLES] = capacity[POOL_TRIANGLE_PAIRS] = capacity[POOL_PATCHES] =
      capacity[POOL_PATCH_PAIRS] = capacity[POOL_COROTATIONAL] = capacity[POOL_CRACKS] = 0;
  capacity[POOL_YARN_PAIRS] = s->woven.self_collision ? s->limits.self_collision_pairs : 0;
}

void draft_fill_particles(const draft *d, fray_world *w) {
  for (uint32_t p = 0; p < d->crossings; ++p) {
    const vec3 at = d->place[d->crossing[p]];
    w->p.x[p] = at.x;
    w->p.y[p] = at.y;
    w->p.z[p] = at.z;
  }
  for (uint32_t p = 0; p < d->attached; ++p) {
    const uint8_t b = d->holder[d->crossing[p]];
    WRITABLE(uint8_t, w->p.attach_body)[p] = b;
    WRITABLE(int32_t, w->p.attach_x)[p] = w->p.x[p] - w->rigid.states[b].position[0];
    WRITABLE(int32_t, w->p.attach_y)[p] = w->p.y[p] - w->rigid.states[b].position[1];
    WRITABLE(int32_t, w->p.attach_z)[p] = w->p.z[p] - w->rigid.states[b].position[2];
  }
}

static void fill_springs(const draft *d, fray_world *w) {
  for (uint32_t c = 0; c < d->crossings; ++c)
    WRITABLE(index_t, w->woven.crossing_particle)[c] = (index_t)d->particle[c];
  const uint32_t bends_from = d->springs_of_kind[FRAY_STRUCTURAL];
  const uint32_t shears_from = bends_from + d->springs_of_kind[FRAY_BEND];
  for (uint32_t spring = 0; spring < all_springs(d); ++spring) {
    const draft_spring *r = &d->springs[spring];
    uint32_t a;
    uint32_t b;
    yarn_grid_ends(d->grid, r->canonical, &a, &b);
    w->woven.spring_i[spring] = (index_t)r->i;
    w->woven.spring_j[spring] = (index_t)r->j;
    /* with equal spacings warps and wefts share a class, so that SIMD kernels take both at once */
    const int along_warp = a / d->grid.warps != b / d->grid.warps;
    w->woven.spring_kind[spring] = spring >= shears_from                                  ? CLASS_SHEAR
                        : along_warp && d->spacing[0] != d->spacing[1] ? CLASS_WARP
                                                                         : CLASS_WEFT;
    WRITABLE(index_t, w->woven.canonical_id)[spring] = (index_t)r->canonical;
    WRITABLE(index_t, w->woven.spring_of)[r->canonical] = (index_t)spring;
  }
  for (uint32_t b = 0; b < d->batch_count; ++b)
    WRITABLE(spring_batch, w->woven.batches)[b] = d->batches[b];
}

static int fill_keyframe(const draft *d, uint32_t n, const scene_keyframe *from, keyframe *to) {
  int64_t tick;
  vec3 at;
  if (!exact_to_fixed(exact_mul(from->time, exact_make(d->scene->rate_hz, 1)), 0, &tick) ||
      tick < 0 || tick > INT32_MAX)
    return draft_refuse(d, from->place, "found a time of too many digits in a path, expected fewer");
  if (!draft_keyframe(d, BLOCK_BODY + n, from, &at)) return 0;
  to->tick = (int32_t)tick;
  to->position[0] = at.x;
  to->position[1] = at.y;
  to->position[2] = at.z;
  return 1;
}

int draft_fill_bodies(const draft *d, fray_world *w) {
  for (uint32_t n = 0; n < d->bodies; ++n) {
    WRITABLE(rigid_body, w->rigid.bodies)[n] = d->body[n];
    for (uint32_t a = 0; a < 3; ++a) w->rigid.states[n].position[a] = d->body[n].start[a];
  }
  for (uint32_t n = 0; n < d->scene->body_count; ++n) {
    const scene_body *b = &d->scene->bodies[n];
    keyframe *keys = WRITABLE(keyframe, w->rigid.keyframes);
    for (uint32_t k = b->key_first; k < b->key_first + b->keys; ++k) {
      if (!fill_keyframe(d, n, &d->scene->keys[k], &keys[k])) return 0;
      if (k > b->key_first && keys[k].tick <= keys[k - 1].tick)
        return draft_refuse(d, d->scene->keys[k].place,
                            "found a keyframe in the tick of the one before, expected them at least a tick "
                            "of 1/%u s "
                            "apart",
                            d->scene->rate_hz);
    }
    const int64_t per_second = (int64_t)d->scene->rate_hz * d->substeps;
    for (uint32_t a = 0; a < 3 && b->motion == FRAY_FREE; ++a) {
      int64_t v;
      char most[SOURCE_VALUE];
      const exact lu = exact_mul(b->velocity[a], d->lu_per_cm);
      if (!exact_to_fixed(exact_div(lu, exact_make(per_second, 1)), FX_VELOCITY_BITS, &v) ||
          v > INT32_MAX / 2 || v < -(INT32_MAX / 2))
        return draft_expected(d, BLOCK_BODY + n, "velocity",
                              "less than %s: it goes less than 4 lu of %u um in one of "
                              "%u substeps at %u Hz",
                              draft_value(d, BLOCK_BODY + n, "velocity", UNIT_SPEED,
                                          exact_div(exact_make(4 * per_second, 1), d->lu_per_cm), -1, most),
                              d->lu_um, d->substeps, d->scene->rate_hz);
      w->rigid.states[n].velocity[a] = (int32_t)v;
    }
  }
  return 1;
}

/* Whole crossings, with the springs of split ones dead; with `yarns all` every free one is then split. */
static int fill_yarns(const draft *d, fray_world *w) {
  if (!world_has_yarns(w)) return 1;
  if (!draft_yarns(d, WRITABLE(yarn_params, w->woven.yarn_constants))) return 0;
  for (uint32_t c = 0; c < d->crossings; ++c) {
    w->woven.warp_particle[c] = w->woven.crossing_particle[c];
    w->woven.crossing_of[w->woven.crossing_particle[c]] = (index_t)c;
  }
  for (uint32_t spring = all_springs(d) - d->springs_of_kind[DRAFT_SHADOWS]; spring < all_springs(d);
       ++spring)
    world_kill_spring(w, spring);
  for (uint32_t c = 0; c < d->crossings && w->woven.yarn_constants->all_yarn != 0; ++c)
    if (!crossing_is_attached(w, c) && !crossing_split(w, c, FRAY_CONNECTED))
      return draft_expected(d, BLOCK_LIMITS, "spare_particles",
                            "%u: one for each free crossing with 'yarns all'", d->crossings - d->attached);
  return 1;
}

static void begin_hash(fray_world *w) {
  const uint64_t now = state_hash(w);
  w->state->hash[0] = (int32_t)(uint32_t)(now & 0xFFFFFFFFu);
  w->state->hash[1] = (int32_t)(uint32_t)(now >> 32);
}

static int finish(const draft *d, fray_world *w) {
  w->state->mode = FRAY_READY;
  begin_hash(w);
  fray_error refused;
  if (image_validate(w, &refused) != FRAY_OK)
    return draft_refuse(d, d->scene->source.block[BLOCK_CLOTH],
                        "the world that is made of this is not valid: section %u, element %u: %s",
                        refused.section, refused.index, refused.what);
  return 1;
}

static int fill(draft *d, void **memory, fray_world **world) {
  uint32_t capacity[POOLS];
  if (!begin_draft(d) || !draft_scale(d) || !draft_place_bodies(d) || !draft_place_crossings(d) ||
      !draft_order_particles(d) || !draft_make_springs(d))
    return 0;
  plan_capacity(d, capacity);
  const size_t bytes = image_blank(capacity, NULL, NULL);
  *memory = aligned_alloc(64, (bytes + 63) / 64 * 64);
  if (*memory == NULL) return draft_no_memory(d);
  fray_world *w = NULL;
  image_blank(capacity, *memory, &w);
  *world = w;
  if (!draft_fill_bodies(d, w)) return 0;
  draft_rigid_mesh_fill(d, WRITABLE(int32_t, w->rigid.mesh_words));
  draft_fill_particles(d, w);
  fill_springs(d, w);
  if (!draft_params(d, WRITABLE(params, w->params)) ||
      !draft_classes(d, WRITABLE(link_class, w->woven.link_classes),
                     WRITABLE(bend_shear_class, w->woven.bend_shear_classes)))
    return 0;
  if (world_has_elastic_yarns(w) &&
      !draft_yarn_elastic(d, w->woven.link_classes, WRITABLE(yarn_elastic_params, w->woven.elastic_params),
                          WRITABLE(yarn_gain, w->woven.yarn_gains), capacity[POOL_YARN_GAINS]))
    return 0;
  if (world_has_yarn_collision(w) && !draft_yarn_collision(d, WRITABLE(self_params, w->self.constants)))
    return 0;
  w->p.count = d->crossings;
  return draft_body_clearance(d, w) && draft_mesh_clearance(d, w) && fill_yarns(d, w) && draft_slits(d, w);
}

int compile_world(const scene *s, const char *file, uint32_t substeps, uint32_t iterations, void **memory,
               fray_world **world, scene_error *error) {
  draft *d = calloc(1, sizeof *d);
  if (d == NULL) return 0;
  d->scene = s;
  d->file = file;
  d->error = error;
  d->substeps = substeps;
  d->iterations = iterations;
  *memory = NULL;
  const int filled =
      (s->membrane.present ? draft_membrane(d, memory, world) : fill(d, memory, world)) &&
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
  free(rest->bends);
  for (uint32_t n = 0; n < 3; ++n) free(rest->particles[n]);
}

/* Tick 0 is where the settled scene is; paths and thrown bodies start where the scene says. */
static void start_at_rest(fray_world *w, const settle_rest *rest) {
  const uint32_t particles = w->p.count;
  if (rest->particles[0] == NULL) return;
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    for (uint32_t n = 0; n < 3 && w->rigid.bodies[b].motion == FRAY_FREE; ++n)
      w->rigid.states[b].position[n] = rest->bodies[b][n];
  memcpy(w->p.x, rest->particles[0], particles * sizeof *w->p.x);
  memcpy(w->p.y, rest->particles[1], particles * sizeof *w->p.y);
  memcpy(w->p.z, rest->particles[2], particles * sizeof *w->p.z);
  if (rest->bends != NULL)
    memcpy(w->membrane.bend_states, rest->bends, triangles_in_use(w) * sizeof *rest->bends);
}

static void begin_contacts(fray_world *w) {
  if (!world_has_yarns(w)) return;
  for (uint32_t n = 0; n < (uint32_t)w->woven.yarn_counts->split; ++n) yarn_slip_begin(w, n);
}

/* Along the axis of the largest component of gravity. */
static uint32_t fall_steps(const params *p) {
  const uint32_t x = fx_magnitude(p->gravity_x);
  const uint32_t y = fx_magnitude(p->gravity_y);
  const uint32_t z = fx_magnitude(p->gravity_z);
  return (x > y ? (x > z ? x : z) : (y > z ? y : z)) >> FX_SUB_BITS;
}

enum { SETTLE_TICKS_MAX = 100000 };

/* A share of the strain at which something splits or tears: what is left is for motion. */
static exact rest_strain_of(exact least) { return exact_mul(least, exact_make(4, 5)); }

/* The lowest of what cloth may be strained by at rest. max_rest_strain is for `auto` alone. */
static exact rest_strain_max(const scene *s, int searched, rest_limit *limit) {
  exact most = searched || !s->woven.tearing ? s->max_rest_strain : rest_strain_of(s->woven.tear_min);
  *limit = searched || !s->woven.tearing ? REST_BY_MAX : REST_BY_TEAR;
  if (s->woven.tearing && exact_compare(rest_strain_of(s->woven.tear_min), most) < 0) {
    most = rest_strain_of(s->woven.tear_min);
    *limit = REST_BY_TEAR;
  }
  if (s->woven.tearing && s->woven.yarns == 1 &&
      exact_compare(rest_strain_of(s->woven.split_strain_min), most) < 0) {
    most = rest_strain_of(s->woven.split_strain_min);
    *limit = REST_BY_SPLIT;
  }
  return most;
}

static int find_work(const scene *s, const char *file, compile_report *report, settle_rest *rest,
                     compile_progress *progress, void *context, scene_error *error) {
  int64_t ticks;
  int64_t bound;
  report->substeps = s->substeps == 0 && s->membrane.present ? MEMBRANE_SUBSTEPS : s->substeps;
  report->iterations = s->iterations;
  report->default_bend = s->woven.present && !s->woven.has_bend ? s->woven.bend : exact_make(0, 1);
  report->default_shear = s->woven.present && !s->woven.has_shear ? s->woven.shear : exact_make(0, 1);
  report->searched = !s->membrane.present && (s->substeps == 0 || s->iterations == 0);
  const exact strain = rest_strain_max(s, report->searched, &report->limit);
  settle_request plan = {file, 0, 0, 0, strain, progress, context};
  if (!exact_to_fixed(exact_mul(s->settle, exact_make(s->rate_hz, 1)), 0, &ticks) || ticks < 0 ||
      ticks > SETTLE_TICKS_MAX || !exact_to_fixed(strain, 16, &bound) || bound < 1) {
    char message[160];
    char found[SOURCE_SAID + 24];
    char most[SOURCE_VALUE];
    snprintf(message, sizeof message, "found %s, expected at most %s: %d ticks at %u Hz",
             source_found(&s->source, BLOCK_SCENE, "settle", found),
             source_value(&s->source, BLOCK_SCENE, "settle", UNIT_TIME,
                          exact_make(SETTLE_TICKS_MAX, s->rate_hz), -1, most),
             SETTLE_TICKS_MAX, s->rate_hz);
    scene_refuse(error, file, source_place(&s->source, BLOCK_SCENE, "settle"), message);
    return 0;
  }
  plan.rest_ticks = (uint32_t)ticks;
  plan.ticks = report->searched ? s->rate_hz / 2 : 0;
  plan.strain_max_q16 = (int32_t)bound;
  report->strain_max_q16 = s->membrane.present ? 0 : (int32_t)bound;
  if (!report->searched && ticks == 0) return 1;
  return settle_scene(s, &plan, report, rest, error);
}

int compile_rest_strain(const scene *s, const char *file, compile_report *report, compile_progress *progress,
                        void *context, scene_error *error) {
  int64_t ticks = 0;
  settle_rest rest;
  memset(&rest, 0, sizeof rest);
  (void)exact_to_fixed(exact_mul(s->settle, exact_make(s->rate_hz, 1)), 0, &ticks);
  const settle_request plan = {file, (uint32_t)ticks, s->rate_hz / 2, INT32_MAX, exact_make(1, 1), progress,
                              context};
  const int good = settle_scene(s, &plan, report, &rest, error);
  free_rest(&rest);
  return good;
}

int compile_image(const scene *s, const char *file, uint8_t **image, size_t *image_bytes,
                compile_report *report, compile_progress *progress, void *context,
                scene_error *error) {
  void *memory = NULL;
  fray_world *w = NULL;
  settle_rest rest;
  memset(&rest, 0, sizeof rest);
  memset(report, 0, sizeof *report);
  *image = NULL;
  if (find_work(s, file, report, &rest, progress, context, error) &&
      compile_world(s, file, report->substeps, report->iterations, &memory, &w, error)) {
    start_at_rest(w, &rest);
    begin_contacts(w);
    begin_hash(w);
    report->stretch_steps = fray_get_info(w).yarn_steps;
    report->fall_steps = fall_steps(w->params);
    *image_bytes = fray_save_bytes(w);
    *image = malloc(*image_bytes);
    if (*image == NULL)
      scene_refuse(error, file, s->source.block[BLOCK_CLOTH], "not enough memory for its image");
    else
      (void)fray_save(w, *image, *image_bytes);
  }
  free_rest(&rest);
  free(memory);
  return *image != NULL;
}
