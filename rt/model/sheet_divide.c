/* SPDX-License-Identifier: Apache-2.0 */
/* The three things that every tear and cut is made of: a side is opened, a side is divided, a triangle
 * is divided. Every word of the topology that changes is taken out of its hash before, and entered
 * after. */
#include "rt/model/sheet_split.h"

static void flip(fray_world *w, uint64_t entry) {
  w->state->topology[0] ^= (int32_t)(uint32_t)(entry & 0xFFFFFFFFu);
  w->state->topology[1] ^= (int32_t)(uint32_t)(entry >> 32);
}
static void flip_triangle(fray_world *w, uint32_t t) {
  flip(w, sheet_triangle_entry(&w->sheet, t));
}
static void flip_vertex(fray_world *w, uint32_t p) { flip(w, sheet_vertex_entry(&w->sheet, p)); }

static void set_mark(sheet_mesh *s, uint32_t t, uint32_t k, sheet_mark mark) {
  s->mark[t] = (uint8_t)((s->mark[t] & ~(3u << (2u * k))) | (uint32_t)mark << (2u * k));
}

void sheet_part(fray_world *w, uint32_t t, int parted) {
  if (parted == sheet_is_parted(&w->sheet, t)) return;
  flip_triangle(w, t);
  w->sheet.mark[t] ^= SHEET_PARTED;
  flip_triangle(w, t);
}

static void set_fan(fray_world *w, uint32_t vertex, uint32_t t) {
  if (w->sheet.fan[vertex] == t) return;
  flip_vertex(w, vertex);
  w->sheet.fan[vertex] = (row_id)t;
  flip_vertex(w, vertex);
}

static uint32_t next_particle(fray_world *w) {
  ++w->sheet.state->born;
  return w->particles++;
}

/* ---- opening ---- */

static void copy_particle(fray_world *w, uint32_t to, uint32_t from) {
  int32_t *const words[] = {w->x,  w->y,  w->z,  w->qx, w->qy,      w->qz,
                            w->vx, w->vy, w->vz, w->sheet.u, w->sheet.v};
  int8_t *const rests[] = {w->rx, w->ry, w->rz};
  for (uint32_t n = 0; n < sizeof words / sizeof words[0]; ++n) words[n][to] = words[n][from];
  for (uint32_t n = 0; n < 3; ++n) rests[n][to] = rests[n][from];
}

/* The fan of a vertex has fallen into two: what begins with triangle `first` gets a new vertex. */
static void divide_fan(fray_world *w, uint32_t vertex, uint32_t first) {
  sheet_mesh *s = &w->sheet;
  const uint32_t born = next_particle(w);
  copy_particle(w, born, vertex);
  s->fan[born] = (row_id)first;
  uint32_t t = first;
  for (uint32_t steps = 0; steps < SHEET_FAN && t != SHEET_NONE; ++steps) {
    const uint32_t k = sheet_corner(s, t, vertex);
    flip_triangle(w, t);
    s->triangle[t].v[k] = (row_id)born;
    flip_triangle(w, t);
    s->mass[vertex] -= s->area[t];
    s->mass[born] += s->area[t];
    t = sheet_across(s, t, sheet_next(k));
  }
  flip_vertex(w, born);
}

static void open_end(fray_world *w, uint32_t vertex, int was_open, uint32_t first) {
  if (was_open)
    divide_fan(w, vertex, first);
  else
    set_fan(w, vertex, first);
}

static uint32_t spare_particles(const fray_world *w) {
  return w->capacity[POOL_PARTICLES] - w->particles;
}
static uint32_t spare_triangles(const fray_world *w) {
  return w->capacity[POOL_TRIANGLES] - (uint32_t)w->sheet.state->triangles;
}
static int is_held(const fray_world *w, uint32_t p) { return p < (uint32_t)w->params->held; }

sheet_result sheet_open_side(fray_world *w, uint32_t t, uint32_t k, sheet_mark mark) {
  sheet_mesh *s = &w->sheet;
  const uint32_t other = sheet_across(s, t, k);
  if (other == SHEET_NONE) return SHEET_NO_WAY;
  const uint32_t back = sheet_back(s, t, k);
  const uint32_t from = s->triangle[t].v[sheet_next(k)];
  const uint32_t to = s->triangle[t].v[sheet_last(k)];
  const int from_open = sheet_is_open(s, from);
  const int to_open = sheet_is_open(s, to);
  if ((from_open && is_held(w, from)) || (to_open && is_held(w, to))) return SHEET_NO_WAY;
  if (spare_particles(w) < (uint32_t)from_open + (uint32_t)to_open) return SHEET_NO_PARTICLES;
  flip_triangle(w, t);
  flip_triangle(w, other);
  s->triangle[t].across[k] = (row_id)t;
  s->triangle[other].across[back] = (row_id)other;
  set_mark(s, t, k, mark);
  set_mark(s, other, back, mark);
  flip_triangle(w, t);
  flip_triangle(w, other);
  open_end(w, from, from_open, t);
  open_end(w, to, to_open, other);
  return SHEET_DONE;
}

/* ---- dividing ---- */

sheet_point sheet_between(sheet_point a, sheet_point b, uint32_t share) {
  const int32_t f = (int32_t)share;
  const sheet_point p = {fx_add(a.u, (int32_t)fx_round64(fx_mul_wide(fx_sub(b.u, a.u), f), 16)),
                         fx_add(a.v, (int32_t)fx_round64(fx_mul_wide(fx_sub(b.v, a.v), f), 16))};
  return p;
}

typedef struct {
  uint32_t count;
  uint32_t vertex[3];
  uint32_t share[3]; /* Q16 of its place, SHEET_SHARE in all */
  uint32_t mass[3];  /* what the new vertex takes of theirs */
} parents;

/* n / d to the nearest, for d in 1..2^31 and results of 31 bits. */
static int32_t quotient(int64_t n, uint32_t d) {
  const uint64_t size = n < 0 ? (uint64_t)-n : (uint64_t)n;
  const uint32_t q = fx_divide_wide(size + d / 2u, d);
  return n < 0 ? -(int32_t)q : (int32_t)q;
}

/* What rounding leaves over is owed to the next one, so that momentum is exact. */
static int32_t shared_velocity(const int32_t *v, const parents *from, int32_t *owed) {
  int64_t momentum = *owed;
  uint32_t mass = 0;
  for (uint32_t n = 0; n < from->count; ++n) {
    momentum = fx_add64(momentum, fx_mul_wide(v[from->vertex[n]], (int32_t)from->mass[n]));
    mass += from->mass[n];
  }
  const int32_t velocity = quotient(momentum, mass);
  *owed = (int32_t)(momentum - fx_mul_wide(velocity, (int32_t)mass)); /* half the mass at most */
  return velocity;
}

/* The weighted mean of positions and their remainders; in Q28 with 16 bits of shares below 2^51. */
static void shared_position(int32_t *x, int32_t *q, int8_t *r, uint32_t born, const parents *from) {
  int64_t sum = 0;
  int64_t predicted = 0;
  for (uint32_t n = 0; n < from->count; ++n) {
    const uint32_t p = from->vertex[n];
    const int64_t share = from->share[n];
    sum = fx_add64(sum, share * ((int64_t)x[p] * 16 + r[p]));
    predicted = fx_add64(predicted, share * q[p]);
  }
  const int64_t fine = fx_round64(sum, 16);
  x[born] = (int32_t)fx_round64(fine, FX_SUB_BITS);
  r[born] = (int8_t)(fine - (int64_t)x[born] * 16);
  q[born] = (int32_t)fx_round64(predicted, 16);
}

static void give_birth(fray_world *w, uint32_t born, sheet_point at, uint32_t fan,
                       const parents *from) {
  sheet_mesh *s = &w->sheet;
  s->u[born] = at.u;
  s->v[born] = at.v;
  s->fan[born] = (row_id)fan;
  s->mass[born] = 0;
  for (uint32_t n = 0; n < from->count; ++n) {
    s->mass[from->vertex[n]] -= from->mass[n];
    s->mass[born] += from->mass[n];
  }
  w->vx[born] = shared_velocity(w->vx, from, &s->state->owed[0]);
  w->vy[born] = shared_velocity(w->vy, from, &s->state->owed[1]);
  w->vz[born] = shared_velocity(w->vz, from, &s->state->owed[2]);
  shared_position(w->x, w->qx, w->rx, born, from);
  shared_position(w->y, w->qy, w->ry, born, from);
  shared_position(w->z, w->qz, w->rz, born, from);
  flip_vertex(w, born);
}

static int has_room(const sheet_mesh *s, uint32_t vertex) {
  sheet_fan fan;
  sheet_walk(s, vertex, &fan);
  return fan.count < SHEET_FAN;
}

static int parts_are_stout(const sheet_mesh *s, uint32_t t, uint32_t k, sheet_point at) {
  const sheet_triangle *f = &s->triangle[t];
  const sheet_point apex = sheet_at(s, f->v[k]);
  return sheet_is_stout(s, apex, sheet_at(s, f->v[sheet_next(k)]), at) &&
         sheet_is_stout(s, apex, at, sheet_at(s, f->v[sheet_last(k)]));
}

int sheet_can_divide_side(const sheet_mesh *s, uint32_t t, uint32_t k, uint32_t share) {
  const sheet_triangle *f = &s->triangle[t];
  const sheet_point at =
      sheet_between(sheet_at(s, f->v[sheet_next(k)]), sheet_at(s, f->v[sheet_last(k)]), share);
  if (!parts_are_stout(s, t, k, at) || !has_room(s, f->v[k])) return 0;
  const uint32_t other = sheet_across(s, t, k);
  if (other == SHEET_NONE) return 1;
  const uint32_t back = sheet_back(s, t, k);
  return parts_are_stout(s, other, back, at) && has_room(s, s->triangle[other].v[back]);
}

/* Area of the part that keeps its number; the other part has the rest. */
static uint32_t area_of_part(const sheet_mesh *s, uint32_t t, uint32_t a, uint32_t b, uint32_t c) {
  const int64_t twice = sheet_twice_area(sheet_at(s, a), sheet_at(s, b), sheet_at(s, c));
  const int64_t part = fx_round64(twice, 19);
  return (uint32_t)fx_clamp64(part, 1, (int64_t)s->area[t] - 1);
}

/* The triangle across side k of t is told that it is `now` that it sees there. */
static void rejoin(fray_world *w, uint32_t t, uint32_t k, uint32_t now) {
  sheet_mesh *s = &w->sheet;
  const uint32_t other = sheet_across(s, t, k);
  if (other == SHEET_NONE) return;
  const uint32_t back = sheet_back(s, t, k);
  flip_triangle(w, other);
  s->triangle[other].across[back] = (row_id)now;
  flip_triangle(w, other);
}

/* What is known of a triangle holds for a part of it too. */
static void inherit(fray_world *w, uint32_t part, uint32_t t) {
  w->sheet.cloth[part] = w->sheet.cloth[t];
  w->habits[part] = w->habits[t];
  w->stress[part] = w->stress[t];
  w->pull[part] = w->pull[t];
}

/* Triangle t becomes (apex, k + 1, born) at the same places, `part` (apex, born, k + 2). Sides along
 * the one that is divided are left as borders. */
static void divide_along(fray_world *w, uint32_t t, uint32_t k, uint32_t born, uint32_t part) {
  sheet_mesh *s = &w->sheet;
  const uint32_t next = sheet_next(k);
  const uint32_t last = sheet_last(k);
  const uint32_t end = s->triangle[t].v[last];
  const int outer = sheet_across(s, t, next) != SHEET_NONE;
  rejoin(w, t, next, part);
  flip_triangle(w, t);
  s->triangle[part] = s->triangle[t];
  s->mark[part] = s->mark[t];
  inherit(w, part, t);
  s->triangle[part].v[next] = (row_id)born;
  s->triangle[part].across[k] = (row_id)part;
  s->triangle[part].across[last] = (row_id)t;
  if (!outer) s->triangle[part].across[next] = (row_id)part;
  set_mark(s, part, last, SHEET_WHOLE);
  s->triangle[t].v[last] = (row_id)born;
  s->triangle[t].across[k] = (row_id)t;
  s->triangle[t].across[next] = (row_id)part;
  set_mark(s, t, next, SHEET_WHOLE);
  const uint32_t whole = s->area[t];
  s->area[t] = area_of_part(s, t, s->triangle[t].v[k], s->triangle[t].v[next], born);
  s->area[part] = whole - s->area[t];
  s->weights[t] = sheet_weights_of(s, t);
  s->weights[part] = sheet_weights_of(s, part);
  flip_triangle(w, t);
  flip_triangle(w, part);
  if (s->fan[end] == t) set_fan(w, end, part);
}

static void join_across(fray_world *w, uint32_t t, uint32_t k, uint32_t other, uint32_t back) {
  sheet_mesh *s = &w->sheet;
  flip_triangle(w, t);
  flip_triangle(w, other);
  s->triangle[t].across[k] = (row_id)other;
  s->triangle[other].across[back] = (row_id)t;
  flip_triangle(w, t);
  flip_triangle(w, other);
}

sheet_result sheet_divide_side(fray_world *w, uint32_t t, uint32_t k, uint32_t share,
                               uint32_t *born) {
  sheet_mesh *s = &w->sheet;
  const uint32_t other = sheet_across(s, t, k);
  const uint32_t pieces = other == SHEET_NONE ? 1 : 2;
  if (share > SHEET_SHARE || !sheet_can_divide_side(s, t, k, share)) return SHEET_NO_WAY;
  if (spare_particles(w) < 1) return SHEET_NO_PARTICLES;
  if (spare_triangles(w) < pieces) return SHEET_NO_TRIANGLES;
  const uint32_t back = other == SHEET_NONE ? 0 : sheet_back(s, t, k);
  const uint32_t a = s->triangle[t].v[sheet_next(k)];
  const uint32_t b = s->triangle[t].v[sheet_last(k)];
  const uint32_t part = (uint32_t)s->state->triangles;
  const sheet_point at = sheet_between(sheet_at(s, a), sheet_at(s, b), share);
  parents from = {2, {a, b, 0}, {SHEET_SHARE - share, share, 0}, {0, 0, 0}};
  *born = next_particle(w);
  s->u[*born] = at.u;
  s->v[*born] = at.v;
  s->state->triangles += (int32_t)pieces;
  divide_along(w, t, k, *born, part);
  from.mass[0] = s->area[part];
  from.mass[1] = s->area[t];
  if (other != SHEET_NONE) {
    divide_along(w, other, back, *born, part + 1u);
    from.mass[0] += s->area[other];
    from.mass[1] += s->area[part + 1u];
    join_across(w, t, k, part + 1u, back);
    join_across(w, part, k, other, back);
  }
  give_birth(w, *born, at, part, &from);
  return SHEET_DONE;
}

/* ---- a triangle in three ---- */

sheet_point sheet_within(const sheet_mesh *s, uint32_t t, uint32_t share0, uint32_t share1) {
  const sheet_point a = sheet_at(s, s->triangle[t].v[0]);
  const sheet_point b = sheet_at(s, s->triangle[t].v[1]);
  const sheet_point c = sheet_at(s, s->triangle[t].v[2]);
  const int32_t f = (int32_t)share0;
  const int32_t g = (int32_t)share1;
  const int64_t u = fx_add64(fx_mul_wide(fx_sub(a.u, c.u), f), fx_mul_wide(fx_sub(b.u, c.u), g));
  const int64_t v = fx_add64(fx_mul_wide(fx_sub(a.v, c.v), f), fx_mul_wide(fx_sub(b.v, c.v), g));
  const sheet_point p = {fx_add(c.u, (int32_t)fx_round64(u, 16)),
                         fx_add(c.v, (int32_t)fx_round64(v, 16))};
  return p;
}

int sheet_can_divide_triangle(const sheet_mesh *s, uint32_t t, uint32_t share0, uint32_t share1) {
  const sheet_triangle *f = &s->triangle[t];
  const sheet_point at = sheet_within(s, t, share0, share1);
  for (uint32_t k = 0; k < 3; ++k)
    if (!has_room(s, f->v[k]) || !sheet_is_stout(s, at, sheet_at(s, f->v[sheet_next(k)]),
                                                 sheet_at(s, f->v[sheet_last(k)])))
      return 0;
  return 1;
}

/* (0, 1, born) keeps its number; then (born, 1, 2) and (0, born, 2). */
static void divide_in_three(fray_world *w, uint32_t t, uint32_t born, uint32_t part) {
  sheet_mesh *s = &w->sheet;
  const sheet_triangle old = s->triangle[t];
  const uint32_t right = part;
  const uint32_t left = part + 1u;
  rejoin(w, t, 0, right);
  rejoin(w, t, 1, left);
  flip_triangle(w, t);
  const sheet_triangle three[3] = {
      {{old.v[0], old.v[1], (row_id)born}, {(row_id)right, (row_id)left, old.across[2]}},
      {{(row_id)born, old.v[1], old.v[2]},
       {old.across[0] == t ? (row_id)right : old.across[0], (row_id)left, (row_id)t}},
      {{old.v[0], (row_id)born, old.v[2]},
       {(row_id)right, old.across[1] == t ? (row_id)left : old.across[1], (row_id)t}}};
  const uint32_t at[3] = {t, right, left};
  const uint32_t whole = s->area[t];
  const uint32_t mark = s->mark[t];
  for (uint32_t n = 0; n < 3; ++n) {
    s->triangle[at[n]] = three[n];
    if (n != 0) inherit(w, at[n], t);
    /* each has one of the old sides: 2, 0, 1 */
    s->mark[at[n]] = (uint8_t)(mark & 3u << (2u * (n == 0 ? 2u : n - 1u)));
    s->weights[at[n]] = sheet_weights_of(s, at[n]);
  }
  s->area[t] = whole - 1u;
  s->area[t] = area_of_part(s, t, old.v[0], old.v[1], born);
  s->area[right] = whole - s->area[t];
  s->area[right] = area_of_part(s, right, born, old.v[1], old.v[2]);
  s->area[left] = whole - s->area[t] - s->area[right];
  for (uint32_t n = 0; n < 3; ++n) flip_triangle(w, at[n]);
  if (s->fan[old.v[1]] == t) set_fan(w, old.v[1], right);
  if (s->fan[old.v[2]] == t) set_fan(w, old.v[2], left);
}

sheet_result sheet_divide_triangle(fray_world *w, uint32_t t, uint32_t share0, uint32_t share1,
                                   uint32_t *born) {
  sheet_mesh *s = &w->sheet;
  if (share0 > SHEET_SHARE || share1 > SHEET_SHARE - share0 ||
      !sheet_can_divide_triangle(s, t, share0, share1))
    return SHEET_NO_WAY;
  if (spare_particles(w) < 1) return SHEET_NO_PARTICLES;
  if (spare_triangles(w) < 2) return SHEET_NO_TRIANGLES;
  const sheet_triangle old = s->triangle[t];
  const uint32_t part = (uint32_t)s->state->triangles;
  const sheet_point at = sheet_within(s, t, share0, share1);
  *born = next_particle(w);
  s->u[*born] = at.u;
  s->v[*born] = at.v;
  s->state->triangles += 2;
  divide_in_three(w, t, *born, part);
  const parents from = {3,
                        {old.v[0], old.v[1], old.v[2]},
                        {share0, share1, SHEET_SHARE - share0 - share1},
                        {s->area[part], s->area[part + 1u], s->area[t]}};
  give_birth(w, *born, at, t, &from);
  return SHEET_DONE;
}
