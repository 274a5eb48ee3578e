/* SPDX-License-Identifier: Apache-2.0 */
#ifndef FRAY_BUILD_TRIANGLES_H
#define FRAY_BUILD_TRIANGLES_H

#include "tools/build/draft.h"

/* Cloth, steps and gains of a world whose triangles stand. */
int draft_cloths(draft *d, fray_world *w);
/* Opens the scene's slits in a world whose triangles and masses stand. */
int draft_sheet_slits(const draft *d, fray_world *w);

#endif
