/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/huffman.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
  uint32_t count;
  uint32_t symbol;
} leaf;

static int leaf_order(const void *a, const void *b) {
  const leaf *x = a, *y = b;
  if (x->count != y->count) return x->count < y->count ? -1 : 1;
  return x->symbol < y->symbol ? -1 : x->symbol > y->symbol;
}

/* Depths of the leaves of a Huffman tree over counts in rising order, by the two-queue method:
 * inner nodes are made in rising order too, so no heap is needed. Returns the deepest. */
static uint32_t tree_depths(const leaf *leaves, uint32_t n, uint8_t *depth) {
  uint64_t weight[2 * HUFFMAN_SYMBOLS_MAX];
  uint32_t parent[2 * HUFFMAN_SYMBOLS_MAX];
  uint32_t level[2 * HUFFMAN_SYMBOLS_MAX];
  for (uint32_t k = 0; k < n; k++) weight[k] = leaves[k].count;
  uint32_t next_leaf = 0, next_inner = n, made = n;
  for (; made < 2 * n - 1; made++) {
    weight[made] = 0;
    for (int pick = 0; pick < 2; pick++) {
      const int inner =
          next_leaf >= n || (next_inner < made && weight[next_inner] < weight[next_leaf]);
      const uint32_t node = inner ? next_inner++ : next_leaf++;
      weight[made] += weight[node];
      parent[node] = made;
    }
  }
  uint32_t deepest = 0;
  level[made - 1] = 0;
  for (uint32_t k = made - 1; k-- > 0;) {
    level[k] = level[parent[k]] + 1;
    if (k < n) {
      depth[k] = (uint8_t)level[k];
      if (level[k] > deepest) deepest = level[k];
    }
  }
  return deepest;
}

static uint32_t reversed(uint32_t code, uint32_t bits) {
  uint32_t r = 0;
  for (uint32_t k = 0; k < bits; k++) r |= ((code >> k) & 1u) << (bits - 1 - k);
  return r;
}

void huffman_assign(huffman *h, uint32_t symbols) {
  uint32_t of_length[HUFFMAN_BITS_MAX + 1] = {0}, next[HUFFMAN_BITS_MAX + 2] = {0};
  for (uint32_t s = 0; s < symbols; s++) of_length[h->length[s]]++;
  of_length[0] = 0;
  for (uint32_t b = 1; b <= HUFFMAN_BITS_MAX; b++) next[b + 1] = (next[b] + of_length[b]) << 1;
  for (uint32_t s = 0; s < symbols; s++) {
    const uint32_t bits = h->length[s];
    h->code[s] = bits ? (uint16_t)reversed(next[bits]++, bits) : 0;
  }
}

void huffman_build(huffman *h, const uint32_t *counts, uint32_t symbols, uint32_t limit) {
  leaf leaves[HUFFMAN_SYMBOLS_MAX];
  uint8_t depth[HUFFMAN_SYMBOLS_MAX];
  uint32_t n = 0;
  memset(h, 0, sizeof *h);
  for (uint32_t s = 0; s < symbols; s++)
    if (counts[s]) leaves[n++] = (leaf){counts[s], s};
  for (uint32_t s = 0; n < 2; s++)
    if (!counts[s]) leaves[n++] = (leaf){1, s};
  qsort(leaves, n, sizeof leaves[0], leaf_order);
  /* Too deep a tree comes from very uneven counts: halving them (never to 0) keeps their order
   * and ends after at most 32 rounds, when all are equal. */
  while (tree_depths(leaves, n, depth) > limit)
    for (uint32_t k = 0; k < n; k++) leaves[k].count = (leaves[k].count + 1) / 2;
  for (uint32_t k = 0; k < n; k++) h->length[leaves[k].symbol] = depth[k];
  huffman_assign(h, symbols);
}
