/* SPDX-License-Identifier: Apache-2.0 */
/* Every value of a loaded triangle sheet, in time linear in the image: so that walks around
 * vertices end, weights exist, and gains do not overflow. */
#include "rt/model/image.h"

#define X(name, least, most) {least, most},
static const word_range params_ranges[SHEET_PARAM_WORDS] = {SHEET_PARAMS(X)};
static const word_range state_ranges[SHEET_STATE_WORDS] = {SHEET_STATE(X)};
static const word_range cloth_ranges[CLOTH_PARAM_WORDS] = {CLOTH_PARAMS(X)};
static const word_range toughness_ranges[TOUGHNESS_WORDS] = {TOUGHNESS(X)};
#undef X

/* Section ids, as in image_arrays. */
enum {
  IN_SHEET = 36, IN_SHEET_STATE, IN_TRIANGLE, IN_AREA, IN_MARK, IN_CLOTH, IN_U, IN_V, IN_FAN, IN_FABRICS,
  IN_CLOTHS, IN_HABITS, IN_TOUGHNESSES
};

static int bad(fray_error *error, uint32_t section, uint32_t index, const char *what) {
  (void)image_refuse(error, FRAY_BAD_FIELD, section, index, what);
  return 0;
}

static int words_in_range(const void *table, const word_range *ranges, uint32_t count,
                          uint32_t section, fray_error *error) {
  const int32_t *words = (const int32_t *)table;
  for (uint32_t n = 0; n < count; ++n)
    if (words[n] < ranges[n].least || words[n] > ranges[n].most)
      return bad(error, section, n, "a word in its range, see model/sheet.h and model/cloths.h");
  return 1;
}

static int counts_good(const fray_world *w, fray_error *error) {
  const sheet_state *s = w->sheet.state;
  if (s->triangles < w->sheet.params->triangles ||
      (uint32_t)s->triangles > w->capacity[POOL_TRIANGLES] ||
      w->particles > w->capacity[POOL_PARTICLES])
    return bad(error, IN_SHEET_STATE, 0, "triangles and vertices that exist");
  return 1;
}

static int fabrics_good(const fray_world *w, fray_error *error) {
  for (uint32_t n = 0; n < (uint32_t)w->sheet.params->cloths; ++n) {
    const fabric *f = &w->fabrics[n];
    if (f->scale < 1 || f->scale > 1 << 30)
      return bad(error, IN_FABRICS, n, "a scale of at most 1");
    for (uint32_t r = 0; r < FABRIC_ROWS; ++r) {
      const int32_t *c = f->stretch[r];
      for (uint32_t e = 0; e < FABRIC_ENTRIES; ++e)
        if (c[e] < (e == 1 ? 0 : 1) || c[e] > FABRIC_STIFF_MAX)
          return bad(error, IN_FABRICS, n, "a stiffness of 0 to 2^18 N/m, above 0 but for c12");
      if (fx_mul_wide(c[1], c[1]) > fx_mul_wide(c[0], c[2]))
        return bad(error, IN_FABRICS, n, "c12 at most the root of c11 c22");
    }
    for (uint32_t b = 0; b < FABRIC_BENDS; ++b)
      for (uint32_t k = 0; k < FABRIC_CURVES; ++k)
        if (f->bend[b][k] < 0) return bad(error, IN_FABRICS, n, "a bending stiffness of 0 or more");
  }
  return 1;
}

static int toughnesses_good(const fray_world *w, fray_error *error) {
  for (uint32_t n = 0; n < (uint32_t)w->sheet.params->cloths; ++n) {
    const toughness *t = &w->toughnesses[n];
    int32_t most = 0;
    if (!words_in_range(t, toughness_ranges, TOUGHNESS_WORDS, IN_TOUGHNESSES, error)) return 0;
    for (uint32_t k = 0; k < TOUGHNESS_DIRECTIONS; ++k) most |= t->strength[k];
    if (most != 0 && toughness_least(t) == 0)
      return bad(error, IN_TOUGHNESSES, n, "a strength in all directions, or in none");
  }
  return 1;
}

/* Corners are three vertices in use; what is across a side has it too, the other way round. */
static int triangle_good(const fray_world *w, uint32_t t) {
  const sheet_mesh *s = &w->sheet;
  const sheet_triangle *f = &s->triangle[t];
  const uint32_t triangles = (uint32_t)s->state->triangles;
  for (uint32_t k = 0; k < 3; ++k)
    if (f->v[k] >= w->particles || f->v[k] == f->v[sheet_next(k)] || f->across[k] >= triangles)
      return 0;
  for (uint32_t k = 0; k < 3; ++k) {
    if (f->across[k] == t) continue;
    const sheet_triangle *other = &s->triangle[f->across[k]];
    const uint32_t at = sheet_corner(s, f->across[k], f->v[sheet_next(k)]);
    if (at == 3 || other->v[sheet_last(at)] != f->v[sheet_last(k)] ||
        other->across[sheet_next(at)] != t)
      return 0;
  }
  return 1;
}

static int triangles_good(const fray_world *w, fray_error *error) {
  const sheet_mesh *s = &w->sheet;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t) {
    if (!triangle_good(w, t))
      return bad(error, IN_TRIANGLE, t,
                 "three vertices in use, and sides that two triangles agree on");
    const sheet_triangle *f = &s->triangle[t];
    if (!sheet_is_stout(s, sheet_at(s, f->v[0]), sheet_at(s, f->v[1]), sheet_at(s, f->v[2])))
      return bad(error, IN_TRIANGLE, t, "a triangle with area_min and height_min");
    if (s->area[t] < 1 || s->area[t] >= SHEET_AREA_MAX)
      return bad(error, IN_AREA, t, "an area of 1 to 2^27 - 1");
    const int32_t *habits = (const int32_t *)(const void *)&w->habits[t];
    for (uint32_t n = 0; n < HABIT_WORDS; ++n)
      if (habits[n] < -STRAIN_MAX || habits[n] > STRAIN_MAX)
        return bad(error, IN_HABITS, t, "strains within 4");
    if (s->mark[t] > (world_has_blades(w) ? SHEET_MARKS | SHEET_PARTED : SHEET_MARKS))
      return bad(error, IN_MARK, t, "two bits a side, and one where meshes cut");
    if (s->cloth[t] >= (uint32_t)s->params->cloths)
      return bad(error, IN_CLOTH, t, "a cloth that exists");
  }
  return 1;
}

/* Vertices in use have one fan, with all triangles that name them, and it begins where it says. */
static int fans_good(const fray_world *w, fray_error *error) {
  const sheet_mesh *s = &w->sheet;
  int32_t *named = w->qx; /* not in use between ticks */
  for (uint32_t p = 0; p < w->capacity[POOL_PARTICLES]; ++p) named[p] = 0;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t)
    for (uint32_t k = 0; k < 3; ++k) ++named[s->triangle[t].v[k]];
  for (uint32_t p = 0; p < w->particles; ++p) {
    sheet_fan fan;
    if (named[p] < 1 || named[p] > SHEET_FAN || s->fan[p] >= (uint32_t)s->state->triangles ||
        sheet_corner(s, s->fan[p], p) == 3)
      return bad(error, IN_FAN, p, "a triangle that has this vertex, and at most 16 that do");
    sheet_walk(s, p, &fan);
    if (fan.count != (uint32_t)named[p] || (fan.closed == 0 && !sheet_is_open(s, p)))
      return bad(error, IN_FAN, p, "the first triangle of the one fan that has them all");
  }
  return 1;
}

/* So that areas fit 64 bits. */
#define PLACE_MAX (32 * FX_LU)

static int places_good(const fray_world *w, fray_error *error) {
  for (uint32_t p = 0; p < w->capacity[POOL_PARTICLES]; ++p) {
    if (w->sheet.u[p] < -PLACE_MAX || w->sheet.u[p] > PLACE_MAX)
      return bad(error, IN_U, p, "a rest place within 32 lu");
    if (w->sheet.v[p] < -PLACE_MAX || w->sheet.v[p] > PLACE_MAX)
      return bad(error, IN_V, p, "a rest place within 32 lu");
  }
  return 1;
}

int sheet_valid(fray_world *w, fray_error *error) {
  const int good =
      words_in_range(w->sheet.params, params_ranges, SHEET_PARAM_WORDS, IN_SHEET, error) &&
      words_in_range(w->sheet.state, state_ranges, SHEET_STATE_WORDS, IN_SHEET_STATE, error) &&
      words_in_range(w->cloths, cloth_ranges, CLOTH_PARAM_WORDS, IN_CLOTHS, error) &&
      counts_good(w, error) && fabrics_good(w, error) && toughnesses_good(w, error) &&
      places_good(w, error) &&
      triangles_good(w, error) && fans_good(w, error);
  if (good) sheet_derive(w);
  return good;
}
