/* SPDX-License-Identifier: Apache-2.0 */
/* What continuous collisions cost on a small target: one line for each piece between two marks.
 *
 *   FAMILY SHAPE none|contact     a call, pairs of tests/physics; thickness 0, and 1/50 lu where
 *                                 the name ends in _thick */
#include "tests/determinism/cases.h"
#include "tests/determinism/line.h"
#include "tests/physics/moving_pairs.h"

enum { CALLS = 300 };

void work_mark(void);
__attribute__((noinline)) void work_mark(void) { __asm__ volatile("" ::: "memory"); }

static void count_family(const family_row *row, int triangle, int32_t thickness) {
  line l = {{0}, 0};
  for (uint32_t n = 0; n < CALLS; ++n) {
    ccd_path p[4];
    ccd_contact c;
    row->make(p, triangle);
    work_mark();
    const int found = ccd_of_pair(p, triangle, thickness, &c);
    work_mark();
    add_text(&l, row->name);
    add_text(&l, thickness != 0 ? "_thick" : "");
    add_text(&l, triangle ? " triangle" : " edges");
    add_text(&l, found ? " contact" : " none");
    print_line(&l);
  }
}

int main(void) {
  for (uint32_t n = 0; n < FAMILIES; ++n)
    for (int triangle = 0; triangle < 2; ++triangle) {
      count_family(&families[n], triangle, 0);
      if (n >= 1 && n <= 2) count_family(&families[n], triangle, FX_LU / 50);
    }
  port_print("end\n");
  return 0;
}
