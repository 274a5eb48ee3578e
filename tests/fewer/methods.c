/* SPDX-License-Identifier: Apache-2.0 */
/* Extra rows and chains are computed in double and move whole position steps, equal and opposite,
 * so that momentum is exact and mirror images stay so; the runtime would do it in fixed point. */
#include "tests/fewer/methods.h"

#include <math.h>
#include <stdlib.h>

/* The runtime's own code, under another name. */
#define strain_run strain_as_it_stands
#include "rt/stage/strain.c"
#undef strain_run
void strain_run(fray_world *w);

/* A row over `span` links of one yarn. */
typedef struct {
  uint32_t i, j; /* i < j: held ones come first */
  uint32_t from, span, axis;
  uint32_t turn; /* its place in the order */
  uint32_t dead;
} long_row;

static method now;
static long_row *rows;
static uint32_t row_count;
static uint32_t row_capacity;
static uint32_t built;
static int32_t cuts_seen;
static uint8_t *loud; /* by batch */
static uint32_t *level;

void method_use(const method *m) {
  method_end();
  now = *m;
}

void method_end(void) {
  free(rows);
  free(loud);
  free(level);
  rows = NULL;
  loud = NULL;
  level = NULL;
  row_count = row_capacity = built = 0;
}

static void *grown(void *old, size_t bytes) {
  void *p = realloc(old, bytes);
  if (p == NULL) abort();
  return p;
}

/* ---- extra rows ---- */

static uint32_t step_of(const fray_world *w, uint32_t axis) {
  return axis == 0 ? 1 : (uint32_t)w->params->warps;
}

static uint32_t yarn_length(const fray_world *w, uint32_t axis) {
  return (uint32_t)(axis == 0 ? w->params->warps : w->params->wefts);
}

static uint32_t yarn_start(const fray_world *w, uint32_t axis, uint32_t yarn) {
  return axis == 0 ? yarn * (uint32_t)w->params->warps : yarn;
}

/* The link from a crossing along an axis. */
static uint32_t link_row(const fray_world *w, uint32_t crossing, uint32_t axis) {
  const uint32_t warps = (uint32_t)w->params->warps;
  const uint32_t i = crossing % warps;
  const uint32_t j = crossing / warps;
  return w->row_of[axis == 0 ? j * (warps - 1) + i
                             : (uint32_t)w->params->wefts * (warps - 1) + j * warps + i];
}

static int is_held(const fray_world *w, uint32_t crossing) {
  return w->crossing[crossing] < (uint32_t)w->params->held;
}

static void find_levels(const fray_world *w) {
  const uint32_t warps = (uint32_t)w->params->warps;
  const uint32_t count = warps * (uint32_t)w->params->wefts;
  level = grown(NULL, count * sizeof *level);
  for (uint32_t c = 0; c < count; ++c) level[c] = is_held(w, c) ? 0 : 1u << 20;
  for (int changed = 1; changed;) {
    changed = 0;
    for (uint32_t n = 0; n < 2 * count; ++n) {
      const uint32_t c = n < count ? n : 2 * count - 1 - n;
      uint32_t least = level[c];
      if (c % warps > 0 && level[c - 1] + 1 < least) least = level[c - 1] + 1;
      if (c % warps + 1 < warps && level[c + 1] + 1 < least) least = level[c + 1] + 1;
      if (c >= warps && level[c - warps] + 1 < least) least = level[c - warps] + 1;
      if (c + warps < count && level[c + warps] + 1 < least) least = level[c + warps] + 1;
      changed |= least < level[c];
      level[c] = least;
    }
  }
}

/* Rows of one turn share no particle, so that their order within it means nothing. */
static void add_row(const fray_world *w, uint32_t from, uint32_t span, uint32_t axis,
                    uint32_t group, uint32_t colour) {
  const uint32_t a = from;
  const uint32_t b = from + span * step_of(w, axis);
  if (span < 2 || (is_held(w, a) && is_held(w, b))) return;
  if (row_count == row_capacity) {
    row_capacity = row_capacity == 0 ? 4096 : row_capacity * 2;
    rows = grown(rows, row_capacity * sizeof *rows);
  }
  long_row *r = &rows[row_count++];
  const uint32_t pa = w->crossing[a];
  const uint32_t pb = w->crossing[b];
  const uint32_t near = level[a] < level[b] ? level[a] : level[b];
  r->i = pa < pb ? pa : pb;
  r->j = pa < pb ? pb : pa;
  r->from = from;
  r->span = span;
  r->axis = axis;
  r->dead = 0;
  const uint32_t place = is_held(w, a) || is_held(w, b) ? 0 : near + 1;
  r->turn = ((group * 4096 + (now.inwards != 0 ? 4095 - place : place)) * 2 + axis) * 4 + colour;
}

/* A piece of a yarn in spans of nearly equal length, the same from both ends; `first` is a
 * crossing. A span shorter than its neighbours takes a larger strain, and a link that no span
 * covers the largest. */
static void add_spans(const fray_world *w, uint32_t first, uint32_t links, uint32_t axis,
                      uint32_t stride, uint32_t group) {
  uint32_t spans = (links + stride / 2) / stride;
  if (spans % 2 == 0) spans = spans * stride > links && spans > 0 ? spans - 1 : spans + 1;
  if (links < 2 || links / spans < 2) return;
  const uint32_t short_span = links / spans;
  const uint32_t longer = links % spans;
  const uint32_t middle = spans / 2;
  uint32_t at = 0;
  for (uint32_t k = 0; k < spans; ++k) {
    const uint32_t from_end = k < middle ? k : spans - 1 - k;
    const uint32_t more = k == middle ? longer % 2 : from_end < longer / 2;
    add_row(w, first + at * step_of(w, axis), short_span + more, axis, group,
            k == middle ? 2 : from_end % 2);
    at += short_span + more;
  }
}

/* Held crossings part a yarn. */
static void add_strides(const fray_world *w, uint32_t axis, uint32_t stride, uint32_t group) {
  const uint32_t length = yarn_length(w, axis);
  const uint32_t step = step_of(w, axis);
  for (uint32_t yarn = 0; yarn < yarn_length(w, 1 - axis); ++yarn) {
    const uint32_t start = yarn_start(w, axis, yarn);
    uint32_t begun = 0;
    for (uint32_t n = 1; n < length; ++n) {
      if (n + 1 < length && !is_held(w, start + n * step)) continue;
      add_spans(w, start + begun * step, n - begun, axis, stride, group);
      begun = n;
    }
  }
}

static void add_tethers(const fray_world *w, uint32_t axis) {
  const uint32_t length = yarn_length(w, axis);
  const uint32_t step = step_of(w, axis);
  for (uint32_t yarn = 0; yarn < yarn_length(w, 1 - axis); ++yarn) {
    const uint32_t start = yarn_start(w, axis, yarn);
    for (uint32_t n = 0; n < length; ++n) {
      if (!is_held(w, start + n * step)) continue;
      for (uint32_t k = n + 1; k < length && !is_held(w, start + k * step); ++k)
        if ((k - n) % now.tether == 0) add_row(w, start + n * step, k - n, axis, 0, 0);
      for (uint32_t k = n; k-- > 0 && !is_held(w, start + k * step);)
        if ((n - k) % now.tether == 0) add_row(w, start + k * step, n - k, axis, 0, 1);
    }
  }
}

static int compare_turns(const void *left, const void *right) {
  const long_row *a = left;
  const long_row *b = right;
  if (a->turn != b->turn) return a->turn < b->turn ? -1 : 1;
  return a->from < b->from ? -1 : a->from > b->from;
}

static void build(const fray_world *w) {
  method_end();
  built = 1;
  cuts_seen = 0;
  find_levels(w);
  loud = grown(NULL, (size_t)w->params->link_batches);
  for (uint32_t axis = 0; axis < 2; ++axis) {
    if (now.tether != 0) add_tethers(w, axis);
    for (uint32_t n = 0; n < METHOD_STRIDES && now.strides[n] != 0; ++n)
      add_strides(w, axis, now.strides[n], n + 1);
  }
  if (row_count != 0) qsort(rows, row_count, sizeof *rows, compare_turns);
}

/* A row ends with the first link of its span that is cut. */
static void end_cut_rows(const fray_world *w) {
  cuts_seen = w->state->cuts_total;
  for (uint32_t n = 0; n < row_count; ++n) {
    rows[n].dead = 0;
    for (uint32_t k = 0; k < rows[n].span; ++k) {
      const uint32_t crossing = rows[n].from + k * step_of(w, rows[n].axis);
      rows[n].dead |= w->row_class[link_row(w, crossing, rows[n].axis)] == ROW_DEAD;
    }
  }
}

/* ---- moving ends ---- */

static int32_t steps(double v) { return (int32_t)lrint(v < 0 ? -floor(0.5 - v) : floor(0.5 + v)); }

/* End i gains m, end j loses it; a held end i leaves all of it to j. */
static void move_ends(fray_world *w, uint32_t i, uint32_t j, const double half[3]) {
  const int held = i < (uint32_t)w->params->held;
  int32_t c[3];
  for (uint32_t n = 0; n < 3; ++n) c[n] = steps(held ? 2 * half[n] : half[n]);
  w->x[j] -= c[0];
  w->y[j] -= c[1];
  w->z[j] -= c[2];
  if (held) {
    body_gave(&w->motion[w->grip_body[i]], -(int64_t)c[0] * 16, -(int64_t)c[1] * 16,
              -(int64_t)c[2] * 16);
    return;
  }
  w->x[i] += c[0];
  w->y[i] += c[1];
  w->z[i] += c[2];
}

static double difference(const fray_world *w, uint32_t i, uint32_t j, double d[3]) {
  d[0] = (double)w->x[j] - w->x[i];
  d[1] = (double)w->y[j] - w->y[i];
  d[2] = (double)w->z[j] - w->z[i];
  return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

static void pull_back(fray_world *w, const long_row *r) {
  double d[3];
  if (r->dead) return;
  const double rest = (double)w->links[1 + r->axis].rest * r->span;
  const double length = difference(w, r->i, r->j, d);
  if (length <= rest) return;
  const double share = fmin(1 - rest / length, 0.2) / 2;
  for (uint32_t n = 0; n < 3; ++n) d[n] *= share;
  move_ends(w, r->i, r->j, d);
}

static void run_long_rows(fray_world *w) {
  for (uint32_t r = 0; r < row_count; ++r) pull_back(w, &rows[r]);
  w->work.projections += row_count;
}

/* ---- sweeps ---- */

static void project_relaxed(fray_world *w, uint32_t row) {
  double d[3];
  const uint32_t kind = w->row_class[row];
  if (kind == ROW_DEAD) return;
  const double length = difference(w, w->row_i[row], w->row_j[row], d);
  double share = fmax(fmin(1 - w->links[kind].rest / length, 0.2), -0.33) / 2;
  share *= share > 0 ? now.factor : w->links[kind].push / 4096.0;
  for (uint32_t n = 0; n < 3; ++n) d[n] *= share;
  move_ends(w, w->row_i[row], w->row_j[row], d);
}

/* Whether a projection would move an end by more than `quiet` steps. */
static int is_loud(const fray_world *w, const row_batch *b) {
  const link_view s = {w->x, w->y, w->z, w->row_i, w->row_j, w->row_class, w->links,
                      w->capacity[POOL_LINK_CLASSES]};
  for (int32_t row = b->first; row < b->first + b->count; ++row) {
    const uint32_t kind = w->row_class[row];
    if (kind == ROW_DEAD) continue;
    const vec3 c = correction(&s, w->row_i[row], w->row_j[row], &w->links[kind]);
    const int32_t most = now.quiet * (1 << (20 - LINK_SHIFT));
    if (abs(c.x) > most || abs(c.y) > most || abs(c.z) > most) return 1;
  }
  return 0;
}

static void run_batch(fray_world *w, uint32_t n, uint32_t substep) {
  const link_view view = {w->x, w->y, w->z, w->row_i, w->row_j, w->row_class, w->links,
                      w->capacity[POOL_LINK_CLASSES]};
  const row_batch *b = &w->batches[n];
  const uint32_t first = (uint32_t)b->first;
  const uint32_t end = first + (uint32_t)b->count;
  if (b->held == BATCH_IDLE) return;
  if (now.quiet != 0 && substep == 0) loud[n] = (uint8_t)is_loud(w, b);
  if (now.quiet != 0 && substep != 0 && loud[n] == 0) return;
  w->work.projections += (uint32_t)b->count;
  if (now.factor > 0)
    for (uint32_t row = first; row < end; ++row) project_relaxed(w, row);
  else if (b->held == BATCH_HELD)
    project_held(w, view, first, end);
  else if (!wide_project(w->kernel, view, b, 1))
    project_free(view, first, end);
}

static void sweep(fray_world *w, int inwards, uint32_t substep) {
  const uint32_t batches = (uint32_t)w->params->link_batches;
  for (uint32_t n = 0; n < batches; ++n) run_batch(w, inwards ? batches - 1 - n : n, substep);
}

/* ---- chains ---- */

enum { CHAIN_MAX = 1024, CHAIN_ROUNDS = 3 };
static const double chain_slack = 0.01;

typedef struct {
  uint32_t p[CHAIN_MAX + 1];
  double d[CHAIN_MAX][3]; /* directions */
  double over[CHAIN_MAX];
  double pull[CHAIN_MAX];
  int on[CHAIN_MAX];
} chain;

static double share_of(const fray_world *w, uint32_t p) {
  return p < (uint32_t)w->params->held ? 0 : 1;
}

/* Pulls that take up `over` of all links that are on; Thomas. */
static void solve_chain(const fray_world *w, chain *c, uint32_t links) {
  double pivot[CHAIN_MAX];
  double side[CHAIN_MAX] = {0};
  double right[CHAIN_MAX];
  for (uint32_t k = 0; k < links; ++k) {
    pivot[k] = share_of(w, c->p[k]) + share_of(w, c->p[k + 1]);
    if (pivot[k] == 0) c->on[k] = 0;
    right[k] = c->over[k];
    if (k == 0 || !c->on[k] || !c->on[k - 1]) continue;
    side[k] = -share_of(w, c->p[k]) * (c->d[k][0] * c->d[k - 1][0] + c->d[k][1] * c->d[k - 1][1] +
                                       c->d[k][2] * c->d[k - 1][2]);
    const double gain = side[k] / pivot[k - 1];
    pivot[k] = fmax(pivot[k] - gain * side[k], 1e-6);
    right[k] -= gain * right[k - 1];
  }
  for (uint32_t k = links; k-- > 0;) {
    c->pull[k] = 0;
    if (!c->on[k]) continue;
    const double next = k + 1 < links && c->on[k + 1] ? side[k + 1] * c->pull[k + 1] : 0;
    c->pull[k] = (right[k] - next) / pivot[k];
  }
}

static void run_chain(fray_world *w, uint32_t start, uint32_t axis) {
  static chain c;
  const uint32_t links = yarn_length(w, axis) - 1;
  const uint32_t step = step_of(w, axis);
  const double rest = w->links[1 + axis].rest;
  double push[CHAIN_MAX];
  for (uint32_t k = 0; k <= links; ++k) c.p[k] = w->crossing[start + k * step];
  for (uint32_t k = 0; k < links; ++k) {
    const uint32_t kind = w->row_class[link_row(w, start + k * step, axis)];
    const double length = fmax(difference(w, c.p[k], c.p[k + 1], c.d[k]), 1);
    for (uint32_t n = 0; n < 3; ++n) c.d[k][n] /= length;
    c.over[k] = fmin(length - rest, 0.25 * rest);
    c.on[k] = kind != ROW_DEAD && c.over[k] > -chain_slack * rest;
    push[k] = kind != ROW_DEAD && c.over[k] < 0 ? w->links[kind].push / 4096.0 * c.over[k] : 0;
  }
  for (uint32_t round = 0; round < CHAIN_ROUNDS; ++round) {
    solve_chain(w, &c, links);
    for (uint32_t k = 0; k < links; ++k) c.on[k] &= c.pull[k] > 0;
  }
  for (uint32_t k = 0; k < links; ++k) {
    const double shares = share_of(w, c.p[k]) + share_of(w, c.p[k + 1]);
    if (shares == 0) continue;
    const double pull = c.on[k] ? c.pull[k] : push[k] / shares;
    const int swap = c.p[k] > c.p[k + 1];
    double half[3];
    for (uint32_t n = 0; n < 3; ++n)
      half[n] = (swap ? -pull : pull) * c.d[k][n] / (shares < 2 ? 2 : 1);
    move_ends(w, swap ? c.p[k + 1] : c.p[k], swap ? c.p[k] : c.p[k + 1], half);
  }
  w->work.projections += links * now.chain_cost;
}

static void run_chains(fray_world *w) {
  for (uint32_t axis = 2; axis-- > 0;)
    for (uint32_t yarn = 0; yarn < yarn_length(w, 1 - axis); ++yarn)
      run_chain(w, yarn_start(w, axis, yarn), axis);
}

/* In the place of the runtime's. */
void strain_run(fray_world *w) {
  const uint32_t free_ones = (uint32_t)(w->params->particles - w->params->held);
  const uint32_t substep = w->work.predictions / free_ones - 1;
  if (!built) build(w);
  if (w->state->cuts_total != cuts_seen) end_cut_rows(w);
  for (int32_t n = 0; n < w->params->sweeps; ++n) {
    run_long_rows(w);
    if (now.chains != 0) {
      run_chains(w);
      continue;
    }
    sweep(w, now.order == TURN_ABOUT && substep % 2 == 1, substep);
    if (now.order == THERE_AND_BACK) sweep(w, 1, substep);
  }
}
