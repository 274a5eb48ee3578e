/* SPDX-License-Identifier: Apache-2.0 */
/* OBJ files: what is read, how faces become triangles and join, and every way to be refused. Runs in
 * the repository's root: it reads tests/scenes/meshes. */
#include <stdio.h>
#include <stdlib.h>

#include "tests/lib/test.h"
#include "tools/mesh_import/obj.h"

static obj_mesh mesh;
static scene_error failure;

/* In a buffer of its exact size, so that a sanitizer sees a read behind. Frees the mesh of before. */
static int parse_bytes(const char *text, size_t bytes) {
  char *copy = malloc(bytes + (bytes == 0));
  if (copy == NULL) return 0;
  memcpy(copy, text, bytes);
  obj_free(&mesh);
  memset(&failure, 0, sizeof failure);
  const int good = obj_read("x.obj", copy, bytes, &mesh, &failure);
  free(copy);
  return good;
}
static void check_parses(const char *text) {
  const int good = parse_bytes(text, strlen(text));
  if (!good) printf("%s\n%d:%d: %s\n", text, failure.line, failure.column, failure.message);
  CHECK(good);
}
static void check_fails(const char *text, int line, int column, const char *message) {
  CHECK(!parse_bytes(text, strlen(text)));
  CHECK_EQ_INT(failure.line, line);
  CHECK_EQ_INT(failure.column, column);
  CHECK_TEXT(failure.message, message);
  CHECK_TEXT(failure.file, "x.obj");
}
static void check_triangle(uint32_t n, uint32_t a, uint32_t b, uint32_t c, uint32_t face, int line) {
  if (n >= mesh.triangle_count) return;
  const obj_triangle *t = &mesh.triangles[n];
  CHECK(t->point[0] == a && t->point[1] == b && t->point[2] == c);
  CHECK_EQ_INT(t->face, face);
  CHECK_EQ_INT(t->line, line);
}

#define SQUARE "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"

static void reads_points_exactly(void) {
  check_parses("v 0.1 -2.5e-1 3\r\nv 1 0 0 1\nv 0 1 0 0.5 0.5 0.5\nf 1 2 3\n");
  CHECK_EQ_INT(mesh.point_count, 3);
  CHECK_EQ_INT(mesh.points[0].at[0].numerator, 1);
  CHECK_EQ_INT(mesh.points[0].at[0].denominator, 10);
  CHECK_EQ_INT(mesh.points[0].at[1].numerator, -1);
  CHECK_EQ_INT(mesh.points[0].at[1].denominator, 4);
  CHECK_EQ_INT(mesh.points[2].line, 3);
}

static void faces_become_fans(void) {
  check_parses(SQUARE "v 0.5 2 0\nf 1/1 2/2/2 3//3 5 4\n");
  CHECK_EQ_INT(mesh.triangle_count, 3);
  check_triangle(0, 0, 1, 2, 0, 6);
  check_triangle(1, 0, 2, 4, 0, 6);
  check_triangle(2, 0, 4, 3, 0, 6);
}

static void numbers_count_from_the_end_too(void) {
  check_parses("v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 0 1 0\nf -4 -2 -1\n");
  check_triangle(1, 0, 2, 3, 1, 6);
}

/* The edge between two points runs from `a` to `b`, between triangle 1 and `other`. */
static void check_edge(uint32_t from, uint32_t to, uint32_t a, uint32_t b, uint32_t other) {
  const uint32_t found = obj_edge_between(&mesh, from, to);
  CHECK(found != OBJ_NONE);
  if (found == OBJ_NONE) return;
  const obj_edge *e = &mesh.edges[found];
  CHECK(e->point[0] == a && e->point[1] == b && e->triangle[0] == 1 && e->triangle[1] == other);
}

static void triangles_join_at_edges(void) {
  check_parses(SQUARE "f 1 2 3\nf 1 3 4\n");
  CHECK_EQ_INT(mesh.edge_count, 5);
  check_edge(2, 0, 0, 2, 0);
  check_edge(0, 3, 3, 0, OBJ_NONE);
  CHECK(obj_edge_between(&mesh, 1, 3) == OBJ_NONE);
}

static void marks_and_what_is_read_over(void) {
  check_parses("mtllib a.mtl\no thing\ng a b\ns off\nusemtl m\nvt 0 0\nvn 0 0 1\n# comment\n\n"
               "v 0 0 0 # a point\nv 1 0 0\nv \\\n 1 1 0\nf 1 \\\r\n 2 3\nl 1 2 3\np 1 -1\n");
  CHECK_EQ_INT(mesh.mark_count, 4);
  CHECK(mesh.marks[1].point[0] == 1 && mesh.marks[1].point[1] == 2);
  CHECK(mesh.marks[3].point[0] == 2 && mesh.marks[3].point[1] == 2);
  CHECK_EQ_INT(mesh.marks[3].line, 17);
  CHECK_EQ_INT(mesh.points[2].line, 12);
}

static void refuses_bad_lines(void) {
  check_fails("v 0 0\n", 1, 6, "found the end of the line, expected 3 numbers for 'v'");
  check_fails("v 0 0 x\n", 1, 7, "found 'x', expected a number");
  check_fails("v 0 0 nan\n", 1, 7, "found 'nan', expected a number");
  check_fails("v 0 0 1e99\n", 1, 7,
              "found '1e99', expected a number that is neither so large nor so small");
  check_fails("v 0 0 0.1234567890123456789\n", 1, 7,
              "found '0.1234567890123456789', expected a number of at most 18 digits");
  check_fails("v 0 0 0 0 0 0 0\n", 1, 15, "found '0', expected at most 6 numbers for 'v'");
  check_fails("v 0 0 0 0 0\n", 1, 12, "found the end of the line, expected 3 numbers for 'v'");
  check_fails("v 0 0 0 2\n", 1, 1,
              "found a fourth number that is not 1, expected a point of a polygon mesh");
  check_fails("curv 0 1\n", 1, 1,
              "found 'curv', expected v, f, l, p, or keys that are skipped: vt, vn, vp, o, g, s, mg, usemtl, "
              "mtllib");
  check_fails("w\x01 1\n", 1, 1,
              "found 'w?', expected v, f, l, p, or keys that are skipped: vt, vn, vp, o, g, s, mg, usemtl, "
              "mtllib");
  check_fails("", 0, 0, "has no faces, expected lines 'v x y z' and 'f a b c'");
  check_fails(SQUARE, 0, 0, "has no faces, expected lines 'v x y z' and 'f a b c'");
}

#define CORNER "the number of a point of an earlier line, from 1 or below 0"

static void refuses_bad_faces(void) {
  check_fails(SQUARE "f 1 2\n", 5, 6, "found the end of the line, expected at least 3 corners for 'f'");
  check_fails(SQUARE "f 1 2 5\n", 5, 7, "found '5', expected " CORNER);
  check_fails(SQUARE "f 1 2 0\n", 5, 7, "found '0', expected " CORNER);
  check_fails(SQUARE "f 1 2 -5\n", 5, 7, "found '-5', expected " CORNER);
  check_fails(SQUARE "f 1 2 99999999999999999999\n", 5, 7, "found '99999999999999999999', expected " CORNER);
  check_fails(SQUARE "f 1 2 3/\n", 5, 7, "found '3/', expected a corner as 1, 1/2, 1//3 or 1/2/3");
  check_fails(SQUARE "f 1 2 3/1/1/1\n", 5, 7,
              "found '3/1/1/1', expected a corner as 1, 1/2, 1//3 or 1/2/3");
  check_fails(SQUARE "f 1 2 1\n", 5, 7, "found '1', expected each corner of a face once");
  check_fails(SQUARE "l 1\n", 5, 4, "found the end of the line, expected 2 points for 'l'");
  check_fails(SQUARE "l 1 1\n", 5, 5, "found '1', expected another point than the one before");
  check_fails(SQUARE "p\n", 5, 2, "found the end of the line, expected a point for 'p'");
}

static void refuses_what_is_no_manifold(void) {
  check_fails(SQUARE "v 0 0 1\nf 1 2 3\nf 3 1 4\nf 1 3 5\n", 8, 0,
              "found 3 triangles at the edge of points 1 and 3, expected at most 2");
  check_fails(SQUARE "f 1 2 3\nf 1 4 3\n", 6, 0,
              "found two triangles that pass the edge of points 1 and 3 in the same direction, expected "
              "all faces anticlockwise as seen from outside");
  check_fails(SQUARE "v 2 2 0\nf 1 2 3\nf 3 5 4\n", 7, 0,
              "found triangles at point 3 that only touch there, expected them to share edges around it");
  check_fails(SQUARE "f 1 2 3\n", 4, 0, "found point 4 in no face, expected one or no such point");
}

static void too_much_is_refused(void) {
  static char text[OBJ_CORNERS_MAX * 32 + 1024];
  size_t at = 0;
  for (int n = 0; n <= OBJ_CORNERS_MAX; ++n)
    at += (size_t)snprintf(text + at, sizeof text - at, "v %d %d 0\n", n, n * n);
  at += (size_t)snprintf(text + at, sizeof text - at, "f");
  for (int n = 0; n <= OBJ_CORNERS_MAX; ++n)
    at += (size_t)snprintf(text + at, sizeof text - at, " %d", n + 1);
  CHECK(!parse_bytes(text, at));
  CHECK_TEXT(failure.message, "found '65', expected at most 64 corners of a face");
}

static void check_file(const char *file, uint32_t points, uint32_t edges, uint32_t triangles) {
  obj_free(&mesh);
  CHECK(obj_load(file, &mesh, &failure));
  CHECK_EQ_INT(mesh.point_count, points);
  CHECK_EQ_INT(mesh.edge_count, edges);
  CHECK_EQ_INT(mesh.triangle_count, triangles);
}
static void files_are_read(void) {
  check_file("tests/scenes/meshes/box.obj", 8, 18, 12);
  check_file("tests/scenes/meshes/ball.obj", 162, 480, 320);
  check_file("tests/scenes/meshes/sword.obj", 9, 21, 14);
  check_file("tests/scenes/meshes/plate.obj", 4, 5, 2);
  obj_free(&mesh);
  CHECK(!obj_load("tests/scenes/meshes", &mesh, &failure));
  CHECK_TEXT(failure.message, "cannot be read: it is a folder, expected a file");
  CHECK(!obj_load("tests/scenes/meshes/none.obj", &mesh, &failure));
}

/* Returns 1 for a mesh. */
static uint32_t is_mesh_or_refused(const char *text, size_t bytes) {
  const int good = parse_bytes(text, bytes);
  CHECK(good || failure.message[0] != 0);
  return (uint32_t)good;
}

/* Cut off anywhere, and with any byte changed, it is refused with a message or is a mesh. */
static void damaged_files_are_harmless(void) {
  char text[1024];
  FILE *in = fopen("tests/scenes/meshes/box.obj", "rb");
  CHECK(in != NULL);
  if (in == NULL) return;
  const size_t bytes = fread(text, 1, sizeof text, in);
  fclose(in);
  uint32_t meshes = 0;
  for (size_t cut = 0; cut < bytes; ++cut) meshes += is_mesh_or_refused(text, cut);
  for (size_t n = 0; n < bytes; ++n) {
    const char was = text[n];
    for (int byte = 0; byte < 256; ++byte) {
      text[n] = (char)byte;
      meshes += is_mesh_or_refused(text, bytes);
    }
    text[n] = was;
  }
  printf("  %u damaged files, %u of them still meshes\n", (unsigned)(bytes * 257), meshes);
}

int main(void) {
  TEST(reads_points_exactly);
  TEST(faces_become_fans);
  TEST(numbers_count_from_the_end_too);
  TEST(triangles_join_at_edges);
  TEST(marks_and_what_is_read_over);
  TEST(refuses_bad_lines);
  TEST(refuses_bad_faces);
  TEST(refuses_what_is_no_manifold);
  TEST(too_much_is_refused);
  TEST(files_are_read);
  TEST(damaged_files_are_harmless);
  return test_end();
}
