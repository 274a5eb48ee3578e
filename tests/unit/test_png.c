/* SPDX-License-Identifier: Apache-2.0 */
/* What png_encode writes is read back here by an inflate of its own, bit by bit (RFC 1951). */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "tests/lib/test.h"
#include "tools/render/huffman.h"
#include "tools/render/png.h"

typedef struct {
  const uint8_t *in;
  size_t count, at; /* at: in bits */
  uint8_t *out;
  size_t room, made;
  int failed;
} inflater;

static uint32_t take(inflater *s, uint32_t bits) {
  uint32_t v = 0;
  for (uint32_t k = 0; k < bits; k++, s->at++) {
    if (s->at / 8 >= s->count) {
      s->failed = 1;
      return 0;
    }
    v |= (uint32_t)(s->in[s->at / 8] >> (s->at % 8) & 1) << k;
  }
  return v;
}

static void give(inflater *s, uint8_t v) {
  if (s->made >= s->room) s->failed = 1;
  else s->out[s->made++] = v;
}

/* Canonical decoding by counts of each length. */
typedef struct {
  uint16_t count[16], symbol[288];
} code_set;

static void code_from(code_set *c, const uint8_t *lengths, uint32_t n) {
  uint16_t offset[16] = {0};
  memset(c, 0, sizeof *c);
  for (uint32_t k = 0; k < n; k++) c->count[lengths[k]]++;
  c->count[0] = 0;
  for (int b = 1; b < 15; b++) offset[b + 1] = (uint16_t)(offset[b] + c->count[b]);
  for (uint32_t k = 0; k < n; k++)
    if (lengths[k]) c->symbol[offset[lengths[k]]++] = (uint16_t)k;
}

static uint32_t decode(inflater *s, const code_set *c) {
  int32_t code = 0, first = 0, index = 0;
  for (int b = 1; b < 16 && !s->failed; b++) {
    code |= (int32_t)take(s, 1);
    if (code - first < c->count[b]) return c->symbol[index + code - first];
    index += c->count[b];
    first = (first + c->count[b]) * 2;
    code *= 2;
  }
  s->failed = 1;
  return 0;
}

static void inflate_codes(inflater *s, const code_set *literal, const code_set *distance) {
  while (!s->failed) {
    const uint32_t v = decode(s, literal);
    if (s->failed || v == 256) return;
    if (v < 256) {
      give(s, (uint8_t)v);
      continue;
    }
    /* Bases by the rule of the format, not by a table: a slip in the encoder's tables shows. */
    uint32_t length = v - 257 + 3, far;
    if (v >= 265 && v < 285) {
      const uint32_t extra = (v - 261) / 4;
      length = 3 + ((4 + (v - 261) % 4) << extra);
      length += take(s, extra);
    } else if (v == 285) {
      length = 258;
    }
    const uint32_t d = decode(s, distance);
    far = d + 1;
    if (d >= 4) {
      const uint32_t extra = d / 2 - 1;
      far = ((2 + d % 2) << extra) + 1;
      far += take(s, extra);
    }
    if (far > s->made || d > 29) s->failed = 1;
    for (uint32_t k = 0; k < length && !s->failed; k++) give(s, s->out[s->made - far]);
  }
}

static void inflate_dynamic(inflater *s) {
  static const uint8_t order[19] = {16, 17, 18, 0, 8,  7, 9,  6, 10, 5,
                                    11, 4,  12, 3, 13, 2, 14, 1, 15};
  uint8_t lengths[320] = {0}, of_lengths[19] = {0};
  const uint32_t literals = take(s, 5) + 257, distances = take(s, 5) + 1, sent = take(s, 4) + 4;
  for (uint32_t k = 0; k < sent; k++) of_lengths[order[k]] = (uint8_t)take(s, 3);
  code_set code, literal, distance;
  code_from(&code, of_lengths, 19);
  for (uint32_t k = 0; k < literals + distances && !s->failed;) {
    const uint32_t v = decode(s, &code);
    uint32_t run = 1;
    uint8_t value = (uint8_t)v;
    if (v == 16 && k > 0) value = lengths[k - 1], run = 3 + take(s, 2);
    if (v == 16 && k == 0) s->failed = 1;
    if (v == 17) value = 0, run = 3 + take(s, 3);
    if (v == 18) value = 0, run = 11 + take(s, 7);
    if (k + run > literals + distances) s->failed = 1;
    for (; run > 0 && !s->failed; run--) lengths[k++] = value;
  }
  code_from(&literal, lengths, literals);
  code_from(&distance, lengths + literals, distances);
  inflate_codes(s, &literal, &distance);
}

static void inflate_fixed(inflater *s) {
  uint8_t lengths[288], distances[30];
  for (int k = 0; k < 288; k++) lengths[k] = k < 144 ? 8 : k < 256 ? 9 : k < 280 ? 7 : 8;
  memset(distances, 5, sizeof distances);
  code_set literal, distance;
  code_from(&literal, lengths, 288);
  code_from(&distance, distances, 30);
  inflate_codes(s, &literal, &distance);
}

static size_t inflate(const uint8_t *in, size_t count, uint8_t *out, size_t room) {
  inflater s = {in, count, 0, out, room, 0, 0};
  for (uint32_t last = 0; !last && !s.failed;) {
    last = take(&s, 1);
    const uint32_t kind = take(&s, 2);
    if (kind == 0) {
      s.at = (s.at + 7) / 8 * 8;
      const uint32_t n = take(&s, 16);
      if ((take(&s, 16) ^ n) != 0xFFFF) s.failed = 1;
      for (uint32_t k = 0; k < n && !s.failed; k++) give(&s, (uint8_t)take(&s, 8));
    } else if (kind == 1) {
      inflate_fixed(&s);
    } else if (kind == 2) {
      inflate_dynamic(&s);
    } else {
      s.failed = 1;
    }
  }
  return s.failed || (s.at + 7) / 8 != count ? (size_t)-1 : s.made;
}

static uint32_t u32_at(const uint8_t *p) {
  return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

static void unfilter(const uint8_t *in, uint32_t width, uint32_t height, uint8_t *rgb) {
  const size_t bytes = (size_t)width * 3;
  for (size_t y = 0; y < height; y++) {
    const uint8_t filter = *in++;
    for (size_t k = 0; k < bytes; k++) {
      const int a = k >= 3 ? rgb[y * bytes + k - 3] : 0, b = y ? rgb[(y - 1) * bytes + k] : 0;
      const int c = k >= 3 && y ? rgb[(y - 1) * bytes + k - 3] : 0;
      const int pa = abs(b - c), pb = abs(a - c), pc = abs(a + b - 2 * c);
      const int best = pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
      const int guess[5] = {0, a, b, (a + b) / 2, best};
      rgb[y * bytes + k] = (uint8_t)(*in++ + guess[filter < 5 ? filter : 0]);
    }
  }
}

/* Encodes, walks the chunks, inflates and unfilters; 1 iff every pixel came back. */
static int round_trip(const uint8_t *rgb, uint32_t width, uint32_t height, size_t *file_bytes) {
  byte_buffer file = {0};
  if (!png_encode(&file, rgb, width, height)) return 0;
  const size_t raw = ((size_t)width * 3 + 1) * height;
  uint8_t *filtered = malloc(raw), *back = malloc(raw);
  int good = filtered && back && file.count > 8 && memcmp(file.data, "\x89PNG\r\n\x1A\n", 8) == 0;
  int header = 0, data = 0, end = 0;
  for (size_t at = 8; good && at + 12 <= file.count;) {
    const uint8_t *chunk = file.data + at;
    const uint32_t n = u32_at(chunk);
    good = at + 12 + n <= file.count && u32_at(chunk + 8 + n) == png_crc32(0, chunk + 4, n + 4);
    if (!good) break;
    if (!memcmp(chunk + 4, "IHDR", 4))
      header = u32_at(chunk + 8) == width && u32_at(chunk + 12) == height;
    if (!memcmp(chunk + 4, "IEND", 4)) end = at + 12 == file.count;
    if (!memcmp(chunk + 4, "IDAT", 4)) {
      good = (chunk[8] * 256 + chunk[9]) % 31 == 0;
      data = inflate(chunk + 10, n - 6, filtered, raw) == raw;
      data = data && u32_at(chunk + 8 + n - 4) == png_adler32(1, filtered, raw);
    }
    at += 12 + n;
  }
  good = good && header && data && end;
  if (good) {
    unfilter(filtered, width, height, back);
    good = memcmp(back, rgb, (size_t)width * height * 3) == 0;
  }
  *file_bytes = file.count;
  free(filtered);
  free(back);
  byte_buffer_free(&file);
  return good;
}

static uint32_t noise_state = 1;
static uint8_t noise(void) {
  noise_state = noise_state * 1664525u + 1013904223u;
  return (uint8_t)(noise_state >> 24);
}

static void checksums(void) {
  CHECK(png_crc32(0, "123456789", 9) == 0xCBF43926u);
  CHECK(png_crc32(png_crc32(0, "1234", 4), "56789", 5) == 0xCBF43926u);
  CHECK(png_adler32(1, "Wikipedia", 9) == 0x11E60398u);
  CHECK(png_adler32(1, "", 0) == 1u);
}

static void reader(void) {
  /* The reader itself, on streams made by hand: stored "abc", and fixed "a" + end. */
  static const uint8_t stored[] = {0x01, 0x03, 0x00, 0xFC, 0xFF, 'a', 'b', 'c'};
  static const uint8_t fixed[] = {0x4B, 0x04, 0x00};
  static const uint8_t wrong[] = {0x07};
  uint8_t out[8];
  CHECK(inflate(stored, sizeof stored, out, sizeof out) == 3);
  CHECK(memcmp(out, "abc", 3) == 0);
  CHECK(inflate(fixed, sizeof fixed, out, sizeof out) == 1);
  CHECK(out[0] == 'a');
  CHECK(inflate(wrong, sizeof wrong, out, sizeof out) == (size_t)-1);
}

static void codes(void) {
  /* Fibonacci counts make the deepest tree; the limit must hold and the set be complete. */
  uint32_t counts[30] = {1, 1};
  for (int k = 2; k < 30; k++) counts[k] = counts[k - 1] + counts[k - 2];
  huffman h;
  huffman_build(&h, counts, 30, 15);
  uint32_t sum = 0, longest = 0;
  for (int k = 0; k < 30; k++) {
    CHECK(h.length[k] > 0);
    if (h.length[k] > longest) longest = h.length[k];
    sum += 1u << (15 - h.length[k]);
  }
  CHECK(longest <= 15);
  CHECK(sum == 1u << 15);
  /* One symbol only: a second one is made up. */
  uint32_t one[30] = {0};
  one[7] = 5;
  huffman_build(&h, one, 30, 15);
  CHECK(h.length[7] == 1);
  CHECK(h.length[0] == 1);
}

static void pictures(void) {
  enum { W = 320, H = 200 };
  uint8_t *rgb = malloc(W * H * 3);
  size_t bytes = 0;
  CHECK(rgb != NULL);
  if (!rgb) return;
  memset(rgb, 200, W * H * 3);
  CHECK(round_trip(rgb, W, H, &bytes));
  CHECK(bytes < 1000);
  for (size_t k = 0; k < W * H * 3; k++) rgb[k] = noise();
  CHECK(round_trip(rgb, W, H, &bytes));
  CHECK(bytes < W * H * 3 + 4096);
  for (size_t k = 0; k < W * H * 3; k++) rgb[k] = (uint8_t)(k / 3 % W / 2 + k / 3 / W);
  CHECK(round_trip(rgb, W, H, &bytes));
  CHECK(bytes < 8000);
  /* Patches of noise in a flat field: literals and matches, near and far, of every length. */
  for (size_t k = 0; k < W * H * 3; k++)
    rgb[k] = (k * k >> 9) % 7 == 0 ? noise() : (uint8_t)(k >> 10);
  CHECK(round_trip(rgb, W, H, &bytes));
  for (size_t y = 1; y < H; y++)
    memcpy(rgb + y * W * 3, rgb + (y * 7 % y) * W * 3, (y * 13) % (W * 3));
  CHECK(round_trip(rgb, W, H, &bytes));
  for (uint32_t w = 1; w < 9; w++) CHECK(round_trip(rgb, w, 9 - w, &bytes));
  free(rgb);
}

static void refused(void) {
  byte_buffer file = {0};
  const uint8_t pixel[3] = {1, 2, 3};
  CHECK(!png_encode(&file, pixel, 0, 1));
  CHECK(!png_encode(&file, pixel, 1, 0));
  CHECK(!png_encode(&file, NULL, 1, 1));
  CHECK(!png_encode(&file, pixel, 1u << 20, 1));
  CHECK(!png_write("/nonexistent/folder/x.png", pixel, 1, 1));
  byte_buffer_free(&file);
}

int main(void) {
  TEST(checksums);
  TEST(reader);
  TEST(codes);
  TEST(pictures);
  TEST(refused);
  return test_end();
}
