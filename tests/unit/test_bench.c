/* SPDX-License-Identifier: Apache-2.0 */
/* What `fray bench` computes and writes around its clocks. */
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"

#include "tools/bench/scaling.h"
#include "tools/bench/json.h"
#include "tools/bench/tear_phases.h"
#include "tools/bench/projections.h"

static void json_is_json(void) {
  char text[512];
  FILE *out = tmpfile();
  json j = {out, 0, 0};
  CHECK(out != NULL);
  if (out == NULL) return;
  json_begin(&j, NULL, '{');
  json_text(&j, "a \"b\"\\", "tab\tline\n\x01");
  json_begin(&j, "list", '[');
  json_number(&j, NULL, 1.25);
  json_number(&j, NULL, -0.00004);
  json_number(&j, NULL, (double)NAN);
  json_number(&j, NULL, (double)INFINITY);
  json_begin(&j, NULL, '{');
  json_end(&j, '}');
  json_end(&j, ']');
  json_count(&j, "n", 18446744073709551615ull);
  json_end(&j, '}');
  rewind(out);
  text[fread(text, 1, sizeof text - 1, out)] = 0;
  fclose(out);
  CHECK_TEXT(text,
             "{\n"
             "  \"a \\\"b\\\"\\\\\": \"tab\\u0009line\\u000a\\u0001\",\n"
             "  \"list\": [\n"
             "    1.2500,\n"
             "    -0.0000,\n"
             "    null,\n"
             "    null,\n"
             "    {}\n"
             "  ],\n"
             "  \"n\": 18446744073709551615\n"
             "}\n");
}

static int near(double a, double b) { return fabs(a - b) < 1e-9; }

static void a_line_goes_through_points(void) {
  static const double x[4] = {1, 2, 3, 4};
  static const double on_it[4] = {5, 7, 9, 11};
  static const double beside[4] = {6, 5, 7, 10}; /* slope 1.4, offset 3.5, R2 0.7 by hand */
  const line_fit straight = line_through(x, on_it, 4);
  CHECK(near(straight.slope, 2) && near(straight.offset, 3) && near(straight.r2, 1));
  const line_fit loose = line_through(x, beside, 4);
  CHECK(near(loose.slope, 1.4) && near(loose.offset, 3.5) && near(loose.r2, 0.7));
}

static void rounds_give_least_and_median(void) {
  double values[5] = {9, 2, 4, 100, 3};
  const min_median s = min_median_of(values, 5);
  CHECK(near(s.min, 2) && near(s.median, 4));
}

/* What is kept are batches in long runs, and nothing else is projected. */
static void only_runs_are_kept(void) {
  struct world_file o;
  kernels k;
  projection_times t;
  CHECK_EQ_INT(world_file_open("tests/scenes/hanging.scene", &o, stderr), 0);
  CHECK(kernels_find(&k, o.world, "scalar"));
  CHECK_EQ_INT(k.count, 1);
  const uint32_t rows = projections_keep_runs(&o);
  CHECK(rows > 1000);
  uint32_t found = 0;
  for (int32_t n = 0; n < o.world->params->link_batches; ++n) {
    const spring_batch *b = &o.world->woven.batches[n];
    int32_t runs = b->attached == BATCH_INACTIVE ? 0 : 1;
    for (int32_t row = b->first + 1; row < b->first + b->count; ++row)
      if (o.world->woven.spring_i[row] != o.world->woven.spring_i[row - 1] + 1u ||
          o.world->woven.spring_j[row] != o.world->woven.spring_j[row - 1] + 1u)
        ++runs;
    if (b->attached == BATCH_INACTIVE) continue;
    CHECK(b->count >= RUN_MEAN * runs);
    found += (uint32_t)b->count;
  }
  CHECK_EQ_INT(found, rows);
  CHECK(projections_time(o.world, &k, &t));
  CHECK_EQ_INT(t.rows, rows);
  CHECK_EQ_INT(o.world->work.projections % rows, 0);
  world_file_close(&o);
}

/* Three ticks with one unit in each stage, the last one with a long search for collisions. */
static void parts_of_a_tick_add_up(void) {
  static float ns[3 * TIMED_COUNT];
  for (int n = 0; n < 3 * TIMED_COUNT; ++n) ns[n] = 1;
  ns[2 * TIMED_COUNT + TIMED_TRIANGLE_COLLISION] = 31;
  const tear_phase p = tear_phase_of(ns, 1, 3);
  double parts = 0;
  for (int n = 0; n < TEAR_TOTAL; ++n) parts += p.mean_ns[n];
  CHECK_EQ_INT(p.ticks, 2);
  CHECK(near(parts, p.mean_ns[TEAR_TOTAL]) && near(p.mean_ns[TEAR_TOTAL], TIMED_COUNT + 15.0));
  CHECK(near(p.worst_ns[TEAR_COLLISION] - p.mean_ns[TEAR_COLLISION], 15));
  CHECK(near(p.worst_ns[TEAR_TEARING], p.mean_ns[TEAR_TEARING]));
  CHECK_EQ_INT(tear_phase_of(ns, 2, 2).ticks, 0);
}

int main(void) {
  TEST(json_is_json);
  TEST(a_line_goes_through_points);
  TEST(rounds_give_least_and_median);
  TEST(parts_of_a_tick_add_up);
  TEST(only_runs_are_kept);
  return test_end();
}
