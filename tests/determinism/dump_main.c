/* SPDX-License-Identifier: Apache-2.0 */
/* Prints every word of the state after one tick of one case, and what the tick put out: two
 * machines that part there are told apart by `diff`. Built with REPLAY_DUMP_CASE, REPLAY_DUMP_TICK. */
#include "rt/state/world.h"
#include "tests/determinism/line.h"

#ifndef REPLAY_MEMORY
#define REPLAY_MEMORY 131072
#endif
#ifndef REPLAY_KERNEL
#define REPLAY_KERNEL FRAY_KERNEL_SCALAR
#endif
_Alignas(16) static uint8_t memory[REPLAY_MEMORY];

static void print_word(const char *what, uint32_t index, const char *field, int32_t value) {
  line l = {{0}, 0};
  add_text(&l, what);
  add_text(&l, " ");
  add_number(&l, index);
  add_text(&l, " ");
  add_text(&l, field);
  add_text(&l, " ");
  add_hex(&l, (uint32_t)value, 8);
  print_line(&l);
}

static void print_state(const state *s) {
  const int32_t *words = (const int32_t *)(const void *)s;
  uint32_t n = 0;
#define X(name, least, most) print_word("state", n, #name, words[n]), ++n;
  STATE(X)
#undef X
}

static void print_particles(const fray_world *w) {
  static const char *const field[9] = {"x", "y", "z", "vx", "vy", "vz", "rx", "ry", "rz"};
  const int32_t *const words[6] = {w->p.x, w->p.y, w->p.z, w->p.vx, w->p.vy, w->p.vz};
  const int8_t *const rests[3] = {w->p.rx, w->p.ry, w->p.rz};
  for (uint32_t p = 0; p < (uint32_t)w->params->particles; ++p)
    for (uint32_t n = 0; n < 9; ++n)
      print_word("particle", p, field[n], n < 6 ? words[n][p] : rests[n - 6][p]);
}

static void print_bodies(const fray_world *w) {
  static const char *const field[3] = {"x", "y", "z"};
  for (uint32_t b = 0; b < w->capacity[POOL_BODIES]; ++b)
    for (uint32_t n = 0; n < 3; ++n) {
      print_word("body", b, field[n], w->rigid.states[b].position[n]);
      print_word("body remainder", b, field[n], w->rigid.states[b].remainder[n]);
      print_word("body velocity", b, field[n], w->rigid.states[b].velocity[n]);
      print_word("body fraction", b, field[n], w->rigid.states[b].fraction[n]);
    }
}

static void print_outputs(const fray_output *o) {
  static const char *const field[3] = {"x", "y", "z"};
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    print_word("hand", h, "consumed", o->consumed[h]);
    for (uint32_t n = 0; n < 3; ++n) {
      print_word("force", h, field[n], o->force[h][n]);
      print_word("raw force", h, field[n], o->force_unlimited[h][n]);
    }
  }
  print_word("output", 0, "state", o->state);
  print_word("output", 0, "acked", o->answered);
  print_word("output", 0, "result", o->result);
  print_word("output", 0, "faults", o->faults);
  print_word("output", 0, "cuts_waiting", (int32_t)o->tears_waiting);
  print_word("output", 0, "cut_first", (int32_t)o->first_tear);
  print_word("output", 0, "cuts_total", (int32_t)o->tears_total);
  print_word("work", 0, "contacts", (int32_t)o->work.contacts);
  print_word("work", 0, "cuts", (int32_t)o->work.tears);
}

static int is_wanted(const char *name) {
  const char *wanted = REPLAY_DUMP_CASE;
  while (*name != 0 && *name == *wanted) ++name, ++wanted;
  return *name == *wanted;
}

int main(void) {
  static const fray_input nothing;
  fray_world *world = 0;
  fray_output out;
  for (uint32_t n = 0; n < replay_case_count; ++n) {
    const replay_case *c = &replay_cases[n];
    if (!is_wanted(c->name)) continue;
    if (fray_open(c->image, c->image_bytes, memory, REPLAY_MEMORY, &world, 0) != FRAY_OK) return 1;
    if (!fray_set_kernel(world, REPLAY_KERNEL)) return 1;
    for (uint32_t tick = 0; tick <= REPLAY_DUMP_TICK; ++tick)
      fray_tick(world, tick < c->input_count ? &c->inputs[tick] : &nothing, &out);
    print_particles(world);
    for (uint32_t row = 0; row < world->capacity[POOL_SPRINGS]; ++row)
      print_word("row", world->woven.canonical_id[row], "class", world->woven.spring_kind[row]);
    print_bodies(world);
    print_state(world->state);
    print_outputs(&out);
    return 0;
  }
  return 1;
}
