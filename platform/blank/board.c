/* SPDX-License-Identifier: Apache-2.0 */
/* A blank board: copy this folder, and fill in what every function's comment asks for. It compiles
 * and links as it stands, computes nothing and sends nothing. platform/platform.h has the contract,
 * platform/README.md the order to go about it. */
#include "platform/bare/bare.h"
#include "platform/platform.h"

/* Next tick of a fixed grid. tick_wait() of platform/cortexm or platform/rv32 is all there is to it
 * where the core's own timer serves; call tick_begin() before the first. */
int32_t platform_wait(void) { return -1; }

/* 1. Write the frame to a transmit buffer that nothing else uses.
 * 2. Wait for its transmit-complete flag, PLATFORM_CONFIRM_US at most; bus-off or no flag:
 *    PLATFORM_LOST, and the same frame goes out first in the next call.
 * 3. port_push() what was received before that moment: read the receive level when the flag comes,
 *    in its interrupt if others may delay you, and take so many frames out of the FIFO. */
platform_result platform_sync(const frame *sync, port *p) {
  (void)sync;
  (void)p;
  return PLATFORM_LOST;
}

/* A transmit buffer if one is free; PLATFORM_LOST if not. It never waits. */
platform_result platform_send(const frame *f) {
  (void)f;
  return PLATFORM_LOST;
}

/* A UART, polled: only start-up and faults print. Or link platform/bare/semihost.c. */
void platform_print(const char *text) { (void)text; }

/* What a product does when its program ends or faults: outputs safe, then a reset. */
_Noreturn void platform_exit(int status) {
  (void)status;
  for (;;) {
  }
}
