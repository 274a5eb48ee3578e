/* SPDX-License-Identifier: Apache-2.0 */
#define _GNU_SOURCE

#include "platform/linux/workers.h"

#include <string.h>

#include "platform/linux/thread.h"

#ifndef WORKERS_STACK
#define WORKERS_STACK (1 << 17) /* kernels that a compiler does not optimise take more */
#endif

/* A dependency is tested so often, some 20 ns each; then so often after sched_yield(); then the worker
 * sleeps. */
enum { SPINS = 2000, YIELDS = 20 };

static void pause_cpu(void) {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  __asm__ volatile("yield");
#endif
}

static int has_done(workers_thread *w, uint32_t steps) {
  return (int32_t)(atomic_load_explicit(&w->done, memory_order_acquire) - steps) >= 0;
}

static int is_over(workers_thread *w, uint32_t steps, workers_group *g) {
  return has_done(w, steps) || atomic_load_explicit(&g->stop, memory_order_relaxed);
}

/* No wake-up is lost: publish() stores its progress, then reads `sleepers`; a sleeper adds itself to
 * `sleepers`, then reads the progress. One of the two sees the other. */
static void sleep_until(workers_group *g, workers_thread *w, uint32_t steps) {
  (void)pthread_mutex_lock(&g->lock);
  atomic_fetch_add(&g->sleepers, 1);
  while ((int32_t)(atomic_load(&w->done) - steps) < 0 && !atomic_load(&g->stop))
    (void)pthread_cond_wait(&g->progress, &g->lock);
  atomic_fetch_sub(&g->sleepers, 1);
  (void)pthread_mutex_unlock(&g->lock);
}

static void wait_until(workers_group *g, workers_thread *w, uint32_t steps) {
  for (uint32_t n = 0; n < g->spins; ++n) {
    if (is_over(w, steps, g)) return;
    pause_cpu();
  }
  for (uint32_t n = 0; n < YIELDS; ++n) {
    if (is_over(w, steps, g)) return;
    (void)sched_yield();
  }
  sleep_until(g, w, steps);
}

static void wake(workers_group *g) {
  (void)pthread_mutex_lock(&g->lock);
  (void)pthread_cond_broadcast(&g->progress);
  (void)pthread_mutex_unlock(&g->lock);
}

static void publish(workers_group *g, workers_thread *w, uint32_t steps) {
  atomic_store(&w->done, steps);
  if (atomic_load(&g->sleepers) != 0) wake(g);
}

static void await_dependency(workers_group *g, const workers_thread *own, fray_dependency need,
                             uint32_t base) {
  if (need.steps == 0) return;
  if (need.worker != FRAY_ALL_WORKERS) {
    wait_until(g, &g->worker[need.worker], base + need.steps);
    return;
  }
  for (uint32_t n = 0; n < g->count; ++n)
    if (n != own->number) wait_until(g, &g->worker[n], base + need.steps);
}

static void run_tick(workers_thread *w, uint32_t base, const fray_input *input, fray_output *output) {
  workers_group *g = w->group;
  for (uint32_t n = 0; n < g->steps; ++n) {
    await_dependency(g, w, fray_parallel_dependency(g->parallel, w->number, n), base);
    if (atomic_load_explicit(&g->stop, memory_order_relaxed)) return;
    fray_parallel_step(g->parallel, w->number, n, input, output);
    publish(g, w, base + n + 1u);
  }
}

/* For the other workers a tick begins when worker 0 has done its first step. */
static void *run_worker(void *context) {
  workers_thread *w = context;
  for (uint32_t base = 0; !atomic_load(&w->group->stop); base += w->group->steps)
    run_tick(w, base, NULL, NULL);
  return NULL;
}

uint32_t workers_cpus(void) {
  cpu_set_t set;
  return sched_getaffinity(0, sizeof set, &set) == 0 ? (uint32_t)CPU_COUNT(&set) : 1u;
}

static int pin(pthread_t thread, const cpu_set_t *set, int cpu, uint32_t n) {
  cpu_set_t one;
  CPU_ZERO(&one);
  for (uint32_t seen = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (!CPU_ISSET((unsigned)cpu, set) || seen++ != n) continue;
    CPU_SET((unsigned)cpu, &one);
    return pthread_setaffinity_np(thread, sizeof one, &one) == 0;
  }
  return 0;
}

uint32_t workers_count(const fray_world *world, uint32_t workers) {
  if (workers == 0) return fray_parallel_useful(world, workers_cpus());
  return workers < FRAY_WORKERS_MAX ? workers : (uint32_t)FRAY_WORKERS_MAX;
}

size_t workers_memory_size(const fray_world *world, uint32_t workers) {
  return workers > 1 ? fray_parallel_memory_size(world, workers) : 0;
}

static int start_threads(workers_group *g) {
  for (g->started = 1; g->started < g->count; ++g->started) {
    workers_thread *w = &g->worker[g->started];
    if (!thread_start(&w->thread, WORKERS_STACK, run_worker, w)) break;
  }
  return g->started == g->count;
}

static int pin_all(workers_group *g, int cpu) {
  if (cpu == WORKERS_ANY_CPU) return 1;
  if (sched_getaffinity(0, sizeof g->caller_cpus, &g->caller_cpus) != 0) return 0;
  g->pinned = 1;
  int good = pin(pthread_self(), &g->caller_cpus, cpu, 0);
  for (uint32_t n = 1; n < g->count; ++n) good &= pin(g->worker[n].thread, &g->caller_cpus, cpu, n);
  return good;
}

int workers_open(workers_group *g, fray_world *world, uint32_t workers, int cpu, void *memory, size_t bytes) {
  memset(g, 0, sizeof *g);
  g->world = world;
  g->count = workers;
  if (workers <= 1) return 1;
  g->parallel = fray_parallel_open(world, workers, memory, bytes);
  if (g->parallel == NULL) return 0;
  g->steps = fray_parallel_steps(g->parallel);
  g->spins = workers_cpus() < workers ? 0 : SPINS; /* the worker that is waited for may need this very CPU */
  (void)pthread_mutex_init(&g->lock, NULL);
  (void)pthread_cond_init(&g->progress, NULL);
  for (uint32_t n = 0; n < workers; ++n) {
    g->worker[n].group = g;
    g->worker[n].number = n;
  }
  if (start_threads(g) && pin_all(g, cpu)) return 1;
  workers_close(g);
  return 0;
}

void workers_tick(workers_group *g, const fray_input *input, fray_output *output) {
  if (g->parallel == NULL) {
    fray_tick(g->world, input, output);
    return;
  }
  run_tick(&g->worker[0], g->base, input, output);
  g->base += g->steps;
}

void workers_close(workers_group *g) {
  if (g->parallel == NULL) return;
  atomic_store(&g->stop, 1);
  wake(g);
  for (uint32_t n = 1; n < g->started; ++n) (void)pthread_join(g->worker[n].thread, NULL);
  if (g->pinned) (void)pthread_setaffinity_np(pthread_self(), sizeof g->caller_cpus, &g->caller_cpus);
  (void)pthread_cond_destroy(&g->progress);
  (void)pthread_mutex_destroy(&g->lock);
  g->parallel = NULL;
}
