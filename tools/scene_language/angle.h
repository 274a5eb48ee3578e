/* SPDX-License-Identifier: Apache-2.0 */
#ifndef FRAY_TOOLS_SCENE_LANGUAGE_ANGLE_H
#define FRAY_TOOLS_SCENE_LANGUAGE_ANGLE_H

#include "tools/scene_language/exact.h"

enum { ANGLE_STEPS = 4096 };

/* The multiple of 1 / ANGLE_STEPS that is nearest to the tangent of half the angle, for |angle|
 * up to 170 degrees. Invalid iff the angle in Q60 turns cannot be held. */
exact angle_half_tangent(exact degrees);

#endif
