/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/yarn_axes.h"

#include <stdlib.h>

/* Yarns of a scene without thickness still lie one over the other. */
static const float least_apart = 0.08f;

/* The crossing behind a living spring, to the right, below, to the left, above. */
static int neighbour(const picture_source *s, uint32_t i, uint32_t j, int way, uint32_t *at) {
  const uint32_t here = j * s->warps + i;
  const int back = way >= 2;
  if (back && (way == 2 ? i : j) == 0) return 0;
  const uint32_t spring = way % 2 == 0 ? picture_weft_spring(s, i - (uint32_t)back, j)
                                       : picture_warp_spring(s, i, j - (uint32_t)back);
  if (!picture_alive(s, spring)) return 0;
  const uint32_t step = way % 2 == 0 ? 1 : s->warps;
  *at = back ? here - step : here + step;
  return 1;
}

static v3 particle_at(const picture_source *s, int axis, uint32_t crossing) {
  return v3_add_scaled(s->crossings[crossing], s->half_gap[crossing], axis == AXIS_WARP ? 1.0f : -1.0f);
}

/* The mean of the normals of up to four triangles around a crossing; zero where there is none. */
static v3 normal_at(const picture_source *s, uint32_t i, uint32_t j) {
  const uint32_t here = j * s->warps + i;
  v3 way[4], sum = {0, 0, 0};
  int has[4];
  for (int k = 0; k < 4; k++) {
    const int axis = k % 2 == 0 ? AXIS_WEFT : AXIS_WARP;
    uint32_t at = 0;
    has[k] = neighbour(s, i, j, k, &at);
    way[k] = v3_sub(particle_at(s, axis, at), particle_at(s, axis, here));
  }
  for (int k = 0; k < 4; k++) {
    const int next = (k + 1) % 4;
    if (has[k] && has[next]) sum = v3_add(sum, v3_unit(v3_cross(way[next], way[k])));
  }
  return v3_length(sum) > 1e-3f ? v3_unit(sum) : (v3){0, 0, 0};
}

static int is_zero(v3 n) { return n.x == 0.0f && n.y == 0.0f && n.z == 0.0f; }

/* A thread without cloth beside it takes the normal of where it comes from. */
static void spread_normals(yarn_axes *a) {
  const picture_source *s = a->source;
  const uint32_t count = s->warps * s->wefts;
  for (int way = 0; way < 4; way++) {
    for (uint32_t n = 0; n < count; n++) {
      const uint32_t k = way < 2 ? count - 1 - n : n;
      uint32_t from = 0;
      if (is_zero(a->normal[k]) && neighbour(s, k % s->warps, k / s->warps, way, &from))
        a->normal[k] = a->normal[from];
    }
  }
  for (uint32_t k = 0; k < count; k++)
    if (is_zero(a->normal[k])) a->normal[k] = (v3){0, 0, 1};
}

int yarn_axes_open(yarn_axes *a, const picture_source *source) {
  a->source = source;
  a->apart = fmaxf(source->thickness, least_apart * source->spacing);
  a->normal = calloc((size_t)source->warps * source->wefts + 1, sizeof *a->normal);
  if (!a->normal) return 0;
  for (uint32_t j = 0; j < source->wefts; j++)
    for (uint32_t i = 0; i < source->warps; i++)
      a->normal[j * source->warps + i] = normal_at(source, i, j);
  spread_normals(a);
  return 1;
}

void yarn_axes_close(yarn_axes *a) {
  free(a->normal);
  a->normal = NULL;
}

float yarn_axes_side(const yarn_axes *a, int axis, uint32_t crossing) {
  const picture_source *s = a->source;
  const int warp_over = picture_warp_over(s, crossing % s->warps, crossing / s->warps);
  return warp_over == (axis == AXIS_WARP) ? 1.0f : -1.0f;
}

v3 yarn_axes_at(const yarn_axes *a, int axis, uint32_t crossing) {
  const picture_source *s = a->source;
  if (s->split[crossing]) return particle_at(s, axis, crossing);
  return v3_add_scaled(s->crossings[crossing], a->normal[crossing],
                       yarn_axes_side(a, axis, crossing) * 0.5f * a->apart);
}

uint32_t yarn_paths(const picture_source *source, int axis) {
  return axis == AXIS_WARP ? source->warps : source->wefts;
}

yarn_path yarn_path_of(const yarn_axes *a, int axis, uint32_t number) {
  return (yarn_path){a, axis, number, yarn_paths(a->source, 1 - axis)};
}

uint32_t yarn_path_crossing(const yarn_path *path, uint32_t point) {
  const uint32_t warps = path->axes->source->warps;
  return path->axis == AXIS_WARP ? point * warps + path->number : path->number * warps + point;
}

v3 yarn_path_at(const yarn_path *path, uint32_t point) {
  return yarn_axes_at(path->axes, path->axis, yarn_path_crossing(path, point));
}

v3 yarn_path_particle(const yarn_path *path, uint32_t point) {
  return particle_at(path->axes->source, path->axis, yarn_path_crossing(path, point));
}

uint32_t yarn_path_spring(const yarn_path *path, uint32_t point) {
  const picture_source *s = path->axes->source;
  return path->axis == AXIS_WARP ? picture_warp_spring(s, path->number, point)
                                 : picture_weft_spring(s, point, path->number);
}

int yarn_path_joined(const yarn_path *path, uint32_t point) {
  return picture_alive(path->axes->source, yarn_path_spring(path, point));
}

v3 yarn_path_tangent(const yarn_path *path, uint32_t point) {
  const v3 here = yarn_path_at(path, point);
  const int before = point > 0 && yarn_path_joined(path, point - 1);
  const int after = yarn_path_joined(path, point);
  const v3 low = before ? yarn_path_at(path, point - 1) : here;
  const v3 high = after ? yarn_path_at(path, point + 1) : here;
  return v3_scale(v3_sub(high, low), before && after ? 0.5f : 1.0f);
}
