/* SPDX-License-Identifier: Apache-2.0 */
/* snap_balance.h has the contract. Energies are those of the triangles around the vertex that moves and
 * around the tip, before any of it happens, and what the shared out masses add to that of motion:
 *
 *   of stress   area T (U - 1), Q70 N/m lu^2: with the gain of membrane_gains.c it comes to the other's unit
 *   of motion   mass v^2, Q30 lu^2 and Q56; both without their 32 lowest bits
 *
 * A side of the edge moves along its force, by a share of force / stiffness. The stiffness is the sum of
 * area c r^2 over its triangles, no less than the true one of a small strain: so a share of 1 still gains. */
#include "rt/membrane/snap_balance.h"

#include "rt/base/wide.h"
#include "rt/membrane/membrane.h"
#include "rt/state/corotational.h"
#include "rt/state/deformation.h"

#if FRAY_CRACKS

enum { SMALLEST_SHARE = 5, WAY_BITS = 27 };

/* The rings as they are, or as they will be. */
typedef struct {
  const fray_world *w;
  const trimesh_path *path;
  const trimesh_snap *snap;
  uint32_t edge; /* ring edge of the path that opens: triangles from it on are on the second side */
  int is_moved;
  int32_t half_step; /* of the elastic steps of a substep, Q30 */
  vec3 part[2];
} ring_view;

static trimesh_point rest_of(const ring_view *k, uint32_t p) {
  return k->is_moved && p == k->snap->vertex ? k->snap->at : trimesh_at(&k->w->trimesh, p);
}

static vec64 q28_place(const ring_view *k, uint32_t p) {
  const particle_arrays *a = &k->w->p;
  const vec64 at = {(int64_t)a->x[p] * (1 << FX_SUB_BITS) + a->rx[p],
                    (int64_t)a->y[p] * (1 << FX_SUB_BITS) + a->ry[p],
                    (int64_t)a->z[p] * (1 << FX_SUB_BITS) + a->rz[p]};
  const vec64 moved = {k->snap->place[0], k->snap->place[1], k->snap->place[2]};
  return k->is_moved && p == k->snap->vertex ? moved : at;
}

static vec3 velocity_of(const ring_view *k, uint32_t p) {
  if (particle_is_attached(k->w, p)) return world_body_velocity(k->w, k->w->p.attach_body[p]);
  return k->is_moved && p == k->snap->vertex ? vec_of(k->snap->velocity) : world_velocity(k->w, p);
}

static vec64 place_of(const ring_view *k, uint32_t p, uint32_t side) {
  const vec64 at = q28_place(k, p);
  const vec3 v = velocity_of(k, p);
  const vec3 by = p == k->path->vertex ? k->part[side] : vec_make(0, 0, 0);
  const vec64 place = {at.x + by.x - fx_mul_round(v.x, k->half_step, 30),
                       at.y + by.y - fx_mul_round(v.y, k->half_step, 30),
                       at.z + by.z - fx_mul_round(v.z, k->half_step, 30)};
  return place;
}

static vec3 edge_between(const ring_view *k, uint32_t from, uint32_t to, uint32_t side) {
  const vec64 a = place_of(k, from, side);
  const vec64 b = place_of(k, to, side);
  const vec64 edge = {b.x - a.x, b.y - a.y, b.z - a.z};
  return vec_clamp64(edge, DEFORMATION_REACH * (1 << FX_SUB_BITS) - 1);
}

typedef struct {
  trimesh_weights weights;
  deformation form;
  material_tensor stress, counted;
  const int32_t *c;
  int32_t area; /* of what stiffness it keeps */
} stressed_triangle;

static stressed_triangle stressed_of(const ring_view *k, uint32_t t, uint32_t area, uint32_t side) {
  const trimesh *s = &k->w->trimesh;
  const index_t *v = s->triangle[t].v;
  stressed_triangle f;
  f.weights = trimesh_weights_between(rest_of(k, v[0]), rest_of(k, v[1]), rest_of(k, v[2]));
  f.form = deformation_from_edges(edge_between(k, v[0], v[1], side), edge_between(k, v[0], v[2], side),
                                  &f.weights, STRAIN_BITS);
  f.c = k->w->membrane.materials[s->material[t]].stretch[0];
  f.area = fx_mul_round((int32_t)area, membrane_softening_of(k->w, &f.weights), 30);
  f.stress = corotational_stress(f.c, material_strain(f.form.u, f.form.v), &f.counted);
  return f;
}

static wide_number energy_of(const stressed_triangle *f) {
  const material_tensor e = f->counted;
  const material_tensor tension = material_stress(f->c, e);
  const int64_t twice = fx_add64(fx_add64(fx_mul_wide(tension.uu, e.uu), fx_mul_wide(tension.vv, e.vv)),
                                 fx_mul_wide(tension.uv, e.uv));
  return wide_product(twice, f->area, 60);
}

/* Of triangle n around the vertex that moves: two of them are at the tip too, on both sides of the edge. */
static wide_number moved_energy(const ring_view *k, uint32_t n) {
  const uint32_t t = k->snap->ring.triangle[n];
  const uint32_t side = k->edge < k->path->ring.count && t == k->path->ring.triangle[k->edge];
  const uint32_t area = k->is_moved ? k->snap->area[n] : k->w->trimesh.area[t];
  const stressed_triangle f = stressed_of(k, t, area, side);
  return energy_of(&f);
}

/* Of triangle n around the tip. */
static uint32_t area_at_tip(const ring_view *k, uint32_t t) {
  if (k->is_moved)
    for (uint32_t n = 0; n < k->snap->ring.count; ++n)
      if (k->snap->ring.triangle[n] == t) return k->snap->area[n];
  return k->w->trimesh.area[t];
}

static wide_number stress_energy(const ring_view *k) {
  const membrane_params *c = k->w->membrane.constants;
  wide_number sum = {0, 0};
  for (uint32_t n = 0; n < k->snap->ring.count; ++n) sum = wide_add(sum, moved_energy(k, n));
  for (uint32_t n = 0; n < k->path->ring.count; ++n) {
    const uint32_t t = k->path->ring.triangle[n];
    if (trimesh_corner(&k->w->trimesh, t, k->snap->vertex) < 3) continue;
    const stressed_triangle f = stressed_of(k, t, k->w->trimesh.area[t], n >= k->edge);
    sum = wide_add(sum, energy_of(&f));
  }
  const wide_number impulses = wide_times(sum, (int64_t)c->steps * c->force_gain, (unsigned)c->force_shift);
  return wide_times(impulses, c->mass_unit, 4);
}

static wide_number motion_gained(const ring_view *k) {
  const trimesh *s = &k->w->trimesh;
  const trimesh_snap *snap = k->snap;
  const int64_t mass = s->mass[snap->vertex];
  const int64_t now = (int64_t)vec_squared(vec_of(snap->velocity));
  const int64_t before = (int64_t)vec_squared(world_velocity(k->w, snap->vertex));
  wide_number sum = wide_sub(wide_product(now, mass, 32), wide_product(before, mass, 32));
  for (uint32_t n = 0; n < snap->ring.count; ++n) {
    const vec3 v = world_velocity(k->w, trimesh_ring_end(s, &snap->ring, n));
    sum = wide_add(sum, wide_product((int64_t)vec_squared(v), trimesh_snap_mass_gained(s, snap, n), 32));
  }
  return sum;
}

/* ---- how the sides part ---- */

typedef struct {
  wide_number force[3], stiffness;
} side_pull;

static void add_pull(const ring_view *k, uint32_t t, const stressed_triangle *f, side_pull *pull) {
  const uint32_t corner = trimesh_corner(&k->w->trimesh, t, k->path->vertex);
  const trimesh_weights *r = &f->weights;
  const int32_t ru = corner == 0 ? -fx_add(r->u1, r->u2) : corner == 1 ? r->u1 : r->u2;
  const int32_t rv = corner == 0 ? -fx_add(r->v1, r->v2) : corner == 1 ? r->v1 : r->v2;
  const int32_t u[3] = {f->form.u.x, f->form.u.y, f->form.u.z};
  const int32_t v[3] = {f->form.v.x, f->form.v.y, f->form.v.z};
  const int32_t square = (int32_t)((fx_square(ru) + fx_square(rv)) >> 33);
  for (uint32_t n = 0; n < 3; ++n) {
    const int32_t pu = material_round(fx_mul_wide(f->stress.uu, u[n]) + fx_mul_wide(f->stress.uv, v[n]));
    const int32_t pv = material_round(fx_mul_wide(f->stress.uv, u[n]) + fx_mul_wide(f->stress.vv, v[n]));
    const int64_t force = fx_asr64(fx_mul_wide(pu, ru), 1) + fx_asr64(fx_mul_wide(pv, rv), 1);
    pull->force[n] = wide_sub(pull->force[n], wide_product(force, f->area, 65)); /* N/m lu, less 2 bits */
  }
  pull->stiffness = wide_add(pull->stiffness, wide_product(fx_mul_wide(square, f->c[0]), f->area, 55));
}

/* Their quotient, Q28, held below 1/2. */
static int32_t way_of(wide_number force, wide_number stiffness) {
  const int is_back = wide_is_negative(force);
  wide_number rest = wide_shift_up(is_back ? wide_negated(force) : force, STRAIN_BITS);
  int32_t way = 0;
  for (uint32_t n = WAY_BITS; n > 0; --n) {
    const wide_number less = wide_sub(rest, wide_shift_up(stiffness, n - 1u));
    if (wide_is_negative(less)) continue;
    rest = less;
    way += 1 << (n - 1u);
  }
  return is_back ? -way : way;
}

static snap_parting whole_parting(const ring_view *k) {
  const wide_number none = {0, 0};
  snap_parting parting;
  side_pull pull[2] = {{{none, none, none}, none}, {{none, none, none}, none}};
  for (uint32_t n = 0; n < k->path->ring.count; ++n) {
    const uint32_t t = k->path->ring.triangle[n];
    const stressed_triangle f = stressed_of(k, t, area_at_tip(k, t), n >= k->edge);
    add_pull(k, t, &f, &pull[n >= k->edge]);
  }
  for (uint32_t n = 0; n < 2; ++n)
    parting.side[n] = vec_make(way_of(pull[n].force[0], pull[n].stiffness),
                               way_of(pull[n].force[1], pull[n].stiffness),
                               way_of(pull[n].force[2], pull[n].stiffness));
  return parting;
}

static vec3 share_of(vec3 whole, unsigned bits) {
  return vec_make(fx_asr(whole.x, bits), fx_asr(whole.y, bits), fx_asr(whole.z, bits));
}

int snap_balance(const fray_world *w, const trimesh_path *path, const trimesh_snap *snap,
                 snap_parting *parting) {
  const vec3 none = {0, 0, 0};
  ring_view k = {w, path, snap, path->n + (snap->vertex == path->end[0] ? 0u : 1u), 0,
                 (int32_t)fx_divide_wide(1u << 29, (uint32_t)w->membrane.constants->steps), {none, none}};
  FRAY_ASSERT(snap->ring.closed != 0 && world_is_corotational(w));
  const wide_number allowed = wide_sub(stress_energy(&k), motion_gained(&k));
  parting->side[0] = parting->side[1] = none;
  k.is_moved = 1;
  if (!wide_is_negative(wide_sub(allowed, stress_energy(&k)))) return 1;
  if (path->ring.closed != 0) return 0; /* one vertex stays at both sides */
  const snap_parting whole = whole_parting(&k);
  for (unsigned bits = SMALLEST_SHARE + 1u; bits > 0; --bits) {
    for (uint32_t n = 0; n < 2; ++n) parting->side[n] = k.part[n] = share_of(whole.side[n], bits - 1u);
    if (!wide_is_negative(wide_sub(allowed, stress_energy(&k)))) return 1;
  }
  return 0;
}

static int32_t part_axis(int32_t *x, int8_t *r, uint32_t p, int32_t by) {
  const int64_t fine = (int64_t)x[p] * (1 << FX_SUB_BITS) + r[p] + by;
  const int32_t to = fx_clamp_wide(fx_round64(fine, FX_SUB_BITS), FX_EDGE_MAX);
  const int32_t moved = fx_sub(to, x[p]);
  x[p] = to;
  r[p] = (int8_t)fx_clamp64(fine - (int64_t)to * (1 << FX_SUB_BITS), -8, 8);
  return moved;
}

static void part_vertex(fray_world *w, uint32_t p, vec3 by) {
  const int32_t x = part_axis(w->p.x, w->p.rx, p, by.x);
  const int32_t y = part_axis(w->p.y, w->p.ry, p, by.y);
  const int32_t z = part_axis(w->p.z, w->p.rz, p, by.z);
  world_shift_predicted(w, p, vec_make(x, y, z));
}

void snap_part(fray_world *w, uint32_t vertex, uint32_t added, const snap_parting *parting) {
  FRAY_ASSERT(vertex < w->p.count && added < w->p.count);
  part_vertex(w, vertex, parting->side[0]);
  part_vertex(w, added, parting->side[1]);
}

#endif
