/* SPDX-License-Identifier: Apache-2.0 */
/* Validates every value of a membrane's image, in time linear in the image: so that walks around vertices
 * end, weights exist, and gains do not overflow. */
#include "rt/image/image.h"

#define X(name, min, max) {min, max},
static const word_range params_ranges[TRIMESH_PARAM_WORDS] = {TRIMESH_PARAMS(X)};
static const word_range state_ranges[TRIMESH_STATE_WORDS] = {TRIMESH_STATE(X)};
static const word_range membrane_ranges[MEMBRANE_PARAM_WORDS] = {MEMBRANE_PARAMS(X)};
#if FRAY_CRACKS
static const word_range crack_ranges[CRACK_PARAM_WORDS] = {CRACK_PARAMS(X)};
#endif
static const word_range strength_ranges[TEAR_STRENGTH_WORDS] = {TEAR_STRENGTHS(X)};
#undef X

/* Section ids, as in image_arrays. */
enum {
  IN_TRIMESH = 36, IN_TRIMESH_STATE, IN_TRIANGLE, IN_AREA, IN_EDGE_MARKS, IN_MATERIAL, IN_U, IN_V,
  IN_FIRST_TRIANGLE, IN_MATERIALS, IN_MEMBRANE_PARAMS, IN_STIFFNESS, IN_TEAR_STRENGTHS
};

static int counts_good(const fray_world *w, fray_error *error) {
  const trimesh_state *s = w->trimesh.state;
  if (s->triangles < w->trimesh.params->triangles ||
      (uint32_t)s->triangles > w->capacity[POOL_TRIANGLES] ||
      w->p.count > w->capacity[POOL_PARTICLES])
    return image_bad(error, IN_TRIMESH_STATE, 0, "triangles and vertices that exist");
  return 1;
}

/* So that the law of state/corotational.h has an energy. */
static int is_isotropic(const material_table *f) {
  const int32_t *c = f->stretch[0];
  for (uint32_t r = 0; r < MATERIAL_ROWS; ++r)
    for (uint32_t e = 0; e < MATERIAL_ENTRIES; ++e)
      if (f->stretch[r][e] != c[e]) return 0;
  const int64_t off = (int64_t)c[0] - c[1] - 2 * (int64_t)c[3]; /* no range is checked yet */
  return c[0] == c[2] && off >= -2 && off <= 2;
}

static int materials_good(const fray_world *w, fray_error *error) {
  for (uint32_t n = 0; n < (uint32_t)w->trimesh.params->materials; ++n) {
    const material_table *f = &w->membrane.materials[n];
    if (world_is_corotational(w) && !is_isotropic(f))
      return image_bad(error, IN_MATERIALS, n, "c11 = c22 = c12 + 2 c33, the same in all rows");
    if (f->scale < 1 || f->scale > 1 << 30)
      return image_bad(error, IN_MATERIALS, n, "a scale of at most 1");
    for (uint32_t r = 0; r < MATERIAL_ROWS; ++r) {
      const int32_t *c = f->stretch[r];
      for (uint32_t e = 0; e < MATERIAL_ENTRIES; ++e)
        if (c[e] < (e == 1 ? 0 : 1) || c[e] > MATERIAL_STIFF_MAX)
          return image_bad(error, IN_MATERIALS, n, "a stiffness of 0 to 2^18 N/m, above 0 but for c12");
      if (fx_mul_wide(c[1], c[1]) > fx_mul_wide(c[0], c[2]))
        return image_bad(error, IN_MATERIALS, n, "c12 at most the root of c11 c22");
    }
    for (uint32_t b = 0; b < MATERIAL_BENDS; ++b)
      for (uint32_t k = 0; k < MATERIAL_CURVES; ++k)
        if (f->bend[b][k] < 0 || f->bend[b][k] > MATERIAL_BEND_MAX)
          return image_bad(error, IN_MATERIALS, n, "a bending stiffness of 0 to 2^26");
  }
  return 1;
}

static int tear_strengths_good(const fray_world *w, fray_error *error) {
  for (uint32_t n = 0; n < (uint32_t)w->trimesh.params->materials; ++n) {
    const tear_strength *t = &w->membrane.tear_strengths[n];
    int32_t most = 0;
    if (!image_words_in_range(t, strength_ranges, TEAR_STRENGTH_WORDS, IN_TEAR_STRENGTHS, error)) return 0;
    for (uint32_t k = 0; k < TEAR_STRENGTH_DIRECTIONS; ++k) most |= t->strength[k];
    if (most != 0 && tear_strength_min(t) == 0)
      return image_bad(error, IN_TEAR_STRENGTHS, n, "a strength in all directions, or in none");
  }
  return 1;
}

/* Corners are three vertices in use; a neighbour has the same edge, the other way round. */
static int triangle_good(const fray_world *w, uint32_t t) {
  const trimesh *s = &w->trimesh;
  const trimesh_triangle *f = &s->triangle[t];
  const uint32_t triangles = (uint32_t)s->state->triangles;
  for (uint32_t k = 0; k < 3; ++k)
    if (f->v[k] >= w->p.count || f->v[k] == f->v[trimesh_next(k)] || f->neighbour[k] >= triangles)
      return 0;
  for (uint32_t k = 0; k < 3; ++k) {
    if (f->neighbour[k] == t) continue;
    const trimesh_triangle *other = &s->triangle[f->neighbour[k]];
    const uint32_t at = trimesh_corner(s, f->neighbour[k], f->v[trimesh_next(k)]);
    if (at == 3 || other->v[trimesh_previous(at)] != f->v[trimesh_previous(k)] ||
        other->neighbour[trimesh_next(at)] != t)
      return 0;
  }
  return 1;
}

/* Green's strain cannot be below -1/2, and what is a mean of it neither. */
static int stiffness_good(const stiffness_state *s) {
  for (uint32_t n = 0; n < SMOOTHED_STRAIN_POLES; ++n) {
    const material_tensor *mean = &s->mean[n];
    if (mean->uu < -STRAIN_ONE / 2 || mean->uu > STRAIN_MAX || mean->vv < -STRAIN_ONE / 2 ||
        mean->vv > STRAIN_MAX || mean->uv < -STRAIN_MAX || mean->uv > STRAIN_MAX)
      return 0;
  }
  for (uint32_t n = 0; n < MATERIAL_ENTRIES; ++n)
    if (s->c[n] < 0 || s->c[n] > MATERIAL_STIFF_MAX) return 0;
  return s->owed >= -MATERIAL_ENERGY_MAX && s->owed <= MATERIAL_ENERGY_MAX;
}

/* Offsets of a side are opposite in its two triangles, and none is on the boundary. */
static int bend_good(const fray_world *w, uint32_t t) {
  const trimesh *s = &w->trimesh;
  const bend_state *b = &w->membrane.bend_states[t];
  for (uint32_t n = 0; n < SMOOTHED_STRAIN_POLES; ++n)
    if (b->habit[n] < 0 || b->habit[n] > BEND_HABIT_MAX) return 0;
  if (b->faded < 0 || b->faded > BEND_ONE) return 0;
  if (b->owed < -BEND_ENERGY_MAX || b->owed > BEND_ENERGY_MAX) return 0;
  for (uint32_t k = 0; k < 3; ++k) {
    const uint32_t other = s->triangle[t].neighbour[k];
    if (b->offset[k] < -BEND_OFFSET_MAX || b->offset[k] > BEND_OFFSET_MAX) return 0;
    const int32_t across =
        other == t ? 0 : w->membrane.bend_states[other].offset[trimesh_neighbour_edge(s, t, k)];
    if ((int64_t)b->offset[k] + across != 0) return 0;
  }
  return 1;
}

static int triangles_good(const fray_world *w, fray_error *error) {
  const trimesh *s = &w->trimesh;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t) {
    if (!triangle_good(w, t))
      return image_bad(error, IN_TRIANGLE, t,
                 "three vertices in use, and sides that two triangles agree on");
    const trimesh_triangle *f = &s->triangle[t];
    if (!trimesh_has_quality(s, trimesh_at(s, f->v[0]), trimesh_at(s, f->v[1]), trimesh_at(s, f->v[2])))
      return image_bad(error, IN_TRIANGLE, t, "a triangle with area_min and height_min");
    if (s->area[t] < 1 || s->area[t] >= TRIMESH_AREA_MAX)
      return image_bad(error, IN_AREA, t, "an area of 1 to 2^27 - 1");
    if (!stiffness_good(&w->membrane.stiffness[t]))
      return image_bad(error, IN_STIFFNESS, t,
                       "strains of -1/2 to 4, shear within 4, stiffness of 0 to 2^18 N/m, 2^28 owed at most");
    if (!bend_good(w, t))
      return image_bad(error, IMAGE_BEND_STATES, t,
                       "offsets within 0.3, opposite across a side, habits of 0 to 8, faded 0 to 1, "
                       "2^29 owed at most");
    if (s->edge_marks[t] > (world_has_blades(w) ? TRIMESH_MARKS | TRIMESH_PASSING_BLADE : TRIMESH_MARKS))
      return image_bad(error, IN_EDGE_MARKS, t, "two bits a side, and one where meshes cut");
    if (s->material[t] >= (uint32_t)s->params->materials)
      return image_bad(error, IN_MATERIAL, t, "a cloth that exists");
  }
  return 1;
}

/* Vertices in use have one ring, with all triangles that use them, and it begins at first_triangle. */
static int rings_good(const fray_world *w, fray_error *error) {
  const trimesh *s = &w->trimesh;
  int32_t *const uses = w->p.seen; /* of a vertex, by triangles */
  for (uint32_t p = 0; p < w->capacity[POOL_PARTICLES]; ++p) uses[p] = 0;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t)
    for (uint32_t k = 0; k < 3; ++k) ++uses[s->triangle[t].v[k]];
  for (uint32_t p = 0; p < w->p.count; ++p) {
    trimesh_ring ring;
    if (uses[p] < 1 || uses[p] > TRIMESH_RING_MAX || s->first_triangle[p] >= (uint32_t)s->state->triangles ||
        trimesh_corner(s, s->first_triangle[p], p) == 3)
      return image_bad(error, IN_FIRST_TRIANGLE, p,
                       "a triangle that has this vertex, and at most 16 that do");
    trimesh_ring_of(s, p, &ring);
    if (ring.count != (uint32_t)uses[p] || (ring.closed == 0 && !trimesh_is_boundary(s, p)))
      return image_bad(error, IN_FIRST_TRIANGLE, p, "the first triangle of the one ring that has them all");
  }
  return 1;
}

#if FRAY_CRACKS
static int cracks_good(const fray_world *w, fray_error *error) {
  const crack_state *c = w->membrane.cracks;
  if (!world_has_cracks(w)) return 1;
  if (!image_words_in_range(w->membrane.crack_constants, crack_ranges, CRACK_PARAM_WORDS, IMAGE_CRACK_PARAMS,
                            error))
    return 0;
  if (c->tips < 0 || c->tips > CRACK_TIPS)
    return image_bad(error, IMAGE_CRACK_STATE, 0, "at most 32 tips");
  for (uint32_t n = 0; n < CRACK_TIPS; ++n) {
    const crack_tip *tip = &c->tip[n];
    const uint32_t most = n < (uint32_t)c->tips ? 1u << 30 : 0;
    if (fx_magnitude(tip->way_u) > most || fx_magnitude(tip->way_v) > most || tip->vertex < 0 ||
        (most != 0 ? (uint32_t)tip->vertex >= w->p.count : tip->vertex != 0))
      return image_bad(error, IMAGE_CRACK_STATE, 1u + 3u * n, "a vertex in use and a way within 1, or zeros");
  }
  return 1;
}
#endif

/* So that areas fit 64 bits, and the sum of two edges its word. */
#define REST_MAX (32 * FX_LU - 1)

static int rest_positions_good(const fray_world *w, fray_error *error) {
  for (uint32_t p = 0; p < w->capacity[POOL_PARTICLES]; ++p) {
    if (w->trimesh.u[p] < -REST_MAX || w->trimesh.u[p] > REST_MAX)
      return image_bad(error, IN_U, p, "a rest place less than 32 lu from the origin");
    if (w->trimesh.v[p] < -REST_MAX || w->trimesh.v[p] > REST_MAX)
      return image_bad(error, IN_V, p, "a rest place less than 32 lu from the origin");
  }
  return 1;
}

int trimesh_validate(fray_world *w, fray_error *error) {
  const int good =
      image_words_in_range(w->trimesh.params, params_ranges, TRIMESH_PARAM_WORDS, IN_TRIMESH, error) &&
      image_words_in_range(w->trimesh.state, state_ranges, TRIMESH_STATE_WORDS, IN_TRIMESH_STATE, error) &&
      image_words_in_range(w->membrane.constants, membrane_ranges, MEMBRANE_PARAM_WORDS, IN_MEMBRANE_PARAMS,
                     error) &&
      counts_good(w, error) && materials_good(w, error) && tear_strengths_good(w, error) &&
      rest_positions_good(w, error) &&
#if FRAY_CRACKS
      cracks_good(w, error) &&
#endif
      triangles_good(w, error) && rings_good(w, error);
  if (good) trimesh_derive(w);
  return good;
}
