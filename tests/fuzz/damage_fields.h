/* SPDX-License-Identifier: Apache-2.0 */
/* Damages an image where it hurts: elements of its sections, one or all of them, get values in their ranges,
 * at their limits and just past them. */
#ifndef FRAY_TESTS_FUZZ_DAMAGE_FIELDS_H
#define FRAY_TESTS_FUZZ_DAMAGE_FIELDS_H

#include "rt/base/bytes.h"
#include "rt/image/image.h"
#include "tests/lib/splitmix64.h"

typedef struct {
  uint32_t id, bytes, count, at; /* of elements; offset in the image */
} damage_section;

static uint64_t damage_draws;
static inline uint32_t damage_below(uint32_t n) { return (uint32_t)((splitmix64(&damage_draws) >> 32) * n >> 32); }

#define BODY_WORD(field) (offsetof(rigid_body, field) / 4)
static inline word_range damage_body_range(uint32_t n) {
  const word_range place = {-FX_WORLD_MAX, FX_WORLD_MAX}, size = {0, 16 * FX_LU}, unit = {-(1 << 30), 1 << 30};
  if (n == BODY_WORD(shape)) return (word_range){FRAY_ANCHOR, SHAPES_END - 1};
  if (n == BODY_WORD(motion)) return (word_range){FRAY_FIXED, FRAY_FREE};
  if (n == BODY_WORD(hand)) return (word_range){0, 1};
  if (n == BODY_WORD(friction)) return (word_range){0, 16 << 16};
  if (n == BODY_WORD(mass_ratio)) return (word_range){0, 1 << 30};
  if (n == BODY_WORD(keyframes) || n == BODY_WORD(keyframe_first)) return (word_range){0, 4};
  if (n >= BODY_WORD(axes) && n < BODY_WORD(axes) + 9) return unit;
  if (n >= BODY_WORD(start)) return place;
  if (n >= BODY_WORD(aabb_half) && n < BODY_WORD(aabb_half) + 3) return (word_range){0, 64 * FX_LU - 1};
  return size;
}
static inline word_range damage_body_state_range(uint32_t n) {
  const word_range place = {-FX_WORLD_MAX, FX_WORLD_MAX}, remainder = {-8, 8}, any = {-INT32_MAX, INT32_MAX},
                   fraction = {0, (1 << 30) - 1};
  return n < 3 ? place : n < 6 ? remainder : n < 9 ? any : fraction;
}

static inline word_range damage_tip_range(uint32_t n) {
  const word_range tips = {0, CRACK_TIPS}, vertex = {0, 16}, way = {-(1 << 30), 1 << 30};
  return n == 0 ? tips : n % 3 == 1 ? vertex : way;
}
static inline word_range damage_bend_range(uint32_t n) {
  const word_range offset = {-BEND_OFFSET_MAX, BEND_OFFSET_MAX}, habit = {0, BEND_HABIT_MAX}, faded = {0, BEND_ONE},
                   owed = {-BEND_ENERGY_MAX, BEND_ENERGY_MAX};
  return n < 3 ? offset : n < 3u + SMOOTHED_STRAIN_POLES ? habit : n == 3u + SMOOTHED_STRAIN_POLES ? faded : owed;
}
static inline word_range damage_stiffness_range(uint32_t n) {
  const word_range strain = {-STRAIN_MAX, STRAIN_MAX}, stiff = {0, MATERIAL_STIFF_MAX},
                   owed = {-MATERIAL_ENERGY_MAX, MATERIAL_ENERGY_MAX};
  return n < 3u * SMOOTHED_STRAIN_POLES ? strain : n < 3u * SMOOTHED_STRAIN_POLES + MATERIAL_ENTRIES ? stiff : owed;
}
static inline word_range damage_yarn_contact_range(uint32_t n) {
  const word_range place = {0, 8 << YARN_PLACE_BITS}, offset = {-YARN_OFFSET_MAX, YARN_OFFSET_MAX},
                   grip = {0, YARN_PRESSED_MAX << 2 | 3};
  return n < 2 ? place : n < 5 ? offset : grip;
}

/* Words with a range of their own; other words may be anything. */
static inline word_range damage_range(uint32_t id, uint32_t n) {
#define X(name, least, most) {least, most},
  static const word_range params_words[] = {PARAMS(X)}, state_words[] = {STATE(X)}, yarn_words[] = {YARN_PARAMS(X)},
                          elastic_words[] = {YARN_ELASTIC_PARAMS(X)}, self_words[] = {SELF_PARAMS(X)},
                          mesh_words[] = {TRIMESH_PARAMS(X)}, mesh_state_words[] = {TRIMESH_STATE(X)},
                          membrane_words[] = {MEMBRANE_PARAMS(X)}, strength_words[] = {TEAR_STRENGTHS(X)},
                          crack_words[] = {CRACK_PARAMS(X)}, handle_words[] = {HANDLE_PARAMS(X)},
                          handle_state_words[] = {HANDLE_STATE(X)};
#undef X
  const word_range place = {-62 * FX_LU, 62 * FX_LU}, speed = {-FX_SPEED_MAX, FX_SPEED_MAX},
                   grip = {-FX_WORLD_MAX, FX_WORLD_MAX}, rest = {-32 * FX_LU, 32 * FX_LU}, area = {1, TRIMESH_AREA_MAX - 1},
                   stiff = {0, MATERIAL_STIFF_MAX}, cuts = {1, MAX_BREAKS}, blade = {BLADE_NEVER, BLADE_SPEED_MAX}, any = {INT32_MIN, INT32_MAX};
  switch (id) {
    case 1: return params_words[n % PARAM_WORDS];
    case 2: return state_words[n % STATE_WORDS];
    case 12: case 13: case 14: return place;
    case 15: case 16: case 17: return speed;
    case 22: case 23: case 24: return grip;
    case 25: return damage_body_range(n % BODY_WORDS);
    case 26: return damage_body_state_range(n % BODY_STATE_WORDS);
    case 27: return n % KEYFRAME_WORDS == 0 ? (word_range){0, 300} : grip;
    case 28: return yarn_words[n % YARN_PARAM_WORDS];
    case 33: return elastic_words[n % YARN_ELASTIC_PARAM_WORDS];
    case 36: return mesh_words[n % TRIMESH_PARAM_WORDS];
    case 37: return mesh_state_words[n % TRIMESH_STATE_WORDS];
    case 39: return area;
    case 42: case 43: return rest;
    case 45: return stiff;
    case 46: return membrane_words[n % MEMBRANE_PARAM_WORDS];
    case 47: return damage_stiffness_range(n % STIFFNESS_STATE_WORDS);
    case 48: return strength_words[n % TEAR_STRENGTH_WORDS];
    case IMAGE_YARN_COLLISION: case IMAGE_TRIANGLE_COLLISION: return self_words[n % SELF_PARAM_WORDS];
    case IMAGE_BLADES: return n == 0 ? cuts : blade;
    case IMAGE_BEND_STATES: return damage_bend_range(n % BEND_STATE_WORDS);
    case IMAGE_YARN_CONTACTS: return damage_yarn_contact_range(n % YARN_CONTACT_WORDS);
    case IMAGE_CRACK_PARAMS: return crack_words[n % CRACK_PARAM_WORDS];
    case IMAGE_CRACK_STATE: return damage_tip_range(n);
    case IMAGE_HANDLE_PARAMS: return handle_words[n % HANDLE_PARAM_WORDS];
    case IMAGE_HANDLE_STATES: return handle_state_words[n % HANDLE_STATE_WORDS];
    default: return any;
  }
}

static inline int32_t damage_word(word_range r, int32_t now) {
  const uint64_t span = (uint64_t)((int64_t)r.most - r.least) + 1;
  const int64_t bit = (int64_t)1 << damage_below(31);
  int64_t to;
  switch (damage_below(9)) {
    case 0: to = r.least; break;
    case 1: to = r.most; break;
    case 2: to = (int64_t)now + 1; break;
    case 3: to = (int64_t)now - 1; break;
    case 4: to = (int64_t)now * (1 + damage_below(64)); break;
    case 5: to = now / (int32_t)(1 + damage_below(64)); break;
    case 6: to = damage_below(2) != 0 ? bit : -bit; break;
    case 7: return (int32_t)(uint32_t)((uint64_t)now ^ (uint64_t)bit);
    default: to = r.least + (int64_t)(splitmix64(&damage_draws) % span); break;
  }
  const int64_t past = damage_below(32) == 0 ? 1 : 0;
  return (int32_t)(to < r.least ? r.least - (r.least != INT32_MIN ? past : 0)
                                : to > r.most ? r.most + (r.most != INT32_MAX ? past : 0) : to);
}

static inline uint32_t damage_load(const uint8_t *at, uint32_t bytes) {
  return bytes == 1 ? *at : bytes == 2 ? bytes_load16(at) : bytes_load32(at);
}
static inline void damage_element(uint8_t *image, const damage_section *s, uint32_t n) {
  uint8_t *at = image + s->at + n * s->bytes;
  const uint32_t now = damage_load(at, s->bytes);
  const uint32_t other = damage_load(image + s->at + damage_below(s->count) * s->bytes, s->bytes);
  uint32_t to = damage_below(3) == 0 ? other : now ^ 1u << damage_below(8 * s->bytes);
  /* bytes are small numbers: remainders of -8 to 8, bodies, materials, marks */
  if (s->bytes == 1 && damage_below(2) == 0) to = damage_below(17) - 8u;
  if (s->bytes == 4 && damage_below(8) != 0) to = (uint32_t)damage_word(damage_range(s->id, n), (int32_t)now);
  if (s->bytes == 1) *at = (uint8_t)to;
  else if (s->bytes == 2) bytes_store16(at, (uint16_t)to);
  else bytes_store32(at, to);
}

/* Sections that lie in the image; returns how many. */
static inline uint32_t damage_sections(const uint8_t *image, size_t bytes, damage_section found[64]) {
  uint32_t count = 0;
  if (bytes < 4 * IMAGE_HEADER_WORDS) return 0;
  const uint32_t said = bytes_load32(image + 4 * IMAGE_SECTIONS_WORD);
  for (uint32_t n = 0; n < said && n < 64; ++n) {
    const size_t entry = 4u * (IMAGE_HEADER_WORDS + (size_t)IMAGE_DIRECTORY_WORDS * n);
    if (entry + 4 * IMAGE_DIRECTORY_WORDS > bytes) break;
    const damage_section s = {bytes_load32(image + entry), bytes_load32(image + entry + 4),
                              bytes_load32(image + entry + 8), bytes_load32(image + entry + 12)};
    if ((s.bytes == 1 || s.bytes == 2 || s.bytes == 4) && s.count != 0 && s.at < bytes && s.count <= (bytes - s.at) / s.bytes)
      found[count++] = s;
  }
  return count;
}

/* A share of a section: each in its own way, or all words by one rule, at their limits as a rule. */
static inline void damage_many(uint8_t *image, const damage_section *s) {
  const uint32_t share = damage_below(2) == 0 ? 1 : 1 + damage_below(8);
  const uint32_t rule = s->bytes == 4 ? damage_below(5) : 0;
  for (uint32_t k = 0; k < s->count; ++k) {
    const word_range r = damage_range(s->id, k);
    const int32_t end = damage_below(2) != 0 ? r.least : r.most;
    uint8_t *at = image + s->at + k * s->bytes;
    if (damage_below(share) != 0) continue;
    if (rule == 0) damage_element(image, s, k);
    else if (rule == 1) bytes_store32(at, (uint32_t)(r.least + (int64_t)(splitmix64(&damage_draws) % ((uint64_t)((int64_t)r.most - r.least) + 1))));
    else bytes_store32(at, (uint32_t)(rule == 2 ? r.least : rule == 3 ? r.most : end));
  }
}

/* One to three sections: an element, or a share of all of them. State more often than constants. */
static inline void damage_fields(uint8_t *image, size_t bytes, uint32_t seed) {
  damage_section sections[64];
  const uint32_t count = damage_sections(image, bytes, sections);
  damage_draws = seed;
  for (uint32_t n = 1 + damage_below(3); n > 0 && count != 0; --n) {
    const damage_section *s = &sections[damage_below(count)];
    if (damage_below(3) != 0) {
      damage_element(image, s, damage_below(s->count));
      continue;
    }
    damage_many(image, s);
  }
}

#endif
