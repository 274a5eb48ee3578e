/* SPDX-License-Identifier: Apache-2.0 */
/* A tick by several workers: the stages of rt/run/step.c, in parts.
 *
 * The substeps are not divided but overlap (plan.h): each worker has some blocks of its own, and takes
 * them in one pass after the other, a pass being a sweep of a substep; so particles stay in its cache.
 * What a pass needs besides them is a pure function of the tick's start: gravity's remainder, and where
 * driven bodies are. Sums of impulses and counts do not depend on their order. Springs before them
 * (seams.c), and the test for tearing and the hash behind them, go with the blocks, so nobody waits for
 * everybody: who begins the substeps late has taken more of the springs, who ends them early takes his
 * part of the hash.
 *
 * Bodies that fly free are moved by what the cloth gave them in the substep before, so worlds with them
 * are ticked by worker 0, as are triangle sheets and those with rigid meshes, with yarns, with
 * self-collision, with links that have a stiffness, and with rows that leave no place to cut. Springs that
 * tear are found when all substeps are done: what comes between in step.c, velocities, neither moves a
 * particle nor asks for a row. */
#include "rt/share/share.h"

#include "rt/base/arena.h"
#include "rt/run/step.h"
#include "rt/stage/cuts.h"

/* The least rows times passes that a worker is worth waking for; the least blocks worth overlapping. */
enum { ROWS_A_WORKER = 24576, BLOCKS_LEAST = 4 };

static int has_free_body(const fray_world *w) {
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    if (w->bodies[b].motion == FRAY_FREE) return 1;
  return 0;
}

static int is_whole(const fray_world *w) {
  return has_free_body(w) || world_has_yarns(w) || world_has_stretch(w) || world_has_sheet(w) ||
         world_has_meshes(w) || world_has_selves(w);
}

static int has_surface(const fray_world *w) {
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    if (w->bodies[b].shape != FRAY_ANCHOR) return 1;
  return 0;
}

uint32_t fray_share_useful(const fray_world *w, uint32_t workers_max) {
  const params *p = w->params;
  const uint32_t passes = (uint32_t)p->substeps * (uint32_t)p->sweeps;
  const uint64_t rows = (uint64_t)(uint32_t)p->links * passes;
  const uint32_t most = workers_max < FRAY_WORKERS_MAX ? workers_max : (uint32_t)FRAY_WORKERS_MAX;
  uint32_t workers = (uint32_t)p->links / PLAN_ROWS_LEAST / (uint32_t)BLOCKS_LEAST;
  if (workers > most) workers = most;
  if (workers > passes) workers = passes;
  if (workers > rows / ROWS_A_WORKER) workers = (uint32_t)(rows / ROWS_A_WORKER);
  return workers < 2u || p->held == 0 || is_whole(w) ? 1u : workers;
}

/* The parts first: they want whole lines. */
static fray_share *carve_share(const fray_world *w, uint32_t workers, arena *a) {
  const size_t springs = (uint32_t)w->params->bend_batches + (uint32_t)w->params->shear_batches;
  share_part *parts = (share_part *)arena_take(a, workers, sizeof *parts);
  fray_share *s = (fray_share *)arena_take(a, 1, sizeof *s);
  share_cut *cuts = (share_cut *)arena_take(a, springs * (workers + 1u), sizeof *cuts);
  void *scratch = arena_take(a, 1, plan_scratch_bytes(w));
  if (s != NULL) {
    bytes_zero(parts, workers * sizeof *parts);
    bytes_zero(s, sizeof *s);
    s->parts = parts;
    s->cuts = cuts;
    s->scratch = scratch;
  }
  return s;
}

size_t fray_share_bytes(const fray_world *w, uint32_t workers) {
  arena dry = {NULL, 0, 0};
  (void)carve_share(w, workers, &dry);
  return dry.used;
}

fray_share *fray_share_open(fray_world *w, uint32_t workers, void *memory, size_t memory_bytes) {
  if (w == NULL || memory == NULL || ((uintptr_t)memory & (FRAY_SHARE_ALIGN - 1u)) != 0 ||
      workers == 0 || workers > FRAY_WORKERS_MAX || memory_bytes < fray_share_bytes(w, workers))
    return NULL;
  arena a = {(uint8_t *)memory, memory_bytes, 0};
  fray_share *s = carve_share(w, workers, &a);
  s->world = w;
  s->workers = workers;
  s->passes = (uint32_t)w->params->substeps * (uint32_t)w->params->sweeps;
  s->gathers = has_surface(w);
  s->block_count = is_whole(w) ? 0 : plan_cut(w, s->blocks, s->scratch);
  if (s->block_count < BLOCKS_LEAST) s->block_count = 0;
  share_order(s);
  return s;
}

int fray_share_holds(const fray_share *s) {
  return s->block_count == 0 ||
         (plan_holds(s->world, s->blocks, s->block_count) && seams_hold(s));
}

/* What the parts share with the world is copied anew: a tick may have loaded or moved anything. */
static void hand_out(fray_share *s) {
  const fray_world *w = s->world;
  for (uint32_t n = 0; n < s->workers; ++n) {
    share_part *part = &s->parts[n];
    part->world = *w;
    part->state = *w->state;
    part->state.faults = 0;
    bytes_copy(part->motion, w->motion, sizeof(body_motion) * w->capacity[POOL_BODIES]);
    part->world.state = &part->state;
    part->world.body_states = part->bodies;
    part->world.motion = part->motion;
    part->world.cuts = part->cuts;
  }
}

/* What the workers have counted and given goes to the world; nothing of it twice. */
static void join(fray_share *s) {
  fray_world *w = s->world;
  for (uint32_t n = 0; n < s->workers; ++n) {
    share_part *part = &s->parts[n];
    fray_work *k = &part->world.work;
    w->state->faults |= part->state.faults;
    w->work.predictions += k->predictions;
    w->work.projections += k->projections;
    w->work.springs += k->springs;
    w->work.contacts += k->contacts;
    w->work.tear_tests += k->tear_tests;
    w->work.over += k->over;
    bytes_zero(k, sizeof *k);
    for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b) {
      body_motion *m = &part->motion[b];
      body_gave(&w->motion[b], m->impulse[0], m->impulse[1], m->impulse[2]);
      bytes_zero(m->impulse, sizeof m->impulse);
    }
  }
}

static void open_tick(fray_share *s, const fray_input *input, fray_output *output) {
  step_begin(s->world, output);
  devices_run(s->world, input);
  damp_whole(s->world);
  s->world->contact_count = 0;
  hand_out(s);
}

typedef enum { SPRINGS_NEAR, SPRINGS_OWN, SPRINGS_FAR } springs_kind;

/* A worker's rows of a kind. */
static void run_springs(const fray_share *s, uint32_t worker, springs_kind kind, uint32_t from, uint32_t end) {
  fray_world *w = &s->parts[worker].world;
  const uint32_t first = (uint32_t)w->params->link_batches;
  for (uint32_t b = from; b < end; ++b) {
    const share_cut *rows = s->cuts + (size_t)(b - first) * (s->workers + 1u) + worker;
    const uint32_t at[4] = {rows->near, rows->own, rows->far, rows[1].near};
    if (at[kind] < at[kind + 1]) springs_part(w, b, at[kind], at[kind + 1]);
  }
}

/* Drag comes before springs. The near ones, for which others wait and which wait for others, come in
 * between the far ones. */
static void run_before_substeps(const fray_share *s, uint32_t worker, uint32_t step) {
  fray_world *w = &s->parts[worker].world;
  const uint32_t held = (uint32_t)w->params->held;
  const uint32_t first = (uint32_t)w->params->link_batches;
  const uint32_t end = w->capacity[POOL_BATCHES];
  const uint32_t middle = first + (uint32_t)w->params->bend_batches;
  const uint32_t from = s->springs_from[worker] < held ? held : s->springs_from[worker];
  if (step == s->at.near) {
    run_springs(s, worker, SPRINGS_NEAR, first, end);
  } else if (step == s->at.far) {
    run_springs(s, worker, SPRINGS_FAR, middle, end);
  } else {
    damp_part(w, from, s->springs_from[worker + 1u]);
    run_springs(s, worker, SPRINGS_OWN, first, end);
    run_springs(s, worker, SPRINGS_FAR, first, middle);
  }
}

/* Contacts stand in order of body and particle; where those of each block begin. */
static void index_contacts(fray_share *s) {
  const fray_world *w = s->world;
  uint32_t n = 0;
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    for (uint32_t k = 0; k <= s->block_count; ++k) {
      s->contact_from[k][b] = n;
      while (k < s->block_count && n < w->contact_count && w->contacts[n].body == b &&
             w->contacts[n].particle < s->blocks[k].finish_end)
        ++n;
    }
}

static void gather(fray_share *s) {
  collide_gather(s->world);
  index_contacts(s);
}

/* Gravity and driven bodies as they are in a substep, from the one before. */
static void begin_substep(const fray_share *s, share_part *part, uint32_t substep) {
  const fray_world *start = s->world;
  const uint32_t before = substep != 0 ? substep - 1u : 0;
  const int32_t rest[3] = {start->params->gravity_rest_x, start->params->gravity_rest_y,
                           start->params->gravity_rest_z};
  for (uint32_t n = 0; n < 3; ++n)
    part->state.gravity_phase[n] = fx_wrap_add(start->state->gravity_phase[n],
                                               fx_wrap_mul((int32_t)before, rest[n]));
  bytes_copy(part->bodies, start->body_states, sizeof(body_state) * start->capacity[POOL_BODIES]);
  if (substep != 0) predict_begin(&part->world, before);
  predict_begin(&part->world, substep);
}

static void finish_block(const fray_share *s, fray_world *w, uint32_t k) {
  const uint32_t bodies = w->contact_count != 0 ? (uint32_t)w->params->bodies : 0;
  const uint32_t first = k != 0 ? s->blocks[k - 1u].finish_end : (uint32_t)w->params->held;
  for (uint32_t b = 0; b < bodies; ++b)
    collide_part(w, s->contact_from[k][b], s->contact_from[k + 1u][b]);
  finish_part(w, first, s->blocks[k].finish_end);
  for (uint32_t b = 0; b < bodies; ++b)
    finish_contacts(w, s->contact_from[k][b], s->contact_from[k + 1u][b]);
}

static void run_block(const fray_share *s, uint32_t worker, share_place at) {
  share_part *part = &s->parts[worker];
  fray_world *w = &part->world;
  const uint32_t sweeps = (uint32_t)w->params->sweeps;
  const uint32_t sweep = at.pass % sweeps;
  const plan_block *block = &s->blocks[at.block];
  const plan_block *before = at.block != 0 ? block - 1 : NULL;
  if (at.block == s->from[worker]) {
    begin_substep(s, part, at.pass / sweeps);
    w->contact_count = s->world->contact_count;
  }
  if (before == NULL && sweep == 0) predict_held(w);
  if (sweep == 0)
    predict_part(w, before != NULL ? before->predict_end : (uint32_t)w->params->held,
                 block->predict_end);
  strain_part(w, before != NULL ? before->batch_end : 0, block->batch_end);
  if (sweep + 1u == sweeps) finish_block(s, w, at.block);
}

static void join_cuts(fray_share *s) {
  for (uint32_t n = 0; n < s->workers; ++n) {
    const fray_world *part = &s->parts[n].world;
    s->world->cuts_waiting += part->cuts_waiting;
    for (uint32_t k = 0; k < part->cut_count; ++k) cuts_enlist(s->world, part->cuts[k]);
  }
}

/* Up to where particles are final with a block, in whole rounds of lanes but for the last. */
static uint32_t hash_end_of(const fray_share *s, uint32_t block) {
  if (block + 1u == s->block_count) return s->world->particles;
  return s->blocks[block].finish_end / (uint32_t)HASH_LANES * (uint32_t)HASH_LANES;
}

/* Goes on behind the blocks before. */
static void hash_blocks(fray_share *s, uint32_t from, uint32_t end) {
  for (uint32_t which = 0; which < HASHED; ++which) {
    if (from == 0)
      for (uint32_t n = 0; n < 3; ++n) hash_begin(&s->axes[which][n]);
    world_hash_axes(s->world, (world_hashed)which, s->axes[which],
                    from != 0 ? hash_end_of(s, from - 1u) : 0, hash_end_of(s, end - 1u));
  }
}

/* Everybody his own; but who ends last leaves it to the one before, block by block. */
static void hash_step_of(fray_share *s, uint32_t worker, uint32_t step) {
  const uint32_t last = s->owners - 1u;
  if (step == s->at.hash && (worker != last || last == 0))
    hash_blocks(s, s->from[worker], s->from[worker + 1u]);
  if (step != s->at.hash && worker + 1u == last) {
    const uint32_t end = s->from[last] + step - s->at.hash;
    hash_blocks(s, end - 1u, end);
  }
}

static void tear_own(const fray_share *s, uint32_t worker) {
  tear_part(&s->parts[worker].world, share_rows_before(s, s->from[worker]),
            share_rows_before(s, s->from[worker + 1u]));
}

static void close_tick(fray_share *s, fray_output *output) {
  fray_world *w = s->world;
  const share_part *last = &s->parts[0];
  hash h;
  join(s);
  join_cuts(s);
  bytes_copy(w->state->gravity_phase, last->state.gravity_phase, sizeof w->state->gravity_phase);
  bytes_copy(w->body_states, last->bodies, sizeof(body_state) * w->capacity[POOL_BODIES]);
  cut_run(w);
  force_run(w, output->force);
  report_begin(w, output);
  world_hash_begin(w, &h);
  for (uint32_t which = 0; which < HASHED; ++which)
    for (uint32_t n = 0; n < 3; ++n) hash_join(&h, &s->axes[which][n]);
  report_end(w, hash_end(&h), output);
}

void fray_share_step(fray_share *s, uint32_t worker, uint32_t step, const fray_input *input,
                     fray_output *output) {
  share_place place;
  if (s->block_count == 0) {
    if (worker == 0 && step == 0) fray_tick(s->world, input, output);
  } else if (step == 0) {
    if (worker == 0) open_tick(s, input, output);
  } else if (step == s->at.close) {
    if (worker == 0) close_tick(s, output);
  } else if (worker >= s->owners) {
    return;
  } else if (step < s->at.gather) {
    run_before_substeps(s, worker, step);
  } else if (step == s->at.gather) {
    if (worker == 0 && s->gathers) gather(s);
  } else if (step == s->at.tear) {
    tear_own(s, worker);
  } else if (step >= s->at.hash) {
    hash_step_of(s, worker, step);
  } else if (share_place_of(s, worker, step, &place)) {
    run_block(s, worker, place);
  }
}
