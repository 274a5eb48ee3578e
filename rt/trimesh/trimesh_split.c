/* SPDX-License-Identifier: Apache-2.0 */
/* Vertex splits and cuts. Both are planned first, on a one-ring that need not exist yet: a centre, and the
 * triangles around it. So a split or cut happens as a whole or changes nothing. */
#include "rt/trimesh/trimesh_split.h"

enum { RAYS = 3 };

typedef struct {
  trimesh_point centre;
  trimesh_ring ring;
  uint32_t rays;
  trimesh_ray ray[RAYS];  /* fraction 0: along a ring edge, else through a triangle */
  uint32_t ends[RAYS][2]; /* vertices at the ends of the ring edges on both sides of it */
  uint32_t min_quality;   /* of the parts that it leaves, see below */
} plan;

/* Tears divide edges in the middle. Cuts do it anywhere, and would leave slivers as thin as allowed all along
 * their path; small triangles vibrate. So cuts leave at least 4 times the minimal area and twice the minimal
 * height. */
enum { FOR_TEAR = 0, FOR_CUT = 1 };

static int64_t cross(trimesh_point from, trimesh_point to, int32_t du, int32_t dv) {
  return fx_add64(fx_mul_wide(fx_sub(to.u, from.u), dv), -fx_mul_wide(fx_sub(to.v, from.v), du));
}

/* before / (before + after), Q16. */
static uint32_t fraction_of(uint64_t before, uint64_t after) {
  uint64_t whole = before + after;
  unsigned shift = 0;
  while (whole >> shift >= (uint64_t)1 << 31) ++shift;
  whole >>= shift;
  return whole == 0 ? 0 : fx_divide_wide(before >> shift << 16, (uint32_t)whole);
}

int trimesh_ray_along(const trimesh *s, const trimesh_ring *ring, trimesh_point centre, int32_t du,
                    int32_t dv, trimesh_ray *ray) {
  FRAY_ASSERT(ring->count > 0 && ring->count <= TRIMESH_RING_MAX);
  for (uint32_t n = 0; n < ring->count; ++n) {
    const int64_t before = cross(centre, trimesh_at(s, trimesh_ring_end(s, ring, n)), du, dv);
    const int64_t after = -cross(centre, trimesh_at(s, trimesh_ring_end(s, ring, n + 1u)), du, dv);
    if (before < 0 || after <= 0) continue;
    ray->n = n;
    ray->fraction = fraction_of((uint64_t)before, (uint64_t)after);
    return 1;
  }
  return 0;
}

/* ---- the plan ---- */

static void begin_plan(plan *p, uint32_t min_quality, trimesh_point centre) {
  p->min_quality = min_quality;
  p->centre = centre;
  p->rays = 0;
}

static int can_open(const fray_world *w, const plan *p, uint32_t n) {
  const trimesh *s = &w->trimesh;
  if (p->ring.closed == 0 && (n == 0 || n >= p->ring.count)) return 0;
  const uint32_t end = trimesh_ring_end(s, &p->ring, n);
  return !(particle_is_attached(w, end) && trimesh_is_boundary(s, end));
}

/* 1 iff no planned ray divides triangle n of the ring, or its neighbour `other`. */
static int is_undivided(const trimesh *s, const plan *p, uint32_t n, uint32_t other) {
  for (uint32_t m = 0; m < p->rays; ++m) {
    const uint32_t at = p->ray[m].n;
    if (p->ray[m].fraction == 0) continue;
    if (at == n) return 0;
    if (other != TRIMESH_NONE &&
        trimesh_neighbour(s, p->ring.triangle[at], p->ring.corner[at]) == other)
      return 0;
  }
  return 1;
}

/* Triangle n of the ring can be divided from the centre to the opposite edge, and so can its neighbour there.
 * */
static int can_divide(const fray_world *w, const plan *p, uint32_t n, uint32_t fraction) {
  const trimesh *s = &w->trimesh;
  const uint32_t t = p->ring.triangle[n];
  const uint32_t k = p->ring.corner[n];
  const trimesh_point a = trimesh_at(s, trimesh_ring_end(s, &p->ring, n));
  const trimesh_point b = trimesh_at(s, trimesh_ring_end(s, &p->ring, n + 1u));
  const trimesh_point at = trimesh_point_on(a, b, fraction);
  const uint32_t other = trimesh_neighbour(s, t, k);
  if (p->ring.count + RAYS > TRIMESH_RING_MAX || !trimesh_has_area(s, t) || !is_undivided(s, p, n, other))
    return 0;
  if (!trimesh_exceeds_quality(s, p->min_quality, p->centre, a, at) ||
      !trimesh_exceeds_quality(s, p->min_quality, p->centre, at, b))
    return 0;
  if (other == TRIMESH_NONE) return 1;
  const uint32_t back = trimesh_neighbour_edge(s, t, k);
  return trimesh_parts_exceed(s, p->min_quality, other, back, at) &&
         trimesh_ring_has_room(s, s->triangle[other].v[back], RAYS);
}

static int has_ray_along(const fray_world *w, const plan *p, uint32_t n) {
  for (uint32_t m = 0; m < p->rays; ++m)
    if (p->ray[m].fraction == 0 && p->ends[m][0] == trimesh_ring_end(&w->trimesh, &p->ring, n)) return 1;
  return 0;
}

static void append_ray(const fray_world *w, plan *p, uint32_t n, uint32_t fraction) {
  FRAY_ASSERT(p->rays < RAYS && n <= p->ring.count && fraction < TRIMESH_WEIGHT_ONE);
  const trimesh_ray ray = {n, fraction};
  p->ends[p->rays][0] = trimesh_ring_end(&w->trimesh, &p->ring, n);
  p->ends[p->rays][1] = fraction == 0 ? TRIMESH_NONE : trimesh_ring_end(&w->trimesh, &p->ring, n + 1u);
  p->ray[p->rays++] = ray;
}

/* Adds a ray to the plan: as it is, or along the nearer or the other ring edge beside it. */
static int add_ray(const fray_world *w, plan *p, const trimesh_ray *ray) {
  if (ray->n >= p->ring.count || ray->fraction > TRIMESH_WEIGHT_ONE) return 0;
  if (ray->fraction != 0 && ray->fraction != TRIMESH_WEIGHT_ONE && can_divide(w, p, ray->n, ray->fraction)) {
    append_ray(w, p, ray->n, ray->fraction);
    return 1;
  }
  const uint32_t nearer = ray->fraction < TRIMESH_WEIGHT_ONE / 2 ? 0 : 1;
  for (uint32_t m = 0; m < 2; ++m) {
    const uint32_t n = ray->n + (m == 0 ? nearer : 1u - nearer);
    if (m != 0 && (ray->fraction == 0 || ray->fraction == TRIMESH_WEIGHT_ONE)) return 0;
    if (!can_open(w, p, n) || has_ray_along(w, p, n)) continue;
    append_ray(w, p, n, 0);
    return 1;
  }
  return 0;
}

/* Spare particles and triangles that the plan takes, without those of a new centre. */
static void count_needs(const fray_world *w, const plan *p, uint32_t *particles,
                        uint32_t *triangles) {
  const trimesh *s = &w->trimesh;
  *triangles = 0;
  *particles = p->ring.closed != 0 ? p->rays - 1u : p->rays;
  for (uint32_t m = 0; m < p->rays; ++m) {
    const uint32_t n = p->ray[m].n;
    if (p->ray[m].fraction == 0) {
      *particles += (uint32_t)trimesh_is_boundary(s, p->ends[m][0]);
      continue;
    }
    const int on_boundary = trimesh_neighbour(s, p->ring.triangle[n], p->ring.corner[n]) == TRIMESH_NONE;
    *particles += on_boundary ? 2 : 1;
    *triangles += on_boundary ? 1 : 2;
  }
}

/* For the plan and a new centre. */
static trimesh_result check_pools(const fray_world *w, const plan *p, uint32_t extra_particles,
                                uint32_t extra_triangles) {
  uint32_t particles;
  uint32_t triangles;
  count_needs(w, p, &particles, &triangles);
  if (particles + extra_particles > w->capacity[POOL_PARTICLES] - w->p.count) return TRIMESH_NO_PARTICLES;
  if (triangles + extra_triangles > w->capacity[POOL_TRIANGLES] - triangles_in_use(w))
    return TRIMESH_NO_TRIANGLES;
  return TRIMESH_DONE;
}

/* ---- its execution ---- */

trimesh_result trimesh_open_to(fray_world *w, uint32_t vertex, uint32_t end, trimesh_mark mark) {
  trimesh_ring ring;
  trimesh_ring_of(&w->trimesh, vertex, &ring);
  for (uint32_t n = ring.closed != 0 ? 0 : 1; n < ring.count; ++n)
    if (trimesh_ring_end(&w->trimesh, &ring, n) == end)
      return trimesh_open_edge(w, ring.triangle[n], trimesh_previous(ring.corner[n]), mark);
  return TRIMESH_NO_PATH;
}

/* Divides the edge between the ends of two ring edges; returns the new vertex. */
static uint32_t divide_edge_between(fray_world *w, uint32_t vertex, const uint32_t ends[2],
                               uint32_t fraction) {
  trimesh_ring ring;
  uint32_t added = TRIMESH_NONE;
  trimesh_ring_of(&w->trimesh, vertex, &ring);
  for (uint32_t n = 0; n < ring.count; ++n)
    if (trimesh_ring_end(&w->trimesh, &ring, n) == ends[0] &&
        trimesh_ring_end(&w->trimesh, &ring, n + 1u) == ends[1]) {
      (void)trimesh_divide_edge(w, ring.triangle[n], ring.corner[n], fraction, &added);
      break;
    }
  return added;
}

/* Opens the edge from the centre to `end`; adds the vertices that became two to `cut`. */
static void open_ray(fray_world *w, uint32_t centre, uint32_t end, trimesh_mark mark,
                     trimesh_cut_vertices *cut) {
  const int on_boundary = trimesh_is_boundary(&w->trimesh, end);
  const uint32_t before = w->p.count;
  (void)trimesh_open_to(w, centre, end, mark);
  if (on_boundary && w->p.count != before) cut->vertex[cut->count++] = end;
  for (uint32_t p = before; p < w->p.count; ++p) cut->vertex[cut->count++] = p;
}

static void execute(fray_world *w, const plan *p, uint32_t centre, trimesh_mark mark,
                    trimesh_cut_vertices *cut) {
  uint32_t to[RAYS];
  FRAY_ASSERT(p->rays >= 1 && centre < w->p.count);
  cut->vertex[0] = centre;
  cut->count = 1;
  for (uint32_t m = 0; m < p->rays; ++m)
    to[m] = p->ray[m].fraction == 0 ? p->ends[m][0]
                                 : divide_edge_between(w, centre, p->ends[m], p->ray[m].fraction);
  /* the second ray divides a closed ring: after it the centre is another vertex, so it comes last */
  for (uint32_t m = 0; m < p->rays; ++m)
    open_ray(w, centre, to[m == 0 ? 0 : p->rays - m], mark, cut);
  FRAY_ASSERT(cut->count <= TRIMESH_CUT_VERTICES && w->p.count <= w->capacity[POOL_PARTICLES]);
}

/* ---- splitting a vertex ---- */

static trimesh_result plan_split(const fray_world *w, uint32_t vertex, const trimesh_ray *from,
                               const trimesh_ray *to, plan *p) {
  FRAY_ASSERT(vertex < w->p.count);
  begin_plan(p, FOR_TEAR, trimesh_at(&w->trimesh, vertex));
  trimesh_ring_of(&w->trimesh, vertex, &p->ring);
  if (particle_is_attached(w, vertex) || !add_ray(w, p, from)) return TRIMESH_NO_PATH;
  if (p->ring.closed != 0 && !add_ray(w, p, to)) return TRIMESH_NO_PATH;
  return TRIMESH_DONE;
}

trimesh_fit trimesh_can_split(const fray_world *w, uint32_t vertex, const trimesh_ray *from,
                          const trimesh_ray *to) {
  plan p;
  if (plan_split(w, vertex, from, to, &p) != TRIMESH_DONE) return TRIMESH_FITS_NOT;
  return p.ray[0].fraction == from->fraction ? TRIMESH_FITS : TRIMESH_FITS_ALONG_EDGE;
}

trimesh_result trimesh_split(fray_world *w, uint32_t vertex, const trimesh_ray *from, const trimesh_ray *to,
                         trimesh_mark mark) {
  plan p;
  trimesh_cut_vertices cut;
  trimesh_result result = plan_split(w, vertex, from, to, &p);
  if (result == TRIMESH_DONE) result = check_pools(w, &p, 0, 0);
  if (result == TRIMESH_DONE) execute(w, &p, vertex, mark, &cut);
  return result;
}

/* ---- cuts ---- */

/* A cut nearer to an end of an edge than this goes through the end: it would leave slivers all along its
 * path. */
enum { SNAP = TRIMESH_WEIGHT_ONE / 4 };

static uint32_t snap_to_end(uint32_t fraction) {
  if (fraction < SNAP) return 0;
  return fraction > TRIMESH_WEIGHT_ONE - SNAP ? TRIMESH_WEIGHT_ONE : fraction;
}

/* Adds the rays of a line through the centre: to both sides of it in a closed ring, as far as possible; one
 * in an open one. Returns 0 where there is none. */
static int add_line(const fray_world *w, plan *p, int32_t du, int32_t dv) {
  for (uint32_t m = 0; m < 2; ++m) {
    trimesh_ray ray;
    const int32_t sign = m == 0 ? 1 : -1;
    if (p->ring.closed == 0 && p->rays != 0) break;
    if (!trimesh_ray_along(&w->trimesh, &p->ring, p->centre, sign * du, sign * dv, &ray)) continue;
    ray.fraction = snap_to_end(ray.fraction);
    (void)add_ray(w, p, &ray);
  }
  return p->rays != 0;
}

static trimesh_result cut_vertex(fray_world *w, uint32_t vertex, int32_t du, int32_t dv,
                                 trimesh_cut_vertices *cut) {
  plan p;
  begin_plan(&p, FOR_CUT, trimesh_at(&w->trimesh, vertex));
  trimesh_ring_of(&w->trimesh, vertex, &p.ring);
  if (particle_is_attached(w, vertex) || !add_line(w, &p, du, dv)) return TRIMESH_NO_PATH;
  const trimesh_result result = check_pools(w, &p, 0, 0);
  if (result == TRIMESH_DONE) execute(w, &p, vertex, TRIMESH_CUT, cut);
  return result;
}

static void append_triangle(trimesh_ring *ring, uint32_t t, uint32_t k) {
  FRAY_ASSERT(ring->count < TRIMESH_RING_MAX && k < 3);
  ring->triangle[ring->count] = t;
  ring->corner[ring->count++] = (uint8_t)k;
}

/* The ring of the vertex that is about to divide edge k. */
static void ring_on_edge(const trimesh *s, uint32_t t, uint32_t k, trimesh_ring *ring) {
  const uint32_t other = trimesh_neighbour(s, t, k);
  ring->count = 0;
  ring->closed = other != TRIMESH_NONE;
  append_triangle(ring, t, trimesh_next(k));
  append_triangle(ring, t, trimesh_previous(k));
  if (other == TRIMESH_NONE) return;
  const uint32_t back = trimesh_neighbour_edge(s, t, k);
  append_triangle(ring, other, trimesh_next(back));
  append_triangle(ring, other, trimesh_previous(back));
}

static int parts_have_quality(const trimesh *s, uint32_t t, uint32_t k, uint32_t fraction) {
  const trimesh_point a = trimesh_at(s, s->triangle[t].v[trimesh_next(k)]);
  const trimesh_point b = trimesh_at(s, s->triangle[t].v[trimesh_previous(k)]);
  const trimesh_point at = trimesh_point_on(a, b, fraction);
  const uint32_t other = trimesh_neighbour(s, t, k);
  return trimesh_parts_exceed(s, FOR_CUT, t, k, at) &&
         (other == TRIMESH_NONE ||
          trimesh_parts_exceed(s, FOR_CUT, other, trimesh_neighbour_edge(s, t, k), at));
}

trimesh_result trimesh_cut_edge(fray_world *w, uint32_t t, uint32_t k, uint32_t fraction, int32_t du,
                            int32_t dv, trimesh_cut_vertices *cut) {
  FRAY_ASSERT(t < triangles_in_use(w) && k < 3);
  const trimesh *s = &w->trimesh;
  const uint32_t a = s->triangle[t].v[trimesh_next(k)];
  const uint32_t b = s->triangle[t].v[trimesh_previous(k)];
  plan p;
  if (fraction > TRIMESH_WEIGHT_ONE) return TRIMESH_NO_PATH;
  if (snap_to_end(fraction) != fraction || !trimesh_can_divide_edge(s, t, k, fraction) ||
      !parts_have_quality(s, t, k, fraction))
    return cut_vertex(w, fraction < TRIMESH_WEIGHT_ONE / 2 ? a : b, du, dv, cut);
  begin_plan(&p, FOR_CUT, trimesh_point_on(trimesh_at(s, a), trimesh_at(s, b), fraction));
  ring_on_edge(s, t, k, &p.ring);
  if (!add_line(w, &p, du, dv)) return TRIMESH_NO_PATH;
  trimesh_result result = check_pools(w, &p, 1, p.ring.closed != 0 ? 2 : 1);
  if (result != TRIMESH_DONE) return result;
  uint32_t centre = TRIMESH_NONE;
  result = trimesh_divide_edge(w, t, k, fraction, &centre);
  execute(w, &p, centre, TRIMESH_CUT, cut);
  return result;
}

/* The edge that a point in a triangle is nearest to, by the area between, and where on it. */
static uint32_t nearest_edge(const uint32_t weight[3], uint32_t *fraction) {
  uint32_t k = 0;
  for (uint32_t n = 1; n < 3; ++n)
    if (weight[n] < weight[k]) k = n;
  const uint32_t both = weight[trimesh_next(k)] + weight[trimesh_previous(k)];
  *fraction = fx_divide_wide((uint64_t)weight[trimesh_previous(k)] << 16, both);
  return k;
}

trimesh_result trimesh_cut_triangle(fray_world *w, uint32_t t, uint32_t weight0, uint32_t weight1,
                                int32_t du, int32_t dv, trimesh_cut_vertices *cut) {
  FRAY_ASSERT(t < triangles_in_use(w));
  const trimesh *s = &w->trimesh;
  plan p;
  if (weight0 > TRIMESH_WEIGHT_ONE || weight1 > TRIMESH_WEIGHT_ONE - weight0) return TRIMESH_NO_PATH;
  if (!trimesh_can_divide_triangle(s, t, weight0, weight1)) {
    const uint32_t weight[3] = {weight0, weight1, TRIMESH_WEIGHT_ONE - weight0 - weight1};
    uint32_t fraction;
    const uint32_t k = nearest_edge(weight, &fraction);
    return trimesh_cut_edge(w, t, k, fraction, du, dv, cut);
  }
  begin_plan(&p, FOR_CUT, trimesh_point_in(s, t, weight0, weight1));
  p.ring.count = 0;
  p.ring.closed = 1;
  for (uint32_t k = 0; k < 3; ++k) append_triangle(&p.ring, t, k);
  for (uint32_t n = 0; n < 3; ++n)
    if (can_open(w, &p, n)) append_ray(w, &p, n, 0);
  if (p.rays == 0) return TRIMESH_NO_PATH;
  trimesh_result result = check_pools(w, &p, 1, 2);
  if (result != TRIMESH_DONE) return result;
  uint32_t centre = TRIMESH_NONE;
  result = trimesh_divide_triangle(w, t, weight0, weight1, &centre);
  execute(w, &p, centre, TRIMESH_CUT, cut);
  return result;
}
