/* SPDX-License-Identifier: Apache-2.0 */
/* The hash of a state, the CRC of an image, and the random numbers of thresholds. The literals
 * come from another implementation, in arbitrary-precision integers: they pin the functions, since
 * every recording and every image depends on them. */
#include "rt/base/bytes.h"
#include "rt/base/hash.h"
#include "rt/base/random.h"
#include "tests/lib/splitmix64.h"
#include "tests/lib/test.h"

static uint64_t hash_of(const int32_t *words, uint32_t count) {
  hash h;
  hash_begin(&h);
  hash_words(&h, words, count);
  return hash_end(&h);
}

static void the_hash_is_pinned(void) {
  static const int32_t zero[] = {0};
  static const int32_t ten[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
  static const int32_t ends[] = {-1, INT32_MIN, INT32_MAX};
  hash h;
  CHECK(hash_of(zero, 0) == 0xD2C1BBCE23A8FD13u);
  CHECK(hash_of(zero, 1) == 0x94EC5BA9964A9240u);
  CHECK(hash_of(ten, 10) == 0x5A157245AE926948u);
  CHECK(hash_of(ends, 3) == 0x1579D2C8A979854Eu);
  /* a second array starts at lane 0 again */
  hash_begin(&h);
  hash_words(&h, ten, 3);
  hash_words(&h, ten + 3, 2);
  CHECK(hash_end(&h) == 0x061028EB0474D90Au);
}

static void the_entries_of_a_set_are_pinned(void) {
  CHECK(hash_entry(1, 0, 0) == 0xE220A8397B1DCDAFu);
  CHECK(hash_entry(1, 12345, 0) == 0x8F190AFCA4F30EBFu);
  CHECK(hash_entry(7, 0xFFFFFFFFu, 0xFFFFFFFFu) == 0xF14F2CF802083FA5u);
}

static void random_numbers_are_pinned(void) {
  CHECK_EQ_INT(random_bits(0, 0), 0xD1CB73ECu);
  CHECK_EQ_INT(random_bits(1, 2), 0x7EA31C5Cu);
  CHECK_EQ_INT(random_bits(20091, 6280), 0x87CFF459u);
  CHECK_EQ_INT(random_between(3, 4, -5, 5), 4);
  /* thresholds: both ends are reached, nothing lies outside, the mean is in the middle */
  int32_t low = 100;
  int32_t high = -100;
  int64_t sum = 0;
  for (uint32_t n = 0; n < 100000; ++n) {
    const int32_t v = random_between(9, n, 10, 20);
    low = v < low ? v : low;
    high = v > high ? v : high;
    sum += v;
  }
  CHECK_EQ_INT(low, 10);
  CHECK_EQ_INT(high, 20);
  /* 100,000 draws of a standard deviation of 3.16: 6 deviations of the sum are 6,000 */
  CHECK(sum > 1494000 && sum < 1506000);
}

/* Bytes count as signed words. */
static void bytes_are_words(void) {
  int8_t bytes[40];
  int32_t words[40];
  for (uint32_t n = 0; n < 40; ++n) words[n] = bytes[n] = (int8_t)(n * 37u % 256u - 128u);
  for (uint32_t count = 0; count <= 40; ++count) {
    hash h;
    hash_begin(&h);
    hash_bytes(&h, bytes, count);
    CHECK(hash_end(&h) == hash_of(words, count));
  }
}

/* Every step is a bijection of its lane, so no single change can go unseen. */
static void every_changed_word_changes_the_hash(void) {
  int32_t words[70];
  uint64_t seed = 4;
  uint32_t unseen = 0;
  uint32_t changes = 0;
  for (uint32_t n = 0; n < 70; ++n) words[n] = (int32_t)(uint32_t)(splitmix64(&seed) & 0xFFFFFFFFu);
  for (uint32_t count = 1; count <= 70; ++count) {
    const uint64_t before = hash_of(words, count);
    for (uint32_t n = 0; n < count; ++n)
      for (uint32_t bit = 0; bit < 36; ++bit) {
        const int32_t kept = words[n];
        const uint32_t flip = bit < 32 ? (uint32_t)1 << bit : (uint32_t)(splitmix64(&seed) >> 32) | 1u;
        words[n] = (int32_t)((uint32_t)words[n] ^ flip);
        unseen += hash_of(words, count) == before;
        ++changes;
        words[n] = kept;
      }
  }
  printf("figure hash_unseen_changes %u (asked: 0 of %u)\n", unseen, changes);
  CHECK_EQ_INT(unseen, 0);
}

static void the_crc_is_iso_3309(void) {
  static const uint8_t zeros[32] = {0};
  CHECK_EQ_INT(bytes_crc32((const uint8_t *)"123456789", 9), 0xCBF43926u);
  CHECK_EQ_INT(bytes_crc32(zeros, 0), 0);
  CHECK_EQ_INT(bytes_crc32((const uint8_t *)"a", 1), 0xE8B7BE43u);
  CHECK_EQ_INT(bytes_crc32(zeros, 32), 0x190A55ADu);
}

static void words_are_little_endian(void) {
  uint8_t b[4];
  bytes_store32(b, 0x12345678u);
  CHECK_EQ_INT(b[0], 0x78);
  CHECK_EQ_INT(b[3], 0x12);
  CHECK_EQ_INT(bytes_load32(b), 0x12345678);
  bytes_store16(b, 0xABCDu);
  CHECK_EQ_INT(b[0], 0xCD);
  CHECK_EQ_INT(bytes_load16(b), 0xABCD);
}

int main(void) {
  TEST(the_hash_is_pinned);
  TEST(the_entries_of_a_set_are_pinned);
  TEST(random_numbers_are_pinned);
  TEST(bytes_are_words);
  TEST(every_changed_word_changes_the_hash);
  TEST(the_crc_is_iso_3309);
  TEST(words_are_little_endian);
  return test_end();
}
