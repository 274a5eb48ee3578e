/* SPDX-License-Identifier: Apache-2.0 */
/* What is damaged: seeds, and images that were accepted. libFuzzer's corpus is mostly images that were refused, each
 * in another way, and what is damaged twice is refused again. */
#ifndef FRAY_TESTS_FUZZ_BASES_H
#define FRAY_TESTS_FUZZ_BASES_H

#include <dirent.h>
#include <stdio.h>
#include <string.h>

#include "rt/image/image.h"
#include "tests/fuzz/damage_fields.h"

/* Of a kind are images with the same features, so that each feature is damaged as often, however many images have it. */
enum { BASE_KINDS = 48, BASE_OF_A_KIND = 16, BASE_BYTES = 1 << 14, BASE_SEEDS = 96, BASE_NAME = 512,
       BASE_LONG_ONE_IN = 32 /* seeds named long_* */ };

typedef struct {
  uint8_t image[BASE_BYTES];
  size_t bytes;
} base_image;

static struct {
  base_image seed[2][BASE_SEEDS]; /* small, long */
  uint32_t seeds[2];
  base_image kept[BASE_KINDS][BASE_OF_A_KIND];
  uint32_t features[BASE_KINDS], count[BASE_KINDS], kinds;
} bases;

static inline void bases_seed(const char *folder, const char *name) {
  char path[2 * BASE_NAME];
  const uint32_t is_long = strncmp(name, "long_", 5) == 0;
  if (bases.seeds[is_long] == BASE_SEEDS) return;
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *in = fopen(path, "rb");
  if (in == NULL) return;
  base_image *to = &bases.seed[is_long][bases.seeds[is_long]];
  to->bytes = fread(to->image, 1, BASE_BYTES, in);
  fclose(in);
  bases.seeds[is_long] += to->bytes != 0 && to->bytes < BASE_BYTES;
}

/* Reads the images of a folder. */
static inline void bases_read(const char *folder) {
  DIR *d = opendir(folder);
  for (struct dirent *e = d != NULL ? readdir(d) : NULL; e != NULL; e = readdir(d))
    if (strstr(e->d_name, ".img") != NULL) bases_seed(folder, e->d_name);
  if (d != NULL) closedir(d);
}

/* Which pools are empty, and the header's features. */
static inline uint32_t base_features(const uint8_t *image) {
  uint32_t bits = bytes_load32(image + 4 * IMAGE_FEATURES_WORD) << POOLS_IN_HEADER;
  for (uint32_t n = 0; n < POOLS_IN_HEADER; ++n)
    bits |= (uint32_t)(bytes_load32(image + 4 * (IMAGE_CAPACITY_WORD + n)) != 0) << n;
  return bits;
}

/* The kind's number, or BASE_KINDS. */
static inline uint32_t base_kind(uint32_t features) {
  uint32_t k = 0;
  while (k < bases.kinds && bases.features[k] != features) ++k;
  if (k == bases.kinds && k < BASE_KINDS) bases.features[bases.kinds++] = features;
  return k;
}

/* Of an image that was accepted, in the place of another of its kind. */
static inline void bases_keep(const uint8_t *image, size_t bytes, uint32_t draw) {
  const uint32_t kind = base_kind(base_features(image));
  if (kind == BASE_KINDS || bytes > BASE_BYTES) return;
  const uint32_t slot = bases.count[kind] < BASE_OF_A_KIND ? bases.count[kind]++ : draw % BASE_OF_A_KIND;
  memcpy(bases.kept[kind][slot].image, image, bytes);
  bases.kept[kind][slot].bytes = bytes;
}

static inline uint32_t bases_below(uint32_t n, uint64_t *draws) {
  return (uint32_t)((splitmix64(draws) >> 32) * n >> 32);
}

/* A seed, or one that was kept; NULL: what libFuzzer gave. */
static inline const base_image *bases_draw(uint64_t *draws) {
  enum { OF_EIGHT_SEEDS = 4, OF_EIGHT_KEPT = 7 };
  const uint32_t from = bases_below(8, draws);
  const uint32_t is_long = bases_below(BASE_LONG_ONE_IN, draws) == 0 && bases.seeds[1] != 0;
  if (from < OF_EIGHT_SEEDS && bases.seeds[is_long] != 0)
    return &bases.seed[is_long][bases_below(bases.seeds[is_long], draws)];
  if (from >= OF_EIGHT_KEPT || bases.kinds == 0) return NULL;
  const uint32_t kind = bases_below(bases.kinds, draws);
  return bases.count[kind] == 0 ? NULL : &bases.kept[kind][bases_below(bases.count[kind], draws)];
}

#endif
