/* SPDX-License-Identifier: Apache-2.0 */
/* Cortex-M3: vectors, zeroed and initialised data, main, exit status to the emulator. */
#include <stdint.h>

#include "tests/target/cortexm3/semihost.h"

extern uint32_t stack_top[], data_load[], data_first[], data_last[], bss_first[], bss_last[];

int main(void);
void reset_handler(void);
static void fault_handler(void);

typedef void (*vector)(void);
__attribute__((section(".vectors"), used)) static const struct {
  uint32_t *stack;
  vector handler[15];
} vectors = {stack_top,
             {reset_handler, fault_handler, fault_handler, fault_handler, fault_handler,
              fault_handler, 0, 0, 0, 0, fault_handler, fault_handler, 0, fault_handler,
              fault_handler}};

static void fault_handler(void) {
  semihost_print("fault\n");
  semihost_exit(99);
}

void reset_handler(void) {
  const uint32_t *from = data_load;
  for (uint32_t *to = data_first; to < data_last;) *to++ = *from++;
  for (uint32_t *to = bss_first; to < bss_last;) *to++ = 0;
  semihost_exit(main());
}
