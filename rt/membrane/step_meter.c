/* SPDX-License-Identifier: Apache-2.0 */
/* What acted in an elastic step, for the energy ledger: the work of its impulse times the mean of the
 * velocities before and behind the step. Impulses of constraints are what the sum gained from mark to
 * mark: one by one, each would have its own part of the velocities behind the step. Both are found again
 * from what the step left: the drag of a speed is less than one for one, so the speed before it is the
 * fixed point of a few rounds. A kernel's steps are the same. */
#include "rt/membrane/step_meter.h"

#include "rt/membrane/membrane.h"

#if FRAY_ENERGY

/* Speeds of a step along an axis. */
typedef struct {
  int64_t taken; /* by drag */
  int64_t twice_mean;
} metered_axis;

static metered_axis meter_axis(const step_view *k, uint32_t p, uint32_t n, int32_t impulse) {
  const int64_t speed = (int64_t)k->v[n][p] - k->gravity[n];
  const int64_t size = speed < 0 ? -speed : speed;
  const int64_t change = fx_round64(fx_mul_wide(impulse, k->inverse[p]),
                                    ELASTIC_IMPULSE_BITS + ELASTIC_INVERSE_BITS - FX_VELOCITY_BITS);
  int64_t lost = 0;
  for (uint32_t round = 0; round < 3; ++round) lost = ((size + lost) * k->drag + k->dither) >> 30;
  const int64_t taken = speed < 0 ? -lost : lost;
  const metered_axis a = {taken, speed + taken - change + k->v[n][p]};
  return a;
}

static wide_number times_mean(int64_t by, const metered_axis *a, unsigned bits) {
  return wide_product(by, a->twice_mean, bits + FX_VELOCITY_BITS + 1u);
}

static void add_row(fray_world *w, wide_number *row, wide_number work) {
  *row = wide_add(*row, work);
  w->energy.booked = wide_add(w->energy.booked, work);
}

static int32_t axis_of(const elastic_impulse *a, uint32_t n) { return n == 0 ? a->x : n == 1 ? a->y : a->z; }

/* The stage behind which mark n + 1 is. */
static const fray_energy_stage marked_stage[STEP_MARKS] = {FRAY_ENERGY_LIMITS, FRAY_ENERGY_CONTACT,
                                                           FRAY_ENERGY_SELF_COLLISION};

static void meter_stages(fray_world *w, uint32_t p, uint32_t n, const metered_axis *a) {
  const metered_impulse *m = &w->membrane.metered_impulses[p];
  for (uint32_t k = 0; k < STEP_MARKS; ++k) {
    const elastic_impulse *behind = k + 1u < STEP_MARKS ? &m->sum[k + 1u] : &w->membrane.impulse[p];
    const int64_t part = (int64_t)axis_of(behind, n) - axis_of(&m->sum[k], n);
    if (part != 0)
      add_row(w, &w->energy.stage[marked_stage[k]], times_mean(part, a, ELASTIC_IMPULSE_BITS));
  }
}

/* A body has the work of its impulse on the cloth, and the stage what is left of that, by the same mean. */
static void meter_body(fray_world *w, uint32_t b, uint32_t mark) {
  metered_body *m = &w->membrane.metered_bodies[b];
  const int32_t *before = w->membrane.bodies[b].before;
  const int32_t *v = w->rigid.states[b].velocity;
  const int64_t *impulse = w->rigid.motion[b].impulse;
  for (uint32_t n = 0; n < 3; ++n) {
    if (mark != 0) m->given[mark - 1u][n] = impulse[n] - m->impulse[n];
    m->impulse[n] = impulse[n];
    for (uint32_t k = 0; k < STEP_MARKS && mark == STEP_MARKS; ++k)
      if (m->given[k][n] != 0)
        add_row(w, &w->energy.stage[marked_stage[k]],
                wide_product(-m->given[k][n], (int64_t)before[n] + v[n], 2 * FX_VELOCITY_BITS + 1));
  }
}

void step_meter_mark_add(fray_world *w, uint32_t mark) {
  FRAY_ASSERT(mark <= STEP_MARKS && world_has_membrane(w));
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    meter_body(w, b, mark);
  for (uint32_t p = 0; p < w->p.count && mark < STEP_MARKS; ++p)
    w->membrane.metered_impulses[p].sum[mark] = w->membrane.impulse[p];
}

static void meter_vertex(fray_world *w, const step_view *k, uint32_t p) {
  enum { MASS_BITS = 20 };
  const elastic_impulse *sum = &k->sum[p];
  const elastic_impulse *load = &w->membrane.external_impulse[p];
  const int64_t mass =
      ((int64_t)w->trimesh.mass[p] << MASS_BITS) / w->membrane.constants->mass_unit;
  const int32_t impulse[3] = {sum->x, sum->y, sum->z};
  const int32_t external[3] = {load->x, load->y, load->z};
  for (uint32_t n = 0; n < 3; ++n) {
    const metered_axis a = meter_axis(k, p, n, impulse[n]);
    meter_stages(w, p, n, &a);
    if (k->drag != 0)
      add_row(w, &w->energy.stage[FRAY_ENERGY_DRAG],
              times_mean(-mass * a.taken, &a, FX_VELOCITY_BITS + MASS_BITS));
    if (external[n] != 0)
      add_row(w, &w->energy.supplied[FRAY_SUPPLIED_LOADS],
              times_mean(external[n], &a, ELASTIC_IMPULSE_BITS));
  }
}

/* The load on a vertex that a body holds works on the body, which takes it from the cloth's books.
 */
static void meter_attached(fray_world *w, uint32_t p) {
  const elastic_impulse *load = &w->membrane.external_impulse[p];
  const int32_t external[3] = {load->x, load->y, load->z};
  const int32_t *v = w->rigid.states[w->p.attach_body[p]].velocity;
  for (uint32_t n = 0; n < 3; ++n)
    if (external[n] != 0)
      add_row(w, &w->energy.supplied[FRAY_SUPPLIED_LOADS],
              wide_of(fx_mul_wide(external[n], v[n]), ELASTIC_IMPULSE_BITS + FX_VELOCITY_BITS));
}

void step_meter_add(fray_world *w, const step_view *view) {
  FRAY_ASSERT(world_has_membrane(w));
  for (uint32_t p = 0; p < particles_attached(w); ++p) meter_attached(w, p);
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) meter_vertex(w, view, p);
}

#endif
