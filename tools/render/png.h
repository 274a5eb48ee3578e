/* SPDX-License-Identifier: Apache-2.0 */
/* 8-bit RGB pictures as PNG, without a library (PNG 1.2, RFC 1950, RFC 1951). */
#ifndef FRAY_TOOLS_RENDER_PNG_H
#define FRAY_TOOLS_RENDER_PNG_H

#include <stddef.h>
#include <stdint.h>

#include "tools/render/deflate.h"

uint32_t png_crc32(uint32_t crc, const void *data, size_t count);     /* start with 0 */
uint32_t png_adler32(uint32_t adler, const void *data, size_t count); /* start with 1 */

/* Appends a whole PNG file. `rgb` is width * height * 3 bytes, rows from the top, sRGB.
 * Returns 1, or 0 iff a side is 0 or too long, or memory ran out. */
int png_encode(byte_buffer *out, const uint8_t *rgb, uint32_t width, uint32_t height);

/* Returns 1, or 0 with errno set iff the file could not be written whole. */
int png_write(const char *path, const uint8_t *rgb, uint32_t width, uint32_t height);

#endif
