/* SPDX-License-Identifier: Apache-2.0 */
/* The law of isotropic sheets, corotational: stress is linear in U - 1 of F = R U, so drawn cloth gets no
 * stiffer. With C = 1 + 2 G = U^2, exact in two dimensions by two roots:
 *
 *   J = root(det C),  t = root(tr C + 2 J)
 *   U - 1 = (C + J - t) / t             the strain that counts; its product with T is twice the energy
 *   T     = c (U - 1)                   force over length at rest: what tears go by
 *   S     = T U^-1,  U^-1 = (adj C + J) / (t J):  2 mu - (2 mu - lambda (t - 2)) U^-1
 *
 * U^-1 grows without bound where a triangle is pressed to a line, and turns over there. So a principal
 * stretch l below 1/2 counts as l^2 - 3/4, in place of l - 1: force and energy go on, and the force fades to
 * nothing with l. No slope is above 1.22 times that at rest, for a Poisson's ratio of at most 0.4; those
 * above have 11/10 of the steps (tools/scene_compiler/membrane_params.c).
 *
 *   U - 1, G, U^-1   Q28   stretches are below 3
 *   S, T             that of c, saturated */
#ifndef FRAY_STATE_COROTATIONAL_H
#define FRAY_STATE_COROTATIONAL_H

#include "rt/state/features.h"
#include "rt/state/material.h"

/* S of Green's strain g in the format of c, which is isotropic; U - 1 in *counted, its uv twice the shear.
 * Cost: two roots and 30 products; one root more where a stretch is below 1/2. */
material_tensor corotational_stress(const int32_t c[MATERIAL_ENTRIES], material_tensor g,
                                    material_tensor *counted);

/* T of it. */
material_tensor corotational_tension(const int32_t c[MATERIAL_ENTRIES], material_tensor g);

#endif
