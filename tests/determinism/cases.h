/* SPDX-License-Identifier: Apache-2.0 */
/* What every machine replays: images and inputs as arrays, written by emit.c. */
#ifndef FRAY_TESTS_DETERMINISM_CASES_H
#define FRAY_TESTS_DETERMINISM_CASES_H

#include "rt/fray.h"

typedef struct {
  const char *name;
  const uint8_t *image;
  uint32_t image_bytes;
  const fray_input *inputs; /* inputs[input_count]; nothing behind them */
  uint32_t input_count;
  uint32_t ticks;
} replay_case;

extern const replay_case replay_cases[];
extern const uint32_t replay_case_count;

/* The port of a machine. `text` ends with a 0. */
void port_print(const char *text);

#endif
