/* SPDX-License-Identifier: Apache-2.0 */
/* A scene as written: what the text says, checked for form and range, in exact numbers.
 * Lengths are centimetres, times seconds, masses grams, forces newtons, shares plain ratios
 * (5 % is 1/20); whatever unit the text used. Optional things have a `has_` or a stated default. */
#ifndef FRAY_BUILD_SCENE_H
#define FRAY_BUILD_SCENE_H

#include <stddef.h>
#include <stdint.h>

#include "rt/fray.h"
#include "tools/build/exact.h"
#include "tools/build/fabrics.h"

enum { SCENE_NAME = 32, SCENE_PATH = 256, SCENE_BODIES = 16, SCENE_KEYS = 4096, SCENE_PINS = 64, SCENE_SLITS = 64, SCENE_WEAVE = 8,
       SCENE_MATERIALS = 8, SCENE_LOADS = 4 };

typedef struct {
  exact at[3];
} scene_point;

typedef struct {
  exact time; /* s */
  exact at[3]; /* cm */
} scene_key;

/* Turned by quarter-exact means only: three axes as rows of exact direction cosines would not be
 * exact, so a turn is a rotation by an angle whose tangent of half is the ratio t:
 * cos = (1-t^2)/(1+t^2), sin = 2t/(1+t^2). The text gives degrees; the parser takes the nearest t
 * with denominator 4096. */
typedef struct {
  int axis;    /* 0 x, 1 y, 2 z; -1: not turned */
  exact half_tangent;
} scene_turn;

/* Which edges and points of a mesh are sharp: none, those that the file marks, or those at which its
 * faces meet at no more than an angle. */
typedef enum { SCENE_SHARP_OFF, SCENE_SHARP_NAMED, SCENE_SHARP_ANGLE } scene_sharp;

typedef struct {
  char name[SCENE_NAME];
  int line;              /* where it was declared, for messages */
  fray_shape shape;
  fray_motion motion;
  uint32_t hand;         /* for FRAY_HAND */
  exact at[3];           /* cm; on a path: where the path begins */
  exact radius;          /* ball, bar */
  exact size[3];         /* box: full sizes; bar: size[0] is its length between the cap centres */
  scene_turn turn;       /* bar, box, plane; before it a bar lies along x and a
                            plane's normal is +y; |angle| <= 170 degrees */
  exact friction;        /* default 0.3 */
  exact mass;            /* g; FRAY_FREE only, required there */
  exact velocity[3];     /* cm/s; FRAY_FREE only, default 0 */
  int has_grip;
  exact grip;            /* crossings no farther than this from the body's surface are held by it;
                            0 or less than 0 is allowed (inside only) */
  uint32_t key_first, keys; /* FRAY_PATH, in scene.keys; times strictly rising from >= 0 */
  char obj[SCENE_PATH];  /* mesh: the file, from where the scene's stands */
  exact unit;            /* mesh: cm of a unit in that file, default 1 */
  scene_sharp sharp;     /* mesh: default SCENE_SHARP_OFF */
  exact sharp_tangent;   /* SCENE_SHARP_ANGLE: of half the angle, as for turns */
} scene_body;

typedef struct {
  char name[SCENE_NAME];
  int line;
  fabric_draft cloth;
} scene_material;

typedef enum { MESH_REGULAR, MESH_TURNED, MESH_IRREGULAR } scene_mesh;
typedef enum { SIDE_TOP, SIDE_BOTTOM, SIDE_LEFT, SIDE_RIGHT } scene_side;

/* A force on a side of a triangle sheet, per length of it at rest. */
typedef struct {
  scene_side side;
  int line;
  exact force[3]; /* N/m */
} scene_load;

/* Crossings held where they are, or by a body; of a triangle sheet the vertices of its grid, of its columns i and
 * rows j. */
typedef struct {
  uint32_t i0, i1, j0, j1; /* inclusive, inside the grid (checked) */
  char body[SCENE_NAME];   /* empty: where they are */
  uint32_t by;             /* its number, SCENE_BODIES: none */
  int line, column;
} scene_pin;

/* What is cut before tick 0: the yarns that cross between a yarn and the next one, or a triangle sheet along
 * a line of its grid. */
typedef struct {
  int beside_weft;            /* 0: the wefts from first to last, between warp `yarn` and the next; 1: warps */
  int of_triangles;           /* along column `yarn` from row first to last; or along a row */
  uint32_t yarn, first, last; /* inside the grid (checked) */
  int line, column;
} scene_slit;

typedef struct {
  char name[SCENE_NAME];

  uint32_t rate_hz;       /* default 1000 */
  uint32_t substeps;      /* 0: auto, the compiler finds it (default) */
  uint32_t sweeps;        /* 0: auto; default 1 */
  exact gravity[3];       /* cm/s2, default 0 -981 0 */
  uint32_t seed;          /* default 1 */
  exact settle;           /* s to come to rest in before tick 0, default 0: starts as placed */
  exact rest_strain;      /* no spring at rest may reach it, default 0.05; finds the substeps */

  struct {
    int present, line;
    uint32_t warps, wefts;
    exact warp_spacing;   /* cm between warps: distance of neighbours along a weft */
    exact weft_spacing;
    uint32_t weave_columns, weave_rows;
    uint8_t weave[SCENE_WEAVE][SCENE_WEAVE]; /* [row][column]: 1 the warp is over */
    char weave_name[SCENE_NAME];
    exact density;        /* g/cm2, default 0.25 */
    exact thickness;      /* cm, default 0.01 */
    exact bend, shear;    /* g/s2, defaults 5 and 2 */
    exact structural;     /* g/s2, default 6000: recorded, carried by projection */
    exact tear_min, tear_max; /* defaults 0.05 0.10 */
    int tearing;          /* default 1 */
    int tear_mirrored;    /* default 0 */
    exact at[3];          /* centre of the sheet, cm */
    int vertical;         /* 1: in the x-y plane, weft 0 at the top (default); 0: in x-z,
                             weft 0 at -z */
    exact gather;         /* share of its width that the sheet is pushed together, 0..0.9,
                             default 0 */
    uint32_t pleats;      /* folds that take up what gather takes away, default 8 */
    exact drag;           /* 1/s, default 0.5 */
    exact damping;        /* 1/s towards the rigid motion of the whole sheet, default 0 */
    int yarns;            /* 0 off (default), 1 on: crossings split where the cloth tears,
                             2 all: every free crossing is split from tick 0 on */
    int has_transition;
    exact transition_min, transition_max; /* defaults 9/10 of tear_min and tear_max */
    exact loose;          /* cm, default 0.02 */
    int loose_by_particles; /* that distance is between the particles, default 0: between the yarns */
    exact slip_friction;  /* default 0 */
    exact slip_grip;      /* N that a crossing holds back by itself, default 0 */
    int selves;           /* 1: yarns, or triangles, do not pass through each other, default 0 */
    int has_self_thickness;
    exact self_thickness; /* cm: how far apart they are kept, default thickness */
    int has_crimp;
    exact crimp;          /* share of the yarns' waves that is in their rest length, default 0; with a
                             stretch: as much as keeps their tension where they split */
    exact stretch;        /* N: force of a yarn at a strain of 1 (its EA); 0: carried by projection,
                             whatever force that takes (default) */
    exact stretch_damping; /* s: force is that of strain + this * its rate, default less than 0: the compiler's
                              choice */
  } sheet;

  /* What it shares with woven sheets stands there: density, thickness, at, vertical, drag. */
  struct {
    int present, line;
    uint32_t columns, rows; /* of cells, two triangles each where the mesh is regular */
    int whole;              /* its triangles meet meshes and balls, not only its vertices */
    exact edge[2];          /* cm, along rows and along columns */
    scene_mesh mesh;        /* default regular */
    exact mesh_half_tangent; /* MESH_TURNED */
    uint32_t mesh_seed;      /* MESH_IRREGULAR */
    exact weft_half_tangent; /* of the weft against the rows, default 0 */
    char material[SCENE_NAME];
    int material_line, material_column;
    fabric_draft cloth;      /* of that material, mended */
    uint32_t inner_steps;    /* most in a tick, default 64: stiffer cloths are scaled down */
    exact strain_limit;      /* no side grows longer than by this share; 0: default, no limit */
    exact wind_normal, wind_drag; /* coefficients, defaults 1 and 0.1 */
  } triangles;
  scene_material materials[SCENE_MATERIALS];
  uint32_t material_count;
  int has_wind;
  exact wind[3];          /* cm/s; without it there is no air */
  scene_load loads[SCENE_LOADS];
  uint32_t load_count;

  scene_body bodies[SCENE_BODIES];
  uint32_t body_count;
  scene_key keys[SCENE_KEYS];
  uint32_t key_count;
  scene_pin pins[SCENE_PINS];
  uint32_t pin_count;
  scene_slit slits[SCENE_SLITS];
  uint32_t slit_count;

  struct {
    int has_spare_particles, has_spare_triangles, has_contacts;
    uint32_t spare_triangles; /* default: of triangle sheets as many as triangles */
    uint32_t spare_particles; /* default: with yarns as many as crossings, of triangle sheets as many
                                 as vertices, else 0 */
    uint32_t contacts;        /* default: as many as crossings */
    uint32_t cuts_per_tick;   /* default 16 */
    uint32_t splits_per_tick; /* default 32 */
    uint32_t self_pairs;      /* default: 16 times as many as crossings or triangles */
  } limits;

  struct {
    exact force_limit;    /* N, default 8 */
    exact force_rate;     /* N/s, default 4000 */
    exact speed;          /* cm/s that a body follows a hand at most, default 200 */
    exact ramp, fade;     /* s, defaults 0.1 and 0.01 */
  } hands;
} scene;

typedef struct {
  char file[256];
  int line, column;       /* from 1; 0: not about a place */
  char message[400];      /* what was found, what was expected, the known keys */
} scene_error;

/* Parses text into *out. Returns 1, or 0 with *error filled; out is then undefined. */
int scene_parse(const char *file, const char *text, size_t bytes, scene *out, scene_error *error);

#endif
