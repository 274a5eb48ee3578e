/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/script.h"

#include <string.h>

#include "rt/base/random.h"
#include "rt/wire/dictionary.h"

enum { WORD_MAX_BYTES = 32, TIME_MAX_S = 36000, RATE_MAX = 10000 };

/* One word of the text; bytes 0: the end. */
typedef struct {
  const char *text;
  size_t bytes;
  int line, column;
} word;

typedef struct {
  const char *file;
  const char *text;
  size_t bytes, at;
  int line, column;
  word now;
  uint32_t seen; /* keys of the language that stand only once */
  script *out;
  candump_error *error;
} parser;

static void step(parser *p) {
  if (p->text[p->at] == '\n') {
    p->line += 1;
    p->column = 1;
  } else {
    p->column += 1;
  }
  p->at += 1;
}

static int is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

static int is_brace(char c) { return c == '{' || c == '}'; }

static void next(parser *p) {
  while (p->at < p->bytes && (is_space(p->text[p->at]) || p->text[p->at] == '#')) {
    if (p->text[p->at] == '#') {
      while (p->at < p->bytes && p->text[p->at] != '\n') step(p);
    } else {
      step(p);
    }
  }
  p->now.text = p->text + p->at;
  p->now.line = p->line;
  p->now.column = p->column;
  const size_t start = p->at;
  while (p->at < p->bytes && !is_space(p->text[p->at]) && p->text[p->at] != '#') {
    if (is_brace(p->text[p->at]) && p->at > start) break;
    step(p);
    if (is_brace(p->text[p->at - 1])) break;
  }
  p->now.bytes = p->at - start;
}

static int is(const parser *p, const char *text) {
  return p->now.bytes == strlen(text) && memcmp(p->now.text, text, p->now.bytes) == 0;
}

static int fail(const parser *p, const char *expected) {
  const int bytes = p->now.bytes > WORD_MAX_BYTES ? WORD_MAX_BYTES : (int)p->now.bytes;
  if (bytes == 0) {
    return candump_fail(p->error, p->file, p->now.line, p->now.column,
                        "found the end of the file, expected %s", expected);
  }
  return candump_fail(p->error, p->file, p->now.line, p->now.column, "found '%.*s', expected %s",
                      bytes, p->now.text, expected);
}

/* A decimal number in millionths. Up to 9 digits before the point and 6 after it. */
static int read_number(parser *p, int64_t *millionths, const char *expected) {
  const char *t = p->now.text;
  const size_t bytes = p->now.bytes;
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
  const word start = p->now;
  int64_t value;
  if (!read_number(p, &value, expected)) return 0;
  if (value % 1000000 != 0 || value / 1000000 < low || value / 1000000 > high) {
    p->now = start;
    return fail(p, expected);
  }
  *out = (uint32_t)(value / 1000000);
  return 1;
}

static int read_time(parser *p, int64_t *time_us) {
  const word start = p->now;
  int64_t value;
  if (!read_number(p, &value, "a time, e.g. 0.5 s")) return 0;
  if (is(p, "ms")) {
    if (value % 1000 != 0) {
      p->now = start;
      return fail(p, "at most 3 digits after the point of a time in ms");
    }
    value /= 1000;
  } else if (!is(p, "s")) {
    return fail(p, "the time's unit: s or ms");
  }
  next(p);
  if (value < 0 || value > (int64_t)TIME_MAX_S * 1000000) {
    p->now = start;
    return fail(p, "a time of 0 s to 36000 s");
  }
  *time_us = value;
  return 1;
}

/* The unit of lengths, then millionths of it to nanometres. */
static int read_length_unit(parser *p, const word *start, int64_t *lengths, size_t count) {
  const int cm = is(p, "cm"), um = is(p, "um");
  if (!cm && !um && !is(p, "mm")) return fail(p, "the length's unit: mm, cm or um");
  for (size_t n = 0; n < count; ++n) {
    if (um && lengths[n] % 1000 != 0) {
      p->now = *start;
      return fail(p, "at most 3 digits after the point of a length in um");
    }
    lengths[n] = um ? lengths[n] / 1000 : (cm ? lengths[n] * 10 : lengths[n]);
  }
  next(p);
  return 1;
}

static int read_key(parser *p, script_key *key, const script_key *before) {
  const word start = p->now;
  if (!read_time(p, &key->time_us)) return 0;
  if (before != NULL && key->time_us <= before->time_us) {
    p->now = start;
    return fail(p, "a time after that of the key before");
  }
  const word place = p->now;
  int64_t at[3];
  for (int n = 0; n < 3; ++n) {
    if (!read_number(p, &at[n], "x, y and z, e.g. -25 2 0 mm")) return 0;
  }
  if (!read_length_unit(p, &place, at, 3)) return 0;
  for (int n = 0; n < 3; ++n) {
    if (at[n] < -SCRIPT_REACH_NM || at[n] > SCRIPT_REACH_NM) {
      p->now = place;
      return fail(p, "x, y and z within +-65 mm");
    }
    key->at_nm[n] = (int32_t)at[n];
  }
  return 1;
}

static int read_hand(parser *p, uint32_t hand) {
  script *s = p->out;
  if (!is(p, "{")) return fail(p, "'{' and the keys of this hand");
  next(p);
  while (!is(p, "}")) {
    const uint32_t n = s->keys[hand];
    if (n == SCRIPT_KEYS) return fail(p, "'}' after 256 keys");
    const script_key *before = n > 0 ? &s->key[hand][n - 1] : NULL;
    if (!read_key(p, &s->key[hand][n], before)) return 0;
    s->keys[hand] += 1;
  }
  if (s->keys[hand] == 0) return fail(p, "a key, e.g. 0 s 0 0 0 mm");
  next(p);
  return 1;
}

static int read_command(parser *p) {
  static const char *const VERBS[] = {NULL, "start", "stop", "reset", "zero", "halt"};
  script *s = p->out;
  const word start = p->now;
  script_command *command = &s->command[s->commands];
  if (s->commands == SCRIPT_COMMANDS) return fail(p, "no more than 64 commands");
  if (!read_time(p, &command->time_us)) return 0;
  if (s->commands > 0 && command->time_us < command[-1].time_us) {
    p->now = start;
    return fail(p, "a time not before that of the command before");
  }
  for (int verb = FRAY_VERB_START; verb <= FRAY_VERB_HALT; ++verb) {
    if (!is(p, VERBS[verb])) continue;
    command->verb = (fray_verb)verb;
    s->commands += 1;
    next(p);
    return 1;
  }
  return fail(p, "a command: start, stop, reset, zero or halt");
}

static int read_noise(parser *p) {
  const word start = p->now;
  int64_t noise;
  if (!read_number(p, &noise, "a length, e.g. 4 um")) return 0;
  if (!read_length_unit(p, &start, &noise, 1)) return 0;
  if (noise < 0 || noise > SCRIPT_NOISE_NM_MAX) {
    p->now = start;
    return fail(p, "a noise of 0 to 500 um");
  }
  p->out->noise_nm = (int32_t)noise;
  return 1;
}

static int read_rate(parser *p) {
  if (!read_whole(p, 1, RATE_MAX, &p->out->rate_hz, "a whole rate of 1 to 10000")) return 0;
  if (!is(p, "Hz")) return fail(p, "the rate's unit: Hz");
  next(p);
  return 1;
}

static int read_statement(parser *p) {
  static const char *const ONCE[] = {"rate",     "seed", "noise", "instance",
                                     "duration", "left", "right"};
  uint32_t which = 0;
  while (which < 7 && !is(p, ONCE[which])) ++which;
  if (which == 7 && !is(p, "command")) {
    return fail(p, "rate, seed, noise, instance, duration, command, left or right");
  }
  if (which < 7 && (p->seen >> which & 1u) != 0) {
    return fail(p, "something else: this was said before");
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
    default: return read_command(p);
  }
}

int script_parse(const char *file, const char *text, size_t bytes, script *out,
                 candump_error *error) {
  parser p = {file, text, bytes, 0, 1, 1, {NULL, 0, 0, 0}, 0, out, error};
  memset(out, 0, sizeof *out);
  out->rate_hz = 1000;
  out->seed = 1;
  next(&p);
  while (p.now.bytes > 0) {
    if (!read_statement(&p)) return 0;
  }
  if (out->duration_us == 0) return fail(&p, "a duration, e.g. duration 5 s");
  if (out->keys[0] == 0 && out->keys[1] == 0) return fail(&p, "a hand: left or right { keys }");
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
  const script_key *keys = s->key[hand];
  uint32_t n = 0;
  if (time_us <= keys[0].time_us) return keys[0].at_nm[axis];
  while (n + 1 < s->keys[hand] && keys[n + 1].time_us <= time_us) ++n;
  if (n + 1 == s->keys[hand]) return keys[n].at_nm[axis];
  const script_key *a = &keys[n], *b = &keys[n + 1];
  const int64_t share = smooth_q30(time_us - a->time_us, b->time_us - a->time_us);
  const int64_t way = (int64_t)b->at_nm[axis] - a->at_nm[axis];
  return (int32_t)(a->at_nm[axis] + divide_round(way * share, 1 << 30));
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
