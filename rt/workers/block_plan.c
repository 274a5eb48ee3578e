/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/workers/block_plan.h"

/* The particles of a batch, end excluded. Inactive batches are not projected, so they have none. */
typedef struct {
  uint32_t first, end;
} particle_span;

static particle_span span_of(const fray_world *w, uint32_t b) {
  FRAY_ASSERT(b < (uint32_t)w->params->link_batches);
  const spring_batch *batch = &w->woven.batches[b];
  const uint32_t first = (uint32_t)batch->first;
  particle_span s = {UINT32_MAX, 0};
  if (batch->attached == BATCH_INACTIVE) return s;
  for (uint32_t link = first; link < first + (uint32_t)batch->count; ++link) {
    const uint32_t i = w->woven.spring_i[link];
    const uint32_t j = w->woven.spring_j[link];
    const uint32_t low = i < j ? i : j;
    const uint32_t high = i < j ? j : i;
    if (low < s.first) s.first = low;
    if (high >= s.end) s.end = high + 1u;
  }
  return s;
}

static uint32_t clamp(uint32_t v, uint32_t low, uint32_t high) {
  return v < low ? low : (v > high ? high : v);
}

size_t block_plan_scratch_bytes(const fray_world *w) {
  return ((size_t)(uint32_t)w->params->link_batches + 1u) * sizeof(particle_span);
}

/* For every batch b: the lowest particle of batches b and later, and the end of those of earlier batches. */
static void find_spans(const fray_world *w, particle_span *s) {
  const uint32_t batches = (uint32_t)w->params->link_batches;
  for (uint32_t b = 0; b < batches; ++b) s[b] = span_of(w, b);
  s[batches].first = UINT32_MAX;
  s[batches].end = 0;
  for (uint32_t b = batches; b > 0; --b)
    if (s[b].first < s[b - 1u].first) s[b - 1u].first = s[b].first;
  uint32_t end = particles_attached(w); /* attached particles are carried in block 0 */
  for (uint32_t b = 0; b <= batches; ++b) {
    const uint32_t own = s[b].end;
    s[b].end = end;
    if (own > end) end = own;
  }
}

uint32_t block_plan_make(const fray_world *w, block_plan *blocks, void *scratch) {
  FRAY_ASSERT(!world_has_membrane(w) && w->params->link_batches > 0);
  const uint32_t batches = (uint32_t)w->params->link_batches;
  const uint32_t attached = particles_attached(w);
  const uint32_t particles = (uint32_t)w->params->particles;
  const uint32_t even = (uint32_t)w->params->links / BLOCKS_MAX + 1u;
  const uint32_t links_min = even < BLOCK_SPRINGS_MIN ? BLOCK_SPRINGS_MIN : even; /* of a block */
  particle_span *s = (particle_span *)scratch;
  uint32_t count = 0;
  uint32_t from = 0; /* first batch of this block */
  find_spans(w, s);
  for (uint32_t b = 1; b <= batches; ++b) {
    const uint32_t links = (uint32_t)(w->woven.batches[b - 1u].first + w->woven.batches[b - 1u].count -
                                      w->woven.batches[from].first);
    /* (1), for the block before this one */
    const int apart = from == 0 || s[b].first >= s[from].end;
    if (b < batches && (links < links_min || !apart || s[b].first == UINT32_MAX)) continue;
    FRAY_ASSERT(count < BLOCKS_MAX);
    block_plan *block = &blocks[count++];
    block->batch_end = b;
    block->advance_end = b < batches ? s[b].end : particles;
    block->finish_end = b < batches ? clamp(s[b].first, attached, s[b].end) : particles;
    from = b;
  }
  FRAY_ASSERT(block_plan_holds(w, blocks, count));
  return count;
}

int block_plan_holds(const fray_world *w, const block_plan *blocks, uint32_t count) {
  FRAY_ASSERT(count <= BLOCKS_MAX);
  const uint32_t attached = particles_attached(w);
  uint32_t b = 0;
  uint32_t first = 0; /* of the particles that the block may touch */
  for (uint32_t k = 0; k < count; ++k) {
    for (; b < blocks[k].batch_end; ++b) {
      const particle_span s = span_of(w, b);
      if (s.end != 0 && (s.first < first || s.end > blocks[k].advance_end)) return 0;
    }
    if (k + 1u < count && blocks[k + 1u].finish_end < blocks[k].advance_end) return 0;
    if (blocks[k].finish_end > blocks[k].advance_end || blocks[k].finish_end < attached) return 0;
    /* attached particles belong to block 0, and block 1 may touch them too */
    first = k == 0 && blocks[k].finish_end == attached ? 0 : blocks[k].finish_end;
  }
  return b == (uint32_t)w->params->link_batches && count != 0 &&
         blocks[count - 1u].finish_end == (uint32_t)w->params->particles;
}
