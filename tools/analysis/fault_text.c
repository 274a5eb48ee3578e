/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/analysis/fault_text.h"

#include "rt/fray.h"

enum { PREFIX = sizeof "FRAY_FAULT_" - 1 };

typedef struct {
  uint32_t bit;
  const char *name, *cause, *action;
} fault;

#define ROW(name, bit, signal, cause, action) {bit, &#name[PREFIX], cause, action},
static const fault FAULTS[] = {FRAY_FAULTS(ROW)};

void fault_text_print(FILE *out, uint32_t faults) {
  if (faults == 0) {
    fprintf(out, "faults       none\n");
    return;
  }
  fprintf(out, "faults       0x%03X\n", (unsigned)faults);
  for (size_t n = 0; n < sizeof FAULTS / sizeof *FAULTS; ++n) {
    const fault *f = &FAULTS[n];
    if ((faults >> f->bit & 1u) == 0) continue;
    fprintf(out, "  bit %-2u     %s: %s\n               %s\n", (unsigned)f->bit, f->name, f->cause, f->action);
  }
  const uint32_t unknown = faults & ~(uint32_t)FRAY_FAULTS_ALL;
  if (unknown != 0) fprintf(out, "  unknown    0x%03X\n", (unsigned)unknown);
}
