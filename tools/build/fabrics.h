/* SPDX-License-Identifier: Apache-2.0 */
/* What is known of cloths, as it was measured, and what a scene says of others. */
#ifndef FRAY_BUILD_FABRICS_H
#define FRAY_BUILD_FABRICS_H

#include "rt/model/fabric.h"
#include "rt/model/toughness.h"
#include "tools/build/exact.h"

/* Measured values as whole numbers, so that nothing is lost. */
typedef struct {
  const char *name, *sample, *made_of;
  int32_t density;                                /* mg/m2 */
  int64_t stretch[FABRIC_ROWS][FABRIC_ENTRIES];   /* uN/m: c11 c12 c22 c33; row 0 at rest, then 0, 22.5,
                                                     45, 67.5, 90 degrees */
  int64_t bend[FABRIC_BENDS][FABRIC_CURVES];      /* 1e-12 N m: 0, 45, 90 degrees; 0 to 20 / m */
} fabric_facts;

enum { FABRICS_MEASURED = 4 };
extern const fabric_facts fabrics_measured[FABRICS_MEASURED];

/* Mean of an entry over the six rows, negative ones counted as zero, cut after six decimals: the
 * figures of Karaoz 2015, Table 4.14. uN/m. */
int64_t fabrics_mean(const fabric_facts *facts, uint32_t entry);

/* As a scene takes it: N/m, N m, g/cm2. */
typedef struct {
  exact density;
  exact stretch[FABRIC_ROWS][FABRIC_ENTRIES];
  exact bend[FABRIC_BENDS][FABRIC_CURVES];
  exact strength[TOUGHNESS_DIRECTIONS]; /* 0: it never tears */
  exact relax;                          /* s */
  int is_cut;                           /* by blades ... */
  exact cut;                            /* ... that come as fast, cm/s */
} fabric_draft;

void fabrics_never_tear(fabric_draft *f);
/* denim, t-shirt, pants, swimsuit, paper: they never tear. Returns 0 iff there is no such cloth. */
int fabrics_find(const char *name, fabric_draft *f);
/* E and nu to c by (2.11): N/m. The same in all rows. */
void fabrics_isotropic(exact e, exact nu, fabric_draft *f);
/* The same row for all directions and strains. */
void fabrics_same(const exact row[FABRIC_ENTRIES], fabric_draft *f);
void fabrics_bend(exact stiffness, fabric_draft *f);

/* Negative entries count as zero; c33, and c11 and c22 of a row, are at least FABRIC_FLOOR of the row's
 * largest entry: a cloth without any would not hold together. Returns NULL, or what is wrong: a row with
 * c12^2 > c11 c22 would push itself apart. */
enum { FABRIC_FLOOR = 64 /* one part in */ };
const char *fabrics_mend(fabric_draft *f);

#endif
