/* SPDX-License-Identifier: Apache-2.0 */
/* Damaged, cut off and hostile images: each is refused with a reason, or is a world that runs.
 * Built twice: with 32-bit ids, and with FRAY_ID_BITS=16 (the Makefile's id16). Every image lies
 * in memory of its exact size, so that a sanitizer sees a read behind it. */
#include "tests/lib/hostile_run.h"
#include "tests/lib/image_mend.h"
#include "tests/lib/test.h"

#include <stdlib.h>
#include <time.h>

#include "rt/base/bytes.h"
#include "rt/image/image.h"
#include "tools/scene_compiler/compile.h"

/* Every section has something in it: pins, a hand, a path, a free body, springs that may tear. */
static const char SCENE[] =
    "scene tiny rate 1000 Hz substeps 2 gravity 0 -981 0 cm/s2 seed 3\n"
    "woven { warps 5 wefts 4 spacing 12 /cm weave twill 2/1 tear 5 10 % drag 1 /s }\n"
    "pin row top\n"
    "sphere a { radius 0.05 cm at 0.16 -0.12 0 cm move hand right attach_within 0.01 cm }\n"
    "capsule b { length 0.2 cm radius 0.05 cm move path { 0 s 0 0 0.2 cm 0.01 s 0 0 -0.1 cm } }\n"
    "box c { size 0.1 0.1 0.1 cm at 0 0.2 0 cm move free mass 1 g }\n"
    "plane d { at 0 -0.3 0 cm }\n"
    "limits { contacts 12 tears_per_tick 2 }\n";

/* And those of yarns that have a stiffness. */
static const char STRETCHED[] =
    "scene stretched rate 1000 Hz substeps 2 gravity 0 -981 0 cm/s2 seed 3\n"
    "woven { warps 5 wefts 4 spacing 12 /cm yarns on stretch 0.1 N tear 5 10 % crossing_friction 0.1 mN }\n"
    "pin row top\n"
    "sphere a { radius 0.05 cm at 0.16 -0.12 0 cm move hand right attach_within 0.01 cm }\n"
    "limits { contacts 12 tears_per_tick 2 spare_particles 6 splits_per_tick 3 }\n";

enum { SECTIONS = 27, SECTION_LAST = IMAGE_YARN_CONTACTS, MEMORY_MAX = 1 << 22, SECOND_OF = 1 };

static uint8_t *image;
static size_t image_bytes;

static uint8_t *copy_of(const uint8_t *from, size_t bytes) {
  uint8_t *copy = malloc(bytes + (bytes == 0));
  if (copy == NULL) abort();
  if (bytes != 0) memcpy(copy, from, bytes);
  return copy;
}

/* One try to open. The world, if there is one, lives in memory, which the caller frees. */
typedef struct {
  void *memory;
  fray_world *world;
  fray_status status;
  fray_error error;
} attempt;

static attempt attempt_of(const uint8_t *bytes, size_t count, size_t *needed) {
  fray_error other;
  attempt t = {NULL, NULL, FRAY_OK, {FRAY_OK, 0, 0, NULL}};
  if (fray_memory_size(bytes, count, needed, &other) != FRAY_OK || *needed > MEMORY_MAX)
    *needed = MEMORY_MAX;
  const size_t room = (*needed + FRAY_ALIGN - 1) / FRAY_ALIGN * FRAY_ALIGN;
  t.memory = aligned_alloc(FRAY_ALIGN, room);
  if (t.memory == NULL) abort();
  t.world = (fray_world *)t.memory; /* must become NULL where it is refused */
  return t;
}

static attempt try_open(const uint8_t *bytes, size_t count) {
  size_t needed;
  attempt t = attempt_of(bytes, count, &needed);
  t.status = fray_open(bytes, count, t.memory, needed, &t.world, &t.error);
  return t;
}

/* With the image's CRC and hashes put right. */
static attempt try_mended(uint8_t *bytes, size_t count) {
  size_t needed;
  attempt t = attempt_of(bytes, count, &needed);
  t.status = image_mend_open(bytes, count, t.memory, needed, &t.world, &t.error);
  return t;
}

static int reason_is_good(const attempt *t) {
  return t->world == NULL && t->error.status == t->status && t->error.section <= SECTION_LAST &&
         t->error.what != NULL && t->error.what[0] != 0;
}

/* An altered copy of the image, whose CRC is put right: refused. Frees it. */
static void check_refused(uint8_t *copy, fray_status expected, uint32_t in_section) {
  image_mend_crc(copy, image_bytes);
  const attempt t = try_open(copy, image_bytes);
  CHECK_EQ_INT(t.status, expected);
  CHECK(reason_is_good(&t));
  CHECK_EQ_INT(t.error.section, in_section);
  free(t.memory);
  free(copy);
}

static fray_input input_of(uint32_t tick) {
  fray_input input;
  memset(&input, 0, sizeof input);
  input.has_pose = 3;
  input.pose[1].x = (int16_t)(tick * 300);
  input.pose[1].y = (int16_t)(-200 * (int32_t)tick);
  input.pose[1].counter = (tick + 1) & 15u;
  input.command = tick == 0 ? FRAY_COMMAND_START : FRAY_COMMAND_NONE;
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
  const attempt t = try_open(image, image_bytes);
  CHECK_EQ_INT(t.status, FRAY_OK);
  const uint64_t last = run(t.world, 60);
  CHECK(last == fray_hash(t.world));
  CHECK(fray_get_info(t.world).tick == 60);
  free(t.memory);
}

static void every_length_is_refused(void) {
  uint32_t bad = 0;
  for (size_t bytes = 0; bytes < image_bytes; ++bytes) {
    uint8_t *part = copy_of(image, bytes);
    const attempt t = try_open(part, bytes);
    bad += t.status != FRAY_TRUNCATED || !reason_is_good(&t);
    free(t.memory);
    free(part);
  }
  CHECK_EQ_INT(bad, 0);
}

static void bytes_behind_the_image_do_not_matter(void) {
  uint8_t *longer = calloc(image_bytes + 5, 1);
  if (longer == NULL) abort();
  memcpy(longer, image, image_bytes);
  const attempt t = try_open(longer, image_bytes + 5);
  CHECK_EQ_INT(t.status, FRAY_OK);
  free(t.memory);
  free(longer);
}

static void every_flipped_bit_is_refused(void) {
  uint32_t bad = 0;
  uint8_t *copy = copy_of(image, image_bytes);
  for (size_t bit = 0; bit < 8 * image_bytes; ++bit) {
    copy[bit / 8] = (uint8_t)(copy[bit / 8] ^ 1u << bit % 8);
    const attempt t = try_open(copy, image_bytes);
    bad += t.status == FRAY_OK || !reason_is_good(&t);
    copy[bit / 8] = image[bit / 8];
    free(t.memory);
  }
  free(copy);
  CHECK_EQ_INT(bad, 0);
}

/* With its CRC and hashes put right, a flipped bit is found by what it means, or means another world, that runs: some
 * of them for 200 ticks. Mends `bytes`. */
static int mended_flip_is_harmless(uint8_t *bytes, uint32_t *accepted) {
  enum { LONG = 200, SHORT = 3, LONG_EACH = 128 * TEST_FEWER, WORK_MAX = 1000000 };
  const clock_t began = clock();
  const attempt t = try_mended(bytes, image_bytes);
  const int good = t.status == FRAY_OK || reason_is_good(&t);
  if (t.status == FRAY_OK) {
    const int is_long = *accepted % LONG_EACH == 0;
    (void)hostile_run(t.world, is_long ? LONG : SHORT, WORK_MAX, is_long, FRAY_KERNEL_SCALAR, *accepted);
    *accepted += 1;
  }
  free(t.memory);
  return good && clock() - began < 2 * CLOCKS_PER_SEC;
}

static void every_mended_flip_is_harmless(void) {
  uint32_t bad = 0, accepted = 0, tried = 0;
  uint8_t *copy = copy_of(image, image_bytes);
  for (size_t bit = 0; bit < 8 * image_bytes; ++bit) {
    if (bit / 32 == IMAGE_CRC_WORD) continue;
    copy[bit / 8] = (uint8_t)(copy[bit / 8] ^ 1u << bit % 8);
    if (!mended_flip_is_harmless(copy, &accepted)) {
      bad++;
      printf("bit %zu\n", bit);
    }
    memcpy(copy, image, image_bytes);
    tried++;
  }
  free(copy);
  CHECK_EQ_INT(bad, 0);
  printf("  %u mended flips, %u accepted as another world\n", tried, accepted);
}

static void check_word(uint32_t word, uint32_t value, fray_status expected) {
  uint8_t *copy = copy_of(image, image_bytes);
  bytes_store32(copy + 4 * word, value);
  check_refused(copy, expected, 0);
}

static void headers(void) {
  check_word(IMAGE_MAGIC_WORD, 0x59415247u, FRAY_BAD_MAGIC);
  check_word(IMAGE_VERSION_WORD, 4u << 16, FRAY_BAD_VERSION);
  check_word(IMAGE_VERSION_WORD, 0u << 16, FRAY_BAD_VERSION);
  check_word(IMAGE_VERSION_WORD, FRAY_IMAGE_MAJOR << 16 | 1u, FRAY_BAD_VERSION);
  check_word(IMAGE_FEATURES_WORD, 0, FRAY_BAD_VERSION);
  check_word(IMAGE_FEATURES_WORD, IMAGE_SHORT_IDS | 2u, FRAY_BAD_VERSION);
  check_word(IMAGE_SECTIONS_WORD, SECTIONS - 1, FRAY_BAD_SECTION);
  check_word(IMAGE_BYTES_WORD, (uint32_t)image_bytes + 16u, FRAY_BAD_SECTION);
  check_word(IMAGE_CAPACITY_WORD + POOL_TRIANGLE_PAIRS, 1, FRAY_BAD_SECTION);
  check_word(IMAGE_CAPACITY_WORD + POOL_RIGID_MESH_WORDS, 1, FRAY_BAD_SECTION);
  check_word(IMAGE_CAPACITY_WORD + POOL_BLADES, 1, FRAY_BAD_SECTION);
  check_word(IMAGE_CAPACITY_WORD + POOL_PARAMS, 2, FRAY_BAD_FIELD);
  check_word(IMAGE_CAPACITY_WORD + POOL_PARTICLES, 0xFFFFFFFFu, FRAY_BAD_FIELD);
  check_word(IMAGE_CAPACITY_WORD + POOL_SPRINGS, 0, FRAY_BAD_SECTION);
}

/* The version that reads it. */
static void older_images(void) {
  uint8_t *copy = copy_of(image, image_bytes);
  bytes_store32(copy + 4 * IMAGE_VERSION_WORD, 2u << 16 | 7u);
  const attempt t = try_open(copy, image_bytes);
  CHECK(t.status == FRAY_BAD_VERSION && strcmp(t.error.what, "image version 3.0; version 2 needs fray 0.3 or 0.4") == 0);
  free(t.memory);
  free(copy);
}

/* Another id of the physics is no error; a save has that of this build. */
static void other_physics(void) {
  uint8_t *copy = copy_of(image, image_bytes), *saved = copy_of(image, image_bytes);
  bytes_store32(copy + 4 * IMAGE_PHYSICS_WORD, ~fray_physics_id());
  image_mend_crc(copy, image_bytes);
  const attempt t = try_open(copy, image_bytes), own = try_open(image, image_bytes);
  CHECK(t.status == FRAY_OK && own.status == FRAY_OK);
  CHECK(fray_get_info(t.world).physics_id == ~fray_physics_id());
  CHECK(fray_get_info(own.world).physics_id == fray_physics_id());
  CHECK(fray_hash(t.world) == fray_hash(own.world));
  CHECK(fray_save(t.world, saved, image_bytes) == image_bytes && memcmp(saved, image, image_bytes) == 0);
  free(saved);
  free(t.memory);
  free(own.memory);
  free(copy);
}

static void no_capacities_overflow(void) {
  uint8_t *copy = copy_of(image, image_bytes);
  static const uint32_t most[POOLS] = {1, 1, MAX_PARTICLES, MAX_PARTICLES, MAX_PARTICLES, MAX_SPRINGS, MAX_BATCHES,
                                       MAX_CLASSES, MAX_CLASSES, MAX_BODIES, MAX_KEYS, MAX_CONTACTS, MAX_BREAKS};
  for (uint32_t p = 0; p < POOLS_IN_HEADER; ++p)
    bytes_store32(copy + 4 * (IMAGE_CAPACITY_WORD + p), most[p]);
  bytes_store32(copy + 4 * IMAGE_FEATURES_WORD, 0);
  image_mend_crc(copy, image_bytes);
  /* a build with 16-bit ids stops at the features */
  const int narrow = sizeof(index_t) == 2;
  size_t needed = 0;
  CHECK_EQ_INT(fray_memory_size(copy, image_bytes, &needed, NULL),
               narrow ? FRAY_BAD_VERSION : FRAY_OK);
  CHECK(narrow || needed > (size_t)MAX_PARTICLES * 40u);
  check_refused(copy, narrow ? FRAY_BAD_VERSION : FRAY_BAD_SECTION, 0);
}

/* Section ids as in image/image_table.c. */
enum { ID_BATCHES = 5, ID_HOME = 7, ID_ROW_OF = 8, ID_ROW_I = 9, ID_ROW_J = 10 };

/* The first batch of two or more rows whose ends are both free. */
static uint32_t batch_of_two(uint8_t *bytes, uint32_t *first) {
  const uint8_t *batches = image_mend_section(bytes, ID_BATCHES);
  for (uint32_t b = 0;; ++b) {
    spring_batch batch;
    int32_t words[sizeof batch / 4];
    for (uint32_t n = 0; n < sizeof batch / 4; ++n)
      words[n] = (int32_t)bytes_load32(batches + sizeof batch * b + 4 * n);
    memcpy(&batch, words, sizeof batch);
    *first = (uint32_t)batch.first;
    if (batch.count >= 2 && batch.attached == 0) return b;
  }
}

static void rows_that_share_a_particle(void) {
  uint8_t *copy = copy_of(image, image_bytes);
  uint32_t first = 0;
  (void)batch_of_two(copy, &first);
  uint8_t *ends = image_mend_section(copy, ID_ROW_I);
  bytes_store16(ends + 2 * (first + SECOND_OF), bytes_load16(ends + 2 * first));
  check_refused(copy, FRAY_BAD_BATCH, ID_BATCHES);
}

static void rows_crosswise(void) {
  uint8_t *copy = copy_of(image, image_bytes);
  uint32_t first = 0;
  (void)batch_of_two(copy, &first);
  bytes_store16(image_mend_section(copy, ID_ROW_J) + 2 * (first + SECOND_OF),
                bytes_load16(image_mend_section(copy, ID_ROW_I) + 2 * first));
  check_refused(copy, FRAY_BAD_BATCH, ID_BATCHES);
}

static uint32_t rows_of(const uint8_t *bytes) {
  return bytes_load32(bytes + 4 * (IMAGE_CAPACITY_WORD + POOL_SPRINGS));
}

/* A structural and a shear row that trade their canonical numbers: still each once, but cutting
 * the one would release what does not hang on it. */
static void rows_that_trade_homes(void) {
  uint8_t *copy = copy_of(image, image_bytes);
  uint8_t *home = image_mend_section(copy, ID_HOME);
  uint8_t *row_of = image_mend_section(copy, ID_ROW_OF);
  const uint32_t last = rows_of(copy) - 1;
  const uint16_t a = bytes_load16(home);
  const uint16_t b = bytes_load16(home + 2 * last);
  bytes_store16(home, b);
  bytes_store16(home + 2 * last, a);
  bytes_store16(row_of + 2 * b, 0);
  bytes_store16(row_of + 2 * a, (uint16_t)last);
  check_refused(copy, FRAY_BAD_FIELD, ID_HOME);
}

static void check_batch_word(uint32_t word, uint32_t add) {
  uint8_t *copy = copy_of(image, image_bytes);
  uint32_t first = 0;
  const uint32_t b = batch_of_two(copy, &first);
  uint8_t *place = image_mend_section(copy, ID_BATCHES) + sizeof(spring_batch) * b + 4 * word;
  bytes_store32(place, (uint32_t)((uint64_t)bytes_load32(place) + add) & 0xFFFFFFFFu);
  check_refused(copy, FRAY_BAD_BATCH, ID_BATCHES);
}

static void batches_that_overlap_or_gape(void) {
  const uint32_t first = offsetof(spring_batch, first) / 4, count = offsetof(spring_batch, count) / 4;
  check_batch_word(first, 1);
  check_batch_word(first, 0xFFFFFFFFu);
  check_batch_word(count, 1);
  check_batch_word(count, 0xFFFFFFFFu);
  check_batch_word(count, 0x7FFFFFFFu);
  check_batch_word(count, 0x80000000u);
  check_batch_word(offsetof(spring_batch, attached) / 4, 1);
}

static void ids_out_of_range(void) {
  uint8_t *copy = copy_of(image, image_bytes);
  bytes_store16(image_mend_section(copy, ID_ROW_I), 0xFFFF);
  check_refused(copy, FRAY_BAD_FIELD, ID_ROW_I);
  copy = copy_of(image, image_bytes);
  bytes_store16(image_mend_section(copy, ID_ROW_OF), 0xFFFF);
  check_refused(copy, FRAY_BAD_FIELD, 7);
}

static void memory_too_small_or_crooked(void) {
  size_t needed = 0;
  fray_error error;
  CHECK_EQ_INT(fray_memory_size(image, image_bytes, &needed, &error), FRAY_OK);
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
  CHECK_EQ_INT(fray_memory_size(NULL, 100, &needed, &error), FRAY_BAD_ARGUMENT);
  CHECK_EQ_INT(fray_memory_size(image, image_bytes, NULL, &error), FRAY_BAD_ARGUMENT);
  CHECK_EQ_INT(fray_open(NULL, 100, memory, sizeof memory, &world, &error), FRAY_BAD_ARGUMENT);
  CHECK(world == NULL);
  CHECK_EQ_INT(fray_open(image, image_bytes, NULL, 100, &world, &error), FRAY_BAD_ARGUMENT);
  CHECK_EQ_INT(fray_open(image, image_bytes, memory, 64, NULL, &error), FRAY_BAD_ARGUMENT);
}

/* Wherever an image lies, it is the same world. */
static void at_odd_addresses(void) {
  uint64_t hashes[5];
  for (uint32_t off = 0; off < 5; ++off) {
    uint8_t *copy = malloc(image_bytes + off);
    if (copy == NULL) abort();
    memcpy(copy + off, image, image_bytes);
    const attempt t = try_open(copy + off, image_bytes);
    CHECK_EQ_INT(t.status, FRAY_OK);
    hashes[off] = run(t.world, 60);
    CHECK(hashes[off] == hashes[0]);
    free(t.memory);
    free(copy);
  }
}

static void a_save_is_the_image(void) {
  const attempt t = try_open(image, image_bytes);
  CHECK_EQ_INT(t.status, FRAY_OK);
  CHECK_EQ_INT(fray_save_bytes(t.world), image_bytes);
  uint8_t *saved = copy_of(image, image_bytes);
  memset(saved, 0xA5, image_bytes);
  CHECK_EQ_INT(fray_save(t.world, saved, image_bytes - 1), 0);
  CHECK_EQ_INT(fray_save(t.world, NULL, image_bytes), 0);
  CHECK_EQ_INT(saved[0], 0xA5);
  CHECK_EQ_INT(fray_save(t.world, saved, image_bytes), image_bytes);
  CHECK_EQ_INT(memcmp(saved, image, image_bytes), 0);
  free(t.memory);
  free(saved);
}

static int compile(const char *text) {
  static scene s;
  scene_error error;
  compile_report report;
  memset(&error, 0, sizeof error);
  if (scene_parse("tiny", text, strlen(text), &s, &error) &&
      compile_image(&s, "tiny", &image, &image_bytes, &report, NULL, NULL, &error))
    return 1;
  printf("tiny:%d:%d: %s\n", error.line, error.column, error.message);
  return 0;
}

static void more_particles_than_the_pool_has(void) {
  enum { IN_PARAMS = 1, IN_YARN_STATE = 29 };
  uint8_t *bytes = copy_of(image, image_bytes);
  bytes_store32(image_mend_section(bytes, IN_YARN_STATE), 1000);
  check_refused(bytes, FRAY_BAD_FIELD, IN_PARAMS);
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
  check_word(IMAGE_CAPACITY_WORD + POOL_YARN_GAINS, 0, FRAY_BAD_SECTION);
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
  TEST(older_images);
  TEST(other_physics);
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
