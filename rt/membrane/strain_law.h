/* SPDX-License-Identifier: Apache-2.0 */
/* The law of membranes beyond the strain that elastic steps bear. c G grows
 * with the square of a stretch, so a triangle that is drawn far outruns any step. From the threshold g0 on, a
 * principal strain g, of the stretch l = root(1 + 2 g), counts as
 *
 *   f(g) = g0 + s0 x r,  x = l - s0,  r = 2 / (2 + x),  s0 = root(1 + 2 g0):  f' = s0 r^2 / l
 *
 * along its own direction. Stretched further, slope and force go on from what they are at g0, and fade. With
 * G~ = f(G) the energy is G~:c:G~ / 2 for any c, and stress its derivative: with T = c G~, in the principal
 * directions of G
 *
 *   S11 = f'(g1) T11,  S22 = f'(g2) T22,  S12 = T12 (f(g1) - f(g2)) / (g1 - g2)
 *
 * Below g0 nothing differs. g0 is where the slope (3 s0^2 - 1) / 2 of c G takes a triangle alone to
 * w^2 h^2 = 3.4. No slope is more than 1.16 times that, whatever c and however drawn: below 4. With f of a
 * constant slope it would be up to 1.6 times, as T22 has c12 f(g1) in it. Force has its maximum at x = 1 or
 * before: a body's pull above that draws cloth to the limit of its edges (edge_limit.c). Cloth under a
 * `load` has steps for a g0 beyond what that draws it to (tools/scene_compiler/membrane_params.c). */
#ifndef FRAY_MEMBRANE_STRAIN_LAW_H
#define FRAY_MEMBRANE_STRAIN_LAW_H

#include "rt/state/material.h"

enum { STRAIN_LAW_MAX = 3 * STRAIN_ONE /* of g0: below STRAIN_MAX */ };

/* g0, Q28, for a triangle whose w^2 h^2 at rest is slope / room, slope in Q20 and room in Q30. */
int32_t strain_law_threshold(uint32_t slope, uint32_t room, uint32_t steps);

/* Whether a principal strain may be above the threshold: a bound without a product. */
static inline int strain_law_may_apply(material_tensor g, int32_t threshold) {
  return fx_max(g.uu, g.vv) + (int32_t)(fx_magnitude(g.uv) >> 1) > threshold;
}

/* Stress in the format of c, and in *counted the strain G~ whose product with c G~ is twice the energy. */
material_tensor strain_law_stress(const int32_t c[MATERIAL_ENTRIES], material_tensor g, int32_t threshold,
                                  material_tensor *counted);

#endif
