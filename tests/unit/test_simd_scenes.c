/* SPDX-License-Identifier: Apache-2.0 */
/* Every scene that people run, under every kernel that this machine has: the hash after every tick
 * and all that it puts out are those of the scalar code, while the sheet tears. Settling is cut
 * short and cloth made weak, so that few ticks have everything. */
#include "tests/lib/test.h"
#include "tests/lib/simd_kernels.h"
#include "tests/lib/world_fixture.h"

enum { TICKS = 80 };

static void shorten(char *text) {
  char *settle = strstr(text, "\nsettle ");
  if (settle == NULL) return;
  char *end = strchr(settle + 1, '\n');
  memmove(settle, end, strlen(end) + 1);
}

static void make_weak(fixture *f) {
  params *p = fixture_params(f);
  p->tearing = 1;
  p->tear_min = 65536 / 500; /* 0.2 % */
  p->tear_max = 65536 / 25;
}

/* Hands part from each other, to and fro. */
static fray_input some_input(const fixture *f, uint32_t tick) {
  const int32_t away = (int32_t)(tick % 40) * 60;
  const int32_t at[FRAY_HANDS][3] = {{-away, away / 2, away / 5}, {away, away / 3, -away}};
  fray_input input = fixture_poses(f, at, tick);
  if (tick == 0) input.command = FRAY_COMMAND_START;
  return input;
}

static void run_scene(const char *path) {
  fixture scalar, other[SIMD_KERNELS];
  fray_kernel kernels[SIMD_KERNELS];
  const uint32_t count = simd_kernels(kernels);
  uint32_t different[SIMD_KERNELS] = {0};
  fray_output expected = {0};
  char *text = fixture_read(path);
  shorten(text);
  fixture_text(&scalar, text);
  make_weak(&scalar);
  for (uint32_t n = 0; n < count; ++n) {
    fixture_copy(&other[n], &scalar);
    CHECK(fray_set_kernel(other[n].w, kernels[n]));
  }
  for (uint32_t tick = 0; tick < TICKS; ++tick) {
    const fray_input input = some_input(&scalar, tick);
    expected = fixture_tick(&scalar, &input);
    for (uint32_t n = 0; n < count; ++n) {
      const fray_output out = fixture_tick(&other[n], &input);
      different[n] += out.hash != expected.hash || memcmp(out.force, expected.force, sizeof out.force) != 0 ||
                      memcmp(&out.work, &expected.work, sizeof out.work) != 0;
    }
  }
  for (uint32_t n = 0; n < count; ++n) {
    printf("figure %s %s %d ticks, %u cuts, ticks that differ from scalar %u (asked: 0)\n", path,
           simd_kernel_names[kernels[n]], TICKS, expected.tears_total, different[n]);
    CHECK_EQ_INT(different[n], 0);
    fixture_close(&other[n]);
  }
  CHECK(expected.tears_total > 0);
  fixture_close(&scalar);
  free(text);
}

static void bars_apart(void) { run_scene("tests/scenes/bars_apart.scene"); }
static void corner_load(void) { run_scene("tests/scenes/corner_load.scene"); }
static void cube(void) { run_scene("tests/scenes/cube.scene"); }
static void hanging(void) { run_scene("tests/scenes/hanging.scene"); }
static void mirror(void) { run_scene("tests/scenes/mirror.scene"); }
static void small(void) { run_scene("tests/scenes/small.scene"); }
static void thrown_ball(void) { run_scene("tests/scenes/thrown_ball.scene"); }
static void two_hands(void) { run_scene("tests/scenes/two_hands.scene"); }
static void weight(void) { run_scene("tests/scenes/weight.scene"); }

int main(void) {
  TEST(bars_apart);
  TEST(corner_load);
  TEST(cube);
  TEST(hanging);
  TEST(mirror);
  TEST(small);
  TEST(thrown_ball);
  TEST(two_hands);
  TEST(weight);
  return test_end();
}
