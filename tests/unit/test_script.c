/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/bus/script.h"

#include "tests/lib/test.h"

static script s;
static candump_error error;

static int parse(const char *text) {
  memset(&error, 0, sizeof error);
  return script_parse("x.hand", text, strlen(text), &s, &error);
}

static void a_script(void) {
  CHECK(parse("rate 500 Hz seed 7 noise 4.5 um # comment\n"
              "duration 2.001 s\n"
              "command 0.1 s start  command 100 ms zero command 0.2 s halt\n"
              "left{ 0 s 0 0 0 mm  1 s -2.5 0.000001 65 mm}\n"
              "right { 500 ms 1 -1 0.5 cm }\n"));
  CHECK_EQ_INT(s.rate_hz, 500);
  CHECK_EQ_INT(s.seed, 7);
  CHECK_EQ_INT(s.noise_nm, 4500);
  CHECK_EQ_INT(s.duration_us, 2001000);
  CHECK_EQ_INT(script_ticks(&s), 1001);
  CHECK_EQ_INT(s.commands, 3);
  CHECK_EQ_INT(s.command[1].verb, FRAY_COMMAND_ZERO);
  CHECK_EQ_INT(s.command[1].time_us, 100000);
  CHECK_EQ_INT(s.command[2].verb, FRAY_COMMAND_HALT);
  CHECK_EQ_INT(script_tick_at(&s, 100000), 50);
  CHECK_EQ_INT(script_tick_at(&s, 100001), 51);
  CHECK_EQ_INT(s.keys[0], 2);
  CHECK_EQ_INT(s.key[0][1].at_nm[0], -2500000);
  CHECK_EQ_INT(s.key[0][1].at_nm[1], 1);
  CHECK_EQ_INT(s.key[0][1].at_nm[2], 65000000);
  CHECK_EQ_INT(s.key[1][0].at_nm[0], 10000000);
  CHECK_EQ_INT(s.key[1][0].at_nm[1], -10000000);
}

/* 3t^2 - 2t^3 at a quarter is 5/32, at a half 1/2. */
static void smooth_way(void) {
  CHECK(parse("rate 1000 Hz duration 3 s left { 1 s 0 10 0 mm 2 s 32 -10 0 mm }"));
  CHECK_EQ_INT(script_pose(&s, 0, 0).x, 0);
  CHECK_EQ_INT(script_pose(&s, 0, 0).y, 5000);
  CHECK_EQ_INT(script_pose(&s, 0, 1000).x, 0);
  CHECK_EQ_INT(script_pose(&s, 0, 1250).x, 2500);
  CHECK_EQ_INT(script_pose(&s, 0, 1250).y, 3438); /* 10 - 20 * 5/32 = 6.875 mm, halves away */
  CHECK_EQ_INT(script_pose(&s, 0, 1500).x, 8000);
  CHECK_EQ_INT(script_pose(&s, 0, 1500).y, 0);
  CHECK_EQ_INT(script_pose(&s, 0, 1750).y, -3438); /* mirrored */
  CHECK_EQ_INT(script_pose(&s, 0, 2000).x, 16000);
  CHECK_EQ_INT(script_pose(&s, 0, 2999).x, 16000);
}

static void noise_is_seeded_and_bounded(void) {
  int different = 0;
  CHECK(parse("duration 1 s noise 20 um left { 0 s 65 0 -65 mm }"));
  script other = s;
  other.seed = 2;
  for (uint32_t tick = 0; tick < 1000; ++tick) {
    const fray_pose pose = script_pose(&s, 0, tick);
    CHECK(pose.x >= 32490 && pose.x <= 32510);
    CHECK(pose.z >= -32510 && pose.z <= -32490);
    different += pose.x != script_pose(&other, 0, tick).x;
  }
  CHECK(different > 800);
}

static void refused(const char *text, int line, int column, const char *message) {
  CHECK(!parse(text));
  CHECK_TEXT(error.file, "x.hand");
  CHECK_EQ_INT(error.line, line);
  CHECK_EQ_INT(error.column, column);
  CHECK_TEXT(error.message, message);
}

static void refused_scripts(void) {
  refused("", 1, 1, "found the end of the file, expected a duration, e.g. duration 5 s");
  refused("\n dur\033[31mX 1 s\n", 2, 5, "found the byte 0x1B, expected printable ASCII");
  refused("duration 1 s\n", 1, 13,
          "found the end of the file, expected a hand: left or right { keyframes }");
  refused("\n  speed 3", 2, 3,
          "found 'speed', expected rate, seed, noise, instance, duration, arm, command, left or right");
  refused("rate 0 Hz", 1, 6, "found '0', expected a whole rate of 1 to 10000");
  refused("rate 1.5 Hz", 1, 6, "found '1.5', expected a whole rate of 1 to 10000");
  refused("rate 1000", 1, 10, "found the end of the file, expected the rate's unit: Hz");
  refused("seed 1 seed 2", 1, 8, "found 'seed', expected another key: this one was given before");
  refused("noise 501 um", 1, 7, "found '501', expected a noise of 0 to 500 um");
  refused("noise 1.2345 um", 1, 7,
          "found '1.2345', expected at most 3 digits after the point of a length in um");
  refused("arm 0.3 g 500 N/m 2", 1, 9, "found 'g', expected the mass's unit: kg");
  refused("arm 200 kg 500 N/m 2", 1, 5, "found '200', expected a mass of 0.01 to 100 kg");
  refused("arm 0.3 kg 20000 N/m 2", 1, 12, "found '20000', expected a stiffness of 0 to 10000 N/m");
  refused("arm 0.3 kg 500 N/m 5", 1, 20, "found '5', expected a delay of 1 to 4 ticks");
  refused("duration 5", 1, 11, "found the end of the file, expected the time's unit: s or ms");
  refused("duration 1e3 s", 1, 10, "found '1e3', expected a time, e.g. 0.5 s");
  refused("duration 1. s", 1, 10, "found '1.', expected a time, e.g. 0.5 s");
  refused("duration 36001 s", 1, 10, "found '36001', expected a time of 0 s to 36000 s");
  refused("command 1 s go", 1, 13, "found 'go', expected a command: start, stop, reset, zero or halt");
  refused("command 1 s stop command 0 s stop", 1, 26,
          "found '0', expected a time not before that of the command before");
  refused("left 0 s", 1, 6, "found '0', expected '{' and the keyframes of this hand");
  refused("left { }", 1, 8, "found '}', expected a keyframe, e.g. 0 s 0 0 0 mm");
  refused("left { 0 s 0 0 0 mm", 1, 20, "found the end of the file, expected a time, e.g. 0.5 s");
  refused("left { 0 s 0 0 mm }", 1, 16, "found 'mm', expected x, y and z, e.g. -25 2 0 mm");
  refused("left {\n 1 s 0 0 0 mm\n 1 s 0 0 0 mm }", 3, 2,
          "found '1', expected a time after that of the keyframe before");
  refused("left { 0 s 0 66 0 mm }", 1, 12, "found '0', expected x, y and z within +-65 mm");
}

int main(void) {
  TEST(a_script);
  TEST(smooth_way);
  TEST(noise_is_seeded_and_bounded);
  TEST(refused_scripts);
  return test_end();
}
