/* SPDX-License-Identifier: Apache-2.0 */
/* Length-limited prefix codes as deflate wants them (RFC 1951, 3.2.2). */
#ifndef FRAY_TOOLS_RENDER_HUFFMAN_H
#define FRAY_TOOLS_RENDER_HUFFMAN_H

#include <stdint.h>

enum { HUFFMAN_SYMBOLS_MAX = 288, HUFFMAN_BITS_MAX = 15 };

/* Both arrays have one stride: where a loop walked bytes and halves side by side, gcc 12 for
 * aarch64 dropped the stores to the codes. */
typedef struct {
  uint16_t length[HUFFMAN_SYMBOLS_MAX]; /* 0: the symbol does not occur */
  uint16_t code[HUFFMAN_SYMBOLS_MAX];  /* bit-reversed, ready to be sent lowest bit first */
} huffman;

/* Lengths and codes from how often each symbol occurs; no code is longer than `limit` bits.
 * At least two symbols get a code, so that the set is always complete: decoders differ on others.
 */
void huffman_build(huffman *h, const uint32_t *counts, uint32_t symbols, uint32_t limit);

/* Codes from lengths that are already in h. */
void huffman_assign(huffman *h, uint32_t symbols);

#endif
