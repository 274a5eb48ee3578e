/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/state/yarn_grid.h"

#include "rt/base/assert.h"

yarn_grid_link yarn_grid_link_at(yarn_grid g, uint32_t canonical) {
  FRAY_ASSERT(canonical < yarn_grid_links(g));
  const uint32_t weft_links = g.wefts * (g.warps - 1u);
  yarn_grid_link link;
  if (canonical < weft_links) {
    link.i = canonical % (g.warps - 1u);
    link.j = canonical / (g.warps - 1u);
    link.along_warp = 0;
  } else {
    link.i = (canonical - weft_links) % g.warps;
    link.j = (canonical - weft_links) / g.warps;
    link.along_warp = 1;
  }
  return link;
}

uint32_t yarn_grid_mirror(yarn_grid g, uint32_t canonical) {
  const yarn_grid_link l = yarn_grid_link_at(g, canonical);
  uint32_t mirrored;
  if (l.along_warp != 0)
    mirrored = canonical - l.i + (g.warps - 1u - l.i);
  else
    mirrored = canonical - l.i + (g.warps - 2u - l.i);
  return mirrored < canonical ? mirrored : canonical;
}

/* The bend spring that begins at crossing (i, j). */
static uint32_t bend_number(yarn_grid g, uint32_t i, uint32_t j, uint32_t along_warp) {
  const uint32_t first = yarn_grid_links(g);
  return along_warp != 0 ? first + g.wefts * (g.warps - 2u) + j * g.warps + i
                         : first + j * (g.warps - 2u) + i;
}

/* Cell (i, j) has corners (i,j) .. (i+1,j+1); diagonal 0 rises with i, diagonal 1 falls. */
static uint32_t shear_number(yarn_grid g, uint32_t i, uint32_t j, uint32_t diagonal) {
  return yarn_grid_links(g) + yarn_grid_bends(g) + 2u * (j * (g.warps - 1u) + i) + diagonal;
}

void yarn_grid_ends(yarn_grid g, uint32_t canonical, uint32_t *a, uint32_t *b) {
  FRAY_ASSERT(canonical < yarn_grid_springs(g) + yarn_grid_shears(g));
  const uint32_t links = yarn_grid_links(g);
  const uint32_t bends = yarn_grid_bends(g);
  if (canonical < links) {
    const yarn_grid_link l = yarn_grid_link_at(g, canonical);
    *a = l.j * g.warps + l.i;
    *b = *a + (l.along_warp != 0 ? g.warps : 1u);
  } else if (canonical < links + bends) {
    const uint32_t n = canonical - links;
    const uint32_t weft_bends = g.wefts * (g.warps - 2u);
    if (n < weft_bends) {
      *a = n / (g.warps - 2u) * g.warps + n % (g.warps - 2u);
      *b = *a + 2u;
    } else {
      *a = n - weft_bends;
      *b = *a + 2u * g.warps;
    }
  } else {
    const uint32_t n = canonical < yarn_grid_springs(g) ? canonical - links - bends
                                                        : canonical - yarn_grid_springs(g);
    const uint32_t cell = n / 2u;
    const uint32_t corner = cell / (g.warps - 1u) * g.warps + cell % (g.warps - 1u);
    *a = n % 2u == 0 ? corner : corner + 1u;
    *b = n % 2u == 0 ? corner + g.warps + 1u : corner + g.warps;
  }
}

uint32_t yarn_grid_released(yarn_grid g, uint32_t canonical, uint32_t released[YARN_GRID_RELEASED]) {
  const yarn_grid_link l = yarn_grid_link_at(g, canonical);
  const uint32_t along = l.along_warp != 0 ? l.j : l.i;
  const uint32_t crossings = l.along_warp != 0 ? g.wefts : g.warps; /* of the link's yarn */
  uint32_t count = 0;
  if (along >= 1u) /* (before, a, b) */
    released[count++] = l.along_warp != 0 ? bend_number(g, l.i, l.j - 1u, 1)
                                          : bend_number(g, l.i - 1u, l.j, 0);
  if (along + 2u < crossings) /* (a, b, after) */
    released[count++] = bend_number(g, l.i, l.j, l.along_warp);
  for (uint32_t side = 0; side < 2u; ++side) {
    /* the cells with the link as one edge: at (i, j) and one before it across the yarn */
    const uint32_t across = l.along_warp != 0 ? l.i : l.j;
    if (across < side) continue;
    const uint32_t i = l.along_warp != 0 ? l.i - side : l.i;
    const uint32_t j = l.along_warp != 0 ? l.j : l.j - side;
    if (i < g.warps - 1u && j < g.wefts - 1u) {
      released[count++] = shear_number(g, i, j, 0);
      released[count++] = shear_number(g, i, j, 1);
    }
  }
  FRAY_ASSERT(count <= YARN_GRID_RELEASED);
  return count;
}

int yarn_grid_step(yarn_grid g, uint32_t crossing, uint32_t direction, uint32_t *next, uint32_t *link) {
  FRAY_ASSERT(crossing < g.warps * g.wefts && direction < 4u);
  const uint32_t i = crossing % g.warps;
  const uint32_t j = crossing / g.warps;
  const uint32_t along = direction < 2u ? i : j;
  const uint32_t crossings = direction < 2u ? g.warps : g.wefts; /* of the yarn */
  const uint32_t stride = direction < 2u ? 1u : g.warps;
  const int on = (direction & 1u) != 0;
  if (on ? along + 1u == crossings : along == 0) return 0;
  const uint32_t first = on ? crossing : crossing - stride; /* where the link begins */
  *next = on ? crossing + stride : first;
  *link = direction < 2u ? first / g.warps * (g.warps - 1u) + first % g.warps
                         : g.wefts * (g.warps - 1u) + first;
  return 1;
}

static void add_bends(yarn_grid g, uint32_t i, uint32_t j, uint32_t along_warp, yarn_grid_star *s) {
  const uint32_t along = along_warp != 0 ? j : i;
  const uint32_t crossings = along_warp != 0 ? g.wefts : g.warps;
  if (along >= 2u)
    s->spring[s->count++] = along_warp != 0 ? bend_number(g, i, j - 2u, 1) : bend_number(g, i - 2u, j, 0);
  if (along + 2u < crossings) s->spring[s->count++] = bend_number(g, i, j, along_warp);
}

void yarn_grid_springs_at(yarn_grid g, uint32_t crossing, yarn_grid_star *s) {
  FRAY_ASSERT(crossing < g.warps * g.wefts);
  const uint32_t i = crossing % g.warps;
  const uint32_t j = crossing / g.warps;
  s->weft_end = s->warp_end = s->count = 0;
  uint32_t next;
  for (uint32_t axis = 0; axis < 2u; ++axis) {
    for (uint32_t direction = 2u * axis; direction < 2u * axis + 2u; ++direction)
      if (yarn_grid_step(g, crossing, direction, &next, &s->spring[s->count])) ++s->count;
    add_bends(g, i, j, axis, s);
    if (axis == 0)
      s->weft_end = s->count;
    else
      s->warp_end = s->count;
  }
  for (uint32_t cell = 0; cell < 4u; ++cell) {
    const uint32_t left = cell & 1u;
    const uint32_t above = cell >> 1;
    if (i < left || j < above || i - left >= g.warps - 1u || j - above >= g.wefts - 1u) continue;
    s->spring[s->count++] = shear_number(g, i - left, j - above, left ^ above);
  }
  FRAY_ASSERT(s->warp_end <= 2u * YARN_GRID_AT_YARN && s->count <= YARN_GRID_AT);
}

yarn_grid_neighbours yarn_grid_neighbours_at(yarn_grid g, uint32_t crossing) {
  FRAY_ASSERT(crossing < g.warps * g.wefts);
  const uint32_t j = crossing / g.warps;
  const uint32_t i = crossing - j * g.warps;
  const uint32_t weft_link = crossing - j; /* that begins here */
  const uint32_t warp_link = g.wefts * (g.warps - 1u) + crossing;
  const yarn_grid_neighbours n = {
      {i > 0 ? crossing - 1u : crossing, i + 1u < g.warps ? crossing + 1u : crossing,
       j > 0 ? crossing - g.warps : crossing, j + 1u < g.wefts ? crossing + g.warps : crossing},
      {i > 0 ? weft_link - 1u : 0, weft_link, warp_link - g.warps, warp_link}};
  return n;
}
