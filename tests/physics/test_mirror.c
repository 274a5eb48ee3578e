/* SPDX-License-Identifier: Apache-2.0 */
/* A scene that is its own mirror image in x stays so to the last bit: crossing (i, j) at
 * (x, y, z) and crossing (warps - 1 - i, j) at (-x, y, z), velocities likewise, after every tick.
 * The cap on cuts must not bind: at a tie the mirror images would be told apart by number. */
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"

enum { TICKS = 5000 };

static uint32_t broken(const fray_world *w) {
  const uint32_t warps = (uint32_t)w->params->warps;
  uint32_t bad = 0;
  for (uint32_t j = 0; j < (uint32_t)w->params->wefts; ++j)
    for (uint32_t i = 0; i < (warps + 1) / 2; ++i) {
      const uint32_t a = w->woven.crossing_particle[j * warps + i];
      const uint32_t b = w->woven.crossing_particle[j * warps + warps - 1 - i];
      bad += w->p.x[a] != -w->p.x[b] || w->p.y[a] != w->p.y[b] || w->p.z[a] != w->p.z[b] ||
             w->p.vx[a] != -w->p.vx[b] || w->p.vy[a] != w->p.vy[b] || w->p.vz[a] != w->p.vz[b] ||
             w->p.rx[a] != -w->p.rx[b] || w->p.ry[a] != w->p.ry[b] || w->p.rz[a] != w->p.rz[b];
    }
  return bad;
}

static uint32_t broken_rows(const fray_world *w) {
  uint32_t bad = 0;
  for (uint32_t row = 0; row < (uint32_t)w->params->links; ++row) {
    const uint32_t twin = w->woven.spring_of[yarn_grid_mirror(world_yarn_grid(w), w->woven.canonical_id[row])];
    bad += (w->woven.spring_kind[row] == SPRING_DEAD) != (w->woven.spring_kind[twin] == SPRING_DEAD);
  }
  return bad;
}

static void run(const char *label, fixture *f) {
  uint32_t first_bad = TICKS;
  uint32_t touches = 0;
  fray_output out;
  char name[64];
  memset(&out, 0, sizeof out);
  CHECK_EQ_INT(broken(f->w), 0);
  for (uint32_t tick = 0; tick < TICKS; ++tick) {
    out = fixture_tick(f, &fixture_idle);
    for (uint32_t c = 0; c < f->w->contact.count; ++c) touches += f->w->contact.list[c].touching;
    if (broken(f->w) + broken_rows(f->w) != 0) {
      first_bad = tick;
      break;
    }
  }
  snprintf(name, sizeof name, "mirror_%s_ticks", label);
  figure(name, first_bad, "ticks", "5000 to the last bit");
  snprintf(name, sizeof name, "mirror_%s_cuts", label);
  figure(name, out.tears_total, "", "more than 0");
  snprintf(name, sizeof name, "mirror_%s_touches", label);
  figure(name, touches, "", "printed");
  CHECK_EQ_INT(first_bad, TICKS);
  CHECK(out.tears_total > 0);
  CHECK((out.faults & FRAY_FAULT_BREAK_BUDGET) == 0);
  fixture_close(f);
}

static void a_mirrored_scene_stays_mirrored(void) {
  fixture f;
  fixture_file(&f, "tests/scenes/mirror.scene", "gravity 0",
               "limits {\n tears_per_tick 64\n}\ngravity 0", NULL);
  run("balls_apart", &f);
}

/* A ball thrown in the plane of symmetry, at a sheet that its edges hold. */
static void and_with_a_ball_thrown_along_the_plane(void) {
  fixture f;
  fixture_file(&f, "tests/scenes/mirror.scene", "gravity 0",
               "limits {\n tears_per_tick 64\n}\npin column left\npin column right\n"
               "sphere thrown {\n radius 0.2 cm\n at 0 0.1 1 cm\n move free\n mass 5 g\n"
               " velocity 0 30 -150 cm/s\n}\nplane ground {\n at 0 -3 0 cm\n}\n"
               "gravity 0",
               "gather 10 % pleats 8", "gather 0 %", NULL);
  run("thrown_ball", &f);
}

/* Damping towards the rigid motion sums over the sheet and solves for its turning. */
static void and_with_damping(void) {
  fixture f;
  fixture_file(&f, "tests/scenes/mirror.scene", "gather 10 % pleats 8",
               "gather 10 % pleats 8\n  damping 2 /s", "gravity 0",
               "limits {\n tears_per_tick 64\n}\ngravity 0", NULL);
  run("damped", &f);
}

int main(void) {
  TEST(a_mirrored_scene_stays_mirrored);
  TEST(and_with_damping);
  TEST(and_with_a_ball_thrown_along_the_plane);
  return test_end();
}
