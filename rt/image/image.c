/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/image/image.h"

#include "rt/base/arena.h"
#include "rt/base/bytes.h"
#include "rt/image/physics_id.h"

static const uint32_t capacity_max[POOLS] = {
    1,          1,             MAX_PARTICLES, MAX_PARTICLES, MAX_PARTICLES, MAX_SPRINGS,
    MAX_BATCHES, MAX_CLASSES, MAX_CLASSES, MAX_BODIES,   MAX_KEYS,      MAX_CONTACTS,
    MAX_BREAKS, MAX_SPLITS,  MAX_CLASSES,   FRAY_TRIANGLES ? MAX_TRIANGLES : 0,
    MAX_YARN_PAIRS, MAX_TRIANGLE_PAIRS, MAX_MESH_WORDS, 1};

fray_status image_refuse(fray_error *error, fray_status status, uint32_t section, uint32_t index,
                         const char *what) {
  const fray_error refused = {status, section, index, what};
  if (error != NULL) *error = refused;
  return status;
}

static int short_ids(const uint32_t capacity[POOLS]) {
  return capacity[POOL_SPRINGS] <= 65535u && capacity[POOL_PARTICLES] <= 65535u &&
         capacity[POOL_TRIANGLES] <= 65535u;
}
/* Bytes of one element in the image and in memory. */
static uint32_t stored_bytes(const image_array *a, int ids_are_short) {
  if (a->kind == KIND_BYTE) return 1;
  if (a->kind == KIND_ID) return ids_are_short ? 2 : 4;
  return 4;
}
static uint32_t memory_bytes_of(const image_array *a) {
  if (a->kind == KIND_BYTE) return 1;
  if (a->kind == KIND_ID) return sizeof(index_t);
  return a->kind == KIND_STRUCT ? a->words : 4u;
}
static int is_left_out(const image_array *a, const uint32_t capacity[POOLS]) {
  return a->only != 0 && capacity[a->only] == 0;
}
static int is_saved(const image_array *a, const uint32_t capacity[POOLS]) {
  return a->id != 0 && !is_left_out(a, capacity);
}
static uint32_t features_of(const uint32_t capacity[POOLS]) {
  uint32_t features = short_ids(capacity) ? (uint32_t)IMAGE_SHORT_IDS : 0u;
#if FRAY_CRACKS
  if (capacity[POOL_COROTATIONAL] != 0) features |= IMAGE_COROTATIONAL;
  if (capacity[POOL_CRACKS] != 0) features |= IMAGE_CRACKS;
#endif
#if FRAY_HANDLES
  if (capacity[POOL_HANDLES] != 0) features |= IMAGE_HANDLES;
#endif
  return features;
}
enum { IMAGE_VERSION = FRAY_IMAGE_MAJOR << 16, IMAGE_VERSION_FEATURES = IMAGE_VERSION | 1 };
_Static_assert(IMAGE_VERSION == 3u << 16 && FRAY_IMAGE_MINOR == 1u, "the versions that messages name");

/* The oldest that has these features. */
static uint32_t version_of(uint32_t features) {
  return features > IMAGE_SHORT_IDS ? (uint32_t)IMAGE_VERSION_FEATURES : (uint32_t)IMAGE_VERSION;
}
static uint32_t elements(const image_array *a, const uint32_t capacity[POOLS]) {
  FRAY_ASSERT(a->pool < POOLS);
  if (is_left_out(a, capacity)) return 0;
  return capacity[a->pool] * (a->kind == KIND_STRUCT ? 1u : a->words);
}
/* 1 iff this machine reads the words of an image as they stand. */
static int readable_in_place(const uint8_t *image) {
  return bytes_host_is_little() && ((uintptr_t)image & 3u) == 0;
}
static int stays_in_place(const image_array *a, const uint32_t capacity[POOLS], int readable) {
  return readable && a->role == ROLE_CONSTANT &&
         stored_bytes(a, short_ids(capacity)) == memory_bytes_of(a);
}

/* Arrays of one tick that no section of the image bounds: left as they are, so that opening an image costs
 * what the image is long. Nothing reads an element that its tick has not written. */
static int stays_unwritten(const image_array *a) {
  return a->pool == POOL_CONTACTS || a->pool == POOL_YARN_PAIRS || a->pool == POOL_TRIANGLE_PAIRS;
}

/* Carves every array that is not used in place; with a dry arena it only counts. */
static void carve_arrays(fray_world *w, const uint32_t capacity[POOLS], int readable, arena *a) {
  for (uint32_t n = 0; n < image_array_count; ++n) {
    const image_array *array = &image_arrays[n];
    if (stays_in_place(array, capacity, readable) || is_left_out(array, capacity)) continue;
    void *taken = arena_take(a, elements(array, capacity), memory_bytes_of(array));
    if (w == NULL) continue;
    *(void **)(void *)((uint8_t *)w + array->pointer) = taken;
    if (!stays_unwritten(array))
      bytes_zero(taken, (size_t)elements(array, capacity) * memory_bytes_of(array));
  }
}

static size_t plan_bytes(const uint32_t capacity[POOLS], int readable) {
  arena dry = {NULL, 0, 0};
  (void)arena_take(&dry, 1, sizeof(fray_world));
  carve_arrays(NULL, capacity, readable, &dry);
  return dry.used;
}

static fray_world *plan_carve(const uint32_t capacity[POOLS], int readable, void *memory,
                              size_t bytes) {
  arena a = {(uint8_t *)memory, bytes, 0};
  FRAY_ASSERT(plan_bytes(capacity, readable) <= bytes);
  fray_world *w = (fray_world *)arena_take(&a, 1, sizeof(fray_world));
  bytes_zero(w, sizeof *w);
  for (uint32_t p = 0; p < POOLS; ++p) w->capacity[p] = capacity[p];
  w->physics_id = PHYSICS_ID;
  world_find_features(w);
  carve_arrays(w, capacity, readable, &a);
  return w;
}

/* What follows from the other capacities. */
static void derive_pools(uint32_t capacity[POOLS]) {
  const uint32_t across = patches_across(capacity[POOL_TRIANGLES]);
  const uint32_t tiles = capacity[POOL_TRIANGLE_PAIRS] != 0 ? across * across : 0;
  capacity[POOL_PATCHES] = tiles;
  capacity[POOL_PATCH_PAIRS] = tiles != 0 ? tiles * (tiles - 1u) / 2u : 0;
#if FRAY_TRIANGLES && FRAY_MESHES
  const int repeats = capacity[POOL_TRIANGLE_PAIRS] != 0 || capacity[POOL_RIGID_MESH_WORDS] != 0;
  const uint32_t zones = capacity[capacity[POOL_TRIANGLE_PAIRS] != 0 ? POOL_PARTICLES : POOL_BODIES];
  capacity[POOL_ZONES] = capacity[POOL_TRIANGLES] != 0 && repeats ? zones + 1u : 0;
#endif
  const int64_t spares = (int64_t)capacity[POOL_PARTICLES] - capacity[POOL_CROSSINGS];
  capacity[POOL_YARN_CONTACTS] = capacity[POOL_SPLITS] != 0 && spares > 0 ? (uint32_t)spares : 0;
}

size_t image_blank(const uint32_t said[POOLS], void *memory, fray_world **world) {
  uint32_t capacity[POOLS];
  for (uint32_t p = 0; p < POOLS; ++p) capacity[p] = said[p];
  derive_pools(capacity);
  const size_t bytes = plan_bytes(capacity, 0);
  if (memory != NULL) *world = plan_carve(capacity, 0, memory, bytes);
  return bytes;
}

static uint32_t header_capacity(const uint8_t *image, pool_name pool) {
  return bytes_load32(image + 4u * (IMAGE_CAPACITY_WORD + (uint32_t)pool));
}

static fray_status check_version(const uint8_t *image, fray_error *error) {
  const uint32_t version = bytes_load32(image + 4 * IMAGE_VERSION_WORD);
  if (bytes_load32(image) != IMAGE_MAGIC)
    return image_refuse(error, FRAY_BAD_MAGIC, 0, 0, "the bytes FRAY");
  if (version == version_of(bytes_load32(image + 4 * IMAGE_FEATURES_WORD))) return FRAY_OK;
  if (version == IMAGE_VERSION || version == IMAGE_VERSION_FEATURES)
    return image_refuse(error, FRAY_BAD_VERSION, 0, IMAGE_FEATURES_WORD,
                        "image version 3.1 with an isotropic sheet or handles, 3.0 without");
  return image_refuse(error, FRAY_BAD_VERSION, 0, IMAGE_VERSION_WORD,
                      version >> 16 == 2u ? "image version 3.0; version 2 needs fray 0.3 or 0.4"
                                          : "image version 3.0 or 3.1");
}

/* What the options of this build leave out. */
static fray_status check_options(const uint8_t *image, fray_error *error) {
  if (!FRAY_TRIANGLES && (header_capacity(image, POOL_TRIANGLES) | header_capacity(image, POOL_BLADES)) != 0)
    return image_refuse(error, FRAY_BAD_VERSION, 0, IMAGE_CAPACITY_WORD + POOL_TRIANGLES,
                        "a build with membranes (FRAY_TRIANGLES)");
  if (!FRAY_YARNS && header_capacity(image, POOL_SPLITS) != 0)
    return image_refuse(error, FRAY_BAD_VERSION, 0, IMAGE_CAPACITY_WORD + POOL_SPLITS,
                        "a build with yarns (FRAY_YARNS)");
  if (!FRAY_STRETCH && header_capacity(image, POOL_YARN_GAINS) != 0)
    return image_refuse(error, FRAY_BAD_VERSION, 0, IMAGE_CAPACITY_WORD + POOL_YARN_GAINS,
                        "a build with elastic yarns (FRAY_STRETCH)");
  if (!FRAY_YARN_COLLISION && header_capacity(image, POOL_YARN_PAIRS) != 0)
    return image_refuse(error, FRAY_BAD_VERSION, 0, IMAGE_CAPACITY_WORD + POOL_YARN_PAIRS,
                        "a build with self-collision of yarns (FRAY_YARN_COLLISION)");
  if (!FRAY_TRIANGLE_COLLISION && header_capacity(image, POOL_TRIANGLE_PAIRS) != 0)
    return image_refuse(error, FRAY_BAD_VERSION, 0, IMAGE_CAPACITY_WORD + POOL_TRIANGLE_PAIRS,
                        "a build with self-collision of membranes (FRAY_TRIANGLE_COLLISION)");
  if (!FRAY_HANDLES && (bytes_load32(image + 4 * IMAGE_FEATURES_WORD) & IMAGE_HANDLES) != 0)
    return image_refuse(error, FRAY_BAD_VERSION, 0, IMAGE_FEATURES_WORD,
                        "a build with handles (FRAY_HANDLES)");
  if (!FRAY_MESHES &&
      (header_capacity(image, POOL_RIGID_MESH_WORDS) | header_capacity(image, POOL_BLADES)) != 0)
    return image_refuse(error, FRAY_BAD_VERSION, 0, IMAGE_CAPACITY_WORD + POOL_RIGID_MESH_WORDS,
                        "a build with rigid meshes, and bodies that triangles meet (FRAY_MESHES)");
  if (!FRAY_CRACKS && (bytes_load32(image + 4 * IMAGE_FEATURES_WORD) & IMAGE_COROTATIONAL) != 0)
    return image_refuse(error, FRAY_BAD_VERSION, 0, IMAGE_FEATURES_WORD,
                        "a build with isotropic sheets (FRAY_CRACKS)");
  return FRAY_OK;
}

/* The header: length, version, CRC word not yet compared, capacities. */
static fray_status read_header(const uint8_t *image, size_t bytes, uint32_t capacity[POOLS],
                               fray_error *error) {
  if (image == NULL) return image_refuse(error, FRAY_BAD_ARGUMENT, 0, 0, "an image");
  if (bytes < 4u * IMAGE_HEADER_WORDS)
    return image_refuse(error, FRAY_TRUNCATED, 0, (uint32_t)bytes, "a header of 108 bytes");
  fray_status status = check_version(image, error);
  if (status == FRAY_OK) status = check_options(image, error);
  if (status != FRAY_OK) return status;
  for (uint32_t p = 0; p < POOLS_IN_HEADER; ++p) {
    capacity[p] = header_capacity(image, (pool_name)p);
    if (capacity[p] > capacity_max[p] || (p <= POOL_STATE && capacity[p] != 1u))
      return image_refuse(error, FRAY_BAD_FIELD, 0, IMAGE_CAPACITY_WORD + p,
                          "a capacity in its range");
  }
  const uint32_t features = bytes_load32(image + 4 * IMAGE_FEATURES_WORD);
  derive_pools(capacity);
#if FRAY_CRACKS
  capacity[POOL_COROTATIONAL] = capacity[POOL_TRIANGLES] != 0 && (features & IMAGE_COROTATIONAL) != 0;
  capacity[POOL_CRACKS] = capacity[POOL_COROTATIONAL] != 0 && (features & IMAGE_CRACKS) != 0;
#endif
#if FRAY_HANDLES
  capacity[POOL_HANDLES] = (features & IMAGE_HANDLES) != 0 ? FRAY_HANDS : 0;
#endif
  if (features != features_of(capacity))
    return image_refuse(error, FRAY_BAD_VERSION, 0, IMAGE_FEATURES_WORD,
                        "the features of its capacities, short ids where they fit");
  if (sizeof(index_t) == 2u && !short_ids(capacity))
    return image_refuse(error, FRAY_BAD_VERSION, 0, IMAGE_FEATURES_WORD,
                        "a build with 32-bit ids (FRAY_ID_BITS)");
  return FRAY_OK;
}

fray_status fray_memory_size(const void *image, size_t image_bytes, size_t *bytes, fray_error *error) {
  uint32_t capacity[POOLS];
  if (bytes == NULL) return image_refuse(error, FRAY_BAD_ARGUMENT, 0, 0, "a place for the result");
  const fray_status status = read_header((const uint8_t *)image, image_bytes, capacity, error);
  if (status != FRAY_OK) return status;
  *bytes = plan_bytes(capacity, readable_in_place((const uint8_t *)image));
  return FRAY_OK;
}

static uint32_t align_up(uint32_t bytes) {
  return (bytes + IMAGE_ALIGN - 1u) & ~(uint32_t)(IMAGE_ALIGN - 1u);
}

/* Where array n's section starts; sections follow one another in the order of the table. */
static uint32_t section_offset(const uint32_t capacity[POOLS], uint32_t n) {
  FRAY_ASSERT(n <= image_array_count);
  uint32_t sections = 0;
  for (uint32_t k = 0; k < image_array_count; ++k) sections += is_saved(&image_arrays[k], capacity) != 0;
  uint32_t offset = align_up(4u * (IMAGE_HEADER_WORDS + IMAGE_DIRECTORY_WORDS * sections));
  for (uint32_t k = 0; k < n; ++k)
    if (is_saved(&image_arrays[k], capacity))
      offset = align_up(offset + elements(&image_arrays[k], capacity) *
                                     stored_bytes(&image_arrays[k], short_ids(capacity)));
  return offset;
}
static uint32_t image_length(const uint32_t capacity[POOLS]) {
  return section_offset(capacity, image_array_count);
}

/* The layout follows from the capacities alone, so the directory is only compared. */
static fray_status check_directory(const uint8_t *image, const uint32_t capacity[POOLS],
                                   fray_error *error) {
  uint32_t entry = 0;
  for (uint32_t n = 0; n < image_array_count; ++n) {
    const image_array *a = &image_arrays[n];
    if (!is_saved(a, capacity)) continue;
    const uint8_t *words = image + 4u * (IMAGE_HEADER_WORDS + IMAGE_DIRECTORY_WORDS * entry);
    if (bytes_load32(words) != a->id ||
        bytes_load32(words + 4) != stored_bytes(a, short_ids(capacity)) ||
        bytes_load32(words + 8) != elements(a, capacity) ||
        bytes_load32(words + 12) != section_offset(capacity, n))
      return image_refuse(error, FRAY_BAD_SECTION, a->id, entry,
                          "the directory entry that the capacities call for");
    ++entry;
  }
  if (bytes_load32(image + 4 * IMAGE_SECTIONS_WORD) != entry)
    return image_refuse(error, FRAY_BAD_SECTION, 0, IMAGE_SECTIONS_WORD, "every section once");
  return FRAY_OK;
}

static uint32_t load_element(const uint8_t *from, uint32_t bytes) {
  FRAY_ASSERT(bytes == 1 || bytes == 2 || bytes == 4);
  return bytes == 1 ? from[0] : (bytes == 2 ? bytes_load16(from) : bytes_load32(from));
}
static void load_array(const image_array *a, const uint8_t *from, uint32_t stored, void *to,
                       uint32_t count) {
  for (uint32_t n = 0; n < count; ++n) {
    const uint32_t value = load_element(from + n * stored, stored);
    if (a->kind == KIND_BYTE)
      ((uint8_t *)to)[n] = (uint8_t)value;
    else if (a->kind == KIND_ID)
      ((index_t *)to)[n] = (index_t)value;
    else
      ((uint32_t *)to)[n] = value;
  }
}

static void load_sections(fray_world *w, const uint8_t *image, int readable) {
  for (uint32_t n = 0; n < image_array_count; ++n) {
    const image_array *a = &image_arrays[n];
    if (!is_saved(a, w->capacity)) continue;
    const uint8_t *from = image + section_offset(w->capacity, n);
    if (stays_in_place(a, w->capacity, readable))
      *(const void **)(void *)((uint8_t *)w + a->pointer) = from;
    else
      load_array(a, from, stored_bytes(a, short_ids(w->capacity)), image_pointer(w, a),
                 elements(a, w->capacity));
  }
}

fray_status fray_open(const void *image, size_t image_bytes, void *memory, size_t memory_bytes,
                      fray_world **world, fray_error *error) {
  uint32_t capacity[POOLS] = {0};
  const uint8_t *bytes = (const uint8_t *)image;
  if (world != NULL) *world = NULL;
  if (world == NULL || memory == NULL || ((uintptr_t)memory & (FRAY_ALIGN - 1u)) != 0)
    return image_refuse(error, FRAY_BAD_ARGUMENT, 0, 0, "memory aligned to FRAY_ALIGN");
  fray_status status = read_header(bytes, image_bytes, capacity, error);
  if (status != FRAY_OK) return status;
  const uint32_t length = bytes_load32(bytes + 4 * IMAGE_BYTES_WORD);
  if (length != image_length(capacity))
    return image_refuse(error, FRAY_BAD_SECTION, 0, IMAGE_BYTES_WORD,
                        "the length that the capacities call for");
  if (image_bytes < length)
    return image_refuse(error, FRAY_TRUNCATED, 0, (uint32_t)image_bytes,
                        "as many bytes as its length");
  if (bytes_crc32(bytes + IMAGE_CRC_FROM, length - IMAGE_CRC_FROM) !=
      bytes_load32(bytes + 4 * IMAGE_CRC_WORD))
    return image_refuse(error, FRAY_BAD_CRC, 0, IMAGE_CRC_WORD, "the CRC-32 of what follows");
  status = check_directory(bytes, capacity, error);
  if (status != FRAY_OK) return status;
  const int readable = readable_in_place(bytes);
  if (memory_bytes < plan_bytes(capacity, readable))
    return image_refuse(error, FRAY_SMALL_MEMORY, 0, 0,
                        "as many bytes of memory as fray_memory_size() says");
  fray_world *w = plan_carve(capacity, readable, memory, memory_bytes);
  w->physics_id = bytes_load32(bytes + 4 * IMAGE_PHYSICS_WORD);
  load_sections(w, bytes, readable);
  w->p.count = (uint32_t)w->params->particles +
                 (world_has_yarns(w) ? (uint32_t)w->woven.yarn_counts->split : 0u) +
                 (world_has_membrane(w) ? (uint32_t)w->trimesh.state->allocated : 0u);
  status = image_validate(w, error);
  if (status == FRAY_OK) *world = w;
  return status;
}

size_t fray_save_bytes(const fray_world *world) {
  FRAY_ASSERT(world != NULL);
  return image_length(world->capacity);
}

static void save_array(const image_array *a, const void *from, uint32_t stored, uint8_t *to,
                       uint32_t count) {
  for (uint32_t n = 0; n < count; ++n) {
    uint8_t *place = to + n * stored;
    if (a->kind == KIND_BYTE) {
      *place = ((const uint8_t *)from)[n];
    } else {
      const uint32_t value = a->kind == KIND_ID ? (uint32_t)((const index_t *)from)[n]
                                                : ((const uint32_t *)from)[n];
      if (stored == 2)
        bytes_store16(place, (uint16_t)value);
      else
        bytes_store32(place, value);
    }
  }
}

/* What a saved state is opened by: counts within their pools, and the topology that its hash says. */
__attribute__((unused)) static int is_consistent(const fray_world *w) {
  const uint64_t said = (uint64_t)(uint32_t)w->state->topology[1] << 32 | (uint32_t)w->state->topology[0];
  return w->p.count <= w->capacity[POOL_PARTICLES] && world_topology(w) == said;
}

size_t fray_save(const fray_world *world, void *buffer, size_t buffer_bytes) {
  FRAY_ASSERT(world != NULL && is_consistent(world));
  const uint32_t length = image_length(world->capacity);
  const int ids_are_short = short_ids(world->capacity);
  uint8_t *image = (uint8_t *)buffer;
  uint32_t entry = 0;
  if (buffer == NULL || buffer_bytes < length) return 0;
  bytes_zero(image, length);
  for (uint32_t n = 0; n < image_array_count; ++n) {
    const image_array *a = &image_arrays[n];
    if (!is_saved(a, world->capacity)) continue;
    const uint32_t stored = stored_bytes(a, ids_are_short);
    const uint32_t count = elements(a, world->capacity);
    const uint32_t offset = section_offset(world->capacity, n);
    uint8_t *words = image + 4u * (IMAGE_HEADER_WORDS + IMAGE_DIRECTORY_WORDS * entry++);
    bytes_store32(words, a->id);
    bytes_store32(words + 4, stored);
    bytes_store32(words + 8, count);
    bytes_store32(words + 12, offset);
    save_array(a, image_pointer(world, a), stored, image + offset, count);
  }
  bytes_store32(image, IMAGE_MAGIC);
  bytes_store32(image + 4 * IMAGE_VERSION_WORD, version_of(features_of(world->capacity)));
  bytes_store32(image + 4 * IMAGE_BYTES_WORD, length);
  bytes_store32(image + 4 * IMAGE_FEATURES_WORD, features_of(world->capacity));
  bytes_store32(image + 4 * IMAGE_SECTIONS_WORD, entry);
  bytes_store32(image + 4 * IMAGE_PHYSICS_WORD, PHYSICS_ID);
  for (uint32_t p = 0; p < POOLS_IN_HEADER; ++p)
    bytes_store32(image + 4u * (IMAGE_CAPACITY_WORD + p), world->capacity[p]);
  bytes_store32(image + 4 * IMAGE_CRC_WORD, bytes_crc32(image + IMAGE_CRC_FROM, length - IMAGE_CRC_FROM));
  return length;
}

int fray_view_pool(const fray_world *world, uint32_t index, fray_pool *pool) {
  FRAY_ASSERT(world != NULL && pool != NULL);
  if (index >= image_array_count) return 0;
  const image_array *a = &image_arrays[index];
  const uint8_t *place = (const uint8_t *)image_pointer(world, a);
  const uint8_t *first = (const uint8_t *)world;
  pool->name = a->name;
  pool->count = is_left_out(a, world->capacity) ? 0 : world->capacity[a->pool];
  pool->element_bytes = memory_bytes_of(a) * (a->kind == KIND_STRUCT ? 1u : a->words);
  pool->constant = a->role == ROLE_CONSTANT;
  pool->in_place = place != NULL && (place < first || place >= first + plan_bytes(world->capacity, 0));
  return 1;
}
