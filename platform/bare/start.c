/* SPDX-License-Identifier: Apache-2.0 */
#include "platform/bare/bare.h"

#include "platform/platform.h"

extern uint32_t stack_first[], stack_top[];
extern uint32_t data_load[], data_first[], data_last[], bss_first[], bss_last[];

int main(void);

enum { PAINT = 0x5AA5C33C };

/* Words below the frame that the painting leaves alone: its own registers and its caller's. */
enum { KEPT = 32 };

/* The linker's symbols are the ends of one memory; a compiler takes them for separate objects. */
static inline int below(const uint32_t *word, const uint32_t *end) {
  return (uintptr_t)word < (uintptr_t)end;
}

__attribute__((noinline)) BARE_LOOP static void paint_stack(void) {
  const uint32_t *end = (const uint32_t *)__builtin_frame_address(0) - KEPT;
  for (uint32_t *word = stack_first; below(word, end);) *word++ = PAINT;
}

__attribute__((noinline)) BARE_LOOP static void fill_data(void) {
  const uint32_t *from = data_load;
  for (uint32_t *to = data_first; below(to, data_last);) *to++ = *from++;
  for (uint32_t *to = bss_first; below(to, bss_last);) *to++ = 0;
}

_Noreturn void bare_start(void) {
  paint_stack();
  fill_data();
  platform_exit(main());
}

uint32_t bare_stack_bytes(void) {
  return (uint32_t)((uintptr_t)stack_top - (uintptr_t)stack_first);
}

uint32_t bare_stack_used(void) {
  const uint32_t *word = stack_first;
  while (below(word, stack_top) && *word == PAINT) ++word;
  return (uint32_t)((uintptr_t)stack_top - (uintptr_t)word);
}

void bare_print_number(uint32_t value) {
  char text[11];
  uint32_t at = 10;
  text[at] = 0;
  do {
    text[--at] = (char)('0' + value % 10u);
    value /= 10u;
  } while (value != 0);
  platform_print(text + at);
}

static void print_fault(uint32_t cause) {
  const uint32_t used = bare_stack_used();
  platform_print("fault ");
  bare_print_number(cause);
  platform_print(", stack ");
  bare_print_number(used);
  platform_print(" of ");
  bare_print_number(bare_stack_bytes());
  platform_print(" bytes\n");
}

/* A console that faults must not keep the board from its exit, and an exit that faults must not loop. */
_Noreturn void bare_fault(uint32_t cause) {
  static uint32_t faults;
  const uint32_t before = faults++;
  if (before == 0) print_fault(cause);
  if (before <= 1) platform_exit(BARE_FAULT_STATUS);
  for (;;) {
  }
}
