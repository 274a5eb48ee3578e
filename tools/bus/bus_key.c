/* SPDX-License-Identifier: Apache-2.0 */
#define _DEFAULT_SOURCE /* explicit_bzero: compilers drop a memset of an object that is not used again */

#include "tools/bus/bus_key.h"

#include <string.h>

#include "rt/wire/signals.h"
#include "tools/bus/key_file.h"

enum { STRANGER = 16 /* this many invalid frames without a valid one: the other end has another key */ };

int bus_key_check(const char *verb, const bus_key_options *o, int live) {
  if (o->file == NULL && (o->classic_tags || o->freshness != NULL)) {
    fprintf(stderr, "fray %s: --classic-tags and --freshness go with --key\n", verb);
    return 0;
  }
  if (!live && (o->classic_tags || o->freshness != NULL)) {
    fprintf(stderr, "fray %s: --classic-tags and --freshness go with --can\n", verb);
    return 0;
  }
  return 1;
}

int bus_key_read(const char *file, cmac_key *key) {
  uint8_t bytes[CMAC_KEY];
  candump_error error;
  const int good = key_file_read(file, bytes, &error);
  if (good)
    cmac_key_init(key, bytes);
  else
    candump_print_error(stderr, &error);
  explicit_bzero(bytes, sizeof bytes);
  return good;
}

static void print_restart_note(const bus_key *k, const bus_key_options *o) {
  const char *key = o->file;
  if (o->freshness == NULL) {
    fprintf(stderr,
            "%s: no --freshness FILE, so this end begins anew: right only with a key for this\n"
            "session alone. Under a key that was used before, recorded frames are taken again, and\n"
            "an end that remembers refuses this one\n",
            key);
  } else if (k->store.is_new) {
    fprintf(stderr, "%s: a new file, so this end begins anew: right only with a new key\n",
            o->freshness);
  }
}

int bus_key_open(bus_key *k, const bus_key_options *o, auth_gate_end end, uint32_t instance,
                 uint32_t hands) {
  candump_error error;
  memset(k, 0, sizeof *k);
  if (!bus_key_read(o->file, &k->key)) return 0;
  auth_gate_init(&k->g, &k->key, o->classic_tags ? AUTH_GATE_CLASSIC : AUTH_GATE_FD, end, instance, hands);
  if (o->freshness != NULL && !freshness_open(&k->store, o->freshness, &k->g, &k->key, &error)) {
    candump_print_error(stderr, &error);
    explicit_bzero(&k->key, sizeof k->key);
    return 0;
  }
  k->stored = o->freshness != NULL;
  print_restart_note(k, o);
  return 1;
}

int bus_key_tick(bus_key *k) {
  if (!k->stored) return 1;
  freshness_exchange(&k->store);
  if (k->fault == 0) k->fault = freshness_failed(&k->store);
  return k->fault == 0;
}

int bus_key_close(bus_key *k) {
  const int good = !k->stored || freshness_close(&k->store);
  if (!good)
    fprintf(stderr, "%s: cannot be written: %s\n", k->store.file,
            strerror(freshness_failed(&k->store)));
  else if (k->fault != 0)
    fprintf(stderr, "%s: could not be written for a while: %s; that is why this end stopped\n",
            k->store.file, strerror(k->fault));
  explicit_bzero(&k->key, sizeof k->key);
  return good && k->fault == 0;
}

static const char *name_of(const bus_key *k, uint32_t id) {
  return SIGNALS[dictionary_find(id, k->g.instance)].name;
}

static const char *complaint_fd(const auth_gate *g) {
  uint32_t good = 0, old = 0, forged = 0;
  for (uint32_t n = 0; n < g->in_count; ++n) {
    good += g->in[n].accepted;
    old += g->in[n].old;
    forged += g->in[n].forged;
  }
  if (good != 0) return NULL;
  if (forged >= STRANGER) return "no tag fits: the other end has another key";
  if (old >= STRANGER)
    return "every frame is old: the other end has begun anew under a key that was used before, or "
           "these are replayed";
  return g->plain >= STRANGER ? "no frame has a tag: the other end has no key, or --classic-tags"
                              : NULL;
}

static const char *complaint_classic(const auth_gate *g) {
  uint32_t good = 0, bad = 0, missing = 0;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    good += g->monitor[h].good;
    bad += g->monitor[h].bad;
    missing += g->monitor[h].missing;
  }
  if (good != 0 || g->failed == 0) return NULL;
  return missing >= bad ? "no TAG comes: the other end has no key, or no --classic-tags"
                        : "no TAG fits: the other end has another key, or another freshness";
}

const char *bus_key_complaint(const bus_key *k) {
  return k->g.form == AUTH_GATE_FD ? complaint_fd(&k->g) : complaint_classic(&k->g);
}

static void print_fd(const bus_key *k, FILE *out) {
  const auth_gate *g = &k->g;
  for (uint32_t n = 0; n < g->in_count; ++n) {
    const auth_lane *l = &g->in[n];
    fprintf(out, "             %s: %u good, %u skipped, %u old, %u forged, %u of a wrong form\n",
            name_of(k, l->id), l->accepted, l->lost, l->old, l->forged, l->malformed);
  }
  fprintf(out, "             without a tag %u, over budget %u: none of these was used\n", g->plain,
          g->over_budget);
}

static void print_classic(const bus_key *k, FILE *out) {
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    const auth_monitor *w = &k->g.monitor[h];
    if (((uint32_t)k->g.hands >> h & 1u) == 0) continue;
    fprintf(out, "             %s: %u good, %u bad, %u missing%s\n", name_of(k, w->group.tag_id),
            w->good, w->bad, w->missing, w->failed ? ": failed" : "");
  }
  fprintf(out, "             poses dropped after a failure %u\n", k->g.plain);
}

void bus_key_print(const bus_key *k, FILE *out) {
  fprintf(out, "key          %s\n", k->g.form == AUTH_GATE_FD ? "CAN FD" : "TAGs on classic CAN");
  if (k->g.form == AUTH_GATE_FD)
    print_fd(k, out);
  else if (k->g.end == AUTH_GATE_RUNTIME)
    print_classic(k, out);
}
