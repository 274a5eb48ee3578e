/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/world/world_workers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void *world_workers_alloc(size_t bytes) {
  void *room = aligned_alloc(_Alignof(world_workers), bytes);
  if (room != NULL) memset(room, 0, bytes);
  return room;
}

int world_workers_open(world_workers *c, fray_world *world, uint32_t workers, int cpu) {
  const uint32_t count = workers_count(world, workers);
  const size_t bytes = (workers_memory_size(world, count) + FRAY_PARALLEL_ALIGN - 1) / FRAY_PARALLEL_ALIGN *
                       FRAY_PARALLEL_ALIGN;
  c->memory = bytes != 0 ? aligned_alloc(FRAY_PARALLEL_ALIGN, bytes) : NULL;
  if (workers_open(&c->group, world, count, cpu, c->memory, bytes)) return 1;
  fprintf(stderr, "--workers %u: cannot be started, expected memory, threads and CPUs for them\n", count);
  free(c->memory);
  c->memory = NULL;
  return 0;
}

void world_workers_close(world_workers *c) {
  workers_close(&c->group);
  free(c->memory);
  c->memory = NULL;
}
