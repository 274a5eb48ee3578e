/* SPDX-License-Identifier: Apache-2.0 */
/* wild SEED COUNT [SECONDS [FIRST]] [short]: random scenes, judged (README.md). Findings by kind, each with
 * the first scene that has it, shrunk, in out/wild; scenes a minute. `short` judges only what holds
 * today. Exit 1: something was found. */
#define _POSIX_C_SOURCE 200809L
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "tests/wild/judge.h"
#include "tests/wild/random_scene.h"
#include "tests/wild/shrink.h"

enum { SHRINK_TRIES = 24, PATH_ROOM = 128 };

typedef struct {
  uint64_t seed;
  uint32_t count, refused, scenes[RANDOM_KINDS], judged;
  uint32_t found[JUDGE_KINDS], by_cloth[JUDGE_KINDS][RANDOM_KINDS];
  double worst[JUDGE_KINDS];
  double seconds;
  uint32_t kinds; /* that are judged, a bit each */
} wild;

static void write_text(const char *path, const char *text) {
  FILE *out = fopen(path, "w");
  if (out == NULL || fputs(text, out) < 0 || fclose(out) != 0) {
    perror(path);
    exit(2);
  }
}

/* Its scene, the poses of its hands as a log, and how to run it. */
static void keep(const wild *k, const judge_run *run, char *text, const judge_result *r,
                 uint32_t kind) {
  char scene[PATH_ROOM];
  char log[PATH_ROOM];
  judge_result again;
  const double rate = (double)r->ticks / k->seconds;
  const double seconds = (r->tick[kind] + 2.0) / rate;
  const uint32_t gone = shrink_scene(text, run, kind, seconds, SHRINK_TRIES);
  snprintf(scene, sizeof scene, "out/wild/%llu_%llu.scene", (unsigned long long)run->seed,
           (unsigned long long)run->number);
  snprintf(log, sizeof log, "out/wild/%llu_%llu.log", (unsigned long long)run->seed,
           (unsigned long long)run->number);
  write_text(scene, text);
  judge_run recorded = *run;
  recorded.seconds = seconds;
  recorded.record = fopen(log, "w");
  if (recorded.record == NULL) {
    perror(log);
    exit(2);
  }
  judge_scene(text, &recorded, &again);
  fclose(recorded.record);
  printf("  shrunk by %u lines: fray run %s --log %s --energy out/wild/energy.csv\n", gone, scene,
         log);
}

static void run_one(wild *k, uint64_t number) {
  static char text[RANDOM_SCENE_ROOM];
  judge_result r;
  const judge_run run = {k->seed, number, k->seconds, 0, NULL};
  const random_kind cloth = random_scene_write(k->seed, number, text);
  judge_scene(text, &run, &r);
  if (r.refused[0] != 0) {
    ++k->refused;
    return;
  }
  ++k->judged;
  ++k->scenes[cloth];
  uint32_t first = JUDGE_KINDS;
  for (uint32_t kind = 0; kind < JUDGE_KINDS; ++kind) {
    if ((r.found & k->kinds & 1u << kind) == 0) continue;
    if (k->found[kind]++ == 0 && first == JUDGE_KINDS) first = kind;
    ++k->by_cloth[kind][cloth];
    if (r.size[kind] > k->worst[kind]) k->worst[kind] = r.size[kind];
    printf("scene %llu (%s) tick %u: %s, %.4g; allowed %.4g\n", (unsigned long long)number,
           random_kind_name[cloth], r.tick[kind], judge_name(kind), r.size[kind], r.allowed[kind]);
  }
  if (first != JUDGE_KINDS) keep(k, &run, text, &r, first);
  fflush(stdout);
}

static int report(const wild *k, double minutes) {
  uint32_t found = 0;
  printf("%u scenes of seed %llu (", k->judged, (unsigned long long)k->seed);
  for (uint32_t n = 0; n < RANDOM_KINDS; ++n)
    printf("%s%u %s", n != 0 ? ", " : "", k->scenes[n], random_kind_name[n]);
  printf("), %u refused by the compiler, %.3g scenes a minute\n", k->refused, k->judged / minutes);
  for (uint32_t kind = 0; kind < JUDGE_KINDS; ++kind) {
    if (k->found[kind] == 0) continue;
    ++found;
    printf("%5u  %-34s", k->found[kind], judge_name(kind));
    for (uint32_t n = 0; n < RANDOM_KINDS; ++n)
      printf(" %s %u", random_kind_name[n], k->by_cloth[kind][n]);
    printf("; worst %.4g\n", k->worst[kind]);
  }
  printf("%s\n", found == 0 ? "no finding" : "findings");
  return found != 0 || k->judged == 0;
}

static double minutes_now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec / 60 + (double)t.tv_nsec / 60e9;
}

/* The n-th argument, otherwise the default. */
static double number_at(int argc, char **argv, int n, const char *name, double most, double otherwise) {
  if (n >= argc) return otherwise;
  char *end;
  const double value = strtod(argv[n], &end);
  if (end != argv[n] && *end == 0 && value >= 0 && value <= most) return value;
  fprintf(stderr, "wild: %s \"%s\", expected a number from 0 to %.16g\n", name, argv[n], most);
  exit(2);
}

int main(int argc, char **argv) {
  static wild k;
  const int is_short = strcmp(argv[argc - 1], "short") == 0;
  argc -= is_short;
  if (argc < 3) {
    fprintf(stderr, "usage: wild SEED COUNT [SECONDS [FIRST]] [short]\n");
    return 2;
  }
  k.seed = (uint64_t)number_at(argc, argv, 1, "SEED", 0x1p53, 0);
  k.count = (uint32_t)number_at(argc, argv, 2, "COUNT", UINT32_MAX, 0);
  k.seconds = number_at(argc, argv, 3, "SECONDS", 3600, 2);
  const uint64_t first = (uint64_t)number_at(argc, argv, 4, "FIRST", 0x1p53, 0);
  k.kinds = is_short ? (1u << JUDGE_MOTION) - 1u : (1u << JUDGE_KINDS) - 1u;
  mkdir("out", 0777);
  mkdir("out/wild", 0777);
  const double begin = minutes_now();
  for (uint64_t n = 0; n < k.count; ++n) run_one(&k, first + n);
  return report(&k, minutes_now() - begin);
}
