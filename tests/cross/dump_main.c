/* SPDX-License-Identifier: Apache-2.0 */
/* Prints every word of the state after one tick of one case, and what the tick put out: two
 * machines that part there are told apart by `diff`. Built with CROSS_DUMP_CASE, CROSS_DUMP_TICK. */
#include "rt/model/world.h"
#include "tests/cross/line.h"

#ifndef CROSS_MEMORY
#define CROSS_MEMORY 98304
#endif
#ifndef CROSS_KERNEL
#define CROSS_KERNEL FRAY_KERNEL_SCALAR
#endif
_Alignas(16) static uint8_t memory[CROSS_MEMORY];

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
  for (uint32_t p = 0; p < (uint32_t)w->params->particles; ++p) {
    print_word("particle", p, "x", w->x[p]);
    print_word("particle", p, "y", w->y[p]);
    print_word("particle", p, "z", w->z[p]);
    print_word("particle", p, "vx", w->vx[p]);
    print_word("particle", p, "vy", w->vy[p]);
    print_word("particle", p, "vz", w->vz[p]);
    print_word("particle", p, "rx", w->rx[p]);
    print_word("particle", p, "ry", w->ry[p]);
    print_word("particle", p, "rz", w->rz[p]);
  }
}

static void print_bodies(const fray_world *w) {
  static const char *const field[3] = {"x", "y", "z"};
  for (uint32_t b = 0; b < w->capacity[POOL_BODIES]; ++b)
    for (uint32_t n = 0; n < 3; ++n) {
      print_word("body", b, field[n], w->body_states[b].position[n]);
      print_word("body remainder", b, field[n], w->body_states[b].remainder[n]);
      print_word("body velocity", b, field[n], w->body_states[b].velocity[n]);
      print_word("body fraction", b, field[n], w->body_states[b].fraction[n]);
    }
}

static void print_outputs(const fray_output *o) {
  static const char *const field[3] = {"x", "y", "z"};
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    print_word("hand", h, "consumed", o->consumed[h]);
    for (uint32_t n = 0; n < 3; ++n) {
      print_word("force", h, field[n], o->force[h][n]);
      print_word("raw force", h, field[n], o->raw[h][n]);
    }
  }
  print_word("output", 0, "state", o->state);
  print_word("output", 0, "acked", o->acked);
  print_word("output", 0, "result", o->result);
  print_word("output", 0, "faults", o->faults);
  print_word("output", 0, "cuts_waiting", (int32_t)o->cuts_waiting);
  print_word("output", 0, "cut_first", (int32_t)o->cut_first);
  print_word("output", 0, "cuts_total", (int32_t)o->cuts_total);
  print_word("work", 0, "contacts", (int32_t)o->work.contacts);
  print_word("work", 0, "cuts", (int32_t)o->work.cuts);
}

static int is_wanted(const char *name) {
  const char *wanted = CROSS_DUMP_CASE;
  while (*name != 0 && *name == *wanted) ++name, ++wanted;
  return *name == *wanted;
}

int main(void) {
  static const fray_input nothing;
  fray_world *world = 0;
  fray_output out;
  for (uint32_t n = 0; n < cross_case_count; ++n) {
    const cross_case *c = &cross_cases[n];
    if (!is_wanted(c->name)) continue;
    if (fray_open(c->image, c->image_bytes, memory, CROSS_MEMORY, &world, 0) != FRAY_OK) return 1;
    if (!fray_use(world, CROSS_KERNEL)) return 1;
    for (uint32_t tick = 0; tick <= CROSS_DUMP_TICK; ++tick)
      fray_tick(world, tick < c->input_count ? &c->inputs[tick] : &nothing, &out);
    print_particles(world);
    for (uint32_t row = 0; row < world->capacity[POOL_ROWS]; ++row)
      print_word("row", world->home[row], "class", world->row_class[row]);
    print_bodies(world);
    print_state(world->state);
    print_outputs(&out);
    return 0;
  }
  return 1;
}
