/* SPDX-License-Identifier: Apache-2.0 */
/* A scene as written, checked for form and range, in exact numbers: centimetres, seconds, grams, newtons,
 * plain ratios (5 % is 1/20), whatever the units of the text. Optional values have a `has_` or a stated
 * default. */
#ifndef FRAY_TOOLS_SCENE_LANGUAGE_SCENE_H
#define FRAY_TOOLS_SCENE_LANGUAGE_SCENE_H

#include <stddef.h>
#include <stdint.h>

#include "rt/fray.h"
#include "tools/scene_language/exact.h"
#include "tools/scene_language/material_table.h"
#include "tools/scene_language/source.h"

enum { SCENE_NAME = 32, SCENE_PATH = 256, SCENE_BODIES = 16, SCENE_KEYFRAMES = 4096, SCENE_PINS = 64,
       SCENE_SLITS = 64, SCENE_WEAVE = 8, SCENE_MATERIALS = 8, SCENE_LOADS = 4, SCENE_NOTES = 32 };

/* Blocks of a scene, in scene_source. */
enum {
  BLOCK_SCENE,
  BLOCK_CLOTH,
  BLOCK_LIMITS,
  BLOCK_HANDS,
  BLOCK_BODY,
  BLOCK_MATERIAL = BLOCK_BODY + SCENE_BODIES,
  BLOCKS = BLOCK_MATERIAL + SCENE_MATERIALS
};

typedef struct {
  exact at[3];
} scene_point;

typedef struct {
  exact time; /* s */
  exact at[3]; /* cm */
  scene_place place;
} scene_keyframe;

/* A rotation by an angle, as the tangent t of its half, a ratio, so that cosine and sine are exact:
 * cos = (1-t^2)/(1+t^2), sin = 2t/(1+t^2). The text gives degrees; angle_half_tangent() rounds t. */
typedef struct {
  int axis;    /* 0 x, 1 y, 2 z; -1: not rotated */
  exact half_tangent;
} scene_rotation;

/* The sharp edges and points of a mesh: none, those marked in its file, or those where its faces meet at
 * no more than an angle. */
typedef enum { SCENE_SHARP_OFF, SCENE_SHARP_NAMED, SCENE_SHARP_ANGLE } scene_sharp;

typedef struct {
  char name[SCENE_NAME];
  fray_shape shape;
  fray_motion motion;
  uint32_t hand;         /* for FRAY_HAND and handles */
  exact at[3];           /* cm; on a path: where the path begins */
  exact radius;          /* 0 where the shape has none */
  exact size[3];         /* twice its half sizes, 0 where it has none: of a capsule size[0] is the length
                            between its cap centres */
  scene_rotation rotation; /* box, capsule, plane, mesh; unrotated a capsule lies along x and a plane's
                            normal is +y; |angle| <= 170 degrees */
  exact friction;        /* default 0.3 */
  exact mass;            /* g; FRAY_FREE only, required there; of a hand it makes a handle */
  exact velocity[3];     /* cm/s; FRAY_FREE only, default 0 */
  int is_handle;         /* of a hand, with mass: FRAY_FREE, drawn to its proxy */
  exact coupling;        /* g/s2, default 1 N/mm */
  exact coupling_damping; /* s: its damping over its stiffness; below 0: 6 ticks */
  exact hand_scale, force_scale; /* of the way, of the force; defaults 1 */
  scene_rotation hand_rotation; /* the device's axes */
  int has_hand_offset;
  exact hand_offset[3];  /* cm: where the device's origin is; default: by START */
  int has_attach;
  exact attach_within;   /* crossings no farther than this from its surface are attached; 0 or less: inside
                            of it only */
  uint32_t key_first, keys; /* FRAY_PATH, in scene.keys; times strictly rising from >= 0 */
  char obj[SCENE_PATH];  /* mesh: the file, relative to the scene's */
  exact unit;            /* mesh: cm of a unit in that file, default 1 */
  scene_sharp sharp;     /* mesh: default SCENE_SHARP_OFF */
  exact sharp_tangent;   /* SCENE_SHARP_ANGLE: of half the angle, as for rotations */
} scene_body;

typedef struct {
  char name[SCENE_NAME];
  uint32_t stretch_rows, bend_rows; /* bits of the rows that it gives */
  material_spec cloth;
} scene_material;

typedef enum { PATTERN_REGULAR, PATTERN_ROTATED, PATTERN_IRREGULAR } scene_pattern;
typedef enum { EDGE_TOP, EDGE_BOTTOM, EDGE_LEFT, EDGE_RIGHT } scene_edge;

/* A force on a whole edge of a membrane, per length at rest. */
typedef struct {
  scene_edge edge;
  exact force[3]; /* N/m */
} scene_load;

/* Crossings attached to a body, or to their place; of a membrane the vertices at column lines i and row
 * lines j of its grid. */
typedef struct {
  uint32_t i0, i1, j0, j1; /* inclusive, inside the grid (checked) */
  char body[SCENE_NAME];   /* empty: their place */
  uint32_t by;             /* its number, SCENE_BODIES: none */
  scene_place place, by_place;
} scene_pin;

/* A cut before tick 0: through the yarns between two neighbouring yarns, or along a grid line of a
 * membrane. */
typedef struct {
  int beside_weft;           /* 0: the wefts from first to last, between warp `yarn` and the next; 1: warps */
  int of_membrane;           /* along column `yarn` from row first to last; or along a row */
  uint32_t yarn, first, last; /* inside the grid (checked) */
  scene_place place;
} scene_slit;

/* A key that has no effect where it stands. */
typedef struct {
  scene_place place;
  char text[160];
} scene_note;

typedef struct {
  char name[SCENE_NAME];
  scene_source source;    /* where its blocks and keys stand */
  scene_note notes[SCENE_NOTES];
  uint32_t note_count;

  uint32_t rate_hz;       /* default 1000 */
  uint32_t substeps;      /* 0: auto, the compiler finds it (default) */
  uint32_t iterations;    /* 0: auto; default 1 */
  exact gravity[3];       /* cm/s2, default 0 -981 0 */
  uint32_t seed;          /* default 1 */
  exact settle;           /* s in which the scene comes to rest before tick 0, default 0: none */
  exact max_rest_strain;  /* `auto` keeps every spring at rest below it, default 0.05 */

  struct {
    int present;
    uint32_t warps, wefts;
    exact warp_spacing;   /* cm between warps: distance of neighbours along a weft */
    exact weft_spacing;
    uint32_t weave_columns, weave_rows;
    uint8_t weave[SCENE_WEAVE][SCENE_WEAVE]; /* [row][column]: 1 the warp is over */
    char weave_name[SCENE_NAME];
    exact density;        /* g/cm2, default 0.25 */
    exact thickness;      /* cm, default 0.01 */
    exact bend, shear;    /* g/s2, defaults 5 and 2, or the most that a tick bears */
    int has_bend, has_shear;
    exact shear_lock;     /* tan of half the angle of shear at which yarns jam; 0 (default): none */
    exact structural; /* g/s2, default 6000; projection keeps the length, this is what pressed yarns push with
                       */
    exact tear_min, tear_max; /* defaults 0.05 0.10 */
    int tearing;          /* default 1 */
    int tear_mirrored;    /* default 0 */
    exact at[3];          /* centre of the cloth, cm */
    int vertical;         /* 1: in the x-y plane, weft 0 at the top (default); 0: in x-z,
                             weft 0 at -z */
    exact gather;         /* share of its width that pleats take up, 0..0.9, default 0 */
    uint32_t pleats;      /* default 8 */
    exact drag;           /* 1/s, default 0.5 */
    exact damping;        /* 1/s towards the rigid motion of the whole cloth, default 0 */
    int yarns;            /* 0 off (default), 1 on: crossings split where the cloth tears,
                             2 all: every free crossing is split from tick 0 on */
    int has_split_strain;
    exact split_strain_min, split_strain_max; /* defaults 9/10 of tear_min and tear_max */
    exact disconnect_at;  /* cm, default 0.02 */
    int disconnect_by_particles; /* default 0: by the distance of the yarns */
    int spread_splits;    /* default 0: what splits is decided by what holds it */
    exact slip_friction;  /* default 0 */
    exact static_friction; /* of a yarn at rest over that of one that slides, default 1 */
    exact crossing_friction; /* N, without tension in the yarns, default 0 */
    int self_collision;   /* 1: yarns, or triangles, do not pass through each other, default 0 */
    int has_self_thickness;
    exact self_thickness; /* cm: how far apart they are kept, default thickness */
    exact stretch;        /* N: a yarn's EA, its force at a strain of 1; 0 (default): inextensible,
                             by projection */
    exact stretch_damping; /* s: force of strain + this * its rate; default, less than 0: the compiler's
                              choice */
  } woven;

  /* Fields in common with woven cloth are in `woven`: density, thickness, at, vertical, drag, self_... */
  struct {
    int present;
    uint32_t columns, rows; /* of cells, two triangles each in a regular pattern */
    int collide_triangles;  /* triangles collide with meshes and spheres, not only vertices */
    exact cell[2];          /* cm, along rows and along columns */
    scene_pattern pattern;        /* default regular */
    exact pattern_half_tangent; /* PATTERN_ROTATED */
    uint32_t pattern_seed;      /* PATTERN_IRREGULAR */
    exact weft_half_tangent; /* angle of the weft against the rows, default 0 */
    char material[SCENE_NAME];
    scene_place material_place;
    material_spec cloth;      /* of that material, sanitized */
    uint32_t elastic_steps_max; /* in a tick, default 64: stiffer cloths are scaled down */
    exact strain_limit;      /* of edges; 0 (default): no limit */
    exact wind_normal, wind_drag; /* coefficients, defaults 1 and 0.1 */
  } membrane;
  scene_material materials[SCENE_MATERIALS];
  uint32_t material_count;
  int has_wind;
  exact wind[3];          /* cm/s; without it there is no air */
  scene_load loads[SCENE_LOADS];
  uint32_t load_count;

  scene_body bodies[SCENE_BODIES];
  uint32_t body_count;
  scene_keyframe keys[SCENE_KEYFRAMES];
  uint32_t key_count;
  scene_pin pins[SCENE_PINS];
  uint32_t pin_count;
  scene_slit slits[SCENE_SLITS];
  uint32_t slit_count;

  struct {
    int has_spare_particles, has_spare_triangles, has_contacts;
    uint32_t spare_triangles; /* default: of membranes one for each triangle */
    uint32_t spare_particles; /* default: one for each crossing of woven cloth with yarns, or vertex of a
                                 membrane; else 0 */
    uint32_t contacts;        /* default: one for each particle, spare ones too */
    uint32_t tears_per_tick;  /* default 16 */
    uint32_t splits_per_tick; /* default 32 */
    uint32_t self_collision_pairs; /* default: 16 for each crossing or triangle */
  } limits;

  struct {
    exact force_limit;    /* N, default 8 */
    exact force_rate;     /* N/s, default 4000 */
    exact speed;          /* cm/s at most of a body behind its hand, default 200 */
    exact ramp_up, ramp_down; /* s, defaults 0.1 and 0.01 */
    exact reserve;        /* J, default 0.01 */
    uint32_t delay;       /* ticks, default 2 */
  } hands;
} scene;

typedef struct {
  char file[256];
  int line, column;       /* from 1; 0: not about a place */
  char message[560];      /* found, expected, the known keys */
} scene_error;

/* Parses text into *out. Returns 1, or 0 with *error filled; out is then undefined. */
int scene_parse(const char *file, const char *text, size_t bytes, scene *out, scene_error *error);

#endif
