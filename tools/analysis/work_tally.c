/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/analysis/work_tally.h"

#include <stdlib.h>
#include <string.h>

#define STEADY(X) \
  X(particle_steps, 112) X(projections, 100) X(springs, 166) X(tear_tests, 38) X(broad_phase_tests, 20) \
  X(transitions, 38) X(slips, 3390) X(yarn_forces, 100)
#define EVENTS(X) X(contacts, 634) X(tears, 390) X(over_threshold, 146) X(splits, 7070)

#define WEIGHED(count, instructions) +(double)w->count * (instructions)
static double events_of(const fray_work *w) { return 0 EVENTS(WEIGHED); }
static double work_of(const fray_work *w) { return events_of(w) STEADY(WEIGHED); }

#define BEYOND(count, instructions) || w->count > most->count
static int is_beyond(const fray_work *w, const fray_work *most) {
  return 0 STEADY(BEYOND) EVENTS(BEYOND);
}

void work_tally_open(work_tally *t, const fray_world *w) {
  memset(t, 0, sizeof *t);
  t->limits = fray_work_bound(w);
  t->torn = fray_view_particles(w).count > fray_view_weave(w).warps * fray_view_weave(w).wefts;
}

void work_tally_add(work_tally *t, const fray_output *output) {
  const double work = work_of(&output->work);
  t->torn |= output->work.tears != 0 || output->work.splits != 0;
  const int phase = t->torn ? TALLY_TORN : TALLY_INTACT;
  if (t->count[phase] == t->room[phase]) {
    const uint32_t room = t->room[phase] != 0 ? 2 * t->room[phase] : 1024;
    double *grown = realloc(t->ticks[phase], room * sizeof *grown);
    if (grown == NULL) {
      t->failed = 1;
      return;
    }
    t->ticks[phase] = grown;
    t->room[phase] = room;
  }
  t->ticks[phase][t->count[phase]++] = work;
  t->beyond += is_beyond(&output->work, &t->limits) ? 1u : 0u;
  if (work > t->worst) t->worst = work;
  if (events_of(&output->work) > t->worst_events) t->worst_events = events_of(&output->work);
}

static int rising(const void *a, const void *b) {
  const double x = *(const double *)a;
  const double y = *(const double *)b;
  return (x > y) - (x < y);
}

static void print_phase(work_tally *t, int phase, const char *name, FILE *out) {
  const uint32_t count = t->count[phase];
  if (count == 0) return;
  qsort(t->ticks[phase], count, sizeof *t->ticks[phase], rising);
  const double median = t->ticks[phase][count / 2];
  fprintf(out, "work %-7s %.2f M instructions a tick (median), worst %.2f times\n", name,
          median * 1e-6, t->ticks[phase][count - 1] / median);
}

void work_tally_print(work_tally *t, FILE *out) {
  if (t->failed || t->count[TALLY_INTACT] + t->count[TALLY_TORN] == 0) return;
  const double bound = work_of(&t->limits);
  print_phase(t, TALLY_INTACT, "intact", out);
  print_phase(t, TALLY_TORN, "torn", out);
  fprintf(out, "work worst   %.2f M of the bound of %.2f M", t->worst * 1e-6, bound * 1e-6);
  fprintf(out, "; events %.1f %% of it, at most %.1f %%", 100 * t->worst_events / bound,
          100 * events_of(&t->limits) / bound);
  fprintf(out, "; %u ticks beyond a bound\n", t->beyond);
}

void work_tally_close(work_tally *t) {
  for (int phase = 0; phase < TALLY_PHASES; ++phase) free(t->ticks[phase]);
}
