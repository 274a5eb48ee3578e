/* SPDX-License-Identifier: Apache-2.0 */
/* A cloth of the scene's own: `like` one that was measured, and what is different; or isotropic; or a
 * table by direction. */
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "tools/build/parser.h"

static int read_like(parser *p, const block_key *key, void *target) {
  const parser_place place = parser_here(p);
  char name[SCENE_NAME];
  (void)key;
  if (!value_read_name(p, name)) return 0;
  return fabrics_find(name, &((scene_material *)target)->cloth) ||
         parser_fail(p, place, "found '%s', expected denim, t-shirt, pants, swimsuit or paper for 'like'", name);
}

static void to_newtons(exact *values, int count) {
  for (int k = 0; k < count; k++) values[k] = exact_mul(values[k], exact_make(1, 1000));
}

/* isotropic 1000 N/m 0.3: Young's modulus, Poisson's ratio */
static int read_isotropic(parser *p, const block_key *key, void *target) {
  static const value_range ratio = {UNIT_NONE, "0", "0.499"};
  exact e, nu;
  if (!value_read_exacts(p, &key->range, 1, &e) || !value_read_exacts(p, &ratio, 1, &nu)) return 0;
  to_newtons(&e, 1);
  fabrics_isotropic(e, nu, &((scene_material *)target)->cloth);
  return 1;
}

/* stretch all 2200 100 800 20 N/m: c11 c12 c22 c33; or of one row, at rest or a direction */
static int read_stretch(parser *p, const block_key *key, void *target) {
  static const char *const rows[] = {"rest", "0", "22.5", "45", "67.5", "90", "all"};
  fabric_draft *cloth = &((scene_material *)target)->cloth;
  exact row[VALUES_MAX];
  int index;
  if (!value_read_choice(p, rows, 7, &index) || !value_read_exacts(p, &key->range, FABRIC_ENTRIES, row)) return 0;
  to_newtons(row, FABRIC_ENTRIES);
  if (index == FABRIC_ROWS)
    fabrics_same(row, cloth);
  else
    memcpy(cloth->stretch[index], row, sizeof cloth->stretch[index]);
  return 1;
}

/* bend all 60 uNm; or of one direction at curvatures of 0, 5, 10, 15 and 20 / m */
static int read_bend(parser *p, const block_key *key, void *target) {
  static const char *const directions[] = {"0", "45", "90", "all"};
  fabric_draft *cloth = &((scene_material *)target)->cloth;
  exact values[VALUES_MAX];
  int index;
  if (!value_read_choice(p, directions, 4, &index) ||
      !value_read_exacts(p, &key->range, index == FABRIC_BENDS ? 1 : FABRIC_CURVES, values))
    return 0;
  if (index == FABRIC_BENDS)
    fabrics_bend(values[0], cloth);
  else
    memcpy(cloth->bend[index], values, sizeof cloth->bend[index]);
  return 1;
}

/* tear 12 N/m in all directions, or at 0, 45, 90, 135 degrees against the warp. */
static int read_tear(parser *p, const block_key *key, void *target) {
  fabric_draft *cloth = &((scene_material *)target)->cloth;
  value_number values[TOUGHNESS_DIRECTIONS];
  exact factor;
  uint32_t count = 0;
  do {
    if (!value_read_number(p, &values[count], "a number")) return 0;
    count++;
  } while (count < TOUGHNESS_DIRECTIONS && value_here(p) && value_number_here(p));
  if (count != 1 && count != TOUGHNESS_DIRECTIONS)
    return parser_expected(p, "1 number or 4 for 'tear'");
  if (!value_read_unit(p, UNIT_STIFFNESS, &factor)) return 0;
  for (uint32_t k = 0; k < TOUGHNESS_DIRECTIONS; ++k)
    if (!value_scale(p, &values[count == 1 ? 0 : k], factor, &key->range, &cloth->strength[k])) return 0;
  to_newtons(cloth->strength, TOUGHNESS_DIRECTIONS);
  return 1;
}

/* cut 0.5 m/s: blades that come as fast, or faster */
static int read_cut(parser *p, const block_key *key, void *target) {
  fabric_draft *cloth = &((scene_material *)target)->cloth;
  cloth->is_cut = 1;
  return value_read_exacts(p, &key->range, 1, &cloth->cut);
}

static const block_key keys[] = {
    {"tear", read_tear, 0, {UNIT_STIFFNESS, "1", "8000000"}, 4, 0},
    {"cut", read_cut, 0, {UNIT_SPEED, "0", "100000"}, 1, 0},
    {"relax", block_exacts, offsetof(scene_material, cloth.relax), {UNIT_TIME, "0", "60"}, 1, 0},
    {"like", read_like, 0, {UNIT_NONE, "0", "0"}, 0, 0},
    {"density", block_exacts, offsetof(scene_material, cloth.density),
     {UNIT_AREAL_DENSITY, "0.0001", "100"}, 1, 0},
    {"isotropic", read_isotropic, 0, {UNIT_STIFFNESS, "1", "1000000000000"}, 1, 0},
    {"stretch", read_stretch, 0, {UNIT_STIFFNESS, "-1000000000000", "1000000000000"}, 4, KEY_REPEATS},
    {"bend", read_bend, 0, {UNIT_BENDING, "0", "0.0019"}, 5, KEY_REPEATS},
};
static const block_rule rule = {keys, sizeof keys / sizeof keys[0]};

int material_block_read(parser *p, const block_key *key, void *target) {
  scene *out = (scene *)target;
  const parser_place opened = p->key_place;
  const exact zero = exact_make(0, 1);
  block_seen seen;
  char title[SCENE_NAME + 16];
  (void)key;
  if (out->material_count == SCENE_MATERIALS)
    return parser_fail(p, opened, "found one material more, expected at most %d in a scene", SCENE_MATERIALS);
  scene_material *m = &out->materials[out->material_count];
  m->line = opened.line;
  m->cloth.density = zero;
  for (uint32_t r = 0; r < FABRIC_ROWS; r++)
    for (uint32_t n = 0; n < FABRIC_ENTRIES; n++) m->cloth.stretch[r][n] = zero;
  fabrics_bend(zero, &m->cloth);
  fabrics_never_tear(&m->cloth);
  if (!value_read_name(p, m->name)) return 0;
  snprintf(title, sizeof title, "material '%s'", m->name);
  if (!value_read_open(p) || !block_read(p, &rule, title, opened, m, &seen)) return 0;
  if (m->cloth.density.numerator == 0)
    return parser_fail(p, opened, "%s has no 'density', expected one", title);
  out->material_count++;
  return 1;
}
