/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts with a plane that faces up: every kernel that this machine has against the scalar stage, to
 * the last bit: particles at rest, sliding, deep, at the world's edge, some of them in contact, some of
 * half the mass, in runs and apart. All arrays lie against a page that faults.
 *
 *   test_simd_contacts [CONTACTS]     1,000,000 unless told, a tenth under sanitizers */
#define _DEFAULT_SOURCE 1 /* mmap without a file */
#include "tests/lib/test.h"

#include "rt/state/crossing.h"
#include "rt/contact/contact.h"
#include "tests/lib/guarded.h"
#include "tests/lib/simd_kernels.h"

enum { MOST = 150, ARRAYS = 9 };
#define PLACE_MAX (62 * FX_LU)

static uint64_t contacts_asked = GUARDED_SLOW ? 100000 : 1000000;

/* Places, speeds, predicted places by axis; contacts; what they did to the plane. */
typedef struct {
  int32_t word[ARRAYS][MOST];
  contact contacts[MOST];
  uint8_t couple[MOST];
  index_t place[MOST];
  uint32_t particles, count, first, end, yarns;
  params constants;
  rigid_body plane;
  body_state at;
  body_motion motion;
  state state;
} heap;

static guarded memory_word[ARRAYS], memory_contacts;

static int32_t near(int32_t v, uint32_t most) {
  const int64_t by = draw_below(most) - (int64_t)(most / 2);
  return (int32_t)fx_clamp64(v + by, -PLACE_MAX, PLACE_MAX);
}

static void make_particle(heap *h, uint32_t p) {
  const uint32_t slip = 1u << (2 + draw_below(24));
  for (int a = 0; a < 3; ++a) {
    h->word[a][p] = draw_below(6) == 0 ? draw_either(1, -1) * (FX_WORLD_MAX - (int32_t)draw_below(1000))
                                  : draw_between(-PLACE_MAX, PLACE_MAX);
    h->word[3 + a][p] = draw_below(3) == 0 ? draw_either(1, -1) * (int32_t)draw_below(1u << 31) / 2
                                      : near(0, slip << FX_SUB_BITS);
  }
  if (draw_below(8) != 0) h->word[1][p] = near(h->at.position[1], draw_below(4) == 0 ? 1u << 27 : 1u << 20);
  for (int a = 0; a < 3; ++a) h->word[6 + a][p] = draw_below(5) == 0 ? h->word[a][p] : near(h->word[a][p], slip);
}

static void make_heap(heap *h) {
  memset(h, 0, sizeof *h);
  h->particles = 1 + draw_below(MOST);
  h->constants.thickness = draw_below(4) == 0 ? 0 : (int32_t)draw_below(1u << (1 + draw_below(24)));
  h->plane.shape = FRAY_PLANE;
  h->plane.axes[0] = h->plane.axes[4] = h->plane.axes[8] = 1 << 30;
  h->plane.friction = draw_below(3) == 0 ? draw_either(0, 16 << 16) : draw_between(0, 2 << 16);
  for (int a = 0; a < 3; ++a) h->at.position[a] = draw_between(-40 * FX_LU, 40 * FX_LU);
  if (draw_below(3) == 0) h->motion.moved = vec_make(near(0, 1u << 25), near(0, 1u << 25), near(0, 1u << 25));
  const uint32_t gaps = draw_below(3);
  h->yarns = draw_below(2);
  for (uint32_t p = 0; p < h->particles; ++p) {
    make_particle(h, p);
    h->place[p] = (index_t)draw_below(h->particles);
    h->couple[p] = (uint8_t)(draw_below(4) | (draw_below(4) == 0 ? CROSSING_PENDING : 0));
    if (gaps == 0 || draw_below(1 + gaps) != 0) h->contacts[h->count++].particle = p;
  }
  h->first = draw_below(3) == 0 && h->count != 0 ? draw_below(h->count) : 0;
  h->end = h->count - (draw_below(3) == 0 ? draw_below(h->count - h->first + 1) : 0);
}

static void run(heap *h, fray_kernel kernel, int32_t *const word[ARRAYS], contact *contacts) {
  fray_world w = {0};
  w.kernel = kernel;
  w.params = &h->constants;
  w.rigid.bodies = &h->plane;
  w.rigid.states = &h->at;
  w.rigid.motion = &h->motion;
  w.state = &h->state;
  w.contact.list = contacts;
  w.contact.count = w.capacity[POOL_CONTACTS] = h->count;
  w.p.count = w.capacity[POOL_PARTICLES] = h->particles;
  w.capacity[POOL_BODIES] = 1;
  w.capacity[POOL_SPLITS] = h->yarns;
  world_find_features(&w);
  if (h->yarns != 0) w.woven.crossing_state = h->couple, w.woven.crossing_of = h->place;
  w.p.x = word[0], w.p.y = word[1], w.p.z = word[2];
  w.p.vx = word[3], w.p.vy = word[4], w.p.vz = word[5];
  w.p.qx = word[6], w.p.qy = word[7], w.p.qz = word[8];
  contact_primitives_range(&w, h->first, h->end);
  CHECK_EQ_INT(w.work.contacts, h->end - h->first);
}

static int kernel_is_as(const heap *given, const heap *expected, fray_kernel kernel, int at_end) {
  static heap h;
  int32_t *word[ARRAYS];
  h = *given;
  for (int n = 0; n < ARRAYS; ++n)
    word[n] = memcpy(guarded_place(&memory_word[n], 4 * h.particles, at_end), h.word[n], 4 * h.particles);
  const size_t bytes = h.count * sizeof(contact);
  contact *contacts = memcpy(guarded_place(&memory_contacts, bytes, at_end), h.contacts, bytes);
  run(&h, kernel, word, contacts);
  int same = memcmp(&h.motion, &expected->motion, sizeof h.motion) == 0 &&
             h.state.faults == expected->state.faults && guarded_intact(&memory_contacts) &&
             memcmp(contacts, expected->contacts, bytes) == 0;
  for (int n = 0; n < ARRAYS; ++n)
    same = same && memcmp(word[n], expected->word[n], 4 * h.particles) == 0 && guarded_intact(&memory_word[n]);
  return same;
}

static void contacts_are_as_scalar(void) {
  static heap given, expected;
  fray_kernel kernels[SIMD_KERNELS];
  const uint32_t count = simd_kernels(kernels);
  uint64_t different[SIMD_KERNELS] = {0};
  uint64_t contacts = 0, touching = 0, held_back = 0;
  for (uint32_t n = 0; contacts < contacts_asked; ++n) {
    make_heap(&given);
    expected = given;
    int32_t *word[ARRAYS];
    for (int a = 0; a < ARRAYS; ++a) word[a] = expected.word[a];
    run(&expected, FRAY_KERNEL_SCALAR, word, expected.contacts);
    for (uint32_t k = 0; k < count; ++k)
      different[k] += !kernel_is_as(&given, &expected, kernels[k], n % 2 == 0);
    contacts += given.end - given.first;
    for (uint32_t c = given.first; c < given.end; ++c)
      touching += expected.contacts[c].touching == CONTACT_GROUND;
    held_back += expected.state.faults != 0;
  }
  printf("figure contacts_touching %llu, heaps at the world's edge %llu (asked: printed)\n",
         (unsigned long long)touching, (unsigned long long)held_back);
  CHECK(touching > contacts / 4 && touching < contacts && held_back > 0);
  simd_report("contacts", "heaps", kernels, count, contacts, different);
}

int main(int argc, char **argv) {
  if (argc > 1) contacts_asked = strtoull(argv[1], NULL, 10);
  for (int n = 0; n < ARRAYS; ++n) memory_word[n] = guarded_make(4 * MOST);
  memory_contacts = guarded_make(MOST * sizeof(contact));
  TEST(contacts_are_as_scalar);
  return test_end();
}
