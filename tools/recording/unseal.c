/* SPDX-License-Identifier: Apache-2.0 */
#define _DEFAULT_SOURCE /* explicit_bzero */

#include "tools/recording/unseal.h"

#include <string.h>

#include "rt/wire/auth.h"
#include "rt/wire/codec.h"
#include "rt/wire/signals.h"
#include "tools/bus/bus_key.h"

enum { NOTES = 8, SEARCHES = 8, ACK_LATE_TICKS = 8, HIGH_HALVES = 1 << 16 };

typedef struct {
  const char *file;
  FILE *out;
  uint32_t count;
} notes;

static void note(notes *n, int line, const char *name, const char *what) {
  n->count += 1;
  if (n->out != NULL && n->count <= NOTES)
    fprintf(n->out, "%s:%d: %s: %s\n", n->file, line, name, what);
}

static void note_end(const notes *n) {
  if (n->out != NULL && n->count > NOTES)
    fprintf(n->out, "%s: and %u more of that kind\n", n->file, n->count - NOTES);
}

static dictionary_message message_of(const frame *f, uint32_t instance) {
  return f->extended || f->error ? MESSAGES : dictionary_find(f->id, instance);
}

static int is_runtimes(dictionary_message m) {
  return m == MESSAGE_ACK || m == MESSAGE_FORCE_LEFT || m == MESSAGE_FORCE_RIGHT;
}

int unseal_is_fd(const candump_log *log, uint32_t instance) {
  size_t plain[2] = {0, 0}, sealed[2] = {0, 0}; /* of a runtime, of a device */
  for (size_t n = 0; n < log->count; ++n) {
    const dictionary_message m = message_of(&log->entries[n].frame, instance);
    if (m == MESSAGES) continue;
    const dictionary_message protects = (dictionary_message)DICTIONARY[m].protects;
    if (protects != MESSAGES)
      sealed[is_runtimes(protects) ? 0 : 1] += 1;
    else if (dictionary_auth(m) != MESSAGES)
      plain[is_runtimes(m) ? 0 : 1] += 1;
  }
  const int sender = plain[0] + sealed[0] == 0;
  return sealed[sender] > plain[sender];
}

/* CAN FD */

typedef struct {
  auth_lane of[MESSAGES]; /* by the plain message; for COMMAND that of operators */
  auth_lane own;          /* the runtime's COMMANDs */
} receivers;

static void begin_lanes(receivers *r, const cmac_key *key, uint32_t instance) {
  for (uint32_t m = 0; m < MESSAGES; ++m)
    auth_lane_init(&r->of[m], key, (dictionary_message)m, instance, 0);
  auth_lane_init(&r->own, key, MESSAGE_COMMAND, instance, AUTH_RUNTIME_FIRST);
}

static auth_lane *lane_for(receivers *r, dictionary_message protects, const frame *f) {
  const int own = f->length == DICTIONARY_LENGTH_AUTH && f->data[11] >= AUTH_RUNTIME_FIRST >> 24;
  return protects == MESSAGE_COMMAND && own ? &r->own : &r->of[protects];
}

/* 1: the entry stays. */
static int open_entry(receivers *r, candump_entry *e, uint32_t instance, unseal_counts *counts,
                      notes *say) {
  const dictionary_message m = message_of(&e->frame, instance);
  if (m == MESSAGES) return 1;
  const dictionary_message protects = (dictionary_message)DICTIONARY[m].protects;
  if (protects == MESSAGES && dictionary_auth(m) == MESSAGES) return 1;
  auth_reason reason = AUTH_ID;
  if (protects != MESSAGES) reason = auth_open(lane_for(r, protects, &e->frame), &e->frame, &e->frame);
  if (reason == AUTH_OK) {
    counts->good += 1;
    return 1;
  }
  counts->refused += 1;
  note(say, e->line, SIGNALS[m].name,
       protects == MESSAGES ? "no tag; not used" : auth_reason_text(reason));
  return 0;
}

void unseal_fd(const char *file, candump_log *log, const cmac_key *key, uint32_t instance,
               unseal_counts *counts, FILE *out) {
  receivers r;
  notes say = {file, out, 0};
  size_t kept = 0;
  begin_lanes(&r, key, instance);
  memset(counts, 0, sizeof *counts);
  for (size_t n = 0; n < log->count; ++n) {
    candump_entry e = log->entries[n];
    if (open_entry(&r, &e, instance, counts, &say)) log->entries[kept++] = e;
  }
  log->count = kept;
  note_end(&say);
}

/* Classic */

typedef struct {
  auth_monitor watch;
  int found;     /* the upper half of the freshness is known */
  uint32_t searches;
} watcher;

/* The upper 16 bits of the first freshness are not in the log. */
static void find_freshness(watcher *w, const frame *tag) {
  if (w->found || w->searches == SEARCHES || w->watch.group.count != AUTH_GROUP || w->watch.failed)
    return;
  const uint32_t low = tag->data[0] | (uint32_t)tag->data[1] << 8;
  w->searches += 1;
  for (uint32_t high = 0; high < HIGH_HALVES && !w->found; ++high) {
    auth_monitor tried = w->watch;
    if (high == 0 && low == 0) continue;
    tried.group.last = (high << 16 | low) - 1u;
    if (auth_monitor_check(&tried, tag) != AUTH_MONITOR_GOOD) continue;
    w->watch.group.last = (high << 16 | low) - 1u;
    w->found = 1;
  }
}

/* 1: the entry stays. */
static int watch_entry(watcher *w, uint32_t hand, const candump_entry *e, notes *say,
                       unseal_counts *counts) {
  const int was_failed = w->watch.failed;
  const uint32_t missing = w->watch.missing;
  const int is_tag = e->frame.id == w->watch.group.tag_id;
  if (is_tag && e->frame.length == DICTIONARY_LENGTH) find_freshness(w, &e->frame);
  const auth_verdict verdict = auth_monitor_check(&w->watch, &e->frame);
  const char *name = SIGNALS[dictionary_tag(hand)].name;
  if (w->watch.missing != missing)
    note(say, e->line, name, "missing before this POSE: the four before it have no tag");
  else if (verdict == AUTH_MONITOR_BAD || (verdict == AUTH_MONITOR_FAILED && !was_failed))
    note(say, e->line, name, "does not fit: the POSEs before it have no tag");
  if (verdict != AUTH_MONITOR_FAILED) return 1;
  if (!was_failed) note(say, e->line, name, "the lane has failed: no POSE is used until RESET");
  if (!is_tag) counts->dropped += 1;
  return is_tag;
}

/* This entry is the last SYNC of a tick that executed a RESET: earlier frames belong to the failed lane,
 * later ones to a new one. On a busy bus the ACK is late. */
static int resets_at(const candump_log *log, size_t at, uint32_t instance) {
  codec_sync sync, again;
  codec_ack ack;
  if (codec_decode_sync(&log->entries[at].frame, instance, &sync) != CODEC_OK) return 0;
  for (size_t n = at + 1; n < log->count; ++n) {
    const frame *f = &log->entries[n].frame;
    if (codec_decode_sync(f, instance, &again) == CODEC_OK &&
        (again.tick == sync.tick || again.tick - sync.tick > ACK_LATE_TICKS))
      return 0;
    if (codec_decode_ack(f, instance, &ack) == CODEC_OK && ack.tick == sync.tick &&
        ack.command == FRAY_COMMAND_RESET && ack.result == FRAY_RESULT_OK)
      return 1;
  }
  return 0;
}

static int any_failed(const watcher *w) { return w[0].watch.failed || w[1].watch.failed; }

/* As auth_gate_clear(): a lane that had not failed continues in the middle of its four. */
static void clear_failed(watcher *w) {
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    if (w[h].watch.failed) auth_monitor_clear(&w[h].watch);
}

void unseal_classic(const char *file, candump_log *log, const cmac_key *key, uint32_t instance,
                    uint32_t hands, unseal_counts *counts, FILE *out) {
  watcher w[FRAY_HANDS];
  notes say = {file, out, 0};
  size_t kept = 0;
  memset(counts, 0, sizeof *counts);
  memset(w, 0, sizeof w);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) auth_monitor_init(&w[h].watch, key, instance, h, 0);
  for (size_t n = 0; n < log->count; ++n) {
    const candump_entry *e = &log->entries[n];
    int stays = 1;
    for (uint32_t h = 0; h < FRAY_HANDS; ++h)
      if ((hands >> h & 1u) != 0 && !watch_entry(&w[h], h, e, &say, counts)) stays = 0;
    if (any_failed(w) && resets_at(log, n, instance)) clear_failed(w);
    if (stays) log->entries[kept++] = *e;
  }
  log->count = kept;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    counts->good += w[h].watch.good;
    counts->refused += w[h].watch.bad + w[h].watch.missing;
  }
  note_end(&say);
}

/* Both */

static int has_tags(const candump_log *log, uint32_t instance) {
  for (size_t n = 0; n < log->count; ++n) {
    const dictionary_message m = message_of(&log->entries[n].frame, instance);
    if (m == MESSAGE_TAG_LEFT || m == MESSAGE_TAG_RIGHT) return 1;
  }
  return 0;
}

static int open_without_key(const char *file, const candump_log *log, int fd, uint32_t instance,
                            FILE *err) {
  if (fd)
    fprintf(err, "%s: was recorded under a key, expected --key FILE\n", file);
  else if (has_tags(log, instance))
    fprintf(err, "%s: its TAGs are not checked without --key FILE\n", file);
  return !fd;
}

static int open_fd(const char *file, candump_log *log, const cmac_key *key, uint32_t instance,
                   FILE *err) {
  unseal_counts counts;
  unseal_fd(file, log, key, instance, &counts, err);
  if (counts.good == 0) {
    fprintf(err, "%s: no tag of this log fits, expected the key that it was recorded under\n", file);
    return 0;
  }
  fprintf(err, "%s: %u frames have a good tag, %u others are not used\n", file, counts.good,
          counts.refused);
  return 1;
}

static int open_classic(const char *file, candump_log *log, const cmac_key *key, uint32_t instance,
                        uint32_t hands, FILE *err) {
  unseal_counts counts;
  unseal_classic(file, log, key, instance, hands, &counts, err);
  if (counts.good == 0) {
    fprintf(err, "%s: no TAG of this log fits, expected the key that it was recorded under\n", file);
    return 0;
  }
  fprintf(err, "%s: %u TAGs are good, %u failures, %u POSEs after a failed lane are not used\n", file,
          counts.good, counts.refused, counts.dropped);
  return 1;
}

int unseal_log(const char *file, candump_log *log, const char *key_file, uint32_t instance,
               uint32_t hands, FILE *err) {
  cmac_key key;
  const int fd = unseal_is_fd(log, instance);
  if (key_file == NULL) return open_without_key(file, log, fd, instance, err);
  if (!bus_key_read(key_file, &key)) return 0;
  if (!fd && !has_tags(log, instance)) {
    explicit_bzero(&key, sizeof key);
    fprintf(err, "%s: nothing of instance %u has a tag, expected a recording under a key; without one "
                 "leave --key away\n", file, instance);
    return 0;
  }
  const int good = fd ? open_fd(file, log, &key, instance, err)
                      : open_classic(file, log, &key, instance, hands, err);
  explicit_bzero(&key, sizeof key);
  return good;
}
