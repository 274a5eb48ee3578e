/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/membrane_picture.h"

#include <stdlib.h>

enum { AT = 0, NORMAL = 3, LOAD = 6, VALUES = 7 };

typedef struct {
  const camera *cam;
  const lighting *light;
  const cloth_style *style;
} triangle_job;

static canvas_sample shade(const void *context, const float *a, int front) {
  const triangle_job *k = context;
  const v3 at = {a[AT], a[AT + 1], a[AT + 2]};
  const v3 towards = camera_towards(k->cam, at);
  v3 normal = v3_unit((v3){a[NORMAL], a[NORMAL + 1], a[NORMAL + 2]});
  if (v3_dot(normal, towards) < 0.0f) normal = v3_scale(normal, -1.0f);
  rgb colour = rgb_mix(k->style->warp, k->style->weft, 0.5f);
  if (k->style->strain) {
    colour = cloth_strain_colour(a[LOAD]);
  } else if (!front) {
    const rgb b = k->style->back;
    colour = (rgb){colour.r * b.r, colour.g * b.g, colour.b * b.b};
  }
  const surface_material m = {colour, 0.22f, 0.0f, 0.30f};
  return (canvas_sample){lighting_shade(k->light, &m, at, normal, normal, towards), 1.0f};
}

/* Mean of the normals around a vertex, weighted by area; mean of the loads: stress over strength, or over `full` in
 * what never tears. */
static void gather(const picture_source *s, float full, v3 *normals, float *loads, float *counts) {
  for (uint32_t t = 0; t < s->triangle_count; t++) {
    const picture_triangle *f = s->triangles + t;
    const v3 a = s->vertices[f->vertex[0]];
    const v3 n =
        v3_cross(v3_sub(s->vertices[f->vertex[1]], a), v3_sub(s->vertices[f->vertex[2]], a));
    for (int k = 0; k < 3; k++) {
      normals[f->vertex[k]] = v3_add(normals[f->vertex[k]], n);
      loads[f->vertex[k]] += f->stress / (f->strength > 0.0f ? f->strength : full);
      counts[f->vertex[k]] += 1.0f;
    }
  }
  for (uint32_t p = 0; p < s->vertex_count; p++)
    if (counts[p] > 0.0f) loads[p] /= counts[p];
}

static int project(const triangle_job *k, v3 at, v3 normal, float load, canvas_vertex *v) {
  const float values[VALUES] = {at.x, at.y, at.z, normal.x, normal.y, normal.z, load};
  for (int n = 0; n < VALUES; n++) v->a[n] = values[n];
  return camera_project(k->cam, at, v);
}

static void draw_border(canvas *c, const triangle_job *k, const picture_source *s,
                        const picture_triangle *f) {
  for (int n = 0; n < 3; n++) {
    canvas_vertex a, b;
    const v3 from = s->vertices[f->vertex[(n + 1) % 3]], to = s->vertices[f->vertex[(n + 2) % 3]];
    if (!f->border[n] || !camera_project(k->cam, from, &a) || !camera_project(k->cam, to, &b))
      continue;
    const rgb colour = rgb_hex(f->side[n] == FRAY_EDGE_TORN  ? 0xD01818
                               : f->side[n] == FRAY_EDGE_CUT ? 0x18A030
                                                             : 0x404850);
    canvas_wire(c, &a, &b, f->side[n] == FRAY_EDGE_INTACT ? 1.0f : 1.8f, colour, 0.9f);
  }
}

int membrane_picture_draw(canvas *c, const camera *cam, const lighting *light,
                          const picture_source *source, const cloth_style *style) {
  const triangle_job k = {cam, light, style};
  v3 *normals = calloc(source->vertex_count, sizeof *normals);
  float *loads = calloc(source->vertex_count, sizeof *loads);
  float *counts = calloc(source->vertex_count, sizeof *counts);
  const int good = normals && loads && counts;
  if (good) gather(source, style->stress_full, normals, loads, counts);
  for (uint32_t t = 0; good && t < source->triangle_count; t++) {
    const picture_triangle *f = source->triangles + t;
    canvas_vertex v[3];
    int seen = 1;
    for (int n = 0; n < 3; n++)
      seen = project(&k, source->vertices[f->vertex[n]], normals[f->vertex[n]], loads[f->vertex[n]],
                     v + n) &&
             seen;
    if (seen) canvas_triangle(c, v, v + 1, v + 2, VALUES, light ? shade : NULL, &k);
    if (seen && light) draw_border(c, &k, source, f);
  }
  free(normals);
  free(loads);
  free(counts);
  return good;
}
