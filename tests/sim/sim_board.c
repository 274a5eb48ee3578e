/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/sim/sim_board.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "platform/log/candump.h"
#include "rt/wire/codec.h"
#include "rt/wire/dictionary.h"

enum { START_US = 1000000, CONFIRM_US = 60 };

sim_board sim;

void sim_begin(uint32_t rate_hz) {
  sim_entry *const entries = sim.entries; /* kept from session to session */
  const size_t capacity = sim.capacity;
  memset(&sim, 0, sizeof sim);
  sim.entries = entries;
  sim.capacity = capacity;
  sim.period_us = 1000000 / (int64_t)rate_hz;
  sim.now_us = START_US;
  sim.grid_us = START_US;
}

void sim_end(void) {
  free(sim.entries);
  memset(&sim, 0, sizeof sim);
}

static void add(const frame *f, int own, int failed) {
  if (sim.count == sim.capacity) {
    sim.capacity = sim.capacity == 0 ? 4096 : sim.capacity * 2;
    sim.entries = realloc(sim.entries, sim.capacity * sizeof *sim.entries);
    if (sim.entries == NULL) abort();
  }
  sim_entry *e = &sim.entries[sim.count++];
  e->f = *f;
  e->time_us = sim.now_us;
  e->own = (uint8_t)own;
  e->failed = (uint8_t)failed;
}

void sim_inject(const frame *f) { add(f, 0, 0); }

void sim_pose(uint32_t hand, uint8_t counter, int16_t x, int16_t y, int16_t z) {
  frame f;
  const fray_pose pose = {x, y, z, (uint8_t)(counter & 15u), 0};
  codec_encode_pose(&f, 0, hand, &pose);
  sim_inject(&f);
}

void sim_command(uint8_t counter, uint8_t verb) {
  frame f;
  const codec_command command = {(uint8_t)(counter & 15u), verb, 0};
  codec_encode_command(&f, 0, &command);
  sim_inject(&f);
}

/* Like the real one: a grid that stays, missed ticks are not caught up. */
int32_t platform_wait(void) {
  if (sim.stop) return -1;
  const int64_t behind = (sim.now_us - sim.grid_us) / sim.period_us;
  sim.grid_us += (behind > 0 ? behind : 1) * sim.period_us;
  if (sim.now_us < sim.grid_us) sim.now_us = sim.grid_us;
  return behind > 1 ? (int32_t)(behind - 1) : 0;
}

static void hand_over(port *p) {
  for (; sim.taken < sim.count; ++sim.taken)
    if (!sim.entries[sim.taken].own) port_push(p, &sim.entries[sim.taken].f);
}

platform_result platform_sync(const frame *sync, port *p) {
  hand_over(p);
  if (sim.sync_fails > 0) {
    --sim.sync_fails;
    add(sync, 1, !sim.sync_seen);
    sim.now_us += PLATFORM_CONFIRM_US;
    return PLATFORM_LOST;
  }
  sim.now_us += CONFIRM_US;
  add(sync, 1, 0);
  return PLATFORM_SENT;
}

platform_result platform_send(const frame *f) {
  const int failed = sim.send_fails > 0;
  if (failed) --sim.send_fails;
  add(f, 1, failed);
  return failed ? PLATFORM_LOST : PLATFORM_SENT;
}

size_t sim_own(size_t from, uint32_t id, int failed) {
  size_t count = 0;
  for (size_t n = from; n < sim.count; ++n)
    count += sim.entries[n].own && sim.entries[n].failed == failed && sim.entries[n].f.id == id;
  return count;
}

char *sim_log(size_t *bytes) {
  char *text = malloc(sim.count * CANDUMP_TEXT + 1);
  if (text == NULL) abort();
  *bytes = 0;
  text[0] = 0;
  for (size_t n = 0; n < sim.count; ++n)
    if (!sim.entries[n].failed)
      *bytes += candump_format(text + *bytes, "sim0", sim.entries[n].time_us, &sim.entries[n].f);
  return text;
}
