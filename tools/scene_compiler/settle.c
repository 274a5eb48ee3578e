/* SPDX-License-Identifier: Apache-2.0 */
/* The test run of Metaaphanon 2009, section 4.1: the simulation "without tearing forces" (hands and paths
 * at rest, no thrown bodies, no tears), to find the substeps (or iterations, whichever is `auto`) that keep
 * every spring below what splits its ends or tears it, with a margin (rest_strain_max()). Tries rising
 * numbers. A try ends when a spring exceeds the bound after the cloth has come to rest; as strain falls
 * with the square of the substeps, hopeless tries are skipped. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "platform/linux/cpu.h"
#include "rt/state/crossing.h"
#include "tools/scene_compiler/draft.h"
#include "tools/scene_compiler/settle.h"

enum { SETTLE_DRAG = 30 /* 1/s */ };

static const uint32_t ladder[] = {1,  2,  3,  4,  6,  8,  10, 12, 16,
                                  20, 24, 28, 32, 40, 48, 64, 96, 128};
enum { LADDER = sizeof ladder / sizeof ladder[0] };

/* Largest (length / rest)^2 - 1 over all links in Q16, exact enough: 2^-16 of rest^2. */
static int64_t largest_elongation(const fray_world *w, const uint8_t *idle) {
  const fray_particles p = fray_view_particles(w);
  int64_t max = 0;
  for (uint32_t row = 0; row < (uint32_t)w->params->links; ++row) {
    if (idle[row] != 0 || w->woven.spring_kind[row] == SPRING_DEAD) continue;
    const uint32_t i = w->woven.spring_i[row];
    const uint32_t j = w->woven.spring_j[row];
    const vec3 d = vec_make(fx_sub(p.x[j], p.x[i]), fx_sub(p.y[j], p.y[i]), fx_sub(p.z[j], p.z[i]));
    const int64_t rest = w->woven.link_classes[w->woven.spring_kind[row] & SPRING_CLASS].rest;
    const int64_t rest2 = rest * rest;
    const uint64_t n = vec_squared(d);
    const int64_t bounded = n > (uint64_t)rest2 * 4u ? rest2 * 4 : (int64_t)n;
    const int64_t over = (bounded - rest2) / (rest2 >> 16);
    if (over > max) max = over;
  }
  return max;
}

/* Kinetic and potential energy of the free particles in units of m (lu/substep)^2, Q32; with yarns of m/2. */
static int64_t energy(const fray_world *w) {
  const fray_info f = fray_get_info(w);
  int64_t total = 0;
  for (uint32_t p = (uint32_t)w->params->attached; p < w->p.count; ++p) {
    const int weight = world_has_yarns(w) && !particle_is_half(w, p) ? 2 : 1;
    const int64_t v[3] = {w->p.vx[p], w->p.vy[p], w->p.vz[p]};
    const int64_t at[3] = {w->p.x[p], w->p.y[p], w->p.z[p]};
    for (uint32_t n = 0; n < 3; ++n) {
      total += weight * (fx_asr64(v[n], 12) * fx_asr64(v[n], 12) / 2); /* Q16 squared */
      const int64_t g = (int64_t)f.gravity[n] * 256 + (f.gravity_rest[n] >> 24); /* Q36 */
      total -= weight * fx_asr64(fx_asr64(at[n], 8) * g, 20);          /* Q16 Q36 to Q32 */
    }
  }
  return total;
}

/* sqrt(1 + e) - 1 in Q16, from e in Q16. */
static int32_t strain_of(int64_t elongation_q16) {
  return (int32_t)exact_sqrt((uint64_t)(65536 + elongation_q16) << 16) - 65536;
}

typedef struct {
  int good;          /* bound held over the whole run */
  int32_t strain_q16;
  int energy_grew;
  uint32_t faults;
} trial;

static void mark_idle(const fray_world *w, uint8_t *idle) {
  for (uint32_t b = 0; b < (uint32_t)w->params->link_batches; ++b)
    for (int32_t n = 0; n < w->woven.batches[b].count; ++n)
      idle[w->woven.batches[b].first + n] = w->woven.batches[b].attached == BATCH_INACTIVE;
}

static void run_trial(fray_world *w, const settle_request *plan, uint8_t *idle, trial *t) {
  const fray_input nothing = {0, {{0, 0, 0, 0, 0}, {0, 0, 0, 0, 0}}, 0, 0};
  fray_output out;
  const int64_t before = energy(w);
  /* allowance for start-up transients: the fall of the whole cloth by half a spacing */
  const uint32_t pull_x = fx_magnitude(w->params->gravity_x);
  const uint32_t pull_y = fx_magnitude(w->params->gravity_y);
  const uint32_t pull_z = fx_magnitude(w->params->gravity_z);
  const int64_t pull = (int64_t)pull_x + pull_y + pull_z + 1;
  const int64_t allowance = (int64_t)w->params->particles * (world_has_yarns(w) ? 2 : 1) *
                            (pull * (w->woven.link_classes[1].rest / 2) >> 20);
  int64_t last = before; /* at the edge of the world cloth stays in place and is still accelerated: no energy */
  for (uint32_t tick = 0; tick < plan->ticks; ++tick) {
    fray_tick(w, &nothing, &out);
    t->faults |= out.faults;
    if ((out.faults & FRAY_FAULT_OUT_OF_WORLD) == 0) last = energy(w);
    const int32_t strain = strain_of(largest_elongation(w, idle));
    if (strain > t->strain_q16) t->strain_q16 = strain;
    if (t->strain_q16 >= plan->strain_max_q16) return;
    if (plan->progress != NULL && tick % 32 == 0)
      plan->progress(plan->context, (uint32_t)w->params->substeps, (uint32_t)w->params->iterations,
                     tick, plan->ticks);
  }
  t->energy_grew = last > before + allowance;
  t->good = !t->energy_grew;
}

/* The scene at rest: paths and thrown bodies are fixed, nothing tears. */
static void still_scene(const scene *s, scene *still) {
  *still = *s;
  still->woven.tearing = 0;
  for (uint32_t n = 0; n < still->body_count; ++n) {
    scene_body *b = &still->bodies[n];
    const int is_thrown = b->motion == FRAY_FREE && !b->has_attach;
    if (b->motion == FRAY_PATH || is_thrown) b->motion = FRAY_FIXED;
    if (is_thrown) b->is_handle = 0;
  }
}

/* The runtime's drag acts on the cloth alone; bodies that hang on it must come to rest too. */
static void slow_bodies(fray_world *w) {
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    for (uint32_t n = 0; n < 3 && w->rigid.bodies[b].motion == FRAY_FREE; ++n) {
      int32_t *v = &w->rigid.states[b].velocity[n];
      *v -= (int32_t)fx_round64(fx_mul_wide(*v, w->params->drag), 24);
    }
}

/* Runs with strong drag, then sets all velocities to zero. */
static void come_to_rest(fray_world *w, const settle_request *plan, const uint8_t *idle, trial *t) {
  const fray_input nothing = {0, {{0, 0, 0, 0, 0}, {0, 0, 0, 0, 0}}, 0, 0};
  fray_output out;
  params *p = (params *)(uintptr_t)w->params;
  const int32_t drag = p->drag;
  p->drag = fx_max(drag, fx_min(1 << 23, (1 << 24) / p->rate_hz * SETTLE_DRAG));
  for (uint32_t tick = 0; tick < plan->rest_ticks; ++tick) {
    fray_tick(w, &nothing, &out);
    t->faults |= out.faults;
    slow_bodies(w);
    if (tick % 32 == 0 && plan->progress != NULL)
      plan->progress(plan->context, (uint32_t)p->substeps, (uint32_t)p->iterations, tick,
                     plan->rest_ticks + plan->ticks);
    if (tick % 32 == 0 && tick > plan->rest_ticks / 2 && plan->ticks > 0) {
      t->strain_q16 = strain_of(largest_elongation(w, idle));
      if (t->strain_q16 >= plan->strain_max_q16) return;
    }
  }
  t->strain_q16 = 0;
  p->drag = drag;
  const size_t bytes = (size_t)w->p.count * sizeof(int32_t);
  memset(w->p.vx, 0, bytes);
  memset(w->p.vy, 0, bytes);
  memset(w->p.vz, 0, bytes);
}

static int keep_rest(const fray_world *w, settle_rest *rest) {
  const size_t bytes = (size_t)w->p.count * sizeof(int32_t);
  const int32_t *const axes[3] = {w->p.x, w->p.y, w->p.z};
  for (uint32_t n = 0; n < 3; ++n) {
    free(rest->particles[n]);
    rest->particles[n] = malloc(bytes);
    if (rest->particles[n] == NULL) return 0;
    memcpy(rest->particles[n], axes[n], bytes);
  }
  if (world_has_membrane(w)) {
    const size_t bends = triangles_in_use(w) * sizeof *rest->bends;
    free(rest->bends);
    rest->bends = malloc(bends);
    if (rest->bends == NULL) return 0;
    memcpy(rest->bends, w->membrane.bend_states, bends);
  }
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    memcpy(rest->bodies[b], w->rigid.states[b].position, sizeof rest->bodies[b]);
  return 1;
}

static int try_once(const scene *still, const settle_request *plan, uint32_t substeps, uint32_t iterations,
                    trial *t, settle_rest *rest, scene_error *error) {
  fray_world *w = NULL;
  void *memory = NULL;
  t->good = 0;
  t->strain_q16 = 0;
  t->energy_grew = 0;
  t->faults = 0;
  if (!compile_world(still, plan->file, substeps, iterations, &memory, &w, error)) return 0;
  cpu_use_best(w);
  uint8_t *idle = calloc((size_t)w->params->links, 1);
  int kept = idle != NULL;
  if (kept) {
    mark_idle(w, idle);
    come_to_rest(w, plan, idle, t);
    kept = keep_rest(w, rest);
  }
  if (kept && plan->ticks > 0 && t->strain_q16 == 0) run_trial(w, plan, idle, t);
  free(idle);
  free(memory);
  return kept;
}

/* The next number worth a try: strain falls at most with the square of the substeps, 3/5 as margin. */
static uint32_t next_rung(uint32_t n, const trial *t, const settle_request *plan) {
  const uint64_t needed =
      (uint64_t)ladder[n] * ladder[n] * (uint32_t)t->strain_q16 / (uint32_t)plan->strain_max_q16;
  for (++n; n < LADDER && (uint64_t)ladder[n] * ladder[n] < needed * 3 / 5; ++n) {
  }
  return n;
}

/* Cloth that is not at rest is strained by its motion, and most where it meets itself. */
static const char *advise(const scene *s, const settle_request *plan, int crowded, const char *key, char *text,
                          size_t room) {
  if (!s->woven.self_collision) return "take a lighter load or a higher rate";
  snprintf(text, room, "give it %s to 'settle' before%s, or a number of '%s'",
           plan->rest_ticks > 0 ? "more time" : "time", crowded ? ", more 'self_collision_pairs'" : "", key);
  return text;
}

/* No rung was good: the last one says why. */
static void refuse_trials(const scene *s, const settle_request *plan, const compile_report *report,
                          const trial *t, scene_error *error) {
  const char *key = s->substeps == 0 ? "substeps" : "iterations";
  static const char *const limits[] = {"'max_rest_strain'", "four fifths of the least strain of 'tear'",
                                       "four fifths of the least strain of 'split_strain'"};
  const int crowded = (t->faults & FRAY_FAULT_SELF_COLLISION_BUDGET) != 0;
  char message[sizeof error->message];
  char advice[160];
  char strain[SOURCE_VALUE];
  char bound[SOURCE_VALUE];
  if (t->energy_grew)
    snprintf(message, sizeof message,
             "found cloth that gains energy with %u substeps and %u iterations in the test run "
             "of '%s auto', expected a scene that comes to rest",
             report->substeps, report->iterations, key);
  else
    snprintf(message, sizeof message,
             "found springs %sstrained by %s or more with %u substeps and %u iterations in the test "
             "run of '%s auto'%s, expected less than %s, %s; %s",
             plan->rest_ticks > 0 ? "at rest " : "",
             source_value(&s->source, BLOCK_SCENE, "max_rest_strain", UNIT_SHARE,
                          exact_make(t->strain_q16, 65536), -1, strain),
             report->substeps, report->iterations, key,
             crowded ? ", where self-collision ran out of pairs or rounds (SELF_COLLISION_BUDGET)" : "",
             source_value(&s->source, BLOCK_SCENE, "max_rest_strain", UNIT_SHARE,
                          plan->strain_max, 0, bound),
             limits[report->limit],
             advise(s, plan, crowded, key, advice, sizeof advice));
  const int written = source_find(&s->source, BLOCK_SCENE, key) != NULL;
  scene_refuse(error, plan->file,
               written ? source_place(&s->source, BLOCK_SCENE, key) : s->source.block[BLOCK_CLOTH], message);
}

int settle_scene(const scene *s, const settle_request *plan, compile_report *report, settle_rest *rest,
                 scene_error *error) {
  scene *still = malloc(sizeof *still);
  if (still == NULL) return 0;
  still_scene(s, still);
  trial t = {0, 0, 0, 0};
  int built = 1;
  uint32_t first = 0;
  const uint32_t min = scene_has_stretch(s) ? yarn_elastic_min_substeps(s) : 1;
  while (s->substeps == 0 && first + 1u < LADDER && ladder[first] < min) ++first;
  for (uint32_t n = first; n < LADDER && built && !t.good; n = next_rung(n, &t, plan)) {
    report->substeps = s->substeps != 0 ? s->substeps : ladder[n];
    report->iterations = s->iterations != 0 ? s->iterations : (s->substeps != 0 ? ladder[n] : 1);
    built = try_once(still, plan, report->substeps, report->iterations, &t, rest, error);
    t.good = t.good || !report->searched;
    ++report->tries;
  }
  free(still);
  report->strain_q16 = t.strain_q16;
  if (!built) return 0;
  if (t.good) return 1;
  refuse_trials(s, plan, report, &t, error);
  return 0;
}
