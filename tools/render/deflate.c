/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/deflate.h"

#include <stdlib.h>
#include <string.h>

#include "tools/render/huffman.h"

enum {
  MATCH_MIN = 3,
  MATCH_WORTH = 6,
  MATCH_MAX = 258,
  WINDOW = 32768,
  HASH_BITS = 15,
  HASH_SIZE = 1 << HASH_BITS,
  CHAIN_MAX = 20,   /* candidates looked at: more cost time and gain little on pictures */
  MATCH_GOOD = 128, /* long enough to stop looking */
  BLOCK_SYMBOLS = 65536,
  END_OF_BLOCK = 256,
  LITERALS = 286,
  DISTANCES = 30,
  LENGTH_CODES = 19
};

static const uint16_t length_base[29] = {3,  4,  5,  6,   7,   8,   9,   10,  11, 13,
                                         15, 17, 19, 23,  27,  31,  35,  43,  51, 59,
                                         67, 83, 99, 115, 131, 163, 195, 227, 258};
static const uint8_t length_extra[29] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2,
                                         2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0};
static const uint16_t distance_base[30] = {
    1,   2,   3,   4,   5,   7,    9,    13,   17,   25,   33,   49,   65,    97,    129,
    193, 257, 385, 513, 769, 1025, 1537, 2049, 3073, 4097, 6145, 8193, 12289, 16385, 24577};
static const uint8_t distance_extra[30] = {0, 0, 0, 0, 1, 1, 2, 2,  3,  3,  4,  4,  5,  5,  6,
                                           6, 7, 7, 8, 8, 9, 9, 10, 10, 11, 11, 12, 12, 13, 13};
/* The order in which the lengths of the length code are sent (RFC 1951, 3.2.7). */
static const uint8_t sent_order[LENGTH_CODES] = {16, 17, 18, 0, 8,  7, 9,  6, 10, 5,
                                                 11, 4,  12, 3, 13, 2, 14, 1, 15};

typedef struct {
  uint16_t value;    /* literal, or match length */
  uint16_t distance; /* 0: a literal */
} token;

typedef struct {
  byte_buffer *out;
  uint64_t bits;
  uint32_t bit_count;
  token *tokens;
  uint32_t token_count;
  int32_t *head;  /* HASH_SIZE: last place of a hash, or -1 */
  int32_t *chain; /* WINDOW: the place before, by place % WINDOW */
  uint8_t length_symbol[MATCH_MAX + 1];
} encoder;

void byte_buffer_append(byte_buffer *r, const void *data, size_t count) {
  if (r->failed || count == 0) return;
  if (r->room - r->count < count) {
    size_t room = r->room < 4096 ? 4096 : r->room;
    while (room - r->count < count) room *= 2;
    uint8_t *grown = realloc(r->data, room);
    if (!grown) {
      r->failed = 1;
      return;
    }
    r->data = grown;
    r->room = room;
  }
  memcpy(r->data + r->count, data, count);
  r->count += count;
}

void byte_buffer_free(byte_buffer *r) {
  free(r->data);
  memset(r, 0, sizeof *r);
}

static void put_bits(encoder *e, uint32_t value, uint32_t count) {
  e->bits |= (uint64_t)value << e->bit_count;
  e->bit_count += count;
  if (e->bit_count < 32) return;
  const uint8_t four[4] = {(uint8_t)e->bits, (uint8_t)(e->bits >> 8), (uint8_t)(e->bits >> 16),
                           (uint8_t)(e->bits >> 24)};
  byte_buffer_append(e->out, four, 4);
  e->bits >>= 32;
  e->bit_count -= 32;
}

static void flush_bits(encoder *e) {
  while (e->bit_count > 0) {
    const uint8_t one = (uint8_t)e->bits;
    byte_buffer_append(e->out, &one, 1);
    e->bits >>= 8;
    e->bit_count = e->bit_count > 8 ? e->bit_count - 8 : 0;
  }
}

static uint32_t distance_symbol(uint32_t distance) {
  uint32_t low = 0, high = DISTANCES;
  while (high - low > 1) {
    const uint32_t middle = (low + high) / 2;
    if (distance_base[middle] <= distance) low = middle;
    else high = middle;
  }
  return low;
}

/* Lengths as runs: symbol, and the value and width of what follows it (RFC 1951, 3.2.7). */
typedef struct {
  uint8_t symbol, extra, width;
} length_run;

static uint32_t runs_of(const uint8_t *lengths, uint32_t count, length_run *runs) {
  uint32_t n = 0;
  for (uint32_t k = 0; k < count;) {
    uint32_t run = 1;
    while (k + run < count && lengths[k + run] == lengths[k]) run++;
    if (lengths[k] == 0 && run >= 3) {
      if (run > 138) run = 138;
      runs[n++] = run < 11 ? (length_run){17, (uint8_t)(run - 3), 3}
                           : (length_run){18, (uint8_t)(run - 11), 7};
    } else if (run >= 4) {
      if (run > 7) run = 7;
      runs[n++] = (length_run){lengths[k], 0, 0};
      runs[n++] = (length_run){16, (uint8_t)(run - 4), 2};
    } else {
      run = 1;
      runs[n++] = (length_run){lengths[k], 0, 0};
    }
    k += run;
  }
  return n;
}

static void put_tables(encoder *e, const huffman *literal, const huffman *distance) {
  uint8_t lengths[LITERALS + DISTANCES];
  length_run runs[LITERALS + DISTANCES];
  uint32_t counts[LENGTH_CODES] = {0};
  uint32_t literals = LITERALS, distances = DISTANCES, sent = LENGTH_CODES;
  while (literals > 257 && !literal->length[literals - 1]) literals--;
  while (distances > 1 && !distance->length[distances - 1]) distances--;
  for (uint32_t k = 0; k < literals; k++) lengths[k] = (uint8_t)literal->length[k];
  for (uint32_t k = 0; k < distances; k++) lengths[literals + k] = (uint8_t)distance->length[k];
  const uint32_t n = runs_of(lengths, literals + distances, runs);
  for (uint32_t k = 0; k < n; k++) counts[runs[k].symbol]++;
  huffman code;
  huffman_build(&code, counts, LENGTH_CODES, 7);
  while (sent > 4 && !code.length[sent_order[sent - 1]]) sent--;
  put_bits(e, literals - 257, 5);
  put_bits(e, distances - 1, 5);
  put_bits(e, sent - 4, 4);
  for (uint32_t k = 0; k < sent; k++) put_bits(e, code.length[sent_order[k]], 3);
  for (uint32_t k = 0; k < n; k++) {
    put_bits(e, code.code[runs[k].symbol], code.length[runs[k].symbol]);
    put_bits(e, runs[k].extra, runs[k].width);
  }
}

static void put_block(encoder *e, int last) {
  uint32_t literal_counts[LITERALS] = {0}, distance_counts[DISTANCES] = {0};
  literal_counts[END_OF_BLOCK] = 1;
  for (uint32_t k = 0; k < e->token_count; k++) {
    const token t = e->tokens[k];
    if (!t.distance) {
      literal_counts[t.value]++;
    } else {
      literal_counts[257u + e->length_symbol[t.value]]++;
      distance_counts[distance_symbol(t.distance)]++;
    }
  }
  huffman literal, distance;
  huffman_build(&literal, literal_counts, LITERALS, HUFFMAN_BITS_MAX);
  huffman_build(&distance, distance_counts, DISTANCES, HUFFMAN_BITS_MAX);
  put_bits(e, last ? 1u : 0u, 1);
  put_bits(e, 2, 2);
  put_tables(e, &literal, &distance);
  for (uint32_t k = 0; k < e->token_count; k++) {
    const token t = e->tokens[k];
    if (!t.distance) {
      put_bits(e, literal.code[t.value], literal.length[t.value]);
      continue;
    }
    const uint32_t l = e->length_symbol[t.value], d = distance_symbol(t.distance);
    put_bits(e, literal.code[257 + l], literal.length[257 + l]);
    put_bits(e, (uint32_t)t.value - length_base[l], length_extra[l]);
    put_bits(e, distance.code[d], distance.length[d]);
    put_bits(e, (uint32_t)t.distance - distance_base[d], distance_extra[d]);
  }
  put_bits(e, literal.code[END_OF_BLOCK], literal.length[END_OF_BLOCK]);
  e->token_count = 0;
}

static uint32_t hash_at(const uint8_t *p) {
  const uint32_t v = (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16;
  return (v * 2654435761u) >> (32 - HASH_BITS);
}

static void remember(encoder *e, const uint8_t *data, size_t at) {
  const uint32_t h = hash_at(data + at);
  e->chain[at % WINDOW] = e->head[h];
  e->head[h] = (int32_t)at;
}

static token find_match(const encoder *e, const uint8_t *data, size_t count, size_t at) {
  token best = {data[at], 0};
  uint32_t best_length = MATCH_MIN - 1;
  const uint32_t max = count - at < MATCH_MAX ? (uint32_t)(count - at) : (uint32_t)MATCH_MAX;
  if (max < MATCH_MIN) return best;
  int32_t from = e->head[hash_at(data + at)];
  for (int look = 0; look < CHAIN_MAX && from >= 0 && at - (size_t)from < WINDOW; look++) {
    const uint8_t *a = data + from, *b = data + at;
    if (a[best_length] == b[best_length]) {
      uint32_t n = 0;
      while (n < max && a[n] == b[n]) n++;
      if (n > best_length) {
        best_length = n;
        best = (token){(uint16_t)n, (uint16_t)(at - (size_t)from)};
        if (n >= MATCH_GOOD || n == max) break;
      }
    }
    const int32_t before = e->chain[(size_t)from % WINDOW];
    if (before >= from) break;
    from = before;
  }
  /* Filtered rows are small numbers: as literals, short matches cost fewer bits. */
  if (best_length < MATCH_WORTH && best.distance > 1) best = (token){data[at], 0};
  return best;
}

static void tokenize(encoder *e, const uint8_t *data, size_t count) {
  for (size_t at = 0; at < count;) {
    token t = find_match(e, data, count, at);
    const size_t hashed_end = count >= MATCH_MIN ? count - MATCH_MIN + 1 : 0;
    if (at < hashed_end) remember(e, data, at);
    if (t.distance && t.value < 16 && at + 1 < count) {
      /* One literal first, if a longer match starts at the next byte. */
      const token later = find_match(e, data, count, at + 1);
      if (later.distance && later.value > t.value) t = (token){data[at], 0};
    }
    const size_t step = t.distance ? t.value : 1;
    for (size_t k = 1; k < step; k++)
      if (at + k < hashed_end) remember(e, data, at + k);
    at += step;
    e->tokens[e->token_count++] = t;
    if (e->token_count == BLOCK_SYMBOLS && at < count) put_block(e, 0);
  }
  put_block(e, 1);
}

int deflate_append(byte_buffer *out, const uint8_t *data, size_t count) {
  encoder e = {.out = out};
  if (count > INT32_MAX) return 0;
  e.tokens = malloc(BLOCK_SYMBOLS * sizeof *e.tokens);
  e.head = malloc(HASH_SIZE * sizeof *e.head);
  e.chain = malloc(WINDOW * sizeof *e.chain);
  if (e.tokens && e.head && e.chain) {
    for (size_t k = 0; k < HASH_SIZE; k++) e.head[k] = -1;
    for (size_t k = 0; k < WINDOW; k++) e.chain[k] = -1;
    for (uint32_t s = 0; s < 29; s++)
      for (uint32_t n = length_base[s]; n <= MATCH_MAX; n++) e.length_symbol[n] = (uint8_t)s;
    tokenize(&e, data, count);
    flush_bits(&e);
  } else {
    out->failed = 1;
  }
  free(e.tokens);
  free(e.head);
  free(e.chain);
  return !out->failed;
}
