/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/png.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "platform/files/output_file.h"

enum { SIDE_MAX = 32768, BYTES_PER_PIXEL = 3, FILTERS = 5 };

uint32_t png_crc32(uint32_t crc, const void *data, size_t count) {
  uint32_t table[256];
  for (uint32_t n = 0; n < 256; n++) {
    uint32_t c = n;
    for (int k = 0; k < 8; k++) c = c & 1u ? 0xEDB88320u ^ (c >> 1) : c >> 1;
    table[n] = c;
  }
  const uint8_t *p = data;
  crc = ~crc;
  for (size_t k = 0; k < count; k++) crc = table[(crc ^ p[k]) & 255u] ^ (crc >> 8);
  return ~crc;
}

uint32_t png_adler32(uint32_t adler, const void *data, size_t count) {
  const uint8_t *p = data;
  uint32_t a = adler & 0xFFFFu, b = adler >> 16;
  while (count > 0) {
    /* 5552 is the most bytes before b could pass 2^32. */
    const size_t run = count < 5552 ? count : 5552;
    for (size_t k = 0; k < run; k++) {
      a += p[k];
      b += a;
    }
    a %= 65521u;
    b %= 65521u;
    p += run;
    count -= run;
  }
  return b << 16 | a;
}

static void put_u32(uint8_t *p, uint32_t v) {
  p[0] = (uint8_t)(v >> 24);
  p[1] = (uint8_t)(v >> 16);
  p[2] = (uint8_t)(v >> 8);
  p[3] = (uint8_t)v;
}

static void add_chunk(byte_buffer *out, const char *name, const uint8_t *data, size_t count) {
  uint8_t word[4];
  put_u32(word, (uint32_t)count);
  byte_buffer_append(out, word, 4);
  byte_buffer_append(out, name, 4);
  byte_buffer_append(out, data, count);
  put_u32(word, png_crc32(png_crc32(0, name, 4), data, count));
  byte_buffer_append(out, word, 4);
}

static uint8_t paeth(int a, int b, int c) {
  const int p = a + b - c;
  const int pa = abs(p - a), pb = abs(p - b), pc = abs(p - c);
  return (uint8_t)(pa <= pb && pa <= pc ? a : pb <= pc ? b : c);
}

static uint8_t predicted(int filter, int left, int up, int corner) {
  switch (filter) {
    case 1: return (uint8_t)left;
    case 2: return (uint8_t)up;
    case 3: return (uint8_t)((left + up) / 2);
    case 4: return paeth(left, up, corner);
    default: return 0;
  }
}

/* Filters one row into out[1..], out[0] is the filter. `above` may be NULL. Returns the sum of
 * the residuals as signed magnitudes: the usual guess at how well the row will deflate. */
static uint64_t filter_row(int filter, const uint8_t *row, const uint8_t *above, size_t bytes,
                           uint8_t *out) {
  uint64_t sum = 0;
  out[0] = (uint8_t)filter;
  for (size_t k = 0; k < bytes; k++) {
    const int left = k >= BYTES_PER_PIXEL ? row[k - BYTES_PER_PIXEL] : 0;
    const int up = above ? above[k] : 0;
    const int corner = above && k >= BYTES_PER_PIXEL ? above[k - BYTES_PER_PIXEL] : 0;
    const uint8_t v = (uint8_t)(row[k] - predicted(filter, left, up, corner));
    out[k + 1] = v;
    sum += v < 128 ? v : 256u - v;
  }
  return sum;
}

static uint8_t *filter_picture(const uint8_t *rgb, uint32_t width, uint32_t height, size_t *count) {
  const size_t bytes = (size_t)width * BYTES_PER_PIXEL, stride = bytes + 1;
  uint8_t *filtered = malloc(stride * height);
  uint8_t *trial = malloc(stride);
  if (!filtered || !trial) {
    free(filtered);
    free(trial);
    return NULL;
  }
  for (uint32_t y = 0; y < height; y++) {
    const uint8_t *row = rgb + y * bytes;
    uint64_t best = UINT64_MAX;
    for (int f = 0; f < FILTERS; f++) {
      const uint64_t sum = filter_row(f, row, y > 0 ? row - bytes : NULL, bytes, trial);
      if (sum >= best) continue;
      best = sum;
      memcpy(filtered + y * stride, trial, stride);
    }
  }
  free(trial);
  *count = stride * height;
  return filtered;
}

int png_encode(byte_buffer *out, const uint8_t *rgb, uint32_t width, uint32_t height) {
  static const uint8_t signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  static const uint8_t zlib_header[2] = {0x78, 0x9C};
  if (!rgb || width == 0 || height == 0 || width > SIDE_MAX || height > SIDE_MAX) return 0;
  uint8_t header[13] = {0};
  put_u32(header, width);
  put_u32(header + 4, height);
  header[8] = 8; /* bits a sample */
  header[9] = 2; /* RGB */
  byte_buffer_append(out, signature, sizeof signature);
  add_chunk(out, "IHDR", header, sizeof header);
  static const uint8_t perceptual = 0;
  add_chunk(out, "sRGB", &perceptual, 1);

  size_t count = 0;
  uint8_t *filtered = filter_picture(rgb, width, height, &count);
  if (!filtered) return 0;
  byte_buffer body = {0};
  byte_buffer_append(&body, zlib_header, sizeof zlib_header);
  int good = deflate_append(&body, filtered, count);
  uint8_t check[4];
  put_u32(check, png_adler32(1, filtered, count));
  byte_buffer_append(&body, check, sizeof check);
  free(filtered);
  good = good && !body.failed;
  if (good) {
    add_chunk(out, "IDAT", body.data, body.count);
    add_chunk(out, "IEND", NULL, 0);
  }
  byte_buffer_free(&body);
  return good && !out->failed;
}

int png_write(const char *path, const uint8_t *rgb, uint32_t width, uint32_t height) {
  byte_buffer file = {0};
  if (!png_encode(&file, rgb, width, height)) {
    byte_buffer_free(&file);
    errno = EINVAL;
    return 0;
  }
  const int good = output_file_write(path, file.data, file.count);
  byte_buffer_free(&file);
  return good;
}
