/* SPDX-License-Identifier: Apache-2.0 */
/* Threads that compute the ticks of one world together (rt/fray.h, "one tick by several workers"). The
 * caller is worker 0. The other threads start once; between ticks they look for work for a short while,
 * then sleep. Nothing is allocated in a tick.
 *
 * Context: one thread opens, ticks and closes a group. NULL: never, but for `memory` of no bytes. */
#ifndef FRAY_PLATFORM_LINUX_WORKERS_H
#define FRAY_PLATFORM_LINUX_WORKERS_H

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

#include "rt/fray.h"

enum { WORKERS_LINE = 64, WORKERS_ANY_CPU = -1 };

typedef struct workers_group workers_group;

typedef struct {
  _Alignas(WORKERS_LINE) _Atomic uint32_t done; /* steps since the group was opened; wraps */
  workers_group *group;
  uint32_t number; /* 0 is the caller */
  pthread_t thread;
} workers_thread;

struct workers_group {
  fray_world *world;
  fray_parallel *parallel; /* NULL: one worker, fray_tick() */
  uint32_t count, steps;   /* workers; steps of one of them in a tick */
  uint32_t started;        /* threads that run, the caller among them */
  uint32_t spins;          /* tests of a dependency before a worker yields its CPU */
  uint32_t base;           /* steps of all ticks before this one */
  _Atomic uint32_t sleepers;
  _Atomic int stop;
  cpu_set_t caller_cpus; /* before the caller was pinned */
  int pinned;
  pthread_mutex_t lock;
  pthread_cond_t progress;
  workers_thread worker[FRAY_WORKERS_MAX];
};

/* CPUs that this process may use. Cost: a system call. */
uint32_t workers_cpus(void);

/* The number of workers to open a group of. workers: as asked for; 0: as many as the CPUs of this process
 * and the size of the world are good for. At most FRAY_WORKERS_MAX. Cost: a system call. */
uint32_t workers_count(const fray_world *world, uint32_t workers);

/* Bytes of memory for a group. workers: 1 to FRAY_WORKERS_MAX; 0 bytes for one. Cost: constant. */
size_t workers_memory_size(const fray_world *world, uint32_t workers);

/* Starts workers - 1 threads, which inherit the caller's scheduling and take no signals. workers: 1 to
 * FRAY_WORKERS_MAX. Worker n is pinned to the n-th CPU from `cpu` on, of those that the process may use;
 * with WORKERS_ANY_CPU none is. Memory is aligned to FRAY_PARALLEL_ALIGN; memory and world stay the
 * caller's and must outlive the group. Returns 1, or 0 for want of memory, threads or CPUs; no thread runs
 * then. Cost: linear in the structural springs, and the threads. */
int workers_open(workers_group *g, fray_world *world, uint32_t workers, int cpu, void *memory, size_t bytes);

/* As fray_tick(), from the thread that opened the group. */
void workers_tick(workers_group *g, const fray_input *input, fray_output *output);

/* Ends the threads and unpins the caller. Cost: the end of a tick. */
void workers_close(workers_group *g);

#endif
