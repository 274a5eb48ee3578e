/* SPDX-License-Identifier: Apache-2.0 */
/* A free body that begins in another one is refused, and one beside it is not: capsules and boxes at random places,
 * against the distance from points along the capsule's axis. */
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"

enum { PAIRS = 2000 / TEST_FEWER, ALONG = 400 };
static const double thickness = 0.01, pi = 3.14159265358979323846;

static uint64_t seed = 3;
static double between(double from, double to) {
  return from + (to - from) * (double)(splitmix64(&seed) >> 11) * 0x1p-53;
}

typedef struct {
  double at[3], size[3], length, radius;
  int turn[2]; /* of capsule and box, degrees about z */
} pair;

/* Of a point of the capsule's axis, from the box; 0 in it. */
static double distance(const pair *p, double along) {
  const double c = cos(p->turn[0] * pi / 180), s = sin(p->turn[0] * pi / 180);
  const double bc = cos(p->turn[1] * pi / 180), bs = sin(p->turn[1] * pi / 180);
  const double x = along * c - p->at[0], y = along * s - p->at[1];
  const double local[3] = {x * bc + y * bs, y * bc - x * bs, -p->at[2]};
  double squared = 0;
  for (uint32_t n = 0; n < 3; ++n) squared += pow(fmax(0, fabs(local[n]) - p->size[n] / 2), 2);
  return sqrt(squared);
}

static double overlap_of(const pair *p) {
  double least = 1e300;
  for (int n = 0; n <= ALONG; ++n) least = fmin(least, distance(p, p->length * (n / (double)ALONG - 0.5)));
  return p->radius - least;
}

static void what_begins_in_a_body_is_refused(void) {
  uint32_t refused = 0, accepted = 0, near = 0;
  for (uint32_t n = 0; n < PAIRS; ++n) {
    pair p;
    char text[1024];
    scene_error error;
    fixture_scoped f = {0};
    for (uint32_t k = 0; k < 3; ++k) {
      p.at[k] = between(-2, 2);
      p.size[k] = between(0.2, 2);
    }
    p.length = between(0.2, 3);
    p.radius = between(0.1, 0.6);
    for (uint32_t k = 0; k < 2; ++k) p.turn[k] = (int)between(-89, 89);
    snprintf(text, sizeof text,
             "scene s\nwoven {\n warps 4\n wefts 4\n spacing 10 /cm\n at 0 0 5 cm\n thickness %g cm\n}\n"
             "capsule c {\n length %.4f cm\n radius %.4f cm\n rotate %d deg about z\n at 0 0 0 cm\n move free\n mass 9 g\n}\n"
             "box b {\n size %.4f %.4f %.4f cm\n rotate %d deg about z\n at %.4f %.4f %.4f cm\n}\n",
             thickness, p.length, p.radius, p.turn[0], p.size[0], p.size[1], p.size[2], p.turn[1], p.at[0], p.at[1],
             p.at[2]);
    const double over = overlap_of(&p) - thickness;
    const int good = fixture_compile(&f, "test", text, &error);
    if (fabs(over) < 0.002) {
      ++near;
      continue;
    }
    if (!good) CHECK(error.line == 13 && strstr(error.message, "expected a place outside of 'b'") != NULL);
    CHECK_EQ_INT(good, over < 0);
    refused += !good;
    accepted += good != 0;
  }
  printf("figure bodies_refused %u, accepted %u, too near to tell %u (asked: as sampled)\n", refused, accepted, near);
  CHECK(refused > PAIRS / 10 && accepted > PAIRS / 10 && near < PAIRS / 50);
}

int main(void) {
  TEST(what_begins_in_a_body_is_refused);
  return test_end();
}
