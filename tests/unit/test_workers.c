/* SPDX-License-Identifier: Apache-2.0 */
/* Threads that share a tick: the hashes of one, threads that start once, nothing allocated in a tick.
 * `make san-thread` runs it under a sanitizer that sees two threads at one word. */
#define _GNU_SOURCE

#include <dirent.h>
#include <malloc.h>
#include <time.h>

#include "tests/lib/test.h"
#include "tests/lib/torn_by_hands.h"

#include "platform/linux/cpu.h"
#include "platform/linux/workers.h"

typedef struct {
  fixture f;
  workers_group t;
  void *memory;
} squad;

static int squad_open(squad *s, const fixture *start, uint32_t workers, int cpu) {
  fixture_copy(&s->f, start);
  (void)cpu_use_best(s->f.w);
  const size_t bytes = (workers_memory_size(s->f.w, workers) + 63) / 64 * 64;
  s->memory = bytes != 0 ? aligned_alloc(FRAY_PARALLEL_ALIGN, bytes) : NULL;
  return workers_open(&s->t, s->f.w, workers, cpu, s->memory, bytes);
}

static void squad_close(squad *s) {
  workers_close(&s->t);
  free(s->memory);
  fixture_close(&s->f);
}

static void open_torn(fixture *f) { torn_open(f, "substeps 6", "damping 1 /s", "at 0 -0.2 -0.12 cm"); }

static void pause_ms(long ms) {
  const struct timespec time = {0, ms * 1000000L};
  (void)nanosleep(&time, NULL);
}

/* Now and then a pause, so that workers fall asleep and are woken. */
static uint32_t compare(const fixture *start, uint32_t workers, uint32_t ticks) {
  fixture_scoped plain = {0};
  CLOSED_BY(squad_close) squad s = {0};
  uint32_t cuts = 0;
  fixture_copy(&plain, start);
  CHECK(squad_open(&s, start, workers, WORKERS_ANY_CPU));
  for (uint32_t tick = 0; tick < ticks; ++tick) {
    const fray_input input = torn_input(start, tick);
    const fray_output one = fixture_tick(&plain, &input);
    fray_output two;
    workers_tick(&s.t, &input, &two);
    cuts += one.work.tears;
    CHECK_EQ_INT(memcmp(&one, &two, sizeof one), 0);
    if (tick % 25 == 24) pause_ms(5);
  }
  return cuts;
}

static void any_number_of_workers(void) {
  fixture_scoped f = {0};
  open_torn(&f);
  for (uint32_t workers = 1; workers <= 8; workers *= 2) CHECK(compare(&f, workers, 110) > 10);
  fixture_close(&f);
  fixture_hanging(&f, 64, 48, 4, "0 s", "5 %", "0.5 /s");
  for (uint32_t workers = 2; workers <= 8; workers *= 2) (void)compare(&f, workers, 30);
  fixture_close(&f);
  fixture_file(&f, "tests/determinism/bodies.scene", NULL); /* free bodies: substeps by one */
  (void)compare(&f, 4, 60);
}

static uint32_t threads(void) {
  uint32_t count = 0;
  DIR *tasks = opendir("/proc/self/task");
  for (const struct dirent *e = tasks != NULL ? readdir(tasks) : NULL; e != NULL; e = readdir(tasks))
    count += e->d_name[0] != '.';
  if (tasks != NULL) closedir(tasks);
  return count;
}

static void starts_once_and_allocates_nothing(void) {
  fixture_scoped f = {0};
  squad s;
  fray_output out;
  const uint32_t before = threads();
  open_torn(&f);
  CHECK(squad_open(&s, &f, 4, WORKERS_ANY_CPU));
  CHECK_EQ_INT(threads(), before + 3);
  const size_t used = mallinfo2().uordblks;
  for (uint32_t tick = 0; tick < 50; ++tick) {
    const fray_input input = torn_input(&f, tick);
    workers_tick(&s.t, &input, &out);
  }
  CHECK_EQ_INT(threads(), before + 3);
  CHECK_EQ_INT(mallinfo2().uordblks, used);
  squad_close(&s);
  CHECK_EQ_INT(threads(), before);
}

/* A group that never ticks, one whose workers sleep, and one right after another. */
static void opens_and_closes(void) {
  fixture_scoped f = {0};
  squad s;
  fray_output out;
  fixture_hanging(&f, 16, 16, 2, "0 s", "0 %", "0 /s");
  for (uint32_t n = 0; n < 50; ++n) {
    CHECK(squad_open(&s, &f, 1 + n % 8, WORKERS_ANY_CPU));
    if (n % 3 != 0) workers_tick(&s.t, &fixture_idle, &out);
    if (n % 5 == 0) pause_ms(3);
    squad_close(&s);
  }
}

static void pins_and_unpins(void) {
  fixture_scoped f = {0};
  squad s;
  cpu_set_t before, now;
  fixture_hanging(&f, 16, 16, 2, "0 s", "0 %", "0 /s");
  CHECK(sched_getaffinity(0, sizeof before, &before) == 0);
  const uint32_t cpus = workers_cpus();
  if (cpus >= 2) {
    CHECK(squad_open(&s, &f, 2, 0));
    CHECK_EQ_INT(workers_cpus(), 1);
    squad_close(&s);
    CHECK(sched_getaffinity(0, sizeof now, &now) == 0 && CPU_EQUAL(&before, &now));
  }
  if (cpus < FRAY_WORKERS_MAX) {
    CHECK(!squad_open(&s, &f, FRAY_WORKERS_MAX, 0));
    free(s.memory);
    fixture_close(&s.f);
    CHECK(sched_getaffinity(0, sizeof now, &now) == 0 && CPU_EQUAL(&before, &now));
  }
}

static void chooses_by_size(void) {
  fixture_scoped f = {0};
  fixture_hanging(&f, 12, 12, 2, "0 s", "0 %", "0 /s");
  CHECK_EQ_INT(workers_count(f.w, 0), 1);
  CHECK_EQ_INT(workers_count(f.w, 3), 3);
  fixture_close(&f);
  fixture_hanging(&f, 160, 80, 4, "0 s", "0 %", "0 /s");
  CHECK_EQ_INT(workers_count(f.w, 0), workers_cpus() < 4 ? workers_cpus() : 4);
}

int main(void) {
  TEST(any_number_of_workers);
  TEST(starts_once_and_allocates_nothing);
  TEST(opens_and_closes);
  TEST(pins_and_unpins);
  TEST(chooses_by_size);
  return test_end();
}
