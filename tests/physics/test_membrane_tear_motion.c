/* SPDX-License-Identifier: Apache-2.0 */
/* Membranes that tear in motion: whole after every tick, the same when saved in the middle, torn
 * across the load, at the load that their strength says, and at rest below it. */
#include "tests/lib/test.h"

#include "tests/lib/trimesh_check.h"
#include "tests/lib/world_fixture.h"

static const char *const meshes[] = {"regular", "rotated 30 deg", "irregular 3"};

/* Held at its left, drawn at its right; heavily damped, so that the load comes on without a wave. */
static void open_strip(fixture *f, uint32_t columns, const char *mesh, double drag, double load,
                       const char *more) {
  fixture_print(f,
                "scene strip\nrate 1000 Hz\nsubsteps 1\ngravity 0 0 0 cm/s2\nmembrane {\n columns %u\n rows 10\n"
                " cell 1 cm\n pattern %s\n material weak\n drag %g /s\n}\nmaterial weak {\n density 0.02 g/cm2\n"
                " isotropic 1000 N/m 0\n tear 12 N/m\n tear_interval 2 ms\n}\npin column left\n"
                "load right %.9f 0 0 N/m\n%s",
                columns, mesh, drag, load, more);
}

/* Length of what is torn, along u and along v, lu. */
static void torn_length(const fray_world *w, double *along_u, double *along_v) {
  const trimesh *s = &w->trimesh;
  *along_u = *along_v = 0;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t)
    for (uint32_t k = 0; k < 3; ++k) {
      if (trimesh_mark_of(s, t, k) != TRIMESH_TORN) continue;
      const uint32_t a = s->triangle[t].v[trimesh_next(k)], b = s->triangle[t].v[trimesh_previous(k)];
      *along_u += fabs((double)s->u[a] - s->u[b]) / FX_LU / 2;
      *along_v += fabs((double)s->v[a] - s->v[b]) / FX_LU / 2;
    }
}

/* Momentum between two ticks is what loads and holds made of it; so it is looked at before and after the
 * stage alone, by a world that is ticked up to there. */
static void it_is_whole_after_every_tick(void) {
  for (uint32_t n = 0; n < 3; ++n) {
    fixture_scoped f = {0};
    trimesh_check k;
    uint32_t wrong = 0, over = 0;
    fray_output out = {0};
    open_strip(&f, 16, meshes[n], 5, 14, "");
    const fray_work most = fray_work_bound(f.w);
    trimesh_check_open(&k, f.w);
    for (uint32_t tick = 0; tick < 300; ++tick) {
      const uint32_t before = (uint32_t)f.w->state->tears_total;
      out = fixture_tick(&f, &fixture_idle);
      over += !fixture_within_bound(&out.work, &most);
      wrong += out.work.tears > 1 || out.tears_total != before + out.work.tears;
      int64_t momentum[3];
      uint64_t area;
      trimesh_check_sums(f.w, &area, momentum);
      memcpy(k.momentum, momentum, sizeof momentum);
      trimesh_check_now(&k, f.w);
    }
    CHECK_EQ_INT(k.bad, 0);
    CHECK_EQ_INT(wrong, 0);
    CHECK_EQ_INT(over, 0);
    CHECK(out.tears_total > 20);
    printf("figure sheet_%s_tears %u triangles %d of %d\n", meshes[n], out.tears_total,
           f.w->trimesh.state->triangles, f.w->trimesh.params->triangles);
  }
}

static void it_goes_on_as_it_was_saved(void) {
  uint32_t different = 0, saves = 0;
  fixture_scoped f = {0};
  open_strip(&f, 16, "irregular 3", 5, 14, "");
  fixture other;
  fixture_copy(&other, &f);
  for (uint32_t tick = 0; tick < 300; ++tick) {
    const fray_output a = fixture_tick(&f, &fixture_idle);
    const fray_output b = fixture_tick(&other, &fixture_idle);
    different += a.hash != b.hash || a.tears_total != b.tears_total || a.faults != b.faults;
    if (b.work.tears == 0 && tick % 16 != 0) continue;
    fixture again; /* after every tear, while the cloth rests */
    fixture_copy(&again, &other);
    fixture_close(&other);
    other = again;
    ++saves;
  }
  CHECK_EQ_INT(different, 0);
  CHECK(saves > 40);
  fixture_close(&other);
}

/* The least load that tears a sheet that has come to rest under it. */
static double load_at_tear(const char *mesh) {
  double low = 11, high = 14;
  while (high - low > 0.02) {
    const double load = (low + high) / 2;
    fixture f;
    uint32_t torn = 0;
    open_strip(&f, 40, mesh, 1000, load, ""); /* long, so that it does not swing */
    f.w->trimesh.state->tear_cooldown[0] = 250; /* it may not tear before */
    for (uint32_t tick = 0; tick < 300 && torn == 0; ++tick) torn = fixture_tick(&f, &fixture_idle).tears_total;
    fixture_close(&f);
    if (torn != 0)
      high = load;
    else
      low = load;
  }
  return high;
}

/* Without a Poisson's ratio the stress is the same everywhere. A load T on a rest length is F S, with S
 * the stress, E (F^2 - 1) / 2, so at S = 12 N/m it is 12.143. */
static void it_tears_at_its_strength(void) {
  for (uint32_t n = 0; n < 3; n += TEST_FEWER) {
    const double load = load_at_tear(meshes[n]);
    printf("figure sheet_%s_load_at_tear %.3f N/m (strength 12)\n", meshes[n], load);
    CHECK(load > 12.143 * 0.99 && load < 12.143 * 1.01);
  }
}

static void torn_across(const char *mesh, double *u, double *v) {
  fixture_scoped f = {0};
  open_strip(&f, 40, mesh, 1000, 12.7, "");
  for (uint32_t tick = 0; tick < 300 && f.w->state->tears_total < 12; ++tick)
    (void)fixture_tick(&f, &fixture_idle);
  torn_length(f.w, u, v);
}

/* The load is along the weft. A dozen tears of one turned mesh are few: they go by where its triangles are, so
 * those are counted together. */
static void it_tears_across_the_load(void) {
  double u, v;
  double turned[2] = {0, 0};
  for (uint32_t n = 0; n < 3; n += 2) {
    torn_across(meshes[n], &u, &v);
    printf("figure sheet_%s_torn %.2f lu along the load, %.2f across (asked: 2 times)\n", meshes[n], u, v);
    CHECK(v > 2 * u);
  }
  for (uint32_t angle = 10; angle <= 80; angle += 10 * TEST_FEWER) {
    char mesh[32];
    snprintf(mesh, sizeof mesh, "rotated %u deg", angle);
    torn_across(mesh, &u, &v);
    turned[0] += u;
    turned[1] += v;
  }
  printf("figure sheet_rotated_torn %.2f lu along the load, %.2f across (asked: 2.5 times)\n", turned[0], turned[1]);
  CHECK(turned[1] > 2.5 * turned[0]);
}

static void full_pools_end_in_a_flag(void) {
  static const struct {
    const char *limits;
    uint32_t flag;
  } cases[] = {{"limits {\n spare_particles 5\n}\n", FRAY_FAULT_PARTICLES_FULL},
               {"limits {\n spare_triangles 3\n}\n", FRAY_FAULT_TRIANGLES_FULL}};
  for (uint32_t n = 0; n < 2; ++n) {
    fixture_scoped f = {0};
    trimesh_check k;
    open_strip(&f, 16, "irregular 3", 5, 14, cases[n].limits);
    trimesh_check_open(&k, f.w);
    uint32_t flags = 0;
    for (uint32_t tick = 0; tick < 200; ++tick) flags |= fixture_tick(&f, &fixture_idle).faults;
    trimesh_check_sums(f.w, &k.area, k.momentum);
    trimesh_check_now(&k, f.w);
    CHECK_EQ_INT(k.bad, 0);
    CHECK((flags & cases[n].flag) != 0);
  }
}

int main(void) {
  TEST(it_is_whole_after_every_tick);
  TEST(it_goes_on_as_it_was_saved);
  TEST(it_tears_at_its_strength);
  TEST(it_tears_across_the_load);
  TEST(full_pools_end_in_a_flag);
  return test_end();
}
