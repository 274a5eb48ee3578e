/* SPDX-License-Identifier: Apache-2.0 */
/* --workers N: the threads that step a world, with their memory. */
#ifndef FRAY_TOOLS_WORLD_WORLD_WORKERS_H
#define FRAY_TOOLS_WORLD_WORLD_WORKERS_H

#include "platform/linux/workers.h"

typedef struct {
  workers_group group;
  void *memory;
} world_workers;

/* Zeroed memory for a structure with a world_workers in it, aligned for it; NULL: none. free() it. */
void *world_workers_alloc(size_t bytes);

/* `workers` as in workers_count(), `cpu` as in workers_open(). Returns 1, or 0 after a message to stderr. */
int world_workers_open(world_workers *c, fray_world *world, uint32_t workers, int cpu);
void world_workers_close(world_workers *c);

#endif
