/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/bench/float_records.h"

#include <stdlib.h>
#include <string.h>

#include "rt/state/world.h"
#include "tools/bench/float_avx2.h"

enum { LANES = 8, NOBODY = 2 /* particles of padding springs */ };

static void add_row(float_records *f, uint32_t at, uint32_t i, uint32_t j, float reach) {
  f->i[at] = i;
  f->j[at] = j;
  f->reach[at] = reach;
}

static uint32_t take_batch(float_records *f, const fray_world *w, const spring_batch *b, uint32_t at) {
  const int held = b->attached == BATCH_ATTACHED;
  float_batch *batch = &f->batches[f->batch_count++];
  batch->first = at;
  batch->held = held;
  for (uint32_t row = (uint32_t)b->first; row < (uint32_t)(b->first + b->count); ++row) {
    const float rest = (float)w->woven.link_classes[w->woven.spring_kind[row] & SPRING_CLASS].rest * 0x1p-24f;
    if (w->woven.spring_kind[row] == SPRING_DEAD) continue;
    add_row(f, at++, w->woven.spring_i[row], w->woven.spring_j[row], held ? rest : 0.5f * rest);
    ++f->rows;
  }
  while (at % LANES != 0) add_row(f, at++, f->particle_count, f->particle_count + 1, 0.5f);
  batch->end = at;
  return at;
}

int float_records_open(float_records *f, const fray_world *w) {
  const size_t batches = (size_t)w->params->link_batches;
  const size_t room = ((size_t)w->params->links + batches * LANES) / LANES * LANES + LANES;
  memset(f, 0, sizeof *f);
  f->particle_count = w->p.count;
  f->particles = aligned_alloc(16, (f->particle_count + NOBODY) * 4 * sizeof(float));
  f->i = malloc(room * sizeof *f->i);
  f->j = malloc(room * sizeof *f->j);
  f->reach = aligned_alloc(LANES * sizeof(float), room * sizeof(float));
  f->batches = malloc(batches * sizeof *f->batches);
  if (!f->particles || !f->i || !f->j || !f->reach || !f->batches) return 0;
  uint32_t at = 0;
  for (size_t b = 0; b < batches; ++b)
    if (w->woven.batches[b].attached != BATCH_INACTIVE) at = take_batch(f, w, &w->woven.batches[b], at);
  float_records_restore(f, w);
  return 1;
}

void float_records_restore(float_records *f, const fray_world *w) {
  for (uint32_t n = 0; n < f->particle_count; ++n) {
    float *p = f->particles + (size_t)n * 4;
    p[0] = (float)w->p.x[n] * 0x1p-24f;
    p[1] = (float)w->p.y[n] * 0x1p-24f;
    p[2] = (float)w->p.z[n] * 0x1p-24f;
    p[3] = 0;
  }
  for (uint32_t n = 0; n < NOBODY * 4; ++n)
    f->particles[(size_t)f->particle_count * 4 + n] = (float)(n / 4);
}

void float_records_close(float_records *f) {
  free(f->particles);
  free(f->i);
  free(f->j);
  free(f->reach);
  free(f->batches);
}

#if FLOAT_AVX2
int float_avx2_able(void) {
  return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
}

/* Ends of rows k and k + 4 in the two halves of part[k]. */
typedef struct {
  __m256 part[4];
} ends8;

AVX2_INLINE ends8 load_ends(const float *particles, const uint32_t *ids) {
  ends8 e;
  for (int k = 0; k < 4; ++k)
    e.part[k] = _mm256_insertf128_ps(
        _mm256_castps128_ps256(_mm_load_ps(particles + (size_t)ids[k] * 4)),
        _mm_load_ps(particles + (size_t)ids[k + 4] * 4), 1);
  return e;
}

AVX2_INLINE void store_ends(float *particles, const uint32_t *ids, ends8 e) {
  for (int k = 0; k < 4; ++k) {
    _mm_store_ps(particles + (size_t)ids[k] * 4, _mm256_castps256_ps128(e.part[k]));
    _mm_store_ps(particles + (size_t)ids[k + 4] * 4, _mm256_extractf128_ps(e.part[k], 1));
  }
}

AVX2_INLINE __m256 pairs(__m256 a, __m256 b, int high) {
  const __m256d x = _mm256_castps_pd(a);
  const __m256d y = _mm256_castps_pd(b);
  return _mm256_castpd_ps(high ? _mm256_unpackhi_pd(x, y) : _mm256_unpacklo_pd(x, y));
}

AVX2_INLINE float_vec8 transposed(ends8 e) {
  const __m256 xy01 = _mm256_unpacklo_ps(e.part[0], e.part[1]);
  const __m256 xy23 = _mm256_unpacklo_ps(e.part[2], e.part[3]);
  const __m256 z01 = _mm256_unpackhi_ps(e.part[0], e.part[1]);
  const __m256 z23 = _mm256_unpackhi_ps(e.part[2], e.part[3]);
  return (float_vec8){pairs(xy01, xy23, 0), pairs(xy01, xy23, 1), pairs(z01, z23, 0)};
}

AVX2_INLINE void sweep_batch(float_records *f, const float_batch *batch, int held) {
  const __m256 all = _mm256_set1_ps(held ? 1.0f : 0.5f);
  for (uint32_t n = batch->first; n < batch->end; n += LANES) {
    ends8 a = load_ends(f->particles, f->i + n);
    ends8 b = load_ends(f->particles, f->j + n);
    ends8 d;
    for (int k = 0; k < 4; ++k) d.part[k] = _mm256_sub_ps(b.part[k], a.part[k]);
    const __m256 s = float_share(transposed(d), _mm256_load_ps(f->reach + n), all);
    const __m256 of[4] = {_mm256_permute_ps(s, 0x00), _mm256_permute_ps(s, 0x55),
                          _mm256_permute_ps(s, 0xAA), _mm256_permute_ps(s, 0xFF)};
    for (int k = 0; k < 4; ++k) {
      a.part[k] = _mm256_fmadd_ps(of[k], d.part[k], a.part[k]);
      b.part[k] = _mm256_fnmadd_ps(of[k], d.part[k], b.part[k]);
    }
    if (!held) store_ends(f->particles, f->i + n, a);
    store_ends(f->particles, f->j + n, b);
  }
}

AVX2_TARGET void float_records_iterate(float_records *f) {
  for (uint32_t n = 0; n < f->batch_count; ++n)
    if (f->batches[n].held)
      sweep_batch(f, &f->batches[n], 1);
    else
      sweep_batch(f, &f->batches[n], 0);
}
#else
int float_avx2_able(void) { return 0; }
void float_records_iterate(float_records *f) { (void)f; }
#endif
