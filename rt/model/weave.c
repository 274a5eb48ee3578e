/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/model/weave.h"

weave_link weave_link_at(weave w, uint32_t canonical) {
  const uint32_t across = w.wefts * (w.warps - 1u);
  weave_link link;
  if (canonical < across) {
    link.i = canonical % (w.warps - 1u);
    link.j = canonical / (w.warps - 1u);
    link.along_warp = 0;
  } else {
    link.i = (canonical - across) % w.warps;
    link.j = (canonical - across) / w.warps;
    link.along_warp = 1;
  }
  return link;
}

uint32_t weave_mirror(weave w, uint32_t canonical) {
  const weave_link l = weave_link_at(w, canonical);
  uint32_t mirrored;
  if (l.along_warp != 0)
    mirrored = canonical - l.i + (w.warps - 1u - l.i);
  else
    mirrored = canonical - l.i + (w.warps - 2u - l.i);
  return mirrored < canonical ? mirrored : canonical;
}

static uint32_t bend_number(weave w, uint32_t i, uint32_t j, uint32_t along_warp) {
  const uint32_t first = weave_links(w);
  return along_warp != 0 ? first + w.wefts * (w.warps - 2u) + j * w.warps + i
                         : first + j * (w.warps - 2u) + i;
}
/* Cell (i, j) has corners (i,j) .. (i+1,j+1); diagonal 0 rises with i, diagonal 1 falls. */
static uint32_t shear_number(weave w, uint32_t i, uint32_t j, uint32_t diagonal) {
  return weave_links(w) + weave_bends(w) + 2u * (j * (w.warps - 1u) + i) + diagonal;
}

void weave_ends(weave w, uint32_t canonical, uint32_t *a, uint32_t *b) {
  const uint32_t links = weave_links(w);
  const uint32_t bends = weave_bends(w);
  if (canonical < links) {
    const weave_link l = weave_link_at(w, canonical);
    *a = l.j * w.warps + l.i;
    *b = *a + (l.along_warp != 0 ? w.warps : 1u);
  } else if (canonical < links + bends) {
    const uint32_t n = canonical - links;
    const uint32_t across = w.wefts * (w.warps - 2u);
    if (n < across) {
      *a = n / (w.warps - 2u) * w.warps + n % (w.warps - 2u);
      *b = *a + 2u;
    } else {
      *a = n - across;
      *b = *a + 2u * w.warps;
    }
  } else {
    const uint32_t n = canonical < weave_rows(w) ? canonical - links - bends
                                                 : canonical - weave_rows(w);
    const uint32_t cell = n / 2u;
    const uint32_t corner = cell / (w.warps - 1u) * w.warps + cell % (w.warps - 1u);
    *a = n % 2u == 0 ? corner : corner + 1u;
    *b = n % 2u == 0 ? corner + w.warps + 1u : corner + w.warps;
  }
}

uint32_t weave_released(weave w, uint32_t canonical, uint32_t released[WEAVE_RELEASED]) {
  const weave_link l = weave_link_at(w, canonical);
  const uint32_t along = l.along_warp != 0 ? l.j : l.i;
  const uint32_t crossings = l.along_warp != 0 ? w.wefts : w.warps;
  uint32_t count = 0;
  if (along >= 1u) /* (before, a, b) */
    released[count++] = l.along_warp != 0 ? bend_number(w, l.i, l.j - 1u, 1)
                                          : bend_number(w, l.i - 1u, l.j, 0);
  if (along + 2u < crossings) /* (a, b, after) */
    released[count++] = bend_number(w, l.i, l.j, l.along_warp);
  for (uint32_t side = 0; side < 2u; ++side) {
    /* the cells with the link as one edge: at (i, j) and one before it across the yarn */
    const uint32_t across = l.along_warp != 0 ? l.i : l.j;
    if (across < side) continue;
    const uint32_t i = l.along_warp != 0 ? l.i - side : l.i;
    const uint32_t j = l.along_warp != 0 ? l.j : l.j - side;
    if (i < w.warps - 1u && j < w.wefts - 1u) {
      released[count++] = shear_number(w, i, j, 0);
      released[count++] = shear_number(w, i, j, 1);
    }
  }
  return count;
}

int weave_step(weave w, uint32_t crossing, uint32_t way, uint32_t *next, uint32_t *link) {
  const uint32_t i = crossing % w.warps;
  const uint32_t j = crossing / w.warps;
  const uint32_t at = way < 2u ? i : j;
  const uint32_t ends = way < 2u ? w.warps : w.wefts;
  const uint32_t step = way < 2u ? 1u : w.warps;
  const int on = (way & 1u) != 0;
  if (on ? at + 1u == ends : at == 0) return 0;
  const uint32_t first = on ? crossing : crossing - step;
  *next = on ? crossing + step : first;
  *link = way < 2u ? first / w.warps * (w.warps - 1u) + first % w.warps
                   : w.wefts * (w.warps - 1u) + first;
  return 1;
}

static void add_bends(weave w, uint32_t i, uint32_t j, uint32_t along_warp, weave_star *s) {
  const uint32_t at = along_warp != 0 ? j : i;
  const uint32_t ends = along_warp != 0 ? w.wefts : w.warps;
  if (at >= 2u)
    s->row[s->count++] = along_warp != 0 ? bend_number(w, i, j - 2u, 1) : bend_number(w, i - 2u, j, 0);
  if (at + 2u < ends) s->row[s->count++] = bend_number(w, i, j, along_warp);
}

void weave_rows_at(weave w, uint32_t crossing, weave_star *s) {
  const uint32_t i = crossing % w.warps;
  const uint32_t j = crossing / w.warps;
  s->along_weft = s->along_warp = s->count = 0;
  uint32_t next;
  for (uint32_t axis = 0; axis < 2u; ++axis) {
    for (uint32_t way = 2u * axis; way < 2u * axis + 2u; ++way)
      if (weave_step(w, crossing, way, &next, &s->row[s->count])) ++s->count;
    add_bends(w, i, j, axis, s);
    if (axis == 0)
      s->along_weft = s->count;
    else
      s->along_warp = s->count;
  }
  for (uint32_t cell = 0; cell < 4u; ++cell) {
    const uint32_t left = cell & 1u;
    const uint32_t above = cell >> 1;
    if (i < left || j < above || i - left >= w.warps - 1u || j - above >= w.wefts - 1u) continue;
    s->row[s->count++] = shear_number(w, i - left, j - above, left ^ above);
  }
}

weave_cross weave_cross_at(weave w, uint32_t crossing) {
  const uint32_t j = crossing / w.warps;
  const uint32_t i = crossing - j * w.warps;
  const uint32_t along_weft = crossing - j; /* of the link that begins here */
  const uint32_t along_warp = w.wefts * (w.warps - 1u) + crossing;
  const weave_cross c = {{i > 0 ? crossing - 1u : crossing, i + 1u < w.warps ? crossing + 1u : crossing,
                          j > 0 ? crossing - w.warps : crossing,
                          j + 1u < w.wefts ? crossing + w.warps : crossing},
                         {i > 0 ? along_weft - 1u : 0, along_weft, along_warp - w.warps, along_warp}};
  return c;
}
