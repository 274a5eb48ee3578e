/* SPDX-License-Identifier: Apache-2.0 */
/* What `make work` counts on a small target: every tick of every case, then storms (states made to
 * cost as much as one tick can), then stages alone. One line for each piece between two marks:
 *
 *   limits CASE ...             what bounds the loops of a tick; see bound.awk
 *   tick CASE N torn predictions projections springs contacts gathers tear_tests over cuts
 *       transitions splits slips stretches
 *   storm CASE N torn ...       the same
 *   bend CASE rows, shear CASE rows
 *
 * and `BAD ...` where a tick counted more than fray_work_bound() says. */
#include "rt/base/random.h"
#include "rt/state/crossing.h"
#include "rt/woven/woven.h"
#include "tests/determinism/cases.h"
#include "tests/wcet/loop_limits.h"

enum { MEMORY = 1 << 18, STORMS = 8 };

#ifndef WORK_KERNEL
#define WORK_KERNEL FRAY_KERNEL_SCALAR
#endif
_Alignas(16) static uint8_t memory[MEMORY];

void work_mark(void);
__attribute__((noinline)) void work_mark(void) { __asm__ volatile("" ::: "memory"); }

static fray_world *open_case(const replay_case *c) {
  fray_world *world;
  if (fray_open(c->image, c->image_bytes, memory, sizeof memory, &world, 0) != FRAY_OK) return 0;
  return fray_set_kernel(world, WORK_KERNEL) ? world : 0;
}

static void print_work(const char *what, const replay_case *c, uint32_t n, uint32_t torn, const fray_work *k) {
  line l = line_begin(what, c->name);
  const uint32_t words[] = {n, torn, k->particle_steps, k->projections, k->springs, k->contacts,
                            k->broad_phase_tests, k->tear_tests, k->over_threshold, k->tears, k->transitions, k->splits,
                            k->slips, k->yarn_forces};
  for (uint32_t m = 0; m < sizeof words / sizeof words[0]; ++m) line_number(&l, words[m]);
  print_line(&l);
}

static int within(const fray_work *k, const fray_work *most) {
  return k->particle_steps <= most->particle_steps && k->projections <= most->projections &&
         k->springs <= most->springs && k->contacts <= most->contacts &&
         k->broad_phase_tests <= most->broad_phase_tests && k->tear_tests <= most->tear_tests &&
         k->over_threshold <= most->over_threshold && k->tears <= most->tears && k->transitions <= most->transitions &&
         k->splits <= most->splits && k->slips <= most->slips &&
         k->yarn_forces <= most->yarn_forces;
}

static int one_tick(const char *what, const replay_case *c, fray_world *w, uint32_t n, const fray_input *in) {
  fray_output out;
  const fray_work most = fray_work_bound(w);
  work_mark();
  fray_tick(w, in, &out);
  work_mark();
  const uint32_t torn = out.tears_total != 0;
  print_work(what, c, n, torn, &out.work);
  if (within(&out.work, &most)) return 1;
  print_work("BAD", c, n, torn, &out.work);
  return 0;
}

static int replay(const replay_case *c) {
  static const fray_input nothing;
  fray_world *w = open_case(c);
  int good = w != 0;
  for (uint32_t n = 0; good && n < c->ticks; ++n)
    good = one_tick("tick", c, w, n, n < c->input_count ? &c->inputs[n] : &nothing);
  return good;
}

static void disconnect_yarns(fray_world *w) {
  uint32_t left = w->capacity[POOL_PARTICLES] - w->p.count;
  left = left > w->capacity[POOL_SPLITS] ? left - w->capacity[POOL_SPLITS] : 0;
  for (uint32_t c = 0; c < w->capacity[POOL_CROSSINGS] && left != 0; ++c)
    if (!crossing_is_attached(w, c) && crossing_split(w, c, FRAY_LOOSE)) --left;
}

/* A quarter of a spacing from their wefts' particles, as fast. */
static void place_warps(fray_world *w) {
  for (uint32_t p = (uint32_t)w->params->particles; p < w->p.count; ++p) {
    const uint32_t weft = w->woven.crossing_particle[w->woven.crossing_of[p]];
    w->p.x[p] = w->p.x[weft] + FX_LU / 64;
    w->p.y[p] = w->p.y[weft];
    w->p.z[p] = w->p.z[weft];
    w->p.vx[p] = w->p.vx[weft];
    w->p.vy[p] = w->p.vy[weft];
    w->p.vz[p] = w->p.vz[weft];
  }
}

/* Ends of links half as long again let the bar pass, so half of the storms begin nearer: those that lie on the
 * bar have neighbours on both sides, within that; the others, whose neighbours of the other side are beyond
 * it, fly off. */
static void place_near(fray_world *w, const body_state *rail, int32_t radius, uint32_t q, int left, int lies) {
  const int32_t away = w->woven.link_classes[CLASS_WEFT].rest / 8 * 11;
  const int32_t top = rail->position[1] + radius;
  w->p.y[q] = fx_clamp(w->p.y[q], top - away / 16, top);
  w->p.z[q] = fx_clamp(w->p.z[q], rail->position[2] - away / 16, rail->position[2] + away / 16);
  w->p.x[q] = rail->position[0] + (lies ? 0 : left ? -away : away);
  if (lies) return;
  w->p.vx[q] = left ? -(FX_SPEED_MAX / 2) : FX_SPEED_MAX / 2;
  w->p.vy[q] = w->p.vz[q] = 0;
}

/* Neighbours of the weave apart, farther by their number, so that every link is over its threshold
 * and the list of the worst changes often; next but one together, so that springs are pressed; all
 * of them at an edge of the world and leaving it. As many as the pool takes lie on the last body, a
 * bar along x, and their neighbours pull them through it. Of sheets with yarns all crossings but as
 * many as split in a tick are loose, each yarn on its own. */
static void make_storm(fray_world *w, uint32_t n) {
  const params *p = w->params;
  const uint32_t warps = (uint32_t)p->warps;
  const uint32_t first = (uint32_t)p->attached;
  const uint32_t half = ((uint32_t)p->particles - first) / 2u;
  const uint32_t b = (uint32_t)p->bodies - 1u;
  body_state *rail = &w->rigid.states[b];
  const int32_t radius = w->rigid.bodies[b].radius;
  const int32_t apart = (p->substeps * p->substeps + 16) * (FX_LU / 8); /* far until the end */
  uint32_t touching = 0;
  if (world_has_yarns(w)) disconnect_yarns(w);
  rail->position[0] = apart + FX_LU - FX_WORLD_MAX;
  rail->position[1] = 2 * radius - FX_WORLD_MAX;
  rail->position[2] = -FX_WORLD_MAX;
  for (uint32_t crossing = 0; crossing < w->capacity[POOL_CROSSINGS]; ++crossing) {
    const uint32_t q = w->woven.crossing_particle[crossing];
    if (q < first) continue;
    const uint32_t i = crossing % warps;
    const uint32_t j = crossing / warps;
    const uint32_t side = (i + j) & 1u;
    /* of the neighbours of one that lies on the bar, two pull to the left and two to the right */
    const int32_t left = w->capacity[POOL_CONTACTS] == 0 || ((i + warps - j) / 2u & 1u) == 0;
    const int32_t lane = left ? 0 : 2 * FX_LU;
    const uint32_t rank = n % 2u == 0 ? q : random_bits(n, q) % (uint32_t)p->particles;
    const int32_t step = FX_LU / 4 / p->particles * (int32_t)(rank + 1u);
    w->p.x[q] = (side != 0 ? apart + lane + step : step / 4) - FX_WORLD_MAX;
    w->p.y[q] = w->p.z[q] = -FX_WORLD_MAX;
    w->p.vx[q] = 0; /* so that it is no candidate: the pool is for those below */
    w->p.vy[q] = w->p.vz[q] = -INT32_MAX;
    touching += side == 0 ? w->capacity[POOL_CONTACTS] : 0;
    const int lies = side == 0 && touching >= half;
    if (lies) {
      touching -= half;
      w->p.x[q] = rail->position[0] + random_between(n, q, -FX_LU / 8, FX_LU / 8);
      w->p.y[q] = rail->position[1] + radius - random_between(n, 2u * q, 0, FX_LU / 64);
      w->p.z[q] = rail->position[2] + random_between(n, 3u * q, -FX_LU / 64, FX_LU / 64);
      w->p.vx[q] = n % 4u < 2u ? 0 : FX_LU / 64;
      w->p.vy[q] = w->p.vz[q] = 0;
    }
    if (n >= STORMS / 2) place_near(w, rail, radius, q, left, lies);
  }
  if (world_has_yarns(w)) place_warps(w);
}

/* In the tick in which every hand is armed all of them are looked up and divided by. */
static void arm_hands(fray_world *w) {
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) w->state->hand[h].good = w->params->arm_poses;
}

static int storms(const replay_case *c) {
  static const fray_input start = {.has_pose = 3, .command = FRAY_COMMAND_START};
  int good = 1;
  for (uint32_t n = 0; good && n < STORMS; ++n) {
    fray_world *w = open_case(c);
    good = w != 0;
    if (good && w->params->bodies == 0) return 1;
    if (good) make_storm(w, n);
    if (good) arm_hands(w);
    good = good && one_tick("storm", c, w, n, &start);
  }
  return good;
}

/* bend_shear_apply with the batches of one family: the world is told so by params of its own. */
static void springs_alone(const replay_case *c) {
  static params changed;
  fray_world *w = open_case(c);
  changed = *w->params;
  const params all = changed;
  w->params = &changed;
  for (uint32_t family = 0; family < 2; ++family) {
    changed.link_batches = family == 0 ? all.link_batches : all.link_batches + all.bend_batches;
    changed.bend_batches = family == 0 ? all.bend_batches : 0;
    changed.shear_batches = family == 0 ? 0 : all.shear_batches;
    w->work.springs = 0;
    work_mark();
    bend_shear_apply(w);
    work_mark();
    line l = line_begin(family == 0 ? "bend" : "shear", c->name);
    line_number(&l, w->work.springs);
    print_line(&l);
  }
}

int main(void) {
  int good = 1;
  for (uint32_t n = 0; n < replay_case_count; ++n) {
    const replay_case *c = &replay_cases[n];
    fray_world *w = open_case(c);
    if (w == 0) return 1;
    loop_limits_print(c->name, w);
    good = replay(c) && storms(c) && good;
    springs_alone(c);
  }
  port_print("end\n");
  return good ? 0 : 1;
}
