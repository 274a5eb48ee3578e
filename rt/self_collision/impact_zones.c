/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/self_collision/impact_zones.h"

#include "rt/state/crossing.h"
#include "rt/state/vertex_mass.h"

enum { WEIGHT_BITS = 6, WEIGHT_MAX = (1 << 11) - 1 };

/* ---- zones ---- */

/* Keeps a particle where differences of positions fit. */
__attribute__((noinline)) void impact_zones_hold(fray_world *w, uint32_t p) {
  FRAY_ASSERT(p < w->p.count);
  w->p.x[p] = fx_clamp(w->p.x[p], -FX_EDGE_MAX, FX_EDGE_MAX);
  w->p.y[p] = fx_clamp(w->p.y[p], -FX_EDGE_MAX, FX_EDGE_MAX);
  w->p.z[p] = fx_clamp(w->p.z[p], -FX_EDGE_MAX, FX_EDGE_MAX);
}

void impact_zones_begin(fray_world *w) {
  FRAY_ASSERT(w->p.count <= w->capacity[POOL_PARTICLES]);
  for (uint32_t p = 0; p < w->p.count; ++p) {
    impact_zones_hold(w, p);
    w->self.paths[p].end = world_position(w, p);
    w->self.zone_of[p] = (index_t)p;
    w->self.moved_round[p] = 0;
  }
  w->self.merged = 0;
  w->self.round = 1;
}

/* A tree whose entries are so many ids apart. */
typedef struct {
  index_t *first;
  uint32_t stride;
} zone_tree;

static zone_tree tree_of(fray_world *w) {
  const zone_tree t = {w->self.zone_of, 1};
  return t;
}
static zone_tree joined_tree_of(fray_world *w) {
  const zone_tree t = {&w->attempt.vertices->joined, sizeof(attempt_vertex) / sizeof(index_t)};
  return t;
}
static index_t *entry_of(const zone_tree *t, uint32_t p) { return &t->first[p * t->stride]; }

static uint32_t root_of(const zone_tree *t, uint32_t p) {
  uint32_t at = p;
  while (*entry_of(t, at) != at) {
    FRAY_ASSERT(*entry_of(t, at) < at);
    *entry_of(t, at) = *entry_of(t, *entry_of(t, at));
    at = *entry_of(t, at);
  }
  return at;
}

/* Returns 1 iff they were apart. */
static int join(const zone_tree *t, uint32_t p, uint32_t q) {
  const uint32_t a = root_of(t, p);
  const uint32_t b = root_of(t, q);
  *entry_of(t, a < b ? b : a) = (index_t)(a < b ? a : b);
  return a != b;
}

uint32_t impact_zones_of(fray_world *w, uint32_t p) {
  FRAY_ASSERT(p < w->p.count);
  const zone_tree t = tree_of(w);
  return root_of(&t, p);
}

void impact_zones_join(fray_world *w, uint32_t p, uint32_t q) {
  const zone_tree t = tree_of(w);
  (void)join(&t, p, q);
  w->self.merged = 1;
  FRAY_ASSERT(impact_zones_of(w, p) == impact_zones_of(w, q));
}

void impact_zones_join_all(fray_world *w) {
  world_fault(w, FRAY_FAULT_SELF_COLLISION_BUDGET);
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p)
    impact_zones_join(w, particles_attached(w), p);
  impact_zones_move(w);
}

int impact_zones_are_near(const fray_world *w) {
  FRAY_ASSERT(w->self.constants->slack > 0);
  for (uint32_t p = 0; p < w->p.count; ++p)
    if (!vec_is_within(vec_sub(world_position(w, p), w->self.paths[p].end), w->self.constants->slack))
      return 0;
  return 1;
}

/* ---- for another attempt ---- */

void impact_zones_forget(fray_world *w) {
  FRAY_ASSERT(world_repeats_ticks(w));
  for (uint32_t p = 0; p < w->p.count; ++p) {
    w->attempt.vertices[p].joined = (index_t)p;
    w->attempt.vertices[p].joined_body = w->attempt.vertices[p].pinned = 0;
  }
  w->attempt.begin->joined_any = w->attempt.begin->joined_new = 0;
}

void impact_zones_keep_pinned(fray_world *w) {
  FRAY_ASSERT(world_repeats_ticks(w));
  for (uint32_t p = 0; p < w->p.count; ++p) {
    attempt_vertex *v = &w->attempt.vertices[p];
    if (v->pinned == 0 || v->joined_body != 0) continue;
    v->joined_body = (uint8_t)(v->pinned_to + 1u);
    w->attempt.begin->joined_new = 1;
  }
}

void impact_zones_keep(fray_world *w) {
  const zone_tree joined = joined_tree_of(w);
  FRAY_ASSERT(world_has_triangle_collision(w));
  for (uint32_t p = 0; p < w->p.count; ++p)
    w->attempt.begin->joined_new |= (uint32_t)join(&joined, p, impact_zones_of(w, p));
  impact_zones_keep_pinned(w);
}

void impact_zones_keep_pair(fray_world *w, uint32_t p, uint32_t q) {
  const zone_tree joined = joined_tree_of(w);
  FRAY_ASSERT(world_has_triangle_collision(w));
  (void)join(&joined, p, q);
}

void impact_zones_keep_all(fray_world *w) {
  world_fault(w, FRAY_FAULT_SELF_COLLISION_BUDGET);
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p)
    impact_zones_keep_pair(w, particles_attached(w), p);
}

uint32_t impact_zones_joined(fray_world *w, uint32_t p) {
  FRAY_ASSERT(p < w->p.count);
  const zone_tree t = joined_tree_of(w);
  return root_of(&t, p);
}

/* ---- positions ---- */

/* Of yarns in half crossings; of vertices in 64ths of a particle, bounded so that sums keep within 64
 * bits. */
static int32_t weight_of(const fray_world *w, const vertex_mass_scale *scale, uint32_t p) {
  if (scale->per_mass == 0) return particle_half_masses(w, p);
  return fx_clamp(fx_asr(vertex_mass_at(scale, p), VERTEX_MASS_BITS - WEIGHT_BITS), 1, WEIGHT_MAX);
}

/* Attached to a body, or pinned to one in this tick. */
static int is_fixed(const fray_world *w, uint32_t p) {
  return p < particles_attached(w) || (world_has_triangle_collision(w) && w->attempt.vertices[p].pinned != 0);
}

void impact_zones_shift(fray_world *w, uint32_t p, vec3 by) {
  FRAY_ASSERT(p >= particles_attached(w) && p < w->p.count);
  const vec3 before = world_position(w, p);
  vec_add_at(w->p.x, w->p.y, w->p.z, p, by);
  impact_zones_hold(w, p);
  world_shift_predicted(w, p, vec_sub(world_position(w, p), before));
  w->self.moved_round[p] = w->self.round;
}

static vec3 travel_of(const fray_world *w, uint32_t p) {
  return vec_sub(world_position(w, p), w->self.paths[p].begin);
}

static void sum_paths(fray_world *w) {
  static const self_zone empty = {{0, 0, 0}, 0, {0, 0, 0}, {0, 0, 0}, 0, 0, 0, SELF_NONE};
  const vertex_mass_scale scale = vertex_mass_scale_of(w);
  for (uint32_t p = 0; p < w->p.count; ++p) w->self.zones[p] = empty;
  for (uint32_t p = 0; p < w->p.count; ++p) {
    self_zone *z = &w->self.zones[impact_zones_of(w, p)];
    const vec3 moved = travel_of(w, p);
    const int32_t weight = weight_of(w, &scale, p);
    FRAY_ASSERT(weight > 0);

    ++z->members;
    z->mass += weight;
    z->sum[0] += (int64_t)moved.x * weight;
    z->sum[1] += (int64_t)moved.y * weight;
    z->sum[2] += (int64_t)moved.z * weight;

    /* a pinned particle leads before an attached one, which is carried by its body in any case */
    const uint32_t attached = particles_attached(w);
    if (is_fixed(w, p) && (z->held == SELF_NONE || (p >= attached && z->held < attached))) z->held = p;
  }
}

void impact_zones_move(fray_world *w) {
  if (!w->self.merged) return;
  sum_paths(w);
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
    const self_zone *z = &w->self.zones[impact_zones_of(w, p)];
    if (z->members < 2 || is_fixed(w, p)) continue;
    FRAY_ASSERT(z->mass > 0 && z->members <= w->p.count);
    vec3 by = vec_make((int32_t)(z->sum[0] / z->mass), (int32_t)(z->sum[1] / z->mass),
                       (int32_t)(z->sum[2] / z->mass));
    if (z->held != SELF_NONE) by = travel_of(w, z->held);
    const vec3 to = vec_add_clamped(w->self.paths[p].begin, by, FX_EDGE_MAX);
    impact_zones_shift(w, p, vec_sub(to, world_position(w, p)));
    ++w->work.self_merged;
  }
}

/* ---- velocities ---- */

FX_WRAPS static int64_t wrap_add64(int64_t a, int64_t b) { return (int64_t)((uint64_t)a + (uint64_t)b); }

/* Nearly the mean: by the weights of positions, which keep the sum within 64 bits. `held` is the
 * heaviest member. */
static void sum_velocities(fray_world *w) {
  const vertex_mass_scale scale = vertex_mass_scale_of(w);
  for (uint32_t p = 0; p < w->p.count; ++p) {
    self_zone *z = &w->self.zones[p];
    z->sum[0] = z->sum[1] = z->sum[2] = z->whole = 0;
    z->mass = 0;
    z->held = SELF_NONE;
  }
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
    self_zone *z = &w->self.zones[impact_zones_of(w, p)];
    const int32_t weight = weight_of(w, &scale, p);
    z->mass += weight;
    z->sum[0] += (int64_t)w->p.vx[p] * weight;
    z->sum[1] += (int64_t)w->p.vy[p] * weight;
    z->sum[2] += (int64_t)w->p.vz[p] * weight;
    z->whole += (int64_t)w->trimesh.mass[p];
    if (z->held == SELF_NONE || w->trimesh.mass[z->held] < w->trimesh.mass[p]) z->held = p;
  }
  for (uint32_t p = 0; p < w->p.count; ++p) {
    self_zone *z = &w->self.zones[p];
    for (uint32_t k = 0; k < 3 && z->mass != 0; ++k) {
      z->mean[k] = (int32_t)(z->sum[k] / z->mass);
      z->sum[k] = 0; /* from here on the momentum that the mean leaves out */
    }
  }
}

static int is_averaged(const self_zone *z) {
  const int32_t fastest = FX_SPEED_MAX / 2;
  for (uint32_t k = 0; k < 3; ++k)
    if (z->mean[k] < -fastest || z->mean[k] > fastest) return 0;
  return z->members > 1;
}

static void set_mean(fray_world *w, int32_t *speed, uint32_t k) {
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
    self_zone *z = &w->self.zones[impact_zones_of(w, p)];
    if (!is_averaged(z)) continue;
    z->sum[k] = wrap_add64(z->sum[k], (int64_t)w->trimesh.mass[p] * ((int64_t)speed[p] - z->mean[k]));
    speed[p] = z->mean[k];
  }
}

/* What the mean left out goes to all members, its remainder to the heaviest, and the rest of that to the
 * next zone. */
static void restore_momentum(fray_world *w, int32_t *speed, uint32_t k) {
  int32_t *remainder = &w->trimesh.state->momentum_remainder[k];
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
    const self_zone *z = &w->self.zones[impact_zones_of(w, p)];
    if (is_averaged(z)) speed[p] = fx_clamp_wide(speed[p] + z->sum[k] / z->whole, FX_SPEED_OVER);
  }
  for (uint32_t p = 0; p < w->p.count; ++p) {
    const self_zone *z = &w->self.zones[p];
    if (w->self.zone_of[p] != p || z->mass == 0 || !is_averaged(z)) continue;
    FRAY_ASSERT(z->held < w->p.count && z->whole > 0 && w->trimesh.mass[z->held] > 0);
    const int64_t mass = (int64_t)w->trimesh.mass[z->held];
    const int64_t rest = z->sum[k] % z->whole + *remainder;
    const int64_t more = rest / mass;
    speed[z->held] = fx_clamp_wide(speed[z->held] + more, FX_SPEED_OVER);
    *remainder = (int32_t)(rest - more * mass);
  }
}

static void sum_half_masses(fray_world *w) {
  for (uint32_t p = 0; p < w->p.count; ++p) {
    self_zone *z = &w->self.zones[p];
    z->sum[0] = z->sum[1] = z->sum[2] = z->mass = 0;
  }
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
    self_zone *z = &w->self.zones[impact_zones_of(w, p)];
    const int32_t halves = particle_half_masses(w, p);
    z->mass += halves;
    z->sum[0] += (int64_t)w->p.vx[p] * halves;
    z->sum[1] += (int64_t)w->p.vy[p] * halves;
    z->sum[2] += (int64_t)w->p.vz[p] * halves;
  }
}

/* The mean downwards; `sum` is what it leaves out. */
static void divide(self_zone *z, uint32_t k) {
  const int64_t rest = z->sum[k] % z->mass;
  z->mean[k] = (int32_t)(z->sum[k] / z->mass) - (rest < 0);
  z->sum[k] = rest < 0 ? rest + z->mass : rest;
}

static int32_t share(self_zone *z, uint32_t k, int32_t halves) {
  const int more = z->sum[k] >= halves;
  if (more) z->sum[k] -= halves;
  return z->mean[k] + more;
}

/* What the mean leaves out is less than a step of speed for each half crossing, so whole crossings take two
 * of it each, then halves one: nothing is left. */
static void average_woven(fray_world *w) {
  sum_half_masses(w);
  for (uint32_t p = 0; p < w->p.count; ++p)
    for (uint32_t k = 0; k < 3 && w->self.zones[p].mass != 0; ++k) divide(&w->self.zones[p], k);
  for (int32_t halves = 2; halves != 0; --halves)
    for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
      self_zone *z = &w->self.zones[impact_zones_of(w, p)];
      if (particle_half_masses(w, p) != halves) continue;
      w->p.vx[p] = share(z, 0, halves);
      w->p.vy[p] = share(z, 1, halves);
      w->p.vz[p] = share(z, 2, halves);
    }
}

void impact_zones_average(fray_world *w) {
  int32_t *const speeds[3] = {w->p.vx, w->p.vy, w->p.vz};
  if (!w->self.merged) return;
  if (!world_has_membrane(w)) {
    average_woven(w);
    return;
  }
  sum_velocities(w);
  for (uint32_t k = 0; k < 3; ++k) {
    set_mean(w, speeds[k], k);
    restore_momentum(w, speeds[k], k);
  }
}
