/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/build/parser.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* Lines and columns stay far inside int. */
enum { TEXT_BYTES_MAX = 1 << 24 };

#define AT(field) offsetof(scene, field)

static const block_key limits_keys[] = {
    {"spare_particles", block_count, AT(limits.spare_particles), {UNIT_NONE, "0", "262144"}, 1, 0},
    {"spare_triangles", block_count, AT(limits.spare_triangles), {UNIT_NONE, "0", "1000000"}, 1, 0},
    {"contacts", block_count, AT(limits.contacts), {UNIT_NONE, "0", "1048576"}, 1, 0},
    {"cuts_per_tick", block_count, AT(limits.cuts_per_tick), {UNIT_NONE, "1", "64"}, 1, 0},
    {"splits_per_tick", block_count, AT(limits.splits_per_tick), {UNIT_NONE, "1", "4096"}, 1, 0},
    {"self_pairs", block_count, AT(limits.self_pairs), {UNIT_NONE, "1", "1048576"}, 1, 0},
};
static const block_rule limits_rule = {limits_keys, sizeof limits_keys / sizeof limits_keys[0]};

static const block_key hands_keys[] = {
    {"force_limit", block_exacts, AT(hands.force_limit), {UNIT_FORCE, "0", "16.3835"}, 1, 0},
    {"force_rate", block_exacts, AT(hands.force_rate), {UNIT_FORCE_RATE, "1", "16000"}, 1, 0},
    {"speed", block_exacts, AT(hands.speed), {UNIT_SPEED, "0.1", "100000"}, 1, 0},
    {"ramp", block_exacts, AT(hands.ramp), {UNIT_TIME, "0.0001", "1"}, 1, 0},
    {"fade", block_exacts, AT(hands.fade), {UNIT_TIME, "0.0001", "1"}, 1, 0},
};
static const block_rule hands_rule = {hands_keys, sizeof hands_keys / sizeof hands_keys[0]};

static int read_limits(parser *p, const block_key *key, void *target) {
  scene *out = (scene *)target;
  parser_place opened = p->key_place;
  block_seen seen;
  (void)key;
  if (!value_read_open(p)) return 0;
  if (!block_read(p, &limits_rule, "limits", opened, target, &seen)) return 0;
  out->limits.has_spare_particles =
      block_place(&limits_rule, &seen, "spare_particles").line != 0;
  out->limits.has_spare_triangles =
      block_place(&limits_rule, &seen, "spare_triangles").line != 0;
  out->limits.has_contacts = block_place(&limits_rule, &seen, "contacts").line != 0;
  return 1;
}

static int read_hands(parser *p, const block_key *key, void *target) {
  parser_place opened = p->key_place;
  block_seen seen;
  (void)key;
  if (!value_read_open(p)) return 0;
  return block_read(p, &hands_rule, "hands", opened, target, &seen);
}

static int read_scene_name(parser *p, const block_key *key, void *target) {
  (void)key;
  return value_read_name(p, ((scene *)target)->name);
}

static const block_key scene_keys[] = {
    {"scene", read_scene_name, 0, {UNIT_NONE, "0", "0"}, 0, KEY_NEEDED},
    {"rate", block_count, AT(rate_hz), {UNIT_FREQUENCY, "1", "10000"}, 1, 0},
    {"substeps", block_auto_count, AT(substeps), {UNIT_NONE, "1", "128"}, 1, 0},
    {"sweeps", block_auto_count, AT(sweeps), {UNIT_NONE, "1", "128"}, 1, 0},
    {"gravity", block_exacts, AT(gravity), {UNIT_ACCELERATION, "-100000", "100000"}, 3, 0},
    {"seed", block_count, AT(seed), {UNIT_NONE, "0", "4294967295"}, 1, 0},
    {"settle", block_exacts, AT(settle), {UNIT_TIME, "0", "60"}, 1, 0},
    {"rest_strain", block_exacts, AT(rest_strain), {UNIT_SHARE, "0.1", "100"}, 1, 0},
    {"wind", block_exacts, AT(wind), {UNIT_SPEED, "-10000", "10000"}, 3, 0},
    {"sheet", sheet_block_read, 0, {UNIT_NONE, "0", "0"}, 0, 0},
    {"triangles", triangles_block_read, 0, {UNIT_NONE, "0", "0"}, 0, 0},
    {"material", material_block_read, 0, {UNIT_NONE, "0", "0"}, 0, KEY_REPEATS},
    {"load", load_read, 0, {UNIT_STIFFNESS, "-1000000000", "1000000000"}, 3, KEY_REPEATS},
    {"ball", body_block_read, 0, {UNIT_NONE, "0", "0"}, 0, KEY_REPEATS},
    {"box", body_block_read, 0, {UNIT_NONE, "0", "0"}, 0, KEY_REPEATS},
    {"bar", body_block_read, 0, {UNIT_NONE, "0", "0"}, 0, KEY_REPEATS},
    {"plane", body_block_read, 0, {UNIT_NONE, "0", "0"}, 0, KEY_REPEATS},
    {"mesh", body_block_read, 0, {UNIT_NONE, "0", "0"}, 0, KEY_REPEATS},
    {"pin", pins_read, 0, {UNIT_NONE, "0", "0"}, 0, KEY_REPEATS},
    {"slit", slits_read, 0, {UNIT_NONE, "0", "0"}, 0, KEY_REPEATS},
    {"limits", read_limits, 0, {UNIT_NONE, "0", "0"}, 0, 0},
    {"hands", read_hands, 0, {UNIT_NONE, "0", "0"}, 0, 0},
};
static const block_rule scene_rule = {scene_keys, sizeof scene_keys / sizeof scene_keys[0]};

static void set_sheet_defaults(scene *out) {
  const exact zero = exact_make(0, 1);
  static const uint8_t plain[2][2] = {{1, 0}, {0, 1}};
  out->sheet.weave_columns = out->sheet.weave_rows = 2;
  for (int row = 0; row < 2; row++) memcpy(out->sheet.weave[row], plain[row], 2);
  memcpy(out->sheet.weave_name, "plain", sizeof "plain");
  out->sheet.warp_spacing = out->sheet.weft_spacing = zero;
  out->sheet.density = exact_make(1, 4);
  out->sheet.thickness = exact_make(1, 100);
  out->sheet.bend = exact_make(5, 1);
  out->sheet.shear = exact_make(2, 1);
  out->sheet.structural = exact_make(6000, 1);
  out->sheet.tear_min = exact_make(1, 20);
  out->sheet.tear_max = exact_make(1, 10);
  out->sheet.tearing = 1;
  for (int k = 0; k < 3; k++) out->sheet.at[k] = zero;
  out->sheet.vertical = 1;
  out->sheet.gather = zero;
  out->sheet.pleats = 8;
  out->sheet.drag = exact_make(1, 2);
  out->sheet.damping = zero;
  out->sheet.loose = exact_make(1, 50);
  out->sheet.slip_friction = out->sheet.slip_grip = zero;
  out->sheet.crimp = out->sheet.stretch = zero;
  out->sheet.stretch_damping = exact_make(-1, 1);
}

static void set_triangle_defaults(scene *out) {
  const exact zero = exact_make(0, 1);
  out->triangles.mesh_half_tangent = out->triangles.weft_half_tangent = zero;
  out->triangles.mesh_seed = 1;
  out->triangles.inner_steps = 64;
  out->triangles.strain_limit = zero;
  out->triangles.wind_normal = exact_make(1, 1);
  out->triangles.wind_drag = exact_make(1, 10);
  for (int k = 0; k < 3; k++) out->wind[k] = zero;
}

static void set_defaults(scene *out) {
  const exact zero = exact_make(0, 1);
  memset(out, 0, sizeof *out);
  out->rate_hz = 1000;
  out->sweeps = 1;
  out->gravity[0] = out->gravity[2] = zero;
  out->gravity[1] = exact_make(-981, 1);
  out->seed = 1;
  out->settle = zero;
  out->rest_strain = exact_make(1, 20);
  set_sheet_defaults(out);
  set_triangle_defaults(out);
  out->limits.cuts_per_tick = 16;
  out->limits.splits_per_tick = 32;
  out->hands.force_limit = exact_make(8, 1);
  out->hands.force_rate = exact_make(4000, 1);
  out->hands.speed = exact_make(200, 1);
  out->hands.ramp = exact_make(1, 10);
  out->hands.fade = exact_make(1, 100);
}

static int check_text(parser *p, const char *text, size_t bytes) {
  parser_place place = {0, 0};
  unsigned byte = 0;
  if (bytes > TEXT_BYTES_MAX) {
    return parser_fail(p, place, "found more than %d bytes, expected a scene", TEXT_BYTES_MAX);
  }
  if (lexer_readable(text, bytes, &place.line, &place.column, &byte)) return 1;
  return parser_fail(p, place, "found the byte 0x%02X, expected printable ASCII", byte);
}

/* Table 1 of the paper: 4.5 to 9 % where springs tear at 5 to 10 %. */
static void set_transition(scene *out) {
  const exact share = exact_make(9, 10);
  if (out->sheet.has_transition) return;
  out->sheet.transition_min = exact_mul(out->sheet.tear_min, share);
  out->sheet.transition_max = exact_mul(out->sheet.tear_max, share);
}

/* A woven sheet or one of triangles; what only the latter has goes with it. */
static int one_sheet(parser *p, const block_seen *seen) {
  static const char *const of_triangles[] = {"wind", "material", "load"};
  const parser_place triangles = block_place(&scene_rule, seen, "triangles");
  const parser_place first = {1, 1};
  if (p->out->sheet.present && triangles.line != 0)
    return parser_fail(p, triangles, "found 'triangles' beside a woven sheet, expected one of both; see "
                       "line %d", p->out->sheet.line);
  if (!p->out->sheet.present && triangles.line == 0)
    return parser_fail(p, first, "the scene has no 'sheet', expected one, or 'triangles'");
  for (size_t k = 0; k < 3 && triangles.line == 0; k++) {
    const parser_place place = block_place(&scene_rule, seen, of_triangles[k]);
    if (place.line != 0)
      return parser_fail(p, place, "found '%s' with a woven sheet, expected it with 'triangles'",
                         of_triangles[k]);
  }
  return 1;
}

int scene_parse(const char *file, const char *text, size_t bytes, scene *out, scene_error *error) {
  parser p;
  block_seen seen;
  const parser_place whole_text = {0, 0};
  memset(&p, 0, sizeof p);
  memset(error, 0, sizeof *error);
  snprintf(error->file, sizeof error->file, "%s", file);
  p.out = out;
  p.error = error;
  p.key = "scene";
  set_defaults(out);
  if (!check_text(&p, text, bytes)) return 0;
  lexer_start(&p.lexer, text, bytes);
  if (!block_read(&p, &scene_rule, "the scene", whole_text, out, &seen)) return 0;
  out->has_wind = block_place(&scene_rule, &seen, "wind").line != 0;
  if (!one_sheet(&p, &seen) || !triangles_resolve(&p) || !pins_resolve(&p) || !slits_check(&p)) return 0;
  if (!out->limits.has_contacts && !out->triangles.present)
    out->limits.contacts = out->sheet.warps * out->sheet.wefts;
  if (!out->limits.has_spare_particles && out->sheet.yarns != 0)
    out->limits.spare_particles = out->sheet.warps * out->sheet.wefts;
  if (out->limits.self_pairs == 0) out->limits.self_pairs = 16u * out->sheet.warps * out->sheet.wefts;
  if (!out->sheet.has_self_thickness) out->sheet.self_thickness = out->sheet.thickness;
  set_transition(out);
  return 1;
}
