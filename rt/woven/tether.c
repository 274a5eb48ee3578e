/* SPDX-License-Identifier: Apache-2.0 */
/* A free body on projected yarns gets no more than the momentum of the particles that it holds: a heavy one
 * sank without end, and drew links to 600 times their length. So where links are overstretched, none goes
 * farther from what holds the cloth than half as far again as the cloth reaches, along a weft and a warp
 * (after the long range attachments of Kim, Chentanez, Mueller-Fischer 2012): the pair that is farthest
 * beyond that stops it at the velocity, and the other body gets its momentum. Of whole cloth only: a way
 * along torn or split yarns leads nowhere. */
#include "rt/state/crossing.h"
#include "rt/woven/woven.h"

enum { COARSE = 16 }; /* so that three squares fit */

/* From a particle of a free body to one of a driven body, or a fixed one. */
typedef struct {
  uint32_t held, holder;
  uint32_t excess; /* of the squared distance, in units of 2^COARSE; 0: it reaches */
} tether;

static int is_whole(const fray_world *w) {
  const uint32_t links = (uint32_t)w->params->links;
  uint32_t n = 0;
  while (n < links && w->woven.spring_kind[n] != SPRING_DEAD) ++n;
  return n == links && !world_has_yarns(w);
}

static const rigid_body *body_of(const fray_world *w, uint32_t p) {
  return &w->rigid.bodies[w->p.attach_body[p]];
}

/* The first crossing that a body holds, or all of them. */
static uint32_t crossing_held(const fray_world *w, uint32_t b) {
  uint32_t c = 0;
  while (c < w->capacity[POOL_CROSSINGS] &&
         (!crossing_is_attached(w, c) || w->p.attach_body[w->woven.crossing_particle[c]] != b))
    ++c;
  return c;
}

static uint32_t apart(uint32_t a, uint32_t b) { return a < b ? b - a : a - b; }

/* In units of 2^COARSE. */
static uint32_t reach_between(const fray_world *w, uint32_t a, uint32_t c) {
  enum { FINE = COARSE - 4 };
  const uint32_t warps = (uint32_t)w->params->warps;
  const link_class *k = w->woven.link_classes;
  const uint32_t weft = apart(a % warps, c % warps) * ((uint32_t)k[CLASS_WEFT].rest >> (COARSE - FINE));
  const uint32_t warp = apart(a / warps, c / warps) * ((uint32_t)k[CLASS_WARP].rest >> (COARSE - FINE));
  const uint32_t reach = ((weft + warp) >> FINE) * 3u / 2u + 1u;
  return reach < UINT16_MAX ? reach : UINT16_MAX;
}

static tether farthest_of(const fray_world *w, uint32_t a) {
  tether t = {w->woven.crossing_particle[a], 0, 0};
  for (uint32_t c = 0; c < w->capacity[POOL_CROSSINGS]; ++c) {
    const uint32_t q = w->woven.crossing_particle[c];
    if (!particle_is_attached(w, q) || !body_is_driven(body_of(w, q))) continue;
    const vec3 d = vec_asr(vec_sub(world_position(w, t.held), world_position(w, q)), COARSE);
    const uint32_t squared =
        (uint32_t)fx_mul(d.x, d.x) + (uint32_t)fx_mul(d.y, d.y) + (uint32_t)fx_mul(d.z, d.z);
    const uint32_t reach = reach_between(w, a, c);
    if (squared <= reach * reach || squared - reach * reach <= t.excess) continue;
    t.excess = squared - reach * reach;
    t.holder = q;
  }
  return t;
}

/* It comes back as fast as it went, at most at what gravity gives it in a tick, so that it does not sink: it
 * has no more energy than before. */
__attribute__((noinline)) static void hold_body(fray_world *w, uint32_t b, const tether *t) {
  enum { MOMENTUM_BITS = 48 };
  const params *const p = w->params;
  const uint32_t other = w->p.attach_body[t->holder];
  int32_t *velocity = w->rigid.states[b].velocity;
  const vec3 way = vec_sub(world_position(w, t->held), world_position(w, t->holder));
  const vec3 away = vec_unit(way, vec_make(0, 0, 0));
  const int32_t gravity = vec_dot_unit(vec_make(p->gravity_x, p->gravity_y, p->gravity_z), away);
  const int32_t speed =
      vec_dot_unit(vec_sub_saturated(vec_of(velocity), vec_of(w->rigid.states[other].velocity)), away);
  world_fault(w, FRAY_FAULT_OVERSTRETCHED);
  if (speed <= 0) return;
  const int64_t back = fx_clamp64((int64_t)gravity * p->substeps, 0, speed);
  const vec3 lost = vec_scale_unit(away, fx_saturate(speed + back));
  const int32_t change[3] = {lost.x, lost.y, lost.z};
  const int64_t most = (int64_t)1 << MOMENTUM_BITS;
  for (uint32_t n = 0; n < 3; ++n) {
    int64_t *impulse = &w->rigid.motion[other].impulse[n];
    const int64_t momentum = (int64_t)change[n] * (1 << 30) / w->rigid.bodies[b].mass_ratio;
    velocity[n] = fx_saturate((int64_t)velocity[n] - change[n]);
    *impulse = fx_add64(*impulse, -fx_clamp64(momentum, -most, most));
  }
}

void tethers_apply(fray_world *w) {
  FRAY_ASSERT(world_is_projected(w));
  if (!is_whole(w)) return;
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b) {
    if (body_is_driven(&w->rigid.bodies[b])) continue;
    const uint32_t a = crossing_held(w, b);
    if (a == w->capacity[POOL_CROSSINGS]) continue;
    const tether t = farthest_of(w, a);
    if (t.excess != 0) hold_body(w, b, &t);
  }
}
