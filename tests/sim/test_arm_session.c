/* SPDX-License-Identifier: Apache-2.0 */
/* The loop of two simulated arms through the bus, in virtual time: POSE frames to the port, ticks, FORCE frames
 * back. A cloth between two handles is drawn, shaken and let go; what the arms get is what they gave, or less. */
#include "rt/wire/port.h"
#include "tests/lib/held_cloth.h"
#include "tests/lib/test.h"
#include "tools/bus/simulated_device.h"

enum { SECONDS = 4 };

static const char script_text[] = "duration 4 s\narm %s %u\ncommand 0.05 s start\n"
                                  "left { 0 s 0 0 0 mm  0.3 s 0 0 0 mm  1 s -8 2 0 mm  1.2 s -3 0 1 mm "
                                  "2 s -9 0 0 mm  2.2 s 2 0 0 mm  3 s 0 0 0 mm }\n"
                                  "right { 0 s 0 0 0 mm  0.3 s 0 0 0 mm  1 s 8 0 0 mm  1.3 s 3 1 0 mm "
                                  "2 s 9 0 -2 mm  2.3 s -2 0 0 mm  3 s 0 0 0 mm }\n";

typedef struct {
  double out_uj;
  int64_t given_nj;
  double peak_n;
  uint32_t operational;
  uint64_t hash;
} arm_session;

static void take_script(const char *words, uint32_t delay, script *s) {
  char text[512];
  candump_error error;
  snprintf(text, sizeof text, script_text, words, delay);
  if (!script_parse("test", text, strlen(text), s, &error)) {
    printf("%s\n", text);
    fixture_give_up("script", "is not taken");
  }
}

static void answer(port_sender *sender, const fray_output *out, simulated_device *device) {
  frame frames[PORT_OUT];
  const uint32_t count = port_encode(sender, out, frames);
  for (uint32_t n = 0; n < count; ++n) simulated_device_receive(device, &frames[n]);
}

static arm_session run_session(uint32_t coupling, const char *words, uint32_t delay) {
  fixture_scoped f = {0};
  arm_session r = {0, 0, 0, 0, 0};
  static script s;
  static simulated_device device;
  static const device_faults no_faults = {0, 0, 0, 0, 0, 0, 0, 1};
  char hands[64];
  port bus;
  port_sender sender;
  snprintf(hands, sizeof hands, " delay %u\n energy_reserve 2 J\n", delay);
  held_cloth_open(&f, coupling, "", hands, "");
  take_script(words, delay, &s);
  simulated_device_begin(&device, &s, &no_faults);
  port_init(&bus, 0, f.facts.hands, NULL);
  port_sender_init(&sender, 0, f.facts.hands, f.facts.rate_hz);
  while (!simulated_device_done(&device)) {
    frame frames[SIMULATED_DEVICE_FRAMES];
    fray_input input;
    const uint32_t count = simulated_device_step(&device, frames);
    for (uint32_t n = 0; n < count; ++n) port_push(&bus, &frames[n]);
    port_take(&bus, &input);
    const fray_output out = fixture_tick(&f, &input);
    answer(&sender, &out, &device);
    r.operational += out.state == FRAY_OPERATIONAL;
    r.peak_n = fmax(r.peak_n, fabs(out.force[0][0] * 0.0005));
    r.out_uj = fmax(r.out_uj, -1e6 * (device.handle[0].arm.given + device.handle[1].arm.given));
    r.hash = out.hash;
  }
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    fray_handle handle;
    CHECK(fray_view_handle(f.w, h, &handle) == 1);
    CHECK_EQ_INT(handle.taken_nj, 0);
    r.given_nj += handle.given_nj;
  }
  return r;
}

static void arms_get_nothing_over_the_bus(void) {
  static const char *const arms[] = {"0.1 kg 2000 N/m", "0.3 kg 500 N/m", "2 kg 1000 N/m"};
  for (uint32_t coupling = 1000; coupling <= 2000; coupling += 1000)
    for (uint32_t n = 0; n < 9; ++n) {
      const arm_session r = run_session(coupling, arms[n % 3], 1 + n / 3);
      printf("figure arm_session %s, %u N/m, delay %u: out %.3g uJ, meters %.4g uJ, peak %.3g N\n", arms[n % 3],
             coupling, 1 + n / 3, r.out_uj, (double)r.given_nj * 1e-3, r.peak_n);
      CHECK(r.operational > 1000 * SECONDS - 100);
      CHECK(r.out_uj <= 0.01);
      CHECK(r.peak_n > 2 && r.given_nj < -100000);
    }
}

static void a_session_is_the_same_again(void) {
  const arm_session a = run_session(1000, "0.3 kg 500 N/m", 2);
  const arm_session b = run_session(1000, "0.3 kg 500 N/m", 2);
  CHECK(a.hash == b.hash && a.given_nj == b.given_nj);
}

int main(void) {
  TEST(arms_get_nothing_over_the_bus);
  TEST(a_session_is_the_same_again);
  return test_end();
}
