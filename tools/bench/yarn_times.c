/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/bench/yarn_times.h"

#include <stdlib.h>
#include <string.h>

#include "tools/bench/woven_sample.h"
#include "tools/bench/timed_tick.h"
#include "tools/world/kernel.h"
#include "tools/terminal/progress.h"

enum { SCALING_ROUNDS = 2, LEVEL_ROUNDS = 3, TICKS = WOVEN_SAMPLE_TORN_TICKS, LEVELS = 2, LEVEL_WARPS = 120, LEVEL_WEFTS = 60 };

/* Twice as wide as high: 1k to 40k crossings. */
static const uint32_t heights[YARN_SIZES] = {22, 32, 45, 63, 84, 105, 122, 141};

typedef struct {
  session first; /* as it begins */
  struct world_file now;
  double min[TICKS];
  uint32_t split[TICKS], cuts[TICKS];
} torn_sample;

static int open_torn(const char *kernel, uint32_t warps, uint32_t wefts, woven_sample_bodies bodies,
                     const char *yarns, torn_sample *sample, fray_kernel *taken) {
  kernels k;
  if (!woven_sample_open_torn(warps, wefts, bodies, yarns, &sample->first)) return 1;
  if (!kernels_find(&k, sample->first.world_file.world, kernel)) return 2;
  *taken = kernels_fastest(&k);
  return 0;
}

static void close_torn(torn_sample *sample) {
  world_file_close(&sample->now);
  session_close(&sample->first);
}

static int begin_again(torn_sample *sample, fray_kernel kernel) {
  world_file_close(&sample->now);
  if (!kernels_reopen_world(&sample->first.world_file, &sample->now)) return 0;
  fray_set_kernel(sample->now.world, kernel);
  return 1;
}

static void time_tick(torn_sample *sample, uint32_t round, uint32_t tick) {
  static const fray_input nothing;
  fray_output out;
  const double before = timed_cpu_ns();
  fray_tick(sample->now.world, &nothing, &out);
  const double ns = timed_cpu_ns() - before;
  if (round == 0 || ns < sample->min[tick]) sample->min[tick] = ns;
  sample->split[tick] = out.crossings_loose + out.crossings_disconnected;
  sample->cuts[tick] = out.tears_total;
}

/* Returns 0 iff memory is out. */
static int time_all(torn_sample *samples, uint32_t count, uint32_t rounds, fray_kernel kernel) {
  for (uint32_t round = 0; round < rounds; ++round) {
    for (uint32_t n = 0; n < count; ++n)
      if (!begin_again(&samples[n], kernel)) return 0;
    for (uint32_t tick = 0; tick < TICKS; ++tick) {
      progress_show("ticks of all cloths", round * TICKS + tick, rounds * TICKS);
      for (uint32_t n = 0; n < count; ++n) time_tick(&samples[n], round, tick);
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
  fprintf(stderr, "fray bench: not enough memory for the cloths\n");
  return 1;
}

static int all_torn(const torn_sample *samples, uint32_t count) {
  for (uint32_t n = 0; n < count; ++n)
    if (samples[n].cuts[TICKS - 1] == 0) {
      fprintf(stderr, "fray bench: a cloth has not torn\n");
      return 0;
    }
  return 1;
}

static void keep_scaling(const torn_sample *samples, yarn_scaling *g) {
  double crossings[YARN_SIZES];
  double ns[YARN_SIZES];
  for (uint32_t n = 0; n < YARN_SIZES; ++n) {
    yarn_point *p = &g->points[n];
    p->tick_ns = ns[n] = mean_of(samples[n].min, 0, TICKS);
    p->cuts = samples[n].cuts[TICKS - 1];
    p->split = samples[n].split[TICKS - 1];
    crossings[n] = (double)p->warps * p->wefts;
  }
  g->line = line_through(crossings, ns, YARN_SIZES);
}

int yarn_scaling_measure(const char *kernel, yarn_scaling *g) {
  torn_sample *samples = calloc(YARN_SIZES, sizeof *samples);
  int code = samples == NULL;
  memset(g, 0, sizeof *g);
  for (uint32_t n = 0; code == 0 && n < YARN_SIZES; ++n) {
    g->points[n].warps = 2 * heights[n];
    g->points[n].wefts = heights[n];
    code = open_torn(kernel, 2 * heights[n], heights[n], WOVEN_SAMPLE_CAPSULES, "on", &samples[n], &g->kernel);
  }
  if (code == 0) code = time_all(samples, YARN_SIZES, SCALING_ROUNDS, g->kernel) ? 0 : 1;
  if (code == 1) (void)no_memory();
  if (code == 0) {
    keep_scaling(samples, g);
    code = all_torn(samples, YARN_SIZES) ? 0 : 1;
  }
  for (uint32_t n = 0; samples != NULL && n < YARN_SIZES; ++n) close_torn(&samples[n]);
  free(samples);
  return code;
}

static yarn_part part_of(const torn_sample *samples, uint32_t from, uint32_t to) {
  const uint32_t last = to > 0 ? to - 1 : 0;
  return (yarn_part){samples[0].split[last], samples[0].cuts[last],
                     mean_of(samples[0].min, from, to), mean_of(samples[1].min, from, to)};
}

static void keep_levels(const torn_sample *samples, yarn_levels *l) {
  for (l->first_split = 0; l->first_split < TICKS && samples[0].split[l->first_split] == 0;)
    ++l->first_split;
  l->before = part_of(samples, 0, l->first_split);
  for (uint32_t n = 0; n < YARN_PARTS; ++n)
    l->parts[n] = part_of(samples, n * TICKS / YARN_PARTS, (n + 1) * TICKS / YARN_PARTS);
}

int yarn_levels_measure(const char *kernel, yarn_levels *l) {
  static const char *const yarns[LEVELS] = {"on", "all"};
  torn_sample *samples = calloc(LEVELS, sizeof *samples);
  int code = samples == NULL;
  memset(l, 0, sizeof *l);
  l->warps = LEVEL_WARPS;
  l->wefts = LEVEL_WEFTS;
  for (uint32_t n = 0; code == 0 && n < LEVELS; ++n)
    code = open_torn(kernel, l->warps, l->wefts, WOVEN_SAMPLE_SPHERES, yarns[n], &samples[n], &l->kernel);
  if (code == 0) code = time_all(samples, LEVELS, LEVEL_ROUNDS, l->kernel) ? 0 : 1;
  if (code == 1) (void)no_memory();
  if (code == 0) {
    keep_levels(samples, l);
    code = all_torn(samples, LEVELS) ? 0 : 1;
  }
  for (uint32_t n = 0; samples != NULL && n < LEVELS; ++n) close_torn(&samples[n]);
  free(samples);
  return code;
}

void yarn_scaling_print(FILE *out, const yarn_scaling *g) {
  fprintf(out,
          "cloths torn apart by two bars, %d substeps, %s, mean of %d ticks\n"
          "  crossings   us a tick   ns a crossing  tears   split\n",
          (int)WOVEN_SAMPLE_TORN_SUBSTEPS, kernel_name(g->kernel), (int)TICKS);
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
          "a cloth of %ux%u torn apart by two balls, %d substeps, %s\n"
          "  ticks            split  tears    two-level     all-yarn    ratio   (us a tick)\n",
          l->warps, l->wefts, (int)WOVEN_SAMPLE_TORN_SUBSTEPS, kernel_name(l->kernel));
  for (uint32_t n = 0; n < YARN_PARTS; ++n) {
    snprintf(label, sizeof label, "%u to %u", n * TICKS / YARN_PARTS,
             (n + 1) * TICKS / YARN_PARTS - 1);
    print_part(out, label, l, &l->parts[n]);
  }
  snprintf(label, sizeof label, "before %u", l->first_split);
  print_part(out, label, l, &l->before);
}
