/* SPDX-License-Identifier: Apache-2.0 */
/* What acted in an elastic step, for the energy ledger. Loads, drag and the damping of stress: the work of
 * their impulse times the mean of the velocities before and behind the step. Constraints: what each stage
 * changes of m u^2 / 2 (elastic/step_passive.h); in sum that is the same, and stage by stage it does not
 * depend on those behind it. Velocities are found again from what the step left: the drag of a speed is less
 * than one for one, so the speed before it is the fixed point of a few rounds. A kernel's steps are the
 * same. */
#include "rt/membrane/step_meter.h"

#include "rt/elastic/step_passive.h"
#include "rt/membrane/membrane.h"

#if FRAY_ENERGY

/* Speeds of a step along an axis. */
typedef struct {
  int64_t taken; /* by drag */
  int64_t twice_mean;
  int64_t behind; /* all impulses, before drag and gravity */
} metered_axis;

static int64_t change_of(const step_view *k, uint32_t p, int32_t impulse) {
  return fx_round64(fx_mul_wide(impulse, k->inverse[p]),
                    ELASTIC_IMPULSE_BITS + ELASTIC_INVERSE_BITS - FX_VELOCITY_BITS);
}

static metered_axis meter_axis(const step_view *k, uint32_t p, uint32_t n, int32_t impulse) {
  const int64_t speed = (int64_t)k->v[n][p] - k->gravity[n];
  const int64_t size = speed < 0 ? -speed : speed;
  int64_t lost = 0;
  for (uint32_t round = 0; round < 3; ++round) lost = ((size + lost) * k->drag + k->dither) >> 30;
  const int64_t taken = speed < 0 ? -lost : lost;
  const metered_axis a = {taken, speed + taken - change_of(k, p, impulse) + k->v[n][p], speed + taken};
  return a;
}

static wide_number times_half(int64_t by, int64_t twice, unsigned bits) {
  return wide_product(by, twice, bits + FX_VELOCITY_BITS + 1u);
}

static void book_stage(fray_world *w, fray_energy_stage stage, wide_number work) {
  energy_ledger_book(&w->energy, &w->energy.stage[stage], work);
}

static void book_load(fray_world *w, wide_number work) {
  energy_ledger_book(&w->energy, &w->energy.supplied[FRAY_SUPPLIED_LOADS], work);
}

static int32_t axis_of(vec3 a, uint32_t n) { return n == 0 ? a.x : n == 1 ? a.y : a.z; }

/* The stage behind which a mark is. */
static fray_energy_stage stage_of(const fray_world *w, uint32_t mark) {
  static const fray_energy_stage stages[STEP_MARKS] = {FRAY_ENERGY_SELF_COLLISION, FRAY_ENERGY_STEPS,
                                                       FRAY_ENERGY_LIMITS, FRAY_ENERGY_CONTACT,
                                                       FRAY_ENERGY_LIMITS, FRAY_ENERGY_SELF_COLLISION};
  FRAY_ASSERT(mark != 0 && mark <= STEP_MARKS);
  return mark == 1 ? world_zone_stage(w) : stages[mark - 1u];
}

static void meter_stages(fray_world *w, const step_view *k, uint32_t p, uint32_t n, const metered_axis *a) {
  const metered_impulse *m = &w->membrane.metered_impulses[p];
  const int32_t end = axis_of(elastic_impulse_vec(&w->membrane.impulse[p]), n);
  const int32_t forced = axis_of(elastic_impulse_vec(&w->membrane.forced[p]), n);
  const int64_t twice_before = /* 2 u, before any impulse */
      2 * (a->behind - change_of(k, p, end)) + k->gravity[n] - change_of(k, p, forced);
  int32_t before = forced;
  for (uint32_t mark = 1; mark <= STEP_MARKS; ++mark) {
    const int32_t behind = mark < STEP_MARKS ? axis_of(m->sum[mark - 1u], n) : end;
    const int64_t part = (int64_t)behind - before;
    if (part != 0)
      book_stage(w, stage_of(w, mark),
                 times_half(part, twice_before + change_of(k, p, before) + change_of(k, p, behind),
                            ELASTIC_IMPULSE_BITS));
    before = behind;
  }
  /* drag slows what constraints gave */
  if (end != forced)
    book_stage(w, FRAY_ENERGY_DRAG, times_half((int64_t)forced - end, a->taken, ELASTIC_IMPULSE_BITS));
}

/* A driven body has the work of its impulse on the cloth, and the stage what is left of that. A free one is
 * changed by the stage, planes under it too. */
static void meter_body(fray_world *w, uint32_t b, uint32_t mark) {
  metered_body *m = &w->membrane.metered_bodies[b];
  const rigid_body *k = &w->rigid.bodies[b];
  const body_state *s = &w->rigid.states[b];
  for (uint32_t n = 0; n < 3; ++n) {
    const int64_t before = w->membrane.bodies[b].before[n];
    const int64_t speed = body_fine_speed(s, n);
    const int64_t impulse = w->rigid.motion[b].impulse[n];
    if (mark == 0)
      m->forced[n] = speed - before * (1 << 16);
    else
      book_stage(w, stage_of(w, mark),
                 body_is_driven(k)
                     ? wide_product(m->impulse[n] - impulse, s->velocity[n], 2 * FX_VELOCITY_BITS)
                     : body_fine_work(k, speed - m->speed[n], speed + m->speed[n] - m->forced[n]));
    m->impulse[n] = impulse;
    m->speed[n] = speed;
  }
}

void step_meter_mark_add(fray_world *w, uint32_t mark) {
  FRAY_ASSERT(mark <= STEP_MARKS && world_has_membrane(w));
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    meter_body(w, b, mark);
  if (mark == 0 || mark == STEP_MARKS) return; /* those sums are membrane.forced and membrane.impulse */
  for (uint32_t p = 0; p < w->p.count; ++p)
    w->membrane.metered_impulses[p].sum[mark - 1u] =
        elastic_impulse_vec(&w->membrane.impulse[p]);
}

/* Impulses of stress with damping, less those without it. */
void step_meter_damping_add(fray_world *w) {
  const fray_work work = w->work;
  for (uint32_t p = 0; p < w->p.count; ++p) {
    w->membrane.metered_impulses[p].damping = elastic_impulse_vec(&w->membrane.impulse[p]);
    w->membrane.impulse[p] = w->membrane.external_impulse[p];
  }
  membrane_force_add(w, FORCE_MEASURED);
  for (uint32_t p = 0; p < w->p.count; ++p) {
    elastic_impulse *sum = &w->membrane.impulse[p];
    vec3 *damping = &w->membrane.metered_impulses[p].damping;
    const vec3 less = vec_sub(*damping, elastic_impulse_vec(sum));
    elastic_impulse_add(sum, less);
    *damping = less;
  }
  w->work = work;
}

static void meter_damping(fray_world *w, uint32_t p, uint32_t n, int64_t twice_mean) {
  const int32_t damping = axis_of(w->membrane.metered_impulses[p].damping, n);
  if (damping != 0)
    book_stage(w, FRAY_ENERGY_DAMPING, times_half(damping, twice_mean, ELASTIC_IMPULSE_BITS));
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
    meter_stages(w, k, p, n, &a);
    meter_damping(w, p, n, a.twice_mean);
    if (k->drag != 0)
      book_stage(w, FRAY_ENERGY_DRAG,
                 times_half(-mass * a.taken, a.twice_mean, FX_VELOCITY_BITS + MASS_BITS));
    if (external[n] != 0)
      book_load(w, times_half(external[n], a.twice_mean, ELASTIC_IMPULSE_BITS));
  }
}

/* What loads and damps a vertex that a body holds works on the body, which takes it from the cloth's
 * books. */
static void meter_attached(fray_world *w, uint32_t p) {
  const elastic_impulse *load = &w->membrane.external_impulse[p];
  const int32_t external[3] = {load->x, load->y, load->z};
  const uint32_t b = w->p.attach_body[p];
  const int32_t *v = w->rigid.states[b].velocity;
  for (uint32_t n = 0; n < 3; ++n) {
    meter_damping(w, p, n, (int64_t)w->membrane.bodies[b].before[n] + v[n]);
    if (external[n] != 0)
      book_load(w, wide_of(fx_mul_wide(external[n], v[n]), ELASTIC_IMPULSE_BITS + FX_VELOCITY_BITS));
  }
}

/* A tick leaves the vertices of a zone alike half a step later, by what acts on each; then they are alike at
 * once. What loads and damping, which store nothing, have of that is no work of the zone's. */
void step_meter_zones_add(fray_world *w, const elastic_step *step) {
  FRAY_ASSERT(world_has_membrane(w));
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
    const vec3 ahead = vec_sub_saturated(step_vertex_half_of(w, p, step), step_half_of(w, p, step));
    const vec3 load = elastic_impulse_vec(&w->membrane.external_impulse[p]);
    const vec3 damping = w->membrane.metered_impulses[p].damping;
    for (uint32_t n = 0; n < 3; ++n) {
      const int64_t speed = axis_of(ahead, n);
      const int64_t both = (int64_t)axis_of(load, n) + axis_of(damping, n);
      if (speed == 0) continue;
      book_load(w, times_half(axis_of(load, n), speed, ELASTIC_IMPULSE_BITS));
      book_stage(w, FRAY_ENERGY_DAMPING, times_half(axis_of(damping, n), speed, ELASTIC_IMPULSE_BITS));
      book_stage(w, world_zone_stage(w), times_half(-both, speed, ELASTIC_IMPULSE_BITS));
    }
  }
}

void step_meter_add(fray_world *w, const step_view *view) {
  FRAY_ASSERT(world_has_membrane(w));
  for (uint32_t p = 0; p < particles_attached(w); ++p) meter_attached(w, p);
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) meter_vertex(w, view, p);
}

#endif
