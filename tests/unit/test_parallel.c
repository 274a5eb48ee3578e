/* SPDX-License-Identifier: Apache-2.0 */
/* Ticks that are shared: in whatever order workers take their steps, as long as each waits for what
 * it needs, every tick puts out what fray_tick() does, and the world is the same in every byte. Then
 * the plan: whatever may be under way at the same time shares no particle. */
#include "tests/lib/test.h"
#include "tests/lib/torn_by_hands.h"

#include "platform/linux/cpu.h"
#include "rt/workers/parallel.h"

/* Who goes next, of those whose needs are met. */
typedef enum { TURNS, FIRST, LAST, RANDOM, POLICIES } policy;

typedef struct {
  fixture f;
  fray_parallel *share;
  void *memory;
  uint32_t workers;
  uint32_t draws;
} shared;

static void parallel_run_open(shared *s, uint32_t workers) {
  const size_t bytes = fray_parallel_memory_size(s->f.w, workers);
  s->workers = workers;
  s->memory = aligned_alloc(FRAY_PARALLEL_ALIGN, (bytes + 63) / 64 * 64);
  s->share = fray_parallel_open(s->f.w, workers, s->memory, bytes);
  if (s->share == NULL) fixture_give_up("fray_parallel_open", "refused");
}

static void parallel_run_close(shared *s) {
  free(s->memory);
  s->memory = NULL;
}
static void shared_close(shared *s) {
  parallel_run_close(s);
  fixture_close(&s->f);
}

static int is_met(const shared *s, const uint32_t *done, uint32_t worker) {
  const fray_dependency need = fray_parallel_dependency(s->share, worker, done[worker]);
  if (need.worker != FRAY_ALL_WORKERS) return done[need.worker] >= need.steps;
  for (uint32_t n = 0; n < s->workers; ++n)
    if (n != worker && done[n] < need.steps) return 0;
  return 1;
}

/* The worker to look at in the n-th look of a turn. */
static uint32_t choose(shared *s, policy p, uint32_t turn, uint32_t n) {
  if (p == FIRST) return n;
  if (p == LAST) return s->workers - 1 - n;
  if (p == RANDOM && n == 0) s->draws = s->draws * 1664525u + 1013904223u;
  return ((p == RANDOM ? s->draws >> 16 : turn) + n) % s->workers;
}

static fray_output parallel_run_tick(shared *s, policy p, const fray_input *input) {
  const uint32_t steps = fray_parallel_steps(s->share);
  uint32_t done[FRAY_WORKERS_MAX] = {0};
  uint32_t left = steps * s->workers;
  fray_output out;
  memset(&out, 0xA5, sizeof out);
  for (uint32_t turn = 0; left > 0; ++turn) {
    uint32_t n = 0;
    uint32_t worker = 0;
    for (; n < s->workers; ++n) {
      worker = choose(s, p, turn, n);
      if (done[worker] < steps && is_met(s, done, worker)) break;
    }
    if (n == s->workers) fixture_give_up("parallel_run_tick", "everybody waits");
    fray_parallel_step(s->share, worker, done[worker], input, &out);
    ++done[worker];
    --left;
  }
  return out;
}

static int same_image(const fixture *a, const fixture *b) {
  const size_t bytes = fray_save_bytes(a->w);
  void *one = malloc(bytes);
  void *two = malloc(bytes);
  const int same = one != NULL && two != NULL && fray_save(a->w, one, bytes) == bytes &&
                   fray_save(b->w, two, bytes) == bytes && memcmp(one, two, bytes) == 0;
  free(one);
  free(two);
  return same;
}

/* What the scenes must have had, so that they prove something. */
typedef struct {
  uint32_t blocks, cuts, waited, contacts;
  uint16_t faults;
} seen;

static seen compare(const fixture *start, uint32_t workers, policy p, uint32_t ticks) {
  fixture plain;
  CLOSED_BY(shared_close) shared s = {0};
  seen all = {0, 0, 0, 0, 0};
  fixture_copy(&plain, start);
  fixture_copy(&s.f, start);
  if (workers % 2 == 0) (void)cpu_use_best(s.f.w);
  parallel_run_open(&s, workers);
  all.blocks = s.share->block_count;
  for (uint32_t tick = 0; tick < ticks; ++tick) {
    const fray_input input = torn_input(start, tick);
    const fray_output one = fixture_tick(&plain, &input);
    const fray_output two = parallel_run_tick(&s, p, &input);
    all.cuts += one.work.tears;
    all.waited += one.tears_waiting;
    all.contacts += one.work.contacts;
    all.faults |= one.faults;
    if (memcmp(&one, &two, sizeof one) == 0) continue;
    printf("%u workers, order %d, tick %u: %016llx, expected %016llx\n", workers, (int)p, tick,
           (unsigned long long)two.hash, (unsigned long long)one.hash);
    CHECK(0);
    break;
  }
  CHECK(same_image(&plain, &s.f));
  CHECK(fray_parallel_holds(s.share));
  fixture_close(&plain);
  return all;
}

static seen compare_all(fixture *f, uint32_t ticks) {
  static const uint32_t numbers[] = {1, 2, 3, 4, 8, 16};
  seen s = {0, 0, 0, 0, 0};
  for (uint32_t n = 0; n < sizeof numbers / sizeof numbers[0]; ++n)
    for (policy p = TURNS; p < POLICIES; ++p) s = compare(f, numbers[n], p, ticks);
  fixture_close(f);
  return s;
}

/* Two hands with grips, a rail on a path, a plane; torn, with springs that wait and contacts that do
 * not fit. */
static void open_torn(fixture *f, const char *substeps, const char *damping) {
  torn_open(f, substeps, damping,
            "friction 0.3\n move path {\n  0 s 0 -0.2 -0.15 cm\n  0.02 s 0 -0.2 -0.15 cm\n  0.1 s 0 -0.1 0.2 cm\n }\n}\n"
            "plane ground {\n at 0 -1 0 cm\n friction 0.5");
}

static void torn_between_two_hands(void) {
  fixture f;
  open_torn(&f, "substeps 6\niterations 1", "");
  const seen s = compare_all(&f, 110);
  CHECK(s.blocks >= 4 && s.cuts > 40 && s.waited > 0 && s.contacts > 0);
  CHECK((s.faults & FRAY_FAULT_CONTACTS_FULL) != 0);
  printf("  torn: %u blocks, %u cuts, %u waited\n", s.blocks, s.cuts, s.waited);
}

static void sweeps_are_passes_too(void) {
  fixture f;
  open_torn(&f, "substeps 3\niterations 3", "damping 3 /s");
  const seen s = compare_all(&f, 90);
  CHECK(s.blocks >= 4 && s.cuts > 20 && s.contacts > 0);
}

static void one_substep(void) {
  fixture f;
  open_torn(&f, "substeps 1\niterations 2", "");
  CHECK(compare_all(&f, 60).blocks >= 4);
}

/* Who carries a crossing at the edge of the world, and flags it, is any worker. */
static void leaves_the_world(void) {
  fixture f;
  fixture_print(&f,
                "scene edge\nrate 1000 Hz\nsubsteps 4\ngravity 0 -981 0 cm/s2\n"
                "woven {\n warps 20\n wefts 24\n spacing 12 /cm\n tear off\n at 0 0 55 cm\n}\n"
                "sphere top {\n radius 0.2 cm\n attach_within 0.1 cm\n move path {\n"
                "  0 s 0 0.96 55 cm\n  0.04 s 0 0.96 59.9 cm\n }\n}\n");
  const seen s = compare_all(&f, 80);
  CHECK(s.blocks >= 4);
  CHECK((s.faults & FRAY_FAULT_OUT_OF_WORLD) != 0);
}

static void scenes(void) {
  static const struct {
    const char *file, *from, *to;
    uint32_t ticks, divided;
  } list[] = {
      {"tests/scenes/small.scene", "seed", "seed", 60, 0},
      {"tests/scenes/mirror.scene", "substeps 8", "substeps 5", 60, 1},
      {"tests/scenes/hanging.scene", "substeps auto\nsettle 0.2 s", "substeps 4", 20, 1},
      {"tests/scenes/two_hands.scene", "substeps auto\niterations 1", "substeps 9\niterations 1", 40, 1},
      {"tests/scenes/bars_apart.scene", "settle 0.5 s", "", 10, 1},
      {"tests/scenes/corner_load.scene", "settle 0.5 s", "", 10, 1},
      {"tests/scenes/thrown_ball.scene", "settle 0.5 s", "", 10, 0},
      {"tests/scenes/cube.scene", "substeps 16", "substeps 5", 10, 0},
      {"tests/scenes/weight.scene", "substeps auto\nsettle 3 s", "substeps 12", 30, 0},
      {"tests/determinism/torn.scene", "seed", "seed", 120, 0},
      {"tests/determinism/bodies.scene", "seed", "seed", 120, 0},
      {"tests/determinism/satin24.scene", "seed", "seed", 60, 0},
      {"tests/determinism/stretched.scene", "seed", "seed", 120, 0},
      {"tests/determinism/membrane_tear.scene", "substeps", "substeps", 60, 0},
      {"tests/scenes/strength/single_yarn.scene", "warps 2", "warps 40", 20, 0},
  };
  for (uint32_t n = 0; n < sizeof list / sizeof list[0]; ++n) {
    fixture_scoped f = {0};
    if (strcmp(list[n].file, "tests/scenes/two_hands.scene") == 0)
      fixture_file(&f, list[n].file, list[n].from, list[n].to, "settle 1 s", "", "max_rest_strain 0.7 %", "", NULL);
    else
      fixture_file(&f, list[n].file, list[n].from, list[n].to, NULL);
    seen s = {0, 0, 0, 0, 0};
    for (uint32_t workers = 1; workers <= 8; workers *= 2)
      s = compare(&f, workers, workers == 2 ? LAST : RANDOM, list[n].ticks);
    printf("  %s: %u blocks, %u cuts, %u contacts\n", list[n].file, s.blocks, s.cuts, s.contacts);
    CHECK_EQ_INT(s.blocks != 0, list[n].divided);
  }
}

/* Saved by one number of workers, gone on with by another. */
static void saved_in_the_middle(void) {
  fixture_scoped plain = {0};
  CLOSED_BY(shared_close) shared s = {0};
  open_torn(&plain, "substeps 6\niterations 1", "");
  fixture_copy(&s.f, &plain);
  for (uint32_t tick = 0, workers = 1; tick < 110; ++tick) {
    const fray_input input = torn_input(&plain, tick);
    if (tick % 11 == 0) {
      fixture next;
      fixture_copy(&next, &s.f);
      parallel_run_close(&s);
      fixture_close(&s.f);
      s.f = next;
      workers = workers % 8 + 1;
      parallel_run_open(&s, workers);
    }
    const fray_output one = fixture_tick(&plain, &input);
    const fray_output two =
        tick % 11 == 5 ? fixture_tick(&s.f, &input) : parallel_run_tick(&s, RANDOM, &input);
    CHECK(memcmp(&one, &two, sizeof one) == 0);
  }
  CHECK(same_image(&plain, &s.f));
}

/* ---- the plan, by what rows and particles say ---- */

enum { CLOCKS_MAX = 2048 };

/* What a step of the substeps follows: of each worker, how many steps. */
typedef struct {
  uint32_t after[FRAY_WORKERS_MAX];
} clock;

/* touches[k]: particles of block k, a byte each. */
static uint8_t *find_touched(const fray_parallel *s) {
  const fray_world *w = s->world;
  const uint32_t particles = (uint32_t)w->params->particles;
  uint8_t *touched = calloc(s->block_count, particles);
  uint32_t b = 0;
  for (uint32_t k = 0; k < s->block_count; ++k) {
    uint8_t *own = touched + (size_t)k * particles;
    const uint32_t held = (uint32_t)w->params->attached;
    for (; b < s->blocks[k].batch_end; ++b)
      for (int32_t row = w->woven.batches[b].first;
           w->woven.batches[b].attached != BATCH_INACTIVE && row < w->woven.batches[b].first + w->woven.batches[b].count; ++row)
        own[w->woven.spring_i[row]] = own[w->woven.spring_j[row]] = 1;
    for (uint32_t p = k == 0 ? 0 : s->blocks[k - 1].advance_end; p < s->blocks[k].advance_end; ++p)
      own[p] = 1;
    for (uint32_t p = k == 0 ? held : s->blocks[k - 1].finish_end; p < s->blocks[k].finish_end; ++p)
      own[p] = 1;
  }
  return touched;
}

static int meet(const uint8_t *touched, uint32_t particles, uint32_t a, uint32_t b) {
  const uint8_t *one = touched + (size_t)a * particles;
  const uint8_t *two = touched + (size_t)b * particles;
  for (uint32_t p = 0; p < particles; ++p)
    if (one[p] != 0 && two[p] != 0) return 1;
  return 0;
}

/* One block of one pass, whose it is, and what it follows. */
typedef struct {
  uint32_t worker, step;
  clock follows;
} task;

/* The block that a worker takes in one step, with what it follows. */
static void note_task(const shared *s, uint32_t worker, uint32_t step, const clock *c, task *tasks) {
  schedule_entry p;
  if (!schedule_entry_at(s->share, worker, step, &p)) return;
  task *t = &tasks[p.pass * s->share->block_count + p.block];
  CHECK_EQ_INT(t->step, 0); /* once */
  t->worker = worker;
  t->step = step;
  t->follows = *c;
}

/* All blocks of a tick's passes: tasks[pass * blocks + block]. Workers go in turn, each as far as it
 * can, so that what a step needs has its clock already. */
static void find_tasks(const shared *s, task *tasks) {
  static clock at[FRAY_WORKERS_MAX][CLOCKS_MAX];
  const uint32_t first = s->share->step.substeps;
  const uint32_t end = s->share->step.tear;
  uint32_t done[FRAY_WORKERS_MAX];
  uint32_t left = (end - first) * s->workers;
  for (uint32_t v = 0; v < s->workers; ++v) done[v] = first;
  for (uint32_t worker = 0; left > 0; worker = (worker + 1) % s->workers)
    for (; done[worker] < end; ++done[worker], --left) {
      const uint32_t step = done[worker];
      const fray_dependency need = fray_parallel_dependency(s->share, worker, step);
      if (need.worker != FRAY_ALL_WORKERS && done[need.worker] < need.steps) break;
      clock *c = &at[worker][step - first];
      memset(c, 0, sizeof *c);
      if (step > first) *c = *(c - 1);
      c->after[worker] = step;
      if (need.worker != FRAY_ALL_WORKERS && need.steps > first) {
        const clock *other = &at[need.worker][need.steps - 1 - first];
        for (uint32_t v = 0; v < s->workers; ++v)
          if (v != worker && other->after[v] > c->after[v]) c->after[v] = other->after[v];
        if (c->after[need.worker] < need.steps) c->after[need.worker] = need.steps;
      }
      note_task(s, worker, step, c, tasks);
    }
}

/* a stands before b in one worker's order; does it here? */
static int is_before(const task *a, const task *b) {
  return b->follows.after[a->worker] > a->step;
}

/* Every pair of blocks of a tick: one follows the other, or they share no particle. */
static void check_pairs(const shared *s, const uint8_t *touched, const task *tasks) {
  const fray_parallel *share = s->share;
  const uint32_t blocks = share->block_count;
  const uint32_t particles = (uint32_t)share->world->params->particles;
  uint8_t *meets = calloc(blocks, blocks);
  uint32_t beside = 0;
  uint32_t bad = 0;
  for (uint32_t a = 0; a < blocks; ++a)
    for (uint32_t b = 0; b < blocks; ++b) meets[a * blocks + b] = (uint8_t)meet(touched, particles, a, b);
  for (uint32_t b = 0; b < share->passes * blocks; ++b) {
    CHECK(tasks[b].step != 0);
    for (uint32_t a = 0; a < b; ++a) {
      if (is_before(&tasks[a], &tasks[b])) continue;
      beside += tasks[a].worker != tasks[b].worker;
      bad += meets[a % blocks * blocks + b % blocks];
    }
  }
  CHECK_EQ_INT(bad, 0);
  CHECK(beside > 0 || s->workers == 1 || share->passes < 2);
  free(meets);
}

static void check_plan(const fixture *f, uint32_t workers) {
  static task tasks[CLOCKS_MAX];
  CLOSED_BY(shared_close) shared s = {0};
  memset(tasks, 0, sizeof tasks);
  fixture_copy(&s.f, f);
  parallel_run_open(&s, workers);
  const fray_parallel *share = s.share;
  CHECK(share->block_count >= 3 && share->passes * share->block_count <= CLOCKS_MAX);
  CHECK(fray_parallel_holds(share));
  uint8_t *touched = find_touched(share);
  find_tasks(&s, tasks);
  check_pairs(&s, touched, tasks);
  free(touched);
}

static void nothing_meets(void) {
  fixture f[5];
  open_torn(&f[0], "substeps 6\niterations 1", "");
  open_torn(&f[1], "substeps 3\niterations 2", "");
  fixture_hanging(&f[2], 41, 41, 4, "0 s", "0 %", "0 /s");
  fixture_hanging(&f[3], 160, 80, 4, "0 s", "0 %", "0 /s");
  fixture_file(&f[4], "tests/scenes/bars_apart.scene", "settle 0.5 s", "", NULL);
  for (uint32_t n = 0; n < 5; ++n) {
    for (uint32_t workers = 1; workers <= FRAY_WORKERS_MAX; ++workers) check_plan(&f[n], workers);
    fixture_close(&f[n]);
  }
}

/* Every particle is predicted once, finished once, in between its links; every row in one block. */
static void blocks_cover_a_sweep(void) {
  CLOSED_BY(shared_close) shared s = {0};
  open_torn(&s.f, "substeps 6\niterations 1", "");
  parallel_run_open(&s, 2);
  const fray_world *w = s.f.w;
  const block_plan *blocks = s.share->blocks;
  const uint32_t count = s.share->block_count;
  uint32_t b = 0;
  for (uint32_t k = 0; k < count; ++k)
    for (; b < blocks[k].batch_end; ++b) {
      if (w->woven.batches[b].attached == BATCH_INACTIVE) continue;
      for (int32_t row = w->woven.batches[b].first; row < w->woven.batches[b].first + w->woven.batches[b].count; ++row) {
        const uint32_t ends[2] = {w->woven.spring_i[row], w->woven.spring_j[row]};
        for (int n = 0; n < 2; ++n) {
          CHECK(ends[n] < blocks[k].advance_end);
          if (k > 0 && ends[n] >= (uint32_t)w->params->attached) CHECK(ends[n] >= blocks[k - 1].finish_end);
        }
      }
    }
  CHECK_EQ_INT(b, w->params->link_batches);
  CHECK_EQ_INT(blocks[count - 1].advance_end, w->params->particles);
  CHECK_EQ_INT(blocks[count - 1].finish_end, w->params->particles);
}

/* A row that gets another end: far from its place the plan is void, and a new one is made. */
static void a_moved_end_voids_the_plan(void) {
  CLOSED_BY(shared_close) shared s = {0};
  fixture_hanging(&s.f, 41, 41, 4, "0 s", "0 %", "0 /s");
  parallel_run_open(&s, 2);
  fray_world *w = s.f.w;
  const uint32_t row = (uint32_t)w->params->links / 4;
  const index_t before = w->woven.spring_j[row];
  CHECK(fray_parallel_holds(s.share));
  w->woven.spring_j[row] = (index_t)(w->params->particles - 1);
  CHECK(!fray_parallel_holds(s.share));
  parallel_run_close(&s);
  parallel_run_open(&s, 2);
  CHECK(fray_parallel_holds(s.share));
  w->woven.spring_j[row] = before;
}

/* Springs for which a worker waits for the one before, or that one for him, in percent. */
static uint32_t springs_waited_for(const fray_parallel *s) {
  const params *p = s->world->params;
  const uint32_t batches = (uint32_t)p->bend_batches + (uint32_t)p->shear_batches;
  uint32_t near = 0;
  for (uint32_t b = 0; b < batches; ++b)
    for (uint32_t n = 0; n < s->owners; ++n) {
      const spring_span *c = s->spans + (size_t)b * (s->workers + 1u) + n;
      near += c->far - c->near;
    }
  return near * 100u / (uint32_t)(p->bends + p->shears);
}

/* Those about where two workers meet, a fifth, and not before a worker is in the middle of his first pass: rows of
 * springs go with the particles (half of them where pieces of runs did not). */
static void few_springs_wait(void) {
  static const uint32_t sizes[][2] = {{160, 80}, {320, 160}};
  for (uint32_t n = 0; n < 2; ++n) {
    CLOSED_BY(shared_close) shared s = {0};
    fixture_hanging(&s.f, sizes[n][0], sizes[n][1], 4, "0 s", "0 %", "0 /s");
    parallel_run_open(&s, 2);
    const uint32_t waited = springs_waited_for(s.share);
    printf("  %u x %u: %u %% of the springs are waited for\n", sizes[n][0], sizes[n][1], waited);
    CHECK(waited <= 25);
    CHECK(!s.share->springs_first && s.share->gate_block[0] != PARALLEL_NO_GATE && s.share->gate_block[0] >= 2);
  }
}

static void refuses_what_does_not_fit(void) {
  fixture_scoped f = {0};
  fixture_hanging(&f, 8, 8, 2, "0 s", "0 %", "0 /s");
  static _Alignas(FRAY_PARALLEL_ALIGN) uint8_t memory[1 << 17];
  const size_t bytes = fray_parallel_memory_size(f.w, 4);
  CHECK(bytes < sizeof memory);
  CHECK(fray_parallel_open(f.w, 4, memory, bytes) != NULL);
  CHECK(fray_parallel_open(f.w, 4, memory, bytes - 1) == NULL);
  CHECK(fray_parallel_open(f.w, 4, memory + 16, bytes) == NULL);
  CHECK(fray_parallel_open(f.w, 0, memory, bytes) == NULL);
  CHECK(fray_parallel_open(f.w, FRAY_WORKERS_MAX + 1, memory, sizeof memory) == NULL);
  CHECK(fray_parallel_open(NULL, 4, memory, bytes) == NULL);
  CHECK(fray_parallel_open(f.w, 4, NULL, bytes) == NULL);
  CHECK_EQ_INT(fray_parallel_useful(f.w, 8), 1);
  fixture_close(&f);
  fixture_hanging(&f, 160, 80, 4, "0 s", "0 %", "0 /s");
  CHECK_EQ_INT(fray_parallel_useful(f.w, 2), 2);
  CHECK_EQ_INT(fray_parallel_useful(f.w, 1), 1);
}

int main(void) {
  TEST(torn_between_two_hands);
  TEST(sweeps_are_passes_too);
  TEST(one_substep);
  TEST(leaves_the_world);
  TEST(scenes);
  TEST(saved_in_the_middle);
  TEST(nothing_meets);
  TEST(blocks_cover_a_sweep);
  TEST(a_moved_end_voids_the_plan);
  TEST(few_springs_wait);
  TEST(refuses_what_does_not_fit);
  return test_end();
}
