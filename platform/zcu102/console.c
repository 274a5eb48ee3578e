/* SPDX-License-Identifier: Apache-2.0 */
#include "platform/zcu102/console.h"

#include "platform/zcu102/cpu.h"

/* UG1085, chapter 21. */
static const uintptr_t uart = 0xFF000000u;
enum { CR = 0x00, MR = 0x04, BAUDGEN = 0x18, SR = 0x2C, FIFO = 0x30, BDIV = 0x34 };
enum { CR_TXEN = 1 << 4, CR_RESET = 3, MR_8N1 = 4 << 3, SR_TXFULL = 1 << 4 };

void console_begin(void) {
  device_write(uart, CR, CR_RESET);
  device_write(uart, MR, MR_8N1);
  device_write(uart, BAUDGEN, 124); /* 100 MHz / 124 / (6 + 1) */
  device_write(uart, BDIV, 6);
  device_write(uart, CR, CR_TXEN);
}

void platform_print(const char *text) {
  for (; *text != 0; ++text) {
    while ((device_read(uart, SR) & SR_TXFULL) != 0) {
    }
    device_write(uart, FIFO, (uint8_t)*text);
  }
}

void console_number(uint64_t v, uint32_t digits) {
  char text[21];
  uint32_t at = 20;
  text[at] = 0;
  do {
    text[--at] = (char)('0' + v % 10u);
    v /= 10u;
  } while (at > 0 && (v != 0 || 20u - at < digits));
  platform_print(text + at);
}

void console_hex(uint64_t v, uint32_t digits) {
  char text[17];
  for (uint32_t n = 0; n < digits; ++n)
    text[n] = "0123456789ABCDEF"[v >> 4u * (digits - 1u - n) & 15u];
  text[digits] = 0;
  platform_print(text);
}
