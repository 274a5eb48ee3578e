/* SPDX-License-Identifier: Apache-2.0 */
/* What moves as one in a tick, where a sheet meets itself (after the zones of Bridson et al. 2002, without
 * turning): particles on their straight ways of the tick, and groups of them that go by their mean, from where
 * the tick began. Used by selves.c for yarns and by layers.c for triangles. */
#ifndef FRAY_STAGE_ZONES_H
#define FRAY_STAGE_ZONES_H

#include "rt/model/world.h"

/* Everyone for himself; ways end where particles are now. */
void zones_begin(fray_world *w);
uint32_t zones_of(fray_world *w, uint32_t particle);
void zones_join(fray_world *w, uint32_t p, uint32_t q);
/* All of a zone by its mean, or as the body moves that holds some of it, or beside which some of it stands.
 * Positions alone: nobody gets a speed by it. Cost: linear in the particles. */
void zones_move(fray_world *w);
/* 1 iff nobody is farther from where his way ended than the slack, along an axis. */
int zones_stay(const fray_world *w);
/* The whole sheet; said as a fault. */
void zones_join_all(fray_world *w);

#endif
