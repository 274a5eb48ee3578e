/* SPDX-License-Identifier: Apache-2.0 */
/* The three operations that tears and cuts consist of: an edge is opened, an edge is divided, a triangle is
 * divided. The topology's hash is a XOR of entries: toggling one before and after a change keeps it up to
 * date. Areas are divided exactly, and so are masses and momenta: see state/trimesh.h. */
#include "rt/trimesh/trimesh_split.h"

static void toggle_triangle(fray_world *w, uint32_t t) {
  w->membrane.bend_current = 0;
  world_toggle_entry(w, trimesh_triangle_entry(&w->trimesh, t));
}
static void toggle_vertex(fray_world *w, uint32_t p) {
  world_toggle_entry(w, trimesh_vertex_entry(&w->trimesh, p));
}

static void set_mark(trimesh *s, uint32_t t, uint32_t k, trimesh_mark mark) {
  s->edge_marks[t] = (uint8_t)((s->edge_marks[t] & ~(3u << (2u * k))) | (uint32_t)mark << (2u * k));
}

void trimesh_set_passing_blade(fray_world *w, uint32_t t, int passing) {
  FRAY_ASSERT(t < triangles_in_use(w) && (passing == 0 || passing == 1));
  if (passing == trimesh_is_passing_blade(&w->trimesh, t)) return;
  toggle_triangle(w, t);
  w->trimesh.edge_marks[t] ^= TRIMESH_PASSING_BLADE;
  toggle_triangle(w, t);
}

static void set_first_triangle(fray_world *w, uint32_t vertex, uint32_t t) {
  if (w->trimesh.first_triangle[vertex] == t) return;
  toggle_vertex(w, vertex);
  w->trimesh.first_triangle[vertex] = (index_t)t;
  toggle_vertex(w, vertex);
}

/* In ascending order; callers have asked spare_particles(). */
static uint32_t allocate_vertex(fray_world *w, trimesh_point at) {
  FRAY_ASSERT(w->p.count < w->capacity[POOL_PARTICLES]);
  ++w->trimesh.state->allocated;
  w->trimesh.u[w->p.count] = at.u;
  w->trimesh.v[w->p.count] = at.v;
  return w->p.count++;
}

static void set_neighbour(fray_world *w, uint32_t t, uint32_t k, uint32_t now, trimesh_mark mark) {
  toggle_triangle(w, t);
  w->trimesh.triangle[t].neighbour[k] = (index_t)now;
  set_mark(&w->trimesh, t, k, mark);
  toggle_triangle(w, t);
}

/* ---- opening an edge ---- */

static void copy_particle(fray_world *w, uint32_t to, uint32_t from) {
  FRAY_ASSERT(to != from && to < w->p.count && from < w->p.count);
  int32_t *const words[] = {w->p.x,  w->p.y,  w->p.z,  w->p.qx, w->p.qy,
                            w->p.qz, w->p.vx, w->p.vy, w->p.vz};
  int8_t *const remainders[] = {w->p.rx, w->p.ry, w->p.rz};
  for (uint32_t n = 0; n < sizeof words / sizeof words[0]; ++n) words[n][to] = words[n][from];
  for (uint32_t n = 0; n < 3; ++n) remainders[n][to] = remainders[n][from];
}

/* The ring of a vertex has become two: the one that begins with triangle `first` gets a new vertex, at the
 * same place. */
static void split_ring(fray_world *w, uint32_t vertex, uint32_t first) {
  trimesh *s = &w->trimesh;
  FRAY_ASSERT(trimesh_corner(s, first, vertex) < 3);
  const uint32_t added = allocate_vertex(w, trimesh_at(s, vertex));
  copy_particle(w, added, vertex);
  s->first_triangle[added] = (index_t)first;
  uint32_t t = first;
  for (uint32_t steps = 0; steps < TRIMESH_RING_MAX && t != TRIMESH_NONE; ++steps) {
    const uint32_t k = trimesh_corner(s, t, vertex);
    toggle_triangle(w, t);
    s->triangle[t].v[k] = (index_t)added;
    toggle_triangle(w, t);
    s->mass[vertex] -= s->area[t];
    s->mass[added] += s->area[t];
    t = trimesh_neighbour(s, t, trimesh_next(k));
  }
  toggle_vertex(w, added);
  FRAY_ASSERT(s->mass[vertex] > 0 && s->mass[added] > 0);
}

/* One end of an edge that has been opened. */
static void open_vertex(fray_world *w, uint32_t vertex, int was_on_boundary, uint32_t first) {
  if (was_on_boundary)
    split_ring(w, vertex, first);
  else
    set_first_triangle(w, vertex, first);
}

static uint32_t spare_particles(const fray_world *w) {
  FRAY_ASSERT(w->p.count <= w->capacity[POOL_PARTICLES]);
  return w->capacity[POOL_PARTICLES] - w->p.count;
}
static uint32_t spare_triangles(const fray_world *w) {
  FRAY_ASSERT(triangles_in_use(w) <= w->capacity[POOL_TRIANGLES]);
  return w->capacity[POOL_TRIANGLES] - triangles_in_use(w);
}

trimesh_result trimesh_open_edge(fray_world *w, uint32_t t, uint32_t k, trimesh_mark mark) {
  trimesh *s = &w->trimesh;
  const uint32_t other = trimesh_neighbour(s, t, k);
  FRAY_ASSERT(t < triangles_in_use(w) && k < 3);
  if (other == TRIMESH_NONE) return TRIMESH_NO_PATH;
  const uint32_t back = trimesh_neighbour_edge(s, t, k);
  const uint32_t from = s->triangle[t].v[trimesh_next(k)];
  const uint32_t to = s->triangle[t].v[trimesh_previous(k)];
  const int from_on_boundary = trimesh_is_boundary(s, from);
  const int to_on_boundary = trimesh_is_boundary(s, to);
  if ((from_on_boundary && particle_is_attached(w, from)) || (to_on_boundary && particle_is_attached(w, to)))
    return TRIMESH_NO_PATH;
  if (spare_particles(w) < (uint32_t)from_on_boundary + (uint32_t)to_on_boundary) return TRIMESH_NO_PARTICLES;
  set_neighbour(w, t, k, t, mark);
  set_neighbour(w, other, back, other, mark);
  w->membrane.bend_states[t].offset[k] = w->membrane.bend_states[other].offset[back] = 0;
  open_vertex(w, from, from_on_boundary, t);
  open_vertex(w, to, to_on_boundary, other);
  return TRIMESH_DONE;
}

/* ---- dividing an edge ---- */

trimesh_point trimesh_point_on(trimesh_point a, trimesh_point b, uint32_t weight) {
  FRAY_ASSERT(weight <= TRIMESH_WEIGHT_ONE);
  const int32_t f = (int32_t)weight;
  const trimesh_point p = {fx_add(a.u, fx_mul_round(fx_sub(b.u, a.u), f, 16)),
                         fx_add(a.v, fx_mul_round(fx_sub(b.v, a.v), f, 16))};
  return p;
}

typedef struct {
  uint32_t count;
  uint32_t vertex[3];
  uint32_t weight[3]; /* Q16 of its position, TRIMESH_WEIGHT_ONE in all */
  uint32_t mass[3];  /* that the new vertex takes of it */
} parents;

/* n / d to the nearest, for d in 1..2^31 and results of 31 bits. */
static int32_t rounded_quotient(int64_t n, uint32_t d) {
  FRAY_ASSERT(d > 0);
  const uint64_t size = n < 0 ? (uint64_t)-n : (uint64_t)n;
  const uint32_t q = fx_divide_wide(size + d / 2u, d);
  return n < 0 ? -(int32_t)q : (int32_t)q;
}

/* Rounding leaves a remainder, which the next vertex gets, so that momentum is exact. */
static int32_t mean_velocity(const int32_t *v, const parents *from, int32_t *remainder) {
  int64_t momentum = *remainder;
  uint32_t mass = 0;
  for (uint32_t n = 0; n < from->count; ++n) {
    momentum = fx_add64(momentum, fx_mul_wide(v[from->vertex[n]], (int32_t)from->mass[n]));
    mass += from->mass[n];
  }
  FRAY_ASSERT(mass > 0);
  const int32_t velocity = rounded_quotient(momentum, mass);
  *remainder = (int32_t)(momentum - fx_mul_wide(velocity, (int32_t)mass)); /* half the mass at most */
  FRAY_ASSERT(*remainder >= -(1 << 30) && *remainder <= 1 << 30);
  return velocity;
}

/* The weighted mean of positions and their remainders; in Q28 with weights of 16 bits below 2^51. */
static void mean_position(int32_t *x, int32_t *q, int8_t *r, uint32_t added, const parents *from) {
  int64_t sum = 0;
  int64_t predicted = 0;
  for (uint32_t n = 0; n < from->count; ++n) {
    const uint32_t p = from->vertex[n];
    const int64_t weight = from->weight[n];
    sum = fx_add64(sum, weight * ((int64_t)x[p] * 16 + r[p]));
    predicted = fx_add64(predicted, weight * q[p]);
  }
  const int64_t fine = fx_round64(sum, 16);
  x[added] = (int32_t)fx_round64(fine, FX_SUB_BITS);
  r[added] = (int8_t)(fine - (int64_t)x[added] * 16);
  q[added] = (int32_t)fx_round64(predicted, 16);
}

static void add_vertex(fray_world *w, uint32_t added, uint32_t ring, const parents *from) {
  trimesh *s = &w->trimesh;
  s->first_triangle[added] = (index_t)ring;
  s->mass[added] = 0;
  for (uint32_t n = 0; n < from->count; ++n) {
    FRAY_ASSERT(s->mass[from->vertex[n]] > from->mass[n]);
    s->mass[from->vertex[n]] -= from->mass[n];
    s->mass[added] += from->mass[n];
  }
  w->p.vx[added] = mean_velocity(w->p.vx, from, &s->state->momentum_remainder[0]);
  w->p.vy[added] = mean_velocity(w->p.vy, from, &s->state->momentum_remainder[1]);
  w->p.vz[added] = mean_velocity(w->p.vz, from, &s->state->momentum_remainder[2]);
  mean_position(w->p.x, w->p.qx, w->p.rx, added, from);
  mean_position(w->p.y, w->p.qy, w->p.ry, added, from);
  mean_position(w->p.z, w->p.qz, w->p.rz, added, from);
  toggle_vertex(w, added);
}

int trimesh_ring_has_room(const trimesh *s, uint32_t vertex, uint32_t added) {
  trimesh_ring ring;
  trimesh_ring_of(s, vertex, &ring);
  return ring.count + added <= TRIMESH_RING_MAX;
}

int trimesh_parts_exceed(const trimesh *s, uint32_t by, uint32_t t, uint32_t k, trimesh_point at) {
  const trimesh_triangle *f = &s->triangle[t];
  const trimesh_point apex = trimesh_at(s, f->v[k]);
  return trimesh_has_area(s, t) &&
         trimesh_exceeds_quality(s, by, apex, trimesh_at(s, f->v[trimesh_next(k)]), at) &&
         trimesh_exceeds_quality(s, by, apex, at, trimesh_at(s, f->v[trimesh_previous(k)]));
}

int trimesh_can_divide_edge(const trimesh *s, uint32_t t, uint32_t k, uint32_t weight) {
  FRAY_ASSERT(t < (uint32_t)s->state->triangles && k < 3);
  const trimesh_triangle *f = &s->triangle[t];
  const trimesh_point at = trimesh_point_on(trimesh_at(s, f->v[trimesh_next(k)]),
                                            trimesh_at(s, f->v[trimesh_previous(k)]), weight);
  if (!trimesh_parts_exceed(s, 0, t, k, at) || !trimesh_ring_has_room(s, f->v[k], 1)) return 0;
  const uint32_t other = trimesh_neighbour(s, t, k);
  if (other == TRIMESH_NONE) return 1;
  const uint32_t back = trimesh_neighbour_edge(s, t, k);
  return trimesh_parts_exceed(s, 0, other, back, at) &&
         trimesh_ring_has_room(s, s->triangle[other].v[back], 1);
}

/* Area of the part that keeps its number; the other part gets the rest. Half, where an image says less than
 * the rest coordinates do. */
static uint32_t part_area(const trimesh *s, uint32_t t, uint32_t a, uint32_t b, uint32_t c) {
  const int64_t twice = trimesh_twice_area(trimesh_at(s, a), trimesh_at(s, b), trimesh_at(s, c));
  const int64_t part = fx_round64(twice, 19);
  FRAY_ASSERT(s->area[t] >= 2);
  return part > 0 && part < (int64_t)s->area[t] ? (uint32_t)part : s->area[t] / 2u;
}

/* The neighbour at edge k of t gets `now` for its own neighbour there. */
static void relink_neighbour(fray_world *w, uint32_t t, uint32_t k, uint32_t now) {
  trimesh *s = &w->trimesh;
  const uint32_t other = trimesh_neighbour(s, t, k);
  if (other == TRIMESH_NONE) return;
  const uint32_t back = trimesh_neighbour_edge(s, t, k);
  set_neighbour(w, other, back, now, trimesh_mark_of(s, other, back));
}

/* Of a triangle to a part of it: everything but shape and topology. */
static void copy_properties(fray_world *w, uint32_t part, uint32_t t) {
  w->trimesh.material[part] = w->trimesh.material[t];
  w->membrane.stiffness[part] = w->membrane.stiffness[t];
  w->membrane.bend_states[part] = w->membrane.bend_states[t];
  w->membrane.bend_states[part].owed = 0;
  w->membrane.stress[part] = w->membrane.stress[t];
  w->membrane.gains[part] = w->membrane.gains[t];
}

static void update_shape(fray_world *w, uint32_t t) {
  w->trimesh.weights[t] = trimesh_weights_of(&w->trimesh, t);
  w->membrane.bend_shapes[t] = bend_shape_of(&w->trimesh, t);
}

/* Triangle t becomes (apex, k + 1, added) at the same positions, `part` (apex, added, k + 2). Along the
 * divided edge both are left without neighbours. */
static void divide_at_edge(fray_world *w, uint32_t t, uint32_t k, uint32_t added, uint32_t part) {
  trimesh *s = &w->trimesh;
  const uint32_t next = trimesh_next(k);
  const uint32_t last = trimesh_previous(k);
  const uint32_t end = s->triangle[t].v[last];
  const int has_neighbour = trimesh_neighbour(s, t, next) != TRIMESH_NONE;
  relink_neighbour(w, t, next, part);
  toggle_triangle(w, t);
  s->triangle[part] = s->triangle[t];
  s->edge_marks[part] = s->edge_marks[t];
  copy_properties(w, part, t);
  s->triangle[part].v[next] = (index_t)added;
  s->triangle[part].neighbour[k] = (index_t)part;
  s->triangle[part].neighbour[last] = (index_t)t;
  if (!has_neighbour) s->triangle[part].neighbour[next] = (index_t)part;
  set_mark(s, part, last, TRIMESH_WHOLE);
  s->triangle[t].v[last] = (index_t)added;
  s->triangle[t].neighbour[k] = (index_t)t;
  s->triangle[t].neighbour[next] = (index_t)part;
  set_mark(s, t, next, TRIMESH_WHOLE);
  const uint32_t whole = s->area[t];
  s->area[t] = part_area(s, t, s->triangle[t].v[k], s->triangle[t].v[next], added);
  s->area[part] = whole - s->area[t];
  FRAY_ASSERT(s->area[t] > 0 && s->area[part] > 0);
  /* the old sides keep their offsets, which are angles; the new one begins with none */
  w->membrane.bend_states[part].offset[last] = w->membrane.bend_states[t].offset[next] = 0;
  update_shape(w, t);
  update_shape(w, part);
  toggle_triangle(w, t);
  toggle_triangle(w, part);
  if (s->first_triangle[end] == t) set_first_triangle(w, end, part);
}

static void link_neighbours(fray_world *w, uint32_t t, uint32_t k, uint32_t other, uint32_t back) {
  trimesh *s = &w->trimesh;
  FRAY_ASSERT(s->triangle[t].v[trimesh_next(k)] == s->triangle[other].v[trimesh_previous(back)] &&
              s->triangle[t].v[trimesh_previous(k)] == s->triangle[other].v[trimesh_next(back)]);
  set_neighbour(w, t, k, other, trimesh_mark_of(s, t, k));
  set_neighbour(w, other, back, t, trimesh_mark_of(s, other, back));
}

trimesh_result trimesh_divide_edge(fray_world *w, uint32_t t, uint32_t k, uint32_t weight,
                               uint32_t *added) {
  trimesh *s = &w->trimesh;
  FRAY_ASSERT(t < triangles_in_use(w) && k < 3);
  const uint32_t other = trimesh_neighbour(s, t, k);
  const uint32_t pieces = other == TRIMESH_NONE ? 1 : 2;
  if (weight > TRIMESH_WEIGHT_ONE || !trimesh_can_divide_edge(s, t, k, weight)) return TRIMESH_NO_PATH;
  if (spare_particles(w) < 1) return TRIMESH_NO_PARTICLES;
  if (spare_triangles(w) < pieces) return TRIMESH_NO_TRIANGLES;
  const uint32_t back = other == TRIMESH_NONE ? 0 : trimesh_neighbour_edge(s, t, k);
  const uint32_t a = s->triangle[t].v[trimesh_next(k)];
  const uint32_t b = s->triangle[t].v[trimesh_previous(k)];
  const uint32_t part = triangles_in_use(w);
  parents from = {2, {a, b, 0}, {TRIMESH_WEIGHT_ONE - weight, weight, 0}, {0, 0, 0}};
  *added = allocate_vertex(w, trimesh_point_on(trimesh_at(s, a), trimesh_at(s, b), weight));
  s->state->triangles += (int32_t)pieces;
  divide_at_edge(w, t, k, *added, part);
  from.mass[0] = s->area[part];
  from.mass[1] = s->area[t];
  if (other != TRIMESH_NONE) {
    divide_at_edge(w, other, back, *added, part + 1u);
    from.mass[0] += s->area[other];
    from.mass[1] += s->area[part + 1u];
    link_neighbours(w, t, k, part + 1u, back);
    link_neighbours(w, part, k, other, back);
  }
  add_vertex(w, *added, part, &from);
  return TRIMESH_DONE;
}

/* ---- dividing a triangle into three ---- */

trimesh_point trimesh_point_in(const trimesh *s, uint32_t t, uint32_t weight0, uint32_t weight1) {
  FRAY_ASSERT(weight0 <= TRIMESH_WEIGHT_ONE && weight1 <= TRIMESH_WEIGHT_ONE - weight0);
  const trimesh_point a = trimesh_at(s, s->triangle[t].v[0]);
  const trimesh_point b = trimesh_at(s, s->triangle[t].v[1]);
  const trimesh_point c = trimesh_at(s, s->triangle[t].v[2]);
  const int32_t f = (int32_t)weight0;
  const int32_t g = (int32_t)weight1;
  const int64_t u = fx_add64(fx_mul_wide(fx_sub(a.u, c.u), f), fx_mul_wide(fx_sub(b.u, c.u), g));
  const int64_t v = fx_add64(fx_mul_wide(fx_sub(a.v, c.v), f), fx_mul_wide(fx_sub(b.v, c.v), g));
  const trimesh_point p = {fx_add(c.u, (int32_t)fx_round64(u, 16)),
                         fx_add(c.v, (int32_t)fx_round64(v, 16))};
  return p;
}

int trimesh_can_divide_triangle(const trimesh *s, uint32_t t, uint32_t weight0, uint32_t weight1) {
  FRAY_ASSERT(t < (uint32_t)s->state->triangles);
  const trimesh_triangle *f = &s->triangle[t];
  const trimesh_point at = trimesh_point_in(s, t, weight0, weight1);
  if (!trimesh_has_area(s, t)) return 0;
  for (uint32_t k = 0; k < 3; ++k)
    if (!trimesh_ring_has_room(s, f->v[k], 1) ||
        !trimesh_has_quality(s, at, trimesh_at(s, f->v[trimesh_next(k)]),
                             trimesh_at(s, f->v[trimesh_previous(k)])))
      return 0;
  return 1;
}

/* (0, 1, added) keeps its number; then (added, 1, 2) and (0, added, 2). */
static void divide_in_three(fray_world *w, uint32_t t, uint32_t added, uint32_t part) {
  trimesh *s = &w->trimesh;
  const trimesh_triangle old = s->triangle[t];
  const uint32_t right = part;
  const uint32_t left = part + 1u;
  relink_neighbour(w, t, 0, right);
  relink_neighbour(w, t, 1, left);
  toggle_triangle(w, t);
  const trimesh_triangle three[3] = {
      {{old.v[0], old.v[1], (index_t)added}, {(index_t)right, (index_t)left, old.neighbour[2]}},
      {{(index_t)added, old.v[1], old.v[2]},
       {old.neighbour[0] == t ? (index_t)right : old.neighbour[0], (index_t)left, (index_t)t}},
      {{old.v[0], (index_t)added, old.v[2]},
       {(index_t)right, old.neighbour[1] == t ? (index_t)left : old.neighbour[1], (index_t)t}}};
  const uint32_t at[3] = {t, right, left};
  const uint32_t whole = s->area[t];
  const uint32_t mark = s->edge_marks[t];
  const bend_state bent = w->membrane.bend_states[t];
  for (uint32_t n = 0; n < 3; ++n) {
    const uint32_t kept = n == 0 ? 2u : n - 1u; /* each has one of the old edges */
    s->triangle[at[n]] = three[n];
    if (n != 0) copy_properties(w, at[n], t);
    s->edge_marks[at[n]] = (uint8_t)(mark & 3u << (2u * kept));
    for (uint32_t k = 0; k < 3; ++k)
      w->membrane.bend_states[at[n]].offset[k] = k == kept ? bent.offset[k] : 0;
    update_shape(w, at[n]);
  }
  s->area[t] = whole - 1u;
  s->area[t] = part_area(s, t, old.v[0], old.v[1], added);
  s->area[right] = whole - s->area[t];
  s->area[right] = part_area(s, right, added, old.v[1], old.v[2]);
  s->area[left] = whole - s->area[t] - s->area[right];
  FRAY_ASSERT(s->area[t] > 0 && s->area[right] > 0 && s->area[left] > 0 && s->area[left] < whole);
  for (uint32_t n = 0; n < 3; ++n) toggle_triangle(w, at[n]);
  if (s->first_triangle[old.v[1]] == t) set_first_triangle(w, old.v[1], right);
  if (s->first_triangle[old.v[2]] == t) set_first_triangle(w, old.v[2], left);
}

trimesh_result trimesh_divide_triangle(fray_world *w, uint32_t t, uint32_t weight0, uint32_t weight1,
                                   uint32_t *added) {
  trimesh *s = &w->trimesh;
  FRAY_ASSERT(t < triangles_in_use(w));
  if (weight0 > TRIMESH_WEIGHT_ONE || weight1 > TRIMESH_WEIGHT_ONE - weight0 ||
      !trimesh_can_divide_triangle(s, t, weight0, weight1))
    return TRIMESH_NO_PATH;
  if (spare_particles(w) < 1) return TRIMESH_NO_PARTICLES;
  if (spare_triangles(w) < 2) return TRIMESH_NO_TRIANGLES;
  const trimesh_triangle old = s->triangle[t];
  const uint32_t part = triangles_in_use(w);
  *added = allocate_vertex(w, trimesh_point_in(s, t, weight0, weight1));
  s->state->triangles += 2;
  divide_in_three(w, t, *added, part);
  const parents from = {3,
                        {old.v[0], old.v[1], old.v[2]},
                        {weight0, weight1, TRIMESH_WEIGHT_ONE - weight0 - weight1},
                        {s->area[part], s->area[part + 1u], s->area[t]}};
  add_vertex(w, *added, t, &from);
  return TRIMESH_DONE;
}
