/* SPDX-License-Identifier: Apache-2.0 */
/* The words of the message table: every message's signals with bits, steps, ranges, units, names of
 * values and comments. tools/dictionary_text.c writes fray.dbc and the tables of README.md from it;
 * nothing of it is in the runtime. */
#ifndef FRAY_WIRE_SIGNALS_H
#define FRAY_WIRE_SIGNALS_H

#include <stdint.h>

#include "rt/fray.h"
#include "rt/wire/codec.h"
#include "rt/wire/dictionary.h"

typedef struct {
  uint32_t value;
  const char *name; /* NULL ends a list */
} signals_value;

/* Little-endian. A value is its raw number times step_milli / 1000, in `unit`. */
typedef struct {
  const char *name; /* NULL ends a list; in the DBC after the message's name and `_` */
  uint8_t start, bits;
  uint8_t is_signed;
  uint16_t step_milli;
  const char *unit;
  int64_t least, most; /* raw */
  const signals_value *values; /* or NULL */
  const char *comment;         /* or NULL */
} signals_signal;

typedef struct {
  const char *name;
  const char *from, *to;
  const signals_signal *signals; /* of a protected form: those of the plain one */
  const char *comment;
} signals_message;

#define SIGNALS_PLAIN(name, start, bits, values, comment) \
  { name, start, bits, 0, 1000, "", 0, (INT64_C(1) << (bits)) - 1, values, comment }
#define SIGNALS_AXIS(name, start, step_milli, unit) \
  { name, start, 16, 1, step_milli, unit, INT16_MIN, INT16_MAX, 0, 0 }
#define SIGNALS_CRC \
  SIGNALS_PLAIN("CRC", 0, 8, 0, "E2E: CRC-8H2F of bytes 1..7 and the entry of the id list.")
#define SIGNALS_END { 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 }

static const signals_value SIGNALS_VERBS[] = {
    {FRAY_VERB_START, "START"}, {FRAY_VERB_STOP, "STOP"}, {FRAY_VERB_RESET, "RESET"},
    {FRAY_VERB_ZERO, "ZERO"},   {FRAY_VERB_HALT, "HALT"}, {0, 0}};
static const signals_value SIGNALS_RESULTS[] = {{FRAY_RESULT_OK, "OK"},
                                                {FRAY_RESULT_REFUSED, "REFUSED"},
                                                {FRAY_RESULT_UNKNOWN, "UNKNOWN"},
                                                {0, 0}};
static const signals_value SIGNALS_STATES[] = {{0, "INIT"},
                                               {FRAY_READY, "READY"},
                                               {FRAY_OPERATIONAL, "OPERATIONAL"},
                                               {FRAY_SAFE, "SAFE"},
                                               {0, 0}};
static const signals_value SIGNALS_KINDS[] = {
    {CODEC_TEAR_STRUCTURAL, "STRUCTURAL"}, {CODEC_TEAR_TRIANGLES, "TRIANGLES"},
    {CODEC_TEAR_CUT, "CUT"}, {0, 0}};
static const signals_value SIGNALS_FAULTS[6][3] = {
    {{0, "OK"}, {1, "STALE_LEFT"}, {0, 0}},    {{0, "OK"}, {1, "STALE_RIGHT"}, {0, 0}},
    {{0, "OK"}, {1, "CONTACTS_FULL"}, {0, 0}}, {{0, "OK"}, {1, "CUTS_WAIT"}, {0, 0}},
    {{0, "OK"}, {1, "LEFT_WORLD"}, {0, 0}},    {{0, "OK"}, {1, "HALTED"}, {0, 0}}};

static const signals_signal SIGNALS_SYNC[] = {
    SIGNALS_PLAIN("Tick", 0, 32, 0, 0),
    SIGNALS_PLAIN("Hash", 32, 32, 0, "Low 32 bits of the state's hash after the tick before."),
    SIGNALS_END};

static const signals_signal SIGNALS_COMMAND[] = {
    SIGNALS_CRC,
    SIGNALS_PLAIN("Counter", 8, 4, 0, 0),
    {"Verb", 16, 8, 0, 1000, "", 1, 255, SIGNALS_VERBS, "Others are answered UNKNOWN."},
    SIGNALS_PLAIN("Argument", 32, 32, 0, "No verb has one yet: send 0."),
    SIGNALS_END};

static const signals_signal SIGNALS_ACK[] = {
    SIGNALS_CRC,
    SIGNALS_PLAIN("Counter", 8, 4, 0, "The tick, modulo 16."),
    SIGNALS_PLAIN("CommandCounter", 12, 4, 0, "Counter of the COMMAND."),
    {"Verb", 16, 8, 0, 1000, "", 1, 255, SIGNALS_VERBS, 0},
    {"Result", 24, 8, 0, 1000, "", 0, FRAY_RESULT_UNKNOWN, SIGNALS_RESULTS, 0},
    SIGNALS_PLAIN("Tick", 32, 32, 0, 0),
    SIGNALS_END};

static const signals_signal SIGNALS_POSE[] = {
    SIGNALS_CRC,
    SIGNALS_PLAIN("Counter", 8, 4, 0, 0),
    SIGNALS_PLAIN("Buttons", 12, 4, 0, 0),
    SIGNALS_AXIS("X", 16, DICTIONARY_POSE_UM * 1000, "um"),
    SIGNALS_AXIS("Y", 32, DICTIONARY_POSE_UM * 1000, "um"),
    SIGNALS_AXIS("Z", 48, DICTIONARY_POSE_UM * 1000, "um"),
    SIGNALS_END};

static const signals_signal SIGNALS_FORCE[] = {
    SIGNALS_CRC,
    SIGNALS_PLAIN("Counter", 8, 4, 0, "The tick, modulo 16."),
    SIGNALS_PLAIN("Consumed", 12, 4, 0,
                  "Counter of the last POSE that the runtime consumed; 0 before the first."),
    SIGNALS_AXIS("X", 16, DICTIONARY_FORCE_UN, "mN"),
    SIGNALS_AXIS("Y", 32, DICTIONARY_FORCE_UN, "mN"),
    SIGNALS_AXIS("Z", 48, DICTIONARY_FORCE_UN, "mN"),
    SIGNALS_END};

static const signals_signal SIGNALS_TEAR[] = {
    {"Kind", 0, 8, 0, 1000, "", 1, 3, SIGNALS_KINDS, 0},
    SIGNALS_PLAIN("More", 16, 16, 0, "How many more in this tick, saturated."),
    SIGNALS_PLAIN("Element", 32, 32, 0, "Canonical number of the structural spring, or the vertex where triangles tore or were cut."),
    SIGNALS_END};

static const signals_signal SIGNALS_STATUS[] = {
    {"State", 0, 8, 0, 1000, "", 0, FRAY_SAFE, SIGNALS_STATES, 0},
    {"PoolFill", 8, 8, 0, 1000, "%", 0, 100, 0, "Of the fullest pool."},
    SIGNALS_PLAIN("StaleLeft", 16, 1, SIGNALS_FAULTS[0], 0),
    SIGNALS_PLAIN("StaleRight", 17, 1, SIGNALS_FAULTS[1], 0),
    SIGNALS_PLAIN("ContactsFull", 18, 1, SIGNALS_FAULTS[2], 0),
    SIGNALS_PLAIN("CutsWait", 19, 1, SIGNALS_FAULTS[3], 0),
    SIGNALS_PLAIN("LeftWorld", 20, 1, SIGNALS_FAULTS[4], 0),
    SIGNALS_PLAIN("Halted", 21, 1, SIGNALS_FAULTS[5], 0),
    SIGNALS_PLAIN("Overruns", 32, 16, 0, "Ticks that came late, saturated."),
    SIGNALS_PLAIN("Tears", 48, 16, 0, "Springs cut, tears and cuts of triangle sheets in all, saturated."),
    SIGNALS_END};

static const signals_signal SIGNALS_TAG[] = {
    SIGNALS_PLAIN("Freshness", 0, 16, 0, "Its low 16 bits."),
    SIGNALS_PLAIN("Tag", 16, 48, 0, "The first 6 bytes of the CMAC."),
    SIGNALS_END};

/* What a protected form has after the 8 bytes of its plain message. */
static const signals_signal SIGNALS_TRAILER[] = {
    SIGNALS_PLAIN("Freshness", 64, 32, 0, "Rises strictly; never wraps."),
    SIGNALS_PLAIN("Tag0", 96, 32, 0, "Bytes 0..3 of the CMAC."),
    SIGNALS_PLAIN("Tag1", 128, 32, 0, "Bytes 4..7 of the CMAC."),
    SIGNALS_END};

#define SIGNALS_AUTH(plain) "Authenticated form of " plain " on CAN FD; its own lane of freshness."

static const signals_message SIGNALS[MESSAGES] = {
    [MESSAGE_SYNC] = {"SYNC", "Runtime", "Device,Operator", SIGNALS_SYNC,
                      "Opens a tick: its number, and the low 32 bits of the state's hash after the "
                      "tick before."},
    [MESSAGE_COMMAND] = {"COMMAND", "Operator", "Runtime", SIGNALS_COMMAND,
                         "An order to the runtime; it is answered by one ACK. Reserved bits are 0. "
                         "Counter rises by one from 1, modulo 16."},
    [MESSAGE_ACK] = {"ACK", "Runtime", "Operator", SIGNALS_ACK,
                     "Answers a COMMAND in the tick that took it. Its counter is that tick, modulo "
                     "16."},
    [MESSAGE_POSE_LEFT] = {"POSE_LEFT", "Device", "Runtime", SIGNALS_POSE,
                           "Where the left hand is. Counter rises by one from 1, modulo 16."},
    [MESSAGE_POSE_RIGHT] = {"POSE_RIGHT", "Device", "Runtime", SIGNALS_POSE,
                            "Where the right hand is. Counter rises by one from 1, modulo 16."},
    [MESSAGE_FORCE_LEFT] = {"FORCE_LEFT", "Runtime", "Device", SIGNALS_FORCE,
                            "Force on the left hand, in every tick. Its counter is the tick, modulo "
                            "16."},
    [MESSAGE_FORCE_RIGHT] = {"FORCE_RIGHT", "Runtime", "Device", SIGNALS_FORCE,
                             "Force on the right hand, in every tick. Its counter is the tick, "
                             "modulo 16."},
    [MESSAGE_TEAR] = {"TEAR", "Runtime", "Device,Operator", SIGNALS_TEAR,
                      "Springs were cut, or a triangle sheet tore or was cut, in a tick: the first one, and how many more. At most one a "
                      "tick."},
    [MESSAGE_STATUS] = {"STATUS", "Runtime", "Device,Operator", SIGNALS_STATUS,
                        "On a change of state or faults, and at 10 Hz."},
    [MESSAGE_COMMAND_AUTH] = {"COMMAND_AUTH", "Operator", "Runtime", SIGNALS_COMMAND,
                              SIGNALS_AUTH("COMMAND")},
    [MESSAGE_ACK_AUTH] = {"ACK_AUTH", "Runtime", "Operator", SIGNALS_ACK, SIGNALS_AUTH("ACK")},
    [MESSAGE_POSE_LEFT_AUTH] = {"POSE_LEFT_AUTH", "Device", "Runtime", SIGNALS_POSE,
                                SIGNALS_AUTH("POSE_LEFT")},
    [MESSAGE_POSE_RIGHT_AUTH] = {"POSE_RIGHT_AUTH", "Device", "Runtime", SIGNALS_POSE,
                                 SIGNALS_AUTH("POSE_RIGHT")},
    [MESSAGE_FORCE_LEFT_AUTH] = {"FORCE_LEFT_AUTH", "Runtime", "Device", SIGNALS_FORCE,
                                 SIGNALS_AUTH("FORCE_LEFT")},
    [MESSAGE_FORCE_RIGHT_AUTH] = {"FORCE_RIGHT_AUTH", "Runtime", "Device", SIGNALS_FORCE,
                                  SIGNALS_AUTH("FORCE_RIGHT")},
    [MESSAGE_TAG_LEFT] = {"TAG_LEFT", "Device", "Runtime", SIGNALS_TAG,
                          "After every fourth POSE_LEFT of the authenticated mode on classic CAN."},
    [MESSAGE_TAG_RIGHT] = {"TAG_RIGHT", "Device", "Runtime", SIGNALS_TAG,
                           "After every fourth POSE_RIGHT of the authenticated mode on classic "
                           "CAN."},
};

#endif
