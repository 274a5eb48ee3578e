/* SPDX-License-Identifier: Apache-2.0 */
/* watched_tick(): fray_tick() with a look at the world in every substep, before bodies move and after contacts
 * with rigid meshes are solved, and where a tick is done again: the files of the tick, compiled a second time. The
 * test defines watch_begin(), watch_end() and watch_again(). Worlds with rigid meshes only. */
#ifndef FRAY_TESTS_LIB_WATCHED_TICK_H
#define FRAY_TESTS_LIB_WATCHED_TICK_H

#include "rt/contact/contact.h"
#include "rt/haptics/haptics.h"
#include "rt/integrate/integrate.h"
#include "rt/membrane/membrane.h"
#include "rt/self_collision/self_collision.h"
#include "rt/tick/rollback.h"
#include "rt/tick/tick.h"
#include "rt/woven/woven.h"

static void watch_begin(fray_world *w);
static void watch_end(const fray_world *w);
static void watch_again(void);
void watched_tick(fray_world *w, const fray_input *input, fray_output *output);

#define bodies_advance(w, substep) (watch_begin(w), bodies_advance(w, substep))
#define contact_vertices_solve(w) (contact_vertices_solve(w), watch_end(w))
#define rollback_restore(w) (rollback_restore(w), watch_again())
#define fray_tick watched_tick
#define tick_start watched_tick_start
#define tick_woven watched_tick_woven
#define tick_membrane watched_tick_membrane
void tick_start(fray_world *w, fray_output *output);
void tick_woven(fray_world *w);
void tick_membrane(fray_world *w);
#include "rt/tick/tick.c"
#include "rt/tick/tick_membrane.c"
#include "rt/tick/tick_woven.c"
#undef bodies_advance
#undef contact_vertices_solve
#undef rollback_restore
#undef fray_tick
#undef tick_start
#undef tick_woven
#undef tick_membrane

#endif
