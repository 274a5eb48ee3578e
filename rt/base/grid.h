/* SPDX-License-Identifier: Apache-2.0 */
/* Which of many swept boxes overlap, with a fixed bound of work: a uniform grid of cells, hashed.
 *
 *   grid_box_of    for every edge, triangle or point: the box of its way
 *   grid_fill      puts the boxes of a list into cells
 *   grid_find      pairs of others, or of the same list, with them that overlap
 *
 * Elements are named by their place in a list, so the caller's numbering is the order of
 * everything: pairs come sorted, and the same ones whatever the memory or the machine. Every pair
 * of boxes that overlap, or touch, and have no corner in common is listed, unless one of the two is
 * flagged.
 *
 * A box stands in the one cell that holds its lower corner; who looks for others looks so much
 * lower as the widest box goes. Boxes wider than a cell would make that far for all: they are
 * listed apart, and every element looks through that list. A cell should be about as wide as the
 * boxes.
 *
 * Memory of an edge with 16-bit (32-bit) ids: box 12, corners 4 (8), entry 2 (4), two buckets 4
 * (8), flags 1, and 4 (8) bytes a pair: with four pairs an edge 39 (65) bytes. Work: grid_fill is
 * two steps an element and one a bucket. grid_find is, an element, at most cells_most cells,
 * wide_most + visits_most boxes and partners_most^2 / 2 moves. On a Cortex-M3 an edge of a sheet
 * takes 235 instructions for its box, 136 to fill, 900 to 1,250 to find its pairs, flat or crumpled
 * (tests/work/sweep.sh). */
#ifndef FRAY_BASE_GRID_H
#define FRAY_BASE_GRID_H

#include "rt/base/sweep.h"

#if defined(FRAY_ID_BITS) && FRAY_ID_BITS == 16
typedef uint16_t grid_id;
#else
typedef uint32_t grid_id;
#endif

enum { GRID_BITS = 9, GRID_CORNERS = 3, GRID_PARTNERS = 32 };

/* In 2^-GRID_BITS lu, ends included. */
typedef struct {
  int16_t low[3], high[3];
} grid_box;

typedef struct {
  grid_id a, b; /* in one list a < b; else a is in `others` */
} grid_pair;

/* Why pairs of an element may be missing. */
enum {
  GRID_LARGE = 1,   /* more than cells_most cells to look into, or wide and no room for it */
  GRID_CROWDED = 2, /* more than visits_most boxes where it is, or more than partners_most pairs */
  GRID_PAIRS = 4    /* no room for its pairs */
};

typedef struct {
  const grid_box *boxes;
  const grid_id *corners; /* corners_each of them for each element; NULL: nothing is left out */
  uint8_t *flags;         /* of each element; grid_fill and grid_find add to them */
  uint32_t count, corners_each; /* at most GRID_CORNERS */
} grid_list;

typedef struct {
  /* the caller's: memory and limits */
  grid_id *bucket;  /* [buckets + 1]: where its entries begin */
  grid_id *entry;   /* [elements of the list] */
  grid_id *wide;    /* [wide_most]: boxes wider than a cell */
  uint32_t buckets; /* a power of two; about as many as elements */
  uint32_t wide_most;
  uint32_t cell_bits;   /* a cell is 2^(cell_bits - GRID_BITS) lu wide; 1..15 */
  uint32_t cells_most;  /* that one may look into; 27 for what is not wider than a cell; to 1024 */
  uint32_t visits_most; /* boxes that one may be held against */
  uint32_t partners_most; /* pairs that one may have with later ones; at most GRID_PARTNERS */
  /* set by grid_fill */
  uint32_t wide_count;
  int32_t reach[3]; /* the widest of the others along each axis */
} grid;

/* The box of `count` points (from 1 on) on their ways, widened by half the thickness and outwards
 * to whole units. `drift` is taken from where they end: what all move by brings none of them
 * nearer, and boxes are smaller without it; its components are at most FX_WORLD_MAX. */
grid_box grid_box_of(const sweep_point *points, uint32_t count, int32_t thickness, vec3 drift);

/* Empties the grid and puts `list` into it; clears the list's flags. */
void grid_fill(grid *g, const grid_list *list);

/* The pairs of `others` with `list`, which fills the grid; `others` may be `list` itself, and else
 * has its flags cleared. Returns how many there are, at most `capacity`, sorted by a, then b. */
uint32_t grid_find(const grid *g, const grid_list *list, const grid_list *others, grid_pair *pairs,
                   uint32_t capacity);

#endif
