/* SPDX-License-Identifier: Apache-2.0 */
/* Replays every case and prints, for every tick, the hash of the state and a digest of all that
 * the tick put out. No libc but what the port brings. For each case:
 *
 *   case NAME
 *   memory BYTES                 of this build; may differ between machines
 *   TICK HASH OUTPUTS            after every tick: decimal, 16 digits, 8 digits
 *   saved BYTES CRC              of the image that fray_save() writes at the end
 *   restored same                a second run, saved and opened again every 64 ticks */
#include "tests/cross/cases.h"

#include "rt/base/bytes.h"

#ifndef CROSS_MEMORY
#define CROSS_MEMORY 65536
#endif
enum { LINE = 64, SAVE_EVERY = 64 };

_Alignas(16) static uint8_t memory[2][CROSS_MEMORY];
_Alignas(16) static uint8_t saved[2][CROSS_MEMORY];

typedef struct {
  char text[LINE];
  uint32_t length;
} line;

static void add_text(line *l, const char *text) {
  while (*text != 0 && l->length < LINE - 2u) l->text[l->length++] = *text++;
}
static void add_hex(line *l, uint64_t v, uint32_t digits) {
  char text[17];
  for (uint32_t n = 0; n < digits; ++n) text[n] = "0123456789abcdef"[v >> 4u * (digits - 1u - n) & 15u];
  text[digits] = 0;
  add_text(l, text);
}
static void add_number(line *l, uint32_t v) {
  char text[11];
  uint32_t at = 10;
  text[at] = 0;
  do {
    text[--at] = (char)('0' + v % 10u);
    v /= 10u;
  } while (v != 0);
  add_text(l, text + at);
}
static void print_line(line *l) {
  l->text[l->length++] = '\n';
  l->text[l->length] = 0;
  port_print(l->text);
  l->length = 0;
}

/* Field by field, so that padding and byte order cannot enter. */
static uint32_t digest(uint32_t digest_before, uint32_t word) {
  uint32_t d = digest_before;
  for (uint32_t n = 0; n < 4; ++n) d = (uint32_t)((uint64_t)(d ^ (word >> 8 * n & 255u)) * 16777619u & 0xFFFFFFFFu);
  return d;
}
static uint32_t digest_outputs(const fray_output *o) {
  const fray_work *w = &o->work;
  const uint32_t words[] = {o->tick,        o->consumed[0], o->consumed[1], o->state,
                            o->acked,       o->ack_counter, o->result,      o->faults,
                            o->cuts_waiting, w->cuts != 0 ? o->cut_first : 0u, o->cuts_total,
                            w->predictions, w->projections, w->springs,     w->contacts,
                            w->tear_tests,  w->cuts};
  uint32_t d = 2166136261u;
  for (uint32_t n = 0; n < sizeof words / sizeof words[0]; ++n) d = digest(d, words[n]);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    for (uint32_t n = 0; n < 3; ++n) {
      d = digest(d, (uint32_t)o->force[h][n]);
      d = digest(d, (uint32_t)o->raw[h][n]);
    }
  return d;
}

static fray_world *open_world(const uint8_t *image, uint32_t bytes, uint32_t at) {
  size_t needed = 0;
  fray_world *world = 0;
  if (fray_bytes(image, bytes, &needed, 0) != FRAY_OK || needed > CROSS_MEMORY) return 0;
  if (fray_open(image, bytes, memory[at], CROSS_MEMORY, &world, 0) != FRAY_OK) return 0;
  return world;
}

static const fray_input *input_of(const cross_case *c, uint32_t tick) {
  static const fray_input nothing;
  return tick < c->input_count ? &c->inputs[tick] : &nothing;
}

static void print_saved(const fray_world *world) {
  line l = {{0}, 0};
  const size_t bytes = fray_save(world, saved[0], CROSS_MEMORY);
  add_text(&l, "saved ");
  add_number(&l, (uint32_t)bytes);
  add_text(&l, " ");
  add_hex(&l, bytes_crc32(saved[0], bytes), 8);
  print_line(&l);
}

/* Prints every tick; returns the last hash. */
static uint64_t replay(const cross_case *c, fray_world *world) {
  fray_output out;
  out.hash = fray_hash(world);
  for (uint32_t tick = 0; tick < c->ticks; ++tick) {
    line l = {{0}, 0};
    fray_tick(world, input_of(c, tick), &out);
    add_number(&l, tick);
    add_text(&l, " ");
    add_hex(&l, out.hash, 16);
    add_text(&l, " ");
    add_hex(&l, digest_outputs(&out), 8);
    print_line(&l);
  }
  print_saved(world);
  return out.hash;
}

/* The same ticks, in worlds that live for SAVE_EVERY ticks each; returns the last hash. */
static uint64_t replay_restored(const cross_case *c) {
  const uint8_t *image = c->image;
  uint32_t bytes = c->image_bytes;
  fray_world *world = open_world(image, bytes, 0);
  fray_output out;
  out.hash = 0;
  for (uint32_t tick = 0; tick < c->ticks && world != 0; ++tick) {
    fray_tick(world, input_of(c, tick), &out);
    if (tick % SAVE_EVERY != SAVE_EVERY - 1u) continue;
    const uint32_t at = tick / SAVE_EVERY & 1u;
    bytes = (uint32_t)fray_save(world, saved[at], CROSS_MEMORY);
    world = open_world(saved[at], bytes, 1u - at);
  }
  return out.hash;
}

static int run_case(const cross_case *c) {
  line l = {{0}, 0};
  size_t needed = 0;
  add_text(&l, "case ");
  add_text(&l, c->name);
  print_line(&l);
  fray_world *world = open_world(c->image, c->image_bytes, 0);
  if (world == 0) {
    port_print("refused\n");
    return 0;
  }
  (void)fray_bytes(c->image, c->image_bytes, &needed, 0);
  add_text(&l, "memory ");
  add_number(&l, (uint32_t)needed);
  print_line(&l);
  const uint64_t last = replay(c, world);
  const int same = replay_restored(c) == last;
  port_print(same ? "restored same\n" : "restored differs\n");
  return same;
}

int main(void) {
  int good = 1;
  for (uint32_t n = 0; n < cross_case_count; ++n) good = run_case(&cross_cases[n]) && good;
  port_print("end\n");
  return good ? 0 : 1;
}
