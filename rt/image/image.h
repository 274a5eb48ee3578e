/* SPDX-License-Identifier: Apache-2.0 */
/* The image: a snapshot of a world, little-endian on every machine.
 *
 *   header     27 words: magic, version, bytes, CRC, features, sections, id of the physics, capacities
 *   directory  4 words a section: id, element bytes, elements, offset from the start
 *   sections   in ascending id, each at a multiple of 16, gaps are zero
 *
 * The CRC-32 covers everything behind its own word. It finds damage, not intent: an image from
 * an untrusted hand is safe to load (every field is checked) but not thereby authentic.
 * Two versions are read: 3.0, and 3.1 of worlds with an isotropic sheet or handles; another one is refused.
 * What only some worlds need stands in sections of its own, and capacities and features say which of them
 * there are. */
#ifndef FRAY_IMAGE_IMAGE_H
#define FRAY_IMAGE_IMAGE_H

#include "rt/state/world.h"

#define IMAGE_MAGIC 0x59415246u /* "FRAY" */

enum {
  IMAGE_MAGIC_WORD,
  IMAGE_VERSION_WORD,
  IMAGE_BYTES_WORD,
  IMAGE_CRC_WORD,
  IMAGE_FEATURES_WORD,
  IMAGE_SECTIONS_WORD,
  IMAGE_PHYSICS_WORD, /* PHYSICS_ID of the build that wrote it */
  IMAGE_CAPACITY_WORD,
  IMAGE_HEADER_WORDS = 27,
  IMAGE_DIRECTORY_WORDS = 4,
  IMAGE_ALIGN = 16,
  IMAGE_CRC_FROM = 4 * (IMAGE_CRC_WORD + 1)
};
/* Features: ids are 16 bits wide (no row, particle or triangle number needs more); the membrane is isotropic,
 * by the law of state/corotational.h; it breaks; hands move handles. All but the first need version 3.1.
 */
enum { IMAGE_SHORT_IDS = 1, IMAGE_COROTATIONAL = 2, IMAGE_CRACKS = 4, IMAGE_HANDLES = 8 };
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

/* Sections that build options leave out. */
enum { IMAGE_YARN_COLLISION = 49, IMAGE_RIGID_MESHES = 50, IMAGE_BLADES = 51, IMAGE_TRIANGLE_COLLISION = 52,
       IMAGE_BEND_STATES = 53, IMAGE_YARN_CONTACTS = 54, IMAGE_CRACK_PARAMS = 55, IMAGE_CRACK_STATE = 56,
       IMAGE_HANDLE_PARAMS = 64, IMAGE_HANDLE_STATES };

/* A world with capacities and arrays in the caller's memory, for the builder: nothing is taken in
 * place. `memory` NULL: only counts. Returns the bytes needed. */
size_t image_blank(const uint32_t capacity[POOLS], void *memory, fray_world **world);

/* Fills *error (if any) and returns the status. */
fray_status image_refuse(fray_error *error, fray_status status, uint32_t section, uint32_t index,
                         const char *what);

/* The same for a value that is not allowed, in a loaded world. Returns 0. */
int image_bad(fray_error *error, uint32_t section, uint32_t index, const char *what);

/* Of a word in a section. */
typedef struct {
  int32_t least, most;
} word_range;
int image_words_in_range(const void *table, const word_range *ranges, uint32_t count, uint32_t section,
                         fray_error *error);

/* Checks every value of a freshly loaded world; see image/validate.c. */
fray_status image_validate(fray_world *w, fray_error *error);
/* What worlds with yarns have beside it, in time linear in the crossings. 1, or 0 with the error filled. */
int yarn_contacts_validate(const fray_world *w, fray_error *error);
/* What membranes have beside it: triangles and vertices that are one mesh, every fan whole, every
 * triangle stout, gains in their ranges; and derives what follows. 1, or 0 with the error filled. */
int trimesh_validate(fray_world *w, fray_error *error);
/* Handles: free bodies, one a hand, springs and dampers that the elastic steps bear. *hands: a bit
 * each. 1, or 0 with the error filled. */
#if FRAY_HANDLES
int handles_validate(const fray_world *w, int32_t *hands, fray_error *error);
#else
static inline int handles_validate(const fray_world *w, int32_t *hands, fray_error *error) {
  (void)w, (void)hands, (void)error;
  return 0;
}
#endif

#endif
