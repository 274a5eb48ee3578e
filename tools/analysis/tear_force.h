/* SPDX-License-Identifier: Apache-2.0 */
/* The force with which two hands tear a cloth, in its three phases: the elastic rise until the first tear, the peak,
 * and what the tear goes on at. */
#ifndef FRAY_TOOLS_ANALYSIS_TEAR_FORCE_H
#define FRAY_TOOLS_ANALYSIS_TEAR_FORCE_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "rt/fray.h"

typedef struct {
  float force[FRAY_HANDS][3]; /* N */
  float apart;                /* cm between the bodies of both hands */
  uint32_t tears;             /* in this tick */
} tear_force_sample;

typedef struct {
  double rise, rise_r2; /* N/cm and R2 of the line of force over the way apart, from a tenth of the peak to the
                           first tear */
  double peak;          /* N */
  size_t peak_at;       /* sample */
  double plateau;       /* N: mean of the middle four fifths of the time from the peak to the last tear */
  double variation;     /* standard deviation over mean there */
} tear_force_hand;

typedef struct {
  uint32_t axis;      /* along which the largest force acts: 0 to 2 for x, y, z */
  size_t first, last; /* samples with the first and the last tear */
  double unbalanced;  /* until the last tear: root mean square of the sum of both forces, over the larger peak */
  tear_force_hand hand[FRAY_HANDS];
} tear_force;

/* Returns 0 where nothing tears or no rise and plateau are to be seen. Memory: 16 bytes a sample, for a while. */
int tear_force_measure(const tear_force_sample *samples, size_t count, tear_force *f);
/* Two lines of a summary, a hand each, and one of both. */
void tear_force_print(FILE *out, const tear_force *f, uint32_t rate_hz);

#endif
