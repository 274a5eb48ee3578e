/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/analysis/energy_table.h"

#include <inttypes.h>

#define NAME(row, text) text,
static const char *const STORES[] = {FRAY_ENERGY_STORE_ROWS(NAME)};
static const char *const SUPPLIES[] = {FRAY_ENERGY_SUPPLY_ROWS(NAME)};
static const char *const STAGES[] = {FRAY_ENERGY_STAGE_ROWS(NAME)};

static double step_of(const fray_info *f) { return (double)f->lu_um * f->rate_hz * f->substeps; }

double energy_table_unit(const fray_info *f) {
  return 0x1p-40 * f->particle_mass_ng * 1e-24 * step_of(f) * step_of(f);
}

double energy_table_speed(const fray_info *f) { return 0x1p-28 * 1e-6 * step_of(f); }

void energy_table_head(FILE *out) {
  fprintf(out, "tick");
  for (uint32_t n = 0; n < FRAY_ENERGY_STORES; ++n) fprintf(out, ",%s", STORES[n]);
  fprintf(out, ",gravity");
  for (uint32_t n = 0; n < FRAY_ENERGY_SUPPLIES; ++n) fprintf(out, ",%s", SUPPLIES[n]);
  for (uint32_t n = 0; n < FRAY_ENERGY_STAGES; ++n)
    fprintf(out, ",%s_made,%s_lost", STAGES[n], STAGES[n]);
  fprintf(out, ",open\n");
}

/* What the rows leave open of the change of the total, in units. */
static double open_of(const fray_energy_account *a) {
  uint64_t open = 0 - (uint64_t)a->begun; /* large rows leave exact sums in integers alone */
  for (uint32_t n = 0; n < FRAY_ENERGY_STORES; ++n) open += (uint64_t)a->stored[n];
  for (uint32_t n = 0; n < FRAY_ENERGY_SUPPLIES; ++n) open -= (uint64_t)a->supplied[n];
  for (uint32_t n = 0; n < FRAY_ENERGY_STAGES; ++n)
    open -= (uint64_t)a->made[n] - (uint64_t)a->lost[n];
  return (double)(int64_t)open;
}

void energy_table_line(FILE *out, const fray_info *f, uint64_t tick, const fray_energy_account *a) {
  const double unit = energy_table_unit(f);
  fprintf(out, "%" PRIu64, tick);
  for (uint32_t n = 0; n < FRAY_ENERGY_STORES; ++n)
    fprintf(out, ",%.9g", (double)a->stored[n] * unit);
  fprintf(out, ",%.9g", (double)a->gravity * unit);
  for (uint32_t n = 0; n < FRAY_ENERGY_SUPPLIES; ++n)
    fprintf(out, ",%.9g", (double)a->supplied[n] * unit);
  for (uint32_t n = 0; n < FRAY_ENERGY_STAGES; ++n)
    fprintf(out, ",%.9g,%.9g", (double)a->made[n] * unit, (double)a->lost[n] * unit);
  fprintf(out, ",%.3g\n", open_of(a) * unit);
}

static void print_rows(FILE *out, const char *head, double sum, const char *const *names,
                       const int64_t *rows, uint32_t count, double unit) {
  const char *before = " (";
  fprintf(out, "%s%.4g J", head, sum * unit);
  for (uint32_t n = 0; n < count; ++n) {
    if (rows[n] == 0) continue;
    fprintf(out, "%s%s %.3g", before, names[n], (double)rows[n] * unit);
    before = ", ";
  }
  fprintf(out, "%s\n", before[0] == ',' ? ")" : "");
}

void energy_table_print(FILE *out, const fray_info *f, const fray_energy_account *a) {
  const double unit = energy_table_unit(f);
  double supplied = 0;
  double made = 0;
  double lost = 0;
  for (uint32_t n = 0; n < FRAY_ENERGY_SUPPLIES; ++n) supplied += (double)a->supplied[n];
  for (uint32_t n = 0; n < FRAY_ENERGY_STAGES; ++n) {
    made += (double)a->made[n];
    lost += (double)a->lost[n];
  }
  fprintf(out, "gravity      %.4g J\n", (double)a->gravity * unit);
  print_rows(out, "supplied     ", supplied, SUPPLIES, a->supplied, FRAY_ENERGY_SUPPLIES, unit);
  print_rows(out, "lost         ", lost, STAGES, a->lost, FRAY_ENERGY_STAGES, unit);
  print_rows(out, "made         ", made, STAGES, a->made, FRAY_ENERGY_STAGES, unit);
  fprintf(out, "fastest      %.4g m/s, particle %u, tick %" PRIu64 "\n",
          a->fastest_speed * energy_table_speed(f), a->fastest_vertex, a->fastest_tick);
}
