/* SPDX-License-Identifier: Apache-2.0 */
/* Inner steps of membranes, and what a tick works out for them: every kernel that this machine has
 * against the scalar code, to the last bit. Irregular meshes; vertices where the sheet has them and thrown
 * together, in a plane, on a line, at one point, apart by the size of the world; gains, weights, folds, loads and speeds of their own and
 * any. The law of isotropic sheets also on triangles drawn one by one. All that kernels read and write ends where the next page faults.
 *
 *   test_simd_membrane [ROWS]     triangles, 2,000,000 unless told, a tenth under sanitizers */
#define _DEFAULT_SOURCE 1 /* mmap without a file */
#include "tests/lib/test.h"

#include <math.h>

#include "rt/membrane/membrane.h"
#include "rt/tick/tick.h"
#include "rt/simd/simd.h"
#include "rt/state/corotational.h"
#include "tests/lib/guarded.h"
#include "tests/lib/simd_kernels.h"
#include "tests/lib/world_fixture.h"

enum { ROUNDS = 12, ARRAYS = 21, STEPS = 3, VERTICES = 256 };

static uint64_t rows_asked = GUARDED_SLOW ? 200000 : 2000000;

/* What a kernel gets: arrays of the world, each in pages of its own. */
typedef struct {
  guarded pages[ARRAYS];
  size_t bytes[ARRAYS];
  uint8_t *first[ARRAYS]; /* what they hold before a kernel */
  uint8_t *found[ARRAYS]; /* and after the scalar code */
} arrays;

#define MOVE(k, field, count) \
  w->field = move(a, k, w->field, (size_t)(count) * sizeof *w->field)

static void *move(arrays *a, size_t k, const void *from, size_t bytes) {
  a->pages[k] = guarded_make(bytes);
  a->bytes[k] = bytes;
  a->first[k] = malloc(bytes);
  a->found[k] = malloc(bytes);
  void *at = guarded_place(&a->pages[k], bytes, draw_below(4) != 0);
  memcpy(at, from, bytes);
  return at;
}

static void move_all(arrays *a, fray_world *w) {
  const uint32_t particles = w->p.count;
  const uint32_t triangles = (uint32_t)w->trimesh.state->triangles;
  MOVE(0, membrane.positions, particles);
  MOVE(1, membrane.impulse, particles);
  MOVE(2, membrane.external_impulse, particles);
  MOVE(3, membrane.inverse_mass, particles);
  MOVE(4, p.vx, particles);
  MOVE(5, p.vy, particles);
  MOVE(6, p.vz, particles);
  MOVE(7, membrane.low_x, particles);
  MOVE(8, membrane.low_y, particles);
  MOVE(9, membrane.low_z, particles);
  MOVE(10, membrane.gains, triangles);
  MOVE(11, trimesh.weights, triangles);
  MOVE(12, membrane.plates, PLATE_COLUMNS * w->capacity[POOL_TRIANGLES]);
  MOVE(13, membrane.stiffness, triangles);
  MOVE(14, membrane.stress, triangles);
  MOVE(15, membrane.folds, FOLD_COLUMNS * bend_fold_stride(w));
  MOVE(16, membrane.normals, triangles);
  MOVE(17, membrane.moments, triangles);
  MOVE(18, membrane.bend_states, triangles);
  MOVE(19, membrane.bend_shapes, triangles);
  MOVE(20, membrane.strain_threshold, triangles);
}

static void free_all(arrays *a) {
  const size_t page = (size_t)sysconf(_SC_PAGESIZE);
  for (size_t k = 0; k < ARRAYS; ++k) {
    CHECK(guarded_intact(&a->pages[k]));
    free(a->first[k]);
    free(a->found[k]);
    munmap(a->pages[k].pages - page, a->pages[k].pages_bytes + 2 * page);
  }
}

static void keep(const arrays *a, uint8_t *const to[ARRAYS]) {
  for (size_t k = 0; k < ARRAYS; ++k) memcpy(to[k], a->pages[k].at, a->bytes[k]);
}
static void put(const arrays *a) {
  for (size_t k = 0; k < ARRAYS; ++k) memcpy(a->pages[k].at, a->first[k], a->bytes[k]);
}
static int is_found(const arrays *a) {
  for (size_t k = 0; k < ARRAYS; ++k)
    if (memcmp(a->pages[k].at, a->found[k], a->bytes[k]) != 0) return 0;
  return 1;
}

/* Below 2^bits, so that what comes of them is now here, now beyond what kernels take. */
static int32_t some(uint32_t bits) { return (int32_t)draw_word() >> (31u - bits); }
static int32_t natural(uint32_t bits) { return (int32_t)(draw_word() >> (32u - bits)); }

/* `steep`: near one point, with weights and gains that make impulses of small ways, up to their bound. */
static void throw_vertices(const fray_world *w, int steep) {
  const uint32_t shape = draw_below(8);
  const uint32_t away = 1u << (steep ? 17 + draw_below(5) : 2 + draw_below(draw_below(4) == 0 ? 28 : 22));
  int32_t *const x[3] = {w->p.x, w->p.y, w->p.z};
  for (uint32_t p = 0; p < w->p.count; ++p)
    for (uint32_t n = 0; n < 3; ++n) {
      const int32_t off = (int32_t)draw_below(away) - (int32_t)(away / 2);
      const int is_flat = steep || (shape == 0 && n == 2) || (shape == 1 && n != 0) || (shape == 2 && draw_below(3) == 0);
      const int32_t home = is_flat ? 0 : x[n][p];
      x[n][p] = is_flat && !steep ? 0 : (int32_t)fx_clamp64((int64_t)home + off, -FX_WORLD_MAX, FX_WORLD_MAX);
      if (p != 0 && draw_below(40) == 0) x[n][p] = x[n][p - 1];
    }
}

static void throw_folds(const fray_world *w, uint32_t of_moments, uint32_t of_lengths) {
  const uint32_t of_rates = 1 + draw_below(31);
  for (uint32_t t = 0; t < (uint32_t)w->trimesh.state->triangles; ++t) {
    for (uint32_t h = PLATE_H00; h <= PLATE_H12; ++h) bend_plate_column(w, h)[t] = some(of_moments > 28 ? 28 : of_moments);
    for (uint32_t k = 0; k < 3; ++k) bend_plate_column(w, PLATE_PER_LENGTH_0 + k)[t] = some(of_lengths);
  }
  for (uint32_t n = 0; n < w->membrane.fold_count; ++n) {
    bend_fold_column(w, FOLD_SHARE)[n] = draw_between(0, BEND_ONE);
    bend_fold_column(w, FOLD_HOLD)[n] = draw_below(3) == 0 ? draw_between(0, BEND_ONE) : BEND_ONE;
    bend_fold_column(w, FOLD_RATE)[n] = natural(of_rates);
    bend_fold_column(w, FOLD_OFFSET)[n] = draw_between(-BEND_OFFSET_MAX, BEND_OFFSET_MAX);
  }
}

static void throw_habits(const fray_world *w) {
  const uint32_t most = 1u << (1 + draw_below(27));
  for (uint32_t t = 0; t < (uint32_t)w->trimesh.state->triangles; ++t)
    for (uint32_t n = 0; n < SMOOTHED_STRAIN_POLES; ++n) w->membrane.bend_states[t].habit[n] = (int32_t)draw_below(most);
}

static void throw_gains(const fray_world *w, int steep) {
  const uint32_t triangles = (uint32_t)w->trimesh.state->triangles;
  const uint32_t of_gains = steep ? 28 + draw_below(4) : 1 + draw_below(31);
  /* the third one, their sum, is a weight too */
  const uint32_t of_weights = steep ? 26 + draw_below(4) : 1 + draw_below(30);
  const uint32_t of_moments = 1 + draw_below(31);
  const uint32_t of_speeds = 1 + draw_below(30);
  const uint32_t of_masses = 1 + draw_below(31);
  const uint32_t of_loads = 1 + draw_below(22);
  int32_t *const speed[3] = {w->p.vx, w->p.vy, w->p.vz};
  const uint32_t of_thresholds = 26 + draw_below(6);
  for (uint32_t t = 0; t < triangles; ++t) w->membrane.strain_threshold[t] = natural(of_thresholds) >> 1;
  if (steep || draw_below(2) == 0)
    for (uint32_t t = 0; t < triangles; ++t)
      for (uint32_t n = 0; n < MATERIAL_ENTRIES; ++n) w->membrane.gains[t].c[n] = some(of_gains);
  if (steep || draw_below(3) == 0)
    for (uint32_t t = 0; t < triangles; ++t)
      w->trimesh.weights[t] =
          (trimesh_weights){some(of_weights), some(of_weights), some(of_weights), some(of_weights)};
  throw_folds(w, of_moments, of_masses);
  for (uint32_t p = 0; p < w->p.count; ++p) {
    for (uint32_t n = 0; n < 3; ++n) speed[n][p] = some(of_speeds);
    w->membrane.inverse_mass[p] = natural(of_masses);
    w->membrane.external_impulse[p] = (elastic_impulse){some(of_loads), some(of_loads), some(of_loads), 0};
  }
}

static void print_isotropic(fixture *f) {
  fixture_print(f, "scene isotropic\nrate 1000 Hz\nmembrane {\n columns %u\n rows %u\n cell 1 cm\n pattern irregular "
                   "%u\n material foil\n drag %u /s\n}\npin column left\nmaterial foil {\n density 200 g/m2\n"
                   " young %u MPa\n poisson 0.%u\n thickness 0.5 mm\n breaks 10 MPa\n average 4 cm\n"
                   " tear_interval 10 ms\n bend all 8 uNm\n}\n",
                3 + draw_below(10), 2 + draw_below(7), 1 + draw_below(9), draw_below(3), 1 + draw_below(4), 1 + draw_below(4));
}

static void make_sheet(fixture *f) {
  static const char *const cloths[] = {"denim", "pants", "t-shirt", "paper"};
  if (draw_below(4) == 0) {
    print_isotropic(f);
    return;
  }
  fixture_print(f, "scene sheets\nrate 1000 Hz\nmembrane {\n columns %u\n rows %u\n cell 1 cm\n pattern irregular "
                   "%u\n material %s\n drag %u /s\n}\npin column left\nwind %u 1 %u m/s\n",
                3 + draw_below(10), 2 + draw_below(7), 1 + draw_below(9), cloths[draw_below(4)], draw_below(3), draw_below(9), draw_below(3));
}

/* Where vertices are, which all kernels begin with. */
typedef struct {
  int32_t x[3][VERTICES];
} positions;

static void take(const fray_world *w, positions *p) {
  const int32_t *const x[3] = {w->p.x, w->p.y, w->p.z};
  for (uint32_t n = 0; n < 3; ++n) memcpy(p->x[n], x[n], 4 * w->p.count);
}

static void begin(fray_world *w, const positions *p) {
  int32_t *const x[3] = {w->p.x, w->p.y, w->p.z};
  int8_t *const r[3] = {w->p.rx, w->p.ry, w->p.rz};
  for (uint32_t n = 0; n < 3; ++n) {
    memcpy(x[n], p->x[n], 4 * w->p.count);
    memset(r[n], 0, w->p.count);
  }
}

static void run(fray_world *w, const positions *from, fray_kernel kernel) {
  fray_set_kernel(w, kernel);
  begin(w, from);
  elastic_steps_run(w, 0);
}

/* Of a tick, with vertices where they were thrown: stress, wind, folds. */
static void prepare(fray_world *w, const positions *from, fray_kernel kernel) {
  fray_set_kernel(w, kernel);
  begin(w, from);
  membrane_stress_update(w);
  w->membrane.bend_current = 0;
  membrane_gains_update(w);
  wind_apply(w);
}

/* Of triangles, as they are now: those before the first that is left to the scalar code. */
static uint64_t taken_of(const fray_world *w) {
  const force_view view = {w->membrane.positions, w->membrane.impulse, w->trimesh.triangle, w->trimesh.weights, w->membrane.gains, w->membrane.strain_threshold, NULL, 0, 0};
  const uint32_t triangles = (uint32_t)w->trimesh.state->triangles;
  return world_is_corotational(w) ? simd_corotational_force(w->kernel, &view, 0, triangles)
                                  : simd_membrane_force(w->kernel, &view, 0, triangles);
}

/* Of drawn triangles: all that it takes. */
static uint64_t drawn_taken_of(const fray_world *w) {
  const force_view view = {w->membrane.positions, w->membrane.impulse, w->trimesh.triangle, w->trimesh.weights, w->membrane.gains, w->membrane.strain_threshold, NULL, 0, 0};
  uint64_t sum = 0;
  for (uint32_t t = 0; t < triangles_in_use(w); t += SIMD_LEFT) {
    const uint32_t taken = simd_corotational_force(w->kernel, &view, t, triangles_in_use(w));
    sum += taken;
    t += taken;
  }
  return sum;
}

/* Of folds in the same way. */
static uint64_t folds_taken_of(const fray_world *w) {
  const bend_view view = {w->membrane.positions, w->membrane.impulse, w->trimesh.triangle, w->membrane.plates,
                          w->membrane.folds,     w->membrane.normals, w->membrane.moments, w->capacity[POOL_TRIANGLES],
                          bend_fold_stride(w),   20,                  1};
  return simd_bend_folds(w->kernel, &view, 0, w->membrane.fold_count) / 2u +
         simd_bend_joints(w->kernel, &view, 0, w->membrane.fold_count) / 2u;
}

static void sheets_are_as_scalar(void) {
  fray_kernel kernels[SIMD_KERNELS];
  const uint32_t count = simd_kernels(kernels);
  uint64_t different[SIMD_KERNELS] = {0};
  uint64_t unlike[SIMD_KERNELS] = {0};
  uint64_t taken[SIMD_KERNELS] = {0};
  uint64_t folds_taken[SIMD_KERNELS] = {0};
  uint64_t rows = 0;
  uint64_t folds = 0;
  while (rows < rows_asked) {
    fixture_scoped f = {0};
    make_sheet(&f);
    fray_world *w = f.w;
    fixture_tick(&f, &fixture_idle); /* fills what follows from the state */
    membrane_params *constants = (membrane_params *)(uintptr_t)w->membrane.constants;
    constants->steps = STEPS;
    constants->bend_every = 1;
    arrays a;
    positions home;
    positions thrown;
    move_all(&a, w);
    take(w, &home);
    for (uint32_t round = 0; round < ROUNDS; ++round) {
      const int steep = draw_below(8) == 0;
      begin(w, &home);
      throw_vertices(w, steep);
      take(w, &thrown);
      throw_habits(w);
      keep(&a, a.first);
      if (draw_below(2) == 0) constants->mass_unit = draw_between(1 << 8, 1 << 30); /* of all weights */
      constants->norm2_max = draw_between(1 << 10, 1 << (11 + draw_below(20))); /* few, some, all are softened */
      prepare(w, &thrown, FRAY_KERNEL_SCALAR);
      keep(&a, a.found);
      for (uint32_t k = 0; k < count; ++k) {
        put(&a);
        prepare(w, &thrown, kernels[k]);
        unlike[k] += !is_found(&a);
      }
      put(&a);
      throw_gains(w, steep);
      keep(&a, a.first);
      run(w, &thrown, FRAY_KERNEL_SCALAR);
      keep(&a, a.found);
      for (uint32_t k = 0; k < count; ++k) {
        put(&a);
        run(w, &thrown, kernels[k]);
        different[k] += !is_found(&a);
        taken[k] += taken_of(w);
        folds_taken[k] += folds_taken_of(w);
      }
      rows += STEPS * (uint32_t)w->trimesh.state->triangles;
      folds += STEPS * w->membrane.fold_count;
    }
    free_all(&a);
  }
  for (uint32_t k = 0; k < count; ++k) {
    printf("figure sheets_as_scalar_%s %llu triangles, %.0f %% taken at once, %llu folds, sheets that differ "
           "%llu, as prepared %llu (asked: 0)\n",
           simd_kernel_names[kernels[k]], (unsigned long long)rows, 100.0 * (double)taken[k] * STEPS / (double)rows,
           (unsigned long long)folds, (unsigned long long)different[k],
           (unsigned long long)unlike[k]);
    CHECK_EQ_INT(unlike[k], 0);
    CHECK_EQ_INT(different[k], 0);
    CHECK(taken[k] * STEPS > rows / 4);
    CHECK(folds_taken[k] * STEPS > folds / 2);
  }
}

/* A principal stretch: any, at rest, near 1/2, where the law turns over, none, up to beyond STRAIN_MAX. */
static double draw_stretch(uint32_t kind) {
  const double share = (double)draw_word() / 4294967296.0;
  switch (kind) {
    case 0: return 1;
    case 1: return 0.5 + (share - 0.5) * exp2(-(double)draw_below(28));
    case 2: return 0.5 * share;
    case 3: return 0;
    case 4: return 1.9 + 0.3 * share; /* where kernels end */
    case 5: return 3 + (share - 0.5) * exp2(-(double)draw_below(28));
    case 6: return 4 * share;
    default: return 1 + (share - 0.5) * exp2(-(double)draw_below(10));
  }
}

/* Corners 1 and 2 beside corner 0, by weights of U and V alone: U = d1 / scale, V = d2 / scale. */
static void draw_triangle(fray_world *w, uint32_t first, double scale, uint32_t usual, uint32_t rare) {
  const double a = draw_stretch(draw_below(rare) == 0 ? draw_below(7) : usual);
  const double b = draw_below(8) == 0 ? a : draw_stretch(draw_below(rare) == 0 ? draw_below(7) : usual);
  const double turn = draw_below(6) == 0 ? 0 : (double)draw_word() / 4294967296.0 * 6.283185307179586;
  const double tilt = draw_below(3) == 0 ? 0 : (double)draw_word() / 4294967296.0 * 6.283185307179586;
  const double uu = a * cos(turn) * cos(turn) + b * sin(turn) * sin(turn);
  const double vv = b * cos(turn) * cos(turn) + a * sin(turn) * sin(turn);
  const double uv = (a - b) * cos(turn) * sin(turn);
  const double d[2][3] = {{uu * cos(tilt), uv, uu * sin(tilt)}, {uv * cos(tilt), vv, uv * sin(tilt)}};
  int32_t *const x[3] = {w->p.x, w->p.y, w->p.z};
  const int is_whole = draw_below(4) == 0;
  for (uint32_t n = 0; n < 3; ++n) {
    const int32_t at = (int32_t)draw_below(1u << 28);
    for (uint32_t k = 0; k < 3; ++k) {
      elastic_position *place = &w->membrane.positions[first + k];
      place->at[n] = at + (k == 0 ? 0 : (int32_t)lrint(d[k - 1][n] * scale * STRAIN_ONE));
      x[n][first + k] = place->at[n] >> FX_SUB_BITS;
      if (n == 0) place->low_bits = 0;
      if (!is_whole) place->low_bits |= (int32_t)draw_below(4) << 8u * n;
    }
  }
}

/* All triangles by threes of vertices, each with a stiffness of its own. */
static void draw_triangles(fray_world *w) {
  const uint32_t threes = w->p.count / 3u;
  const uint32_t usual = draw_below(9);
  const uint32_t rare = draw_below(2) == 0 ? 4 : 200;
  const uint32_t of_gains = 4 + draw_below(27);
  const unsigned up = draw_below(3);
  for (uint32_t k = 0; k < threes; ++k) draw_triangle(w, 3u * k, up == 0 ? 1 : up == 1 ? 0.5 : 0.25, usual, rare);
  for (uint32_t t = 0; t < triangles_in_use(w); ++t) {
    const int32_t stiff = natural(of_gains) >> 1;
    const int32_t across = (int32_t)draw_below(1u + (uint32_t)stiff / 2u);
    const int32_t one = (1 << TRIMESH_WEIGHT_BITS) << up;
    for (uint32_t k = 0; k < 3; ++k) w->trimesh.triangle[t].v[k] = (index_t)(3u * (t % threes) + k);
    w->trimesh.weights[t] = (trimesh_weights){one, 0, 0, one};
    w->membrane.gains[t] = (membrane_gain){{stiff, across, stiff, (stiff - across) / 2}};
    if (draw_below(20) == 0)
      for (uint32_t n = 0; n < MATERIAL_ENTRIES; ++n) w->membrane.gains[t].c[n] = some(31);
  }
}

/* Impulses of a step and the stress of a tick, from what `a` holds first. Returns the faults. */
static int32_t find_stress(fray_world *w, const arrays *a, fray_kernel kernel) {
  fray_set_kernel(w, kernel);
  put(a);
  w->state->faults = 0;
  membrane_force_add(w, FORCE_FIRST);
  membrane_stress_update(w);
  return w->state->faults;
}

static void drawn_triangles_are_as_scalar(void) {
  fray_kernel kernels[SIMD_KERNELS];
  const uint32_t count = simd_kernels(kernels);
  uint64_t different[SIMD_KERNELS] = {0};
  uint64_t taken[SIMD_KERNELS] = {0};
  uint64_t rows = 0;
  uint64_t overstretched = 0;
  while (rows < rows_asked) {
    fixture_scoped f = {0};
    print_isotropic(&f);
    fray_world *w = f.w;
    fixture_tick(&f, &fixture_idle);
    CHECK(world_is_corotational(w));
    membrane_params *constants = (membrane_params *)(uintptr_t)w->membrane.constants;
    arrays a;
    move_all(&a, w);
    for (uint32_t round = 0; round < ROUNDS; ++round) {
      constants->norm2_max = draw_below(4) == 0 ? 1 << 12 : INT32_MAX; /* all softened, or none */
      draw_triangles(w);
      keep(&a, a.first);
      const int32_t faults = find_stress(w, &a, FRAY_KERNEL_SCALAR);
      overstretched += (faults & FRAY_FAULT_OVERSTRETCHED) != 0;
      keep(&a, a.found);
      for (uint32_t k = 0; k < count; ++k) {
        different[k] += find_stress(w, &a, kernels[k]) != faults;
        different[k] += !is_found(&a);
        put(&a);
        taken[k] += drawn_taken_of(w);
      }
      rows += triangles_in_use(w);
    }
    free_all(&a);
  }
  for (uint32_t k = 0; k < count; ++k) {
    printf("figure drawn_triangles_as_scalar_%s %llu triangles, %.0f %% taken at once, sheets that differ %llu (asked: 0)\n",
           simd_kernel_names[kernels[k]], (unsigned long long)rows, 100.0 * (double)taken[k] / (double)rows,
           (unsigned long long)different[k]);
    CHECK_EQ_INT(different[k], 0);
    CHECK(taken[k] > rows / 4);
  }
  CHECK(overstretched > 0);
}

int main(int argc, char **argv) {
  if (argc > 1) rows_asked = strtoull(argv[1], NULL, 10);
  TEST(sheets_are_as_scalar);
  TEST(drawn_triangles_are_as_scalar);
  return test_end();
}
