/* SPDX-License-Identifier: Apache-2.0 */
/* Yarns that are cut before tick 0. What a slit opens is what a tear would have: in sheets with yarns the
 * ends of every cut spring are split first. */
#include "rt/model/couples.h"
#include "tools/build/draft.h"
#include "tools/build/parser.h"

static int read_index(parser *p, uint32_t *index) {
  static const value_range range = {UNIT_NONE, "0", "1023"};
  return value_read_count(p, &range, index);
}

int slits_read(parser *p, const block_key *key, void *target) {
  static const char *const kinds[] = {"warp", "weft", "column", "row"};
  scene *out = (scene *)target;
  (void)key;
  if (out->slit_count == SCENE_SLITS) {
    return parser_fail(p, p->key_place, "found one slit more, expected at most %d in a scene",
                       SCENE_SLITS);
  }
  scene_slit *slit = &out->slits[out->slit_count];
  slit->line = p->key_place.line;
  slit->column = p->key_place.column;
  int kind;
  if (!value_read_choice(p, kinds, 4, &kind) || !read_index(p, &slit->yarn) ||
      !read_index(p, &slit->first) || !read_index(p, &slit->last))
    return 0;
  slit->beside_weft = kind % 2;
  slit->of_triangles = kind / 2;
  out->slit_count++;
  return 1;
}

/* Only a regular mesh has sides along the lines of its grid. */
static int check_of_triangles(parser *p, const scene_slit *slit) {
  const scene *out = p->out;
  const parser_place place = {slit->line, slit->column};
  const uint32_t columns = out->triangles.columns, rows = out->triangles.rows;
  const uint32_t lines = slit->beside_weft ? rows : columns;
  const uint32_t along = slit->beside_weft ? columns : rows;
  if (out->triangles.mesh != MESH_REGULAR)
    return parser_fail(p, place, "found a slit in a mesh that is not regular, expected 'mesh regular'");
  if (slit->yarn != 0 && slit->yarn < lines && slit->first < slit->last && slit->last <= along) return 1;
  return parser_fail(p, place,
                     "found a slit along %s %u from %u to %u, expected it inside the grid: %s 1 to %u, from "
                     "0 to %u",
                     slit->beside_weft ? "row" : "column", (unsigned)slit->yarn, (unsigned)slit->first,
                     (unsigned)slit->last, slit->beside_weft ? "row" : "column", (unsigned)lines - 1u,
                     (unsigned)along);
}

int slits_check(parser *p) {
  const scene *out = p->out;
  for (uint32_t n = 0; n < out->slit_count; n++) {
    const scene_slit *slit = &out->slits[n];
    if (slit->of_triangles != out->triangles.present) {
      const parser_place wrong = {slit->line, slit->column};
      return parser_fail(p, wrong, "found a slit along a %s, expected %s for this sheet",
                         slit->of_triangles ? "line of triangles" : "yarn",
                         slit->of_triangles ? "'slit warp' or 'slit weft'" : "'slit column' or 'slit row'");
    }
    if (slit->of_triangles) {
      if (!check_of_triangles(p, slit)) return 0;
      continue;
    }
    const uint32_t beside = slit->beside_weft ? out->sheet.wefts : out->sheet.warps;
    const uint32_t across = slit->beside_weft ? out->sheet.warps : out->sheet.wefts;
    if (slit->yarn + 1 < beside && slit->first <= slit->last && slit->last < across) continue;
    const parser_place place = {slit->line, slit->column};
    return parser_fail(p, place,
                       "found a slit beside %s %u from %u to %u, expected it inside the grid: %s 0 to "
                       "%u, from 0 to %u",
                       slit->beside_weft ? "weft" : "warp", (unsigned)slit->yarn,
                       (unsigned)slit->first, (unsigned)slit->last,
                       slit->beside_weft ? "weft" : "warp", (unsigned)beside - 2u,
                       (unsigned)across - 1u);
  }
  return 1;
}

static int split_end(const draft *d, fray_world *w, const scene_slit *slit, uint32_t crossing) {
  if (couple_is_held(w, crossing)) return 1;
  if (couple_at(w, crossing) == FRAY_CONNECTED) couple_change(w, crossing, FRAY_LOOSE);
  if (couple_at(w, crossing) != FRAY_WHOLE || couple_split(w, crossing, FRAY_LOOSE)) return 1;
  return draft_refuse(d, slit->line, "spare_particles: expected one for each crossing beside a slit");
}

static int cut_link(const draft *d, fray_world *w, const scene_slit *slit, uint32_t link) {
  uint32_t released[WEAVE_RELEASED];
  uint32_t ends[2];
  weave_ends(d->grid, link, &ends[0], &ends[1]);
  if (world_has_yarns(w) && (!split_end(d, w, slit, ends[0]) || !split_end(d, w, slit, ends[1])))
    return 0;
  const uint32_t count = weave_released(d->grid, link, released);
  world_kill_row(w, w->row_of[link]);
  for (uint32_t n = 0; n < count; ++n) {
    world_kill_row(w, w->row_of[released[n]]);
    if (world_has_yarns(w) && released[n] >= weave_links(d->grid) + weave_bends(d->grid))
      world_kill_row(w, w->row_of[released[n] + weave_shears(d->grid)]);
  }
  return 1;
}

int draft_slits(const draft *d, fray_world *w) {
  for (uint32_t n = 0; n < d->scene->slit_count; ++n) {
    const scene_slit *slit = &d->scene->slits[n];
    for (uint32_t at = slit->first; at <= slit->last; ++at) {
      const uint32_t link =
          slit->beside_weft
              ? d->grid.wefts * (d->grid.warps - 1u) + slit->yarn * d->grid.warps + at
              : at * (d->grid.warps - 1u) + slit->yarn;
      if (!cut_link(d, w, slit, link)) return 0;
    }
  }
  return 1;
}
