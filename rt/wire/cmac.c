/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/wire/cmac.h"

#include "rt/base/assert.h"
#include "rt/base/bytes.h"

enum { PLANES = CMAC_PLANES, MASK = 0xFFFF };

/* Byte n of a block is column n / 4 and row n % 4 of the state, and bit n of each plane: a column is a
 * nibble of a plane, a row every fourth bit. */
typedef struct {
  uint32_t at[PLANES];
} planes;

/* The 8 x 8 bits of 8 bytes, turned about the diagonal (H. S. Warren, Hacker's Delight, 7-3). */
static uint64_t cmac_transpose(uint64_t x) {
  uint64_t t = (x ^ x >> 7) & UINT64_C(0x00AA00AA00AA00AA);
  x ^= t ^ t << 7;
  t = (x ^ x >> 14) & UINT64_C(0x0000CCCC0000CCCC);
  x ^= t ^ t << 14;
  t = (x ^ x >> 28) & UINT64_C(0x00000000F0F0F0F0);
  return x ^ t ^ t << 28;
}

static uint64_t cmac_load64(const uint8_t *p) {
  return (uint64_t)bytes_load32(p) | (uint64_t)bytes_load32(p + 4) << 32;
}

static void cmac_store64(uint8_t *p, uint64_t v) {
  bytes_store32(p, (uint32_t)(v & 0xFFFFFFFFu));
  bytes_store32(p + 4, (uint32_t)(v >> 32));
}

static void cmac_slice(planes *s, const uint8_t block[CMAC_BLOCK]) {
  const uint64_t low = cmac_transpose(cmac_load64(block));
  const uint64_t high = cmac_transpose(cmac_load64(block + 8));
  for (uint32_t b = 0; b < PLANES; ++b) {
    s->at[b] = (uint32_t)(low >> 8 * b & 0xFF) | (uint32_t)(high >> 8 * b & 0xFF) << 8;
  }
}

static void cmac_unslice(const planes *s, uint8_t block[CMAC_BLOCK]) {
  uint64_t low = 0, high = 0;
  for (uint32_t b = 0; b < PLANES; ++b) {
    low |= (uint64_t)(s->at[b] & 0xFF) << 8 * b;
    high |= (uint64_t)(s->at[b] >> 8 & 0xFF) << 8 * b;
  }
  cmac_store64(block, cmac_transpose(low));
  cmac_store64(block + 8, cmac_transpose(high));
}

/* The S-box, 16 bytes at a time, is the circuit of J. Boyar and R. Peralta, "A depth-16 circuit for
 * the AES S-box" (IACR ePrint 2011/332), with its names: into the tower field, inversion and
 * products there, and back with the affine map. x0 and s0 are the top bits.
 * tests/unit/test_cmac.c tries all 256 bytes against the definition. */
static void cmac_sbox_in(const planes *p, uint32_t y[22]) {
  const uint32_t x0 = p->at[7], x1 = p->at[6], x2 = p->at[5], x3 = p->at[4];
  const uint32_t x4 = p->at[3], x5 = p->at[2], x6 = p->at[1], x7 = p->at[0];
  const uint32_t t0 = x1 ^ x2;
  y[0] = x7;
  y[14] = x3 ^ x5;
  y[13] = x0 ^ x6;
  y[9] = x0 ^ x3;
  y[8] = x0 ^ x5;
  y[1] = t0 ^ x7;
  y[4] = y[1] ^ x3;
  y[12] = y[13] ^ y[14];
  y[2] = y[1] ^ x0;
  y[5] = y[1] ^ x6;
  y[3] = y[5] ^ y[8];
  const uint32_t t1 = x4 ^ y[12];
  y[15] = t1 ^ x5;
  y[20] = t1 ^ x1;
  y[6] = y[15] ^ x7;
  y[10] = y[15] ^ t0;
  y[11] = y[20] ^ y[9];
  y[7] = x7 ^ y[11];
  y[17] = y[10] ^ y[11];
  y[19] = y[10] ^ y[8];
  y[16] = t0 ^ y[11];
  y[21] = y[13] ^ y[16];
  y[18] = x0 ^ y[16];
}

static void cmac_sbox_invert(const uint32_t y[22], uint32_t z[18]) {
  const uint32_t t2 = y[12] & y[15], t7 = y[13] & y[16], t12 = y[9] & y[11];
  const uint32_t t14 = (y[14] & y[17]) ^ t12, t16 = (y[8] & y[10]) ^ t12;
  const uint32_t t21 = (y[3] & y[6]) ^ t2 ^ t14 ^ y[20];
  const uint32_t t22 = (y[4] & y[0]) ^ t2 ^ t16 ^ y[19];
  const uint32_t t23 = (y[5] & y[1]) ^ t7 ^ t14 ^ y[21];
  const uint32_t t24 = (y[2] & y[7]) ^ t7 ^ t16 ^ y[18];
  const uint32_t t25 = t21 ^ t22, t26 = t21 & t23, t27 = t24 ^ t26;
  const uint32_t t29 = (t25 & t27) ^ t22;
  const uint32_t t33 = ((t22 ^ t26) & (t23 ^ t24)) ^ t24;
  const uint32_t t36 = t24 & (t27 ^ t33);
  const uint32_t t37 = t36 ^ t23 ^ t33;
  const uint32_t t40 = t25 ^ (t29 & (t27 ^ t36));
  const uint32_t t41 = t40 ^ t37, t42 = t29 ^ t33, t43 = t29 ^ t40, t44 = t33 ^ t37;
  const uint32_t t45 = t42 ^ t41;
  z[0] = t44 & y[15];
  z[1] = t37 & y[6];
  z[2] = t33 & y[0];
  z[3] = t43 & y[16];
  z[4] = t40 & y[1];
  z[5] = t29 & y[7];
  z[6] = t42 & y[11];
  z[7] = t45 & y[17];
  z[8] = t41 & y[10];
  z[9] = t44 & y[12];
  z[10] = t37 & y[3];
  z[11] = t33 & y[4];
  z[12] = t43 & y[13];
  z[13] = t40 & y[5];
  z[14] = t29 & y[2];
  z[15] = t42 & y[9];
  z[16] = t45 & y[14];
  z[17] = t41 & y[8];
}

static void cmac_sbox_out(const uint32_t z[18], planes *p) {
  const uint32_t t46 = z[15] ^ z[16], t48 = z[5] ^ z[13];
  const uint32_t t53 = z[0] ^ z[3], t54 = z[6] ^ z[7];
  const uint32_t t57 = z[2] ^ z[12] ^ t53, t58 = z[4] ^ t46, t59 = z[3] ^ t54;
  const uint32_t t62 = z[7] ^ z[8] ^ t58, t63 = z[9] ^ z[10] ^ t58;
  const uint32_t t64 = z[4] ^ t59, t65 = z[14] ^ t57 ^ t62, t66 = z[1] ^ t63;
  const uint32_t s3 = t53 ^ t66;
  p->at[7] = t59 ^ t63;
  p->at[6] = t64 ^ s3 ^ MASK;
  p->at[5] = z[16] ^ z[17] ^ t64 ^ t65 ^ MASK;
  p->at[4] = s3;
  p->at[3] = z[2] ^ z[5] ^ t66;
  p->at[2] = z[10] ^ z[11] ^ t65;
  p->at[1] = z[12] ^ t48 ^ t62 ^ MASK;
  p->at[0] = t48 ^ t46 ^ t57 ^ MASK;
}

static void cmac_sub_bytes(planes *s) {
  uint32_t y[22], z[18];
  FRAY_ASSERT((s->at[0] | s->at[1] | s->at[2] | s->at[3]) <= MASK);
  FRAY_ASSERT((s->at[4] | s->at[5] | s->at[6] | s->at[7]) <= MASK);
  cmac_sbox_in(s, y);
  cmac_sbox_invert(y, z);
  cmac_sbox_out(z, s);
}

/* Row r turns by r columns: 4r bits of a plane. */
static void cmac_shift_rows(planes *s) {
  for (uint32_t b = 0; b < PLANES; ++b) {
    const uint32_t twice = s->at[b] | s->at[b] << 16;
    s->at[b] = (twice & 0x1111) | (twice >> 4 & 0x2222) | (twice >> 8 & 0x4444) |
               (twice >> 12 & 0x8888);
  }
}

/* Each row of a column moves to the place of the one above it. */
static uint32_t cmac_rows_up(uint32_t p) { return (p >> 1 & 0x7777) | (p << 3 & 0x8888); }

/* With up(a) = a, each row moved to the place of the one above: 2 (a + up a) + up (a + up (a + up a)).
 * Doubling moves every plane up by one; the top one is added to the planes of 0x1B. */
static void cmac_mix_columns(planes *s) {
  uint32_t sum[PLANES] = {0}; /* gcc's analyzer does not see that the loop fills it */
  for (uint32_t b = 0; b < PLANES; ++b) sum[b] = s->at[b] ^ cmac_rows_up(s->at[b]);
  for (uint32_t b = 0; b < PLANES; ++b) {
    const uint32_t doubled = b == 0 ? sum[7] : sum[b - 1];
    const uint32_t reduced = b == 1 || b == 3 || b == 4 ? sum[7] : 0;
    const uint32_t rest = cmac_rows_up(s->at[b] ^ cmac_rows_up(sum[b]));
    s->at[b] = doubled ^ reduced ^ rest;
  }
}

static void cmac_add_key(planes *s, const uint16_t round[PLANES]) {
  for (uint32_t b = 0; b < PLANES; ++b) s->at[b] ^= round[b];
}

void cmac_encrypt(const cmac_key *key, const uint8_t in[CMAC_BLOCK], uint8_t out[CMAC_BLOCK]) {
  FRAY_ASSERT(key != NULL && in != NULL && out != NULL);
  planes s;
  cmac_slice(&s, in);
  cmac_add_key(&s, key->round[0]);
  for (uint32_t n = 1; n < CMAC_ROUNDS; ++n) {
    cmac_sub_bytes(&s);
    cmac_shift_rows(&s);
    cmac_mix_columns(&s);
    cmac_add_key(&s, key->round[n]);
  }
  cmac_sub_bytes(&s);
  cmac_shift_rows(&s);
  cmac_add_key(&s, key->round[CMAC_ROUNDS]);
  cmac_unslice(&s, out);
}

/* FIPS-197, 5.2, on planes: the last column, substituted and turned by one row, is added to the
 * first with the round's constant; then every column takes the sum of those up to it. */
static void cmac_expand(cmac_key *key, const uint8_t bytes[CMAC_KEY]) {
  FRAY_ASSERT(key != NULL && bytes != NULL);
  static const uint8_t CONSTANTS[CMAC_ROUNDS] = {0x01, 0x02, 0x04, 0x08, 0x10,
                                                 0x20, 0x40, 0x80, 0x1B, 0x36};
  planes k;
  cmac_slice(&k, bytes);
  for (uint32_t n = 0; n <= CMAC_ROUNDS; ++n) {
    for (uint32_t b = 0; b < PLANES; ++b) key->round[n][b] = (uint16_t)k.at[b];
    if (n == CMAC_ROUNDS) break;
    planes sub = k;
    cmac_sub_bytes(&sub);
    for (uint32_t b = 0; b < PLANES; ++b) {
      const uint32_t turned = cmac_rows_up(sub.at[b]) >> 12;
      uint32_t next = k.at[b] ^ turned ^ ((uint32_t)CONSTANTS[n] >> b & 1u);
      next ^= next << 4 & MASK;
      k.at[b] = next ^ (next << 8 & MASK);
    }
  }
}

/* Times x in GF(2^128), bytes from the top, reduced by 0x87. */
static void cmac_double(const uint8_t in[CMAC_BLOCK], uint8_t out[CMAC_BLOCK]) {
  const uint32_t top = (uint32_t)in[0] >> 7;
  for (uint32_t n = 0; n < CMAC_BLOCK; ++n) {
    const uint32_t below = n + 1 < CMAC_BLOCK ? (uint32_t)in[n + 1] >> 7 : 0;
    out[n] = (uint8_t)(((uint32_t)in[n] << 1 & 0xFEu) | below);
  }
  out[CMAC_BLOCK - 1] = (uint8_t)(out[CMAC_BLOCK - 1] ^ (top | top << 1 | top << 2 | top << 7));
}

void cmac_key_init(cmac_key *key, const uint8_t bytes[CMAC_KEY]) {
  FRAY_ASSERT(key != NULL && bytes != NULL);
  uint8_t zero[CMAC_BLOCK];
  cmac_expand(key, bytes);
  bytes_zero(zero, sizeof zero);
  cmac_encrypt(key, zero, zero);
  cmac_double(zero, key->whole);
  cmac_double(key->whole, key->part);
}

static void cmac_mix_in(uint8_t state[CMAC_BLOCK], const uint8_t *data, uint32_t bytes) {
  FRAY_ASSERT(bytes <= CMAC_BLOCK);
  for (uint32_t n = 0; n < bytes; ++n) state[n] = (uint8_t)(state[n] ^ data[n]);
}

void cmac_tag(const cmac_key *key, const uint8_t *data, uint32_t bytes, uint8_t tag[CMAC_BLOCK]) {
  FRAY_ASSERT(key != NULL && tag != NULL);
  FRAY_ASSERT(data != NULL || bytes == 0);
  uint8_t state[CMAC_BLOCK];
  uint32_t from = 0;
  bytes_zero(state, sizeof state);
  for (; bytes - from > CMAC_BLOCK; from += CMAC_BLOCK) {
    cmac_mix_in(state, data + from, CMAC_BLOCK);
    cmac_encrypt(key, state, state);
  }
  const uint32_t rest = bytes - from;
  FRAY_ASSERT(rest <= CMAC_BLOCK);
  if (rest > 0) cmac_mix_in(state, data + from, rest);
  if (rest == CMAC_BLOCK) {
    cmac_mix_in(state, key->whole, CMAC_BLOCK);
  } else {
    state[rest] ^= 0x80u;
    cmac_mix_in(state, key->part, CMAC_BLOCK);
  }
  cmac_encrypt(key, state, tag);
}

uint32_t cmac_differs(const uint8_t *a, const uint8_t *b, uint32_t bytes) {
  FRAY_ASSERT(a != NULL && b != NULL);
  uint32_t difference = 0;
  for (uint32_t n = 0; n < bytes; ++n) difference |= (uint32_t)(a[n] ^ b[n]);
  return difference;
}
