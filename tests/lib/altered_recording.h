/* SPDX-License-Identifier: Apache-2.0 */
/* A recording, and ways to alter it, for one test program. It is of a small cloth that tears: a STOP that changes
 * nothing, START, a hand that falls silent (STALE), a refused START, RESET, START; a SYNC and a COMMAND that were
 * repeated, a POSE that no tick took. */
#ifndef FRAY_TESTS_LIB_ALTERED_RECORDING_H
#define FRAY_TESTS_LIB_ALTERED_RECORDING_H

#include "rt/base/bytes.h"
#include "rt/wire/auth_gate.h"
#include "rt/wire/dictionary.h"
#include "rt/wire/e2e.h"
#include "tests/lib/set_tick.h"
#include "tests/lib/world_fixture.h"
#include "tools/recording/record.h"
#include "tools/recording/unseal.h"

enum { TICKS = 700, RIGHT = 1 };
enum { SILENT = 640, TAKEN_LATER = 300, SYNC_TWICE = 400, COMMAND_TWICE = 690 };

/* And shorter ones: of a world without hands, and across 2^32 ticks. */
enum { SMALL, NO_HANDS, ACROSS, SESSIONS };
static const struct {
  const char *scene;
  uint64_t first;
  uint32_t ticks;
} OF[SESSIONS] = {{"tests/scenes/small.scene", 0, TICKS},
                  {"tests/scenes/flag.scene", 0, 25},
                  {"tests/scenes/small.scene", (UINT64_C(1) << 32) - 20, 40}};

/* Of one session: `good` as recorded, `changed` with one change */
static uint32_t session;
static fixture worlds[SESSIONS];
static candump_log logs[SESSIONS], good, changed;

/* What a session takes in tick n; the world tears while the hand moves. */
static void make_input(fray_input *in, uint32_t n, uint8_t *counter) {
  static const struct {
    uint32_t tick;
    uint8_t command;
  } COMMANDS[] = {{0, FRAY_COMMAND_STOP},    {2, FRAY_COMMAND_START},  {660, FRAY_COMMAND_START},
                  {670, FRAY_COMMAND_RESET}, {680, FRAY_COMMAND_START}, {684, FRAY_COMMAND_ZERO}};
  const int32_t way = n < 100 ? 0 : n < 600 ? (int32_t)n - 100 : 500;
  memset(in, 0, sizeof *in);
  for (size_t k = 0; k < sizeof COMMANDS / sizeof *COMMANDS; ++k) {
    if (COMMANDS[k].tick != n) continue;
    in->command = COMMANDS[k].command;
    in->command_counter = (uint8_t)(k + 1);
  }
  if (n >= SILENT && n < SILENT + 10) return;
  *counter = (uint8_t)((*counter + (n == TAKEN_LATER ? 2u : 1u)) & 15u);
  in->has_pose = 1u << RIGHT;
  in->pose[RIGHT] = (fray_pose){(int16_t)(2 * way), (int16_t)(-5 * way), (int16_t)(3 * way), *counter, 1};
}

static dictionary_message message_at(const candump_log *log, size_t at) {
  return at < log->count ? dictionary_find(log->entries[at].frame.id, 0) : MESSAGES;
}

/* The entry of the SYNC of this tick; the first has tick 0. */
static size_t sync_at(const candump_log *log, uint32_t tick) {
  for (size_t at = 0; at < log->count; ++at)
    if (message_at(log, at) == MESSAGE_SYNC && bytes_load32(log->entries[at].frame.data) == (uint32_t)OF[session].first + tick)
      return at;
  return log->count;
}

static void number_lines(candump_log *log) {
  for (size_t n = 0; n < log->count; ++n) log->entries[n].line = (int)n + 1;
}

static void insert(candump_log *log, size_t at, const frame *f) {
  const frame inserted = *f; /* f may point into the entries, which realloc() moves */
  candump_entry *grown = realloc(log->entries, (log->count + 1) * sizeof *grown);
  if (grown == NULL || at > log->count) fixture_give_up("insert", "no room");
  log->entries = grown;
  memmove(&grown[at + 1], &grown[at], (log->count - at) * sizeof *grown);
  memset(&grown[at], 0, sizeof grown[at]);
  grown[at].frame = inserted;
  log->count += 1;
  number_lines(log);
}

static void remove_at(size_t at) {
  memmove(&changed.entries[at], &changed.entries[at + 1], (changed.count - at - 1) * sizeof *changed.entries);
  changed.count -= 1;
  number_lines(&changed);
}

/* What a bus has besides: a POSE that the next one overtook in its tick, a repeated SYNC and COMMAND. */
static void add_besides(void) {
  frame f;
  fray_pose pose;
  size_t at = sync_at(&good, TAKEN_LATER) - 1;
  CHECK_EQ_INT(codec_decode_pose(&good.entries[at].frame, 0, RIGHT, &pose), CODEC_OK);
  pose.counter = (pose.counter + 15u) & 15u;
  codec_encode_pose(&f, 0, RIGHT, &pose);
  insert(&good, at, &f);
  at = sync_at(&good, SYNC_TWICE);
  insert(&good, at + 1, &good.entries[at].frame);
  codec_encode_command(&f, 0, &(codec_command){6, FRAY_COMMAND_ZERO, 0});
  insert(&good, sync_at(&good, COMMAND_TWICE), &f);
}

/* A world before the first tick of the session. */
static fixture open_world(void) {
  fixture f = worlds[session];
  fixture_open_image(&f);
  set_tick(f.w, OF[session].first);
  return f;
}

static void record_session(void) {
  char *text = NULL;
  size_t bytes = 0;
  FILE *out = open_memstream(&text, &bytes);
  fray_input in;
  fray_output output;
  uint8_t counter = 0;
  record r;
  candump_error error;
  if (out == NULL) fixture_give_up("open_memstream", "no memory");
  fixture_file(&worlds[session], OF[session].scene, NULL);
  fixture f = open_world();
  record_begin(&r, out, 0, f.facts.hands, f.facts.rate_hz, OF[session].first, fray_hash(f.w));
  r.sender.contacts_max = fray_work_bound(f.w).contacts;
  for (uint32_t n = 0; n < OF[session].ticks; ++n) {
    make_input(&in, n, &counter);
    if (f.facts.hands == 0) memset(&in, 0, sizeof in);
    fray_tick(f.w, &in, &output);
    CHECK(record_tick(&r, &in, &output));
  }
  CHECK(record_end(&r));
  fclose(out);
  free(f.memory);
  CHECK(candump_parse_all("r.log", text, bytes, &good, &error));
  free(text);
  if (session == SMALL) {
    CHECK(output.tears_total > 5 && output.state == FRAY_OPERATIONAL);
    add_besides();
  }
  logs[session] = good;
}

static void use_session(uint32_t n) {
  session = n;
  good = logs[n];
}

/* ---- changes: each returns 0 iff it does not fit the entry */

static frame *frame_at(size_t at) { return &changed.entries[at].frame; }

static void mend(size_t at) {
  const dictionary_message m = message_at(&changed, at);
  if (m == MESSAGES || DICTIONARY[m].e2e_kind == DICTIONARY_NO_E2E) return;
  e2e_protect(frame_at(at)->data, 8, dictionary_e2e_base(m, 0), frame_at(at)->data[1] & 15u);
}

static int flip_bit(size_t at, uint32_t bit) {
  frame_at(at)->data[bit / 8] ^= (uint8_t)(1u << bit % 8);
  mend(at);
  return 1;
}

static size_t next_of(size_t at, dictionary_message m) {
  do {
    ++at;
  } while (at < changed.count && message_at(&changed, at) != m);
  return at;
}

static int removed(size_t at) {
  remove_at(at);
  return 1;
}

static int repeated(size_t at) {
  const frame f = *frame_at(at);
  insert(&changed, at + 1, &f);
  return 1;
}

/* With the next one of its message. */
static int swapped(size_t at) {
  const size_t next = next_of(at, message_at(&changed, at));
  if (next >= changed.count || memcmp(frame_at(at)->data, frame_at(next)->data, 8) == 0) return 0;
  const frame f = *frame_at(at);
  *frame_at(at) = *frame_at(next);
  *frame_at(next) = f;
  return 1;
}

/* With the frame behind it. */
static int neighbours(size_t at) {
  if (at < 10 || message_at(&changed, at + 1) == MESSAGES) return 0;
  if (message_at(&changed, at) == message_at(&changed, at + 1)) return 0;
  const frame f = *frame_at(at);
  *frame_at(at) = *frame_at(at + 1);
  *frame_at(at + 1) = f;
  return 1;
}

static int any_bit(size_t at) {
  const dictionary_message m = message_at(&changed, at);
  const int has_crc = m != MESSAGES && DICTIONARY[m].e2e_kind != DICTIONARY_NO_E2E;
  return flip_bit(at, has_crc ? 8 + (uint32_t)at % 56 : (uint32_t)at % 64);
}

/* One of two equal SYNCs. */
static int is_one_of_two(size_t at) {
  const size_t next = next_of(at, MESSAGE_SYNC);
  return (next < changed.count && memcmp(frame_at(at)->data, frame_at(next)->data, 4) == 0) ||
         (at > 0 && message_at(&changed, at - 1) == MESSAGE_SYNC);
}
static int sync_removed(size_t at) {
  return !is_one_of_two(at) && next_of(at, MESSAGE_SYNC) < changed.count && removed(at);
}
static int sync_of_two_removed(size_t at) { return is_one_of_two(at) && removed(at); }
static int sync_swapped(size_t at) { return !is_one_of_two(at) && swapped(at); }
static int sync_number(size_t at) { return flip_bit(at, (uint32_t)at % 32); }
static int sync_hash(size_t at) { return flip_bit(at, 32 + (uint32_t)at % 32); }
static int wrong_sync_behind(size_t at) { return repeated(at) && flip_bit(at + 1, 40); }
static int wrong_sync_before(size_t at) {
  frame f = *frame_at(at);
  f.data[4] ^= 1;
  insert(&changed, at, &f);
  return 1;
}

static int is_taken(size_t at) { return next_of(at, MESSAGE_SYNC) < next_of(at, MESSAGE_POSE_RIGHT); }
static int taken_removed(size_t at) { return is_taken(at) && removed(at); }
static int taken_bit(size_t at) { return is_taken(at) && flip_bit(at, 8 + (uint32_t)at % 56); }
static int other_removed(size_t at) { return !is_taken(at) && removed(at); }
static int other_bit(size_t at) { return !is_taken(at) && flip_bit(at, 16 + (uint32_t)at % 48); }
static int other_before(size_t at) {
  if (!is_taken(at)) return 0;
  repeated(at);
  return flip_bit(at, 17);
}
static int other_behind(size_t at) { return is_taken(at) && repeated(at) && flip_bit(at + 1, 17); }

/* The same COMMAND stands before. */
static int is_repeated(size_t at) {
  for (size_t n = 0; n < at; ++n)
    if (message_at(&changed, n) == MESSAGE_COMMAND && memcmp(frame_at(n)->data, frame_at(at)->data, 8) == 0) return 1;
  return 0;
}
static int command_removed(size_t at) { return !is_repeated(at) && removed(at); }
static int command_bit(size_t at) { return !is_repeated(at) && flip_bit(at, 8 + (uint32_t)at % 24); }
static int argument_bit(size_t at) { return !is_repeated(at) && flip_bit(at, 32 + (uint32_t)at % 32); }
static int repetition_removed(size_t at) { return is_repeated(at) && removed(at); }
static int command_added_here(size_t at) {
  frame f = *frame_at(at);
  f.data[1] = (uint8_t)((f.data[1] + 7u) & 15u);
  insert(&changed, at, &f);
  mend(at);
  return 1;
}
static int is_stop(size_t at) { return frame_at(at)->data[2] == FRAY_COMMAND_STOP; }
static int command_added(size_t at) { return !is_stop(at) && command_added_here(at); }
static int added_beside_stop(size_t at) { return is_stop(at) && command_added_here(at); }
static int with_ack_removed(size_t at, uint8_t counter) {
  if (is_repeated(at) || (frame_at(at)->data[1] & 15u) != counter) return 0;
  remove_at(next_of(at, MESSAGE_ACK));
  return removed(at);
}
static int idle_removed(size_t at) { return with_ack_removed(at, 1); }
static int start_removed(size_t at) { return with_ack_removed(at, 2); }
static int commands_swapped(size_t at, int near) {
  const size_t next = next_of(at, MESSAGE_COMMAND);
  size_t sync = at;
  for (int n = 0; n < 3; ++n) sync = next_of(sync, MESSAGE_SYNC);
  return next < changed.count && (next < sync) == near && !is_repeated(next) && swapped(at);
}
static int near_swapped(size_t at) { return commands_swapped(at, 1); }
static int far_swapped(size_t at) { return commands_swapped(at, 0); }

static int crc_bit(size_t at) {
  const dictionary_message m = message_at(&changed, at);
  if (m == MESSAGES || DICTIONARY[m].e2e_kind == DICTIONARY_NO_E2E) return 0;
  if ((m == MESSAGE_POSE_RIGHT && !is_taken(at)) || (m == MESSAGE_COMMAND && is_repeated(at))) return 0;
  frame_at(at)->data[at % 8] ^= 0x10;
  return 1;
}

static int added(size_t at) {
  repeated(at);
  return flip_bit(at, 40);
}

static int other_field(size_t at) {
  uint32_t bit = (uint32_t)at % 48; /* not Overruns */
  return flip_bit(at, bit < 32 ? bit : bit + 16);
}
static int overruns_rise(size_t at) {
  for (; at < changed.count; at = next_of(at, MESSAGE_STATUS)) frame_at(at)->data[4] = 7;
  return 1;
}
static int overruns_fall(size_t at) {
  frame_at(at)->data[4] = 7;
  return next_of(at, MESSAGE_STATUS) < changed.count;
}

static int physics_bit(size_t at) { return flip_bit(at, (uint32_t)at % 32); }
static int tick_high_bit(size_t at) { return flip_bit(at, 32 + (uint32_t)at % 32); }
static int identity_added(size_t at) {
  repeated(at);
  return flip_bit(at + 1, 0);
}

static int closing_removed(size_t at) {
  if (next_of(at, MESSAGE_SYNC) < changed.count) return 0;
  changed.count = at;
  return 1;
}
static int cut_behind(size_t at) {
  changed.count = at + 1;
  return at > 10 && message_at(&changed, at) != MESSAGE_SYNC;
}
static int cut_behind_sync(size_t at) {
  changed.count = at + 1;
  return 1;
}

/* ---- frames that are added, moved, of another form */

/* From entry `from` to before entry `to`. */
static void move_entry(size_t from, size_t to) {
  const frame f = *frame_at(from);
  remove_at(from);
  insert(&changed, to > from ? to - 1 : to, &f);
}

/* The n-th SYNC of another tick behind (before) this entry. */
static size_t sync_behind(size_t at, int n) {
  while (n-- > 0 && at < changed.count) {
    const size_t sync = at = next_of(at, MESSAGE_SYNC);
    const size_t again = next_of(sync, MESSAGE_SYNC);
    if (again < changed.count && memcmp(frame_at(sync)->data, frame_at(again)->data, 8) == 0) at = again;
  }
  return at;
}
static size_t sync_before(size_t at, int n) {
  for (; n > 0 && at > 0; --n) {
    do --at;
    while (at > 0 && message_at(&changed, at) != MESSAGE_SYNC);
    if (at > 0 && message_at(&changed, at - 1) == MESSAGE_SYNC) --at;
  }
  return at;
}

static int moved_later(size_t at, int ticks) {
  const size_t to = sync_behind(at, ticks);
  if (to + 1 >= changed.count) return 0;
  move_entry(at, to + 1);
  return 1;
}
static int moved_earlier(size_t at, int ticks) {
  const size_t to = sync_before(at, ticks + 1); /* the first one is of its own tick, or the one before */
  if (message_at(&changed, to) != MESSAGE_SYNC || at < 10) return 0;
  move_entry(at, to);
  return 1;
}
/* This and all that follow of its message, in their order: to here, or to the end. */
static int all_moved(size_t at, int to_the_end) {
  const dictionary_message m = message_at(&changed, at);
  size_t n = at;
  for (int end = 0; end < 2; ++end)
    for (size_t from = at; from < good.count; ++from)
      if ((message_at(&good, from) == m) == (end == to_the_end)) changed.entries[n++] = good.entries[from];
  return at >= 10;
}
static int all_behind_this(size_t at) { return all_moved(at, 0); }
static int all_at_the_end(size_t at) { return all_moved(at, 1); }
static int later_3(size_t at) {
  return (message_at(&changed, at) != MESSAGE_POSE_RIGHT || is_taken(at)) && moved_later(at, 3);
}
static int later_12(size_t at) { return moved_later(at, 12); }
static int earlier_5(size_t at) { return moved_earlier(at, 5); }
static int to_the_end(size_t at) {
  move_entry(at, changed.count);
  return 1;
}
static int to_the_first(size_t at) {
  move_entry(at, sync_at(&changed, 0) + 1);
  return 1;
}

/* A POSE like that of this entry, before `to`. */
static int add_pose(size_t at, size_t to, uint32_t hand, uint32_t ahead) {
  frame f;
  fray_pose pose;
  if (!is_taken(at) || codec_decode_pose(frame_at(at), 0, RIGHT, &pose) != CODEC_OK) return 0;
  pose.counter = (uint8_t)((pose.counter + ahead) & 15u);
  pose.x = (int16_t)(pose.x + 100);
  codec_encode_pose(&f, 0, hand, &pose);
  insert(&changed, to, &f);
  return 1;
}
static int pose_next(size_t at) {
  return at > 100 && next_of(at, MESSAGE_POSE_RIGHT) < changed.count && add_pose(at, at + 1, RIGHT, 1);
}
static int other_counter_before(size_t at) { return at > 100 && add_pose(at, at, RIGHT, 1 + (uint32_t)at % 15); }
static int other_counter_behind(size_t at) { return at > 100 && add_pose(at, at + 1, RIGHT, 2 + (uint32_t)at % 14); }
static int pose_left(size_t at) { return add_pose(at, at, 0, 1); }

/* Behind entry `at`. */
static int wrong_crc_added(size_t at) {
  repeated(at);
  frame_at(at + 1)->data[0] ^= 1;
  return 1;
}

/* With a reserved bit, or command 0; its CRC is right. */
static int malformed_added(size_t at) {
  if (is_stop(at) || !command_added_here(at)) return 0;
  if (at % 2 != 0) frame_at(at)->data[3] = 1;
  else frame_at(at)->data[2] = 0;
  mend(at);
  return 1;
}

static void add_command(size_t at, uint8_t counter, uint8_t what) {
  frame f;
  codec_encode_command(&f, 0, &(codec_command){counter & 15u, what, 0});
  insert(&changed, at, &f);
}
static uint8_t counter_at(size_t at) { return frame_at(at)->data[1] & 15u; }
static int last_again(size_t at) {
  if (at < 10) return 0;
  add_command(sync_behind(at, 1), counter_at(at), FRAY_COMMAND_ZERO);
  return 1;
}
/* So many ticks behind this COMMAND, whose counter is one ahead of the last; `what` is never what it was. */
static int last_but_one(size_t at, int ticks) {
  const size_t to = sync_behind(at, ticks);
  if (is_repeated(at) || at < 10 || to > next_of(at, MESSAGE_COMMAND) || to >= changed.count) return 0;
  add_command(to, (uint8_t)(counter_at(at) + 15u), FRAY_COMMAND_ZERO);
  return 1;
}
static int last_but_one_near(size_t at) { return last_but_one(at, 2); }
static int last_but_one_far(size_t at) { return last_but_one(at, 4); }
static int copied_before(size_t at, int ticks) {
  const size_t to = sync_before(at, ticks);
  if (is_repeated(at) || at < 100) return 0;
  const frame f = *frame_at(at);
  insert(&changed, to, &f);
  return 1;
}
static int copied_near(size_t at) { return copied_before(at, 2); }
static int copied_far(size_t at) { return copied_before(at, 4); }
static int command_later(size_t at) { return !is_repeated(at) && later_3(at); }
static int command_earlier(size_t at) { return !is_repeated(at) && earlier_5(at); }
static int command_near(size_t at) { return !is_repeated(at) && at > 100 && moved_earlier(at, at % 2); }
static int command_before_all(size_t at) {
  (void)at;
  add_command(0, 9, FRAY_COMMAND_START);
  return 1;
}
static int command_behind_all(size_t at) {
  (void)at;
  add_command(sync_at(&changed, TICKS - 1) + 1, 9, FRAY_COMMAND_START);
  return 1;
}
static int command_in_flood(size_t at) {
  if (at < 100 || at % 7 != 0 || !is_taken(at)) return 0;
  for (int n = 0; n < PORT_FRAMES_PER_TICK; ++n) repeated(at);
  add_command(at + PORT_FRAMES_PER_TICK + 1, 9, FRAY_COMMAND_HALT);
  return 1;
}

static int before_the_first(size_t at) {
  const dictionary_message m = message_at(&changed, at);
  if (m != MESSAGE_FORCE_RIGHT && m != MESSAGE_ACK && m != MESSAGE_TEAR && m != MESSAGE_STATUS) return 0;
  const frame f = *frame_at(at);
  insert(&changed, sync_at(&changed, 0), &f);
  return 1;
}
static int force_left(size_t at) {
  frame f;
  codec_encode_force(&f, 0, 0, &(codec_force){1, 2, 3, counter_at(at), 0});
  insert(&changed, at, &f);
  return 1;
}
static int ack_of_before(size_t at) {
  frame f;
  codec_encode_ack(&f, 0, &(codec_ack){3, FRAY_COMMAND_STOP, 0, UINT32_MAX});
  insert(&changed, at, &f);
  return 1;
}
static int identity_at_end(size_t at) {
  const frame f = *frame_at(at);
  insert(&changed, changed.count, &f);
  return 1;
}
static int first_identity_at_end(size_t at) {
  return next_of(at, MESSAGE_IDENTITY) < changed.count && identity_at_end(at);
}

static int as_fd(size_t at) {
  frame_at(at)->fd = at % 2 != 0 ? FRAME_FD : FRAME_FD | FRAME_FD_BRS;
  return 1;
}
static int of_others(size_t at) {
  repeated(at);
  if (at % 2 == 0)
    frame_at(at + 1)->extended = 1;
  else
    frame_at(at + 1)->id = dictionary_id(message_at(&changed, at), 1);
  return 1;
}
static int other_time(size_t at) {
  changed.entries[at].time_us += 5000000;
  return 1;
}

/* ---- under a key */

static int sealed(const uint8_t *bytes, dictionary_message form, size_t n, size_t byte) {
  static const uint8_t KEY[CMAC_KEY] = {1, 2, 3};
  cmac_key key, other;
  auth_gate runtime, device;
  unseal_counts counts;
  cmac_key_init(&key, KEY);
  cmac_key_init(&other, bytes == NULL ? KEY : bytes);
  auth_gate_init(&runtime, &key, AUTH_GATE_FD, AUTH_GATE_RUNTIME, 0, 3);
  auth_gate_init(&device, &key, AUTH_GATE_FD, AUTH_GATE_DEVICE, 0, 3);
  for (size_t at = 0; at < changed.count; ++at) {
    frame *f = frame_at(at);
    if (!auth_gate_seal(&device, f) || (f->fd == 0 && !auth_gate_seal(&runtime, f))) return 0;
    if (message_at(&changed, at) == form && n-- == 0) f->data[byte] ^= 4;
  }
  unseal_fd("r.log", &changed, &other, 0, &counts, NULL);
  return 1;
}
static int same_key(size_t at) { return at > 0 && sealed(NULL, MESSAGES, 0, 0); }
static int other_key(size_t at) { return at > 0 && sealed((const uint8_t[CMAC_KEY]){1, 2, 4}, MESSAGES, 0, 0); }
static int sealed_pose(size_t at) { return sealed(NULL, MESSAGE_POSE_RIGHT_AUTH, at / 4, at % 20); }
static int sealed_force(size_t at) { return sealed(NULL, MESSAGE_FORCE_RIGHT_AUTH, at / 4, at % 20); }
static int sealed_command(size_t at) { return sealed(NULL, MESSAGE_COMMAND_AUTH, 1, at % 20); }
static int sealed_ack(size_t at) { return sealed(NULL, MESSAGE_ACK_AUTH, 1, at % 20); }

#endif
