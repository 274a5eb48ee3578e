/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/camera.h"

#include "tools/render/portable_math.h"

static const float nearest_mm = 0.5f;
static const float margin = 1.06f;

bounds bounds_none(void) {
  return (bounds){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

void bounds_add(bounds *b, v3 p) {
  b->low = (v3){fminf(b->low.x, p.x), fminf(b->low.y, p.y), fminf(b->low.z, p.z)};
  b->high = (v3){fmaxf(b->high.x, p.x), fmaxf(b->high.y, p.y), fmaxf(b->high.z, p.z)};
}

void bounds_join(bounds *b, bounds other) {
  /* Not through bounds_add: the low corner of nothing is at +infinity. */
  if (!(other.low.x <= other.high.x)) return;
  bounds_add(b, other.low);
  bounds_add(b, other.high);
}

bounds bounds_within(bounds run, bounds start) {
  const float room = 0.3f * v3_length(v3_sub(start.high, start.low));
  if (!isfinite(room)) return run;
  const v3 low = v3_sub(start.low, (v3){room, room, room});
  const v3 high = v3_add(start.high, (v3){room, room, room});
  run.low = (v3){fmaxf(run.low.x, low.x), fmaxf(run.low.y, low.y), fmaxf(run.low.z, low.z)};
  run.high = (v3){fminf(run.high.x, high.x), fminf(run.high.y, high.y), fminf(run.high.z, high.z)};
  return run;
}

static v3 corner(bounds b, int k) {
  return (v3){k & 1 ? b.high.x : b.low.x, k & 2 ? b.high.y : b.low.y, k & 4 ? b.high.z : b.low.z};
}

static bounds sound(bounds b) {
  if (b.low.x <= b.high.x && isfinite(b.low.x) && isfinite(b.high.x)) return b;
  return (bounds){{-10, -10, -10}, {10, 10, 10}};
}

static void turn(camera *cam, v3 back) {
  const v3 hint = fabsf(back.y) > 0.999f ? (v3){0, 0, -1} : (v3){0, 1, 0};
  cam->back = back;
  cam->right = v3_unit(v3_cross(hint, back));
  cam->up = v3_cross(back, cam->right);
}

camera camera_look_at(v3 eye, v3 target, float field_degrees, uint32_t width, uint32_t height) {
  camera cam = {.eye = eye, .x = 0.5f * (float)width, .y = 0.5f * (float)height};
  turn(&cam, v3_unit(v3_sub(eye, target)));
  const double half = (double)field_degrees * 3.14159265358979 / 360.0;
  cam.pixels = cam.y * (float)(portable_cos(half) / portable_sin(half));
  return cam;
}

camera camera_frame(bounds b, float yaw, float pitch, uint32_t width, uint32_t height) {
  const double degree = 3.14159265358979 / 180.0;
  const double a = (double)yaw * degree, e = (double)pitch * degree, level = portable_cos(e);
  const v3 back = {(float)(portable_sin(a) * level), (float)portable_sin(e),
                   (float)(portable_cos(a) * level)};
  b = sound(b);
  v3 target = v3_scale(v3_add(b.low, b.high), 0.5f);
  camera cam = camera_look_at(v3_add(target, back), target, 28.0f, width, height);
  /* Each corner asks for a distance; then the target moves to where both sides fit alike. */
  float distance = 1.0f;
  for (int round = 0; round < 4; round++) {
    distance = 1.0f;
    for (int k = 0; k < 8; k++) {
      const v3 d = v3_sub(corner(b, k), target);
      const float x = fabsf(v3_dot(d, cam.right)) * cam.pixels / cam.x;
      const float y = fabsf(v3_dot(d, cam.up)) * cam.pixels / cam.y;
      distance = fmaxf(distance, v3_dot(d, cam.back) + margin * fmaxf(x, y));
    }
    float low = INFINITY, high = -INFINITY, left = INFINITY, right = -INFINITY;
    for (int k = 0; k < 8; k++) {
      const v3 d = v3_sub(corner(b, k), target);
      const float w = distance - v3_dot(d, cam.back);
      low = fminf(low, v3_dot(d, cam.up) / w);
      high = fmaxf(high, v3_dot(d, cam.up) / w);
      left = fminf(left, v3_dot(d, cam.right) / w);
      right = fmaxf(right, v3_dot(d, cam.right) / w);
    }
    target = v3_add_scaled(target, cam.up, 0.5f * (low + high) * distance);
    target = v3_add_scaled(target, cam.right, 0.5f * (left + right) * distance);
  }
  cam.eye = v3_add_scaled(target, cam.back, distance);
  return cam;
}

camera camera_default(bounds b, uint32_t width, uint32_t height) {
  b = sound(b);
  const v3 size = v3_sub(b.high, b.low);
  const float upright = clamp01(size.y / (fmaxf(size.x, size.z) + 1e-6f) * 1.6f);
  return camera_frame(b, 24.0f, 36.0f - 24.0f * upright, width, height);
}

camera camera_light(bounds b, v3 direction, uint32_t side) {
  b = sound(b);
  const v3 centre = v3_scale(v3_add(b.low, b.high), 0.5f);
  const float radius = 0.5f * v3_length(v3_sub(b.high, b.low)) + 1e-3f;
  camera cam = {.parallel = 1, .x = 0.5f * (float)side, .y = 0.5f * (float)side};
  turn(&cam, v3_unit(direction));
  cam.eye = v3_add_scaled(centre, cam.back, 2.0f * radius);
  cam.pixels = 0.49f * (float)side / radius;
  return cam;
}

int camera_project(const camera *cam, v3 p, canvas_vertex *v) {
  const v3 d = v3_sub(p, cam->eye);
  const float w = -v3_dot(d, cam->back);
  if (!(w > nearest_mm)) return 0;
  const float over = cam->parallel ? 1.0f : 1.0f / w;
  v->x = cam->x + v3_dot(d, cam->right) * cam->pixels * over;
  v->y = cam->y - v3_dot(d, cam->up) * cam->pixels * over;
  v->depth = cam->parallel ? -w : over;
  v->over_w = over;
  return 1;
}

v3 camera_towards(const camera *cam, v3 p) {
  return cam->parallel ? cam->back : v3_unit(v3_sub(cam->eye, p));
}

float camera_pixels(const camera *cam, v3 p) {
  const float w = -v3_dot(v3_sub(p, cam->eye), cam->back);
  return cam->parallel ? cam->pixels : cam->pixels / fmaxf(w, nearest_mm);
}
