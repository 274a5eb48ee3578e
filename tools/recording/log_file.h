/* SPDX-License-Identifier: Apache-2.0 */
/* A log of the bus from a file, for run, render, bench and verify. */
#ifndef FRAY_TOOLS_RECORDING_LOG_FILE_H
#define FRAY_TOOLS_RECORDING_LOG_FILE_H

#include <stdio.h>

#include "platform/log/candump.h"

typedef enum { LOG_FILE_GOOD, LOG_FILE_INCOMPLETE, LOG_FILE_REFUSED } log_file_result;

/* cut: it may end anywhere, and ends at a gap; else it must be whole, or is INCOMPLETE. Where it is not GOOD, `err` has
 * a message, and *log is empty. Lines that are neither frames nor comments with `#` are noted there; a file without
 * any frame, but with such lines, is REFUSED. */
log_file_result log_file_load(const char *file, int cut, candump_log *log, FILE *err);

#endif
