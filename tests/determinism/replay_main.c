/* SPDX-License-Identifier: Apache-2.0 */
/* Replays every case and prints, for every tick, the hash of the state and a digest of all that
 * the tick put out. No libc but what the port brings. For each case:
 *
 *   case NAME
 *   memory BYTES                 of this build; may differ between machines
 *   TICK HASH OUTPUTS            after every tick: decimal, 16 digits, 8 digits
 *   saved BYTES CRC              of the image that fray_save() writes at the end
 *   restored same                a second run, saved and opened again every 64 ticks, put out the
 *                                same in every tick; else the first tick that differs
 *
 * Worlds are run by REPLAY_KERNEL, the scalar code unless told; where the build lacks it they count
 * as refused. For want of memory the second run is saved once, where REPLAY_SAVED_IMAGES is 1; for want of time
 * it is left out, where REPLAY_RESTORED is 0. */
#include "rt/base/bytes.h"
#include "tests/determinism/line.h"

#ifndef REPLAY_MEMORY
#define REPLAY_MEMORY 163840 /* of a world */
#endif
#ifndef REPLAY_SAVED
#define REPLAY_SAVED 65536 /* of an image */
#endif
#ifndef REPLAY_SAVED_IMAGES
#define REPLAY_SAVED_IMAGES 2
#endif
#ifndef REPLAY_RESTORED
#define REPLAY_RESTORED 1
#endif
#ifndef REPLAY_KERNEL
#define REPLAY_KERNEL FRAY_KERNEL_SCALAR
#endif
enum { SAVE_EVERY = 64, SPANS = 32 };

_Alignas(16) static uint8_t memory[REPLAY_MEMORY];
_Alignas(16) static uint8_t saved[REPLAY_SAVED_IMAGES][REPLAY_SAVED];

/* Field by field, so that padding and byte order cannot enter. */
static uint32_t digest(uint32_t digest_before, uint32_t word) {
  uint32_t d = digest_before;
  for (uint32_t n = 0; n < 4; ++n) d = (uint32_t)((uint64_t)(d ^ (word >> 8 * n & 255u)) * 16777619u & 0xFFFFFFFFu);
  return d;
}
static uint32_t digest_outputs(const fray_output *o) {
  const fray_work *w = &o->work;
  const uint32_t words[] = {(uint32_t)(o->tick & UINT32_MAX), o->consumed[0], o->consumed[1], o->state,
                            o->answered,       o->answer_counter, o->result,      o->faults,
                            o->tears_waiting, w->tears != 0 ? o->first_tear : 0u, o->tears_total,
                            w->particle_steps, w->projections, w->springs,     w->contacts,
                            w->tear_tests,  w->tears};
  uint32_t d = 2166136261u;
  for (uint32_t n = 0; n < sizeof words / sizeof words[0]; ++n) d = digest(d, words[n]);
  const uint32_t yarns[] = {o->splits_waiting, o->crossings_connected, o->crossings_loose,
                            o->crossings_disconnected, w->transitions, w->splits, w->slips};
  for (uint32_t n = 0; n < sizeof yarns / sizeof yarns[0] && w->transitions != 0; ++n)
    d = digest(d, yarns[n]);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    for (uint32_t n = 0; n < 3; ++n) {
      d = digest(d, (uint32_t)o->force[h][n]);
      d = digest(d, (uint32_t)o->force_unlimited[h][n]);
    }
  return d;
}

/* What a run put out: the digest of every span of SAVE_EVERY ticks, and of its image at the end. */
typedef struct {
  uint32_t span[SPANS];
  uint32_t saved_bytes, saved_crc;
} trace;

static void trace_tick(trace *t, uint32_t tick, const fray_output *out, uint32_t outputs) {
  uint32_t *span = &t->span[tick / SAVE_EVERY % SPANS];
  *span = digest(*span, outputs);
  *span = digest(*span, (uint32_t)(out->hash & 0xFFFFFFFFu));
  *span = digest(*span, (uint32_t)(out->hash >> 32));
}
static void trace_saved(trace *t, const fray_world *world, uint32_t at) {
  t->saved_bytes = (uint32_t)fray_save(world, saved[at], REPLAY_SAVED);
  t->saved_crc = bytes_crc32(saved[at], t->saved_bytes);
}

static fray_world *open_world(const uint8_t *image, uint32_t bytes) {
  size_t needed = 0;
  fray_world *world = 0;
  if (fray_memory_size(image, bytes, &needed, 0) != FRAY_OK || needed > REPLAY_MEMORY) return 0;
  if (fray_open(image, bytes, memory, REPLAY_MEMORY, &world, 0) != FRAY_OK) return 0;
  return fray_set_kernel(world, REPLAY_KERNEL) ? world : 0;
}

static const fray_input *input_of(const replay_case *c, uint32_t tick) {
  static const fray_input nothing;
  return tick < c->input_count ? &c->inputs[tick] : &nothing;
}

static void replay(const replay_case *c, fray_world *world, trace *t) {
  line l = {{0}, 0};
  fray_output out;
  for (uint32_t tick = 0; tick < c->ticks; ++tick) {
    fray_tick(world, input_of(c, tick), &out);
    const uint32_t outputs = digest_outputs(&out);
    trace_tick(t, tick, &out, outputs);
    add_number(&l, tick);
    add_text(&l, " ");
    add_hex(&l, out.hash, 16);
    add_text(&l, " ");
    add_hex(&l, outputs, 8);
    print_line(&l);
  }
  trace_saved(t, world, 0);
  add_text(&l, "saved ");
  add_number(&l, t->saved_bytes);
  add_text(&l, " ");
  add_hex(&l, t->saved_crc, 8);
  print_line(&l);
}

static int time_to_save(const replay_case *c, uint32_t tick) {
  if (REPLAY_SAVED_IMAGES == 1) return tick == c->ticks / 2u;
  return tick % SAVE_EVERY == SAVE_EVERY - 1u;
}

/* The same ticks, in worlds that are saved and opened again. An image stays where it is as long as
 * its world lives, so the next one is saved beside it. */
static int replay_restored(const replay_case *c, trace *t) {
  fray_world *world = open_world(c->image, c->image_bytes);
  uint32_t at = 0;
  fray_output out;
  for (uint32_t tick = 0; tick < c->ticks && world != 0; ++tick) {
    fray_tick(world, input_of(c, tick), &out);
    trace_tick(t, tick, &out, digest_outputs(&out));
    if (!time_to_save(c, tick)) continue;
    const uint32_t bytes = (uint32_t)fray_save(world, saved[at], REPLAY_SAVED);
    world = open_world(saved[at], bytes);
    at = (at + 1u) % REPLAY_SAVED_IMAGES;
  }
  if (world != 0 && REPLAY_SAVED_IMAGES > 1) trace_saved(t, world, at);
  return world != 0;
}

static int print_restored(const trace *first, const trace *second) {
  line l = {{0}, 0};
  uint32_t span = 0;
  while (span < SPANS && first->span[span] == second->span[span]) ++span;
  const int same_image =
      first->saved_bytes == second->saved_bytes && first->saved_crc == second->saved_crc;
  if (span < SPANS) {
    add_text(&l, "restored differs in or after tick ");
    add_number(&l, span * SAVE_EVERY);
  } else {
    add_text(&l, same_image ? "restored same" : "restored differs in the image at the end");
  }
  print_line(&l);
  return span == SPANS && same_image;
}

/* Not inline: its line would stay on the stack while the world runs. */
__attribute__((noinline)) static void announce(const replay_case *c, const fray_world *world) {
  line l = {{0}, 0};
  size_t needed = 0;
  add_text(&l, "case ");
  add_text(&l, c->name);
  print_line(&l);
  if (world == 0) {
    port_print("refused\n");
    return;
  }
  (void)fray_memory_size(c->image, c->image_bytes, &needed, 0);
  add_text(&l, "memory ");
  add_number(&l, (uint32_t)needed);
  print_line(&l);
}

static int run_case(const replay_case *c) {
  trace first = {{0}, 0, 0}, second = {{0}, 0, 0};
  fray_world *world = open_world(c->image, c->image_bytes);
  announce(c, world);
  if (world == 0) return 0;
  replay(c, world, &first);
  if (!REPLAY_RESTORED) {
    port_print("restored not run\n");
    return 1;
  }
  second = first;
  for (uint32_t n = 0; n < SPANS; ++n) second.span[n] = 0;
  if (!replay_restored(c, &second)) {
    port_print("restored refused\n");
    return 0;
  }
  return print_restored(&first, &second);
}

int main(void) {
  int good = 1;
  for (uint32_t n = 0; n < replay_case_count; ++n) good = run_case(&replay_cases[n]) && good;
  port_print("end\n");
  return good ? 0 : 1;
}
