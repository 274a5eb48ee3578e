/* SPDX-License-Identifier: Apache-2.0 */
/* Velocities take over what projections and collisions did to the positions, then are
 * manipulated where particles touch bodies (Metaaphanon 2009, section 4, step 8, after Mueller
 * et al. 2007: a touching particle keeps no velocity away from the body that the push gave it). */
#include "rt/model/couples.h"
#include "rt/model/heft.h"
#include "rt/stage/stage.h"
#include "rt/wide/wide.h"

static int32_t slowed(int32_t v, int32_t lost) {
  return (int32_t)fx_clamp64((int64_t)v - lost, -FX_SPEED_MAX, FX_SPEED_MAX);
}

/* A light particle loses an even speed, so that its momentum is a whole number too. */
static int32_t parts_of(const fray_world *w, uint32_t p) {
  return world_has_yarns(w) && couple_is_light(w, p) ? 2 : 1;
}

static void settle_contact(fray_world *w, const contact *c, const heft *weighs) {
  const uint32_t p = c->particle;
  const int32_t *bv = w->body_states[c->body].velocity;
  const vec3 away = vec_make(fx_saturate((int64_t)w->vx[p] - bv[0]),
                             fx_saturate((int64_t)w->vy[p] - bv[1]),
                             fx_saturate((int64_t)w->vz[p] - bv[2]));
  const int32_t speed = vec_dot_unit(away, c->normal);
  if (speed <= 0) return;
  const int32_t parts = parts_of(w, p);
  const vec3 lost = vec_scale_unit(c->normal, speed / parts);
  w->vx[p] = slowed(w->vx[p], lost.x * parts);
  w->vy[p] = slowed(w->vy[p], lost.y * parts);
  w->vz[p] = slowed(w->vz[p], lost.z * parts);
  if (weighs->per_mass != 0) {
    const int32_t mass = heft_at(weighs, p);
    body_gave(&w->motion[c->body], -heft_times(mass, lost.x, 0), -heft_times(mass, lost.y, 0),
              -heft_times(mass, lost.z, 0));
    return;
  }
  body_gave(&w->motion[c->body], -(int64_t)lost.x, -(int64_t)lost.y, -(int64_t)lost.z);
}

/* The same where the normal is (0, 1, 0). */
static void settle_level(fray_world *w, const contact *c, const heft *weighs) {
  const uint32_t p = c->particle;
  const int32_t speed = fx_saturate((int64_t)w->vy[p] - w->body_states[c->body].velocity[1]);
  if (speed <= 0) return;
  const int32_t parts = parts_of(w, p);
  const int32_t lost = speed / parts;
  w->vy[p] = slowed(w->vy[p], lost * parts);
  const int64_t gave = weighs->per_mass != 0 ? heft_times(heft_at(weighs, p), lost, 0) : lost;
  body_gave(&w->motion[c->body], 0, -gave, 0);
}

/* A free body gets the opposite of what the cloth gained from it since the last substep. */
static void push_body(fray_world *w, uint32_t b) {
  body_motion *m = &w->motion[b];
  body_state *s = &w->body_states[b];
  const int64_t bound = (int64_t)1 << 32;
  for (uint32_t n = 0; n < 3; ++n) {
    const int64_t gained = fx_clamp64(m->impulse[n] - m->settled[n], -bound, bound);
    const int64_t change =
        (int64_t)(uint32_t)s->fraction[n] - fx_mul64(gained, w->bodies[b].yield);
    m->settled[n] = m->impulse[n];
    s->velocity[n] = fx_saturate(s->velocity[n] + fx_asr64(change, 30));
    s->fraction[n] = (int32_t)(change & ((1 << 30) - 1));
  }
}

void finish_part(fray_world *w, uint32_t first, uint32_t end) {
  wide_take_over(w->kernel, w->x, w->qx, w->vx, first, end);
  wide_take_over(w->kernel, w->y, w->qy, w->vy, first, end);
  wide_take_over(w->kernel, w->z, w->qz, w->vz, first, end);
}

void finish_contacts(fray_world *w, uint32_t first, uint32_t end) {
  const heft weighs = heft_of(w);
  for (uint32_t n = first; n < end; ++n) {
    const contact *c = &w->contacts[n];
    if (!FX_NARROW && c->touching == CONTACT_LEVEL)
      settle_level(w, c, &weighs);
    else if (c->touching != 0)
      settle_contact(w, c, &weighs);
  }
}

void finish_run(fray_world *w) {
  finish_part(w, (uint32_t)w->params->held, w->particles);
  finish_contacts(w, 0, w->contact_count);
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    if (w->bodies[b].motion == FRAY_FREE) push_body(w, b);
}
