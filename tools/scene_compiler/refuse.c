/* SPDX-License-Identifier: Apache-2.0 */
/* Errors of the compiler: the place of the key, what was found and what was expected, in the unit of the
 * text; and numbers of a scene as words of the runtime, which are refused outside of their range. */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "tools/scene_compiler/draft.h"

void scene_refuse(scene_error *error, const char *file, scene_place place, const char *message) {
  snprintf(error->file, sizeof error->file, "%s", file);
  error->line = place.line;
  error->column = place.column;
  snprintf(error->message, sizeof error->message, "%s", message);
}

int draft_refuse(const draft *d, scene_place place, const char *format, ...) {
  char message[sizeof d->error->message];
  va_list list;
  va_start(list, format);
  vsnprintf(message, sizeof message, format, list);
  va_end(list);
  scene_refuse(d->error, d->file, place, message);
  return 0;
}

int draft_no_memory(const draft *d) {
  const scene_place nowhere = {0, 0};
  return draft_refuse(d, nowhere, "not enough memory to compile it");
}

int draft_expected(const draft *d, uint32_t block, const char *key, const char *format, ...) {
  const scene_source *s = &d->scene->source;
  char expected[sizeof d->error->message - 128];
  char found[SOURCE_SAID + 24];
  va_list list;
  va_start(list, format);
  vsnprintf(expected, sizeof expected, format, list);
  va_end(list);
  return draft_refuse(d, source_place(s, block, key), "found %s, expected %s",
                      source_found(s, block, key, found), expected);
}

const char *draft_value(const draft *d, uint32_t block, const char *key, unit_quantity quantity, exact value,
                        int way, char text[SOURCE_VALUE]) {
  return source_value(&d->scene->source, block, key, quantity, value, way, text);
}

/* value is the given number times what the rate, the mass and lu make of it: so is the bound. */
int draft_fixed_point(const draft *d, draft_number n, exact value, unsigned shift, int64_t min, int64_t max,
                      int32_t *out) {
  int64_t fixed;
  char bound[SOURCE_VALUE];
  if (exact_to_fixed(value, shift, &fixed) && fixed >= min && fixed <= max) {
    *out = (int32_t)fixed;
    return 1;
  }
  const exact one = exact_make((int64_t)1 << shift, 1);
  const exact least = exact_div(exact_make(min, 1), one);
  const int under = exact_valid(value) && exact_compare(value, least) < 0;
  const exact limit = under ? least : exact_div(exact_make(max, 1), one);
  const exact given = exact_div(limit, exact_div(value, n.given));
  if (!exact_valid(given))
    return draft_expected(d, n.block, n.key, "a %s number, or one of fewer digits",
                          under ? "larger" : "smaller");
  return draft_expected(d, n.block, n.key, "at %s %s at %u Hz with %u substep%s", under ? "least" : "most",
                        draft_value(d, n.block, n.key, n.quantity, given, under ? 1 : -1, bound),
                        d->scene->rate_hz, d->substeps, d->substeps == 1 ? "" : "s");
}

/* Half of the world's width, cm. */
static exact world_reach(const draft *d) {
  return exact_div(exact_make(FX_WORLD_MAX / FX_LU, 1), d->lu_per_cm);
}

int draft_length(const draft *d, uint32_t block, const char *key, exact centimetres, int32_t *lu) {
  int64_t fixed;
  char reach[SOURCE_VALUE];
  if (exact_to_fixed(exact_mul(centimetres, d->lu_per_cm), FX_POSITION_BITS, &fixed) &&
      fixed <= FX_WORLD_MAX && fixed >= -FX_WORLD_MAX) {
    *lu = (int32_t)fixed;
    return 1;
  }
  return draft_expected(d, block, key,
                        "at most %s: the world reaches so far from its origin for cloth as fine as this",
                        draft_value(d, block, key, UNIT_LENGTH, world_reach(d), -1, reach));
}

int draft_place(const draft *d, uint32_t block, const char *key, const exact at[3], vec3 *place) {
  return draft_length(d, block, key, at[0], &place->x) && draft_length(d, block, key, at[1], &place->y) &&
         draft_length(d, block, key, at[2], &place->z);
}

int draft_position(const draft *d, uint32_t block, const exact at[3], vec3 *place) {
  return draft_place(d, block, "at", at, place);
}

int draft_keyframe(const draft *d, uint32_t block, const scene_keyframe *key, vec3 *place) {
  int64_t lu[3];
  char found[SOURCE_VALUE];
  char reach[SOURCE_VALUE];
  for (uint32_t n = 0; n < 3; ++n)
    if (!exact_to_fixed(exact_mul(key->at[n], d->lu_per_cm), FX_POSITION_BITS, &lu[n]) ||
        lu[n] > FX_WORLD_MAX || lu[n] < -FX_WORLD_MAX)
      return draft_refuse(d, key->place,
                          "found %s in a path, expected at most %s: the world reaches so far from its origin "
                          "for "
                          "cloth as fine as this",
                          draft_value(d, block, "move", UNIT_LENGTH, key->at[n], 0, found),
                          draft_value(d, block, "move", UNIT_LENGTH, world_reach(d), -1, reach));
  *place = vec_make((int32_t)lu[0], (int32_t)lu[1], (int32_t)lu[2]);
  return 1;
}

int draft_outside(const draft *d) {
  char reach[SOURCE_VALUE];
  return draft_refuse(d, d->scene->source.block[BLOCK_CLOTH],
                      "found cloth that goes beyond %s from the origin, expected it within: the world "
                      "reaches so far "
                      "for cloth as fine as this",
                      draft_value(d, BLOCK_CLOTH, "at", UNIT_LENGTH, world_reach(d), 0, reach));
}

/* The own one of the scene, of that name. A key that it lacks comes from another. */
uint32_t draft_material(const draft *d, const char **key) {
  const scene *s = d->scene;
  uint32_t n = 0;
  while (n < s->material_count && strcmp(s->materials[n].name, s->membrane.material) != 0) ++n;
  if (n == s->material_count) {
    *key = "material";
    return BLOCK_CLOTH;
  }
  const uint32_t block = BLOCK_MATERIAL + n;
  if (source_find(&s->source, block, *key) != NULL) return block;
  const int is_stretch = strcmp(*key, "stretch") == 0;
  *key = is_stretch && source_find(&s->source, block, "isotropic") != NULL ? "isotropic"
         : is_stretch && s->materials[n].cloth.corotational                 ? "young"
         : source_find(&s->source, block, "base") != NULL ? "base" : *key;
  return block;
}
