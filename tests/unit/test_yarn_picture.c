/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of yarns: where a yarn runs (Metaaphanon 2009, equation 2), which one lies on top, how
 * a torn one ends, and that the picture is the same to the byte wherever this is built. */
#include <stdlib.h>

#include "tests/lib/test.h"
#include "tools/render/picture.h"
#include "tools/render/png.h"
#include "tools/render/portable_math.h"
#include "tools/render/yarn_axes.h"
#include "tools/render/yarn_touch.h"

enum { WARPS = 12, WEFTS = 10, WIDTH = 480, HEIGHT = 400 };

static const float spacing = 0.8f, thickness = 0.1f;

typedef struct {
  const char *name;
  uint32_t repeat;
  uint64_t bits;
} weave_case;

static const weave_case weaves[] = {{"plain", 2, 0x0201},
                                    {"twill 2/1", 3, 0x050603},
                                    {"twill 2/2", 4, 0x090C0603},
                                    {"satin 5", 5, 0x170F1D1B1E}};
enum { WEAVE_CASES = sizeof weaves / sizeof weaves[0] };

/* Flat, facing +z, all springs alive. */
static int make_sheet(picture_source *s, const weave_case *w) {
  memset(s, 0, sizeof *s);
  if (!picture_source_reserve(s, WARPS, WEFTS, 0)) return 0;
  s->weave_columns = s->weave_rows = w->repeat;
  s->weave = w->bits;
  s->spacing = spacing;
  s->thickness = thickness;
  s->rate_hz = 1000;
  memset(s->springs, SPRING_ALIVE, picture_springs(WARPS, WEFTS));
  for (uint32_t j = 0; j < WEFTS; j++)
    for (uint32_t i = 0; i < WARPS; i++)
      s->crossings[j * WARPS + i] = (v3){spacing * ((float)i - 0.5f * (WARPS - 1)),
                                         spacing * (0.5f * (WEFTS - 1) - (float)j), 0.0f};
  return 1;
}

/* A crossing whose yarns have slid apart by `slide`, the warp's way. */
static void split_crossing(picture_source *s, uint32_t i, uint32_t j, v3 slide) {
  const uint32_t c = j * WARPS + i;
  s->split[c] = 1;
  s->half_gap[c] = v3_scale(slide, 0.5f);
  s->crossings[c] = v3_add_scaled(s->crossings[c], slide, 0.5f);
}

static int near(float a, float b) { return fabsf(a - b) < 1e-5f; }

static void yarns_lie_half_the_thickness_off_the_node(void) {
  for (uint32_t w = 0; w < WEAVE_CASES; w++) {
    CLOSED_BY(picture_source_close) picture_source s = {0};
    CLOSED_BY(yarn_axes_close) yarn_axes axes = {0};
    CHECK(make_sheet(&s, &weaves[w]) && yarn_axes_open(&axes, &s));
    for (uint32_t c = 0; c < WARPS * WEFTS; c++) {
      const float side = picture_warp_over(&s, c % WARPS, c / WARPS) ? 0.5f : -0.5f;
      const v3 warp = yarn_axes_at(&axes, AXIS_WARP, c), weft = yarn_axes_at(&axes, AXIS_WEFT, c);
      CHECK(near(warp.z, side * thickness) && near(weft.z, -side * thickness));
      CHECK(near(warp.x, s.crossings[c].x) && near(weft.y, s.crossings[c].y));
    }
  }
}

static void a_split_crossing_gives_its_particles(void) {
  CLOSED_BY(picture_source_close) picture_source s = {0};
  CLOSED_BY(yarn_axes_close) yarn_axes axes = {0};
  CHECK(make_sheet(&s, &weaves[0]));
  const v3 node = s.crossings[4 * WARPS + 3];
  split_crossing(&s, 3, 4, (v3){0.3f, -0.1f, 0.2f});
  CHECK(yarn_axes_open(&axes, &s));
  const uint32_t c = 4 * WARPS + 3;
  const v3 warp = yarn_axes_at(&axes, AXIS_WARP, c), weft = yarn_axes_at(&axes, AXIS_WEFT, c);
  CHECK(near(weft.x, node.x) && near(weft.y, node.y) && near(weft.z, 0.0f));
  CHECK(near(warp.x, node.x + 0.3f) && near(warp.y, node.y - 0.1f) && near(warp.z, 0.2f));
}

/* Half a spacing from its crossing, along the warp. */
static void the_wave_of_a_split_crossing_is_where_its_yarns_touch(void) {
  CLOSED_BY(picture_source_close) picture_source s = {0};
  CLOSED_BY(yarn_axes_close) yarn_axes axes = {0};
  CHECK(make_sheet(&s, &weaves[0]));
  const uint32_t c = 4 * WARPS + 3;
  const float side = picture_warp_over(&s, 3, 4) ? 1.0f : -1.0f;
  split_crossing(&s, 3, 4, (v3){0.0f, 0.5f * spacing, 0.0f});
  s.touching[c] = 1;
  s.place[AXIS_WEFT][c] = 3.0f;
  s.place[AXIS_WARP][c] = 4.5f;
  CHECK(yarn_axes_open(&axes, &s));
  for (int axis = 0; axis < AXES; axis++) {
    yarn_touch_place list[WARPS];
    yarn_touches t = {.list = list};
    float touch = 0.0f;
    const float place = s.place[axis][c], sign = axis == AXIS_WARP ? side : -side;
    const yarn_path path = yarn_path_of(&axes, axis, axis == AXIS_WARP ? 3 : 4);
    yarn_touches_read(&t, &path);
    CHECK_EQ_INT(t.count, 1);
    CHECK(near(yarn_touches_at(&t, place, &touch).z, sign) && near(touch, 1.0f));
    CHECK(near(yarn_touches_at(&t, place - 0.5f, &touch).z, 0.5f * sign) && near(touch, 0.5f));
    CHECK(near(yarn_touches_at(&t, place + 1.0f, &touch).z, 0.0f) && near(touch, 0.0f));
  }
}

static void a_yarn_is_its_points_and_pieces(void) {
  CLOSED_BY(picture_source_close) picture_source s = {0};
  CLOSED_BY(yarn_axes_close) yarn_axes axes = {0};
  CHECK(make_sheet(&s, &weaves[0]));
  s.springs[picture_weft_spring(&s, 6, 2)] = SPRING_CUT;
  CHECK(yarn_axes_open(&axes, &s));
  const yarn_path weft = yarn_path_of(&axes, AXIS_WEFT, 2);
  const yarn_path warp = yarn_path_of(&axes, AXIS_WARP, 6);
  CHECK_EQ_INT(weft.count, WARPS);
  CHECK_EQ_INT(warp.count, WEFTS);
  CHECK_EQ_INT(yarn_path_crossing(&weft, 5), 2 * WARPS + 5);
  CHECK_EQ_INT(yarn_path_crossing(&warp, 5), 5 * WARPS + 6);
  for (uint32_t k = 0; k < WARPS; k++)
    CHECK_EQ_INT(yarn_path_joined(&weft, k), k != 6 && k + 1 < WARPS);
  CHECK_EQ_INT(yarn_path_spring(&weft, WARPS - 1), UINT32_MAX);
  /* Catmull and Rom: half the way between the neighbours; at an end, to the only one. */
  CHECK(near(yarn_path_tangent(&weft, 3).x, spacing) && near(yarn_path_tangent(&weft, 3).z, 0.0f));
  CHECK(near(fabsf(yarn_path_tangent(&weft, 6).z), thickness));
  CHECK(near(fabsf(yarn_path_tangent(&weft, 7).z), thickness));
}

typedef struct {
  canvas c;
  camera cam;
  uint8_t *pixels;
} shot;

/* yaw 0: from the front, 180: from behind. */
static int take(shot *t, const picture_source *s, cloth_look look, float yaw) {
  const float x = 0.5f * spacing * WARPS, y = 0.5f * spacing * WEFTS;
  const bounds frame = {{-x, -y, -0.1f}, {x, y, 0.1f}};
  picture_style style = picture_style_default(frame, look);
  style.cloth.warp = rgb_hex(0xC03020);
  style.cloth.weft = rgb_hex(0x2030C0);
  style.ground = 0;
  t->cam = camera_frame(frame, yaw, 0.0f, WIDTH, HEIGHT);
  t->pixels = malloc((size_t)WIDTH * HEIGHT * 3);
  if (!t->pixels || !canvas_open(&t->c, WIDTH, HEIGHT, 2)) return 0;
  if (!picture_draw(&t->c, &t->cam, s, &style)) return 0;
  canvas_resolve(&t->c, t->pixels);
  return 1;
}

static void drop(shot *t) {
  canvas_close(&t->c);
  free(t->pixels);
}

static const uint8_t *pixel_at(const shot *t, v3 p) {
  canvas_vertex v;
  const int in_picture =
      camera_project(&t->cam, p, &v) && v.x >= 0 && v.y >= 0 && v.x < WIDTH && v.y < HEIGHT;
  CHECK(in_picture);
  if (!in_picture) return t->pixels;
  return t->pixels + 3 * ((size_t)v.y * WIDTH + (size_t)v.x);
}

static int is_warp(const uint8_t *p) { return p[0] > p[2] + 40; }
static int is_weft(const uint8_t *p) { return p[2] > p[0] + 40; }

static void what_is_over_hides_what_is_under(void) {
  for (uint32_t w = 0; w < WEAVE_CASES; w++) {
    for (int behind = 0; behind < 2; behind++) {
      CLOSED_BY(picture_source_close) picture_source s = {0};
      CLOSED_BY(drop) shot t = {0};
      CHECK(make_sheet(&s, &weaves[w]) && take(&t, &s, LOOK_YARN, behind ? 180.0f : 0.0f));
      uint32_t wrong = 0;
      for (uint32_t c = 0; c < WARPS * WEFTS; c++) {
        const int warp = picture_warp_over(&s, c % WARPS, c / WARPS) != behind;
        for (int place = 0; place < 5; place++) {
          static const float off[5][2] = {{0, 0}, {0.3f, 0}, {-0.3f, 0}, {0, 0.3f}, {0, -0.3f}};
          v3 p = s.crossings[c];
          p.x += off[place][0] * spacing;
          p.y += off[place][1] * spacing;
          const uint8_t *seen = pixel_at(&t, p);
          wrong += !(warp ? is_warp(seen) : is_weft(seen));
        }
      }
      CHECK_EQ_INT(wrong, 0);
    }
  }
}

/* How much of the background shines through, by how far the pixel is from what stands there. */
static int cover(const shot *with, const shot *without, v3 p) {
  const uint8_t *a = pixel_at(with, p), *b = pixel_at(without, p);
  return abs(a[0] - b[0]) + abs(a[1] - b[1]) + abs(a[2] - b[2]);
}

/* One end of a torn weft by itself in the air, its seven points; or not even that. */
static int take_thread(shot *t, picture_source *s, int there) {
  const v3 away = {1e5f, 0.0f, -1e4f};
  if (!make_sheet(s, &weaves[0])) return 0;
  memset(s->springs, SPRING_CUT, picture_springs(WARPS, WEFTS));
  for (uint32_t c = 0; c < WARPS * WEFTS; c++) {
    if (there && c / WARPS == 4 && c % WARPS <= 6)
      split_crossing(s, c % WARPS, 4, away);
    else
      s->crossings[c] = away;
  }
  for (uint32_t i = 0; i + 1 < WARPS; i++)
    if (i != 6) s->springs[picture_weft_spring(s, i, 4)] = SPRING_ALIVE;
  return take(t, s, LOOK_YARN, 0.0f);
}

static void torn_tips_fade_out(void) {
  picture_source s, nothing;
  shot bare, torn;
  CHECK(take_thread(&bare, &nothing, 0) && take_thread(&torn, &s, 1));
  yarn_axes axes;
  CHECK(yarn_axes_open(&axes, &s));
  const v3 end = yarn_axes_at(&axes, AXIS_WEFT, 4 * WARPS + 6);
  yarn_axes_close(&axes);
  int seen[10];
  for (int n = 0; n < 10; n++)
    seen[n] = cover(&torn, &bare, (v3){end.x + 0.1f * (float)n * spacing, end.y, end.z});
  CHECK(seen[0] > 200);
  for (int n = 1; n < 10; n++) CHECK(seen[n] < seen[n - 1] || seen[n] == 0);
  CHECK(seen[7] < seen[0] / 5);
  CHECK_EQ_INT(seen[9], 0);
  drop(&bare);
  drop(&torn);
  picture_source_close(&nothing);
  picture_source_close(&s);
}

static void wires_tell_yarns_from_the_base(void) {
  CLOSED_BY(picture_source_close) picture_source s = {0};
  CLOSED_BY(drop) shot t = {0};
  CHECK(make_sheet(&s, &weaves[0]));
  for (uint32_t j = 0; j < WEFTS; j++) split_crossing(&s, 9, j, (v3){0.0f, 0.0f, 0.2f});
  s.springs[picture_weft_spring(&s, 2, 5)] = SPRING_CUT;
  CHECK(take(&t, &s, LOOK_WIRE, 0.0f));
  const v3 half = {0.5f * spacing, 0.0f, 0.0f};
  const uint8_t *base = pixel_at(&t, v3_add(s.crossings[4 * WARPS + 2], half));
  CHECK(base[0] > base[1] + 60 && base[2] > base[1] + 40);
  yarn_axes axes;
  CHECK(yarn_axes_open(&axes, &s));
  const uint8_t *yarn = pixel_at(&t, v3_add(yarn_axes_at(&axes, AXIS_WEFT, 4 * WARPS + 9), half));
  CHECK(yarn[1] > yarn[0] + 60 && yarn[2] > yarn[0] + 60);
  yarn_axes_close(&axes);
  const uint8_t *gap = pixel_at(&t, v3_add(s.crossings[5 * WARPS + 2], half));
  CHECK(gap[0] == 255 && gap[1] == 255 && gap[2] == 255);
}

/* Waves, a tear, yarns that have slipped: everything that a picture computes. */
static void make_frayed(picture_source *s) {
  CHECK(make_sheet(s, &weaves[2]));
  for (uint32_t c = 0; c < WARPS * WEFTS; c++)
    s->crossings[c].z = 0.5f * portable_wave((float)(c % WARPS) / WARPS);
  for (uint32_t j = 4; j < WEFTS; j++) {
    s->springs[picture_weft_spring(s, 5, j)] = SPRING_CUT;
    for (uint32_t i = 6; i < 9; i++)
      split_crossing(s, i, j, (v3){-0.06f * (float)(j - 3), 0.02f * (float)i, 0.1f});
  }
  s->springs[picture_warp_spring(s, 3, 6)] = SPRING_CUT;
}

static void pictures_are_the_same_everywhere(void) {
  static const uint32_t expected[3] = {2133633605u, 1791975222u, 2121436156u};
  for (int look = LOOK_SURFACE; look <= LOOK_WIRE; look++) {
    CLOSED_BY(picture_source_close) picture_source s = {0};
    CLOSED_BY(drop) shot t = {0};
    make_frayed(&s);
    CHECK(take(&t, &s, (cloth_look)look, 25.0f));
    CHECK_EQ_INT(png_crc32(0, t.pixels, (size_t)WIDTH * HEIGHT * 3), expected[look]);
  }
}

static void portable_functions_are_exact_enough(void) {
  for (int k = -2000; k <= 2000; k++) {
    const double x = k * 0.0137;
    CHECK(fabs(portable_sin(x) - sin(x)) < 1e-12 && fabs(portable_cos(x) - cos(x)) < 1e-12);
  }
  for (int n = 1; n <= 12; n++) {
    for (double v = 1e-9; v < 1e6; v *= 3.7) {
      CHECK(fabs(portable_root(v, n) / pow(v, 1.0 / n) - 1.0) < 1e-13);
      CHECK(fabs(portable_power(v, n) / pow(v, n) - 1.0) < 1e-13);
    }
  }
  CHECK(portable_root(0.0, 5) == 0.0 && portable_power(2.0, -3) == 0.125);
  for (int k = -30; k <= 30; k++) {
    CHECK_EQ_INT(portable_decade(pow(10.0, k) * 1.001), k);
    CHECK_EQ_INT(portable_decade(pow(10.0, k) * 0.999), k - 1);
  }
}

int main(void) {
  TEST(yarns_lie_half_the_thickness_off_the_node);
  TEST(a_split_crossing_gives_its_particles);
  TEST(the_wave_of_a_split_crossing_is_where_its_yarns_touch);
  TEST(a_yarn_is_its_points_and_pieces);
  TEST(what_is_over_hides_what_is_under);
  TEST(torn_tips_fade_out);
  TEST(wires_tell_yarns_from_the_base);
  TEST(pictures_are_the_same_everywhere);
  TEST(portable_functions_are_exact_enough);
  return test_end();
}
