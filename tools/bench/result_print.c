/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/fray.h"
#include "tools/bench/machine.h"
#include "tools/bench/result.h"
#include "tools/world/kernel.h"

void machine_print(FILE *out) {
  const machine m = machine_here();
  fprintf(out, "%s, %ld processors; %s; fray %s\n", m.processor, m.processors, m.compiler,
          FRAY_VERSION);
}

static void print_projections(FILE *out, const bench_result *r, const projection_times *t) {
  for (uint32_t n = 0; n < r->kernels.count; ++n) {
    fprintf(out, "    fray %-14s %7.2f %7.2f  ", kernel_name(r->kernels.list[n]),
            t->fray[n].min, t->fray[n].median);
    for (uint32_t loop = 0; loop < LOOPS; ++loop)
      if (t->loop[loop].min > 0)
        fprintf(out, " %6.2f", t->ratio[n][loop]);
      else
        fprintf(out, "      -");
    fprintf(out, "\n");
  }
  for (uint32_t loop = 0; loop < LOOPS; ++loop)
    if (t->loop[loop].min > 0)
      fprintf(out, "    %-19s %7.2f %7.2f\n", loop_names[loop], t->loop[loop].min,
              t->loop[loop].median);
    else if (loop == LOOP_RECORDS || loop == LOOP_ARRAYS)
      fprintf(out, "    %-19s this machine lacks AVX2 or FMA\n", loop_names[loop]);
}

static void print_stages(FILE *out, const bench_result *r) {
  fprintf(out, "  us a tick by stage");
  for (uint32_t k = 0; k < r->kernels.count; ++k)
    fprintf(out, " %15s", kernel_name(r->kernels.list[k]));
  fprintf(out, "\n");
  for (int n = 0; n < TIMED_COUNT; ++n) {
    fprintf(out, "    %-16s", timed_labels[n]);
    for (uint32_t k = 0; k < r->kernels.count; ++k) {
      const profile *p = &r->profiles[k];
      fprintf(out, " %8.2f %4.1f %%", p->stage_ns[n] / 1e3, profile_share(p, p->stage_ns[n]));
    }
    fprintf(out, "\n");
  }
}

static void print_phases(FILE *out, const bench_result *r) {
  for (int phase = 0; phase < TEAR_PHASES; ++phase) {
    if (r->profiles[0].phases[phase].ticks == 0) continue;
    fprintf(out, "  ms a tick %s, %u ticks: mean (worst)\n", tear_phase_labels[phase],
            r->profiles[0].phases[phase].ticks);
    for (uint32_t k = 0; k < r->kernels.count; ++k) {
      const tear_phase *p = &r->profiles[k].phases[phase];
      fprintf(out, "    %-7s", kernel_name(r->kernels.list[k]));
      for (int n = 0; n < TEAR_PARTS; ++n)
        fprintf(out, " %s %.3f (%.3f)%s", tear_part_labels[n], p->mean_ns[n] / 1e6, p->worst_ns[n] / 1e6,
                n + 1 < TEAR_PARTS ? "," : "\n");
    }
  }
}

void result_print(FILE *out, const bench_result *r) {
  const profile *first = &r->profiles[0];
  if (r->triangles != 0)
    fprintf(out, "%s: %u triangles", r->name, r->triangles);
  else
    fprintf(out, "%s: %u x %u", r->name, r->warps, r->wefts);
  fprintf(out, ", %u ticks at %u Hz, %u substeps; %zu bytes of memory\n", first->ticks, first->rate_hz, first->substeps,
          r->memory_bytes);
  fprintf(out, "  counted work a tick: median %u, worst %u\n", first->work_median,
          first->work_worst);
  for (uint32_t n = 0; n < r->kernels.count; ++n) {
    const profile *p = &r->profiles[n];
    fprintf(out,
            "  %-7s %9.1f us a tick (median of the runs %.1f, worst tick %.1f), %.2f times real"
            " time\n",
            kernel_name(p->kernel), p->tick_ns.min / 1e3, p->tick_ns.median / 1e3,
            p->worst_ns / 1e3, profile_real_time(p));
  }
  print_stages(out, r);
  print_phases(out, r);
  if (r->any.rows == 0) {
    fprintf(out, "  no projections: membranes have no links; predict has their stress and bending\n");
    return;
  }
  fprintf(out,
          "  ns a projection, %u links, %.0f %% in runs\n"
          "                          least  median   ratio to float plain, coloured, AVX2 by ids,"
          " in runs\n",
          r->any.rows, 100.0 * r->any.springs_in_runs / r->any.rows);
  print_projections(out, r, &r->any);
  if (r->runs.rows > 0) {
    fprintf(out, "  of its links in long runs alone, %u\n", r->runs.rows);
    print_projections(out, r, &r->runs);
  }
}

void scaling_print(FILE *out, const scaling *g) {
  fprintf(out,
          "hanging cloths, 4 substeps, %s\n"
          "  crossings   us a tick   median   ns a crossing   bytes a crossing   in the image\n",
          kernel_name(g->kernel));
  for (uint32_t n = 0; n < SCALING_SIZES; ++n) {
    const scaling_point *p = &g->points[n];
    const double crossings = (double)p->warps * p->wefts;
    fprintf(out, "  %9.0f  %10.1f %8.1f %15.2f %18.1f %14.1f\n", crossings,
            p->tick_ns.min / 1e3, p->tick_ns.median / 1e3, p->tick_ns.min / crossings,
            (double)p->memory_bytes / crossings, (double)p->image_bytes / crossings);
  }
  fprintf(out,
          "  line through the least: %.2f ns a crossing and tick, %.1f us at none, R2 %.5f\n"
          "  through the medians:    %.2f ns a crossing and tick, %.1f us at none, R2 %.5f\n",
          g->min.slope, g->min.offset / 1e3, g->min.r2, g->median.slope,
          g->median.offset / 1e3, g->median.r2);
}
