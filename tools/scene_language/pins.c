/* SPDX-License-Identifier: Apache-2.0 */
/* Pins and slits. Both may come before the cloth and the bodies, so they are resolved and checked once
 * the whole scene is known. */
#include <stdio.h>
#include <string.h>

#include "tools/scene_language/nearest.h"
#include "tools/scene_language/parser.h"

/* The grid's last row or column. */
#define LAST UINT32_MAX

static const value_range index_range = {UNIT_NONE, "0", "1023"};

static int read_index(parser *p, uint32_t *index) {
  return value_read_count(p, &index_range, index);
}

/* first and last name the grid's outer lines; a number is any line. */
static int read_line(parser *p, const char *first, const char *last, uint32_t *min,
                     uint32_t *max) {
  const token *t = &p->lexer.token;
  if (value_here(p) && value_number_here(p)) {
    if (!read_index(p, min)) return 0;
    *max = *min;
    return 1;
  }
  if (!value_here(p) || (!lexer_is(t, first) && !lexer_is(t, last))) {
    return parser_expected(p, "%s, %s or a number for 'pin'", first, last);
  }
  *min = *max = lexer_is(t, first) ? 0 : LAST;
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
  pin->by_place = parser_here(p);
  if (!value_here(p) || t->bytes >= sizeof pin->body)
    return parser_expected(p, "the name of a body behind 'by'");
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
  if (!parser_has_room(p, p->key_place, out->pin_count, SCENE_PINS, "pin")) return 0;
  scene_pin *pin = &out->pins[out->pin_count];
  pin->place = p->key_place;
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

static int unknown_body(parser *p, const scene_pin *pin) {
  const scene *out = p->out;
  char names[PARSER_LIST] = "";
  const char *near = NULL;
  int least = NEAREST_EDITS + 1;
  for (uint32_t n = 0; n < out->body_count; n++) {
    const char *name = out->bodies[n].name;
    const int edits = nearest_edits(pin->body, strlen(pin->body), name);
    const size_t length = strlen(names);
    snprintf(names + length, sizeof names - length, "%s%s", n == 0 ? ": " : ", ", name);
    if (edits >= least || !nearest_is_near(edits, strlen(pin->body))) continue;
    least = edits;
    near = name;
  }
  return parser_fail(p, pin->by_place,
                     near != NULL ? "found '%s' (did you mean '%s'?), expected the name of a body%s"
                                  : "found '%s'%.0s, expected the name of a body%s",
                     pin->body, near != NULL ? near : "", names);
}

/* A body without an attach_within of its own gets these crossings alone: none is 10 m inside of it. */
static int find_body(parser *p, scene_pin *pin) {
  scene *out = p->out;
  pin->by = SCENE_BODIES;
  if (pin->body[0] == 0) return 1;
  for (uint32_t n = 0; n < out->body_count; n++)
    if (strcmp(out->bodies[n].name, pin->body) == 0) pin->by = n;
  if (pin->by == SCENE_BODIES) return unknown_body(p, pin);
  scene_body *b = &out->bodies[pin->by];
  if (!b->has_attach) b->attach_within = exact_make(-1000, 1);
  b->has_attach = 1;
  return 1;
}

/* A pattern that is not regular keeps only the outer lines of the grid. */
static int is_edge(const scene_pin *pin, uint32_t columns, uint32_t rows) {
  const int row = pin->i0 == 0 && pin->i1 == columns && pin->j0 == pin->j1 && pin->j0 % rows == 0;
  const int column = pin->j0 == 0 && pin->j1 == rows && pin->i0 == pin->i1 && pin->i0 % columns == 0;
  return row || column;
}

int pins_resolve(parser *p) {
  scene *out = p->out;
  const uint32_t columns = out->membrane.columns, rows = out->membrane.rows;
  const uint32_t warps = out->membrane.present ? columns + 1 : out->woven.warps;
  const uint32_t wefts = out->membrane.present ? rows + 1 : out->woven.wefts;
  for (uint32_t k = 0; k < out->pin_count; k++) {
    scene_pin *pin = &out->pins[k];
    resolve(&pin->i0, warps);
    resolve(&pin->i1, warps);
    resolve(&pin->j0, wefts);
    resolve(&pin->j1, wefts);
    if (!find_body(p, pin)) return 0;
    const scene_place place = pin->place;
    if (out->membrane.present && out->membrane.pattern != PATTERN_REGULAR && !is_edge(pin, columns, rows))
      return parser_fail(p, place, "found a pin inside a pattern that is not regular, expected row top, row "
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

int slits_read(parser *p, const block_key *key, void *target) {
  static const char *const kinds[] = {"warp", "weft", "column", "row"};
  scene *out = (scene *)target;
  int kind;
  (void)key;
  if (!parser_has_room(p, p->key_place, out->slit_count, SCENE_SLITS, "slit")) return 0;
  scene_slit *slit = &out->slits[out->slit_count];
  slit->place = p->key_place;
  if (!value_read_choice(p, kinds, 4, &kind) || !read_index(p, &slit->yarn) ||
      !read_index(p, &slit->first) || !read_index(p, &slit->last))
    return 0;
  slit->beside_weft = kind % 2;
  slit->of_membrane = kind / 2;
  out->slit_count++;
  return 1;
}

/* Woven: between yarns `yarn` and `yarn` + 1, across yarns first to last. Membrane: along an inner grid line,
 * from line first to line last. */
static int check_slit(parser *p, const scene_slit *slit) {
  static const char *const names[2][2] = {{"warp", "weft"}, {"column", "row"}};
  const scene *out = p->out;
  const scene_place place = slit->place;
  const int membrane = out->membrane.present;
  const char *name = names[membrane][slit->beside_weft];
  const uint32_t columns = membrane ? out->membrane.columns : out->woven.warps - 1;
  const uint32_t rows = membrane ? out->membrane.rows : out->woven.wefts - 1;
  const uint32_t min = membrane ? 1 : 0;
  const uint32_t max = (slit->beside_weft ? rows : columns) - 1;
  const uint32_t along = slit->beside_weft ? columns : rows;
  if (slit->of_membrane != membrane)
    return parser_fail(p, place, "found 'slit %s', expected 'slit %s' or 'slit %s' for this cloth",
                       names[!membrane][slit->beside_weft], names[membrane][0], names[membrane][1]);
  if (membrane && out->membrane.pattern != PATTERN_REGULAR)
    return parser_fail(p, place, "found a slit in a pattern that is not regular, expected 'pattern regular'");
  if (slit->yarn >= min && slit->yarn <= max && slit->first + min <= slit->last && slit->last <= along)
    return 1;
  return parser_fail(
      p, place, "found a slit %s %s %u from %u to %u, expected it inside the grid: %s %u to %u, from 0 to %u",
      membrane ? "along" : "beside", name, (unsigned)slit->yarn, (unsigned)slit->first, (unsigned)slit->last,
      name, (unsigned)min, (unsigned)max, (unsigned)along);
}

int slits_check(parser *p) {
  for (uint32_t n = 0; n < p->out->slit_count; n++)
    if (!check_slit(p, &p->out->slits[n])) return 0;
  return 1;
}
