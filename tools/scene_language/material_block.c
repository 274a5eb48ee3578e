/* SPDX-License-Identifier: Apache-2.0 */
/* A material of the scene: a measured one as `base` with some values replaced, isotropic, or a table by
 * direction. */
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "tools/scene_language/parser.h"

/* The key that is read takes away all that an earlier one gave. */
static int replaces(parser *p, const source_key *earlier) {
  return parser_fail(p, p->key_place,
                     "found '%s' behind '%s' of line %d, which has no effect then, expected '%s' first",
                     p->key, earlier->said, earlier->place.line, p->key);
}

/* Refuses rows that were given before. given: bits of rows, `all` of them. */
static int gives_rows(parser *p, uint32_t *given, int row, int all) {
  const source_key *isotropic = source_find(&p->out->source, p->block, "isotropic");
  if (row == all && *given != 0) return replaces(p, source_find(&p->out->source, p->block, p->key));
  if (row == all && isotropic != NULL && strcmp(p->key, "stretch") == 0) return replaces(p, isotropic);
  if ((*given >> row & 1u) != 0)
    return parser_fail(p, p->key_place, "found this row of '%s' again, expected it once", p->key);
  *given |= 1u << row;
  return 1;
}

static int read_base(parser *p, const block_key *key, void *target) {
  static const char *const names[] = {"denim", "t-shirt", "pants", "swimsuit", "paper"};
  const scene_source *s = &p->out->source;
  int index;
  (void)key;
  for (uint32_t n = 0; n < s->count; n++)
    if (s->keys[n].block == p->block && &s->keys[n] != p->mark) return replaces(p, &s->keys[n]);
  return value_read_choice(p, names, 5, &index) &&
         material_table_find(names[index], &((scene_material *)target)->cloth);
}

static void to_newtons(exact *values, int count) {
  for (int k = 0; k < count; k++) values[k] = exact_mul(values[k], exact_make(1, 1000));
}

/* isotropic 1000 N/m 0.3: Young's modulus, Poisson's ratio */
static int read_isotropic(parser *p, const block_key *key, void *target) {
  static const value_range ratio = {UNIT_NONE, "0", "0.499"};
  exact e, nu;
  const source_key *earlier = source_find(&p->out->source, p->block, "stretch");
  if (earlier != NULL) return replaces(p, earlier);
  if (!value_read_exacts(p, &key->range, 1, &e) || !value_read_exacts(p, &ratio, 1, &nu)) return 0;
  to_newtons(&e, 1);
  material_table_isotropic(e, nu, &((scene_material *)target)->cloth);
  return 1;
}

/* stretch all 2200 100 800 20 N/m: c11 c12 c22 c33; or of one row, at rest or a direction */
static int read_stretch(parser *p, const block_key *key, void *target) {
  static const char *const rows[] = {"rest", "0", "22.5", "45", "67.5", "90", "all"};
  scene_material *m = target;
  material_spec *cloth = &m->cloth;
  exact row[VALUES_MAX];
  int index;
  if (!value_read_choice(p, rows, 7, &index) || !gives_rows(p, &m->stretch_rows, index, MATERIAL_ROWS) ||
      !value_read_exacts(p, &key->range, MATERIAL_ENTRIES, row))
    return 0;
  to_newtons(row, MATERIAL_ENTRIES);
  if (index == MATERIAL_ROWS)
    material_table_uniform(row, cloth);
  else
    memcpy(cloth->stretch[index], row, sizeof cloth->stretch[index]);
  return 1;
}

/* bend all 60 uNm; or of one direction at curvatures of 0, 5, 10, 15 and 20 / m */
static int read_bend(parser *p, const block_key *key, void *target) {
  static const char *const directions[] = {"0", "45", "90", "all"};
  scene_material *m = target;
  material_spec *cloth = &m->cloth;
  exact values[VALUES_MAX];
  int index;
  if (!value_read_choice(p, directions, 4, &index) ||
      !gives_rows(p, &m->bend_rows, index, MATERIAL_BENDS) ||
      !value_read_exacts(p, &key->range, index == MATERIAL_BENDS ? 1 : MATERIAL_CURVES, values))
    return 0;
  if (index == MATERIAL_BENDS)
    material_table_bend(values[0], cloth);
  else
    memcpy(cloth->bend[index], values, sizeof cloth->bend[index]);
  return 1;
}

/* tear 12 N/m in all directions, or at 0, 45, 90, 135 degrees against the warp. */
static int read_tear(parser *p, const block_key *key, void *target) {
  material_spec *cloth = &((scene_material *)target)->cloth;
  value_number values[TEAR_STRENGTH_DIRECTIONS];
  exact factor;
  const int count = value_read_numbers(p, values, TEAR_STRENGTH_DIRECTIONS);
  if (count == 0) return 0;
  if (count != 1 && count != TEAR_STRENGTH_DIRECTIONS)
    return parser_expected(p, "1 number or 4 for 'tear'");
  if (!value_read_unit(p, UNIT_STIFFNESS, &factor)) return 0;
  for (uint32_t k = 0; k < TEAR_STRENGTH_DIRECTIONS; ++k)
    if (!value_scale(p, &values[count == 1 ? 0 : k], factor, &key->range, &cloth->strength[k])) return 0;
  to_newtons(cloth->strength, TEAR_STRENGTH_DIRECTIONS);
  return 1;
}

/* cut_speed 0.5 m/s: the slowest blade that cuts */
static int read_cut_speed(parser *p, const block_key *key, void *target) {
  material_spec *cloth = &((scene_material *)target)->cloth;
  cloth->has_cut_speed = 1;
  return value_read_exacts(p, &key->range, 1, &cloth->cut_speed);
}

/* young 3 GPa, poisson 0.3, thickness 0.1 mm: an isotropic sheet, without `isotropic` or `stretch`. */
static int is_of_sheet(const char *key) {
  static const char *const all[] = {"young", "poisson", "thickness", "breaks", "average", "cracks"};
  for (uint32_t n = 0; n < sizeof all / sizeof all[0]; n++)
    if (strcmp(key, all[n]) == 0) return 1;
  return 0;
}

static int read_cracks(parser *p, const block_key *key, void *target) {
  static const char *const words[] = {"one", "many"};
  (void)key;
  return value_read_choice(p, words, 2, &((scene_material *)target)->cloth.many_cracks);
}

static int resolve_sheet(parser *p, scene_material *m) {
  static const char *const others[] = {"base", "isotropic", "stretch", "tear"};
  const scene_source *s = &p->out->source;
  const source_key *young = source_find(s, p->block, "young");
  if (young == NULL) {
    for (uint32_t n = 0; n < s->count; n++)
      if (s->keys[n].block == p->block && is_of_sheet(s->keys[n].key))
        return parser_fail(p, s->keys[n].place, "found '%s' without 'young', expected both", s->keys[n].key);
    return 1;
  }
  for (uint32_t n = 0; n < sizeof others / sizeof others[0]; n++) {
    const source_key *other = source_find(s, p->block, others[n]);
    if (other != NULL && (strcmp(others[n], "tear") != 0 || m->cloth.breaks.numerator != 0))
      return parser_fail(p, young->place, "found 'young' beside '%s' of line %d, expected one of them", others[n],
                         other->place.line);
  }
  m->cloth.corotational = 1;
  material_table_isotropic(exact_mul(m->cloth.young, exact_mul(m->cloth.thickness, exact_make(1, 100))),
                           m->cloth.poisson, &m->cloth);
  return 1;
}

static const block_key keys[] = {
    {"tear", read_tear, 0, {UNIT_STIFFNESS, "1", "8000000"}, 4, 0},
    {"cut_speed", read_cut_speed, 0, {UNIT_SPEED, "0", "100000"}, 1, 0},
    {"tear_interval",
     block_exacts,
     offsetof(scene_material, cloth.tear_interval),
     {UNIT_TIME, "0", "60"},
     1,
     0},
    {"base", read_base, 0, NO_RANGE, 0, 0},
    {"density",
     block_exacts,
     offsetof(scene_material, cloth.density),
     {UNIT_AREAL_DENSITY, "0.0001", "100"},
     1,
     0},
    {"isotropic", read_isotropic, 0, {UNIT_STIFFNESS, "1", "1000000000000"}, 1, 0},
    {"stretch", read_stretch, 0, {UNIT_STIFFNESS, "-1000000000000", "1000000000000"}, 4, KEY_REPEATS},
    {"young", block_exacts, offsetof(scene_material, cloth.young), {UNIT_PRESSURE, "1", "1000000000000"}, 1, 0},
    {"poisson", block_exacts, offsetof(scene_material, cloth.poisson), {UNIT_NONE, "0", "0.499"}, 1, 0},
    {"thickness", block_exacts, offsetof(scene_material, cloth.thickness), {UNIT_LENGTH, "0.0001", "1"}, 1, 0},
    {"breaks", block_exacts, offsetof(scene_material, cloth.breaks), {UNIT_PRESSURE, "1", "1000000000000"}, 1, 0},
    {"average", block_exacts, offsetof(scene_material, cloth.average), {UNIT_LENGTH, "0.001", "100"}, 1, 0},
    {"cracks", read_cracks, 0, NO_RANGE, 0, 0},
    {"bend", read_bend, 0, {UNIT_BENDING, "0", "0.0019"}, 5, KEY_REPEATS},
};
const block_rule material_rule = {"material", keys, sizeof keys / sizeof keys[0]};

int material_block_read(parser *p, const block_key *key, void *target) {
  scene *out = (scene *)target;
  const scene_place opened = p->key_place;
  const exact zero = exact_make(0, 1);
  block_seen seen;
  char title[SCENE_NAME + 16];
  (void)key;
  if (!parser_has_room(p, opened, out->material_count, SCENE_MATERIALS, "material")) return 0;
  scene_material *m = &out->materials[out->material_count];
  m->cloth.density = zero;
  for (uint32_t r = 0; r < MATERIAL_ROWS; r++)
    for (uint32_t n = 0; n < MATERIAL_ENTRIES; n++) m->cloth.stretch[r][n] = zero;
  material_table_bend(zero, &m->cloth);
  material_table_never_tear(&m->cloth);
  m->stretch_rows = m->bend_rows = 0;
  m->cloth.young = zero;
  m->cloth.many_cracks = 0;
  m->cloth.poisson = exact_make(3, 10);
  m->cloth.thickness = exact_make(1, 100);
  const scene_place name = parser_here(p);
  if (!value_read_name(p, m->name)) return 0;
  for (uint32_t n = 0; n < out->material_count; n++)
    if (strcmp(out->materials[n].name, m->name) == 0)
      return parser_fail(p, name, "found a second material '%s', expected another name; see line %d", m->name,
                         out->source.block[BLOCK_MATERIAL + n].line);
  snprintf(title, sizeof title, "material '%s'", m->name);
  block_open(p, BLOCK_MATERIAL + out->material_count);
  if (!block_read(p, &material_rule, title, opened, m, &seen) || !resolve_sheet(p, m)) return 0;
  if (m->cloth.density.numerator == 0)
    return parser_fail(p, opened, "%s has no 'density', expected one", title);
  out->material_count++;
  return 1;
}
