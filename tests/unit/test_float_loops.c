/* SPDX-License-Identifier: Apache-2.0 */
/* The float loops that fray's times are held against do fray's work: the same links, from the same
 * positions to the same positions. Sheets here have no compression share (a link's structural
 * spring is stiff enough to take all of it), as the float loops have none. */
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"

#include "rt/woven/woven.h"
#include "tools/bench/float_arrays.h"
#include "tools/bench/float_loop.h"
#include "tools/bench/float_records.h"
#include "tools/bench/projections.h"

enum { SWEEPS = 20, DEAD = 40 };

/* In spacings, after SWEEPS sweeps. Eight lanes differ from one by rounding (2^-22 of a link in a
 * share, 2^-22 lu in a position). fray's psi is within 0.25 % of the root up to 10 % of strain. */
static const double lanes_tolerance = 2e-5;
static const double fray_tolerance = 2e-4;

static const char *const sheets[] = {
    "pin row top", "pin column left", "pin crossing 0 0\npin crossing 36 0",
    "sphere a {\n radius 0.2 cm\n at 0.4 0.3 0 cm\n attach_within 0.05 cm\n}"};
enum { SHEETS = sizeof sheets / sizeof *sheets };

/* Shaken: every coordinate by up to a twentieth of a spacing. */
static void open_shaken(fixture *f, const char *pins) {
  uint64_t seed = 5;
  fixture_print(f,
                "scene loops\nrate 1000 Hz\nsubsteps 1\niterations 1\nwoven {\n warps 37\n wefts 23\n"
                " spacing 12 /cm\n structural 100000 g/s2\n gather 3 %% pleats 2\n}\n%s\n",
                pins);
  const int32_t reach = f->w->woven.link_classes[1].rest / 20;
  for (uint32_t p = (uint32_t)f->w->params->attached; p < (uint32_t)f->w->params->particles; ++p) {
    f->w->p.x[p] += (int32_t)(splitmix64(&seed) % (2u * (uint32_t)reach)) - reach;
    f->w->p.y[p] += (int32_t)(splitmix64(&seed) % (2u * (uint32_t)reach)) - reach;
    f->w->p.z[p] += (int32_t)(splitmix64(&seed) % (2u * (uint32_t)reach)) - reach;
  }
  CHECK_EQ_INT(f->w->woven.link_classes[1].push, 4096);
}

static uint32_t kill_rows(fixture *f) {
  uint64_t seed = 7;
  uint32_t killed = 0;
  while (killed < DEAD) {
    const uint32_t row = (uint32_t)(splitmix64(&seed) % (uint32_t)f->w->params->links);
    if (f->w->woven.spring_kind[row] == SPRING_DEAD || !fixture_spring_moves(f->w, row)) continue;
    f->w->woven.spring_kind[row] = SPRING_DEAD;
    ++killed;
  }
  return killed;
}

static uint32_t moving_rows(const fixture *f) {
  uint32_t rows = 0;
  for (uint32_t row = 0; row < (uint32_t)f->w->params->links; ++row)
    if (f->w->woven.spring_kind[row] != SPRING_DEAD && fixture_spring_moves(f->w, row)) ++rows;
  return rows;
}

static double spacing(const fixture *f) { return f->w->woven.link_classes[1].rest * 0x1p-24; }

static double farther(double most, double a, double b) { return fmax(most, fabs(a - b)); }

/* The farthest that a particle of each is from the scalar loop's, in spacings. */
static double records_differ(const fixture *f, const float_loop *l, const float_records *r) {
  double most = 0;
  for (uint32_t n = 0; n < r->particle_count; ++n) {
    most = farther(most, (double)l->particles[n].x, (double)r->particles[4 * n]);
    most = farther(most, (double)l->particles[n].y, (double)r->particles[4 * n + 1]);
    most = farther(most, (double)l->particles[n].z, (double)r->particles[4 * n + 2]);
  }
  return most / spacing(f);
}

static double arrays_differ(const fixture *f, const float_loop *l, const float_arrays *a) {
  double most = 0;
  for (uint32_t n = 0; n < a->particles; ++n) {
    most = farther(most, (double)l->particles[n].x, (double)a->x[n]);
    most = farther(most, (double)l->particles[n].y, (double)a->y[n]);
    most = farther(most, (double)l->particles[n].z, (double)a->z[n]);
  }
  return most / spacing(f);
}

static double fray_differs(const fixture *f, const float_loop *l) {
  double most = 0;
  for (uint32_t n = 0; n < (uint32_t)f->w->params->particles; ++n) {
    most = farther(most, (double)l->particles[n].x, f->w->p.x[n] * 0x1p-24);
    most = farther(most, (double)l->particles[n].y, f->w->p.y[n] * 0x1p-24);
    most = farther(most, (double)l->particles[n].z, f->w->p.z[n] * 0x1p-24);
  }
  return most / spacing(f);
}

static void compare_lanes(const fixture *f) {
  CLOSED_BY(float_loop_close) float_loop loop = {0};
  CLOSED_BY(float_records_close) float_records records = {0};
  CLOSED_BY(float_arrays_close) float_arrays arrays = {0};
  CHECK(float_loop_open(&loop, f->w, FLOAT_BATCHED));
  CHECK(float_records_open(&records, f->w));
  CHECK(float_arrays_open(&arrays, f->w));
  CHECK_EQ_INT(loop.rows, moving_rows(f));
  CHECK_EQ_INT(records.rows, loop.rows);
  CHECK_EQ_INT(arrays.rows, loop.rows);
  for (int n = 0; n < SWEEPS; ++n) {
    float_loop_iterate(&loop);
    float_records_iterate(&records);
    float_arrays_iterate(&arrays);
  }
  const double by_ids = records_differ(f, &loop, &records);
  const double in_runs = arrays_differ(f, &loop, &arrays);
  CHECK(by_ids <= lanes_tolerance);
  CHECK(in_runs <= lanes_tolerance);
  printf("figure float_lanes %.2g by ids, %.2g in runs (%u of %u rows) (asked: %g spacings)\n",
         by_ids, in_runs, arrays.springs_in_runs, arrays.rows, lanes_tolerance);
}

static void eight_lanes_are_as_one(void) {
  if (!float_avx2_able()) {
    printf("not run: the AVX2 loops needs a processor that has it\n");
    return;
  }
  for (int n = 0; n < SHEETS; ++n) {
    fixture_scoped f = {0};
    open_shaken(&f, sheets[n]);
    compare_lanes(&f);
    kill_rows(&f);
    compare_lanes(&f);
  }
}

static void fray_does_the_same(void) {
  for (int n = 0; n < SHEETS; ++n) {
    fixture_scoped f = {0};
    CLOSED_BY(float_loop_close) float_loop loop = {0};
    open_shaken(&f, sheets[n]);
    kill_rows(&f);
    CHECK(float_loop_open(&loop, f.w, FLOAT_BATCHED));
    for (int sweep = 0; sweep < SWEEPS; ++sweep) {
      float_loop_iterate(&loop);
      strain_limit_apply(f.w);
    }
    const double away = fray_differs(&f, &loop);
    CHECK(away <= fray_tolerance);
    printf("figure float_fray %.2g (asked: %g spacings)\n", away, fray_tolerance);
  }
}

/* Root of the mean square strain. */
static double strain_left(const float_loop *l) {
  double sum = 0;
  for (uint32_t n = 0; n < l->rows; ++n) {
    const float_particle a = l->particles[l->i[n]];
    const float_particle b = l->particles[l->j[n]];
    const double x = (double)(b.x - a.x);
    const double y = (double)(b.y - a.y);
    const double z = (double)(b.z - a.z);
    const double strain = sqrt(x * x + y * y + z * z) / (double)l->rest[n] - 1;
    sum += strain * strain;
  }
  return sqrt(sum / l->rows);
}

static void orders_do_the_same(void) {
  fixture_scoped f = {0};
  float_loop loops[3];
  double left[3];
  open_shaken(&f, sheets[0]);
  for (int order = 0; order < 3; ++order) {
    CHECK(float_loop_open(&loops[order], f.w, (float_order)order));
    CHECK_EQ_INT(loops[order].rows, moving_rows(&f));
    const double before = strain_left(&loops[order]);
    for (int n = 0; n < SWEEPS; ++n) float_loop_iterate(&loops[order]);
    left[order] = strain_left(&loops[order]) / before;
    float_loop_close(&loops[order]);
  }
  for (int order = 0; order < 3; ++order) CHECK(left[order] < 2 * left[(order + 1) % 3]);
  printf("figure float_orders %.3f plain, %.3f coloured, %.3f batched of the strain are left"
         " (asked: none twice another)\n",
         left[0], left[1], left[2]);
}

int main(void) {
  TEST(eight_lanes_are_as_one);
  TEST(fray_does_the_same);
  TEST(orders_do_the_same);
  return test_end();
}
