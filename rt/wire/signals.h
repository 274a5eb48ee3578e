/* SPDX-License-Identifier: Apache-2.0 */
/* The texts of the message table: every message's signals with bits, steps, ranges, units, names of values
 * and comments. tests/lib/dictionary_text.c writes fray.dbc and the tables of README.md from it. Data for
 * tools; the runtime does not include it. */
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
  int64_t min, max; /* raw */
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

static const signals_value SIGNALS_COMMANDS[] = {
    {FRAY_COMMAND_START, "START"}, {FRAY_COMMAND_STOP, "STOP"}, {FRAY_COMMAND_RESET, "RESET"},
    {FRAY_COMMAND_ZERO, "ZERO"},   {FRAY_COMMAND_HALT, "HALT"}, {0, 0}};
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
/* One bit of STATUS for each row of FRAY_FAULTS; values are named without FRAY_FAULT_. */
enum { SIGNALS_FAULT_FIRST = 16, SIGNALS_FAULT_PREFIX = sizeof "FRAY_FAULT_" - 1 };
#define SIGNALS_FAULT_VALUES(name, bit, signal, cause, action) \
  {{0, "OK"}, {1, &#name[SIGNALS_FAULT_PREFIX]}, {0, 0}},
static const signals_value SIGNALS_FAULTS[][3] = {FRAY_FAULTS(SIGNALS_FAULT_VALUES)};
#undef SIGNALS_FAULT_VALUES
#define SIGNALS_FAULT(name, bit, signal, cause, action) \
  SIGNALS_PLAIN(signal, SIGNALS_FAULT_FIRST + (bit), 1, SIGNALS_FAULTS[bit], cause " " action),

static const signals_signal SIGNALS_SYNC[] = {
    SIGNALS_PLAIN("Tick", 0, 32, 0, 0),
    SIGNALS_PLAIN("Hash", 32, 32, 0, "Low 32 bits of the state's hash after the tick before."),
    SIGNALS_END};

static const signals_signal SIGNALS_COMMAND[] = {
    SIGNALS_CRC,
    SIGNALS_PLAIN("Counter", 8, 4, 0, 0),
    {"Command", 16, 8, 0, 1000, "", 1, 255, SIGNALS_COMMANDS, "Others are answered UNKNOWN."},
    SIGNALS_PLAIN("Argument", 32, 32, 0, "No command has one yet: send 0."),
    SIGNALS_END};

static const signals_signal SIGNALS_ACK[] = {
    SIGNALS_CRC,
    SIGNALS_PLAIN("Counter", 8, 4, 0, "The tick, modulo 16."),
    SIGNALS_PLAIN("CommandCounter", 12, 4, 0, "Counter of the COMMAND."),
    {"Command", 16, 8, 0, 1000, "", 1, 255, SIGNALS_COMMANDS, 0},
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
    SIGNALS_PLAIN("Element", 32, 32, 0,
                  "Canonical number of the structural spring, or the vertex where a membrane tore or was "
                  "cut."),
    SIGNALS_END};

static const signals_signal SIGNALS_STATUS[] = {
    {"State", 0, 8, 0, 1000, "", 0, FRAY_SAFE, SIGNALS_STATES, 0},
    {"PoolFill", 8, 8, 0, 1000, "%", 0, 100, 0, "Of the fullest pool."},
    FRAY_FAULTS(SIGNALS_FAULT)
    SIGNALS_PLAIN("Overruns", 32, 16, 0, "Ticks that came late, saturated."),
    SIGNALS_PLAIN("Tears", 48, 16, 0, "Broken springs, tears and cuts of membranes in all, saturated."),
    SIGNALS_END};

static const signals_signal SIGNALS_TAG[] = {
    SIGNALS_PLAIN("Freshness", 0, 16, 0, "Its low 16 bits."),
    SIGNALS_PLAIN("Tag", 16, 48, 0, "The first 6 bytes of the CMAC."),
    SIGNALS_END};

static const signals_signal SIGNALS_IDENTITY[] = {
    SIGNALS_PLAIN("Physics", 0, 32, 0, "Id of the runtime's physics: equal ids, equal hashes."),
    SIGNALS_PLAIN("TickHigh", 32, 32, 0, "High 32 bits of the number of the next tick."),
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
                      "Starts a tick: its number, and the low 32 bits of the state's hash after the "
                      "tick before."},
    [MESSAGE_COMMAND] = {"COMMAND", "Operator", "Runtime", SIGNALS_COMMAND,
                         "A command to the runtime; one ACK answers it. Reserved bits are 0. "
                         "Counter rises by one from 1, modulo 16."},
    [MESSAGE_ACK] = {"ACK", "Runtime", "Operator", SIGNALS_ACK,
                     "Answers a COMMAND in the tick that consumed it. Its counter is that tick, modulo "
                     "16."},
    [MESSAGE_POSE_LEFT] = {"POSE_LEFT", "Device", "Runtime", SIGNALS_POSE,
                           "Position of the left hand. Counter rises by one from 1, modulo 16."},
    [MESSAGE_POSE_RIGHT] = {"POSE_RIGHT", "Device", "Runtime", SIGNALS_POSE,
                            "Position of the right hand. Counter rises by one from 1, modulo 16."},
    [MESSAGE_FORCE_LEFT] = {"FORCE_LEFT", "Runtime", "Device", SIGNALS_FORCE,
                            "Force on the left hand, in every tick. Its counter is the tick, modulo "
                            "16."},
    [MESSAGE_FORCE_RIGHT] = {"FORCE_RIGHT", "Runtime", "Device", SIGNALS_FORCE,
                             "Force on the right hand, in every tick. Its counter is the tick, "
                             "modulo 16."},
    [MESSAGE_TEAR] = {"TEAR", "Runtime", "Device,Operator", SIGNALS_TEAR,
                      "Springs broke, or a membrane tore or was cut, in a tick: the first one, and how "
                      "many more. At most one a tick."},
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
    [MESSAGE_IDENTITY] = {"IDENTITY", "Runtime", "Device,Operator", SIGNALS_IDENTITY,
                          "Before the first SYNC of a session, and before that of every tick whose low 32 "
                          "bits are 0."},
};

#endif
