/* SPDX-License-Identifier: Apache-2.0 */
/* The puck of adding.sh, a cylinder along its first axis, in a copy of the tree that has it: against double
 * precision, through a save, and in a picture. */
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"
#include "tools/render/body_picture.h"

enum { TABLE = 0, LEANING = 1, FLOOR = 2, TICKS = 600 };
static const double step = 0x1p-24; /* lu */

/* How far a particle is inside of what cloth keeps off the table, an upright cylinder: below 0 outside. */
static double depth_in_table(const fray_world *w, uint32_t p, double *off_axis) {
  const fray_body b = fray_view_body(w, TABLE);
  const double x = ((double)w->p.x[p] - b.position[0]) * step, z = ((double)w->p.z[p] - b.position[2]) * step;
  const double skin = w->params->thickness * step;
  *off_axis = sqrt(x * x + z * z);
  return fmin(b.half[0] * step + skin - fabs(((double)w->p.y[p] - b.position[1]) * step),
              b.radius * step + skin - *off_axis);
}

static void cloth_rests_on_it(void) {
  fixture f;
  double deepest = -1, off_axis;
  uint32_t resting = 0, over = 0;
  fixture_file(&f, "tests/adding/puck.scene", NULL);
  for (int tick = 0; tick < TICKS; tick++) {
    fixture_tick(&f, &fixture_idle);
    for (uint32_t p = 0; p < f.w->p.count; p++) deepest = fmax(deepest, depth_in_table(f.w, p, &off_axis));
  }
  for (uint32_t p = 0; p < f.w->p.count; p++) {
    const double depth = depth_in_table(f.w, p, &off_axis);
    if (off_axis > 0.8 * fray_view_body(f.w, TABLE).radius * step) continue;
    over++;
    resting += fabs(depth) < 0.1 * f.w->params->thickness * step;
  }
  printf("deepest %.3g steps, %u of %u rest\n", deepest / step, resting, over);
  CHECK(deepest < 8 * step);
  CHECK(over > 100);
  CHECK_EQ_INT(resting, over);
  fixture_close(&f);
}

static void a_free_one_rests_on_a_plane(void) {
  fixture f;
  fixture_file(&f, "tests/adding/puck.scene", NULL);
  for (int tick = 0; tick < TICKS; tick++) fixture_tick(&f, &fixture_idle);
  const fray_body b = fray_view_body(f.w, LEANING);
  const double sine = b.axes[1] * 0x1p-30; /* of its axis over the plane */
  const double reach = b.half[0] * sine + b.radius * sqrt(1 - sine * sine);
  const double height = (double)b.position[1] - fray_view_body(f.w, FLOOR).position[1];
  printf("height %.1f, expected %.1f\n", height, reach);
  CHECK(fabs(height - reach) < 8);
  fixture_close(&f);
}

static void a_save_has_it(void) {
  fixture f, copy;
  fixture_file(&f, "tests/adding/puck.scene", NULL);
  for (int tick = 0; tick < TICKS / 4; tick++) fixture_tick(&f, &fixture_idle);
  fixture_copy(&copy, &f);
  CHECK_EQ_INT(fray_view_body(copy.w, LEANING).shape, FRAY_PUCK);
  for (int tick = 0; tick < TICKS / 4; tick++) {
    fixture_tick(&f, &fixture_idle);
    fixture_tick(&copy, &fixture_idle);
  }
  CHECK(fray_hash(f.w) == fray_hash(copy.w));
  fixture_close(&copy);
  fixture_close(&f);
}

/* Square millimetres of the table as seen against `back`, from its depths alone. */
static double area_seen(const picture_body *b, v3 right, v3 up, v3 back) {
  enum { SIDE = 400 };
  const float pixels = 20;
  const camera cam = {v3_add_scaled(b->position, back, 100), right, up, back, pixels, SIDE / 2, SIDE / 2, 1};
  canvas c;
  double samples = 0;
  if (!canvas_open(&c, SIDE, SIDE, 1)) return 0;
  canvas_fill(&c, rgb_hex(0), rgb_hex(0));
  body_picture_draw(&c, &cam, NULL, b);
  for (uint32_t n = 0; n < c.columns * c.rows; n++) samples += c.depth[n] > -INFINITY;
  canvas_close(&c);
  return samples / (pixels * pixels);
}

static void a_picture_shows_it(void) {
  const v3 x = {1, 0, 0}, y = {0, 1, 0}, z = {0, 0, 1};
  picture_source source = {0};
  fixture f;
  fixture_file(&f, "tests/adding/puck.scene", NULL);
  CHECK(picture_source_read(&source, f.w));
  const double from_above = area_seen(&source.bodies[TABLE], x, v3_scale(z, -1), y);
  const double from_beside = area_seen(&source.bodies[TABLE], x, y, z);
  printf("%.2f and %.2f square mm\n", from_above, from_beside);
  CHECK(fabs(from_above / (3.14159265 * 6 * 6) - 1) < 0.01);
  CHECK(fabs(from_beside / (12 * 6) - 1) < 0.01);
  picture_source_close(&source);
  fixture_close(&f);
}

int main(void) {
  TEST(cloth_rests_on_it);
  TEST(a_free_one_rests_on_a_plane);
  TEST(a_save_has_it);
  TEST(a_picture_shows_it);
  return test_end();
}
