/* SPDX-License-Identifier: Apache-2.0 */
/* How stiff every side of two triangles is against being folded, in this tick; stage/fold.c says what
 * is done with it. Of
 *
 *   F_i = k |E|^2 / (|N1| + |N2|) sin(t/2) u_i        (Karaoz 2015, 2.49 to 2.58)
 *
 * all but the normals and the angle is worked out here, where vertices are at the beginning of the tick.
 * Heights are h = |N| / |E|; D goes by the direction of the side at rest against the weft, and by the
 * curvature 2 |n1 - n2| / (h1 + h2), which is that of the moment: a D that lags behind the fold gives it
 * energy.
 *
 * k = 24/5 D: then a strip that bends along the regular mesh has the measured stiffness D. With all
 * sides of the same curvature that is 4 D; but vertices where four triangles meet give way by 1/12
 * of a cell's sag against those where eight do, which takes 1/6 of the energy away.
 *
 * Impulses times height over sin(t/2) are 24/5 D |E|^2 / (|N1| + |N2|) times every h^2 / (i m lu^2) 2^34, which is
 * bend_gain for D in 2^-40 N m. */
#include "rt/model/element.h"
#include "rt/stage/hinge.h"
#include "rt/stage/stage.h"
#include "rt/wide/wide.h"

/* Q`bits` of n / d, for d above 0. */
static int32_t ratio(int64_t n, uint32_t d, unsigned bits) {
  const uint64_t magnitude = (uint64_t)(n < 0 ? -n : n);
  const uint32_t quotient = fx_divide_wide(magnitude << bits, d);
  const int32_t bounded = quotient > INT32_MAX ? INT32_MAX : (int32_t)quotient;
  return n < 0 ? -bounded : bounded;
}

static int32_t way(const int32_t *x, uint32_t from, uint32_t to) {
  return fx_clamp_rare(fx_sub(x[to], x[from]), -HINGE_REACH / 16, HINGE_REACH / 16) * 16;
}
static vec3 way_of(const weigh_view *v, uint32_t from, uint32_t to) {
  return vec_make(way(v->at[0], from, to), way(v->at[1], from, to), way(v->at[2], from, to));
}

/* 2 (cos, sin) of twice the angle are (u^2 - v^2, 2 u v): mirrored into 0 to 90 degrees. */
static int32_t direction_of(const weigh_view *w, uint32_t from, uint32_t to) {
  const int64_t u = fx_asr(fx_sub(w->u[to], w->u[from]), 8);
  const int64_t v = fx_asr(fx_sub(w->v[to], w->v[from]), 8);
  const int64_t x = u * u - v * v;
  const int64_t y = 2 * u * v;
  const int32_t cosine = fx_saturate(fx_round64(x, 6));
  const int32_t sine = fx_saturate(fx_round64(y < 0 ? -y : y, 6));
  if (cosine == 0 && sine == 0) return 0;
  return fabric_direction(cosine / 2, sine / 2) / 2;
}

static int32_t foot(vec3 from_end, vec3 side, uint32_t squared) {
  const int64_t along = fx_mul_wide(from_end.x, side.x) + fx_mul_wide(from_end.y, side.y) +
                        fx_mul_wide(from_end.z, side.z);
  return fx_clamp(ratio(fx_round64(along, 28), squared, 24), -2 * (1 << 24), 2 * (1 << 24));
}

static int32_t times(int32_t a, int32_t b, unsigned bits) {
  return fx_saturate(fx_round64(fx_mul_wide(a, b), bits));
}

/* By curvature, for the direction of a side at rest, Q28 of 0..2 for 0, 45, 90 degrees. */
static void fill_stiffness(const weigh_view *v, const fabric *f, int32_t direction, int32_t shape, crease *c) {
  const uint32_t row = direction >= STRAIN_ONE ? 1 : 0;
  const int32_t turned = direction - (int32_t)(row << STRAIN_BITS);
  for (uint32_t n = 0; n < FABRIC_CURVES; ++n) {
    const int32_t from = f->bend[row][n];
    const int32_t d = from + times(fx_sub(f->bend[row + 1u][n], from), turned, STRAIN_BITS);
    c->stiff[n] = times(times(d, shape, 24), v->cloths->bend_gain, (unsigned)v->cloths->bend_shift);
  }
}

/* 0 where a triangle has no area to speak of. */
static int weigh_crease(const weigh_view *v, crease *c) {
  const uint32_t *x = c->x;
  const hinge h = hinge_of(way_of(v, x[2], x[3]), way_of(v, x[3], x[0]), way_of(v, x[3], x[1]));
  if (!hinge_is_sound(&h)) return 0;
  const hinge_unit n1 = hinge_unit_of(h.area1);
  const hinge_unit n2 = hinge_unit_of(h.area2);
  const uint32_t edge = hinge_unit_of(h.side).length;
  const uint32_t squared = (uint32_t)fx_round64((int64_t)vec_squared(h.side), 28);
  const uint32_t areas = n1.length + n2.length;
  fill_stiffness(v, &v->fabrics[(uint32_t)c->reach], direction_of(v, x[2], x[3]), ratio(squared, areas, 24), c);
  /* 2 |n1 - n2| / (h1 + h2) = 4 sin(t/2) |E| / areas */
  c->reach = times(ratio(edge, areas, 24), v->cloths->curve_gain, 24);
  c->height[0] = ratio(edge, n1.length, 16);
  c->height[1] = ratio(edge, n2.length, 16);
  c->foot[0] = foot(h.to1, h.side, squared);
  c->foot[1] = foot(h.to2, h.side, squared);
  return 1;
}

/* Sides of two triangles, with their vertices; until they are weighed, the cloth stands in `reach`. */
static uint32_t list_creases(fray_world *w) {
  const sheet_mesh *s = &w->sheet;
  uint32_t count = 0;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t)
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t other = s->triangle[t].across[k];
      if (other <= t) continue;
      crease *c = &w->creases[count++];
      c->x[0] = s->triangle[t].v[k];
      c->x[1] = s->triangle[other].v[sheet_back(s, t, k)];
      c->x[2] = s->triangle[t].v[sheet_last(k)];
      c->x[3] = s->triangle[t].v[sheet_next(k)];
      c->reach = s->cloth[t];
    }
  return count;
}

void creases_weigh(fray_world *w) {
  const weigh_view view = {{w->x, w->y, w->z}, w->sheet.u, w->sheet.v, w->fabrics, w->cloths, w->creases};
  uint32_t count = 0;
  uint32_t at = 0;
  if (w->cloths->bend_every == 0) return;
  const uint32_t listed = list_creases(w);
  while (at < listed) {
    const uint32_t taken = wide_weigh(w->kernel, &view, at, listed);
    for (uint32_t n = at; count != at && n < at + taken; ++n) w->creases[count + n - at] = w->creases[n];
    at += taken;
    count += taken;
    if (at == listed) break;
    crease *c = &w->creases[at++];
    if (!weigh_crease(&view, c)) continue;
    if (c != &w->creases[count]) w->creases[count] = *c;
    ++count;
  }
  w->crease_count = count;
}
