/* SPDX-License-Identifier: Apache-2.0 */
#include <stddef.h>

#include "tools/build/parser.h"

enum { CROSSINGS_MAX = 262144 };

static int read_spacing_unit(parser *p, int *per_length, exact *factor) {
  const token *t = &p->lexer.token;
  *per_length = value_here(p) && units_find(UNIT_PER_LENGTH, t->text, t->bytes, factor);
  if (*per_length || (value_here(p) && units_find(UNIT_LENGTH, t->text, t->bytes, factor))) {
    lexer_next(&p->lexer);
    return 1;
  }
  char counts[PARSER_LIST / 2] = "", lengths[PARSER_LIST / 2] = "";
  units_list(UNIT_PER_LENGTH, counts, sizeof counts);
  units_list(UNIT_LENGTH, lengths, sizeof lengths);
  return parser_expected(p, "a unit of length or of yarns per length for 'spacing': %s, %s",
                         lengths, counts);
}

/* 12 /cm, 0.83 mm, or one value for the warps and one for the wefts. */
static int read_spacing(parser *p, const block_key *key, void *target) {
  static const value_range length = {UNIT_LENGTH, "0.001", "10"};
  static const value_range counts = {UNIT_PER_LENGTH, "0.1", "1000"};
  scene *out = (scene *)target;
  value_number values[2];
  exact factor, results[2];
  int count = 0, per_length;
  (void)key;
  do {
    if (!value_read_number(p, &values[count], "a number")) return 0;
    count++;
  } while (count < 2 && value_here(p) && value_number_here(p));
  if (!read_spacing_unit(p, &per_length, &factor)) return 0;
  for (int k = 0; k < count; k++) {
    const value_range *range = per_length ? &counts : &length;
    if (!value_scale(p, &values[k], factor, range, &results[k])) return 0;
    if (per_length) results[k] = exact_div(exact_make(1, 1), results[k]);
  }
  out->sheet.warp_spacing = results[0];
  out->sheet.weft_spacing = results[count - 1];
  return 1;
}

static int once(parser *p, parser_place *place, const char *what) {
  if (place->line != 0) {
    return parser_fail(p, p->key_place, "found '%s' again, expected it once; see line %d", what,
                       place->line);
  }
  *place = p->key_place;
  return 1;
}

/* tear 5 10 %, tear off; and beside one of these, tear mirrored. */
static int read_tear(parser *p, const block_key *key, void *target) {
  scene *out = (scene *)target;
  exact shares[2];
  if (value_here(p) && lexer_is(&p->lexer.token, "mirrored")) {
    lexer_next(&p->lexer);
    out->sheet.tear_mirrored = 1;
    return once(p, &p->tear_mirrored, "tear mirrored");
  }
  if (!once(p, &p->tear_threshold, "tear")) return 0;
  if (value_here(p) && lexer_is(&p->lexer.token, "off")) {
    lexer_next(&p->lexer);
    out->sheet.tearing = 0;
    return 1;
  }
  if (!value_here(p) || !value_number_here(p)) {
    return parser_expected(p, "2 numbers (least and most strain), off or mirrored for 'tear'");
  }
  if (!value_read_exacts(p, &key->range, 2, shares)) return 0;
  if (exact_compare(shares[0], shares[1]) > 0) {
    return parser_fail(p, p->key_place, "found a least strain above the most, expected 'tear' "
                                        "to give the smaller one first");
  }
  out->sheet.tear_min = shares[0];
  out->sheet.tear_max = shares[1];
  return 1;
}

/* yarns off, on or all. */
static int read_yarns(parser *p, const block_key *key, void *target) {
  static const char *const kinds[] = {"off", "on", "all"};
  (void)key;
  return value_read_choice(p, kinds, 3, &((scene *)target)->sheet.yarns);
}

/* self_collision off or on. */
int self_collision_read(parser *p, const block_key *key, void *target) {
  static const char *const kinds[] = {"off", "on"};
  (void)key;
  return value_read_choice(p, kinds, 2, &((scene *)target)->sheet.selves);
}

int self_thickness_read(parser *p, const block_key *key, void *target) {
  ((scene *)target)->sheet.has_self_thickness = 1;
  return block_exacts(p, key, target);
}

static int read_loose_by(parser *p, const block_key *key, void *target) {
  static const char *const kinds[] = {"yarns", "particles"};
  (void)key;
  return value_read_choice(p, kinds, 2, &((scene *)target)->sheet.loose_by_particles);
}

static int read_transition(parser *p, const block_key *key, void *target) {
  scene *out = (scene *)target;
  exact shares[2];
  if (!value_read_exacts(p, &key->range, 2, shares)) return 0;
  if (exact_compare(shares[0], shares[1]) > 0) {
    return parser_fail(p, p->key_place, "found a least strain above the most, expected 'transition' "
                                        "to give the smaller one first");
  }
  out->sheet.has_transition = 1;
  out->sheet.transition_min = shares[0];
  out->sheet.transition_max = shares[1];
  return 1;
}

static int read_crimp(parser *p, const block_key *key, void *target) {
  ((scene *)target)->sheet.has_crimp = 1;
  return block_exacts(p, key, target);
}

static int read_plane(parser *p, const block_key *key, void *target) {
  static const char *const planes[] = {"vertical", "horizontal"};
  int index;
  (void)key;
  if (!value_read_choice(p, planes, 2, &index)) return 0;
  ((scene *)target)->sheet.vertical = index == 0;
  return 1;
}

#define AT(field) offsetof(scene, sheet.field)
static const block_key keys[] = {
    {"warps", block_count, AT(warps), {UNIT_NONE, "2", "1024"}, 1, KEY_NEEDED},
    {"wefts", block_count, AT(wefts), {UNIT_NONE, "2", "1024"}, 1, KEY_NEEDED},
    {"spacing", read_spacing, 0, {UNIT_LENGTH, "0.001", "10"}, 2, KEY_NEEDED},
    {"weave", pattern_read, 0, {UNIT_NONE, "0", "0"}, 0, 0},
    {"density", block_exacts, AT(density), {UNIT_AREAL_DENSITY, "0.0001", "100"}, 1, 0},
    {"thickness", block_exacts, AT(thickness), {UNIT_LENGTH, "0.0001", "1"}, 1, 0},
    {"structural", block_exacts, AT(structural), {UNIT_STIFFNESS, "1", "1000000000"}, 1, 0},
    {"bend", block_exacts, AT(bend), {UNIT_STIFFNESS, "0", "1000000"}, 1, 0},
    {"shear", block_exacts, AT(shear), {UNIT_STIFFNESS, "0", "1000000"}, 1, 0},
    {"tear", read_tear, 0, {UNIT_SHARE, "0.1", "400"}, 2, KEY_REPEATS},
    {"at", block_exacts, AT(at), {UNIT_LENGTH, "-6000", "6000"}, 3, 0},
    {"plane", read_plane, 0, {UNIT_NONE, "0", "0"}, 0, 0},
    {"gather", block_exacts, AT(gather), {UNIT_SHARE, "0", "90"}, 1, 0},
    {"pleats", block_count, AT(pleats), {UNIT_NONE, "1", "256"}, 1, 0},
    {"drag", block_exacts, AT(drag), {UNIT_RATE, "0", "1000"}, 1, 0},
    {"damping", block_exacts, AT(damping), {UNIT_RATE, "0", "1000"}, 1, 0},
    {"yarns", read_yarns, 0, {UNIT_NONE, "0", "0"}, 0, 0},
    {"transition", read_transition, 0, {UNIT_SHARE, "0.1", "400"}, 2, 0},
    {"loose", block_exacts, AT(loose), {UNIT_LENGTH, "0.0001", "1"}, 1, 0},
    {"crimp", read_crimp, AT(crimp), {UNIT_SHARE, "0", "100"}, 1, 0},
    {"stretch", block_exacts, AT(stretch), {UNIT_FORCE, "0.0001", "2000"}, 1, 0},
    {"stretch_damping", block_exacts, AT(stretch_damping), {UNIT_TIME, "0", "1"}, 1, 0},
    {"loose_by", read_loose_by, 0, {UNIT_NONE, "0", "0"}, 0, 0},
    {"slip_grip", block_exacts, AT(slip_grip), {UNIT_FORCE, "0", "1"}, 1, 0},
    {"self_collision", self_collision_read, 0, {UNIT_NONE, "0", "0"}, 0, 0},
    {"self_thickness", self_thickness_read, AT(self_thickness), {UNIT_LENGTH, "0.0001", "1"}, 1, 0},
    {"slip_friction", block_exacts, AT(slip_friction), {UNIT_NONE, "0", "16"}, 1, 0},
};

static const block_rule rule = {keys, sizeof keys / sizeof keys[0]};

int sheet_block_read(parser *p, const block_key *key, void *target) {
  scene *out = (scene *)target;
  parser_place opened = p->key_place;
  block_seen seen;
  (void)key;
  out->sheet.present = 1;
  out->sheet.line = opened.line;
  if (!value_read_open(p)) return 0;
  if (!block_read(p, &rule, "the sheet", opened, target, &seen)) return 0;
  if (out->sheet.warps * out->sheet.wefts > CROSSINGS_MAX) {
    return parser_fail(p, opened, "found a sheet of %u x %u = %u crossings, expected at most %d",
                       (unsigned)out->sheet.warps, (unsigned)out->sheet.wefts,
                       (unsigned)(out->sheet.warps * out->sheet.wefts), CROSSINGS_MAX);
  }
  return 1;
}
