/* SPDX-License-Identifier: Apache-2.0 */
#ifndef FRAY_TOOLS_SCENE_COMPILER_MEMBRANE_H
#define FRAY_TOOLS_SCENE_COMPILER_MEMBRANE_H

#include "tools/scene_compiler/draft.h"

/* Masses, elastic steps and gains, once the triangles are there. */
int draft_membrane_params(draft *d, fray_world *w);
/* Opens the scene's slits, once triangles and masses are there. */
int draft_membrane_slits(const draft *d, fray_world *w);

#endif
