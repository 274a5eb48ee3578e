/* SPDX-License-Identifier: Apache-2.0 */
/* Power cuts at random moments of a recorded session: what a fdatasync has returned for stays, of what was only
 * written a random part does, torn at any byte. What is lost is at most what platform/linux/bus_log.h states, and
 * `fray verify --cut` accepts every log. */
#define _GNU_SOURCE /* dup2 */

#include <stdlib.h>
#include <unistd.h>

#include "platform/log/candump.h"
#include "tests/lib/test.h"
#include "tests/sim/sys_session.h"
#include "tools/cmd/cmd.h"

enum { TICKS = 3000, CUTS = 200, ROUNDS_MAX = 1000, TICK_NS = 1000000 };

/* A round of the writer: from `written_ns` on the file has `bytes`, from `kept_ns` on the disk has them. */
typedef struct {
  int64_t written_ns, kept_ns;
  size_t bytes;
} round_of_writer;

static round_of_writer rounds[ROUNDS_MAX];
static int round_count;
static int64_t next_ns;
static uint64_t seed;
static char folder[] = "/tmp/fray_power_XXXXXX", image_path[64], log_path[64], said_path[64];

/* The writer is a thread of its own: its calls take none of the loop's time. */
static void write_round(int64_t sync_most_ns) {
  if (sys.now_ns < next_ns || round_count == ROUNDS_MAX) return;
  const int64_t loop_ns = sys.now_ns;
  sys.sync_ns = (int64_t)(splitmix64(&seed) % (uint64_t)sync_most_ns);
  CHECK(bus_log_store(&own_log));
  rounds[round_count++] = (round_of_writer){sys.now_ns - sys.sync_ns, sys.now_ns, sys.file_bytes};
  next_ns = loop_ns + BUS_LOG_EVERY_MS * INT64_C(1000000);
  if (next_ns < sys.now_ns) next_ns = sys.now_ns;
  sys.now_ns = loop_ns;
}

static void record_session(int64_t sync_most_ns) {
  CHECK(sys_session_begin(0));
  round_count = 0;
  next_ns = 0;
  for (int tick = 0; tick < TICKS; ++tick) {
    CHECK_EQ_INT(loop_run(&l), LOOP_TICKED);
    write_round(sync_most_ns);
  }
}

static size_t bytes_at(int64_t cut_ns, int kept) {
  size_t bytes = 0;
  for (int n = 0; n < round_count && (kept ? rounds[n].kept_ns : rounds[n].written_ns) <= cut_ns; ++n)
    bytes = rounds[n].bytes;
  return bytes;
}

/* What is left of the file; returns its bytes. */
static size_t cut_file(int64_t cut_ns) {
  const size_t kept = bytes_at(cut_ns, 1), written = bytes_at(cut_ns, 0);
  const size_t bytes = kept + (size_t)(splitmix64(&seed) % (written - kept + 1));
  FILE *out = fopen(log_path, "wb");
  if (out == NULL || fwrite(sys.file, 1, bytes, out) != bytes || fclose(out) != 0) abort();
  return bytes;
}

static int verified(void) {
  char *words[] = {"verify", log_path, "--scene", image_path, "--cut"};
  fflush(stdout);
  const int kept = dup(1);
  if (kept < 0 || freopen(said_path, "w", stdout) == NULL) abort();
  const int code = cmd_verify(5, words);
  fflush(stdout);
  if (dup2(kept, 1) < 0) abort();
  (void)close(kept);
  return code == 0;
}

/* Nanoseconds before the cut of the first line that is not whole in the file. */
static int64_t lost_ns(size_t bytes, int64_t cut_ns) {
  uint32_t lines = 0;
  for (size_t n = 0; n < bytes; ++n) lines += sys.file[n] == '\n';
  return lines < sys.rx_taken && sys.rx[lines].at_ns < cut_ns ? cut_ns - sys.rx[lines].at_ns : 0;
}

static int64_t cut_moment(int64_t begun_ns) {
  return begun_ns + (int64_t)(splitmix64(&seed) % (uint64_t)(TICKS * (int64_t)TICK_NS));
}

static void cuts(void) {
  const int64_t begun_ns = 5000000000;
  int64_t worst_ns = 0;
  uint32_t good = 0, empty = 0;
  record_session(INT64_C(1000000) * (BUS_LOG_LOSS_MS - BUS_LOG_EVERY_MS) - TICK_NS);
  for (int n = 0; n < CUTS; ++n) {
    const int64_t cut_ns = cut_moment(begun_ns);
    const size_t bytes = cut_file(cut_ns);
    const int64_t lost = lost_ns(bytes, cut_ns);
    if (lost > worst_ns) worst_ns = lost;
    empty += bytes < 200;
    good += bytes >= 200 && verified();
  }
  CHECK_EQ_INT(good + empty, CUTS);
  CHECK(empty < CUTS / 10); /* before the first fdatasync there is nothing to verify */
  CHECK(worst_ns <= BUS_LOG_LOSS_MS * INT64_C(1000000) + TICK_NS);
  CHECK(own_log.worst_ns <= BUS_LOG_LOSS_MS * INT64_C(1000000));
  figure("power_cuts_verified", good, "of 200", "all that are not empty");
  figure("power_cut_lost_worst", (double)worst_ns / 1e6, "ms", "100, and a tick");
  board_close(0);
}

/* A disk that takes longer loses more, and the log says how much. */
static void slow_disk(void) {
  int64_t worst_ns = 0;
  record_session(INT64_C(400000000));
  for (int n = 0; n < CUTS; ++n) {
    const int64_t cut_ns = cut_moment(5000000000);
    const int64_t lost = cut_ns <= rounds[round_count - 1].kept_ns ? lost_ns(bytes_at(cut_ns, 1), cut_ns) : 0;
    if (lost > worst_ns) worst_ns = lost;
  }
  CHECK(worst_ns > BUS_LOG_LOSS_MS * INT64_C(1000000));
  CHECK(worst_ns <= own_log.worst_ns + TICK_NS);
  CHECK_EQ_INT(l.overruns, 0);
  figure("power_cut_lost_slow_disk", (double)worst_ns / 1e6, "ms", "as the run says");
  board_close(0);
}

static void open_folder(void) {
  prepare();
  if (mkdtemp(folder) == NULL) abort();
  snprintf(image_path, sizeof image_path, "%s/start.img", folder);
  snprintf(log_path, sizeof log_path, "%s/cut.log", folder);
  snprintf(said_path, sizeof said_path, "%s/said", folder);
  FILE *out = fopen(image_path, "wb");
  if (out == NULL || fwrite(saved.image, 1, saved.image_bytes, out) != saved.image_bytes || fclose(out) != 0) abort();
}

int main(void) {
  seed = 18;
  TEST(open_folder);
  TEST(cuts);
  TEST(slow_disk);
  (void)unlink(image_path);
  (void)unlink(log_path);
  (void)unlink(said_path);
  (void)rmdir(folder);
  return sys_session_end();
}
