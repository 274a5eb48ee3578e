/* SPDX-License-Identifier: Apache-2.0 */
/* A log of the bus from a file, for run, render, bench and verify. */
#ifndef FRAY_TOOLS_RECORDING_LOG_FILE_H
#define FRAY_TOOLS_RECORDING_LOG_FILE_H

#include <stdio.h>

#include "platform/log/candump.h"

/* cut: it may end anywhere, and ends at a gap; else it must be whole. Returns 0 after a message to `err`. Lines that
 * are neither frames nor comments with `#` are noted there; a file without any frame, but with such lines, is none. */
int log_file_load(const char *file, int cut, candump_log *log, FILE *err);

#endif
