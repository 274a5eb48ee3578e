/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/picture_source.h"

#include <stdlib.h>
#include <string.h>

#include "rt/state/crossing.h"
#include "rt/state/world.h"

uint32_t picture_springs(uint32_t warps, uint32_t wefts) {
  return warps && wefts ? wefts * (warps - 1) + warps * (wefts - 1) : 0;
}

void picture_source_close(picture_source *s) {
  free(s->crossings);
  free(s->split);
  free(s->half_gap);
  free(s->touching);
  for (int axis = 0; axis < AXES; axis++) free(s->place[axis]);
  free(s->pinned);
  free(s->springs);
  free(s->load);
  free(s->vertices);
  free(s->held);
  free(s->triangles);
  free(s->bodies);
  memset(s, 0, sizeof *s);
}

int picture_source_reserve(picture_source *s, uint32_t warps, uint32_t wefts, uint32_t bodies) {
  if (s->crossings && !s->triangles && s->warps == warps && s->wefts == wefts && s->body_count == bodies)
    return 1;
  picture_source_close(s);
  const size_t crossings = (size_t)warps * wefts, springs = picture_springs(warps, wefts);
  /* One more of each: calloc(0) may return NULL. */
  s->crossings = calloc(crossings + 1, sizeof *s->crossings);
  s->split = calloc(crossings + 1, sizeof *s->split);
  s->half_gap = calloc(crossings + 1, sizeof *s->half_gap);
  s->touching = calloc(crossings + 1, sizeof *s->touching);
  for (int axis = 0; axis < AXES; axis++) s->place[axis] = calloc(crossings + 1, sizeof *s->place[axis]);
  s->pinned = calloc(crossings + 1, sizeof *s->pinned);
  s->springs = calloc(springs + 1, sizeof *s->springs);
  s->load = calloc(springs + 1, sizeof *s->load);
  s->bodies = calloc((size_t)bodies + 1, sizeof *s->bodies);
  if (!s->crossings || !s->split || !s->half_gap || !s->touching || !s->place[AXIS_WEFT] ||
      !s->place[AXIS_WARP] || !s->pinned || !s->springs || !s->load || !s->bodies) {
    picture_source_close(s);
    return 0;
  }
  s->warps = warps;
  s->wefts = wefts;
  s->body_count = bodies;
  return 1;
}

static v3 in_mm(const int32_t *q24, float mm_per_q24) {
  return (v3){(float)q24[0] * mm_per_q24, (float)q24[1] * mm_per_q24, (float)q24[2] * mm_per_q24};
}

static picture_body body_in_mm(const fray_body *b, float mm_per_q24) {
  const float q30 = 1.0f / 1073741824.0f;
  picture_body out = {.shape = b->shape, .motion = b->motion, .hand = b->hand};
  out.radius = (float)b->radius * mm_per_q24;
  out.half = in_mm(b->half, mm_per_q24);
  out.position = in_mm(b->position, mm_per_q24);
  for (int k = 0; k < 3; k++) out.axes[k] = in_mm(b->axes + 3 * k, q30);
  return out;
}

/* The particles of a crossing's weft and warp: one and the same until it splits. */
static void particles_at(const fray_world *world, uint32_t crossing, uint32_t at[AXES]) {
  at[AXIS_WEFT] = fray_yarn_particle(world, crossing, FRAY_WEFT);
  at[AXIS_WARP] = fray_yarn_particle(world, crossing, FRAY_WARP);
}

static void read_crossing(picture_source *s, const fray_world *world, const fray_particles *p,
                          uint32_t crossing, float mm_per_q24) {
  uint32_t n[AXES];
  v3 at[AXES];
  particles_at(world, crossing, n);
  for (int axis = 0; axis < AXES; axis++) {
    if (n[axis] >= p->count) return;
    const int32_t q24[3] = {p->x[n[axis]], p->y[n[axis]], p->z[n[axis]]};
    at[axis] = in_mm(q24, mm_per_q24);
  }
  s->crossings[crossing] = v3_scale(v3_add(at[AXIS_WEFT], at[AXIS_WARP]), 0.5f);
  s->half_gap[crossing] = v3_scale(v3_sub(at[AXIS_WARP], at[AXIS_WEFT]), 0.5f);
  s->split[crossing] = n[AXIS_WEFT] != n[AXIS_WARP];
  const uint32_t holder = n[0] < p->attached ? fray_attached_body(world, n[0]) : UINT32_MAX;
  s->pinned[crossing] = holder < s->body_count && s->bodies[holder].shape == FRAY_ANCHOR;
}

/* Where the yarns of a split crossing touch, if they still do. */
static void read_contact(picture_source *s, const fray_world *world, uint32_t crossing) {
  s->touching[crossing] = 0;
  if (!s->split[crossing] || crossing_state_at(world, crossing) == FRAY_DISCONNECTED) return;
  if (world->woven.crossing_state[crossing] & CROSSING_LEFT) return;
  const yarn_contact *held = world->woven.contacts + crossing_contact(world, crossing);
  s->touching[crossing] = 1;
  for (int axis = 0; axis < AXES; axis++)
    s->place[axis][crossing] =
        (float)held->place[axis == AXIS_WARP ? FRAY_WARP : FRAY_WEFT] / (float)YARN_PLACE_ONE - 0.5f;
}

static void read_springs(picture_source *s, const fray_world *world, const fray_particles *p,
                         uint32_t rows, float mm_per_q24) {
  const uint32_t springs = picture_springs(s->warps, s->wefts);
  double rest_sum = 0.0;
  memset(s->springs, SPRING_NONE, springs);
  for (uint32_t k = 0; k < rows; k++) {
    const fray_spring row = fray_view_spring(world, FRAY_STRUCTURAL, k);
    rest_sum += (double)row.rest;
    if (row.id >= springs) continue;
    s->springs[row.id] = row.alive ? SPRING_ALIVE : SPRING_CUT;
    const double dx = (double)p->x[row.i] - (double)p->x[row.j];
    const double dy = (double)p->y[row.i] - (double)p->y[row.j];
    const double dz = (double)p->z[row.i] - (double)p->z[row.j];
    const double rest = row.rest > 0 ? (double)row.rest : 1.0;
    const double strain = sqrt(dx * dx + dy * dy + dz * dz) / rest - 1.0;
    const double limit = row.threshold > 0 ? (double)row.threshold / 65536.0 : 0.1;
    s->load[row.id] = (float)(strain / limit);
  }
  s->spacing = rows ? (float)(rest_sum / rows) * mm_per_q24 : 1.0f;
}

static float principal(const int32_t stress[3]) {
  const float middle = 0.5f * ((float)stress[0] + (float)stress[1]);
  const float half = 0.5f * ((float)stress[0] - (float)stress[1]), shear = (float)stress[2];
  return (middle + sqrtf(half * half + shear * shear)) / 4096.0f;
}

static int read_triangles(picture_source *s, const fray_world *world, const fray_particles *p,
                          const fray_info *facts, float mm_per_q24) {
  double area = 0.0;
  if (facts->triangles == 0) return 1;
  s->vertices = calloc(p->count, sizeof *s->vertices);
  s->held = calloc(p->count, sizeof *s->held);
  s->triangles = calloc(facts->triangles, sizeof *s->triangles);
  if (!s->vertices || !s->held || !s->triangles) return 0;
  s->vertex_count = p->count;
  s->triangle_count = facts->triangles;
  for (uint32_t n = 0; n < p->count; n++) {
    const int32_t at[3] = {p->x[n], p->y[n], p->z[n]};
    s->vertices[n] = in_mm(at, mm_per_q24);
    s->held[n] = n < p->attached && s->bodies[fray_attached_body(world, n)].shape == FRAY_ANCHOR;
  }
  for (uint32_t t = 0; t < facts->triangles; t++) {
    const fray_triangle from = fray_view_triangle(world, t);
    picture_triangle *to = s->triangles + t;
    to->stress = principal(from.stress);
    to->strength = (float)tear_strength_min(&world->membrane.tear_strengths[from.material]) / 4096.0f;
    for (int k = 0; k < 3; k++) {
      to->vertex[k] = from.vertex[k];
      to->border[k] = from.boundary[k];
      to->side[k] = from.edge[k];
    }
    const double u1 = (double)from.u[1] - from.u[0], u2 = (double)from.u[2] - from.u[0];
    const double v1 = (double)from.v[1] - from.v[0], v2 = (double)from.v[2] - from.v[0];
    area += u1 * v2 - u2 * v1;
  }
  s->spacing = (float)sqrt(area / facts->triangles) * mm_per_q24;
  return 1;
}

int picture_source_read(picture_source *s, const fray_world *world) {
  const fray_info facts = fray_get_info(world);
  const fray_weave sheet = fray_view_weave(world);
  const fray_particles p = fray_view_particles(world);
  if (!picture_source_reserve(s, sheet.warps, sheet.wefts, facts.bodies)) return 0;
  const float mm_per_q24 = (float)facts.lu_um * 1e-3f / 16777216.0f;
  s->weave_columns = sheet.weave_columns;
  s->weave_rows = sheet.weave_rows;
  s->weave = sheet.weave;
  s->thickness = (float)facts.thickness * mm_per_q24;
  s->tick = facts.tick;
  s->rate_hz = facts.rate_hz;
  for (uint32_t k = 0; k < facts.bodies; k++) {
    const fray_body b = fray_view_body(world, k);
    s->bodies[k] = body_in_mm(&b, mm_per_q24);
    (void)fray_view_mesh(world, k, &s->bodies[k].mesh);
    s->bodies[k].mm = mm_per_q24;
  }
  for (uint32_t k = 0; k < s->warps * s->wefts; k++) read_crossing(s, world, &p, k, mm_per_q24);
  for (uint32_t k = 0; k < s->warps * s->wefts; k++) read_contact(s, world, k);
  read_springs(s, world, &p, facts.springs[FRAY_STRUCTURAL], mm_per_q24);
  if (!read_triangles(s, world, &p, &facts, mm_per_q24)) {
    picture_source_close(s);
    return 0;
  }
  return 1;
}

v3 picture_mesh_point(const picture_body *b, uint32_t point) {
  return v3_add(b->position, in_mm(b->mesh.point + 5 * point, b->mm));
}

bounds picture_source_bounds(const picture_source *s) {
  bounds b = bounds_none();
  for (uint32_t k = 0; k < s->warps * s->wefts; k++) bounds_add(&b, s->crossings[k]);
  for (uint32_t k = 0; k < s->vertex_count; k++) bounds_add(&b, s->vertices[k]);
  for (uint32_t k = 0; k < s->body_count; k++) {
    const picture_body *body = s->bodies + k;
    for (uint32_t n = 0; n < body->mesh.points; n++) bounds_add(&b, picture_mesh_point(body, n));
    const float r = body->radius + v3_length(body->half);
    if (r == 0.0f) continue; /* a plane, an anchor, a mesh */
    bounds_add(&b, v3_sub(body->position, (v3){r, r, r}));
    bounds_add(&b, v3_add(body->position, (v3){r, r, r}));
  }
  return b;
}

uint32_t picture_weft_spring(const picture_source *s, uint32_t i, uint32_t j) {
  return i + 1 < s->warps && j < s->wefts ? j * (s->warps - 1) + i : UINT32_MAX;
}

uint32_t picture_warp_spring(const picture_source *s, uint32_t i, uint32_t j) {
  if (i >= s->warps || j + 1 >= s->wefts) return UINT32_MAX;
  return s->wefts * (s->warps - 1) + j * s->warps + i;
}

int picture_alive(const picture_source *s, uint32_t spring) {
  return spring != UINT32_MAX && s->springs[spring] == SPRING_ALIVE;
}

int picture_cell_closed(const picture_source *s, uint32_t i, uint32_t j) {
  return i + 1 < s->warps && j + 1 < s->wefts && picture_alive(s, picture_weft_spring(s, i, j)) &&
         picture_alive(s, picture_weft_spring(s, i, j + 1)) &&
         picture_alive(s, picture_warp_spring(s, i, j)) &&
         picture_alive(s, picture_warp_spring(s, i + 1, j));
}

int picture_warp_over(const picture_source *s, uint32_t i, uint32_t j) {
  const uint32_t columns = s->weave_columns ? s->weave_columns : 1;
  const uint32_t rows = s->weave_rows ? s->weave_rows : 1;
  return (int)(s->weave >> ((j % rows) * 8 + i % columns) & 1u);
}
