/* SPDX-License-Identifier: Apache-2.0 */
/* Save at tick k, load, go on: the same hash after every tick; and the same image from both worlds.
 * The topology's hash that cuts keep up to date is the one recomputed from all rows. */
#include "rt/image/state_hash.h"
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"

enum { AFTER = 200, SAVES_MAX = 8 };

/* Hands apart and a little up and down, so that poses, forces and ramps are in the state. */
static fray_input drive(const fixture *f, uint32_t tick) {
  const int32_t out = tick < 20 ? 0 : (int32_t)(tick - 20) * 25;
  const int32_t wave = (int32_t)(tick % 64) * 10;
  const int32_t at[FRAY_HANDS][3] = {{-out, wave, out / 3}, {out, -wave, out / 3}};
  fray_input input = fixture_poses(f, at, tick);
  if (tick == 0) input.command = FRAY_COMMAND_START;
  if (tick % 97 == 96) input.has_pose = 0;
  return input;
}

/* From a save of `f` as it is, both go on for AFTER ticks. Returns the ticks that differ. */
static uint32_t go_on(const fixture *f, uint32_t tick) {
  fixture_scoped one = {0};
  fixture other;
  uint32_t bad = 0;
  fixture_copy(&one, f);
  fixture_copy(&other, &one);
  CHECK_EQ_INT(fray_hash(one.w) == fray_hash(f->w), 1);
  CHECK_EQ_INT(state_hash(one.w) == state_hash(f->w), 1);
  CHECK(one.image_bytes == other.image_bytes &&
        memcmp(one.image, other.image, one.image_bytes) == 0);
  for (uint32_t n = 0; n < AFTER; ++n) {
    const fray_input input = drive(f, tick + n);
    const fray_output a = fixture_tick(&one, &input);
    /* saved and loaded again after every 16th tick */
    if (n % 16 == 15) {
      fixture again;
      fixture_copy(&again, &other);
      fixture_close(&other);
      other = again;
    }
    const fray_output b = fixture_tick(&other, &input);
    bad += a.hash != b.hash || memcmp(a.force, b.force, sizeof a.force) != 0 ||
           a.tears_total != b.tears_total;
  }
  fixture_close(&other);
  return bad;
}

static void check_scene(const char *label, fixture *f) {
  static const uint32_t at[] = {0, 1, 333};
  uint32_t saves = 0;
  uint32_t bad = 0;
  uint32_t torn_at = 0;
  uint32_t cuts = 0;
  uint64_t expected[1200];
  uint32_t late = 0;
  fixture_scoped start = {0};
  fixture_copy(&start, f);
  for (uint32_t tick = 0; tick < 1000; ++tick) {
    const int tearing = cuts > 4 && torn_at == 0;
    if (tearing) torn_at = tick;
    if (tick == at[saves < 3 ? saves : 2] || tearing) {
      bad += go_on(f, tick);
      if (!tearing) saves = saves < 2 ? saves + 1 : saves;
    }
    const fray_input input = drive(f, tick);
    const fray_output out = fixture_tick(f, &input);
    expected[tick] = out.hash;
    cuts = out.tears_total;
    CHECK(fixture_topology_holds(f->w));
    CHECK(out.hash == fray_hash(f->w));
  }
  /* the world that was never saved agrees with one opened from its save at tick 0 */
  for (uint32_t tick = 0; tick < 1000; ++tick) {
    const fray_input input = drive(&start, tick);
    late += fixture_tick(&start, &input).hash != expected[tick];
  }
  char name[64];
  char asked[64];
  snprintf(name, sizeof name, "save_%s_ticks_that_differ", label);
  snprintf(asked, sizeof asked, "0; saved at 0, 1, 333, %u; %u cuts", torn_at, cuts);
  figure(name, bad + late, "", asked);
  CHECK_EQ_INT(bad, 0);
  CHECK_EQ_INT(late, 0);
  CHECK(torn_at > 0);
  CHECK(cuts > 4);
  fixture_close(f);
}

static void a_small_sheet_goes_on_from_its_save(void) {
  fixture f;
  fixture_file(&f, "tests/scenes/small.scene", NULL);
  check_scene("small", &f);
}
static void a_mirrored_sheet_goes_on_from_its_save(void) {
  fixture f;
  fixture_file(&f, "tests/scenes/mirror.scene", NULL);
  check_scene("mirror", &f);
}
/* Free body, contacts, friction, relative damping. */
static void a_sheet_with_a_ball_goes_on_from_its_save(void) {
  fixture f;
  fixture_text(&f, "scene ball\nrate 1000 Hz\nsubsteps 6\niterations 1\nseed 3\n"
                   "woven {\n warps 24\n wefts 16\n spacing 12 /cm\n damping 3 /s\n}\n"
                   "pin column left\npin column right\n"
                   "sphere b {\n radius 0.3 cm\n at 0.1 0.1 1 cm\n move free\n mass 20 g\n"
                   " velocity 0 20 -200 cm/s\n}\nplane ground {\n at 0 -3 0 cm\n}\n");
  check_scene("ball", &f);
}

/* A body pushes the sheet against the edge of the world: what is saved there can be opened. */
static void what_is_saved_at_the_edge_opens(void) {
  fixture_scoped f = {0};
  uint32_t saves = 0;
  fixture_text(&f,
               "scene edge\nrate 1000 Hz\nsubsteps 4\n"
               "woven {\n warps 8\n wefts 8\n spacing 12 /cm\n at 50 0 0 cm\n tear off\n}\n"
               "box pusher {\n size 10 20 20 cm\n"
               " move path {\n 0 s 40 0 0 cm\n 0.4 s 59 0 0 cm\n }\n}\n");
  fray_output out;
  memset(&out, 0, sizeof out);
  for (uint32_t tick = 0; tick < 600; ++tick) {
    out = fixture_tick(&f, &fixture_idle);
    if (tick % 20 != 19) continue;
    fixture_scoped copy = {0};
    fixture_copy(&copy, &f);
    saves += fray_hash(copy.w) == out.hash;
  }
  figure("save_at_the_edge", saves, "of 30 saves", "all open");
  CHECK_EQ_INT(saves, 30);
  CHECK((out.faults & FRAY_FAULT_OUT_OF_WORLD) != 0);
}

int main(void) {
  TEST(a_small_sheet_goes_on_from_its_save);
  TEST(a_mirrored_sheet_goes_on_from_its_save);
  TEST(a_sheet_with_a_ball_goes_on_from_its_save);
  TEST(what_is_saved_at_the_edge_opens);
  return test_end();
}
