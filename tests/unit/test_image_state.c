/* SPDX-License-Identifier: Apache-2.0 */
/* Images whose state no scene reaches, their hashes put right: each field is refused past its range, and at its
 * limits is a world that runs, stays within what the loader takes, and opens again after every save. Under
 * FRAY_CHECKED no sum of theirs leaves its type. */
#include "rt/state/yarn_touch.h"
#include "tests/lib/hostile_run.h"
#include "tests/lib/image_mend.h"
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"

enum { IN_PARAMS = 1, IN_STATE = 2, IN_LINKS = 3, IN_X = 12, IN_VX = 15, IN_BODY_STATES = 26, IN_AREA = 39, IN_U = 42, IN_V = 43, IN_MATERIALS = 45, IN_MEMBRANE = 46,
       IN_STIFFNESS = 47, IN_BEND_STATES = 53, TICKS = 60, WORK_MAX = 1 << 24 };

static void patch(fixture *f, uint32_t section, uint32_t word, int32_t value) {
  bytes_store32(image_mend_section(f->image, section) + 4 * word, (uint32_t)value);
}

static fray_status open_patched(fixture *f, fray_error *error) {
  return image_mend_open(f->image, f->image_bytes, f->memory, f->memory_bytes, &f->w, error);
}

/* It is accepted, and runs. */
static void check_runs(fixture *f) {
  fray_error error = {FRAY_OK, 0, 0, ""};
  CHECK_EQ_INT(open_patched(f, &error), FRAY_OK);
  if (f->w == NULL) printf("  section %u, element %u: %s\n", error.section, error.index, error.what);
  else (void)hostile_run(f->w, TICKS, WORK_MAX, 1, FRAY_KERNEL_SCALAR, 7);
}

/* ---- fields past their ranges ---- */

static void stiffness_that_no_triangle_has(void) {
  fixture_scoped f = {0};
  const int32_t half = STRAIN_ONE / 2;
  const struct {
    uint32_t section, word;
    int32_t value;
    int is_good;
  } cases[] = {{IN_STIFFNESS, 0, -half, 1},
               {IN_STIFFNESS, 0, -half - 1, 0},
               {IN_STIFFNESS, 0, -STRAIN_MAX, 0},
               {IN_STIFFNESS, 1, -half - 1, 0},
               {IN_STIFFNESS, 1, STRAIN_MAX, 1},
               {IN_STIFFNESS, 2, -STRAIN_MAX, 1},
               {IN_STIFFNESS, 3, -half - 1, 0},
               {IN_STIFFNESS, 4, -half, 1},
               {IN_STIFFNESS, 4, STRAIN_MAX + 1, 0},
               {IN_STIFFNESS, 5, STRAIN_MAX, 1},
               {IN_STIFFNESS, 6, -1, 0},
               {IN_STIFFNESS, 6, 0, 1},
               {IN_STIFFNESS, 9, MATERIAL_STIFF_MAX, 1},
               {IN_STIFFNESS, 9, MATERIAL_STIFF_MAX + 1, 0},
               {IN_STIFFNESS, 10, -MATERIAL_ENERGY_MAX, 1},
               {IN_STIFFNESS, 10, -MATERIAL_ENERGY_MAX - 1, 0},
               {IN_STIFFNESS, 10, MATERIAL_ENERGY_MAX, 1},
               {IN_STIFFNESS, 10, MATERIAL_ENERGY_MAX + 1, 0},
               {IN_BEND_STATES, 3, -1, 0},
               {IN_BEND_STATES, 4, BEND_HABIT_MAX, 1},
               {IN_BEND_STATES, 4, BEND_HABIT_MAX + 1, 0},
               {IN_BEND_STATES, 5, -1, 0},
               {IN_BEND_STATES, 5, BEND_ONE, 1},
               {IN_BEND_STATES, 5, BEND_ONE + 1, 0},
               {IN_BEND_STATES, 6, -BEND_ENERGY_MAX, 1},
               {IN_BEND_STATES, 6, -BEND_ENERGY_MAX - 1, 0},
               {IN_BEND_STATES, 6, BEND_ENERGY_MAX, 1},
               {IN_BEND_STATES, 6, BEND_ENERGY_MAX + 1, 0}};
  fixture_file(&f, "tests/fuzz/seeds/membrane.scene", NULL);
  for (uint32_t n = 0; n < sizeof cases / sizeof cases[0]; ++n) {
    fray_error error = {FRAY_OK, 0, 0, ""};
    uint8_t *place = image_mend_section(f.image, cases[n].section) + 4 * cases[n].word;
    const uint32_t was = bytes_load32(place);
    patch(&f, cases[n].section, cases[n].word, cases[n].value);
    CHECK_EQ_INT(open_patched(&f, &error), cases[n].is_good ? FRAY_OK : FRAY_BAD_FIELD);
    if (cases[n].is_good) hostile_look(f.w);
    else CHECK_EQ_INT(error.section, cases[n].section);
    bytes_store32(place, was);
  }
}

static void classes_of_a_shear_lock(void) {
  enum { WORDS = sizeof(link_class) / 4 };
  fixture_scoped f = {0};
  fixture_file(&f, "tests/scenes/small.scene", "  bend ", "  shear_lock 45 deg\n  bend ", NULL);
  CHECK_EQ_INT(f.w->capacity[POOL_LINK_CLASSES], CLASSES_WITH_LOCK);
  for (uint32_t word = CLASS_LOCK * WORDS; word < CLASSES_WITH_LOCK * WORDS; ++word) {
    fray_error error = {FRAY_OK, 0, 0, ""};
    uint8_t *place = image_mend_section(f.image, IN_LINKS) + 4 * word;
    const uint32_t was = bytes_load32(place);
    bytes_store32(place, was + 1);
    CHECK_EQ_INT(open_patched(&f, &error), FRAY_BAD_FIELD);
    CHECK_EQ_INT(error.section, IN_LINKS);
    CHECK_EQ_INT(error.index, CLASS_LOCK);
    bytes_store32(place, was);
  }
  check_runs(&f);
  CHECK_EQ_INT(f.w->capacity[POOL_BEND_SHEAR_CLASSES], CLASS_SHEAR + 1);
}

/* The law of an isotropic sheet is asked for before the range of its words. */
static void stiffness_beyond_its_type(void) {
  static const int32_t shears[] = {1 << 30, INT32_MAX, INT32_MIN}, others[] = {INT32_MIN, INT32_MAX};
  for (uint32_t n = 0; n < 3; ++n)
    for (uint32_t k = 0; k < 2; ++k) {
      fixture_scoped f = {0};
      fray_error error = {FRAY_OK, 0, 0, ""};
      fixture_file(&f, "tests/fuzz/tiny/isotropic.seed", NULL);
      for (uint32_t r = 0; r < MATERIAL_ROWS; ++r) {
        const uint32_t row = (uint32_t)(offsetof(material_table, stretch) / 4) + r * MATERIAL_ENTRIES;
        patch(&f, IN_MATERIALS, row + 1, others[k]);
        patch(&f, IN_MATERIALS, row + 3, shears[n]);
      }
      CHECK_EQ_INT(open_patched(&f, &error), FRAY_BAD_FIELD);
      CHECK_EQ_INT(error.section, IN_MATERIALS);
    }
}

/* ---- fields at their limits ---- */

/* What a device was given saturates, whatever an image says that it was. */
static void energies_of_handles_saturate(void) {
  static const int64_t given[] = {INT64_MAX, INT64_MIN, INT64_MAX / 2, -INT64_MAX / 2};
  for (uint32_t n = 0; n < 4; ++n) {
    fixture_scoped f = {0};
    fixture_file(&f, "tests/fuzz/tiny/two_handles.seed", NULL);
    for (uint32_t h = 0; h < FRAY_HANDS; ++h)
      for (uint32_t word = 0; word < 6; ++word)
        patch(&f, IMAGE_HANDLE_STATES, h * HANDLE_STATE_WORDS + (uint32_t)(offsetof(handle_state, given) / 4) + word,
              (int32_t)(uint32_t)((uint64_t)given[n] >> (word & 1u) * 32u));
    check_runs(&f);
    fray_error error = {FRAY_OK, 0, 0, ""};
    CHECK_EQ_INT(open_patched(&f, &error), FRAY_OK);
    (void)fixture_tick(&f, &fixture_idle);
    for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
      const int64_t sum = (int64_t)state_pair(f.w->handles.states[h].given);
      CHECK(sum >= -(INT64_MAX / 4) && sum <= INT64_MAX / 4 && (sum < 0) == (given[n] < 0));
    }
  }
}

/* A force of many steps for a unit of impulse. */
static void forces_of_handles_with_every_shift(void) {
  for (int32_t shift = 1; shift <= 62; shift += shift < 12 ? 1 : 10) {
    fixture_scoped f = {0};
    fixture_file(&f, "tests/fuzz/tiny/two_handles.seed", NULL);
    patch(&f, IN_PARAMS, offsetof(params, force_shift) / 4, shift);
    patch(&f, IN_PARAMS, offsetof(params, force_gain) / 4, 1 << 23);
    check_runs(&f);
  }
}

/* Its path of a tick ends in the world, as those of the vertices do. */
static void a_free_blade_as_fast_as_a_word_says(void) {
  for (uint32_t n = 0; n < 6; ++n) {
    fixture_scoped f = {0};
    fixture_file(&f, "tests/fuzz/tiny/held_blade.seed", NULL);
    patch(&f, IN_PARAMS, offsetof(params, substeps) / 4, 64);
    patch(&f, IN_BODY_STATES, (uint32_t)(offsetof(body_state, velocity) / 4) + n % 3, n < 3 ? INT32_MAX : -INT32_MAX);
    check_runs(&f);
  }
}

/* Eight worlds of each scene, their vertices thrown anywhere by `place`. */
static void check_thrown(const char *const scenes[2], int32_t (*place)(uint64_t *draws)) {
  for (uint32_t n = 0; n < 2; ++n)
    for (uint32_t seed = 0; seed < 8; ++seed) {
      fixture_scoped f = {0};
      uint64_t draws = seed;
      fixture_file(&f, scenes[n], NULL);
      for (uint32_t axis = 0; axis < 3; ++axis)
        for (uint32_t p = 0; p < f.w->capacity[POOL_PARTICLES]; ++p) patch(&f, IN_X + axis, p, place(&draws));
      check_runs(&f);
    }
}

static int32_t within_a_unit(uint64_t *draws) { return (int32_t)(hostile_draw(draws, 9) * FX_LU / 4) - FX_LU; }
static int32_t at_an_edge(uint64_t *draws) { return hostile_draw(draws, 2) != 0 ? 62 * FX_LU : -62 * FX_LU; }

/* Triangles are drawn to the largest strain on one side, and pressed to a line on the other. */
static void isotropic_sheets_at_their_limits(void) {
  static const char *const scenes[] = {"tests/fuzz/tiny/isotropic.seed", "tests/fuzz/tiny/many_cracks.seed"};
  check_thrown(scenes, within_a_unit);
}

static void places_at_the_edge_with_self_collision(void) {
  static const char *const scenes[] = {"tests/fuzz/seeds/yarn_collision.scene", "tests/fuzz/seeds/triangle_collision.scene"};
  check_thrown(scenes, at_an_edge);
}

/* Curves of yarns swing beyond the world by a little: the gap between two is of 33 bits before it is clamped. */
static void yarns_at_opposite_edges(void) {
  const yarn_contact c = {.offset = {0}};
  yarn_touch touch = {.gap = {0, 0, 0}};
  touch.spot[FRAY_WARP].at = vec_make(65 * FX_LU, -65 * FX_LU, FX_LU / 8);
  touch.spot[FRAY_WEFT].at = vec_make(-65 * FX_LU, 65 * FX_LU, 0);
  const vec3 gap = yarn_touch_gap(&touch, &c);
  CHECK(gap.x == YARN_GAP_MAX && gap.y == -YARN_GAP_MAX && gap.z == FX_LU / 8);
}

/* Triangles as large as they count, at speeds that no air has. */
static void gales(void) {
  for (uint32_t seed = 0; seed < 16; ++seed) {
    fixture_scoped f = {0};
    uint64_t draws = seed;
    fixture_file(&f, "tests/fuzz/seeds/membrane.scene", NULL);
    for (uint32_t n = 0; n < 3; ++n) {
      patch(&f, IN_MEMBRANE, offsetof(membrane_params, wind) / 4 + n, hostile_draw(&draws, 2) != 0 ? MAX_WIND : -MAX_WIND);
      for (uint32_t p = 0; p < f.w->capacity[POOL_PARTICLES]; ++p) {
        patch(&f, IN_X + n, p, (int32_t)(hostile_draw(&draws, 17) * FX_LU) - 8 * FX_LU);
        patch(&f, IN_VX + n, p, hostile_draw(&draws, 2) != 0 ? FX_SPEED_MAX : -FX_SPEED_MAX);
      }
    }
    check_runs(&f);
  }
}

/* Their gains are near 0, and they owe the most. */
static void triangles_that_have_hardly_any_area(void) {
  for (int32_t area = 1; area < 12; ++area) {
    fixture_scoped f = {0};
    fixture_file(&f, "tests/fuzz/seeds/blades.scene", NULL);
    for (uint32_t t = 0; t < triangles_in_use(f.w); ++t) {
      patch(&f, IN_AREA, t, area);
      patch(&f, IN_STIFFNESS, STIFFNESS_STATE_WORDS * t + STIFFNESS_STATE_WORDS - 1, MATERIAL_ENERGY_MAX);
    }
    check_runs(&f);
  }
}

/* Two edges as long as the rest plane are added up where a tear is looked for. */
static void triangles_as_large_as_the_rest_plane(void) {
  const int32_t most = 32 * FX_LU - 1;
  fray_error error = {FRAY_OK, 0, 0, ""};
  for (int32_t shorter = 0; shorter < 8; ++shorter) {
    fixture_scoped f = {0};
    fixture_file(&f, "tests/fuzz/tiny/membrane_balls.seed", NULL);
    for (uint32_t p = 0; p < f.w->p.count; ++p)
      patch(&f, IN_V, p, f.w->trimesh.v[p] > 0 ? most - shorter * (int32_t)p : -most);
    check_runs(&f);
  }
  for (uint32_t section = IN_U; section <= IN_V; ++section) {
    fixture_scoped f = {0};
    fixture_file(&f, "tests/fuzz/seeds/membrane.scene", NULL);
    patch(&f, section, 0, most + 1);
    CHECK_EQ_INT(open_patched(&f, &error), FRAY_BAD_FIELD);
    CHECK_EQ_INT(error.section, section);
  }
}

static void counts_of_tears_saturate(void) {
  static const char *const scenes[] = {"tests/fuzz/seeds/woven.scene", "tests/fuzz/seeds/membrane.scene",
                                       "tests/fuzz/seeds/blades.scene"};
  for (uint32_t n = 0; n < 3; ++n)
    for (int32_t below = 0; below < 2; ++below) {
      const int32_t most[2] = {MAX_SPRINGS, INT32_MAX};
      fixture_scoped f = {0};
      fixture_file(&f, scenes[n], NULL);
      patch(&f, IN_STATE, offsetof(state, tears_total) / 4, most[below] - 1);
      check_runs(&f);
      CHECK(f.w != NULL && f.w->state->tears_total > most[0]);
      if (below != 0) CHECK_EQ_INT(f.w->state->tears_total, INT32_MAX);
    }
}

/* ---- scenes that leave their ranges ---- */

static int is_within(const int32_t *v, uint32_t count, int32_t most) {
  for (uint32_t n = 0; n < count; ++n)
    if (v[n] < -most || v[n] > most) return 0;
  return 1;
}

/* Saved and opened after every tick. */
static void check_saves(fixture *f, uint32_t ticks) {
  uint32_t refused = 0;
  uint32_t fast = 0;
  for (uint32_t tick = 0; tick < ticks; ++tick) {
    (void)fixture_tick(f, &fixture_idle);
    const size_t bytes = fray_save_bytes(f->w);
    uint8_t *saved = malloc(bytes);
    hostile_world again;
    fray_error error = {FRAY_OK, 0, 0, ""};
    if (saved == NULL) fixture_give_up("check_saves", "out of memory");
    (void)fray_save(f->w, saved, bytes);
    if (hostile_open(&again, saved, bytes, &error) != FRAY_OK) {
      if (refused++ == 0)
        printf("  tick %u: section %u, element %u: expected %s\n", tick, error.section, error.index, error.what);
      free(saved);
      continue;
    }
    hostile_close(&again);
    const fray_particles p = fray_view_particles(f->w);
    fast += !is_within(p.vx, p.count, FX_SPEED_MAX) || !is_within(p.vy, p.count, FX_SPEED_MAX) ||
            !is_within(p.vz, p.count, FX_SPEED_MAX);
  }
  CHECK_EQ_INT(refused, 0);
  CHECK_EQ_INT(fast, 0);
}

static void a_body_that_leaps_with_held_particles(void) {
  fixture_scoped f = {0};
  fixture_text(&f, "scene leap\nsubsteps 4\nwoven { warps 6 wefts 6 spacing 12 /cm }\n"
                   "sphere h { radius 0.2 cm at 0 0 0 cm attach_within 0.1 cm\n"
                   " move path { 0 s 0 0 0 cm 0.005 s 0 0 0 cm 0.006 s 20 0 0 cm } }\n");
  check_saves(&f, 20);
}

static void held_yarns_that_leap_slide_on(void) {
  fixture_scoped f = {0};
  fixture_file(&f, "tests/determinism/frayed.scene", "0.5 s 1.3417 0.1 0.05 cm",
               "0.15 s 0.78 0.03 0.01 cm 0.151 s 50 0.1 0.05 cm", NULL);
  check_saves(&f, 160);
}

/* From one end of the world to the other in a substep, and back, with cloth inside. */
static void bodies_that_leap_through_the_world(void) {
  static const char *const cloths[] = {
      "woven { warps 4 wefts 4 spacing 12 /cm at 57 0.1 0 cm tear 5 10 % yarns on self_collision on }",
      "membrane { columns 3 rows 3 cell 1 cm at 57 0.1 0 cm material m self_collision on }\n"
      "material m { base t-shirt tear 5 N/m }"};
  for (uint32_t n = 0; n < 2; ++n) {
    fixture_scoped f = {0};
    scene_error error;
    char text[2048];
    snprintf(text, sizeof text,
             "scene leap\nsubsteps 1\n%s\n"
             "sphere s { radius 15 cm friction 0.5 at -59 0 0 cm move path { 0 s -59 0 0 cm 0.005 s -59 0 0 cm\n"
             " 0.006 s 59 0 0 cm 0.007 s -59 0 0 cm 0.008 s 59 0 0 cm } }\n"
             "plane g { at 0 -48 0 cm rotate 30 deg about z friction 0.5 move path { 0 s 0 -48 0 cm 0.01 s 0 -48 0 cm\n"
             " 0.011 s 0 48 0 cm 0.012 s 0 -48 0 cm 0.013 s 0 48 0 cm } }\n"
             "mesh m { obj \"../scenes/meshes/box.obj\" unit 8 cm at 0 0 50 cm move path { 0 s 0 0 50 cm 0.015 s 0 0 50 cm\n"
             " 0.016 s 50 0 -50 cm 0.017 s -50 0 50 cm } }\n", cloths[n]);
    if (!fixture_compile(&f, "tests/unit/leap.scene", text, &error)) fixture_give_up("leap", error.message);
    fixture_open_image(&f);
    check_saves(&f, 40);
    check_runs(&f);
  }
}

/* ---- what opening costs ---- */

/* Pools of one tick at their limits, that no section bounds: opening writes what the image is long, no more. */
static void check_written(const char *path, uint32_t pool, uint32_t capacity) {
  enum { TIMES = 32 };
  fixture_scoped f = {0};
  fray_error error = {FRAY_OK, 0, 0, ""};
  size_t needed = 0;
  fixture_file(&f, path, NULL);
  bytes_store32(f.image + 4 * (IMAGE_CAPACITY_WORD + POOL_CONTACTS), MAX_CONTACTS);
  bytes_store32(f.image + 4 * (IMAGE_CAPACITY_WORD + pool), capacity);
  image_mend_crc(f.image, f.image_bytes);
  CHECK_EQ_INT(fray_memory_size(f.image, f.image_bytes, &needed, &error), FRAY_OK);
  CHECK(needed / 4096 > f.image_bytes);
  uint8_t *memory = aligned_alloc(FRAY_ALIGN, needed);
  fray_world *w = NULL;
  if (memory == NULL) fixture_give_up("check_written", "out of memory");
  memset(memory, 0xA5, needed);
  CHECK_EQ_INT(fray_open(f.image, f.image_bytes, memory, needed, &w, &error), FRAY_OK);
  size_t written = 0;
  for (size_t n = 0; n < needed; ++n) written += memory[n] != 0xA5;
  printf("  %zu bytes ask for %zu, of which %zu are written\n", f.image_bytes, needed, written);
  CHECK(written < TIMES * f.image_bytes);
  if (w != NULL) (void)hostile_run(w, TICKS, WORK_MAX, 1, FRAY_KERNEL_SCALAR, 7);
  free(memory);
}

static void opening_writes_what_the_image_is_long(void) {
  check_written("tests/fuzz/seeds/woven.scene", POOL_CONTACTS, MAX_CONTACTS);
  check_written("tests/fuzz/seeds/yarn_collision.scene", POOL_YARN_PAIRS, MAX_YARN_PAIRS);
  check_written("tests/fuzz/seeds/triangle_collision.scene", POOL_TRIANGLE_PAIRS, MAX_YARN_PAIRS);
}

int main(void) {
  TEST(stiffness_that_no_triangle_has);
  TEST(classes_of_a_shear_lock);
  TEST(stiffness_beyond_its_type);
  TEST(energies_of_handles_saturate);
  TEST(forces_of_handles_with_every_shift);
  TEST(a_free_blade_as_fast_as_a_word_says);
  TEST(isotropic_sheets_at_their_limits);
  TEST(places_at_the_edge_with_self_collision);
  TEST(yarns_at_opposite_edges);
  TEST(gales);
  TEST(triangles_that_have_hardly_any_area);
  TEST(triangles_as_large_as_the_rest_plane);
  TEST(counts_of_tears_saturate);
  TEST(a_body_that_leaps_with_held_particles);
  TEST(held_yarns_that_leap_slide_on);
  TEST(bodies_that_leap_through_the_world);
  TEST(opening_writes_what_the_image_is_long);
  return test_end();
}
