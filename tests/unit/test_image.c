/* SPDX-License-Identifier: Apache-2.0 */
/* Damaged, cut off and hostile images: each is refused with a reason, or is a world that runs.
 * Built twice: with 32-bit ids, and with FRAY_ID_BITS=16 (the Makefile's id16). Every image lies
 * in memory of its exact size, so that a sanitizer sees a read behind it. */
#include "tests/lib/test.h"

#include <stdlib.h>
#include <time.h>

#include "rt/base/bytes.h"
#include "rt/model/image.h"
#include "tools/build/build.h"

/* Every section has something in it: pins, a hand, a path, a free body, springs that may tear. */
static const char SCENE[] =
    "scene tiny rate 1000 Hz substeps 2 gravity 0 -981 0 cm/s2 seed 3\n"
    "sheet { warps 5 wefts 4 spacing 12 /cm weave twill 2/1 tear 5 10 % drag 1 /s }\n"
    "pin row top\n"
    "ball a { radius 0.05 cm at 0.16 -0.12 0 cm move hand right grip 0.01 cm }\n"
    "bar b { length 0.2 cm radius 0.05 cm move path { 0 s 0 0 0.2 cm 0.01 s 0 0 -0.1 cm } }\n"
    "box c { size 0.1 0.1 0.1 cm at 0 0.2 0 cm move free mass 1 g }\n"
    "plane d { at 0 -0.3 0 cm }\n"
    "limits { contacts 12 cuts_per_tick 2 }\n";

/* And those of yarns that have a stiffness. */
static const char STRETCHED[] =
    "scene stretched rate 1000 Hz substeps 2 gravity 0 -981 0 cm/s2 seed 3\n"
    "sheet { warps 5 wefts 4 spacing 12 /cm yarns on stretch 0.1 N tear 5 10 % slip_grip 0.1 mN }\n"
    "pin row top\n"
    "ball a { radius 0.05 cm at 0.16 -0.12 0 cm move hand right grip 0.01 cm }\n"
    "limits { contacts 12 cuts_per_tick 2 spare_particles 6 splits_per_tick 3 }\n";

enum { SECTIONS = 27, SECTION_LAST = IMAGE_LAYERS, MEMORY_MAX = 1 << 22, SECOND_OF = 1 };

static uint8_t *image;
static size_t image_bytes;

static uint8_t *copy_of(const uint8_t *from, size_t bytes) {
  uint8_t *copy = malloc(bytes + (bytes == 0));
  if (copy == NULL) abort();
  if (bytes != 0) memcpy(copy, from, bytes);
  return copy;
}

static void mend(uint8_t *bytes, size_t count) {
  bytes_store32(bytes + 4 * IMAGE_CRC_WORD,
                bytes_crc32(bytes + IMAGE_CRC_FROM, count - IMAGE_CRC_FROM));
}

/* The bytes of a section, by the directory. */
static uint8_t *section(uint8_t *bytes, uint32_t id) {
  const uint32_t count = bytes_load32(bytes + 4 * IMAGE_SECTIONS_WORD);
  for (uint32_t n = 0; n < count; ++n) {
    const uint8_t *entry = bytes + 4 * (IMAGE_HEADER_WORDS + IMAGE_DIRECTORY_WORDS * n);
    if (bytes_load32(entry) == id) return bytes + bytes_load32(entry + 12);
  }
  abort();
}

/* One try to open. The world, if there is one, lives in *memory, which the caller frees. */
static fray_status try_open(const uint8_t *bytes, size_t count, void **memory, fray_world **world,
                            fray_error *error) {
  size_t needed = MEMORY_MAX;
  fray_error other;
  if (fray_bytes(bytes, count, &needed, &other) != FRAY_OK || needed > MEMORY_MAX)
    needed = MEMORY_MAX;
  const size_t room = (needed + FRAY_ALIGN - 1) / FRAY_ALIGN * FRAY_ALIGN;
  *memory = aligned_alloc(FRAY_ALIGN, room);
  if (*memory == NULL) abort();
  *world = (fray_world *)*memory; /* must become NULL where it is refused */
  return fray_open(bytes, count, *memory, needed, world, error);
}

static int reason_is_good(fray_status status, const fray_error *error, const fray_world *world) {
  return world == NULL && error->status == status && error->section <= SECTION_LAST &&
         error->what != NULL && error->what[0] != 0;
}

static void check_refused(const uint8_t *bytes, size_t count, fray_status expected,
                          uint32_t in_section) {
  void *memory;
  fray_world *world;
  fray_error error = {FRAY_OK, 0, 0, NULL};
  const fray_status status = try_open(bytes, count, &memory, &world, &error);
  CHECK_EQ_INT(status, expected);
  CHECK(reason_is_good(status, &error, world));
  CHECK_EQ_INT(error.section, in_section);
  free(memory);
}

static fray_input input_of(uint32_t tick) {
  fray_input input;
  memset(&input, 0, sizeof input);
  input.has_pose = 3;
  input.pose[1].x = (int16_t)(tick * 300);
  input.pose[1].y = (int16_t)(-200 * (int32_t)tick);
  input.pose[1].counter = (tick + 1) & 15u;
  input.verb = tick == 0 ? FRAY_VERB_START : FRAY_VERB_NONE;
  return input;
}

static uint64_t run(fray_world *world, uint32_t ticks) {
  fray_output output;
  output.hash = fray_hash(world);
  for (uint32_t tick = 0; tick < ticks; ++tick) {
    const fray_input input = input_of(tick);
    fray_tick(world, &input, &output);
  }
  return output.hash;
}

static void opens(void) {
  void *memory;
  fray_world *world;
  fray_error error;
  CHECK_EQ_INT(try_open(image, image_bytes, &memory, &world, &error), FRAY_OK);
  const uint64_t last = run(world, 60);
  CHECK(last == fray_hash(world));
  CHECK(fray_describe(world).tick == 60);
  free(memory);
}

static void every_length_is_refused(void) {
  uint32_t bad = 0;
  for (size_t bytes = 0; bytes < image_bytes; ++bytes) {
    void *memory;
    fray_world *world;
    fray_error error = {FRAY_OK, 0, 0, NULL};
    uint8_t *part = copy_of(image, bytes);
    const fray_status status = try_open(part, bytes, &memory, &world, &error);
    bad += status != FRAY_TRUNCATED || !reason_is_good(status, &error, world);
    free(memory);
    free(part);
  }
  CHECK_EQ_INT(bad, 0);
}

static void bytes_behind_the_image_do_not_matter(void) {
  void *memory;
  fray_world *world;
  uint8_t *longer = calloc(image_bytes + 5, 1);
  if (longer == NULL) abort();
  memcpy(longer, image, image_bytes);
  CHECK_EQ_INT(try_open(longer, image_bytes + 5, &memory, &world, NULL), FRAY_OK);
  free(memory);
  free(longer);
}

static void every_flipped_bit_is_refused(void) {
  uint32_t bad = 0;
  uint8_t *copy = copy_of(image, image_bytes);
  for (size_t bit = 0; bit < 8 * image_bytes; ++bit) {
    void *memory;
    fray_world *world;
    fray_error error = {FRAY_OK, 0, 0, NULL};
    copy[bit / 8] = (uint8_t)(copy[bit / 8] ^ 1u << bit % 8);
    const fray_status status = try_open(copy, image_bytes, &memory, &world, &error);
    bad += status == FRAY_OK || !reason_is_good(status, &error, world);
    copy[bit / 8] = image[bit / 8];
    free(memory);
  }
  free(copy);
  CHECK_EQ_INT(bad, 0);
}

/* With its CRC put right, a flipped bit is found by what it means, or means another world. */
static int mended_flip_is_harmless(const uint8_t *bytes, uint32_t *accepted) {
  void *memory;
  fray_world *world;
  fray_error error = {FRAY_OK, 0, 0, NULL};
  const clock_t began = clock();
  const fray_status status = try_open(bytes, image_bytes, &memory, &world, &error);
  const int good = status == FRAY_OK || reason_is_good(status, &error, world);
  if (status == FRAY_OK) {
    *accepted += 1;
    (void)run(world, 3);
  }
  free(memory);
  return good && clock() - began < 2 * CLOCKS_PER_SEC;
}

static void every_mended_flip_is_harmless(void) {
  uint32_t bad = 0, accepted = 0, tried = 0;
  uint8_t *copy = copy_of(image, image_bytes);
  for (size_t bit = 0; bit < 8 * image_bytes; ++bit) {
    if (bit / 32 == IMAGE_CRC_WORD) continue;
    copy[bit / 8] = (uint8_t)(copy[bit / 8] ^ 1u << bit % 8);
    mend(copy, image_bytes);
    if (!mended_flip_is_harmless(copy, &accepted)) {
      bad++;
      printf("bit %zu\n", bit);
    }
    copy[bit / 8] = image[bit / 8];
    tried++;
  }
  free(copy);
  CHECK_EQ_INT(bad, 0);
  printf("  %u mended flips, %u accepted as another world\n", tried, accepted);
}

static void check_word(uint32_t word, uint32_t value, fray_status expected) {
  uint8_t *copy = copy_of(image, image_bytes);
  bytes_store32(copy + 4 * word, value);
  mend(copy, image_bytes);
  check_refused(copy, image_bytes, expected, 0);
  free(copy);
}

static void headers(void) {
  check_word(IMAGE_MAGIC_WORD, 0x59415247u, FRAY_BAD_MAGIC);
  check_word(IMAGE_VERSION_WORD, 3u << 16, FRAY_BAD_VERSION);
  check_word(IMAGE_VERSION_WORD, 0u << 16, FRAY_BAD_VERSION);
  check_word(IMAGE_VERSION_WORD, FRAY_IMAGE_MAJOR << 16 | 1u, FRAY_BAD_VERSION);
  check_word(IMAGE_FEATURES_WORD, 0, FRAY_BAD_VERSION);
  check_word(IMAGE_FEATURES_WORD, IMAGE_SHORT_IDS | 2u, FRAY_BAD_VERSION);
  check_word(IMAGE_SECTIONS_WORD, SECTIONS - 1, FRAY_BAD_SECTION);
  check_word(IMAGE_BYTES_WORD, (uint32_t)image_bytes + 16u, FRAY_BAD_SECTION);
  check_word(IMAGE_CAPACITY_WORD + POOL_LAYERS, 1, FRAY_BAD_VERSION);
  check_word(IMAGE_CAPACITY_WORD + POOL_PARAMS, 2, FRAY_BAD_FIELD);
  check_word(IMAGE_CAPACITY_WORD + POOL_PARTICLES, 0xFFFFFFFFu, FRAY_BAD_FIELD);
  check_word(IMAGE_CAPACITY_WORD + POOL_ROWS, 0, FRAY_BAD_SECTION);
}

static void no_capacities_overflow(void) {
  uint8_t *copy = copy_of(image, image_bytes);
  static const uint32_t most[POOLS] = {1,
                                       1,
                                       LIMIT_PARTICLES,
                                       LIMIT_PARTICLES,
                                       LIMIT_PARTICLES,
                                       LIMIT_ROWS,
                                       LIMIT_BATCHES,
                                       LIMIT_CLASSES,
                                       LIMIT_CLASSES,
                                       LIMIT_BODIES,
                                       LIMIT_KEYS,
                                       LIMIT_CONTACTS,
                                       LIMIT_CUTS};
  for (uint32_t p = 0; p < POOLS_IN_HEADER; ++p)
    bytes_store32(copy + 4 * (IMAGE_CAPACITY_WORD + p), most[p]);
  bytes_store32(copy + 4 * IMAGE_FEATURES_WORD, 0);
  mend(copy, image_bytes);
  /* a build with 16-bit ids stops at the features */
  const int narrow = sizeof(row_id) == 2;
  size_t needed = 0;
  CHECK_EQ_INT(fray_bytes(copy, image_bytes, &needed, NULL),
               narrow ? FRAY_BAD_VERSION : FRAY_OK);
  CHECK(narrow || needed > (size_t)LIMIT_PARTICLES * 40u);
  check_refused(copy, image_bytes, narrow ? FRAY_BAD_VERSION : FRAY_BAD_SECTION, 0);
  free(copy);
}

/* Section ids as in model/image.c. */
enum { ID_BATCHES = 5, ID_HOME = 7, ID_ROW_OF = 8, ID_ROW_I = 9, ID_ROW_J = 10 };

/* The first batch of two or more rows whose ends are both free. */
static uint32_t batch_of_two(uint8_t *bytes, uint32_t *first) {
  const uint8_t *batches = section(bytes, ID_BATCHES);
  for (uint32_t b = 0;; ++b) {
    row_batch batch;
    int32_t words[sizeof batch / 4];
    for (uint32_t n = 0; n < sizeof batch / 4; ++n)
      words[n] = (int32_t)bytes_load32(batches + sizeof batch * b + 4 * n);
    memcpy(&batch, words, sizeof batch);
    *first = (uint32_t)batch.first;
    if (batch.count >= 2 && batch.held == 0) return b;
  }
}

static void rows_that_share_a_particle(void) {
  uint8_t *copy = copy_of(image, image_bytes);
  uint32_t first = 0;
  (void)batch_of_two(copy, &first);
  uint8_t *ends = section(copy, ID_ROW_I);
  bytes_store16(ends + 2 * (first + SECOND_OF), bytes_load16(ends + 2 * first));
  mend(copy, image_bytes);
  check_refused(copy, image_bytes, FRAY_BAD_BATCH, ID_BATCHES);
  free(copy);
}

static void rows_crosswise(void) {
  uint8_t *copy = copy_of(image, image_bytes);
  uint32_t first = 0;
  (void)batch_of_two(copy, &first);
  bytes_store16(section(copy, ID_ROW_J) + 2 * (first + SECOND_OF),
                bytes_load16(section(copy, ID_ROW_I) + 2 * first));
  mend(copy, image_bytes);
  check_refused(copy, image_bytes, FRAY_BAD_BATCH, ID_BATCHES);
  free(copy);
}

static uint32_t rows_of(const uint8_t *bytes) {
  return bytes_load32(bytes + 4 * (IMAGE_CAPACITY_WORD + POOL_ROWS));
}

/* A structural and a shear row that trade their canonical numbers: still each once, but cutting
 * the one would release what does not hang on it. */
static void rows_that_trade_homes(void) {
  uint8_t *copy = copy_of(image, image_bytes);
  uint8_t *home = section(copy, ID_HOME);
  uint8_t *row_of = section(copy, ID_ROW_OF);
  const uint32_t last = rows_of(copy) - 1;
  const uint16_t a = bytes_load16(home);
  const uint16_t b = bytes_load16(home + 2 * last);
  bytes_store16(home, b);
  bytes_store16(home + 2 * last, a);
  bytes_store16(row_of + 2 * b, 0);
  bytes_store16(row_of + 2 * a, (uint16_t)last);
  mend(copy, image_bytes);
  check_refused(copy, image_bytes, FRAY_BAD_FIELD, ID_HOME);
  free(copy);
}

static void check_batch_word(uint32_t word, uint32_t add) {
  uint8_t *copy = copy_of(image, image_bytes);
  uint32_t first = 0;
  const uint32_t b = batch_of_two(copy, &first);
  uint8_t *place = section(copy, ID_BATCHES) + sizeof(row_batch) * b + 4 * word;
  bytes_store32(place, (uint32_t)((uint64_t)bytes_load32(place) + add) & 0xFFFFFFFFu);
  mend(copy, image_bytes);
  check_refused(copy, image_bytes, FRAY_BAD_BATCH, ID_BATCHES);
  free(copy);
}

static void batches_that_overlap_or_gape(void) {
  const uint32_t first = offsetof(row_batch, first) / 4, count = offsetof(row_batch, count) / 4;
  check_batch_word(first, 1);
  check_batch_word(first, 0xFFFFFFFFu);
  check_batch_word(count, 1);
  check_batch_word(count, 0xFFFFFFFFu);
  check_batch_word(count, 0x7FFFFFFFu);
  check_batch_word(count, 0x80000000u);
  check_batch_word(offsetof(row_batch, held) / 4, 1);
}

static void ids_out_of_range(void) {
  uint8_t *copy = copy_of(image, image_bytes);
  bytes_store16(section(copy, ID_ROW_I), 0xFFFF);
  mend(copy, image_bytes);
  check_refused(copy, image_bytes, FRAY_BAD_FIELD, ID_ROW_I);
  memcpy(copy, image, image_bytes);
  bytes_store16(section(copy, ID_ROW_OF), 0xFFFF);
  mend(copy, image_bytes);
  check_refused(copy, image_bytes, FRAY_BAD_FIELD, 7);
  free(copy);
}

static void memory_too_small_or_crooked(void) {
  size_t needed = 0;
  fray_error error;
  CHECK_EQ_INT(fray_bytes(image, image_bytes, &needed, &error), FRAY_OK);
  const size_t room = (needed / FRAY_ALIGN + 2) * FRAY_ALIGN;
  uint8_t *memory = aligned_alloc(FRAY_ALIGN, room);
  if (memory == NULL) abort();
  fray_world *world = (fray_world *)(void *)memory;
  CHECK_EQ_INT(fray_open(image, image_bytes, memory, needed - 1, &world, &error), FRAY_SMALL_MEMORY);
  CHECK(world == NULL);
  CHECK_EQ_INT(fray_open(image, image_bytes, memory, 0, &world, NULL), FRAY_SMALL_MEMORY);
  for (uint32_t off = 1; off < FRAY_ALIGN; ++off)
    CHECK_EQ_INT(fray_open(image, image_bytes, memory + off, needed, &world, &error),
                 FRAY_BAD_ARGUMENT);
  CHECK_EQ_INT(fray_open(image, image_bytes, memory, needed, &world, &error), FRAY_OK);
  CHECK(world != NULL);
  free(memory);
}

static void null_arguments(void) {
  _Alignas(16) static uint8_t memory[64];
  fray_world *world = (fray_world *)(void *)memory;
  fray_error error;
  size_t needed;
  CHECK_EQ_INT(fray_bytes(NULL, 100, &needed, &error), FRAY_BAD_ARGUMENT);
  CHECK_EQ_INT(fray_bytes(image, image_bytes, NULL, &error), FRAY_BAD_ARGUMENT);
  CHECK_EQ_INT(fray_open(NULL, 100, memory, sizeof memory, &world, &error), FRAY_BAD_ARGUMENT);
  CHECK(world == NULL);
  CHECK_EQ_INT(fray_open(image, image_bytes, NULL, 100, &world, &error), FRAY_BAD_ARGUMENT);
  CHECK_EQ_INT(fray_open(image, image_bytes, memory, 64, NULL, &error), FRAY_BAD_ARGUMENT);
}

/* Wherever an image lies, it is the same world. */
static void at_odd_addresses(void) {
  uint64_t hashes[5];
  for (uint32_t off = 0; off < 5; ++off) {
    void *memory;
    fray_world *world;
    uint8_t *copy = malloc(image_bytes + off);
    if (copy == NULL) abort();
    memcpy(copy + off, image, image_bytes);
    CHECK_EQ_INT(try_open(copy + off, image_bytes, &memory, &world, NULL), FRAY_OK);
    hashes[off] = run(world, 60);
    CHECK(hashes[off] == hashes[0]);
    free(memory);
    free(copy);
  }
}

static void a_save_is_the_image(void) {
  void *memory;
  fray_world *world;
  CHECK_EQ_INT(try_open(image, image_bytes, &memory, &world, NULL), FRAY_OK);
  CHECK_EQ_INT(fray_save_bytes(world), image_bytes);
  uint8_t *saved = copy_of(image, image_bytes);
  memset(saved, 0xA5, image_bytes);
  CHECK_EQ_INT(fray_save(world, saved, image_bytes - 1), 0);
  CHECK_EQ_INT(fray_save(world, NULL, image_bytes), 0);
  CHECK_EQ_INT(saved[0], 0xA5);
  CHECK_EQ_INT(fray_save(world, saved, image_bytes), image_bytes);
  CHECK_EQ_INT(memcmp(saved, image, image_bytes), 0);
  free(memory);
  free(saved);
}

static int compile(const char *text) {
  static scene s;
  scene_error error;
  build_report report;
  memset(&error, 0, sizeof error);
  if (scene_parse("tiny", text, strlen(text), &s, &error) &&
      build_image(&s, "tiny", &image, &image_bytes, &report, NULL, NULL, &error))
    return 1;
  printf("tiny:%d:%d: %s\n", error.line, error.column, error.message);
  return 0;
}

static void more_particles_than_the_pool_has(void) {
  enum { IN_PARAMS = 1, IN_YARN_STATE = 29 };
  uint8_t *bytes = copy_of(image, image_bytes);
  bytes_store32(section(bytes, IN_YARN_STATE), 1000);
  mend(bytes, image_bytes);
  check_refused(bytes, image_bytes, FRAY_BAD_FIELD, IN_PARAMS);
  free(bytes);
}

/* Once more what any image must stand. */
static void stretched(void) {
  uint8_t *plain = image;
  const size_t plain_bytes = image_bytes;
  if (!compile(STRETCHED)) abort();
  opens();
  every_length_is_refused();
  every_flipped_bit_is_refused();
  every_mended_flip_is_harmless();
  at_odd_addresses();
  a_save_is_the_image();
  more_particles_than_the_pool_has();
  check_word(IMAGE_VERSION_WORD, FRAY_IMAGE_MAJOR << 16 | 1u, FRAY_BAD_VERSION);
  check_word(IMAGE_VERSION_WORD, FRAY_IMAGE_MAJOR << 16, FRAY_BAD_VERSION);
  free(image);
  image = plain;
  image_bytes = plain_bytes;
}

int main(void) {
  if (!compile(SCENE)) return 1;
  TEST(opens);
  TEST(every_length_is_refused);
  TEST(bytes_behind_the_image_do_not_matter);
  TEST(every_flipped_bit_is_refused);
  TEST(every_mended_flip_is_harmless);
  TEST(headers);
  TEST(no_capacities_overflow);
  TEST(rows_that_share_a_particle);
  TEST(rows_crosswise);
  TEST(rows_that_trade_homes);
  TEST(batches_that_overlap_or_gape);
  TEST(ids_out_of_range);
  TEST(memory_too_small_or_crooked);
  TEST(null_arguments);
  TEST(at_odd_addresses);
  TEST(a_save_is_the_image);
  TEST(stretched);
  free(image);
  return test_end();
}
