/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/share/plan.h"

/* The particles of a batch, end excluded. Idle batches are projected by nobody. */
typedef struct {
  uint32_t first, end;
} span;

static span span_of(const fray_world *w, uint32_t b) {
  const row_batch *batch = &w->batches[b];
  const uint32_t first = (uint32_t)batch->first;
  span s = {UINT32_MAX, 0};
  if (batch->held == BATCH_IDLE) return s;
  for (uint32_t row = first; row < first + (uint32_t)batch->count; ++row) {
    const uint32_t i = w->row_i[row];
    const uint32_t j = w->row_j[row];
    const uint32_t least = i < j ? i : j;
    const uint32_t most = i < j ? j : i;
    if (least < s.first) s.first = least;
    if (most >= s.end) s.end = most + 1u;
  }
  return s;
}

static uint32_t within(uint32_t v, uint32_t least, uint32_t most) {
  return v < least ? least : (v > most ? most : v);
}

size_t plan_scratch_bytes(const fray_world *w) {
  return ((size_t)(uint32_t)w->params->link_batches + 1u) * sizeof(span);
}

/* For every batch b: the least particle of it and of all behind it, the end of all before it. */
static void find_spans(const fray_world *w, span *s) {
  const uint32_t batches = (uint32_t)w->params->link_batches;
  for (uint32_t b = 0; b < batches; ++b) s[b] = span_of(w, b);
  s[batches].first = UINT32_MAX;
  s[batches].end = 0;
  for (uint32_t b = batches; b > 0; --b)
    if (s[b].first < s[b - 1u].first) s[b - 1u].first = s[b].first;
  uint32_t end = (uint32_t)w->params->held; /* the first block carries the held ones */
  for (uint32_t b = 0; b <= batches; ++b) {
    const uint32_t own = s[b].end;
    s[b].end = end;
    if (own > end) end = own;
  }
}

uint32_t plan_cut(const fray_world *w, plan_block *blocks, void *scratch) {
  const uint32_t batches = (uint32_t)w->params->link_batches;
  const uint32_t held = (uint32_t)w->params->held;
  const uint32_t particles = (uint32_t)w->params->particles;
  const uint32_t share = (uint32_t)w->params->links / PLAN_BLOCKS_MAX + 1u;
  const uint32_t rows = share < PLAN_ROWS_LEAST ? PLAN_ROWS_LEAST : share;
  span *s = (span *)scratch;
  uint32_t count = 0;
  uint32_t from = 0; /* first batch of this block */
  find_spans(w, s);
  for (uint32_t b = 1; b <= batches; ++b) {
    const uint32_t taken = (uint32_t)(w->batches[b - 1u].first + w->batches[b - 1u].count -
                                      w->batches[from].first);
    /* (1), for the block before this one */
    const int apart = from == 0 || s[b].first >= s[from].end;
    if (b < batches && (taken < rows || !apart || s[b].first == UINT32_MAX)) continue;
    plan_block *block = &blocks[count++];
    block->batch_end = b;
    block->predict_end = b < batches ? s[b].end : particles;
    block->finish_end = b < batches ? within(s[b].first, held, s[b].end) : particles;
    from = b;
  }
  return count;
}

int plan_holds(const fray_world *w, const plan_block *blocks, uint32_t count) {
  const uint32_t held = (uint32_t)w->params->held;
  uint32_t b = 0;
  uint32_t first = 0; /* of the particles that the block may touch */
  for (uint32_t k = 0; k < count; ++k) {
    for (; b < blocks[k].batch_end; ++b) {
      const span s = span_of(w, b);
      if (s.end != 0 && (s.first < first || s.end > blocks[k].predict_end)) return 0;
    }
    if (k + 1u < count && blocks[k + 1u].finish_end < blocks[k].predict_end) return 0;
    if (blocks[k].finish_end > blocks[k].predict_end || blocks[k].finish_end < held) return 0;
    /* held ones belong to block 0, and block 1 may touch them too */
    first = k == 0 && blocks[k].finish_end == held ? 0 : blocks[k].finish_end;
  }
  return b == (uint32_t)w->params->link_batches && count != 0 &&
         blocks[count - 1u].finish_end == (uint32_t)w->params->particles;
}
