/* SPDX-License-Identifier: Apache-2.0 */
/* Measured by Wang, O'Brien, Ramamoorthi, "Data-driven elastic models for cloth: modeling and
 * measurement", 2011; the figures are those that ARCSim distributes with its materials
 * (kaist-silab/arcsim e17d93b5436b, materials/SAMPLE.json). */
#include "tools/scene_language/material_table.h"

#include <string.h>

const material_sample material_samples[MATERIAL_SAMPLES] = {
    {"denim", "11oz-black-denim", "99% cotton 1% spandex", 324000,
     {{205352005, 10234077, 1013886290, 53387184},
      {232027634, 40646339, 1052842890, 64980499},
      {224592209, 40384563, 1054434440, 67184807},
      {225951050, 62095657, 1059597410, 83992020},
      {226039566, 40502792, 1058277710, 75118423},
      {225767487, 40917892, 1051557120, 71810631}},
     {{64196457, 60286175, 60943428, 62433697, 19824701},
      {73384567, 59671982, 61080757, 68242569, 36033474},
      {96951576, 107848228, 113060738, 120569740, 79781021}}},
    {"t-shirt", "gray-interlock", "60% cotton 40% polyester", 187000,
     {{16593832, -14695990, 34477123, 36860302},
      {46364765, 53694656, 261013855, -29691301},
      {49285110, 87596100, 206373993, 22768457},
      {123989220, 105181770, 365966217, 44217571},
      {139686325, 73592560, 413553162, -174438530},
      {127443810, 85848587, 405872833, 32238411}},
     {{23191698, 32932217, 34406498, 39014420, 23382786},
      {24749964, 18651314, 16370552, 25095791, 8860165},
      {14267624, 7052906, 14515154, 24665127, 19383726}}},
    {"pants", "royal-target", "65% cotton 35% polyester", 220000,
     {{2016554560, 9170511, 2034976440, 104759674},
      {2109516840, 38604588, 2173939690, 19129177},
      {2109780020, 60165310, 2155513670, 27817890},
      {2110333490, 30987429, 2135079100, 121482445},
      {2109160150, 72393326, 2124135250, 40810982},
      {2109526120, 63424015, 2152738520, 39885654}},
     {{125409805, 167284561, 215412750, 215090790, 223861038},
      {107997696, 120583267, 144141678, 140606689, 153048309},
      {125409805, 167284561, 215412750, 215090790, 227861038}}},
    {"swimsuit", "white-swim-solid", "87% nylon 13% spandex", 204000,
     {{47971176, 6834521, 104615456, 60773663},
      {40369045, 23092957, 169666290, -24681890},
      {40291599, 48142597, 138261612, 9002558},
      {51393467, -32966949, 79881721, 35973194},
      {51500938, 1868910, 63693932, -37540417},
      {68621185, 40131950, 124468513, 36199604}},
     {{60237942, 56357208, 69698593, 55305969, 34705532},
      {58803211, 63121964, 61379181, 47971302, 19383726},
      {51018833, 50741455, 50570576, 50006001, 24556618}}},
};

int64_t material_table_mean(const material_sample *facts, uint32_t entry) {
  int64_t sum = 0;
  for (uint32_t row = 0; row < MATERIAL_ROWS; ++row)
    if (facts->stretch[row][entry] > 0) sum += facts->stretch[row][entry];
  return sum / MATERIAL_ROWS;
}

void material_table_uniform(const exact row[MATERIAL_ENTRIES], material_spec *f) {
  for (uint32_t r = 0; r < MATERIAL_ROWS; ++r)
    memcpy(f->stretch[r], row, sizeof f->stretch[r]);
}

void material_table_isotropic(exact e, exact nu, material_spec *f) {
  const exact one = exact_make(1, 1);
  const exact stiff = exact_div(e, exact_sub(one, exact_mul(nu, nu)));
  const exact shear = exact_mul(stiff, exact_div(exact_sub(one, nu), exact_make(2, 1)));
  const exact row[MATERIAL_ENTRIES] = {stiff, exact_mul(stiff, nu), stiff, shear};
  material_table_uniform(row, f);
}

void material_table_bend(exact stiffness, material_spec *f) {
  for (uint32_t b = 0; b < MATERIAL_BENDS; ++b)
    for (uint32_t n = 0; n < MATERIAL_CURVES; ++n) f->bend[b][n] = stiffness;
}

/* Printing paper: 80 g/m2, 0.1 mm thick, 1 MN/m, nu 0.3; it bends like a plate, E t^2 / 12 / (1 - nu^2). */
static void set_paper(material_spec *f) {
  f->density = exact_make(8, 1000);
  material_table_isotropic(exact_make(1000000, 1), exact_make(3, 10), f);
  material_table_bend(exact_make(1, 1092), f);
}

static void set_measured(const material_sample *facts, material_spec *f) {
  f->density = exact_make(facts->density, 10000000);
  for (uint32_t r = 0; r < MATERIAL_ROWS; ++r)
    for (uint32_t n = 0; n < MATERIAL_ENTRIES; ++n)
      f->stretch[r][n] = exact_make(facts->stretch[r][n], 1000000);
  for (uint32_t b = 0; b < MATERIAL_BENDS; ++b)
    for (uint32_t n = 0; n < MATERIAL_CURVES; ++n)
      f->bend[b][n] = exact_make(facts->bend[b][n], 1000000000000);
}

void material_table_never_tear(material_spec *f) {
  for (uint32_t n = 0; n < TEAR_STRENGTH_DIRECTIONS; ++n) f->strength[n] = exact_make(0, 1);
  f->tear_interval = exact_make(0, 1);
  f->has_cut_speed = 0;
  f->cut_speed = exact_make(0, 1);
  f->corotational = 0;
  f->breaks = f->average = exact_make(0, 1);
}

int material_table_find(const char *name, material_spec *f) {
  material_table_never_tear(f);
  if (strcmp(name, "paper") == 0) {
    set_paper(f);
    return 1;
  }
  for (uint32_t n = 0; n < MATERIAL_SAMPLES; ++n) {
    if (strcmp(name, material_samples[n].name) != 0) continue;
    set_measured(&material_samples[n], f);
    return 1;
  }
  return 0;
}

static exact larger(exact a, exact b) { return exact_compare(a, b) > 0 ? a : b; }

const char *material_table_sanitize(material_spec *f) {
  const exact zero = exact_make(0, 1);
  for (uint32_t r = 0; r < MATERIAL_ROWS; ++r) {
    exact *row = f->stretch[r];
    for (uint32_t n = 0; n < MATERIAL_ENTRIES; ++n) row[n] = larger(row[n], zero);
    const exact max = larger(larger(row[0], row[2]), row[3]);
    if (exact_compare(max, zero) == 0) return "a row of zeros, expected some stiffness";
    const exact min = exact_div(max, exact_make(MATERIAL_TABLE_FLOOR, 1));
    row[0] = larger(row[0], min);
    row[2] = larger(row[2], min);
    row[3] = larger(row[3], min);
    if (row[1].numerator != 0 && exact_compare(exact_div(row[1], row[0]), exact_div(row[2], row[1])) > 0)
      return "c12 above the root of c11 times c22, expected a positive definite row";
  }
  return NULL;
}
