/* SPDX-License-Identifier: Apache-2.0 */
/* Tears and cuts of membranes: after each of 10,000 random ones the sheet is whole in itself, its
 * sums are the same to the last bit, and what cannot be done changes nothing. */
#include "tests/lib/test.h"

#include "rt/trimesh/trimesh_split.h"
#include "tests/lib/bare_membrane.h"
#include "tests/lib/trimesh_check.h"

typedef struct {
  uint32_t kind, at, k, share, share1;
  int32_t du, dv;
} act;

static act draw(const fray_world *w, uint64_t *seed) {
  act a;
  a.kind = bare_below(seed, 8);
  a.at = bare_below(seed, a.kind < 4 ? w->p.count : (uint32_t)w->trimesh.state->triangles);
  a.k = bare_below(seed, 3);
  a.share = bare_below(seed, TRIMESH_WEIGHT_ONE + 1);
  a.share1 = bare_below(seed, TRIMESH_WEIGHT_ONE + 1 - a.share);
  a.du = bare_between(seed, -(1 << 30), 1 << 30);
  a.dv = bare_between(seed, -(1 << 30), 1 << 30);
  return a;
}

static trimesh_result split(fray_world *w, const act *a) {
  trimesh_ring fan;
  trimesh_ray from;
  trimesh_ray to;
  trimesh_ring_of(&w->trimesh, a->at, &fan);
  const trimesh_point centre = trimesh_at(&w->trimesh, a->at);
  if (!trimesh_ray_along(&w->trimesh, &fan, centre, a->du, a->dv, &from)) return TRIMESH_NO_PATH;
  if (fan.closed != 0 && !trimesh_ray_along(&w->trimesh, &fan, centre, -a->du, -a->dv, &to))
    return TRIMESH_NO_PATH;
  return trimesh_split(w, a->at, &from, &to, TRIMESH_TORN);
}

static trimesh_cut_vertices lips; /* of the last cut */

static trimesh_result perform(fray_world *w, const act *a) {
  uint32_t born;
  if (a->kind < 4) return split(w, a);
  if (a->kind == 4) return trimesh_open_edge(w, a->at, a->k, TRIMESH_CUT);
  if (a->kind == 5) return trimesh_cut_edge(w, a->at, a->k, a->share, a->du, a->dv, &lips);
  if (a->kind == 6) return trimesh_cut_triangle(w, a->at, a->share, a->share1, a->du, a->dv, &lips);
  return a->share % 2 == 0 ? trimesh_divide_edge(w, a->at, a->k, a->share, &born)
                           : trimesh_divide_triangle(w, a->at, a->share, a->share1, &born);
}

typedef struct {
  uint32_t done, no_way, no_particles, no_triangles, kinds[8];
  double worst_area, worst_weight;
} tally;

/* What is refused for want of room needs more than there is, and with enough of it is done. */
static void check_refusal(const bare_membrane *b, const act *a, trimesh_result result) {
  CLOSED_BY(bare_close) bare_membrane roomy = {0};
  bare_copy(&roomy, b);
  const uint32_t particles = roomy.w.capacity[POOL_PARTICLES];
  const uint32_t triangles = roomy.w.capacity[POOL_TRIANGLES];
  roomy.w.capacity[POOL_PARTICLES] += BARE_HIDDEN;
  roomy.w.capacity[POOL_TRIANGLES] += BARE_HIDDEN;
  CHECK_EQ_INT(perform(&roomy.w, a), TRIMESH_DONE);
  if (result == TRIMESH_NO_PARTICLES) CHECK(roomy.w.p.count > particles);
  if (result == TRIMESH_NO_TRIANGLES)
    CHECK((uint32_t)roomy.w.trimesh.state->triangles > triangles && roomy.w.p.count <= particles);
}

/* What was done takes as much as it takes, and no less: pools that have just enough do, one short of it
 * they are named. `before` is what it was done to. */
static void check_needs(const bare_membrane *before, const bare_membrane *b, const act *a) {
  const uint32_t particles = b->w.p.count;
  const uint32_t triangles = (uint32_t)b->w.trimesh.state->triangles;
  for (uint32_t n = 0; n < 3; ++n) {
    if ((n == 1 && particles == before->w.p.count) ||
        (n == 2 && triangles == (uint32_t)before->w.trimesh.state->triangles))
      continue;
    CLOSED_BY(bare_close) bare_membrane tight = {0};
    bare_copy(&tight, before);
    tight.w.capacity[POOL_PARTICLES] = particles - (n == 1);
    tight.w.capacity[POOL_TRIANGLES] = triangles - (n == 2);
    CHECK_EQ_INT(perform(&tight.w, a),
                 n == 0 ? TRIMESH_DONE : n == 1 ? TRIMESH_NO_PARTICLES : TRIMESH_NO_TRIANGLES);
    CHECK(bare_is_same(&tight, n == 0 ? b : before));
  }
}

/* One sheet until it has had so many tears and cuts, or no more fit. */
static void shred(bare_mesh mesh, uint64_t seed, const uint32_t spare[2], uint32_t wanted,
                  tally *total) {
  enum { COLUMNS = 14, ROWS = 12 };
  CLOSED_BY(bare_close) bare_membrane b = {0};
  bare_membrane before;
  trimesh_check k;
  bare_open(&b, mesh, COLUMNS, ROWS, spare[0], spare[1], seed);
  if (seed / 5 % 2 == 0) bare_lower_min_quality(&b);
  trimesh_check_open(&k, &b.w);
  trimesh_check_now(&k, &b.w);
  uint32_t refused = 0;
  for (uint32_t done = 0; done < wanted && refused < 400 && k.bad == 0;) {
    const act a = draw(&b.w, &seed);
    bare_copy(&before, &b);
    const trimesh_result result = perform(&b.w, &a);
    if (result == TRIMESH_DONE) {
      trimesh_check_now(&k, &b.w);
      check_needs(&before, &b, &a);
      ++done;
      ++total->done;
      ++total->kinds[a.kind];
      refused = 0;
    } else {
      CHECK(bare_is_same(&before, &b));
      total->no_way += result == TRIMESH_NO_PATH;
      total->no_particles += result == TRIMESH_NO_PARTICLES;
      total->no_triangles += result == TRIMESH_NO_TRIANGLES;
      if (result != TRIMESH_NO_PATH) check_refusal(&b, &a, result);
      ++refused;
    }
    bare_close(&before);
  }
  CHECK_EQ_INT(k.bad, 0);
  if (k.worst_area > total->worst_area) total->worst_area = k.worst_area;
  if (k.worst_weight > total->worst_weight) total->worst_weight = k.worst_weight;
}

static void random_tears_and_cuts(void) {
  tally total;
  memset(&total, 0, sizeof total);
  static const uint32_t spare[5][2] = {{3000, 3000}, {3000, 3000}, {3000, 3000}, {60, 60}, {90, 40}};
  for (uint32_t run = 0; total.done < 10000 && run < 1000; ++run)
    shred((bare_mesh)(run % BARE_MESHES), 1000 + run, spare[run % 5], 400, &total);
  CHECK(total.done >= 10000);
  for (uint32_t n = 0; n < 8; ++n) CHECK(total.kinds[n] > 100);
  CHECK(total.no_particles > 10 && total.no_triangles > 10);
  CHECK(total.worst_area <= 16);
  CHECK(total.worst_weight <= 1e-6);
  printf("figure sheet_tears_and_cuts %u (asked: 10000); refused: %u no way, %u no particles, %u no "
         "triangles\n", total.done, total.no_way, total.no_particles, total.no_triangles);
  printf("figure sheet_area_off %.3g of 2^-30 lu^2, weights %.3g per lu (asked: 16, 1e-6)\n",
         total.worst_area, total.worst_weight);
}

/* ---- what becomes of one ---- */

enum { WIDE = 6, HIGH = 6 };
static uint32_t at(uint32_t i, uint32_t j) { return j * (WIDE + 1) + i; }

/* With floors that leave room for three parts of a triangle. */
static fray_world *open_small(bare_membrane *b, bare_mesh mesh) {
  bare_open(b, mesh, WIDE, HIGH, 40, 40, 1);
  bare_lower_min_quality(b);
  return &b->w;
}

static uint32_t pieces(const fray_world *w, uint32_t vertex) {
  uint32_t count = 0; /* vertices at the same place of the rest shape */
  for (uint32_t p = 0; p < w->p.count; ++p)
    count += w->trimesh.u[p] == w->trimesh.u[vertex] && w->trimesh.v[p] == w->trimesh.v[vertex];
  return count;
}

static uint32_t marked(const fray_world *w, trimesh_mark mark) {
  uint32_t count = 0;
  for (uint32_t t = 0; t < (uint32_t)w->trimesh.state->triangles; ++t)
    for (uint32_t k = 0; k < 3; ++k) count += trimesh_mark_of(&w->trimesh, t, k) == mark;
  return count;
}

static trimesh_result split_along(fray_world *w, uint32_t vertex, int32_t du, int32_t dv) {
  const act a = {0, vertex, 0, 0, 0, du, dv};
  return split(w, &a);
}

/* Spokes of the regular mesh go along u, along v, and along both. */
static void a_tear_goes_on_from_its_ends(void) {
  CLOSED_BY(bare_close) bare_membrane b = {0};
  fray_world *w = open_small(&b, BARE_REGULAR);
  const uint32_t p = at(3, 3), first = w->p.count;
  CHECK_EQ_INT(split_along(w, p, 0, 1 << 20), TRIMESH_DONE);
  CHECK_EQ_INT(w->p.count, first + 1);
  CHECK_EQ_INT(pieces(w, p), 2);
  CHECK_EQ_INT(pieces(w, at(3, 4)), 1);
  CHECK_EQ_INT(marked(w, TRIMESH_TORN), 4);
  const int32_t *const arrays[] = {w->p.x, w->p.y, w->p.z, w->p.qx, w->p.qy, w->p.qz, w->p.vx, w->p.vy, w->p.vz};
  for (uint32_t n = 0; n < 9; ++n) CHECK_EQ_INT(arrays[n][first], arrays[n][p]);
  CHECK(abs((int)w->trimesh.mass[first] - (int)w->trimesh.mass[p]) < 64); /* three triangles each */
  CHECK(trimesh_is_boundary(&w->trimesh, at(3, 4)) && trimesh_is_boundary(&w->trimesh, at(3, 2)));
  /* the next ones divide the vertex that was its end, and at the border that too */
  CHECK_EQ_INT(split_along(w, at(3, 4), 0, 1 << 20), TRIMESH_DONE);
  CHECK_EQ_INT(pieces(w, at(3, 4)), 2);
  CHECK_EQ_INT(pieces(w, at(3, 5)), 1);
  CHECK_EQ_INT(split_along(w, at(3, 5), 0, 1 << 20), TRIMESH_DONE);
  CHECK_EQ_INT(pieces(w, at(3, 5)), 2);
  CHECK_EQ_INT(pieces(w, at(3, 6)), 2);
  CHECK_EQ_INT(w->trimesh.state->triangles, 2 * WIDE * HIGH);
}

static void a_ray_near_a_side_goes_along_it(void) {
  CLOSED_BY(bare_close) bare_membrane b = {0};
  fray_world *w = open_small(&b, BARE_REGULAR);
  CHECK_EQ_INT(split_along(w, at(3, 3), 1 << 16, 1 << 20), TRIMESH_DONE); /* 3.6 degrees */
  CHECK_EQ_INT(w->trimesh.state->triangles, 2 * WIDE * HIGH);
  CHECK_EQ_INT(pieces(w, at(3, 3)), 2);
  CHECK_EQ_INT(split_along(w, at(1, 3), 1 << 19, 1 << 20), TRIMESH_DONE); /* 27 degrees */
  CHECK_EQ_INT(w->trimesh.state->triangles, 2 * WIDE * HIGH + 4);
}

static void what_is_held_stays_whole(void) {
  CLOSED_BY(bare_close) bare_membrane b = {0};
  fray_world *w = open_small(&b, BARE_REGULAR);
  CHECK_EQ_INT(split_along(w, at(3, 0), 0, 1 << 20), TRIMESH_NO_PATH);
  CHECK_EQ_INT(split_along(w, at(3, 1), 0, 1 << 20), TRIMESH_NO_PATH); /* would divide at(3, 0) */
  CHECK_EQ_INT(split_along(w, at(3, 1), 1 << 20, 0), TRIMESH_DONE);
}

static void a_point_opens_three_sides(void) {
  CLOSED_BY(bare_close) bare_membrane b = {0};
  fray_world *w = open_small(&b, BARE_REGULAR);
  const uint32_t t = 2 * (2 * WIDE + 2), first = w->p.count;
  CHECK_EQ_INT(trimesh_cut_triangle(w, t, TRIMESH_WEIGHT_ONE / 3, TRIMESH_WEIGHT_ONE / 3, 1 << 20, 0, &lips), TRIMESH_DONE);
  CHECK_EQ_INT(w->trimesh.state->triangles, 2 * WIDE * HIGH + 2);
  CHECK_EQ_INT(w->p.count, first + 3);
  CHECK_EQ_INT(pieces(w, first), 3);
  CHECK_EQ_INT(marked(w, TRIMESH_CUT), 6);
}

/* An edge that goes over the middle of a side, across it: the way through both triangles opens. */
static void an_edge_opens_its_way(void) {
  CLOSED_BY(bare_close) bare_membrane b = {0};
  fray_world *w = open_small(&b, BARE_REGULAR);
  const uint32_t t = 2 * (2 * WIDE + 2), first = w->p.count;
  uint32_t k = 0; /* the side between both triangles of a cell */
  while (trimesh_neighbour(&w->trimesh, t, k) != t + 1) ++k;
  const uint32_t apex = w->trimesh.triangle[t].v[k];
  const uint32_t far = w->trimesh.triangle[t + 1].v[trimesh_neighbour_edge(&w->trimesh, t, k)];
  const int32_t du = w->trimesh.u[far] - w->trimesh.u[apex], dv = w->trimesh.v[far] - w->trimesh.v[apex];
  CHECK_EQ_INT(trimesh_cut_edge(w, t, k, TRIMESH_WEIGHT_ONE / 2, du, dv, &lips), TRIMESH_DONE);
  CHECK_EQ_INT(w->trimesh.state->triangles, 2 * WIDE * HIGH + 2);
  CHECK_EQ_INT(w->p.count, first + 2);
  CHECK_EQ_INT(pieces(w, first), 2);
  CHECK_EQ_INT(marked(w, TRIMESH_CUT), 4);
  CHECK(trimesh_is_boundary(&w->trimesh, apex) && trimesh_is_boundary(&w->trimesh, far));
  /* near its end it is the end that is split */
  CHECK_EQ_INT(trimesh_cut_edge(w, 0, 0, TRIMESH_WEIGHT_ONE - 100, 1 << 20, 0, &lips), TRIMESH_DONE);
  CHECK_EQ_INT(w->trimesh.state->triangles, 2 * WIDE * HIGH + 2);
}

/* A vertex that is born on a side stands on it and moves with it. */
static void what_is_born_is_between(void) {
  CLOSED_BY(bare_close) bare_membrane b = {0};
  uint32_t born;
  fray_world *w = open_small(&b, BARE_TURNED);
  const uint32_t t = 2 * (2 * WIDE + 2);
  const uint32_t a = w->trimesh.triangle[t].v[1], c = w->trimesh.triangle[t].v[2];
  CHECK_EQ_INT(trimesh_divide_edge(w, t, 0, TRIMESH_WEIGHT_ONE / 4, &born), TRIMESH_DONE);
  const int32_t *const arrays[] = {w->p.x, w->p.y, w->p.z, w->p.qx, w->p.qy, w->p.qz, w->p.vx, w->p.vy, w->p.vz,
                                   w->trimesh.u, w->trimesh.v};
  const double most[] = {0.6, 0.6, 0.6, 0.6, 0.6, 0.6, 3000, 3000, 3000, 0.6, 0.6};
  for (uint32_t n = 0; n < 11; ++n) {
    const double expected = arrays[n][a] + 0.25 * ((double)arrays[n][c] - arrays[n][a]);
    CHECK(fabs(arrays[n][born] - expected) <= most[n]); /* velocities by areas, which are whole steps */
  }
}

int main(void) {
  TEST(a_tear_goes_on_from_its_ends);
  TEST(a_ray_near_a_side_goes_along_it);
  TEST(what_is_held_stays_whole);
  TEST(a_point_opens_three_sides);
  TEST(an_edge_opens_its_way);
  TEST(what_is_born_is_between);
  TEST(random_tears_and_cuts);
  return test_end();
}
