/* SPDX-License-Identifier: Apache-2.0 */
/* Random scenes: a number gives the same scene on every machine. */
#ifndef FRAY_TESTS_WILD_RANDOM_SCENE_H
#define FRAY_TESTS_WILD_RANDOM_SCENE_H

#include <stddef.h>
#include <stdint.h>

enum { RANDOM_SCENE_ROOM = 16384 };

/* What the cloth of a scene is: it is stated, so that findings can be counted by it. */
typedef enum {
  RANDOM_WOVEN,
  RANDOM_YARNS,
  RANDOM_STRETCH, /* yarns with a stiffness */
  RANDOM_MEMBRANE,
  RANDOM_SHEET, /* an isotropic membrane, with cracks and handles */
  RANDOM_KINDS
} random_kind;
extern const char *const random_kind_name[RANDOM_KINDS];

/* Writes the scene of this seed and number into text, RANDOM_SCENE_ROOM bytes: a cloth of any kind,
 * densities and rates over two decades, bodies of every shape and motion, hands, wind, loads, pins,
 * slits, pools that may be too small. Meshes are named as seen from out/wild. */
random_kind random_scene_write(uint64_t seed, uint64_t number, char *text);

/* The pose of a hand in a tick, 2 um a step: presses, draws or waves, as the seed says. */
void random_scene_pose(uint64_t seed, uint64_t number, uint32_t hand, double seconds,
                       int16_t at[3]);

#endif
