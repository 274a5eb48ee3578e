/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/model/couples.h"

static int32_t *count_of(fray_world *w, fray_couple of) {
  yarn_state *s = w->yarn_state;
  return of == FRAY_CONNECTED ? &s->connected : of == FRAY_LOOSE ? &s->loose : &s->disconnected;
}

/* Every change of the byte goes through here, so that the topology's hash follows. */
static void write_couple(fray_world *w, uint32_t c, uint32_t value) {
  if (w->couple[c] != FRAY_WHOLE) world_toggle(w, TOPOLOGY_COUPLE, c, w->couple[c]);
  if (value != FRAY_WHOLE) world_toggle(w, TOPOLOGY_COUPLE, c, value);
  w->couple[c] = (uint8_t)value;
}

void couple_want(fray_world *w, uint32_t c, int wanted) {
  const int was = (w->couple[c] & COUPLE_WANTED) != 0;
  if (was == wanted) return;
  write_couple(w, c, w->couple[c] ^ (uint32_t)COUPLE_WANTED);
  w->yarn_state->wanted += wanted ? 1 : -1;
}

static uint32_t canonical_shears_from(const fray_world *w) {
  return (uint32_t)(w->params->links + w->params->bends);
}

/* Where a yarn of this class was put when the crossing split, in halves of the thickness. */
static int32_t side_of(const fray_world *w, uint32_t c, uint32_t axis) {
  if (couple_at(w, c) == FRAY_WHOLE) return 0;
  return couple_warp_over(w, c) == (axis == CLASS_WARP) ? 1 : -1;
}

uint8_t couple_kind(const fray_world *w, uint32_t row) {
  const uint32_t home = w->home[row];
  const uint32_t i = w->row_i[row];
  const uint32_t j = w->row_j[row];
  const uint32_t ends = (couple_is_light(w, i) ? (uint32_t)ROW_UP_I : 0u) |
                        (couple_is_light(w, j) ? (uint32_t)ROW_UP_J : 0u);
  if (home >= canonical_shears_from(w)) {
    const uint32_t shadow = home >= weave_rows(world_weave(w)) || ends != 0;
    return (uint8_t)(shadow ? CLASS_SHEAR_HALF | (ends != 0 ? ROW_LIGHT | ends : 0u) : CLASS_SHEAR);
  }
  uint32_t a;
  uint32_t b;
  weave_ends(world_weave(w), home, &a, &b);
  const uint32_t axis = a / (uint32_t)w->params->warps == b / (uint32_t)w->params->warps
                            ? (uint32_t)CLASS_WEFT
                            : (uint32_t)CLASS_WARP;
  /* where warps lie as close as wefts, both have one class */
  const int square = w->links[CLASS_WEFT].rest == w->links[CLASS_WARP].rest;
  const uint32_t base = square ? (uint32_t)CLASS_WEFT : axis;
  if (home >= (uint32_t)w->params->links)
    return (uint8_t)(base | (ends != 0 ? ROW_LIGHT | ends : 0u));
  const int32_t way = side_of(w, a, axis) - side_of(w, b, axis);
  const uint32_t class = base + CLASS_CRIMP * (uint32_t)(way < 0 ? -way : way);
  /* a projection between two light ends is one between two heavy ones */
  return (uint8_t)(class | (ends != 0 && ends != (ROW_UP_I | ROW_UP_J) ? ROW_LIGHT | ends : 0u));
}

/* The particle that a canonical row has at one of its crossings. */
static uint32_t end_of(const fray_world *w, uint32_t home, uint32_t c, int along_warp) {
  if (home < canonical_shears_from(w)) return along_warp ? w->warp_at[c] : w->crossing[c];
  const int upper = home < weave_rows(world_weave(w));
  return upper == couple_warp_over(w, c) ? w->warp_at[c] : w->crossing[c];
}

void couple_ends(const fray_world *w, uint32_t row, uint32_t *a, uint32_t *b) {
  const uint32_t home = w->home[row];
  uint32_t from;
  uint32_t to;
  weave_ends(world_weave(w), home, &from, &to);
  const int along_warp = from / (uint32_t)w->params->warps != to / (uint32_t)w->params->warps;
  *a = end_of(w, home, from, along_warp);
  *b = end_of(w, home, to, along_warp);
}

/* Half way between the two yarns of a crossing. */
static vec3 middle(const fray_world *w, uint32_t c) {
  const vec3 a = world_position(w, w->crossing[c]);
  const vec3 b = world_position(w, w->warp_at[c]);
  const vec3 apart = vec_sub(b, a);
  return vec_add(a, vec_make(fx_round(apart.x, 1), fx_round(apart.y, 1), fx_round(apart.z, 1)));
}

/* From the crossing before to the one after it; across a cut only if there is no other way. */
static vec3 along(const fray_world *w, uint32_t c, uint32_t way, int across_cuts) {
  vec3 ends[2];
  for (uint32_t n = 0; n < 2; ++n) {
    uint32_t next = c;
    uint32_t link;
    if (!weave_step(world_weave(w), c, way + n, &next, &link) ||
        (!across_cuts && w->row_class[w->row_of[link]] == ROW_DEAD))
      next = c;
    ends[n] = middle(w, next);
  }
  return vec_sub(ends[1], ends[0]);
}

static int64_t determinant(int32_t a, int32_t b, int32_t c, int32_t d) {
  return fx_add64(fx_mul_wide(a, d), -fx_mul_wide(b, c));
}

/* The unit vector along a x b, Q30; 0 where they are parallel. */
static int unit_cross(vec3 a, vec3 b, vec3 *unit) {
  const int64_t n[3] = {determinant(a.y, a.z, b.y, b.z), determinant(a.z, a.x, b.z, b.x),
                        determinant(a.x, a.y, b.x, b.y)};
  uint64_t all = 0;
  for (uint32_t k = 0; k < 3; ++k) all |= (uint64_t)(n[k] < 0 ? -n[k] : n[k]);
  if (all == 0) return 0;
  unsigned shift = 0;
  while (all >> shift >= (uint64_t)1 << 30) ++shift;
  const vec3 v = vec_make((int32_t)fx_asr64(n[0], shift), (int32_t)fx_asr64(n[1], shift),
                          (int32_t)fx_asr64(n[2], shift));
  const uint64_t squared = vec_squared(v);
  if (squared == 0) return 0;
  const fx_root root = fx_rsqrt(squared, FX_ROOT_FINE);
  *unit = vec_make(fx_root_unit(root, v.x), fx_root_unit(root, v.y), fx_root_unit(root, v.z));
  return 1;
}

/* The four cross products of neighbouring spokes sum up to one, of the spokes' differences. */
vec3 couple_normal(const fray_world *w, uint32_t c) {
  vec3 unit = vec_make(0, 0, 1 << 30);
  for (int across = 0; across < 2; ++across)
    if (unit_cross(along(w, c, 2, across), along(w, c, 0, across), &unit)) return unit;
  return unit;
}

static void rename_end(fray_world *w, uint32_t row, uint32_t from, uint32_t to) {
  if (w->row_i[row] == from)
    w->row_i[row] = (row_id)to;
  else
    w->row_j[row] = (row_id)to;
}

static void renew_kind(fray_world *w, uint32_t row) {
  if (w->row_class[row] != ROW_DEAD) w->row_class[row] = couple_kind(w, row);
}

/* A diagonal whose first end splits gets a second one (figure 5c): one goes on between what is up, the
 * other between what is down. */
static void split_diagonal(fray_world *w, uint32_t canonical, uint32_t c) {
  const uint32_t row = w->row_of[canonical];
  const uint32_t shadow = w->row_of[canonical + (uint32_t)w->params->shears];
  const int born = w->row_class[row] == CLASS_SHEAR;
  rename_end(w, couple_warp_over(w, c) ? row : shadow, w->crossing[c], w->warp_at[c]);
  renew_kind(w, row);
  if (born) {
    world_toggle(w, TOPOLOGY_ROW, w->home[shadow], ROW_DEAD);
    w->row_class[shadow] = couple_kind(w, shadow);
  } else {
    renew_kind(w, shadow);
  }
}

static void split_rows(fray_world *w, uint32_t c) {
  weave_star star;
  weave_rows_at(world_weave(w), c, &star);
  for (uint32_t n = 0; n < star.along_warp; ++n) {
    const uint32_t row = w->row_of[star.row[n]];
    if (n >= star.along_weft) rename_end(w, row, w->crossing[c], w->warp_at[c]);
    renew_kind(w, row);
  }
  for (uint32_t n = star.along_warp; n < star.count; ++n) split_diagonal(w, star.row[n], c);
}

/* Both halves stay where the crossing is but for +-`off`; so do the predicted positions. */
static void split_axis(int32_t *x, int32_t *q, int32_t *v, int8_t *r, uint32_t weft, uint32_t warp,
                       int32_t off) {
  x[warp] = fx_add(x[weft], off);
  x[weft] = fx_sub(x[weft], off);
  q[warp] = fx_add(q[weft], off);
  q[weft] = fx_sub(q[weft], off);
  v[warp] = v[weft];
  r[warp] = r[weft];
}

int couple_split(fray_world *w, uint32_t c, fray_couple to) {
  if (w->particles == w->capacity[POOL_PARTICLES]) return 0;
  const uint32_t weft = w->crossing[c];
  const uint32_t warp = w->particles;
  const int32_t half = fx_asr(w->params->thickness, 1);
  const vec3 off = vec_scale_unit(couple_normal(w, c), couple_warp_over(w, c) ? half : -half);
  ++w->particles;
  ++w->yarn_state->split;
  ++*count_of(w, to);
  split_axis(w->x, w->qx, w->vx, w->rx, weft, warp, off.x);
  split_axis(w->y, w->qy, w->vy, w->ry, weft, warp, off.y);
  split_axis(w->z, w->qz, w->vz, w->rz, weft, warp, off.z);
  w->warp_at[c] = (row_id)warp;
  w->place[warp] = (row_id)c;
  world_toggle(w, TOPOLOGY_WARP, c, warp);
  write_couple(w, c, (w->couple[c] & (uint32_t)COUPLE_WANTED) | to);
  split_rows(w, c);
  return 1;
}

void couple_change(fray_world *w, uint32_t c, fray_couple to) {
  --*count_of(w, couple_at(w, c));
  ++*count_of(w, to);
  write_couple(w, c, (w->couple[c] & (uint32_t)COUPLE_WANTED) | to);
  if (to != FRAY_DISCONNECTED) return;
  weave_star star;
  weave_rows_at(world_weave(w), c, &star);
  for (uint32_t n = star.along_warp; n < star.count; ++n) {
    world_kill_row(w, w->row_of[star.row[n]]);
    world_kill_row(w, w->row_of[star.row[n] + (uint32_t)w->params->shears]);
  }
}
