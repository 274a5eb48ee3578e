/* SPDX-License-Identifier: Apache-2.0 */
/* Tears and cuts are planned on a fan that need not exist yet: a centre, and the sides around it. So it
 * is known before anything changes whether all of it can be done. */
#include "rt/model/sheet_split.h"

enum { RAYS = 3 };

typedef struct {
  uint32_t vertex; /* SHEET_NONE: the centre is still to be born */
  sheet_point centre;
  sheet_fan fan;
  uint32_t rays;
  sheet_ray ray[RAYS];     /* share 0 along a spoke, else through a triangle */
  uint32_t ends[RAYS][2];  /* where the spokes on both sides of it go to */
  uint32_t stouter;        /* than the floors: what it may leave, see below */
} plan;

/* Tears divide sides in the middle. Cuts do it anywhere, so slivers as thin as the floors would stand all along
 * their way, and small triangles tremble: they leave 4 times the least area and 2 times the least height. */
enum { FOR_TEAR = 0, FOR_CUT = 1 };

static int is_held(const fray_world *w, uint32_t p) { return p < (uint32_t)w->params->held; }

/* Where spoke n of a fan goes to; an open fan has one more than triangles. */
static uint32_t spoke(const sheet_mesh *s, const sheet_fan *fan, uint32_t n) {
  if (n < fan->count) return s->triangle[fan->triangle[n]].v[sheet_next(fan->corner[n])];
  if (fan->closed != 0) return spoke(s, fan, 0);
  return s->triangle[fan->triangle[n - 1u]].v[sheet_last(fan->corner[n - 1u])];
}

static int64_t turn(sheet_point from, sheet_point to, int32_t du, int32_t dv) {
  return fx_add64(fx_mul_wide(fx_sub(to.u, from.u), dv), -fx_mul_wide(fx_sub(to.v, from.v), du));
}

/* before / (before + behind), Q16. */
static uint32_t share_of(uint64_t before, uint64_t behind) {
  uint64_t whole = before + behind;
  unsigned shift = 0;
  while (whole >> shift >= (uint64_t)1 << 31) ++shift;
  whole >>= shift;
  return whole == 0 ? 0 : fx_divide_wide(before >> shift << 16, (uint32_t)whole);
}

int sheet_ray_along(const sheet_mesh *s, const sheet_fan *fan, sheet_point centre, int32_t du,
                    int32_t dv, sheet_ray *ray) {
  for (uint32_t n = 0; n < fan->count; ++n) {
    const int64_t before = turn(centre, sheet_at(s, spoke(s, fan, n)), du, dv);
    const int64_t behind = -turn(centre, sheet_at(s, spoke(s, fan, n + 1u)), du, dv);
    if (before < 0 || behind <= 0) continue;
    ray->n = n;
    ray->share = share_of((uint64_t)before, (uint64_t)behind);
    return 1;
  }
  return 0;
}

/* ---- the plan ---- */

static int may_open(const fray_world *w, const plan *p, uint32_t n) {
  const sheet_mesh *s = &w->sheet;
  if (p->fan.closed == 0 && (n == 0 || n >= p->fan.count)) return 0;
  const uint32_t end = spoke(s, &p->fan, n);
  return !(is_held(w, end) && sheet_is_open(s, end));
}

static int has_room_for(const sheet_mesh *s, uint32_t vertex, uint32_t more) {
  sheet_fan fan;
  sheet_walk(s, vertex, &fan);
  return fan.count + more <= SHEET_FAN;
}

/* 1 iff no ray that is planned already divides the triangle, or the one across its side. */
static int is_untouched(const sheet_mesh *s, const plan *p, uint32_t n, uint32_t other) {
  for (uint32_t m = 0; m < p->rays; ++m) {
    const uint32_t at = p->ray[m].n;
    if (p->ray[m].share == 0) continue;
    if (at == n) return 0;
    if (other != SHEET_NONE &&
        sheet_across(s, p->fan.triangle[at], p->fan.corner[at]) == other)
      return 0;
  }
  return 1;
}

/* The centre's triangle n can be divided towards its side, and so can the one across that. */
static int may_divide(const fray_world *w, const plan *p, uint32_t n, uint32_t share) {
  const sheet_mesh *s = &w->sheet;
  const uint32_t t = p->fan.triangle[n];
  const uint32_t k = p->fan.corner[n];
  const sheet_point a = sheet_at(s, spoke(s, &p->fan, n));
  const sheet_point b = sheet_at(s, spoke(s, &p->fan, n + 1u));
  const sheet_point at = sheet_between(a, b, share);
  const uint32_t other = sheet_across(s, t, k);
  if (p->fan.count + RAYS > SHEET_FAN || !is_untouched(s, p, n, other)) return 0;
  if (!sheet_is_stouter(s, p->stouter, p->centre, a, at) || !sheet_is_stouter(s, p->stouter, p->centre, at, b)) return 0;
  if (other == SHEET_NONE) return 1;
  const uint32_t far = s->triangle[other].v[sheet_back(s, t, k)];
  const sheet_point apex = sheet_at(s, far);
  return sheet_is_stouter(s, p->stouter, apex, b, at) && sheet_is_stouter(s, p->stouter, apex, at, a) &&
         has_room_for(s, far, RAYS);
}

static int is_taken(const fray_world *w, const plan *p, uint32_t n) {
  for (uint32_t m = 0; m < p->rays; ++m)
    if (p->ray[m].share == 0 && p->ends[m][0] == spoke(&w->sheet, &p->fan, n)) return 1;
  return 0;
}

static void put_ray(const fray_world *w, plan *p, uint32_t n, uint32_t share) {
  const sheet_ray ray = {n, share};
  p->ends[p->rays][0] = spoke(&w->sheet, &p->fan, n);
  p->ends[p->rays][1] = share == 0 ? SHEET_NONE : spoke(&w->sheet, &p->fan, n + 1u);
  p->ray[p->rays++] = ray;
}

/* Adds a ray to the plan as it can be done: as it is, or along a spoke beside it. */
static int add_ray(const fray_world *w, plan *p, const sheet_ray *ray) {
  if (ray->n >= p->fan.count || ray->share > SHEET_SHARE) return 0;
  if (ray->share != 0 && ray->share != SHEET_SHARE && may_divide(w, p, ray->n, ray->share)) {
    put_ray(w, p, ray->n, ray->share);
    return 1;
  }
  const uint32_t further = ray->share < SHEET_SHARE / 2 ? 0 : 1;
  for (uint32_t m = 0; m < 2; ++m) {
    const uint32_t n = ray->n + (m == 0 ? further : 1u - further);
    if (m != 0 && (ray->share == 0 || ray->share == SHEET_SHARE)) return 0;
    if (!may_open(w, p, n) || is_taken(w, p, n)) continue;
    put_ray(w, p, n, 0);
    return 1;
  }
  return 0;
}

/* Spare particles and triangles that the plan takes, beside those of the centre's birth. */
static void count_needs(const fray_world *w, const plan *p, uint32_t *particles,
                        uint32_t *triangles) {
  const sheet_mesh *s = &w->sheet;
  *triangles = 0;
  *particles = p->fan.closed != 0 ? p->rays - 1u : p->rays;
  for (uint32_t m = 0; m < p->rays; ++m) {
    const uint32_t n = p->ray[m].n;
    if (p->ray[m].share == 0) {
      *particles += (uint32_t)sheet_is_open(s, p->ends[m][0]);
      continue;
    }
    const int border = sheet_across(s, p->fan.triangle[n], p->fan.corner[n]) == SHEET_NONE;
    *particles += border ? 2 : 1;
    *triangles += border ? 1 : 2;
  }
}

/* For the plan and those of the centre's birth. */
static sheet_result check_pools(const fray_world *w, const plan *p, uint32_t born_particles,
                                uint32_t born_triangles) {
  uint32_t particles;
  uint32_t triangles;
  count_needs(w, p, &particles, &triangles);
  if (particles + born_particles > w->capacity[POOL_PARTICLES] - w->particles) return SHEET_NO_PARTICLES;
  if (triangles + born_triangles > w->capacity[POOL_TRIANGLES] - (uint32_t)w->sheet.state->triangles)
    return SHEET_NO_TRIANGLES;
  return SHEET_DONE;
}

/* ---- carrying it out ---- */

static void open_towards(fray_world *w, uint32_t vertex, uint32_t end, sheet_mark mark) {
  sheet_fan fan;
  sheet_walk(&w->sheet, vertex, &fan);
  for (uint32_t n = fan.closed != 0 ? 0 : 1; n < fan.count; ++n)
    if (spoke(&w->sheet, &fan, n) == end) {
      (void)sheet_open_side(w, fan.triangle[n], sheet_last(fan.corner[n]), mark);
      return;
    }
}

/* The new vertex between two neighbouring spokes. */
static uint32_t divide_between(fray_world *w, uint32_t vertex, const uint32_t ends[2],
                               uint32_t share) {
  sheet_fan fan;
  uint32_t born = SHEET_NONE;
  sheet_walk(&w->sheet, vertex, &fan);
  for (uint32_t n = 0; n < fan.count; ++n)
    if (spoke(&w->sheet, &fan, n) == ends[0] && spoke(&w->sheet, &fan, n + 1u) == ends[1]) {
      (void)sheet_divide_side(w, fan.triangle[n], fan.corner[n], share, &born);
      break;
    }
  return born;
}

/* All sides towards its ends open; what became two of that. */
static void open_ray(fray_world *w, uint32_t centre, uint32_t end, sheet_mark mark, sheet_lips *lips) {
  const int is_border = sheet_is_open(&w->sheet, end);
  const uint32_t before = w->particles;
  open_towards(w, centre, end, mark);
  if (is_border && w->particles != before) lips->vertex[lips->count++] = end;
  for (uint32_t p = before; p < w->particles; ++p) lips->vertex[lips->count++] = p;
}

static void carry_out(fray_world *w, const plan *p, uint32_t centre, sheet_mark mark, sheet_lips *lips) {
  uint32_t to[RAYS];
  lips->vertex[0] = centre;
  lips->count = 1;
  for (uint32_t m = 0; m < p->rays; ++m)
    to[m] = p->ray[m].share == 0 ? p->ends[m][0]
                                 : divide_between(w, centre, p->ends[m], p->ray[m].share);
  /* what opens second divides a closed fan: behind it the centre is another vertex */
  for (uint32_t m = 0; m < p->rays; ++m)
    open_ray(w, centre, to[m == 0 ? 0 : p->rays - m], mark, lips);
}

/* ---- splitting a vertex ---- */

static sheet_result plan_split(const fray_world *w, uint32_t vertex, const sheet_ray *from,
                               const sheet_ray *to, plan *p) {
  p->vertex = vertex;
  p->stouter = FOR_TEAR;
  p->centre = sheet_at(&w->sheet, vertex);
  p->rays = 0;
  sheet_walk(&w->sheet, vertex, &p->fan);
  if (is_held(w, vertex) || !add_ray(w, p, from)) return SHEET_NO_WAY;
  if (p->fan.closed != 0 && !add_ray(w, p, to)) return SHEET_NO_WAY;
  return SHEET_DONE;
}

sheet_fit sheet_can_split(const fray_world *w, uint32_t vertex, const sheet_ray *from,
                          const sheet_ray *to) {
  plan p;
  if (plan_split(w, vertex, from, to, &p) != SHEET_DONE) return SHEET_FITS_NOT;
  return p.ray[0].share == from->share ? SHEET_FITS : SHEET_FITS_BESIDE;
}

sheet_result sheet_split(fray_world *w, uint32_t vertex, const sheet_ray *from, const sheet_ray *to,
                         sheet_mark mark) {
  plan p;
  sheet_lips lips;
  sheet_result result = plan_split(w, vertex, from, to, &p);
  if (result == SHEET_DONE) result = check_pools(w, &p, 0, 0);
  if (result == SHEET_DONE) carry_out(w, &p, vertex, mark, &lips);
  return result;
}

/* ---- cuts ---- */

/* Of a side: nearer to an end than that a cut goes through the end. Slivers that a tear seldom leaves, as it
 * divides sides in the middle, a cut would leave all along its way. */
enum { CUT_NEAR = SHEET_SHARE / 4 };

static uint32_t drawn_to_end(uint32_t share) {
  if (share < CUT_NEAR) return 0;
  return share > SHEET_SHARE - CUT_NEAR ? SHEET_SHARE : share;
}

/* The way of an edge over the centre: to both sides of it in a closed fan, and as far as it goes; one
 * way in an open one. */
static int add_way(const fray_world *w, plan *p, int32_t du, int32_t dv) {
  for (uint32_t m = 0; m < 2; ++m) {
    sheet_ray ray;
    const int32_t sign = m == 0 ? 1 : -1;
    if (p->fan.closed == 0 && p->rays != 0) break;
    if (!sheet_ray_along(&w->sheet, &p->fan, p->centre, sign * du, sign * dv, &ray)) continue;
    ray.share = drawn_to_end(ray.share);
    (void)add_ray(w, p, &ray);
  }
  return p->rays != 0;
}

static sheet_result cut_vertex(fray_world *w, uint32_t vertex, int32_t du, int32_t dv, sheet_lips *lips) {
  plan p;
  p.vertex = vertex;
  p.stouter = FOR_CUT;
  p.centre = sheet_at(&w->sheet, vertex);
  p.rays = 0;
  sheet_walk(&w->sheet, vertex, &p.fan);
  if (is_held(w, vertex) || !add_way(w, &p, du, dv)) return SHEET_NO_WAY;
  const sheet_result result = check_pools(w, &p, 0, 0);
  if (result == SHEET_DONE) carry_out(w, &p, vertex, SHEET_CUT, lips);
  return result;
}

static void put_side(sheet_fan *fan, uint32_t t, uint32_t k) {
  fan->triangle[fan->count] = t;
  fan->corner[fan->count++] = (uint8_t)k;
}

/* The sides around the vertex that side k will have, anticlockwise. */
static void fan_on_side(const sheet_mesh *s, uint32_t t, uint32_t k, sheet_fan *fan) {
  const uint32_t other = sheet_across(s, t, k);
  fan->count = 0;
  fan->closed = other != SHEET_NONE;
  put_side(fan, t, sheet_next(k));
  put_side(fan, t, sheet_last(k));
  if (other == SHEET_NONE) return;
  const uint32_t back = sheet_back(s, t, k);
  put_side(fan, other, sheet_next(back));
  put_side(fan, other, sheet_last(back));
}

static int parts_are_stouter(const sheet_mesh *s, uint32_t t, uint32_t k, uint32_t share) {
  const sheet_point a = sheet_at(s, s->triangle[t].v[sheet_next(k)]);
  const sheet_point b = sheet_at(s, s->triangle[t].v[sheet_last(k)]);
  const sheet_point at = sheet_between(a, b, share);
  const uint32_t other = sheet_across(s, t, k);
  for (uint32_t n = 0; n < (other == SHEET_NONE ? 1u : 2u); ++n) {
    const sheet_point apex = sheet_at(s, n == 0 ? s->triangle[t].v[k] : s->triangle[other].v[sheet_back(s, t, k)]);
    const int turned = n != 0;
    if (!sheet_is_stouter(s, FOR_CUT, apex, turned ? at : a, turned ? a : at) ||
        !sheet_is_stouter(s, FOR_CUT, apex, turned ? b : at, turned ? at : b))
      return 0;
  }
  return 1;
}

sheet_result sheet_cut_side(fray_world *w, uint32_t t, uint32_t k, uint32_t share, int32_t du,
                            int32_t dv, sheet_lips *lips) {
  const sheet_mesh *s = &w->sheet;
  const uint32_t a = s->triangle[t].v[sheet_next(k)];
  const uint32_t b = s->triangle[t].v[sheet_last(k)];
  plan p;
  if (share > SHEET_SHARE) return SHEET_NO_WAY;
  if (drawn_to_end(share) != share || !sheet_can_divide_side(s, t, k, share) || !parts_are_stouter(s, t, k, share))
    return cut_vertex(w, share < SHEET_SHARE / 2 ? a : b, du, dv, lips);
  p.vertex = SHEET_NONE;
  p.stouter = FOR_CUT;
  p.centre = sheet_between(sheet_at(s, a), sheet_at(s, b), share);
  p.rays = 0;
  fan_on_side(s, t, k, &p.fan);
  if (!add_way(w, &p, du, dv)) return SHEET_NO_WAY;
  const uint32_t pieces = p.fan.closed != 0 ? 2 : 1;
  sheet_result result = check_pools(w, &p, 1, pieces);
  if (result != SHEET_DONE) return result;
  uint32_t centre = SHEET_NONE;
  result = sheet_divide_side(w, t, k, share, &centre);
  carry_out(w, &p, centre, SHEET_CUT, lips);
  return result;
}

/* The side that a point in a triangle is nearest to, by the area between, and where on it. */
static uint32_t nearest_side(const uint32_t weight[3], uint32_t *share) {
  uint32_t k = 0;
  for (uint32_t n = 1; n < 3; ++n)
    if (weight[n] < weight[k]) k = n;
  const uint32_t both = weight[sheet_next(k)] + weight[sheet_last(k)];
  *share = fx_divide_wide((uint64_t)weight[sheet_last(k)] << 16, both);
  return k;
}

sheet_result sheet_cut_triangle(fray_world *w, uint32_t t, uint32_t share0, uint32_t share1,
                                int32_t du, int32_t dv, sheet_lips *lips) {
  const sheet_mesh *s = &w->sheet;
  plan p;
  if (share0 > SHEET_SHARE || share1 > SHEET_SHARE - share0) return SHEET_NO_WAY;
  if (!sheet_can_divide_triangle(s, t, share0, share1)) {
    const uint32_t weight[3] = {share0, share1, SHEET_SHARE - share0 - share1};
    uint32_t share;
    const uint32_t k = nearest_side(weight, &share);
    return sheet_cut_side(w, t, k, share, du, dv, lips);
  }
  p.vertex = SHEET_NONE;
  p.stouter = FOR_CUT;
  p.centre = sheet_within(s, t, share0, share1);
  p.rays = 0;
  p.fan.count = 0;
  p.fan.closed = 1;
  for (uint32_t k = 0; k < 3; ++k) put_side(&p.fan, t, k);
  for (uint32_t n = 0; n < 3; ++n)
    if (may_open(w, &p, n)) put_ray(w, &p, n, 0);
  if (p.rays == 0) return SHEET_NO_WAY;
  sheet_result result = check_pools(w, &p, 1, 2);
  if (result != SHEET_DONE) return result;
  uint32_t centre = SHEET_NONE;
  result = sheet_divide_triangle(w, t, share0, share1, &centre);
  carry_out(w, &p, centre, SHEET_CUT, lips);
  return result;
}
