/* SPDX-License-Identifier: Apache-2.0 */
/* A cell of a woven sheet, sheared by s from a right angle, has diagonals of a^2 + b^2 -+ 2 a b sin s,
 * squared. A shear lock of 45 degrees keeps s below 50 in a sheet that falls and hangs by two corners, and in
 * one that is torn; without a lock the same sheets hang as ropes. */
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"

enum { LIMIT = 50 };

static const char SCENE[] =
    "scene sheared\nrate 1000 Hz\nsubsteps 24\niterations 1\nsettle 0 s\nseed 20091\n"
    "woven {\n warps 24\n wefts 24\n spacing 12 /cm\n bend 5 g/s2\n shear 2 g/s2\n shear_lock %d deg\n"
    " %s\n drag 2 /s\n}\n";

/* Share of whole diagonals that a shear beyond LIMIT makes that short, and the farthest shear, degrees. */
static double share_beyond(const fray_world *w, double *farthest) {
  const double side = w->woven.link_classes[CLASS_WEFT].rest;
  const double most = sin(LIMIT * acos(-1) / 180);
  uint32_t whole = 0;
  uint32_t beyond = 0;
  *farthest = 0;
  const uint32_t first = (uint32_t)(w->params->links + w->params->bends);
  for (uint32_t s = first; s < first + (uint32_t)w->params->shears; ++s) {
    if (w->woven.spring_kind[s] != CLASS_SHEAR) continue;
    const uint32_t i = w->woven.spring_i[s];
    const uint32_t j = w->woven.spring_j[s];
    const double x = (double)w->p.x[i] - w->p.x[j];
    const double y = (double)w->p.y[i] - w->p.y[j];
    const double z = (double)w->p.z[i] - w->p.z[j];
    const double sine = 1 - (x * x + y * y + z * z) / (2 * side * side);
    ++whole;
    beyond += sine > most;
    *farthest = fmax(*farthest, 180 / acos(-1) * asin(fmin(1, sine)));
  }
  return whole == 0 ? 0 : (double)beyond / whole;
}

typedef struct {
  double beyond, farthest; /* the most at any tick */
  double last;             /* share at the end */
  uint32_t tears;
} result;

static void look(const fixture *f, result *r) {
  double farthest;
  r->last = share_beyond(f->w, &farthest);
  r->beyond = fmax(r->beyond, r->last);
  r->farthest = fmax(r->farthest, farthest);
}

static void print(const char *name, int lock, const result *r) {
  char text[80];
  snprintf(text, sizeof text, "shear_lock_%s_%d_beyond_50", name, lock);
  figure(text, 100 * r->beyond, "% of whole cells", "0 with a lock");
  snprintf(text, sizeof text, "shear_lock_%s_%d_farthest", name, lock);
  figure(text, r->farthest, "deg", "at most 50 with a lock");
}

static result hang(int lock) {
  fixture_scoped f = {0};
  result r = {0, 0, 0, 0};
  char text[1024];
  snprintf(text, sizeof text, SCENE, lock, "tear off\n yarns off");
  fixture_print(&f, "%spin crossing 0 23\npin crossing 23 23\n", text);
  for (uint32_t tick = 0; tick < 1500; ++tick) {
    (void)fixture_tick(&f, &fixture_idle);
    look(&f, &r);
  }
  print("hanging", lock, &r);
  return r;
}

/* Torn by two hands that move apart, with its yarns. */
static result tear(int lock) {
  fixture_scoped f = {0};
  result r = {0, 0, 0, 0};
  char text[1024];
  snprintf(text, sizeof text, SCENE, lock, "tear 5 10 %\n yarns on");
  fixture_print(&f,
                "%ssphere left {\n radius 0.25 cm\n at -0.9583 0.9583 0 cm\n move hand left\n"
                " attach_within 0.02 cm\n}\n"
                "sphere right {\n radius 0.25 cm\n at 0.9583 0.9583 0 cm\n move hand right\n"
                " attach_within 0.02 cm\n}\n",
                text);
  (void)fixture_start_hands(&f, 200);
  for (uint32_t tick = 0; tick < 3000; ++tick) {
    const int32_t at = (int32_t)(tick < 2000 ? tick : 2000) * 5 / 2; /* 5 mm/s each */
    const int32_t to[FRAY_HANDS][3] = {{-at, 0, 0}, {at, 0, 0}};
    const fray_input input = fixture_poses(&f, to, tick);
    r.tears = fixture_tick(&f, &input).tears_total;
    look(&f, &r);
  }
  CHECK(fixture_topology_holds(f.w));
  print("torn", lock, &r);
  return r;
}

static void torn(void) {
  const result locked = tear(45);
  const result loose = tear(0);
  CHECK(locked.tears > 0 && loose.tears > 0);
  CHECK(locked.beyond == 0 && locked.farthest <= LIMIT);
  CHECK(loose.beyond > 0.2);
}

static void hanging(void) {
  const result locked = hang(45);
  const result loose = hang(0);
  CHECK(locked.beyond == 0 && locked.farthest <= LIMIT);
  CHECK(loose.beyond > 0.2);
}

int main(void) {
  TEST(hanging);
  TEST(torn);
  return test_end();
}
