/* SPDX-License-Identifier: Apache-2.0 */
/* Nothing passes through a rigid mesh: after every substep the way of every particle, as the mesh saw
 * it, is held against every triangle in exact arithmetic, and begins where the last one ended. */
#include "tests/lib/test.h"

#include "rt/state/rigid_mesh.h"
#include "tests/physics/contact_watch.h"

static int box_meets(const vec3 a, const vec3 b, const rigid_mesh_box *box) {
  const int32_t low[3] = {fx_min(a.x, b.x), fx_min(a.y, b.y), fx_min(a.z, b.z)};
  const int32_t high[3] = {fx_max(a.x, b.x), fx_max(a.y, b.y), fx_max(a.z, b.z)};
  for (uint32_t k = 0; k < 3; ++k)
    if (low[k] > box->high[k] || high[k] < box->low[k]) return 0;
  return 1;
}

/* What reaches the world's edge is held there, meshes or not, and reported. */
static int at_edge(const fray_world *w, uint32_t p) {
  const vec3 v = world_position(w, p);
  return fx_max(fx_max(v.x, -v.x), fx_max(fx_max(v.y, -v.y), fx_max(v.z, -v.z))) >= FX_WORLD_MAX;
}

/* By all leaves, whatever the tree says. */
static int touches(const rigid_mesh_parts *m, vec3 begin, vec3 end) {
  moving_point p[4];
  if (begin.x == end.x && begin.y == end.y && begin.z == end.z) return 0;
  p[0] = moving_between(begin, end);
  for (uint32_t n = 0; n < m->box_count; ++n) {
    const rigid_mesh_box *box = &m->boxes[n];
    if (box->face == RIGID_MESH_NONE || !box_meets(begin, end, box)) continue;
    ++near_paths;
    for (uint32_t k = 0; k < 3; ++k) {
      const vec3 at = rigid_mesh_corner(m, (uint32_t)box->face, k);
      p[k + 1] = moving_between(at, at);
    }
    if (exact_ccd_touches(p, 1)) return 1;
  }
  return 0;
}

static void look_at_substep(const fray_world *w) {
  for (uint32_t n = 0; n < rigid_mesh_count(w); ++n) {
    const rigid_mesh_parts m = rigid_mesh_at(w, n);
    const uint32_t b = (uint32_t)m.of->body;
    const vec3 now = vec_of(w->rigid.states[b].position);
    for (uint32_t p = (uint32_t)w->params->attached; p < w->p.count; ++p) {
      const vec3 begin = vec_sub(vec_make(w->contact.start_x[p], w->contact.start_y[p], w->contact.start_z[p]), w->rigid.start[b]);
      const vec3 end = vec_sub(world_position(w, p), now);
      ++paths;
      passed += (uint32_t)(!at_edge(w, p) && touches(&m, begin, end));
    }
  }
}

/* Runs a scene and prints; splits move particles between substeps, so not with yarns. Returns faults. */
static uint32_t nothing_passes(const char *name, fixture *f, uint32_t ticks, const fray_input *inputs) {
  uint32_t faults = 0;
  watch_reset();
  for (uint32_t tick = 0; tick < ticks; ++tick) faults |= watch_tick(f, inputs != NULL ? &inputs[tick] : &fixture_idle);
  printf("figure meshes_%s %u ways, %u near a triangle, %u pass (asked: 0), %u begin elsewhere (asked: "
         "0), %u stopped, %u substeps jammed, faults 0x%02X\n",
         name, paths, near_paths, passed, broken, watched_work.mesh_pins, jams, faults);
  CHECK_EQ_INT(passed, 0);
  CHECK_EQ_INT(broken, 0);
  return faults;
}

#define SHEET(more) \
  "scene s\nrate 1000 Hz\nwoven { warps 24 wefts 24 spacing 12 /cm orientation horizontal tear off " more " }\n"

/* Reports these faults and no others. */
static void try_scene(const char *name, const char *text, uint32_t ticks, uint32_t faults) {
  fixture_scoped f = {0};
  fixture_text(&f, text);
  CHECK_EQ_INT(nothing_passes(name, &f, ticks, NULL), faults);
}

static void cloth_falls_on_meshes(void) {
  try_scene("box",
            SHEET("at 0 0.52 0 cm") "substeps 4\n"
            "mesh m { obj \"tests/scenes/meshes/box.obj\" at 0 0 0 cm }\n", 500, 0);
  try_scene("ball",
            SHEET("at 0 1.02 0 cm") "substeps 4\n"
            "mesh m { obj tests/scenes/meshes/ball.obj at 0 0 0 cm friction 0 }\n", 500, 0);
  try_scene("turned_sword",
            SHEET("at 0 0.7 0 cm") "substeps 4\n"
            "mesh m { obj tests/scenes/meshes/sword.obj rotate 80 deg about z at -2 0 0 cm }\n", 500, 0);
}

/* Yarns with a stiffness meet planes of meshes in their elastic steps, and meshes move in these. */
static void elastic_yarns_stay_in_front(void) {
  try_scene("stretch_box",
            SHEET("at 0 0.52 0 cm stretch 0.5 N") "substeps 4\n"
            "mesh m { obj \"tests/scenes/meshes/box.obj\" at 0 0 0 cm }\n", 300, 0);
  try_scene("stretch_plate",
            SHEET("at 0 0 0 cm stretch 0.5 N") "substeps 8\npin row top\n"
            "mesh m { obj tests/scenes/meshes/plate.obj at 0.7 1 0.3 cm move free mass 20 g "
            "velocity 30 -300 10 cm/s }\n", 100, 0);
  try_scene("stretch_slash",
            SHEET("at 0 0 0 cm stretch 0.5 N") "substeps 8\npin row top\n"
            "mesh m { obj tests/scenes/meshes/sword.obj friction 1 move path { 0 s -2 2 0 cm 0.01 s -2 2 0 "
            "cm 0.012 s 3 1.9 0 cm 0.03 s 3 2 1 cm 0.04 s -3 2 -1 cm } }\n", 80, 0);
}

/* 5 cm a tick; a slash draws links to twice their length, whose ends it lets pass. */
static void thrown_meshes_stay_in_front(void) {
  try_scene("thrown_ball",
            SHEET("at 0 0 0 cm thickness 0.002 cm") "substeps 24\npin row top\npin row bottom\n"
            "mesh m { obj tests/scenes/meshes/ball.obj unit 0.4 cm at 0 1 0 cm move free mass 20 g "
            "velocity 0 -5000 0 cm/s }\n", 120, FRAY_FAULT_OUT_OF_WORLD);
  try_scene("thrown_plate",
            SHEET("at 0 0 0 cm") "substeps 8\n"
            "mesh m { obj tests/scenes/meshes/plate.obj at 0.7 1 0.3 cm move free mass 200 g "
            "velocity 300 -3000 100 cm/s }\n", 60, FRAY_FAULT_OUT_OF_WORLD);
  try_scene("slash",
            SHEET("at 0 0 0 cm") "substeps 8\npin row top\n"
            "mesh m { obj tests/scenes/meshes/sword.obj friction 1 move path { 0 s -2 2 0 cm 0.01 s -2 2 0 "
            "cm 0.012 s 3 1.9 0 cm 0.03 s 3 2 1 cm 0.04 s -3 2 -1 cm } }\n", 80, FRAY_FAULT_CONTACT_UNRESOLVED);
}

/* A plate comes down on a sheet that lies on another one: there is less room than the cloth is thick. */
static void between_two_meshes(void) {
  fixture_scoped f = {0};
  fixture_text(&f, SHEET("at 0 0.1 0 cm thickness 0.05 cm") "substeps 4\nlimits { contacts 2000 }\n"
               "mesh low { obj tests/scenes/meshes/plate.obj at 0 0 0 cm }\n"
               "mesh high { obj tests/scenes/meshes/plate.obj move path { 0 s 0 1 0 cm 0.2 s 0 0.05 0 cm "
               "0.4 s 0.5 0.05 0 cm } }\n");
  const uint32_t faults = nothing_passes("press", &f, 450, NULL);
  CHECK_EQ_INT(faults & ~(uint32_t)FRAY_FAULT_CONTACT_UNRESOLVED, 0);
}

/* What is not looked at stands. */
static void pools_that_are_too_small(void) {
  try_scene("few_contacts",
            SHEET("at 0 0.52 0 cm") "substeps 4\nlimits { contacts 20 }\n"
            "mesh m { obj tests/scenes/meshes/box.obj at 0 0 0 cm }\n", 200, FRAY_FAULT_CONTACTS_FULL);
  try_scene("crowded",
            SHEET("at 0 0.2 0 cm") "substeps 1\n"
            "mesh m { obj tests/scenes/meshes/ball.obj unit 0.1 cm move path { 0 s -1 -1 -1 cm "
            "0.05 s -1 -1 -1 cm 0.051 s 1 1 1 cm 0.06 s 1 1 1 cm 0.061 s -1 -1 -1 cm } }\n", 100,
            FRAY_FAULT_MESH_QUERY_BUDGET | FRAY_FAULT_OUT_OF_WORLD);
}

/* Hands that shake meshes as fast as they may, through each other and a table: where two of them leave
 * no room for a particle, which is reported, it may pass one. */
static void hands_shake_meshes(void) {
  enum { TICKS = 400 };
  static fray_input inputs[TICKS];
  fixture_scoped f = {0};
  uint64_t seed = 5;
  int32_t at[3] = {0, 0, 0};
  for (uint32_t tick = 0; tick < TICKS; ++tick) {
    inputs[tick].has_pose = 3;
    inputs[tick].command = tick == 20 ? FRAY_COMMAND_START : FRAY_COMMAND_NONE;
    for (uint32_t n = 0; n < 3 && tick > 60; ++n)
      at[n] = fx_clamp(at[n] + (int32_t)(splitmix64(&seed) % 2001u) - 1000, -9000, 9000);
    for (uint32_t h = 0; h < 2; ++h) {
      inputs[tick].pose[h].counter = (uint8_t)(tick & 15u);
      inputs[tick].pose[h].x = (int16_t)(h == 0 ? at[0] : at[1]);
      inputs[tick].pose[h].y = (int16_t)(h == 0 ? at[1] : at[2]);
      inputs[tick].pose[h].z = (int16_t)(h == 0 ? at[2] : at[0]);
    }
  }
  fixture_text(&f, SHEET("at 0 0 0 cm") "substeps 8\nhands { speed 50 m/s }\n"
               "mesh l { obj tests/scenes/meshes/sword.obj at -0.5 4.5 0 cm move hand left }\n"
               "mesh r { obj tests/scenes/meshes/box.obj unit 0.5 cm at 0.7 0.6 0 cm move hand right }\n"
               "mesh table { obj tests/scenes/meshes/plate.obj at 0 -0.5 0 cm }\n");
  (void)nothing_passes("hands", &f, TICKS, inputs);
  CHECK(jams < TICKS * 8 / 20);
}

int main(void) {
  TEST(cloth_falls_on_meshes);
  TEST(elastic_yarns_stay_in_front);
  TEST(thrown_meshes_stay_in_front);
  TEST(between_two_meshes);
  TEST(pools_that_are_too_small);
  TEST(hands_shake_meshes);
  return test_end();
}
