/* SPDX-License-Identifier: Apache-2.0 */
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "tools/build/angle.h"
#include "tools/build/parser.h"

static int read_grip(parser *p, const block_key *key, void *target) {
  ((scene_body *)target)->has_grip = 1;
  return block_exacts(p, key, target);
}

/* turn 45 deg about z */
static int read_turn(parser *p, const block_key *key, void *target) {
  static const char *const about[] = {"about"};
  static const char *const axes[] = {"x", "y", "z"};
  scene_body *body = (scene_body *)target;
  exact degrees;
  int index;
  if (!value_read_exacts(p, &key->range, 1, &degrees)) return 0;
  if (!value_read_choice(p, about, 1, &index)) return 0;
  if (!value_read_choice(p, axes, 3, &index)) return 0;
  body->turn.axis = index;
  body->turn.half_tangent = angle_half_tangent(degrees);
  if (!exact_valid(body->turn.half_tangent)) {
    return parser_fail(p, p->key_place, "found an angle of too many digits for 'turn', expected "
                                        "fewer");
  }
  return 1;
}

static int read_obj(parser *p, const block_key *key, void *target) {
  (void)key;
  return value_read_path(p, ((scene_body *)target)->obj);
}

/* sharp off, sharp named, sharp 60 deg */
static int read_sharp(parser *p, const block_key *key, void *target) {
  static const char *const words[] = {"off", "named"};
  scene_body *body = (scene_body *)target;
  exact degrees;
  int index;
  if (!value_number_here(p) || p->lexer.token.first) {
    if (!value_read_choice(p, words, 2, &index)) return 0;
    body->sharp = index == 0 ? SCENE_SHARP_OFF : SCENE_SHARP_NAMED;
    return 1;
  }
  if (!value_read_exacts(p, &key->range, 1, &degrees)) return 0;
  body->sharp = SCENE_SHARP_ANGLE;
  body->sharp_tangent = angle_half_tangent(degrees);
  return exact_valid(body->sharp_tangent) ||
         parser_fail(p, p->key_place, "found an angle of too many digits for 'sharp', expected fewer");
}

#define AT(field) offsetof(scene_body, field)
#define SIZE_RANGE {UNIT_LENGTH, "0.001", "1000"}
#define KEY_PLACE {"at", block_exacts, AT(at), {UNIT_LENGTH, "-6000", "6000"}, 3, 0}
#define KEY_MOVE {"move", motion_read, 0, {UNIT_NONE, "0", "0"}, 0, 0}
#define KEY_FRICTION {"friction", block_exacts, AT(friction), {UNIT_NONE, "0", "4"}, 1, 0}
#define KEY_GRIP {"grip", read_grip, AT(grip), {UNIT_LENGTH, "-1000", "1000"}, 1, 0}
#define KEY_MASS {"mass", block_exacts, AT(mass), {UNIT_MASS, "0.001", "100000"}, 1, 0}
#define KEY_VELOCITY \
  {"velocity", block_exacts, AT(velocity), {UNIT_SPEED, "-100000", "100000"}, 3, 0}
#define KEY_RADIUS {"radius", block_exacts, AT(radius), SIZE_RANGE, 1, KEY_NEEDED}
#define KEY_TURN {"turn", read_turn, 0, {UNIT_ANGLE, "-170", "170"}, 1, 0}
#define KEYS_OF_SOLIDS KEY_PLACE, KEY_MOVE, KEY_GRIP, KEY_FRICTION, KEY_MASS, KEY_VELOCITY

static const block_key ball_keys[] = {KEY_RADIUS, KEYS_OF_SOLIDS};
static const block_key box_keys[] = {
    {"size", block_exacts, AT(size), SIZE_RANGE, 3, KEY_NEEDED}, KEY_TURN, KEYS_OF_SOLIDS};
static const block_key bar_keys[] = {
    {"length", block_exacts, AT(size), SIZE_RANGE, 1, KEY_NEEDED}, KEY_RADIUS, KEY_TURN,
    KEYS_OF_SOLIDS};
static const block_key mesh_keys[] = {
    {"obj", read_obj, 0, {UNIT_NONE, "0", "0"}, 1, KEY_NEEDED},
    {"unit", block_exacts, AT(unit), {UNIT_LENGTH, "0.000001", "1000"}, 1, 0},
    {"sharp", read_sharp, 0, {UNIT_ANGLE, "1", "170"}, 1, 0},
    KEY_TURN, KEY_PLACE, KEY_MOVE, KEY_FRICTION, KEY_MASS, KEY_VELOCITY};
static const block_key plane_keys[] = {KEY_PLACE, KEY_TURN, KEY_MOVE, KEY_FRICTION};

#define RULE(keys) {keys, sizeof(keys) / sizeof((keys)[0])}
static const struct {
  const char *name;
  fray_shape shape;
  block_rule rule;
} kinds[] = {
    {"ball", FRAY_BALL, RULE(ball_keys)},
    {"box", FRAY_BOX, RULE(box_keys)},
    {"bar", FRAY_BAR, RULE(bar_keys)},
    {"plane", FRAY_PLANE, RULE(plane_keys)},
    {"mesh", FRAY_MESH, RULE(mesh_keys)},
};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

static void set_defaults(scene_body *body, fray_shape shape, int line) {
  const exact zero = exact_make(0, 1);
  memset(body, 0, sizeof *body);
  body->line = line;
  body->shape = shape;
  body->motion = FRAY_FIXED;
  body->turn.axis = -1;
  body->turn.half_tangent = zero;
  body->friction = exact_make(3, 10);
  body->unit = exact_make(1, 1);
  body->radius = body->mass = body->grip = zero;
  for (int k = 0; k < 3; k++) body->at[k] = body->size[k] = body->velocity[k] = zero;
}

/* A path says where its body begins. */
static int settle_place(parser *p, scene_body *body, const char *title, parser_place at,
                        parser_place opened) {
  if (body->motion != FRAY_PATH) {
    return at.line != 0 || parser_fail(p, opened, "%s has no 'at', expected one", title);
  }
  const exact *start = p->out->keys[body->key_first].at;
  for (int k = 0; k < 3 && at.line != 0; k++) {
    if (exact_compare(start[k], body->at[k]) == 0) continue;
    return parser_fail(p, at, "found %s 'at' another place than its path begins, expected the "
                       "same, or no 'at'", title);
  }
  memcpy(body->at, start, sizeof body->at);
  return 1;
}

static int check_free(parser *p, const scene_body *body, const char *title, parser_place mass,
                      parser_place velocity, parser_place opened) {
  if (body->motion == FRAY_FREE) {
    return mass.line != 0 ||
           parser_fail(p, opened, "%s moves free and has no 'mass', expected one", title);
  }
  if (mass.line == 0 && velocity.line == 0) return 1;
  return parser_fail(p, mass.line != 0 ? mass : velocity,
                     "found '%s' in %s, expected it only in a body with 'move free'",
                     mass.line != 0 ? "mass" : "velocity", title);
}

static int check_name(parser *p, const scene_body *body, parser_place place) {
  const scene *out = p->out;
  for (uint32_t k = 0; k < out->body_count; k++) {
    if (strcmp(out->bodies[k].name, body->name) != 0) continue;
    return parser_fail(p, place, "found a second body '%s', expected another name; see line %d",
                       body->name, out->bodies[k].line);
  }
  return 1;
}

int body_block_read(parser *p, const block_key *key, void *target) {
  scene *out = (scene *)target;
  parser_place opened = p->key_place;
  block_seen seen;
  char title[SCENE_NAME + 16];
  int kind = 0;
  while (kind + 1 < KINDS && strcmp(kinds[kind].name, key->name) != 0) kind++;
  if (out->body_count == SCENE_BODIES) {
    return parser_fail(p, opened, "found one body more, expected at most %d in a scene",
                       SCENE_BODIES);
  }
  scene_body *body = &out->bodies[out->body_count];
  set_defaults(body, kinds[kind].shape, opened.line);
  parser_place name_place = parser_here(p);
  if (!value_read_name(p, body->name)) return 0;
  if (!check_name(p, body, name_place)) return 0;
  snprintf(title, sizeof title, "%s '%s'", key->name, body->name);
  if (!value_read_open(p)) return 0;
  const block_rule *rule = &kinds[kind].rule;
  if (!block_read(p, rule, title, opened, body, &seen)) return 0;
  if (!settle_place(p, body, title, block_place(rule, &seen, "at"), opened)) return 0;
  if (!check_free(p, body, title, block_place(rule, &seen, "mass"),
                  block_place(rule, &seen, "velocity"), opened)) {
    return 0;
  }
  out->body_count++;
  return 1;
}
