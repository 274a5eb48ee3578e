/* SPDX-License-Identifier: Apache-2.0 */
/* Membranes (cloth of triangles), and the loads along their edges. */
#include <stdio.h>
#include <string.h>

#include "tools/scene_language/cloth_keys.h"
#include "tools/scene_language/nearest.h"

enum { CELLS_MAX = 200000 };

/* One number for both directions, or two. */
static int read_cell(parser *p, const block_key *key, void *target) {
  scene *out = (scene *)target;
  value_number values[2];
  exact factor;
  const int count = value_read_numbers(p, values, 2);
  if (count == 0 || !value_read_unit(p, UNIT_LENGTH, &factor)) return 0;
  for (int k = 0; k < 2; k++)
    if (!value_scale(p, &values[k < count ? k : 0], factor, &key->range, &out->membrane.cell[k]))
      return 0;
  return 1;
}

static int read_weft(parser *p, const block_key *key, void *target) {
  return value_read_angle(p, &key->range, &((scene *)target)->membrane.weft_half_tangent);
}

/* regular, rotated 30 deg, irregular SEED */
static int read_pattern(parser *p, const block_key *key, void *target) {
  static const char *const words[] = {"regular", "rotated", "irregular"};
  static const value_range angles = {UNIT_ANGLE, "-90", "90"};
  static const value_range seeds = {UNIT_NONE, "0", "4294967295"};
  scene *out = (scene *)target;
  int index;
  (void)key;
  if (!value_read_choice(p, words, 3, &index)) return 0;
  out->membrane.pattern = (scene_pattern)index;
  if (index == 1) return value_read_angle(p, &angles, &out->membrane.pattern_half_tangent);
  return index == 0 || value_read_count(p, &seeds, &out->membrane.pattern_seed);
}

static int read_collision(parser *p, const block_key *key, void *target) {
  static const char *const words[] = {"vertices", "triangles"};
  (void)key;
  return value_read_choice(p, words, 2, &((scene *)target)->membrane.collide_triangles);
}

static int read_material(parser *p, const block_key *key, void *target) {
  scene *out = (scene *)target;
  (void)key;
  out->membrane.material_place = parser_here(p);
  return value_read_name(p, out->membrane.material);
}

#define OF(field) offsetof(scene, membrane.field)
static const block_key keys[] = {
    {"columns", block_count, OF(columns), {UNIT_NONE, "1", "1000"}, 1, KEY_NEEDED},
    {"rows", block_count, OF(rows), {UNIT_NONE, "1", "1000"}, 1, KEY_NEEDED},
    {"cell", read_cell, 0, {UNIT_LENGTH, "0.01", "20"}, 2, KEY_NEEDED},
    {"pattern", read_pattern, 0, NO_RANGE, 0, 0},
    {"material", read_material, 0, NO_RANGE, 0, KEY_NEEDED},
    {"weft", read_weft, 0, {UNIT_ANGLE, "-170", "170"}, 1, 0},
    {"elastic_steps_max", block_count, OF(elastic_steps_max), {UNIT_NONE, "1", "1024"}, 1, 0},
    {"strain_limit", block_exacts, OF(strain_limit), {UNIT_SHARE, "0", "1000"}, 1, 0},
    {"wind_normal", block_exacts, OF(wind_normal), {UNIT_NONE, "0", "10"}, 1, 0},
    {"wind_drag", block_exacts, OF(wind_drag), {UNIT_NONE, "0", "10"}, 1, 0},
    {"collision", read_collision, 0, NO_RANGE, 0, 0},
    CLOTH_KEYS};
const block_rule membrane_rule = {"membrane", keys, sizeof keys / sizeof keys[0]};

int membrane_block_read(parser *p, const block_key *key, void *target) {
  scene *out = (scene *)target;
  const scene_place opened = p->key_place;
  block_seen seen;
  (void)key;
  out->membrane.present = 1;
  out->membrane.collide_triangles = 1;
  block_open(p, BLOCK_CLOTH);
  if (!block_read(p, &membrane_rule, "the membrane", opened, target, &seen)) return 0;
  out->woven.has_self_thickness = block_has(&membrane_rule, &seen, "self_thickness");
  return out->membrane.columns * out->membrane.rows <= CELLS_MAX ||
         parser_fail(p, opened, "found %u x %u cells, expected at most %d", (unsigned)out->membrane.columns,
                     (unsigned)out->membrane.rows, CELLS_MAX);
}

static int unknown_material(parser *p, scene_place place, const char *name) {
  static const char *const known[] = {"denim", "t-shirt", "pants", "swimsuit", "paper"};
  enum { KNOWN = sizeof known / sizeof known[0] };
  char meant[SCENE_NAME + 24] = "";
  for (uint32_t n = 0; n < KNOWN + p->out->material_count; n++) {
    const char *word = n < KNOWN ? known[n] : p->out->materials[n - KNOWN].name;
    if (nearest_is_near(nearest_edits(name, strlen(name), word), strlen(name)))
      snprintf(meant, sizeof meant, " (did you mean '%s'?)", word);
  }
  return parser_fail(p, place,
                     "found the material '%s'%s, expected denim, t-shirt, pants, swimsuit, paper, or one of "
                     "the scene's own",
                     name, meant);
}

int membrane_block_resolve(parser *p) {
  scene *out = p->out;
  const char *name = out->membrane.material;
  const scene_place place = out->membrane.material_place;
  if (!out->membrane.present) return 1;
  uint32_t n = 0;
  while (n < out->material_count && strcmp(out->materials[n].name, name) != 0) n++;
  if (n < out->material_count)
    out->membrane.cloth = out->materials[n].cloth;
  else if (!material_table_find(name, &out->membrane.cloth))
    return unknown_material(p, place, name);
  const char *wrong = material_table_sanitize(&out->membrane.cloth);
  out->woven.density = out->membrane.cloth.density;
  return wrong == NULL || parser_fail(p, place, "found %s in '%s'", wrong, name);
}

int load_read(parser *p, const block_key *key, void *target) {
  static const char *const edges[] = {"top", "bottom", "left", "right"};
  scene *out = (scene *)target;
  int index;
  if (!parser_has_room(p, p->key_place, out->load_count, SCENE_LOADS, "load")) return 0;
  scene_load *load = &out->loads[out->load_count];
  if (!value_read_choice(p, edges, 4, &index) || !value_read_exacts(p, &key->range, 3, load->force))
    return 0;
  load->edge = (scene_edge)index;
  /* g/s2 to N/m */
  for (int k = 0; k < 3; k++) load->force[k] = exact_mul(load->force[k], exact_make(1, 1000));
  out->load_count++;
  return 1;
}
