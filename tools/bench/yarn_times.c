/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/bench/yarn_times.h"

#include <stdlib.h>
#include <string.h>

#include "tools/bench/sheets.h"
#include "tools/bench/timed_tick.h"
#include "tools/kernel.h"
#include "tools/progress.h"

enum { GROWTH_ROUNDS = 2, LEVEL_ROUNDS = 3, TICKS = SHEET_TORN_TICKS, LEVELS = 2, LEVEL_WARPS = 120, LEVEL_WEFTS = 60 };

/* Twice as wide as high: 1k to 40k crossings. */
static const uint32_t heights[YARN_SIZES] = {22, 32, 45, 63, 84, 105, 122, 141};

typedef struct {
  session first; /* as it begins */
  struct opened now;
  double least[TICKS];
  uint32_t split[TICKS], cuts[TICKS];
} torn_sheet;

static int open_torn(const char *kernel, uint32_t warps, uint32_t wefts, sheet_grips grips,
                     const char *yarns, torn_sheet *sheet, fray_kernel *taken) {
  kernels k;
  if (!sheet_open_torn(warps, wefts, grips, yarns, &sheet->first)) return 1;
  if (!kernels_find(&k, sheet->first.opened.world, kernel)) return 2;
  *taken = kernels_fastest(&k);
  return 0;
}

static void close_torn(torn_sheet *sheet) {
  world_close(&sheet->now);
  session_close(&sheet->first);
}

static int begin_again(torn_sheet *sheet, fray_kernel kernel) {
  world_close(&sheet->now);
  if (!world_again(&sheet->first.opened, &sheet->now)) return 0;
  fray_use(sheet->now.world, kernel);
  return 1;
}

static void time_tick(torn_sheet *sheet, uint32_t round, uint32_t tick) {
  static const fray_input nothing;
  fray_output out;
  const double before = timed_cpu_ns();
  fray_tick(sheet->now.world, &nothing, &out);
  const double ns = timed_cpu_ns() - before;
  if (round == 0 || ns < sheet->least[tick]) sheet->least[tick] = ns;
  sheet->split[tick] = out.couples_loose + out.couples_disconnected;
  sheet->cuts[tick] = out.cuts_total;
}

/* Returns 0 iff memory is out. */
static int time_all(torn_sheet *sheets, uint32_t count, uint32_t rounds, fray_kernel kernel) {
  for (uint32_t round = 0; round < rounds; ++round) {
    for (uint32_t n = 0; n < count; ++n)
      if (!begin_again(&sheets[n], kernel)) return 0;
    for (uint32_t tick = 0; tick < TICKS; ++tick) {
      progress_show("ticks of all sheets", round * TICKS + tick, rounds * TICKS);
      for (uint32_t n = 0; n < count; ++n) time_tick(&sheets[n], round, tick);
    }
  }
  progress_end();
  return 1;
}

static double mean_of(const double *ns, uint32_t from, uint32_t to) {
  double sum = 0;
  for (uint32_t tick = from; tick < to; ++tick) sum += ns[tick];
  return to > from ? sum / (to - from) : 0;
}

static int no_memory(void) {
  fprintf(stderr, "fray bench: not enough memory for the sheets\n");
  return 1;
}

static int all_torn(const torn_sheet *sheets, uint32_t count) {
  for (uint32_t n = 0; n < count; ++n)
    if (sheets[n].cuts[TICKS - 1] == 0) {
      fprintf(stderr, "fray bench: a sheet has not torn\n");
      return 0;
    }
  return 1;
}

static void keep_growth(const torn_sheet *sheets, yarn_growth *g) {
  double crossings[YARN_SIZES];
  double ns[YARN_SIZES];
  for (uint32_t n = 0; n < YARN_SIZES; ++n) {
    yarn_point *p = &g->points[n];
    p->tick_ns = ns[n] = mean_of(sheets[n].least, 0, TICKS);
    p->cuts = sheets[n].cuts[TICKS - 1];
    p->split = sheets[n].split[TICKS - 1];
    crossings[n] = (double)p->warps * p->wefts;
  }
  g->line = line_through(crossings, ns, YARN_SIZES);
}

int yarn_growth_measure(const char *kernel, yarn_growth *g) {
  torn_sheet *sheets = calloc(YARN_SIZES, sizeof *sheets);
  int code = sheets == NULL;
  memset(g, 0, sizeof *g);
  for (uint32_t n = 0; code == 0 && n < YARN_SIZES; ++n) {
    g->points[n].warps = 2 * heights[n];
    g->points[n].wefts = heights[n];
    code = open_torn(kernel, 2 * heights[n], heights[n], SHEET_BARS, "on", &sheets[n], &g->kernel);
  }
  if (code == 0) code = time_all(sheets, YARN_SIZES, GROWTH_ROUNDS, g->kernel) ? 0 : 1;
  if (code == 1) (void)no_memory();
  if (code == 0) {
    keep_growth(sheets, g);
    code = all_torn(sheets, YARN_SIZES) ? 0 : 1;
  }
  for (uint32_t n = 0; sheets != NULL && n < YARN_SIZES; ++n) close_torn(&sheets[n]);
  free(sheets);
  return code;
}

static yarn_part part_of(const torn_sheet *sheets, uint32_t from, uint32_t to) {
  const uint32_t last = to > 0 ? to - 1 : 0;
  return (yarn_part){sheets[0].split[last], sheets[0].cuts[last],
                     mean_of(sheets[0].least, from, to), mean_of(sheets[1].least, from, to)};
}

static void keep_levels(const torn_sheet *sheets, yarn_levels *l) {
  for (l->first_split = 0; l->first_split < TICKS && sheets[0].split[l->first_split] == 0;)
    ++l->first_split;
  l->before = part_of(sheets, 0, l->first_split);
  for (uint32_t n = 0; n < YARN_PARTS; ++n)
    l->parts[n] = part_of(sheets, n * TICKS / YARN_PARTS, (n + 1) * TICKS / YARN_PARTS);
}

int yarn_levels_measure(const char *kernel, yarn_levels *l) {
  static const char *const yarns[LEVELS] = {"on", "all"};
  torn_sheet *sheets = calloc(LEVELS, sizeof *sheets);
  int code = sheets == NULL;
  memset(l, 0, sizeof *l);
  l->warps = LEVEL_WARPS;
  l->wefts = LEVEL_WEFTS;
  for (uint32_t n = 0; code == 0 && n < LEVELS; ++n)
    code = open_torn(kernel, l->warps, l->wefts, SHEET_BALLS, yarns[n], &sheets[n], &l->kernel);
  if (code == 0) code = time_all(sheets, LEVELS, LEVEL_ROUNDS, l->kernel) ? 0 : 1;
  if (code == 1) (void)no_memory();
  if (code == 0) {
    keep_levels(sheets, l);
    code = all_torn(sheets, LEVELS) ? 0 : 1;
  }
  for (uint32_t n = 0; sheets != NULL && n < LEVELS; ++n) close_torn(&sheets[n]);
  free(sheets);
  return code;
}

void yarn_growth_print(FILE *out, const yarn_growth *g) {
  fprintf(out,
          "sheets torn apart by two bars, %d substeps, %s, mean of %d ticks\n"
          "  crossings   us a tick   ns a crossing   cuts   split\n",
          (int)SHEET_TORN_SUBSTEPS, kernel_name(g->kernel), (int)TICKS);
  for (uint32_t n = 0; n < YARN_SIZES; ++n) {
    const yarn_point *p = &g->points[n];
    const uint32_t crossings = p->warps * p->wefts;
    fprintf(out, "  %9u  %10.1f %15.2f %6u  %4.1f %%\n", crossings, p->tick_ns / 1e3,
            p->tick_ns / crossings, p->cuts, 100.0 * p->split / crossings);
  }
  fprintf(out, "  line: %.2f ns a crossing and tick, %.1f us at none, R2 %.5f\n", g->line.slope,
          g->line.offset / 1e3, g->line.r2);
}

static void print_part(FILE *out, const char *label, const yarn_levels *l, const yarn_part *p) {
  fprintf(out, "  %-12s %8.1f %% %6u %12.1f %12.1f %8.2f\n", label,
          100.0 * p->split / (l->warps * l->wefts), p->cuts, p->two_level / 1e3, p->all_yarn / 1e3,
          p->two_level > 0 ? p->all_yarn / p->two_level : 0);
}

void yarn_levels_print(FILE *out, const yarn_levels *l) {
  char label[32];
  fprintf(out,
          "a sheet of %ux%u torn apart by two balls, %d substeps, %s\n"
          "  ticks            split   cuts    two-level     all-yarn    ratio   (us a tick)\n",
          l->warps, l->wefts, (int)SHEET_TORN_SUBSTEPS, kernel_name(l->kernel));
  for (uint32_t n = 0; n < YARN_PARTS; ++n) {
    snprintf(label, sizeof label, "%u to %u", n * TICKS / YARN_PARTS,
             (n + 1) * TICKS / YARN_PARTS - 1);
    print_part(out, label, l, &l->parts[n]);
  }
  snprintf(label, sizeof label, "before %u", l->first_split);
  print_part(out, label, l, &l->before);
}
