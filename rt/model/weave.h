/* SPDX-License-Identifier: Apache-2.0 */
/* Canonical numbers of crossings and springs on a grid of warps x wefts, and which springs a cut
 * releases. Warp i runs along j, weft j runs along i; crossing (i, j) is j * warps + i.
 * Canonical rows count through the three families like the rows themselves. */
#ifndef FRAY_MODEL_WEAVE_H
#define FRAY_MODEL_WEAVE_H

#include <stdint.h>

typedef struct {
  uint32_t warps, wefts;
} weave;

static inline uint32_t weave_links(weave w) {
  return w.wefts * (w.warps - 1u) + w.warps * (w.wefts - 1u);
}
static inline uint32_t weave_bends(weave w) {
  return w.wefts * (w.warps - 2u) + w.warps * (w.wefts - 2u);
}
static inline uint32_t weave_shears(weave w) { return 2u * (w.warps - 1u) * (w.wefts - 1u); }

typedef struct {
  uint32_t i, j;      /* the crossing it starts at */
  uint32_t along_warp; /* 1: (i,j)-(i,j+1), 0: (i,j)-(i+1,j) */
} weave_link;

weave_link weave_link_at(weave w, uint32_t canonical);
/* The link of the mirrored sheet, (i, j) -> (warps - 1 - i, j): the lesser number of the two. */
uint32_t weave_mirror(weave w, uint32_t canonical);

/* Shadow rows, of worlds with yarns: the second ones of the diagonals, in the same order, numbered on
 * behind them. */
static inline uint32_t weave_rows(weave w) {
  return weave_links(w) + weave_bends(w) + weave_shears(w);
}

/* Both crossings of any canonical row. */
void weave_ends(weave w, uint32_t canonical, uint32_t *a, uint32_t *b);

/* What cutting a link releases, as canonical rows; at most WEAVE_RELEASED.
 * - The bend springs along the same yarn that span the cut: the yarn between their ends is gone.
 * - Both diagonals of the (at most two) cells beside the link: a shear spring stands for the
 *   shear of a closed cell of four yarn pieces, and the cell is open now.
 * So two pieces that share no link share no spring either. */
enum { WEAVE_RELEASED = 6 };
uint32_t weave_released(weave w, uint32_t canonical, uint32_t released[WEAVE_RELEASED]);

/* The rows that end at a crossing, as canonical rows: first those along its weft, then along its warp,
 * then the diagonals, without shadow rows. At most WEAVE_AT. */
enum { WEAVE_AT_YARN = 4, WEAVE_AT = 12 };
typedef struct {
  uint32_t row[WEAVE_AT];
  uint32_t along_weft, along_warp, count; /* the first of the next kind */
} weave_star;
void weave_rows_at(weave w, uint32_t crossing, weave_star *s);

/* The next crossing along a yarn and the link that leads there; 0 at the end of the yarn.
 * way: 0 back and 1 on along the weft, 2 back and 3 on along the warp. */
int weave_step(weave w, uint32_t crossing, uint32_t way, uint32_t *next, uint32_t *link);

/* All four at once: `next` is the crossing itself at the end of a yarn. */
typedef struct {
  uint32_t next[4], link[4];
} weave_cross;
weave_cross weave_cross_at(weave w, uint32_t crossing);

#endif
