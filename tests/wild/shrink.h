/* SPDX-License-Identifier: Apache-2.0 */
/* Makes a scene shorter for as long as the same is found in it. */
#ifndef FRAY_TESTS_WILD_SHRINK_H
#define FRAY_TESTS_WILD_SHRINK_H

#include "tests/wild/judge.h"
#include "tests/wild/random_scene.h"

/* text: RANDOM_SCENE_ROOM bytes, changed. Tries at most `tries` runs of no more than the time at
 * which `kind` was found. Returns how many lines went. */
uint32_t shrink_scene(char *text, const judge_run *run, uint32_t kind, double seconds,
                      uint32_t tries);

#endif
