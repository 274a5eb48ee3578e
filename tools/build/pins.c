/* SPDX-License-Identifier: Apache-2.0 */
/* Crossings held where they are, or by a body. A pin may stand before the sheet and its body, so its last
 * row or column and the body's number are filled in when the whole scene is known. */
#include <string.h>

#include "tools/build/parser.h"

/* The grid's last row or column. */
#define LAST UINT32_MAX

static const value_range index_range = {UNIT_NONE, "0", "1023"};

static int read_index(parser *p, uint32_t *index) {
  return value_read_count(p, &index_range, index);
}

/* first and last name the grid's borders; a number is a row or a column of its own. */
static int read_line(parser *p, const char *first, const char *last, uint32_t *least,
                     uint32_t *most) {
  const token *t = &p->lexer.token;
  if (value_here(p) && value_number_here(p)) {
    if (!read_index(p, least)) return 0;
    *most = *least;
    return 1;
  }
  if (!value_here(p) || (!lexer_is(t, first) && !lexer_is(t, last))) {
    return parser_expected(p, "%s, %s or a number for 'pin'", first, last);
  }
  *least = *most = lexer_is(t, first) ? 0 : LAST;
  lexer_next(&p->lexer);
  return 1;
}

static int read_block(parser *p, scene_pin *pin) {
  if (!read_index(p, &pin->i0) || !read_index(p, &pin->i1)) return 0;
  if (!read_index(p, &pin->j0) || !read_index(p, &pin->j1)) return 0;
  if (pin->i0 > pin->i1 || pin->j0 > pin->j1) {
    return parser_fail(p, p->key_place, "found a block that ends before it begins, expected "
                       "'pin block' FIRST_WARP LAST_WARP FIRST_WEFT LAST_WEFT");
  }
  return 1;
}

/* by NAME, or nothing. */
static int read_body(parser *p, scene_pin *pin) {
  pin->body[0] = 0;
  if (!value_here(p) || !lexer_is(&p->lexer.token, "by")) return 1;
  lexer_next(&p->lexer);
  const token *t = &p->lexer.token;
  if (!value_here(p) || t->bytes >= sizeof pin->body)
    return parser_expected(p, "the name of a body that holds the crossings");
  memcpy(pin->body, t->text, t->bytes);
  pin->body[t->bytes] = 0;
  lexer_next(&p->lexer);
  return 1;
}

int pins_read(parser *p, const block_key *key, void *target) {
  static const char *const kinds[] = {"row", "column", "crossing", "block"};
  scene *out = (scene *)target;
  int kind, good = 0;
  (void)key;
  if (out->pin_count == SCENE_PINS) {
    return parser_fail(p, p->key_place, "found one pin more, expected at most %d in a scene",
                       SCENE_PINS);
  }
  scene_pin *pin = &out->pins[out->pin_count];
  pin->line = p->key_place.line;
  pin->column = p->key_place.column;
  pin->i0 = pin->j0 = 0;
  pin->i1 = pin->j1 = LAST;
  if (!value_read_choice(p, kinds, 4, &kind)) return 0;
  switch (kind) {
    case 0: good = read_line(p, "top", "bottom", &pin->j0, &pin->j1); break;
    case 1: good = read_line(p, "left", "right", &pin->i0, &pin->i1); break;
    case 2:
      good = read_index(p, &pin->i0) && read_index(p, &pin->j0);
      pin->i1 = pin->i0;
      pin->j1 = pin->j0;
      break;
    case 3: good = read_block(p, pin); break;
  }
  good = good && read_body(p, pin);
  if (good) out->pin_count++;
  return good;
}

static void resolve(uint32_t *index, uint32_t count) {
  if (*index == LAST) *index = count - 1;
}

/* A body without a grip of its own holds these crossings alone: none is as deep inside it as that. */
static int find_body(parser *p, scene_pin *pin) {
  scene *out = p->out;
  pin->by = SCENE_BODIES;
  if (pin->body[0] == 0) return 1;
  for (uint32_t n = 0; n < out->body_count; n++)
    if (strcmp(out->bodies[n].name, pin->body) == 0) pin->by = n;
  if (pin->by == SCENE_BODIES) {
    const parser_place place = {pin->line, pin->column};
    return parser_fail(p, place, "found a pin by '%s', expected the name of a body", pin->body);
  }
  scene_body *b = &out->bodies[pin->by];
  if (!b->has_grip) b->grip = exact_make(-1000, 1);
  b->has_grip = 1;
  return 1;
}

/* Of a mesh without a grid only whole sides can be named. */
static int is_side(const scene_pin *pin, uint32_t columns, uint32_t rows) {
  const int row = pin->i0 == 0 && pin->i1 == columns && pin->j0 == pin->j1 && pin->j0 % rows == 0;
  const int column = pin->j0 == 0 && pin->j1 == rows && pin->i0 == pin->i1 && pin->i0 % columns == 0;
  return row || column;
}

int pins_resolve(parser *p) {
  scene *out = p->out;
  const uint32_t columns = out->triangles.columns, rows = out->triangles.rows;
  const uint32_t warps = out->triangles.present ? columns + 1 : out->sheet.warps;
  const uint32_t wefts = out->triangles.present ? rows + 1 : out->sheet.wefts;
  for (uint32_t k = 0; k < out->pin_count; k++) {
    scene_pin *pin = &out->pins[k];
    resolve(&pin->i0, warps);
    resolve(&pin->i1, warps);
    resolve(&pin->j0, wefts);
    resolve(&pin->j1, wefts);
    if (!find_body(p, pin)) return 0;
    parser_place place = {pin->line, pin->column};
    if (out->triangles.present && out->triangles.mesh != MESH_REGULAR && !is_side(pin, columns, rows))
      return parser_fail(p, place, "found a pin inside of a mesh that is not regular, expected row top, row "
                         "bottom, column left or column right");
    if (pin->i1 < warps && pin->j1 < wefts) continue;
    return parser_fail(p, place,
                       "found a pin at warp %u, weft %u, expected it inside the grid: warps 0 to "
                       "%u, wefts 0 to %u",
                       (unsigned)pin->i1, (unsigned)pin->j1, (unsigned)warps - 1u,
                       (unsigned)wefts - 1u);
  }
  return 1;
}
