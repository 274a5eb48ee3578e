/* SPDX-License-Identifier: Apache-2.0 */
/* Read-only views for the caller. */
#include "rt/base/bytes.h"
#include "rt/model/couples.h"
#include "rt/model/element.h"
#include "rt/model/mesh.h"

uint64_t fray_hash(const fray_world *w) {
  return (uint64_t)(uint32_t)w->state->hash[1] << 32 | (uint32_t)w->state->hash[0];
}

/* Rows of the batches [first, end) that anything steps. */
static uint32_t stepped(const fray_world *w, uint32_t first, uint32_t end) {
  uint32_t rows = 0;
  for (uint32_t b = first; b < end; ++b)
    if (w->batches[b].held != BATCH_IDLE) rows += (uint32_t)w->batches[b].count;
  return rows;
}

static uint32_t most_of(uint64_t a, uint64_t b) {
  return a != 0 && b > UINT32_MAX / a ? UINT32_MAX : (uint32_t)(a * b);
}

static uint32_t most_sum(uint32_t a, uint32_t b) { return b > UINT32_MAX - a ? UINT32_MAX : a + b; }

/* One particle or triangle for each contact, in each substep; all once more where free bodies may be stopped. */
static void mesh_limits(const fray_world *w, fray_work *most) {
  const uint64_t looks = mesh_looks(w);
  const uint64_t whole = mesh_is_whole(w) != 0;
  const uint64_t checks = MESH_CHECKS * (1u + looks);
  uint64_t runs = 1;
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    if (whole != 0 && w->bodies[b].motion == FRAY_FREE) runs = 2;
  const uint64_t substeps = (uint32_t)w->params->substeps * runs;
  const uint64_t ways = substeps * w->capacity[POOL_CONTACTS];
  const uint64_t passes = substeps * mesh_solids(w) * (1u + looks);
  most->mesh_tests = most_of(w->capacity[POOL_PARTICLES], passes);
  most->mesh_boxes = most_of(ways, MESH_VISITS * (2u + looks + whole * (MESH_PRESSES + 3u + checks)));
  most->mesh_sweeps =
      most_of(ways, MESH_NEAR * (MESH_ROUNDS + 1u + looks + 3u * whole) +
                        whole * MESH_CLOSE_SWEEPS * (MESH_PRESSES + checks));
  most->mesh_stops = most_of(w->capacity[POOL_PARTICLES], passes * (1u + whole) + (runs - 1u) * mesh_solids(w) * substeps);
}

/* Every pass may find as many pairs as there is room for. */
static void selves_limits(const fray_world *w, fray_work *most) {
  const uint64_t pairs = (uint64_t)w->capacity[POOL_PAIRS] * SELVES_PASSES;
  most->self_visits = most_of(w->capacity[POOL_CROSSINGS], SELVES_VISITS * SELVES_PASSES);
  most->self_pairs = most_of(pairs, 1);
  most->self_sweeps = most_of(pairs, SELVES_MERGES) + most_of(w->capacity[POOL_PAIRS], SELVES_ROUNDS);
  most->self_stops = most_of(w->capacity[POOL_PARTICLES], SELVES_PASSES * (SELVES_MERGES + 2u) + 1u);
}

/* The list may be made twice in a pass; bodies are asked behind each. */
static void layers_limits(const fray_world *w, fray_work *most) {
  const uint64_t triangles = w->capacity[POOL_TRIANGLES];
  const uint64_t pairs = (uint64_t)w->capacity[POOL_LAYERS] * SELVES_PASSES;
  const uint64_t contacts = w->capacity[POOL_CONTACTS];
  const uint64_t looks = (uint64_t)LAYERS_LOOKS * mesh_solids(w);
  most->self_visits = most_of(triangles * (triangles + 1u) / 2u, 2 * SELVES_PASSES);
  most->self_pairs = most_of(pairs, 1);
  most->self_sweeps = most_sum(most_of(pairs, SELVES_MERGES), most_of(w->capacity[POOL_LAYERS], SELVES_ROUNDS));
  most->self_stops = most_of(w->capacity[POOL_PARTICLES], SELVES_PASSES * (SELVES_MERGES + 2u) + 2u);
  if (!world_has_meshes(w)) return;
  most->mesh_tests = most_sum(most->mesh_tests, most_of(w->capacity[POOL_PARTICLES], looks));
  most->mesh_boxes = most_sum(most->mesh_boxes, most_of(contacts, MESH_VISITS * looks * (1u + MESH_CHECKS)));
  most->mesh_sweeps =
      most_sum(most->mesh_sweeps, most_of(contacts, looks * (MESH_NEAR + MESH_CLOSE_SWEEPS * MESH_CHECKS)));
  most->mesh_stops = most_sum(most->mesh_stops, most_of(w->capacity[POOL_PARTICLES], 2u * looks));
}

/* All triangles once by each mesh, as many as there are contacts; particles twice; what a cut adds is looked
 * at again. */
static void blade_limits(const fray_world *w, fray_work *most) {
  const uint64_t meshes = mesh_count(w);
  most->slashes = (uint32_t)w->blades->cuts_max;
  most->cuts += most->slashes;
  most->mesh_tests = most_sum(most->mesh_tests, most_of(2u * w->capacity[POOL_PARTICLES], meshes));
  most->mesh_boxes = most_sum(most->mesh_boxes, most_of(w->capacity[POOL_CONTACTS], MESH_VISITS * meshes));
  most->mesh_sweeps =
      most_sum(most->mesh_sweeps, most_of(w->capacity[POOL_CONTACTS], MESH_CLOSE_SWEEPS * meshes));
}

fray_work fray_limits(const fray_world *w) {
  const params *p = w->params;
  const uint32_t substeps = (uint32_t)p->substeps;
  const uint32_t link_batches = (uint32_t)p->link_batches;
  const uint32_t born = w->capacity[POOL_PARTICLES] - (uint32_t)p->particles;
  const uint32_t spares = world_has_yarns(w) ? born : 0;
  const uint32_t particles =
      (uint32_t)(p->particles - p->held) + (world_has_sheet(w) ? born : spares);
  fray_work most;
  bytes_zero(&most, sizeof most);
  most.predictions = particles * substeps;
  most.projections = stepped(w, 0, link_batches) * (uint32_t)p->sweeps * substeps;
  most.springs = stepped(w, link_batches, w->capacity[POOL_BATCHES]);
  most.contacts = w->capacity[POOL_CONTACTS] * substeps;
  most.tear_tests = p->tearing != 0 ? (uint32_t)p->links : 0;
  most.gathers = 0;
  for (uint32_t b = 0; b < (uint32_t)p->bodies; ++b)
    if (body_is_solid(&w->bodies[b])) most.gathers += particles;
  most.over = most.tear_tests;
  most.cuts = p->tearing != 0 ? (uint32_t)p->cuts_max : 0;
  most.slips = spares * substeps;
  most.stretches = !world_has_stretch(w) ? 0
                                         : (stepped(w, 0, link_batches) * substeps)
                                               << (uint32_t)w->stretch->steps_bits;
  if (world_has_stretch(w) && w->stretch->damping_ns != 0) most.stretches *= 2u;
  most.transitions = most.tear_tests != 0 && world_has_yarns(w) ? most.tear_tests + spares : 0;
  const uint32_t triangles = world_has_sheet(w) ? w->capacity[POOL_TRIANGLES] : 0;
  const uint32_t inner = triangles != 0 ? (uint32_t)w->cloths->inner : 1u;
  const uint32_t every = triangles != 0 ? (uint32_t)w->cloths->bend_every : 0u;
  most.pulls = triangles * inner * substeps;
  most.lines = p->tearing != 0 ? 6u * triangles : 0; /* three corners, a side and the middle at each */
  most.folds = every != 0 ? 3u * triangles / 2u * ((inner + every - 1u) / every) * substeps : 0;
  if (triangles != 0)
    most.predictions = (w->capacity[POOL_PARTICLES] - (uint32_t)p->held) * inner * substeps;
  if (triangles != 0 && p->tearing != 0) {
    most.tear_tests = triangles;
    most.cuts = (uint32_t)w->sheet.params->cloths;
  }
  if (world_has_meshes(w)) mesh_limits(w, &most);
  if (world_has_selves(w)) selves_limits(w, &most);
  if (world_has_layers(w)) layers_limits(w, &most);
  if (world_has_blades(w)) blade_limits(w, &most);
  most.splits = p->tearing != 0 ? w->capacity[POOL_SPLITS] : 0;
  return most;
}

fray_facts fray_describe(const fray_world *w) {
  const params *p = w->params;
  fray_facts f;
  bytes_zero(&f, sizeof f);
  f.rate_hz = (uint32_t)p->rate_hz;
  f.substeps = (uint32_t)p->substeps;
  f.sweeps = (uint32_t)p->sweeps;
  f.lu_um = (uint32_t)p->lu_um;
  f.particle_mass_ng = (uint32_t)p->particle_mass_ng;
  f.thickness = p->thickness;
  f.tear_min_q16 = p->tear_min;
  f.tear_max_q16 = p->tear_max;
  f.tearing = (uint32_t)p->tearing;
  f.tick = (uint32_t)w->state->tick;
  f.rows[FRAY_STRUCTURAL] = (uint32_t)p->links;
  f.rows[FRAY_BEND] = (uint32_t)p->bends;
  f.rows[FRAY_SHEAR] = w->capacity[POOL_ROWS] - (uint32_t)(p->links + p->bends);
  f.batches[FRAY_STRUCTURAL] = (uint32_t)p->link_batches;
  f.batches[FRAY_BEND] = (uint32_t)p->bend_batches;
  f.batches[FRAY_SHEAR] =
      w->capacity[POOL_BATCHES] - (uint32_t)(p->link_batches + p->bend_batches);
  f.bodies = (uint32_t)p->bodies;
  f.particles_max = w->capacity[POOL_PARTICLES];
  f.contacts_max = w->capacity[POOL_CONTACTS];
  f.cuts_max = w->capacity[POOL_CUTS];
  f.splits_max = w->capacity[POOL_SPLITS];
  if (world_has_yarns(w)) {
    f.all_yarn = (uint32_t)w->yarns->all_yarn;
    f.transition_min_q16 = w->yarns->transition_min;
    f.transition_max_q16 = w->yarns->transition_max;
    f.loose_max = w->yarns->loose_max;
  }
  if (world_has_stretch(w)) {
    f.stretch_un = (uint32_t)w->stretch->stiffness_un;
    f.stretch_steps = 1u << (uint32_t)w->stretch->steps_bits;
    f.stretch_damping_ns = (uint32_t)w->stretch->damping_ns;
    f.stretch_limit_q16 = w->stretch->limit;
  }
  if (world_has_sheet(w)) {
    f.triangles = (uint32_t)w->sheet.state->triangles;
    f.triangles_max = w->capacity[POOL_TRIANGLES];
    f.inner_steps = (uint32_t)w->cloths->inner;
    f.stiffness_q30 = w->fabrics[0].scale;
  }
  if (world_has_selves(w) || world_has_layers(w)) {
    f.pairs_max = w->capacity[POOL_PAIRS] + w->capacity[POOL_LAYERS];
    f.self_thickness = w->selves->thickness;
  }
  f.hands = (uint32_t)p->hands;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) f.consumed[h] = (uint8_t)w->state->hand[h].consumed;
  f.gravity[0] = p->gravity_x;
  f.gravity[1] = p->gravity_y;
  f.gravity[2] = p->gravity_z;
  f.gravity_rest[0] = (uint32_t)p->gravity_rest_x;
  f.gravity_rest[1] = (uint32_t)p->gravity_rest_y;
  f.gravity_rest[2] = (uint32_t)p->gravity_rest_z;
  return f;
}

fray_particles fray_view_particles(const fray_world *w) {
  const fray_particles v = {w->particles, (uint32_t)w->params->held, w->x, w->y, w->z, w->vx, w->vy,
                            w->vz};
  return v;
}

fray_sheet fray_view_sheet(const fray_world *w) {
  const params *p = w->params;
  const fray_sheet s = {(uint32_t)p->warps, (uint32_t)p->wefts, (uint32_t)p->weave_columns,
                        (uint32_t)p->weave_rows,
                        (uint64_t)(uint32_t)p->weave_high << 32 | (uint32_t)p->weave_low};
  return s;
}

fray_row fray_view_row(const fray_world *w, fray_family family, uint32_t index) {
  const params *p = w->params;
  const uint32_t firsts[3] = {0, (uint32_t)p->links, (uint32_t)(p->links + p->bends)};
  const uint32_t row = firsts[family] + index;
  const uint32_t kind = w->row_class[row];
  fray_row v;
  bytes_zero(&v, sizeof v);
  v.i = w->row_i[row];
  v.j = w->row_j[row];
  v.home = w->home[row];
  v.alive = kind != ROW_DEAD;
  v.held = v.i < (uint32_t)p->held || v.j < (uint32_t)p->held;
  v.rest = family == FRAY_STRUCTURAL ? w->links[kind & ROW_CLASS].rest
                                     : w->springs[kind & ROW_CLASS].rest;
  v.threshold = family == FRAY_STRUCTURAL ? world_threshold(w, row) : 0;
  return v;
}

fray_body fray_view_body(const fray_world *w, uint32_t b) {
  const body *k = &w->bodies[b];
  const body_state *s = &w->body_states[b];
  fray_body v;
  v.shape = (fray_shape)k->shape;
  v.motion = (fray_motion)k->motion;
  v.hand = (uint32_t)k->hand;
  v.radius = k->radius;
  for (uint32_t n = 0; n < 9; ++n) v.axes[n] = k->axes[n];
  for (uint32_t n = 0; n < 3; ++n) {
    v.half[n] = k->half[n];
    v.position[n] = s->position[n];
    v.velocity[n] = s->velocity[n];
    v.impulse[n] = w->motion[b].impulse[n];
  }
  return v;
}

int fray_view_mesh(const fray_world *w, uint32_t b, fray_mesh *view) {
  const uint32_t n = mesh_of_body(w, b);
  bytes_zero(view, sizeof *view);
  if (n == mesh_count(w)) return 0;
  const mesh_parts m = mesh_at(w, n);
  view->points = (uint32_t)m.of->points;
  view->edges = (uint32_t)m.of->edges;
  view->faces = (uint32_t)m.of->faces;
  view->point = (const int32_t *)(const void *)m.points;
  view->edge = (const int32_t *)(const void *)m.edges;
  view->face = (const int32_t *)(const void *)m.faces;
  return 1;
}

uint32_t fray_particle_at(const fray_world *w, uint32_t crossing) { return w->crossing[crossing]; }

fray_couple fray_couple_at(const fray_world *w, uint32_t crossing) {
  return world_has_yarns(w) ? couple_at(w, crossing) : FRAY_WHOLE;
}

uint32_t fray_particle_of(const fray_world *w, uint32_t crossing, fray_axis axis) {
  return axis == FRAY_WARP && world_has_yarns(w) ? w->warp_at[crossing] : w->crossing[crossing];
}

uint32_t fray_holder(const fray_world *w, uint32_t particle) { return w->grip_body[particle]; }

fray_triangle fray_view_triangle(const fray_world *w, uint32_t t) {
  const sheet_mesh *s = &w->sheet;
  const element_axes e = element_axes_of(w, t);
  int32_t c[FABRIC_ENTRIES];
  fabric_stiffness(&w->fabrics[s->cloth[t]], w->habits[t].mean[HABIT_POLES - 1], c);
  const tensor stress = fabric_stress(c, fabric_strain(e.u, e.v));
  fray_triangle v;
  bytes_zero(&v, sizeof v);
  for (uint32_t k = 0; k < 3; ++k) {
    const uint32_t p = s->triangle[t].v[k];
    v.vertex[k] = p;
    v.u[k] = s->u[p];
    v.v[k] = s->v[p];
    v.border[k] = sheet_across(s, t, k) == SHEET_NONE;
    v.side[k] = (uint8_t)sheet_mark_of(s, t, k);
  }
  v.stress[0] = stress.uu;
  v.stress[1] = stress.vv;
  v.stress[2] = stress.uv;
  v.cloth = s->cloth[t];
  return v;
}
