/* SPDX-License-Identifier: Apache-2.0 */
/* The most work that a tick can count, from the image's sizes and budgets. tests/unit/test_work_bound.c
 * holds ticks of every kind against it. */
#include "rt/base/bytes.h"
#include "rt/state/rigid_mesh.h"

/* Springs of batches first to end - 1 that can move an end. */
static uint32_t active_springs(const fray_world *w, uint32_t first, uint32_t end) {
  FRAY_ASSERT(first <= end && end <= w->capacity[POOL_BATCHES]);
  uint32_t springs = 0;
  for (uint32_t b = first; b < end; ++b)
    if (w->woven.batches[b].attached != BATCH_INACTIVE) springs += (uint32_t)w->woven.batches[b].count;
  return springs;
}

static uint32_t saturated_product(uint64_t a, uint64_t b) {
  return a != 0 && b > UINT32_MAX / a ? UINT32_MAX : (uint32_t)(a * b);
}

static uint32_t saturated_sum(uint32_t a, uint32_t b) { return b > UINT32_MAX - a ? UINT32_MAX : a + b; }

/* One particle and two triangles for each contact, in each substep; twice where free bodies may be stopped.
 * A first pass pushes particles of woven cloth, or finds the constraints of a membrane. */
static void add_rigid_meshes(const fray_world *w, fray_work *most) {
  const uint64_t whole = rigid_mesh_meets_triangles(w) != 0;
  const uint64_t tests = collider_checks(w);
  uint64_t runs = 1;
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    if (whole != 0 && w->rigid.bodies[b].motion == FRAY_FREE) runs = 2;
  const uint64_t substeps = (uint32_t)w->params->substeps * runs;
  const uint64_t ways = substeps * w->capacity[POOL_CONTACTS];
  const uint64_t passes = substeps * collider_count(w) * (1u + tests);
  const uint64_t checks = RIGID_MESH_CHECKS * tests;
  most->mesh_tests = saturated_product(w->capacity[POOL_PARTICLES], passes);
  const uint64_t triangles = whole * RIGID_MESH_TRIANGLES * (1u + checks);
  most->mesh_boxes = saturated_product(ways, RIGID_MESH_VISITS * (2u + tests + triangles));
  most->mesh_ccd = saturated_product(
      ways, RIGID_MESH_NEAR * (RIGID_MESH_ROUNDS + 1u + tests) + RIGID_MESH_CLOSE_CCD * triangles);
  most->mesh_pins = saturated_product(w->capacity[POOL_PARTICLES],
                                      passes * (1u + whole) + (runs - 1u) * collider_count(w) * substeps);
}

/* Of pairs found in so many passes, in a pool of which so many have room; and of tests without room. */
static uint32_t self_ccd_most(uint64_t pairs, uint32_t room, uint64_t without_room) {
  const uint32_t merges = saturated_product(pairs, SELF_MERGES);
  const uint32_t pushes = saturated_product(room, SELF_ROUNDS);
  return saturated_sum(saturated_sum(merges, pushes), saturated_product(without_room, 1));
}

/* Every pass may fill the pool of pairs; those without room are pushed and tested. */
static void add_yarn_collision(const fray_world *w, fray_work *most) {
  const uint64_t pairs = (uint64_t)w->capacity[POOL_YARN_PAIRS] * SELF_PASSES;
  most->self_box_tests = saturated_product(w->capacity[POOL_CROSSINGS], SELF_VISITS * SELF_PASSES);
  most->self_pairs = saturated_product(pairs, 1);
  const uint64_t crossings = w->capacity[POOL_CROSSINGS];
  const uint32_t substeps = (uint32_t)w->params->substeps;
  const uint64_t sweeps = (uint64_t)SELF_FOLLOWS * self_follow_sweeps(substeps);
  const uint64_t followed = sweeps * (most->projections / substeps);
  if (!world_has_elastic_yarns(w))
    most->projections = saturated_sum(most->projections, saturated_product(followed, 1));
  most->self_ccd = self_ccd_most(pairs, w->capacity[POOL_YARN_PAIRS], 2u * crossings * SELF_WITHOUT_ROOM);
  const uint64_t looks = SELF_PASSES * (SELF_ROUNDS + SELF_MERGES + 3u) + sweeps; /* at bodies */
  most->self_ccd = saturated_sum(most->self_ccd, saturated_product(w->capacity[POOL_CONTACTS], looks));
  most->self_merged = saturated_product(w->capacity[POOL_PARTICLES], SELF_PASSES * (SELF_MERGES + 2u) + 1u);
}

/* The pairs may be found twice in a pass, and once for constraints; a test against bodies follows a pass. */
static void add_triangle_collision(const fray_world *w, fray_work *most) {
  const uint64_t triangles = w->capacity[POOL_TRIANGLES];
  const uint64_t pairs = (uint64_t)w->capacity[POOL_TRIANGLE_PAIRS] * (SELF_PASSES + 1u);
  const uint64_t contacts = w->capacity[POOL_CONTACTS];
  const uint64_t looks = (uint64_t)TRIANGLE_PAIR_CHECKS * collider_count(w);
  most->self_box_tests = saturated_product(triangles * (triangles + 1u) / 2u, 2 * (SELF_PASSES + 1u));
  most->self_pairs = saturated_product(pairs, 1);
  const uint64_t without_room = triangles * SELF_TRIANGLES_WITHOUT_ROOM;
  most->self_ccd = self_ccd_most(pairs, w->capacity[POOL_TRIANGLE_PAIRS], without_room);
  most->self_merged = saturated_product(w->capacity[POOL_PARTICLES], SELF_PASSES * (SELF_MERGES + 2u) + 2u);
  const uint64_t steps = (uint64_t)(uint32_t)w->membrane.constants->steps * (uint32_t)w->params->substeps;
  const uint64_t constraints = (uint64_t)SELF_CONSTRAINTS * w->capacity[POOL_PARTICLES];
  most->contact_constraints = saturated_sum(most->contact_constraints, saturated_product(constraints, steps));
  if (!world_has_rigid_meshes(w)) return;
  most->mesh_tests = saturated_sum(most->mesh_tests, saturated_product(w->capacity[POOL_PARTICLES], looks));
  const uint64_t checks = (uint64_t)RIGID_MESH_TRIANGLES * RIGID_MESH_CHECKS;
  most->mesh_boxes = saturated_sum(most->mesh_boxes,
                                   saturated_product(contacts, RIGID_MESH_VISITS * looks * (1u + checks)));
  most->mesh_ccd = saturated_sum(
      most->mesh_ccd,
      saturated_product(contacts, looks * (RIGID_MESH_NEAR + RIGID_MESH_CLOSE_CCD * checks)));
  most->mesh_pins =
      saturated_sum(most->mesh_pins, saturated_product(w->capacity[POOL_PARTICLES], 2u * looks));
}

/* What substeps count, as often as the tick may be done. */
static void repeat_substeps(fray_work *most) {
  uint32_t *const counts[] = {&most->particle_steps, &most->element_forces,      &most->bend_forces,
                              &most->contacts,       &most->contact_constraints, &most->mesh_tests,
                              &most->mesh_boxes,     &most->mesh_ccd,            &most->mesh_pins,
                              &most->self_box_tests, &most->self_pairs,          &most->self_ccd,
                              &most->self_merged};
  for (uint32_t n = 0; n < sizeof counts / sizeof counts[0]; ++n)
    *counts[n] = saturated_product(*counts[n], TICK_ATTEMPTS);
}

/* All triangles once by each mesh, at most as many as contacts; particles twice; what a cut adds is tested
 * again. */
static void add_blades(const fray_world *w, fray_work *most) {
  const uint64_t meshes = rigid_mesh_count(w);
  most->blade_cuts = (uint32_t)w->membrane.blades->tears_max;
  most->tears += most->blade_cuts;
  most->mesh_tests =
      saturated_sum(most->mesh_tests, saturated_product(2u * w->capacity[POOL_PARTICLES], meshes));
  most->mesh_boxes = saturated_sum(
      most->mesh_boxes, saturated_product(w->capacity[POOL_CONTACTS], RIGID_MESH_VISITS * meshes));
  most->mesh_ccd = saturated_sum(
      most->mesh_ccd, saturated_product(w->capacity[POOL_CONTACTS], RIGID_MESH_CLOSE_CCD * meshes));
}

static void add_woven(const fray_world *w, fray_work *most) {
  const params *p = w->params;
  const uint32_t substeps = (uint32_t)p->substeps;
  const uint32_t link_batches = (uint32_t)p->link_batches;
  const uint32_t links = active_springs(w, 0, link_batches);
  const uint32_t spares = world_has_yarns(w) ? w->capacity[POOL_PARTICLES] - (uint32_t)p->particles : 0;
  most->particle_steps = ((uint32_t)(p->particles - p->attached) + spares) * substeps;
  const uint32_t locked =
      world_has_shear_lock(w)
          ? active_springs(w, link_batches + (uint32_t)p->bend_batches, w->capacity[POOL_BATCHES]) : 0;
  const uint32_t projected = world_has_elastic_yarns(w) ? locked : links + locked;
  most->projections = projected * (uint32_t)p->iterations * substeps;
  most->springs = active_springs(w, link_batches, w->capacity[POOL_BATCHES]);
  most->slips = spares * substeps;
  if (world_has_elastic_yarns(w)) {
    most->yarn_forces = (links * substeps) << (uint32_t)w->woven.elastic_params->steps_bits;
    most->slips <<= (uint32_t)w->woven.elastic_params->steps_bits;
    most->springs *= substeps;
    if (w->woven.elastic_params->damping_ns != 0) most->yarn_forces *= 2u;
  }
  if (p->tearing == 0) return;
  most->tear_tests = most->over_threshold = (uint32_t)p->links;
  most->tears = (uint32_t)p->tears_max;
  most->splits = w->capacity[POOL_SPLITS];
  if (most->tear_tests != 0 && world_has_yarns(w)) most->transitions = most->tear_tests + spares;
}

/* Candidates of a tear: at each of three corners an edge and the middle of the opposite one. */
static void add_membrane(const fray_world *w, fray_work *most) {
  const params *p = w->params;
  const uint32_t substeps = (uint32_t)p->substeps;
  const uint32_t triangles = w->capacity[POOL_TRIANGLES];
  const uint32_t steps = (uint32_t)w->membrane.constants->steps;
  const uint32_t every = (uint32_t)w->membrane.constants->bend_every;
  most->particle_steps = (w->capacity[POOL_PARTICLES] - (uint32_t)p->attached) * steps * substeps;
  most->element_forces = triangles * steps * substeps;
  most->contact_constraints = saturated_product(
      (uint64_t)CONSTRAINTS_PER_CONTACT * w->capacity[POOL_CONTACTS], (uint64_t)steps * substeps);
  if (every != 0) most->bend_forces = 3u * triangles / 2u * ((steps + every - 1u) / every) * substeps;
  if (p->tearing == 0) return;
  most->tear_tests = triangles;
  most->tear_candidates = 6u * triangles;
  most->tears = (uint32_t)w->trimesh.params->materials;
  if (!world_has_cracks(w)) return;
  most->tears = CRACK_TIPS + 2;
  most->eigenvalues = 2u * w->capacity[POOL_PARTICLES] + CRACK_TIPS + 1u;
}

fray_work fray_work_bound(const fray_world *w) {
  FRAY_ASSERT(w != NULL && w->params->particles >= w->params->attached);
  const params *p = w->params;
  const uint32_t spare = w->capacity[POOL_PARTICLES] - (uint32_t)p->particles;
  const uint32_t free_particles = (uint32_t)(p->particles - p->attached) +
                                  (world_has_membrane(w) || world_has_yarns(w) ? spare : 0);
  fray_work most;
  bytes_zero(&most, sizeof most);
  most.contacts = w->capacity[POOL_CONTACTS] * (uint32_t)p->substeps;
  if (world_has_elastic_yarns(w)) most.contacts <<= (uint32_t)w->woven.elastic_params->steps_bits;
  for (uint32_t b = 0; b < (uint32_t)p->bodies; ++b)
    if (body_is_primitive(&w->rigid.bodies[b])) most.broad_phase_tests += free_particles;
  if (world_has_elastic_yarns(w)) most.broad_phase_tests *= (uint32_t)p->substeps;
  if (world_has_membrane(w))
    add_membrane(w, &most);
  else
    add_woven(w, &most);
  if (world_has_rigid_meshes(w)) add_rigid_meshes(w, &most);
  if (world_has_yarn_collision(w)) add_yarn_collision(w, &most);
  if (world_has_triangle_collision(w)) add_triangle_collision(w, &most);
  if (world_repeats_ticks(w)) repeat_substeps(&most);
  if (world_has_blades(w)) add_blades(w, &most);
  return most;
}
