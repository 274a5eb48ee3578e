/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/wild/random_scene.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "tests/lib/splitmix64.h"

const char *const random_kind_name[RANDOM_KINDS] = {"woven", "yarns", "stretch", "membrane",
                                                  "sheet"};

typedef struct {
  uint64_t seed;
  char *text;
  size_t length;
  random_kind kind;
  double rate, width, height, cell; /* of the cloth, cm */
  double at[3];
  int vertical, regular, columns, rows;
  int hands_left;
} draft;

__attribute__((format(printf, 2, 3))) static void put(draft *d, const char *format, ...) {
  va_list list;
  va_start(list, format);
  const int more = vsnprintf(d->text + d->length, RANDOM_SCENE_ROOM - d->length, format, list);
  va_end(list);
  if (more > 0 && d->length + (size_t)more < RANDOM_SCENE_ROOM) d->length += (size_t)more;
}

/* 0 to 1, without 1. */
static double unit(draft *d) { return (double)(splitmix64(&d->seed) >> 11) * 0x1p-53; }
static double between(draft *d, double from, double to) { return from + (to - from) * unit(d); }
/* By octaves, evenly within each: no function of libm, whose last bit is not the same everywhere.
 */
static double decades(draft *d, double from, double to) {
  int octaves = 1;
  double value;
  while (ldexp(from, octaves) < to) ++octaves;
  do {
    const int octave = (int)(splitmix64(&d->seed) % (uint64_t)octaves);
    value = ldexp(from * (1 + unit(d)), octave);
  } while (value > to);
  return value;
}
/* One after the other: arguments of a call have no order. */
static void draw(draft *d, double *out, int count, double from, double to) {
  for (int n = 0; n < count; ++n) out[n] = between(d, from, to);
}
static int chance(draft *d, double share) { return unit(d) < share; }
static int below(draft *d, int count) { return (int)(splitmix64(&d->seed) % (uint64_t)count); }
static const char *one_of(draft *d, const char *const *words, int count) {
  return words[below(d, count)];
}
#define ONE_OF(d, ...) \
  one_of(d, (const char *const[]){__VA_ARGS__}, \
         (int)(sizeof((const char *const[]){__VA_ARGS__}) / sizeof(const char *)))

static void write_head(draft *d, uint64_t number) {
  static const int rates[] = {1000, 1000, 500, 240, 2000};
  d->rate = rates[below(d, 5)];
  double pull[3];
  put(d, "scene wild_%llu\nrate %.0f Hz\n", (unsigned long long)number, d->rate);
  put(d, "seed %d\n", below(d, 1 << 30));
  draw(d, pull, 3, -1500, 1500);
  const double g = unit(d);
  if (g < 0.75)
    put(d, "gravity 0 -981 0 cm/s2\n");
  else if (g < 0.9)
    put(d, "gravity %.1f %.1f %.1f cm/s2\n", pull[0], pull[1], pull[2]);
  else
    put(d, "gravity 0 0 0 cm/s2\n");
  if (chance(d, 0.1)) put(d, "settle %.3f s\n", between(d, 0.01, 0.05));
}

static void write_place(draft *d) {
  d->vertical = chance(d, 0.55);
  put(d, "  orientation %s\n", d->vertical ? "vertical" : "horizontal");
  for (int n = 0; n < 3; ++n) d->at[n] = chance(d, 0.3) ? between(d, -0.5, 0.5) : 0;
  put(d, "  at %.3f %.3f %.3f cm\n", d->at[0], d->at[1], d->at[2]);
}

static void write_woven(draft *d) {
  static const int substeps[] = {1, 2, 3, 4, 4, 6, 8, 12, 16};
  put(d, "substeps %d\n", d->kind == RANDOM_STRETCH ? 4 << below(d, 3) : substeps[below(d, 9)]);
  if (chance(d, 0.15)) put(d, "iterations %d\n", 1 + below(d, 5));
  const int warps = 3 + below(d, 22);
  const int wefts = 3 + below(d, 22);
  const double per_cm = between(d, 6, 20);
  d->columns = warps - 1;
  d->rows = wefts - 1;
  d->cell = 1 / per_cm;
  d->width = (warps - 1) / per_cm;
  d->height = (wefts - 1) / per_cm;
  d->regular = 1;
  put(d, "woven {\n  warps %d\n  wefts %d\n  spacing %.4f /cm\n", warps, wefts, per_cm);
  if (chance(d, 0.5))
    put(d, "  weave %s\n", ONE_OF(d, "plain", "twill 2/1", "twill 2/2", "satin 5", "satin 8"));
  const double thickness = decades(d, 0.003, 0.03);
  put(d, "  thickness %.5f cm\n", fmin(thickness, 0.4 / per_cm));
  put(d, "  density %.5f g/cm2\n", decades(d, 0.0025, 0.25 * 4));
  if (chance(d, 0.3)) put(d, "  structural %.0f g/s2\n", decades(d, 500, 50000));
  if (chance(d, 0.3)) put(d, "  bend %.3f g/s2\n", decades(d, 0.1, 50));
  if (chance(d, 0.3)) put(d, "  shear %.3f g/s2\n", decades(d, 0.1, 50));
  const double tear = between(d, 1, 10);
  const double most = fmin(tear * between(d, 1, 2.5), 19);
  if (d->kind == RANDOM_YARNS || chance(d, 0.8))
    put(d, "  tear %.2f %.2f %%\n", tear, most);
  else
    put(d, "  tear off\n");
  write_place(d);
  if (chance(d, 0.15) && warps > 4) {
    put(d, "  gather %.1f %%\n", between(d, 1, 20));
    put(d, "  pleats %d\n", 1 + below(d, 4));
  }
  put(d, "  drag %s /s\n", ONE_OF(d, "0", "0.5", "2"));
  if (chance(d, 0.25)) put(d, "  damping %s /s\n", ONE_OF(d, "1", "10", "30"));
  if (d->kind == RANDOM_YARNS) {
    put(d, "  yarns %s\n", ONE_OF(d, "on", "all"));
    if (chance(d, 0.6)) put(d, "  slip_friction %.2f\n", between(d, 0, 1.2));
    if (chance(d, 0.2)) put(d, "  static_friction %.2f\n", between(d, 1, 2));
    if (chance(d, 0.4)) put(d, "  crossing_friction %.2f mN\n", between(d, 0, 2));
  } else if (d->kind == RANDOM_STRETCH) {
    if (chance(d, 0.4)) put(d, "  yarns on\n");
    put(d, "  stretch %.4f N\n", decades(d, 0.02, 1));
    if (chance(d, 0.3)) put(d, "  stretch_damping %.1f us\n", between(d, 1, 40));
  }
  if (d->kind != RANDOM_STRETCH && chance(d, 0.25)) put(d, "  self_collision on\n");
  put(d, "}\n");
}

static void write_material(draft *d, const char *base) {
  put(d, "material rag {\n  base %s\n", base);
  if (chance(d, 0.4)) {
    const double c = decades(d, 20, 2000);
    const double across = c * between(d, 0, 0.3);
    const double along = c * between(d, 0.5, 2);
    put(d, "  stretch all %.1f %.1f %.1f %.1f N/m\n", c, across, along, c * between(d, 0.05, 0.5));
  } else if (chance(d, 0.2)) {
    put(d, "  isotropic %.1f N/m", decades(d, 20, 3000));
    put(d, " %.2f\n", between(d, 0, 0.45));
  }
  if (chance(d, 0.2)) put(d, "  bend all %.2f uNm\n", decades(d, 0.1, 200));
  if (chance(d, 0.6)) put(d, "  tear %.2f N/m\n", decades(d, 2, 60));
  if (chance(d, 0.3)) put(d, "  tear_interval %.1f ms\n", between(d, 0, 5));
  if (chance(d, 0.4)) put(d, "  cut_speed %.2f m/s\n", between(d, 0, 1.5));
  put(d, "}\n");
}

static int is_membrane(const draft *d) { return d->kind == RANDOM_MEMBRANE || d->kind == RANDOM_SHEET; }

/* From soft rubber to stiff paper, which breaks at a strain of 2 to 20 %. */
static void write_sheet_material(draft *d) {
  const double stiffness = decades(d, 50, 5000); /* N/m */
  const double thickness = decades(d, 0.005, 0.1);
  const double young = stiffness / (thickness * 1e-2);
  put(d, "material rag {\n  density %.1f g/m2\n  young %.0f Pa\n", decades(d, 20, 500), young);
  put(d, "  thickness %.5f cm\n", thickness);
  if (chance(d, 0.6)) put(d, "  poisson %.2f\n", between(d, 0, 0.45));
  if (chance(d, 0.5)) put(d, "  bend all %.2f uNm\n", decades(d, 0.1, 200));
  const double strain = between(d, 0.02, 0.2);
  if (chance(d, 0.75)) {
    put(d, "  breaks %.0f Pa\n", young * strain);
    put(d, "  average %.4f cm\n", d->cell * between(d, 2, 5));
    if (chance(d, 0.3)) put(d, "  cracks many\n");
  } else {
    put(d, "  tear %.2f N/m\n", stiffness * strain);
  }
  if (chance(d, 0.5)) put(d, "  tear_interval %.1f ms\n", between(d, 0, 5));
  if (chance(d, 0.4)) put(d, "  cut_speed %.2f m/s\n", between(d, 0, 1.5));
  put(d, "}\n");
}

/* Behind `move hand`. */
static void write_handle(draft *d) {
  put(d, "  mass %.3f g\n", decades(d, 1, 100));
  if (chance(d, 0.6)) put(d, "  coupling %.0f N/m\n", decades(d, 50, 3000));
  if (chance(d, 0.4)) put(d, "  coupling_damping %.2f ms\n", between(d, 0, 10));
  if (chance(d, 0.3)) put(d, "  hand_scale %.2f\n", decades(d, 0.2, 4));
  if (chance(d, 0.3)) put(d, "  hand_rotate %.1f deg about %s\n", between(d, -170, 170), "y");
  if (chance(d, 0.3)) put(d, "  force_scale %.2f\n", decades(d, 0.2, 4));
}

static void write_membrane(draft *d) {
  static const int substeps[] = {1, 1, 1, 2, 3, 4};
  const int columns = 2 + below(d, 12);
  const int rows = 2 + below(d, 12);
  const double cell = between(d, 0.4, 2.5);
  const int pattern = below(d, 4);
  put(d, "substeps %d\nmembrane {\n  columns %d\n  rows %d\n  cell %.4f cm\n",
      substeps[below(d, 6)], columns, rows, cell);
  d->columns = columns;
  d->rows = rows;
  d->cell = cell;
  d->width = columns * cell;
  d->height = rows * cell;
  d->regular = pattern < 2 || columns < 4 || rows < 4;
  if (!d->regular && pattern == 2) put(d, "  pattern rotated %.1f deg\n", between(d, -89, 89));
  if (!d->regular && pattern == 3) put(d, "  pattern irregular %d\n", below(d, 1000));
  const char *base = ONE_OF(d, "denim", "t-shirt", "pants", "swimsuit", "paper");
  const int own = chance(d, 0.75) || d->kind == RANDOM_SHEET;
  put(d, "  material %s\n", own ? "rag" : base);
  if (chance(d, 0.3)) put(d, "  weft %.1f deg\n", between(d, -90, 90));
  write_place(d);
  put(d, "  drag %s /s\n", ONE_OF(d, "0", "0.5", "2"));
  if (chance(d, 0.4)) put(d, "  strain_limit %.0f %%\n", between(d, 5, 60));
  put(d, "  thickness %.5f cm\n", fmin(cell * between(d, 0.01, 0.1), 1));
  if (chance(d, 0.2)) put(d, "  elastic_steps_max %d\n", 8 + below(d, 57));
  if (chance(d, 0.3)) put(d, "  collision vertices\n");
  if (chance(d, 0.35)) put(d, "  self_collision on\n");
  if (chance(d, 0.2)) {
    put(d, "  wind_normal %.2f\n", between(d, 0, 3));
    put(d, "  wind_drag %.2f\n", between(d, 0, 1));
  }
  put(d, "}\n");
  if (d->kind == RANDOM_SHEET)
    write_sheet_material(d);
  else if (own)
    write_material(d, base);
  double blow[3];
  draw(d, blow, 3, -6, 6);
  if (chance(d, 0.4)) put(d, "wind %.1f %.1f %.1f m/s\n", blow[0], blow[1], blow[2]);
  static const char *const sides[] = {"top", "bottom", "left", "right"};
  for (int n = 0; n < 4; ++n) {
    double load[3];
    draw(d, load, 3, -20, 20);
    if (chance(d, 0.07))
      put(d, "load %s %.1f %.1f %.1f N/m\n", sides[n], load[0], load[1], load[2]);
  }
}

static void write_pins(draft *d) {
  if (!chance(d, 0.6)) return;
  static const char *const rows[] = {"row top", "row bottom", "column left", "column right"};
  const int first = below(d, 4);
  put(d, "pin %s\n", rows[first]);
  if (chance(d, 0.3)) put(d, "pin %s\n", rows[(first + 1) % 4]);
}

/* A point of the cloth as it begins, and one beside it. */
static void on_cloth(draft *d, double at[3]) {
  const double x = (unit(d) - 0.5) * d->width;
  const double y = (unit(d) - 0.5) * d->height;
  at[0] = d->at[0] + x;
  at[1] = d->at[1] + (d->vertical ? y : 0);
  at[2] = d->at[2] + (d->vertical ? 0 : y);
}
static void beside_cloth(draft *d, double size, double away, double at[3]) {
  on_cloth(d, at);
  const double side = chance(d, 0.8) ? 1 : -1;
  const double by = side * (size + between(d, 0.1, 1) * away);
  at[d->vertical ? 2 : 1] += by;
}

static void write_path(draft *d, const double at[3], double size) {
  double t = 0;
  double to[3] = {at[0], at[1], at[2]};
  put(d, "  move path { 0 s %.4f %.4f %.4f cm", to[0], to[1], to[2]);
  for (int n = 1 + below(d, 4); n > 0; --n) {
    t += between(d, 0.05, 0.6);
    for (int k = 0; k < 3; ++k) to[k] += between(d, -0.5, 0.5) * size;
    put(d, "  %.3f s %.4f %.4f %.4f cm", t, to[0], to[1], to[2]);
  }
  put(d, " }\n");
}

static void write_free(draft *d, const double at[3]) {
  put(d, "  at %.4f %.4f %.4f cm\n  move free\n  mass %.4f g\n", at[0], at[1], at[2],
      decades(d, 0.1, 20));
  if (!chance(d, 0.6)) return;
  double to[3];
  on_cloth(d, to);
  double length = 1e-9;
  for (int n = 0; n < 3; ++n) length += fabs(to[n] - at[n]);
  const double speed = between(d, 20, 400) / length;
  put(d, "  velocity %.2f %.2f %.2f cm/s\n", (to[0] - at[0]) * speed, (to[1] - at[1]) * speed,
      (to[2] - at[2]) * speed);
}

static void write_body(draft *d, int number) {
  const double cloth = fmax(d->width, d->height);
  const double s = cloth * between(d, 0.05, 0.3);
  const int shape = below(d, 6);
  double at[3];
  if (shape == 5) {
    const double below_cloth =
        d->at[1] - (d->vertical ? d->height / 2 : 0) - cloth * between(d, 0.05, 0.8);
    put(d, "plane b%d {\n  at 0 %.4f 0 cm\n", number, below_cloth);
    put(d, "  friction %.2f\n", between(d, 0, 1));
    if (chance(d, 0.3)) {
      put(d, "  rotate %.1f deg", between(d, -30, 30));
      put(d, " about %s\n", ONE_OF(d, "x", "z"));
    }
    put(d, "}\n");
    return;
  }
  const int gripped = shape < 3 && chance(d, 0.35);
  static const char *const words[] = {"sphere", "box", "capsule", "mesh", "mesh"};
  put(d, "%s b%d {\n", words[shape], number);
  if (shape == 0) put(d, "  radius %.4f cm\n", s);
  double size[3];
  draw(d, size, 3, 0.3, 2);
  if (shape == 1) put(d, "  size %.4f %.4f %.4f cm\n", s * size[0], s * size[1], s * size[2]);
  if (shape == 2)
    put(d, "  length %.4f cm\n  radius %.4f cm\n", 2 * s * size[0], 0.3 * s * size[1]);
  if (shape >= 3) {
    put(d, "  obj \"../../tests/scenes/meshes/%s.obj\"\n",
        ONE_OF(d, "ball", "box", "hammer", "plate", "sword"));
    put(d, "  unit %.4f cm\n", s * between(d, 0.3, 0.8));
    if (chance(d, 0.5)) put(d, "  sharp %s\n", ONE_OF(d, "named", "60 deg", "100 deg"));
  }
  if (shape != 0 && chance(d, 0.5)) {
    put(d, "  rotate %.1f deg", between(d, -170, 170));
    put(d, " about %s\n", ONE_OF(d, "x", "y", "z"));
  }
  put(d, "  friction %.2f\n", between(d, 0, 1));
  if (gripped) {
    on_cloth(d, at);
    put(d, "  attach_within %.4f cm\n", between(d, 0.1, 1) * d->cell);
  } else {
    beside_cloth(d, 2 * s, cloth * 0.4, at);
  }
  const double motion = unit(d);
  if (motion < 0.25) {
    put(d, "  at %.4f %.4f %.4f cm\n", at[0], at[1], at[2]);
  } else if (motion < 0.5) {
    write_path(d, at, cloth);
  } else if (motion < 0.75 && d->hands_left > 0) {
    put(d, "  at %.4f %.4f %.4f cm\n  move hand %s\n", at[0], at[1], at[2],
        d->hands_left-- == 2 ? "left" : "right");
    if (d->kind == RANDOM_SHEET && chance(d, 0.7)) write_handle(d);
  } else {
    write_free(d, at);
  }
  put(d, "}\n");
}

static void write_limits(draft *d) {
  static const int few[] = {1, 5, 20, 100, 400};
  if (!chance(d, 0.25)) return;
  put(d, "limits {\n");
  if (chance(d, 0.5)) put(d, "  contacts %d\n", few[below(d, 5)]);
  if (chance(d, 0.4)) put(d, "  tears_per_tick %d\n", 1 + below(d, 64));
  if (is_membrane(d) && chance(d, 0.5))
    put(d, "  spare_triangles %d\n", few[below(d, 5)]);
  put(d, "}\n");
}

static void write_slit(draft *d) {
  if (!chance(d, 0.15) || !d->regular || d->columns < 3 || d->rows < 3) return;
  if (is_membrane(d))
    put(d, "slit column %d 1", 1 + below(d, d->columns - 1));
  else
    put(d, "slit warp %d 0", below(d, d->columns - 1));
  put(d, " %d\n", is_membrane(d) ? 2 + below(d, d->rows - 1) : below(d, d->rows));
}

random_kind random_scene_write(uint64_t seed, uint64_t number, char *text) {
  draft d = {.seed = seed * 0x9E3779B97F4A7C15u + number * 0xD1B54A32D192ED03u,
             .text = text,
             .hands_left = 2};
  static const random_kind kinds[] = {RANDOM_WOVEN, RANDOM_YARNS, RANDOM_STRETCH, RANDOM_MEMBRANE,
                                      RANDOM_MEMBRANE};
  text[0] = 0;
  d.kind = kinds[below(&d, 5)];
  if (d.kind == RANDOM_MEMBRANE && number % 3 == 2) d.kind = RANDOM_SHEET;
  write_head(&d, number);
  if (is_membrane(&d))
    write_membrane(&d);
  else
    write_woven(&d);
  write_pins(&d);
  const int bodies = chance(&d, 0.9) ? below(&d, 5) : 5 + below(&d, 6);
  for (int n = 0; n < bodies; ++n) write_body(&d, n);
  write_limits(&d);
  write_slit(&d);
  return d.kind;
}

void random_scene_pose(uint64_t seed, uint64_t number, uint32_t hand, double seconds,
                       int16_t at[3]) {
  draft d = {.seed = seed * 0x9E3779B97F4A7C15u + number * 0xD1B54A32D192ED03u + hand + 1u};
  for (int n = 0; n < 3; ++n) {
    const double reach = between(&d, -8000, 8000); /* 16 mm, and twice that */
    const double turns = decades(&d, 0.3, 4) * seconds;
    const double phase = turns - floor(turns);
    const int waves = chance(&d, 0.5);
    const double way = waves ? (phase < 0.5 ? 4 * phase - 1 : 3 - 4 * phase) + 1 : fmin(1, turns);
    at[n] = (int16_t)lrint(reach * way);
  }
}
