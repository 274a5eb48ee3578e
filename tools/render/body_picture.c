/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/body_picture.h"

#include "tools/render/portable_math.h"

enum { AT = 0, NORMAL = 3, BODY_ATTRIBUTES = 6, SLICES = 48, STACKS = 24, GROUND_TILES = 32 };

static const v3 world_axes[3] = {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}};

typedef struct {
  canvas *c;
  const camera *cam;
  const lighting *light;
  rgb colour;
} body_job;

rgb body_picture_colour(const picture_body *b) {
  if (b->motion == FRAY_HAND) return rgb_hex(b->hand == 0 ? 0xE0742F : 0x2F9E74);
  if (b->motion == FRAY_FREE) return rgb_hex(0xCFA640);
  if (b->motion == FRAY_PATH) return rgb_hex(0xA66B9C);
  return rgb_hex(0x8C939B);
}

static canvas_sample shade_body(const void *context, const float *a, int front) {
  const body_job *k = context;
  (void)front;
  const v3 at = {a[AT], a[AT + 1], a[AT + 2]};
  const v3 normal = v3_unit((v3){a[NORMAL], a[NORMAL + 1], a[NORMAL + 2]});
  const surface_material m = {k->colour, 0.10f, 0.22f, 0.0f};
  const v3 towards = camera_towards(k->cam, at);
  return (canvas_sample){lighting_shade(k->light, &m, at, normal, normal, towards), 1.0f};
}

static int put(const body_job *k, canvas_vertex *v, v3 at, v3 normal) {
  const float values[BODY_ATTRIBUTES] = {at.x, at.y, at.z, normal.x, normal.y, normal.z};
  for (int n = 0; n < BODY_ATTRIBUTES; n++) v->a[n] = values[n];
  return camera_project(k->cam, at, v);
}

static void quad(const body_job *k, const canvas_vertex *a, const canvas_vertex *b,
                 const canvas_vertex *c, const canvas_vertex *d) {
  canvas_shader *shader = k->light ? shade_body : NULL;
  canvas_triangle(k->c, a, b, c, BODY_ATTRIBUTES, shader, k);
  canvas_triangle(k->c, a, c, d, BODY_ATTRIBUTES, shader, k);
}

/* A ball whose halves are moved apart by 2 * half along its first axis: a capsule. */
static void draw_round(const body_job *k, v3 centre, const v3 *axes, float radius, float half) {
  canvas_vertex ring[2][SLICES + 1];
  float sine[SLICES], cosine[SLICES];
  for (int slice = 0; slice < SLICES; slice++) {
    sine[slice] = (float)portable_sin(6.28318530717959 * slice / SLICES);
    cosine[slice] = (float)portable_cos(6.28318530717959 * slice / SLICES);
  }
  for (int stack = 0; stack <= STACKS + 1; stack++) {
    /* The equator comes twice, once for each half. */
    const int second = stack > STACKS / 2;
    const double polar = 3.14159265358979 * (second ? stack - 1 : stack) / STACKS;
    const float along = -(float)portable_cos(polar), around = (float)portable_sin(polar);
    canvas_vertex *now = ring[stack & 1], *before = ring[(stack & 1) ^ 1];
    for (int slice = 0; slice <= SLICES; slice++) {
      v3 n = v3_scale(axes[0], along);
      n = v3_add_scaled(n, axes[1], around * cosine[slice % SLICES]);
      n = v3_add_scaled(n, axes[2], around * sine[slice % SLICES]);
      const v3 middle = v3_add_scaled(centre, axes[0], second ? half : -half);
      if (!put(k, now + slice, v3_add_scaled(middle, n, radius), n)) return;
    }
    if (stack == 0) continue;
    for (int slice = 0; slice < SLICES; slice++)
      quad(k, before + slice, before + slice + 1, now + slice + 1, now + slice);
  }
}

static void draw_box(const body_job *k, const picture_body *b) {
  const float half[3] = {b->half.x, b->half.y, b->half.z};
  for (int face = 0; face < 6; face++) {
    const int a = face / 2, p = (a + 1) % 3, q = (a + 2) % 3;
    const v3 normal = v3_scale(b->axes[a], face & 1 ? 1.0f : -1.0f);
    const v3 middle = v3_add_scaled(b->position, normal, half[a]);
    canvas_vertex v[4];
    int good = 1;
    for (int n = 0; n < 4; n++) {
      const float sp = n == 0 || n == 3 ? -1.0f : 1.0f, sq = n < 2 ? -1.0f : 1.0f;
      v3 at = v3_add_scaled(middle, b->axes[p], sp * half[p]);
      at = v3_add_scaled(at, b->axes[q], sq * half[q]);
      good &= put(k, v + n, at, normal);
    }
    if (good) quad(k, v, v + 1, v + 2, v + 3);
  }
}

static v3 mesh_normal_of(const picture_body *b, uint32_t face) {
  const int32_t *n = b->mesh.face + 7 * face + 3;
  return v3_unit((v3){(float)n[0], (float)n[1], (float)n[2]});
}

/* Faces are flat, and seen from both sides. */
static void draw_mesh(const body_job *k, const picture_body *b) {
  canvas_shader *shader = k->light ? shade_body : NULL;
  for (uint32_t f = 0; f < b->mesh.faces; f++) {
    const v3 first = picture_mesh_point(b, (uint32_t)b->mesh.face[7 * f]);
    v3 normal = mesh_normal_of(b, f);
    if (v3_dot(camera_towards(k->cam, first), normal) < 0.0f) normal = v3_scale(normal, -1.0f);
    canvas_vertex v[3];
    int good = 1;
    for (uint32_t n = 0; n < 3; n++)
      good &= put(k, v + n, picture_mesh_point(b, (uint32_t)b->mesh.face[7 * f + n]), normal);
    if (good) canvas_triangle(k->c, v, v + 1, v + 2, BODY_ATTRIBUTES, shader, k);
  }
}

/* A step towards the eye, so that its own faces do not hide it. */
static int put_mark(const body_job *k, const picture_body *b, uint32_t point, canvas_vertex *v) {
  const v3 at = picture_mesh_point(b, point);
  return camera_project(k->cam, v3_add_scaled(at, camera_towards(k->cam, at), 0.3f), v);
}

/* What cuts is red, as in Karaoz 2015, figure 3.3. */
static void draw_sharp(const body_job *k, const picture_body *b) {
  const rgb red = rgb_hex(0xD0342C);
  canvas_vertex v[2];
  for (uint32_t e = 0; e < b->mesh.edges; e++) {
    const int32_t *edge = b->mesh.edge + 5 * e;
    if (edge[4] != 0 && put_mark(k, b, (uint32_t)edge[0], v) && put_mark(k, b, (uint32_t)edge[1], v + 1))
      canvas_wire(k->c, v, v + 1, 2.5f, red, 1.0f);
  }
  for (uint32_t p = 0; p < b->mesh.points; p++)
    if (b->mesh.point[5 * p + 3] != 0 && put_mark(k, b, p, v)) {
      v[1] = v[0];
      v[1].x += 0.5f;
      canvas_wire(k->c, v, v + 1, 6.0f, red, 1.0f);
    }
}

void body_picture_draw(canvas *c, const camera *cam, const lighting *light, const picture_body *b) {
  body_job k = {c, cam, light, body_picture_colour(b)};
  switch (b->shape) {
    case FRAY_SPHERE: draw_round(&k, b->position, world_axes, b->radius, 0.0f); break;
    case FRAY_CAPSULE: draw_round(&k, b->position, b->axes, b->radius, b->half.x); break;
    case FRAY_BOX: draw_box(&k, b); break;
    case FRAY_MESH:
      draw_mesh(&k, b);
      if (light) draw_sharp(&k, b);
      break;
    case FRAY_ANCHOR:
    case FRAY_PLANE: break;
  }
}

void body_picture_draw_pins(canvas *c, const camera *cam, const lighting *light, const picture_source *source) {
  const body_job k = {c, cam, light, rgb_hex(0x4A4F57)};
  for (uint32_t n = 0; n < source->warps * source->wefts; n++) {
    if (!source->pinned[n]) continue;
    draw_round(&k, source->crossings[n], world_axes, 0.42f * source->spacing, 0.0f);
  }
}

typedef struct {
  const lighting *light;
  v3 centre, normal, across, along;
  float reach, grid;
} ground_job;

/* Share of a line of this width in the distance to the nearest multiple of `step`. */
static float grid_line(float v, float step, float width) {
  const float d = fabsf(v / step - floorf(v / step + 0.5f)) * step;
  return clamp01(1.5f - d / width);
}

static canvas_sample shade_ground(const void *context, const float *a, int front) {
  const ground_job *k = context;
  (void)front;
  const v3 at = {a[0], a[1], a[2]};
  const v3 d = v3_sub(at, k->centre);
  const float far = v3_length(d) / k->reach;
  const float fade = clamp01(1.0f - far * far);
  if (fade <= 0.0f) return (canvas_sample){{0, 0, 0}, 0.0f};
  const float shadow = 1.0f - lighting_visibility(k->light, at, k->normal);
  float line = 0.0f;
  if (k->grid > 0.0f) {
    const float x = v3_dot(at, k->across), y = v3_dot(at, k->along), w = 0.022f * k->grid;
    const float fine = fmaxf(grid_line(x, k->grid, w), grid_line(y, k->grid, w));
    const float bold =
        fmaxf(grid_line(x, 5 * k->grid, 1.6f * w), grid_line(y, 5 * k->grid, 1.6f * w));
    line = fmaxf(0.20f * fine, 0.34f * bold);
  }
  const rgb dark = {0.10f, 0.12f, 0.15f};
  const float alpha = fade * fmaxf(line, 0.34f * shadow);
  return (canvas_sample){dark, fminf(alpha, 0.49f)};
}

void body_picture_draw_ground(canvas *c, const camera *cam, const lighting *light, v3 at, v3 normal,
                 float reach_mm, float grid_mm) {
  const v3 up = v3_unit(normal);
  const v3 hint = fabsf(up.x) < 0.9f ? (v3){1, 0, 0} : (v3){0, 0, 1};
  const v3 along = v3_unit(v3_cross(hint, up)), across = v3_cross(up, along);
  const ground_job k = {light, at, up, across, along, reach_mm, grid_mm};
  if (v3_dot(camera_towards(cam, at), up) <= 0.0f) return; /* from behind it would veil the cloth */
  /* In tiles: those behind the camera fall out without clipping. */
  for (int y = 0; y < GROUND_TILES; y++) {
    for (int x = 0; x < GROUND_TILES; x++) {
      canvas_vertex v[4];
      int good = 1;
      for (int n = 0; n < 4; n++) {
        const float s = (float)(x + (n == 1 || n == 2)) / GROUND_TILES * 2.0f - 1.0f;
        const float t = (float)(y + (n >= 2)) / GROUND_TILES * 2.0f - 1.0f;
        const v3 p = v3_add_scaled(v3_add_scaled(at, across, s * reach_mm), along, t * reach_mm);
        v[n].a[0] = p.x;
        v[n].a[1] = p.y;
        v[n].a[2] = p.z;
        good &= camera_project(cam, p, v + n);
      }
      if (!good) continue;
      canvas_triangle(c, v, v + 1, v + 2, 3, shade_ground, &k);
      canvas_triangle(c, v, v + 2, v + 3, 3, shade_ground, &k);
    }
  }
}
