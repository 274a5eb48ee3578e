/* SPDX-License-Identifier: Apache-2.0 */
/* Handles: what the device feels of a weight, of another hand, of noise and of a tear; where the
 * proxy is; the energy of it all; images with and without them. */
#include "rt/base/bytes.h"
#include "tests/lib/energy_account.h"
#include "tests/lib/held_cloth.h"
#include "tests/lib/test.h"

static const int16_t nowhere[FRAY_HANDS][3];

/* 10 g on a strip of 2 x 6 cm, 200 g/m2. */
static void open_weight(fixture *f, const char *reserve) {
  fixture_print(f,
                "scene weight\nsettle 2 s\nmembrane {\n columns 2\n rows 6\n cell 1 cm\n material "
                "cloth\n drag 2 /s\n}\n"
                "material cloth {\n density 200 g/m2\n isotropic 1000 N/m 0.3\n}\n"
                "hands {\n energy_reserve %s\n}\n"
                "box holder {\n size 2.4 0.2 0.2 cm\n at 0 3 0 cm\n move hand left\n mass 5 g\n "
                "attach_within 0 cm\n}\n"
                "box weight {\n size 2.4 0.2 0.2 cm\n at 0 -3 0 cm\n move free\n mass 10 g\n "
                "attach_within 0 cm\n}\n",
                reserve);
}

static void a_device_feels_the_weight(void) {
  fixture_scoped f = {0};
  double force[3] = {0, 0, 0};
  enum { REST = 4000, MEAN = 1000 };
  open_weight(&f, "10 mJ");
  (void)fixture_start_hands(&f, REST);
  for (uint32_t tick = 0; tick < MEAN; ++tick) {
    static const int32_t origin[FRAY_HANDS][3];
    const fray_input input = fixture_poses(&f, origin, tick);
    const fray_output out = fixture_tick(&f, &input);
    for (uint32_t n = 0; n < 3; ++n) force[n] += out.force_unlimited[0][n] * 0.5 / MEAN;
  }
  double strip = 0; /* of the free vertices: the weight of attached ones is their body's */
  for (uint32_t p = particles_attached(f.w); p < f.w->p.count; ++p)
    strip += (double)f.w->trimesh.mass[p] / f.w->membrane.constants->mass_unit *
             fixture_mass_g(&f) * 9.81;
  figure("handle_weight", -force[1] - strip, "mN", "98.1 within 1 %");
  figure("handle_strip", strip, "mN", "printed");
  CHECK(fabs(-force[1] - strip - 98.1) <= 0.981);
  CHECK(fabs(force[0]) <= 0.5 && fabs(force[2]) <= 0.5);
}

/* Lowered by 20 mm, the weight gives 2 mJ: all of it with a reserve of more, else no more than the
 * reserve. */
static void the_net_holds_energy_back(void) {
  static const char *const reserves[] = {"10 mJ", "1 mJ", "0 J"};
  static const int64_t reserve_nj[] = {10000000, 1000000, 0};
  for (uint32_t r = 0; r < 3; ++r) {
    fixture_scoped f = {0};
    fray_handle handle;
    int64_t most = INT64_MIN;
    open_weight(&f, reserves[r]);
    (void)fixture_start_hands(&f, 1000);
    for (uint32_t tick = 0; tick < 2000; ++tick) {
      const int32_t at[FRAY_HANDS][3] = {{0, -5 * ((int32_t)tick + 1), 0}, {0, 0, 0}};
      const fray_input input = fixture_poses(&f, at, tick);
      (void)fixture_tick(&f, &input);
      CHECK(fray_view_handle(f.w, 0, &handle) == 1);
      most = handle.given_nj > most ? handle.given_nj : most;
    }
    printf("figure handle_net reserve %s: given %.6g uJ, taken %.6g uJ\n", reserves[r],
           (double)handle.given_nj * 1e-3, (double)handle.taken_nj * 1e-3);
    CHECK_EQ_INT(handle.given_most_nj, most > 0 ? most : 0);
    CHECK(most <= reserve_nj[r] + 2000);
    CHECK(r == 0 ? handle.taken_nj == 0 && handle.given_nj > 1900000 : handle.taken_nj > 0);
  }
}

/* Draws a cloth with arms of 0.3 kg and 500 N/m. */
typedef struct {
  double peak, off,
      step; /* N: largest force, largest sum of both hands, largest change in a tick */
  uint32_t tears;
} drawn;

static drawn draw_apart(fixture *f, double metres, uint32_t ticks) {
  drawn d = {0, 0, 0, 0};
  arm arms[FRAY_HANDS] = {arm_make(0.3, 500, 2), arm_make(0.3, 500, 2)};
  int16_t poses[FRAY_HANDS][3] = {{0}};
  int16_t before[FRAY_HANDS][3] = {{0}};
  (void)fixture_start_hands(f, 300);
  for (uint32_t tick = 0; tick < ticks; ++tick) {
    const double way = metres * fmin(1, 1.25 * tick / ticks);
    const double goals[FRAY_HANDS][3] = {{-way, 0, 0}, {way, 0, 0}};
    const fray_output out = held_cloth_tick(f, arms, poses, goals, tick);
    d.tears = out.tears_total;
    for (uint32_t h = 0; h < FRAY_HANDS; ++h)
      for (uint32_t n = 0; n < 3; ++n) {
        d.peak = fmax(d.peak, fabs(out.force[h][n] * 0.0005));
        d.step = fmax(d.step, fabs((out.force[h][n] - before[h][n]) * 0.0005));
        before[h][n] = out.force[h][n];
      }
    d.off = fmax(d.off, fabs((out.force[0][0] + out.force[1][0]) * 0.0005));
  }
  return d;
}

static void two_hands_feel_opposite_forces(void) {
  fixture_scoped f = {0};
  held_cloth_open(&f, 1000, "", "", "");
  const drawn d = draw_apart(&f, 0.01, 1000);
  figure("handle_peak", d.peak, "N", "above 1");
  figure("handle_sum_of_both", 100 * d.off / d.peak, "% of the peak", "at most 10");
  figure("handle_step", d.step, "N/ms", "at most 0.8");
  CHECK(d.peak > 1);
  CHECK(d.off <= 0.1 * d.peak);
  CHECK(d.step <= 0.8);
}

/* A cloth that snaps at 2.5 N throws the handle; the rate limit of the scene keeps that from the
 * hand. */
static void a_snap_keeps_to_the_rate_limit(void) {
  for (int limited = 0; limited < 2; ++limited) {
    fixture_scoped f = {0};
    held_cloth_open(&f, 1000, " tear 60 N/m\n tear_interval 2 ms\n",
                    limited ? " force_rate 0.8 N/ms\n" : "", "");
    const drawn d = draw_apart(&f, 0.02, 2000);
    figure(limited ? "handle_torn_peak_limited" : "handle_torn_peak", d.peak, "N", "above 1");
    figure(limited ? "handle_torn_step_limited" : "handle_torn_step", d.step, "N/ms",
           limited ? "at most 0.8" : "printed");
    CHECK(d.tears > 0 && d.peak > 1);
    CHECK(d.step <= (limited ? 0.8 : 4));
  }
}

static void a_hand_at_rest_feels_no_noise(void) {
  fixture_scoped f = {0};
  enum { REST = 3000, MEAN = 2000 };
  double sum[FRAY_HANDS][3] = {{0}};
  double squares[FRAY_HANDS][3] = {{0}};
  double worst = 0;
  held_cloth_open(&f, 2000, "", "", "");
  arm arms[FRAY_HANDS] = {arm_make(0.3, 500, 2), arm_make(0.3, 500, 2)};
  int16_t poses[FRAY_HANDS][3] = {{0}};
  const double goals[FRAY_HANDS][3] = {{-0.0051, 0.0013, 0.0007}, {0.0047, 0.0003, -0.0011}};
  (void)fixture_start_hands(&f, 300);
  for (uint32_t tick = 0; tick < REST + MEAN; ++tick) {
    const fray_output out = held_cloth_tick(&f, arms, poses, goals, tick);
    for (uint32_t n = 0; n < 3 * FRAY_HANDS && tick >= REST; ++n) {
      const double mn = out.force[n / 3][n % 3] * 0.5;
      sum[n / 3][n % 3] += mn / MEAN;
      squares[n / 3][n % 3] += mn * mn / MEAN;
    }
  }
  for (uint32_t n = 0; n < 3 * FRAY_HANDS; ++n)
    worst = fmax(worst, squares[n / 3][n % 3] - sum[n / 3][n % 3] * sum[n / 3][n % 3]);
  figure("handle_noise", sqrt(fmax(worst, 0)), "mN rms", "at most 10");
  CHECK(sqrt(fmax(worst, 0)) <= 10);
}

static fray_output stay(fixture *f, const int16_t at[FRAY_HANDS][3], uint32_t command,
                        uint32_t ticks) {
  fray_output out;
  memset(&out, 0, sizeof out);
  for (uint32_t tick = 0; tick < ticks; ++tick) {
    int32_t poses[FRAY_HANDS][3];
    for (uint32_t n = 0; n < 3 * FRAY_HANDS; ++n) poses[n / 3][n % 3] = at[n / 3][n % 3];
    fray_input input = fixture_poses(f, (const int32_t(*)[3])poses, tick);
    if (tick == 0) input.command = (uint8_t)command;
    out = fixture_tick(f, &input);
  }
  return out;
}

static double proxy_cm(const fixture *f, uint32_t hand, uint32_t axis) {
  fray_handle handle;
  CHECK(fray_view_handle(f->w, hand, &handle) == 1);
  return handle.proxy[axis] * 0x1p-24 * fixture_lu_cm(f);
}

/* 1 mm of the device along x, by 2, turned by 90 degrees about y: x goes to -z. */
static void a_proxy_is_an_affine_function_of_the_device(void) {
  static const int16_t moved[FRAY_HANDS][3] = {{700, 200, 0}, {0, 0, 0}};
  static const int16_t from[FRAY_HANDS][3] = {{200, 200, 0}, {0, 0, 0}};
  for (int placed = 0; placed < 2; ++placed) {
    fixture_scoped f = {0};
    held_cloth_open(&f, 1000, "", "",
                    placed ? " hand_scale 2\n hand_rotate 90 deg about y\n hand_offset 0 0 1 cm\n"
                           : " hand_scale 2\n hand_rotate 90 deg about y\n");
    (void)stay(&f, from, FRAY_COMMAND_START, 200);
    CHECK(fabs(proxy_cm(&f, 0, 0) - (placed ? 0 : -3)) <= 1e-6);
    (void)stay(&f, moved, FRAY_COMMAND_NONE, 200);
    CHECK(fabs(proxy_cm(&f, 0, 0) - (placed ? 0 : -3)) <= 1e-6);
    CHECK(fabs(proxy_cm(&f, 0, 1) - (placed ? 0.08 : 0)) <= 1e-6);
    CHECK(fabs(proxy_cm(&f, 0, 2) - (placed ? 0.72 : -0.2)) <= 1e-6);
  }
}

/* START moves nothing; SAFE lets no force out, and the proxy stays where it is. */
static void states_hold(void) {
  static const int16_t far[FRAY_HANDS][3] = {{-3000, 400, 90}, {2000, 0, -500}};
  static const int16_t drawn_to[FRAY_HANDS][3] = {{-5500, 400, 90}, {4500, 0, -500}};
  fixture_scoped f = {0};
  held_cloth_open(&f, 1000, "", "", "");
  fray_output out = stay(&f, far, FRAY_COMMAND_START, 200);
  CHECK_EQ_INT(out.state, FRAY_OPERATIONAL);
  CHECK(fabs(proxy_cm(&f, 0, 0) + 3) <= 1e-6 && out.force[0][0] == 0);
  out = stay(&f, drawn_to, FRAY_COMMAND_NONE, 400);
  CHECK(out.force[0][0] > 1000 && out.force[1][0] < -1000);
  const double at = proxy_cm(&f, 0, 0);
  out = stay(&f, nowhere, FRAY_COMMAND_HALT, 20);
  CHECK_EQ_INT(out.state, FRAY_SAFE);
  for (uint32_t n = 0; n < 3 * FRAY_HANDS; ++n) CHECK_EQ_INT(out.force[n / 3][n % 3], 0);
  CHECK(proxy_cm(&f, 0, 0) == at);
}

/* What the hands worked is stored, or lost in the damper: no stage makes a part of it. */
static void the_ledger_closes(void) {
  fixture_scoped f = {0};
  held_cloth_open(&f, 1000, "", "", "");
  arm arms[FRAY_HANDS] = {arm_make(0.3, 500, 2), arm_make(0.3, 500, 2)};
  int16_t poses[FRAY_HANDS][3] = {{0}};
  int64_t most_open = 0;
  (void)fixture_start_hands(&f, 300);
  fray_energy_watch(f.w);
  for (uint32_t tick = 0; tick < 1500; ++tick) {
    const double way = tick % 500 < 250 ? 0.01 : 0;
    const double goals[FRAY_HANDS][3] = {{-way, way / 2, 0}, {way, 0, way / 2}};
    (void)held_cloth_tick(&f, arms, poses, goals, tick);
    const fray_energy_account a = fray_energy(f.w);
    int64_t open = -a.begun;
    for (uint32_t n = 0; n < FRAY_ENERGY_STORES; ++n) open += a.stored[n];
    for (uint32_t n = 0; n < FRAY_ENERGY_SUPPLIES; ++n) open -= a.supplied[n];
    for (uint32_t n = 0; n < FRAY_ENERGY_STAGES; ++n) open -= a.made[n] - a.lost[n];
    most_open = open < 0           ? (-open > most_open ? -open : most_open)
                : open > most_open ? open
                                   : most_open;
  }
  const fray_energy_account a = fray_energy(f.w);
  const double unit = 0x1p-40 * f.facts.particle_mass_ng * 1e-24 *
                      pow((double)f.facts.lu_um * f.facts.rate_hz * f.facts.substeps, 2);
  const double supplied = (double)a.supplied[FRAY_SUPPLIED_HANDS] * unit;
  figure("handle_hands_supplied", supplied, "J", "above 0");
  figure("handle_springs_store", (double)a.stored[FRAY_STORED_HANDLES] * unit, "J", "above 0");
  figure("handle_damping_lost", (double)a.lost[FRAY_ENERGY_DAMPING] * unit, "J", "above 0");
  const double net = (double)(a.made[FRAY_ENERGY_STEPS] - a.lost[FRAY_ENERGY_STEPS]) * unit;
  figure("handle_steps_net", net, "J", "within 1e-4 of it");
  CHECK(most_open <= FRAY_ENERGY_ROUNDING);
  CHECK(supplied > 0 && a.stored[FRAY_STORED_HANDLES] > 0);
  CHECK(a.lost[FRAY_ENERGY_DAMPING] > 0);
  figure("handle_damping_made", (double)a.made[FRAY_ENERGY_DAMPING] * unit, "J",
         "below 1e-4 of it");
  CHECK((double)a.made[FRAY_ENERGY_DAMPING] * unit <= 1e-4 * supplied);
  CHECK(fabs(net) <= 1e-4 * supplied);
}

/* Saved in the middle of a motion and opened, a world goes on with the same hashes. */
/* A hand draws a pinned sheet against its strain limit and stays there: what a damper takes in a step follows from
 * all impulses of that step. */
static void a_held_limit_makes_none(void) {
  fixture_scoped f = {0};
  double turned = 0, most = 0;
  fixture_text(&f, "scene limit\nmembrane {\n columns 5\n rows 2\n cell 2.4745 cm\n material rag\n orientation horizontal\n strain_limit 14 %\n}\n"
                   "material rag {\n density 48.3 g/m2\n young 8.76 MPa\n}\npin row top\n"
                   "sphere b {\n radius 1 cm\n attach_within 0.8377 cm\n at -1.7417 0 0.971 cm\n move hand left\n mass 24.78 g\n"
                   " coupling 2231 N/m\n}\n");
  (void)fixture_start_hands(&f, 100);
  fray_energy_watch(f.w);
  for (uint32_t tick = 0; tick < 1000; ++tick) {
    const int32_t up = 100 * ((int32_t)tick + 1);
    const int32_t at[FRAY_HANDS][3] = {{0, up < 15000 ? up : 15000, 0}, {0, 0, 0}};
    const fray_input input = fixture_poses(&f, at, tick);
    (void)fixture_tick(&f, &input);
    const fray_energy_account a = fray_energy(f.w);
    turned = fmax(turned, account_supplied(&a));
    most = fmax(most, account_net(&a, FRAY_ENERGY_STEPS));
  }
  printf("figure handle_limit_made %.3g of what was supplied (asked: at most 1e-4)\n", most / turned);
  CHECK(most <= 1e-4 * turned);
}

static void a_save_goes_on(void) {
  fixture_scoped f = {0};
  fixture_scoped copy = {0};
  held_cloth_open(&f, 1000, "", "", "");
  (void)fixture_start_hands(&f, 200);
  for (uint32_t tick = 0; tick < 200; ++tick) {
    const int32_t at[FRAY_HANDS][3] = {{(int32_t)tick * -7, 0, 3},
                                       {(int32_t)tick * 9, (int32_t)tick, 0}};
    const fray_input input = fixture_poses(&f, at, tick);
    const fray_output a = fixture_tick(&f, &input);
    if (tick == 100) fixture_copy(&copy, &f);
    if (tick <= 100) continue;
    const fray_output b = fixture_tick(&copy, &input);
    CHECK(a.hash == b.hash && memcmp(a.force, b.force, sizeof a.force) == 0);
  }
}

/* Word 1 of a header is its version: 3.1 for a world with handles, 3.0 for others; and a bit of
 * word 4. */
static void only_images_with_handles_are_newer(void) {
  fixture_scoped f = {0};
  fixture_scoped plain = {0};
  fray_handle handle;
  held_cloth_open(&f, 1000, "", "", "");
  fixture_file(&plain, "tests/scenes/flag.scene", NULL);
  CHECK_EQ_INT(bytes_load32(f.image + 4 * IMAGE_VERSION_WORD), 3 << 16 | 1);
  CHECK_EQ_INT(bytes_load32(plain.image + 4 * IMAGE_VERSION_WORD), 3 << 16);
  CHECK(fray_view_handle(plain.w, 0, &handle) == 0);
}

/* By the compiler, with what the steps would bear; and by the loader. */
static void a_coupling_that_steps_cannot_bear_is_refused(void) {
  fixture_scoped f = {0};
  fixture_scoped stiff = {0};
  scene_error error;
  const char *text = "scene s\nmembrane {\n columns 2\n rows 2\n cell 1 cm\n material thin\n}\n"
                     "material thin {\n density 20 g/m2\n isotropic 1 N/m 0.3\n}\n"
                     "box b {\n size 2.4 0.2 0.2 cm\n at 0 1 0 cm\n move hand left\n mass 0.1 g\n"
                     " coupling 10 N/mm\n attach_within 0 cm\n}\n";
  CHECK(fixture_compile(&stiff, "test", text, &error) == 0);
  CHECK(strstr(error.message, "with this mass and") != NULL);
  held_cloth_open(&f, 1000, "", "", "");
  handle_params *k = (handle_params *)(uintptr_t)f.w->handles.constants;
  fray_error refused = {FRAY_OK, 0, 0, ""};
  const handle_params good = k[0];
  k[0].spring = INT32_MAX;
  CHECK(image_validate(f.w, &refused) == FRAY_BAD_FIELD && refused.section == IMAGE_HANDLE_PARAMS);
  k[0] = good;
  k[0].damping = INT32_MAX;
  CHECK(image_validate(f.w, &refused) == FRAY_BAD_FIELD && refused.section == IMAGE_HANDLE_PARAMS);
  k[0] = good;
  k[0].body = k[1].body;
  CHECK(image_validate(f.w, &refused) == FRAY_BAD_FIELD && refused.section == IMAGE_HANDLE_PARAMS);
  k[0] = good;
  CHECK(image_validate(f.w, &refused) == FRAY_OK);
}

/* Cloth settles before any hand acts: a handle that holds nothing stays where it is. */
static void a_handle_waits_while_cloth_settles(void) {
  fixture_scoped f = {0};
  fixture_text(&f, "scene waits\nsettle 0.1 s\nmembrane {\n columns 2\n rows 2\n cell 1 cm\n material denim\n}\npin row top\n"
                   "sphere b {\n radius 1 cm\n at 0 0 4 cm\n move hand left\n mass 5 g\n}\n");
  CHECK(world_has_handles(f.w));
  CHECK_EQ_INT(f.w->handles.constants[0].body, 0);
}

int main(void) {
  TEST(a_device_feels_the_weight);
  TEST(the_net_holds_energy_back);
  TEST(two_hands_feel_opposite_forces);
  TEST(a_snap_keeps_to_the_rate_limit);
  TEST(a_hand_at_rest_feels_no_noise);
  TEST(a_proxy_is_an_affine_function_of_the_device);
  TEST(states_hold);
  TEST(the_ledger_closes);
  TEST(a_held_limit_makes_none);
  TEST(a_save_goes_on);
  TEST(only_images_with_handles_are_newer);
  TEST(a_coupling_that_steps_cannot_bear_is_refused);
  TEST(a_handle_waits_while_cloth_settles);
  return test_end();
}
