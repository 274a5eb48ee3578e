/* SPDX-License-Identifier: Apache-2.0 */
/* Bodies that cloth goes past on ways, each from where a substep began to where it is now: rigid meshes,
 * and balls where triangles of a sheet meet them. Bodies only translate, so all is as seen from one. */
#ifndef FRAY_STAGE_SOLIDS_H
#define FRAY_STAGE_SOLIDS_H

#include "rt/base/sweep.h"
#include "rt/model/mesh.h"

enum {
  SOLID_DEPTH_LEAST = 4,   /* what rounding leaves of a push */
  SOLID_SKIN_LEAST = 1024, /* of cloth without thickness: nothing may touch */
  SOLID_SLIDE_MOST = 16 * FX_LU,
  SOLID_TOO_MANY = MESH_CLOSE + 1
};

/* Bits of aside[]: what many ways share of the sides keeps them, and all between them, away. */
enum { SOLID_SIDES = 63, SOLID_STANDS = 64, SOLID_MOVED = 128 };

/* A body in this substep. */
typedef struct {
  uint32_t body;
  int32_t radius;   /* of a ball, which is its middle with this around it; 0: a mesh */
  int32_t sharp;    /* of a mesh: it cuts */
  mesh_parts m;     /* of a mesh */
  mesh_box around;
  vec3 before, now; /* where it stood and stands */
} solid;

/* Triangles of a mesh near a way, at most SOLID_TOO_MANY - 1. */
typedef struct {
  uint32_t count;
  uint16_t face[MESH_CLOSE];
} solid_near;

typedef struct {
  int32_t low[3], high[3];
} solid_span;

/* n below mesh_solids(): meshes first, each in the order of bodies. */
solid solid_at(const fray_world *w, uint32_t n);
int32_t solid_skin(const fray_world *w);
/* What was cut lets blades through: triangles beside a cut, vertices that only such ones have. */
static inline int solid_parts(const fray_world *w, const solid *t, uint32_t triangle) {
  return t->sharp != 0 && sheet_is_parted(&w->sheet, triangle);
}
static inline int solid_passes(const fray_world *w, const solid *t, uint32_t p) {
  return t->sharp != 0 && w->parted[p] != 0;
}

/* Triangles that miss it: all of their vertices stay on one side of its box, as aside[] has it. */
static inline int solid_misses(const fray_world *w, uint32_t triangle) {
  const row_id *v = w->sheet.triangle[triangle].v;
  return (w->aside[v[0]] & w->aside[v[1]] & w->aside[v[2]] & SOLID_SIDES) != 0;
}
/* Triangles that a body holds by a vertex. */
static inline int solid_grips(const fray_world *w, const solid *t, uint32_t triangle) {
  const row_id *v = w->sheet.triangle[triangle].v;
  for (uint32_t k = 0; k < 3; ++k)
    if (v[k] < (uint32_t)w->params->held && w->grip_body[v[k]] == t->body) return 1;
  return 0;
}

static inline sweep_point solid_way(const fray_world *w, const solid *t, uint32_t p) {
  const sweep_point went = {vec_sub(vec_make(w->sx[p], w->sy[p], w->sz[p]), t->before),
                           vec_sub(world_position(w, p), t->now)};
  return went;
}
/* Goes nowhere beside the body. */
static inline int solid_stays(const sweep_point *went) {
  return went->begin.x == went->end.x && went->begin.y == went->end.y && went->begin.z == went->end.z;
}
solid_span solid_span_of(const sweep_point *ways, uint32_t count, int32_t skin);
static inline int solid_overlap(const solid_span *s, const mesh_box *b) {
  return s->low[0] <= b->high[0] && s->high[0] >= b->low[0] && s->low[1] <= b->high[1] &&
         s->high[1] >= b->low[1] && s->low[2] <= b->high[2] && s->high[2] >= b->low[2];
}
static inline int solid_holds(const solid_span *s, vec3 v) {
  return v.x >= s->low[0] && v.x <= s->high[0] && v.y >= s->low[1] && v.y <= s->high[1] &&
         v.z >= s->low[2] && v.z <= s->high[2];
}
/* Differences go to 122 lu, sweeps to 60; bodies to 16, so what is farther off moves absurdly fast. */
static inline int solid_is_far(vec3 v) {
  return v.x < -FX_WORLD_MAX || v.x > FX_WORLD_MAX || v.y < -FX_WORLD_MAX || v.y > FX_WORLD_MAX ||
         v.z < -FX_WORLD_MAX || v.z > FX_WORLD_MAX;
}

/* On which sides of the box all of a way stays, a bit each; 0: it may come near. */
uint8_t solid_sides(const solid *t, const sweep_point *went, int32_t skin);

/* The triangles whose boxes the span overlaps; count SOLID_TOO_MANY where they are more than `most`, or the
 * boxes more than one is held against. */
void solid_list_near(fray_world *w, const solid *t, const solid_span *s, uint32_t most,
                     solid_near *near);

/* Whether the way of a particle touches the mesh, or may. */
int solid_crosses(fray_world *w, const solid *t, const sweep_point *went);
/* The same of triangles that are listed. */
int solid_crosses_near(fray_world *w, const solid *t, const solid_near *near, const sweep_point *went);
/* A particle's way against one triangle. */
int solid_meets(fray_world *w, const solid *t, uint32_t face, const sweep_point *went, int32_t skin,
                sweep_contact *c);

static inline int32_t solid_gap(const solid *t, uint32_t face, vec3 at) {
  return vec_dot_unit(vec_sub(at, mesh_corner(&t->m, face, 0)), mesh_vec(t->m.faces[face].normal));
}

/* `at`, moved by `depth` along a unit vector. */
vec3 solid_pushed(vec3 at, vec3 out, int32_t depth);
/* Moves a particle to a place beside the body, which gets what the cloth gains. */
void solid_place(fray_world *w, const solid *t, uint32_t p, vec3 beside);
/* It keeps its place beside the body. */
void solid_stand(fray_world *w, const solid *t, uint32_t p, const sweep_point *went);
/* Returns 0 where the pool is full. */
int solid_add_contact(fray_world *w, const solid *t, uint32_t p, vec3 out);

/* Triangles of a sheet against one body (rt/stage/press.c), where aside[] has what solid_sides() says of each
 * particle: pushes them out, then lets no way cross it. `left`: how many may be pushed, and held against it,
 * yet. Returns PRESS_FREE, or who holds vertices that would have to give way to the body. */
enum { PRESS_FREE = 0xFFFF };
uint32_t press_run(fray_world *w, const solid *t, uint32_t left[2]);
/* The last part again, behind what another body did. Returns how many stand for it; *holder as above. */
uint32_t press_look(fray_world *w, const solid *t, uint32_t *left, uint32_t *holder);
/* All that is near keeps its place beside the body. */
void press_stand(fray_world *w, const solid *t);

#endif
