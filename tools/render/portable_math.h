/* SPDX-License-Identifier: Apache-2.0 */
/* What a libm computes a little differently on every machine, from + - * / and square roots alone:
 * IEEE 754 gives those one result everywhere, so pictures agree to the byte. It takes a compiler
 * that neither fuses nor widens them: see the options of tools/render in the Makefile. */
#ifndef FRAY_TOOLS_RENDER_PORTABLE_MATH_H
#define FRAY_TOOLS_RENDER_PORTABLE_MATH_H

#include <float.h>

_Static_assert(FLT_EVAL_METHOD == 0,
               "pictures need floats that are computed as floats: see FLOATS in the Makefile");

double portable_sin(double radians); /* to 1e-12, |radians| up to 1e6 */
double portable_cos(double radians);
double portable_root(double v, int n);    /* v >= 0, n 1 to 12: to 1e-14 of it */
double portable_power(double v, int n);   /* n of either sign */
/* Nearly the sine of so many turns. */
float portable_wave(float turns);
/* The power of ten at or below v > 0. */
int portable_decade(double v);

#endif
