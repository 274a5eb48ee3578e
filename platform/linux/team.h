/* SPDX-License-Identifier: Apache-2.0 */
/* Threads that share the ticks of one world (rt/fray.h, "one tick by several workers"). The caller is
 * worker 0. The others are started once and sleep between ticks after a short while of looking.
 * Nothing is allocated in a tick. */
#ifndef FRAY_LINUX_TEAM_H
#define FRAY_LINUX_TEAM_H

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

#include "rt/fray.h"

enum { TEAM_LINE = 64, TEAM_ANY_CPU = -1 };

typedef struct team team;

typedef struct {
  _Alignas(TEAM_LINE) _Atomic uint32_t done; /* steps since the team was opened; wraps */
  team *of;
  uint32_t number;
  pthread_t thread;
} team_worker;

struct team {
  fray_world *world;
  fray_share *share;          /* NULL: one worker, fray_tick() */
  uint32_t workers, steps;
  uint32_t started;           /* threads that run */
  uint32_t looks;             /* before a worker lets others run */
  uint32_t base;              /* steps of the ticks before */
  _Atomic uint32_t sleepers;
  _Atomic int stop;
  cpu_set_t before;           /* where the caller ran before it was pinned */
  int pinned;
  pthread_mutex_t lock;
  pthread_cond_t moved;
  team_worker worker[FRAY_WORKERS_MAX];
};

/* CPUs that this process may use. */
uint32_t team_cpus(void);

/* How many of `workers` to open a team of: 0 asks for as many as this machine's free CPUs and the
 * world's size are good for. */
uint32_t team_size(const fray_world *world, uint32_t workers);

/* Bytes of memory for a team of so many; 0 for one. */
size_t team_bytes(const fray_world *world, uint32_t workers);

/* Starts workers - 1 threads, which inherit the caller's scheduling and take no signals. Worker n is
 * pinned to the n-th CPU from `cpu` on, of those that the process may use; with TEAM_ANY_CPU nobody is.
 * Memory is aligned to FRAY_SHARE_ALIGN. Memory and world stay the caller's and must outlive the team.
 * Returns 1, or 0: no thread runs then, for want of memory, threads or CPUs. */
int team_open(team *t, fray_world *world, uint32_t workers, int cpu, void *memory, size_t bytes);

/* As fray_tick(), from the thread that opened the team. */
void team_tick(team *t, const fray_input *input, fray_output *output);

/* Ends the threads, and unpins the caller. */
void team_close(team *t);

#endif
