/* SPDX-License-Identifier: Apache-2.0 */
/* The energy account of a run (rt/energy/README.md), in joules: a CSV with a line a tick, and a short account. */
#ifndef FRAY_TOOLS_ANALYSIS_ENERGY_TABLE_H
#define FRAY_TOOLS_ANALYSIS_ENERGY_TABLE_H

#include <stdio.h>

#include "rt/fray.h"

/* Joules of a unit of fray_energy_account. */
double energy_table_unit(const fray_info *facts);
/* Metres per second of fastest_speed's steps. */
double energy_table_speed(const fray_info *facts);
void energy_table_head(FILE *out);
/* The account after a tick; all but what is stored since the run began. */
void energy_table_line(FILE *out, const fray_info *facts, uint64_t tick, const fray_energy_account *account);
/* Supplied, lost, made, and the fastest vertex. */
void energy_table_print(FILE *out, const fray_info *facts, const fray_energy_account *account);

#endif
