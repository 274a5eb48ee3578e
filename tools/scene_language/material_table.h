/* SPDX-License-Identifier: Apache-2.0 */
/* Materials of membranes: measured ones, and those of a scene. */
#ifndef FRAY_TOOLS_SCENE_LANGUAGE_MATERIAL_TABLE_H
#define FRAY_TOOLS_SCENE_LANGUAGE_MATERIAL_TABLE_H

#include "rt/state/material.h"
#include "rt/state/tear_strength.h"
#include "tools/scene_language/exact.h"

/* Measured values, exact as whole numbers. */
typedef struct {
  const char *name, *sample, *made_of;
  int32_t density;                                /* mg/m2 */
  int64_t stretch[MATERIAL_ROWS][MATERIAL_ENTRIES];   /* uN/m: c11 c12 c22 c33; row 0 at rest, then 0, 22.5,
                                                     45, 67.5, 90 degrees */
  int64_t bend[MATERIAL_BENDS][MATERIAL_CURVES];      /* 1e-12 N m: 0, 45, 90 degrees; 0 to 20 / m */
} material_sample;

enum { MATERIAL_SAMPLES = 4 };
extern const material_sample material_samples[MATERIAL_SAMPLES];

/* Mean of an entry over the six rows, negative ones counted as zero, cut after six decimals: the
 * figures of Karaoz 2015, Table 4.14. uN/m. */
int64_t material_table_mean(const material_sample *facts, uint32_t entry);

/* In N/m, N m, g/cm2. */
typedef struct {
  exact density;
  exact stretch[MATERIAL_ROWS][MATERIAL_ENTRIES];
  exact bend[MATERIAL_BENDS][MATERIAL_CURVES];
  exact strength[TEAR_STRENGTH_DIRECTIONS]; /* 0: never tears */
  exact tear_interval;                  /* s */
  int has_cut_speed;                    /* blades cut it ... */
  exact cut_speed;                      /* ... at this speed or faster, cm/s */
  int corotational;                     /* isotropic, by state/corotational.h: */
  exact young, poisson, thickness;      /* N/m2, ratio, cm; stretch follows from them */
  exact breaks;                         /* N/m2; 0: never */
  exact average;                        /* cm; 0: the least there is */
  int many_cracks;
} material_spec;

void material_table_never_tear(material_spec *f);
/* denim, t-shirt, pants, swimsuit, paper: they never tear. Returns 0 iff there is no such material. */
int material_table_find(const char *name, material_spec *f);
/* E and nu to c by (2.11): N/m. The same in all rows. */
void material_table_isotropic(exact e, exact nu, material_spec *f);
/* The same row for all directions and strains. */
void material_table_uniform(const exact row[MATERIAL_ENTRIES], material_spec *f);
void material_table_bend(exact stiffness, material_spec *f);

/* Sets negative entries to zero, and raises c11, c22 and c33 to 1/MATERIAL_TABLE_FLOOR of their row's largest
 * entry, for cloth without any would not hold together. Returns NULL, or the fault: a row with
 * c12^2 > c11 c22 is not positive definite. */
enum { MATERIAL_TABLE_FLOOR = 64 /* 1 / it */ };
const char *material_table_sanitize(material_spec *f);

#endif
