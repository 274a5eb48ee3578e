/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/model/sheet.h"

#include "rt/model/world.h"

void sheet_walk(const sheet_mesh *s, uint32_t vertex, sheet_fan *fan) {
  const uint32_t first = s->fan[vertex];
  uint32_t t = first;
  fan->count = 0;
  fan->closed = 0;
  while (fan->count < SHEET_FAN) {
    const uint32_t k = sheet_corner(s, t, vertex);
    fan->triangle[fan->count] = t;
    fan->corner[fan->count++] = (uint8_t)k;
    const uint32_t next = sheet_across(s, t, sheet_next(k));
    if (next == SHEET_NONE) return;
    if (next == first) {
      fan->closed = 1;
      return;
    }
    t = next;
  }
}

int64_t sheet_twice_area(sheet_point a, sheet_point b, sheet_point c) {
  return fx_add64(fx_mul_wide(fx_sub(b.u, a.u), fx_sub(c.v, a.v)),
                  -fx_mul_wide(fx_sub(b.v, a.v), fx_sub(c.u, a.u)));
}

static uint64_t side_squared(sheet_point a, sheet_point b) {
  return fx_square(fx_sub(b.u, a.u)) + fx_square(fx_sub(b.v, a.v));
}

/* The least height is the one on the longest side. */
int sheet_is_stouter(const sheet_mesh *s, uint32_t by, sheet_point a, sheet_point b, sheet_point c) {
  const int64_t twice = sheet_twice_area(a, b, c);
  if (twice < (int64_t)s->params->area_min * (1 << (19 + 2 * by))) return 0;
  const uint64_t sides[3] = {side_squared(a, b), side_squared(b, c), side_squared(c, a)};
  uint64_t longest = sides[0] > sides[1] ? sides[0] : sides[1];
  if (sides[2] > longest) longest = sides[2];
  const uint32_t length = fx_root_length(fx_rsqrt(longest, FX_ROOT_FINE));
  return twice >= fx_mul_wide(s->params->height_min, (int32_t)length) * (1 << by);
}

/* n * 2^46 / twice, for results below 2^31. */
static int32_t over_twice_area(int32_t n, int64_t twice) {
  const unsigned up = fx_leading_zeros64((uint64_t)twice);
  const uint32_t divisor = (uint32_t)((uint64_t)twice << up >> 33);
  const unsigned shift = 13u + up; /* 46 - (33 - up) */
  const uint64_t whole = ((uint64_t)fx_magnitude(n) << shift) + divisor / 2u;
  const uint32_t quotient = fx_divide_wide(whole, divisor);
  return n < 0 ? -(int32_t)quotient : (int32_t)quotient;
}

sheet_weights sheet_weights_of(const sheet_mesh *s, uint32_t t) {
  const sheet_point a = sheet_at(s, s->triangle[t].v[0]);
  const sheet_point b = sheet_at(s, s->triangle[t].v[1]);
  const sheet_point c = sheet_at(s, s->triangle[t].v[2]);
  const int64_t twice = sheet_twice_area(a, b, c);
  const sheet_weights w = {
      over_twice_area(fx_sub(c.v, a.v), twice), over_twice_area(fx_sub(a.v, b.v), twice),
      over_twice_area(fx_sub(a.u, c.u), twice), over_twice_area(fx_sub(b.u, a.u), twice)};
  return w;
}

void sheet_derive(fray_world *w) {
  const sheet_mesh *s = &w->sheet;
  for (uint32_t p = 0; p < w->capacity[POOL_PARTICLES]; ++p) s->mass[p] = 0;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t) {
    for (uint32_t k = 0; k < 3; ++k) s->mass[s->triangle[t].v[k]] += s->area[t];
    s->weights[t] = sheet_weights_of(s, t);
  }
}

uint64_t sheet_triangle_entry(const sheet_mesh *s, uint32_t t) {
  uint64_t total = 0;
  for (uint32_t k = 0; k < 3; ++k) {
    total ^= hash_entry(TOPOLOGY_TRIANGLE, 8u * t + k, s->triangle[t].v[k]);
    total ^= hash_entry(TOPOLOGY_TRIANGLE, 8u * t + 3u + k, s->triangle[t].across[k]);
  }
  total ^= hash_entry(TOPOLOGY_TRIANGLE, 8u * t + 6u, s->area[t]);
  return total ^ hash_entry(TOPOLOGY_TRIANGLE, 8u * t + 7u,
                            (uint32_t)s->mark[t] << 8 | s->cloth[t]);
}

uint64_t sheet_vertex_entry(const sheet_mesh *s, uint32_t p) {
  return hash_entry(TOPOLOGY_VERTEX, 4u * p, (uint32_t)s->u[p]) ^
         hash_entry(TOPOLOGY_VERTEX, 4u * p + 1u, (uint32_t)s->v[p]) ^
         hash_entry(TOPOLOGY_VERTEX, 4u * p + 2u, s->fan[p]);
}

uint64_t sheet_topology(const fray_world *w) {
  const sheet_mesh *s = &w->sheet;
  uint64_t total = 0;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t) total ^= sheet_triangle_entry(s, t);
  for (uint32_t p = 0; p < w->particles; ++p)
    if (s->mass[p] != 0) total ^= sheet_vertex_entry(s, p);
  return total;
}
