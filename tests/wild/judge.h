/* SPDX-License-Identifier: Apache-2.0 */
/* Runs a scene three times side by side and judges its motion (README.md). */
#ifndef FRAY_TESTS_WILD_JUDGE_H
#define FRAY_TESTS_WILD_JUDGE_H

#include <stdint.h>
#include <stdio.h>

#include "rt/fray.h"

/* What is found. Those before JUDGE_MOTION hold of every world today. */
typedef enum {
  JUDGE_KERNEL,  /* another kernel has another hash */
  JUDGE_WORKERS, /* so have workers, or a world that was saved and opened */
  JUDGE_OPENS,   /* what was saved, or compiled, is refused */
  JUDGE_CLOSES,  /* the ledger is open */
  JUDGE_MOTION,
  JUDGE_CLAMP = JUDGE_MOTION, /* the limit of speed, without a fault */
  JUDGE_SPEED,                /* faster than all that was supplied allows */
  JUDGE_THROUGH,              /* a particle is in a body that it was outside of, without a fault */
  JUDGE_MADE,                 /* + fray_energy_stage: more than its bound */
  JUDGE_KINDS = JUDGE_MADE + FRAY_ENERGY_STAGES
} judge_kind;

/* "speed", "made by contact". */
const char *judge_name(uint32_t kind);

typedef struct {
  uint64_t seed, number; /* of the poses of hands */
  double seconds;
  uint32_t wanted; /* bit a kind: ends as soon as one of these is found; 0: runs to its end */
  FILE *record;    /* a log of the bus, or NULL */
} judge_run;

typedef struct {
  uint32_t found;              /* bit a kind */
  uint32_t tick[JUDGE_KINDS];  /* the first */
  double size[JUDGE_KINDS];    /* the largest: m/s, J, cm */
  double allowed[JUDGE_KINDS]; /* beside it */
  uint32_t faults;
  uint64_t ticks;
  char refused[256]; /* by the scene compiler; else empty */
} judge_result;

void judge_scene(const char *text, const judge_run *run, judge_result *result);

#endif
