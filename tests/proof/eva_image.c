/* SPDX-License-Identifier: Apache-2.0 */
/* The loader up to the point where a world stands in memory; what checks its values is in
 * eva_validate.c. headers(): any bytes, any capacities, any length. loads(): capacities of one
 * shape, plain, with rigid meshes, blades, handles, self-collision of both kinds, everything else
 * arbitrary; image and memory end where they must. */
#include "rt/image/image.c"
#include "rt/image/image_table.c"
#include "tests/proof/any.h"

enum {
  PARTICLES = 5, HELD = 1, CROSSINGS = 4, ROWS = 6, BATCHES = 3, CLASSES = 2, BODIES = 1,
  KEYS = 1, CONTACTS = 1, CUTS = 1, PAIRS = 2, RIGID_MESH_WORDS = 9
};
static const uint32_t plain[POOLS] = {1,       1,       PARTICLES, HELD, CROSSINGS, ROWS, BATCHES,
                                      CLASSES, CLASSES, BODIES,    KEYS, CONTACTS,  CUTS};
static const uint32_t meshes[POOLS] = {
    1, 1, PARTICLES, HELD, CROSSINGS, ROWS, BATCHES, CLASSES, CLASSES, BODIES, KEYS, CONTACTS, CUTS,
    [POOL_RIGID_MESH_WORDS] = RIGID_MESH_WORDS};
static const uint32_t selves[POOLS] = {
    1, 1, PARTICLES, HELD, CROSSINGS, ROWS, BATCHES, CLASSES, CLASSES, BODIES, KEYS, CONTACTS, CUTS,
    [POOL_YARN_PAIRS] = PAIRS};
static const uint32_t layers[POOLS] = {
    1, 1, PARTICLES, HELD, CROSSINGS, ROWS, BATCHES, CLASSES, CLASSES, BODIES, KEYS, CONTACTS, CUTS,
    [POOL_TRIANGLE_PAIRS] = PAIRS};
static const uint32_t blades[POOLS] = {
    1, 1, PARTICLES, HELD, CROSSINGS, ROWS, BATCHES, CLASSES, CLASSES, BODIES, KEYS, CONTACTS, CUTS,
    [POOL_RIGID_MESH_WORDS] = RIGID_MESH_WORDS, [POOL_BLADES] = 1};

static const uint32_t handles[POOLS] = {
    1, 1, PARTICLES, HELD, CROSSINGS, ROWS, BATCHES, CLASSES, CLASSES, BODIES, KEYS, CONTACTS, CUTS,
    [POOL_HANDLES] = FRAY_HANDS};

/* Words of 64 bits, so that both are aligned. */
enum { IMAGE_ROOM = 4096, MEMORY_ROOM = 16384 };
static uint64_t image_room[IMAGE_ROOM / 8];
static uint64_t memory_room[MEMORY_ROOM / 8];
#define IMAGE_AT(bytes) ((uint8_t *)image_room + IMAGE_ROOM - (bytes))
#define MEMORY_AT(bytes) ((uint8_t *)memory_room + MEMORY_ROOM - (bytes))

/* Stands for image_validate(): any verdict. */
fray_status image_validate(fray_world *w, fray_error *error) {
  if (any_word() == 0) return FRAY_OK;
  return image_refuse(error, FRAY_BAD_FIELD, w->capacity[POOL_PARAMS], 0, "any");
}

void headers(void) {
  uint32_t capacity[POOLS];
  const uint32_t length = any_between(0, IMAGE_ROOM);
  fray_error error;
  any_bytes(image_room, sizeof image_room);
  const uint8_t *image = (const uint8_t *)image_room;
  if (read_header(image, length, capacity, &error) != FRAY_OK) return;
  for (uint32_t n = 0; n <= image_array_count; ++n) (void)section_offset(capacity, n);
  (void)plan_bytes(capacity, 0);
  (void)plan_bytes(capacity, 1);
}

/* A header that was read, and a length word that fits it: the directory has its place. */
void directories(void) {
  fray_error error;
  any_bytes(image_room, sizeof image_room);
  uint32_t capacity[POOLS];
  const uint8_t *image = (const uint8_t *)image_room;
  if (read_header(image, IMAGE_ROOM, capacity, &error) != FRAY_OK) return;
  (void)check_directory(image, capacity, &error);
}

/* What says the shape: the header's capacities and features. */
static void store_shape(uint8_t *image, const uint32_t shape[POOLS]) {
  for (uint32_t p = 0; p < POOLS_IN_HEADER; ++p)
    bytes_store32(image + 4u * (IMAGE_CAPACITY_WORD + p), shape[p]);
  bytes_store32(image + 4u * IMAGE_FEATURES_WORD, features_of(shape));
}

static void load(const uint32_t shape[POOLS], size_t image_bytes, size_t memory_bytes) {
  fray_world *world;
  fray_error error;
  uint8_t *image = IMAGE_AT(image_bytes);
  any_bytes(image_room, sizeof image_room);
  any_bytes(memory_room, sizeof memory_room);
  store_shape(image, shape);
  if (fray_open(image, image_bytes, MEMORY_AT(memory_bytes), memory_bytes, &world, &error) !=
      FRAY_OK)
    return;
  (void)fray_save(world, image, fray_save_bytes(world));
}

static void loads_of(const uint32_t said[POOLS]) {
  uint32_t shape[POOLS];
  for (uint32_t p = 0; p < POOLS; ++p) shape[p] = said[p];
  derive_pools(shape);
  const size_t length = image_length(shape);
  load(shape, length, plan_bytes(shape, 0));
  load(shape, length, plan_bytes(shape, 1));
  load(shape, length - 1u, plan_bytes(shape, 0));
  load(shape, length, plan_bytes(shape, 1) - 1u);
}

void loads(void) { loads_of(plain); }
void loads_meshes(void) { loads_of(meshes); }
void loads_yarn_collision(void) { loads_of(selves); }
void loads_triangle_collision(void) { loads_of(layers); }
void loads_blades(void) { loads_of(blades); }
void loads_handles(void) { loads_of(handles); }
