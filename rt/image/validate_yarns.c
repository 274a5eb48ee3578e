/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts of yarns: each stands on its yarns, in the order of their crossings. */
#include "rt/image/image.h"
#include "rt/state/crossing.h"

static int contact_is_empty(const yarn_contact *c) {
  return (c->place[0] | c->place[1] | c->grip) == 0 && (c->offset[0] | c->offset[1] | c->offset[2]) == 0;
}

/* Crossing k of the yarn of an axis through `crossing`. */
static uint32_t crossing_on(const fray_world *w, uint32_t crossing, uint32_t axis, uint32_t k) {
  const uint32_t warps = (uint32_t)w->params->warps;
  return axis == (uint32_t)FRAY_WARP ? crossing % warps + k * warps : crossing / warps * warps + k;
}

static uint32_t last_on(const fray_world *w, uint32_t axis) {
  return (uint32_t)(axis == (uint32_t)FRAY_WARP ? w->params->wefts : w->params->warps) - 1u;
}

/* direction: see yarn_grid_step(). */
static int has_link(const fray_world *w, uint32_t crossing, uint32_t direction) {
  uint32_t next;
  uint32_t link;
  return yarn_grid_step(world_yarn_grid(w), crossing, direction, &next, &link) &&
         w->woven.spring_kind[w->woven.spring_of[link]] != SPRING_DEAD;
}

/* The place is on a link that is not broken, or near the end of one. */
static int place_is_held(const fray_world *w, uint32_t crossing, uint32_t axis, uint32_t place) {
  const uint32_t k = place >> YARN_PLACE_BITS;
  const int32_t past = yarn_place_past(place);
  if (k > last_on(w, axis)) return 0;
  const uint32_t c = crossing_on(w, crossing, axis, k);
  const int back = has_link(w, c, 2u * axis);
  const int on = has_link(w, c, 2u * axis + 1u);
  return (back || on) && (past <= YARN_PLACE_BEYOND || on) && (past >= -YARN_PLACE_BEYOND || back);
}

static int contact_good(const fray_world *w, uint32_t n) {
  const yarn_contact *c = &w->woven.contacts[n];
  const uint32_t warps = (uint32_t)w->params->warps;
  if (n >= (uint32_t)w->woven.yarn_counts->split) return contact_is_empty(c);
  const uint32_t crossing = w->woven.crossing_of[(uint32_t)w->params->particles + n];
  const uint32_t home[2] = {crossing % warps, crossing / warps};
  if (crossing_state_at(w, crossing) == FRAY_DISCONNECTED) return contact_is_empty(c);
  if (yarn_contact_pressed(c) > YARN_PRESSED_MAX) return 0;
  for (uint32_t axis = 0; axis < 3; ++axis)
    if (c->offset[axis] < -YARN_OFFSET_MAX || c->offset[axis] > YARN_OFFSET_MAX) return 0;
  for (uint32_t axis = 0; axis < 2; ++axis) {
    const int left = (w->woven.crossing_state[crossing] & CROSSING_LEFT) != 0;
    if (left ? c->place[axis] >> YARN_PLACE_BITS > last_on(w, axis)
             : !place_is_held(w, crossing, axis, c->place[axis]))
      return 0;
    if (crossing_state_at(w, crossing) == FRAY_CONNECTED && c->place[axis] != yarn_place_of(home[axis]))
      return 0;
  }
  return 1;
}

/* Places rise along a yarn from crossing to crossing. */
static int yarn_is_in_order(const fray_world *w, uint32_t axis, uint32_t first) {
  uint32_t before = 0;
  for (uint32_t k = 0; k <= last_on(w, axis); ++k) {
    const uint32_t c = crossing_on(w, first, axis, k);
    const fray_crossing_state now = crossing_state_at(w, c);
    if (now == FRAY_DISCONNECTED) continue;
    const uint32_t place =
        now == FRAY_WHOLE ? yarn_place_of(k) : w->woven.contacts[crossing_contact(w, c)].place[axis];
    if (place < before) return 0;
    before = place;
  }
  return 1;
}

int yarn_contacts_validate(const fray_world *w, fray_error *error) {
  const uint32_t warps = (uint32_t)w->params->warps;
  for (uint32_t n = 0; n < w->capacity[POOL_YARN_CONTACTS]; ++n)
    if (!contact_good(w, n))
      return image_bad(error, IMAGE_YARN_CONTACTS, n,
                       "a contact on both of its yarns, 0 where there is none");
  for (uint32_t i = 0; i < warps; ++i)
    if (!yarn_is_in_order(w, FRAY_WARP, i))
      return image_bad(error, IMAGE_YARN_CONTACTS, i, "contacts in order along a warp");
  for (uint32_t j = 0; j < (uint32_t)w->params->wefts; ++j)
    if (!yarn_is_in_order(w, FRAY_WEFT, j * warps))
      return image_bad(error, IMAGE_YARN_CONTACTS, j, "contacts in order along a weft");
  return 1;
}
