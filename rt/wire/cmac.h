/* SPDX-License-Identifier: Apache-2.0 */
/* AES-128 (FIPS-197, encryption only) and AES-CMAC (RFC 4493, NIST SP 800-38B).
 *
 * Constant time: no branch and no address depends on the key, the data or the tag, so neither time
 * nor caches reveal them. The state is held as 8 planes of 16 bits, bit n of plane b is bit b of byte
 * n, and the S-box is a circuit of 115 gates. The number of instructions depends on `bytes` alone;
 * tests/bus/cmac_constant.sh counts them, and has memcheck follow key and data.
 *
 * Power and fault attacks on the part itself are not considered.
 *
 * Contract of all functions here. Context: any thread or interrupt; at the same time too, as a key is only
 * read once it is set. NULL: never, but for `data` of no bytes. Errors: none. A block has CMAC_BLOCK bytes.
 * */
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

/* Expands a key. Cost: 20 S-boxes of the whole state, two blocks. */
void cmac_key_init(cmac_key *key, const uint8_t bytes[CMAC_KEY]);

/* Encrypts one block; out may be in. Cost: 10 S-boxes, one block. */
void cmac_encrypt(const cmac_key *key, const uint8_t in[CMAC_BLOCK], uint8_t out[CMAC_BLOCK]);

/* The tag of a message. bytes: 0 to what data holds; of 0 nothing is read. Cost: one block for every 16 bytes
 * begun, at least one. */
void cmac_tag(const cmac_key *key, const uint8_t *data, uint32_t bytes, uint8_t tag[CMAC_BLOCK]);

/* Returns 0 iff the two are equal. bytes: 0 to what both hold; all are compared. Cost: linear in bytes. */
uint32_t cmac_differs(const uint8_t *a, const uint8_t *b, uint32_t bytes);

#ifdef __cplusplus
}
#endif
#endif
