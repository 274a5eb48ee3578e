/* SPDX-License-Identifier: Apache-2.0 */
/* Read-only views of a world. */
#include "rt/base/assert.h"
#include "rt/base/bytes.h"
#include "rt/image/physics_id.h"
#include "rt/state/corotational.h"
#include "rt/state/crossing.h"
#include "rt/state/deformation.h"
#include "rt/state/rigid_mesh.h"

uint32_t fray_physics_id(void) { return PHYSICS_ID; }

uint64_t fray_hash(const fray_world *w) {
  FRAY_ASSERT(w != NULL);
  return state_pair(w->state->hash);
}

fray_info fray_get_info(const fray_world *w) {
  FRAY_ASSERT(w != NULL);
  const params *p = w->params;
  fray_info f;
  bytes_zero(&f, sizeof f);
  f.rate_hz = (uint32_t)p->rate_hz;
  f.substeps = (uint32_t)p->substeps;
  f.iterations = (uint32_t)p->iterations;
  f.lu_um = (uint32_t)p->lu_um;
  f.particle_mass_ng = (uint32_t)p->particle_mass_ng;
  f.thickness = p->thickness;
  f.tear_min_q16 = p->tear_min;
  f.tear_max_q16 = p->tear_max;
  f.tearing = (uint32_t)p->tearing;
  f.tick = state_tick(w->state);
  f.physics_id = w->physics_id;
  f.springs[FRAY_STRUCTURAL] = (uint32_t)p->links;
  f.springs[FRAY_BEND] = (uint32_t)p->bends;
  f.springs[FRAY_SHEAR] = w->capacity[POOL_SPRINGS] - (uint32_t)(p->links + p->bends);
  f.batches[FRAY_STRUCTURAL] = (uint32_t)p->link_batches;
  f.batches[FRAY_BEND] = (uint32_t)p->bend_batches;
  f.batches[FRAY_SHEAR] =
      w->capacity[POOL_BATCHES] - (uint32_t)(p->link_batches + p->bend_batches);
  f.bodies = (uint32_t)p->bodies;
  f.particles_max = w->capacity[POOL_PARTICLES];
  f.contacts_max = w->capacity[POOL_CONTACTS];
  f.tears_max = w->capacity[POOL_BREAKS];
  f.splits_max = w->capacity[POOL_SPLITS];
  if (world_has_yarns(w)) {
    f.all_yarn = (uint32_t)w->woven.yarn_constants->all_yarn;
    f.split_min_q16 = w->woven.yarn_constants->split_min;
    f.split_max_q16 = w->woven.yarn_constants->split_max;
    f.disconnect_distance = w->woven.yarn_constants->disconnect_distance;
  }
  if (world_has_elastic_yarns(w)) {
    f.yarn_stiffness_un = (uint32_t)w->woven.elastic_params->stiffness_un;
    f.yarn_steps = 1u << (uint32_t)w->woven.elastic_params->steps_bits;
    f.yarn_damping_ns = (uint32_t)w->woven.elastic_params->damping_ns;
  }
  if (world_has_membrane(w)) {
    f.triangles = triangles_in_use(w);
    f.triangles_max = w->capacity[POOL_TRIANGLES];
    f.elastic_steps = (uint32_t)w->membrane.constants->steps;
    f.stiffness_q30 = w->membrane.materials[0].scale;
    f.corotational = (uint32_t)world_is_corotational(w);
  }
  if (world_has_yarn_collision(w) || world_has_triangle_collision(w)) {
    f.self_pairs_max = w->capacity[POOL_YARN_PAIRS] + w->capacity[POOL_TRIANGLE_PAIRS];
    f.self_thickness = w->self.constants->thickness;
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
  FRAY_ASSERT(w != NULL && w->p.count <= w->capacity[POOL_PARTICLES]);
  const fray_particles v = {w->p.count, particles_attached(w), w->p.x, w->p.y, w->p.z, w->p.vx, w->p.vy,
                            w->p.vz};
  return v;
}

fray_weave fray_view_weave(const fray_world *w) {
  FRAY_ASSERT(w != NULL);
  const params *p = w->params;
  const fray_weave s = {(uint32_t)p->warps, (uint32_t)p->wefts, (uint32_t)p->weave_columns,
                        (uint32_t)p->weave_rows,
                        (uint64_t)(uint32_t)p->weave_high << 32 | (uint32_t)p->weave_low};
  return s;
}

fray_spring fray_view_spring(const fray_world *w, fray_spring_kind kind, uint32_t index) {
  const params *p = w->params;
  const uint32_t firsts[3] = {0, (uint32_t)p->links, (uint32_t)(p->links + p->bends)};
  FRAY_ASSERT(!world_has_membrane(w) && (uint32_t)kind <= (uint32_t)FRAY_SHEAR);
  const uint32_t s = firsts[kind] + index;
  FRAY_ASSERT(s < (kind == FRAY_SHEAR ? w->capacity[POOL_SPRINGS] : firsts[kind + 1]));
  const uint32_t class = w->woven.spring_kind[s] & SPRING_CLASS;
  fray_spring v;
  bytes_zero(&v, sizeof v);
  v.i = w->woven.spring_i[s];
  v.j = w->woven.spring_j[s];
  v.id = w->woven.canonical_id[s];
  v.alive = w->woven.spring_kind[s] != SPRING_DEAD;
  v.attached = v.i < (uint32_t)p->attached || v.j < (uint32_t)p->attached;
  v.rest = kind == FRAY_STRUCTURAL ? w->woven.link_classes[class].rest
                                     : w->woven.bend_shear_classes[class].rest;
  v.threshold = kind == FRAY_STRUCTURAL ? world_tear_strain(w, s) : 0;
  return v;
}

fray_body fray_view_body(const fray_world *w, uint32_t b) {
  FRAY_ASSERT(b < (uint32_t)w->params->bodies);
  const rigid_body *k = &w->rigid.bodies[b];
  const body_state *s = &w->rigid.states[b];
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
    v.impulse[n] = w->rigid.motion[b].impulse[n];
  }
  fray_handle handle;
  if (v.motion == FRAY_FREE && fray_view_handle(w, v.hand, &handle) != 0 && handle.body == b)
    v.motion = FRAY_HAND;
  return v;
}

int fray_view_handle(const fray_world *w, uint32_t hand, fray_handle *view) {
  FRAY_ASSERT(w != NULL && hand < FRAY_HANDS && view != NULL);
#if FRAY_HANDLES
  if (world_has_handles(w) && w->handles.constants[hand].body != HANDLE_NONE) {
    const handle_state *s = &w->handles.states[hand];
    view->body = (uint32_t)w->handles.constants[hand].body;
    for (uint32_t n = 0; n < 3; ++n) view->proxy[n] = s->proxy[n];
    view->given_nj = (int64_t)state_pair(s->given);
    view->given_most_nj = (int64_t)state_pair(s->most);
    view->taken_nj = (int64_t)state_pair(s->taken);
    return 1;
  }
#else
  (void)hand;
  (void)view;
#endif
  return 0;
}

int fray_view_mesh(const fray_world *w, uint32_t b, fray_mesh *view) {
  FRAY_ASSERT(b < (uint32_t)w->params->bodies && view != NULL);
  const uint32_t n = rigid_mesh_of_body(w, b);
  bytes_zero(view, sizeof *view);
  if (n == rigid_mesh_count(w)) return 0;
  const rigid_mesh_parts m = rigid_mesh_at(w, n);
  view->points = (uint32_t)m.of->points;
  view->edges = (uint32_t)m.of->edges;
  view->faces = (uint32_t)m.of->faces;
  view->point = (const int32_t *)(const void *)m.points;
  view->edge = (const int32_t *)(const void *)m.edges;
  view->face = (const int32_t *)(const void *)m.faces;
  return 1;
}

uint32_t fray_crossing_particle(const fray_world *w, uint32_t crossing) {
  FRAY_ASSERT(crossing < w->capacity[POOL_CROSSINGS]);
  return w->woven.crossing_particle[crossing];
}

fray_crossing_state fray_crossing_state_at(const fray_world *w, uint32_t crossing) {
  FRAY_ASSERT(crossing < w->capacity[POOL_CROSSINGS]);
  return world_has_yarns(w) ? crossing_state_at(w, crossing) : FRAY_WHOLE;
}

uint32_t fray_yarn_particle(const fray_world *w, uint32_t crossing, fray_axis axis) {
  FRAY_ASSERT(crossing < w->capacity[POOL_CROSSINGS] && axis <= FRAY_WARP);
  return axis == FRAY_WARP && world_has_yarns(w) ? w->woven.warp_particle[crossing]
                                                 : w->woven.crossing_particle[crossing];
}

uint32_t fray_attached_body(const fray_world *w, uint32_t particle) {
  FRAY_ASSERT(particle < particles_attached(w));
  return w->p.attach_body[particle];
}

/* Of an isotropic sheet by its own law, which tears go by too. */
static material_tensor stress_of(const fray_world *w, uint32_t t) {
  const material_table *material = &w->membrane.materials[w->trimesh.material[t]];
  const deformation d = deformation_of(w, t);
  const material_tensor strain = material_strain(d.u, d.v);
#if FRAY_CRACKS
  if (world_is_corotational(w)) return corotational_tension(material->stretch[0], strain);
#endif
  const int32_t *const in_use = w->membrane.stiffness[t].c;
  int32_t c[MATERIAL_ENTRIES];
  if (in_use[0] != 0) return material_stress(in_use, strain);
  material_stiffness(material, strain, c);
  return material_stress(c, strain);
}

fray_triangle fray_view_triangle(const fray_world *w, uint32_t t) {
  FRAY_ASSERT(world_has_membrane(w) && t < triangles_in_use(w));
  const trimesh *s = &w->trimesh;
  const material_tensor stress = stress_of(w, t);
  fray_triangle v;
  bytes_zero(&v, sizeof v);
  for (uint32_t k = 0; k < 3; ++k) {
    const uint32_t p = s->triangle[t].v[k];
    v.vertex[k] = p;
    v.u[k] = s->u[p];
    v.v[k] = s->v[p];
    v.boundary[k] = trimesh_neighbour(s, t, k) == TRIMESH_NONE;
    v.edge[k] = (uint8_t)trimesh_mark_of(s, t, k);
  }
  v.stress[0] = stress.uu;
  v.stress[1] = stress.vv;
  v.stress[2] = stress.uv;
  v.material = s->material[t];
  return v;
}
