/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/analysis/tear_force.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/analysis/line_fit.h"

enum { SAMPLES_MIN = 10 }; /* of a rise, of a plateau */

static int find_tears(const tear_force_sample *samples, size_t count, tear_force *f) {
  f->first = count;
  for (size_t n = 0; n < count; ++n) {
    if (samples[n].tears == 0) continue;
    if (f->first == count) f->first = n;
    f->last = n;
  }
  return f->first < count;
}

static uint32_t strongest_axis(const tear_force_sample *samples, const tear_force *f) {
  uint32_t axis = 0;
  float most = 0;
  for (size_t n = 0; n <= f->last; ++n)
    for (uint32_t a = 0; a < 3; ++a)
      if (fabsf(samples[n].force[0][a]) > most) {
        most = fabsf(samples[n].force[0][a]);
        axis = a;
      }
  return axis;
}

static int measure_rise(const tear_force_sample *samples, const tear_force *f, uint32_t hand, tear_force_hand *h) {
  size_t start = f->first;
  while (start > 0 && fabs((double)samples[start - 1].force[hand][f->axis]) > h->peak / 10) --start;
  const size_t count = f->first - start;
  if (count < SAMPLES_MIN) return 0;
  double *apart = malloc(count * sizeof *apart), *force = malloc(count * sizeof *force);
  const int good = apart != NULL && force != NULL;
  for (size_t n = 0; good && n < count; ++n) {
    apart[n] = (double)samples[start + n].apart;
    force[n] = fabs((double)samples[start + n].force[hand][f->axis]);
  }
  if (good) {
    const line_fit line = line_through(apart, force, count);
    h->rise = line.slope;
    h->rise_r2 = line.r2;
  }
  free(apart);
  free(force);
  return good;
}

static int measure_hand(const tear_force_sample *samples, const tear_force *f, uint32_t hand, tear_force_hand *h) {
  for (size_t n = 0; n <= f->last; ++n) {
    const double force = fabs((double)samples[n].force[hand][f->axis]);
    if (force <= h->peak) continue;
    h->peak = force;
    h->peak_at = n;
  }
  if (h->peak_at + SAMPLES_MIN < f->first) return 0; /* it did not rise to the tear */
  if (f->last < h->peak_at + 2 * SAMPLES_MIN || !measure_rise(samples, f, hand, h)) return 0;
  const size_t margin = (f->last - h->peak_at) / 10, begin = h->peak_at + margin, end = f->last - margin;
  double sum = 0, squares = 0;
  for (size_t n = begin; n < end; ++n) {
    const double force = fabs((double)samples[n].force[hand][f->axis]);
    sum += force;
    squares += force * force;
  }
  h->plateau = sum / (double)(end - begin);
  h->variation = sqrt(fmax(0, squares / (double)(end - begin) - h->plateau * h->plateau)) / h->plateau;
  return 1;
}

int tear_force_measure(const tear_force_sample *samples, size_t count, tear_force *f) {
  memset(f, 0, sizeof *f);
  if (!find_tears(samples, count, f)) return 0;
  f->axis = strongest_axis(samples, f);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    if (!measure_hand(samples, f, h, &f->hand[h])) return 0;
  double squares = 0;
  for (size_t n = 0; n <= f->last; ++n) {
    const double sum = (double)samples[n].force[0][f->axis] + (double)samples[n].force[1][f->axis];
    squares += sum * sum;
  }
  f->unbalanced = sqrt(squares / (double)(f->last + 1)) / fmax(f->hand[0].peak, f->hand[1].peak);
  return 1;
}

void tear_force_print(FILE *out, const tear_force *f, uint32_t rate_hz) {
  static const char *const hands[FRAY_HANDS] = {"left", "right"};
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    const tear_force_hand *one = &f->hand[h];
    fprintf(out,
            "tearing      %-5s rise %.3f N/cm, R2 %.4f; peak %.3f N at %.3f s; goes on at %.3f N, %.1f %% of the peak, "
            "varies by %.1f %%\n",
            hands[h], one->rise, one->rise_r2, one->peak, (double)(one->peak_at + 1) / rate_hz, one->plateau,
            100 * one->plateau / one->peak, 100 * one->variation);
  }
  fprintf(out, "             along %c; the sum of both is %.1f %% of the peak\n", "xyz"[f->axis % 3],
          100 * f->unbalanced);
}
