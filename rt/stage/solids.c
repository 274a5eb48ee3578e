/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/stage/solids.h"

#include "rt/model/couples.h"

enum { PLANE_MARGIN = 64 }; /* steps of position: more than the errors of a normal over the world's width */

int32_t solid_skin(const fray_world *w) { return fx_max(w->params->thickness, SOLID_SKIN_LEAST); }

static uint32_t ball_of(const fray_world *w, uint32_t n) {
  uint32_t b = 0;
  uint32_t balls = 0;
  while (b + 1u < w->capacity[POOL_BODIES]) {
    if (w->bodies[b].shape == FRAY_BALL && balls++ == n) return b;
    ++b;
  }
  return b;
}

solid solid_at(const fray_world *w, uint32_t n) {
  const uint32_t meshes = mesh_count(w);
  const mesh_parts none = {NULL, NULL, NULL, NULL, NULL, 0};
  solid t;
  if (n < meshes) {
    t.m = mesh_at(w, n);
    t.body = (uint32_t)t.m.of->body;
    t.radius = 0;
    t.sharp = world_has_blades(w) && (w->sharp >> n & 1u) != 0;
    t.around = t.m.boxes[0];
  } else {
    t.m = none;
    t.body = ball_of(w, n - meshes);
    t.radius = w->bodies[t.body].radius;
    t.sharp = 0;
    for (uint32_t k = 0; k < 3; ++k) {
      t.around.low[k] = -t.radius;
      t.around.high[k] = t.radius;
    }
  }
  t.before = w->stood[t.body];
  t.now = mesh_vec(w->body_states[t.body].position);
  return t;
}

solid_span solid_span_of(const sweep_point *ways, uint32_t count, int32_t skin) {
  vec3 low = ways[0].begin;
  vec3 high = low;
  for (uint32_t n = 0; n < 2 * count; ++n) {
    const vec3 v = (n & 1u) != 0 ? ways[n / 2].end : ways[n / 2].begin;
    low = vec_make(fx_min(low.x, v.x), fx_min(low.y, v.y), fx_min(low.z, v.z));
    high = vec_make(fx_max(high.x, v.x), fx_max(high.y, v.y), fx_max(high.z, v.z));
  }
  const solid_span s = {{low.x - skin, low.y - skin, low.z - skin},
                        {high.x + skin, high.y + skin, high.z + skin}};
  return s;
}

static inline uint32_t sides_along(int32_t begin, int32_t end, int32_t low, int32_t high) {
  return (begin < low && end < low ? 1u : 0u) | (begin > high && end > high ? 2u : 0u);
}
uint8_t solid_sides(const solid *t, const sweep_point *way, int32_t skin) {
  const int32_t *low = t->around.low;
  const int32_t *high = t->around.high;
  return (uint8_t)(
      sides_along(way->begin.x, way->end.x, low[0] - skin, high[0] + skin) |
      sides_along(way->begin.y, way->end.y, low[1] - skin, high[1] + skin) << 2 |
      sides_along(way->begin.z, way->end.z, low[2] - skin, high[2] + skin) << 4);
}

void solid_list_near(fray_world *w, const solid *t, const solid_span *s, uint32_t most,
                     solid_near *near) {
  const uint32_t end = t->m.box_count;
  uint32_t visits = 0;
  uint32_t n = 0;
  uint32_t count = 0;
  while (n < end && visits < MESH_VISITS && count <= most) {
    const mesh_box *b = &t->m.boxes[n];
    ++visits;
    if (!solid_overlap(s, b)) {
      n = (uint32_t)b->next;
      continue;
    }
    ++n;
    if (b->face == MESH_NONE) continue;
    if (count < most) near->face[count] = (uint16_t)b->face;
    ++count;
  }
  near->count = n < end || count > most ? (uint32_t)SOLID_TOO_MANY : count;
  w->work.mesh_boxes += visits;
}

int solid_meets(fray_world *w, const solid *t, uint32_t face, const sweep_point *way, int32_t skin,
                sweep_contact *c) {
  sweep_point corners[3];
  for (uint32_t k = 0; k < 3; ++k) {
    corners[k].begin = mesh_corner(&t->m, face, k);
    corners[k].end = corners[k].begin;
  }
  ++w->work.mesh_sweeps;
  return sweep_point_triangle(way, corners, skin, c);
}

/* Both ends are on one side of the triangle's plane. */
static int is_clear(const solid *t, uint32_t face, const sweep_point *way) {
  const int32_t begin = solid_gap(t, face, way->begin);
  const int32_t end = solid_gap(t, face, way->end);
  return (begin >= PLANE_MARGIN && end >= PLANE_MARGIN) ||
         (begin <= -PLANE_MARGIN && end <= -PLANE_MARGIN);
}

int solid_crosses_near(fray_world *w, const solid *t, const solid_near *near, const sweep_point *way) {
  sweep_contact c;
  for (uint32_t n = 0; n < near->count; ++n)
    if (!is_clear(t, near->face[n], way) && solid_meets(w, t, near->face[n], way, 0, &c)) return 1;
  return 0;
}

int solid_crosses(fray_world *w, const solid *t, const sweep_point *way) {
  solid_near near;
  const solid_span s = solid_span_of(way, 1, 0);
  if (solid_stays(way)) return 0;
  solid_list_near(w, t, &s, MESH_NEAR, &near);
  return near.count == SOLID_TOO_MANY || solid_crosses_near(w, t, &near, way);
}

vec3 solid_pushed(vec3 at, vec3 out, int32_t depth) {
  const vec3 by = vec_scale_unit(out, depth);
  return vec_make(fx_clamp(fx_saturate((int64_t)at.x + by.x), -FX_WORLD_MAX, FX_WORLD_MAX),
                  fx_clamp(fx_saturate((int64_t)at.y + by.y), -FX_WORLD_MAX, FX_WORLD_MAX),
                  fx_clamp(fx_saturate((int64_t)at.z + by.z), -FX_WORLD_MAX, FX_WORLD_MAX));
}

static int32_t within_world(fray_world *w, int64_t v) {
  const int32_t held = (int32_t)fx_clamp64(v, -FX_WORLD_MAX, FX_WORLD_MAX);
  if (held != v) w->state->faults |= (int32_t)FRAY_FAULT_LEFT_WORLD;
  return held;
}

/* Q16 of a particle. */
static int32_t mass_of(const fray_world *w, uint32_t p) {
  if (world_has_sheet(w)) {
    const uint64_t unit = (uint32_t)w->cloths->unit;
    const uint64_t mass = w->sheet.mass[p];
    return mass >= unit << 14 ? 1 << 30 : (int32_t)fx_divide_wide(mass << 16, (uint32_t)unit);
  }
  return world_has_yarns(w) && couple_is_light(w, p) ? 1 << 15 : 1 << 16;
}

void solid_place(fray_world *w, const solid *t, uint32_t p, vec3 beside) {
  const vec3 was = world_position(w, p);
  w->x[p] = within_world(w, (int64_t)beside.x + t->now.x);
  w->y[p] = within_world(w, (int64_t)beside.y + t->now.y);
  w->z[p] = within_world(w, (int64_t)beside.z + t->now.z);
  const int32_t mass = mass_of(w, p);
  body_gave(&w->motion[t->body], fx_round64(fx_mul_wide(fx_sub(w->x[p], was.x), mass), 16 - FX_SUB_BITS),
            fx_round64(fx_mul_wide(fx_sub(w->y[p], was.y), mass), 16 - FX_SUB_BITS),
            fx_round64(fx_mul_wide(fx_sub(w->z[p], was.z), mass), 16 - FX_SUB_BITS));
}

void solid_stand(fray_world *w, const solid *t, uint32_t p, const sweep_point *way) {
  ++w->work.mesh_stops;
  solid_place(w, t, p, way->begin);
}

int solid_add_contact(fray_world *w, const solid *t, uint32_t p, vec3 out) {
  if (w->contact_count == w->capacity[POOL_CONTACTS]) return 0;
  contact *c = &w->contacts[w->contact_count++];
  c->particle = p;
  c->body = (uint16_t)t->body;
  c->touching = CONTACT_TOUCHES;
  c->normal = out;
  return 1;
}
