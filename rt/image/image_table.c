/* SPDX-License-Identifier: Apache-2.0 */
/* The arrays of a world: section of the image, role, size of an element, pool, and place in the struct. */
#include "rt/image/image.h"

#define AT(field) offsetof(struct fray_world, field)
#define WORDS(id, role, pool, words, field) {#field, id, role, KIND_WORD, pool, 0, words, AT(field)}
#define BYTE(id, role, pool, field) {#field, id, role, KIND_BYTE, pool, 0, 1, AT(field)}
#define IDS(id, role, pool, field) {#field, id, role, KIND_ID, pool, 0, 1, AT(field)}
#define YARN(id, role, kind, pool, words, field) \
  {#field, id, role, kind, pool, POOL_SPLITS, words, AT(field)}
#define STRETCH(id, pool, words, field) \
  {#field, id, ROLE_CONSTANT, KIND_WORD, pool, POOL_YARN_GAINS, words, AT(field)}
#define SHEET(id, role, kind, pool, words, field) \
  {#field, id, role, kind, pool, POOL_TRIANGLES, words, AT(field)}
#define LAYERS(kind, pool, bytes, field)                                                                   \
  { #field, 0, ROLE_TICK, kind, pool, POOL_TRIANGLE_PAIRS, bytes, AT(field) }
#define REPEATS(kind, pool, bytes, field) {#field, 0, ROLE_TICK, kind, pool, POOL_ZONES, bytes, AT(field)}
#define SELVES(kind, pool, bytes, field) {#field, 0, ROLE_TICK, kind, pool, POOL_YARN_PAIRS, bytes, AT(field)}
#define MESH(id, role, kind, pool, words, field) \
  {"trimesh." #field, id, role, kind, pool, POOL_TRIANGLES, words, AT(trimesh) + offsetof(trimesh, field)}
#define WITH_MESHES(pool, type, field) \
  {#field, 0, ROLE_TICK, KIND_STRUCT, pool, POOL_RIGID_MESH_WORDS, sizeof(type), AT(field)}
#define TICK(pool, type, field) {#field, 0, ROLE_TICK, KIND_STRUCT, pool, 0, sizeof(type), AT(field)}
#define SHEET_TICK(pool, type, field) SHEET(0, ROLE_TICK, KIND_STRUCT, pool, sizeof(type), field)
#define MESH_TICK(pool, type, field) MESH(0, ROLE_TICK, KIND_STRUCT, pool, sizeof(type), field)

const image_array image_arrays[] = {
    WORDS(1, ROLE_CONSTANT, POOL_PARAMS, PARAM_WORDS, params),
    WORDS(2, ROLE_STATE, POOL_STATE, STATE_WORDS, state),
    WORDS(3, ROLE_CONSTANT, POOL_LINK_CLASSES, LINK_CLASS_WORDS, woven.link_classes),
    WORDS(4, ROLE_CONSTANT, POOL_BEND_SHEAR_CLASSES, BEND_SHEAR_CLASS_WORDS, woven.bend_shear_classes),
    WORDS(5, ROLE_CONSTANT, POOL_BATCHES, BATCH_WORDS, woven.batches),
    IDS(6, ROLE_CONSTANT, POOL_CROSSINGS, woven.crossing_particle),
    IDS(7, ROLE_CONSTANT, POOL_SPRINGS, woven.canonical_id),
    IDS(8, ROLE_CONSTANT, POOL_SPRINGS, woven.spring_of),
    IDS(9, ROLE_STATE, POOL_SPRINGS, woven.spring_i),
    IDS(10, ROLE_STATE, POOL_SPRINGS, woven.spring_j),
    BYTE(11, ROLE_STATE, POOL_SPRINGS, woven.spring_kind),
    WORDS(12, ROLE_STATE, POOL_PARTICLES, 1, p.x),
    WORDS(13, ROLE_STATE, POOL_PARTICLES, 1, p.y),
    WORDS(14, ROLE_STATE, POOL_PARTICLES, 1, p.z),
    WORDS(15, ROLE_STATE, POOL_PARTICLES, 1, p.vx),
    WORDS(16, ROLE_STATE, POOL_PARTICLES, 1, p.vy),
    WORDS(17, ROLE_STATE, POOL_PARTICLES, 1, p.vz),
    BYTE(18, ROLE_STATE, POOL_PARTICLES, p.rx),
    BYTE(19, ROLE_STATE, POOL_PARTICLES, p.ry),
    BYTE(20, ROLE_STATE, POOL_PARTICLES, p.rz),
    BYTE(21, ROLE_CONSTANT, POOL_ATTACHED, p.attach_body),
    WORDS(22, ROLE_CONSTANT, POOL_ATTACHED, 1, p.attach_x),
    WORDS(23, ROLE_CONSTANT, POOL_ATTACHED, 1, p.attach_y),
    WORDS(24, ROLE_CONSTANT, POOL_ATTACHED, 1, p.attach_z),
    WORDS(25, ROLE_CONSTANT, POOL_BODIES, BODY_WORDS, rigid.bodies),
    WORDS(26, ROLE_STATE, POOL_BODIES, BODY_STATE_WORDS, rigid.states),
    WORDS(27, ROLE_CONSTANT, POOL_KEYS, KEYFRAME_WORDS, rigid.keyframes),
    YARN(28, ROLE_CONSTANT, KIND_WORD, POOL_PARAMS, YARN_PARAM_WORDS, woven.yarn_constants),
    YARN(29, ROLE_STATE, KIND_WORD, POOL_STATE, YARN_STATE_WORDS, woven.yarn_counts),
    YARN(30, ROLE_STATE, KIND_BYTE, POOL_CROSSINGS, 1, woven.crossing_state),
    YARN(31, ROLE_STATE, KIND_ID, POOL_CROSSINGS, 1, woven.warp_particle),
    YARN(32, ROLE_STATE, KIND_ID, POOL_PARTICLES, 1, woven.crossing_of),
    STRETCH(33, POOL_PARAMS, YARN_ELASTIC_PARAM_WORDS, woven.elastic_params),
    STRETCH(34, POOL_YARN_GAINS, YARN_GAIN_WORDS, woven.yarn_gains),
    MESH(36, ROLE_CONSTANT, KIND_WORD, POOL_PARAMS, TRIMESH_PARAM_WORDS, params),
    MESH(37, ROLE_STATE, KIND_WORD, POOL_STATE, TRIMESH_STATE_WORDS, state),
    MESH(38, ROLE_STATE, KIND_ID, POOL_TRIANGLES, TRIMESH_TRIANGLE_IDS, triangle),
    MESH(39, ROLE_STATE, KIND_WORD, POOL_TRIANGLES, 1, area),
    MESH(40, ROLE_STATE, KIND_BYTE, POOL_TRIANGLES, 1, edge_marks),
    MESH(41, ROLE_STATE, KIND_BYTE, POOL_TRIANGLES, 1, material),
    MESH(42, ROLE_STATE, KIND_WORD, POOL_PARTICLES, 1, u),
    MESH(43, ROLE_STATE, KIND_WORD, POOL_PARTICLES, 1, v),
    MESH(44, ROLE_STATE, KIND_ID, POOL_PARTICLES, 1, first_triangle),
    SHEET(45, ROLE_CONSTANT, KIND_WORD, POOL_PARAMS, MAX_MATERIALS *MATERIAL_WORDS, membrane.materials),
    SHEET(46, ROLE_CONSTANT, KIND_WORD, POOL_PARAMS, MEMBRANE_PARAM_WORDS, membrane.constants),
    SHEET(47, ROLE_STATE, KIND_WORD, POOL_TRIANGLES, STIFFNESS_STATE_WORDS, membrane.stiffness),
    SHEET(48, ROLE_CONSTANT, KIND_WORD, POOL_PARAMS, MAX_MATERIALS *TEAR_STRENGTH_WORDS,
          membrane.tear_strengths),
#if FRAY_YARN_COLLISION
    {"yarn_collision", IMAGE_YARN_COLLISION, ROLE_CONSTANT, KIND_WORD, POOL_PARAMS, POOL_YARN_PAIRS,
     SELF_PARAM_WORDS, AT(self.constants)},
#endif
    MESH_TICK(POOL_PARTICLES, uint32_t, mass),
    MESH_TICK(POOL_TRIANGLES, trimesh_weights, weights),
    SHEET_TICK(POOL_PARTICLES, int32_t, membrane.inverse_mass),
    SHEET_TICK(POOL_TRIANGLES, membrane_gain, membrane.gains),
    SHEET_TICK(POOL_TRIANGLES, int32_t, membrane.strain_threshold),
    SHEET_TICK(POOL_TRIANGLES, material_tensor, membrane.stress),
    SHEET_TICK(POOL_TRIANGLES, bend_shape, membrane.bend_shapes),
    SHEET_TICK(POOL_TRIANGLES, bend_plate_words, membrane.plates),
    SHEET_TICK(POOL_TRIANGLES, bend_fold_words, membrane.folds),
    SHEET_TICK(POOL_TRIANGLES, bend_normal, membrane.normals),
    SHEET_TICK(POOL_TRIANGLES, bend_moment, membrane.moments),
    SHEET_TICK(POOL_PARTICLES, elastic_position, membrane.positions),
    SHEET_TICK(POOL_PARTICLES, elastic_impulse, membrane.impulse),
    SHEET_TICK(POOL_PARTICLES, elastic_impulse, membrane.forced),
    SHEET_TICK(POOL_PARTICLES, elastic_impulse, membrane.external_impulse),
#if FRAY_ENERGY
    SHEET_TICK(POOL_PARTICLES, metered_impulse, membrane.metered_impulses),
    SHEET_TICK(POOL_BODIES, metered_body, membrane.metered_bodies),
#endif
    SHEET_TICK(POOL_BODIES, elastic_body, membrane.bodies),
    SHEET_TICK(POOL_CONTACTS, contact_constraint[CONSTRAINTS_PER_CONTACT], membrane.constraints),
    SHEET_TICK(POOL_TRIANGLES, limited_edge[LIMITED_EDGES_PER_TRIANGLE], membrane.limited_edges),
    SHEET_TICK(POOL_PARTICLES, int32_t, membrane.low_x),
    SHEET_TICK(POOL_PARTICLES, int32_t, membrane.low_y),
    SHEET_TICK(POOL_PARTICLES, int32_t, membrane.low_z),
#if FRAY_MESHES
    {"meshes", IMAGE_RIGID_MESHES, ROLE_CONSTANT, KIND_WORD, POOL_RIGID_MESH_WORDS, POOL_RIGID_MESH_WORDS,
     1, AT(rigid.mesh_words)},
#if FRAY_TRIANGLES
    {"blades", IMAGE_BLADES, ROLE_CONSTANT, KIND_WORD, POOL_BLADES, POOL_BLADES, BLADE_WORDS,
     AT(membrane.blades)},
    {"passing_blade", 0, ROLE_TICK, KIND_BYTE, POOL_PARTICLES, POOL_BLADES, 1, AT(membrane.passing_blade)},
    {"near_blade", 0, ROLE_TICK, KIND_BYTE, POOL_TRIANGLES, POOL_BLADES, 1, AT(membrane.near_blade)},
#endif
#endif
#if FRAY_TRIANGLE_COLLISION
    {"triangle_collision", IMAGE_TRIANGLE_COLLISION, ROLE_CONSTANT, KIND_WORD, POOL_PARAMS,
     POOL_TRIANGLE_PAIRS, SELF_PARAM_WORDS, AT(self.constants)},
#endif
    SHEET(IMAGE_BEND_STATES, ROLE_STATE, KIND_WORD, POOL_TRIANGLES, BEND_STATE_WORDS, membrane.bend_states),
    YARN(IMAGE_YARN_CONTACTS, ROLE_STATE, KIND_WORD, POOL_YARN_CONTACTS, YARN_CONTACT_WORDS, woven.contacts),
#if FRAY_CRACKS
    {"cracks", IMAGE_CRACK_PARAMS, ROLE_CONSTANT, KIND_WORD, POOL_CRACKS, POOL_CRACKS, CRACK_PARAM_WORDS,
     AT(membrane.crack_constants)},
    {"tips", IMAGE_CRACK_STATE, ROLE_STATE, KIND_WORD, POOL_CRACKS, POOL_CRACKS, CRACK_STATE_WORDS,
     AT(membrane.cracks)},
    {"averaged", 0, ROLE_TICK, KIND_WORD, POOL_TRIANGLES, POOL_CRACKS, 1, AT(membrane.averaged)},
#endif
#if FRAY_HANDLES
    {"handles", IMAGE_HANDLE_PARAMS, ROLE_CONSTANT, KIND_WORD, POOL_HANDLES, POOL_HANDLES, HANDLE_PARAM_WORDS,
     AT(handles.constants)},
    {"handle_states", IMAGE_HANDLE_STATES, ROLE_STATE, KIND_WORD, POOL_HANDLES, POOL_HANDLES,
     HANDLE_STATE_WORDS, AT(handles.states)},
    {"handle_motion", 0, ROLE_TICK, KIND_STRUCT, POOL_HANDLES, POOL_HANDLES, sizeof(handle_motion),
     AT(handles.motion)},
#endif
    TICK(POOL_PARTICLES, int32_t, p.qx),
    TICK(POOL_PARTICLES, int32_t, p.qy),
    TICK(POOL_PARTICLES, int32_t, p.qz),
    TICK(POOL_BODIES, body_motion, rigid.motion),
    TICK(POOL_CONTACTS, contact, contact.list),
    TICK(POOL_BREAKS, torn_spring, woven.tear_queue),
    YARN(0, ROLE_TICK, KIND_STRUCT, POOL_YARN_CONTACTS, sizeof(yarn_contact_step), woven.contact_steps),
#if FRAY_ENERGY
    {"metered", 0, ROLE_TICK, KIND_STRUCT, POOL_PARTICLES, POOL_YARN_GAINS, sizeof(metered_yarn),
     AT(woven.metered)},
#endif
#if FRAY_MESHES
    WITH_MESHES(POOL_PARTICLES, int32_t, contact.start_x),
    WITH_MESHES(POOL_PARTICLES, int32_t, contact.start_y),
    WITH_MESHES(POOL_PARTICLES, int32_t, contact.start_z),
    WITH_MESHES(POOL_BODIES, vec3, rigid.start),
    {"aside", 0, ROLE_TICK, KIND_BYTE, POOL_PARTICLES, POOL_RIGID_MESH_WORDS, 1, AT(contact.side_mask)},
    WITH_MESHES(POOL_TRIANGLES, index_t, contact.near_triangles),
#endif
#if FRAY_YARN_COLLISION
    SELVES(KIND_STRUCT, POOL_PARTICLES, sizeof(self_path), self.paths),
    SELVES(KIND_STRUCT, POOL_PARTICLES, sizeof(self_grid_path), yarn.grid_paths),
    SELVES(KIND_STRUCT, POOL_CROSSINGS, SELF_BOXES * sizeof(self_box), yarn.boxes),
    SELVES(KIND_STRUCT, POOL_CROSSINGS, sizeof(uint32_t), yarn.rough_before),
    SELVES(KIND_STRUCT, POOL_YARN_PAIRS, sizeof(self_pair), yarn.pairs),
    SELVES(KIND_STRUCT, POOL_PARTICLES, sizeof(self_zone), self.zones),
    SELVES(KIND_ID, POOL_PARTICLES, 1, self.zone_of),
    SELVES(KIND_BYTE, POOL_PARTICLES, 1, self.moved_round),
#endif
#if FRAY_TRIANGLE_COLLISION
    LAYERS(KIND_STRUCT, POOL_PARTICLES, sizeof(self_path), self.paths),
    LAYERS(KIND_STRUCT, POOL_STATE, sizeof(triangle_pair_list), tri.list),
    LAYERS(KIND_STRUCT, POOL_TRIANGLE_PAIRS, sizeof(triangle_pair), tri.pairs),
    LAYERS(KIND_STRUCT, POOL_TRIANGLE_PAIRS, 2 * sizeof(uint32_t), tri.active),
    LAYERS(KIND_STRUCT, POOL_TRIANGLES, sizeof(triangle_travel), tri.travel),
    LAYERS(KIND_STRUCT, POOL_TRIANGLES, sizeof(int32_t), tri.predicted_travel),
    LAYERS(KIND_STRUCT, POOL_TRIANGLES, sizeof(triangle_box), tri.boxes),
    LAYERS(KIND_STRUCT, POOL_TRIANGLES, sizeof(uint32_t), tri.pair_counts),
    LAYERS(KIND_ID, POOL_TRIANGLES, 1, tri.order),
    LAYERS(KIND_ID, POOL_TRIANGLES, 1, tri.stale),
    LAYERS(KIND_STRUCT, POOL_TRIANGLES, sizeof(box_cluster), tri.clusters),
    LAYERS(KIND_STRUCT, POOL_PATCHES, sizeof(triangle_patch), tri.patches),
    LAYERS(KIND_STRUCT, POOL_PATCH_PAIRS, sizeof(patch_pair), tri.patch_pairs),
    LAYERS(KIND_ID, POOL_PARTICLES, 1, self.zone_of),
    LAYERS(KIND_BYTE, POOL_PARTICLES, 1, self.moved_round),
    LAYERS(KIND_STRUCT, POOL_PARTICLES, SELF_CONSTRAINTS * sizeof(self_constraint), tri.constraints),
#endif
#if FRAY_TRIANGLES && FRAY_MESHES
    REPEATS(KIND_STRUCT, POOL_ZONES, sizeof(self_zone), self.zones),
    REPEATS(KIND_STRUCT, POOL_STATE, sizeof(attempt_begin), attempt.begin),
    REPEATS(KIND_STRUCT, POOL_PARTICLES, sizeof(attempt_vertex), attempt.vertices),
    REPEATS(KIND_STRUCT, POOL_BODIES, sizeof(attempt_body), attempt.bodies),
    REPEATS(KIND_STRUCT, POOL_TRIANGLES, sizeof(bend_state), attempt.bend_states),
    REPEATS(KIND_WORD, POOL_TRIANGLES, 1, attempt.owed),
#endif
};
const uint32_t image_array_count = sizeof image_arrays / sizeof image_arrays[0];
