/* SPDX-License-Identifier: Apache-2.0 */
/* Rows of Markdown tables, each behind the name of its table; tools/bench/bench.sh has the
 * heads. */
#include "tools/bench/result.h"

#include <string.h>

#include "tools/world/kernel.h"

/* A file's name without folders and ending. */
static int short_name(const char *name, const char **from) {
  const char *slash = strrchr(name, '/');
  *from = slash != NULL ? slash + 1 : name;
  return (int)strcspn(*from, ".");
}

static void tick_row(FILE *out, const bench_result *r, const profile *p) {
  const double *ns = p->stage_ns;
  const double shares[6] = {
      ns[TIMED_STRAIN] + ns[TIMED_STRESS] + ns[TIMED_GAINS],
      ns[TIMED_BEND_SHEAR],
      ns[TIMED_ADVANCE] + ns[TIMED_ELASTIC] + ns[TIMED_WIND] + ns[TIMED_VELOCITY],
      ns[TIMED_GATHER] + ns[TIMED_CONTACT_PRIMITIVES],
      ns[TIMED_TEAR] + ns[TIMED_BREAK] + ns[TIMED_MEMBRANE_TEAR],
      ns[TIMED_DEVICES] + ns[TIMED_DAMP] + ns[TIMED_FORCE] + ns[TIMED_REPORT]};
  const char *name;
  const int letters = short_name(r->name, &name);
  fprintf(out, "tick | %.*s, ", letters, name);
  if (r->triangles != 0)
    fprintf(out, "%u triangles", r->triangles);
  else
    fprintf(out, "%u x %u", r->warps, r->wefts);
  fprintf(out, " | %u | %s | %.1f | %.2f |", p->substeps, kernel_name(p->kernel), p->tick_ns.min / 1e3, profile_real_time(p));
  for (int n = 0; n < 6; ++n) fprintf(out, " %.0f %% |", profile_share(p, shares[n]));
  fprintf(out, "\n");
}

static void put_ns(FILE *out, double ns) {
  if (ns > 0)
    fprintf(out, " %.2f |", ns);
  else
    fprintf(out, " - |");
}

static void projection_row(FILE *out, const bench_result *r, const projection_times *t,
                           const char *which) {
  const char *name;
  const int letters = short_name(r->name, &name);
  fprintf(out, "projection | %.*s%s | %u |", letters, name, which, t->rows);
  for (uint32_t loop = 0; loop < LOOPS; ++loop) put_ns(out, t->loop[loop].min);
  for (fray_kernel k = FRAY_KERNEL_SCALAR; k <= FRAY_KERNEL_NEON; ++k) {
    uint32_t n = 0;
    while (n < r->kernels.count && r->kernels.list[n] != k) ++n;
    if (n == r->kernels.count) {
      fprintf(out, " - |");
    } else {
      fprintf(out, " %.2f", t->fray[n].min);
      if (t->loop[LOOP_RECORDS].min > 0)
        fprintf(out, " (%.2f, %.2f)", t->ratio[n][LOOP_RECORDS],
                t->ratio[n][LOOP_ARRAYS]);
      fprintf(out, " |");
    }
  }
  fprintf(out, "\n");
}

/* Milliseconds, mean and worst tick. */
static void phase_row(FILE *out, const bench_result *r, uint32_t kernel, int phase) {
  const tear_phase *p = &r->profiles[kernel].phases[phase];
  const char *name;
  const int letters = short_name(r->name, &name);
  if (p->ticks == 0) return;
  fprintf(out, "tearing | %.*s, %u triangles, %s | %s |", letters, name, r->triangles, tear_phase_labels[phase],
          kernel_name(r->kernels.list[kernel]));
  for (int n = 0; n < TEAR_PARTS; ++n) fprintf(out, " %.3f (%.3f) |", p->mean_ns[n] / 1e6, p->worst_ns[n] / 1e6);
  fprintf(out, "\n");
}

void result_table(FILE *out, const bench_result *r) {
  for (uint32_t n = 0; n < r->kernels.count; ++n) tick_row(out, r, &r->profiles[n]);
  for (int phase = 0; phase < TEAR_PHASES; ++phase)
    for (uint32_t n = 0; n < r->kernels.count; ++n) phase_row(out, r, n, phase);
  projection_row(out, r, &r->any, "");
  if (r->runs.rows > 0) projection_row(out, r, &r->runs, ", long runs alone");
}

void scaling_table(FILE *out, const scaling *g) {
  for (uint32_t n = 0; n < SCALING_SIZES; ++n) {
    const scaling_point *p = &g->points[n];
    const double crossings = (double)p->warps * p->wefts;
    fprintf(out, "sweep | %.0f | %.1f | %.2f | %.1f | %.1f |\n", crossings, p->tick_ns.min / 1e3,
            p->tick_ns.min / crossings, (double)p->memory_bytes / crossings,
            (double)p->image_bytes / crossings);
  }
  fprintf(out, "line %s: %.2f ns a crossing and tick, R2 %.5f\n", kernel_name(g->kernel),
          g->min.slope, g->min.r2);
}
