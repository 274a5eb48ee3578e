/* SPDX-License-Identifier: Apache-2.0 */
/* Logs written line by line; their CRCs come from a few lines of Python. */
#include "tools/recording/replay.h"

#include <stdlib.h>

#include "tests/lib/test.h"
#include "tools/recording/record.h"

enum { LINES = 13 };

/* Three ticks of one hand: the first consumes POSE 1, the second skips to POSE 3 and takes START,
 * the third has no new POSE. */
static const char *const GOOD[LINES] = {
    "(1.000000) vcan0 101#8801000000000000", /* 1 POSE, counter 1 */
    "(1.000000) vcan0 080#00000000DDCCBBAA", /* 2 SYNC 0 */
    "(1.000100) vcan0 181#E410000000000000", /* 3 FORCE 0, consumed 1 */
    "(1.000200) vcan0 101#D902010000000000", /* 4 POSE, counter 2, x 1 */
    "(1.000300) vcan0 101#6C03020000000000", /* 5 POSE, counter 3, x 2 */
    "(1.000400) vcan0 010#EC01010000000000", /* 6 COMMAND START, counter 1 */
    "(1.001000) vcan0 080#0100000011111111", /* 7 SYNC 1 */
    "(1.001050) vcan0 011#2111010001000000", /* 8 ACK of tick 1 */
    "(1.001100) vcan0 181#0931000000000000", /* 9 FORCE 1, consumed 3 */
    "(1.001200) vcan0 200#0100020005000000", /* 10 TEAR */
    "(1.002000) vcan0 080#0200000022222222", /* 11 SYNC 2 */
    "(1.002100) vcan0 181#AC32000000000000", /* 12 FORCE 2, consumed 3 */
    "(1.003000) vcan0 080#0300000033333333", /* 13 SYNC 3, closing */
};

static replay run;
static candump_error error;
static const replay_setting LEFT = {0, 1, 1000, 0, {0, 0}, 0, 0};

static int read_text(const char *text, const replay_setting *setting) {
  candump_log log;
  memset(&error, 0, sizeof error);
  replay_free(&run); /* of before */
  if (!candump_parse_all("r.log", text, strlen(text), &log, &error)) return 0;
  const int good = replay_read("r.log", &log, setting, &run, &error);
  candump_free(&log);
  return good;
}

static int read_lines(const char *const lines[LINES]) {
  char text[LINES * 64] = "";
  for (int n = 0; n < LINES; ++n) {
    if (lines[n] == NULL) continue;
    strcat(text, lines[n]);
    strcat(text, "\n");
  }
  return read_text(text, &LEFT);
}

static void check_good_run(void) {
  CHECK_EQ_INT(run.recording, 1);
  CHECK_EQ_INT(run.first, 0);
  CHECK_EQ_INT(run.start_hash, 0xAABBCCDD);
  CHECK_EQ_INT(run.count, 3);
  if (run.count != 3) return;
  CHECK_EQ_INT(run.ticks[0].hash, 0x11111111);
  CHECK_EQ_INT(run.ticks[2].hash, 0x33333333);
  CHECK_EQ_INT(run.ticks[0].input.has_pose, 1);
  CHECK_EQ_INT(run.ticks[0].input.pose[0].counter, 1);
  CHECK_EQ_INT(run.ticks[0].input.command, 0);
  CHECK_EQ_INT(run.ticks[1].input.has_pose, 1);
  CHECK_EQ_INT(run.ticks[1].input.pose[0].x, 2);
  CHECK_EQ_INT(run.ticks[1].input.command, FRAY_COMMAND_START);
  CHECK_EQ_INT(run.ticks[1].input.command_counter, 1);
  CHECK_EQ_INT(run.ticks[2].input.has_pose, 0);
  CHECK_EQ_INT(run.ticks[2].force[0][0], 0xAC);
  CHECK_EQ_INT(run.tears.count, 1);
}

static void a_recording(void) {
  CHECK(read_lines(GOOD));
  check_good_run();
  if (run.count != 3) return;
  CHECK_EQ_INT(run.ticks[0].sync_line, 2);
  CHECK_EQ_INT(run.ticks[0].hash_line, 7);
  CHECK_EQ_INT(run.ticks[1].force_line[0], 9);
  CHECK_EQ_INT(run.ticks[1].ack_line, 8);
  CHECK_EQ_INT(run.tears.of[0].line, 10);
}

/* Another listener: inputs after their SYNC, a FORCE after the next SYNC. */
static void places_do_not_matter(void) {
  static const int ORDER[LINES] = {2, 1, 4, 5, 7, 3, 6, 8, 11, 9, 10, 12, 13};
  const char *lines[LINES];
  for (int n = 0; n < LINES; ++n) lines[n] = GOOD[ORDER[n] - 1];
  CHECK(read_lines(lines));
  check_good_run();
}

static void frames_twice(void) {
  char text[2 * LINES * 64] = "";
  for (int n = 0; n < LINES; ++n) {
    for (int twice = 0; twice < 2; ++twice) {
      strcat(text, GOOD[n]);
      strcat(text, "\n");
      if (n == 9) break; /* a TEAR has no number */
    }
  }
  CHECK(read_text(text, &LEFT));
  check_good_run();
}

static void equal_syncs(void) {
  const char *lines[LINES];
  memcpy(lines, GOOD, sizeof lines);
  lines[9] = "(1.001900) vcan0 080#0200000022222222";
  CHECK(read_lines(lines));
  CHECK_EQ_INT(run.count, 3);
  CHECK_EQ_INT(run.ticks[1].hash, 0x22222222);
  CHECK_EQ_INT(run.ticks[1].hash_line, 10);
  lines[9] = "(1.001900) vcan0 080#0200000099999999";
  CHECK(!read_lines(lines));
  CHECK_EQ_INT(error.line, 11);
  CHECK_TEXT(error.message, "SYNC of tick 2 says 22222222, expected 99999999 as in line 10: a repeated SYNC has the "
                            "same hash");
  memcpy(lines, GOOD, sizeof lines);
  lines[2] = "(1.000000) vcan0 080#0000000000CCBBAA";
  CHECK(!read_lines(lines));
  CHECK_EQ_INT(error.line, 3);
}

/* Cut behind the FORCE of tick 2; then before it: tick 1 is closed by the SYNC of tick 2. */
static void without_a_closing_sync(void) {
  static const replay_setting CUT = {0, 1, 1000, 0, {0, 0}, 1, 0};
  char text[LINES * 64] = "";
  for (int n = 0; n < LINES - 1; ++n) {
    strcat(text, GOOD[n]);
    strcat(text, "\n");
    if (n == 10) CHECK(read_text(text, &LEFT) && run.count == 2 && run.cut_line == 0);
  }
  CHECK(!read_text(text, &LEFT));
  CHECK_EQ_INT(error.line, 11);
  CHECK_TEXT(error.message, "tick 2 has no hash, expected a closing SYNC behind it: the recording was cut off "
                            "(--cut takes the ticks that are whole)");
  CHECK(read_text(text, &CUT));
  CHECK_EQ_INT(run.count, 2);
  CHECK_EQ_INT(run.cut_line, 11);
  CHECK_EQ_INT(run.ticks[1].hash, 0x22222222);
}

/* A FORCE that follows the next SYNC is cut off with what is behind it. */
static void cut_before_a_late_force(void) {
  static const replay_setting CUT = {0, 1, 1000, 0, {0, 0}, 1, 0};
  char text[LINES * 64] = "";
  for (int n = 0; n < 11; ++n) {
    if (n == 8) continue;
    strcat(text, GOOD[n]);
    strcat(text, "\n");
  }
  CHECK(read_text(text, &CUT));
  CHECK_EQ_INT(run.count, 1);
  CHECK_EQ_INT(run.cut_line, 7);
}

/* Others may fill the bus when the runtime has gone. */
static void a_bus_that_goes_on_behind_the_last_sync(void) {
  enum { OTHERS = 5000 };
  static char text[(LINES + OTHERS) * 64];
  for (int n = 0; n < LINES; ++n) {
    strcat(text, GOOD[n]);
    strcat(text, "\n");
  }
  size_t end = strlen(text);
  for (int n = 0; n < OTHERS; ++n)
    end += (size_t)sprintf(text + end, "(1.002200) vcan0 400#%016X\n", (unsigned)n);
  CHECK(read_text(text, &LEFT));
  CHECK_EQ_INT(run.count, 3);
  if (run.count != 3) return;
  CHECK_EQ_INT(run.ticks[1].input.command, FRAY_COMMAND_START);
}

/* POSEs and COMMANDs that fail E2E never entered the world. */
static void bad_inputs_are_passed_over(void) {
  const char *lines[LINES];
  memcpy(lines, GOOD, sizeof lines);
  lines[3] = "(1.000200) vcan0 101#0003020000000000";
  CHECK(read_lines(lines));
  CHECK_EQ_INT(run.ticks[1].input.pose[0].x, 2);
}

static void refused(int line, const char *instead, int at, const char *message) {
  const char *lines[LINES];
  memcpy(lines, GOOD, sizeof lines);
  lines[line - 1] = instead;
  CHECK(!read_lines(lines));
  CHECK_TEXT(error.file, "r.log");
  CHECK_EQ_INT(error.line, at);
  CHECK_TEXT(error.message, message);
  CHECK_EQ_INT(run.count, 0);
}

static void commands_without_an_answer(void) {
  refused(8, NULL, 6, "COMMAND 1 with counter 1 has no ACK");
  refused(10, "(1.001200) vcan0 010#4902010000000000", 10, "COMMAND 1 with counter 2 has no ACK");
}

static void missing_frames(void) {
  refused(7, NULL, 10, "SYNC of tick 2, expected tick 1: a SYNC is missing");
  refused(9, NULL, 11,
          "FORCE left with counter 2, expected that of tick 1, 1: a FORCE or a SYNC is missing");
  refused(1, NULL, 2, "tick 0 consumed a POSE left with counter 1, which is not in the log");
  refused(5, NULL, 8, "tick 1 consumed a POSE left with counter 3, which is not in the log");
  refused(6, NULL, 7, "ACK of command 1 with counter 1, whose COMMAND is not in the log");
  refused(12, "(1.002100) vcan0 011#2111010001000000", 11, "tick 2 has no FORCE left");
}

static void damaged_frames(void) {
  refused(2, "(1.000000) vcan0 080#000000", 2, "SYNC has a wrong length");
  refused(3, "(1.000100) vcan0 181#E510000000000000", 3, "FORCE has a wrong CRC");
  refused(8, "(1.001050) vcan0 011#2211010001000000", 8, "ACK has a wrong CRC");
  refused(10, "(1.001200) vcan0 200#0400020005000000", 10, "TEAR has a field outside its range");
  refused(5, "(1.000300) vcan0 101#0003020000000000", 9,
          "tick 1 consumed a POSE left with counter 3, which is not in the log");
}

/* 16 POSEs later the same counter comes again; it must not stand in for a missing one. */
static void the_next_round_of_counters_is_no_substitute(void) {
  static char text[41 * 3 * 64];
  frame f;
  size_t bytes = 0;
  for (uint32_t tick = 0; tick < 40; ++tick) {
    const uint8_t counter = (uint8_t)((tick + 1) & 15);
    const fray_pose pose = {(int16_t)tick, 0, 0, counter, 0};
    const codec_sync sync = {tick, 0};
    const codec_force force = {0, 0, 0, (uint8_t)(tick & 15), counter};
    codec_encode_pose(&f, 0, 0, &pose);
    if (tick != 20) bytes += candump_format(text + bytes, "v", 0, &f);
    codec_encode_sync(&f, 0, &sync);
    bytes += candump_format(text + bytes, "v", 0, &f);
    codec_encode_force(&f, 0, 0, &force);
    bytes += candump_format(text + bytes, "v", 0, &f);
  }
  codec_encode_sync(&f, 0, &(codec_sync){40, 0});
  (void)candump_format(text + bytes, "v", 0, &f);
  CHECK(!read_text(text, &LEFT));
  CHECK_EQ_INT(error.line, 20 * 3 + 2);
  CHECK_TEXT(error.message,
             "tick 20 consumed a POSE left with counter 5, which is not in the log");
}

static void from_a_save(void) {
  const replay_setting setting = {0, 1, 1000, 2, {3, 0}, 0, 0}, other = {0, 1, 1000, 2, {0, 0}, 0, 0};
  static const char TEXT[] =
      "(1.002000) vcan0 080#0200000022222222\n"
      "(1.002100) vcan0 181#AC32000000000000\n"
      "(1.003000) vcan0 080#0300000033333333\n";
  CHECK(read_text(TEXT, &setting));
  CHECK_EQ_INT(run.first, 2);
  CHECK_EQ_INT(run.count, 1);
  CHECK_EQ_INT(run.ticks[0].input.has_pose, 0);
  CHECK(!read_text(TEXT, &other)); /* from another save: POSE 3 is news there */
  CHECK(!read_text(TEXT, &LEFT));
  CHECK_TEXT(error.message, "the recording starts with tick 2, the image with tick 0");
}

static void a_device_log(void) {
  static const char TEXT[] =
      "(5.000000) vcan0 101#8801000000000000\n"
      "(5.000999) vcan0 101#D902010000000000\n"
      "(5.001000) vcan0 010#EC01010000000000\n"
      "(5.003000) vcan0 101#6C03020000000000\n"
      "(5.002999) vcan0 101#6C03020000000000\n"
      "(5.003000) vcan0 101#0003020000000000\n";
  CHECK(read_text(TEXT, &LEFT));
  CHECK_EQ_INT(run.recording, 0);
  CHECK_EQ_INT(run.count, 4);
  if (run.count != 4) return;
  CHECK_EQ_INT(run.ticks[0].input.pose[0].counter, 2);
  CHECK_EQ_INT(run.ticks[1].input.has_pose, 0);
  CHECK_EQ_INT(run.ticks[1].input.command, FRAY_COMMAND_START);
  CHECK_EQ_INT(run.ticks[2].input.has_pose, 0);
  CHECK_EQ_INT(run.ticks[3].input.pose[0].counter, 3);
  CHECK_EQ_INT(run.port.accepted, 4);
  CHECK_EQ_INT(run.port.repeated, 1);
  CHECK_EQ_INT(run.port.wrong_crc, 1);
  CHECK(read_text("", &LEFT));
  CHECK_EQ_INT(run.count, 0);
  CHECK(!read_text("(5.000000) vcan0 101#8801000000000000\n  vcan0  101   [0] \n", &LEFT));
  CHECK_EQ_INT(error.line, 2);
  CHECK_TEXT(error.message,
             "a frame without a time in a log without SYNCs, expected one of candump -L or -t a");
}

static void times_of_ticks(void) {
  CHECK(record_time_us(0, 3000) == INT64_C(1000000000000000));
  CHECK(record_time_us(1, 3000) == INT64_C(1000000000000334));
  CHECK(record_time_us(3, 3000) == INT64_C(1000000000001000));
  CHECK(record_time_us(4001, 1000) == INT64_C(1000000004001000));
}

static void read_stream(FILE *in, char *text, size_t room) {
  rewind(in);
  text[fread(text, 1, room - 1, in)] = 0;
}

/* The run of GOOD, written by record and read again. */
static void recorded_and_read(void) {
  static char text[4096];
  record r;
  fray_input input[2];
  fray_output output;
  FILE *out = tmpfile();
  CHECK(out != NULL);
  if (out == NULL) return;
  memset(input, 0, sizeof input);
  memset(&output, 0, sizeof output);
  const fray_pose pose = {0, 0, 0, 1, 0};
  record_begin(&r, out, 0, 1, 1000, 0, 0x1122334455667788);
  input[0].has_pose = 1;
  input[0].pose[0] = pose;
  input[0].command = FRAY_COMMAND_START;
  input[0].command_counter = 1;
  output.consumed[0] = 1;
  output.answered = FRAY_COMMAND_START;
  output.answer_counter = 1;
  output.state = FRAY_READY;
  output.hash = 0xFFFFFFFF00000001;
  CHECK(record_tick(&r, &input[0], &output));
  output.tick = 1;
  output.answered = 0;
  output.hash = 2;
  CHECK(record_tick(&r, &input[1], &output));
  CHECK(record_end(&r));
  read_stream(out, text, sizeof text);
  fclose(out);
  CHECK_EQ_INT(strncmp(text, "(1000000000.000000) vcan0 709#", 30), 0); /* whatever the physics */
  CHECK_TEXT(strchr(text, '\n') + 1,
             "(1000000000.000000) vcan0 010#EC01010000000000\n"
             "(1000000000.000000) vcan0 101#8801000000000000\n"
             "(1000000000.000000) vcan0 080#0000000088776655\n"
             "(1000000000.000000) vcan0 181#E410000000000000\n"
             "(1000000000.000000) vcan0 011#0A10010000000000\n"
             "(1000000000.000000) vcan0 701#0100000000000000\n"
             "(1000000000.001000) vcan0 080#0100000001000000\n"
             "(1000000000.001000) vcan0 181#6211000000000000\n"
             "(1000000000.002000) vcan0 080#0200000002000000\n");
  CHECK(read_text(text, &LEFT));
  CHECK_EQ_INT(run.count, 2);
  CHECK_EQ_INT(run.start_hash, 0x55667788);
  CHECK_EQ_INT(memcmp(&run.ticks[0].input, &input[0], sizeof input[0]), 0);
  CHECK_EQ_INT(memcmp(&run.ticks[1].input, &input[1], sizeof input[1]), 0);
  CHECK_EQ_INT(run.ticks[1].hash, 2);
}

static void not_recordable(void) {
  record r;
  fray_input input;
  fray_output output;
  FILE *out = tmpfile();
  if (out == NULL) return;
  memset(&input, 0, sizeof input);
  memset(&output, 0, sizeof output);
  record_begin(&r, out, 0, 1, 1000, 0, 0);
  input.has_pose = 1; /* counter 0 in the first tick: FORCE cannot say that it was consumed */
  CHECK(!record_tick(&r, &input, &output));
  fclose(out);
}

int main(void) {
  TEST(a_recording);
  TEST(places_do_not_matter);
  TEST(frames_twice);
  TEST(equal_syncs);
  TEST(without_a_closing_sync);
  TEST(cut_before_a_late_force);
  TEST(a_bus_that_goes_on_behind_the_last_sync);
  TEST(bad_inputs_are_passed_over);
  TEST(commands_without_an_answer);
  TEST(missing_frames);
  TEST(damaged_frames);
  TEST(the_next_round_of_counters_is_no_substitute);
  TEST(from_a_save);
  TEST(a_device_log);
  TEST(times_of_ticks);
  TEST(recorded_and_read);
  TEST(not_recordable);
  return test_end();
}
