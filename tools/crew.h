/* SPDX-License-Identifier: Apache-2.0 */
/* --workers N: a world, and the team that steps it with the memory that it needs. */
#ifndef FRAY_TOOLS_CREW_H
#define FRAY_TOOLS_CREW_H

#include "platform/linux/team.h"

typedef struct {
  team team;
  void *memory;
} crew;

/* Zeros for a structure with a crew in it, aligned as threads want it; NULL: no memory. free() it. */
void *crew_room(size_t bytes);

/* `workers` as in team_size(), `cpu` as in team_open(). Returns 1, or 0 after a message to stderr. */
int crew_open(crew *c, fray_world *world, uint32_t workers, int cpu);
void crew_close(crew *c);

#endif
