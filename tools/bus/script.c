/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/bus/script.h"

#include <string.h>

#include "rt/base/random.h"
#include "rt/wire/dictionary.h"
#include "tools/bus/arm.h"
#include "tools/scene_language/lexer.h"

enum { WORD_MAX_BYTES = 32, TIME_MAX_S = 36000, RATE_MAX = 10000 };

typedef struct {
  const char *file;
  lexer l;
  uint32_t seen; /* bits of the statements seen that may come only once */
  script *out;
  candump_error *error;
  token last_move, last_command; /* the latest times, and where they stand */
  int64_t last_move_us, last_command_us;
} parser;

static void next(parser *p) { lexer_next(&p->l); }

static int is(const parser *p, const char *text) {
  const token *t = &p->l.token;
  return t->bytes == strlen(text) && memcmp(t->text, text, t->bytes) == 0;
}

static int fail_at(const parser *p, const token *t, const char *expected) {
  const int bytes = t->bytes > WORD_MAX_BYTES ? WORD_MAX_BYTES : (int)t->bytes;
  if (bytes == 0)
    return candump_fail(p->error, p->file, p->l.end_line, p->l.end_column, "found the end of the file, expected %s",
                        expected);
  return candump_fail(p->error, p->file, t->line, t->column, "found '%.*s', expected %s", bytes, t->text,
                      expected);
}

static int fail(const parser *p, const char *expected) { return fail_at(p, &p->l.token, expected); }

/* A decimal number in millionths. Up to 9 digits before the point and 6 after it. */
static int read_number(parser *p, int64_t *millionths, const char *expected) {
  const char *t = p->l.token.text;
  const size_t bytes = p->l.token.bytes;
  const int negative = bytes > 0 && t[0] == '-';
  size_t n = negative ? 1u : 0u;
  int64_t value = 0;
  int whole = 0, part = 0;
  for (; n < bytes && t[n] >= '0' && t[n] <= '9' && whole < 9; ++n, ++whole) {
    value = value * 10 + (t[n] - '0');
  }
  if (n < bytes && t[n] == '.') {
    for (++n; n < bytes && t[n] >= '0' && t[n] <= '9' && part < 6; ++n, ++part) {
      value = value * 10 + (t[n] - '0');
    }
    if (part == 0) return fail(p, expected);
  }
  if (whole == 0 || n != bytes) return fail(p, expected);
  for (; part < 6; ++part) value *= 10;
  *millionths = negative ? -value : value;
  next(p);
  return 1;
}

static int read_whole(parser *p, int64_t low, int64_t high, uint32_t *out, const char *expected) {
  const token start = p->l.token;
  int64_t value;
  if (!read_number(p, &value, expected)) return 0;
  if (value % 1000000 != 0 || value / 1000000 < low || value / 1000000 > high)
    return fail_at(p, &start, expected);
  *out = (uint32_t)(value / 1000000);
  return 1;
}

static int read_time(parser *p, int64_t *time_us) {
  const token start = p->l.token;
  int64_t value;
  if (!read_number(p, &value, "a time, e.g. 0.5 s")) return 0;
  if (is(p, "ms")) {
    if (value % 1000 != 0)
      return fail_at(p, &start, "at most 3 digits after the point of a time in ms");
    value /= 1000;
  } else if (!is(p, "s")) {
    return fail(p, "the time's unit: s or ms");
  }
  next(p);
  if (value < 0 || value > (int64_t)TIME_MAX_S * 1000000)
    return fail_at(p, &start, "a time of 0 s to 36000 s");
  *time_us = value;
  return 1;
}

/* The unit of lengths, then millionths of it to nanometres. */
static int read_length_unit(parser *p, const token *start, int64_t *lengths, size_t count) {
  const int cm = is(p, "cm"), um = is(p, "um");
  if (!cm && !um && !is(p, "mm")) return fail(p, "the length's unit: mm, cm or um");
  for (size_t n = 0; n < count; ++n) {
    if (um && lengths[n] % 1000 != 0)
      return fail_at(p, start, "at most 3 digits after the point of a length in um");
    lengths[n] = um ? lengths[n] / 1000 : (cm ? lengths[n] * 10 : lengths[n]);
  }
  next(p);
  return 1;
}

static int read_key(parser *p, script_keyframe *key, const script_keyframe *before) {
  const token start = p->l.token;
  if (!read_time(p, &key->time_us)) return 0;
  if (before != NULL && key->time_us <= before->time_us)
    return fail_at(p, &start, "a time after that of the keyframe before");
  if (key->time_us > p->last_move_us) {
    p->last_move = start;
    p->last_move_us = key->time_us;
  }
  const token place = p->l.token;
  int64_t at[3];
  for (int n = 0; n < 3; ++n) {
    if (!read_number(p, &at[n], "x, y and z, e.g. -25 2 0 mm")) return 0;
  }
  if (!read_length_unit(p, &place, at, 3)) return 0;
  for (int n = 0; n < 3; ++n) {
    if (at[n] < -SCRIPT_REACH_NM || at[n] > SCRIPT_REACH_NM)
      return fail_at(p, &place, "x, y and z within +-65 mm");
    key->at_nm[n] = (int32_t)at[n];
  }
  return 1;
}

static int read_hand(parser *p, uint32_t hand) {
  script *s = p->out;
  if (!is(p, "{")) return fail(p, "'{' and the keyframes of this hand");
  next(p);
  while (!is(p, "}")) {
    const uint32_t n = s->keys[hand];
    if (n == SCRIPT_KEYFRAMES) return fail(p, "'}' after 256 keyframes");
    const script_keyframe *before = n > 0 ? &s->key[hand][n - 1] : NULL;
    if (!read_key(p, &s->key[hand][n], before)) return 0;
    s->keys[hand] += 1;
  }
  if (s->keys[hand] == 0) return fail(p, "a keyframe, e.g. 0 s 0 0 0 mm");
  next(p);
  return 1;
}

static int read_command(parser *p) {
  static const char *const VERBS[] = {NULL, "start", "stop", "reset", "zero", "halt"};
  script *s = p->out;
  const token start = p->l.token;
  script_command *command = &s->command[s->commands];
  if (s->commands == SCRIPT_COMMANDS) return fail(p, "no more than 64 commands");
  if (!read_time(p, &command->time_us)) return 0;
  if (s->commands > 0 && command->time_us < command[-1].time_us)
    return fail_at(p, &start, "a time not before that of the command before");
  p->last_command = start;
  p->last_command_us = command->time_us;
  for (int verb = FRAY_COMMAND_START; verb <= FRAY_COMMAND_HALT; ++verb) {
    if (!is(p, VERBS[verb])) continue;
    command->verb = (fray_command)verb;
    s->commands += 1;
    next(p);
    return 1;
  }
  return fail(p, "a command: start, stop, reset, zero or halt");
}

static int read_noise(parser *p) {
  const token start = p->l.token;
  int64_t noise;
  if (!read_number(p, &noise, "a length, e.g. 4 um")) return 0;
  if (!read_length_unit(p, &start, &noise, 1)) return 0;
  if (noise < 0 || noise > SCRIPT_NOISE_NM_MAX)
    return fail_at(p, &start, "a noise of 0 to 500 um");
  p->out->noise_nm = (int32_t)noise;
  return 1;
}

static int read_rate(parser *p) {
  if (!read_whole(p, 1, RATE_MAX, &p->out->rate_hz, "a whole rate of 1 to 10000")) return 0;
  if (!is(p, "Hz")) return fail(p, "the rate's unit: Hz");
  next(p);
  return 1;
}

static int read_unit(parser *p, const char *unit, const char *expected) {
  if (!is(p, unit)) return fail(p, expected);
  next(p);
  return 1;
}

static int read_arm(parser *p) {
  script *s = p->out;
  const token mass = p->l.token;
  if (!read_number(p, &s->arm_mass_mg, "the mass of an arm, e.g. 0.3 kg") ||
      !read_unit(p, "kg", "the mass's unit: kg"))
    return 0;
  if (s->arm_mass_mg < 10000 || s->arm_mass_mg > 100000000) return fail_at(p, &mass, "a mass of 0.01 to 100 kg");
  const token stiffness = p->l.token;
  if (!read_number(p, &s->arm_stiffness_un, "the stiffness of an arm, e.g. 500 N/m") ||
      !read_unit(p, "N/m", "the stiffness's unit: N/m"))
    return 0;
  if (s->arm_stiffness_un < 0 || s->arm_stiffness_un > 10000000000)
    return fail_at(p, &stiffness, "a stiffness of 0 to 10000 N/m");
  return read_whole(p, 1, ARM_DELAY_MAX, &s->arm_delay, "a delay of 1 to 4 ticks");
}

static int read_statement(parser *p) {
  static const char *const ONCE[] = {"rate",     "seed", "noise", "instance",
                                     "duration", "left", "right", "arm"};
  enum { STATEMENTS = sizeof ONCE / sizeof ONCE[0] };
  uint32_t which = 0;
  while (which < STATEMENTS && !is(p, ONCE[which])) ++which;
  if (which == STATEMENTS && !is(p, "command")) {
    return fail(p, "rate, seed, noise, instance, duration, arm, command, left or right");
  }
  if (which < STATEMENTS && (p->seen >> which & 1u) != 0) {
    return fail(p, "another key: this one was given before");
  }
  p->seen |= 1u << which;
  next(p);
  switch (which) {
    case 0: return read_rate(p);
    case 1: return read_whole(p, 0, 999999999, &p->out->seed, "a whole seed of 0 to 999999999");
    case 2: return read_noise(p);
    case 3: return read_whole(p, 0, 7, &p->out->instance, "an instance of 0 to 7");
    case 4: return read_time(p, &p->out->duration_us);
    case 5: return read_hand(p, 0);
    case 6: return read_hand(p, 1);
    case 7: return read_arm(p);
    default: return read_command(p);
  }
}

static int check_text(const parser *p, const char *text, size_t bytes) {
  int line = 0, column = 0;
  unsigned byte = 0;
  return lexer_readable(text, bytes, &line, &column, &byte) ||
         candump_fail(p->error, p->file, line, column, "found the byte 0x%02X, expected printable ASCII", byte);
}

int script_parse(const char *file, const char *text, size_t bytes, script *out,
                 candump_error *error) {
  parser p = {.file = file, .out = out, .error = error};
  memset(out, 0, sizeof *out);
  out->rate_hz = 1000;
  out->seed = 1;
  lexer_start(&p.l, text, bytes);
  if (!check_text(&p, text, bytes)) return 0;
  while (p.l.token.bytes > 0) {
    if (!read_statement(&p)) return 0;
  }
  if (out->duration_us == 0) return fail(&p, "a duration, e.g. duration 5 s");
  if (out->keys[0] == 0 && out->keys[1] == 0) return fail(&p, "a hand: left or right { keyframes }");
  if (p.last_move_us > out->duration_us)
    return fail_at(&p, &p.last_move, "the keyframes of a hand within the duration");
  if (out->commands > 0 && p.last_command_us >= out->duration_us)
    return fail_at(&p, &p.last_command, "commands before the duration is over");
  return 1;
}

uint32_t script_tick_at(const script *s, int64_t time_us) {
  return (uint32_t)((time_us * s->rate_hz + 999999) / 1000000);
}

uint32_t script_ticks(const script *s) { return script_tick_at(s, s->duration_us); }

/* 3f^2 - 2f^3 of f = into / span, Q30. */
static int64_t smooth_q30(int64_t into, int64_t span) {
  const int64_t f = (into << 20) / span;
  return (f * f * ((3 << 20) - 2 * f)) >> 30;
}

static int64_t divide_round(int64_t v, int64_t by) {
  return v < 0 ? -((-v + by / 2) / by) : (v + by / 2) / by;
}

static int32_t place_nm(const script *s, uint32_t hand, uint32_t axis, int64_t time_us) {
  const script_keyframe *keys = s->key[hand];
  uint32_t n = 0;
  if (time_us <= keys[0].time_us) return keys[0].at_nm[axis];
  while (n + 1 < s->keys[hand] && keys[n + 1].time_us <= time_us) ++n;
  if (n + 1 == s->keys[hand]) return keys[n].at_nm[axis];
  const script_keyframe *a = &keys[n], *b = &keys[n + 1];
  const int64_t share = smooth_q30(time_us - a->time_us, b->time_us - a->time_us);
  const int64_t distance = (int64_t)b->at_nm[axis] - a->at_nm[axis];
  return (int32_t)(a->at_nm[axis] + divide_round(distance * share, 1 << 30));
}

fray_pose script_pose(const script *s, uint32_t hand, uint32_t tick) {
  const int64_t time_us = (int64_t)tick * 1000000 / s->rate_hz;
  int16_t steps[3];
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const uint32_t element = (tick * FRAY_HANDS + hand) * 3 + axis;
    const int32_t noise = random_between(s->seed, element, -s->noise_nm, s->noise_nm);
    const int64_t at = (int64_t)place_nm(s, hand, axis, time_us) + noise;
    steps[axis] = (int16_t)divide_round(at, DICTIONARY_POSE_UM * 1000);
  }
  const fray_pose pose = {steps[0], steps[1], steps[2], 0, 0};
  return pose;
}
