/* SPDX-License-Identifier: Apache-2.0 */
/* Inner steps of membranes, and what a tick works out for them: every kernel that this machine has
 * against the scalar code, to the last bit. Irregular meshes; vertices where the sheet has them and thrown
 * together, in a plane, on a line, at one point, apart by the size of the world; gains, weights, creases, loads and speeds of their own and
 * any. All that kernels read and write ends where the next page faults.
 *
 *   test_simd_membrane [ROWS]     triangles, 2,000,000 unless told, a tenth under sanitizers */
#define _DEFAULT_SOURCE 1 /* mmap without a file */
#include "tests/lib/test.h"

#include "rt/membrane/membrane.h"
#include "rt/simd/simd.h"
#include "tests/lib/guarded.h"
#include "tests/lib/simd_kernels.h"
#include "tests/lib/world_fixture.h"

enum { ROUNDS = 12, ARRAYS = 15, STEPS = 3, VERTICES = 256 };

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
  MOVE(12, membrane.hinges, w->membrane.hinge_count);
  MOVE(13, membrane.smoothed_strains, triangles);
  MOVE(14, membrane.stress, triangles);
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

static void throw_gains(const fray_world *w, int steep) {
  const uint32_t triangles = (uint32_t)w->trimesh.state->triangles;
  const uint32_t of_gains = steep ? 28 + draw_below(4) : 1 + draw_below(31);
  /* the third one, their sum, is a weight too */
  const uint32_t of_weights = steep ? 26 + draw_below(4) : 1 + draw_below(30);
  const uint32_t of_creases = 1 + draw_below(31);
  const uint32_t of_speeds = 1 + draw_below(30);
  const uint32_t of_masses = 1 + draw_below(31);
  const uint32_t of_loads = 1 + draw_below(22);
  int32_t *const speed[3] = {w->p.vx, w->p.vy, w->p.vz};
  if (steep || draw_below(2) == 0)
    for (uint32_t t = 0; t < triangles; ++t)
      for (uint32_t n = 0; n < MATERIAL_ENTRIES; ++n) w->membrane.gains[t].c[n] = some(of_gains);
  if (steep || draw_below(3) == 0)
    for (uint32_t t = 0; t < triangles; ++t)
      w->trimesh.weights[t] =
          (trimesh_weights){some(of_weights), some(of_weights), some(of_weights), some(of_weights)};
  for (uint32_t n = 0; n < w->membrane.hinge_count && draw_below(1000) != 0; ++n) {
    bend_hinge *c = &w->membrane.hinges[n];
    for (uint32_t k = 0; k < MATERIAL_CURVES; ++k) c->stiffness[k] = natural(of_creases);
    c->curvature_scale = natural(1 + draw_below(31));
    for (uint32_t k = 0; k < 2; ++k) c->height[k] = natural(of_masses);
    for (uint32_t k = 0; k < 2; ++k) c->foot[k] = draw_between(-(2 << 24), 2 << 24);
  }
  for (uint32_t p = 0; p < w->p.count; ++p) {
    for (uint32_t n = 0; n < 3; ++n) speed[n][p] = some(of_speeds);
    w->membrane.inverse_mass[p] = natural(of_masses);
    w->membrane.external_impulse[p] = (elastic_impulse){some(of_loads), some(of_loads), some(of_loads), 0};
  }
}

static void make_sheet(fixture *f) {
  static const char *const cloths[] = {"denim", "pants", "t-shirt", "paper"};
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
  membrane_step_run(w, 0);
}

/* Of a tick, with vertices where they were thrown: stress, wind, creases. */
static void prepare(fray_world *w, const positions *from, uint32_t creases, fray_kernel kernel) {
  fray_set_kernel(w, kernel);
  begin(w, from);
  membrane_stress_update(w);
  membrane_gains_update(w);
  wind_apply(w);
  memset(w->membrane.hinges + w->membrane.hinge_count, 0, (creases - w->membrane.hinge_count) * sizeof *w->membrane.hinges);
}

/* Of triangles, as they are now: those before the first that is left to the scalar code. */
static uint64_t taken_of(const fray_world *w) {
  const force_view view = {w->membrane.positions, w->membrane.impulse, w->trimesh.triangle, w->trimesh.weights, w->membrane.gains};
  return simd_membrane_force(w->kernel, &view, 0, (uint32_t)w->trimesh.state->triangles);
}

static void sheets_are_as_scalar(void) {
  fray_kernel kernels[SIMD_KERNELS];
  const uint32_t count = simd_kernels(kernels);
  uint64_t different[SIMD_KERNELS] = {0};
  uint64_t unlike[SIMD_KERNELS] = {0};
  uint64_t taken[SIMD_KERNELS] = {0};
  uint64_t rows = 0;
  uint64_t creases = 0;
  while (rows < rows_asked) {
    fixture_scoped f = {0};
    make_sheet(&f);
    fray_world *w = f.w;
    fixture_tick(&f, &fixture_idle); /* fills what follows from the state */
    ((membrane_params *)(uintptr_t)w->membrane.constants)->steps = STEPS;
    ((membrane_params *)(uintptr_t)w->membrane.constants)->bend_every = 1;
    arrays a;
    positions home;
    positions thrown;
    move_all(&a, w);
    const uint32_t listed = w->membrane.hinge_count;
    take(w, &home);
    for (uint32_t round = 0; round < ROUNDS; ++round) {
      const int steep = draw_below(8) == 0;
      begin(w, &home);
      throw_vertices(w, steep);
      take(w, &thrown);
      keep(&a, a.first);
      prepare(w, &thrown, listed, FRAY_KERNEL_SCALAR);
      keep(&a, a.found);
      w->membrane.hinge_count = listed;
      for (uint32_t k = 0; k < count; ++k) {
        put(&a);
        prepare(w, &thrown, listed, kernels[k]);
        unlike[k] += !is_found(&a);
      }
      put(&a);
      w->membrane.hinge_count = listed;
      throw_gains(w, steep);
      keep(&a, a.first);
      run(w, &thrown, FRAY_KERNEL_SCALAR);
      keep(&a, a.found);
      for (uint32_t k = 0; k < count; ++k) {
        put(&a);
        run(w, &thrown, kernels[k]);
        different[k] += !is_found(&a);
        taken[k] += taken_of(w);
      }
      rows += STEPS * (uint32_t)w->trimesh.state->triangles;
      creases += STEPS * w->membrane.hinge_count;
    }
    free_all(&a);
  }
  for (uint32_t k = 0; k < count; ++k) {
    printf("figure sheets_as_scalar_%s %llu triangles, %.0f %% taken at once, %llu creases, sheets that differ "
           "%llu, as prepared %llu (asked: 0)\n",
           simd_kernel_names[kernels[k]], (unsigned long long)rows, 100.0 * (double)taken[k] * STEPS / (double)rows,
           (unsigned long long)creases, (unsigned long long)different[k],
           (unsigned long long)unlike[k]);
    CHECK_EQ_INT(unlike[k], 0);
    CHECK_EQ_INT(different[k], 0);
    CHECK(taken[k] * STEPS > rows / 4);
  }
}

int main(int argc, char **argv) {
  if (argc > 1) rows_asked = strtoull(argv[1], NULL, 10);
  TEST(sheets_are_as_scalar);
  return test_end();
}
