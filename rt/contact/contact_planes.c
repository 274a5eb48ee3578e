/* SPDX-License-Identifier: Apache-2.0 */
/* Free bodies on planes. A body beside projected yarns is put out of a plane once a substep, and stops
 * there; one beside a membrane meets a constraint in each elastic step, as cloth does; for elastic yarns
 * see contact_steps.c. */
#include "rt/contact/constraints.h"
#include "rt/contact/contact.h"
#include "rt/contact/shape.h"
#include "rt/elastic/step_passive.h"
#include "rt/state/rigid_mesh.h"

/* Extent of a mesh against the normal, which points up. */
static int64_t mesh_extent(const fray_world *w, uint32_t b, vec3 normal) {
  const rigid_mesh_parts m = rigid_mesh_at(w, rigid_mesh_of_body(w, b));
  return rigid_mesh_extent(&m, vec_negated(normal));
}

int64_t contact_height_above(const fray_world *w, uint32_t b, vec3 at, uint32_t g, vec3 plane) {
  const rigid_body *s = &w->rigid.bodies[b];
  const vec3 normal = shape_plane_normal(&w->rigid.bodies[g]);
  const int64_t extent = body_is_mesh(s) && world_has_rigid_meshes(w) ? mesh_extent(w, b, normal)
                                                                      : shape_extent(s, normal);
  return vec_dot_unit(vec_sub(at, plane), normal) - extent;
}

void contact_planes_push(fray_world *w, uint32_t b) {
  body_state *own = &w->rigid.states[b];
  FRAY_ASSERT(w->rigid.bodies[b].motion == FRAY_FREE);
  for (uint32_t g = 0; g < (uint32_t)w->params->bodies; ++g) {
    if (!shape_is_plane(&w->rigid.bodies[g])) continue;
    const int64_t height =
        contact_height_above(w, b, vec_of(own->position), g, vec_of(w->rigid.states[g].position));
    if (height >= 0) continue;
    const vec3 out = vec_scale_unit(shape_plane_normal(&w->rigid.bodies[g]),
                                    (int32_t)fx_clamp64(-height, 0, FX_WORLD_MAX));
    const vec3 at = vec_clamp(vec_add(vec_of(own->position), out), FX_WORLD_MAX);
    vec3 *moved = &w->rigid.motion[b].moved;
    *moved = vec_add(*moved, vec_sub(at, vec_of(own->position)));
    vec_store(own->position, at);
    vec_store(own->velocity, vec_make(0, 0, 0));
  }
}

static void find_planes(const fray_world *w, uint32_t b, int32_t *gap) {
  for (uint32_t g = 0; g < (uint32_t)w->params->bodies; ++g)
    if (shape_is_plane(&w->rigid.bodies[g]))
      gap[g] = fx_saturate(
          contact_height_above(w, b, w->membrane.bodies[b].start, g, w->membrane.bodies[g].start) *
          (1 << FX_SUB_BITS));
}

void contact_planes_find(fray_world *w) {
  FRAY_ASSERT(world_has_membrane(w) && (uint32_t)w->params->bodies <= w->capacity[POOL_BODIES]);
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    if (w->rigid.bodies[b].motion == FRAY_FREE) find_planes(w, b, w->membrane.bodies[b].plane_gap);
}

static void solve_planes(fray_world *w, uint32_t b, int32_t *gap, const elastic_step *step) {
  int32_t *velocity = w->rigid.states[b].velocity;
  const int32_t inverse = fx_max(1, w->rigid.bodies[b].mass_ratio >> 6);
  for (uint32_t g = 0; g < (uint32_t)w->params->bodies; ++g) {
    const rigid_body *plane = &w->rigid.bodies[g];
    if (!shape_is_plane(plane)) continue;
    const vec3 normal = shape_plane_normal(plane);
    const vec3 relative = vec_sub_saturated(vec_of(velocity), vec_of(w->rigid.states[g].velocity));
    const int32_t least = step_speed_min(gap[g], w->membrane.constants->steps, step->rise);
    const vec3 wanted = step_contact_change(relative, normal, least, plane->friction);
    const vec3 u = vec_sub_saturated(relative, step_body_half_of(w, b));
    const vec3 change = step_passive_change(w, step_mass_of((uint32_t)inverse), u, wanted);
    const int32_t along = fx_add_saturated(vec_dot_unit(relative, normal), vec_dot_unit(change, normal));
    vec_store(velocity, vec_add_clamped(vec_of(velocity), change, INT32_MAX));
    gap[g] = fx_saturate(gap[g] + fx_asr64(fx_mul_wide(along, step->part), 31));
  }
}

void contact_planes_solve(fray_world *w, const elastic_step *step) {
  FRAY_ASSERT(world_has_membrane(w) && (uint32_t)w->params->bodies <= w->capacity[POOL_BODIES]);
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    if (w->rigid.bodies[b].motion == FRAY_FREE)
      solve_planes(w, b, w->membrane.bodies[b].plane_gap, step);
}
