/* SPDX-License-Identifier: Apache-2.0 */
/* Yarns with a stiffness in newtons; scalar only, there is no SIMD twin. A link of rest length r pulls its
 * ends together with the force EA (|d|/r - 1), whatever the solver does; compressed, it pushes with
 * k_struct, as in strain_limit.c. The force is explicit, at elastic steps of its own: a substep of length h
 * is 2^b elastic steps of h / 2^b, each a kick of all links at once and then a move (symplectic Euler),
 * which is stable for k (h / 2^b)^2 / m < 1/2: the scene compiler chooses b. Gravity and the motion of driven
 * bodies with what they hold are spread evenly over them; free bodies move in each. Nothing projects these
 * links: a limit that moved positions behind the steps drew particles into bodies, and made up to 2.7 times
 * what was turned over.
 *
 * An elastic step changes velocities, Q28 lu per substep, by d * e * phi(u) * gain, e = |d|^2 - R^2 in the
 * direction units of strain_limit.c, u = e/R^2, and phi(u) = (1 - 1/sqrt(1+u)) / u: a quartic, within 0.03
 * % for stretches to 25 %, 0.2 % for compressions to 25 %. Beyond that u phi(u) stays, and the force grows
 * with d alone. Lengths have 32-bit products and are known to 1/20 of a position step. The rest has 64 bits:
 * with 16-bit directions and forces of 11 bits the force went in stairs of 2^-12 of itself, and a yarn at 4 %
 * began to oscillate, to 3 % of its tension. Of one link along an axis they are held at
 * YARN_ELASTIC_IMPULSE_MAX, which FRAY_FAULT_OVERSTRETCHED says. Impulses are equal and opposite; those of
 * stretch do not depend on the order of the links, those of damping, which come before them, do.
 *
 * Positions move by v / 2^b and keep the remainder of rounding. */
#include "rt/contact/contact.h"
#include "rt/elastic/step_impulse.h"
#include "rt/energy/energy.h"
#include "rt/integrate/integrate.h"
#include "rt/simd/simd.h"
#include "rt/state/crossing.h"
#include "rt/woven/woven.h"
#include "rt/woven/woven_links.h"
#include "rt/woven/yarn_slip.h"

enum {
  STRETCH_SPEED_MAX = FX_SPEED_MAX - (1 << 25), /* four links more fit 32 bits */
  STRETCH_D_MAX = LINK_HI_MAX << LINK_SHIFT
};

typedef struct {
  link_view links;
  int32_t *restrict vx, *restrict vy, *restrict vz;
  const yarn_gain *gains;
} yarn_elastic_view;

/* next + u * y; u is Q26. */
static inline int32_t horner(int32_t u, int32_t y, int32_t next) {
  return next + (int32_t)fx_asr64(fx_mul_wide(u, y), 26);
}

/* Q28; |u| below 9/16 */
static inline int32_t phi_of(int32_t u) {
  const int32_t y = horner(u, horner(u, STRETCH_PHI_4, STRETCH_PHI_3), STRETCH_PHI_2);
  return horner(u, horner(u, y, STRETCH_PHI_1), STRETCH_PHI_0);
}

static inline vec3 dv_of(vec3 d, int32_t pull, int32_t down) {
  return vec_round_clamped(vec_scale64(d, pull), (unsigned)down, YARN_ELASTIC_IMPULSE_MAX);
}

/* dv of end i from the speed at which the ends separate, along the link; fits for any velocities. The gain is
 * for a link at rest: one that is far longer counts as a half or a quarter of itself, else a step would
 * reverse what it damps. */
static inline vec3 damping_impulse(const yarn_elastic_view *s, uint32_t i, uint32_t j, uint32_t class) {
  vec3 hi = vec_clamp(link_coarse_vec(link_vec(&s->links, i, j)), LINK_HI_MAX);
  uint32_t squared = (uint32_t)vec_squared(hi); /* below 2^30 */
  for (; squared > (uint32_t)s->links.classes[class].n_max; squared /= 4) hi = vec_asr(hi, 1);
  const vec3 apart = vec_sub_saturated(vec_at(s->vx, s->vy, s->vz, j), vec_at(s->vx, s->vy, s->vz, i));
  const int32_t speed = fx_saturate(fx_round64(vec_dot64(hi, apart), 13));
  const int32_t pull = fx_mul_saturated(speed, s->gains[class].damping, 24);
  return dv_of(hi, pull, 12);
}

/* dv of end i; end j gets the opposite. */
static inline vec3 elastic_impulse_of(const yarn_elastic_view *s, uint32_t i, uint32_t j, uint32_t class) {
  const link_class *c = &s->links.classes[class];
  const yarn_gain *k = &s->gains[class];
  const vec3 d = link_vec(&s->links, i, j);
  const uint32_t squared = link_squared(d, link_coarse_vec(d));
  const uint32_t n = squared < (uint32_t)c->n_max ? squared : (uint32_t)c->n_max;
  const int32_t e = fx_max((int32_t)n - c->r2, -(c->r2 / 16 * 7)); /* below 2^26 */
  const int32_t u = (int32_t)fx_asr64(fx_mul_wide(e, c->inverse), 10);
  const int32_t size = (int32_t)fx_asr64(fx_mul_wide(e, phi_of(u)), 22);
  const int32_t mantissa = e >= 0 ? k->pull : k->push;
  const int32_t down = e >= 0 ? k->pull_scale : k->push_scale;
  const int32_t pull = fx_mul_round(size, mantissa, 30);
  return dv_of(d, pull, down);
}

/* Returns a span of all impulses: YARN_ELASTIC_IMPULSE_MAX or more iff one was held there. */
static uint32_t apply_links(fray_world *w, const yarn_elastic_view *s, uint32_t first, uint32_t end,
                            int32_t attached, int damp) {
  uint32_t span = 0;
  for (uint32_t link = first; link < end; ++link) {
    const uint32_t kind = s->links.kind[link];
    if (kind == SPRING_DEAD) continue;
    const uint32_t i = s->links.i[link];
    const uint32_t j = s->links.j[link];
    FRAY_ASSERT(j >= particles_attached(w) && (i < particles_attached(w)) == (attached == BATCH_ATTACHED));
    const vec3 dv = damp ? damping_impulse(s, i, j, kind & SPRING_CLASS)
                         : elastic_impulse_of(s, i, j, kind & SPRING_CLASS);
    span |= vec_span(dv);
    vec_add_at(s->vx, s->vy, s->vz, j, vec_mul(dv, -particle_inverse_mass(w, j)));
    if (attached == BATCH_ATTACHED) /* the body gets the opposite of end j's impulse */
      body_take_impulse(&w->rigid.motion[w->p.attach_body[i]], dv);
    else
      vec_add_at(s->vx, s->vy, s->vz, i, vec_mul(dv, particle_inverse_mass(w, i)));
  }
  return span;
}

static void apply_batches(fray_world *w, const yarn_elastic_view *s, int damp) {
  const uint32_t batches = (uint32_t)w->params->link_batches;
  uint32_t b = 0;
  while (b < batches) {
    const int32_t attached = w->woven.batches[b].attached;
    const uint32_t first = (uint32_t)w->woven.batches[b].first;
    const uint32_t end = world_batch_run(w, &b, batches);
    if (attached == BATCH_INACTIVE) continue;
    const uint32_t span = apply_links(w, s, first, end, attached, damp);
    if (span >= YARN_ELASTIC_IMPULSE_MAX) world_fault(w, FRAY_FAULT_OVERSTRETCHED);
    w->work.yarn_forces += end - first;
  }
}

/* Damping before stretch: between the impulses of its two neighbours a particle at rest seems to move. */
static void apply_forces(fray_world *w, const yarn_elastic_view *s) {
  energy_step_mark(w, YARN_STEP_BEGUN);
  if (w->woven.elastic_params->damping_ns != 0) apply_batches(w, s, 1);
  energy_step_mark(w, YARN_STEP_DAMPED);
  apply_batches(w, s, 0);
}

/* Moves one component by an elastic step of 2^-bits of a substep; rounding: the position below Q24, in
 * 2^-(28 + bits) lu. Returns 0 iff no particle is at the world's edge. */
static uint32_t advance_axis(int32_t *restrict x, int32_t *restrict rounding, int32_t *restrict v,
                             uint32_t first, uint32_t end, int32_t gravity, unsigned bits) {
  const unsigned down = FX_SUB_BITS + bits;
  uint32_t at_edge = 0;
  for (uint32_t p = first; p < end; ++p) {
    const int32_t speed = fx_clamp_rare(v[p], -STRETCH_SPEED_MAX, STRETCH_SPEED_MAX) + gravity;
    const int32_t step = speed + rounding[p];
    const int32_t whole = fx_round(step, down);
    const int32_t moved = fx_add(x[p], whole);
    const int32_t clamped = fx_clamp_rare(moved, -FX_WORLD_MAX, FX_WORLD_MAX);
    at_edge |= (uint32_t)(moved ^ clamped);
    v[p] = moved == clamped ? speed : 0; /* the edge stops it, as in loop_advance() */
    rounding[p] = step - whole * (1 << down);
    x[p] = clamped;
  }
  return at_edge;
}

/* Attached particles move with the velocity of their bodies; particles_carry() puts them to their final
 * positions. */
static void begin_axis(fray_world *w, uint32_t axis, int32_t *v) {
  const uint32_t attached = particles_attached(w);
  for (uint32_t p = 0; p < attached; ++p) v[p] = w->rigid.states[w->p.attach_body[p]].velocity[axis];
  for (uint32_t p = attached; p < w->p.count; ++p)
    v[p] = fx_clamp(v[p], -STRETCH_SPEED_MAX, STRETCH_SPEED_MAX);
}

static void begin_rounding(fray_world *w, uint32_t axis, const int8_t *remainder) {
  const uint32_t attached = particles_attached(w);
  const int32_t steps = 1 << w->woven.elastic_params->steps_bits;
  int32_t *rounding = w->p.rounding[axis];
  for (uint32_t p = 0; p < attached; ++p) rounding[p] = 0;
  for (uint32_t p = attached; p < w->p.count; ++p) rounding[p] = remainder[p] * steps;
}

/* predicted: the array that held the rounding. */
static void end_axis(fray_world *w, int32_t *predicted, int8_t *remainder, const int32_t *x) {
  const unsigned bits = (unsigned)w->woven.elastic_params->steps_bits;
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
    remainder[p] = (int8_t)(bits == 0 ? predicted[p] : fx_round(predicted[p], bits));
    predicted[p] = x[p];
  }
}

/* What free bodies hold has their velocities. */
static void follow_bodies(fray_world *w) {
  for (uint32_t p = 0; p < particles_attached(w); ++p) {
    const uint32_t b = w->p.attach_body[p];
    if (w->rigid.bodies[b].motion == FRAY_FREE) world_set_velocity(w, p, vec_of(w->rigid.states[b].velocity));
  }
}

/* The part of a substep's gravity in an elastic step; all of them add up to `gravity`. */
static int32_t gravity_part(int32_t gravity, int32_t step, unsigned bits) {
  if (bits == 0) return gravity;
  return fx_asr(gravity * (step + 1), bits) - fx_asr(gravity * step, bits);
}

/* Behind the first pull, by which yarns that a mesh holds would leave their place. */
static void find_planes(fray_world *w) {
  if (world_has_rigid_meshes(w)) contact_yarn_planes_find(w);
  begin_rounding(w, 0, w->p.rx);
  begin_rounding(w, 1, w->p.ry);
  begin_rounding(w, 2, w->p.rz);
}

void yarn_stretch_run(fray_world *w) {
  FRAY_ASSERT(world_has_elastic_yarns(w) && !world_has_membrane(w));
  FRAY_ASSERT(w->woven.elastic_params->steps_bits <= YARN_ELASTIC_STEPS_BITS);
  const yarn_elastic_view s = {woven_links(w), w->p.vx, w->p.vy, w->p.vz, w->woven.yarn_gains};
  const uint32_t attached = particles_attached(w);
  const uint32_t end = w->p.count;
  const unsigned bits = (unsigned)w->woven.elastic_params->steps_bits;
  const vec3 g = w->gravity_step;
  int32_t *const *rounding = w->p.rounding; /* until the predicted positions are written, at the end */
  uint32_t at_edge = 0;
  begin_axis(w, 0, w->p.vx);
  begin_axis(w, 1, w->p.vy);
  begin_axis(w, 2, w->p.vz);
  if (world_has_rigid_meshes(w)) contact_yarn_planes_begin(w);
  bodies_steps_begin(w, bits);
  yarn_step now = {0, bits, step_rise_of(w), {0, 0, 0}};
  for (int32_t step = 0; step < 1 << bits; ++step) {
    const vec3 gravity = vec_make(gravity_part(g.x, step, bits), gravity_part(g.y, step, bits),
                                  gravity_part(g.z, step, bits));
    contact_steps_mark(w);
    apply_forces(w, &s);
    energy_pulled(w);
    if (world_has_yarns(w)) yarn_slip_apply(w);
    bodies_update_velocity(w);
    contact_steps_pulled(w);
    if (step == 0) find_planes(w);
    energy_step_mark(w, YARN_STEP_FORCED);
    now.number = step;
    now.gravity = gravity;
    contact_steps_solve(w, &now);
    energy_step(w, gravity);
    if (bodies_step(w, gravity, bits)) follow_bodies(w);
    (void)advance_axis(w->p.x, rounding[0], w->p.vx, 0, attached, 0, bits);
    (void)advance_axis(w->p.y, rounding[1], w->p.vy, 0, attached, 0, bits);
    (void)advance_axis(w->p.z, rounding[2], w->p.vz, 0, attached, 0, bits);
    at_edge |= advance_axis(w->p.x, rounding[0], w->p.vx, attached, end, gravity.x, bits);
    at_edge |= advance_axis(w->p.y, rounding[1], w->p.vy, attached, end, gravity.y, bits);
    at_edge |= advance_axis(w->p.z, rounding[2], w->p.vz, attached, end, gravity.z, bits);
    energy_elastic_step(w);
  }
  bodies_steps_end(w, bits);
  end_axis(w, w->p.qx, w->p.rx, w->p.x);
  end_axis(w, w->p.qy, w->p.ry, w->p.y);
  end_axis(w, w->p.qz, w->p.rz, w->p.z);
  if (at_edge != 0) world_fault(w, FRAY_FAULT_OUT_OF_WORLD);
  w->work.particle_steps += end - attached;
}
