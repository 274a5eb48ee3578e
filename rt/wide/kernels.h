/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels of one instruction set, after its lanes. */
#ifndef FRAY_WIDE_KERNELS_H
#define FRAY_WIDE_KERNELS_H

#include "rt/wide/blows.h"
#include "rt/wide/digest.h"
#include "rt/wide/folds.h"
#include "rt/wide/lift.h"
#include "rt/wide/over.h"
#include "rt/wide/project.h"
#include "rt/wide/pulls.h"
#include "rt/wide/push.h"
#include "rt/wide/slides.h"
#include "rt/wide/steps.h"
#include "rt/wide/stresses.h"
#include "rt/wide/weighs.h"

#ifdef LANES_RULE_NOTHING_OUT
#define near_any wide_maybe
#define near_any_above wide_maybe
#else
#define near_any reach_any
#define near_any_above reach_any_above
#endif

#ifndef LANES_LONGS
#define slides_run wide_none
#define pulls_run wide_none
#define folds_run wide_none
#define weighs_run wide_none
#define blows_run wide_none
#define stresses_run wide_none
#define inner_steps wide_none
#endif

#define WIDE_DEFINE(set, name, parameters, arguments, scalar, wide) \
  uint32_t wide_##name##_##set parameters { return wide arguments; }

#endif
