/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/model/image.h"

#include "rt/base/arena.h"
#include "rt/base/bytes.h"

#define AT(field) offsetof(struct fray_world, field)
#define WORDS(id, role, pool, words, field) {#field, id, role, KIND_WORD, pool, 0, words, AT(field)}
#define BYTE(id, role, pool, field) {#field, id, role, KIND_BYTE, pool, 0, 1, AT(field)}
#define IDS(id, role, pool, field) {#field, id, role, KIND_ID, pool, 0, 1, AT(field)}
#define YARN(id, role, kind, pool, words, field) \
  {#field, id, role, kind, pool, POOL_SPLITS, words, AT(field)}
#define STRETCH(id, pool, words, field) \
  {#field, id, ROLE_CONSTANT, KIND_WORD, pool, POOL_STRETCH, words, AT(field)}
#define SHEET(id, role, kind, pool, words, field) \
  {#field, id, role, kind, pool, POOL_TRIANGLES, words, AT(field)}
#define LAYERS(kind, pool, bytes, field) {#field, 0, ROLE_TICK, kind, pool, POOL_LAYERS, bytes, AT(field)}
#define SELVES(kind, pool, bytes, field) {#field, 0, ROLE_TICK, kind, pool, POOL_PAIRS, bytes, AT(field)}
#define MESH(id, role, kind, pool, words, field) \
  {"sheet." #field, id, role, kind, pool, POOL_TRIANGLES, words, AT(sheet) + offsetof(sheet_mesh, field)}
#define WITH_MESHES(pool, type, field) \
  {#field, 0, ROLE_TICK, KIND_STRUCT, pool, POOL_MESH_WORDS, sizeof(type), AT(field)}
#define TICK(pool, type, field) {#field, 0, ROLE_TICK, KIND_STRUCT, pool, 0, sizeof(type), AT(field)}
#define SHEET_TICK(pool, type, field) SHEET(0, ROLE_TICK, KIND_STRUCT, pool, sizeof(type), field)
#define MESH_TICK(pool, type, field) MESH(0, ROLE_TICK, KIND_STRUCT, pool, sizeof(type), field)

const image_array image_arrays[] = {
    WORDS(1, ROLE_CONSTANT, POOL_PARAMS, PARAM_WORDS, params),
    WORDS(2, ROLE_STATE, POOL_STATE, STATE_WORDS, state),
    WORDS(3, ROLE_CONSTANT, POOL_LINK_CLASSES, LINK_CLASS_WORDS, links),
    WORDS(4, ROLE_CONSTANT, POOL_SPRING_CLASSES, SPRING_CLASS_WORDS, springs),
    WORDS(5, ROLE_CONSTANT, POOL_BATCHES, BATCH_WORDS, batches),
    IDS(6, ROLE_CONSTANT, POOL_CROSSINGS, crossing),
    IDS(7, ROLE_CONSTANT, POOL_ROWS, home),
    IDS(8, ROLE_CONSTANT, POOL_ROWS, row_of),
    IDS(9, ROLE_STATE, POOL_ROWS, row_i),
    IDS(10, ROLE_STATE, POOL_ROWS, row_j),
    BYTE(11, ROLE_STATE, POOL_ROWS, row_class),
    WORDS(12, ROLE_STATE, POOL_PARTICLES, 1, x),
    WORDS(13, ROLE_STATE, POOL_PARTICLES, 1, y),
    WORDS(14, ROLE_STATE, POOL_PARTICLES, 1, z),
    WORDS(15, ROLE_STATE, POOL_PARTICLES, 1, vx),
    WORDS(16, ROLE_STATE, POOL_PARTICLES, 1, vy),
    WORDS(17, ROLE_STATE, POOL_PARTICLES, 1, vz),
    BYTE(18, ROLE_STATE, POOL_PARTICLES, rx),
    BYTE(19, ROLE_STATE, POOL_PARTICLES, ry),
    BYTE(20, ROLE_STATE, POOL_PARTICLES, rz),
    BYTE(21, ROLE_CONSTANT, POOL_HELD, grip_body),
    WORDS(22, ROLE_CONSTANT, POOL_HELD, 1, grip_x),
    WORDS(23, ROLE_CONSTANT, POOL_HELD, 1, grip_y),
    WORDS(24, ROLE_CONSTANT, POOL_HELD, 1, grip_z),
    WORDS(25, ROLE_CONSTANT, POOL_BODIES, BODY_WORDS, bodies),
    WORDS(26, ROLE_STATE, POOL_BODIES, BODY_STATE_WORDS, body_states),
    WORDS(27, ROLE_CONSTANT, POOL_KEYS, BODY_KEY_WORDS, keys),
    YARN(28, ROLE_CONSTANT, KIND_WORD, POOL_PARAMS, YARN_PARAM_WORDS, yarns),
    YARN(29, ROLE_STATE, KIND_WORD, POOL_STATE, YARN_STATE_WORDS, yarn_state),
    YARN(30, ROLE_STATE, KIND_BYTE, POOL_CROSSINGS, 1, couple),
    YARN(31, ROLE_STATE, KIND_ID, POOL_CROSSINGS, 1, warp_at),
    YARN(32, ROLE_STATE, KIND_ID, POOL_PARTICLES, 1, place),
    STRETCH(33, POOL_PARAMS, STRETCH_PARAM_WORDS, stretch),
    STRETCH(34, POOL_STRETCH, STRETCH_CLASS_WORDS, pulls),
    STRETCH(35, POOL_STRETCH, LINK_CLASS_WORDS, limits),
    MESH(36, ROLE_CONSTANT, KIND_WORD, POOL_PARAMS, SHEET_PARAM_WORDS, params),
    MESH(37, ROLE_STATE, KIND_WORD, POOL_STATE, SHEET_STATE_WORDS, state),
    MESH(38, ROLE_STATE, KIND_ID, POOL_TRIANGLES, SHEET_TRIANGLE_IDS, triangle),
    MESH(39, ROLE_STATE, KIND_WORD, POOL_TRIANGLES, 1, area),
    MESH(40, ROLE_STATE, KIND_BYTE, POOL_TRIANGLES, 1, mark),
    MESH(41, ROLE_STATE, KIND_BYTE, POOL_TRIANGLES, 1, cloth),
    MESH(42, ROLE_STATE, KIND_WORD, POOL_PARTICLES, 1, u),
    MESH(43, ROLE_STATE, KIND_WORD, POOL_PARTICLES, 1, v),
    MESH(44, ROLE_STATE, KIND_ID, POOL_PARTICLES, 1, fan),
    SHEET(45, ROLE_CONSTANT, KIND_WORD, POOL_PARAMS, LIMIT_CLOTHS * FABRIC_WORDS, fabrics),
    SHEET(46, ROLE_CONSTANT, KIND_WORD, POOL_PARAMS, CLOTH_PARAM_WORDS, cloths),
    SHEET(47, ROLE_STATE, KIND_WORD, POOL_TRIANGLES, HABIT_WORDS, habits),
    SHEET(48, ROLE_CONSTANT, KIND_WORD, POOL_PARAMS, LIMIT_CLOTHS * TOUGHNESS_WORDS, toughnesses),
#if FRAY_SELVES
    {"selves", IMAGE_SELVES, ROLE_CONSTANT, KIND_WORD, POOL_PARAMS, POOL_PAIRS, SELVES_PARAM_WORDS, AT(selves)},
#endif
    MESH_TICK(POOL_PARTICLES, uint32_t, mass),
    MESH_TICK(POOL_TRIANGLES, sheet_weights, weights),
    SHEET_TICK(POOL_PARTICLES, int32_t, inverse),
    SHEET_TICK(POOL_TRIANGLES, pull_row, pull),
    SHEET_TICK(POOL_TRIANGLES, tensor, stress),
    SHEET_TICK(POOL_TRIANGLES, crease_share, creases),
    SHEET_TICK(POOL_PARTICLES, inner_place, places),
    SHEET_TICK(POOL_PARTICLES, inner_sum, sums),
    SHEET_TICK(POOL_PARTICLES, inner_sum, given),
    SHEET_TICK(POOL_PARTICLES, int32_t, low_x),
    SHEET_TICK(POOL_PARTICLES, int32_t, low_y),
    SHEET_TICK(POOL_PARTICLES, int32_t, low_z),
#if FRAY_MESHES
    {"meshes", IMAGE_MESHES, ROLE_CONSTANT, KIND_WORD, POOL_MESH_WORDS, POOL_MESH_WORDS, 1, AT(meshes)},
#if FRAY_TRIANGLES
    {"blades", IMAGE_BLADES, ROLE_CONSTANT, KIND_WORD, POOL_BLADES, POOL_BLADES, BLADE_WORDS, AT(blades)},
    {"parted", 0, ROLE_TICK, KIND_BYTE, POOL_PARTICLES, POOL_BLADES, 1, AT(parted)},
#endif
#endif
#if FRAY_LAYERS
    {"layers", IMAGE_LAYERS, ROLE_CONSTANT, KIND_WORD, POOL_PARAMS, POOL_LAYERS, SELVES_PARAM_WORDS, AT(selves)},
#endif
    TICK(POOL_PARTICLES, int32_t, qx),
    TICK(POOL_PARTICLES, int32_t, qy),
    TICK(POOL_PARTICLES, int32_t, qz),
    TICK(POOL_BODIES, body_motion, motion),
    TICK(POOL_CONTACTS, contact, contacts),
    TICK(POOL_CUTS, cut, cuts),
    YARN(0, ROLE_TICK, KIND_ID, POOL_CROSSINGS, 1, slip_next),
#if SLIP_PLANNED
    YARN(0, ROLE_TICK, KIND_STRUCT, POOL_CROSSINGS, 4 * SLIP_PLAN_WORDS, slip_plan),
#endif
#if FRAY_MESHES
    WITH_MESHES(POOL_PARTICLES, int32_t, sx),
    WITH_MESHES(POOL_PARTICLES, int32_t, sy),
    WITH_MESHES(POOL_PARTICLES, int32_t, sz),
    WITH_MESHES(POOL_BODIES, vec3, stood),
    {"aside", 0, ROLE_TICK, KIND_BYTE, POOL_PARTICLES, POOL_MESH_WORDS, 1, AT(aside)},
    WITH_MESHES(POOL_TRIANGLES, row_id, beside),
#endif
#if FRAY_SELVES
    SELVES(KIND_STRUCT, POOL_PARTICLES, sizeof(self_way), ways),
    SELVES(KIND_STRUCT, POOL_PARTICLES, sizeof(self_field), fields),
    SELVES(KIND_STRUCT, POOL_CROSSINGS, SELVES_BOXES * sizeof(self_box), boxes),
    SELVES(KIND_STRUCT, POOL_CROSSINGS, sizeof(uint32_t), rough),
    SELVES(KIND_STRUCT, POOL_PAIRS, sizeof(self_pair), pairs),
    SELVES(KIND_STRUCT, POOL_PARTICLES, sizeof(self_zone), zones),
    SELVES(KIND_ID, POOL_PARTICLES, 1, zone_of),
    SELVES(KIND_BYTE, POOL_PARTICLES, 1, stirred),
#endif
#if FRAY_LAYERS
    LAYERS(KIND_STRUCT, POOL_PARTICLES, sizeof(self_way), ways),
    LAYERS(KIND_STRUCT, POOL_STATE, sizeof(layer_list), listed),
    LAYERS(KIND_STRUCT, POOL_LAYERS, sizeof(layer_pair), layers),
    LAYERS(KIND_STRUCT, POOL_LAYERS, 2 * sizeof(uint32_t), layers_met),
    LAYERS(KIND_STRUCT, POOL_TRIANGLES, sizeof(layer_way), layer_ways),
    LAYERS(KIND_STRUCT, POOL_TRIANGLES, sizeof(int32_t), layer_soon),
    LAYERS(KIND_STRUCT, POOL_TRIANGLES, sizeof(layer_box), layer_boxes),
    LAYERS(KIND_STRUCT, POOL_TRIANGLES, sizeof(uint32_t), layer_counts),
    LAYERS(KIND_ID, POOL_TRIANGLES, 1, layer_order),
    LAYERS(KIND_ID, POOL_TRIANGLES, 1, layer_stale),
    LAYERS(KIND_STRUCT, POOL_TRIANGLES, sizeof(layer_clump), layer_clumps),
    LAYERS(KIND_STRUCT, POOL_TILES, sizeof(layer_tile), tiles),
    LAYERS(KIND_STRUCT, POOL_BESIDE, sizeof(layer_beside), tiles_beside),
    LAYERS(KIND_STRUCT, POOL_PARTICLES, sizeof(self_zone), zones),
    LAYERS(KIND_ID, POOL_PARTICLES, 1, zone_of),
    LAYERS(KIND_BYTE, POOL_PARTICLES, 1, stirred),
    LAYERS(KIND_BYTE, POOL_PARTICLES, 1, stands),
#endif
};
const uint32_t image_array_count = sizeof image_arrays / sizeof image_arrays[0];

static const uint32_t capacity_max[POOLS] = {
    1,          1,             LIMIT_PARTICLES, LIMIT_PARTICLES, LIMIT_PARTICLES, LIMIT_ROWS,
    LIMIT_BATCHES, LIMIT_CLASSES, LIMIT_CLASSES, LIMIT_BODIES,   LIMIT_KEYS,      LIMIT_CONTACTS,
    LIMIT_CUTS, LIMIT_SPLITS,  LIMIT_CLASSES,   FRAY_TRIANGLES ? LIMIT_TRIANGLES : 0,
    LIMIT_PAIRS, LIMIT_LAYERS, LIMIT_MESH_WORDS, 1};

fray_status image_refuse(fray_error *error, fray_status status, uint32_t section, uint32_t index,
                         const char *what) {
  if (error != NULL) {
    error->status = status;
    error->section = section;
    error->index = index;
    error->what = what;
  }
  return status;
}

static int short_ids(const uint32_t capacity[POOLS]) {
  return capacity[POOL_ROWS] <= 65535u && capacity[POOL_PARTICLES] <= 65535u &&
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
  if (a->kind == KIND_ID) return sizeof(row_id);
  return a->kind == KIND_STRUCT ? a->words : 4u;
}
static int is_left_out(const image_array *a, const uint32_t capacity[POOLS]) {
  return a->only != 0 && capacity[a->only] == 0;
}
static int is_saved(const image_array *a, const uint32_t capacity[POOLS]) {
  return a->id != 0 && !is_left_out(a, capacity);
}
/* The least version that has all that is in the image. */
static uint32_t version_of(const uint32_t capacity[POOLS]) {
  const uint32_t minor = capacity[POOL_LAYERS] != 0      ? IMAGE_MINOR_LAYERS
                         : capacity[POOL_BLADES] != 0     ? IMAGE_MINOR_BLADES
                         : capacity[POOL_MESH_WORDS] != 0 ? IMAGE_MINOR_MESHES
                         : capacity[POOL_PAIRS] != 0     ? IMAGE_MINOR_SELVES
                         : capacity[POOL_TRIANGLES] != 0 ? IMAGE_MINOR_TRIANGLES
                         : capacity[POOL_STRETCH] != 0 ? 2u
                         : capacity[POOL_SPLITS] != 0  ? 1u
                                                       : 0u;
  return FRAY_IMAGE_MAJOR << 16 | minor;
}
static uint32_t features_of(const uint32_t capacity[POOLS]) {
  return short_ids(capacity) ? (uint32_t)IMAGE_SHORT_IDS : 0u;
}
static uint32_t elements(const image_array *a, const uint32_t capacity[POOLS]) {
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

/* Carves every array that is not used in place; with a dry arena it only counts. */
static void carve_arrays(fray_world *w, const uint32_t capacity[POOLS], int readable, arena *a) {
  for (uint32_t n = 0; n < image_array_count; ++n) {
    const image_array *array = &image_arrays[n];
    if (stays_in_place(array, capacity, readable) || is_left_out(array, capacity)) continue;
    void *taken = arena_take(a, elements(array, capacity), memory_bytes_of(array));
    if (w != NULL) *(void **)(void *)((uint8_t *)w + array->pointer) = taken;
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
  bytes_zero(memory, plan_bytes(capacity, readable));
  fray_world *w = (fray_world *)arena_take(&a, 1, sizeof(fray_world));
  for (uint32_t p = 0; p < POOLS; ++p) w->capacity[p] = capacity[p];
  carve_arrays(w, capacity, readable, &a);
  return w;
}

/* What follows from the other capacities. */
static void derive_pools(uint32_t capacity[POOLS]) {
  const uint32_t across = layers_across(capacity[POOL_TRIANGLES]);
  const uint32_t tiles = capacity[POOL_LAYERS] != 0 ? across * across : 0;
  capacity[POOL_TILES] = tiles;
  capacity[POOL_BESIDE] = tiles != 0 ? tiles * (tiles - 1u) / 2u : 0;
}

size_t image_blank(const uint32_t said[POOLS], void *memory, fray_world **world) {
  uint32_t capacity[POOLS];
  for (uint32_t p = 0; p < POOLS; ++p) capacity[p] = said[p];
  derive_pools(capacity);
  const size_t bytes = plan_bytes(capacity, 0);
  if (memory != NULL) *world = plan_carve(capacity, 0, memory, bytes);
  return bytes;
}

/* How many elements the directory says that a section has; 0 where there is no such section. */
static uint32_t elements_said(const uint8_t *image, uint32_t sections, uint32_t id) {
  for (uint32_t n = 0; n < sections; ++n) {
    const uint8_t *entry = image + 4u * (IMAGE_HEADER_WORDS + IMAGE_DIRECTORY_WORDS * n);
    if (bytes_load32(entry) == id) return bytes_load32(entry + 8);
  }
  return 0;
}

/* What the header has no word for: how long the meshes' section is, and whether there is one of blades. */
static fray_status read_directory(const uint8_t *image, size_t bytes, uint32_t capacity[POOLS],
                                  fray_error *error) {
  capacity[POOL_MESH_WORDS] = capacity[POOL_BLADES] = 0;
  if (!FRAY_MESHES || (bytes_load32(image + 4 * IMAGE_VERSION_WORD) & 0xFFFFu) < IMAGE_MINOR_MESHES)
    return FRAY_OK;
  const uint32_t sections = bytes_load32(image + 4 * IMAGE_SECTIONS_WORD);
  if (sections < 1 || sections > IMAGE_LAYERS)
    return image_refuse(error, FRAY_BAD_SECTION, 0, IMAGE_SECTIONS_WORD, "every section once");
  if (bytes < 4u * (IMAGE_HEADER_WORDS + IMAGE_DIRECTORY_WORDS * sections))
    return image_refuse(error, FRAY_TRUNCATED, 0, (uint32_t)bytes, "a header and its directory");
  const uint32_t words = elements_said(image, sections, IMAGE_MESHES);
  if ((words == 0 && capacity[POOL_LAYERS] == 0) || words > capacity_max[POOL_MESH_WORDS])
    return image_refuse(error, FRAY_BAD_SECTION, words == 0 ? 0u : (uint32_t)IMAGE_MESHES, sections - 1u,
                        "the section of meshes");
  capacity[POOL_MESH_WORDS] = words;
  capacity[POOL_BLADES] = FRAY_TRIANGLES && elements_said(image, sections, IMAGE_BLADES) != 0;
  return FRAY_OK;
}

/* The header, and what of the directory it takes: length, version, CRC word not yet compared, capacities. */
static fray_status read_header(const uint8_t *image, size_t bytes, uint32_t capacity[POOLS],
                               fray_error *error) {
  if (image == NULL) return image_refuse(error, FRAY_BAD_ARGUMENT, 0, 0, "an image");
  if (bytes < 4u * IMAGE_HEADER_WORDS)
    return image_refuse(error, FRAY_TRUNCATED, 0, (uint32_t)bytes, "a header of 96 bytes");
  const uint32_t version = bytes_load32(image + 4 * IMAGE_VERSION_WORD);
  if (bytes_load32(image) != IMAGE_MAGIC)
    return image_refuse(error, FRAY_BAD_MAGIC, 0, 0, "the bytes FRAY");
  if (version >> 16 != FRAY_IMAGE_MAJOR || (version & 0xFFFFu) > FRAY_IMAGE_MINOR)
    return image_refuse(error, FRAY_BAD_VERSION, 0, IMAGE_VERSION_WORD, "image version 2.0 to 2.7");
  if (!FRAY_TRIANGLES && (version & 0xFFFFu) == IMAGE_MINOR_TRIANGLES)
    return image_refuse(error, FRAY_BAD_VERSION, 0, IMAGE_VERSION_WORD,
                        "a build with triangle sheets (FRAY_TRIANGLES)");
  if (!FRAY_MESHES && (version & 0xFFFFu) >= IMAGE_MINOR_MESHES)
    return image_refuse(error, FRAY_BAD_VERSION, 0, IMAGE_VERSION_WORD,
                        "a build with rigid meshes (FRAY_MESHES)");
  if (!FRAY_SELVES && bytes_load32(image + 4u * (IMAGE_CAPACITY_WORD + POOL_PAIRS)) != 0)
    return image_refuse(error, FRAY_BAD_VERSION, 0, IMAGE_CAPACITY_WORD + POOL_PAIRS,
                        "a build with self-collision (FRAY_SELVES)");
  if (!FRAY_LAYERS && bytes_load32(image + 4u * (IMAGE_CAPACITY_WORD + POOL_LAYERS)) != 0)
    return image_refuse(error, FRAY_BAD_VERSION, 0, IMAGE_CAPACITY_WORD + POOL_LAYERS,
                        "a build with triangles that meet each other (FRAY_LAYERS)");
  for (uint32_t p = 0; p < POOLS_IN_HEADER; ++p) {
    capacity[p] = bytes_load32(image + 4u * (IMAGE_CAPACITY_WORD + p));
    if (capacity[p] > capacity_max[p] || (p <= POOL_STATE && capacity[p] != 1u))
      return image_refuse(error, FRAY_BAD_FIELD, 0, IMAGE_CAPACITY_WORD + p,
                          "a capacity in its range");
  }
  const fray_status status = read_directory(image, bytes, capacity, error);
  if (status != FRAY_OK) return status;
  derive_pools(capacity);
  if (version != version_of(capacity))
    return image_refuse(error, FRAY_BAD_VERSION, 0, IMAGE_VERSION_WORD,
                        "2.7 for triangles that meet each other, 2.6 for meshes that cut, 2.5 for rigid meshes, "
                        "2.4 for self-collision, 2.3 for triangle sheets, "
                        "2.2 for yarns with a stiffness, "
                        "2.1 for yarns, 2.0 for others");
  const uint32_t features = bytes_load32(image + 4 * IMAGE_FEATURES_WORD);
  if (features != features_of(capacity) || (sizeof(row_id) == 2u && !short_ids(capacity)))
    return image_refuse(error, FRAY_BAD_VERSION, 0, IMAGE_FEATURES_WORD,
                        "features that this build has, short ids where they fit");
  return FRAY_OK;
}

fray_status fray_bytes(const void *image, size_t image_bytes, size_t *bytes, fray_error *error) {
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
  return bytes == 1 ? from[0] : (bytes == 2 ? bytes_load16(from) : bytes_load32(from));
}
static void load_array(const image_array *a, const uint8_t *from, uint32_t stored, void *to,
                       uint32_t count) {
  for (uint32_t n = 0; n < count; ++n) {
    const uint32_t value = load_element(from + n * stored, stored);
    if (a->kind == KIND_BYTE)
      ((uint8_t *)to)[n] = (uint8_t)value;
    else if (a->kind == KIND_ID)
      ((row_id *)to)[n] = (row_id)value;
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
  uint32_t capacity[POOLS];
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
                        "as many bytes of memory as fray_bytes() says");
  fray_world *w = plan_carve(capacity, readable, memory, memory_bytes);
  load_sections(w, bytes, readable);
  w->particles = (uint32_t)w->params->particles +
                 (world_has_yarns(w) ? (uint32_t)w->yarn_state->split : 0u) +
                 (world_has_sheet(w) ? (uint32_t)w->sheet.state->born : 0u);
  status = image_validate(w, error);
  if (status == FRAY_OK) *world = w;
  return status;
}

size_t fray_save_bytes(const fray_world *world) { return image_length(world->capacity); }

static void save_array(const image_array *a, const void *from, uint32_t stored, uint8_t *to,
                       uint32_t count) {
  for (uint32_t n = 0; n < count; ++n) {
    uint8_t *place = to + n * stored;
    if (a->kind == KIND_BYTE) {
      *place = ((const uint8_t *)from)[n];
    } else {
      const uint32_t value = a->kind == KIND_ID ? (uint32_t)((const row_id *)from)[n]
                                                : ((const uint32_t *)from)[n];
      if (stored == 2)
        bytes_store16(place, (uint16_t)value);
      else
        bytes_store32(place, value);
    }
  }
}

size_t fray_save(const fray_world *world, void *buffer, size_t buffer_bytes) {
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
  bytes_store32(image + 4 * IMAGE_VERSION_WORD, version_of(world->capacity));
  bytes_store32(image + 4 * IMAGE_BYTES_WORD, length);
  bytes_store32(image + 4 * IMAGE_FEATURES_WORD, features_of(world->capacity));
  bytes_store32(image + 4 * IMAGE_SECTIONS_WORD, entry);
  for (uint32_t p = 0; p < POOLS_IN_HEADER; ++p)
    bytes_store32(image + 4u * (IMAGE_CAPACITY_WORD + p), world->capacity[p]);
  bytes_store32(image + 4 * IMAGE_CRC_WORD,
                bytes_crc32(image + IMAGE_CRC_FROM, length - IMAGE_CRC_FROM));
  return length;
}

int fray_view_pool(const fray_world *world, uint32_t index, fray_pool *pool) {
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
