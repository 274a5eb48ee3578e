/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/recording/verify.h"

#include <inttypes.h>
#include <string.h>

#include "rt/base/bytes.h"
#include "rt/wire/dictionary.h"
#include "tools/recording/replay.h"

/* One run against its recording. */
typedef struct {
  const verify_recording *of;
  FILE *out;
  replay log;
  fray_world *world;
  workers_group *group;
  port_sender sender;
  size_t tears, statuses, identities; /* compared so far */
  uint64_t hash;
} verifier;

static void print_bytes(FILE *out, const uint8_t *data) {
  for (int n = 0; n < 8; ++n) fprintf(out, "%02X", data[n]);
}

/* One frame of this run (NULL: it has none) against one of the log (line 0: it has none). */
static int compare_frame(const verifier *v, uint64_t tick, const char *name, int line, const uint8_t *says,
                         const uint8_t *has) {
  if (line == 0 && has == NULL) return 1;
  if (line != 0 && has != NULL && memcmp(says, has, 8) == 0) return 1;
  fprintf(v->out, "tick %" PRIu64 " differs: ", tick);
  if (line != 0) {
    fprintf(v->out, "%s at line %d says ", name, line);
    print_bytes(v->out, says);
  } else {
    fprintf(v->out, "the log has no %s", name);
  }
  fprintf(v->out, ", this run has ");
  if (has != NULL) {
    print_bytes(v->out, has);
  } else {
    fprintf(v->out, "none");
  }
  fprintf(v->out, "\n");
  return 0;
}

/* The next message of a list; line 0: there is none. */
static const struct replay_message *next_of(const replay_list *list, size_t at) {
  static const struct replay_message NONE = {0, {0}};
  return at < list->count ? &list->of[at] : &NONE;
}

/* A frame of this run that does not name its tick against the next one of the log. */
static int compare_next(const verifier *v, uint64_t tick, const char *name, const replay_list *list, size_t *at,
                        const uint8_t *has) {
  if (has == NULL) return 1;
  const struct replay_message *says = next_of(list, *at);
  *at += 1;
  return compare_frame(v, tick, name, says->line, says->data, has);
}

static const uint8_t *frame_of(const frame *frames, uint32_t count, dictionary_message message, uint32_t instance) {
  for (uint32_t n = 0; n < count; ++n) {
    if (frames[n].id == dictionary_id(message, instance)) return frames[n].data;
  }
  return NULL;
}

/* Clocks make Overruns: it is as the log says, and never falls. */
static void take_overruns(verifier *v) {
  codec_status says;
  frame f = {.id = dictionary_id(MESSAGE_STATUS, v->of->instance), .length = DICTIONARY_LENGTH};
  memcpy(f.data, next_of(&v->log.statuses, v->statuses)->data, sizeof v->log.statuses.of->data);
  if (codec_decode_status(&f, v->of->instance, &says) == CODEC_OK && says.overruns > v->sender.overruns)
    v->sender.overruns = says.overruns;
}

static int compare_outputs(verifier *v, const replay_tick *expected, const fray_output *output) {
  const uint32_t instance = v->of->instance;
  const uint64_t tick = output->tick;
  frame frames[PORT_OUT];
  take_overruns(v);
  const uint32_t count = port_encode(&v->sender, output, frames);
  const uint8_t *left = frame_of(frames, count, MESSAGE_FORCE_LEFT, instance);
  const uint8_t *right = frame_of(frames, count, MESSAGE_FORCE_RIGHT, instance);
  const uint8_t *ack = frame_of(frames, count, MESSAGE_ACK, instance);
  const uint8_t *tear = frame_of(frames, count, MESSAGE_TEAR, instance);
  const uint8_t *status = frame_of(frames, count, MESSAGE_STATUS, instance);
  int same = compare_frame(v, tick, "FORCE left", expected->force_line[0], expected->force[0], left);
  same &= compare_frame(v, tick, "FORCE right", expected->force_line[1], expected->force[1], right);
  same &= compare_frame(v, tick, "ACK", expected->ack_line, expected->ack, ack);
  same &= compare_next(v, tick, "TEAR", &v->log.tears, &v->tears, tear);
  same &= compare_next(v, tick, "STATUS", &v->log.statuses, &v->statuses, status);
  return same;
}

/* Before the first tick of the recording, and before each whose low 32 bits are 0; `tick` is the next one. */
static int compare_identity(verifier *v, uint64_t tick) {
  const replay_list *list = &v->log.identities;
  if (list->count == 0 || (v->identities > 0 && (tick & 0xFFFFFFFFu) != 0)) return 1;
  uint8_t has[8];
  memcpy(has, list->of[0].data, sizeof has); /* of one physics */
  bytes_store32(has + 4, (uint32_t)(tick >> 32));
  return compare_next(v, tick, "IDENTITY", list, &v->identities, has);
}

static int compare_tick(verifier *v, uint32_t n) {
  const replay_tick *expected = &v->log.ticks[n];
  fray_output output;
  int same = compare_identity(v, fray_get_info(v->world).tick);
  workers_tick(v->group, &expected->input, &output);
  v->hash = output.hash;
  const uint32_t low = (uint32_t)(output.hash & 0xFFFFFFFFu);
  if (expected->hash != low) {
    fprintf(v->out, "tick %" PRIu64 " differs: SYNC at line %d says %08" PRIx32 ", this run has %08" PRIx32 "\n",
            output.tick, expected->hash_line, expected->hash, low);
    same = 0;
  }
  return compare_outputs(v, expected, &output) && same;
}

static int compare_start(const verifier *v) {
  const uint32_t low = (uint32_t)(v->hash & 0xFFFFFFFFu);
  if (v->log.start_hash == low) return 1;
  fprintf(v->out, "the start differs: SYNC at line %d says %08" PRIx32 ", this image has %08" PRIx32 "\n",
          v->log.ticks[0].sync_line, v->log.start_hash, low);
  return 0;
}

/* Frames of the log that the run does not have; those of a cut recording belong to ticks that are not whole. */
static int compare_end(verifier *v, const char *name, const replay_list *list, size_t at) {
  const int line = next_of(list, at)->line;
  if (line == 0 || (v->log.cut_line != 0 && line > v->log.cut_line)) return 1;
  fprintf(v->out, "%s:%d: %s that this run does not have\n", v->of->file, line, name);
  return 0;
}

static int compare_all(verifier *v) {
  if (!compare_start(v)) return 0;
  for (uint32_t n = 0; n < v->log.count; ++n)
    if (!compare_tick(v, n)) return 0;
  /* the closing SYNC */
  if (v->log.cut_line == 0 && !compare_identity(v, fray_get_info(v->world).tick)) return 0;
  return compare_end(v, "a TEAR", &v->log.tears, v->tears) &&
         compare_end(v, "a STATUS", &v->log.statuses, v->statuses) &&
         compare_end(v, "an IDENTITY", &v->log.identities, v->identities);
}

/* Said before any difference, which it may explain. */
static void note_physics(const verify_recording *of, FILE *notes) {
  codec_identity says;
  for (size_t n = 0; n < of->log->count; ++n) {
    if (codec_decode_identity(&of->log->entries[n].frame, of->instance, &says) != CODEC_OK) continue;
    if (says.physics != fray_physics_id())
      fprintf(notes, "%s:%d: made by another version of the physics (id %08" PRIx32 ", this build has %08" PRIx32 ")\n",
              of->file, of->log->entries[n].line, says.physics, fray_physics_id());
    return;
  }
  fprintf(notes, "%s: does not state its physics (no IDENTITY)\n", of->file);
}

static void note_cut(const verifier *v, FILE *notes) {
  if (v->log.cut_line == 0) return;
  fprintf(notes, "%s:%d: cut off: tick %" PRIu64 " has no hash, it and what follows is not verified\n", v->of->file,
          v->log.cut_line, v->log.first + v->log.count);
}

int verify_run(const verify_recording *of, fray_world *world, workers_group *group, FILE *out, FILE *notes) {
  const fray_info facts = fray_get_info(world);
  const replay_setting setting = {of->instance, facts.hands, facts.rate_hz, facts.tick,
                                  {facts.consumed[0], facts.consumed[1]}, of->cut, 0};
  verifier v = {.of = of, .out = out, .world = world, .group = group, .hash = fray_hash(world)};
  candump_error error;
  note_physics(of, notes);
  if (!replay_read(of->file, of->log, &setting, &v.log, &error)) {
    candump_print_error(notes, &error);
    return 0;
  }
  port_sender_init(&v.sender, of->instance, facts.hands, facts.rate_hz);
  v.sender.contacts_max = fray_work_bound(world).contacts;
  const int same = compare_all(&v);
  if (same) {
    note_cut(&v, notes);
    fprintf(out, "verified %" PRIu32 " ticks, hash %016" PRIx64 "\n", v.log.count, v.hash);
  }
  replay_free(&v.log);
  return same;
}
