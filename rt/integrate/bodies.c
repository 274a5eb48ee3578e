/* SPDX-License-Identifier: Apache-2.0 */
/* Rigid bodies: driven ones follow their way through the tick, free ones fall (explicit Euler): once a
 * substep beside projected yarns, in each elastic step beside what has them. */
#include "rt/integrate/integrate.h"
#include "rt/simd/particle_loops.h"

/* Gravity per substep is not a whole number of velocity steps; the fraction accumulates. */
static int32_t gravity_step(int32_t whole, int32_t rest, int32_t *phase) {
  const uint64_t sum = (uint64_t)(uint32_t)*phase + (uint32_t)rest;
  *phase = (int32_t)(uint32_t)(sum & 0xFFFFFFFFu);
  return whole + (int32_t)(sum >> 32);
}

/* from + (to - from) * done / all, without a wide division. */
static int32_t part_way(int32_t from, int32_t to, int32_t done, int32_t all) {
  FRAY_ASSERT(done > 0 && done <= all);
  const int32_t way = fx_sub(to, from);
  return from + way / all * done + way % all * done / all;
}

static void drive_body(fray_world *w, uint32_t b, int32_t done, int32_t all) {
  body_motion *m = &w->rigid.motion[b];
  int32_t *at = w->rigid.states[b].position;
  const vec3 before = vec_of(at);
  at[0] = part_way(m->from.x, m->to.x, done, all);
  at[1] = part_way(m->from.y, m->to.y, done, all);
  at[2] = part_way(m->from.z, m->to.z, done, all);
  m->moved = vec_sub(vec_of(at), before);
  vec_store(w->rigid.states[b].velocity, vec_clamp64(vec_scale64(m->moved, 1 << FX_SUB_BITS), INT32_MAX));
}

/* By 1 / 2^more of a substep, with a remainder that has `more` bits below Q28; as loop_advance(). */
static void move_body(fray_world *w, uint32_t b, vec3 gravity, unsigned more) {
  body_state *s = &w->rigid.states[b];
  const int32_t gained[3] = {gravity.x, gravity.y, gravity.z};
  int32_t moved[3];
  for (uint32_t n = 0; n < 3; ++n) {
    const int32_t speed = fx_clamp(s->velocity[n], -LOOP_SPEED_MAX, LOOP_SPEED_MAX) + gained[n];
    const int32_t step = speed + s->remainder[n];
    const int32_t whole = fx_round(step, FX_SUB_BITS + more);
    const int32_t wanted = fx_add(s->position[n], whole);
    const int32_t place = fx_clamp(wanted, -FX_WORLD_MAX, FX_WORLD_MAX);
    if (place != wanted) world_fault(w, FRAY_FAULT_OUT_OF_WORLD);
    moved[n] = place - s->position[n];
    s->velocity[n] = place == wanted ? speed : 0; /* the edge stops it */
    s->remainder[n] = step - whole * (1 << (FX_SUB_BITS + more));
    s->position[n] = place;
  }
  w->rigid.motion[b].moved = vec_add(w->rigid.motion[b].moved, vec_of(moved));
}

void bodies_advance(fray_world *w, uint32_t substep) {
  const params *p = w->params;
  state *s = w->state;
  FRAY_ASSERT(substep < (uint32_t)p->substeps && (uint32_t)p->bodies <= w->capacity[POOL_BODIES]);
  w->gravity_step = vec_make(gravity_step(p->gravity_x, p->gravity_rest_x, &s->gravity_phase[0]),
                             gravity_step(p->gravity_y, p->gravity_rest_y, &s->gravity_phase[1]),
                             gravity_step(p->gravity_z, p->gravity_rest_z, &s->gravity_phase[2]));
  for (uint32_t b = 0; b < (uint32_t)p->bodies; ++b) {
    w->rigid.motion[b].moved = vec_make(0, 0, 0);
    if (w->rigid.bodies[b].motion != FRAY_FREE)
      drive_body(w, b, (int32_t)substep + 1, p->substeps);
    else if (world_is_projected(w))
      move_body(w, b, w->gravity_step, 0);
  }
}

void bodies_steps_begin(fray_world *w, unsigned more) {
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    for (uint32_t n = 0; n < 3 && w->rigid.bodies[b].motion == FRAY_FREE; ++n)
      w->rigid.states[b].remainder[n] *= 1 << more;
}

void bodies_steps_end(fray_world *w, unsigned more) {
  if (more == 0) return;
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    for (uint32_t n = 0; n < 3 && w->rigid.bodies[b].motion == FRAY_FREE; ++n)
      w->rigid.states[b].remainder[n] = fx_round(w->rigid.states[b].remainder[n], more);
}

int bodies_step(fray_world *w, vec3 gravity, unsigned more) {
  int moved = 0;
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b) {
    if (w->rigid.bodies[b].motion != FRAY_FREE) continue;
    move_body(w, b, gravity, more);
    moved = 1;
  }
  return moved;
}

void body_update_velocity(fray_world *w, uint32_t b) {
  body_motion *m = &w->rigid.motion[b];
  body_state *s = &w->rigid.states[b];
  const int64_t bound = (int64_t)1 << 32;
  FRAY_ASSERT(w->rigid.bodies[b].mass_ratio >= 0);
  for (uint32_t n = 0; n < 3; ++n) {
    const int64_t gained = fx_clamp64(m->impulse[n] - m->applied[n], -bound, bound);
    const int64_t change =
        (int64_t)(uint32_t)s->fraction[n] - fx_mul64(gained, w->rigid.bodies[b].mass_ratio);
    m->applied[n] = m->impulse[n];
    s->velocity[n] = fx_saturate(s->velocity[n] + fx_asr64(change, 30));
    s->fraction[n] = (int32_t)(change & ((1 << 30) - 1));
  }
}

/* In two parts of the impulse, as the product of all of it has 76 bits. */
void body_gain(fray_world *w, uint32_t b, uint32_t axis, int64_t impulse) {
  body_state *s = &w->rigid.states[b];
  const int32_t ratio = w->rigid.bodies[b].mass_ratio;
  FRAY_ASSERT(impulse >> 46 == 0 || impulse >> 46 == -1);
  const int64_t high = fx_mul64(fx_asr64(impulse, 16), ratio);
  const int64_t change = (int64_t)(uint32_t)s->fraction[axis] + (high & ((1 << 14) - 1)) * (1 << 16) +
                         fx_mul64(impulse & 0xFFFF, ratio);
  s->velocity[axis] = fx_saturate(s->velocity[axis] + fx_asr64(high, 14) + fx_asr64(change, 30));
  s->fraction[axis] = (int32_t)(change & ((1 << 30) - 1));
}

void bodies_update_velocity(fray_world *w) {
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    if (w->rigid.bodies[b].motion == FRAY_FREE) body_update_velocity(w, b);
}
