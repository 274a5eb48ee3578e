/* SPDX-License-Identifier: Apache-2.0 */
/* Projected links that bodies draw: what is in a link's way is let through with a fault, what is too heavy
 * for it is stopped, and what was in a body before comes out slowly. */
#include "rt/woven/woven.h"
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"

static double speed_unit(const fixture *f) {
  return f->facts.lu_um * 1e-6 * 0x1p-28 * f->facts.rate_hz * f->facts.substeps;
}

static double length_of(vec3 v) { return sqrt((double)v.x * v.x + (double)v.y * v.y + (double)v.z * v.z); }

/* What came of a run. */
typedef struct {
  double longest; /* link, of its rest length */
  double fastest; /* particle, m/s */
  double made;    /* by limits and contact, less what they lost, of the magnitude of gravity's work */
  uint32_t faults;
} drawn;

static void look(const fixture *f, drawn *r) {
  const fray_world *w = f->w;
  for (uint32_t n = 0; n < (uint32_t)w->params->links; ++n) {
    if (w->woven.spring_kind[n] == SPRING_DEAD) continue;
    const vec3 d = vec_sub(world_position(w, w->woven.spring_j[n]), world_position(w, w->woven.spring_i[n]));
    r->longest = fmax(r->longest, length_of(d) / w->woven.link_classes[w->woven.spring_kind[n] & SPRING_CLASS].rest);
  }
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p)
    r->fastest = fmax(r->fastest, length_of(world_velocity(w, p)) * speed_unit(f));
}

static double made_of(const fixture *f) {
  const fray_energy_account a = fray_energy(f->w);
  const double net = (double)a.made[FRAY_ENERGY_LIMITS] - (double)a.lost[FRAY_ENERGY_LIMITS] +
                     (double)a.made[FRAY_ENERGY_CONTACT] - (double)a.lost[FRAY_ENERGY_CONTACT];
  return net / fmax(fabs((double)a.gravity), 1);
}

static drawn run(fixture *f, const char *text, uint32_t ticks) {
  drawn r = {0, 0, 0, 0};
  fixture_text(f, text);
  fray_energy_watch(f->w);
  for (uint32_t tick = 0; tick < ticks; ++tick) {
    const fray_output o = fixture_tick(f, &fixture_idle);
    r.faults |= o.faults;
    look(f, &r);
  }
  r.made = made_of(f);
  return r;
}

#define SHEET(more) \
  "scene s\nrate 1000 Hz\nsubsteps 4\ngravity 0 0 0 cm/s2\n" \
  "woven { warps 16 wefts 16 spacing 10 /cm orientation horizontal tear off drag 0 /s at 0 0 0 cm " more " }\n"
#define HELD "pin row top\npin row bottom\npin column left\npin column right\n"

/* A body goes 2 cm through a sheet of 1.5 cm that is held all around: at 1 m/s. */
static void a_body_in_the_way_passes(void) {
  static const struct {
    const char *name, *body;
  } bodies[] = {{"sphere", "sphere s { radius 0.3 cm "},
                {"box", "box s { size 0.6 0.6 0.6 cm "},
                {"mesh", "mesh s { obj \"tests/scenes/meshes/box.obj\" unit 0.3 cm "}};
  for (uint32_t n = 0; n < 3; ++n) {
    fixture_scoped f = {0};
    char text[1024];
    snprintf(text, sizeof text, SHEET("") HELD "%s move path { 0 s 0 0.5 0 cm 0.025 s 0 -2 0 cm } }\n", bodies[n].body);
    const drawn r = run(&f, text, 200);
    printf("figure overstretched_%s %.2f lengths (asked: 8), fastest %.2f m/s (asked: 4), faults 0x%03X\n",
           bodies[n].name, r.longest, r.fastest, (unsigned)r.faults);
    CHECK(r.longest <= 8 && r.fastest <= 4);
    CHECK_EQ_INT(r.faults & FRAY_FAULT_CONTACT_UNRESOLVED, FRAY_FAULT_CONTACT_UNRESOLVED);
  }
}

/* By half a spacing, which the sheet bears. */
static void a_body_that_presses_is_held(void) {
  fixture_scoped f = {0};
  const drawn r = run(&f, SHEET("") HELD "sphere s { radius 0.3 cm move path { 0 s 0 0.5 0 cm 0.1 s 0 0.25 0 cm } }\n", 200);
  figure("overstretched_pressed", r.longest, "lengths", "1.5");
  CHECK(r.longest < 1.5);
  CHECK_EQ_INT(r.faults, 0);
}

/* 200 times as heavy as the sheet. */
static void a_heavy_body_hangs(void) {
  fixture_scoped f = {0};
  const drawn r = run(&f, "scene s\nrate 1000 Hz\nsubsteps 4\n"
                          "woven { warps 8 wefts 12 spacing 10 /cm density 0.01 g/cm2 tear off at 0 0 0 cm }\npin row top\n"
                          "box b { size 0.8 0.2 0.2 cm at 0 -0.6 0 cm attach_within 0.08 cm move free mass 2 g }\n", 2000);
  double height = 0;
  for (uint32_t b = 0; b < f.facts.bodies; ++b)
    if (f.w->rigid.bodies[b].motion == FRAY_FREE) height = f.w->rigid.states[b].position[1] * 0x1p-24 * f.facts.lu_um * 1e-4;
  printf("figure overstretched_hung %.2f lengths (asked: 2), fastest %.2f m/s (asked: 1), body at %.2f cm, made %.3f of "
         "gravity's work (asked: 0), faults 0x%03X\n",
         r.longest, r.fastest, height, r.made, (unsigned)r.faults);
  CHECK(r.longest <= 2 && r.fastest <= 1 && height > -2 && r.made <= 0);
  CHECK_EQ_INT(r.faults, FRAY_FAULT_OVERSTRETCHED);
}

/* There is room for few contacts: what found none is deep in the sphere, which goes at 0.1 m/s, when it finds
 * one. */
static void what_was_inside_rises(void) {
  fixture_scoped f = {0};
  const drawn r = run(&f, "scene s\nrate 1000 Hz\nsubsteps 4\ngravity 0 0 0 cm/s2\n"
                          "woven { warps 16 wefts 16 spacing 10 /cm orientation horizontal thickness 0.02 cm drag 0 /s at 0 0 0 cm }\n"
                          "pin row top\npin row bottom\nlimits { contacts 32 tears_per_tick 30 }\n"
                          "sphere s { radius 0.3 cm move path { 0 s -1.5 0 0 cm 0.3 s 1.5 0 0 cm } }\n", 400);
  printf("figure overstretched_rises %.2f m/s (asked: 1), faults 0x%03X\n", r.fastest, (unsigned)r.faults);
  CHECK(r.fastest <= 1);
  CHECK_EQ_INT(r.faults, FRAY_FAULT_CONTACTS_FULL);
}

int main(void) {
  TEST(a_body_in_the_way_passes);
  TEST(a_body_that_presses_is_held);
  TEST(a_heavy_body_hangs);
  TEST(what_was_inside_rises);
  return test_end();
}
