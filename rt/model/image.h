/* SPDX-License-Identifier: Apache-2.0 */
/* The image: a snapshot of a world, little-endian on every machine.
 *
 *   header     24 words: magic, version, bytes, CRC, features, sections, capacities
 *   directory  4 words a section: id, element bytes, elements, offset from the start
 *   sections   in ascending id, each at a multiple of 16, gaps are zero
 *
 * The CRC-32 covers everything behind its own word. It finds damage, not intent: an image from
 * an untrusted hand is safe to load (every field is checked) but not thereby authentic.
 * One major version is read; another one is refused, and converted by tools. What only yarns, yarns
 * with a stiffness, triangles, self-collision, rigid meshes, meshes that cut or triangles that meet
 * each other need stands in sections of its own: an image without any of them is one of version 2.0,
 * then 2.1 to 2.7. How long the section of meshes is, and whether there is one of blades, only the
 * directory says. */
#ifndef FRAY_MODEL_IMAGE_H
#define FRAY_MODEL_IMAGE_H

#include "rt/model/world.h"

#define IMAGE_MAGIC 0x59415246u /* "FRAY" */

enum {
  IMAGE_MAGIC_WORD,
  IMAGE_VERSION_WORD,
  IMAGE_BYTES_WORD,
  IMAGE_CRC_WORD,
  IMAGE_FEATURES_WORD,
  IMAGE_SECTIONS_WORD,
  IMAGE_CAPACITY_WORD,
  IMAGE_HEADER_WORDS = 24,
  IMAGE_DIRECTORY_WORDS = 4,
  IMAGE_ALIGN = 16,
  IMAGE_CRC_FROM = 4 * (IMAGE_CRC_WORD + 1)
};
/* Features: ids are 16 bits wide (no row, particle or triangle number needs more). */
enum { IMAGE_SHORT_IDS = 1 };
_Static_assert(IMAGE_CAPACITY_WORD + POOLS_IN_HEADER == IMAGE_HEADER_WORDS, "capacities fit the header");

typedef enum { ROLE_CONSTANT, ROLE_STATE, ROLE_TICK } image_role;
typedef enum { KIND_WORD, KIND_BYTE, KIND_ID, KIND_STRUCT } image_kind;

/* One array of the world. */
typedef struct {
  const char *name;
  uint16_t id;          /* in the image; 0 for what lives for one tick */
  uint8_t role, kind;
  uint8_t pool;         /* its capacity */
  uint8_t only;         /* a pool: left out where that is empty; 0: never */
  uint16_t words;       /* words or ids per element; bytes for KIND_STRUCT */
  size_t pointer;       /* offset of the pointer in the world */
} image_array;

extern const image_array image_arrays[];
extern const uint32_t image_array_count;

static inline void *image_pointer(const fray_world *w, const image_array *a) {
  void *const *slot = (void *const *)(const void *)((const uint8_t *)w + a->pointer);
  return *slot;
}

/* What the version says beside yarns; the sections of these. */
enum {
  IMAGE_MINOR_TRIANGLES = 3,
  IMAGE_MINOR_SELVES = 4,
  IMAGE_MINOR_MESHES = 5,
  IMAGE_MINOR_BLADES = 6,
  IMAGE_MINOR_LAYERS = 7
};
enum { IMAGE_SELVES = 49, IMAGE_MESHES = 50, IMAGE_BLADES = 51, IMAGE_LAYERS = 52 };

/* A world with capacities and arrays in the caller's zeroed memory, for the builder: nothing is
 * taken in place. `memory` NULL: only counts. Returns the bytes needed. */
size_t image_blank(const uint32_t capacity[POOLS], void *memory, fray_world **world);

/* Fills *error (if any) and returns the status. */
fray_status image_refuse(fray_error *error, fray_status status, uint32_t section, uint32_t index,
                         const char *what);

/* Of a word in a section. */
typedef struct {
  int32_t least, most;
} word_range;

/* Checks every value of a freshly loaded world; see model/validate.c. */
fray_status image_validate(fray_world *w, fray_error *error);
/* What triangle sheets have beside it: triangles and vertices that are one mesh, every fan whole, every
 * triangle stout, gains in their ranges; and derives what follows. 1, or 0 with the error filled. */
int sheet_valid(fray_world *w, fray_error *error);

#endif
