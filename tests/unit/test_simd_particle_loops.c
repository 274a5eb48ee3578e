/* SPDX-License-Identifier: Apache-2.0 */
/* The sweeps over particles and the hash: every kernel that this machine has against the scalar code,
 * to the last bit, at the ends of every range. All arrays lie against a page that faults.
 *
 *   test_simd_particle_loops [PARTICLES]     of each sweep, 1,000,000 unless told, a tenth under sanitizers */
#define _DEFAULT_SOURCE 1 /* mmap without a file */
#include <math.h>

#include "tests/lib/test.h"

#include "rt/simd/simd.h"
#include "tests/lib/guarded.h"
#include "tests/lib/simd_kernels.h"

enum { MOST = 200, ARRAYS = 6 };
#define PLACE_MAX (62 * FX_LU)

static uint64_t particles_asked = GUARDED_SLOW ? 100000 : 1000000;

/* What a sweep is given: places, speeds, remainders, of `all` particles, and takes first..end - 1. */
typedef struct {
  int32_t word[ARRAYS][MOST];
  int8_t byte[MOST];
  rigid_fit motion;
  broad_phase near;
  hash h[3];
  uint32_t all, first, end, answer;
  int32_t share, gravity;
} span;

/* The same arrays where a sweep may work on them. */
typedef struct {
  int32_t *word[ARRAYS];
  int8_t *byte;
} span_arrays;

static int32_t some_place(void) {
  switch (draw_below(4)) {
    case 0: return draw_either(1, -1) * (PLACE_MAX - (int32_t)draw_below(100));
    case 1: return draw_between(-1000, 1000);
    default: return draw_between(-PLACE_MAX, PLACE_MAX);
  }
}
static int32_t some_speed(void) {
  switch (draw_below(4)) {
    case 0: return draw_either(1, -1) * (FX_SPEED_MAX - (int32_t)draw_below(100));
    case 1: return draw_between(-100, 100);
    default: return draw_between(-FX_SPEED_MAX, FX_SPEED_MAX);
  }
}
static int64_t some_turn(void) {
  const int64_t most = (int64_t)1 << 31;
  switch (draw_below(4)) {
    case 0: return draw_either(1, -1) * most;
    case 1: return 0;
    default: return draw_between(-INT32_MAX, INT32_MAX) / (1 << draw_below(20));
  }
}
static int32_t some_share(void) {
  return draw_below(3) == 0 ? draw_either(1, 1 << 24) : draw_between(0, 1 << draw_below(25));
}

static void make_reach(broad_phase *g) {
  double squared = 0;
  int32_t normal[3];
  g->substeps = 1 + draw_below(128);
  g->fastest = (uint32_t)FX_WORLD_MAX / g->substeps;
  g->above = draw_between(0, 1 << draw_below(31));
  for (int n = 0; n < 3; ++n) {
    g->centre[n] = some_place();
    g->half[n] = draw_below(8) == 0 ? 1u << 31 : draw_below(1u << (8 + draw_below(24)));
    normal[n] = draw_between(-1000, 1000);
    squared += (double)normal[n] * normal[n] + 1e-9;
  }
  const double to = (1 << 30) / sqrt(squared);
  g->normal = vec_make((int32_t)(normal[0] * to), (int32_t)(normal[1] * to), (int32_t)(normal[2] * to));
}

static void make_span(span *s) {
  s->all = 1 + draw_below(MOST);
  s->first = draw_below(3) == 0 ? 0 : draw_below(s->all);
  s->end = s->first + 1 + (draw_below(3) == 0 ? s->all - s->first - 1 : draw_below(s->all - s->first));
  s->share = some_share();
  s->gravity = draw_below(3) == 0 ? draw_either(-(1 << 24), (1 << 24) + 1) : draw_between(-(1 << 24), 1 << 24);
  s->answer = 0;
  for (uint32_t p = 0; p < s->all; ++p) {
    for (int a = 0; a < 3; ++a) s->word[a][p] = some_place();
    for (int a = 3; a < ARRAYS; ++a) s->word[a][p] = some_speed();
    s->byte[p] = (int8_t)draw_between(-8, 8);
  }
  memset(&s->motion, 0, sizeof s->motion);
  s->motion.centre = vec_make(some_place(), some_place(), some_place());
  s->motion.velocity = vec_make(some_speed(), some_speed(), some_speed());
  for (int n = 0; n < 3; ++n) s->motion.turn[n] = some_turn();
  make_reach(&s->near);
  for (int n = 0; n < 3; ++n)
    for (int k = 0; k < HASH_LANES; ++k) s->h[n].lane[k] = draw_word();
}

typedef void sweep(span *s, fray_kernel kernel, const span_arrays *a);

static void do_advance(span *s, fray_kernel kernel, const span_arrays *a) {
  s->answer = simd_advance(kernel, a->word[0], a->word[1], a->word[3], a->byte, s->first, s->end, s->gravity);
}
static void do_carry(span *s, fray_kernel kernel, const span_arrays *a) {
  simd_carry(kernel, a->word[0], a->word[1], a->word[3], a->word[2], s->first, s->end, s->near.centre[0],
             s->gravity);
}
/* Some were moved farther than a velocity can take over. */
static void do_take_over(span *s, fray_kernel kernel, const span_arrays *a) {
  for (uint32_t p = s->first; p < s->end; p += 3) a->word[0][p] = fx_add_saturated(a->word[0][p], a->word[0][p]);
  simd_velocity(kernel, a->word[0], a->word[1], a->word[3], s->first, s->end);
}
static void do_drag(span *s, fray_kernel kernel, const span_arrays *a) {
  simd_drag(kernel, a->word[3], s->first, s->end, s->share);
}
static void do_turning(span *s, fray_kernel kernel, const span_arrays *a) {
  simd_rotation(kernel, &s->motion, a->word[0], a->word[1], a->word[2], a->word[3], a->word[4],
               a->word[5], s->first, s->end);
}
static void do_follow(span *s, fray_kernel kernel, const span_arrays *a) {
  simd_follow(kernel, &s->motion, s->share, a->word[0], a->word[1], a->word[2], a->word[3],
              a->word[4], a->word[5], s->first, s->end);
}
/* The scalar stage asks of each particle by itself; what it may leave out is this. */
static void do_near_box(span *s, fray_kernel kernel, const span_arrays *a) {
  int32_t *const *w = a->word;
  s->answer = kernel == FRAY_KERNEL_SCALAR
                  ? broad_phase_any_near(0, &s->near, w[0], w[1], w[2], w[3], w[4], w[5], s->first, s->end)
                  : simd_near_box(kernel, &s->near, w[0], w[1], w[2], w[3], w[4], w[5], s->first, s->end);
}
static void do_near_plane(span *s, fray_kernel kernel, const span_arrays *a) {
  int32_t *const *w = a->word;
  s->answer = kernel == FRAY_KERNEL_SCALAR
                  ? broad_phase_any_near(1, &s->near, w[0], w[1], w[2], w[3], w[4], w[5], s->first, s->end)
                  : simd_near_plane(kernel, &s->near, w[0], w[1], w[2], w[3], w[4], w[5], s->first, s->end);
}
static void do_words(span *s, fray_kernel kernel, const span_arrays *a) {
  const int32_t *const from[3] = {a->word[3] + s->first, a->word[4] + s->first,
                                  a->word[5] + s->first};
  const uint32_t count = s->end - s->first;
  const uint32_t taken = simd_hash_words(kernel, s->h, from, count);
  for (int n = 0; n < 3; ++n) hash_words(&s->h[n], from[n] + taken, count - taken);
}
static void do_bytes(span *s, fray_kernel kernel, const span_arrays *a) {
  const uint32_t third = (s->end - s->first) / 3;
  const int8_t *const from[3] = {a->byte + s->first, a->byte + s->first + third,
                                 a->byte + s->end - third};
  const uint32_t taken = simd_hash_bytes(kernel, s->h, from, third);
  for (int n = 0; n < 3; ++n) hash_bytes(&s->h[n], from[n] + taken, third - taken);
}

static guarded memory_word[ARRAYS], memory_byte;

static int kernel_is_as(const span *given, const span *expected, sweep *run, fray_kernel kernel, int at_end) {
  static span s;
  span_arrays a;
  s = *given;
  for (int n = 0; n < ARRAYS; ++n)
    a.word[n] = memcpy(guarded_place(&memory_word[n], 4 * s.all, at_end), s.word[n], 4 * s.all);
  a.byte = memcpy(guarded_place(&memory_byte, s.all, at_end), s.byte, s.all);
  run(&s, kernel, &a);
  int same = s.answer == expected->answer && memcmp(s.h, expected->h, sizeof s.h) == 0 &&
             memcmp(&s.motion, &expected->motion, sizeof s.motion) == 0 &&
             memcmp(a.byte, expected->byte, s.all) == 0 && guarded_intact(&memory_byte);
  for (int n = 0; n < ARRAYS; ++n)
    same = same && memcmp(a.word[n], expected->word[n], 4 * s.all) == 0 && guarded_intact(&memory_word[n]);
  return same;
}

static void sweep_is_as_scalar(const char *name, sweep *run) {
  static span given, expected;
  fray_kernel kernels[SIMD_KERNELS];
  const uint32_t count = simd_kernels(kernels);
  uint64_t different[SIMD_KERNELS] = {0};
  uint64_t particles = 0;
  for (uint32_t n = 0; particles < particles_asked && count != 0; ++n) {
    make_span(&given);
    expected = given;
    span_arrays plain = {{0}, expected.byte};
    for (int a = 0; a < ARRAYS; ++a) plain.word[a] = expected.word[a];
    run(&expected, FRAY_KERNEL_SCALAR, &plain);
    for (uint32_t k = 0; k < count; ++k)
      different[k] += !kernel_is_as(&given, &expected, run, kernels[k], n % 2 == 0);
    particles += given.end - given.first;
  }
  simd_report(name, "spans", kernels, count, particles, different);
}

static void advance_is_as_scalar(void) { sweep_is_as_scalar("advance", do_advance); }
static void carry_is_as_scalar(void) { sweep_is_as_scalar("carry", do_carry); }
static void take_over_is_as_scalar(void) { sweep_is_as_scalar("take_over", do_take_over); }
static void drag_is_as_scalar(void) { sweep_is_as_scalar("drag", do_drag); }
static void turning_is_as_scalar(void) { sweep_is_as_scalar("turning", do_turning); }
static void follow_is_as_scalar(void) { sweep_is_as_scalar("follow", do_follow); }
static void near_box_is_as_scalar(void) { sweep_is_as_scalar("near_box", do_near_box); }
static void near_plane_is_as_scalar(void) { sweep_is_as_scalar("near_plane", do_near_plane); }
static void words_are_as_scalar(void) { sweep_is_as_scalar("hash_words", do_words); }
static void bytes_are_as_scalar(void) { sweep_is_as_scalar("hash_bytes", do_bytes); }

int main(int argc, char **argv) {
  if (argc > 1) particles_asked = strtoull(argv[1], NULL, 10);
  for (int n = 0; n < ARRAYS; ++n) memory_word[n] = guarded_make(4 * MOST);
  memory_byte = guarded_make(MOST);
  TEST(advance_is_as_scalar);
  TEST(carry_is_as_scalar);
  TEST(take_over_is_as_scalar);
  TEST(drag_is_as_scalar);
  TEST(turning_is_as_scalar);
  TEST(follow_is_as_scalar);
  TEST(near_box_is_as_scalar);
  TEST(near_plane_is_as_scalar);
  TEST(words_are_as_scalar);
  TEST(bytes_are_as_scalar);
  return test_end();
}
