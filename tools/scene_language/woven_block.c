/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/scene_language/angle.h"
#include "tools/scene_language/cloth_keys.h"

enum { CROSSINGS_MAX = 262144 };

int cloth_orientation_read(parser *p, const block_key *key, void *target) {
  static const char *const words[] = {"horizontal", "vertical"};
  (void)key;
  return value_read_choice(p, words, 2, &((scene *)target)->woven.vertical);
}

int cloth_self_collision_read(parser *p, const block_key *key, void *target) {
  static const char *const words[] = {"off", "on"};
  (void)key;
  return value_read_choice(p, words, 2, &((scene *)target)->woven.self_collision);
}

static int read_spacing_unit(parser *p, int *per_length, exact *factor) {
  const token *t = &p->lexer.token;
  const char *unit = value_here(p) ? units_find(UNIT_PER_LENGTH, t->text, t->bytes, factor) : NULL;
  *per_length = unit != NULL;
  if (unit == NULL && value_here(p)) unit = units_find(UNIT_LENGTH, t->text, t->bytes, factor);
  if (unit != NULL) {
    value_mark_unit(p, *per_length ? UNIT_PER_LENGTH : UNIT_LENGTH, unit, *factor);
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
  int per_length;
  (void)key;
  const int count = value_read_numbers(p, values, 2);
  if (count == 0 || !read_spacing_unit(p, &per_length, &factor)) return 0;
  for (int k = 0; k < count; k++) {
    const value_range *range = per_length ? &counts : &length;
    if (!value_scale(p, &values[k], factor, range, &results[k])) return 0;
    if (per_length) results[k] = exact_div(exact_make(1, 1), results[k]);
  }
  out->woven.warp_spacing = results[0];
  out->woven.weft_spacing = results[count - 1];
  return 1;
}

/* 5 10 %: minimum and maximum. */
static int read_strains(parser *p, const block_key *key, exact *min, exact *max) {
  exact strains[2];
  if (!value_read_exacts(p, &key->range, 2, strains)) return 0;
  *min = strains[0];
  *max = strains[1];
  return exact_compare(*min, *max) <= 0 ||
         parser_fail(p, p->key_place,
                     "found a minimum above the maximum, expected the smaller strain first for '%s'", p->key);
}

static int once(parser *p, scene_place *place, const char *what) {
  if (place->line != 0) {
    return parser_fail(p, p->key_place, "found '%s' again, expected it once; see line %d", what,
                       place->line);
  }
  *place = p->key_place;
  return 1;
}

/* tear 5 10 %, or tear off; and, in a line of its own, tear mirrored. */
static int read_tear(parser *p, const block_key *key, void *target) {
  scene *out = (scene *)target;
  if (value_here(p) && lexer_is(&p->lexer.token, "mirrored")) {
    lexer_next(&p->lexer);
    out->woven.tear_mirrored = 1;
    return once(p, &p->tear_mirrored, "tear mirrored");
  }
  if (!once(p, &p->tear_threshold, "tear")) return 0;
  if (value_here(p) && lexer_is(&p->lexer.token, "off")) {
    lexer_next(&p->lexer);
    out->woven.tearing = 0;
    return 1;
  }
  if (!value_here(p) || !value_number_here(p))
    return parser_expected(p, "2 numbers (minimum and maximum strain), off or mirrored for 'tear'");
  return read_strains(p, key, &out->woven.tear_min, &out->woven.tear_max);
}

static int read_split_strain(parser *p, const block_key *key, void *target) {
  scene *out = (scene *)target;
  return read_strains(p, key, &out->woven.split_strain_min, &out->woven.split_strain_max);
}

static int read_yarns(parser *p, const block_key *key, void *target) {
  static const char *const words[] = {"off", "on", "all"};
  (void)key;
  return value_read_choice(p, words, 3, &((scene *)target)->woven.yarns);
}

static int read_disconnect_by(parser *p, const block_key *key, void *target) {
  static const char *const words[] = {"yarns", "particles"};
  (void)key;
  return value_read_choice(p, words, 2, &((scene *)target)->woven.disconnect_by_particles);
}

static int read_spread_splits(parser *p, const block_key *key, void *target) {
  static const char *const words[] = {"off", "on"};
  (void)key;
  return value_read_choice(p, words, 2, &((scene *)target)->woven.spread_splits);
}

/* shear_lock 45 deg; 0 deg is none. */
static int read_shear_lock(parser *p, const block_key *key, void *target) {
  exact *tangent = &((scene *)target)->woven.shear_lock;
  if (!value_read_angle(p, &key->range, tangent)) return 0;
  const exact least = angle_half_tangent(exact_make(10, 1));
  return tangent->numerator == 0 || exact_compare(*tangent, least) >= 0 ||
         parser_fail(p, p->key_place, "found less than 10 deg, expected 0 deg (none) or 10 to 80 deg for '%s'",
                     p->key);
}

#define AT(field) CLOTH_FIELD(field)
static const block_key keys[] = {
    {"warps", block_count, AT(warps), {UNIT_NONE, "2", "1024"}, 1, KEY_NEEDED},
    {"wefts", block_count, AT(wefts), {UNIT_NONE, "2", "1024"}, 1, KEY_NEEDED},
    {"spacing", read_spacing, 0, {UNIT_LENGTH, "0.001", "10"}, 2, KEY_NEEDED},
    {"weave", weave_pattern_read, 0, NO_RANGE, 0, 0},
    {"density", block_exacts, AT(density), {UNIT_AREAL_DENSITY, "0.0001", "100"}, 1, 0},
    {"structural", block_exacts, AT(structural), {UNIT_STIFFNESS, "1", "1000000000"}, 1, 0},
    {"bend", block_exacts, AT(bend), {UNIT_STIFFNESS, "0", "1000000"}, 1, 0},
    {"shear", block_exacts, AT(shear), {UNIT_STIFFNESS, "0", "1000000"}, 1, 0},
    {"shear_lock", read_shear_lock, 0, {UNIT_ANGLE, "0", "80"}, 1, 0},
    {"tear", read_tear, 0, {UNIT_SHARE, "0.1", "400"}, 2, KEY_REPEATS},
    {"gather", block_exacts, AT(gather), {UNIT_SHARE, "0", "90"}, 1, 0},
    {"pleats", block_count, AT(pleats), {UNIT_NONE, "1", "256"}, 1, 0},
    {"damping", block_exacts, AT(damping), {UNIT_RATE, "0", "1000"}, 1, 0},
    {"yarns", read_yarns, 0, NO_RANGE, 0, 0},
    {"split_strain", read_split_strain, 0, {UNIT_SHARE, "0.1", "400"}, 2, 0},
    {"disconnect_at", block_exacts, AT(disconnect_at), {UNIT_LENGTH, "0.0001", "1"}, 1, 0},
    {"disconnect_by", read_disconnect_by, 0, NO_RANGE, 0, 0},
    {"spread_splits", read_spread_splits, 0, NO_RANGE, 0, 0},
    {"crossing_friction", block_exacts, AT(crossing_friction), {UNIT_FORCE, "0", "1"}, 1, 0},
    {"slip_friction", block_exacts, AT(slip_friction), {UNIT_NONE, "0", "16"}, 1, 0},
    {"static_friction", block_exacts, AT(static_friction), {UNIT_NONE, "1", "4"}, 1, 0},
    {"stretch", block_exacts, AT(stretch), {UNIT_FORCE, "0.0001", "2000"}, 1, 0},
    {"stretch_damping", block_exacts, AT(stretch_damping), {UNIT_TIME, "0", "1"}, 1, 0},
    CLOTH_KEYS};
const block_rule woven_rule = {"woven", keys, sizeof keys / sizeof keys[0]};

int woven_block_read(parser *p, const block_key *key, void *target) {
  scene *out = (scene *)target;
  const scene_place opened = p->key_place;
  block_seen seen;
  (void)key;
  out->woven.present = 1;
  block_open(p, BLOCK_CLOTH);
  if (!block_read(p, &woven_rule, "the woven cloth", opened, target, &seen)) return 0;
  out->woven.has_bend = block_has(&woven_rule, &seen, "bend");
  out->woven.has_shear = block_has(&woven_rule, &seen, "shear");
  out->woven.has_split_strain = block_has(&woven_rule, &seen, "split_strain");
  out->woven.has_self_thickness = block_has(&woven_rule, &seen, "self_thickness");
  return out->woven.warps * out->woven.wefts <= CROSSINGS_MAX ||
         parser_fail(p, opened, "found %u x %u = %u crossings, expected at most %d",
                     (unsigned)out->woven.warps, (unsigned)out->woven.wefts,
                     (unsigned)(out->woven.warps * out->woven.wefts), CROSSINGS_MAX);
}
