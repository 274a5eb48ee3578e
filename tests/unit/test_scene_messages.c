/* SPDX-License-Identifier: Apache-2.0 */
/* What a scene that does not compile is told, by the parser or the compiler: the place of the key, what was
 * found, in the unit of the text, and what was expected, in the same. And notes on keys that have no effect.
 */
#include "tests/lib/test.h"

#include "tests/lib/world_fixture.h"

#define WOVEN "scene s\nsubsteps 8\nwoven {\n warps 8\n wefts 8\n spacing 12 /cm\n"
#define MEMBRANE "scene s\nmembrane {\n columns 6\n rows 4\n cell 1 cm\n"
#define DENIM MEMBRANE " material denim\n}\n"
#define OWN MEMBRANE " material x\n}\nmaterial x {\n"

typedef struct {
  const char *text;
  int line, column;
  const char *message; /* its beginning */
} message_case;

static void check(const message_case *c) {
  fixture_scoped f = {0};
  scene_error error;
  const int good = fixture_compile(&f, "t", c->text, &error);
  const int same = !good && strncmp(error.message, c->message, strlen(c->message)) == 0;
  CHECK(!good);
  if (good) printf("compiled:\n%s\n", c->text);
  if (!good && !same) CHECK_TEXT(error.message, c->message);
  if (!good) CHECK_EQ_INT(error.line, c->line);
  if (!good) CHECK_EQ_INT(error.column, c->column);
}

static void check_all(const message_case *cases, size_t count) {
  for (size_t n = 0; n < count; ++n) check(&cases[n]);
}
#define CHECK_ALL(cases) check_all(cases, sizeof(cases) / sizeof(cases)[0])

static void errors_of_cloth(void) {
  static const message_case cases[] = {
      {"scene s\nwoven {\n warps 8\n wefts 8\n spacing 1 cm\n}\n", 5, 2,
       "found 'spacing 1 cm', expected at most 0.624923 cm between yarns"},
      {"scene s\nwoven {\n warps 8\n wefts 8\n spacing 100 /m\n}\n", 5, 2,
       "found 'spacing 100 /m', expected at least 160.02 /m"},
      {WOVEN " at 3 0 0 m\n}\n", 7, 2, "found 'at 3 0 0 m', expected at most 0.6 m"},
      {"rate 100 Hz\n" WOVEN " drag 1000 /s\n}\n", 8, 2,
       "found 'drag 1000 /s', expected at most 100 /s at 100 Hz with 8 substeps"},
      {WOVEN " self_collision on\n self_thickness 500 um # far\n}\n", 8, 2,
       "found 'self_thickness 500 um', expected at most 416.666 um with 'self_collision'"},
      {WOVEN " yarns on\n disconnect_at 0.05 mm\n}\n", 8, 2,
       "found 'disconnect_at 0.05 mm', expected more than 0.1 mm, the thickness"},
      {WOVEN " yarns on\n thickness 0.03 cm\n}\n", 8, 2,
       "found 'thickness 0.03 cm', expected less than 0.02 cm, the distance of 'disconnect_at'"},
      {WOVEN " yarns on\n split_strain 6 11 %\n}\n", 8, 2,
       "found 'split_strain 6 11 %', expected a minimum below 5 % and a range no wider than 5 %"},
      {WOVEN " yarns on\n crossing_friction 1 N\n}\n", 8, 2,
       "found 'crossing_friction 1 N', expected at most 0.277777 N at 1000 Hz with 8 substeps"},
      {WOVEN " stretch 2000 N\n}\n", 7, 2, "found 'stretch 2000 N', expected at least 32 substeps"},
      {WOVEN " stretch 0.5 N\n stretch_damping 1 s\n}\n", 8, 2,
       "found 'stretch_damping 1 s', expected a heavier cloth or a shorter time"},
      {WOVEN " stretch 0.5 N\n stretch_damping 0 s\n}\n", 8, 2,
       "found 'stretch_damping 0 s', expected more than 0"},
      {WOVEN " stretch 0.5 N\n tear 0.05 0.3\n}\n", 8, 2,
       "found 'tear 0.05 0.3', expected at most 0.25 for yarns"},
      {"rate 10 kHz\n" WOVEN " density 100 g/cm2\n}\n", 8, 2,
       "found 'density 100 g/cm2', expected a lighter cloth, or a lower rate than 10000 Hz"},
      {WOVEN " yarns all\n}\nlimits {\n spare_particles 3\n}\n", 10, 2,
       "found 'spare_particles 3', expected 64: one for each free crossing with 'yarns all'"},
  };
  CHECK_ALL(cases);
}

static void errors_of_membranes(void) {
  static const message_case cases[] = {
      {"scene s\nmembrane {\n columns 1000\n rows 9\n cell 1 cm\n material denim\n}\n", 3, 2,
       "found 'columns 1000', expected at most 160 cells of this size"},
      {"scene s\nmembrane {\n columns 6\n rows 1\n cell 1 cm\n material denim\n pattern irregular 3\n}\n", 4,
       2, "found 'rows 1', expected at least 2 with a pattern that is not regular"},
      {DENIM "load right 1e6 0 0 N/m\n", 8, 1,
       "found 'load right 1e6 0 0 N/m', expected at most 33177.6 N/m at 1000 Hz with 1 substep"},
      {DENIM "substeps auto\n", 8, 1,
       "found 'substeps auto' with 'membrane', expected a number, or 1 without the key"},
      {DENIM "iterations auto\n", 8, 1, "found 'iterations' with 'membrane', expected it only with 'woven'"},
      {DENIM "limits {\n splits_per_tick 3\n}\n", 9, 2,
       "found 'splits_per_tick' with 'membrane', expected it only with 'woven'"},
      {WOVEN "}\nlimits {\n spare_triangles 3\n}\n", 9, 2,
       "found 'spare_triangles' with 'woven', expected it only with 'membrane'"},
      {OWN " density 1 g/m2\n isotropic 1e9 N/m 0.3\n}\n", 10, 2,
       "found 'isotropic 1e9 N/m 0.3', expected a stiffness"},
      {OWN " density 200 g/m2\n base denim\n}\n", 10, 2,
       "found 'base' behind 'density 200 g/m2' of line 9, which has no effect then, expected 'base' first"},
      {OWN " base denim\n stretch 45 1 0 1 1 N/m\n stretch all 1 0 1 1 N/m\n}\n", 11, 2,
       "found 'stretch' behind 'stretch 45 1 0 1 1 N/m' of line 10, which has no effect then"},
      {OWN " base denim\n stretch 45 1 0 1 1 N/m\n isotropic 9 N/m 0\n}\n", 11, 2,
       "found 'isotropic' behind 'stretch 45 1 0 1 1 N/m' of line 10, which has no effect then"},
      {OWN " base denim\n isotropic 9 N/m 0\n stretch all 1 0 1 1 N/m\n}\n", 11, 2,
       "found 'stretch' behind 'isotropic 9 N/m 0' of line 10, which has no effect then"},
      {OWN " base denim\n bend 45 1 1 1 1 1 uNm\n bend 45 1 1 1 1 2 uNm\n}\n", 11, 2,
       "found this row of 'bend' again, expected it once"},
      {OWN " density 200 g/m2\n isotropic 9 N/m 0\n bend 0 1 1 1 1 1 uNm\n bend 45 2 2 2 2 2 uNm\n bend 90 1 1 1 1 1 uNm\n}\n",
       11, 2, "found 'bend 0 1 1 1 1 1 uNm', expected a stiffness at 45 degrees below 3.8 / (1 / that at 0 + 1"},
      {OWN " base denim\n}\nmaterial x {\n base paper\n}\n", 11, 10,
       "found a second material 'x', expected another name; see line 8"},
      {DENIM "pin row top\nslit column 3 0 2\n", 9, 1, "found a slit that splits an attached vertex"},
      {DENIM "slit column 3 0 2\nlimits {\n spare_particles 0\n}\n", 8, 1,
       "found too few spare_particles in limits"},
  };
  CHECK_ALL(cases);
}

#define BALL WOVEN "}\nsphere b {\n radius 3 mm\n "

#define FREE_BALL BALL "at 0 0 3 cm\n move free\n mass 9 g\n}\n"

static void errors_of_bodies(void) {
  static const message_case cases[] = {
      {BALL "at 0 0 5 m\n}\n", 10, 2, "found 'at 0 0 5 m', expected at most 0.6 m"},
      {WOVEN "}\nbox b {\n size 1 1 1 m\n at 0 0 60 cm\n}\n", 9, 2,
       "found 'size 1 1 1 m', expected at most 0.32 m"},
      {BALL "at 0 0 1 cm\n move free\n mass 0.001 g\n}\n", 12, 2,
       "found 'mass 0.001 g', expected at least 0.00173612 g, the mass of one crossing"},
      {BALL "at 0 0 0 cm\n move free\n mass 2 mg\n attach_within 0.02 cm\n}\n", 12, 2,
       "found 'mass 2 mg', expected at least 722.223 mg, 8 times that of the 52 crossings that it holds"},
      {BALL "at 0 0 3 cm\n attach_within 0.2 mm\n}\n", 11, 2,
       "found 'attach_within 0.2 mm', expected free cloth within it: the nearest is at 27.0058 mm"},
      {"pin row top\npin row top by b\n" BALL "at 0 0 3 cm\n}\n", 10, 1, "found no cloth for 'b' to hold"},
      {BALL "at 0 0 3 cm\n move free\n mass 2 g\n velocity 0 0 -900 m/s\n}\n", 13, 2,
       "found 'velocity 0 0 -900 m/s', expected less than 320 m/s"},
      {BALL "move path {\n 0 s 0 0 3 cm\n 0.1 ms 0 0 4 cm\n}\n}\n", 12, 2,
       "found a keyframe in the tick of the one before"},
      {BALL "move path {\n 0 s 0 0 3 cm\n 1 s 0 0 4 m\n}\n}\n", 12, 2,
       "found 4 m in a path, expected at most 0.6 m"},
      {BALL "at 0 0 0 cm\n}\n", 10, 2,
       "found 'at 0 0 0 cm', expected a place beside the cloth: at tick 0 warp 3, weft 3"},
      {BALL "move path {\n 0 s 0 0 0 cm\n}\n}\n", 10, 2,
       "found 'move path', expected a place beside the cloth"},
      {WOVEN "}\nbox b {\n size 1 1 1 cm\n at 0 0 0 cm\n}\n", 10, 2,
       "found 'at 0 0 0 cm', expected a place beside"},
      {WOVEN "}\nplane b {\n at 0 3 0 mm\n}\n", 9, 2,
       "found 'at 0 3 0 mm', expected a place beside the cloth: at tick 0 "
       "warp 0, weft 7 is 5.91667 mm inside of it"},
      {DENIM "box b {\n size 3 3 1 cm\n at 0 0 0 cm\n}\n", 10, 2,
       "found 'at 0 0 0 cm', expected a place beside the cloth: "
       "at tick 0 its vertex at "},
      {FREE_BALL "plane g {\n at 0 0 2.8 cm\n rotate -90 deg about x\n}\n", 10, 2,
       "found 'at 0 0 3 cm', expected a place outside of 'g': at tick 0 it is 0.5 cm inside of it; beside it is "
       "0 cm, 0 cm, 2.5 cm"},
      {FREE_BALL "box g {\n size 1 1 1 cm\n at 0 0 3.7 cm\n}\n", 10, 2,
       "found 'at 0 0 3 cm', expected a place outside of 'g': at tick 0 it is 0.1 cm inside of it; beside it is "
       "0 cm, 0 cm, 2.9 cm"},
      {FREE_BALL "capsule g {\n length 4 cm\n radius 5 mm\n at 1 0 3 cm\n move free\n mass 9 g\n}\n", 17, 2,
       "found 'at 1 0 3 cm', expected a place outside of 'b': at tick 0 it is 0.8 cm inside"},
      {DENIM "sphere b {\n radius 1 cm\n at 0 -9 0 cm\n move free\n mass 9 g\n}\nplane g {\n at 0 -9.3 0 cm\n}\n",
       10, 2, "found 'at 0 -9 0 cm', expected a place outside of 'g': at tick 0 it is 0.7 cm inside"},
      {WOVEN "}\nmesh k {\n at 0 0 3 cm\n obj \"none.obj\"\n}\n", 10, 2,
       "mesh 'k': none.obj: cannot be opened: No such file or directory"},
  };
  CHECK_ALL(cases);
}

/* The ball stops the middle, and the cloth meets itself on its way down. */
#define DRAPED \
  "scene s\nwoven {\n warps 24\n wefts 24\n spacing 10 /cm\n orientation horizontal\n self_collision on\n" \
  " tear off\n at 0 1 0 cm\n}\nsphere b {\n radius 4 mm\n at 0 0.4 0 cm\n friction 0.8\n"

static void errors_of_the_scene(void) {
  static const message_case cases[] = {
      {"gravity 0 -900 0 m/s2\nrate 10 Hz\n" WOVEN "}\n", 1, 1,
       "found 'gravity 0 -900 0 m/s2', expected less than 2 m/s2, 1/32 lu a substep in each, at 10 Hz with 8 "
       "substeps"},
      {"rate 10 Hz\n" WOVEN "}\n", 1, 1, "found 'rate 10 Hz', expected more ticks a second than 10"},
      {"settle 60 s\nrate 10 kHz\n" WOVEN "}\n", 1, 1,
       "found 'settle 60 s', expected at most 10 s: 100000 ticks"},
      {WOVEN "}\nhands {\n ramp_up 0.1 ms\n}\n", 9, 2,
       "found 'ramp_up 0.1 ms', expected at least 1 ms at 1000 Hz"},
      {WOVEN "}\nhands {\n speed 1000 m/s\n}\n", 9, 2, "found 'speed 1000 m/s', expected at most 160 m/s"},
      {WOVEN "}\nrate 20 kHz\n", 8, 6, "found '20 kHz', expected 0.001 to 10 kHz for 'rate'"},
      {"rate 60 Hz\n" WOVEN " bend 50 g/s2\n}\n", 8, 2, 
       "found 'bend 50 g/s2', expected at most 1.5625 g/s2: what acts 60 times a second on the mass of a crossing would "
       "make energy"},
      {"rate 60 Hz\n" WOVEN " yarns on\n bend 0.5 g/s2\n shear 50 g/s2\n}\n", 10, 2,
       "found 'shear 50 g/s2', expected at most 0.78125 g/s2: what acts 60 times a second on half the mass of a crossing"},
      {WOVEN " tear 5 10\n}\n", 7, 7, "found '5', expected 0.001 to 4 (0.1 to 400 %) for 'tear'"},
      {DRAPED "}\n", 2, 1,
       "found springs strained by 28.9352 % or more with 96 substeps and 1 iterations in the test run of "
       "'substeps auto', expected less than 5 %, 'max_rest_strain'; give it time to 'settle' before, or a "
       "number of 'substeps'"},
      {DRAPED "}\nlimits { self_collision_pairs 1 }\n", 2, 1,
       "found springs strained by 7.45239 % or more with 128 substeps and 1 iterations in the test run of "
       "'substeps auto', where self-collision ran out of pairs or rounds (SELF_COLLISION_BUDGET), expected "
       "less than 5 %, 'max_rest_strain'; give it time to 'settle' before, more 'self_collision_pairs', or a "
       "number of 'substeps'"},
  };
  CHECK_ALL(cases);
}

/* The test run of 'substeps auto' takes a fall out of the world for what it is. */
static void free_falls(void) {
  static const char *const texts[] = {
      "scene s\nwoven {\n warps 16\n wefts 16\n spacing 12 /cm\n}\n",
      "scene s\nwoven {\n warps 8\n wefts 8\n spacing 10 50 /cm\n}\n",
  };
  for (size_t n = 0; n < sizeof texts / sizeof texts[0]; ++n) {
    fixture_scoped f = {0};
    scene_error error;
    const int good = fixture_compile(&f, "t", texts[n], &error);
    CHECK(good);
    if (!good) CHECK_TEXT(error.message, "");
  }
}

/* What a new user writes. */
static void slips(void) {
  static const message_case cases[] = {
      {WOVEN "}\nsubstep 3\n", 8, 1,
       "found 'substep' (did you mean 'substeps'?), expected a key of the scene: "},
      {WOVEN "}\nRate 1000 Hz\n", 8, 1, "found 'Rate' (did you mean 'rate'?)"},
      {WOVEN "}\nrate: 1000 Hz\n", 8, 1, "found 'rate:' (did you mean 'rate'?)"},
      {WOVEN "}\nrate 1000 hz\n", 8, 11, "found 'hz' (did you mean 'Hz'?), expected a unit of frequency"},
      {WOVEN "}\nrate 1000 Hz;\n", 8, 11, "found 'Hz;' (did you mean 'Hz'?)"},
      {WOVEN "}\ngravity 0, -981, 0 cm/s2\n", 8, 10,
       "found ',', expected a point in decimals and blanks between numbers"},
      {WOVEN " thickness 0,01 cm\n}\n", 7, 13, "found ',01', expected a point in decimals"},
      {WOVEN "}\n// a comment\n", 8, 1, "found '//', expected '#' before a comment"},
      {"scene s\nwarps 8\n", 2, 1, "found 'warps' in the scene, expected it in a block of 'woven'"},
      {WOVEN " cut_speed 1 m/s\n}\n", 7, 2,
       "found 'cut_speed' in the woven cloth, expected it in a block of 'material'"},
      {MEMBRANE " material demin\n}\n", 6, 11,
       "found the material 'demin' (did you mean 'denim'?), expected denim"},
      {OWN " base demin\n}\n", 9, 7, "found 'demin' (did you mean 'denim'?), expected denim, t-shirt"},
      {BALL "at 0 0 3 cm\n}\npin row top by bb\n", 12, 16, "found 'bb', expected the name of a body: b"},
      {WOVEN "}\nsphere clamp {\n radius 1 mm\n at 0 0 3 cm\n}\npin row top by clmp\n", 12, 16,
       "found 'clmp' (did you mean 'clamp'?), expected the name of a body: clamp"},
      {BALL "at 0 0 3 cm\n move hand lefft\n}\n", 11, 12,
       "found 'lefft' (did you mean 'left'?), expected left or right"},
      {BALL "at 0 0 3 cm\n move hand\n}\n", 11, 11,
       "found the end of the line, expected left or right for 'move'"},
      {BALL "at 0 0 3 cm\n move hand left\n move hand left\n}\n", 12, 2, "found 'move' again in sphere 'b'"},
      {BALL "at 0 0 3 cm\n move hand left\n}\nsphere c {\n radius 1 mm\n at 0 0 3 cm\n move hand left\n}\n",
       16, 2, "found a second body on the left hand, expected one at most; see line 11"},
      {"\xff\xfes\0", 1, 1, "found UTF-16, expected ASCII"},
  };
  CHECK_ALL(cases);
  fixture_scoped f = {0};
  scene_error error;
  CHECK(fixture_compile(&f, "t", "\xef\xbb\xbf" WOVEN "}\r\n", &error));
}

typedef struct {
  const char *text;
  int line, column;
  const char *note; /* NULL: none */
} note_case;

static void check_note(const note_case *c) {
  static scene s;
  scene_error error;
  const int good = scene_parse("t", c->text, strlen(c->text), &s, &error);
  CHECK(good);
  if (!good) printf("%s%d:%d: %s\n", c->text, error.line, error.column, error.message);
  if (!good) return;
  CHECK_EQ_INT(s.note_count, c->note != NULL);
  if (s.note_count == 0 || c->note == NULL) {
    if (s.note_count != (c->note != NULL)) printf("%s%s\n", c->text, s.notes[0].text);
    return;
  }
  CHECK_TEXT(s.notes[0].text, c->note);
  CHECK_EQ_INT(s.notes[0].place.line, c->line);
  CHECK_EQ_INT(s.notes[0].place.column, c->column);
}

#define HALF_PINNED "pin row top\n"
#define FREE_OF "has no effect: "

static void notes_on_cloth(void) {
  static const note_case cases[] = {
      {WOVEN " pleats 3\n}\n", 7, 2, "'pleats' " FREE_OF "'gather' is 0"},
      {WOVEN " pleats 3 gather 5 %\n}\n", 0, 0, NULL},
      {WOVEN " tear off tear mirrored\n}\n", 7, 11, "'tear mirrored' " FREE_OF "'tear' is off"},
      {WOVEN " tear 5 5 % tear mirrored\n}\n", 7, 13,
       "'tear mirrored' " FREE_OF "all springs tear at the same strain"},
      {WOVEN " static_friction 1.4\n}\n", 7, 2, "'static_friction' " FREE_OF "'yarns' is off"},
      {WOVEN " slip_friction 0.3\n}\n", 7, 2, "'slip_friction' " FREE_OF "'yarns' is off"},
      {WOVEN " crossing_friction 1 mN\n yarns off\n}\n", 7, 2,
       "'crossing_friction' " FREE_OF "'yarns' is off"},
      {WOVEN " disconnect_at 1 mm\n}\n", 7, 2, "'disconnect_at' " FREE_OF "'yarns' is off"},
      {WOVEN " disconnect_by yarns\n}\n", 7, 2, "'disconnect_by' " FREE_OF "'yarns' is off"},
      {WOVEN " spread_splits on\n}\n", 7, 2, "'spread_splits' " FREE_OF "'yarns' is off"},
      {WOVEN " split_strain 3 4 %\n}\n", 7, 2, "'split_strain' " FREE_OF "'yarns' is off"},
      {WOVEN " yarns all split_strain 3 4 %\n}\n", 0, 0, NULL},
      {WOVEN " yarns on tear off\n}\n", 7, 2, "'yarns' " FREE_OF "'tear' is off: no crossing splits"},
      {WOVEN " yarns on\n}\nlimits { spare_particles 0 }\n", 7, 2,
       "'yarns' " FREE_OF "'spare_particles' is 0: no crossing can split"},
      {WOVEN " stretch_damping 1 us\n}\n", 7, 2, "'stretch_damping' " FREE_OF "there is no 'stretch'"},
      {WOVEN " self_thickness 0.1 mm\n}\n", 7, 2, "'self_thickness' " FREE_OF "'self_collision' is off"},
      {DENIM "slit column 2 0 1\n", 0, 0, NULL},
      {MEMBRANE " wind_drag 1 material denim\n}\n", 6, 2, "'wind_drag' " FREE_OF "there is no 'wind'"},
      {MEMBRANE " wind_normal 1 material denim\n}\n", 6, 2, "'wind_normal' " FREE_OF "there is no 'wind'"},
      {MEMBRANE " collision vertices material denim\n}\n", 6, 2,
       "'collision' " FREE_OF "there is no mesh and no sphere"},
      {OWN " base denim\n tear_interval 1 ms\n}\n", 10, 2,
       "'tear_interval' " FREE_OF "the material has no 'tear'"},
      {OWN " base denim\n cut_speed 1 m/s\n}\n", 10, 2, "'cut_speed' " FREE_OF "there is no mesh"},
      {OWN " base denim\n tear 9 N/m\n}\nlimits { spare_triangles 0 }\n", 10, 2,
       "'tear' " FREE_OF "'limits' leaves no spare particles and triangles to tear with"},
  };
  for (size_t n = 0; n < sizeof cases / sizeof cases[0]; ++n) check_note(&cases[n]);
}

static void notes_on_the_scene(void) {
  static const note_case cases[] = {
      {WOVEN "}\nmax_rest_strain 3 %\n", 8, 1,
       "'max_rest_strain' " FREE_OF "neither 'substeps' nor 'iterations' is auto"},
      {WOVEN "}\nmax_rest_strain 3 % iterations auto\n", 0, 0, NULL},
      {WOVEN " stretch 1 N\n}\niterations 2\n", 9, 1,
       "'iterations' " FREE_OF "yarns with a 'stretch' are not projected"},
      {WOVEN "}\nsettle 0.1 ms\n", 8, 1, "'settle' " FREE_OF "it is shorter than a tick"},
      {WOVEN "}\ngravity 0 0 0 cm/s2 settle 1 s\n", 8, 21,
       "'settle' " FREE_OF "nothing moves the cloth: no gravity, wind, load, body, gather or yarns"},
      {WOVEN "}\nhands { speed 1 m/s }\n", 8, 1,
       "'hands' " FREE_OF "no body has 'move hand left' or 'move hand right'"},
      {WOVEN "}\nlimits { spare_particles 9 }\n", 8, 10,
       "'spare_particles' " FREE_OF "'yarns' is off: crossings do not split"},
      {WOVEN "}\nlimits { splits_per_tick 9 }\n", 8, 10, "'splits_per_tick' " FREE_OF "'yarns' is off"},
      {WOVEN "}\nlimits { self_collision_pairs 9 }\n", 8, 10,
       "'self_collision_pairs' " FREE_OF "'self_collision' is off"},
      {WOVEN " tear off\n}\nlimits { tears_per_tick 9 }\n", 9, 10,
       "'tears_per_tick' " FREE_OF "'tear' is off"},
      {DENIM "limits { tears_per_tick 9 }\n", 8, 10,
       "'tears_per_tick' " FREE_OF "no blade cuts the membrane, which tears once a tick at most"},
      {DENIM "limits { spare_particles 9 }\n", 8, 10,
       "'spare_particles' " FREE_OF "the membrane is never torn, cut or slit"},
      {DENIM "limits { spare_triangles 9 }\n", 8, 10,
       "'spare_triangles' " FREE_OF "the membrane is never torn or cut"},
      {WOVEN "}\n" HALF_PINNED "pin crossing 3 0\n", 9, 1,
       "'pin' " FREE_OF "the pin of line 8 holds all of it"},
      {WOVEN "}\nslit warp 3 0 5\nslit warp 3 2 5\n", 9, 1,
       "'slit' " FREE_OF "the slit of line 8 cuts all of it"},
  };
  for (size_t n = 0; n < sizeof cases / sizeof cases[0]; ++n) check_note(&cases[n]);
}

int main(void) {
  TEST(errors_of_cloth);
  TEST(errors_of_membranes);
  TEST(errors_of_bodies);
  TEST(errors_of_the_scene);
  TEST(free_falls);
  TEST(slips);
  TEST(notes_on_cloth);
  TEST(notes_on_the_scene);
  return test_end();
}
