/* SPDX-License-Identifier: Apache-2.0 */
/* Keys that woven cloth and membranes have in common: fields of scene.woven for both. */
#ifndef FRAY_TOOLS_SCENE_LANGUAGE_CLOTH_KEYS_H
#define FRAY_TOOLS_SCENE_LANGUAGE_CLOTH_KEYS_H

#include <stddef.h>

#include "tools/scene_language/parser.h"

int cloth_orientation_read(parser *p, const block_key *key, void *target);
int cloth_self_collision_read(parser *p, const block_key *key, void *target);

#define CLOTH_FIELD(field) offsetof(scene, woven.field)
#define CLOTH_KEYS \
  {"at", block_exacts, CLOTH_FIELD(at), {UNIT_LENGTH, "-6000", "6000"}, 3, 0}, \
      {"orientation", cloth_orientation_read, 0, NO_RANGE, 0, 0}, \
      {"thickness", block_exacts, CLOTH_FIELD(thickness), {UNIT_LENGTH, "0.0001", "1"}, 1, 0}, \
      {"drag", block_exacts, CLOTH_FIELD(drag), {UNIT_RATE, "0", "1000"}, 1, 0}, \
      {"self_collision", cloth_self_collision_read, 0, NO_RANGE, 0, 0}, \
      {"self_thickness", block_exacts, CLOTH_FIELD(self_thickness), {UNIT_LENGTH, "0.0001", "1"}, 1, 0}

#endif
