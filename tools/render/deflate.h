/* SPDX-License-Identifier: Apache-2.0 */
/* Raw deflate (RFC 1951): LZ77 over a hash chain, one dynamic Huffman block per 64 Ki symbols. */
#ifndef FRAY_TOOLS_RENDER_DEFLATE_H
#define FRAY_TOOLS_RENDER_DEFLATE_H

#include <stddef.h>
#include <stdint.h>

/* A growing row of bytes. `failed` is set once memory runs out; then nothing more is added. */
typedef struct {
  uint8_t *data;
  size_t count, room;
  int failed;
} byte_buffer;

void byte_buffer_append(byte_buffer *r, const void *data, size_t count);
void byte_buffer_free(byte_buffer *r);

/* Appends the deflated form of data to out. Returns 1, or 0 iff memory ran out. */
int deflate_append(byte_buffer *out, const uint8_t *data, size_t count);

#endif
