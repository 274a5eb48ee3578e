/* SPDX-License-Identifier: Apache-2.0 */
/* Velocities gain gravity, positions gain velocities (Metaaphanon 2009, section 4, steps 1, 2
 * and 4: explicit Euler); bodies move on and carry the particles that they hold. */
#include "rt/stage/stage.h"
#include "rt/wide/wide.h"

/* Gravity per substep is not a whole number of velocity steps; the fraction accumulates. */
static int32_t gravity_step(int32_t whole, int32_t rest, int32_t *phase) {
  const uint64_t sum = (uint64_t)(uint32_t)*phase + (uint32_t)rest;
  *phase = (int32_t)(uint32_t)(sum & 0xFFFFFFFFu);
  return whole + (int32_t)(sum >> 32);
}

/* from + (to - from) * done / all, without a wide division. */
static int32_t part_way(int32_t from, int32_t to, int32_t done, int32_t all) {
  const int32_t way = fx_sub(to, from);
  return from + way / all * done + way % all * done / all;
}

static void drive_body(fray_world *w, uint32_t b, int32_t done, int32_t all) {
  body_motion *m = &w->motion[b];
  int32_t *at = w->body_states[b].position;
  const vec3 before = vec_make(at[0], at[1], at[2]);
  at[0] = part_way(m->from.x, m->to.x, done, all);
  at[1] = part_way(m->from.y, m->to.y, done, all);
  at[2] = part_way(m->from.z, m->to.z, done, all);
  m->moved = vec_sub(vec_make(at[0], at[1], at[2]), before);
  int32_t *v = w->body_states[b].velocity;
  v[0] = fx_saturate((int64_t)m->moved.x * (1 << FX_SUB_BITS));
  v[1] = fx_saturate((int64_t)m->moved.y * (1 << FX_SUB_BITS));
  v[2] = fx_saturate((int64_t)m->moved.z * (1 << FX_SUB_BITS));
}

static void fly_body(fray_world *w, uint32_t b) {
  body_state *s = &w->body_states[b];
  const int32_t gravity[3] = {w->gravity_step.x, w->gravity_step.y, w->gravity_step.z};
  int32_t moved[3];
  for (uint32_t n = 0; n < 3; ++n) {
    int8_t remainder = (int8_t)s->remainder[n];
    int32_t unused;
    const int32_t before = s->position[n];
    if (sweep_advance(&s->position[n], &unused, &s->velocity[n], &remainder, 0, 1, gravity[n]) != 0) {
      s->velocity[n] = 0;
      w->state->faults |= (int32_t)FRAY_FAULT_LEFT_WORLD;
    }
    s->remainder[n] = remainder;
    moved[n] = s->position[n] - before;
  }
  w->motion[b].moved = vec_make(moved[0], moved[1], moved[2]);
}

static void carry(fray_world *w, uint32_t p, const body_state *s) {
  const int32_t *at = s->position;
  w->x[p] = w->qx[p] = sweep_carried(at[0], w->grip_x[p]);
  w->y[p] = w->qy[p] = sweep_carried(at[1], w->grip_y[p]);
  w->z[p] = w->qz[p] = sweep_carried(at[2], w->grip_z[p]);
  w->vx[p] = s->velocity[0];
  w->vy[p] = s->velocity[1];
  w->vz[p] = s->velocity[2];
}

static void carry_run(fray_world *w, uint32_t first, uint32_t end) {
  const fray_kernel kernel = w->kernel;
  const body_state *s = &w->body_states[w->grip_body[first]];
  const int32_t *at = s->position;
  wide_carry(kernel, w->x, w->qx, w->vx, w->grip_x, first, end, at[0], s->velocity[0]);
  wide_carry(kernel, w->y, w->qy, w->vy, w->grip_y, first, end, at[1], s->velocity[1]);
  wide_carry(kernel, w->z, w->qz, w->vz, w->grip_z, first, end, at[2], s->velocity[2]);
}

/* Particles that one body holds follow one another, as a rule: wide cores take them together. */
void predict_held(fray_world *w) {
  const uint32_t held = (uint32_t)w->params->held;
  for (uint32_t p = 0; p < held;) {
    if (FX_NARROW) {
      carry(w, p, &w->body_states[w->grip_body[p]]);
      ++p;
    } else {
      const uint32_t first = p;
      do ++p;
      while (p < held && w->grip_body[p] == w->grip_body[first]);
      carry_run(w, first, p);
    }
  }
}

void predict_begin(fray_world *w, uint32_t substep) {
  const params *p = w->params;
  state *s = w->state;
  w->gravity_step = vec_make(gravity_step(p->gravity_x, p->gravity_rest_x, &s->gravity_phase[0]),
                             gravity_step(p->gravity_y, p->gravity_rest_y, &s->gravity_phase[1]),
                             gravity_step(p->gravity_z, p->gravity_rest_z, &s->gravity_phase[2]));
  for (uint32_t b = 0; b < (uint32_t)p->bodies; ++b) {
    if (w->bodies[b].motion == FRAY_FREE)
      fly_body(w, b);
    else
      drive_body(w, b, (int32_t)substep + 1, p->substeps);
  }
}

void predict_part(fray_world *w, uint32_t first, uint32_t end) {
  const fray_kernel kernel = w->kernel;
  uint32_t at_edge = wide_advance(kernel, w->x, w->qx, w->vx, w->rx, first, end, w->gravity_step.x);
  at_edge |= wide_advance(kernel, w->y, w->qy, w->vy, w->ry, first, end, w->gravity_step.y);
  at_edge |= wide_advance(kernel, w->z, w->qz, w->vz, w->rz, first, end, w->gravity_step.z);
  if (at_edge != 0) w->state->faults |= (int32_t)FRAY_FAULT_LEFT_WORLD;
  w->work.predictions += end - first;
}

void predict_run(fray_world *w, uint32_t substep) {
  predict_begin(w, substep);
  if (world_has_sheet(w)) {
    inner_run(w, substep);
    predict_held(w);
    return;
  }
  if (world_has_stretch(w))
    stretch_run(w);
  else
    predict_part(w, (uint32_t)w->params->held, w->particles);
  predict_held(w);
}
