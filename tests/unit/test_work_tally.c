/* SPDX-License-Identifier: Apache-2.0 */
/* What `fray run` says of the counted work of a run. */
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"
#include "tools/analysis/work_tally.h"

static void open_sheet(fixture *f) {
  fixture_print(f, "scene tally\nrate 1000 Hz\nsubsteps 2\nlimits {\n contacts 0\n}\n"
                   "woven {\n warps 8\n wefts 6\n spacing 12 /cm\n}\npin row top\n");
}

static void read_print(work_tally *t, char text[1024]) {
  FILE *out = tmpfile();
  CHECK(out != NULL);
  if (out == NULL) return;
  work_tally_print(t, out);
  rewind(out);
  text[fread(text, 1, 1023, out)] = 0;
  fclose(out);
}

/* Of 1 M instructions a tick and of 2 M; the first cut ends the intact phase. */
static void phases_have_medians_and_worst(void) {
  fixture_scoped f = {0};
  CLOSED_BY(work_tally_close) work_tally t = {0};
  char text[1024] = "";
  open_sheet(&f);
  work_tally_open(&t, f.w);
  t.limits.projections = 100000;
  t.limits.tears = 10;
  for (uint32_t n = 0; n < 5; ++n) {
    fray_output out;
    memset(&out, 0, sizeof out);
    out.work.projections = n == 1 || n == 4 ? 20000 : 10000;
    out.work.tears = n == 3;
    work_tally_add(&t, &out);
  }
  CHECK_EQ_INT(t.count[TALLY_INTACT], 3);
  CHECK_EQ_INT(t.count[TALLY_TORN], 2);
  CHECK_EQ_INT(t.beyond, 0);
  read_print(&t, text);
  CHECK(strstr(text, "work intact  1.00 M instructions a tick (median), worst 2.00 times\n") != NULL);
  CHECK(strstr(text, "work torn    2.00 M instructions a tick (median), worst 1.00 times\n") != NULL);
  CHECK(strstr(text, "; 0 ticks beyond a bound\n") != NULL);
}

static void a_count_beyond_its_bound_is_told(void) {
  fixture_scoped f = {0};
  CLOSED_BY(work_tally_close) work_tally t = {0};
  char text[1024] = "";
  open_sheet(&f);
  work_tally_open(&t, f.w);
  fray_output out;
  memset(&out, 0, sizeof out);
  out.work.splits = 1; /* of a sheet without yarns */
  work_tally_add(&t, &out);
  CHECK_EQ_INT(t.beyond, 1);
  read_print(&t, text);
  CHECK(strstr(text, "; 1 ticks beyond a bound\n") != NULL);
}

static void a_run_keeps_to_its_bound(void) {
  fixture_scoped f = {0};
  CLOSED_BY(work_tally_close) work_tally t = {0};
  open_sheet(&f);
  work_tally_open(&t, f.w);
  for (uint32_t tick = 0; tick < 20; ++tick) {
    const fray_output out = fixture_tick(&f, &fixture_idle);
    work_tally_add(&t, &out);
  }
  CHECK_EQ_INT(t.beyond, 0);
  CHECK(t.worst > 0 && t.worst_events >= 0);
}

int main(void) {
  TEST(phases_have_medians_and_worst);
  TEST(a_count_beyond_its_bound_is_told);
  TEST(a_run_keeps_to_its_bound);
  return test_end();
}
