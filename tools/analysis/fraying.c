/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/analysis/fraying.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "rt/state/crossing.h"

typedef struct {
  const fray_world *w;
  fray_weave weave;
  uint8_t *broken;  /* by canonical id of the spring: broken */
  uint8_t *counted; /* by crossing: bits of the axes along which it was counted */
  double rest_cm[2];
} search;

static uint32_t springs_along_wefts(const search *s) { return s->weave.wefts * (s->weave.warps - 1); }

/* The spring from a crossing to the next one along an axis. */
static uint32_t spring_after(const search *s, uint32_t i, uint32_t j, fray_axis axis) {
  return axis == FRAY_WEFT ? j * (s->weave.warps - 1) + i
                           : springs_along_wefts(s) + j * s->weave.warps + i;
}

static void read_springs(search *s, const fray_info *f) {
  double sum[2] = {0, 0};
  uint32_t count[2] = {0, 0};
  for (uint32_t row = 0; row < f->springs[FRAY_STRUCTURAL]; ++row) {
    const fray_spring r = fray_view_spring(s->w, FRAY_STRUCTURAL, row);
    const int axis = r.id < springs_along_wefts(s) ? FRAY_WEFT : FRAY_WARP;
    s->broken[r.id] = !r.alive;
    if (!r.alive) continue;
    sum[axis] += r.rest;
    ++count[axis];
  }
  for (int axis = 0; axis < 2; ++axis)
    s->rest_cm[axis] = count[axis] == 0 ? 0 : sum[axis] / count[axis] * f->lu_um * 0x1p-24 * 1e-4;
}

/* Where the yarns of a crossing touch, on the yarn along an axis: spacings from the crossing, on along it. */
static double slid_by(const search *s, uint32_t c, fray_axis axis) {
  if (!world_has_yarns(s->w) || crossing_state_at(s->w, c) == FRAY_WHOLE) return 0;
  const uint32_t home = yarn_place_of(axis == FRAY_WARP ? c / s->weave.warps : c % s->weave.warps);
  return ((double)s->w->woven.contacts[crossing_contact(s->w, c)].place[axis] - home) / YARN_PLACE_ONE;
}

/* Walks from a torn end away from the break, over disconnected crossings, to the first that holds; returns the
 * spacings between. */
static double walk(search *s, uint32_t i, uint32_t j, fray_axis axis, int on) {
  double loose = 0;
  for (;;) {
    const uint32_t c = j * s->weave.warps + i;
    if ((s->counted[c] >> axis & 1) != 0) return loose;
    if (fray_crossing_state_at(s->w, c) != FRAY_DISCONNECTED) {
      const double slid = slid_by(s, c, axis);
      return fmax(loose + (on ? slid : -slid), 0);
    }
    s->counted[c] = (uint8_t)(s->counted[c] | 1 << axis);
    ++loose;
    uint32_t *const at = axis == FRAY_WEFT ? &i : &j;
    const uint32_t last = (axis == FRAY_WEFT ? s->weave.warps : s->weave.wefts) - 1;
    if (on ? *at == last : *at == 0) return loose;
    if (!on) --*at;
    if (s->broken[spring_after(s, i, j, axis)] != 0) return loose;
    if (on) ++*at;
  }
}

static void add_end(search *s, fraying *out, double loose, fray_axis axis) {
  out->ends += loose >= 1;
  out->loose_cm += loose * s->rest_cm[axis];
}

static void find_ends(search *s, fraying *out) {
  for (uint32_t axis = FRAY_WEFT; axis <= FRAY_WARP; ++axis)
    for (uint32_t j = 0; j + axis < s->weave.wefts; ++j)
      for (uint32_t i = 0; i + 1 - axis < s->weave.warps; ++i) {
        if (s->broken[spring_after(s, i, j, (fray_axis)axis)] == 0) continue;
        ++out->cuts;
        out->tear_cm += s->rest_cm[1 - axis];
        add_end(s, out, walk(s, i, j, (fray_axis)axis, 0), (fray_axis)axis);
        add_end(s, out, walk(s, i + 1 - axis, j + axis, (fray_axis)axis, 1), (fray_axis)axis);
      }
}

int fraying_measure(const fray_world *w, fraying *out) {
  const fray_info f = fray_get_info(w);
  search s = {w, fray_view_weave(w), NULL, NULL, {0, 0}};
  const uint32_t crossings = s.weave.warps * s.weave.wefts;
  memset(out, 0, sizeof *out);
  s.broken = calloc(f.springs[FRAY_STRUCTURAL], 1);
  s.counted = calloc(crossings, 1);
  const int found = s.broken != NULL && s.counted != NULL;
  if (found) {
    read_springs(&s, &f);
    find_ends(&s, out);
    for (uint32_t c = 0; c < crossings; ++c) {
      const fray_crossing_state now = fray_crossing_state_at(w, c);
      out->split += now != FRAY_WHOLE;
      out->connected += now == FRAY_CONNECTED;
      out->loose += now == FRAY_LOOSE;
      out->disconnected += now == FRAY_DISCONNECTED;
    }
    out->zone_cm = out->tear_cm > 0 ? out->split * s.rest_cm[0] * s.rest_cm[1] / out->tear_cm : 0;
    out->fray = out->tear_cm > 0 ? out->loose_cm / out->tear_cm : 0;
  }
  free(s.broken);
  free(s.counted);
  return found;
}
