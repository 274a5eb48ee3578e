/* SPDX-License-Identifier: Apache-2.0 */
/* What the scalar projection of links (stage/strain.c, which says what it computes) and the wide
 * ones share. */
#ifndef FRAY_WIDE_LINK_H
#define FRAY_WIDE_LINK_H

#include "rt/model/rows.h"

enum {
  LINK_HI_MAX = 16383,
  LINK_THIRD = 2731, /* 2/3 in Q12: of half a correction, where one end has half the mass */
  LINK_U_LEAST = -458752, /* -7/16 in Q20 */
  LINK_PSI_0 = 16384,     /* 1/4 in Q16 */
  LINK_PSI_1 = -12648,    /* -0.193 */
  LINK_PSI_2 = 9961,      /* 0.152 */
  /* the constants of both Horner steps, before their shifts */
  LINK_HORNER_1 = LINK_PSI_1 * 32768 + (1 << 14),
  LINK_HORNER_0 = LINK_PSI_0 * 32768 + (1 << 14)
};

/* The constants of the wide projection, in memory, where lanes take them in one go: compilers would
 * make each anew for every few rows. */
typedef struct {
  int32_t way_half, hi_most, hi_least, e_half, u_half, u_least, psi_2, horner_1, horner_0, f_half,
      step_half;
} link_words;
extern const link_words wide_link_words;

typedef struct {
  int32_t *restrict x, *restrict y, *restrict z;
  const row_id *i, *j;
  const uint8_t *kind;
  const link_class *classes;
} link_view;

#endif
