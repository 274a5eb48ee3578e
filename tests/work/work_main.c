/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/cross/cases.h"
#include "rt/model/world.h"

__attribute__((noinline)) void work_mark(void);
__attribute__((noinline)) void work_mark(void) { __asm__ volatile("" ::: "memory"); }
#define CROSS_MEMORY (1u<<18)
_Alignas(16) static uint8_t memory[CROSS_MEMORY];
int main(void) {
  for (uint32_t n = 0; n < cross_case_count; ++n) {
    const cross_case *c = &cross_cases[n];
    fray_world *w;
    fray_output out;
    if (fray_open(c->image, c->image_bytes, memory, sizeof memory, &w, 0) != FRAY_OK) return 1;
    for (uint32_t t = 0; t < c->ticks; ++t) {
      static const fray_input nothing;
      work_mark();
      fray_tick(w, t < c->input_count ? &c->inputs[t] : &nothing, &out);
      work_mark();
    }
  }
  port_print("end\n");
  return 0;
}
