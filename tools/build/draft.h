/* SPDX-License-Identifier: Apache-2.0 */
/* A scene on its way to an image: the tables that later stages of the compiler need.
 * Stages, in order: scale (units), shape (bodies, crossings, who is held), order (levels, particle
 * numbers), rows (in batches), fill (the world), settle (the test run). Integers only. */
#ifndef FRAY_BUILD_DRAFT_H
#define FRAY_BUILD_DRAFT_H

#include "rt/model/mesh.h"
#include "tools/build/build.h"
#include "tools/build/obj.h"

typedef struct {
  uint32_t kind;      /* BATCH_HELD, BATCH_FREE, BATCH_IDLE: the order of stepping */
  uint32_t colour;
  uint32_t level;     /* the lesser one of its ends */
  uint32_t step;      /* when it is stepped */
  uint32_t band;      /* of springs: the part of the particles that they are of */
  uint32_t rank;      /* in its batch: how long the piece of a run is that it belongs to */
  uint32_t along_warp;
  uint32_t ordered;   /* a link */
  uint32_t canonical;
  uint32_t i, j;      /* particles */
} draft_row;

/* Tables of rt/model/mesh.h that grow, and the meshes in them. */
typedef struct {
  mesh_head head;
  mesh_entry mesh[LIMIT_BODIES];
  mesh_point *points;
  mesh_edge *edges;
  mesh_face *faces;
  mesh_box *boxes;
} draft_mesh;

typedef struct {
  const scene *scene;
  const char *file;
  scene_error *error;

  weave grid;
  uint32_t crossings;
  uint32_t substeps, sweeps;
  uint32_t lu_um;
  exact lu_per_cm;
  int32_t spacing[2];        /* Q24 lu along wefts, along warps */
  exact particle_mass;       /* g */

  uint32_t inner;            /* of triangle sheets: steps of the stress in a substep */
  exact stiffness;           /* of them: share of the measured one, at most 1 */

  vec3 *place;               /* crossing, or vertex -> Q24 lu */
  uint8_t *holder;           /* crossing -> body, or DRAFT_FREE */
  uint32_t *level;           /* crossing -> steps from the nearest held crossing */
  uint8_t *source;           /* crossing -> body that holds the nearest held one */
  uint32_t *particle;        /* crossing -> particle */
  uint32_t *crossing;        /* particle -> crossing */
  uint32_t held;
  uint32_t bodies;           /* the scene's, and one anchor if it pins anything */
  body body[LIMIT_BODIES];
  draft_mesh meshes;
  draft_row *rows;
  uint32_t family_rows[4];   /* the last: shadows of the diagonals, of sheets with yarns */
  row_batch *batches;
  uint32_t family_batches[4];
  uint32_t batch_count;
} draft;

enum { DRAFT_FREE = 255, DRAFT_SHADOWS = 3 };

/* The builder owns a world's tables: it alone writes what rt/ holds constant. */
#define WRITABLE(type, field) ((type *)(uintptr_t)(field))

/* Each returns 1, or 0 with the error filled. */
int draft_scale(draft *d);
int draft_bodies(draft *d);
int draft_crossings(draft *d);
/* The mesh of body n of the scene, its size as it is turned; fills reach[]. */
int draft_mesh_of(draft *d, uint32_t n);
/* Marks what is sharp in the mesh that was added last. */
int draft_mesh_sharpen(const draft *d, const scene_body *b, const char *file, const obj_mesh *obj);
uint32_t draft_mesh_words(const draft *d);
/* Whether all free particles, or all triangles, begin apart from all meshes by a quarter of the thickness. */
int draft_mesh_apart(const draft *d, const fray_world *w);
void draft_mesh_fill(const draft *d, int32_t *words);
int draft_order(draft *d);
int draft_rows(draft *d);
int draft_params(const draft *d, params *p);
int draft_classes(const draft *d, link_class *links, spring_class *springs);
int draft_yarns(const draft *d, yarn_params *y);
int draft_selves(const draft *d, selves_params *k);
int draft_slits(const draft *d, fray_world *w);
int draft_stretch(const draft *d, const link_class *links, stretch_params *p, stretch_class *pulls,
                  link_class *limits, uint32_t classes);

/* 2^ of it: the inner steps that yarns of this stiffness need in each of so many substeps; -1: too many.
 * And the fewest substeps that will do; above LIMIT_SUBSTEPS: none. */
int stretch_steps_bits(const scene *s, uint32_t substeps);
uint32_t stretch_substeps_least(const scene *s);
static inline int scene_has_stretch(const scene *s) {
  return exact_compare(s->sheet.stretch, exact_make(0, 1)) > 0;
}
/* The holders of d->crossings places, by bodies that grip them; then, where nobody does, by pins of
 * columns and rows (NULL: by the grid); d->held counts them. */
int draft_holders(draft *d, const uint32_t *column, const uint32_t *row);
/* The world's bodies and their keys, written. */
int draft_fill_bodies(const draft *d, fray_world *w);
/* value * 2^shift in [least, most], or an error that names the key. */
int draft_word(const draft *d, const char *key, exact value, unsigned shift, int64_t least, int64_t most,
               int32_t *out);
/* Of triangle sheets: what in a woven one are scale, crossings, order, rows and filling. */
int draft_triangles(draft *d, void **memory, fray_world **world);
/* Substeps of a scene of triangles that leaves them open. */
enum { TRIANGLE_SUBSTEPS = 1 };

/* Neighbours of a crossing: before and after it along its weft, along its warp; itself at the edge. */
void draft_neighbours(const draft *d, uint32_t crossing, uint32_t near[4]);

/* Always 0: fills the error. `line` 0 when it is about no place in particular. */
int draft_refuse(const draft *d, int line, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* a, in centimetres, to Q24 lu; refuses what lies outside of the world. */
int draft_length(const draft *d, int line, exact centimetres, int32_t *lu);
int draft_place(const draft *d, int line, const exact at[3], vec3 *place);

#endif
