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
    const uint32_t n = canonical - links - bends;
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
