/* SPDX-License-Identifier: Apache-2.0 */
/* A free body that stood still for a substep while its cloth moved in many steps would be loaded
 * all that time, and shoot back. So its velocity follows every impulse at once, and it moves in
 * each step as a vertex does. */
#include "rt/elastic/step_bodies.h"

#include "rt/integrate/integrate.h"

enum { BODY_SPEED_MAX = INT32_MAX - (1 << 25) };

static int is_free(const fray_world *w, uint32_t b) {
  return w->rigid.bodies[b].motion == FRAY_FREE;
}

void step_bodies_begin(fray_world *w) {
  FRAY_ASSERT(world_has_membrane(w) && (uint32_t)w->params->bodies <= w->capacity[POOL_BODIES]);
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b) {
    elastic_body *e = &w->membrane.bodies[b];
    const body_state *s = &w->rigid.states[b];
    e->start = vec_sub(vec_of(s->position), w->rigid.motion[b].moved);
    const int32_t start[3] = {e->start.x, e->start.y, e->start.z};
    for (uint32_t n = 0; n < 3; ++n) {
      e->at[n] = fx_wrap_add(fx_wrap_shift(start[n], FX_SUB_BITS), s->remainder[n]);
      e->low[n] = 1 << (ELASTIC_LOW_BITS - 1);
      e->moved[n] = 0;
    }
  }
}

static void pull_body(fray_world *w, uint32_t p) {
  enum { MORE = 1 << (FX_VELOCITY_BITS - ELASTIC_IMPULSE_BITS) };
  const elastic_impulse *sum = &w->membrane.impulse[p];
  const vec64 gained = {-(int64_t)sum->x * MORE, -(int64_t)sum->y * MORE, -(int64_t)sum->z * MORE};
  FRAY_ASSERT(w->p.attach_body[p] < w->capacity[POOL_BODIES]);
  body_add_impulse(&w->rigid.motion[w->p.attach_body[p]], gained);
}

void step_bodies_pull(fray_world *w, const elastic_step *step) {
  for (uint32_t p = 0; p < particles_attached(w); ++p) pull_body(w, p);
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b) {
    int32_t *v = w->rigid.states[b].velocity;
    vec_store(w->membrane.bodies[b].before, vec_of(v));
    if (!is_free(w, b)) continue;
    body_update_velocity(w, b);
    for (uint32_t n = 0; n < 3; ++n)
      v[n] = fx_clamp_wide((int64_t)v[n] + step->gravity[n], BODY_SPEED_MAX);
  }
}

static void move_body(fray_world *w, uint32_t b, const elastic_step *step, int32_t number) {
  elastic_body *e = &w->membrane.bodies[b];
  const vec3 moved = w->rigid.motion[b].moved;
  const int32_t way[3] = {moved.x, moved.y, moved.z};
  for (uint32_t n = 0; n < 3; ++n) {
    const int32_t before = e->at[n];
    if (is_free(w, b)) {
      const int64_t travel = fx_mul_wide(w->rigid.states[b].velocity[n], step->part) + e->low[n];
      e->low[n] = (int32_t)(travel & INT32_MAX);
      e->at[n] = fx_wrap_add(e->at[n], (int32_t)fx_asr64(travel, ELASTIC_LOW_BITS));
    } else if (way[n] != 0) {
      e->at[n] = fx_wrap_add(e->at[n], step_part_of(fx_wrap_shift(way[n], FX_SUB_BITS), number,
                                                    w->membrane.constants->steps));
    }
    e->moved[n] = fx_wrap_sub(e->at[n], before);
  }
}

static void carry_vertex(fray_world *w, uint32_t p) {
  const elastic_body *e = &w->membrane.bodies[w->p.attach_body[p]];
  elastic_position *place = &w->membrane.positions[p];
  for (uint32_t n = 0; n < 3; ++n) place->at[n] = fx_wrap_add(place->at[n], e->moved[n]);
  place->low_bits = elastic_low_bits(e->low[0], e->low[1], e->low[2]);
}

void step_bodies_move(fray_world *w, const elastic_step *step, int32_t n) {
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b) move_body(w, b, step, n);
  for (uint32_t p = 0; p < particles_attached(w); ++p) carry_vertex(w, p);
}

static void end_body(fray_world *w, uint32_t b) {
  body_state *s = &w->rigid.states[b];
  const elastic_body *e = &w->membrane.bodies[b];
  const int32_t start[3] = {e->start.x, e->start.y, e->start.z};
  int32_t moved[3] = {0, 0, 0};
  for (uint32_t n = 0; n < 3; ++n) {
    const int32_t travel = fx_wrap_sub(e->at[n], fx_wrap_shift(start[n], FX_SUB_BITS));
    const int32_t whole = fx_round(travel, FX_SUB_BITS);
    const int32_t place = fx_clamp(fx_add(start[n], whole), -FX_WORLD_MAX, FX_WORLD_MAX);
    if (place != start[n] + whole) {
      s->velocity[n] = 0;
      world_fault(w, FRAY_FAULT_OUT_OF_WORLD);
    }
    s->remainder[n] = travel - whole * (1 << FX_SUB_BITS);
    s->position[n] = place;
    moved[n] = place - start[n];
  }
  w->rigid.motion[b].moved = vec_of(moved);
}

void step_bodies_end(fray_world *w) {
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    if (is_free(w, b)) end_body(w, b);
}
