/* SPDX-License-Identifier: Apache-2.0 */
/* Other ways to hold a sheet's links than rt/stage/strain.c: an experiment. A program with
 * methods.c runs these in the place of the runtime's stage, also where the scene compiler settles
 * a sheet. */
#ifndef FRAY_TESTS_FEWER_METHODS_H
#define FRAY_TESTS_FEWER_METHODS_H

#include "rt/model/world.h"

typedef enum {
  OUTWARDS = 0,
  TURN_ABOUT = 1, /* outwards in even substeps, inwards in odd ones */
  THERE_AND_BACK = 2 /* both in each substep */
} sweep_order;

enum { METHOD_STRIDES = 4 };

typedef struct {
  const char *name;
  uint32_t strides[METHOD_STRIDES]; /* one-sided rows along yarns, longest first; 0 ends */
  uint32_t inwards;    /* 1: these rows go from far ones to held ones */
  uint32_t tether;     /* one-sided rows to the held crossing on the same yarn, every so many */
  sweep_order order;
  double factor;       /* share of a correction; 0: the runtime's own code */
  uint32_t chains;     /* 1: warps, then wefts, each solved at once */
  uint32_t chain_cost; /* a link of a chain, in projections */
  int32_t quiet;       /* batches that moved nothing by more steps in substep 0 wait; 0: none */
} method;

void method_use(const method *m); /* for worlds that run from now on */
void method_end(void);

#endif
