/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/crew.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void *crew_room(size_t bytes) {
  void *room = aligned_alloc(_Alignof(crew), bytes);
  if (room != NULL) memset(room, 0, bytes);
  return room;
}

int crew_open(crew *c, fray_world *world, uint32_t workers, int cpu) {
  const uint32_t count = team_size(world, workers);
  const size_t bytes = (team_bytes(world, count) + FRAY_SHARE_ALIGN - 1) / FRAY_SHARE_ALIGN * FRAY_SHARE_ALIGN;
  c->memory = bytes != 0 ? aligned_alloc(FRAY_SHARE_ALIGN, bytes) : NULL;
  if (team_open(&c->team, world, count, cpu, c->memory, bytes)) return 1;
  fprintf(stderr, "--workers %u: cannot be started, expected memory, threads and CPUs for so many\n", count);
  free(c->memory);
  c->memory = NULL;
  return 0;
}

void crew_close(crew *c) {
  team_close(&c->team);
  free(c->memory);
  c->memory = NULL;
}
