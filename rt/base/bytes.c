/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/base/bytes.h"

#include "rt/base/assert.h"

uint32_t bytes_crc32(const uint8_t *data, size_t bytes) {
  FRAY_ASSERT(data != NULL || bytes == 0);
  /* four bits at a time: sixteen entries stay small in flash */
  static const uint32_t nibble[16] = {
      0x00000000u, 0x1DB71064u, 0x3B6E20C8u, 0x26D930ACu, 0x76DC4190u, 0x6B6B51F4u,
      0x4DB26158u, 0x5005713Cu, 0xEDB88320u, 0xF00F9344u, 0xD6D6A3E8u, 0xCB61B38Cu,
      0x9B64C2B0u, 0x86D3D2D4u, 0xA00AE278u, 0xBDBDF21Cu};
  uint32_t crc = 0xFFFFFFFFu;
  for (size_t n = 0; n < bytes; ++n) {
    crc ^= data[n];
    crc = (crc >> 4) ^ nibble[crc & 15u];
    crc = (crc >> 4) ^ nibble[crc & 15u];
  }
  return crc ^ 0xFFFFFFFFu;
}

void bytes_zero(void *to, size_t bytes) {
  FRAY_ASSERT(to != NULL || bytes == 0);
  uint8_t *p = (uint8_t *)to;
  for (size_t n = 0; n < bytes; ++n) p[n] = 0;
}

void bytes_copy(void *to, const void *from, size_t bytes) {
  FRAY_ASSERT(bytes == 0 || (to != NULL && from != NULL));
  uint8_t *p = (uint8_t *)to;
  const uint8_t *q = (const uint8_t *)from;
  for (size_t n = 0; n < bytes; ++n) p[n] = q[n];
}
