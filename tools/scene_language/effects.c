/* SPDX-License-Identifier: Apache-2.0 */
/* Keys that have no effect where they stand: one table, a note for each that a scene has. What can only be a
 * mistake is an error of its reader. */
#include <stdio.h>
#include <string.h>

#include "rt/state/rigid_body.h"
#include "tools/scene_language/parser.h"

static int is_zero(exact v) { return v.numerator == 0; }

static int has_body(const scene *s, int (*is)(const scene_body *)) {
  for (uint32_t n = 0; n < s->body_count; n++)
    if (is(&s->bodies[n])) return 1;
  return 0;
}
static int is_mesh(const scene_body *b) { return b->shape == FRAY_MESH; }
static int moves_with_hand(const scene_body *b) { return b->motion == FRAY_HAND || b->is_handle; }
static int is_handle(const scene_body *b) { return b->is_handle; }
static int collides_with_triangles(const scene_body *b) {
  return b->shape == FRAY_MESH || (SHAPES_COLLIDER >> b->shape & 1) != 0;
}

static int without_hand(const scene *s) { return !has_body(s, moves_with_hand); }
static int without_handle(const scene *s) { return !has_body(s, is_handle); }
static int without_mesh(const scene *s) { return !has_body(s, is_mesh); }
static int without_collider(const scene *s) { return !has_body(s, collides_with_triangles); }
static int without_wind(const scene *s) { return !s->has_wind; }
static int without_gather(const scene *s) { return is_zero(s->woven.gather); }
static int without_stretch(const scene *s) { return is_zero(s->woven.stretch); }
static int with_stretch(const scene *s) { return s->woven.present && !without_stretch(s); }
static int without_self_collision(const scene *s) { return !s->woven.self_collision; }
static int without_yarns(const scene *s) { return s->woven.present && s->woven.yarns == 0; }
static int is_tear_off(const scene *s) { return s->woven.present && !s->woven.tearing; }
static int without_spares_to_split(const scene *s) {
  return s->woven.yarns == 1 && s->limits.has_spare_particles && s->limits.spare_particles == 0;
}
static int never_splits(const scene *s) {
  return s->woven.yarns == 1 && is_tear_off(s) && s->slit_count == 0;
}
static int is_never_cut(const scene *s) {
  return s->membrane.present && (!s->membrane.cloth.has_cut_speed || without_mesh(s));
}
static int never_tears(const scene *s) {
  if (!s->membrane.present) return 0;
  for (int n = 0; n < TEAR_STRENGTH_DIRECTIONS; n++)
    if (!is_zero(s->membrane.cloth.strength[n])) return 0;
  return is_zero(s->membrane.cloth.breaks);
}
static int stays_whole(const scene *s) { return never_tears(s) && is_never_cut(s); }
static int spares_are_idle(const scene *s) {
  return s->limits.spare_particles > 0 && stays_whole(s) && s->slit_count == 0;
}
static int spare_triangles_are_idle(const scene *s) {
  return s->limits.spare_triangles > 0 && stays_whole(s);
}
static int without_spares_to_tear(const scene *s) {
  return s->membrane.present && ((s->limits.has_spare_particles && s->limits.spare_particles == 0) ||
                                 (s->limits.has_spare_triangles && s->limits.spare_triangles == 0));
}
static int is_nothing_searched(const scene *s) { return s->substeps != 0 && s->iterations != 0; }
static int is_shorter_than_a_tick(const scene *s) {
  return !is_zero(s->settle) &&
         exact_compare(exact_mul(s->settle, exact_make(2 * (int64_t)s->rate_hz, 1)), exact_make(1, 1)) < 0;
}
static int is_still(const scene *s) {
  return is_zero(s->gravity[0]) && is_zero(s->gravity[1]) && is_zero(s->gravity[2]) && !s->has_wind &&
         s->load_count == 0 && s->body_count == 0 && without_gather(s) && s->woven.yarns == 0 &&
         s->slit_count == 0;
}

enum { OF_MATERIAL = BLOCKS }; /* the block of the membrane's own material */

static const struct {
  uint32_t block;
  const char *key;
  int (*idle)(const scene *s);
  const char *because;
} rows[] = {
    {BLOCK_SCENE, "settle", is_shorter_than_a_tick, "it is shorter than a tick"},
    {BLOCK_SCENE, "settle", is_still,
     "nothing moves the cloth: no gravity, wind, load, body, gather or yarns"},
    {BLOCK_SCENE, "max_rest_strain", is_nothing_searched, "neither 'substeps' nor 'iterations' is auto"},
    {BLOCK_SCENE, "iterations", with_stretch, "yarns with a 'stretch' are not projected"},
    {BLOCK_SCENE, "hands", without_hand, "no body has 'move hand left' or 'move hand right'"},
    {BLOCK_HANDS, "energy_reserve", without_handle, "no body of a hand has a 'mass'"},
    {BLOCK_HANDS, "delay", without_handle, "no body of a hand has a 'mass'"},
    {BLOCK_CLOTH, "pleats", without_gather, "'gather' is 0"},
    {BLOCK_CLOTH, "yarns", without_spares_to_split, "'spare_particles' is 0: no crossing can split"},
    {BLOCK_CLOTH, "yarns", never_splits, "'tear' is off: no crossing splits"},
    {BLOCK_CLOTH, "split_strain", without_yarns, "'yarns' is off"},
    {BLOCK_CLOTH, "disconnect_at", without_yarns, "'yarns' is off"},
    {BLOCK_CLOTH, "disconnect_by", without_yarns, "'yarns' is off"},
    {BLOCK_CLOTH, "spread_splits", without_yarns, "'yarns' is off"},
    {BLOCK_CLOTH, "crossing_friction", without_yarns, "'yarns' is off"},
    {BLOCK_CLOTH, "slip_friction", without_yarns, "'yarns' is off"},
    {BLOCK_CLOTH, "static_friction", without_yarns, "'yarns' is off"},
    {BLOCK_CLOTH, "stretch_damping", without_stretch, "there is no 'stretch'"},
    {BLOCK_CLOTH, "self_thickness", without_self_collision, "'self_collision' is off"},
    {BLOCK_CLOTH, "wind_normal", without_wind, "there is no 'wind'"},
    {BLOCK_CLOTH, "wind_drag", without_wind, "there is no 'wind'"},
    {BLOCK_CLOTH, "collision", without_collider, "there is no mesh and no sphere"},
    {OF_MATERIAL, "tear", without_spares_to_tear,
     "'limits' leaves no spare particles and triangles to tear with"},
    {OF_MATERIAL, "tear_interval", never_tears, "the material has no 'tear'"},
    {OF_MATERIAL, "cut_speed", without_mesh, "there is no mesh"},
    {BLOCK_LIMITS, "spare_particles", without_yarns, "'yarns' is off: crossings do not split"},
    {BLOCK_LIMITS, "spare_particles", spares_are_idle, "the membrane is never torn, cut or slit"},
    {BLOCK_LIMITS, "spare_triangles", spare_triangles_are_idle, "the membrane is never torn or cut"},
    {BLOCK_LIMITS, "splits_per_tick", without_yarns, "'yarns' is off"},
    {BLOCK_LIMITS, "tears_per_tick", is_tear_off, "'tear' is off"},
    {BLOCK_LIMITS, "tears_per_tick", is_never_cut,
     "no blade cuts the membrane, which tears once a tick at most"},
    {BLOCK_LIMITS, "self_collision_pairs", without_self_collision, "'self_collision' is off"},
};

static void note(parser *p, scene_place place, const char *key, const char *because) {
  scene *out = p->out;
  if (out->note_count == SCENE_NOTES) return;
  scene_note *n = &out->notes[out->note_count++];
  n->place = place;
  snprintf(n->text, sizeof n->text, "'%s' has no effect: %s", key, because);
}

/* BLOCKS: it has none of its own. */
static uint32_t material_of(const scene *s) {
  uint32_t n = 0;
  while (n < s->material_count && strcmp(s->materials[n].name, s->membrane.material) != 0) n++;
  return s->membrane.present && n < s->material_count ? BLOCK_MATERIAL + n : BLOCKS;
}

static void check_mirrored(parser *p) {
  const scene *s = p->out;
  if (!s->woven.tear_mirrored) return;
  if (!s->woven.tearing)
    note(p, p->tear_mirrored, "tear mirrored", "'tear' is off");
  else if (exact_compare(s->woven.tear_min, s->woven.tear_max) == 0)
    note(p, p->tear_mirrored, "tear mirrored", "all springs tear at the same strain");
}

static void check_pins(parser *p) {
  const scene *s = p->out;
  char because[64];
  for (uint32_t n = 0; n < s->pin_count; n++)
    for (uint32_t k = 0; k < n; k++) {
      const scene_pin *a = &s->pins[k], *b = &s->pins[n];
      if (b->i0 < a->i0 || b->i1 > a->i1 || b->j0 < a->j0 || b->j1 > a->j1) continue;
      snprintf(because, sizeof because, "the pin of line %d holds all of it", a->place.line);
      note(p, b->place, "pin", because);
      break;
    }
}

static void check_slits(parser *p) {
  const scene *s = p->out;
  char because[64];
  for (uint32_t n = 0; n < s->slit_count; n++)
    for (uint32_t k = 0; k < n; k++) {
      const scene_slit *a = &s->slits[k], *b = &s->slits[n];
      if (a->beside_weft != b->beside_weft || a->yarn != b->yarn || b->first < a->first || b->last > a->last)
        continue;
      snprintf(because, sizeof because, "the slit of line %d cuts all of it", a->place.line);
      note(p, b->place, "slit", because);
      break;
    }
}

void effects_check(parser *p) {
  const scene *s = p->out;
  for (size_t n = 0; n < sizeof rows / sizeof rows[0]; n++) {
    const uint32_t block = rows[n].block == OF_MATERIAL ? material_of(s) : rows[n].block;
    const source_key *found = source_find(&s->source, block, rows[n].key);
    if (found != NULL && rows[n].idle(s)) note(p, found->place, rows[n].key, rows[n].because);
  }
  check_mirrored(p);
  check_pins(p);
  check_slits(p);
}
