/* SPDX-License-Identifier: Apache-2.0 */
/* End-to-end protection of a message: AUTOSAR E2E profile 2.
 * Byte 0 is a CRC-8 over bytes 1.. and one more byte that is not sent: the entry of the message's id list for
 * its counter. Byte 1 has the counter in its low nibble.
 *
 * The list of a message is entry(c) = base ^ (c << 1) ^ (c << 2). With it no flip of 1, 2 or 3 bits of 8
 * bytes passes (tests/unit/test_e2e.c tries them all); a plain list 0..15 lets 768 flips of three bits
 * through, because a flip in the counter also picks another entry.
 *
 * Contract of all functions here. Context: any thread or interrupt, at the same time too: nothing is kept.
 * NULL: never, but for `data` of no bytes. base: 0..255, id: 0..255, any. Errors: none but the result. */
#ifndef FRAY_WIRE_E2E_H
#define FRAY_WIRE_E2E_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* CRC-8H2F of `data`: polynomial 0x2F, first value 0xFF, result inverted; "123456789" gives 0xDF.
 * bytes: 0 to what data holds. Cost: 8 steps a byte, no table. */
uint8_t e2e_crc(const uint8_t *data, uint32_t bytes);

/* The CRC of a message: bytes 1 to length - 1, then `id`. length >= 2. Cost: 8 steps a byte. */
uint8_t e2e_crc_message(const uint8_t *data, uint32_t length, uint8_t id);

/* The entry of the id list. counter: its low four bits count. Cost: constant. */
uint8_t e2e_id(uint8_t base, uint8_t counter);

/* Writes the counter into byte 1 (the high nibble stays) and the CRC into byte 0. length >= 2. counter: its
 * low four bits count. Cost: 8 steps a byte. */
void e2e_protect(uint8_t *data, uint32_t length, uint8_t base, uint8_t counter);

/* Returns 1 iff byte 0 is the CRC of the rest. length >= 2. Cost: 8 steps a byte. */
int e2e_check(const uint8_t *data, uint32_t length, uint8_t base);

#ifdef __cplusplus
}
#endif
#endif
