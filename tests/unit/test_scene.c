/* SPDX-License-Identifier: Apache-2.0 */
/* Runs in the repository's root: it reads tests/scenes. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/lib/test.h"
#include "tools/scene_language/scene.h"

static scene parsed;
static scene_error failure;

/* The text is handed over in a buffer of its exact size, so that a sanitizer sees a read behind. */
static int parse_bytes(const char *text, size_t bytes) {
  char *copy = malloc(bytes + (bytes == 0));
  if (copy == NULL) return 0;
  memcpy(copy, text, bytes);
  int good = scene_parse("x.scene", copy, bytes, &parsed, &failure);
  free(copy);
  return good;
}

static int parse(const char *text) { return parse_bytes(text, strlen(text)); }

static void check_parses(const char *text) {
  int good = parse(text);
  if (!good) printf("%s\n%d:%d: %s\n", text, failure.line, failure.column, failure.message);
  CHECK(good);
}

static void check_fails(const char *text, int line, int column, const char *message) {
  CHECK(!parse(text));
  CHECK_EQ_INT(failure.line, line);
  CHECK_EQ_INT(failure.column, column);
  CHECK_TEXT(failure.message, message);
  CHECK_TEXT(failure.file, "x.scene");
}

#define CHECK_EXACT(value, n, d) \
  do { \
    exact checked = (value); \
    CHECK_EQ_INT(checked.numerator, n); \
    CHECK_EQ_INT(checked.denominator, d); \
  } while (0)

#define WOVEN "woven { warps 8 wefts 6 spacing 12 /cm }\n"
#define START "scene s\n" WOVEN
#define IN_WOVEN(text) "scene s\nwoven { warps 8 wefts 6 spacing 12 /cm\n" text "\n}\n"
#define IN_SPHERE(text) START "sphere b { radius 1 cm\n" text "\n}\n"

static void fills_in_defaults(void) {
  check_parses(START);
  CHECK_TEXT(parsed.name, "s");
  CHECK_EQ_INT(parsed.rate_hz, 1000);
  CHECK_EQ_INT(parsed.substeps, 0);
  CHECK_EQ_INT(parsed.iterations, 1);
  CHECK_EQ_INT(parsed.seed, 1);
  CHECK_EXACT(parsed.gravity[1], -981, 1);
  CHECK_EXACT(parsed.settle, 0, 1);
  CHECK_EXACT(parsed.max_rest_strain, 1, 20);
  CHECK_EQ_INT(parsed.source.block[BLOCK_CLOTH].line, 2);
  CHECK_EXACT(parsed.woven.warp_spacing, 1, 12);
  CHECK_EXACT(parsed.woven.weft_spacing, 1, 12);
  CHECK_EXACT(parsed.woven.density, 1, 4);
  CHECK_EXACT(parsed.woven.tear_max, 1, 10);
  CHECK_EQ_INT(parsed.woven.tearing, 1);
  CHECK_EQ_INT(parsed.woven.vertical, 1);
  CHECK_EQ_INT(parsed.woven.pleats, 8);
  CHECK_TEXT(parsed.woven.weave_name, "plain");
  CHECK_EQ_INT(parsed.limits.contacts, 48);
  CHECK_EQ_INT(parsed.limits.tears_per_tick, 16);
  CHECK_EXACT(parsed.hands.force_rate, 4000, 1);
  CHECK_EXACT(parsed.hands.ramp_down, 1, 100);
}

static void converts_units(void) {
  check_parses("scene s rate 2 kHz gravity 0 -9.81 0 m/s2 settle 250 ms seed 4294967295\n"
               "hands { force_limit 500 mN force_rate 4 N/ms speed 2 m/s ramp_up 50 ms }\n"
               "woven { warps 3 wefts 4 spacing 0.5 0.25 mm density 250 g/m2 thickness 100 um\n"
               "bend 0.005 N/m tear 0.05 0.1 gather 8% drag 2 /s }");
  CHECK_EQ_INT(parsed.rate_hz, 2000);
  CHECK_EQ_INT(parsed.seed, 4294967295);
  CHECK_EXACT(parsed.gravity[1], -981, 1);
  CHECK_EXACT(parsed.settle, 1, 4);
  CHECK_EXACT(parsed.hands.force_limit, 1, 2);
  CHECK_EXACT(parsed.hands.force_rate, 4000, 1);
  CHECK_EXACT(parsed.hands.speed, 200, 1);
  CHECK_EXACT(parsed.woven.warp_spacing, 1, 20);
  CHECK_EXACT(parsed.woven.weft_spacing, 1, 40);
  CHECK_EXACT(parsed.woven.density, 1, 40);
  CHECK_EXACT(parsed.woven.thickness, 1, 100);
  CHECK_EXACT(parsed.woven.bend, 5, 1);
  CHECK_EXACT(parsed.woven.tear_min, 1, 20);
  CHECK_EXACT(parsed.woven.gather, 2, 25);
  check_parses("scene s\nwoven { warps 3 wefts 4 spacing 10 20 /cm }");
  CHECK_EXACT(parsed.woven.warp_spacing, 1, 10);
  CHECK_EXACT(parsed.woven.weft_spacing, 1, 20);
}

static void check_weave(const char *text, uint32_t columns, uint32_t rows, const char *wanted) {
  char found[SCENE_WEAVE * (SCENE_WEAVE + 1) + 1];
  size_t length = 0;
  check_parses(text);
  CHECK_EQ_INT(parsed.woven.weave_columns, columns);
  CHECK_EQ_INT(parsed.woven.weave_rows, rows);
  for (uint32_t row = 0; row < rows; row++) {
    for (uint32_t column = 0; column < columns; column++) {
      found[length++] = parsed.woven.weave[row][column] ? '1' : '0';
    }
    found[length++] = ' ';
  }
  found[length] = 0;
  CHECK_TEXT(found, wanted);
}

static void weaves(void) {
  check_weave(START, 2, 2, "10 01 ");
  check_weave(IN_WOVEN("weave plain"), 2, 2, "10 01 ");
  check_weave(IN_WOVEN("weave twill 2/1"), 3, 3, "110 101 011 ");
  CHECK_TEXT(parsed.woven.weave_name, "twill 2/1");
  check_weave(IN_WOVEN("weave twill 2/2"), 4, 4, "1100 1001 0011 0110 ");
  check_weave(IN_WOVEN("weave satin 5"), 5, 5, "01111 11011 11110 10111 11101 ");
  check_weave(IN_WOVEN("weave matrix {\n 110\n 001 }"), 3, 2, "110 001 ");
  check_fails(IN_WOVEN("weave twill 5/4"), 3, 13,
              "found '5/4', expected a twill such as 2/1, of 8 yarns at most");
  check_fails(IN_WOVEN("weave satin 6"), 3, 13, "found '6', expected 5, 7 or 8 for 'weave'");
  check_fails(IN_WOVEN("weave matrix { 10 011 }"), 3, 19,
              "found '011', expected a row of the weave with 2 to 2 digits");
  check_fails(IN_WOVEN("weave matrix { 1x }"), 3, 16,
              "found '1x', expected a row of the weave: 1 where the warp is over, 0 where under");
  check_fails(IN_WOVEN("weave matrix { }"), 3, 16,
              "found '}', expected rows of 0 and 1 for the weave's '{' of line 3");
  check_fails(IN_WOVEN("weave matrix { 1 1 1 1 1 1 1 1 1 }"), 3, 32,
              "found '1', expected '}': a weave has at most 8 rows");
}

static void reads_bodies(void) {
  check_parses(START "box b-1 { size 1 2 3 mm rotate 90 deg about z at 1 2 3 cm move free mass 2 kg\n"
               "  velocity 1 0 -1 m/s attach_within -0.1 mm friction 0.5 }\n"
               "capsule rod { length 4 cm radius 2 mm at 0 0 0 m move hand right }\n"
               "plane floor { at 0 -5 0 cm }\n"
               "sphere moved { radius 1 cm move path { 0 s 1 2 3 cm 1 s 4 5 6 cm\n 2 s 7 8 9 mm } }");
  CHECK_EQ_INT(parsed.body_count, 4);
  const scene_body *b = &parsed.bodies[0];
  CHECK_TEXT(b->name, "b-1");
  CHECK_EQ_INT(b->shape, FRAY_BOX);
  CHECK_EQ_INT(b->motion, FRAY_FREE);
  CHECK_EQ_INT(parsed.source.block[BLOCK_BODY].line, 3);
  CHECK_EXACT(b->size[1], 1, 5);
  CHECK_EQ_INT(b->rotation.axis, 2);
  CHECK_EXACT(b->rotation.half_tangent, 1, 1);
  CHECK_EXACT(b->mass, 2000, 1);
  CHECK_EXACT(b->velocity[2], -100, 1);
  CHECK_EQ_INT(b->has_attach, 1);
  CHECK_EXACT(b->attach_within, -1, 100);
  b = &parsed.bodies[1];
  CHECK_EQ_INT(b->motion, FRAY_HAND);
  CHECK_EQ_INT(b->hand, 1);
  CHECK_EQ_INT(b->has_attach, 0);
  CHECK_EQ_INT(b->rotation.axis, -1);
  CHECK_EXACT(b->size[0], 4, 1);
  CHECK_EXACT(b->friction, 3, 10);
  CHECK_EQ_INT(parsed.bodies[2].motion, FRAY_FIXED);
  b = &parsed.bodies[3];
  CHECK_EQ_INT(b->key_first, 0);
  CHECK_EQ_INT(b->keys, 3);
  CHECK_EXACT(b->at[2], 3, 1);
  CHECK_EXACT(parsed.keys[2].time, 2, 1);
  CHECK_EXACT(parsed.keys[2].at[0], 7, 10);
}

static void check_pin(uint32_t n, uint32_t i0, uint32_t i1, uint32_t j0, uint32_t j1) {
  CHECK_EQ_INT(parsed.pins[n].i0, i0);
  CHECK_EQ_INT(parsed.pins[n].i1, i1);
  CHECK_EQ_INT(parsed.pins[n].j0, j0);
  CHECK_EQ_INT(parsed.pins[n].j1, j1);
}

static void reads_pins(void) {
  check_parses("scene s\npin row top\npin row bottom\npin column left\npin column right\n"
               "pin row 3\npin crossing 7 5\npin block 1 2 3 4\n" WOVEN);
  CHECK_EQ_INT(parsed.pin_count, 7);
  check_pin(0, 0, 7, 0, 0);
  check_pin(1, 0, 7, 5, 5);
  check_pin(2, 0, 0, 0, 5);
  check_pin(3, 7, 7, 0, 5);
  check_pin(4, 0, 7, 3, 3);
  check_pin(5, 7, 7, 5, 5);
  check_pin(6, 1, 2, 3, 4);
  CHECK_EQ_INT(parsed.pins[6].place.line, 8);
  check_fails(START "pin crossing 8 0\n", 3, 1,
              "found a pin at warp 8, weft 0, expected it inside the grid: warps 0 to 7, wefts 0 "
              "to 5");
  check_fails(START "pin block 2 1 0 0\n", 3, 1,
              "found a block that ends before it begins, expected 'pin block' FIRST_WARP "
              "LAST_WARP FIRST_WEFT LAST_WEFT");
  check_fails(START "pin row middle\n", 3, 9,
              "found 'middle', expected top, bottom or a number for 'pin'");
  check_fails(START "pin crossing 1.5 0\n", 3, 14,
              "found '1.5', expected a whole number for 'pin'");
}

static void reads_slits_and_pins_by_bodies(void) {
  check_parses("scene s\nslit warp 3 0 5\nslit weft 4 2 2\npin crossing 1 2 by b\n" WOVEN
               "sphere b {\n radius 1 cm\n at 0 0 9 cm\n}\n");
  CHECK_EQ_INT(parsed.slit_count, 2);
  CHECK_EQ_INT(parsed.slits[0].beside_weft, 0);
  CHECK_EQ_INT(parsed.slits[0].yarn, 3);
  CHECK_EQ_INT(parsed.slits[0].last, 5);
  CHECK_EQ_INT(parsed.slits[1].beside_weft, 1);
  CHECK_EQ_INT(parsed.slits[1].first, 2);
  CHECK_EQ_INT(parsed.pins[0].by, 0);
  CHECK(parsed.bodies[0].has_attach);
  check_fails(START "slit warp 7 0 5\n", 3, 1,
              "found a slit beside warp 7 from 0 to 5, expected it inside the grid: warp 0 to 6, from 0 "
              "to 5");
  check_fails(START "slit weft 2 5 8\n", 3, 1,
              "found a slit beside weft 2 from 5 to 8, expected it inside the grid: weft 0 to 4, from 0 "
              "to 7");
  check_fails(START "slit side 2 5 8\n", 3, 6, "found 'side', expected warp, weft, column or row for 'slit'");
  check_fails(START "slit row 2 5 8\n", 3, 1,
              "found 'slit row', expected 'slit warp' or 'slit weft' for this cloth");
  check_fails(START "pin row top by clamp\n", 3, 16, "found 'clamp', expected the name of a body");
}

static void accepts_odd_layout(void) {
  check_parses("\r\n# a comment { \" }\r\nscene s # why\r\n\twoven{warps 8 wefts 6\r\n"
               "spacing 12/cm}\r\nlimits\r\n{ }\r\n");
  check_parses("scene s woven{warps 8 wefts 6 spacing 12/cm}#");
  check_parses(IN_WOVEN("tear mirrored\ntear 5 10%"));
}

static void names_what_is_wrong(void) {
  check_fails(START "rate 1000 kg\n", 3, 11,
              "found 'kg', expected a unit of frequency for 'rate': Hz, kHz");
  check_fails(START "rate 1000\nseed 1\n", 3, 10,
              "found the end of the line, expected a unit of frequency for 'rate': Hz, kHz");
  check_fails(START "rate 20 kHz\n", 3, 6, "found '20 kHz', expected 0.001 to 10 kHz for 'rate'");
  check_fails(START "rate 1.5 Hz\n", 3, 6, "found '1.5', expected a whole number for 'rate'");
  check_fails(START "rate\nseed 1\n", 3, 5,
              "found the end of the line, expected a whole number for 'rate'");
  check_fails(START "substeps many\n", 3, 10,
              "found 'many', expected auto or a whole number for 'substeps'");
  check_fails(START "iterations 3x\n", 3, 13,
              "found 'x', expected nothing behind the plain number for 'iterations'");
  check_fails(START "gravity 0 -981 cm/s2\n", 3, 16,
              "found 'cm/s2', expected 3 numbers for 'gravity'");
  check_fails(START "seed 1234567890123456789\n", 3, 6,
              "found '1234567890123456789', expected a number of at most 18 digits");
  check_fails(START "seed 1e19\n", 3, 6,
              "found '1e19', expected a number that is neither so large nor so small");
  check_fails(START "gravity 1e18 0 0 m/s2\n", 3, 9,
              "found '1e18 m/s2', expected -1000 to 1000 m/s2 for 'gravity'");
  check_fails(START "limits { contact 3 }\n", 3, 10,
              "found 'contact' (did you mean 'contacts'?), expected a key of limits: spare_particles, "
              "spare_triangles, contacts, "
              "tears_per_tick, splits_per_tick, self_collision_pairs");
  check_fails(START "speed 3\n", 3, 1, "found 'speed' in the scene, expected it in a block of 'hands'");
  check_fails(START "tempo 3\n", 3, 1,
              "found 'tempo', expected a key of the scene: scene, rate, substeps, iterations, "
              "gravity, seed, settle, max_rest_strain, wind, woven, membrane, material, load, sphere, box, "
              "capsule, plane, mesh, pin, slit, limits, hands");
  check_fails(START "}\n", 3, 1, "found '}', expected no brace: no block is open");
  check_fails(START "seed 1\nseed 2\n", 4, 1,
              "found 'seed' again in the scene, expected it once; see line 3");
  check_fails(START "limits 3 { }\n", 3, 8, "found '3', expected '{' behind 'limits'");
}

static void checks_the_cloth(void) {
  check_fails("scene s\n", 1, 1, "the scene has no cloth, expected 'woven' or 'membrane': "
                                  "woven { warps 16 wefts 16 spacing 12 /cm }");
  check_fails(WOVEN, 1, 1, "the scene has no 'scene', expected one");
  check_fails("", 1, 1, "the scene has no 'scene', expected one");
  check_fails("scene s\n\n woven { warps 8 wefts 6 }\n", 3, 2,
              "the woven cloth has no 'spacing', expected one");
  check_fails("scene s\nwoven { warps 1 wefts 6 }\n", 2, 15,
              "found '1', expected 2 to 1024 for 'warps'");
  check_fails("scene s\nwoven { warps 1024 wefts 512 spacing 1 mm }\n", 2, 1,
              "found 1024 x 512 = 524288 crossings, expected at most 262144");
  check_fails("scene s\nwoven { warps 8 spacing 12 furlong }\n", 2, 28,
              "found 'furlong', expected a unit of length or of yarns per length for 'spacing': "
              "um, mm, cm, m, /cm, /mm, /m");
  check_fails("scene s\nwoven { spacing 0 /cm }\n", 2, 17,
              "found '0 /cm', expected 0.1 to 1000 /cm for 'spacing'");
  check_fails(IN_WOVEN("tear 10 5 %"), 3, 1,
              "found a minimum above the maximum, expected the smaller strain first for 'tear'");
  check_fails(IN_WOVEN("tear 5 500 %"), 3, 8, "found '500 %', expected 0.1 to 400 % for 'tear'");
  check_fails(IN_WOVEN("tear off\ntear 5 10 %"), 4, 1,
              "found 'tear' again, expected it once; see line 3");
  check_fails(IN_WOVEN("tear yes"), 3, 6,
              "found 'yes', expected 2 numbers (minimum and maximum strain), off or mirrored for "
              "'tear'");
  check_fails(IN_WOVEN("gather 91 %"), 3, 8, "found '91 %', expected 0 to 90 % for 'gather'");
  check_fails(IN_WOVEN("orientation upright"), 3, 13,
              "found 'upright', expected horizontal or vertical for 'orientation'");
  check_fails("scene s\nwoven { warps 8 wefts 6\nspacing 12 /cm\n", 4, 1,
              "found the end of the file, expected '}' for the woven cloth of line 2");
  check_fails("scene s\nwoven { warps 8\nsphere b { radius 1 cm }\n", 3, 1,
              "found 'sphere' in the woven cloth; is the '{' of line 2 not closed? Its keys: warps, "
              "wefts, spacing, weave, density, structural, bend, shear, shear_lock, tear, gather, pleats, "
              "damping, yarns, split_strain, disconnect_at, disconnect_by, spread_splits, crossing_friction, "
              "slip_friction, static_friction, stretch, stretch_damping, at, orientation, thickness, drag, "
              "self_collision, self_thickness");
}

static void reads_yarns(void) {
  check_parses(IN_WOVEN("tear 4 20 %"));
  CHECK_EQ_INT(parsed.woven.yarns, 0);
  CHECK_EXACT(parsed.woven.split_strain_min, 9, 250);
  CHECK_EXACT(parsed.woven.split_strain_max, 9, 50);
  CHECK_EXACT(parsed.woven.disconnect_at, 1, 50);
  CHECK_EXACT(parsed.woven.slip_friction, 0, 1);
  CHECK_EXACT(parsed.woven.static_friction, 1, 1);
  CHECK_EXACT(parsed.woven.crossing_friction, 0, 1);
  CHECK_EQ_INT(parsed.woven.disconnect_by_particles, 0);
  CHECK_EQ_INT(parsed.woven.spread_splits, 0);
  CHECK_EQ_INT(parsed.limits.splits_per_tick, 32);
  CHECK_EQ_INT(parsed.limits.spare_particles, 0);
  check_parses(IN_WOVEN("yarns on split_strain 3 4 % disconnect_at 0.3 mm disconnect_by particles "
                        "spread_splits on "
                        "slip_friction "
                        "0.25 static_friction 1.5 crossing_friction 2 mN"));
  CHECK_EQ_INT(parsed.woven.yarns, 1);
  CHECK_EXACT(parsed.woven.split_strain_min, 3, 100);
  CHECK_EXACT(parsed.woven.split_strain_max, 1, 25);
  CHECK_EXACT(parsed.woven.disconnect_at, 3, 100);
  CHECK_EXACT(parsed.woven.slip_friction, 1, 4);
  CHECK_EXACT(parsed.woven.static_friction, 3, 2);
  CHECK_EXACT(parsed.woven.crossing_friction, 1, 500);
  CHECK_EQ_INT(parsed.woven.disconnect_by_particles, 1);
  CHECK_EQ_INT(parsed.woven.spread_splits, 1);
  CHECK_EQ_INT(parsed.limits.spare_particles, 48);
  check_parses(IN_WOVEN("yarns all") "limits { spare_particles 7 splits_per_tick 1 }\n");
  CHECK_EQ_INT(parsed.woven.yarns, 2);
  CHECK_EQ_INT(parsed.limits.spare_particles, 7);
  CHECK_EQ_INT(parsed.limits.splits_per_tick, 1);
  check_fails(IN_WOVEN("yarns some"), 3, 7, "found 'some', expected off, on or all for 'yarns'");
  check_fails(IN_WOVEN("split_strain 5 4 %"), 3, 1,
              "found a minimum above the maximum, expected the smaller strain first for 'split_strain'");
}

static void checks_bodies(void) {
  check_fails(IN_SPHERE("move fixed"), 3, 1, "sphere 'b' has no 'at', expected one");
  check_fails(START "box b { at 0 0 0 cm }\n", 3, 1, "box 'b' has no 'size', expected one");
  check_fails(IN_SPHERE("at 0 0 0 cm move free"), 3, 1,
              "sphere 'b' has 'move free' and no 'mass', expected one");
  check_fails(IN_SPHERE("at 0 0 0 cm mass 1 g"), 4, 13,
              "found 'mass' in sphere 'b', expected it only in a body with 'move free'");
  check_fails(IN_SPHERE("at 0 0 0 cm") "capsule b { }\n", 6, 9,
              "found a second body 'b', expected another name; see line 3");
  check_fails(IN_SPHERE("at 0 0 0 cm move hand left") "sphere c { move hand left }\n", 6, 12,
              "found a second body on the left hand, expected one at most; see line 4");
  check_fails(IN_SPHERE("move path { 0 s 1 2 3 cm 0 s 1 2 3 cm }"), 4, 26,
              "found a time that is not later than the one before, expected rising times in a path");
  check_fails(IN_SPHERE("move path { -1 s 1 2 3 cm }"), 4, 13,
              "found '-1 s', expected 0 to 86400 s for 'path'");
  check_fails(IN_SPHERE("move path { }"), 4, 13,
              "found '}', expected keyframes of a path: TIME s X Y Z cm");
  check_fails(IN_SPHERE("at 1 2 4 cm move path { 0 s 1 2 3 cm }"), 4, 1,
              "found an 'at' of sphere 'b' that differs from the start of its path, expected the same, "
              "or no 'at'");
  check_fails(START "plane p { at 0 0 0 cm attach_within 1 cm }\n", 3, 23,
              "found 'attach_within', expected a key of plane 'p': at, rotate, move, friction");
  check_fails(START "plane p { at 0 0 0 cm move free }\n", 3, 28,
              "found 'free', expected fixed or path for 'move'");
  check_fails(START "capsule b { rotate 45 deg about w }\n", 3, 33,
              "found 'w', expected x, y or z for 'rotate'");
  check_fails(START "capsule b { rotate 180 deg about x }\n", 3, 20,
              "found '180 deg', expected -170 to 170 deg for 'rotate'");
  check_fails(START "sphere 2 { }\n", 3, 8,
              "found '2', expected a name for 'sphere' that begins with a letter");
  check_fails(START "sphere a.b { }\n", 3, 8,
              "found 'a.b', expected a name of letters, digits, _ and - for 'sphere'");
  check_fails(START "sphere abcdefghijklmnopqrstuvwxyzabcdef { }\n", 3, 8,
              "found 'abcdefghijklmnopqrstuvwxyzabcdef', expected a name of at most 31 characters "
              "for 'sphere'");
}

static void refuses_odd_bytes(void) {
  check_fails("scene s\n # caf\xc3\xa9\n", 2, 7, "found the byte 0xC3, expected printable ASCII");
  check_fails("scene s\rrate 1 Hz\n", 1, 8, "found a carriage return alone, expected a line feed behind it");
  CHECK(!parse_bytes("scene\0s", 7));
  CHECK_EQ_INT(failure.column, 6);
  CHECK_TEXT(failure.message, "found the byte 0x00, expected printable ASCII");
  CHECK(!parse_bytes("\r", 1));
}

static void append(char *text, size_t capacity, const char *format, int n) {
  size_t length = strlen(text);
  snprintf(text + length, capacity - length, format, n, n);
}

static void limits_what_it_holds(void) {
  static char text[400000];
  snprintf(text, sizeof text, START);
  for (int k = 0; k < SCENE_BODIES; k++) {
    append(text, sizeof text, "plane p%d { at 0 %d 0 cm }\n", k);
  }
  check_parses(text);
  append(text, sizeof text, "plane p%d { at 0 %d 0 cm }\n", SCENE_BODIES);
  check_fails(text, 3 + SCENE_BODIES, 1, "found body 17, expected at most 16 in a scene");
  snprintf(text, sizeof text, START);
  for (int k = 0; k < SCENE_PINS; k++) append(text, sizeof text, "pin row top\n", k);
  check_parses(text);
  append(text, sizeof text, "pin row top\n", 0);
  check_fails(text, 3 + SCENE_PINS, 1, "found pin 65, expected at most 64 in a scene");
  snprintf(text, sizeof text, START "sphere b { radius 1 cm move path {\n");
  for (int k = 0; k < SCENE_KEYFRAMES; k++) append(text, sizeof text, "%d s %d 0 0 mm\n", k);
  size_t full = strlen(text);
  append(text, sizeof text, "} }\n", 0);
  check_parses(text);
  text[full] = 0;
  append(text, sizeof text, "%d s %d 0 0 mm\n", SCENE_KEYFRAMES);
  check_fails(text, 4 + SCENE_KEYFRAMES, 1,
              "found keyframe 4097, expected at most 4096 in a scene");
  memset(text, 'x', 100000);
  CHECK(!parse_bytes(text, 100000));
  CHECK(strstr(failure.message, "found 'xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx...', expected") != NULL);
  memset(text, '9', 100000);
  memcpy(text, "rate ", 5);
  CHECK(!parse_bytes(text, 100000));
}

static void reads_the_scenes(void) {
  static const char *const names[] = {"two_hands", "hanging", "weight", "thrown_ball", "cube",
                                      "bars_apart", "corner_load", "small", "mirror"};
  static char text[8192];
  for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
    char path[64];
    snprintf(path, sizeof path, "tests/scenes/%s.scene", names[k]);
    FILE *file = fopen(path, "rb");
    CHECK(file != NULL);
    if (file == NULL) continue;
    size_t bytes = fread(text, 1, sizeof text - 1, file);
    fclose(file);
    text[bytes] = 0;
    check_parses(text);
    CHECK_TEXT(parsed.name, names[k]);
    for (size_t cut = 0; cut < bytes; cut++) parse_bytes(text, cut); /* must not crash */
  }
}

int main(void) {
  TEST(fills_in_defaults);
  TEST(converts_units);
  TEST(weaves);
  TEST(reads_bodies);
  TEST(reads_pins);
  TEST(accepts_odd_layout);
  TEST(names_what_is_wrong);
  TEST(checks_the_cloth);
  TEST(reads_yarns);
  TEST(reads_slits_and_pins_by_bodies);
  TEST(checks_bodies);
  TEST(refuses_odd_bytes);
  TEST(limits_what_it_holds);
  TEST(reads_the_scenes);
  return test_end();
}
