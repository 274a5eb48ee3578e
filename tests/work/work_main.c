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
 * and `BAD ...` where a tick counted more than fray_limits() says. */
#include "rt/base/random.h"
#include "rt/model/couples.h"
#include "rt/stage/stage.h"
#include "tests/cross/cases.h"
#include "tests/work/limits.h"

enum { MEMORY = 1 << 18, STORMS = 8 };

#ifndef WORK_KERNEL
#define WORK_KERNEL FRAY_KERNEL_SCALAR
#endif
_Alignas(16) static uint8_t memory[MEMORY];

void work_mark(void);
__attribute__((noinline)) void work_mark(void) { __asm__ volatile("" ::: "memory"); }

static fray_world *open_case(const cross_case *c) {
  fray_world *world;
  if (fray_open(c->image, c->image_bytes, memory, sizeof memory, &world, 0) != FRAY_OK) return 0;
  return fray_use(world, WORK_KERNEL) ? world : 0;
}

static void print_work(const char *what, const cross_case *c, uint32_t n, uint32_t torn, const fray_work *k) {
  line l = line_begin(what, c->name);
  const uint32_t words[] = {n, torn, k->predictions, k->projections, k->springs, k->contacts,
                            k->gathers, k->tear_tests, k->over, k->cuts, k->transitions, k->splits,
                            k->slips, k->stretches};
  for (uint32_t m = 0; m < sizeof words / sizeof words[0]; ++m) line_number(&l, words[m]);
  print_line(&l);
}

static int within(const fray_work *k, const fray_work *most) {
  return k->predictions <= most->predictions && k->projections <= most->projections &&
         k->springs <= most->springs && k->contacts <= most->contacts &&
         k->gathers <= most->gathers && k->tear_tests <= most->tear_tests &&
         k->over <= most->over && k->cuts <= most->cuts && k->transitions <= most->transitions &&
         k->splits <= most->splits && k->slips <= most->slips &&
         k->stretches <= most->stretches;
}

static int one_tick(const char *what, const cross_case *c, fray_world *w, uint32_t n, const fray_input *in) {
  fray_output out;
  const fray_work most = fray_limits(w);
  work_mark();
  fray_tick(w, in, &out);
  work_mark();
  const uint32_t torn = out.cuts_total != 0;
  print_work(what, c, n, torn, &out.work);
  if (within(&out.work, &most)) return 1;
  print_work("BAD", c, n, torn, &out.work);
  return 0;
}

static int replay(const cross_case *c) {
  static const fray_input nothing;
  fray_world *w = open_case(c);
  int good = w != 0;
  for (uint32_t n = 0; good && n < c->ticks; ++n)
    good = one_tick("tick", c, w, n, n < c->input_count ? &c->inputs[n] : &nothing);
  return good;
}

static void loosen(fray_world *w) {
  uint32_t left = w->capacity[POOL_PARTICLES] - w->particles;
  left = left > w->capacity[POOL_SPLITS] ? left - w->capacity[POOL_SPLITS] : 0;
  for (uint32_t c = 0; c < w->capacity[POOL_CROSSINGS] && left != 0; ++c)
    if (!couple_is_held(w, c) && couple_split(w, c, FRAY_LOOSE)) --left;
}

/* A quarter of a spacing from their wefts' particles, as fast. */
static void place_warps(fray_world *w) {
  for (uint32_t p = (uint32_t)w->params->particles; p < w->particles; ++p) {
    const uint32_t weft = w->crossing[w->place[p]];
    w->x[p] = w->x[weft] + FX_LU / 64;
    w->y[p] = w->y[weft];
    w->z[p] = w->z[weft];
    w->vx[p] = w->vx[weft];
    w->vy[p] = w->vy[weft];
    w->vz[p] = w->vz[weft];
  }
}

/* Neighbours of the weave apart, farther by their number, so that every link is over its threshold
 * and the list of the worst changes often; next but one together, so that springs are pressed; all
 * of them at an edge of the world and leaving it. As many as the pool takes lie on the last body, a
 * bar along x, and their neighbours pull them through it. Of sheets with yarns all crossings but as
 * many as split in a tick are loose, each yarn on its own. */
static void make_storm(fray_world *w, uint32_t n) {
  const params *p = w->params;
  const uint32_t warps = (uint32_t)p->warps;
  const uint32_t first = (uint32_t)p->held;
  const uint32_t half = ((uint32_t)p->particles - first) / 2u;
  const uint32_t b = (uint32_t)p->bodies - 1u;
  body_state *rail = &w->body_states[b];
  const int32_t radius = w->bodies[b].radius;
  const int32_t apart = (p->substeps * p->substeps + 16) * (FX_LU / 8); /* far until the end */
  uint32_t touching = 0;
  if (world_has_yarns(w)) loosen(w);
  rail->position[0] = apart + FX_LU - FX_WORLD_MAX;
  rail->position[1] = 2 * radius - FX_WORLD_MAX;
  rail->position[2] = -FX_WORLD_MAX;
  for (uint32_t crossing = 0; crossing < w->capacity[POOL_CROSSINGS]; ++crossing) {
    const uint32_t q = w->crossing[crossing];
    if (q < first) continue;
    const uint32_t i = crossing % warps;
    const uint32_t j = crossing / warps;
    const uint32_t side = (i + j) & 1u;
    /* of the neighbours of one that lies on the bar, two pull to the left and two to the right */
    const int32_t left = w->capacity[POOL_CONTACTS] == 0 || ((i + warps - j) / 2u & 1u) == 0;
    const int32_t lane = left ? 0 : 2 * FX_LU;
    const uint32_t rank = n % 2u == 0 ? q : random_bits(n, q) % (uint32_t)p->particles;
    const int32_t step = FX_LU / 4 / p->particles * (int32_t)(rank + 1u);
    w->x[q] = (side != 0 ? apart + lane + step : step / 4) - FX_WORLD_MAX;
    w->y[q] = w->z[q] = -FX_WORLD_MAX;
    w->vx[q] = 0; /* so that it is no candidate: the pool is for those below */
    w->vy[q] = w->vz[q] = -INT32_MAX;
    if (side != 0) continue;
    touching += w->capacity[POOL_CONTACTS];
    if (touching < half) continue;
    touching -= half;
    w->x[q] = rail->position[0] + random_between(n, q, -FX_LU / 8, FX_LU / 8);
    w->y[q] = rail->position[1] + radius - random_between(n, 2u * q, 0, FX_LU / 64);
    w->z[q] = rail->position[2] + random_between(n, 3u * q, -FX_LU / 64, FX_LU / 64);
    w->vx[q] = n % 4u < 2u ? 0 : FX_LU / 64;
    w->vy[q] = w->vz[q] = 0;
  }
  if (world_has_yarns(w)) place_warps(w);
}

/* In the tick in which every hand is armed all of them are looked up and divided by. */
static void arm_hands(fray_world *w) {
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) w->state->hand[h].good = w->params->arm_poses;
}

static int storms(const cross_case *c) {
  static const fray_input start = {.has_pose = 3, .verb = FRAY_VERB_START};
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

/* springs_run with the batches of one family: the world is told so by params of its own. */
static void springs_alone(const cross_case *c) {
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
    springs_run(w);
    work_mark();
    line l = line_begin(family == 0 ? "bend" : "shear", c->name);
    line_number(&l, w->work.springs);
    print_line(&l);
  }
}

int main(void) {
  int good = 1;
  for (uint32_t n = 0; n < cross_case_count; ++n) {
    const cross_case *c = &cross_cases[n];
    fray_world *w = open_case(c);
    if (w == 0) return 1;
    limits_print(c->name, w);
    good = replay(c) && storms(c) && good;
    springs_alone(c);
  }
  port_print("end\n");
  return good ? 0 : 1;
}
