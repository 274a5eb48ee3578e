/* SPDX-License-Identifier: Apache-2.0 */
/* The last resort of triangle sheets: a side that is longer than `limit` times its rest length is
 * made so long by projection, one side after the other, each once, and its ends stop drawing apart.
 * It stands above what tears, and hides no stress that is below it. Positions move without a
 * velocity of their own: with one, a load that holds a sheet at its limit would shake it. */
#include "rt/model/element.h"
#include "rt/stage/stage.h"

/* Both move along `unit`, in a ratio of their inverse masses. */
static void part(int32_t *a, uint32_t i, uint32_t j, int64_t along, int64_t share_q24) {
  const int64_t whole = fx_round64(along, 30);
  const int64_t of_i = fx_round64(whole * share_q24, 24);
  a[i] = fx_saturate(a[i] + of_i);
  a[j] = fx_saturate(a[j] - (whole - of_i));
}

static int32_t apart_in(const int32_t *v, uint32_t i, uint32_t j) {
  return fx_saturate((int64_t)v[j] - v[i]);
}

static void shorten(fray_world *w, uint32_t i, uint32_t j) {
  const sheet_mesh *s = &w->sheet;
  const uint32_t held = (uint32_t)w->params->held;
  const uint64_t rest2 = fx_square(fx_sub(s->u[j], s->u[i])) + fx_square(fx_sub(s->v[j], s->v[i]));
  const vec3 d = {element_way(w->x, i, j), element_way(w->y, i, j), element_way(w->z, i, j)};
  const uint64_t now2 = vec_squared(d);
  if (rest2 == 0 || now2 <= rest2) return;
  const uint64_t rest = fx_root_length(fx_rsqrt(rest2, FX_ROOT_FINE));
  const fx_root root = fx_rsqrt(now2, FX_ROOT_FINE);
  const uint64_t now = fx_root_length(root);
  const uint64_t most = rest * (uint32_t)w->cloths->limit >> 16;
  const uint64_t of_i = i < held ? 0 : (uint32_t)w->inverse[i];
  const uint64_t of_j = j < held ? 0 : (uint32_t)w->inverse[j];
  if (now <= most || of_i + of_j == 0) return;
  const int64_t share = (int64_t)((of_i << 24) / (of_i + of_j));
  const vec3 unit = {fx_root_unit(root, d.x), fx_root_unit(root, d.y), fx_root_unit(root, d.z)};
  const vec3 speed = {apart_in(w->vx, i, j), apart_in(w->vy, i, j), apart_in(w->vz, i, j)};
  const int32_t apart = vec_dot_unit(speed, unit);
  const int32_t units[3] = {unit.x, unit.y, unit.z};
  int32_t *const places[3][2] = {{w->x, w->qx}, {w->y, w->qy}, {w->z, w->qz}};
  int32_t *const speeds[3] = {w->vx, w->vy, w->vz};
  for (uint32_t n = 0; n < 3; ++n) {
    const int64_t way = (int64_t)(now - most) * units[n];
    part(places[n][0], i, j, way, share);
    part(places[n][1], i, j, way, share);
    if (apart > 0) part(speeds[n], i, j, (int64_t)apart * units[n], share);
  }
}

void limit_run(fray_world *w) {
  if (!world_has_sheet(w) || w->cloths->limit == 0) return;
  const sheet_mesh *s = &w->sheet;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t)
    for (uint32_t k = 0; k < 3; ++k)
      if (s->triangle[t].across[k] >= t)
        shorten(w, s->triangle[t].v[sheet_next(k)], s->triangle[t].v[sheet_last(k)]);
}
