/* SPDX-License-Identifier: Apache-2.0 */
/* What a membrane's stiffness was scaled to, in words: what its elastic steps bear. */
#ifndef FRAY_TOOLS_ANALYSIS_SCALED_STIFFNESS_H
#define FRAY_TOOLS_ANALYSIS_SCALED_STIFFNESS_H

#include "rt/fray.h"

enum { SCALED_STIFFNESS_TEXT = 160 };

/* Returns 0 iff the stiffness is that of the material. */
int scaled_stiffness_text(const fray_info *f, char text[SCALED_STIFFNESS_TEXT]);

#endif
