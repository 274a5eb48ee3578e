/* SPDX-License-Identifier: Apache-2.0 */
/* A woven scene with the substeps that `auto` finds for it stays whole while its bodies stay: what cloth is
 * strained by at rest keeps a margin to what splits its crossings and tears its springs. */
#include "tests/lib/test.h"

#include "tests/lib/world_fixture.h"

enum { TICKS = 800 };

/* Figure 6's sheet, finer or coarser, held at two corners. */
static const char sheet[] =
    "scene sheet\nrate 1000 Hz\nsubsteps %s\nsettle 0.3 s\nseed 6\n"
    "woven {\n warps 40\n wefts 24\n spacing %u /cm\n weave %s\n density %s g/cm2\n thickness 0.01 cm\n"
    " structural 6000 g/s2\n bend 5 g/s2\n shear 2 g/s2\n tear 5 10 %%\n gather 8 %% pleats 6\n drag 2 /s\n%s}\n"
    "pin crossing 0 0\npin crossing 39 0\n";
/* A T-bar: a strip that is held at both ends carries a bar, which hangs by its middle. */
static const char bar[] =
    "scene t_bar\nrate 1000 Hz\nsubsteps %s\nsettle 0.5 s\nseed 2\n"
    "woven {\n warps 16\n wefts 33\n spacing %u /cm\n weave %s\n density %s g/cm2\n tear 5 10 %%\n drag 2 /s\n%s}\n"
    "capsule bar {\n radius 0.1 cm\n length 1.2 cm\n rotate 90 deg about z\n at 0 0 0 cm\n attach_within 0.01 cm\n"
    " move free\n mass 2 g\n}\n"
    "pin row top\npin row bottom\n";

static void stays_whole(const char *text, uint32_t density, const char *weave, const char *mass, const char *yarns) {
  fixture_scoped f = {0};
  fray_output out = {0};
  fixture_print(&f, text, "auto", density, weave, mass, yarns);
  const uint32_t particles = f.w->p.count;
  for (uint32_t tick = 0; tick < TICKS; ++tick) out = fixture_tick(&f, &fixture_idle);
  printf("figure auto_%u_%s_%s_%s %u substeps, strain %.2f of %.2f %% at rest, %u crossings split, %u springs torn (asked: "
         "0, 0)\n",
         density, weave, mass, yarns[0] != 0 ? "yarns" : "base", f.report.substeps, f.report.strain_q16 / 655.36,
         f.report.strain_max_q16 / 655.36, f.w->p.count - particles, out.tears_total);
  CHECK_EQ_INT(f.w->p.count, particles);
  CHECK_EQ_INT(out.tears_total, 0);
  CHECK(f.report.strain_q16 < f.report.strain_max_q16);
  CHECK_EQ_INT(f.report.limit, yarns[0] != 0 ? REST_BY_SPLIT : REST_BY_TEAR);
}

static void nothing_splits_at_rest(void) {
  static const uint32_t densities[] = {9, 12, 15, 18};
  static const char *const weaves[] = {"plain", "twill 2/1", "satin 8"};
  for (uint32_t n = 0; n < 4; ++n) stays_whole(sheet, densities[n], "plain", "0.25", " yarns on\n");
  for (uint32_t m = 0; m < 3; ++m) stays_whole(sheet, 15, weaves[m], "0.025", " yarns on\n");
  stays_whole(sheet, 15, "plain", "0.25", "");
  stays_whole(bar, 12, "plain", "0.025", " yarns on\n");
  stays_whole(bar, 12, "plain", "0.025", "");
}

/* A number of substeps is measured as `auto` measures it. */
static void given_substeps_are_measured(void) {
  static const uint32_t given[] = {4, 6, 8, 16, 24};
  static char text[4096];
  int32_t last = INT32_MAX;
  for (uint32_t n = 0; n < 5; ++n) {
    fixture_scoped f = {0};
    scene_error error;
    scene *s = malloc(sizeof *s);
    char number[8];
    snprintf(number, sizeof number, "%u", given[n]);
    snprintf(text, sizeof text, sheet, number, 15, "plain", "0.25", " yarns on\n");
    fixture_text(&f, text);
    CHECK_EQ_INT(f.report.strain_max_q16, 65536 * 4 / 5 * 9 / 200);
    CHECK_EQ_INT(f.report.limit, REST_BY_SPLIT);
    CHECK(s != NULL && scene_parse("test", text, strlen(text), s, &error));
    CHECK(compile_rest_strain(s, "test", &f.report, NULL, NULL, &error));
    free(s);
    CHECK_EQ_INT(f.report.substeps, given[n]);
    CHECK(f.report.strain_q16 > 0 && f.report.strain_q16 < last);
    printf("figure rest_strain_%u_substeps %.2f %% (printed)\n", given[n], f.report.strain_q16 / 655.36);
    last = f.report.strain_q16;
  }
}

int main(void) {
  TEST(nothing_splits_at_rest);
  TEST(given_substeps_are_measured);
  return test_end();
}
