/* SPDX-License-Identifier: Apache-2.0 */
/* An end of the bus whose freshness cannot be stored for a while: it stops, and says so. */
#define _DEFAULT_SOURCE
#include "tools/bus/bus_key.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "rt/wire/codec.h"
#include "tests/lib/test.h"

static char folder[] = "/tmp/fray_bus_key_XXXXXX";
static char key_file[64], lanes[64], kept[80];
static bus_key k;

static void seal_poses(uint32_t times) {
  for (uint32_t n = 0; n < times; ++n) {
    frame f;
    codec_encode_pose(&f, 0, 0, &(fray_pose){0, 0, 0, (uint8_t)(n & 15u), 0});
    CHECK(auth_gate_seal(&k.g, &f));
  }
}

static void a_store_that_comes_back(void) {
  const bus_key_options o = {key_file, lanes, 0};
  CHECK(bus_key_open(&k, &o, AUTH_GATE_DEVICE, 0, 0));
  CHECK(bus_key_tick(&k));
  CHECK(rename(lanes, kept) == 0 && mkdir(lanes, 0700) == 0);
  seal_poses(6000);
  const struct timespec pause = {0, 20000000};
  for (int n = 0; n < 500 && bus_key_tick(&k); ++n) (void)nanosleep(&pause, NULL);
  CHECK(!bus_key_tick(&k));
  CHECK(rmdir(lanes) == 0 && rename(kept, lanes) == 0);
  for (int n = 0; n < 500 && freshness_failed(&k.store) != 0; ++n) (void)nanosleep(&pause, NULL);
  CHECK_EQ_INT(freshness_failed(&k.store), 0);
  CHECK(!bus_key_tick(&k)); /* the end of a run has one cause */
  CHECK(!bus_key_close(&k));
  static const cmac_key NONE;
  CHECK(memcmp(&k.key, &NONE, sizeof NONE) == 0);
  CHECK(bus_key_open(&k, &o, AUTH_GATE_DEVICE, 0, 0));
  CHECK_EQ_INT(k.g.out[1].last, 6000);
  CHECK(bus_key_close(&k));
}

static void write_key(void) {
  FILE *out = fopen(key_file, "wb");
  if (out == NULL || fputs("2b7e151628aed2a6abf7158809cf4f3c\n", out) < 0 || fclose(out) != 0 ||
      chmod(key_file, 0600) != 0)
    exit(1);
}

int main(void) {
  if (mkdtemp(folder) == NULL) return 1;
  snprintf(key_file, sizeof key_file, "%s/key", folder);
  snprintf(lanes, sizeof lanes, "%s/lanes", folder);
  snprintf(kept, sizeof kept, "%s.kept", lanes);
  write_key();
  TEST(a_store_that_comes_back);
  unlink(key_file);
  unlink(lanes);
  rmdir(folder);
  return test_end();
}
