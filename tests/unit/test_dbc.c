/* SPDX-License-Identifier: Apache-2.0 */
/* Holds the codec against rt/wire/fray.dbc. A small reader of the file picks each signal's raw
 * value out of frames that the codec made; every byte of the frames is told by some signal.
 * Run from the repository's root, or with the file's name as argument. */
#include <stdint.h>
#include <stdlib.h>

#include "rt/base/bytes.h"
#include "rt/wire/auth.h"
#include "rt/wire/codec.h"
#include "rt/wire/dictionary.h"
#include "tests/lib/test.h"

enum { SIGNALS_MAX = 256, MESSAGES_MAX = 32 };

typedef struct {
  char name[40];
  unsigned id, start, bits;
  char order, sign;
  char scale[16];
  char unit[8];
  double least, most;
  int used;
} signal;

typedef struct {
  char name[40];
  unsigned id, length, cycle_ms;
  unsigned format, switches; /* VFrameFormat, CANFD_BRS */
} message;

static char text[1 << 16];
static signal signals[SIGNALS_MAX];
static message messages[MESSAGES_MAX];
static int signal_count, message_count;

static message *message_by_id(unsigned id) {
  for (int n = 0; n < message_count; ++n) {
    if (messages[n].id == id) return &messages[n];
  }
  return NULL;
}

static void read_line(const char *line) {
  message *m = &messages[message_count];
  signal *s = &signals[signal_count];
  char attribute[32];
  unsigned id, value;
  if (sscanf(line, "BO_ %u %39[^:]: %u", &m->id, m->name, &m->length) == 3) {
    if (message_count < MESSAGES_MAX - 1) message_count += 1;
  } else if (sscanf(line, " SG_ %39s : %u|%u@%c%c (%15[^,],0) [%lf|%lf] \"%7[^\"]", s->name,
                    &s->start, &s->bits, &s->order, &s->sign, s->scale, &s->least, &s->most,
                    s->unit) >= 8) {
    s->id = messages[message_count - 1].id;
    if (signal_count < SIGNALS_MAX - 1) signal_count += 1;
  } else if (sscanf(line, "BA_ \"%31[^\"]\" BO_ %u %u;", attribute, &id, &value) == 3 && message_by_id(id) != NULL) {
    m = message_by_id(id);
    if (strcmp(attribute, "GenMsgCycleTime") == 0) m->cycle_ms = value;
    if (strcmp(attribute, "VFrameFormat") == 0) m->format = value;
    if (strcmp(attribute, "CANFD_BRS") == 0) m->switches = value;
  }
}

static void read_dbc(const char *file) {
  FILE *in = fopen(file, "rb");
  char line[512];
  if (in == NULL) {
    perror(file);
    exit(1);
  }
  text[fread(text, 1, sizeof text - 1, in)] = 0;
  rewind(in);
  while (fgets(line, sizeof line, in) != NULL) read_line(line);
  fclose(in);
}

static signal *signal_by_name(const char *name) {
  for (int n = 0; n < signal_count; ++n) {
    if (strcmp(signals[n].name, name) == 0) return &signals[n];
  }
  return NULL;
}

/* Little-endian: bit n of the frame is bit n % 8 of byte n / 8. */
static long long raw_value(const signal *s, const uint8_t *data) {
  uint64_t raw = 0;
  for (unsigned n = 0; n < s->bits; ++n) {
    const unsigned at = s->start + n;
    raw |= (uint64_t)(data[at / 8] >> at % 8 & 1) << n;
  }
  if (s->sign == '-' && (raw >> (s->bits - 1) & 1) != 0) {
    return (long long)raw - (1LL << s->bits);
  }
  return (long long)raw;
}

static void expect(const frame *f, const char *name, long long value) {
  signal *s = signal_by_name(name);
  CHECK(s != NULL);
  if (s == NULL) return;
  s->used += 1;
  CHECK_EQ_INT(s->id, f->id);
  CHECK_EQ_INT(s->order, '1');
  if (raw_value(s, f->data) != value) printf("%s\n", name);
  CHECK_EQ_INT(raw_value(s, f->data), value);
}

static void messages_are_the_dictionary(void) {
  static const char *const NAMES[MESSAGES] = {
      "SYNC",           "COMMAND",         "ACK",      "POSE_LEFT",    "POSE_RIGHT",
      "FORCE_LEFT",     "FORCE_RIGHT",     "TEAR",     "STATUS",       "COMMAND_AUTH",
      "ACK_AUTH",       "POSE_LEFT_AUTH",  "POSE_RIGHT_AUTH",          "FORCE_LEFT_AUTH",
      "FORCE_RIGHT_AUTH", "TAG_LEFT",      "TAG_RIGHT", "IDENTITY"};
  CHECK_EQ_INT(message_count, MESSAGES);
  for (int m = 0; m < (int)MESSAGES; ++m) {
    const message *found = message_by_id(dictionary_id((dictionary_message)m, 0));
    CHECK(found != NULL);
    if (found == NULL) continue;
    CHECK_TEXT(found->name, NAMES[m]);
    const int fd = strstr(found->name, "_AUTH") != NULL;
    CHECK_EQ_INT(found->length, fd ? 20 : 8);
    CHECK_EQ_INT(found->format, fd ? 14 : 0); /* StandardCAN_FD, StandardCAN */
    CHECK_EQ_INT(found->switches, fd);
    CHECK_EQ_INT(found->cycle_ms, DICTIONARY[m].cycle_ms);
  }
}

static void sync_signals(void) {
  frame f;
  const codec_sync sync = {0x80000001, 0xDEADBEEF};
  codec_encode_sync(&f, 0, &sync);
  expect(&f, "SYNC_Tick", 0x80000001LL);
  expect(&f, "SYNC_Hash", 0xDEADBEEFLL);
}

/* What is behind a hand's MESSAGE_, in the order of the values. */
static void expect_all(const frame *f, const char *name, const char *const of[6], const long long values[6]) {
  char signal_name[40];
  for (int n = 0; n < 6; ++n) {
    snprintf(signal_name, sizeof signal_name, "%s_%s", name, of[n]);
    expect(f, signal_name, values[n]);
  }
}

static void hand_signals(void) {
  static const char *const OF_POSE[] = {"CRC", "Counter", "Buttons", "X", "Y", "Z"};
  static const char *const OF_FORCE[] = {"CRC", "Counter", "Consumed", "X", "Y", "Z"};
  const fray_pose pose = {-32768, 2, 32767, 11, 6};
  const codec_force force = {-5, 32767, -32767, 9, 14};
  for (uint32_t hand = 0; hand < FRAY_HANDS; ++hand) {
    frame f;
    codec_encode_pose(&f, 0, hand, &pose);
    expect_all(&f, hand == 0 ? "POSE_LEFT" : "POSE_RIGHT", OF_POSE, (long long[]){f.data[0], 11, 6, -32768, 2, 32767});
    codec_encode_force(&f, 0, hand, &force);
    expect_all(&f, hand == 0 ? "FORCE_LEFT" : "FORCE_RIGHT", OF_FORCE,
               (long long[]){f.data[0], 9, 14, -5, 32767, -32767});
  }
}

static void command_and_ack_signals(void) {
  frame f;
  const codec_command command = {13, FRAY_COMMAND_ZERO, 0xCAFEF00D};
  codec_encode_command(&f, 0, &command);
  expect(&f, "COMMAND_CRC", f.data[0]);
  expect(&f, "COMMAND_Counter", 13);
  expect(&f, "COMMAND_Command", FRAY_COMMAND_ZERO);
  expect(&f, "COMMAND_Argument", 0xCAFEF00DLL);
  const codec_ack ack = {13, FRAY_COMMAND_RESET, FRAY_RESULT_UNKNOWN, 0x87654321};
  codec_encode_ack(&f, 0, &ack);
  expect(&f, "ACK_CRC", f.data[0]);
  expect(&f, "ACK_Counter", 1);
  expect(&f, "ACK_CommandCounter", 13);
  expect(&f, "ACK_Command", FRAY_COMMAND_RESET);
  expect(&f, "ACK_Result", FRAY_RESULT_UNKNOWN);
  expect(&f, "ACK_Tick", 0x87654321LL);
}

static void tear_signals(void) {
  frame f;
  const codec_tear tear = {CODEC_TEAR_STRUCTURAL, 0xFEDC, 0x12345678};
  codec_encode_tear(&f, 0, &tear);
  expect(&f, "TEAR_Kind", CODEC_TEAR_STRUCTURAL);
  expect(&f, "TEAR_More", 0xFEDC);
  expect(&f, "TEAR_Element", 0x12345678);
}

/* By hand: what is on the bus does not follow the table in rt/fray.h by itself. */
static const struct {
  uint16_t fault;
  const char *signal, *value;
} FAULTS[] = {{1u << 0, "StaleLeft", "STALE_LEFT"},
              {1u << 1, "StaleRight", "STALE_RIGHT"},
              {1u << 2, "ContactsFull", "CONTACTS_FULL"},
              {1u << 3, "BreakBudget", "BREAK_BUDGET"},
              {1u << 4, "OutOfWorld", "OUT_OF_WORLD"},
              {1u << 5, "Halted", "HALTED"},
              {1u << 6, "ParticlesFull", "PARTICLES_FULL"},
              {1u << 7, "SplitBudget", "SPLIT_BUDGET"},
              {1u << 8, "SelfCollisionBudget", "SELF_COLLISION_BUDGET"},
              {1u << 9, "ContactUnresolved", "CONTACT_UNRESOLVED"},
              {1u << 10, "MeshQueryBudget", "MESH_QUERY_BUDGET"},
              {1u << 11, "TrianglesFull", "TRIANGLES_FULL"},
              {1u << 12, "Overstretched", "OVERSTRETCHED"},
              {1u << 13, "SpeedLimit", "SPEED_LIMIT"}};
enum { FAULT_COUNT = sizeof FAULTS / sizeof *FAULTS };

static void status_signals(void) {
  char name[40];
  frame f;
  for (int n = 0; n < FAULT_COUNT; ++n) {
    const codec_status status = {FRAY_SAFE, 93, FAULTS[n].fault, 0xABCD, 0x1234};
    codec_encode_status(&f, 0, &status);
    for (int m = 0; m < FAULT_COUNT; ++m) {
      snprintf(name, sizeof name, "STATUS_%s", FAULTS[m].signal);
      expect(&f, name, m == n);
    }
  }
  CHECK_EQ_INT(FRAY_FAULTS_ALL, (1 << FAULT_COUNT) - 1);
  expect(&f, "STATUS_State", FRAY_SAFE);
  expect(&f, "STATUS_PoolFill", 93);
  expect(&f, "STATUS_Overruns", 0xABCD);
  expect(&f, "STATUS_Tears", 0x1234);
}

static void identity_signals(void) {
  frame f;
  const codec_identity identity = {0xDEADBEEF, 0x80000001};
  codec_encode_identity(&f, 0, &identity);
  expect(&f, "IDENTITY_Physics", 0xDEADBEEFLL);
  expect(&f, "IDENTITY_TickHigh", 0x80000001LL);
}

/* A protected frame of zeros but for its counter: what its plain signals are is told above. */
static void auth_signals(dictionary_message plain, const char *name, const char *const *of) {
  char text_of[64];
  cmac_key key = {0};
  auth_lane lane;
  frame f = {0};
  auth_lane_init(&lane, &key, plain, 0, 0x89ABCDEE);
  f.id = dictionary_id(plain, 0);
  f.length = 8;
  for (int n = 0; n < 8; ++n) f.data[n] = (uint8_t)(0xF1 - 17 * n);
  CHECK_EQ_INT(auth_seal(&lane, &f), AUTH_OK);
  for (; *of != NULL; ++of) {
    snprintf(text_of, sizeof text_of, "%s_%s", name, *of);
    const signal *same = signal_by_name(text_of);
    CHECK(same != NULL);
    snprintf(text_of, sizeof text_of, "%s_AUTH_%s", name, *of);
    if (same != NULL) expect(&f, text_of, raw_value(same, f.data));
  }
  const struct {
    const char *of;
    long long value;
  } own[] = {{"CRC", 0xF1}, {"Freshness", 0x89ABCDEFLL}, {"Tag0", bytes_load32(f.data + 12)},
             {"Tag1", bytes_load32(f.data + 16)}};
  for (int n = 0; n < 4; ++n) {
    snprintf(text_of, sizeof text_of, "%s_AUTH_%s", name, own[n].of);
    expect(&f, text_of, own[n].value);
  }
}

static void protected_signals(void) {
  static const char *const OF_POSE[] = {"Counter", "Buttons", "X", "Y", "Z", NULL};
  static const char *const OF_FORCE[] = {"Counter", "Consumed", "X", "Y", "Z", NULL};
  auth_signals(MESSAGE_COMMAND, "COMMAND", (const char *const[]){"Counter", "Command", "Argument", NULL});
  auth_signals(MESSAGE_ACK, "ACK", (const char *const[]){"Counter", "CommandCounter", "Command", "Result", "Tick", NULL});
  auth_signals(MESSAGE_POSE_LEFT, "POSE_LEFT", OF_POSE);
  auth_signals(MESSAGE_POSE_RIGHT, "POSE_RIGHT", OF_POSE);
  auth_signals(MESSAGE_FORCE_LEFT, "FORCE_LEFT", OF_FORCE);
  auth_signals(MESSAGE_FORCE_RIGHT, "FORCE_RIGHT", OF_FORCE);
}

static void tag_signals(uint32_t hand, const char *freshness, const char *tag) {
  const cmac_key key = {0};
  auth_group group;
  frame f = {0}, pose = {0};
  auth_group_init(&group, &key, 0, hand, 0x1FEDB);
  pose.id = dictionary_id(dictionary_pose(hand), 0);
  pose.length = 8;
  for (int n = 0; n < 4; ++n) CHECK_EQ_INT(auth_group_add(&group, &pose, &f), n == 3);
  expect(&f, freshness, 0xFEDC);
  expect(&f, tag, (long long)bytes_load16(f.data + 2) + ((long long)bytes_load32(f.data + 4) << 16));
}

static void tags_signals(void) {
  tag_signals(0, "TAG_LEFT_Freshness", "TAG_LEFT_Tag");
  tag_signals(1, "TAG_RIGHT_Freshness", "TAG_RIGHT_Tag");
}

/* Runs after the tests above. */
static void every_signal_was_checked(void) {
  for (int n = 0; n < signal_count; ++n) {
    if (signals[n].used == 0) printf("%s\n", signals[n].name);
    CHECK(signals[n].used > 0);
  }
}

static void scales_and_ranges(void) {
  int poses = 0, forces = 0;
  for (int n = 0; n < signal_count; ++n) {
    const signal *s = &signals[n];
    const double scale = strtod(s->scale, NULL);
    if (s->sign != '-') {
      CHECK_TEXT(s->scale, "1");
      CHECK(s->most <= (double)((1ULL << s->bits) - 1) && s->least >= 0);
      continue;
    }
    CHECK_EQ_INT(s->bits, 16);
    CHECK(s->least / scale == -32768.0 && s->most / scale == 32767.0);
    if (strcmp(s->unit, "um") == 0) {
      CHECK(scale == (double)DICTIONARY_POSE_UM);
      poses += 1;
    } else {
      CHECK_TEXT(s->unit, "mN");
      CHECK(scale * 1000.0 == (double)DICTIONARY_FORCE_UN);
      forces += 1;
    }
  }
  CHECK_EQ_INT(poses, 12); /* plain and protected */
  CHECK_EQ_INT(forces, 12);
}

static void values(int value, const char *line_start, const char *name) {
  char wanted[64];
  const char *line = strstr(text, line_start);
  CHECK(line != NULL);
  if (line == NULL) return;
  snprintf(wanted, sizeof wanted, " %d \"%s\"", value, name);
  const char *found = strstr(line, wanted);
  if (found == NULL || memchr(line, '\n', (size_t)(found - line)) != NULL) {
    printf("%s has no%s\n", line_start, wanted);
    CHECK(0);
  }
}

static void names_of_values(void) {
  static const char *const COMMANDS[] = {"VAL_ 16 COMMAND_Command", "VAL_ 17 ACK_Command",
                                      "VAL_ 32 COMMAND_AUTH_Command", "VAL_ 33 ACK_AUTH_Command"};
  static const struct {
    int value;
    const char *name;
  } VERBS[] = {{FRAY_COMMAND_START, "START"}, {FRAY_COMMAND_STOP, "STOP"}, {FRAY_COMMAND_RESET, "RESET"},
               {FRAY_COMMAND_ZERO, "ZERO"},   {FRAY_COMMAND_HALT, "HALT"}};
  for (int n = 0; n < 4 * 5; ++n) values(VERBS[n / 4].value, COMMANDS[n % 4], VERBS[n / 4].name);
  values(FRAY_RESULT_OK, "VAL_ 17 ACK_Result", "OK");
  values(FRAY_RESULT_REFUSED, "VAL_ 17 ACK_Result", "REFUSED");
  values(FRAY_RESULT_UNKNOWN, "VAL_ 17 ACK_Result", "UNKNOWN");
  values(CODEC_TEAR_STRUCTURAL, "VAL_ 512 TEAR_Kind", "STRUCTURAL");
  values(CODEC_TEAR_TRIANGLES, "VAL_ 512 TEAR_Kind", "TRIANGLES");
  values(CODEC_TEAR_CUT, "VAL_ 512 TEAR_Kind", "CUT");
  values(0, "VAL_ 1793 STATUS_State", "INIT");
  values(FRAY_READY, "VAL_ 1793 STATUS_State", "READY");
  values(FRAY_OPERATIONAL, "VAL_ 1793 STATUS_State", "OPERATIONAL");
  values(FRAY_SAFE, "VAL_ 1793 STATUS_State", "SAFE");
  for (int n = 0; n < FAULT_COUNT; ++n) {
    char start[48];
    snprintf(start, sizeof start, "VAL_ 1793 STATUS_%s ", FAULTS[n].signal);
    values(0, start, "OK");
    values(1, start, FAULTS[n].value);
  }
}

int main(int argc, char **argv) {
  read_dbc(argc > 1 ? argv[1] : "rt/wire/fray.dbc");
  TEST(messages_are_the_dictionary);
  TEST(sync_signals);
  TEST(hand_signals);
  TEST(command_and_ack_signals);
  TEST(tear_signals);
  TEST(status_signals);
  TEST(identity_signals);
  TEST(protected_signals);
  TEST(tags_signals);
  TEST(every_signal_was_checked);
  TEST(scales_and_ranges);
  TEST(names_of_values);
  return test_end();
}
