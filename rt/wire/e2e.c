/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/wire/e2e.h"

#include <stddef.h>

#include "rt/base/assert.h"

static uint8_t e2e_crc_step(uint8_t crc, uint8_t byte) {
  uint32_t v = (uint32_t)crc ^ byte;
  for (int bit = 0; bit < 8; ++bit) v = (v & 0x80u) != 0 ? (v << 1 ^ 0x2Fu) & 0xFFu : v << 1;
  return (uint8_t)v;
}

uint8_t e2e_crc(const uint8_t *data, uint32_t bytes) {
  FRAY_ASSERT(data != NULL || bytes == 0);
  uint8_t crc = 0xFF;
  for (uint32_t n = 0; n < bytes; ++n) crc = e2e_crc_step(crc, data[n]);
  return crc ^ 0xFFu;
}

uint8_t e2e_crc_message(const uint8_t *data, uint32_t length, uint8_t id) {
  FRAY_ASSERT(data != NULL);
  FRAY_ASSERT(length >= 2);
  uint8_t crc = 0xFF;
  for (uint32_t n = 1; n < length; ++n) crc = e2e_crc_step(crc, data[n]);
  return e2e_crc_step(crc, id) ^ 0xFFu;
}

uint8_t e2e_id(uint8_t base, uint8_t counter) {
  const uint32_t c = counter & 15u;
  return (uint8_t)(base ^ c << 1 ^ c << 2);
}

void e2e_protect(uint8_t *data, uint32_t length, uint8_t base, uint8_t counter) {
  FRAY_ASSERT(data != NULL);
  FRAY_ASSERT(length >= 2);
  data[1] = (uint8_t)((data[1] & 0xF0u) | (counter & 15u));
  data[0] = e2e_crc_message(data, length, e2e_id(base, counter));
}

int e2e_check(const uint8_t *data, uint32_t length, uint8_t base) {
  FRAY_ASSERT(data != NULL);
  FRAY_ASSERT(length >= 2);
  return data[0] == e2e_crc_message(data, length, e2e_id(base, data[1] & 15u));
}
