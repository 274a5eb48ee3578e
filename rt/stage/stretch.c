/* SPDX-License-Identifier: Apache-2.0 */
/* Yarns with a stiffness in newtons. A link of rest length r pulls its ends together with the force
 * EA (|d|/r - 1), whatever the solver does; pressed, it pushes with k_struct, as in strain.c. The
 * force is explicit, at inner steps of its own: a substep of length h is 2^b inner steps of h /
 * 2^b, each a kick of all links at once and then a move (symplectic Euler), which is stable for k
 * (h / 2^b)^2 / m < 1/2: the scene compiler chooses b. Gravity and the way of held particles come
 * in equal parts. Projection (strain.c) holds what is longer than the image's limit, which is above
 * every tear strain.
 *
 * An inner step changes velocities, Q28 lu per substep, by d * e * phi(u) * gain, e = |d|^2 - R^2
 * in the direction units of strain.c, u = e/R^2, and phi(u) = (1 - 1/sqrt(1+u)) / u: a quartic,
 * within 0.03 % for stretches to 25 %, 0.2 % for squeezes to 25 %. What is outside of that pulls as
 * at 25 %. Lengths have 32-bit products and are known to 1/20 of a position step. What follows has
 * 64 bits: with 16-bit directions and forces of 11 bits the force went in stairs of 2^-12 of
 * itself, and a yarn at 4 % began to sing, to 3 % of its tension. Impulses are equal and opposite;
 * those of stretch do not depend on the order of the rows, those of damping, which come before
 * them, do.
 *
 * Positions move by v / 2^b and keep what rounding leaves, in the arrays of predicted positions. */
#include "rt/model/couples.h"
#include "rt/stage/stage.h"
#include "rt/wide/wide.h"

enum {
  STRETCH_DV_MAX = 1 << 27, /* one link, one pass: four whole ends or two light ones, twice, fit */
  STRETCH_SPEED_MAX = FX_SPEED_MAX - (1 << 25), /* four links more fit 32 bits */
  STRETCH_D_MAX = LINK_HI_MAX << LINK_SHIFT,
  /* phi, Q28, in powers of u */
  STRETCH_PHI_0 = 1 << 27,
  STRETCH_PHI_1 = -101005220,
  STRETCH_PHI_2 = 88514470,
  STRETCH_PHI_3 = -82736220,
  STRETCH_PHI_4 = 47846700
};

typedef struct {
  link_view at;
  int32_t *restrict vx, *restrict vy, *restrict vz;
  const stretch_class *pulls;
} stretch_view;

/* next + u * y; u is Q26. */
static inline int32_t horner(int32_t u, int32_t y, int32_t next) {
  return next + (int32_t)fx_asr64(fx_mul_wide(u, y), 26);
}

/* Q28; |u| below 9/16 */
static inline int32_t phi_of(int32_t u) {
  const int32_t y = horner(u, horner(u, STRETCH_PHI_4, STRETCH_PHI_3), STRETCH_PHI_2);
  return horner(u, horner(u, y, STRETCH_PHI_1), STRETCH_PHI_0);
}

static inline int32_t scaled(int32_t d, int32_t pull, int32_t down) {
  return (int32_t)fx_clamp64(fx_round64(fx_mul_wide(d, pull), (unsigned)down), -STRETCH_DV_MAX,
                             STRETCH_DV_MAX);
}

static inline vec3 bounded(vec3 d) {
  return vec_make(fx_clamp(d.x, -STRETCH_D_MAX, STRETCH_D_MAX),
                  fx_clamp(d.y, -STRETCH_D_MAX, STRETCH_D_MAX),
                  fx_clamp(d.z, -STRETCH_D_MAX, STRETCH_D_MAX));
}

/* dv of end i from the speed at which the ends part, along the link; fits whatever the velocities
 * are. */
static inline vec3 damping_impulse(const stretch_view *s, uint32_t i, uint32_t j, uint32_t kind) {
  const vec3 d = vec_make(fx_sub(s->at.x[j], s->at.x[i]), fx_sub(s->at.y[j], s->at.y[i]),
                          fx_sub(s->at.z[j], s->at.z[i]));
  const vec3 hi = vec_make(fx_clamp(link_coarse(d.x), -LINK_HI_MAX, LINK_HI_MAX),
                           fx_clamp(link_coarse(d.y), -LINK_HI_MAX, LINK_HI_MAX),
                           fx_clamp(link_coarse(d.z), -LINK_HI_MAX, LINK_HI_MAX));
  const int64_t along = fx_mul_wide(hi.x, fx_saturate((int64_t)s->vx[j] - s->vx[i])) +
                        fx_mul_wide(hi.y, fx_saturate((int64_t)s->vy[j] - s->vy[i])) +
                        fx_mul_wide(hi.z, fx_saturate((int64_t)s->vz[j] - s->vz[i]));
  const int32_t speed = fx_saturate(fx_round64(along, 13));
  const int32_t part = fx_saturate(fx_round64(fx_mul_wide(speed, s->pulls[kind].damping), 24));
  return vec_make(scaled(hi.x, part, 12), scaled(hi.y, part, 12), scaled(hi.z, part, 12));
}

/* dv of end i; end j gets the opposite. */
static inline vec3 stretch_impulse(const stretch_view *s, uint32_t i, uint32_t j, uint32_t kind) {
  const link_class *c = &s->at.classes[kind];
  const stretch_class *k = &s->pulls[kind];
  vec3 d = vec_make(fx_sub(s->at.x[j], s->at.x[i]), fx_sub(s->at.y[j], s->at.y[i]),
                    fx_sub(s->at.z[j], s->at.z[i]));
  vec3 hi = vec_make(link_coarse(d.x), link_coarse(d.y), link_coarse(d.z));
  uint32_t n = link_squared(d, hi);
  if (__builtin_expect(n > (uint32_t)c->n_max, 0)) {
    n = (uint32_t)c->n_max;
    d = bounded(d);
    hi = vec_make(link_coarse(d.x), link_coarse(d.y), link_coarse(d.z));
  }
  const int32_t e = fx_max((int32_t)n - c->r2, -(c->r2 / 16 * 7)); /* below 2^26 */
  const int32_t u = (int32_t)fx_asr64(fx_mul_wide(e, c->inverse), 10);
  const int32_t size = (int32_t)fx_asr64(fx_mul_wide(e, phi_of(u)), 22);
  const int32_t mantissa = e >= 0 ? k->pull : k->push;
  const int32_t down = e >= 0 ? k->pull_scale : k->push_scale;
  const int32_t pull = (int32_t)fx_round64(fx_mul_wide(size, mantissa), 30);
  return vec_make(scaled(d.x, pull, down), scaled(d.y, pull, down), scaled(d.z, pull, down));
}

static inline void kick(const stretch_view *s, uint32_t p, vec3 dv, int32_t weight) {
  s->vx[p] = fx_add(s->vx[p], dv.x * weight);
  s->vy[p] = fx_add(s->vy[p], dv.y * weight);
  s->vz[p] = fx_add(s->vz[p], dv.z * weight);
}

/* How light an end is: 2 where it is one yarn of a crossing. */
static inline int32_t lightness(const fray_world *w, uint32_t p) {
  return world_has_yarns(w) && couple_is_light(w, p) ? 2 : 1;
}

static void run_links(fray_world *w, const stretch_view *s, uint32_t first, uint32_t end,
                      int32_t held, int damp) {
  for (uint32_t row = first; row < end; ++row) {
    const uint32_t kind = s->at.kind[row];
    if (kind == ROW_DEAD) continue;
    const uint32_t i = s->at.i[row];
    const uint32_t j = s->at.j[row];
    const vec3 dv = damp ? damping_impulse(s, i, j, kind & ROW_CLASS)
                         : stretch_impulse(s, i, j, kind & ROW_CLASS);
    kick(s, j, dv, -lightness(w, j));
    if (held == BATCH_HELD) /* end i is carried by a body, which gives what end j gains */
      body_gave(&w->motion[w->grip_body[i]], -(int64_t)dv.x, -(int64_t)dv.y, -(int64_t)dv.z);
    else
      kick(s, i, dv, lightness(w, i));
  }
}

static void run_batches(fray_world *w, const stretch_view *s, int damp) {
  const uint32_t batches = (uint32_t)w->params->link_batches;
  uint32_t b = 0;
  while (b < batches) {
    const int32_t held = w->batches[b].held;
    const uint32_t first = (uint32_t)w->batches[b].first;
    const uint32_t end = world_run_of_batches(w, &b, batches);
    if (held == BATCH_IDLE) continue;
    run_links(w, s, first, end, held, damp);
    w->work.stretches += end - first;
  }
}

/* Damping before the pull: between the pulls of its two neighbours a particle at rest would seem to
 * move. */
static void pull_all(fray_world *w, const stretch_view *s) {
  if (w->stretch->damping_ns != 0) run_batches(w, s, 1);
  run_batches(w, s, 0);
}

/* One inner step of 2^-bits of a substep; left: what rounding left over, 2^-(28 + bits) lu. */
static uint32_t inner_advance(int32_t *restrict x, int32_t *restrict left, int32_t *restrict v,
                              uint32_t first, uint32_t end, int32_t gravity, unsigned bits) {
  const unsigned down = FX_SUB_BITS + bits;
  uint32_t at_edge = 0;
  for (uint32_t p = first; p < end; ++p) {
    const int32_t speed = fx_clamp_rare(v[p], -STRETCH_SPEED_MAX, STRETCH_SPEED_MAX) + gravity;
    const int32_t step = speed + left[p];
    const int32_t whole = fx_round(step, down);
    const int32_t moved = fx_add(x[p], whole);
    const int32_t place = fx_clamp_rare(moved, -FX_WORLD_MAX, FX_WORLD_MAX);
    at_edge |= (uint32_t)(moved ^ place);
    v[p] = speed;
    left[p] = step - whole * (1 << down);
    x[p] = place;
  }
  return at_edge;
}

/* Held ends go as fast as their bodies, which have moved on already; predict puts them in place. */
static void begin_axis(fray_world *w, uint32_t axis, int32_t *v, int32_t *left, const int8_t *r) {
  const uint32_t held = (uint32_t)w->params->held;
  const int32_t steps = 1 << w->stretch->steps_bits;
  for (uint32_t p = 0; p < held; ++p) {
    v[p] = w->body_states[w->grip_body[p]].velocity[axis];
    left[p] = 0;
  }
  for (uint32_t p = held; p < w->particles; ++p) {
    v[p] = fx_clamp(v[p], -STRETCH_SPEED_MAX, STRETCH_SPEED_MAX);
    left[p] = r[p] * steps;
  }
}

static void end_axis(fray_world *w, int32_t *left, int8_t *r, const int32_t *x) {
  const unsigned bits = (unsigned)w->stretch->steps_bits;
  for (uint32_t p = (uint32_t)w->params->held; p < w->particles; ++p) {
    r[p] = (int8_t)(bits == 0 ? left[p] : fx_round(left[p], bits));
    left[p] = x[p];
  }
}

/* The part of a substep's gravity that falls on an inner step. */
static int32_t part(int32_t gravity, int32_t step, unsigned bits) {
  if (bits == 0) return gravity;
  return fx_asr(gravity * (step + 1), bits) - fx_asr(gravity * step, bits);
}

void stretch_run(fray_world *w) {
  const stretch_view s = {{w->x, w->y, w->z, w->row_i, w->row_j, w->row_class, w->links,
                           w->capacity[POOL_LINK_CLASSES]},
                          w->vx,
                          w->vy,
                          w->vz,
                          w->pulls};
  const uint32_t held = (uint32_t)w->params->held;
  const uint32_t end = w->particles;
  const unsigned bits = (unsigned)w->stretch->steps_bits;
  const vec3 g = w->gravity_step;
  uint32_t at_edge = 0;
  begin_axis(w, 0, w->vx, w->qx, w->rx);
  begin_axis(w, 1, w->vy, w->qy, w->ry);
  begin_axis(w, 2, w->vz, w->qz, w->rz);
  for (int32_t step = 0; step < 1 << bits; ++step) {
    pull_all(w, &s);
    (void)inner_advance(w->x, w->qx, w->vx, 0, held, 0, bits);
    (void)inner_advance(w->y, w->qy, w->vy, 0, held, 0, bits);
    (void)inner_advance(w->z, w->qz, w->vz, 0, held, 0, bits);
    at_edge |= inner_advance(w->x, w->qx, w->vx, held, end, part(g.x, step, bits), bits);
    at_edge |= inner_advance(w->y, w->qy, w->vy, held, end, part(g.y, step, bits), bits);
    at_edge |= inner_advance(w->z, w->qz, w->vz, held, end, part(g.z, step, bits), bits);
  }
  end_axis(w, w->qx, w->rx, w->x);
  end_axis(w, w->qy, w->ry, w->y);
  end_axis(w, w->qz, w->rz, w->z);
  if (at_edge != 0) w->state->faults |= (int32_t)FRAY_FAULT_LEFT_WORLD;
  w->work.predictions += end - held;
}
