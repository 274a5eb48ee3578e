/* SPDX-License-Identifier: Apache-2.0 */
/* Text on UART 0, 115200 baud. Waits for room: not for use in a tick. */
#ifndef FRAY_PLATFORM_ZCU102_CONSOLE_H
#define FRAY_PLATFORM_ZCU102_CONSOLE_H

#include <stdint.h>

void console_begin(void);
void platform_print(const char *text); /* ends with a 0 */
void console_number(uint64_t v, uint32_t digits); /* decimal, with zeros to `digits` at least */
void console_hex(uint64_t v, uint32_t digits);    /* upper case */

#endif
