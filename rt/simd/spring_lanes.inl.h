/* SPDX-License-Identifier: Apache-2.0 */
/* Springs of a batch, LANES at a time. Included after the lanes of an instruction set.
 *
 * Where the ends of consecutive springs are consecutive particles, a run, plain loads and stores serve; a
 * group of LANES springs with more than SPRING_LANES_RUNS_MAX runs is gathered. Springs of a batch share no
 * particle, so the grouping changes no result. Dead springs, and elements outside of the batch, are neither
 * read nor written.
 *
 * The chain of operations of a spring is longer than the window of a processor. So where up to LANES_GROUPS
 * groups of one kind follow, each one run, all of them do the first part of the chain, then all do the next
 * one. */
#ifndef FRAY_SIMD_SPRING_LANES_INL_H
#define FRAY_SIMD_SPRING_LANES_INL_H

#include "rt/state/spring.h"

#ifndef LANES_UNROLL_3
#define LANES_UNROLL_3
#endif

#ifndef LANES_RUNS_MAX
#define LANES_RUNS_MAX LANES_RUNS_UNROLLED
#endif

/* How a group accesses its particles: SPRING_LANES_ONE_RUN in all lanes, 1..SPRING_LANES_RUNS_MAX runs,
 * SPRING_LANES_GATHERED, or SPRING_LANES_HALVES: two runs of LANES / 2. */
enum {
  SPRING_LANES_RUNS_MAX = LANES_RUNS_MAX,
  SPRING_LANES_ONE_RUN = 0,
  SPRING_LANES_GATHERED = SPRING_LANES_RUNS_MAX + 1,
  SPRING_LANES_HALVES
};

/* A run: lane n is element from + n of an array. */
typedef struct {
  intptr_t from;
  lane_mask used;
  uint32_t first, count; /* its lanes; count is 0 if it has all lanes, or a dead one */
} lane_run;

typedef struct {
  int access;
  int one_class;
  int any_half_mass; /* in groups of mixed kinds */
  uint32_t kind;     /* if one_class */
  lane_run run_i[SPRING_LANES_RUNS_MAX], run_j[SPRING_LANES_RUNS_MAX];
  /* of gathered groups; unused lanes repeat a spring of the group, and write the same words */
  uint32_t i[LANES], j[LANES], kinds[LANES];
} spring_lanes;

FX_WRAPS LANES_INLINE const int32_t *lane_run_word(const int32_t *words, intptr_t n) {
  return (const int32_t *)((uintptr_t)words + (uintptr_t)n * sizeof *words);
}

LANES_INLINE const int32_t *lane_run_begin(const int32_t *words, const lane_run *run) {
  return lane_run_word(words, run->from + (intptr_t)run->first);
}

LANES_INLINE lanes spring_lanes_load(const spring_lanes *p, const int32_t *from, const lane_run *run,
                                     const uint32_t at[LANES]) {
  if (p->access == SPRING_LANES_ONE_RUN) return lanes_load(from + run->from);
  if (p->access == SPRING_LANES_GATHERED) return lanes_gather(from, at);
#ifdef LANES_HAVE_HALVES
  if (p->access == SPRING_LANES_HALVES)
    return lanes_load_halves(lane_run_begin(from, &run[0]), lane_run_begin(from, &run[1]));
#endif
  lanes v = lanes_load_masked(lanes_set(0), lane_run_word(from, run[0].from), run[0].used);
  for (int n = 1; n < p->access; ++n)
    v = lanes_load_masked(v, lane_run_word(from, run[n].from), run[n].used);
  return v;
}
LANES_INLINE lanes spring_lanes_load_i(const spring_lanes *p, const int32_t *from) {
  return spring_lanes_load(p, from, p->run_i, p->i);
}
LANES_INLINE lanes spring_lanes_load_j(const spring_lanes *p, const int32_t *from) {
  return spring_lanes_load(p, from, p->run_j, p->j);
}

LANES_INLINE void lanes_scatter(int32_t *to, const uint32_t at[LANES], lanes v) {
  int32_t words[LANES];
  lanes_store(words, v);
  for (int n = 0; n < LANES; ++n) to[at[n]] = words[n];
}
LANES_INLINE void lane_run_store(int32_t *to, const lane_run *run, lanes v) {
#ifdef LANES_HAVE_STORE_RUN
  if (run->count != 0) {
    lanes_store_run((int32_t *)lane_run_begin(to, run), run->first, run->count, v);
    return;
  }
#endif
  lanes_store_masked((int32_t *)lane_run_word(to, run->from), run->used, v);
}
LANES_INLINE void spring_lanes_store(const spring_lanes *p, int32_t *to, const lane_run *run,
                                     const uint32_t at[LANES], lanes v) {
  if (p->access == SPRING_LANES_ONE_RUN)
    lanes_store(to + run->from, v);
  else if (p->access == SPRING_LANES_GATHERED)
    lanes_scatter(to, at, v);
#ifdef LANES_HAVE_HALVES
  else if (p->access == SPRING_LANES_HALVES)
    lanes_store_halves((int32_t *)lane_run_begin(to, &run[0]), (int32_t *)lane_run_begin(to, &run[1]), v);
#endif
  else
    for (int n = 0; n < p->access; ++n) lane_run_store(to, &run[n], v);
}
LANES_INLINE void spring_lanes_store_i(const spring_lanes *p, int32_t *to, lanes v) {
  spring_lanes_store(p, to, p->run_i, p->i, v);
}
LANES_INLINE void spring_lanes_store_j(const spring_lanes *p, int32_t *to, lanes v) {
  spring_lanes_store(p, to, p->run_j, p->j, v);
}

/* One word of each spring's class; `words` is that of class 0. */
LANES_INLINE lanes spring_lanes_class(const spring_lanes *p, const int32_t *words, uint32_t words_a_class) {
  if (p->one_class) return lanes_set(words[(p->kind & SPRING_CLASS) * words_a_class]);
  uint32_t at[LANES];
  for (int n = 0; n < LANES; ++n) at[n] = (p->kinds[n] & SPRING_CLASS) * words_a_class;
  return lanes_gather(words, at);
}

/* Whether any spring has an end of half mass. */
LANES_INLINE int spring_lanes_any_half_mass(const spring_lanes *p) {
  return p->one_class ? (p->kind & SPRING_HALF_MASS) != 0 : p->any_half_mass;
}
/* The springs whose kind has this bit, in a group of mixed kinds. */
LANES_INLINE lane_mask spring_lanes_with(const spring_lanes *p, uint32_t bit) {
  const lanes kinds = lanes_load((const int32_t *)p->kinds);
  return lanes_negative(lanes_shl(kinds, (unsigned)__builtin_clz(bit)));
}
/* v, doubled where this end has half mass. `up`: SPRING_HALF_I or SPRING_HALF_J. */
LANES_INLINE lanes spring_lanes_by_mass(const spring_lanes *p, lanes v, uint32_t up) {
  if (p->one_class) return (p->kind & up) != 0 ? lanes_add(v, v) : v;
  return lanes_add(v, lanes_or_zero(spring_lanes_with(p, up), v));
}

/* fx_round(v, s), `half` = 2^(s - 1). */
LANES_INLINE lanes lanes_round_with(lanes v, lanes half, unsigned s) {
  return lanes_asr(lanes_add(v, lanes_add(lanes_sign(v), half)), s);
}
LANES_INLINE lanes lanes_round(lanes v, unsigned s) {
  return lanes_round_with(v, lanes_set((int32_t)1 << (s - 1)), s);
}
LANES_INLINE lanes lanes_clamp(lanes v, int32_t bound) {
  return lanes_max(lanes_min(v, lanes_set(bound)), lanes_set(-bound));
}
LANES_INLINE lanes lanes_dot(const lanes a[3], const lanes b[3]) {
  return lanes_add(lanes_add(lanes_mul(a[0], b[0]), lanes_mul(a[1], b[1])), lanes_mul(a[2], b[2]));
}

typedef struct {
  const index_t *i, *j;
  const uint8_t *kind;
} spring_rows;

typedef void spring_lanes_kernel(const void *view, const spring_lanes *p);

/* One call of the kernel for each number of runs, so that it is a constant in each. */
LANES_INLINE void spring_lanes_call(spring_lanes *runs_of, int runs, int one_class,
                                    spring_lanes_kernel *take, const void *view) {
#if LANES_RUNS_MAX > 1
  if (!one_class) {
    runs_of->one_class = 0;
    switch (runs) {
      case 1: runs_of->access = 1; take(view, runs_of); break;
      case 2: runs_of->access = 2; take(view, runs_of); break;
      default: runs_of->access = runs; take(view, runs_of); break;
    }
    return;
  }
#else
  (void)one_class;
#endif
#ifdef LANES_HAVE_HALVES
  if (runs == 2 && runs_of->run_i[0].count == LANES / 2 && runs_of->run_i[1].count == LANES / 2) {
    runs_of->access = SPRING_LANES_HALVES;
    take(view, runs_of);
    return;
  }
#endif
  switch (runs) {
    case 1: runs_of->access = 1; take(view, runs_of); break;
#if LANES_RUNS_UNROLLED == 4
    case 2: runs_of->access = 2; take(view, runs_of); break;
    case 3: runs_of->access = 3; take(view, runs_of); break;
    case 4: runs_of->access = 4; take(view, runs_of); break;
#if LANES_RUNS_MAX > 4
    default: runs_of->access = runs; take(view, runs_of); break;
#endif
#endif
  }
}

/* Runs the kernel on `count` springs from `row` on, at most LANES; `whole`: exactly LANES. */
LANES_INLINE void spring_lanes_group(const spring_rows *s, uint32_t row, uint32_t count, int whole,
                                     spring_lanes_kernel *take, const void *view) {
  FRAY_ASSERT(count > 0 && count <= (uint32_t)LANES && (!whole || count == (uint32_t)LANES));
  const index_t *i = s->i + row;
  const index_t *j = s->j + row;
  const uint8_t *kind = s->kind + row;
  spring_lanes p;
  const lanes ids_i = whole ? lanes_load_ids(i) : lanes_load_ids_first(i, count);
  const lanes ids_j = whole ? lanes_load_ids(j) : lanes_load_ids_first(j, count);
  const lanes kinds = whole ? lanes_load_kinds(kind) : lanes_load_kinds_first(kind, count);
  if (whole && *kind != SPRING_DEAD && lanes_are_consecutive(ids_i, *i) &&
      lanes_are_consecutive(ids_j, *j) && lanes_all_equal(kinds, *kind)) {
    p.run_i[0].from = (intptr_t)*i;
    p.run_j[0].from = (intptr_t)*j;
    p.one_class = 1;
    p.kind = *kind;
    p.access = SPRING_LANES_ONE_RUN;
    take(view, &p);
    return;
  }
  const lane_mask used = lanes_greater(kinds, lanes_set(SPRING_DEAD)); /* none beyond count */
  const uint32_t alive = mask_bits(used);
  if (alive == 0) return;
  const uint32_t first = (uint32_t)__builtin_ctz(alive);
  p.kind = kind[first];
  p.one_class = 1;
  const uint32_t others = mask_bits(lanes_not_equal(kinds, lanes_set((int32_t)p.kind))) & alive;
  uint32_t breaks = (lanes_run_starts(ids_i) | lanes_run_starts(ids_j)) & (0xFFFFFFFFu >> (32u - count));
  const int runs_most = SPRING_LANES_RUNS_MAX > 1 || others == 0 ? SPRING_LANES_RUNS_MAX : 0;
  if (others != 0) {
    const lane_mask light = lanes_negative(lanes_shl(kinds, (unsigned)__builtin_clz(SPRING_HALF_MASS)));
    lanes_store((int32_t *)p.kinds, lanes_select(used, kinds, lanes_set((int32_t)p.kind)));
    p.any_half_mass = mask_bits(light) != 0;
  }
  if (__builtin_popcount(breaks) >= runs_most) {
    lanes_store((int32_t *)p.i, lanes_select(used, ids_i, lanes_set((int32_t)i[first])));
    lanes_store((int32_t *)p.j, lanes_select(used, ids_j, lanes_set((int32_t)j[first])));
    p.access = SPRING_LANES_GATHERED;
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
    const lane_mask mask = mask_range(alive, begun, next);
    p.run_i[runs].from = (intptr_t)i[begun] - (intptr_t)begun;
    p.run_j[runs].from = (intptr_t)j[begun] - (intptr_t)begun;
    p.run_i[runs].used = p.run_j[runs].used = mask;
    const uint32_t whole_run = (1u << next) - (1u << begun);
    p.run_i[runs].first = p.run_j[runs].first = begun;
    p.run_i[runs].count = p.run_j[runs].count =
        mask_bits(mask) == whole_run && whole_run != LANES_ALL ? next - begun : 0;
    ++runs;
    if (breaks == 0) break;
    breaks &= breaks - 1u;
    begun = next;
  }
  spring_lanes_call(&p, runs, others == 0, take, view);
}

typedef struct spring_groups spring_groups;
typedef void spring_groups_kernel(const void *view, const spring_groups *m);

#ifdef LANES_GROUPS
/* Groups of springs of one kind with two whole ends: the first particles of each. */
struct spring_groups {
  uint32_t count;
  spring_lanes one; /* common to all: SPRING_LANES_ONE_RUN, one class, the kind */
  index_t i[LANES_GROUPS], j[LANES_GROUPS];
};

LANES_INLINE void spring_groups_find(const spring_rows *s, uint32_t row, uint32_t end, spring_groups *m) {
  const uint32_t kind = s->kind[row];
  m->one.access = SPRING_LANES_ONE_RUN;
  m->one.one_class = 1;
  m->one.kind = kind;
  m->count = 0;
  if (kind == SPRING_DEAD || (kind & SPRING_HALF_MASS) != 0) return;
  for (; m->count < LANES_GROUPS && row + LANES <= end; row += LANES) {
    if (!lanes_are_run(s->i + row, s->j + row, s->kind + row, kind)) return;
    m->i[m->count] = s->i[row];
    m->j[m->count] = s->j[row];
    ++m->count;
  }
}

/* Returns how many springs it took. */
LANES_INLINE uint32_t spring_groups_next(const spring_rows *s, uint32_t row, uint32_t end,
                                         spring_lanes_kernel *take, spring_groups_kernel *many,
                                         const void *view) {
  spring_groups m;
  spring_groups_find(s, row, end, &m);
  if (m.count != 0)
    many(view, &m);
  else
    spring_lanes_group(s, row, LANES, 1, take, view);
  return m.count != 0 ? m.count * LANES : LANES;
}
#else
LANES_INLINE uint32_t spring_groups_next(const spring_rows *s, uint32_t row, uint32_t end,
                                         spring_lanes_kernel *take, spring_groups_kernel *many,
                                         const void *view) {
  (void)end, (void)many;
  spring_lanes_group(s, row, LANES, 1, take, view);
  return LANES;
}
#endif

/* 1 iff no two of the springs taken from `row` on share a particle. */
static inline int spring_lanes_are_apart(const spring_rows *s, uint32_t row, uint32_t end) {
  const uint32_t last = end - row < LANES ? end : row + LANES;
  for (uint32_t a = row; a < last; ++a)
    for (uint32_t b = row; b < a; ++b)
      if (s->kind[a] != SPRING_DEAD && s->kind[b] != SPRING_DEAD &&
          (s->i[a] == s->i[b] || s->i[a] == s->j[b] || s->j[a] == s->i[b] || s->j[a] == s->j[b]))
        return 0;
  return 1;
}

/* Returns the number of springs. */
LANES_INLINE uint32_t spring_lanes_batches(const spring_rows *s, const spring_batch *batches,
                                           uint32_t count, spring_lanes_kernel *take,
                                           spring_groups_kernel *many, const void *view) {
  uint32_t taken = 0;
  for (uint32_t b = 0; b < count; ++b) {
    uint32_t row = (uint32_t)batches[b].first;
    const uint32_t end = row + (uint32_t)batches[b].count;
    taken += end - row;
    while (row + LANES <= end) {
      FRAY_ASSERT(spring_lanes_are_apart(s, row, end));
      row += spring_groups_next(s, row, end, take, many, view);
    }
    FRAY_ASSERT(spring_lanes_are_apart(s, row, end));
    if (row < end) spring_lanes_group(s, row, end - row, 0, take, view);
  }
  return taken;
}

#endif
