/* SPDX-License-Identifier: Apache-2.0 */
/* Rigid meshes from scene to image: places, what is sharp, what is refused and where, images that are
 * damaged, saved and opened. tests/oracle/test_meshes.c has what they do. Writes to the folder that
 * BUILD names. */
#include "tests/lib/test.h"

#include "rt/base/bytes.h"
#include "rt/model/mesh.h"
#include "tests/lib/world_fixture.h"

#define SHEET \
  "scene s\nsubsteps 2\nsheet { warps 6 wefts 6 spacing 12 /cm plane horizontal at 0 0.52 0 cm }\n"
#define BOX "mesh m { obj \"tests/scenes/meshes/box.obj\" at 0 0 0 cm }\n"

static fray_mesh mesh_in(const fixture *f, uint32_t b) {
  fray_mesh m;
  CHECK(fray_view_mesh(f->w, b, &m));
  return m;
}

static void a_mesh_is_as_its_file(void) {
  fixture f;
  fray_mesh none;
  fixture_text(&f, SHEET "ball b { radius 1 mm at 0 5 0 cm }\n"
                         "mesh m { obj tests/scenes/meshes/box.obj unit 2 mm at 1 0 0 cm }\n");
  CHECK(!fray_view_mesh(f.w, 0, &none));
  const fray_mesh m = mesh_in(&f, 1);
  const double lu = fixture_lu_cm(&f);
  CHECK(m.points == 8 && m.edges == 18 && m.faces == 12);
  for (uint32_t n = 0; n < 8; ++n)
    for (uint32_t k = 0; k < 3; ++k) {
      const double wanted = (k == 1 ? 0.1 : 0.2) / lu;
      CHECK(fabs(fabs(m.point[5 * n + k] * 0x1p-24) - wanted) < 0x1p-24);
    }
  CHECK_EQ_INT(fray_view_body(f.w, 1).shape, FRAY_MESH);
  fixture_close(&f);
}

static void turns_with_its_body(void) {
  fixture f;
  fixture_text(&f, SHEET "mesh m { obj tests/scenes/meshes/sword.obj turn 90 deg about z at 0 -3 0 cm }\n");
  const fray_mesh m = mesh_in(&f, 0);
  const double lu = fixture_lu_cm(&f);
  CHECK(fabs(m.point[0] * 0x1p-24 - 4 / lu) < 1e-6); /* the tip, from -y to +x */
  CHECK(fabs(m.point[1] * 0x1p-24) < 1e-6);
  fixture_close(&f);
}

static void check_sharp(const char *obj, const char *sharp, uint32_t points, uint32_t edges) {
  fixture f;
  char text[512];
  uint32_t found_points = 0;
  uint32_t found_edges = 0;
  snprintf(text, sizeof text, SHEET "mesh m { obj tests/scenes/meshes/%s at 0 -5 0 cm sharp %s }\n", obj,
           sharp);
  fixture_text(&f, text);
  const fray_mesh m = mesh_in(&f, 0);
  for (uint32_t n = 0; n < m.points; ++n) found_points += m.point[5 * n + 3] != 0;
  for (uint32_t n = 0; n < m.edges; ++n) found_edges += m.edge[5 * n + 4] != 0;
  CHECK_EQ_INT(found_points, points);
  CHECK_EQ_INT(found_edges, edges);
  fixture_close(&f);
}
static void what_is_sharp(void) {
  check_sharp("box.obj", "off", 0, 0);
  check_sharp("box.obj", "89 deg", 0, 0);
  check_sharp("box.obj", "90 deg", 8, 12); /* not the diagonals */
  check_sharp("box.obj", "named", 0, 0);
  check_sharp("sword.obj", "named", 1, 4);
  check_sharp("sword.obj", "60 deg", 1, 4); /* two edges of the blade and of its point; the tip */
  check_sharp("plate.obj", "30 deg", 0, 4); /* borders */
  check_sharp("plate.obj", "90 deg", 4, 4);
  check_sharp("ball.obj", "120 deg", 0, 0);
}

static char folder[400];

static int compiles(const char *obj, const char *keys, scene_error *error) {
  char path[512];
  char text[1024];
  scene *s = malloc(sizeof *s);
  uint8_t *image = NULL;
  size_t bytes = 0;
  build_report report;
  snprintf(path, sizeof path, "%s/case.obj", folder);
  FILE *out = fopen(path, "wb");
  if (out == NULL || s == NULL) fixture_give_up(path, "cannot be written");
  fputs(obj, out);
  fclose(out);
  snprintf(path, sizeof path, "%s/case.scene", folder);
  snprintf(text, sizeof text, SHEET "mesh m { obj case.obj at 0 -3 0 cm %s }\n", keys);
  memset(error, 0, sizeof *error);
  const int good = scene_parse(path, text, strlen(text), s, error) &&
                   build_image(s, path, &image, &bytes, &report, NULL, NULL, error);
  free(image);
  free(s);
  return good;
}
static void check_refused(const char *obj, const char *keys, int line, const char *message) {
  scene_error error;
  CHECK(!compiles(obj, keys, &error));
  CHECK_EQ_INT(error.line, line);
  CHECK_TEXT(error.message, message);
  const size_t length = strlen(error.file);
  CHECK(length > 8 && strcmp(error.file + length - 8, "case.obj") == 0);
}

#define TENT "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"

static void what_is_refused(void) {
  scene_error error;
  CHECK(compiles(TENT "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n", "", &error));
  check_refused(TENT "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n", "", 5,
                "found a closed mesh whose faces look inwards, expected them anticlockwise as seen from "
                "outside");
  check_refused("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "", 4,
                "found a triangle of points 1, 2 and 3 that is flatter than 2441 nm, expected none without "
                "area");
  check_refused("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nf 1 2 3\nf 3 2 4\n", "", 4,
                "found point 4 where point 2 lies, expected one point for both");
  check_refused("v 0 2 0\nv -1 -1 0\nv 0 0 0\nv 1 -1 0\nf 2 3 4 1\n", "", 5,
                "found a face that its first corner does not see all of, expected a convex one, or "
                "triangles");
  CHECK(compiles("v 0 2 0\nv -1 -1 0\nv 0 0 0\nv 1 -1 0\nf 3 4 1 2\n", "", &error));
  check_refused("v 0 0 0\nv 17 0 0\nv 0 1 0\nf 1 2 3\n", "", 2,
                "found a point too far out, expected all within 160 mm of the mesh's origin along each "
                "axis, and numbers of few digits");
  check_refused("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "unit 1000 cm", 2,
                "found a point too far out, expected all within 160 mm of the mesh's origin along each "
                "axis, and numbers of few digits");
  check_refused("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nl 1 2\nl 2 4\n", "sharp named", 7,
                "found a line from point 2 to point 4, expected one along an edge of a face");
}

static void check_apart(const char *text, int line, const char *message) {
  scene_error error;
  scene *s = malloc(sizeof *s);
  uint8_t *image = NULL;
  size_t bytes = 0;
  build_report report;
  if (s == NULL) fixture_give_up("scene", "out of memory");
  CHECK(scene_parse("x", text, strlen(text), s, &error));
  CHECK(!build_image(s, "x", &image, &bytes, &report, NULL, NULL, &error));
  CHECK_EQ_INT(error.line, line);
  if (strncmp(error.message, message, strlen(message)) != 0) printf("%s\n", error.message);
  CHECK(strncmp(error.message, message, strlen(message)) == 0);
  free(s);
}

#define TRIANGLES \
  "scene s\nrate 1000 Hz\nsubsteps 2\ntriangles { columns 4 rows 4 edge 1 cm material paper plane horizontal }\n"

static void cloth_begins_apart(void) {
  check_apart(SHEET "mesh m { obj tests/scenes/meshes/box.obj at 0 0.019 0 cm }\n", 4,
              "m: found it at warp");
  check_apart(TRIANGLES "mesh m { obj tests/scenes/meshes/sword.obj at 0.1 1 0.1 cm }\n", 5,
              "m: found it at the triangles, at 10 mm along their weft, 10 mm along ");
  check_apart(TRIANGLES "ball b { radius 0.1 cm at 0.3 0 0.1 cm }\n", 5, "b: found it at the triangles, at ");
}

static void only_images_with_meshes_have_them(void) {
  fixture f;
  fixture_text(&f, SHEET);
  CHECK_EQ_INT(bytes_load32(f.image + 4 * IMAGE_VERSION_WORD), FRAY_IMAGE_MAJOR << 16);
  CHECK_EQ_INT(f.w->capacity[POOL_MESH_WORDS], 0);
  fixture_close(&f);
  fixture_text(&f, SHEET BOX);
  CHECK_EQ_INT(bytes_load32(f.image + 4 * IMAGE_VERSION_WORD), FRAY_IMAGE_MAJOR << 16 | IMAGE_MINOR_MESHES);
  fixture_close(&f);
}

static void a_saved_world_goes_on(void) {
  fixture f;
  fixture copy;
  fixture_text(&f, SHEET BOX "mesh n { obj tests/scenes/meshes/ball.obj unit 1 mm at 0.1 1 0 cm move free "
                             "mass 1 g velocity 3 -100 0 cm/s }\nplane p { at 0 -1 0 cm }\n");
  for (uint32_t round = 0; round < 8; ++round) {
    for (uint32_t tick = 0; tick < 37; ++tick) (void)fixture_tick(&f, &fixture_idle);
    fixture_copy(&copy, &f);
    CHECK(fray_hash(copy.w) == fray_hash(f.w));
    for (uint32_t tick = 0; tick < 3; ++tick) {
      const fray_output a = fixture_tick(&f, &fixture_idle);
      const fray_output b = fixture_tick(&copy, &fixture_idle);
      CHECK(a.hash == b.hash && memcmp(&a.work, &b.work, sizeof a.work) == 0);
    }
    fixture_close(&copy);
  }
  CHECK(fray_view_body(f.w, 1).position[1] > -(1 << 25)); /* it lies on the box or the plane */
  fixture_close(&f);
}

/* With the CRC put right, a flipped bit of the section is found by what it means, or is another mesh,
 * which runs. */
static void damaged_meshes_are_harmless(void) {
  fixture f;
  uint32_t refused = 0;
  uint32_t accepted = 0;
  uint32_t nameless = 0;
  fixture_text(&f, SHEET BOX);
  const uint32_t words = f.w->capacity[POOL_MESH_WORDS];
  const size_t at = (size_t)((const uint8_t *)(const void *)f.w->meshes - f.image);
  CHECK(at < f.image_bytes); /* used in place */
  void *memory = aligned_alloc(64, f.memory_bytes);
  uint8_t *image = malloc(f.image_bytes);
  for (size_t bit = 0; at < f.image_bytes && bit < 32u * words; ++bit) {
    fray_world *w = NULL;
    fray_error error;
    fray_output out;
    memcpy(image, f.image, f.image_bytes);
    image[at + bit / 8] = (uint8_t)(image[at + bit / 8] ^ 1u << bit % 8);
    bytes_store32(image + 4 * IMAGE_CRC_WORD,
                  bytes_crc32(image + IMAGE_CRC_FROM, (uint32_t)f.image_bytes - IMAGE_CRC_FROM));
    if (fray_open(image, f.image_bytes, memory, f.memory_bytes, &w, &error) == FRAY_OK) {
      ++accepted;
      for (int tick = 0; tick < 3; ++tick) fray_tick(w, &fixture_idle, &out);
    } else {
      ++refused;
      nameless += error.section != IMAGE_MESHES || error.what == NULL;
    }
  }
  printf("  %u bits: %u refused, %u another mesh\n", 32 * words, refused, accepted);
  CHECK_EQ_INT(nameless, 0);
  CHECK(refused > accepted);
  free(image);
  free(memory);
  fixture_close(&f);
}

int main(void) {
  const char *build = getenv("FRAY_BUILD");
  snprintf(folder, sizeof folder, "%s", build != NULL ? build : "build");
  TEST(a_mesh_is_as_its_file);
  TEST(turns_with_its_body);
  TEST(what_is_sharp);
  TEST(what_is_refused);
  TEST(cloth_begins_apart);
  TEST(only_images_with_meshes_have_them);
  TEST(a_saved_world_goes_on);
  TEST(damaged_meshes_are_harmless);
  return test_end();
}
