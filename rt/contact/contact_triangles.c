/* SPDX-License-Identifier: Apache-2.0 */
/* Triangles of the membrane against rigid meshes and spheres, after its vertices (Karaoz 2015, section
 * 2.6): points of a mesh against triangles, its edges against their edges; a sphere is its centre against
 * triangles, with its radius added to the thickness. What begins apart stays apart, in three steps:
 *
 *   repulsion   a triangle that comes within the cloth's thickness is pushed out to it, along the way
 *               from the nearest points, with friction; corners move by their weights there, none
 *               farther than the nearest point does. The side is that at the start of the substep.
 *   resolution  a triangle that touches something on its path nevertheless is pinned: its corners keep
 *               their positions relative to the body. That changes the paths of the triangles around it,
 *               so they are tested again, a few times.
 *   the rest    if that does not end, everything near the body is pinned: the paper's rigid group. A path
 *               that is not taken goes nowhere that the old one did not, so what stayed away still does.
 *
 * What exceeds a pool is reported; it is pinned where constraints had room for all that they found
 * (constraints.h), else it passes, as what is more than one query takes does. Attached vertices cannot be
 * pinned: a free body that meets them is stopped (contact_vertices.c); where they draw a triangle through
 * something nevertheless, that is reported. Triangles at a vertex that the body itself holds pass it
 * freely. */
#include "rt/contact/contact_triangles.h"

#include "rt/contact/collider_triangle.h"
#include "rt/contact/constraints.h"

/* A query of one triangle. */
typedef struct {
  const index_t *v;
  collider_triangle_query q; /* its skin is 0 where it only tests */
  int32_t room; /* the part of its skin beyond the thickness */
} contact_query;

/* ---- pinned ---- */

static void pin_corner(fray_world *w, const collider *t, uint32_t p, const ccd_path *path) {
  collider_pin(w, t, p, path);
  w->contact.side_mask[p] |= COLLIDER_PINNED;
}

static int can_move(const fray_world *w, uint32_t p) {
  FRAY_ASSERT(p < w->p.count);
  return p >= particles_attached(w) && (w->contact.side_mask[p] & COLLIDER_PINNED) == 0;
}

static void pin_triangle(fray_world *w, const collider *t, uint32_t triangle) {
  const index_t *v = w->trimesh.triangle[triangle].v;
  for (uint32_t k = 0; k < 3; ++k) {
    if (!can_move(w, v[k])) continue;
    const ccd_path path = collider_path(w, t, v[k]);
    pin_corner(w, t, v[k], &path);
  }
}

static int triangle_can_move(const fray_world *w, uint32_t triangle) {
  FRAY_ASSERT(triangle < triangles_in_use(w));
  const index_t *v = w->trimesh.triangle[triangle].v;
  for (uint32_t k = 0; k < 3; ++k)
    if (can_move(w, v[k])) return 1;
  return 0;
}

/* ---- near triangles ---- */

static int is_near(const fray_world *w, const collider *t, uint32_t triangle) {
  return !collider_misses(w, triangle) && !collider_holds(w, t, triangle) &&
         !collider_passes_triangle(w, t, triangle);
}

/* Lists the triangles near the body; those beyond the budget are pinned. */
static uint32_t list_near(fray_world *w, const collider *t, uint32_t *budget) {
  const uint32_t triangles = triangles_in_use(w);
  uint32_t count = 0;
  for (uint32_t n = 0; n < triangles; ++n) {
    if (!is_near(w, t, n)) continue;
    if (*budget == 0) {
      world_fault(w, FRAY_FAULT_CONTACTS_FULL);
      pin_triangle(w, t, n);
      continue;
    }
    --*budget;
    FRAY_ASSERT(count < triangles);
    w->contact.near_triangles[count++] = (index_t)n;
  }
  return count;
}

/* Edge k is tested with this triangle unless its neighbour there has a lower number and is tested too. */
static uint32_t own_edges_of(const fray_world *w, const collider *t, uint32_t triangle) {
  const trimesh_triangle *s = &w->trimesh.triangle[triangle];
  uint32_t own = 0;
  for (uint32_t k = 0; k < 3; ++k) {
    const uint32_t neighbour = s->neighbour[trimesh_previous(k)];
    if (neighbour >= triangle || collider_holds(w, t, neighbour) || collider_passes_triangle(w, t, neighbour))
      own |= 1u << k;
  }
  return own;
}

/* Returns 0 where the triangle cannot be tested. */
static int begin_query(fray_world *w, const collider *t, uint32_t triangle, int32_t skin, contact_query *f) {
  FRAY_ASSERT(triangle < triangles_in_use(w));
  f->v = w->trimesh.triangle[triangle].v;
  f->room = 0;
  f->q.skin = skin + (skin != 0 ? t->radius : 0);
  for (uint32_t k = 0; k < 3; ++k) f->q.path[k] = collider_path(w, t, f->v[k]);
  f->q.own_edges = own_edges_of(w, t, triangle);
  return collider_triangle_begin(w, t, skin, &f->q);
}

/* ---- constraints ---- */

static vec3 end_at(const contact_query *f, const int32_t weight[3]) {
  return collider_weighted(weight, f->q.path[0].end, f->q.path[1].end, f->q.path[2].end);
}
static vec3 begin_at(const contact_query *f, const int32_t weight[3]) {
  return collider_weighted(weight, f->q.path[0].begin, f->q.path[1].begin, f->q.path[2].begin);
}

static void constrain(fray_world *w, const collider *t, const contact_query *f, const int32_t weight[3],
                      vec3 at, vec3 out) {
  const uint32_t vertex[3] = {f->v[0], f->v[1], f->v[2]};
  const int64_t missing = (int64_t)f->q.skin - vec_dot_unit(vec_sub(end_at(f, weight), at), out);
  const int64_t height = vec_dot_unit(vec_sub(begin_at(f, weight), at), out);
  if (missing <= COLLIDER_DEPTH_MIN) return;
  const constraint_kind kind = t->radius != 0 ? CONSTRAINT_TRIANGLE : CONSTRAINT_FLAT;
  contact_constraint_add(w, t->body, kind, vertex, weight, out, height - (f->q.skin - f->room));
}

/* ---- tests: each finds constraints, or, with skin 0, returns 1 where it touches or may ---- */

static int test_point(fray_world *w, const collider *t, contact_query *f, vec3 at) {
  const ccd_path point = {at, at};
  int32_t weight[3];
  ccd_contact c;
  if (!collider_triangle_take_ccd(w, &f->q)) return 0;
  if (!ccd_point_triangle(&point, f->q.path, f->q.skin, &c)) return 0;
  if (f->q.skin == 0) return 1;
  collider_triangle_weights(&c, weight);
  constrain(w, t, f, weight, at, c.normal);
  return 0;
}

static int test_edge(fray_world *w, const collider *t, contact_query *f, vec3 a, vec3 b) {
  const ccd_path mesh_edge[2] = {{a, a}, {b, b}};
  for (uint32_t k = 0; k < 3; ++k) {
    const ccd_path edge[2] = {f->q.path[k], f->q.path[trimesh_next(k)]};
    int32_t weight[3];
    ccd_contact c;
    if ((f->q.own_edges >> k & 1u) == 0) continue;
    if (f->q.skin == 0 && collider_path_is_point(&edge[0]) && collider_path_is_point(&edge[1])) continue;
    if (!collider_triangle_take_ccd(w, &f->q)) return 0;
    if (!ccd_edges(mesh_edge, edge, f->q.skin, &c)) continue;
    if (f->q.skin == 0) return 1;
    collider_triangle_edge_weights(k, c.weight[1], weight);
    constrain(w, t, f, weight, vec_lerp_q15(a, b, c.weight[0]), c.normal);
  }
  return 0;
}

static int edge_is_near(const collider_box *s, vec3 a, vec3 b) {
  return fx_max(a.x, b.x) >= s->low[0] && fx_min(a.x, b.x) <= s->high[0] && fx_max(a.y, b.y) >= s->low[1] &&
         fx_min(a.y, b.y) <= s->high[1] && fx_max(a.z, b.z) >= s->low[2] && fx_min(a.z, b.z) <= s->high[2];
}

/* Every point and edge of the body near the triangle, each by the one face that owns it. */
static int test_all(fray_world *w, const collider *t, contact_query *f) {
  if (t->radius != 0) return test_point(w, t, f, vec_make(0, 0, 0));
  const collider_box *span = &f->q.span;
  for (uint32_t n = 0; n < f->q.near.count; ++n) {
    const rigid_mesh_face *face = &t->m.faces[f->q.near.face[n]];
    for (uint32_t k = 0; k < 3; ++k) {
      const rigid_mesh_point *p = &t->m.points[face->point[k]];
      const int owns_point = p->face == (int32_t)f->q.near.face[n];
      const int owns_edge = (face->owned_edges >> k & 1) != 0;
      const vec3 a = vec_of(p->at);
      const vec3 b = vec_of(t->m.points[face->point[trimesh_next(k)]].at);
      if (owns_point && collider_contains(span, a) && test_point(w, t, f, a)) return 1;
      if (owns_edge && edge_is_near(span, a, b) && test_edge(w, t, f, a, b)) return 1;
    }
  }
  return 0;
}

void contact_triangles_constrain(fray_world *w, const collider *t, int32_t room, uint32_t *budget) {
  const uint32_t triangles = triangles_in_use(w);
  FRAY_ASSERT(rigid_mesh_meets_triangles(w) && room >= 0);
  for (uint32_t n = 0; n < triangles; ++n) {
    contact_query f;
    if (!is_near(w, t, n) || !triangle_can_move(w, n)) continue;
    if (*budget == 0) {
      contact_constraint_miss(w);
      return;
    }
    --*budget;
    if (!begin_query(w, t, n, collider_skin(w) + room, &f)) continue;
    f.room = room;
    (void)test_all(w, t, &f);
  }
}

/* ---- resolution ---- */

/* The sphere's centre is within `radius` of the triangle where its paths end, or begin: a test at rest. */
static int is_within(const contact_query *f, int at_end, int32_t radius) {
  const ccd_path centre = {{0, 0, 0}, {0, 0, 0}};
  ccd_path still[3];
  ccd_contact c;
  for (uint32_t k = 0; k < 3; ++k) {
    still[k].begin = at_end != 0 ? f->q.path[k].end : f->q.path[k].begin;
    still[k].end = still[k].begin;
  }
  return ccd_point_triangle(&centre, still, radius, &c);
}

/* It ends inside the sphere by more than half the thickness, and did not begin there. */
static int enters_sphere(const fray_world *w, const collider *t, const contact_query *f) {
  const int32_t radius = fx_max(0, t->radius - w->params->thickness / 2);
  return is_within(f, 1, radius) && !is_within(f, 0, radius);
}

static int triangle_crosses(fray_world *w, const collider *t, uint32_t triangle) {
  contact_query f;
  if (!begin_query(w, t, triangle, 0, &f)) return 1;
  if (collider_path_is_point(&f.q.path[0]) && collider_path_is_point(&f.q.path[1]) &&
      collider_path_is_point(&f.q.path[2]))
    return 0;
  return test_all(w, t, &f) || (t->radius != 0 && enters_sphere(w, t, &f));
}

static uint32_t holder_of(const fray_world *w, uint32_t triangle) {
  const index_t *v = w->trimesh.triangle[triangle].v;
  for (uint32_t k = 0; k < 3; ++k)
    if (v[k] < particles_attached(w)) return w->p.attach_body[v[k]];
  return CONTACT_TRIANGLES_FREE;
}

/* Pins near triangles that cross the body, until none does. Returns how many; *holder: the body
 * that holds a triangle which cannot be pinned, else CONTACT_TRIANGLES_FREE. */
static uint32_t pin_crossing(fray_world *w, const collider *t, uint32_t count, uint32_t *holder) {
  uint32_t pinned = 0;
  uint32_t before = 1;
  *holder = CONTACT_TRIANGLES_FREE;
  for (uint32_t round = 0; round < RIGID_MESH_CHECKS && before != pinned; ++round) {
    before = pinned;
    for (uint32_t n = 0; n < count; ++n) {
      const uint32_t triangle = w->contact.near_triangles[n];
      if (!triangle_crosses(w, t, triangle)) continue;
      if (!triangle_can_move(w, triangle)) {
        *holder = holder_of(w, triangle);
        continue;
      }
      pin_triangle(w, t, triangle);
      ++pinned;
    }
  }
  if (before != pinned)
    for (uint32_t n = 0; n < count; ++n) pin_triangle(w, t, w->contact.near_triangles[n]);
  return pinned;
}

uint32_t contact_triangles_check(fray_world *w, const collider *t, uint32_t *budget, uint32_t *holder) {
  FRAY_ASSERT(rigid_mesh_meets_triangles(w));
  return pin_crossing(w, t, list_near(w, t, budget), holder);
}

void contact_triangles_pin(fray_world *w, const collider *t) {
  const uint32_t triangles = triangles_in_use(w);
  const int32_t skin = collider_skin(w);
  FRAY_ASSERT(rigid_mesh_meets_triangles(w));
  for (uint32_t p = 0; p < w->p.count; ++p) {
    const ccd_path path = collider_path(w, t, p);
    w->contact.side_mask[p] = collider_mask_of(w, t, p, &path, skin);
  }
  for (uint32_t n = 0; n < triangles; ++n)
    if (is_near(w, t, n)) pin_triangle(w, t, n);
}
