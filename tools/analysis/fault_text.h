/* SPDX-License-Identifier: Apache-2.0 */
/* Fault bits (FRAY_FAULTS of rt/fray.h) in words. */
#ifndef FRAY_TOOLS_ANALYSIS_FAULT_TEXT_H
#define FRAY_TOOLS_ANALYSIS_FAULT_TEXT_H

#include <stdint.h>
#include <stdio.h>

/* Writes "faults       none", or the bits in hex and a line for each: its number, name, cause and what to
 * do. A bit that the table does not have is called unknown. */
void fault_text_print(FILE *out, uint32_t faults);

#endif
