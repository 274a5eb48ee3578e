/* SPDX-License-Identifier: Apache-2.0 */
/* The shape of a triangle at rest, as bending takes it: bend_plate.h. */
#include "rt/state/world.h"

/* Of the side from a to b; root_area is that of the triangle, Q24 lu. */
static void fill_side(trimesh_point a, trimesh_point b, uint32_t root_area, int32_t side[3]) {
  const int32_t u = fx_sub(b.u, a.u);
  const int32_t v = fx_sub(b.v, a.v);
  const uint64_t squared = fx_square(u) + fx_square(v);
  const fx_root root = fx_rsqrt(squared == 0 ? 1 : squared, FX_ROOT_FINE);
  const int32_t c = fx_root_unit(root, u);
  const int32_t s = fx_root_unit(root, v);
  const uint32_t ratio = fx_divide_wide((uint64_t)fx_root_length(root) << 26, root_area);
  const int32_t length = ratio > INT32_MAX ? INT32_MAX : (int32_t)ratio;
  side[0] = fx_mul_round(length, fx_mul_round(s, s, 30), 30);
  side[1] = fx_mul_round(length, fx_mul_round(c, c, 30), 30);
  side[2] = fx_mul_saturated(-length, fx_mul_round(c, s, 30), 29);
}

bend_shape bend_shape_of(const trimesh *s, uint32_t t) {
  const index_t *v = s->triangle[t].v;
  const trimesh_point at[3] = {trimesh_at(s, v[0]), trimesh_at(s, v[1]), trimesh_at(s, v[2])};
  const int64_t twice = trimesh_twice_area(at[0], at[1], at[2]);
  FRAY_ASSERT(twice > 1);
  const uint32_t root_area = fx_root_length(fx_rsqrt((uint64_t)twice >> 1, FX_ROOT_FINE));
  const uint32_t inverse = fx_divide_wide((uint64_t)1 << 40, root_area);
  bend_shape shape = {{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, 0};
  for (uint32_t k = 0; k < 3; ++k)
    fill_side(at[trimesh_next(k)], at[trimesh_previous(k)], root_area, shape.side[k]);
  shape.inverse_root = inverse > INT32_MAX ? INT32_MAX : (int32_t)inverse;
  return shape;
}
