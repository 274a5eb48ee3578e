/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/portable_math.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

double portable_sin(double radians) {
  double x = radians - 2.0 * pi * floor(radians / (2.0 * pi) + 0.5);
  if (x > 0.5 * pi) x = pi - x;
  if (x < -0.5 * pi) x = -pi - x;
  double sum = 1.0;
  for (int k = 20; k >= 2; k -= 2) sum = 1.0 - x * x * sum / (double)(k * (k + 1));
  return x * sum;
}

double portable_cos(double radians) { return portable_sin(radians + 0.5 * pi); }

double portable_power(double v, int n) {
  double product = 1.0;
  for (int k = n < 0 ? -n : n; k > 0; k >>= 1) {
    if (k & 1) product *= v;
    v *= v;
  }
  return n < 0 ? 1.0 / product : product;
}

/* Newton's steps fall from above, and have arrived when they no longer fall. */
double portable_root(double v, int n) {
  if (!(v > 0.0) || n == 1) return v > 0.0 ? v : 0.0;
  double root = v > 1.0 ? v : 1.0;
  for (int round = 0; round < 2000; round++) {
    const double next = root - (root - v / portable_power(root, n - 1)) / (double)n;
    if (!(next < root)) break;
    root = next;
  }
  return root;
}

float portable_wave(float turns) {
  const float t = turns - floorf(turns + 0.5f);
  return 8.0f * t * (1.0f - 2.0f * fabsf(t));
}

int portable_decade(double v) {
  int decade = 0;
  while (decade < 300 && v >= portable_power(10.0, decade + 1)) ++decade;
  while (decade > -300 && v < portable_power(10.0, decade)) --decade;
  return decade;
}
