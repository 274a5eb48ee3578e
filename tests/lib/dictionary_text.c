/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/lib/dictionary_text.h"

#include <inttypes.h>
#include <string.h>

#include "rt/wire/frame.h"
#include "rt/wire/signals.h"

enum { FRAME_FORMAT_FD = 14 }; /* StandardCAN_FD, among the names of VFrameFormat below */

static int is_auth(dictionary_message m) { return DICTIONARY[m].protects != MESSAGES; }

/* Messages in the order of their ids: MESSAGES after the last one. `from` is the id to begin at. */
static dictionary_message next_message(uint32_t *from) {
  for (; *from <= FRAME_ID_MAX; *from += 1) {
    const dictionary_message m = dictionary_find(*from, 0);
    if (m == MESSAGES) continue;
    *from += 1;
    return m;
  }
  return MESSAGES;
}

/* A raw value in its unit; steps are multiples of a tenth. */
static void write_scaled(FILE *out, int64_t raw, uint32_t step_milli) {
  const int64_t tenths = raw * (int64_t)(step_milli / 100);
  const int64_t size = tenths < 0 ? -tenths : tenths;
  fprintf(out, "%s%" PRId64, tenths < 0 ? "-" : "", size / 10);
  if (size % 10 != 0) fprintf(out, ".%" PRId64, size % 10);
}

static void write_signals(FILE *out, dictionary_message m, const signals_signal *list) {
  for (const signals_signal *s = list; s->name != NULL; ++s) {
    fprintf(out, " SG_ %s_%s : %u|%u@1%c (", SIGNALS[m].name, s->name, s->start, s->bits,
            s->is_signed ? '-' : '+');
    write_scaled(out, 1, s->step_milli);
    fprintf(out, ",0) [");
    write_scaled(out, s->min, s->step_milli);
    fprintf(out, "|");
    write_scaled(out, s->max, s->step_milli);
    fprintf(out, "] \"%s\" %s\n", s->unit, SIGNALS[m].to);
  }
}

static void write_signal_comments(FILE *out, dictionary_message m, const signals_signal *list) {
  for (const signals_signal *s = list; s->name != NULL; ++s) {
    if (s->comment == NULL) continue;
    fprintf(out, "CM_ SG_ %u %s_%s \"%s\";\n", (unsigned)dictionary_id(m, 0), SIGNALS[m].name,
            s->name, s->comment);
  }
}

static void write_values(FILE *out, dictionary_message m) {
  for (const signals_signal *s = SIGNALS[m].signals; s->name != NULL; ++s) {
    if (s->values == NULL) continue;
    fprintf(out, "VAL_ %u %s_%s", (unsigned)dictionary_id(m, 0), SIGNALS[m].name, s->name);
    for (const signals_value *v = s->values; v->name != NULL; ++v) {
      fprintf(out, " %u \"%s\"", (unsigned)v->value, v->name);
    }
    fprintf(out, " ;\n");
  }
}

static void write_attributes(FILE *out) {
  dictionary_message m;
  fprintf(out, "\nBA_DEF_ \"BusType\" STRING ;\n"
               "BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 65535;\n"
               "BA_DEF_ BO_ \"VFrameFormat\" ENUM \"StandardCAN\",\"ExtendedCAN\",\"reserved\","
               "\"J1939PG\"");
  for (int n = 4; n < FRAME_FORMAT_FD; ++n) fprintf(out, ",\"reserved\"");
  fprintf(out, ",\"StandardCAN_FD\",\"ExtendedCAN_FD\";\n"
               "BA_DEF_ BO_ \"CANFD_BRS\" ENUM \"0\",\"1\";\n"
               "BA_DEF_DEF_ \"BusType\" \"CAN\";\n"
               "BA_DEF_DEF_ \"GenMsgCycleTime\" 0;\n"
               "BA_DEF_DEF_ \"VFrameFormat\" \"StandardCAN\";\n"
               "BA_DEF_DEF_ \"CANFD_BRS\" \"0\";\n"
               "BA_ \"BusType\" \"CAN FD\";\n");
  for (uint32_t id = 0; (m = next_message(&id)) != MESSAGES;) {
    if (DICTIONARY[m].cycle_ms == 0) continue;
    fprintf(out, "BA_ \"GenMsgCycleTime\" BO_ %u %u;\n", DICTIONARY[m].id, DICTIONARY[m].cycle_ms);
  }
  for (uint32_t id = 0; (m = next_message(&id)) != MESSAGES;) {
    fprintf(out, "BA_ \"VFrameFormat\" BO_ %u %d;\n", DICTIONARY[m].id,
            is_auth(m) ? FRAME_FORMAT_FD : 0);
  }
  for (uint32_t id = 0; (m = next_message(&id)) != MESSAGES;) {
    if (is_auth(m)) fprintf(out, "BA_ \"CANFD_BRS\" BO_ %u 1;\n", DICTIONARY[m].id);
  }
}

void dictionary_write_dbc(FILE *out) {
  dictionary_message m;
  fprintf(out, "VERSION \"fray 1.3 instance 0\"\n\nNS_ :\n  CM_\n  BA_DEF_\n  BA_\n  VAL_\n"
               "  BA_DEF_DEF_\n\nBS_:\n\nBU_: Runtime Device Operator\n");
  for (uint32_t id = 0; (m = next_message(&id)) != MESSAGES;) {
    fprintf(out, "\nBO_ %u %s: %u %s\n", DICTIONARY[m].id, SIGNALS[m].name,
            (unsigned)dictionary_length(m), SIGNALS[m].from);
    write_signals(out, m, SIGNALS[m].signals);
    if (is_auth(m)) write_signals(out, m, SIGNALS_TRAILER);
  }
  fprintf(out, "\nCM_ \"The bus of fray, instance 0. Instance n = 0..7: COMMAND, ACK + 2n; SYNC, "
               "TEAR, STATUS, IDENTITY + n; POSE, FORCE, TAG + 16n; the same with _AUTH. Plain forms, or _AUTH "
               "on CAN FD, or TAG on classic CAN. See rt/wire/README.md.\";\n");
  for (uint32_t id = 0; (m = next_message(&id)) != MESSAGES;) {
    fprintf(out, "CM_ BO_ %u \"%s\";\n", DICTIONARY[m].id, SIGNALS[m].comment);
  }
  for (uint32_t id = 0; (m = next_message(&id)) != MESSAGES;) {
    write_signal_comments(out, m, SIGNALS[m].signals);
    if (is_auth(m)) write_signal_comments(out, m, SIGNALS_TRAILER);
  }
  write_attributes(out);
  fprintf(out, "\n");
  for (uint32_t id = 0; (m = next_message(&id)) != MESSAGES;) write_values(out, m);
}

/* Markdown */

static void write_message_row(FILE *out, dictionary_message m) {
  fprintf(out, "| `%03X+", DICTIONARY[m].id);
  if (DICTIONARY[m].id_step > 1) fprintf(out, "%u", DICTIONARY[m].id_step);
  fprintf(out, "n` | %s | %s | ", SIGNALS[m].name, SIGNALS[m].from);
  for (const char *c = SIGNALS[m].to; *c != 0; ++c) fprintf(out, *c == ',' ? ", " : "%c", *c);
  fprintf(out, " | %u%s | ", (unsigned)dictionary_length(m), is_auth(m) ? " FD" : "");
  if (DICTIONARY[m].cycle_ms > 0) fprintf(out, "%u ms", DICTIONARY[m].cycle_ms);
  if (DICTIONARY[m].cycle_ms == 0) fprintf(out, "event");
  fprintf(out, " | %s |\n", SIGNALS[m].comment);
}

static void write_range(FILE *out, const signals_signal *s) {
  const int whole = !s->is_signed && s->min == 0 && s->max == (INT64_C(1) << s->bits) - 1;
  if (whole && s->bits > 16) {
    fprintf(out, "u%u", s->bits);
    return;
  }
  write_scaled(out, s->min, s->step_milli);
  fprintf(out, "..");
  write_scaled(out, s->max, s->step_milli);
  if (*s->unit != 0) fprintf(out, " %s", s->unit);
  if (s->step_milli == 1000) return;
  fprintf(out, " by ");
  write_scaled(out, 1, s->step_milli);
}

static int is_fault(const signals_signal *s) {
  for (size_t n = 0; n < sizeof SIGNALS_FAULTS / sizeof *SIGNALS_FAULTS; ++n) {
    if (s->values == SIGNALS_FAULTS[n]) return 1;
  }
  return 0;
}

static void write_signal_rows(FILE *out, const char *message, const signals_signal *list) {
  for (const signals_signal *s = list; s->name != NULL; ++s) {
    fprintf(out, "| %s | %s | %u", message, s->name, s->start / 8);
    if (s->bits % 8 != 0) {
      fprintf(out, " bit %u", s->start % 8);
      if (s->bits > 1) fprintf(out, "..%u", s->start % 8 + s->bits - 1);
    } else if (s->bits > 8) {
      fprintf(out, "..%u", s->start / 8 + s->bits / 8 - 1);
    }
    fprintf(out, " | ");
    write_range(out, s);
    fprintf(out, " | ");
    for (const signals_value *v = s->values; v != NULL && v->name != NULL; ++v) {
      fprintf(out, "%s%u %s", v == s->values ? "" : ", ", (unsigned)v->value, v->name);
    }
    /* the page has a table of its own for faults */
    const char *comment = is_fault(s) ? "See [Faults](#faults)." : s->comment;
    if (s->values != NULL && comment != NULL) fprintf(out, ". ");
    fprintf(out, "%s |\n", comment == NULL ? "" : comment);
  }
}

void dictionary_write_markdown(FILE *out) {
  dictionary_message m;
  fprintf(out, "| id, hex | message | from | to | bytes | every | |\n|---|---|---|---|---|---|---|\n");
  for (uint32_t id = 0; (m = next_message(&id)) != MESSAGES;) write_message_row(out, m);
  fprintf(out, "\n| message | signal | byte | range | |\n|---|---|---|---|---|\n");
  const signals_signal *written = NULL;
  for (uint32_t id = 0; (m = next_message(&id)) != MESSAGES;) {
    /* left and right have the same signals, and are neighbours */
    if (is_auth(m) || SIGNALS[m].signals == written) continue;
    const char *name = SIGNALS[m].name;
    const char *hand = strstr(name, "_LEFT");
    char text[16];
    snprintf(text, sizeof text, "%.*s", (int)(hand == NULL ? strlen(name) : (size_t)(hand - name)),
             name);
    write_signal_rows(out, text, SIGNALS[m].signals);
    written = SIGNALS[m].signals;
  }
  write_signal_rows(out, "..._AUTH", SIGNALS_TRAILER);
}

#define FAULT_ROW(name, bit, signal, cause, action) \
  fprintf(out, "| %u | `%s` | %s | %s | %s |\n", bit, #name, signal, cause, action);

void dictionary_write_faults(FILE *out) {
  fprintf(out, "| bit | name in `rt/fray.h` | signal of STATUS | cause | what to do |\n|---|---|---|---|---|\n");
  FRAY_FAULTS(FAULT_ROW)
}
