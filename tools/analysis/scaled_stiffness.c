/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/analysis/scaled_stiffness.h"

#include <stdio.h>

int scaled_stiffness_text(const fray_info *f, char text[SCALED_STIFFNESS_TEXT]) {
  if (f->triangles_max == 0 || f->stiffness_q30 == 1 << 30) return 0;
  snprintf(text, SCALED_STIFFNESS_TEXT,
           "scaled to %.4g of the material's, for the steps that 'elastic_steps_max' allows; %s",
           f->stiffness_q30 / 1073741824.0,
           f->corotational ? "so is its strength" : "tears follow the scaled stress");
  return 1;
}
