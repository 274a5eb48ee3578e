/* SPDX-License-Identifier: Apache-2.0 */
#include "platform/log/candump.h"

#include "tests/lib/test.h"

static candump_entry entry;
static candump_error error;

static int parse(const char *text) {
  memset(&error, 0, sizeof error);
  return candump_parse(text, strlen(text), 7, &entry, &error);
}

static void classic_frames(void) {
  CHECK_EQ_INT(parse("(1436509052.249713) vcan0 044#2A366C2BBA"), 1);
  CHECK(entry.time_us == INT64_C(1436509052249713));
  CHECK_EQ_INT(entry.line, 7);
  CHECK_EQ_INT(entry.frame.id, 0x44);
  CHECK_EQ_INT(entry.frame.extended, 0);
  CHECK_EQ_INT(entry.frame.length, 5);
  CHECK_EQ_INT(entry.frame.data[0], 0x2A);
  CHECK_EQ_INT(entry.frame.data[4], 0xBA);
  CHECK_EQ_INT(parse("(0.000001) can1 1E5F0a01#"), 1);
  CHECK_EQ_INT(entry.time_us, 1);
  CHECK_EQ_INT(entry.frame.id, 0x1E5F0A01);
  CHECK_EQ_INT(entry.frame.extended, 1);
  CHECK_EQ_INT(entry.frame.length, 0);
}

static void other_frames(void) {
  CHECK_EQ_INT(parse("(1.000000) vcan0 123#R"), 1);
  CHECK_EQ_INT(entry.frame.rtr, 1);
  CHECK_EQ_INT(entry.frame.length, 0);
  CHECK_EQ_INT(parse("(1.000000) vcan0 123#R4"), 1);
  CHECK_EQ_INT(entry.frame.length, 4);
  CHECK_EQ_INT(parse("(1.000000) vcan0 20000004#0000000000000000"), 1);
  CHECK_EQ_INT(entry.frame.error, 1);
  CHECK_EQ_INT(entry.frame.id, 4);
  CHECK_EQ_INT(parse("(1.000000) vcan0 123##1AABB"), 1);
  CHECK_EQ_INT(entry.frame.fd, FRAME_FD | FRAME_FD_BRS);
  CHECK_EQ_INT(entry.frame.length, 2);
  CHECK_EQ_INT(parse("(1.000000) vcan0 123##4000102030405060708090A0B"), 1);
  CHECK_EQ_INT(entry.frame.fd, FRAME_FD);
  CHECK_EQ_INT(entry.frame.length, 12);
  CHECK_EQ_INT(entry.frame.data[11], 11);
}

static void lines_without_frames(void) {
  CHECK_EQ_INT(parse(""), 0);
  CHECK_EQ_INT(parse("# a comment"), 0);
  CHECK_EQ_INT(parse("  "), 0);
  CHECK_EQ_INT(parse("DROPCOUNT: dropped 3 CAN frames on 'vcan0' socket (total drops 3)"), 0);
}

/* One frame in the forms of several tools, and what candump_format() makes of it. */
static void reads_as(const char *text, const char *strict) {
  char written[CANDUMP_TEXT];
  const int found = parse(text);
  CHECK_EQ_INT(found, 1);
  if (found != 1) {
    printf("%s: column %d: %s\n", text, error.column, error.message);
    return;
  }
  written[candump_format(written, "can0", entry.time_us, &entry.frame) - 1] = 0;
  CHECK_TEXT(written, strict);
}

/* python-can 4.1 and asc2log of can-utils 2020.11 */
static void directions(void) {
  static const char *const MARKS[] = {"", " R", " T"};
  static const char *const FRAMES[] = {"123#0a0B", "1E5F0A01#", "123#R", "123#R4", "123##1AABB",
                                       "20000080#0000000000000000"};
  static const char *const STRICT[] = {"123#0A0B", "1E5F0A01#", "123#R", "123#R4", "123##5AABB",
                                       "20000080#0000000000000000"};
  char text[128], strict[128];
  for (int n = 0; n < 6 * 3; ++n) {
    snprintf(text, sizeof text, "(1000000000.000001) can0 %s%s", FRAMES[n / 3], MARKS[n % 3]);
    snprintf(strict, sizeof strict, "(1000000000.000001) can0 %s", STRICT[n / 3]);
    reads_as(text, strict);
  }
}

/* candump without -L; log2long */
static void columns(void) {
  static const char *const FRAMES[][2] = {
      {"  vcan0  123   [8]  11 22 33 44 55 66 77 aA", "123#11223344556677AA"},
      {"  vcan0  123   [0] ", "123#"},
      {"  vcan0  1E5F0a01   [1]  02", "1E5F0A01#02"},
      {"  vcan0  123   [4]  remote request", "123#R4"},
      {"  vcan0       123   [0]  remote request", "123#R"},
      {"  vcan0  123  [02]  AA BB", "123##4AABB"},
      {"  vcan0  RX B -  123  [02]  AA BB", "123##5AABB"},
      {"  vcan0  TX B E  123  [12]  00 01 02 03 04 05 06 07 08 09 0A 0B", "123##7000102030405060708090A0B"},
      {"  vcan0  RX - -  123   [1]  AA", "123#AA"},
      {"  vcan0  20000080   [8]  00 00 00 00 00 00 00 00   ERRORFRAME", "20000080#0000000000000000"},
      {"  vcan0  123   [3]  41 27 5D                  'A']'", "123#41275D"},
      {"  vcan0  7FF   [0]                            ''", "7FF#"}};
  char text[160], strict[128];
  for (size_t n = 0; n < sizeof FRAMES / sizeof *FRAMES; ++n) {
    snprintf(strict, sizeof strict, "(0000000000.000000) can0 %s", FRAMES[n][1]);
    reads_as(FRAMES[n][0], strict);
    CHECK(entry.time_us == CANDUMP_NO_TIME);
    snprintf(text, sizeof text, " (1436509052.249713)%s", FRAMES[n][0]);
    snprintf(strict, sizeof strict, "(1436509052.249713) can0 %s", FRAMES[n][1]);
    reads_as(text, strict);
    reads_as(text + 1, strict);
  }
  reads_as(" (000.001000)  vcan0  123   [1]  00", "(0000000000.001000) can0 123#00");
}

static void refused(const char *text, int column, const char *message) {
  CHECK_EQ_INT(parse(text), -1);
  CHECK_EQ_INT(error.line, 7);
  CHECK_EQ_INT(error.column, column);
  CHECK_TEXT(error.message, message);
}

static void refused_times(void) {
  refused("(", 2, "found the end of the line, expected the seconds, 1 to 12 digits");
  refused("(x.000000) v 123#", 2, "found 'x', expected the seconds, 1 to 12 digits");
  refused("(-1.000000) v 123#", 2, "found '-', expected the seconds, 1 to 12 digits");
  refused("(1,000000) v 123#", 3, "found ',', expected '.' after the seconds");
  refused("(1.00000) v 123#", 9, "found ')', expected 6 digits of microseconds");
  refused("(1.0000000) v 123#", 10, "found '0', expected ')' after 6 digits of microseconds");
  refused("(1234567890123.000000) v 1#", 14, "found '3', expected '.' after the seconds");
  refused("(1.000000)v 123#", 11, "found 'v', expected a space after the time");
  refused("(1.000000) ", 12, "found the end of the line, expected the name of an interface");
  refused(" (2026-01-01 10:00:00.000000)  v  123   [0] ", 7, "found '-', expected '.' after the seconds");
}

static void refused_ids(void) {
  refused("(1.000000) v 12#", 16, "found '#', expected an id of 3 or 8 hex digits");
  refused("(1.000000) v 1234#", 18, "found '#', expected an id of 3 or 8 hex digits");
  refused("(1.000000) v 123456789#", 22, "found '9', expected '#' after an id of 8 digits");
  refused("(1.000000) v 800#", 14,
          "found '8', expected an id of at most 7FF (longer ids have 8 digits)");
  refused("(1.000000) v 40000000#", 14,
          "found '4', expected an id of at most 1FFFFFFF, or 20000000 and more for an error frame");
  refused("(1.000000) v 123", 17,
          "found the end of the line, expected '#' after an id of 3 digits");
}

static void refused_data(void) {
  refused("(1.000000) v 123#001", 21,
          "found the end of the line, expected a second hex digit of this byte");
  refused("(1.000000) v 123#00G0", 20, "found 'G', expected a hex digit or the end of the line");
  refused("(1.000000) v 123#00 ", 21,
          "found the end of the line, expected 'R' or 'T' (received, sent) after the space");
  refused("(1.000000) v 123#00 X", 21, "found 'X', expected 'R' or 'T' (received, sent) after the space");
  refused("(1.000000) v 123#00 RT", 22, "found 'T', expected the end of the line after the direction");
  refused("(1.000000) v 123#000102030405060708", 34,
          "found '0', expected the end of the line after 8 bytes");
  refused("(1.000000) v 123#R9", 19,
          "found '9', expected the end of the line or a length of 0 to 8 after 'R'");
  refused("(1.000000) v 123#R44", 20,
          "found '4', expected the end of the line after a remote request");
  refused("(1.000000) v 123##", 19,
          "found the end of the line, expected a hex digit of flags after '##'");
  refused("(1.000000) v 123##8", 19, "found '8', expected flags of 0 to 7 (1 BRS, 2 ESI, 4 FD)");
  refused("(1.000000) v 123##4000102030405060708", 38,
          "found the end of the line, expected 0 to 8, 12, 16, 20, 24, 32, 48 or 64 bytes");
}

static void refused_columns(void) {
  refused("  v", 4, "found the end of the line, expected a space after the interface's name (15 characters at most)");
  refused("  # indented", 5, "found 'i', expected an id of 3 or 8 hex digits");
  refused("  v  12   [0]", 8, "found a space, expected an id of 3 or 8 hex digits");
  refused("  v  123   8", 12, "found '8', expected '[' and the number of bytes");
  refused("  v  123   []", 13, "found ']', expected the number of bytes after '['");
  refused("  v  123   [9]  00", 14, "found ']', expected 0 to 8 bytes");
  refused("  v  123  [09]  00", 14, "found ']', expected 0 to 8, 12, 16, 20, 24, 32, 48 or 64 bytes");
  refused("  v  123   [2)", 14, "found ')', expected ']' after the number of bytes");
  refused("  v  123   [2]", 15, "found the end of the line, expected a space before the data");
  refused("  v  123   [2]  11", 19, "found the end of the line, expected a space between two bytes");
  refused("  v  123   [2]  11 2", 21, "found the end of the line, expected a second hex digit of this byte");
  refused("  v  123   [2]  11 22 33", 23, "found '3', expected the end of the line after as many bytes as the length says");
  refused("  v  123   [2]  22`11", 19, "found '`', expected a space between two bytes");
  refused("  v  RX B  123  [02]  11 22", 9, "found 'B', expected '- -', 'B -', '- E' or 'B E' after the direction");
  refused("  v  RX - -  123#", 17, "found '#', expected a space after the id");
  refused("  v  20000004  [08]  00", 19, "found ']', expected one digit of length: an error frame is a classic frame");
}

static void refused_lines(void) {
  refused("(1.000000) v 123#00\r", 20,
          "found a carriage return, expected a plain line feed (convert with dos2unix)");
  refused("# comment\r", 10,
          "found a carriage return, expected a plain line feed (convert with dos2unix)");
  char text[CANDUMP_LINE_MAX + 2];
  memset(text, '#', sizeof text);
  text[CANDUMP_LINE_MAX + 1] = 0;
  refused(text, 513, "the line is longer than 512 bytes, expected its end");
  text[CANDUMP_LINE_MAX] = 0;
  CHECK_EQ_INT(parse(text), 0);
}

static void whole_logs(void) {
  static const char TEXT[] =
      "# taken on a bench\n"
      "(2.000000) vcan0 101#01\n"
      "\n"
      "(1.500000) vcan0 102#02\n";
  candump_log log;
  CHECK(candump_parse_all("x.log", TEXT, sizeof TEXT - 1, &log, &error));
  CHECK_EQ_INT(log.count, 2);
  CHECK_EQ_INT(log.entries[0].line, 2);
  CHECK_EQ_INT(log.entries[1].line, 4);
  CHECK_EQ_INT(log.entries[1].time_us, 1500000);
  candump_free(&log);
  CHECK(!candump_parse_all("x.log", TEXT, sizeof TEXT - 2, &log, &error));
  CHECK_EQ_INT(log.count, 0);
  CHECK_TEXT(error.file, "x.log");
  CHECK_EQ_INT(error.line, 4);
  CHECK_EQ_INT(error.column, 24);
  CHECK_TEXT(error.message, "found the end of the file, expected a line feed: the log is cut off (--cut takes what is whole)");
  CHECK(error.incomplete);
  static const char OTHERS[] = "no frame\n# comment\n   \n\n(2.000000) vcan0 101#01\nnor this\n";
  CHECK(candump_parse_all("x.log", OTHERS, sizeof OTHERS - 1, &log, &error));
  CHECK_EQ_INT(log.count, 1);
  CHECK_EQ_INT(log.others, 2);
  CHECK_EQ_INT(log.other_line, 1);
  candump_free(&log);
  CHECK(candump_parse_all("x.log", "", 0, &log, &error));
  CHECK_EQ_INT(log.others, 0);
  CHECK_EQ_INT(log.count, 0);
  CHECK(!candump_load("no/such.log", &log, &error));
  CHECK_TEXT(error.message, "cannot be opened: No such file or directory");
}

static void many_lines(void) {
  static char text[3000 * 32];
  size_t bytes = 0;
  for (int n = 0; n < 3000; ++n) {
    bytes += (size_t)snprintf(text + bytes, 32, "(%d.000000) v 123#%02X\n", n, n & 255);
  }
  candump_log log;
  CHECK(candump_parse_all("x.log", text, bytes, &log, &error));
  CHECK_EQ_INT(log.count, 3000);
  CHECK_EQ_INT(log.entries[2999].frame.data[0], 2999 & 255);
  candump_free(&log);
}

static void written_as_read(void) {
  static const char *const LINES[] = {
      "(1436509052.249713) vcan0 044#2A366C2BBA\n",
      "(0000000001.000002) can1 1E5F0A01#\n",
      "(1000000000.000000) vcan0 123#R\n",
      "(1000000000.000000) vcan0 123#R4\n",
      "(1000000000.000000) vcan0 20000004#0000000000000000\n",
      "(1000000000.000000) vcan0 123##5AABB\n",
  };
  for (size_t n = 0; n < sizeof LINES / sizeof *LINES; ++n) {
    char text[CANDUMP_TEXT];
    CHECK_EQ_INT(candump_parse(LINES[n], strlen(LINES[n]) - 1, 1, &entry, &error), 1);
    CHECK_EQ_INT(candump_format(text, n == 1 ? "can1" : "vcan0", entry.time_us, &entry.frame),
                 strlen(LINES[n]));
    CHECK_TEXT(text, LINES[n]);
  }
}

int main(void) {
  TEST(classic_frames);
  TEST(other_frames);
  TEST(lines_without_frames);
  TEST(directions);
  TEST(columns);
  TEST(refused_times);
  TEST(refused_ids);
  TEST(refused_data);
  TEST(refused_columns);
  TEST(refused_lines);
  TEST(whole_logs);
  TEST(many_lines);
  TEST(written_as_read);
  return test_end();
}
