/* SPDX-License-Identifier: Apache-2.0 */
/* A tick by several workers: the stages of rt/tick/tick_woven.c, divided into steps.
 *
 * The substeps are not divided but overlap (block_plan.h): each worker has some blocks of its own, and
 * computes them in one pass after the other, a pass being an iteration of a substep; so particles stay in
 * its cache. All else that a pass needs is a pure function of the tick's start: gravity's remainder, and
 * the positions of driven bodies. Sums of impulses and counts do not depend on their order. The springs
 * before the substeps (spring_partition.c), the tear test and the hash after them are divided along the
 * blocks, so no step waits for all workers: a worker that begins its substeps late has applied more of the
 * springs, one that ends them early hashes.
 *
 * Worker 0 alone ticks worlds with free bodies, which move by the impulses of the substep before;
 * membranes; worlds with rigid meshes, yarns, self-collision or elastic yarns; and links that cannot be
 * divided. Springs that tear are found after all substeps: what comes in between in tick_woven.c,
 * velocities, neither moves a particle nor reads a spring. */
#include "rt/workers/parallel.h"

#include "rt/base/arena.h"
#include "rt/base/bytes.h"
#include "rt/energy/energy.h"
#include "rt/tick/tick.h"
#include "rt/woven/tear_queue.h"

/* The fewest links times passes worth waking a worker for; the fewest blocks worth overlapping. */
enum { LINKS_PER_WORKER_MIN = 24576, BLOCKS_MIN = 4 };

static int has_free_body(const fray_world *w) {
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    if (w->rigid.bodies[b].motion == FRAY_FREE) return 1;
  return 0;
}

/* 1 iff worker 0 must tick the world alone. */
static int is_serial(const fray_world *w) {
  return has_free_body(w) || world_has_yarns(w) || world_has_elastic_yarns(w) || world_has_membrane(w) ||
         world_has_shear_lock(w) || world_has_rigid_meshes(w) || world_has_yarn_collision(w);
}

uint32_t fray_parallel_useful(const fray_world *w, uint32_t workers_max) {
  FRAY_ASSERT(w != NULL);
  const params *p = w->params;
  const uint32_t passes = (uint32_t)p->substeps * (uint32_t)p->iterations;
  const uint64_t work = (uint64_t)(uint32_t)p->links * passes;
  const uint32_t most = workers_max < FRAY_WORKERS_MAX ? workers_max : (uint32_t)FRAY_WORKERS_MAX;
  uint32_t workers = (uint32_t)p->links / BLOCK_SPRINGS_MIN / (uint32_t)BLOCKS_MIN;
  if (workers > most) workers = most;
  if (workers > passes) workers = passes;
  if (workers > work / LINKS_PER_WORKER_MIN) workers = (uint32_t)(work / LINKS_PER_WORKER_MIN);
  return workers < 2u || p->attached == 0 || is_serial(w) ? 1u : workers;
}

/* The views come first, because they are aligned to cache lines. */
static fray_parallel *carve(const fray_world *w, uint32_t workers, arena *a) {
  const size_t batches = (uint32_t)w->params->bend_batches + (uint32_t)w->params->shear_batches;
  parallel_view *views = (parallel_view *)arena_take(a, workers, sizeof *views);
  fray_parallel *par = (fray_parallel *)arena_take(a, 1, sizeof *par);
  spring_span *spans = (spring_span *)arena_take(a, batches * (workers + 1u), sizeof *spans);
  void *scratch = arena_take(a, 1, block_plan_scratch_bytes(w));
  if (par != NULL) {
    bytes_zero(views, workers * sizeof *views);
    bytes_zero(par, sizeof *par);
    par->views = views;
    par->spans = spans;
    par->scratch = scratch;
  }
  return par;
}

size_t fray_parallel_memory_size(const fray_world *w, uint32_t workers) {
  FRAY_ASSERT(w != NULL && workers >= 1u && workers <= FRAY_WORKERS_MAX);
  arena dry = {NULL, 0, 0};
  (void)carve(w, workers, &dry);
  return dry.used;
}

fray_parallel *fray_parallel_open(fray_world *w, uint32_t workers, void *memory, size_t memory_bytes) {
  if (w == NULL || memory == NULL || ((uintptr_t)memory & (FRAY_PARALLEL_ALIGN - 1u)) != 0 ||
      workers == 0 || workers > FRAY_WORKERS_MAX || memory_bytes < fray_parallel_memory_size(w, workers))
    return NULL;
  arena a = {(uint8_t *)memory, memory_bytes, 0};
  fray_parallel *par = carve(w, workers, &a);
  FRAY_ASSERT(par != NULL && a.used <= memory_bytes);
  par->world = w;
  par->workers = workers;
  par->passes = (uint32_t)w->params->substeps * (uint32_t)w->params->iterations;
  par->gathers = overstretched_links_may_be(w);
  par->block_count = is_serial(w) ? 0 : block_plan_make(w, par->blocks, par->scratch);
  if (par->block_count < BLOCKS_MIN) par->block_count = 0;
  schedule_make(par);
  return par;
}

int fray_parallel_holds(const fray_parallel *par) {
  FRAY_ASSERT(par != NULL);
  return par->block_count == 0 ||
         (block_plan_holds(par->world, par->blocks, par->block_count) && spring_partition_holds(par));
}

/* Copies the world anew to each view: a tick may have loaded or moved anything. */
static void begin_views(fray_parallel *par) {
  FRAY_ASSERT(par->world->params->bodies <= MAX_BODIES);
  const fray_world *w = par->world;
  for (uint32_t n = 0; n < par->workers; ++n) {
    parallel_view *view = &par->views[n];
    view->world = *w;
    view->state = *w->state;
    view->state.faults = 0;
    bytes_copy(view->motion, w->rigid.motion, sizeof(body_motion) * w->capacity[POOL_BODIES]);
    view->world.state = &view->state;
    view->world.rigid.states = view->bodies;
    view->world.rigid.motion = view->motion;
    view->world.woven.tear_queue = view->tear_queue;
  }
}

/* Adds the faults, counts and impulses of each view to the world, and clears them. */
static void join_views(fray_parallel *par) {
  fray_world *w = par->world;
  for (uint32_t n = 0; n < par->workers; ++n) {
    parallel_view *view = &par->views[n];
    fray_work *k = &view->world.work;
    w->state->faults |= view->state.faults;
    w->work.particle_steps += k->particle_steps;
    w->work.projections += k->projections;
    w->work.springs += k->springs;
    w->work.contacts += k->contacts;
    w->work.tear_tests += k->tear_tests;
    w->work.over_threshold += k->over_threshold;
    bytes_zero(k, sizeof *k);
    for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b) {
      body_motion *m = &view->motion[b];
      const vec64 gained = {m->impulse[0], m->impulse[1], m->impulse[2]};
      body_add_impulse(&w->rigid.motion[b], gained);
      bytes_zero(m->impulse, sizeof m->impulse);
    }
  }
}

static void open_tick(fray_parallel *par, const fray_input *input, fray_output *output) {
  tick_start(par->world, output);
  haptic_device_update(par->world, input);
  damp_begin(par->world);
  par->world->contact.count = 0;
  begin_views(par);
}

typedef enum { SPRINGS_NEAR, SPRINGS_OWN, SPRINGS_FAR } spring_range;

/* A worker's springs of a range, in batches first..end-1. */
static void apply_springs(const fray_parallel *par, uint32_t worker, spring_range range, uint32_t first,
                          uint32_t end) {
  fray_world *w = &par->views[worker].world;
  const uint32_t first_batch = (uint32_t)w->params->link_batches;
  for (uint32_t b = first; b < end; ++b) {
    const spring_span *span = par->spans + (size_t)(b - first_batch) * (par->workers + 1u) + worker;
    const uint32_t from[4] = {span->near, span->own, span->far, span[1].near};
    FRAY_ASSERT(from[0] <= from[1] && from[1] <= from[2] && from[2] <= from[3]);
    if (from[range] < from[range + 1]) bend_shear_range(w, b, from[range], from[range + 1]);
  }
}

/* Drag comes before springs. The near springs, which wait for other workers and for which others wait, come
 * between the two halves of the far ones. */
static void run_before_substeps(const fray_parallel *par, uint32_t worker, uint32_t step) {
  fray_world *w = &par->views[worker].world;
  const uint32_t attached = particles_attached(w);
  const uint32_t bend = (uint32_t)w->params->link_batches;
  const uint32_t shear = bend + (uint32_t)w->params->bend_batches;
  const uint32_t end = w->capacity[POOL_BATCHES];
  const uint32_t from = par->spring_from[worker] < attached ? attached : par->spring_from[worker];
  if (step == par->step.near) {
    apply_springs(par, worker, SPRINGS_NEAR, bend, end);
  } else if (step == par->step.far) {
    apply_springs(par, worker, SPRINGS_FAR, shear, end);
  } else {
    damp_range(w, from, par->spring_from[worker + 1u]);
    apply_springs(par, worker, SPRINGS_OWN, bend, end);
    apply_springs(par, worker, SPRINGS_FAR, bend, shear);
  }
}

/* Contacts are in order of body and particle; finds where those of each block begin. */
static void index_contacts(fray_parallel *par) {
  const fray_world *w = par->world;
  uint32_t n = 0;
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    for (uint32_t k = 0; k <= par->block_count; ++k) {
      par->contact_from[k][b] = n;
      while (k < par->block_count && n < w->contact.count && w->contact.list[n].body == b &&
             w->contact.list[n].particle < par->blocks[k].finish_end)
        ++n;
    }
  FRAY_ASSERT(n == w->contact.count);
}

static void gather_contacts(fray_parallel *par) {
  overstretched_links_apply(par->world);
  contact_gather(par->world);
  index_contacts(par);
}

/* Gravity and driven bodies of a substep, from the one before. */
static void begin_substep(const fray_parallel *par, parallel_view *view, uint32_t substep) {
  const fray_world *start = par->world;
  FRAY_ASSERT(substep < (uint32_t)start->params->substeps);
  const uint32_t before = substep != 0 ? substep - 1u : 0;
  const int32_t rest[3] = {start->params->gravity_rest_x, start->params->gravity_rest_y,
                           start->params->gravity_rest_z};
  for (uint32_t n = 0; n < 3; ++n)
    view->state.gravity_phase[n] = fx_wrap_add(start->state->gravity_phase[n],
                                               fx_wrap_mul((int32_t)before, rest[n]));
  bytes_copy(view->bodies, start->rigid.states, sizeof(body_state) * start->capacity[POOL_BODIES]);
  if (substep != 0) bodies_advance(&view->world, before);
  bodies_advance(&view->world, substep);
}

static void finish_block(const fray_parallel *par, fray_world *w, schedule_entry at) {
  const uint32_t k = at.block;
  FRAY_ASSERT(k < par->block_count);
  const uint32_t bodies = w->contact.count != 0 ? (uint32_t)w->params->bodies : 0;
  const uint32_t first = k != 0 ? par->blocks[k - 1u].finish_end : particles_attached(w);
  for (uint32_t b = 0; b < bodies; ++b)
    contact_primitives_range(w, par->contact_from[k][b], par->contact_from[k + 1u][b]);
  if (at.pass + 1u == par->passes) particles_hold_range(w, first, par->blocks[k].finish_end);
  particles_update_velocity_range(w, first, par->blocks[k].finish_end);
  for (uint32_t b = 0; b < bodies; ++b)
    contact_update_velocity_range(w, par->contact_from[k][b], par->contact_from[k + 1u][b]);
}

static void run_block(const fray_parallel *par, uint32_t worker, schedule_entry at) {
  FRAY_ASSERT(at.block < par->block_count && at.pass < par->passes);
  parallel_view *view = &par->views[worker];
  fray_world *w = &view->world;
  const uint32_t iterations = (uint32_t)w->params->iterations;
  const uint32_t iteration = at.pass % iterations;
  const block_plan *block = &par->blocks[at.block];
  const block_plan *before = at.block != 0 ? block - 1 : NULL;
  if (at.block == par->block_from[worker]) {
    begin_substep(par, view, at.pass / iterations);
    w->contact = par->world->contact;
  }
  if (before == NULL && iteration == 0) particles_carry(w);
  if (iteration == 0)
    particles_advance_range(w, before != NULL ? before->advance_end : particles_attached(w),
                            block->advance_end);
  strain_limit_range(w, before != NULL ? before->batch_end : 0, block->batch_end);
  if (iteration + 1u == iterations) finish_block(par, w, at);
}

static void join_tear_queues(fray_parallel *par) {
  for (uint32_t n = 0; n < par->workers; ++n) {
    const woven_state *view = &par->views[n].world.woven;
    par->world->woven.tears_waiting += view->tears_waiting;
    for (uint32_t k = 0; k < view->tear_count; ++k) tear_queue_push(par->world, view->tear_queue[k]);
  }
}

/* The end of the particles that are final with a block, rounded down to whole rounds of hash lanes, but for
 * the last block. */
static uint32_t hash_end_of(const fray_parallel *par, uint32_t block) {
  if (block + 1u == par->block_count) return par->world->p.count;
  return par->blocks[block].finish_end / (uint32_t)HASH_LANES * (uint32_t)HASH_LANES;
}

/* Hashes blocks first..end-1, after all blocks before them. */
static void hash_blocks(fray_parallel *par, uint32_t first, uint32_t end) {
  FRAY_ASSERT(first < end && end <= par->block_count);
  for (uint32_t which = 0; which < HASHED; ++which) {
    if (first == 0)
      for (uint32_t n = 0; n < 3; ++n) hash_begin(&par->axis_hash[which][n]);
    state_hash_axes(par->world, (state_hash_part)which, par->axis_hash[which],
                    first != 0 ? hash_end_of(par, first - 1u) : 0, hash_end_of(par, end - 1u));
  }
}

/* Every worker hashes its own blocks; but those of the last, which ends last, the one before hashes, one
 * block a step. */
static void run_hash_step(fray_parallel *par, uint32_t worker, uint32_t step) {
  const uint32_t last = par->owners - 1u;
  if (step == par->step.hash && (worker != last || last == 0))
    hash_blocks(par, par->block_from[worker], par->block_from[worker + 1u]);
  if (step != par->step.hash && worker + 1u == last) {
    const uint32_t end = par->block_from[last] + step - par->step.hash;
    hash_blocks(par, end - 1u, end);
  }
}

static void find_tears(const fray_parallel *par, uint32_t worker) {
  spring_tear_find_range(&par->views[worker].world, schedule_springs_before(par, par->block_from[worker]),
                         schedule_springs_before(par, par->block_from[worker + 1u]));
}

static void close_tick(fray_parallel *par, fray_output *output) {
  fray_world *w = par->world;
  const parallel_view *view = &par->views[0]; /* all end with the same bodies and the same phase of gravity */
  hash h;
  join_views(par);
  join_tear_queues(par);
  bytes_copy(w->state->gravity_phase, view->state.gravity_phase, sizeof w->state->gravity_phase);
  bytes_copy(w->rigid.states, view->bodies, sizeof(body_state) * w->capacity[POOL_BODIES]);
  spring_break_apply(w);
  haptic_force_update(w, output->force);
  tick_report_begin(w, output);
  state_hash_begin(w, &h);
  for (uint32_t which = 0; which < HASHED; ++which)
    for (uint32_t n = 0; n < 3; ++n) hash_join(&h, &par->axis_hash[which][n]);
  tick_report_end(w, hash_end(&h), output);
}

void fray_parallel_step(fray_parallel *par, uint32_t worker, uint32_t step, const fray_input *input,
                        fray_output *output) {
  FRAY_ASSERT(par != NULL && worker < par->workers && step < par->step.end);
  schedule_entry entry;
  if (par->block_count == 0 || energy_is_watched(par->world)) {
    if (worker == 0 && step == 0) fray_tick(par->world, input, output);
  } else if (step == 0) {
    if (worker == 0) open_tick(par, input, output);
  } else if (step == par->step.close) {
    if (worker == 0) close_tick(par, output);
  } else if (worker >= par->owners) {
    return;
  } else if (step < par->step.gather) {
    run_before_substeps(par, worker, step);
  } else if (step == par->step.gather) {
    if (worker == 0 && par->gathers) gather_contacts(par);
  } else if (step == par->step.tear) {
    find_tears(par, worker);
  } else if (step >= par->step.hash) {
    run_hash_step(par, worker, step);
  } else if (schedule_entry_at(par, worker, step, &entry)) {
    run_block(par, worker, entry);
  }
}
