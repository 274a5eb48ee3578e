/* SPDX-License-Identifier: Apache-2.0 */
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "rt/state/rigid_body.h"
#include "tools/scene_language/parser.h"

/* rotate 45 deg about z */
static int read_rotation(parser *p, const block_key *key, void *target) {
  static const char *const about[] = {"about"};
  static const char *const axes[] = {"x", "y", "z"};
  scene_rotation *rotation = &((scene_body *)target)->rotation;
  int index;
  return value_read_angle(p, &key->range, &rotation->half_tangent) &&
         value_read_choice(p, about, 1, &index) && value_read_choice(p, axes, 3, &rotation->axis);
}

static int read_hand_rotation(parser *p, const block_key *key, void *target) {
  scene_body *body = (scene_body *)target;
  const scene_rotation own = body->rotation;
  const int good = read_rotation(p, key, target);
  body->hand_rotation = body->rotation;
  body->rotation = own;
  return good;
}

static int read_obj(parser *p, const block_key *key, void *target) {
  (void)key;
  return value_read_path(p, ((scene_body *)target)->obj);
}

/* sharp off, sharp named, sharp 60 deg */
static int read_sharp(parser *p, const block_key *key, void *target) {
  static const char *const words[] = {"off", "named"};
  scene_body *body = (scene_body *)target;
  int index;
  if (!value_number_here(p) || p->lexer.token.first) {
    if (!value_read_choice(p, words, 2, &index)) return 0;
    body->sharp = index == 0 ? SCENE_SHARP_OFF : SCENE_SHARP_NAMED;
    return 1;
  }
  body->sharp = SCENE_SHARP_ANGLE;
  return value_read_angle(p, &key->range, &body->sharp_tangent);
}

#define AT(field) offsetof(scene_body, field)
#define SIZE_RANGE {UNIT_LENGTH, "0.001", "1000"}

typedef struct {
  const char *word;
  fray_shape shape;
  int radius, halves, primitive;
} shape_row;

static const shape_row shapes[] = {
#define X(name, word, radius, halves, primitive, collider) {word, FRAY_##name, radius, halves, primitive},
    SHAPES(X)
#undef X
};

/* What a shape has that its keys follow from. */
enum { ANY = 1, RADIUS = 2, LENGTH = 4, EDGES = 8, OBJ = 16, DIRECTION = 32, BOUNDED = 64, SURFACE = 128 };

static const struct {
  int of;
  block_key key;
} body_keys[] = {
    {LENGTH, {"length", block_exacts, AT(size), SIZE_RANGE, 1, KEY_NEEDED}},
    {EDGES, {"size", block_exacts, AT(size), SIZE_RANGE, 0, KEY_NEEDED}}, /* as many as half sizes */
    {RADIUS, {"radius", block_exacts, AT(radius), SIZE_RANGE, 1, KEY_NEEDED}},
    {OBJ, {"obj", read_obj, 0, NO_RANGE, 1, KEY_NEEDED}},
    {OBJ, {"unit", block_exacts, AT(unit), {UNIT_LENGTH, "0.000001", "1000"}, 1, 0}},
    {OBJ, {"sharp", read_sharp, 0, {UNIT_ANGLE, "1", "170"}, 1, 0}},
    {ANY, {"at", block_exacts, AT(at), {UNIT_LENGTH, "-6000", "6000"}, 3, 0}},
    {DIRECTION, {"rotate", read_rotation, 0, {UNIT_ANGLE, "-170", "170"}, 1, 0}},
    {ANY, {"move", motion_read, 0, NO_RANGE, 0, 0}},
    {ANY, {"friction", block_exacts, AT(friction), {UNIT_NONE, "0", "4"}, 1, 0}},
    {BOUNDED, {"mass", block_exacts, AT(mass), {UNIT_MASS, "0.001", "100000"}, 1, 0}},
    {BOUNDED, {"velocity", block_exacts, AT(velocity), {UNIT_SPEED, "-100000", "100000"}, 3, 0}},
    {BOUNDED, {"coupling", block_exacts, AT(coupling), {UNIT_STIFFNESS, "1000", "10000000"}, 1, 0}},
    {BOUNDED, {"coupling_damping", block_exacts, AT(coupling_damping), {UNIT_TIME, "0", "0.1"}, 1, 0}},
    {BOUNDED, {"hand_scale", block_exacts, AT(hand_scale), {UNIT_NONE, "0.01", "100"}, 1, 0}},
    {BOUNDED, {"hand_rotate", read_hand_rotation, 0, {UNIT_ANGLE, "-170", "170"}, 1, 0}},
    {BOUNDED, {"hand_offset", block_exacts, AT(hand_offset), {UNIT_LENGTH, "-6000", "6000"}, 3, 0}},
    {BOUNDED, {"force_scale", block_exacts, AT(force_scale), {UNIT_NONE, "0.001", "1000"}, 1, 0}},
    {SURFACE, {"attach_within", block_exacts, AT(attach_within), {UNIT_LENGTH, "-1000", "1000"}, 1, 0}},
};
enum { BODY_KEYS = sizeof body_keys / sizeof body_keys[0] };

static int traits_of(const shape_row *s) {
  const int sized = s->radius != 0 || s->halves != 0;
  return ANY | (s->radius ? RADIUS : 0) | (s->halves == 1 ? LENGTH : s->halves > 1 ? EDGES : 0) |
         (s->shape == FRAY_MESH ? OBJ : 0) | (s->halves != 0 || !s->radius ? DIRECTION : 0) |
         (s->shape != FRAY_PLANE ? BOUNDED : 0) | (s->primitive && sized ? SURFACE : 0);
}

block_rule body_rule_of(fray_shape shape, block_key keys[BLOCK_KEYS]) {
  const shape_row *s = shapes;
  while (s->shape != shape) s++;
  block_rule rule = {"body", keys, 0};
  for (int n = 0; n < BODY_KEYS; n++) {
    if ((body_keys[n].of & traits_of(s)) == 0) continue;
    keys[rule.count] = body_keys[n].key;
    if (body_keys[n].of == EDGES) keys[rule.count].count = s->halves;
    rule.count++;
  }
  return rule;
}

static void set_defaults(scene_body *body, fray_shape shape) {
  const exact zero = exact_make(0, 1);
  memset(body, 0, sizeof *body);
  body->shape = shape;
  body->motion = FRAY_FIXED;
  body->rotation.axis = -1;
  body->rotation.half_tangent = zero;
  body->friction = exact_make(3, 10);
  body->coupling = exact_make(1000000, 1);
  body->coupling_damping = exact_make(-1, 1);
  body->hand_scale = body->force_scale = exact_make(1, 1);
  body->hand_rotation.axis = -1;
  body->hand_rotation.half_tangent = zero;
  body->unit = exact_make(1, 1);
  body->radius = body->mass = body->attach_within = zero;
  for (int k = 0; k < 3; k++) body->at[k] = body->size[k] = body->velocity[k] = zero;
}

/* A path gives its body's start: `at` may be left out. */
static int find_start(parser *p, scene_body *body, const char *title, scene_place at, scene_place opened) {
  if (body->motion != FRAY_PATH) {
    return at.line != 0 || parser_fail(p, opened, "%s has no 'at', expected one", title);
  }
  const exact *start = p->out->keys[body->key_first].at;
  for (int k = 0; k < 3 && at.line != 0; k++) {
    if (exact_compare(start[k], body->at[k]) == 0) continue;
    return parser_fail(p, at, "found an 'at' of %s that differs from the start of its path, expected "
                       "the same, or no 'at'", title);
  }
  memcpy(body->at, start, sizeof body->at);
  return 1;
}

/* Keys of the coupling are those of a handle; its mass makes a hand's body one. */
static int check_handle(parser *p, scene_body *body, const char *title, const block_rule *rule,
                        const block_seen *seen) {
  static const char *const keys[] = {"coupling", "coupling_damping", "hand_scale", "hand_rotate",
                                     "hand_offset", "force_scale"};
  body->is_handle = body->motion == FRAY_HAND && block_has(rule, seen, "mass");
  body->has_hand_offset = block_has(rule, seen, "hand_offset");
  if (!body->is_handle) {
    for (size_t n = 0; n < sizeof keys / sizeof keys[0]; n++)
      if (block_has(rule, seen, keys[n]))
        return parser_fail(p, block_place(rule, seen, keys[n]),
                           "found '%s' in %s, expected it only in a body with 'move hand left' or 'right' and "
                           "a 'mass'", keys[n], title);
    return 1;
  }
  if (block_has(rule, seen, "velocity"))
    return parser_fail(p, block_place(rule, seen, "velocity"),
                       "found 'velocity' in %s, expected it only in a body with 'move free'", title);
  body->motion = FRAY_FREE;
  return 1;
}

static int check_free(parser *p, const scene_body *body, const char *title, scene_place mass,
                      scene_place velocity, scene_place opened) {
  if (body->motion == FRAY_FREE) {
    return mass.line != 0 ||
           parser_fail(p, opened, "%s has 'move free' and no 'mass', expected one", title);
  }
  if (mass.line == 0 && velocity.line == 0) return 1;
  return parser_fail(p, mass.line != 0 ? mass : velocity,
                     "found '%s' in %s, expected it only in a body with 'move free'",
                     mass.line != 0 ? "mass" : "velocity", title);
}

static int check_name(parser *p, const scene_body *body, scene_place place) {
  const scene *out = p->out;
  for (uint32_t k = 0; k < out->body_count; k++) {
    if (strcmp(out->bodies[k].name, body->name) != 0) continue;
    return parser_fail(p, place, "found a second body '%s', expected another name; see line %d",
                       body->name, out->source.block[BLOCK_BODY + k].line);
  }
  return 1;
}

int body_block_read(parser *p, const block_key *key, void *target) {
  scene *out = (scene *)target;
  scene_place opened = p->key_place;
  block_seen seen;
  char title[SCENE_NAME + 16];
  block_key keys[BLOCK_KEYS];
  const shape_row *row = shapes;
  while (strcmp(row->word, key->name) != 0) row++;
  if (!parser_has_room(p, opened, out->body_count, SCENE_BODIES, "body")) return 0;
  scene_body *body = &out->bodies[out->body_count];
  set_defaults(body, row->shape);
  scene_place name_place = parser_here(p);
  if (!value_read_name(p, body->name)) return 0;
  if (!check_name(p, body, name_place)) return 0;
  snprintf(title, sizeof title, "%s '%s'", key->name, body->name);
  const block_rule rule = body_rule_of(row->shape, keys);
  block_open(p, BLOCK_BODY + out->body_count);
  if (!block_read(p, &rule, title, opened, body, &seen)) return 0;
  body->has_attach = block_has(&rule, &seen, "attach_within");
  if (!find_start(p, body, title, block_place(&rule, &seen, "at"), opened)) return 0;
  if (!check_handle(p, body, title, &rule, &seen)) return 0;
  if (!check_free(p, body, title, block_place(&rule, &seen, "mass"),
                  block_place(&rule, &seen, "velocity"), opened)) {
    return 0;
  }
  out->body_count++;
  return 1;
}
