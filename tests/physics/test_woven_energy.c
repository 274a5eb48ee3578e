/* SPDX-License-Identifier: Apache-2.0 */
/* No stage of woven cloth makes energy: of all rows of the ledger the net is at most a hundredth of what is turned
 * over. Each scene is one that random scenes found, with its cause. */
#include "tests/lib/test.h"
#include "tests/lib/energy_account.h"
#include "tests/lib/world_fixture.h"
#include "tests/wild/body_depth.h"

#if FRAY_ENERGY
static const char at_the_edge[] =
    "scene edge\nrate 1000 Hz\ngravity -630 960 -340 cm/s2\nsubsteps 2\n"
    "woven {\n warps 12\n wefts 8\n spacing 9 /cm\n density 0.5 g/cm2\n tear 4 5 %\n orientation horizontal\n"
    " drag 0.5 /s\n}\n";
/* The same with a stiffness: its elastic steps have an edge of their own. */
static const char stretch_at_the_edge[] =
    "scene edge_stretch\nrate 1000 Hz\ngravity -630 960 -340 cm/s2\nsubsteps 4\n"
    "woven {\n warps 12\n wefts 8\n spacing 9 /cm\n density 0.1 g/cm2\n tear off\n orientation horizontal\n"
    " drag 0.5 /s\n stretch 0.05 N\n}\n";
/* Bend and shear springs beside many elastic steps. */
static const char springs[] =
    "scene springs\nrate 500 Hz\nseed 988981677\nsubsteps 16\n"
    "woven {\n warps 9\n wefts 5\n spacing 17.4953 /cm\n weave twill 2/1\n thickness 0.01633 cm\n"
    " density 0.12183 g/cm2\n tear off\n orientation horizontal\n at 0 0.466 0 cm\n gather 16.3 %\n pleats 1\n"
    " drag 0.5 /s\n stretch 0.2298 N\n}\npin row top\n";
/* Yarns without friction slide over each other in sheared cloth. */
static const char slides[] =
    "scene slides\nrate 1000 Hz\nseed 694927969\nsubsteps 4\n"
    "woven {\n warps 11\n wefts 19\n spacing 10.4796 /cm\n thickness 0.01848 cm\n density 0.0731 g/cm2\n"
    " structural 838 g/s2\n bend 0.778 g/s2\n shear 3.719 g/s2\n tear 8.3 8.98 %\n orientation vertical\n"
    " drag 0 /s\n yarns on\n stretch 0.0655 N\n}\npin column left\npin column right\nslit warp 6 0 6\n";

/* It tears loose and falls on planes. */
static const char stretch_on_planes[] =
    "scene stretch_planes\nrate 1000 Hz\nseed 690153157\nsubsteps 8\n"
    "woven {\n warps 14\n wefts 20\n spacing 10.3976 /cm\n thickness 0.01539 cm\n density 0.01928 g/cm2\n"
    " tear 8.33 15.61 %\n orientation vertical\n gather 1.7 %\n pleats 2\n drag 0 /s\n stretch 0.0219 N\n}\n"
    "plane b0 {\n at 0 -1.0426 0 cm\n friction 0.02\n}\nplane b1 {\n at 0 -1.7036 0 cm\n friction 0.40\n}\n";

/* It falls to the edge of the world, which stops what yarns still approach with. */
static const char heaped[] =
    "scene heaped\nrate 1000 Hz\nsubsteps 4\n"
    "woven {\n warps 17\n wefts 8\n spacing 16.4414 /cm\n thickness 0.00886 cm\n density 0.02738 g/cm2\n bend 0.445 g/s2\n"
    " tear 3.73 6.45 %\n orientation vertical\n at 0 0.05 0 cm\n drag 0.5 /s\n damping 1 /s\n self_collision on\n}\n"
    "sphere s {\n radius 0.1349 cm\n friction 0.35\n attach_within 0.0145 cm\n at 0.0543 0.2003 0 cm\n}\n";

static const struct {
  const char *name, *text;
  uint32_t ticks;
} cases[] = {{"edge", at_the_edge, 800},
             {"edge_stretch", stretch_at_the_edge, 800},
             {"springs", springs, 200},
             {"slides", slides, 60},
             {"stretch_planes", stretch_on_planes, 150},
             {"heaped", heaped, 600}};

/* The largest net of a stage so far. */
static double largest_net(const fray_energy_account *a) {
  double most = 0;
  for (uint32_t n = 0; n < FRAY_ENERGY_STAGES; ++n) most = fmax(most, account_net(a, n));
  return most;
}

static void no_stage_makes_energy(void) {
  for (uint32_t n = 0; n < sizeof cases / sizeof cases[0]; ++n) {
    fixture_scoped f = {0};
    double turned = 0;
    double share = 0;
    fixture_text(&f, cases[n].text);
    fray_energy_watch(f.w);
    for (uint32_t tick = 0; tick < cases[n].ticks; ++tick) {
      (void)fixture_tick(&f, &fixture_idle);
      const fray_energy_account a = fray_energy(f.w);
      turned = fmax(turned, account_supplied(&a) + fabs((double)a.stored[FRAY_STORED_BODIES]));
      if (tick > 20) share = fmax(share, largest_net(&a) / turned);
    }
    printf("figure woven_%s_made %.2g of what is turned over (asked: at most 0.01), faults 0x%02X\n", cases[n].name,
           share, (unsigned)f.w->state->faults);
    CHECK(share <= 0.01);
  }
}

/* It hangs from one side and crumples: yarns that touch go back to where the tick began, and links pull at them. In
 * a heap that stands still what links give its yarns takes, so what holds it counts as one. */
static void crumpling_makes_none(void) {
  fixture_scoped f = {0};
  double turned = 0, made = 0, fastest = 0;
  fixture_text(&f, "scene crumpled\nrate 2000 Hz\nsubsteps 4\n"
                   "woven {\n warps 18\n wefts 13\n spacing 8.1574 /cm\n thickness 0.0041 cm\n density 0.47852 g/cm2\n"
                   " structural 28498 g/s2\n tear 4.8 10.83 %\n orientation vertical\n at 0.466 0 0 cm\n drag 0.5 /s\n"
                   " damping 10 /s\n yarns on\n self_collision on\n}\npin column right\n");
  fray_energy_watch(f.w);
  for (uint32_t tick = 0; tick < 800; ++tick) {
    (void)fixture_tick(&f, &fixture_idle);
    const fray_energy_account a = fray_energy(f.w);
    turned = fmax(turned, account_supplied(&a));
    fastest = fmax(fastest, (double)a.stored[FRAY_STORED_KINETIC]);
    made = fmax(made, account_net(&a, FRAY_ENERGY_LIMITS) + account_net(&a, FRAY_ENERGY_CONTACT) +
                          account_net(&a, FRAY_ENERGY_SLIP) + account_net(&a, FRAY_ENERGY_SELF_COLLISION));
  }
  printf("figure woven_crumpled_made %.2g of what is turned over (asked: at most 1e-4), in motion %.2g at most (asked: 1)\n",
         made / turned, fastest / turned);
  CHECK(made <= 1e-4 * turned && fastest <= turned);
}
#endif

/* Soft, light yarns have one elastic step a substep. */
static void one_step_a_substep_stops_at_bodies(void) {
  fixture_scoped f = {0};
  double deepest = 0;
  fixture_text(&f, "scene soft\nrate 2000 Hz\nsubsteps 16\nlimits {\n contacts 288\n}\nwoven {\n warps 12\n wefts 12\n spacing 6 /cm\n"
                   " orientation horizontal\n density 0.0115 g/cm2\n stretch 0.0203 N\n at 0 0.1 0 cm\n}\n"
                   "box b {\n size 0.9 0.4 0.5 cm\n rotate 30 deg about z\n at 0 -0.5 0 cm\n move path {"
                   " 0 s 0 -0.5 0 cm  0.2 s 0.2 -0.4 0 cm }\n}\nplane p {\n at 0 -1 0 cm\n}\n");
  CHECK_EQ_INT(f.w->woven.elastic_params->steps_bits, 0);
  body_depth *depth = body_depth_open(f.w);
  for (uint32_t tick = 0; tick < 1000; ++tick) {
    (void)fixture_tick(&f, &fixture_idle);
    deepest = fmax(deepest, body_depth_update(depth, f.w));
  }
  body_depth_close(depth);
  printf("figure woven_one_step_depth %.3f of the cloth's thickness (asked: at most 2)\n", deepest / f.facts.thickness);
  CHECK(deepest <= 2.0 * f.facts.thickness);
}

int main(void) {
#if FRAY_ENERGY
  TEST(no_stage_makes_energy);
  TEST(crumpling_makes_none);
#endif
  TEST(one_step_a_substep_stops_at_bodies);
  return test_end();
}
