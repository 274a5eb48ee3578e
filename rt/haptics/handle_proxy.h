/* SPDX-License-Identifier: Apache-2.0 */
/* Proxies of handles: an affine function of the device, and the force of the coupling in its axes.
 */
#ifndef FRAY_HAPTICS_HANDLE_PROXY_H
#define FRAY_HAPTICS_HANDLE_PROXY_H

#include "rt/state/world.h"

#if FRAY_HANDLES
/* At START: the pose of this moment means "where the proxy is", or where the scene places the
 * device. */
void handle_proxies_start(fray_world *w);
/* The ways of the proxies in this tick. */
void handle_proxies_move(fray_world *w);
/* Of the tick's impulses: haptic.force_unlimited of hands with a handle, 0.5 mN a step in the
 * device's axes. */
void handle_forces_find(fray_world *w);
#else
static inline void handle_proxies_start(fray_world *w) { (void)w; }
static inline void handle_proxies_move(fray_world *w) { (void)w; }
static inline void handle_forces_find(fray_world *w) { (void)w; }
#endif

#endif
