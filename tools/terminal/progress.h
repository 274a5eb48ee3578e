/* SPDX-License-Identifier: Apache-2.0 */
/* One line of progress on a terminal; nothing in a pipe. */
#ifndef FRAY_TOOLS_TERMINAL_PROGRESS_H
#define FRAY_TOOLS_TERMINAL_PROGRESS_H

#include <stdint.h>

/* Shows `what` at done / all; call as often as you like. */
void progress_show(const char *what, uint64_t done, uint64_t all);
/* Clears the line. */
void progress_end(void);

#endif
