/* SPDX-License-Identifier: Apache-2.0 */
/* A scene on its way to an image: the tables that later stages of the compiler need. Stages, in order:
 * scale (units), placement (bodies, crossings, attachments), particle_order, spring_batches, compile (fills
 * the world), settle (the test run). Integers only. */
#ifndef FRAY_TOOLS_SCENE_COMPILER_DRAFT_H
#define FRAY_TOOLS_SCENE_COMPILER_DRAFT_H

#include "rt/state/rigid_mesh.h"
#include "tools/scene_compiler/compile.h"
#include "tools/mesh_import/obj.h"

typedef struct {
  uint32_t kind;      /* BATCH_ATTACHED, BATCH_FREE, BATCH_INACTIVE: the order of stepping */
  uint32_t colour;
  uint32_t level;     /* the lower one of its ends */
  uint32_t step;      /* its place in the order of batches */
  uint32_t band;      /* of bend and shear springs: the band of particles of its ends */
  uint32_t rank;      /* in its batch: by the length of its piece of a run */
  uint32_t along_warp;
  uint32_t ordered;   /* a link */
  uint32_t canonical;
  uint32_t i, j;      /* particles */
} draft_spring;

/* Tables of rt/state/rigid_mesh.h that grow, and the meshes in them. */
typedef struct {
  rigid_mesh_head head;
  rigid_mesh_entry mesh[MAX_BODIES];
  rigid_mesh_point *points;
  rigid_mesh_edge *edges;
  rigid_mesh_face *faces;
  rigid_mesh_box *boxes;
} draft_rigid_meshes;

typedef struct {
  const scene *scene;
  const char *file;
  scene_error *error;

  yarn_grid grid;
  uint32_t crossings;
  uint32_t substeps, iterations;
  uint32_t lu_um;
  exact lu_per_cm;
  int32_t spacing[2];        /* Q24 lu along wefts, along warps */
  exact particle_mass;       /* g */

  uint32_t elastic_steps;    /* of membranes, in a substep */
  exact stiffness;           /* of membranes: factor of the material's, at most 1 */

  vec3 *place;               /* crossing, or vertex -> Q24 lu */
  uint8_t *holder;           /* crossing -> body, or DRAFT_FREE */
  uint32_t *level;           /* crossing -> distance to the nearest attached one, in crossings */
  uint8_t *source;           /* crossing -> body of the nearest attached one */
  uint32_t *particle;        /* crossing -> particle */
  uint32_t *crossing;        /* particle -> crossing */
  uint32_t attached;         /* crossings */
  uint32_t bodies;           /* the scene's, and an anchor if there are pins */
  rigid_body body[MAX_BODIES];
  draft_rigid_meshes meshes;
  draft_spring *springs;
  uint32_t springs_of_kind[4];   /* the last: second diagonals, of split crossings */
  spring_batch *batches;
  uint32_t batches_of_kind[4];
  uint32_t batch_count;
} draft;

enum { DRAFT_FREE = 255, DRAFT_SHADOWS = 3 };

/* The compiler owns a world's tables: it writes what is constant in rt/. */
#define WRITABLE(type, field) ((type *)(uintptr_t)(field))

/* Each returns 1, or 0 with the error filled. */
int draft_scale(draft *d);
int draft_place_bodies(draft *d);
int draft_place_crossings(draft *d);
/* The mesh of body n of the scene, rotated; fills aabb_half[]. */
int draft_rigid_mesh_load(draft *d, uint32_t n);
/* Marks sharp edges and points of the mesh that was added last. */
int draft_find_sharp_edges(const draft *d, const scene_body *b, const char *file, const obj_mesh *obj);
uint32_t draft_rigid_mesh_words(const draft *d);
/* Refuses free particles, or triangles, that begin nearer to a mesh than a quarter of the thickness. */
int draft_mesh_clearance(const draft *d, const fray_world *w);
/* Refuses free bodies that begin inside of planes or other bodies, deeper than the thickness. */
int draft_body_clearance(const draft *d, const fray_world *w);
void draft_rigid_mesh_fill(const draft *d, int32_t *words);
int draft_order_particles(draft *d);
int draft_make_springs(draft *d);
int draft_params(const draft *d, params *p);
int draft_classes(const draft *d, link_class *links, bend_shear_class *springs);
int draft_yarns(const draft *d, yarn_params *y);
int draft_yarn_collision(const draft *d, self_params *k);
int draft_slits(const draft *d, fray_world *w);
/* A hand moves a handle; and the constants of handles, their proxies where they are. */
int draft_has_handles(const draft *d);
int draft_handles(const draft *d, fray_world *w);
/* Rows of a rotation, Q30. */
int draft_turn(const draft *d, uint32_t block, const char *key, const scene_rotation *by, int32_t axes[9]);
int draft_yarn_elastic(const draft *d, const link_class *links, yarn_elastic_params *p, yarn_gain *pulls,
                       uint32_t classes);

/* log2 of the elastic steps that the yarns need in each of `substeps`; -1: too many. And the fewest substeps
 * that are enough; above MAX_SUBSTEPS: none. */
int yarn_elastic_steps_bits(const scene *s, uint32_t substeps);
uint32_t yarn_elastic_min_substeps(const scene *s);
static inline int scene_has_stretch(const scene *s) {
  return exact_compare(s->woven.stretch, exact_make(0, 1)) > 0;
}
/* The holders of all crossings, by attach_within of bodies, then by pins of columns and rows (NULL: of the
 * woven grid); d->attached counts them. */
int draft_attach(draft *d, const uint32_t *column, const uint32_t *row);
/* Places of particles; where attached ones are in their bodies. After draft_fill_bodies(). */
void draft_fill_particles(const draft *d, fray_world *w);
/* The world's bodies and their keyframes. */
int draft_fill_bodies(const draft *d, fray_world *w);
/* A number of the scene, in the units of scene.h, and the key that gives it. */
typedef struct {
  uint32_t block;
  const char *key;
  unit_quantity quantity;
  exact given;
} draft_number;
static inline draft_number draft_given(uint32_t block, const char *key, unit_quantity quantity, exact given) {
  const draft_number n = {block, key, quantity, given};
  return n;
}
/* value * 2^shift in [min, max], where value is the number times what does not depend on it. */
int draft_fixed_point(const draft *d, draft_number n, exact value, unsigned shift, int64_t min, int64_t max,
                      int32_t *out);
/* All stages up to a filled world, for membranes. */
int draft_membrane(draft *d, void **memory, fray_world **world);
/* Of membranes, where a scene gives no number. */
enum { MEMBRANE_SUBSTEPS = 1 };

/* Neighbours of a crossing: before and after it along its weft, along its warp; itself at the edge. */
void draft_neighbours(const draft *d, uint32_t crossing, uint32_t near[4]);

/* Always 0: fill the error. The second: "found 'KEY VALUES', expected ..." where that key stands. */
int draft_refuse(const draft *d, scene_place place, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
int draft_expected(const draft *d, uint32_t block, const char *key, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
int draft_no_memory(const draft *d);
/* source_value() of the draft's scene. */
const char *draft_value(const draft *d, uint32_t block, const char *key, unit_quantity quantity, exact value,
                        int way, char text[SOURCE_VALUE]);
/* a, in centimetres, to Q24 lu; refuses what lies outside of the world. */
int draft_length(const draft *d, uint32_t block, const char *key, exact centimetres, int32_t *lu);
/* Always 0: the cloth, as large as its keys make it, does not fit where it is. */
int draft_outside(const draft *d);
/* Of any key; of key `at` of that block; a keyframe of the path of that body. */
int draft_place(const draft *d, uint32_t block, const char *key, const exact at[3], vec3 *place);
int draft_position(const draft *d, uint32_t block, const exact at[3], vec3 *place);
int draft_keyframe(const draft *d, uint32_t block, const scene_keyframe *key, vec3 *place);
/* The block and the key that give `key` of the membrane's material: of a measured one `material` of the
 * cloth. */
uint32_t draft_material(const draft *d, const char **key);

#endif
