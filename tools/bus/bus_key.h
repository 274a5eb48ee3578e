/* SPDX-License-Identifier: Apache-2.0 */
/* --key, --classic-tags and --freshness: one end of an authenticated live bus. */
#ifndef FRAY_TOOLS_BUS_BUS_KEY_H
#define FRAY_TOOLS_BUS_BUS_KEY_H

#include <stdio.h>

#include "platform/linux/freshness.h"
#include "rt/wire/auth_gate.h"

typedef struct {
  const char *file;      /* of the key; NULL: the bus is plain */
  const char *freshness; /* NULL: not stored */
  int classic_tags;      /* TAGs on classic CAN instead of CAN FD */
} bus_key_options;

typedef struct {
  cmac_key key;
  auth_gate g;
  freshness store;
  int stored; /* it is stored */
  int fault;  /* errno of a failed bus_key_tick(), 0: none */
} bus_key;

/* Checks the combination of options; 0 after a message to stderr. `live`: with --can. */
int bus_key_check(const char *verb, const bus_key_options *o, int live);

/* The key alone; 0 after a message to stderr. */
int bus_key_read(const char *file, cmac_key *key);

/* Reads the key, sets up the gate and its freshness, and notes on stderr the effect of a restart.
 * Before the process turns real-time. Returns 1, or 0 after a message to stderr. */
int bus_key_open(bus_key *k, const bus_key_options *o, auth_gate_end end, uint32_t instance,
                 uint32_t hands);

/* Once a tick. Returns 0 iff the freshness could not be stored, then always: stop. */
int bus_key_tick(bus_key *k);

/* Stores the freshness, wipes the key. Returns 0 after a message to stderr: that failed, now or in
 * bus_key_tick(). */
int bus_key_close(bus_key *k);

/* Why all frames of the other end are refused, as a phrase; NULL: no sign of that. */
const char *bus_key_complaint(const bus_key *k);

/* Counts of valid and refused frames of each lane. */
void bus_key_print(const bus_key *k, FILE *out);

#endif
