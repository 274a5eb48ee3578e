/* SPDX-License-Identifier: Apache-2.0 */
/* Triangle sheets: what they are made of, and what pulls at their sides. */
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "tools/build/angle.h"
#include "tools/build/parser.h"

enum { CELLS_MAX = 200000 };

/* One number for both directions, or two. */
static int read_edge(parser *p, const block_key *key, void *target) {
  scene *out = (scene *)target;
  value_number values[2];
  exact factor;
  int count = 0;
  do {
    if (!value_read_number(p, &values[count], "a number")) return 0;
    count++;
  } while (count < 2 && value_here(p) && value_number_here(p));
  if (!value_read_unit(p, UNIT_LENGTH, &factor)) return 0;
  for (int k = 0; k < 2; k++)
    if (!value_scale(p, &values[k < count ? k : 0], factor, &key->range, &out->triangles.edge[k]))
      return 0;
  return 1;
}

static int read_angle(parser *p, const block_key *key, void *target) {
  exact degrees;
  if (!value_read_exacts(p, &key->range, 1, &degrees)) return 0;
  const exact half = angle_half_tangent(degrees);
  memcpy((char *)target + key->offset, &half, sizeof half);
  return exact_valid(half) ||
         parser_fail(p, p->key_place, "found an angle of too many digits for '%s', expected fewer",
                     p->key);
}

/* regular, turned 30 deg, irregular SEED */
static int read_mesh(parser *p, const block_key *key, void *target) {
  static const char *const kinds[] = {"regular", "turned", "irregular"};
  static const block_key angle = {
      "mesh", read_angle, offsetof(scene, triangles.mesh_half_tangent), {UNIT_ANGLE, "-90", "90"},
      1,      0};
  static const value_range seeds = {UNIT_NONE, "0", "4294967295"};
  scene *out = (scene *)target;
  int index;
  (void)key;
  if (!value_read_choice(p, kinds, 3, &index)) return 0;
  out->triangles.mesh = (scene_mesh)index;
  if (index == 1) return read_angle(p, &angle, target);
  return index == 0 || value_read_count(p, &seeds, &out->triangles.mesh_seed);
}

static int read_plane(parser *p, const block_key *key, void *target) {
  static const char *const planes[] = {"vertical", "horizontal"};
  int index;
  (void)key;
  if (!value_read_choice(p, planes, 2, &index)) return 0;
  ((scene *)target)->sheet.vertical = index == 0;
  return 1;
}

static int read_collide(parser *p, const block_key *key, void *target) {
  static const char *const words[] = {"vertices", "whole"};
  (void)key;
  return value_read_choice(p, words, 2, &((scene *)target)->triangles.whole);
}

static int read_material(parser *p, const block_key *key, void *target) {
  scene *out = (scene *)target;
  (void)key;
  out->triangles.material_line = p->lexer.token.line;
  out->triangles.material_column = p->lexer.token.column;
  return value_read_name(p, out->triangles.material);
}

#define OF(field) offsetof(scene, triangles.field)
#define SHARED(field) offsetof(scene, sheet.field)
static const block_key keys[] = {
    {"columns", block_count, OF(columns), {UNIT_NONE, "1", "1000"}, 1, KEY_NEEDED},
    {"rows", block_count, OF(rows), {UNIT_NONE, "1", "1000"}, 1, KEY_NEEDED},
    {"edge", read_edge, 0, {UNIT_LENGTH, "0.01", "20"}, 2, KEY_NEEDED},
    {"mesh", read_mesh, 0, {UNIT_NONE, "0", "0"}, 0, 0},
    {"material", read_material, 0, {UNIT_NONE, "0", "0"}, 0, KEY_NEEDED},
    {"weft", read_angle, OF(weft_half_tangent), {UNIT_ANGLE, "-170", "170"}, 1, 0},
    {"inner_steps", block_count, OF(inner_steps), {UNIT_NONE, "1", "1024"}, 1, 0},
    {"strain_limit", block_exacts, OF(strain_limit), {UNIT_SHARE, "0", "1000"}, 1, 0},
    {"wind_normal", block_exacts, OF(wind_normal), {UNIT_NONE, "0", "10"}, 1, 0},
    {"wind_drag", block_exacts, OF(wind_drag), {UNIT_NONE, "0", "10"}, 1, 0},
    {"at", block_exacts, SHARED(at), {UNIT_LENGTH, "-6000", "6000"}, 3, 0},
    {"plane", read_plane, 0, {UNIT_NONE, "0", "0"}, 0, 0},
    {"thickness", block_exacts, SHARED(thickness), {UNIT_LENGTH, "0.0001", "1"}, 1, 0},
    {"drag", block_exacts, SHARED(drag), {UNIT_RATE, "0", "1000"}, 1, 0},
    {"self_collision", self_collision_read, 0, {UNIT_NONE, "0", "0"}, 0, 0},
    {"self_thickness", self_thickness_read, SHARED(self_thickness), {UNIT_LENGTH, "0.0001", "1"}, 1, 0},
    {"collide", read_collide, 0, {UNIT_NONE, "0", "0"}, 0, 0},
};
static const block_rule rule = {keys, sizeof keys / sizeof keys[0]};

int triangles_block_read(parser *p, const block_key *key, void *target) {
  scene *out = (scene *)target;
  const parser_place opened = p->key_place;
  block_seen seen;
  (void)key;
  out->triangles.present = 1;
  out->triangles.whole = 1;
  out->triangles.line = out->sheet.line = opened.line;
  if (!value_read_open(p) || !block_read(p, &rule, "the triangles", opened, target, &seen))
    return 0;
  if (out->triangles.columns * out->triangles.rows > CELLS_MAX)
    return parser_fail(p, opened, "found %u x %u cells, expected at most %d",
                       (unsigned)out->triangles.columns, (unsigned)out->triangles.rows, CELLS_MAX);
  return 1;
}

int triangles_resolve(parser *p) {
  scene *out = p->out;
  const char *name = out->triangles.material;
  const parser_place place = {out->triangles.material_line, out->triangles.material_column};
  if (!out->triangles.present) return 1;
  uint32_t n = 0;
  while (n < out->material_count && strcmp(out->materials[n].name, name) != 0) n++;
  if (n < out->material_count)
    out->triangles.cloth = out->materials[n].cloth;
  else if (!fabrics_find(name, &out->triangles.cloth))
    return parser_fail(
        p, place,
        "found the material '%s', expected denim, t-shirt, pants, swimsuit, paper, or "
        "one of the scene's own",
        name);
  const char *wrong = fabrics_mend(&out->triangles.cloth);
  out->sheet.density = out->triangles.cloth.density;
  return wrong == NULL || parser_fail(p, place, "found %s in '%s'", wrong, name);
}

int load_read(parser *p, const block_key *key, void *target) {
  static const char *const sides[] = {"top", "bottom", "left", "right"};
  scene *out = (scene *)target;
  int index;
  if (out->load_count == SCENE_LOADS)
    return parser_fail(p, p->key_place, "found one load more, expected at most %d in a scene",
                       SCENE_LOADS);
  scene_load *load = &out->loads[out->load_count];
  load->line = p->key_place.line;
  if (!value_read_choice(p, sides, 4, &index) || !value_read_exacts(p, &key->range, 3, load->force))
    return 0;
  load->side = (scene_side)index;
  /* g/s2 to N/m */
  for (int k = 0; k < 3; k++) load->force[k] = exact_mul(load->force[k], exact_make(1, 1000));
  out->load_count++;
  return 1;
}
