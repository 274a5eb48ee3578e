/* SPDX-License-Identifier: Apache-2.0 */
/* How bend and shear springs are divided: by the particle with the higher number of a row's two. They
 * read positions, and add to velocities what does not depend on velocities, so their order is free;
 * only who touches a particle at the same time is not.
 *
 * A worker has springs from `springs_from` on, up to those of the next. Its far rows touch nobody
 * else's particles, nor what the worker before has in the substeps; it may take them at any time. Its
 * own rows touch what the worker before will have in the substeps, its near rows what that one has in
 * the springs, down to `least`: they wait for the springs of the worker before, and that one's
 * substeps, from the block on that comes to `least`, wait for them. So whoever begins the substeps
 * late, for he follows others, can take more of the springs meanwhile. */
#include "rt/share/share.h"

static uint32_t low_end(const fray_world *w, uint32_t row) {
  return w->row_i[row] < w->row_j[row] ? w->row_i[row] : w->row_j[row];
}

static uint32_t high_end(const fray_world *w, uint32_t row) {
  return w->row_i[row] < w->row_j[row] ? w->row_j[row] : w->row_i[row];
}

static uint32_t batch_end(const row_batch *b) { return (uint32_t)(b->first + b->count); }

/* All rows are his from the first one on that has an end among his particles. */
static void cut_batch(fray_share *s, const row_batch *b, share_cut *cuts) {
  const fray_world *w = s->world;
  uint32_t n = 0;
  cuts[0].near = cuts[0].own = cuts[0].far = (uint32_t)b->first;
  for (uint32_t row = (uint32_t)b->first; row < batch_end(b); ++row) {
    const uint32_t low = low_end(w, row);
    while (n + 1u < s->owners && high_end(w, row) >= s->springs_from[n + 1u]) {
      ++n;
      cuts[n].near = cuts[n].own = cuts[n].far = row;
    }
    if (low < s->springs_from[n]) cuts[n].own = row + 1u;
    if (low < s->far_from[n]) cuts[n].far = row + 1u;
    if (low < s->least[n]) s->least[n] = low;
  }
  while (n++ < s->workers) cuts[n].near = cuts[n].own = cuts[n].far = batch_end(b);
}

/* Springs, in rows, for each: who begins the substeps when those before him have done a pass has as much
 * more, by what a link costs, its particles included, beside a spring. Where contacts must be gathered in
 * between, everybody the same. */
static void share_springs(const fray_share *s, uint64_t springs[FRAY_WORKERS_MAX]) {
  const params *p = s->world->params;
  const uint64_t all = (uint32_t)p->bends + (uint32_t)p->shears;
  uint64_t later[FRAY_WORKERS_MAX];
  uint64_t sum = 0;
  for (uint32_t n = 0; n < s->owners; ++n) {
    later[n] = s->gathers ? 0 : (uint64_t)share_rows_before(s, s->from[n]) * 5u / 4u;
    sum += later[n];
  }
  for (uint32_t n = 0; n < s->owners; ++n)
    springs[n] = sum <= all ? (all - sum) / s->owners + later[n] : all * later[n] / sum;
}

/* Where his springs begin: at the end of a block of the worker before, not of its first ones. */
static uint32_t begin_springs(const fray_share *s, uint32_t worker, uint64_t particle) {
  const uint32_t last = s->from[worker] - 1u;
  uint32_t k = s->from[worker - 1u] + 3u;
  if (s->gathers || k > last) k = last;
  while (k < last && s->blocks[k].finish_end < particle) ++k;
  return s->blocks[k].finish_end;
}

static void place_springs(fray_share *s) {
  const params *p = s->world->params;
  const uint64_t free_ones = (uint32_t)(p->particles - p->held);
  const uint64_t all = (uint64_t)(uint32_t)p->bends + (uint32_t)p->shears + 1u;
  uint64_t springs[FRAY_WORKERS_MAX];
  uint64_t before = 0;
  share_springs(s, springs);
  for (uint32_t n = 0; n <= s->workers; ++n) {
    s->springs_from[n] = n == 0 ? 0 : (uint32_t)p->particles;
    s->far_from[n] = s->springs_from[n];
    s->least[n] = s->springs_from[n];
    if (n == 0 || n >= s->owners) continue;
    before += springs[n - 1u];
    const uint32_t from = begin_springs(s, n, (uint32_t)p->held + before * free_ones / all);
    const uint32_t others = s->blocks[s->from[n] - 1u].predict_end;
    s->springs_from[n] = s->least[n] = from;
    s->far_from[n] = from > others ? from : others;
  }
}

/* The block of each worker that must wait for the near springs of the next one. If it would be its
 * first, which follows the worker before, or if springs reach over a whole worker: all springs first. */
static void place_gates(fray_share *s) {
  s->springs_first = s->gathers;
  for (uint32_t n = 0; n < s->workers; ++n) s->gate[n] = SHARE_NO_GATE;
  for (uint32_t n = 1; n < s->owners; ++n) {
    uint32_t k = s->from[n - 1u];
    if (s->blocks[k].predict_end > s->least[n]) s->springs_first = 1;
    if (k > 0 && s->blocks[k - 1u].predict_end > s->least[n]) s->springs_first = 1;
    while (k < s->from[n] && s->blocks[k].predict_end <= s->least[n]) ++k;
    if (k < s->from[n]) s->gate[n - 1u] = k;
  }
}

void seams_cut(fray_share *s) {
  const fray_world *w = s->world;
  const uint32_t first = (uint32_t)w->params->link_batches;
  place_springs(s);
  for (uint32_t b = first; b < w->capacity[POOL_BATCHES]; ++b)
    cut_batch(s, &w->batches[b], s->cuts + (size_t)(b - first) * (s->workers + 1u));
  place_gates(s);
}

int seams_hold(const fray_share *s) {
  const fray_world *w = s->world;
  const uint32_t first = (uint32_t)w->params->link_batches;
  for (uint32_t b = first; b < w->capacity[POOL_BATCHES]; ++b)
    for (uint32_t n = 0; n < s->owners; ++n) {
      const share_cut *own = s->cuts + (size_t)(b - first) * (s->workers + 1u) + n;
      for (uint32_t row = own->near; row < own[1].near; ++row)
        if (low_end(w, row) < (row < own->own   ? s->least[n]
                               : row < own->far ? s->springs_from[n]
                                                : s->far_from[n]) ||
            high_end(w, row) >= s->springs_from[n + 1u])
          return 0;
    }
  return 1;
}
