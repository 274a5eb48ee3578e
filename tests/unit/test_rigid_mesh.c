/* SPDX-License-Identifier: Apache-2.0 */
/* Rigid meshes from scene to image: places, what is sharp, what is refused and where, images that are
 * damaged, saved and opened. tests/physics/test_contact_vertices.c has what they do. Writes to the folder
 * that BUILD names. */
#include "tests/lib/test.h"

#include "rt/state/rigid_mesh.h"
#include "tests/lib/damage.h"

#define SHEET \
  "scene s\nsubsteps 2\nwoven { warps 6 wefts 6 spacing 12 /cm orientation horizontal at 0 0.52 0 cm }\n"
#define BOX "mesh m { obj \"tests/scenes/meshes/box.obj\" at 0 0 0 cm }\n"

static fray_mesh mesh_in(const fixture *f, uint32_t b) {
  fray_mesh m;
  CHECK(fray_view_mesh(f->w, b, &m));
  return m;
}

static void a_mesh_is_as_its_file(void) {
  fixture_scoped f = {0};
  fray_mesh none;
  fixture_text(&f, SHEET "sphere b { radius 1 mm at 0 5 0 cm }\n"
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
}

static void turns_with_its_body(void) {
  fixture_scoped f = {0};
  fixture_text(&f, SHEET "mesh m { obj tests/scenes/meshes/sword.obj rotate 90 deg about z at 0 -3 0 cm }\n");
  const fray_mesh m = mesh_in(&f, 0);
  const double lu = fixture_lu_cm(&f);
  CHECK(fabs(m.point[0] * 0x1p-24 - 4 / lu) < 1e-6); /* the tip, from -y to +x */
  CHECK(fabs(m.point[1] * 0x1p-24) < 1e-6);
}

static void check_sharp(const char *obj, const char *sharp, uint32_t points, uint32_t edges) {
  fixture_scoped f = {0};
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
}
static void what_is_sharp(void) {
  check_sharp("box.obj", "off", 0, 0);
  check_sharp("box.obj", "89 deg", 0, 0);
  check_sharp("box.obj", "90 deg", 8, 12); /* not the diagonals */
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
  fixture_scoped f = {0};
  snprintf(path, sizeof path, "%s/case.obj", folder);
  FILE *out = fopen(path, "wb");
  if (out == NULL) fixture_give_up(path, "cannot be written");
  fputs(obj, out);
  fclose(out);
  snprintf(path, sizeof path, "%s/case.scene", folder);
  snprintf(text, sizeof text, SHEET "mesh m { obj case.obj at 0 -3 0 cm %s }\n", keys);
  return fixture_compile(&f, path, text, error);
}
/* The scene's `obj` is the place; the message says where in the file. */
static void check_refused(const char *obj, const char *keys, const char *where, const char *message) {
  scene_error error;
  char expected[1024];
  CHECK(!compiles(obj, keys, &error));
  CHECK_EQ_INT(error.line, 4);
  CHECK_EQ_INT(error.column, 10);
  snprintf(expected, sizeof expected, "mesh 'm': %s/case.obj%s: %s", folder, where, message);
  CHECK_TEXT(error.message, expected);
  const size_t length = strlen(error.file);
  CHECK(length > 10 && strcmp(error.file + length - 10, "case.scene") == 0);
}

#define TENT "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"

static void what_is_refused(void) {
  scene_error error;
  CHECK(compiles(TENT "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n", "", &error));
  check_refused(TENT "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n", "", ":5",
                "found a closed mesh whose faces look inwards, expected them anticlockwise as seen from "
                "outside");
  check_refused("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "", ":4",
                "found a triangle of points 1, 2 and 3 that is flatter than 2441 nm, expected none without "
                "area");
  check_refused("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nf 1 2 3\nf 3 2 4\n", "", ":4",
                "found point 4 where point 2 lies, expected one point for both");
  check_refused("v 0 2 0\nv -1 -1 0\nv 0 0 0\nv 1 -1 0\nf 2 3 4 1\n", "", ":5",
                "found a face that its first corner does not see all of, expected a convex one, or "
                "triangles");
  CHECK(compiles("v 0 2 0\nv -1 -1 0\nv 0 0 0\nv 1 -1 0\nf 3 4 1 2\n", "", &error));
  check_refused("v 0 0 0\nv 17 0 0\nv 0 1 0\nf 1 2 3\n", "", ":2",
                "found a point too far out, expected all within 16 cm of the mesh's origin along each "
                "axis, and numbers of few digits");
  check_refused("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "unit 1000 cm", ":2",
                "found a point too far out, expected all within 16 cm of the mesh's origin along each "
                "axis, and numbers of few digits");
  check_refused("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nl 1 2\nl 2 4\n", "sharp named", ":7",
                "found a line from point 2 to point 4, expected one along an edge of a face");
  check_refused(TENT "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n", "sharp named", "",
                "found no edge or point that is marked, expected lines 'l a b' or 'p a' for 'sharp named'");
  check_refused("v 0 0 x\n", "", ":1:7", "found 'x', expected a number");
}

static void check_apart(const char *text, int line, const char *message) {
  scene_error error;
  fixture_scoped f = {0};
  CHECK(!fixture_compile(&f, "x", text, &error));
  CHECK_EQ_INT(error.line, line);
  if (strncmp(error.message, message, strlen(message)) != 0) printf("%s\n", error.message);
  CHECK(strncmp(error.message, message, strlen(message)) == 0);
}

#define TRIANGLES \
  "scene s\nrate 1000 Hz\nsubsteps 2\nmembrane { columns 4 rows 4 cell 1 cm material paper orientation " \
  "horizontal }\n"

static void cloth_begins_apart(void) {
  check_apart(SHEET "mesh m { obj tests/scenes/meshes/box.obj at 0 0.019 0 cm }\n", 4,
              "found 'at 0 0.019 0 cm', expected a place apart from the cloth by a quarter of its thickness "
              "at least: at tick "
              "0 it is at warp 0, weft 0");
  check_apart(TRIANGLES "mesh m { obj tests/scenes/meshes/sword.obj at 0.1 1 0.1 cm }\n", 5,
              "found 'at 0.1 1 0.1 cm', expected a place apart from the cloth by a quarter of its thickness "
              "at least: at "
              "tick 0 it is in the membrane, 1 cm along its weft, 1 cm along its warp");
  check_apart(TRIANGLES "sphere b { radius 0.1 cm at 0.3 0 0.1 cm }\n", 5,
              "found 'at 0.3 0 0.1 cm', expected its middle beside the cloth: at tick 0 it is in the "
              "membrane, 3 cm ");
}

static void only_images_with_meshes_have_them(void) {
  fixture_scoped f = {0};
  fixture_text(&f, SHEET);
  CHECK_EQ_INT(f.w->capacity[POOL_RIGID_MESH_WORDS], 0);
  fixture_close(&f);
  fixture_text(&f, SHEET BOX);
  CHECK(f.w->capacity[POOL_RIGID_MESH_WORDS] != 0);
}

static void a_saved_world_goes_on(void) {
  fixture_scoped f = {0};
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
}

/* With the CRC put right, a flipped bit of the section is found by what it means, or is another mesh,
 * which runs. */
static void damaged_meshes_are_harmless(void) {
  fixture_scoped f = {0};
  fixture_text(&f, SHEET BOX);
  const uint32_t words = f.w->capacity[POOL_RIGID_MESH_WORDS];
  const uint32_t refused = damage_each_bit(&f, IMAGE_RIGID_MESHES, words);
  printf("  %u bits: %u refused\n", 32 * words, refused);
  CHECK(refused > 16 * words);
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
