/* SPDX-License-Identifier: Apache-2.0 */
/* Tears triangle sheets (Karaoz 2015, sections 2.7, 3.1, 3.2, 3.5): of all lines through all vertices the
 * one whose separation strength is the most, as a share of what the cloth requires in its direction, if
 * it is above that; one in a tick for each cloth, and none for a time after that, in which the stress
 * finds its new balance.
 *
 * The stress is that at the beginning of the tick, and so is the tear: what was overloaded at the end of
 * a tick tears in the next one. Lines that cannot be torn do not take part: a held vertex, a sliver. What is beyond
 * the vertex of a closed fan may go along a side beside the line. */
#include "rt/model/sheet_split.h"
#include "rt/stage/separation.h"
#include "rt/stage/stage.h"

typedef struct {
  uint32_t vertex;
  separation_ratio ratio;
} tear;

/* No less than the largest principal stress. */
static int32_t bound_of(tensor s) {
  const int64_t most = (int64_t)(s.uu > s.vv ? s.uu : s.vv) + fx_magnitude(s.uv);
  return (int32_t)fx_clamp64(most, 0, 2 * SEPARATION_STRESS_MAX);
}

/* What pulls at most at each vertex, in a scratch array. */
static void gather_bounds(fray_world *w) {
  const sheet_mesh *s = &w->sheet;
  inner_sum *most = w->sums;
  for (uint32_t p = 0; p < w->particles; ++p) most[p].x = 0;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t) {
    const int32_t bound = bound_of(w->stress[t]);
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t p = s->triangle[t].v[k];
      most[p].x = fx_max(most[p].x, bound);
    }
  }
}

static direction way(const sheet_mesh *s, uint32_t from, uint32_t to) {
  const direction d = {fx_sub(s->u[to], s->u[from]), fx_sub(s->v[to], s->v[from])};
  return d;
}

static void prepare(const fray_world *w, uint32_t vertex, const sheet_fan *around,
                    separation_fan *f) {
  const sheet_mesh *s = &w->sheet;
  f->count = around->count;
  f->closed = around->closed;
  for (uint32_t n = 0; n < around->count; ++n) {
    const uint32_t t = around->triangle[n];
    const uint32_t k = around->corner[n];
    const sym2 stress = {w->stress[t].uu, w->stress[t].vv, w->stress[t].uv};
    f->spoke[n] = way(s, vertex, s->triangle[t].v[sheet_next(k)]);
    f->spoke[n + 1u] = way(s, vertex, s->triangle[t].v[sheet_last(k)]);
    f->pull[n] = stress;
  }
  separation_prepare(f);
}

/* Where a candidate goes, in the fan that it was found in. */
static sheet_ray ray_of(uint32_t candidate) {
  const sheet_ray ray = {candidate / 2u, candidate % 2u == 0 ? 0 : SHEET_SHARE / 2};
  return ray;
}

/* The other half of a line through a closed fan. */
static sheet_ray opposite_of(const sheet_mesh *s, const sheet_fan *around, uint32_t vertex,
                             const separation_ratio *r) {
  sheet_ray ray = {r->opposite, SHEET_SHARE / 2};
  (void)sheet_ray_along(s, around, sheet_at(s, vertex), -r->line.u, -r->line.v, &ray);
  return ray;
}

static int can_tear(const fray_world *w, uint32_t vertex, const sheet_fan *around,
                    const separation_ratio *r) {
  const sheet_ray from = ray_of(r->candidate);
  const sheet_ray to = opposite_of(&w->sheet, around, vertex, r);
  return sheet_can_split(w, vertex, &from, &to) == SHEET_FITS;
}

/* Takes the best line through a vertex if it is better than `best`. */
static void try_vertex(fray_world *w, uint32_t vertex, const toughness *cloth, tear *best) {
  sheet_fan around;
  separation_fan f;
  sheet_walk(&w->sheet, vertex, &around);
  prepare(w, vertex, &around, &f);
  for (uint32_t n = separation_first(&f); n < separation_end(&f); ++n) {
    const separation_ratio r = separation_ratio_of(&f, n, cloth->strength);
    if (r.separation <= r.required || !separation_exceeds(&r, &best->ratio) ||
        !can_tear(w, vertex, &around, &r))
      continue;
    best->vertex = vertex;
    best->ratio = r;
  }
  w->work.lines += separation_end(&f) - separation_first(&f);
}

/* 1 iff a line through the vertex may be above what is required, and above the best one. */
static int is_promising(const fray_world *w, uint32_t vertex, int32_t least, const tear *best) {
  const int64_t bound = separation_bound(w->sums[vertex].x, !sheet_is_open(&w->sheet, vertex));
  if (bound <= least) return 0;
  return best->vertex == SHEET_NONE ||
         bound * best->ratio.required > fx_mul_wide(best->ratio.separation, least);
}

static void rip(fray_world *w, const tear *best, const toughness *cloth, int32_t *resting) {
  sheet_fan around;
  sheet_walk(&w->sheet, best->vertex, &around);
  const sheet_ray from = ray_of(best->ratio.candidate);
  const sheet_ray to = opposite_of(&w->sheet, &around, best->vertex, &best->ratio);
  const sheet_result result = sheet_split(w, best->vertex, &from, &to, SHEET_TORN);
  if (result == SHEET_NO_PARTICLES) w->state->faults |= (int32_t)FRAY_FAULT_SPARES_FULL;
  if (result == SHEET_NO_TRIANGLES) w->state->faults |= (int32_t)FRAY_FAULT_TRIANGLES_FULL;
  if (result != SHEET_DONE) return;
  if (w->work.cuts == 0) w->cut_first = best->vertex;
  ++w->work.cuts;
  ++w->state->cuts_total;
  *resting = cloth->relax;
}

static void rip_cloth(fray_world *w, uint32_t cloth) {
  const sheet_mesh *s = &w->sheet;
  const toughness *t = &w->toughnesses[cloth];
  const int32_t least = toughness_least(t);
  int32_t *resting = &w->sheet.state->resting[cloth];
  tear best = {SHEET_NONE, {0, 1, 0, 0, {0, 0}}};
  if (least == 0) return;
  if (*resting > 0) {
    --*resting;
    return;
  }
  for (uint32_t p = (uint32_t)w->params->held; p < w->particles; ++p)
    if (s->cloth[s->fan[p]] == cloth && is_promising(w, p, least, &best))
      try_vertex(w, p, t, &best);
  if (best.vertex != SHEET_NONE) rip(w, &best, t, resting);
}

void rip_run(fray_world *w) {
  if (!world_has_sheet(w) || w->params->tearing == 0) return;
  gather_bounds(w);
  for (uint32_t cloth = 0; cloth < (uint32_t)w->sheet.params->cloths; ++cloth) rip_cloth(w, cloth);
  w->work.tear_tests += (uint32_t)w->sheet.state->triangles;
}
