/* SPDX-License-Identifier: Apache-2.0 */
/* Vectors of FIPS-197 (appendices A.1, B, C.1), NIST SP 800-38A (F.1.1) and RFC 4493 (section 4),
 * copied from the documents. */
#include "rt/wire/cmac.h"

#include "tests/lib/rfc4493_key.h"
#include "tests/lib/test.h"

/* The key of RFC 4493, SP 800-38A and FIPS-197 A.1 and B. */
static const uint8_t TEXT[64] = {
    0x6b, 0xc1, 0xbe, 0xe2, 0x2e, 0x40, 0x9f, 0x96, 0xe9, 0x3d, 0x7e, 0x11, 0x73, 0x93, 0x17, 0x2a,
    0xae, 0x2d, 0x8a, 0x57, 0x1e, 0x03, 0xac, 0x9c, 0x9e, 0xb7, 0x6f, 0xac, 0x45, 0xaf, 0x8e, 0x51,
    0x30, 0xc8, 0x1c, 0x46, 0xa3, 0x5c, 0xe4, 0x11, 0xe5, 0xfb, 0xc1, 0x19, 0x1a, 0x0a, 0x52, 0xef,
    0xf6, 0x9f, 0x24, 0x45, 0xdf, 0x4f, 0x9b, 0x17, 0xad, 0x2b, 0x41, 0x7b, 0xe6, 0x6c, 0x37, 0x10};

static void check_hex(const uint8_t *data, const char *expected) {
  char text[33];
  for (int n = 0; n < 16; ++n) snprintf(text + 2 * n, 3, "%02x", data[n]);
  CHECK_TEXT(text, expected);
}

static void check_block(const uint8_t key_bytes[16], const uint8_t in[16], const char *expected) {
  cmac_key key;
  uint8_t out[16];
  cmac_key_init(&key, key_bytes);
  cmac_encrypt(&key, in, out);
  check_hex(out, expected);
}

static void fips_197_c1(void) {
  uint8_t key[16], in[16];
  for (int n = 0; n < 16; ++n) {
    key[n] = (uint8_t)n;
    in[n] = (uint8_t)(17 * n);
  }
  check_block(key, in, "69c4e0d86a7b0430d8cdb78070b4c55a");
}

static void fips_197_b(void) {
  static const uint8_t IN[16] = {0x32, 0x43, 0xf6, 0xa8, 0x88, 0x5a, 0x30, 0x8d,
                                 0x31, 0x31, 0x98, 0xa2, 0xe0, 0x37, 0x07, 0x34};
  check_block(RFC4493_KEY, IN, "3925841d02dc09fbdc118597196a0b32");
}

static void sp_800_38a_f11(void) {
  check_block(RFC4493_KEY, TEXT, "3ad77bb40d7a3660a89ecaf32466ef97");
  check_block(RFC4493_KEY, TEXT + 16, "f5d3d58503b9699de785895a96fdbaaf");
  check_block(RFC4493_KEY, TEXT + 32, "43b1cd7f598ece23881b00e3ed030688");
  check_block(RFC4493_KEY, TEXT + 48, "7b0c785e27e8ad3f8223207104725dd4");
}

static void a_block_in_place(void) {
  cmac_key key;
  uint8_t block[16];
  cmac_key_init(&key, RFC4493_KEY);
  memcpy(block, TEXT, sizeof block);
  cmac_encrypt(&key, block, block);
  check_hex(block, "3ad77bb40d7a3660a89ecaf32466ef97");
}

/* The last round key of FIPS-197 A.1, out of its planes. */
static void key_schedule(void) {
  cmac_key key;
  uint8_t bytes[16];
  cmac_key_init(&key, RFC4493_KEY);
  for (unsigned n = 0; n < 16; ++n) {
    bytes[n] = 0;
    for (unsigned b = 0; b < 8; ++b) {
      bytes[n] |= (uint8_t)(((uint32_t)key.round[10][b] >> n & 1u) << b);
    }
  }
  check_hex(bytes, "d014f9a8c9ee2589e13f0cc8b6630ca6");
}

static void subkeys_of_rfc_4493(void) {
  cmac_key key;
  cmac_key_init(&key, RFC4493_KEY);
  check_hex(key.whole, "fbeed618357133667c85e08f7236a8de");
  check_hex(key.part, "f7ddac306ae266ccf90bc11ee46d513b");
}

static void tags_of_rfc_4493(void) {
  static const struct {
    uint32_t bytes;
    const char *tag;
  } VECTORS[4] = {{0, "bb1d6929e95937287fa37d129b756746"},
                  {16, "070a16b46b4d4144f79bdd9dd04a287c"},
                  {40, "dfa66747de9ae63030ca32611497c827"},
                  {64, "51f0bebf7e3b9d92fc49741779363cfe"}};
  cmac_key key;
  cmac_key_init(&key, RFC4493_KEY);
  for (int n = 0; n < 4; ++n) {
    uint8_t tag[16];
    cmac_tag(&key, VECTORS[n].bytes == 0 ? NULL : TEXT, VECTORS[n].bytes, tag);
    check_hex(tag, VECTORS[n].tag);
  }
}

/* AES by its definition: bytes, a product bit by bit, an inverse by search. */

static uint8_t plain_product(unsigned a, unsigned b) {
  unsigned p = 0;
  for (int n = 0; n < 8; ++n) {
    if ((b >> n & 1u) != 0) p ^= a;
    a = (a << 1 ^ ((a & 0x80u) != 0 ? 0x11Bu : 0u)) & 0xFFu;
  }
  return (uint8_t)p;
}

static uint8_t plain_box[256];

static void plain_box_fill(void) {
  for (unsigned a = 0; a < 256; ++a) {
    unsigned inverse = 0;
    for (unsigned b = 1; b < 256 && a != 0; ++b) {
      if (plain_product(a, b) == 1) inverse = b;
    }
    unsigned s = 0x63;
    for (unsigned n = 0; n < 5; ++n) s ^= (inverse << n | inverse >> (8 - n)) & 0xFFu;
    plain_box[a] = (uint8_t)s;
  }
}

static void plain_rows_and_columns(uint8_t s[16], int mixes) {
  uint8_t t[16];
  for (int n = 0; n < 16; ++n) t[n] = plain_box[s[(n + 4 * (n % 4)) % 16]];
  for (int n = 0; n < 16; ++n) {
    const int c = n / 4 * 4;
    const int r = n % 4;
    s[n] = !mixes ? t[n]
                  : (uint8_t)(plain_product(t[n], 2) ^ plain_product(t[c + (r + 1) % 4], 3) ^
                              t[c + (r + 2) % 4] ^ t[c + (r + 3) % 4]);
  }
}

static void plain_encrypt(const uint8_t key[16], const uint8_t in[16], uint8_t out[16]) {
  uint8_t k[16];
  unsigned constant = 1;
  memcpy(k, key, 16);
  for (int n = 0; n < 16; ++n) out[n] = in[n] ^ k[n];
  for (int round = 1; round <= 10; ++round) {
    plain_rows_and_columns(out, round < 10);
    for (int n = 0; n < 4; ++n) k[n] ^= plain_box[k[12 + (n + 1) % 4]];
    k[0] ^= (uint8_t)constant;
    for (int n = 4; n < 16; ++n) k[n] ^= k[n - 4];
    for (int n = 0; n < 16; ++n) out[n] ^= k[n];
    constant = plain_product(constant, 2);
  }
}

static void random_bytes(uint8_t *to, uint32_t bytes, uint32_t seed) {
  uint32_t state = seed;
  for (uint32_t n = 0; n < bytes; ++n) {
    state = (uint32_t)((uint64_t)state * 1664525u + 1013904223u);
    to[n] = (uint8_t)(state >> 24);
  }
}

/* All 256 values in every place of the state, and random keys: 20,000 blocks. */
static void blocks_by_the_definition(void) {
  plain_box_fill();
  CHECK_EQ_INT(plain_box[0x53], 0xED); /* FIPS-197, 5.1.1 */
  int wrong = 0;
  for (uint32_t n = 0; n < 20000; ++n) {
    uint8_t key_bytes[16], in[16], expected[16], out[16];
    cmac_key key;
    random_bytes(key_bytes, 16, n / 256);
    for (uint32_t b = 0; b < 16; ++b) in[b] = (uint8_t)(key_bytes[b] ^ (n + 11 * b));
    plain_encrypt(key_bytes, in, expected);
    cmac_key_init(&key, key_bytes);
    cmac_encrypt(&key, in, out);
    wrong += memcmp(out, expected, 16) != 0;
  }
  CHECK_EQ_INT(wrong, 0);
}

/* No two lengths of zeros have one tag, and a longer buffer does not change a shorter message. */
static void every_length_has_its_tag(void) {
  enum { LENGTHS = 50 };
  static uint8_t tags[LENGTHS][16];
  uint8_t zeros[LENGTHS] = {0};
  cmac_key key;
  cmac_key_init(&key, RFC4493_KEY);
  for (uint32_t n = 0; n < LENGTHS; ++n) {
    cmac_tag(&key, zeros, n, tags[n]);
    for (uint32_t m = 0; m < n; ++m) CHECK(cmac_differs(tags[n], tags[m], 16) != 0);
  }
  zeros[17] = 1;
  uint8_t tag[16];
  cmac_tag(&key, zeros, 17, tag);
  CHECK_EQ_INT(cmac_differs(tag, tags[17], 16), 0);
  cmac_tag(&key, zeros, 18, tag);
  CHECK(cmac_differs(tag, tags[18], 16) != 0);
}

static void differences_are_seen_in_every_bit(void) {
  uint8_t a[16], b[16];
  memcpy(a, RFC4493_KEY, sizeof a);
  memcpy(b, RFC4493_KEY, sizeof b);
  CHECK_EQ_INT(cmac_differs(a, b, 16), 0);
  for (int bit = 0; bit < 128; ++bit) {
    b[bit / 8] ^= (uint8_t)(1 << bit % 8);
    CHECK(cmac_differs(a, b, 16) != 0);
    b[bit / 8] ^= (uint8_t)(1 << bit % 8);
  }
  b[8] ^= 1;
  CHECK_EQ_INT(cmac_differs(a, b, 8), 0);
}

int main(void) {
  TEST(fips_197_c1);
  TEST(fips_197_b);
  TEST(sp_800_38a_f11);
  TEST(a_block_in_place);
  TEST(key_schedule);
  TEST(subkeys_of_rfc_4493);
  TEST(tags_of_rfc_4493);
  TEST(blocks_by_the_definition);
  TEST(every_length_has_its_tag);
  TEST(differences_are_seen_in_every_bit);
  printf("figure cmac_vectors %d tests of FIPS-197, SP 800-38A and RFC 4493 pass, %d fail (asked: 0)\n",
         test_passed, test_failed);
  return test_end();
}
