/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/scene_language/parser.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "rt/state/rigid_body.h"

/* Lines and columns fit int. */
enum { TEXT_BYTES_MAX = 1 << 24 };

#define AT(field) offsetof(scene, field)

static const block_key limits_keys[] = {
    {"spare_particles", block_count, AT(limits.spare_particles), {UNIT_NONE, "0", "262144"}, 1, 0},
    {"spare_triangles", block_count, AT(limits.spare_triangles), {UNIT_NONE, "0", "1000000"}, 1, 0},
    {"contacts", block_count, AT(limits.contacts), {UNIT_NONE, "0", "1048576"}, 1, 0},
    {"tears_per_tick", block_count, AT(limits.tears_per_tick), {UNIT_NONE, "1", "64"}, 1, 0},
    {"splits_per_tick", block_count, AT(limits.splits_per_tick), {UNIT_NONE, "1", "4096"}, 1, 0},
    {"self_collision_pairs", block_count, AT(limits.self_collision_pairs), {UNIT_NONE, "1", "1048576"}, 1, 0},
};
const block_rule limits_rule = {"limits", limits_keys, sizeof limits_keys / sizeof limits_keys[0]};

static const block_key hands_keys[] = {
    {"force_limit", block_exacts, AT(hands.force_limit), {UNIT_FORCE, "0", "16.3835"}, 1, 0},
    {"force_rate", block_exacts, AT(hands.force_rate), {UNIT_FORCE_RATE, "1", "16000"}, 1, 0},
    {"speed", block_exacts, AT(hands.speed), {UNIT_SPEED, "0.1", "100000"}, 1, 0},
    {"ramp_up", block_exacts, AT(hands.ramp_up), {UNIT_TIME, "0.0001", "1"}, 1, 0},
    {"ramp_down", block_exacts, AT(hands.ramp_down), {UNIT_TIME, "0.0001", "1"}, 1, 0},
    {"energy_reserve", block_exacts, AT(hands.reserve), {UNIT_ENERGY, "0", "2"}, 1, 0},
    {"delay", block_count, AT(hands.delay), {UNIT_NONE, "1", "4"}, 1, 0},
};
const block_rule hands_rule = {"hands", hands_keys, sizeof hands_keys / sizeof hands_keys[0]};

static int read_limits(parser *p, const block_key *key, void *target) {
  scene *out = (scene *)target;
  block_seen seen;
  (void)key;
  block_open(p, BLOCK_LIMITS);
  if (!block_read(p, &limits_rule, "limits", p->key_place, target, &seen)) return 0;
  out->limits.has_spare_particles = block_has(&limits_rule, &seen, "spare_particles");
  out->limits.has_spare_triangles = block_has(&limits_rule, &seen, "spare_triangles");
  out->limits.has_contacts = block_has(&limits_rule, &seen, "contacts");
  return 1;
}

static int read_hands(parser *p, const block_key *key, void *target) {
  block_seen seen;
  (void)key;
  block_open(p, BLOCK_HANDS);
  return block_read(p, &hands_rule, "hands", p->key_place, target, &seen);
}

static int read_scene_name(parser *p, const block_key *key, void *target) {
  (void)key;
  return value_read_name(p, ((scene *)target)->name);
}

static const block_key scene_keys[] = {
    {"scene", read_scene_name, 0, NO_RANGE, 0, KEY_NEEDED},
    {"rate", block_count, AT(rate_hz), {UNIT_FREQUENCY, "1", "10000"}, 1, 0},
    {"substeps", block_auto_count, AT(substeps), {UNIT_NONE, "1", "128"}, 1, 0},
    {"iterations", block_auto_count, AT(iterations), {UNIT_NONE, "1", "128"}, 1, 0},
    {"gravity", block_exacts, AT(gravity), {UNIT_ACCELERATION, "-100000", "100000"}, 3, 0},
    {"seed", block_count, AT(seed), {UNIT_NONE, "0", "4294967295"}, 1, 0},
    {"settle", block_exacts, AT(settle), {UNIT_TIME, "0", "60"}, 1, 0},
    {"max_rest_strain", block_exacts, AT(max_rest_strain), {UNIT_SHARE, "0.1", "100"}, 1, 0},
    {"wind", block_exacts, AT(wind), {UNIT_SPEED, "-10000", "10000"}, 3, 0},
    {"woven", woven_block_read, 0, NO_RANGE, 0, 0},
    {"membrane", membrane_block_read, 0, NO_RANGE, 0, 0},
    {"material", material_block_read, 0, NO_RANGE, 0, KEY_REPEATS},
    {"load", load_read, 0, {UNIT_STIFFNESS, "-1000000000", "1000000000"}, 3, KEY_REPEATS},
#define X(name, word, radius, halves, primitive, collider) \
  {word, body_block_read, 0, NO_RANGE, 0, KEY_REPEATS},
    SHAPES(X)
#undef X
        {"pin", pins_read, 0, NO_RANGE, 0, KEY_REPEATS},
    {"slit", slits_read, 0, NO_RANGE, 0, KEY_REPEATS},
    {"limits", read_limits, 0, NO_RANGE, 0, 0},
    {"hands", read_hands, 0, NO_RANGE, 0, 0},
};
const block_rule scene_rule = {"scene", scene_keys, sizeof scene_keys / sizeof scene_keys[0]};

static void set_woven_defaults(scene *out) {
  const exact zero = exact_make(0, 1);
  static const uint8_t plain[2][2] = {{1, 0}, {0, 1}};
  out->woven.weave_columns = out->woven.weave_rows = 2;
  for (int row = 0; row < 2; row++) memcpy(out->woven.weave[row], plain[row], 2);
  memcpy(out->woven.weave_name, "plain", sizeof "plain");
  out->woven.warp_spacing = out->woven.weft_spacing = zero;
  out->woven.density = exact_make(1, 4);
  out->woven.thickness = exact_make(1, 100);
  out->woven.bend = exact_make(5, 1);
  out->woven.shear = exact_make(2, 1);
  out->woven.shear_lock = zero;
  out->woven.structural = exact_make(6000, 1);
  out->woven.tear_min = exact_make(1, 20);
  out->woven.tear_max = exact_make(1, 10);
  out->woven.tearing = 1;
  for (int k = 0; k < 3; k++) out->woven.at[k] = zero;
  out->woven.vertical = 1;
  out->woven.gather = zero;
  out->woven.pleats = 8;
  out->woven.drag = exact_make(1, 2);
  out->woven.damping = zero;
  out->woven.disconnect_at = exact_make(1, 50);
  out->woven.slip_friction = out->woven.crossing_friction = zero;
  out->woven.static_friction = exact_make(1, 1);
  out->woven.stretch = zero;
  out->woven.stretch_damping = exact_make(-1, 1);
}

static void set_membrane_defaults(scene *out) {
  const exact zero = exact_make(0, 1);
  out->membrane.pattern_half_tangent = out->membrane.weft_half_tangent = zero;
  out->membrane.pattern_seed = 1;
  out->membrane.elastic_steps_max = 64;
  out->membrane.strain_limit = zero;
  out->membrane.wind_normal = exact_make(1, 1);
  out->membrane.wind_drag = exact_make(1, 10);
  for (int k = 0; k < 3; k++) out->wind[k] = zero;
}

static void set_defaults(scene *out) {
  const exact zero = exact_make(0, 1);
  memset(out, 0, sizeof *out);
  out->rate_hz = 1000;
  out->iterations = 1;
  out->gravity[0] = out->gravity[2] = zero;
  out->gravity[1] = exact_make(-981, 1);
  out->seed = 1;
  out->settle = zero;
  out->max_rest_strain = exact_make(1, 20);
  set_woven_defaults(out);
  set_membrane_defaults(out);
  out->limits.tears_per_tick = 16;
  out->limits.splits_per_tick = 32;
  out->hands.force_limit = exact_make(8, 1);
  out->hands.force_rate = exact_make(4000, 1);
  out->hands.speed = exact_make(200, 1);
  out->hands.ramp_up = exact_make(1, 10);
  out->hands.ramp_down = exact_make(1, 100);
  out->hands.reserve = exact_make(1, 100);
  out->hands.delay = 2;
}

static int check_text(parser *p, const char *text, size_t bytes) {
  scene_place place = {0, 0};
  unsigned byte = 0;
  if (bytes > TEXT_BYTES_MAX) {
    return parser_fail(p, place, "found more than %d bytes, expected a scene", TEXT_BYTES_MAX);
  }
  const scene_place first = {1, 1};
  if (bytes > 1 && (memcmp(text, "\xff\xfe", 2) == 0 || memcmp(text, "\xfe\xff", 2) == 0))
    return parser_fail(p, first, "found UTF-16, expected ASCII: save it as UTF-8 or plain text");
  if (lexer_readable(text, bytes, &place.line, &place.column, &byte)) return 1;
  if (byte == '\r')
    return parser_fail(p, place, "found a carriage return alone, expected a line feed behind it");
  return parser_fail(p, place, "found the byte 0x%02X, expected printable ASCII", byte);
}

/* Table 1 of Metaaphanon 2009: crossings split at 4.5 to 9 %, springs tear at 5 to 10 %. */
static void set_split_strain(scene *out) {
  const exact share = exact_make(9, 10);
  if (out->woven.has_split_strain) return;
  out->woven.split_strain_min = exact_mul(out->woven.tear_min, share);
  out->woven.split_strain_max = exact_mul(out->woven.tear_max, share);
}

/* One cloth in a scene. */
static int check_cloth(parser *p, const block_seen *seen) {
  const scene_place membrane = block_place(&scene_rule, seen, "membrane");
  const scene_place first = {1, 1};
  if (p->out->woven.present && membrane.line != 0)
    return parser_fail(p, membrane,
                       "found 'membrane' beside 'woven', expected one cloth in a scene; see line %d",
                       block_place(&scene_rule, seen, "woven").line);
  if (!p->out->woven.present && membrane.line == 0)
    return parser_fail(p, first, "the scene has no cloth, expected 'woven' or 'membrane': "
                                 "woven { warps 16 wefts 16 spacing 12 /cm }");
  return 1;
}

/* Keys of one cloth beside the other. */
static int check_keys_of_cloth(parser *p) {
  static const struct {
    uint32_t block;
    const char *key;
    int of_membrane;
  } rows[] = {{BLOCK_SCENE, "wind", 1}, {BLOCK_SCENE, "material", 1}, {BLOCK_SCENE, "load", 1},
              {BLOCK_LIMITS, "spare_triangles", 1}, {BLOCK_LIMITS, "splits_per_tick", 0},
              {BLOCK_SCENE, "iterations", 0}, {BLOCK_SCENE, "max_rest_strain", 0}};
  static const char *const cloths[] = {"woven", "membrane"};
  const int membrane = p->out->membrane.present;
  const source_key *substeps = source_find(&p->out->source, BLOCK_SCENE, "substeps");
  if (membrane && substeps != NULL && p->out->substeps == 0)
    return parser_fail(p, substeps->place,
                       "found 'substeps auto' with 'membrane', expected a number, or 1 without the key: the steps "
                       "that its stiffness needs are found anyhow, and substeps are for collisions, which no test run "
                       "knows before");
  for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
    const source_key *found = source_find(&p->out->source, rows[k].block, rows[k].key);
    if (found != NULL && rows[k].of_membrane != membrane)
      return parser_fail(p, found->place, "found '%s' with '%s', expected it only with '%s'", rows[k].key,
                         cloths[membrane], cloths[!membrane]);
  }
  return 1;
}

int scene_parse(const char *file, const char *text, size_t bytes, scene *out, scene_error *error) {
  parser p;
  block_seen seen;
  const scene_place whole_text = {0, 0};
  memset(&p, 0, sizeof p);
  memset(error, 0, sizeof *error);
  snprintf(error->file, sizeof error->file, "%s", file);
  p.out = out;
  p.error = error;
  p.key = "scene";
  set_defaults(out);
  if (bytes >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) { /* the mark that some editors begin UTF-8 with */
    text += 3;
    bytes -= 3;
  }
  if (!check_text(&p, text, bytes)) return 0;
  lexer_start(&p.lexer, text, bytes);
  if (!block_read(&p, &scene_rule, "the scene", whole_text, out, &seen)) return 0;
  out->source.block[BLOCK_SCENE] = block_place(&scene_rule, &seen, "scene");
  out->has_wind = block_has(&scene_rule, &seen, "wind");
  if (!check_cloth(&p, &seen) || !check_keys_of_cloth(&p) || !membrane_block_resolve(&p) ||
      !pins_resolve(&p) || !slits_check(&p))
    return 0;
  if (!out->limits.has_spare_particles && out->woven.yarns != 0)
    out->limits.spare_particles = out->woven.warps * out->woven.wefts;
  if (!out->limits.has_contacts && !out->membrane.present)
    out->limits.contacts = out->woven.warps * out->woven.wefts + out->limits.spare_particles;
  if (out->limits.self_collision_pairs == 0)
    out->limits.self_collision_pairs = 16u * out->woven.warps * out->woven.wefts;
  if (!out->woven.has_self_thickness) out->woven.self_thickness = out->woven.thickness;
  set_split_strain(out);
  effects_check(&p);
  return 1;
}
