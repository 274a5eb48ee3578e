/* SPDX-License-Identifier: Apache-2.0 */
/* --key, --classic-tags and --freshness: one end of a live bus under a key, set up and taken down. */
#ifndef FRAY_TOOLS_BUS_KEY_H
#define FRAY_TOOLS_BUS_KEY_H

#include <stdio.h>

#include "platform/linux/freshness.h"
#include "rt/wire/guard.h"

typedef struct {
  const char *file;      /* of the key; NULL: the bus is plain */
  const char *freshness; /* NULL: nothing is kept */
  int classic_tags;      /* TAGs on classic CAN instead of CAN FD */
} bus_key_options;

typedef struct {
  cmac_key key;
  guard g;
  freshness store;
  int stored; /* there is a store */
  int fault;  /* errno for which bus_key_tick() said stop, 0: none */
} bus_key;

/* Whether the options go together; 0 after a message to stderr. `live`: --can was given. */
int bus_key_check(const char *verb, const bus_key_options *o, int live);

/* The key alone; 0 after a message to stderr. */
int bus_key_read(const char *file, cmac_key *key);

/* Reads the key, sets up the guard and its freshness, and says on stderr what a restart will mean.
 * Call it before the process becomes a real-time one. Returns 1, or 0 after a message to stderr. */
int bus_key_open(bus_key *k, const bus_key_options *o, guard_end end, uint32_t instance,
                 uint32_t hands);

/* Once a tick. Returns 0 iff the freshness could not be stored: stop, and it stays at that. */
int bus_key_tick(bus_key *k);

/* Stores the freshness, wipes the key. Returns 0 after a message to stderr: that failed, or it was
 * why bus_key_tick() said stop. */
int bus_key_close(bus_key *k);

/* Why nothing of the other end is used, as a phrase; NULL while there is no sign of that. */
const char *bus_key_complaint(const bus_key *k);

/* What became of the frames of each lane. */
void bus_key_print(const bus_key *k, FILE *out);

#endif
