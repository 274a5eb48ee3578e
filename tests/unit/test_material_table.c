/* SPDX-License-Identifier: Apache-2.0 */
/* The table of measured cloths: Karaoz 2015, Table 4.14, from it to the last printed digit, and how
 * its cloths stand in groups; what a scene's cloth is made of. */
#include "tests/lib/test.h"
#include "tools/scene_language/material_table.h"

/* Table 4.14 in uN/m, its rows in the order of the paper. */
static const struct {
  const char *name;
  int64_t mean[MATERIAL_ENTRIES];
} printed[] = {{"denim", {223288325, 39130220, 1048432643, 69412260}},
               {"t-shirt", {83893843, 67652278, 281209530, 22680790}},
               {"pants", {2094145196, 45790863, 2129397111, 58980970}},
               {"swimsuit", {50024568, 20011822, 113431254, 23658169}}};

static void table_is_as_printed(void) {
  for (uint32_t n = 0; n < MATERIAL_SAMPLES; ++n) {
    CHECK_TEXT(material_samples[n].name, printed[n].name);
    printf("figure table 4.14 %-8s", printed[n].name);
    for (uint32_t e = 0; e < MATERIAL_ENTRIES; ++e) {
      const int64_t mean = material_table_mean(&material_samples[n], e);
      CHECK_EQ_INT(mean, printed[n].mean[e]);
      printf(" %lld.%06lld", (long long)(mean / 1000000), (long long)(mean % 1000000));
    }
    printf(" N/m (asked: as printed)\n");
  }
}

/* Section 4.5.2.1: denim and pants are one group, t-shirt and swimsuit the other, by c11, c22, c33.
 */
static void groups_are_the_papers(void) {
  static const uint32_t entries[3] = {0, 2, 3};
  for (uint32_t k = 0; k < 3; ++k) {
    const uint32_t e = entries[k];
    int64_t mean[4];
    for (uint32_t n = 0; n < 4; ++n) mean[n] = material_table_mean(&material_samples[n], e);
    CHECK(mean[0] > mean[1] && mean[0] > mean[3]);
    CHECK(mean[2] > mean[1] && mean[2] > mean[3]);
  }
}

static void all_cloths_are_mended(void) {
  static const char *const names[] = {"denim", "t-shirt", "pants", "swimsuit", "paper"};
  for (uint32_t n = 0; n < 5; ++n) {
    material_spec f;
    CHECK(material_table_find(names[n], &f));
    CHECK(material_table_sanitize(&f) == NULL);
    for (uint32_t r = 0; r < MATERIAL_ROWS; ++r) {
      CHECK(f.stretch[r][1].numerator >= 0);
      for (uint32_t e = 0; e < MATERIAL_ENTRIES; ++e)
        CHECK(exact_valid(f.stretch[r][e]) && (e == 1 || f.stretch[r][e].numerator > 0));
    }
  }
  material_spec none;
  CHECK(!material_table_find("velvet", &none));
}

static void negatives_become_zero_and_shear_its_floor(void) {
  material_spec f;
  CHECK(material_table_find("t-shirt", &f) && material_table_sanitize(&f) == NULL);
  CHECK_EQ_INT(f.stretch[0][1].numerator, 0);
  /* row 1: c33 was -29.69, c22 is 261.013855 */
  CHECK_EQ_INT(exact_compare(f.stretch[1][3], exact_make(261013855, 64000000)), 0);
  CHECK_EQ_INT(exact_compare(f.stretch[2][3], exact_make(22768457, 1000000)), 0);
}

static void isotropic_is_2_11(void) {
  material_spec f;
  material_table_isotropic(exact_make(910, 1), exact_make(3, 10), &f);
  for (uint32_t r = 0; r < MATERIAL_ROWS; ++r) {
    CHECK_EQ_INT(exact_compare(f.stretch[r][0], exact_make(1000, 1)), 0);
    CHECK_EQ_INT(exact_compare(f.stretch[r][1], exact_make(300, 1)), 0);
    CHECK_EQ_INT(exact_compare(f.stretch[r][2], exact_make(1000, 1)), 0);
    CHECK_EQ_INT(exact_compare(f.stretch[r][3], exact_make(350, 1)), 0);
  }
}

static void what_pushes_itself_apart_is_refused(void) {
  const exact row[MATERIAL_ENTRIES] = {exact_make(100, 1), exact_make(101, 1), exact_make(100, 1),
                                     exact_make(20, 1)};
  const exact nothing[MATERIAL_ENTRIES] = {exact_make(0, 1), exact_make(0, 1), exact_make(0, 1),
                                         exact_make(0, 1)};
  material_spec f;
  material_table_uniform(row, &f);
  CHECK(material_table_sanitize(&f) != NULL);
  material_table_uniform(nothing, &f);
  CHECK(material_table_sanitize(&f) != NULL);
}

int main(void) {
  TEST(table_is_as_printed);
  TEST(groups_are_the_papers);
  TEST(all_cloths_are_mended);
  TEST(negatives_become_zero_and_shear_its_floor);
  TEST(isotropic_is_2_11);
  TEST(what_pushes_itself_apart_is_refused);
  return test_end();
}
