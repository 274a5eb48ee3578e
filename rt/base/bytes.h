/* SPDX-License-Identifier: Apache-2.0 */
/* Little-endian loads and stores, and the CRC-32 of an image (ISO 3309, reflected 0x04C11DB7). */
#ifndef FRAY_BASE_BYTES_H
#define FRAY_BASE_BYTES_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

static inline uint16_t bytes_load16(const uint8_t *p) {
  return (uint16_t)((uint32_t)p[0] | (uint32_t)p[1] << 8);
}
static inline uint32_t bytes_load32(const uint8_t *p) {
  return (uint32_t)bytes_load16(p) | (uint32_t)bytes_load16(p + 2) << 16;
}
static inline void bytes_store16(uint8_t *p, uint16_t v) {
  p[0] = (uint8_t)(v & 0xFFu);
  p[1] = (uint8_t)(v >> 8);
}
static inline void bytes_store32(uint8_t *p, uint32_t v) {
  bytes_store16(p, (uint16_t)(v & 0xFFFFu));
  bytes_store16(p + 2, (uint16_t)(v >> 16));
}

static inline int bytes_host_is_little(void) {
  return __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__;
}

/* Check value: "123456789" gives 0xCBF43926. Cost: 2 steps a byte, a table of 16 words. */
uint32_t bytes_crc32(const uint8_t *data, size_t bytes);

/* memset and memcpy, so that rt/ needs no libc. */
void bytes_zero(void *to, size_t bytes);
void bytes_copy(void *to, const void *from, size_t bytes);

#ifdef __cplusplus
}
#endif
#endif
