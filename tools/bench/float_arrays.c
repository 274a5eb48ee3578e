/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/bench/float_arrays.h"

#include <stdlib.h>
#include <string.h>

#include "rt/state/world.h"
#include "tools/bench/float_avx2.h"

enum { LANES = 8, RUN_LEAST = 4 /* shorter ones are faster by ids */ };

/* How many of the rows, from the first on, are one run. */
static uint32_t run_length(const fray_world *w, const uint32_t *rows, uint32_t count) {
  const uint32_t i = w->woven.spring_i[rows[0]];
  const uint32_t j = w->woven.spring_j[rows[0]];
  uint32_t n = 1;
  while (i < j && n < count && w->woven.spring_i[rows[n]] == i + n && w->woven.spring_j[rows[n]] == j + n) ++n;
  return n;
}

static uint32_t whole(uint32_t rows) { return (rows + LANES - 1) / LANES * LANES; }

static float_piece *add_piece(float_arrays *f, uint32_t first, int held, int run) {
  float_piece *p = &f->pieces[f->piece_count++];
  memset(p, 0, sizeof *p);
  p->first = first;
  p->run = (uint8_t)run;
  p->held = (uint8_t)held;
  return p;
}

static void add_row(float_arrays *f, const fray_world *w, uint32_t row, float_piece *p) {
  const uint32_t at = p->first + p->count++;
  const float rest = (float)w->woven.link_classes[w->woven.spring_kind[row] & SPRING_CLASS].rest * 0x1p-24f;
  f->i[at] = w->woven.spring_i[row];
  f->j[at] = w->woven.spring_j[row];
  f->reach[at] = p->held ? rest : 0.5f * rest;
}

static uint32_t take_runs(float_arrays *f, const fray_world *w, const uint32_t *rows,
                          uint32_t count, int held, uint32_t first) {
  uint32_t length;
  for (uint32_t n = 0; n < count; n += length) {
    length = run_length(w, rows + n, count - n);
    if (length < RUN_LEAST) continue;
    float_piece *p = add_piece(f, first, held, 1);
    p->i = w->woven.spring_i[rows[n]];
    p->j = w->woven.spring_j[rows[n]];
    for (uint32_t k = 0; k < length; ++k) add_row(f, w, rows[n + k], p);
    f->springs_in_runs += length;
    first += whole(length);
  }
  return first;
}

static uint32_t take_others(float_arrays *f, const fray_world *w, const uint32_t *rows,
                            uint32_t count, int held, uint32_t first) {
  float_piece *p = add_piece(f, first, held, 0);
  uint32_t length;
  for (uint32_t n = 0; n < count; n += length) {
    length = run_length(w, rows + n, count - n);
    if (length >= RUN_LEAST) continue;
    for (uint32_t k = 0; k < length; ++k) add_row(f, w, rows[n + k], p);
  }
  const uint32_t end = first + whole(p->count);
  for (uint32_t n = first + p->count; n < end; ++n) {
    f->i[n] = f->particles;
    f->j[n] = f->particles + 1;
    f->reach[n] = 0.5f;
  }
  if (p->count == 0) --f->piece_count;
  return end;
}

static void take_batches(float_arrays *f, const fray_world *w, uint32_t *rows) {
  uint32_t first = 0;
  for (uint32_t b = 0; b < (uint32_t)w->params->link_batches; ++b) {
    const spring_batch *batch = &w->woven.batches[b];
    const int held = batch->attached == BATCH_ATTACHED;
    uint32_t count = 0;
    if (batch->attached == BATCH_INACTIVE) continue;
    for (int32_t n = 0; n < batch->count; ++n)
      if (w->woven.spring_kind[batch->first + n] != SPRING_DEAD) rows[count++] = (uint32_t)(batch->first + n);
    first = take_runs(f, w, rows, count, held, first);
    first = take_others(f, w, rows, count, held, first);
    f->rows += count;
  }
}

int float_arrays_open(float_arrays *f, const fray_world *w) {
  const size_t links = (size_t)w->params->links;
  const size_t pieces = links / RUN_LEAST + (size_t)w->params->link_batches + 1;
  const size_t room = (links + pieces * LANES) / LANES * LANES;
  memset(f, 0, sizeof *f);
  f->particles = w->p.count;
  /* behind the last particle: two that only padding springs join, and lanes that a run does not use */
  const size_t bytes = whole(f->particles + 2 + LANES) * sizeof(float);
  uint32_t *rows = malloc(links * sizeof *rows);
  f->x = aligned_alloc(32, bytes);
  f->y = aligned_alloc(32, bytes);
  f->z = aligned_alloc(32, bytes);
  f->i = malloc(room * sizeof *f->i);
  f->j = malloc(room * sizeof *f->j);
  f->reach = aligned_alloc(32, room * sizeof(float));
  f->pieces = malloc(pieces * sizeof *f->pieces);
  const int good = rows && f->x && f->y && f->z && f->i && f->j && f->reach && f->pieces;
  if (good) {
    memset(f->x, 0, bytes);
    memset(f->y, 0, bytes);
    memset(f->z, 0, bytes);
    memset(f->reach, 0, room * sizeof(float));
    take_batches(f, w, rows);
    float_arrays_restore(f, w);
  }
  free(rows);
  return good;
}

void float_arrays_restore(float_arrays *f, const fray_world *w) {
  for (uint32_t n = 0; n < f->particles; ++n) {
    f->x[n] = (float)w->p.x[n] * 0x1p-24f;
    f->y[n] = (float)w->p.y[n] * 0x1p-24f;
    f->z[n] = (float)w->p.z[n] * 0x1p-24f;
  }
  f->x[f->particles + 1] = f->x[f->particles] + 1.0f;
}

void float_arrays_close(float_arrays *f) {
  free(f->x);
  free(f->y);
  free(f->z);
  free(f->i);
  free(f->j);
  free(f->reach);
  free(f->pieces);
}

#if FLOAT_AVX2
AVX2_INLINE float_vec8 load_run(const float_arrays *f, uint32_t at) {
  return (float_vec8){_mm256_loadu_ps(f->x + at), _mm256_loadu_ps(f->y + at),
                      _mm256_loadu_ps(f->z + at)};
}

AVX2_INLINE void store_run(const float_arrays *f, uint32_t at, float_vec8 v) {
  _mm256_storeu_ps(f->x + at, v.x);
  _mm256_storeu_ps(f->y + at, v.y);
  _mm256_storeu_ps(f->z + at, v.z);
}

AVX2_INLINE __m256 load_lanes(const float *p, const uint32_t *id) {
  return _mm256_setr_ps(p[id[0]], p[id[1]], p[id[2]], p[id[3]], p[id[4]], p[id[5]], p[id[6]],
                        p[id[7]]);
}

AVX2_INLINE void store_lanes(float *to, const uint32_t *id, __m256 v) {
  const __m128 half[2] = {_mm256_castps256_ps128(v), _mm256_extractf128_ps(v, 1)};
  for (int n = 0; n < 2; ++n) {
    _mm_store_ss(to + id[4 * n], half[n]);
    _mm_store_ss(to + id[4 * n + 1], _mm_movehdup_ps(half[n]));
    _mm_store_ss(to + id[4 * n + 2], _mm_permute_ps(half[n], 2));
    _mm_store_ss(to + id[4 * n + 3], _mm_permute_ps(half[n], 3));
  }
}

AVX2_INLINE float_vec8 load_ids(const float_arrays *f, const uint32_t *id) {
  return (float_vec8){load_lanes(f->x, id), load_lanes(f->y, id), load_lanes(f->z, id)};
}

AVX2_INLINE void store_ids(const float_arrays *f, const uint32_t *id, float_vec8 v) {
  store_lanes(f->x, id, v.x);
  store_lanes(f->y, id, v.y);
  store_lanes(f->z, id, v.z);
}

AVX2_INLINE float_vec8 minus(float_vec8 a, float_vec8 b) {
  return (float_vec8){_mm256_sub_ps(a.x, b.x), _mm256_sub_ps(a.y, b.y), _mm256_sub_ps(a.z, b.z)};
}

AVX2_INLINE float_vec8 nearer(float_vec8 a, __m256 share, float_vec8 d) {
  return (float_vec8){_mm256_fmadd_ps(share, d.x, a.x), _mm256_fmadd_ps(share, d.y, a.y),
                      _mm256_fmadd_ps(share, d.z, a.z)};
}

AVX2_INLINE float_vec8 farther(float_vec8 a, __m256 share, float_vec8 d) {
  return (float_vec8){_mm256_fnmadd_ps(share, d.x, a.x), _mm256_fnmadd_ps(share, d.y, a.y),
                      _mm256_fnmadd_ps(share, d.z, a.z)};
}

/* Eight rows of a run, of which `live` move. The others are stored as they were: i lies below j and
 * goes first, so no end that moved is undone. */
AVX2_INLINE void run_block(const float_arrays *f, const float_piece *p, uint32_t n, int held,
                           __m256 live) {
  const float_vec8 a = load_run(f, p->i + n);
  const float_vec8 b = load_run(f, p->j + n);
  const float_vec8 d = minus(b, a);
  const __m256 all = _mm256_set1_ps(held ? 1.0f : 0.5f);
  const __m256 reach = _mm256_load_ps(f->reach + p->first + n);
  const __m256 share = _mm256_and_ps(float_share(d, reach, all), live);
  if (!held) store_run(f, p->i + n, nearer(a, share, d));
  store_run(f, p->j + n, farther(b, share, d));
}

AVX2_INLINE void sweep_run(const float_arrays *f, const float_piece *p, int held) {
  const __m256i lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  const __m256 every = _mm256_castsi256_ps(_mm256_set1_epi32(-1));
  uint32_t n = 0;
  for (; n + LANES <= p->count; n += LANES) run_block(f, p, n, held, every);
  if (n == p->count) return;
  const __m256i left = _mm256_set1_epi32((int)(p->count - n));
  run_block(f, p, n, held, _mm256_castsi256_ps(_mm256_cmpgt_epi32(left, lanes)));
}

AVX2_INLINE void sweep_ids(const float_arrays *f, const float_piece *p, int held) {
  const __m256 all = _mm256_set1_ps(held ? 1.0f : 0.5f);
  for (uint32_t n = p->first; n < p->first + p->count; n += LANES) {
    const float_vec8 a = load_ids(f, f->i + n);
    const float_vec8 b = load_ids(f, f->j + n);
    const float_vec8 d = minus(b, a);
    const __m256 share = float_share(d, _mm256_load_ps(f->reach + n), all);
    if (!held) store_ids(f, f->i + n, nearer(a, share, d));
    store_ids(f, f->j + n, farther(b, share, d));
  }
}

AVX2_TARGET void float_arrays_iterate(float_arrays *f) {
  for (uint32_t n = 0; n < f->piece_count; ++n) {
    const float_piece *p = &f->pieces[n];
    if (p->run && p->held) sweep_run(f, p, 1);
    if (p->run && !p->held) sweep_run(f, p, 0);
    if (!p->run && p->held) sweep_ids(f, p, 1);
    if (!p->run && !p->held) sweep_ids(f, p, 0);
  }
}
#else
void float_arrays_iterate(float_arrays *f) { (void)f; }
#endif
