/* SPDX-License-Identifier: Apache-2.0 */
/* Canonical numbering of crossings and springs on a grid of warps x wefts, and which springs a break
 * releases. Warp i runs along j, weft j runs along i; crossing (i, j) is j * warps + i. Canonical springs
 * are numbered through the three kinds (links, bend, shear), like the springs themselves.
 *
 * All functions are pure. Grids have at least 2 warps and 2 wefts, crossings are below warps * wefts, and
 * every call has constant cost. */
#ifndef FRAY_STATE_YARN_GRID_H
#define FRAY_STATE_YARN_GRID_H

#include <stdint.h>

typedef struct {
  uint32_t warps, wefts;
} yarn_grid;

static inline uint32_t yarn_grid_links(yarn_grid g) {
  return g.wefts * (g.warps - 1u) + g.warps * (g.wefts - 1u);
}
static inline uint32_t yarn_grid_bends(yarn_grid g) {
  return g.wefts * (g.warps - 2u) + g.warps * (g.wefts - 2u);
}
static inline uint32_t yarn_grid_shears(yarn_grid g) { return 2u * (g.warps - 1u) * (g.wefts - 1u); }
/* All canonical springs. Worlds with yarns have a second spring for each diagonal, which is used once an end
 * of the diagonal has split: these are numbered after all others, in the order of the first ones. */
static inline uint32_t yarn_grid_springs(yarn_grid g) {
  return yarn_grid_links(g) + yarn_grid_bends(g) + yarn_grid_shears(g);
}

/* A link from crossing (i, j) to (i, j + 1) iff along_warp, else to (i + 1, j). */
typedef struct {
  uint32_t i, j;
  uint32_t along_warp;
} yarn_grid_link;

/* canonical < yarn_grid_links(). */
yarn_grid_link yarn_grid_link_at(yarn_grid g, uint32_t canonical);
/* The lower of the numbers of a link and of its mirror image, (i, j) -> (warps - 1 - i, j).
 * canonical < yarn_grid_links(). */
uint32_t yarn_grid_mirror(yarn_grid g, uint32_t canonical);

/* The crossings at both ends of a canonical spring, second springs of diagonals included:
 * canonical < yarn_grid_springs() + yarn_grid_shears(). */
void yarn_grid_ends(yarn_grid g, uint32_t canonical, uint32_t *a, uint32_t *b);

/* The canonical springs that a break of a link releases; returns their number, at most YARN_GRID_RELEASED.
 * - The bend springs along the same yarn that span the break: the yarn between their ends is gone.
 * - Both diagonals of the (at most two) cells beside the link: a shear spring models the shear of a closed
 *   cell of four yarn pieces, and the cell is open now.
 * So two pieces of cloth that share no link share no spring either. canonical < yarn_grid_links(). */
enum { YARN_GRID_RELEASED = 6 };
uint32_t yarn_grid_released(yarn_grid g, uint32_t canonical, uint32_t released[YARN_GRID_RELEASED]);

/* The canonical springs that end at a crossing: 0..weft_end-1 along its weft, weft_end..warp_end-1 along its
 * warp, warp_end..count-1 diagonals, without their second springs. */
enum { YARN_GRID_AT_YARN = 4, YARN_GRID_AT = 12 };
typedef struct {
  uint32_t spring[YARN_GRID_AT];
  uint32_t weft_end, warp_end, count;
} yarn_grid_star;
void yarn_grid_springs_at(yarn_grid g, uint32_t crossing, yarn_grid_star *s);

/* The next crossing along a yarn and the link to it. direction: 0 back and 1 on along the weft, 2 back and
 * 3 on along the warp. Returns 0, without a result, at the end of the yarn. */
int yarn_grid_step(yarn_grid g, uint32_t crossing, uint32_t direction, uint32_t *next, uint32_t *link);

/* yarn_grid_step() in all four directions: `next` is the crossing itself at the end of a yarn, where `link`
 * has no meaning. */
typedef struct {
  uint32_t next[4], link[4];
} yarn_grid_neighbours;
yarn_grid_neighbours yarn_grid_neighbours_at(yarn_grid g, uint32_t crossing);

#endif
