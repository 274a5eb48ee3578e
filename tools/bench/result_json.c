/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/fray.h"
#include "tools/bench/machine.h"
#include "tools/bench/result.h"
#include "tools/world/kernel.h"

void machine_json(json *j) {
  const machine m = machine_here();
  json_text(j, "machine", m.processor);
  json_count(j, "processors", (unsigned long long)(m.processors > 0 ? m.processors : 0));
  json_text(j, "compiler", m.compiler);
  json_text(j, "version", FRAY_VERSION);
}

static void put_spread(json *j, const char *key, min_median s, double scale) {
  json_begin(j, key, '{');
  json_number(j, "least", s.min * scale);
  json_number(j, "median", s.median * scale);
  json_end(j, '}');
}

static void put_ratios(json *j, const char *kernel, const double *ratio) {
  json_begin(j, kernel, '{');
  for (uint32_t loop = 0; loop < LOOPS; ++loop)
    if (ratio[loop] > 0) json_number(j, loop_keys[loop], ratio[loop]);
  json_end(j, '}');
}

static void put_projections(json *j, const char *key, const bench_result *r,
                            const projection_times *t) {
  json_begin(j, key, '{');
  json_count(j, "rows", t->rows);
  json_count(j, "rows_in_runs", t->springs_in_runs);
  json_begin(j, "ns", '{');
  for (uint32_t loop = 0; loop < LOOPS; ++loop)
    if (t->loop[loop].min > 0) put_spread(j, loop_keys[loop], t->loop[loop], 1);
  for (uint32_t n = 0; n < r->kernels.count; ++n)
    put_spread(j, kernel_name(r->kernels.list[n]), t->fray[n], 1);
  json_end(j, '}');
  json_begin(j, "ratios", '{');
  for (uint32_t n = 0; n < r->kernels.count; ++n)
    put_ratios(j, kernel_name(r->kernels.list[n]), t->ratio[n]);
  json_end(j, '}');
  json_end(j, '}');
}

static void put_profile(json *j, const profile *p) {
  char hash[17];
  json_begin(j, kernel_name(p->kernel), '{');
  put_spread(j, "tick_us", p->tick_ns, 1e-3);
  json_number(j, "worst_tick_us", p->worst_ns / 1e3);
  json_number(j, "real_time", profile_real_time(p));
  json_number(j, "strain_ns_a_projection", p->projection_ns);
  json_begin(j, "stage_us", '{');
  for (int n = 0; n < TIMED_COUNT; ++n) json_number(j, timed_labels[n], p->stage_ns[n] / 1e3);
  json_end(j, '}');
  snprintf(hash, sizeof hash, "%016llx", (unsigned long long)p->hash);
  json_text(j, "hash", hash);
  json_end(j, '}');
}

void result_json(json *j, const bench_result *r) {
  const profile *first = &r->profiles[0];
  json_begin(j, NULL, '{');
  json_text(j, "scene", r->name);
  if (r->triangles != 0) json_count(j, "triangles", r->triangles);
  json_count(j, "warps", r->warps);
  json_count(j, "wefts", r->wefts);
  json_count(j, "rate_hz", first->rate_hz);
  json_count(j, "substeps", first->substeps);
  json_count(j, "ticks", first->ticks);
  json_count(j, "memory_bytes", r->memory_bytes);
  json_count(j, "work_median", first->work_median);
  json_count(j, "work_worst", first->work_worst);
  json_begin(j, "kernels", '{');
  for (uint32_t n = 0; n < r->kernels.count; ++n) put_profile(j, &r->profiles[n]);
  json_end(j, '}');
  put_projections(j, "projections", r, &r->any);
  if (r->runs.rows > 0) put_projections(j, "projections_in_runs", r, &r->runs);
  json_end(j, '}');
}

static void put_line(json *j, const char *key, const line_fit *f) {
  json_begin(j, key, '{');
  json_number(j, "ns_a_crossing", f->slope);
  json_number(j, "us_at_none", f->offset / 1e3);
  json_number(j, "r2", f->r2);
  json_end(j, '}');
}

void scaling_json(json *j, const scaling *g) {
  json_begin(j, "sweep", '{');
  json_text(j, "kernel", kernel_name(g->kernel));
  json_begin(j, "sizes", '[');
  for (uint32_t n = 0; n < SCALING_SIZES; ++n) {
    const scaling_point *p = &g->points[n];
    json_begin(j, NULL, '{');
    json_count(j, "warps", p->warps);
    json_count(j, "wefts", p->wefts);
    json_count(j, "crossings", (unsigned long long)p->warps * p->wefts);
    json_count(j, "ticks", p->ticks);
    put_spread(j, "tick_us", p->tick_ns, 1e-3);
    json_count(j, "memory_bytes", p->memory_bytes);
    json_count(j, "image_bytes", p->image_bytes);
    json_end(j, '}');
  }
  json_end(j, ']');
  put_line(j, "line_least", &g->min);
  put_line(j, "line_median", &g->median);
  json_end(j, '}');
}
