/* SPDX-License-Identifier: Apache-2.0 */
/* Logs under a key, line by line: what is taken out, and what is said of it. */
#define _POSIX_C_SOURCE 200809L
#include "tools/recording/unseal.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "rt/wire/codec.h"
#include "rt/wire/auth_gate.h"
#include "tests/lib/rfc4493_key.h"
#include "tests/lib/test.h"

static cmac_key key;
static auth_gate runtime, device;
static char lines[1 << 20];
static char words[1 << 16]; /* what was said */
static candump_log log_;
static unseal_counts counts;

static void begin(auth_gate_form form) {
  lines[0] = 0;
  auth_gate_init(&runtime, &key, form, AUTH_GATE_RUNTIME, 0, 3);
  auth_gate_init(&device, &key, form, AUTH_GATE_DEVICE, 0, 0);
}

static void say(const frame *f) {
  const size_t at = strlen(lines);
  (void)candump_format(lines + at, "sim0", (int64_t)at, f);
}

static frame pose(uint32_t hand, uint32_t counter, int x) {
  frame f;
  const fray_pose p = {(int16_t)x, 0, 0, (uint8_t)(counter & 15u), 0};
  codec_encode_pose(&f, 0, hand, &p);
  return f;
}

static frame sealed_pose(uint32_t hand, uint32_t counter, int x) {
  frame f = pose(hand, counter, x);
  CHECK(auth_gate_seal(&device, &f));
  return f;
}

static frame sealed_force(uint32_t hand, uint32_t tick) {
  frame f;
  const codec_force force = {0, 0, 0, (uint8_t)(tick & 15u), 0};
  codec_encode_force(&f, 0, hand, &force);
  CHECK(auth_gate_seal(&runtime, &f));
  return f;
}

static void parse(void) {
  candump_error error;
  CHECK(candump_parse_all("x.log", lines, strlen(lines), &log_, &error));
}

static FILE *open_words(void) {
  memset(words, 0, sizeof words);
  FILE *out = fmemopen(words, sizeof words - 1, "w");
  if (out == NULL) exit(1);
  return out;
}

static void unseal(uint32_t hands) {
  parse();
  FILE *out = open_words();
  if (device.form == AUTH_GATE_FD)
    unseal_fd("x.log", &log_, &key, 0, &counts, out);
  else
    unseal_classic("x.log", &log_, &key, 0, hands, &counts, out);
  fclose(out);
}

static void frames_are_named_by_their_line(void) {
  begin(AUTH_GATE_FD);
  frame first = sealed_pose(0, 1, 7), f = first;
  say(&first);                            /* 1 */
  f.data[2] ^= 1;
  say(&f);                                /* 2: its freshness is used up */
  f = sealed_pose(0, 2, 8);
  frame forged = f;
  forged.data[19] ^= 0x80;
  say(&forged);                           /* 3 */
  say(&f);                                /* 4 */
  say(&first);                            /* 5 */
  f = pose(1, 1, 9);
  say(&f);                                /* 6 */
  f = sealed_force(1, 0);
  say(&f);                                /* 7 */
  f.length = 16;
  say(&f);                                /* 8 */
  f = sealed_pose(1, 1, 5);
  f.id = 0x119;                           /* 9: another instance's */
  say(&f);
  unseal(3);
  CHECK_TEXT(words,
             "x.log:2: POSE_LEFT_AUTH: an old freshness\n"
             "x.log:3: POSE_LEFT_AUTH: a tag that does not fit\n"
             "x.log:5: POSE_LEFT_AUTH: an old freshness\n"
             "x.log:6: POSE_RIGHT: no tag; not used\n"
             "x.log:8: FORCE_RIGHT_AUTH: a wrong length\n");
  CHECK_EQ_INT(log_.count, 4);
  CHECK_EQ_INT(counts.good, 3);
  CHECK_EQ_INT(counts.refused, 5);
  static const int LINES[] = {1, 4, 7, 9};
  static const uint32_t IDS[] = {0x101, 0x101, 0x182, 0x119};
  for (size_t n = 0; n < 4 && n < log_.count; ++n) {
    CHECK_EQ_INT(log_.entries[n].line, LINES[n]);
    CHECK_EQ_INT(log_.entries[n].frame.id, IDS[n]);
  }
  candump_free(&log_);
}

static void many_notes_end_with_a_count(void) {
  begin(AUTH_GATE_FD);
  for (int n = 0; n < 20; ++n) {
    frame f = pose(0, (uint32_t)n, 0);
    say(&f);
  }
  frame f = sealed_force(0, 0);
  say(&f);
  unseal(3);
  CHECK(strstr(words, "x.log:8: POSE_LEFT: no tag; not used\nx.log: and 12 more of that kind\n") != NULL);
  CHECK(strstr(words, "x.log:9:") == NULL);
  candump_free(&log_);
}

/* The operator's COMMANDs and the runtime's own are two lanes. */
static void two_senders_of_commands(void) {
  begin(AUTH_GATE_FD);
  for (uint32_t n = 0; n < 4; ++n) {
    frame f;
    const codec_command command = {(uint8_t)(n + 1), FRAY_COMMAND_STOP, 0};
    codec_encode_command(&f, 0, &command);
    CHECK(auth_gate_seal(n % 2 == 0 ? &device : &runtime, &f));
    say(&f);
  }
  unseal(3);
  CHECK_TEXT(words, "");
  CHECK_EQ_INT(counts.good, 4);
  candump_free(&log_);
}

static void which_form(void) {
  frame f;
  begin(AUTH_GATE_FD);
  f = sealed_force(0, 0);
  say(&f);
  for (uint32_t n = 0; n < 9; ++n) { /* a flood cannot make it look plain */
    f = pose(0, n, 0);
    say(&f);
  }
  parse();
  CHECK_EQ_INT(unseal_is_fd(&log_, 0), 1);
  CHECK_EQ_INT(unseal_is_fd(&log_, 1), 0);
  candump_free(&log_);
  begin(AUTH_GATE_CLASSIC);
  codec_encode_force(&f, 0, 0, &(codec_force){0, 0, 0, 0, 0});
  say(&f);
  begin(AUTH_GATE_FD);
  parse();
  CHECK_EQ_INT(unseal_is_fd(&log_, 0), 0);
  candump_free(&log_);
}

/* Classic */

static void say_group(uint32_t first, int spoilt) {
  for (uint32_t n = 0; n < 4; ++n) {
    frame f = pose(0, first + n, (int)first), tag;
    say(&f);
    if (!auth_gate_tag(&device, &f, &tag)) continue;
    if (spoilt) tag.data[7] ^= 1;
    say(&tag);
  }
}

static void say_tick(uint32_t tick, uint8_t reset) {
  frame f;
  codec_encode_sync(&f, 0, &(codec_sync){tick, 0});
  say(&f);
  if (!reset) return;
  frame p = pose(0, tick, 1234); /* comes between the SYNC and its ACK: after the RESET */
  say(&p);
  codec_encode_ack(&f, 0, &(codec_ack){1, FRAY_COMMAND_RESET, FRAY_RESULT_OK, tick});
  say(&f);
}

static void failed_lanes(void) {
  begin(AUTH_GATE_CLASSIC);
  device.group[0].last = 0x54320; /* the upper half is found */
  say_group(1, 0);
  for (uint32_t n = 1; n < 4; ++n) say_group(4 * n + 1, 1);
  say_group(17, 0);
  say_tick(5, 0);
  say_tick(6, 1);
  unseal(1);
  CHECK_TEXT(words,
             "x.log:10: TAG_LEFT: does not fit: the POSEs before it have no tag\n"
             "x.log:15: TAG_LEFT: does not fit: the POSEs before it have no tag\n"
             "x.log:20: TAG_LEFT: does not fit: the POSEs before it have no tag\n"
             "x.log:20: TAG_LEFT: the lane has failed: no POSE is used until RESET\n");
  CHECK_EQ_INT(counts.good, 1);
  CHECK_EQ_INT(counts.refused, 3);
  CHECK_EQ_INT(counts.dropped, 4);
  CHECK_EQ_INT(log_.count, 25 - 4 + 4);
  fray_pose last;
  memset(&last, 0, sizeof last);
  for (size_t n = 0; n < log_.count; ++n) (void)codec_decode_pose(&log_.entries[n].frame, 0, 0, &last);
  CHECK_EQ_INT(last.x, 1234);
  candump_free(&log_);
  begin(AUTH_GATE_CLASSIC);
  for (uint32_t n = 0; n < 4; ++n) say_group(4 * n + 1, 1);
  unseal(2); /* nobody uses that hand */
  CHECK_TEXT(words, "");
  candump_free(&log_);
}

/* A RESET lets the failed lane begin anew; the other one is in the middle of its four. */
static void a_reset_of_one_lane(void) {
  begin(AUTH_GATE_CLASSIC);
  for (uint32_t n = 0; n < 3; ++n) say_group(4 * n + 1, 1);
  for (uint32_t n = 1; n <= 4; ++n) {
    frame f = pose(1, n, 0), tag;
    say(&f);
    if (auth_gate_tag(&device, &f, &tag)) say(&tag);
    if (n == 2) say_tick(6, 1);
  }
  unseal(3);
  CHECK(strstr(words, "TAG_LEFT: the lane has failed") != NULL);
  CHECK(strstr(words, "TAG_RIGHT") == NULL);
  CHECK_EQ_INT(counts.good, 1);
  CHECK_EQ_INT(counts.refused, 3);
  candump_free(&log_);
}

/* Whole: with a key file, and without. */
static const char *says(const char *key_file) {
  parse();
  FILE *out = open_words();
  const int good = unseal_log("x.log", &log_, key_file, 0, 3, out);
  fclose(out);
  candump_free(&log_);
  return good ? "" : words;
}

static void with_and_without_a_key(void) {
  char path[] = "/tmp/fray_unseal_XXXXXX";
  const int out = mkstemp(path);
  if (out < 0 || write(out, "2b7e151628aed2a6abf7158809cf4f3c\n", 33) != 33 || close(out) != 0) exit(1);
  begin(AUTH_GATE_FD);
  frame f = sealed_force(0, 0);
  say(&f);
  CHECK_TEXT(says(path), "");
  CHECK_TEXT(words, "x.log: 1 frames have a good tag, 0 others are not used\n");
  CHECK_TEXT(says(NULL), "x.log: was recorded under a key, expected --key FILE\n");
  f.data[4] ^= 1;
  lines[0] = 0;
  say(&f);
  CHECK(strstr(says(path), "no tag of this log fits, expected the key that it was recorded under") != NULL);
  lines[0] = 0;
  f = pose(0, 1, 1);
  say(&f);
  CHECK(strstr(says(path), "nothing of instance 0 has a tag, expected a recording under a key") != NULL);
  CHECK_TEXT(says(NULL), "");
  begin(AUTH_GATE_CLASSIC);
  say_group(1, 0);
  CHECK_TEXT(says(NULL), "");
  CHECK_TEXT(words, "x.log: its TAGs are not checked without --key FILE\n");
  CHECK_TEXT(says(path), "");
  CHECK_TEXT(words, "x.log: 1 TAGs are good, 0 failures, 0 POSEs after a failed lane are not used\n");
  lines[0] = 0;
  say_group(1, 1);
  CHECK(strstr(says(path), "no TAG of this log fits") != NULL);
  unlink(path);
}

int main(void) {
  cmac_key_init(&key, RFC4493_KEY);
  TEST(frames_are_named_by_their_line);
  TEST(many_notes_end_with_a_count);
  TEST(two_senders_of_commands);
  TEST(which_form);
  TEST(failed_lanes);
  TEST(a_reset_of_one_lane);
  TEST(with_and_without_a_key);
  return test_end();
}
