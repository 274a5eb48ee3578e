/* SPDX-License-Identifier: Apache-2.0 */
/* The order of the particles: by distance from the attached ones (2009, section 4.1), and such that the ends
 * of consecutive springs are neighbours in memory. */
#include <stdlib.h>

#include "tools/scene_compiler/draft.h"

void draft_neighbours(const draft *d, uint32_t c, uint32_t near[4]) {
  const uint32_t i = c % d->grid.warps;
  const uint32_t j = c / d->grid.warps;
  near[0] = i > 0 ? c - 1 : c;
  near[1] = i + 1 < d->grid.warps ? c + 1 : c;
  near[2] = j > 0 ? c - d->grid.warps : c;
  near[3] = j + 1 < d->grid.wefts ? c + d->grid.warps : c;
}

/* Breadth first over the grid from all attached crossings; without any, all levels are 0. */
static void find_levels(draft *d, uint32_t *queue) {
  uint32_t head = 0;
  uint32_t tail = 0;
  for (uint32_t c = 0; c < d->crossings; ++c) {
    d->level[c] = d->attached == 0 || d->holder[c] != DRAFT_FREE ? 0 : UINT32_MAX;
    d->source[c] = d->holder[c];
    if (d->level[c] == 0) queue[tail++] = c;
  }
  while (head < tail) {
    const uint32_t c = queue[head++];
    uint32_t near[4];
    draft_neighbours(d, c, near);
    for (uint32_t n = 0; n < 4; ++n)
      if (d->level[near[n]] == UINT32_MAX) {
        d->level[near[n]] = d->level[c] + 1;
        d->source[near[n]] = d->source[c];
        queue[tail++] = near[n];
      }
  }
}

/* Whether contours of equal level run along yarns, as below a pinned row, where many links join crossings of
 * one level. Around a small attachment they run diagonally, and few links do. */
static int contours_along_yarns(const draft *d) {
  const uint32_t links = yarn_grid_links(d->grid);
  uint32_t along = 0;
  for (uint32_t n = 0; n < links; ++n) {
    uint32_t a;
    uint32_t b;
    yarn_grid_ends(d->grid, n, &a, &b);
    along += d->level[a] == d->level[b];
  }
  return along > links / 4;
}

typedef struct {
  uint64_t key;
  uint32_t crossing;
} place;

/* Order in memory: attached particles by body, the others by level, each level along its contours. The
 * springs of a batch, which all lead from one contour to the next in the same direction, then have long runs
 * in which both ends are consecutive. Contours along yarns are dealt into four planes, by number modulo 4: a
 * link reaches to the next plane, a bend spring to the one after. */
static place place_in_memory(const draft *d, uint32_t c, int planes) {
  static const uint32_t turn[4] = {0, 2, 1, 3};
  if (d->holder[c] != DRAFT_FREE) return (place){d->holder[c], c};
  const uint64_t level = (uint64_t)(d->level[c] + 1) << 32;
  const uint32_t i = c % d->grid.warps;
  const uint32_t j = c / d->grid.warps;
  if (planes) return (place){level | (turn[i % 4] * 4 + turn[j % 4]), c};
  return (place){level | d->source[c], c};
}

static int compare_places(const void *left, const void *right) {
  const place *a = left;
  const place *b = right;
  const int order = (a->key > b->key) - (a->key < b->key);
  return order != 0 ? order : (a->crossing > b->crossing) - (a->crossing < b->crossing);
}

int draft_order_particles(draft *d) {
  find_levels(d, d->crossing); /* filled below; scratch until then */
  place *places = malloc(d->crossings * sizeof *places);
  if (places == NULL) return draft_no_memory(d);
  const int planes = contours_along_yarns(d);
  for (uint32_t c = 0; c < d->crossings; ++c) places[c] = place_in_memory(d, c, planes);
  qsort(places, d->crossings, sizeof *places, compare_places);
  for (uint32_t n = 0; n < d->crossings; ++n) {
    d->crossing[n] = places[n].crossing;
    d->particle[places[n].crossing] = n;
  }
  free(places);
  return 1;
}
