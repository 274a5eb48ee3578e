/* SPDX-License-Identifier: Apache-2.0 */
/* A live run, from its start to its end, on a kernel in memory: each signal that ends it sends STOP and lets the
 * forces fade, and over a lost bus it ends within a second at any rate. */
#define _GNU_SOURCE /* dup2 */

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

#include "tests/lib/test.h"
#include "tests/sim/sys_session.h"
#include "tools/bus/live.h"

static const int signal_numbers[] = {SIGHUP, SIGINT, SIGPIPE, SIGTERM, SIGQUIT, SIGALRM, SIGUSR1, SIGUSR2, SIGXCPU};
enum { SIGNALS = sizeof signal_numbers / sizeof *signal_numbers };
enum { BUS_GOOD, BUS_DOWN, BUS_DEAF, BUSES };
static const char *const bus_names[BUSES] = {"good", "down", "deaf"};

static int64_t worst_ns;

/* What it prints is not this test's. */
static int run_quietly(fray_world *world, live_result *result) {
  const live_options o = {"sys0", NULL, 0, 0, 0, 80, LIVE_ANY_CPU, 1, {NULL, NULL, 0}};
  fflush(stdout);
  const int kept[2] = {dup(1), dup(2)};
  const int quiet = open("/dev/null", O_WRONLY);
  if (kept[0] < 0 || kept[1] < 0 || dup2(quiet, 1) < 0 || dup2(quiet, 2) < 0) abort();
  const int code = live_run(world, &o, result);
  fflush(stdout);
  if (dup2(kept[0], 1) < 0 || dup2(kept[1], 2) < 0) abort();
  (void)close(kept[0]);
  (void)close(kept[1]);
  (void)close(quiet);
  return code;
}

/* The bus is lost from the first tick on, where it is. */
static void one_stop(fray_world *world, int number, int bus_state, int64_t signal_ns) {
  live_result result;
  sys_begin();
  sys.counter = fray_get_info(world).consumed[0];
  sys.signal = number;
  sys.signal_ns = signal_ns;
  if (bus_state == BUS_DOWN) sys_fail(1u << CALL_SEND | 1u << CALL_RECEIVE, 1, UINT32_MAX, ENETDOWN);
  if (bus_state == BUS_DEAF) sys.deaf = 1;
  CHECK_EQ_INT(run_quietly(world, &result), 0);
  CHECK_EQ_INT(sys.sockets, 0);
  const int64_t took_ns = sys.now_ns - signal_ns;
  if (bus_state != BUS_GOOD && took_ns > worst_ns) worst_ns = took_ns;
  if (bus_state != BUS_GOOD && took_ns > INT64_C(1000000000)) {
    printf("%u Hz, bus %s, signal %d: ended after %.3f s\n", fray_get_info(world).rate_hz, bus_names[bus_state], number,
           (double)took_ns / 1e9);
    CHECK(0);
  }
  if (bus_state != BUS_GOOD) return;
  CHECK(result.last.state != FRAY_OPERATIONAL);
  CHECK(session_force_is_zero(&result.last));
}

static void under_force(void) {
  fray_error error;
  fray_world *world;
  for (int n = 0; n < SIGNALS; ++n)
    for (int bus_state = 0; bus_state < BUSES; ++bus_state) {
      if (fray_open(saved.image, saved.image_bytes, saved.memory, saved.memory_bytes, &world, &error) != FRAY_OK) abort();
      one_stop(world, signal_numbers[n], bus_state, INT64_C(8000000000));
    }
}

/* A signal at any moment of a tick, also of one that takes a second. */
static void at_any_rate(void) {
  static const int32_t rates[] = {1, 2, 3, 10, 500, 10000};
  for (size_t r = 0; r < sizeof rates / sizeof *rates; ++r) {
    fixture_scoped f = {0};
    fixture_hanging(&f, 4, 4, 1, "0 s", "0 %", "1 /s");
    fixture_params(&f)->rate_hz = rates[r];
    for (int64_t late_ms = 0; late_ms < 1000; late_ms += 90)
      for (int bus_state = 0; bus_state < BUSES; ++bus_state)
        one_stop(f.w, signal_numbers[late_ms / 90 % SIGNALS], bus_state, INT64_C(7000000000) + late_ms * 1000000);
  }
}

int main(void) {
  for (int n = 0; n < SIGNALS; ++n) (void)signal(signal_numbers[n], SIG_DFL); /* whatever nohup left ignored */
  TEST(prepare);
  TEST(under_force);
  TEST(at_any_rate);
  figure("live_stop_lost_bus_worst", (double)worst_ns / 1e9, "s", "1");
  return sys_session_end();
}
