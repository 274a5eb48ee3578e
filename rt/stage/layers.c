/* SPDX-License-Identifier: Apache-2.0 */
/* Triangles of a sheet do not pass through each other (Karaoz 2015, section 2.6; how a collision is answered is
 * as for yarns, see selves.c). Once a tick, behind all else: every vertex went straight from where the tick
 * began to where it is now. What touches nowhere on these ways has not passed, so:
 *
 *   find    vertices and triangles, and sides, that may come near each other (layers_near.c)
 *   push    those that come nearer than the thickness, a few rounds: positions, and the speed at which they
 *           approach, as an impulse that keeps momentum to the last bit (layers_pair.c)
 *   join    what touches on its way nevertheless goes on as one, by its mean, from where the tick began
 *
 * What was put farther than the search has allowed for is looked at again. So is what has to keep its place
 * beside a rigid mesh or ball, which are asked behind all this: who stands there does not move, and what is
 * joined with him moves with him. If that does not end the whole sheet moves as one, and FRAY_FAULT_SELVES says
 * so.
 *
 * What a tear makes two of begins in one place, where nothing says which side is whose. So until they are a
 * thickness apart the two count as the vertex that they were. */
#include "rt/stage/layers.h"

#include "rt/stage/stage.h"

void layers_begin(fray_world *w) {
  if (!world_has_layers(w)) return;
  layers_went(w);
  for (uint32_t p = 0; p < w->particles; ++p) {
    w->ways[p].begin = world_position(w, p);
    w->stands[p] = 0;
  }
}

void layers_join(fray_world *w, const layer_pair *pair) {
  for (uint32_t n = 1; n < 4; ++n) zones_join(w, pair->p[0], pair->p[n]);
}

static int is_joined(fray_world *w, const layer_pair *pair) {
  const uint32_t zone = zones_of(w, pair->p[0]);
  return zones_of(w, pair->p[1]) == zone && zones_of(w, pair->p[2]) == zone && zones_of(w, pair->p[3]) == zone;
}

static int push_pairs(fray_world *w) {
  int pushed = 1;
  int moved = 0;
  for (uint32_t round = 0; round < SELVES_ROUNDS && pushed; ++round) {
    pushed = 0;
    ++w->round;
    for (uint32_t n = 0; n < w->listed->met; ++n) pushed |= layers_push(w, &w->layers[w->layers_met[n]]);
    moved |= pushed;
  }
  return moved;
}

static int join_touching(fray_world *w) {
  int touch = 0;
  ++w->round;
  for (uint32_t n = 0; n < w->listed->met; ++n) {
    layer_pair *pair = &w->layers[w->layers_met[n]];
    if (is_joined(w, pair) || !layers_touch(w, pair)) continue;
    layers_join(w, pair);
    touch = 1;
  }
  return touch;
}

static void join_pairs(fray_world *w) {
  zones_move(w);
  for (uint32_t round = 0; round < SELVES_MERGES; ++round) {
    if (!join_touching(w)) return;
    zones_move(w);
  }
  for (uint32_t n = 0; n < w->listed->met; ++n) {
    layers_join(w, &w->layers[w->layers_met[n]]);
    zones_join(w, w->layers[w->layers_met[0]].p[0], w->layers[w->layers_met[n]].p[0]);
  }
  zones_move(w);
}

static int has_gone(const fray_world *w, uint32_t p) {
  const vec3 at = w->ways[p].end;
  return w->x[p] != at.x || w->y[p] != at.y || w->z[p] != at.z;
}

/* Bodies are asked whether ways that have changed lead through them; who keeps his place has no speed by it,
 * and gives none. Returns whether somebody does. */
static int stand_beside(fray_world *w) {
  int stand = 0;
  if (!world_has_meshes(w)) return 0;
  for (uint32_t p = 0; p < w->particles; ++p) w->ways[p].end = world_position(w, p);
  if (!meshes_look(w)) return 0;
  for (uint32_t p = (uint32_t)w->params->held; p < w->particles; ++p) {
    const vec3 was = w->ways[p].end;
    if (!has_gone(w, p)) continue;
    w->qx[p] = fx_wrap_add(w->qx[p], fx_wrap_sub(w->x[p], was.x));
    w->qy[p] = fx_wrap_add(w->qy[p], fx_wrap_sub(w->y[p], was.y));
    w->qz[p] = fx_wrap_add(w->qz[p], fx_wrap_sub(w->z[p], was.z));
    w->stands[p] = 1;
    stand = 1;
  }
  return stand;
}

/* The last resort: by the mean of all, then as one goes that cannot. */
static void join_all(fray_world *w) {
  zones_join_all(w);
  zones_slow(w);
  if (!stand_beside(w)) return;
  zones_move(w);
  if (stand_beside(w)) w->state->faults |= (int32_t)FRAY_FAULT_JAMMED;
}

void layers_run(fray_world *w) {
  int moved = 0;
  if (!world_has_layers(w)) return;
  for (uint32_t pass = 0; pass < SELVES_PASSES; ++pass) {
    zones_begin(w);
    if (!layers_find(w)) break;
    if (pass == 0) moved = push_pairs(w);
    join_pairs(w);
    zones_slow(w);
    moved |= w->joined != 0;
    if (!zones_stay(w)) continue;
    if (!moved || !stand_beside(w)) return;
  }
  join_all(w);
}
