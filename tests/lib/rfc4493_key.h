/* SPDX-License-Identifier: Apache-2.0 */
/* The key of RFC 4493's examples. */
#ifndef FRAY_TESTS_LIB_RFC4493_KEY_H
#define FRAY_TESTS_LIB_RFC4493_KEY_H

#include <stdint.h>

static const uint8_t RFC4493_KEY[16] = {0x2b, 0x7e, 0x15, 0x16, 0x28, 0xae, 0xd2, 0xa6,
                                        0xab, 0xf7, 0x15, 0x88, 0x09, 0xcf, 0x4f, 0x3c};

#endif
