/* SPDX-License-Identifier: Apache-2.0 */
/* Membranes from text to world: meshes that are whole, materials, what is refused and where;
 * images with any bit flipped; save and restore; impulses that cancel. */
#include "tests/lib/test.h"

#include "rt/membrane/membrane.h"
#include "tests/lib/damage.h"

static const char small[] = "scene small\nwind 2 0 1 m/s\nmembrane {\n columns 3\n rows 2\n cell "
                            "1 cm\n pattern %s\n material %s\n"
                            " strain_limit 50 %%\n%s}\npin column left\nload right 1 0 0 N/m\n"
                            "limits { spare_particles 2 spare_triangles 2 contacts 4 }\n%s";

static void open_small(fixture *f, const char *mesh, const char *material, const char *inside,
                       const char *more) {
  fixture_print(f, small, mesh, material, inside, more);
}

/* Euler: vertices - sides + triangles of a disc is 1; areas add up to the rectangle. */
static void meshes_are_whole(void) {
  static const char *const meshes[] = {"regular", "rotated 30 deg", "rotated -17.5 deg",
                                       "irregular 1", "irregular 77"};
  for (size_t n = 0; n < sizeof meshes / sizeof meshes[0]; ++n) {
    fixture_scoped f = {0};
    fixture_print(&f,
                  "scene m\nmembrane {\n columns 20\n rows 13\n cell 0.7 1 cm\n pattern %s\n "
                  "material denim\n weft 20 deg\n}\n",
                  meshes[n]);
    const trimesh *s = &f.w->trimesh;
    const uint32_t triangles = (uint32_t)s->state->triangles;
    uint32_t border = 0;
    uint64_t area = 0;
    for (uint32_t t = 0; t < triangles; ++t) {
      area += s->area[t];
      for (uint32_t k = 0; k < 3; ++k) border += trimesh_neighbour(s, t, k) == TRIMESH_NONE;
    }
    CHECK_EQ_INT(f.w->p.count - (3 * triangles + border) / 2 + triangles, 1);
    CHECK_EQ_INT(border, 2 * (20 + 13));
    const double expected = 20 * 0.7 * 13 * 1 * pow(1e4 / f.facts.lu_um, 2) * (1 << 30);
    CHECK(fabs((double)area / expected - 1) < 1e-6);
    printf("figure mesh %s: %u triangles, %u inner steps (asked: printed)\n", meshes[n], triangles,
           f.facts.elastic_steps);
  }
}

static void expect_refusal(const char *text, int line, const char *words) {
  fixture_scoped f = {0};
  scene_error error;
  CHECK(!fixture_compile(&f, "t", text, &error));
  CHECK_EQ_INT(error.line, line);
  if (strstr(error.message, words) == NULL) CHECK_TEXT(error.message, words);
}

static void bad_text_is_refused(void) {
  expect_refusal("scene x\n", 1, "expected 'woven' or 'membrane'");
  expect_refusal("scene x\nmembrane {\n columns 4\n rows 4\n cell 1 cm\n material velvet\n}\n", 6,
                 "denim, t-shirt");
  expect_refusal("scene x\nmembrane {\n columns 4\n rows 4\n cell 1 cm\n}\n", 2,
                 "has no 'material'");
  expect_refusal("scene x\nmembrane {\n columns 0\n rows 4\n cell 1 cm\n material denim\n}\n", 3,
                 "expected 1 to 1000");
  expect_refusal("scene x\nmembrane {\n columns 4\n rows 4\n cell 0.1 1 cm\n material denim\n}\n",
                 5, "found 'cell 0.1 1 cm', expected two edges within a factor of 4");
  expect_refusal("scene x\nmembrane {\n columns 4\n rows 4\n cell 1 cm\n pattern rotated 30 deg\n "
                 "material denim\n}\npin crossing 1 1\n",
                 9, "row top");
  expect_refusal("scene x\nmaterial m { isotropic 100 N/m 0.3 }\nmembrane {\n columns 4\n rows "
                 "4\n cell 1 cm\n material m\n}\n",
                 2, "has no 'density'");
  expect_refusal("scene x\nmaterial m { density 100 g/m2 stretch all 10 20 10 5 N/m }\nmembrane "
                 "{\n columns 4\n rows 4\n cell 1 cm\n"
                 " material m\n}\n",
                 7, "positive definite");
  expect_refusal("scene x\nwind 1 0 0 m/s\nwoven {\n warps 4\n wefts 4\n spacing 12 /cm\n}\n", 2,
                 "expected it only with 'membrane'");
  expect_refusal("scene x\nwoven {\n warps 4\n wefts 4\n spacing 12 /cm\n}\nmembrane {\n columns "
                 "4\n rows 4\n cell 1 cm\n material denim\n}\n",
                 7, "expected one cloth in a scene");
  expect_refusal("scene x\nslit warp 1 0 1\nmembrane {\n columns 4\n rows 4\n cell 1 cm\n material "
                 "denim\n}\n",
                 2, "expected 'slit column' or 'slit row' for this cloth");
  expect_refusal("scene x\nmembrane {\n columns 4\n rows 4\n cell 1 cm\n material denim\n self_collision "
                 "on\n "
                 "self_thickness 0.5 cm\n}\n",
                 8,
                 "found 'self_thickness 0.5 cm', expected at most 0.353553 cm with 'self_collision', half of "
                 "the "
                 "least height of a triangle");
  expect_refusal("scene x\nmembrane {\n columns 4\n rows 4\n cell 1 cm\n material denim\n self_collision "
                 "yes\n}\n",
                 7, "expected off or on for 'self_collision'");
}

/* Vertices that a pin names hang from its body, however far it is. */
static void pins_by_a_body_hold(void) {
  fixture_scoped f = {0};
  fixture_print(&f, "scene x\nmembrane {\n columns 4\n rows 3\n cell 1 cm\n material denim\n}\n"
                    "pin row bottom\npin row top by b\nsphere b {\n radius 1 cm\n at 0 0 9 cm\n}\n");
  CHECK_EQ_INT(f.w->params->attached, 2 * 5);
  uint32_t by_ball = 0;
  for (uint32_t p = 0; p < 2 * 5; ++p) by_ball += f.w->p.attach_body[p] == 0;
  CHECK_EQ_INT(by_ball, 5);
}

/* What is stiffer than the steps allow is scaled by one factor, the square of the steps'. */
static void too_stiff_is_scaled(void) {
  fixture_scoped f = {0};
  open_small(&f, "regular", "paper", "", "");
  CHECK_EQ_INT(f.facts.elastic_steps * f.facts.substeps >= 64, 1);
  CHECK(f.facts.stiffness_q30 < 1 << 30);
  /* 1.7e-3 root(1.0989e6 * 1.3 / 0.08) / 0.01 = 718.37: drawn both ways, c11 + c12 resist; times 113/64, above
   * 1 + 3/2 of the limit */
  const double steps = 718.37 * 113 / 64;
  const double expected = 64.0 / steps * (64.0 / steps);
  CHECK(fabs(f.facts.stiffness_q30 / 1073741824.0 / expected - 1) < 1e-3);
  CHECK(fabs(f.w->membrane.materials[0].stretch[3][0] / 4096.0 / (1e6 / 0.91 * expected) - 1) < 1e-3);
  fixture_close(&f);
  open_small(&f, "regular", "denim", "", "");
  CHECK_EQ_INT(f.facts.stiffness_q30, 1 << 30);
}

/* Elastic steps: 1.7e-3 root(C / rho) / edge in a ms, C the stiffest slope: denim 2 * 1059.59741 -
 * 1013.88629; times 113/64, the next above 1 + 3/2 of the limit of 50 %. */
static void steps_are_the_formulas(void) {
  fixture_scoped f = {0};
  open_small(&f, "regular", "own", "", "material own { density 200 g/m2 isotropic 2002 N/m 0 }\n");
  CHECK_EQ_INT(f.facts.elastic_steps, 31); /* 17.009 * 1.7656 = 30.03 */
  fixture_close(&f);
  open_small(&f, "regular", "own", "",
             "rate 500 Hz\nsubsteps 2\nmaterial own { density 200 g/m2 isotropic 2002 N/m 0 }\n");
  CHECK_EQ_INT(f.facts.elastic_steps, 31); /* twice that in two */
}

/* D of the least curvature along the fold's first direction, in units that steps do not change. */
static double plate_of(const fixture *f) {
  const membrane_params *c = f->w->membrane.constants;
  return ldexp(f->w->membrane.materials[0].bend[0][0], -c->bend_bits) * c->steps / c->bend_every;
}

static void open_plate(fixture *f, const char *bend, const char *steps_max) {
  fixture_print(f,
                "scene plate\nmaterial own { density 200 g/m2 isotropic 60 N/m 0 bend all %s }\n"
                "membrane {\n columns 3\n rows 2\n cell 1 cm\n material own\n strain_limit 50 %%\n%s}\n",
                bend, steps_max);
}

/* Bending that does not bear the steps of the stretch has more of them, not less of D, unless there may be no
 * more. root(150 D / rho) / edge^2 in steps of 2 / 1.5: 1.9e-3 N m have 9 in a tick of a ms. */
static void stiff_bending_takes_more_steps(void) {
  fixture_scoped soft = {0};
  fixture_scoped stiff = {0};
  fixture_scoped limited = {0};
  open_plate(&soft, "1 uNm", "");
  open_plate(&stiff, "1900 uNm", "");
  open_plate(&limited, "1900 uNm", " elastic_steps_max 7\n");
  CHECK_EQ_INT(soft.facts.elastic_steps, 6);
  CHECK_EQ_INT(stiff.facts.elastic_steps, 9);
  CHECK_EQ_INT(stiff.w->membrane.constants->bend_every, 1);
  CHECK(fabs(plate_of(&stiff) / plate_of(&soft) / 1900 - 1) < 1e-3);
  CHECK_EQ_INT(limited.facts.elastic_steps, 7);
  CHECK(plate_of(&limited) < 1800 * plate_of(&soft));
}

static void any_flipped_bit_is_found_or_harmless(void) {
  fixture_scoped f = {0};
  open_small(&f, "irregular 2", "t-shirt", "", "");
  uint32_t refused = 0;
  uint32_t run = 0;
  for (size_t byte = 0; byte < f.image_bytes; ++byte) {
    for (uint32_t bit = 0; bit < 8; bit += byte > 4096 ? 3 : 1) {
      fray_world *w = NULL;
      fray_error error;
      fray_output out;
      f.image[byte] ^= (uint8_t)(1u << bit);
      const int opens = damage_open(&f, &w, &error) == FRAY_OK;
      for (int tick = 0; opens && tick < 2; ++tick) fray_tick(w, &fixture_idle, &out);
      *(opens ? &run : &refused) += 1;
      f.image[byte] ^= (uint8_t)(1u << bit);
    }
  }
  printf("figure damaged triangle images: %u refused, %u ran (asked: printed)\n", refused, run);
  CHECK(refused > run);
}

/* The least number there is at the beginning of a section is nowhere good. */
static void what_is_wrong_is_named_by_its_section(void) {
  fixture_scoped f = {0};
  open_small(&f, "irregular 2", "t-shirt", "", "");
  uint32_t sections = 0;
  for (uint32_t n = 0; n < bytes_load32(f.image + 4 * IMAGE_SECTIONS_WORD); ++n) {
    const uint8_t *entry = f.image + 4 * (IMAGE_HEADER_WORDS + IMAGE_DIRECTORY_WORDS * n);
    if (bytes_load32(entry) < 36) continue; /* those that woven sheets have too */
    fray_world *w = NULL;
    fray_error error;
    uint8_t *at = f.image + bytes_load32(entry + 12);
    const uint32_t kept = bytes_load32(at);
    bytes_store32(at, 0x80000000u);
    CHECK_EQ_INT(damage_open(&f, &w, &error), FRAY_BAD_FIELD);
    bytes_store32(at, kept);
    CHECK_EQ_INT(error.section, bytes_load32(entry));
    ++sections;
  }
  CHECK_EQ_INT(sections, 14);
}

/* Bent, so that folds have offsets and habits. */
static void save_and_restore_go_on_alike(void) {
  fixture_scoped a = {0};
  fixture_scoped b = {0};
  open_small(&a, "irregular 9", "swimsuit", "", "");
  for (uint32_t p = particles_attached(a.w); p < a.w->p.count; ++p)
    a.w->p.z[p] += (int32_t)((p * 2654435761u) >> 12) - (1 << 19);
  for (int tick = 0; tick < 77; ++tick) fixture_tick(&a, &fixture_idle);
  fixture_copy(&b, &a);
  uint32_t offsets = 0;
  uint32_t habits = 0;
  for (uint32_t t = 0; t < triangles_in_use(b.w); ++t) {
    offsets += b.w->membrane.bend_states[t].offset[0] != 0;
    habits += b.w->membrane.bend_states[t].habit[1] != 0;
  }
  CHECK(offsets >= 6 && habits >= 6); /* of 12 */
  CHECK(fray_hash(a.w) == fray_hash(b.w));
  for (int tick = 0; tick < 50; ++tick)
    CHECK(fixture_tick(&a, &fixture_idle).hash == fixture_tick(&b, &fixture_idle).hash);
}

/* Stress and bending give impulses whose sum is zero to the last bit, in every inner step. */
static void impulses_cancel(void) {
  fixture_scoped f = {0};
  fixture_print(&f, "scene free\ngravity 0 0 0 cm/s2\nmembrane {\n columns 7\n rows 5\n cell 1 "
                    "cm\n pattern irregular 4\n material pants\n}\n");
  for (uint32_t p = 0; p < f.w->p.count; ++p) {
    f.w->p.z[p] += (int32_t)((p * 2654435761u) >> 12) - (1 << 19);
    f.w->p.x[p] += (int32_t)((p * 40503u * 2654435761u) >> 14);
  }
  for (int tick = 0; tick < 200; ++tick) {
    const fray_work most = fray_work_bound(f.w);
    const fray_output out = fixture_tick(&f, &fixture_idle);
    int64_t sum[3] = {0, 0, 0};
    for (uint32_t p = 0; p < f.w->p.count; ++p) {
      sum[0] += f.w->membrane.impulse[p].x;
      sum[1] += f.w->membrane.impulse[p].y;
      sum[2] += f.w->membrane.impulse[p].z;
    }
    for (uint32_t n = 0; n < 3; ++n) CHECK_EQ_INT(sum[n], 0);
    CHECK(fixture_within_bound(&out.work, &most));
  }
  CHECK_EQ_INT(f.w->state->faults, 0);
}

/* A sheet rolled on a cylinder of 8 cm is bent by 12.5 / m, 2.5 steps of the table, in which the stiffness
 * doubles from step to step: six times that of a flat sheet. */
static void stiffness_goes_by_the_curvature(void) {
  fixture_scoped f = {0};
  fixture_print(&f, "scene rolled\ngravity 0 0 0 cm/s2\nmembrane {\n columns 16\n rows 8\n cell 0.5 cm\n "
                    "material own\n}\nmaterial own {\n density 200 g/m2\n isotropic 400 N/m 0.3\n"
                    " bend 0 10 20 40 80 160 uNm\n bend 45 10 20 40 80 160 uNm\n"
                    " bend 90 10 20 40 80 160 uNm\n}\n");
  fray_world *w = f.w;
  const double radius = 0.08 / (f.facts.lu_um * 1e-6);
  uint32_t found = 0;
  fixture_tick(&f, &fixture_idle);
  const int32_t flat = bend_plate_column(w, PLATE_H00)[80];
  for (uint32_t p = 0; p < w->p.count; ++p) {
    const double turn = w->trimesh.u[p] / (double)FX_LU / radius;
    w->p.x[p] = (int32_t)lrint(radius * sin(turn) * FX_LU);
    w->p.y[p] = w->trimesh.v[p];
    w->p.z[p] = (int32_t)lrint(radius * cos(turn) * FX_LU);
  }
  bend_prepare(w);
  for (uint32_t p = 0; p < w->p.count; ++p) {
    const int32_t at[3] = {w->p.x[p], w->p.y[p], w->p.z[p]};
    for (uint32_t n = 0; n < 3; ++n) w->membrane.positions[p].at[n] = fx_wrap_shift(at[n], FX_SUB_BITS);
  }
  for (int32_t step = 0; step < 6000; ++step) {
    w->state->tick[0] = step; /* an eighth of the triangles follow in each */
    bend_force_add(w, BEND_LAST);
  }
  for (uint32_t t = 0; t < triangles_in_use(w); ++t) {
    const uint32_t column = t / 2 % 16, row = t / 32;
    if (column < 4 || column > 11 || row < 2 || row > 5) continue;
    CHECK(fabs(w->membrane.bend_states[t].habit[1] / (double)(1 << BEND_HABIT_BITS) - 2.5) < 0.05);
    ++found;
  }
  CHECK_EQ_INT(found, 8 * 4 * 2);
  bend_prepare(w);
  CHECK(fabs(bend_plate_column(w, PLATE_H00)[80] / (double)flat / 6 - 1) < 0.03);
}

int main(void) {
  TEST(meshes_are_whole);
  TEST(stiffness_goes_by_the_curvature);
  TEST(bad_text_is_refused);
  TEST(pins_by_a_body_hold);
  TEST(too_stiff_is_scaled);
  TEST(steps_are_the_formulas);
  TEST(stiff_bending_takes_more_steps);
  TEST(any_flipped_bit_is_found_or_harmless);
  TEST(what_is_wrong_is_named_by_its_section);
  TEST(save_and_restore_go_on_alike);
  TEST(impulses_cancel);
  return test_end();
}
