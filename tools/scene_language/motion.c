/* SPDX-License-Identifier: Apache-2.0 */
/* The motion of a body: fixed, with a hand, free, or along a path. */
#include "tools/scene_language/parser.h"

static int read_hand(parser *p, scene_body *body) {
  static const char *const sides[] = {"left", "right"};
  int side;
  if (!value_read_choice(p, sides, FRAY_HANDS, &side)) return 0;
  if (p->hand[side].line != 0) {
    return parser_fail(p, p->key_place, "found a second body on the %s hand, expected one at "
                       "most; see line %d", sides[side], p->hand[side].line);
  }
  p->hand[side] = p->key_place;
  body->motion = FRAY_HAND;
  body->hand = (uint32_t)side;
  return 1;
}

/* TIME s X Y Z cm; may begin a line. */
static int read_keyframe(parser *p, const scene_keyframe *before, scene_keyframe *next) {
  static const value_range time = {UNIT_TIME, "0", "86400"};
  static const value_range place = {UNIT_LENGTH, "-6000", "6000"};
  next->place = parser_here(p);
  p->lexer.token.first = 0;
  if (!value_read_exacts(p, &time, 1, &next->time)) return 0;
  if (!value_read_exacts(p, &place, 3, next->at)) return 0;
  if (before != NULL && exact_compare(next->time, before->time) <= 0) {
    return parser_fail(p, next->place, "found a time that is not later than the one before, expected "
                                 "rising times in a path");
  }
  return 1;
}

static int read_path(parser *p, scene_body *body) {
  scene *out = p->out;
  scene_place opened = parser_here(p);
  if (!value_read_open(p)) return 0;
  body->motion = FRAY_PATH;
  body->key_first = out->key_count;
  p->key = "path";
  while (p->lexer.token.kind == TOKEN_WORD) {
    if (!parser_has_room(p, parser_here(p), out->key_count, SCENE_KEYFRAMES, "keyframe")) return 0;
    scene_keyframe *next = &out->keys[out->key_count];
    if (!read_keyframe(p, body->keys == 0 ? NULL : next - 1, next)) return 0;
    out->key_count++;
    body->keys++;
  }
  p->lexer.token.first = 0;
  if (body->keys == 0) return parser_expected(p, "keyframes of a path: TIME s X Y Z cm");
  if (p->lexer.token.kind != TOKEN_CLOSE) {
    return parser_expected(p, "'}' for the path's '{' of line %d", opened.line);
  }
  lexer_next(&p->lexer);
  return 1;
}

int motion_read(parser *p, const block_key *key, void *target) {
  static const char *const motions[] = {"fixed", "path", "hand", "free"};
  static const char *const plane_motions[] = {"fixed", "path"};
  scene_body *body = (scene_body *)target;
  int motion;
  (void)key;
  if (body->shape == FRAY_PLANE) {
    if (!value_read_choice(p, plane_motions, 2, &motion)) return 0;
  } else {
    if (!value_read_choice(p, motions, 4, &motion)) return 0;
  }
  if (motion == 1) return read_path(p, body);
  if (motion == 2) return read_hand(p, body);
  body->motion = motion == 3 ? FRAY_FREE : FRAY_FIXED;
  return 1;
}
