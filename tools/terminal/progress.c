/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/terminal/progress.h"

#include <stdio.h>
#include <unistd.h>

static int shown_percent = -1;

void progress_show(const char *what, uint64_t done, uint64_t all) {
  static int terminal = -1;
  if (terminal < 0) terminal = isatty(STDERR_FILENO);
  const int percent = all > 0 ? (int)(done * 100 / all) : 100;
  if (!terminal || percent == shown_percent) return;
  shown_percent = percent;
  fprintf(stderr, "\r%-56s %3d %%", what, percent);
  fflush(stderr);
}

void progress_end(void) {
  if (shown_percent < 0) return;
  shown_percent = -1;
  fprintf(stderr, "\r%64s\r", "");
  fflush(stderr);
}
