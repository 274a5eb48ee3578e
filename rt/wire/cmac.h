/* SPDX-License-Identifier: Apache-2.0 */
/* AES-128 (FIPS-197, encryption only) and AES-CMAC (RFC 4493, NIST SP 800-38B).
 *
 * Constant time: no branch and no address depends on the key, the data or the tag, so neither time
 * nor caches tell them. The state is held as 8 planes of 16 bits, bit n of plane b is bit b of byte
 * n, and the S-box is a circuit of 115 gates. The number of instructions depends on `bytes` alone;
 * tests/bus/cmac_constant.sh counts them, and has memcheck follow key and data.
 *
 * Power and fault attacks on the part itself are not considered. */
#ifndef FRAY_WIRE_CMAC_H
#define FRAY_WIRE_CMAC_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { CMAC_KEY = 16, CMAC_BLOCK = 16, CMAC_ROUNDS = 10, CMAC_PLANES = 8 };

/* A key, expanded: 208 bytes, as secret as the key. */
typedef struct {
  uint16_t round[CMAC_ROUNDS + 1][CMAC_PLANES];
  uint8_t whole[CMAC_BLOCK]; /* K1, for a last block that is full */
  uint8_t part[CMAC_BLOCK];  /* K2, for one that is padded */
} cmac_key;

/* Cost: 20 S-boxes of the whole state. */
void cmac_key_init(cmac_key *key, const uint8_t bytes[CMAC_KEY]);

/* One block; out may be in. Cost: 10 S-boxes. */
void cmac_encrypt(const cmac_key *key, const uint8_t in[CMAC_BLOCK], uint8_t out[CMAC_BLOCK]);

/* The tag of a message; data is not read if bytes is 0. Cost: one block for every 16 bytes begun,
 * at least one. */
void cmac_tag(const cmac_key *key, const uint8_t *data, uint32_t bytes, uint8_t tag[CMAC_BLOCK]);

/* 0 iff equal; looks at every byte. */
uint32_t cmac_differs(const uint8_t *a, const uint8_t *b, uint32_t bytes);

#ifdef __cplusplus
}
#endif
#endif
