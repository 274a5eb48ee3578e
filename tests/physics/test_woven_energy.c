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

/* A plate falls on it: a free body moves in the elastic steps, and its mesh is met in them. */
static const char stretch_under_plate[] =
    "scene stretch_plate\nrate 500 Hz\nsubsteps 4\n"
    "woven {\n warps 22\n wefts 8\n spacing 8.632 /cm\n weave plain\n thickness 0.00536 cm\n density 0.30896 g/cm2\n"
    " tear 8.96 15.75 %\n orientation horizontal\n at 0 0.393 0 cm\n drag 0.5 /s\n damping 30 /s\n stretch 0.6458 N\n}\npin row top\n"
    "mesh plate {\n obj \"tests/scenes/meshes/plate.obj\"\n unit 0.1715 cm\n friction 0.43\n at 0.4444 1.6936 -0.2318 cm\n"
    " move free\n mass 3.5011 g\n velocity -10.46 -11.26 -1.09 cm/s\n}\n";
/* More particles are at the boxes than contacts are kept for: what is left out in one substep is met in the next. */
static const char stretch_few[] =
    "scene stretch_few\nrate 500 Hz\nsubsteps 8\n"
    "woven {\n warps 8\n wefts 17\n spacing 18.4107 /cm\n weave twill 2/2\n thickness 0.00954 cm\n density 0.86449 g/cm2\n"
    " shear 0.586 g/s2\n tear 8.31 18.56 %\n orientation vertical\n drag 0.5 /s\n stretch 0.0242 N\n stretch_damping 26.4 us\n}\n"
    "box b0 {\n size 0.1105 0.1390 0.0339 cm\n friction 0.55\n move path { 0 s 0.0198 -0.0533 0.3049 cm"
    "  0.306 s 0.3498 0.3561 0.4912 cm  0.606 s 0.5158 -0.0523 0.1062 cm  0.913 s 0.1605 -0.2634 0.0847 cm"
    "  1.471 s 0.0966 0.1530 -0.1855 cm }\n}\n"
    "box b3 {\n size 0.5005 0.2546 0.2583 cm\n rotate 162.4 deg about y\n friction 0.66\n attach_within 0.0220 cm\n"
    " at -0.1166 -0.2875 0 cm\n}\nlimits { contacts 5 }\nslit warp 5 0 13\n";
/* What hangs at a sphere is nearer to it than a thickness, and is led out. */
static const char stretch_overlaps[] =
    "scene stretch_overlaps\nrate 240 Hz\nsubsteps 16\n"
    "woven {\n warps 16\n wefts 7\n spacing 13.1452 /cm\n weave plain\n thickness 0.02061 cm\n density 0.05356 g/cm2\n"
    " tear 7.04 17.53 %\n orientation horizontal\n at -0.331 -0.408 0 cm\n drag 0 /s\n stretch 0.8018 N\n"
    " stretch_damping 1.6 us\n}\n"
    "sphere b0 {\n radius 0.196 cm\n friction 0.98\n attach_within 0.0131 cm\n"
    " move path { 0 s 0.2202 -0.4077 0.0197 cm  0.323 s 0.3643 -0.2969 0.3385 cm }\n}\n";
/* It is slit: yarns are apart where they split, and what they are apart by fades. */
static const char stretch_slit[] =
    "scene stretch_slit\nrate 1000 Hz\nsubsteps 8\n"
    "woven {\n warps 6\n wefts 23\n spacing 19.7001 /cm\n thickness 0.00395 cm\n density 0.00326 g/cm2\n shear 2.143 g/s2\n"
    " tear 6.66 12.91 %\n orientation horizontal\n drag 0.5 /s\n damping 1 /s\n yarns on\n stretch 0.0325 N\n}\n"
    "pin column right\nslit warp 1 0 10\n";
/* Free bodies fall through it, past a mesh: forces drive particles at other faces than those on their paths. */
static const char stretch_faces[] =
    "scene stretch_faces\nrate 1000 Hz\nsubsteps 16\n"
    "woven {\n warps 22\n wefts 10\n spacing 18.7584 /cm\n thickness 0.01330 cm\n density 0.02622 g/cm2\n bend 1.374 g/s2\n"
    " shear 2.368 g/s2\n tear 7.69 8.35 %\n orientation vertical\n at 0 -0.367 0 cm\n drag 2 /s\n stretch 0.8750 N\n"
    " stretch_damping 5.1 us\n}\n"
    "capsule b0 {\n length 0.1511 cm\n radius 0.0481 cm\n rotate -108.6 deg about y\n friction 0.29\n attach_within 0.0524 cm\n"
    " at -0.0452 -0.2920 0 cm\n move free\n mass 0.2718 g\n}\n"
    "box b1 {\n size 0.0826 0.1133 0.0229 cm\n rotate -82.5 deg about z\n friction 0.21\n at -0.3188 -0.4964 0.2039 cm\n"
    " move free\n mass 0.2398 g\n}\n"
    "mesh b2 {\n obj \"tests/scenes/meshes/plate.obj\"\n unit 0.0898 cm\n sharp 60 deg\n friction 0.79\n"
    " move path { 0 s 0.2255 -0.3346 0.7910 cm  0.279 s 0.4961 -0.1672 0.9808 cm }\n}\n"
    "mesh b3 {\n obj \"tests/scenes/meshes/box.obj\"\n unit 0.0538 cm\n friction 0.01\n at 0.4261 -0.2860 0.3587 cm\n"
    " move free\n mass 1.5536 g\n velocity -21.15 -2.04 -8.82 cm/s\n}\nlimits { tears_per_tick 1 }\nslit warp 18 0 1\n";
/* A hammer draws the sheet: where a face stops a particle the others draw it through that within a substep. */
static const char stretch_hooked[] =
    "scene stretch_hooked\nrate 2000 Hz\nsubsteps 4\n"
    "woven {\n warps 10\n wefts 14\n spacing 11.3164 /cm\n thickness 0.01149 cm\n density 0.33732 g/cm2\n bend 0.139 g/s2\n"
    " shear 49.803 g/s2\n tear off\n orientation horizontal\n drag 0 /s\n damping 30 /s\n yarns on\n stretch 0.5227 N\n"
    " stretch_damping 28.6 us\n}\npin column left\n"
    "mesh b {\n obj \"tests/scenes/meshes/hammer.obj\"\n unit 0.1069 cm\n rotate 52.9 deg about y\n friction 0.74\n"
    " move path { 0 s 0.1525 0.6360 0.0885 cm  0.201 s 0.1525 0.6360 0.0885 cm  0.251 s -0.5053 0.5322 0.1341 cm\n"
    "  0.3 s -1.1631 0.4286 0.1795 cm  0.35 s -1.4539 0.3248 0.2251 cm  0.401 s -0.7961 0.2212 0.2707 cm\n"
    "  0.451 s -0.1383 0.1174 0.3161 cm  0.5 s -0.2145 0.0136 0.3617 cm  0.55 s -0.8723 -0.09 0.4073 cm\n"
    "  0.6 s -1.5303 -0.1762 0.4527 cm  0.65 s -1.0869 -0.0726 0.4983 cm }\n}\nlimits { contacts 100 }\n";
/* A sheet begins nearer to a mesh below it than its thickness. */
static const char stretch_beside[] =
    "scene stretch_beside\nrate 1000 Hz\nsubsteps 16\n"
    "woven {\n warps 16\n wefts 12\n spacing 12 /cm\n thickness 0.02 cm\n density 0.1 g/cm2\n tear off\n orientation horizontal\n"
    " drag 0 /s\n stretch 0.5 N\n}\npin row top\npin row bottom\n"
    "mesh b {\n obj \"tests/scenes/meshes/box.obj\"\n unit 0.2 cm\n at 0 -0.11 0 cm\n}\n";
/* A free capsule draws what holds it to many times its length. */
static const char stretch_drawn[] =
    "scene stretch_drawn\nrate 2000 Hz\nsubsteps 16\n"
    "woven {\n warps 3\n wefts 13\n spacing 15.9977 /cm\n thickness 0.00552 cm\n density 0.29751 g/cm2\n bend 0.125 g/s2\n"
    " shear 0.584 g/s2\n tear off\n orientation horizontal\n at 0 0 0.451 cm\n drag 0 /s\n stretch 0.0755 N\n}\n"
    "pin column left\npin column right\ncapsule b1 {\n length 0.0433 cm\n radius 0.0185 cm\n friction 0.92\n attach_within 0.0558 cm\n"
    " at 0.0481 0 0.1786 cm\n move free\n mass 8.6298 g\n velocity -13.14 0 318.28 cm/s\n}\nlimits { contacts 5 }\n";

static const struct {
  const char *name, *text;
  uint32_t ticks;
} cases[] = {{"edge", at_the_edge, 800},
             {"edge_stretch", stretch_at_the_edge, 800},
             {"springs", springs, 200},
             {"slides", slides, 60},
             {"stretch_planes", stretch_on_planes, 150},
             {"stretch_plate", stretch_under_plate, 100},
             {"stretch_drawn", stretch_drawn, 100},
             {"stretch_few", stretch_few, 700},
             {"stretch_overlaps", stretch_overlaps, 30},
             {"stretch_faces", stretch_faces, 50},
             {"stretch_hooked", stretch_hooked, 1300},
             {"stretch_beside", stretch_beside, 40},
             {"heaped", heaped, 600}};

/* The largest net of a stage so far. */
static double largest_net(const fray_energy_account *a) {
  double most = 0;
  for (uint32_t n = 0; n < FRAY_ENERGY_STAGES; ++n) most = fmax(most, account_net(a, n));
  return most;
}

/* The largest net of a stage behind the first ticks, by what is turned over. */
static double largest_share(fixture *f, uint32_t ticks) {
  double turned = 0;
  double share = 0;
  fray_energy_watch(f->w);
  for (uint32_t tick = 0; tick < ticks; ++tick) {
    (void)fixture_tick(f, &fixture_idle);
    const fray_energy_account a = fray_energy(f->w);
    turned = fmax(turned, account_supplied(&a) + fabs((double)a.stored[FRAY_STORED_BODIES]));
    if (tick > 20) share = fmax(share, largest_net(&a) / turned);
  }
  return share;
}

static void no_stage_makes_energy(void) {
  for (uint32_t n = 0; n < sizeof cases / sizeof cases[0]; ++n) {
    fixture_scoped f = {0};
    fixture_text(&f, cases[n].text);
    const double share = largest_share(&f, cases[n].ticks);
    printf("figure woven_%s_made %.2g of what is turned over (asked: at most 0.01), faults 0x%02X\n", cases[n].name,
           share, (unsigned)f.w->state->faults);
    CHECK(share <= 0.01);
  }
}

/* Its springs have acted when a body gets the velocity of its path. */
static void a_body_that_sets_off_works(void) {
  fixture_scoped f = {0};
  fixture_text(&f, "scene sets_off\nrate 240 Hz\ngravity 0 0 0 cm/s2\nsubsteps 6\n"
                   "woven {\n warps 12\n wefts 9\n spacing 8 /cm\n density 0.01 g/cm2\n bend 0.5 g/s2\n shear 1 g/s2\n tear off\n"
                   " orientation horizontal\n}\n"
                   "box b {\n size 0.3 0.3 0.3 cm\n attach_within 0 cm\n move path { 0 s 0 0 0 cm  0.1 s 0.6 0.9 0 cm }\n}\n");
  fray_energy_watch(f.w);
  (void)fixture_tick(&f, &fixture_idle);
  const fray_energy_account a = fray_energy(f.w);
  const double share = fabs(account_net(&a, FRAY_ENERGY_STEPS)) / account_supplied(&a);
  printf("figure woven_sets_off_steps %.2g of the body's work (asked: at most 1e-5)\n", share);
  CHECK(share <= 1e-5);
}

static void what_fades_makes_none(void) {
  fixture_scoped f = {0};
  double turned = 0, made = 0;
  fixture_text(&f, stretch_slit);
  fray_energy_watch(f.w);
  for (uint32_t tick = 0; tick < 100; ++tick) {
    (void)fixture_tick(&f, &fixture_idle);
    const fray_energy_account a = fray_energy(f.w);
    turned = fmax(turned, account_supplied(&a));
    made = fmax(made, account_net(&a, FRAY_ENERGY_TEARS));
  }
  printf("figure woven_fades_made %.2g of what is turned over (asked: at most 1e-4), %u crossings split\n", made / turned,
         (unsigned)f.w->woven.yarn_counts->split);
  CHECK(made <= 1e-4 * turned && f.w->woven.yarn_counts->split > 10);
}

/* In longer steps the same force is a larger impulse; what is held of it is no energy. */
static void a_force_that_is_held_is_said(void) {
  static const struct {
    const char *substeps;
    uint32_t fault;
  } tries[] = {{"substeps 1 ", FRAY_FAULT_OVERSTRETCHED}, {"substeps 16", 0}};
  for (uint32_t n = 0; n < 2; ++n) {
    fixture_scoped f = {0};
    char text[sizeof stretch_drawn];
    memcpy(text, stretch_drawn, sizeof text);
    memcpy(strstr(text, tries[1].substeps), tries[n].substeps, strlen(tries[n].substeps));
    fixture_text(&f, text);
    const double share = largest_share(&f, 100);
    CHECK_EQ_INT(f.w->state->faults & FRAY_FAULT_OVERSTRETCHED, tries[n].fault);
    CHECK(share <= 0.01);
  }
}

/* It hangs from one side and crumples: yarns that touch go back to where the tick began, and links pull at them. */
static void print_crumpled(fixture *f, int32_t substeps, const char *tear) {
  fixture_print(f, "scene crumpled\nrate 2000 Hz\nsubsteps %d\n"
                   "woven {\n warps 18\n wefts 13\n spacing 8.1574 /cm\n thickness 0.0041 cm\n density 0.47852 g/cm2\n"
                   " structural 28498 g/s2\n tear %s\n orientation vertical\n at 0.466 0 0 cm\n drag 0.5 /s\n"
                   " damping 10 /s\n yarns on\n self_collision on\n}\npin column right\n", substeps, tear);
}

/* In a heap that stands still what links give its yarns takes, so what holds it counts as one. */
static void crumpling_makes_none(void) {
  fixture_scoped f = {0};
  double turned = 0, made = 0, fastest = 0;
  print_crumpled(&f, 4, "4.8 10.83 %");
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

static double longest_link(const fray_world *w) {
  double most = 0;
  for (uint32_t n = 0; n < (uint32_t)w->params->links; ++n) {
    if (w->woven.spring_kind[n] == SPRING_DEAD) continue;
    const vec3 d = vec_sub(world_position(w, w->woven.spring_j[n]), world_position(w, w->woven.spring_i[n]));
    const double rest = w->woven.link_classes[w->woven.spring_kind[n] & SPRING_CLASS].rest;
    most = fmax(most, sqrt((double)vec_squared(d)) / rest);
  }
  return most;
}

/* The way back of a tick is 32 of a substep. */
static void crumpling_draws_none(void) {
  fixture_scoped f = {0};
  double most = 0;
  print_crumpled(&f, 32, "off");
  for (uint32_t tick = 0; tick < 400; ++tick) {
    (void)fixture_tick(&f, &fixture_idle);
    most = fmax(most, longest_link(f.w) - 1);
  }
  printf("figure woven_crumpled_strain %.1f %% (asked: at most 5)\n", 100 * most);
  CHECK(most <= 0.05);
}

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
  TEST(a_body_that_sets_off_works);
  TEST(what_fades_makes_none);
  TEST(a_force_that_is_held_is_said);
  TEST(crumpling_makes_none);
#endif
  TEST(crumpling_draws_none);
  TEST(one_step_a_substep_stops_at_bodies);
  return test_end();
}
