/* SPDX-License-Identifier: Apache-2.0 */
/* What the substeps of a membrane change, kept and brought back for another attempt at a tick. */
#ifndef FRAY_TICK_ROLLBACK_H
#define FRAY_TICK_ROLLBACK_H

#include "rt/state/world.h"

/* Behind triangle_collision_begin(), before the first substep. */
void rollback_save(fray_world *w);
/* Back to that, but for counted work, and for a fault that says which zones were joined for lack of
 * room. */
void rollback_restore(fray_world *w);

#endif
