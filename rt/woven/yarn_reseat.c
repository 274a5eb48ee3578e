/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts of yarns when the weave changes. So that nothing jolts, the force of a contact stays: what its gap
 * would jump by becomes its offset, which fades (yarn_grip.c). A new contact has no gap. Where a link breaks
 * under a contact, it stays with the piece that is nearer; and leaves iff no link is left there. */
#include "rt/woven/woven.h"
#include "rt/woven/yarn_slip.h"

static vec3 added_offset(const yarn_contact *c, vec3 jump) {
  return vec_clamp(vec_add(vec_of(c->offset), jump), YARN_OFFSET_MAX);
}

void yarn_slip_begin(fray_world *w, uint32_t n) {
  const uint32_t c = yarn_contact_crossing(w, n);
  yarn_contact *k = &w->woven.contacts[n];
  yarn_touch touch;
  vec_store(w->woven.contact_steps[n].impulse, vec_make(0, 0, 0));
  w->woven.contact_steps[n].number[FRAY_WEFT] = (index_t)(c / (uint32_t)w->params->warps);
  w->woven.contact_steps[n].number[FRAY_WARP] = (index_t)(c % (uint32_t)w->params->warps);
  if (yarn_touch_at(w, n, &touch)) vec_store(k->offset, added_offset(k, touch.gap));
}

void yarn_slip_before_breaks(fray_world *w) {
  FRAY_ASSERT(world_has_yarns(w));
  if (w->woven.tear_count == 0) return;
  for (uint32_t n = 0; n < (uint32_t)w->woven.yarn_counts->split; ++n) {
    yarn_touch touch;
    if (yarn_contact_acts(w, n) && yarn_touch_at(w, n, &touch))
      vec_store(w->woven.contact_steps[n].quiet, touch.gap);
  }
}

/* The place that is nearest to it on what is left of the link that it was on. */
static uint32_t place_beside_break(const fray_world *w, const yarn_line *line, uint32_t place) {
  const uint32_t k = place >> YARN_PLACE_BITS;
  const int32_t past = yarn_place_past(place);
  const int on = k < line->last && yarn_line_holds(w, line, k);
  const int back = k > 0 && yarn_line_holds(w, line, k - 1u);
  if (past > YARN_PLACE_BEYOND && !on) return yarn_place_of(k) + (uint32_t)YARN_PLACE_BEYOND;
  if (past < -YARN_PLACE_BEYOND && !back) return yarn_place_of(k) - (uint32_t)YARN_PLACE_BEYOND;
  return place;
}

static void reseat(fray_world *w, uint32_t n) {
  yarn_contact *c = &w->woven.contacts[n];
  const yarn_contact_step *t = &w->woven.contact_steps[n];
  yarn_touch touch;
  for (uint32_t axis = 0; axis < 2; ++axis) {
    const yarn_line line = yarn_line_of(w, axis, t->number[axis]);
    c->place[axis] = place_beside_break(w, &line, c->place[axis]);
  }
  if (!yarn_touch_at(w, n, &touch))
    crossing_set_left(w, yarn_contact_crossing(w, n));
  else
    vec_store(c->offset, added_offset(c, vec_sub(touch.gap, vec_of(t->quiet))));
}

void yarn_slip_after_breaks(fray_world *w) {
  FRAY_ASSERT(world_has_yarns(w));
  if (w->woven.tear_count == 0) return;
  for (uint32_t n = 0; n < (uint32_t)w->woven.yarn_counts->split; ++n)
    if (yarn_contact_acts(w, n)) reseat(w, n);
}
