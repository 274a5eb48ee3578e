/* SPDX-License-Identifier: Apache-2.0 */
/* Words of scenes before version 0.4. The parser looks here when it meets a word that it does not know. */
#include "tools/scene_language/parser.h"

#include <string.h>

const old_word old_words[] = {
    {"scene", "sheet", "woven"},
    {"scene", "triangles", "membrane"},
    {"scene", "sweeps", "iterations"},
    {"scene", "rest_strain", "max_rest_strain"},
    {"scene", "ball", "sphere"},
    {"scene", "bar", "capsule"},
    {"woven", "plane", "orientation"},
    {"woven", "transition", "split_strain"},
    {"woven", "loose", "disconnect_at"},
    {"woven", "loose_by", "disconnect_by"},
    {"woven", "slip_grip", "crossing_friction"},
    {"membrane", "edge", "cell"},
    {"membrane", "mesh", "pattern"},
    {"membrane", "plane", "orientation"},
    {"membrane", "inner_steps", "elastic_steps_max"},
    {"membrane", "collide", "collision"},
    {"pattern", "turned", "rotated"},
    {"collision", "whole", "triangles"},
    {"material", "like", "base"},
    {"material", "relax", "tear_interval"},
    {"material", "cut", "cut_speed"},
    {"body", "grip", "attach_within"},
    {"body", "turn", "rotate"},
    {"limits", "cuts_per_tick", "tears_per_tick"},
    {"limits", "self_pairs", "self_collision_pairs"},
    {"hands", "ramp", "ramp_up"},
    {"hands", "fade", "ramp_down"},
};
const size_t old_word_count = sizeof old_words / sizeof old_words[0];

int old_word_fails(parser *p, const char *where) {
  const token *t = &p->lexer.token;
  for (size_t k = 0; k < old_word_count; k++) {
    const old_word *w = &old_words[k];
    if (strcmp(w->where, where) != 0 || !lexer_is(t, w->old)) continue;
    parser_fail(p, parser_here(p), "'%s' is now '%s'", w->old, w->now);
    return 1;
  }
  return 0;
}
