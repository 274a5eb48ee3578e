/* SPDX-License-Identifier: Apache-2.0 */
/* Rows of a batch, LANES at a time. Included after the lanes of an instruction set.
 *
 * Where the ends of rows follow one another in memory they go by plain loads and stores, in as many
 * runs as the lanes hold; with more than PAIRS_MORE of them they are gathered. Rows of a batch share
 * no particle, so which of them go together does not matter. Dead rows, and all that lies outside of
 * a batch's rows, are neither read nor written.
 *
 * What a row goes through is one long chain of operations, longer than what a processor looks ahead: it
 * would wait more than it computes. So where LANES_MANY groups of LANES rows of one kind follow, each
 * a run, all of them do the first part of the chain, then all the next one. */
#ifndef FRAY_WIDE_PAIRS_H
#define FRAY_WIDE_PAIRS_H

#include "rt/model/rows.h"

#ifndef LANES_UNROLLED
#define LANES_UNROLLED
#endif

#ifndef LANES_MORE_RUNS
#define LANES_MORE_RUNS LANES_RUNS
#endif

/* Up to PAIRS_RUNS of one class, each number has code of its own; up to PAIRS_MORE there is a loop. */
enum {
  PAIRS_RUNS = LANES_RUNS,
  PAIRS_MORE = LANES_MORE_RUNS,
  PAIRS_WHOLE = 0,
  PAIRS_GATHERED = PAIRS_MORE + 1,
  PAIRS_HALVES
};

/* Where a run of lanes lies: lane n at [from + n]. */
typedef struct {
  intptr_t from;
  lane_mask used;
  uint32_t first, count; /* the lanes; count is 0 where all are, or one in between is not used */
} pairs_run;

typedef struct {
  int way;             /* PAIRS_WHOLE: one run in all lanes; PAIRS_HALVES: two, each in half of them;
                          1..PAIRS_MORE runs; PAIRS_GATHERED */
  int one_class;
  int light;           /* whether a row has a light end; of rows of many kinds */
  uint32_t kind;       /* then */
  pairs_run run_i[PAIRS_MORE], run_j[PAIRS_MORE];
  /* of gathered ones; lanes without a row repeat another one, and write what it writes */
  uint32_t i[LANES], j[LANES], kinds[LANES];
} pairs;

FX_WRAPS LANES_INLINE const int32_t *pairs_at(const int32_t *words, intptr_t n) {
  return (const int32_t *)((uintptr_t)words + (uintptr_t)n * sizeof *words);
}

LANES_INLINE const int32_t *pairs_begin(const int32_t *words, const pairs_run *run) {
  return pairs_at(words, run->from + (intptr_t)run->first);
}

LANES_INLINE lanes pairs_fetch(const pairs *p, const int32_t *from, const pairs_run *run,
                               const uint32_t at[LANES]) {
  if (p->way == PAIRS_WHOLE) return lanes_load(from + run->from);
  if (p->way == PAIRS_GATHERED) return lanes_of(from, at);
#ifdef LANES_HALVES
  if (p->way == PAIRS_HALVES) return lanes_load_halves(pairs_begin(from, &run[0]), pairs_begin(from, &run[1]));
#endif
  lanes v = lanes_load_part(lanes_all(0), pairs_at(from, run[0].from), run[0].used);
  for (int n = 1; n < p->way; ++n)
    v = lanes_load_part(v, pairs_at(from, run[n].from), run[n].used);
  return v;
}
LANES_INLINE lanes pairs_fetch_i(const pairs *p, const int32_t *from) {
  return pairs_fetch(p, from, p->run_i, p->i);
}
LANES_INLINE lanes pairs_fetch_j(const pairs *p, const int32_t *from) {
  return pairs_fetch(p, from, p->run_j, p->j);
}

LANES_INLINE void pairs_scatter(int32_t *to, const uint32_t at[LANES], lanes v) {
  int32_t words[LANES];
  lanes_store(words, v);
  for (int n = 0; n < LANES; ++n) to[at[n]] = words[n];
}
LANES_INLINE void pairs_put_run(int32_t *to, const pairs_run *run, lanes v) {
#ifdef LANES_STORE_RUN
  if (run->count != 0) {
    lanes_store_run((int32_t *)pairs_begin(to, run), run->first, run->count, v);
    return;
  }
#endif
  lanes_store_part((int32_t *)pairs_at(to, run->from), run->used, v);
}
LANES_INLINE void pairs_put(const pairs *p, int32_t *to, const pairs_run *run,
                            const uint32_t at[LANES], lanes v) {
  if (p->way == PAIRS_WHOLE)
    lanes_store(to + run->from, v);
  else if (p->way == PAIRS_GATHERED)
    pairs_scatter(to, at, v);
#ifdef LANES_HALVES
  else if (p->way == PAIRS_HALVES)
    lanes_store_halves((int32_t *)pairs_begin(to, &run[0]), (int32_t *)pairs_begin(to, &run[1]), v);
#endif
  else
    for (int n = 0; n < p->way; ++n) pairs_put_run(to, &run[n], v);
}
LANES_INLINE void pairs_put_i(const pairs *p, int32_t *to, lanes v) {
  pairs_put(p, to, p->run_i, p->i, v);
}
LANES_INLINE void pairs_put_j(const pairs *p, int32_t *to, lanes v) {
  pairs_put(p, to, p->run_j, p->j, v);
}

/* One word of the rows' classes. */
LANES_INLINE lanes pairs_class(const pairs *p, const int32_t *words, uint32_t words_a_class) {
  if (p->one_class) return lanes_all(words[(p->kind & ROW_CLASS) * words_a_class]);
  uint32_t at[LANES];
  for (int n = 0; n < LANES; ++n) at[n] = (p->kinds[n] & ROW_CLASS) * words_a_class;
  return lanes_of(words, at);
}

/* Whether any row has a light end. */
LANES_INLINE int pairs_light(const pairs *p) {
  return p->one_class ? (p->kind & ROW_LIGHT) != 0 : p->light;
}
/* Those whose kind has the bit, of rows of many kinds. */
LANES_INLINE lane_mask pairs_with(const pairs *p, uint32_t bit) {
  const lanes kinds = lanes_load((const int32_t *)p->kinds);
  return lanes_below_zero(lanes_shl(kinds, (unsigned)__builtin_clz(bit)));
}
/* v, doubled where the rows have this end light. `up`: ROW_UP_I or ROW_UP_J. */
LANES_INLINE lanes pairs_weighted(const pairs *p, lanes v, uint32_t up) {
  if (p->one_class) return (p->kind & up) != 0 ? lanes_add(v, v) : v;
  return lanes_add(v, lanes_keep(pairs_with(p, up), v));
}

/* `half` is half of 2^s */
LANES_INLINE lanes lanes_round_with(lanes v, lanes half, unsigned s) {
  return lanes_asr(lanes_add(v, lanes_add(lanes_sign(v), half)), s);
}
LANES_INLINE lanes lanes_round(lanes v, unsigned s) {
  return lanes_round_with(v, lanes_all((int32_t)1 << (s - 1)), s);
}
LANES_INLINE lanes lanes_clamp(lanes v, int32_t bound) {
  return lanes_max(lanes_min(v, lanes_all(bound)), lanes_all(-bound));
}
LANES_INLINE lanes lanes_dot(const lanes a[3], const lanes b[3]) {
  return lanes_add(lanes_add(lanes_mul(a[0], b[0]), lanes_mul(a[1], b[1])), lanes_mul(a[2], b[2]));
}

typedef struct {
  const row_id *i, *j;
  const uint8_t *kind;
} pair_rows;

typedef void pairs_take(const void *view, const pairs *p);

/* One call for each number of runs, so that it is a constant in each. */
LANES_INLINE void pairs_stitched(pairs *runs_of, int runs, int one_class, pairs_take *take,
                                 const void *view) {
#if LANES_MORE_RUNS > 1
  if (!one_class) {
    runs_of->one_class = 0;
    switch (runs) {
      case 1: runs_of->way = 1; take(view, runs_of); break;
      case 2: runs_of->way = 2; take(view, runs_of); break;
      default: runs_of->way = runs; take(view, runs_of); break;
    }
    return;
  }
#else
  (void)one_class;
#endif
#ifdef LANES_HALVES
  if (runs == 2 && runs_of->run_i[0].count == LANES / 2 && runs_of->run_i[1].count == LANES / 2) {
    runs_of->way = PAIRS_HALVES;
    take(view, runs_of);
    return;
  }
#endif
  switch (runs) {
    case 1: runs_of->way = 1; take(view, runs_of); break;
#if LANES_RUNS == 4
    case 2: runs_of->way = 2; take(view, runs_of); break;
    case 3: runs_of->way = 3; take(view, runs_of); break;
    case 4: runs_of->way = 4; take(view, runs_of); break;
#if LANES_MORE_RUNS > 4
    default: runs_of->way = runs; take(view, runs_of); break;
#endif
#endif
  }
}

/* Takes `count` rows from `row` on, at most LANES. */
LANES_INLINE void pairs_some(const pair_rows *s, uint32_t row, uint32_t count, int whole,
                             pairs_take *take, const void *view) {
  const row_id *i = s->i + row;
  const row_id *j = s->j + row;
  const uint8_t *kind = s->kind + row;
  pairs p;
  const lanes ids_i = whole ? lanes_load_ids(i) : lanes_load_ids_part(i, count);
  const lanes ids_j = whole ? lanes_load_ids(j) : lanes_load_ids_part(j, count);
  const lanes kinds = whole ? lanes_load_kinds(kind) : lanes_load_kinds_part(kind, count);
  if (whole && *kind != ROW_DEAD && lanes_count_up(ids_i, *i) && lanes_count_up(ids_j, *j) &&
      lanes_all_equal(kinds, *kind)) {
    p.run_i[0].from = (intptr_t)*i;
    p.run_j[0].from = (intptr_t)*j;
    p.one_class = 1;
    p.kind = *kind;
    p.way = PAIRS_WHOLE;
    take(view, &p);
    return;
  }
  const lane_mask used = lanes_above(kinds, lanes_all(ROW_DEAD)); /* none beyond count */
  const uint32_t alive = lanes_bits(used);
  if (alive == 0) return;
  const uint32_t first = (uint32_t)__builtin_ctz(alive);
  p.kind = kind[first];
  p.one_class = 1;
  const uint32_t others = lanes_bits(lanes_differ(kinds, lanes_all((int32_t)p.kind))) & alive;
  uint32_t breaks =
      (lanes_breaks(ids_i) | lanes_breaks(ids_j)) & (0xFFFFFFFFu >> (32u - count));
  const int runs_most = PAIRS_MORE > 1 || others == 0 ? PAIRS_MORE : 0;
  if (others != 0) {
    const lane_mask light = lanes_below_zero(lanes_shl(kinds, (unsigned)__builtin_clz(ROW_LIGHT)));
    lanes_store((int32_t *)p.kinds, lanes_pick(used, kinds, lanes_all((int32_t)p.kind)));
    p.light = lanes_bits(light) != 0;
  }
  if (__builtin_popcount(breaks) >= runs_most) {
    lanes_store((int32_t *)p.i, lanes_pick(used, ids_i, lanes_all((int32_t)i[first])));
    lanes_store((int32_t *)p.j, lanes_pick(used, ids_j, lanes_all((int32_t)j[first])));
    p.way = PAIRS_GATHERED;
    if (others == 0) {
      take(view, &p);
    } else {
      p.one_class = 0;
      take(view, &p);
    }
    return;
  }
  int runs = 0;
  uint32_t begun = 0;
  for (;;) {
    const uint32_t next = breaks == 0 ? count : (uint32_t)__builtin_ctz(breaks);
    const lane_mask mask = lanes_between(alive, begun, next);
    p.run_i[runs].from = (intptr_t)i[begun] - (intptr_t)begun;
    p.run_j[runs].from = (intptr_t)j[begun] - (intptr_t)begun;
    p.run_i[runs].used = p.run_j[runs].used = mask;
    const uint32_t whole_run = (1u << next) - (1u << begun);
    p.run_i[runs].first = p.run_j[runs].first = begun;
    p.run_i[runs].count = p.run_j[runs].count = lanes_bits(mask) == whole_run && whole_run != LANES_ALL ? next - begun : 0;
    ++runs;
    if (breaks == 0) break;
    breaks &= breaks - 1u;
    begun = next;
  }
  pairs_stitched(&p, runs, others == 0, take, view);
}

typedef struct pairs_many pairs_many;
typedef void pairs_take_many(const void *view, const pairs_many *m);

#ifdef LANES_MANY
/* Groups of rows of one kind without light ends; where their ends begin. */
struct pairs_many {
  uint32_t count;
  pairs one; /* what all have in common: PAIRS_WHOLE, one class, the kind */
  row_id i[LANES_MANY], j[LANES_MANY];
};

LANES_INLINE void pairs_find_many(const pair_rows *s, uint32_t row, uint32_t end, pairs_many *m) {
  const uint32_t kind = s->kind[row];
  m->one.way = PAIRS_WHOLE;
  m->one.one_class = 1;
  m->one.kind = kind;
  m->count = 0;
  if (kind == ROW_DEAD || (kind & ROW_LIGHT) != 0) return;
  for (; m->count < LANES_MANY && row + LANES <= end; row += LANES) {
    if (!lanes_are_run(s->i + row, s->j + row, s->kind + row, kind)) return;
    m->i[m->count] = s->i[row];
    m->j[m->count] = s->j[row];
    ++m->count;
  }
}

/* Returns how many rows it took. */
LANES_INLINE uint32_t pairs_some_many(const pair_rows *s, uint32_t row, uint32_t end,
                                      pairs_take *take, pairs_take_many *many, const void *view) {
  pairs_many m;
  pairs_find_many(s, row, end, &m);
  if (m.count != 0)
    many(view, &m);
  else
    pairs_some(s, row, LANES, 1, take, view);
  return m.count != 0 ? m.count * LANES : LANES;
}
#else
LANES_INLINE uint32_t pairs_some_many(const pair_rows *s, uint32_t row, uint32_t end,
                                      pairs_take *take, pairs_take_many *many, const void *view) {
  (void)end, (void)many;
  pairs_some(s, row, LANES, 1, take, view);
  return LANES;
}
#endif

/* Returns the number of rows. */
LANES_INLINE uint32_t pairs_each(const pair_rows *s, const row_batch *batches, uint32_t count,
                                 pairs_take *take, pairs_take_many *many, const void *view) {
  uint32_t taken = 0;
  for (uint32_t b = 0; b < count; ++b) {
    uint32_t row = (uint32_t)batches[b].first;
    const uint32_t end = row + (uint32_t)batches[b].count;
    taken += end - row;
    while (row + LANES <= end) row += pairs_some_many(s, row, end, take, many, view);
    if (row < end) pairs_some(s, row, end - row, 0, take, view);
  }
  return taken;
}

#endif
