/* SPDX-License-Identifier: Apache-2.0 */
/* What bending steps multiply by, once a tick, for bend_force.c. SIMD twin: rt/simd/bend_prepare_lanes.inl.h.
 *
 *   length   1 / |e| of sides
 *   fade     what is left of a pressed triangle
 *   least    |N|^2 at which a bending step looks at a triangle's fade again (bend_fade.c): 9/16 of what it is
 *            now, all of it where fade is below 1
 *
 * Where tears changed the mesh its folds and H are found anew (bend_folds.c, bend_stiffness.c). */
#include "rt/membrane/membrane.h"
#include "rt/simd/simd.h"

plate_view bend_plate_view(const fray_world *w) {
  FRAY_ASSERT(world_has_membrane(w));
  const plate_view view = {{w->p.x, w->p.y, w->p.z}, w->trimesh.triangle, w->trimesh.area,
                           w->membrane.bend_shapes,  w->trimesh.material, w->membrane.materials,
                           w->membrane.bend_states,  w->membrane.plates,  w->capacity[POOL_TRIANGLES]};
  return view;
}

static vec3 edge_vector(const plate_view *view, uint32_t from, uint32_t to) {
  const int32_t *const *at = view->at;
  const vec3 d = vec_sub(vec_at(at[0], at[1], at[2], to), vec_at(at[0], at[1], at[2], from));
  return vec_mul(vec_clamp_rare(d, BEND_REACH / 16), 16);
}

/* 1 / |e|: 2^(31 - h) over the root's inverse is |e| in Q28. */
static int32_t per_length_of(fx_root root) {
  const int down = (int)root.h + 31 - 28 - BEND_PER_LENGTH_BITS;
  return down < 1 ? INT32_MAX : (int32_t)(root.inverse >> down);
}

static int32_t area_min_of(uint64_t squared, int is_whole) {
  return (int32_t)(is_whole ? (squared >> (BEND_AREA_DOWN + 4)) * 9u : squared >> BEND_AREA_DOWN);
}

/* Returns whether it is pressed together. */
static int prepare_triangle(const plate_view *view, uint32_t t) {
  const index_t *v = view->triangle[t].v;
  const vec3 e2 = edge_vector(view, v[0], v[1]);
  const vec3 d2 = edge_vector(view, v[0], v[2]);
  const vec3 e[3] = {vec_sub(d2, e2), vec_negated(d2), e2};
  const uint64_t squared = vec_squared(vec_cross_q28(e2, d2));
  int32_t *const to = view->plates + t;
  uint32_t length[3];
  if (squared < BEND_FLAT) {
    for (uint32_t n = PLATE_PER_LENGTH_0; n <= PLATE_FADE; ++n) to[n * view->stride] = 0;
    return 1;
  }
  for (uint32_t k = 0; k < 3; ++k) {
    const fx_root root = fx_rsqrt(vec_squared(e[k]), FX_ROOT_FINE);
    length[k] = fx_root_length(root);
    to[(PLATE_PER_LENGTH_0 + k) * view->stride] = per_length_of(root);
  }
  const int32_t fade = bend_fade_of(view, t, squared, length);
  to[PLATE_FADE * view->stride] = fade;
  to[PLATE_AREA_MIN * view->stride] = area_min_of(squared, fade == BEND_ONE);
  return fade != BEND_ONE;
}

/* Returns whether a triangle is pressed together. */
static int find_geometry(const fray_world *w) {
  const plate_view view = bend_plate_view(w);
  const uint32_t count = triangles_in_use(w);
  uint32_t pressed = 0;
  for (uint32_t t = 0; t < count;) {
    t += simd_bend_geometry(w->kernel, &view, t, count);
    if (t < count) pressed |= (uint32_t)prepare_triangle(&view, t++);
  }
  return pressed != 0;
}

void bend_prepare(fray_world *w) {
  FRAY_ASSERT(world_has_membrane(w));
  const uint32_t count = triangles_in_use(w);
  if (w->membrane.constants->bend_every == 0) return;
  if (w->membrane.bend_current == 0) {
    (void)bend_folds_find(w);
    bend_stiffen(w, 0, count);
    bend_fade_begin(w);
  }
  w->membrane.bend_current = 1;
  if (!find_geometry(w) && w->membrane.bend_faded == 0) return;
  membrane_angles_find(w);
  bend_owed_begin(w, 0, count);
  bend_fade_follow(w);
  membrane_angles_find(w);
  bend_owed_end(w, 0, count);
}
