/* SPDX-License-Identifier: Apache-2.0 */
/* The loop under a key, with a device that has it and an attacker who has not: what is forged,
 * replayed, held back or left away is never used, and stands in the right counter; the log of it all
 * replays to the same hashes. */
#include <stdlib.h>

#include "tests/lib/test.h"
#include "tests/sim/sim_session.h"
#include "tools/bus_key.h"
#include "tools/replay.h"
#include "tools/unseal.h"

enum { TICKS_MAX = 8192, EVIL_X = 30000, KINDS = 8, FADE = 10, CAPTURED = 4096 };

static const uint8_t KEY_BYTES[16] = {0x2b, 0x7e, 0x15, 0x16, 0x28, 0xae, 0xd2, 0xa6,
                                      0xab, 0xf7, 0x15, 0x88, 0x09, 0xcf, 0x4f, 0x3c};
static const uint8_t OTHER_BYTES[16] = {1};
static cmac_key key, other_key;

static session s;
static guard runtime, hand, thief;
static uint32_t hashes[TICKS_MAX], ticks;
static uint64_t seed;

static uint32_t below(uint32_t n) { return (uint32_t)(fixture_random(&seed) % n); }

static void protect(const cmac_key *device_key, guard_form form) {
  session_begin(&s);
  guard_init(&runtime, &key, form, GUARD_RUNTIME, 0, s.f.facts.hands);
  guard_init(&hand, device_key, form, GUARD_DEVICE, 0, 0);
  guard_init(&thief, &other_key, form, GUARD_DEVICE, 0, 0);
  loop_protect(&s.l, &runtime);
  ticks = 0;
}

static void end(void) {
  fixture_close(&s.f);
  sim_end();
}

static loop_result tick(void) {
  const loop_result result = loop_run(&s.l);
  if (result == LOOP_TICKED && ticks < TICKS_MAX)
    hashes[ticks++] = (uint32_t)(s.l.output.hash & 0xFFFFFFFFu);
  return result;
}

/* What the device says next of this hand, sealed; classic: its TAG to *tag, iff 1. */
static int make_pose(uint32_t h, int32_t x, frame *f, frame *tag) {
  s.counter[h] = (uint8_t)((s.counter[h] + 1u) & 15u);
  const fray_pose pose = {(int16_t)x, 0, 0, s.counter[h], 0};
  codec_encode_pose(f, 0, h, &pose);
  CHECK(guard_seal(&hand, f));
  return guard_tag(&hand, f, tag);
}

static void say_poses(int32_t apart) {
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    frame f, tag;
    const int tagged = make_pose(h, h == 0 ? -apart : apart, &f, &tag);
    sim_say(&f);
    if (tagged) sim_say(&tag);
  }
}

static void say_verb(uint8_t verb) {
  frame f;
  s.command = (uint8_t)((s.command + 1u) & 15u);
  const codec_command command = {s.command, verb, 0};
  codec_encode_command(&f, 0, &command);
  CHECK(guard_seal(&hand, &f));
  sim_say(&f);
}

/* START, the hands go apart in `count` ticks. */
static void start(int32_t count, int32_t apart) {
  say_poses(0);
  say_verb(FRAY_VERB_START);
  for (int32_t n = 0; n < count; ++n) {
    CHECK_EQ_INT(tick(), LOOP_TICKED);
    say_poses(n < 20 ? 0 : apart * (n - 20) / count);
  }
}

/* The log of the bus, unsealed, gives the same inputs: a second world the same hashes. */
static unseal_counts replays(fixture *again) {
  size_t bytes;
  candump_log log;
  candump_error error;
  replay r;
  unseal_counts counts = {0, 0, 0};
  uint32_t bad = 0;
  char *const text = sim_log(&bytes);
  CHECK(candump_parse_all("sim", text, bytes, &log, &error));
  free(text);
  if (runtime.form == GUARD_FD)
    unseal_fd("sim", &log, &key, 0, &counts, NULL);
  else
    unseal_classic("sim", &log, &key, 0, s.f.facts.hands, &counts, NULL);
  const replay_setting setting = {0, s.f.facts.hands, s.f.facts.rate_hz, {0, 0}};
  memset(&error, 0, sizeof error);
  const int good = replay_read("sim", &log, &setting, &r, &error);
  CHECK(good);
  if (!good) candump_print_error(stdout, &error);
  for (uint32_t n = 0; good && n < r.count; ++n) {
    const fray_output out = fixture_tick(again, &r.ticks[n].input);
    bad += (uint32_t)(out.hash & 0xFFFFFFFFu) != hashes[n];
  }
  CHECK(good && r.count >= ticks);
  CHECK_EQ_INT(bad, 0);
  replay_free(&r);
  candump_free(&log);
  return counts;
}

/* CAN FD */

static void a_session_tears_and_verifies(void) {
  fixture again;
  fixture_file(&s.f, "tests/bus/scenes/sheet.scene", NULL);
  fixture_file(&again, "tests/bus/scenes/sheet.scene", NULL);
  protect(&key, GUARD_FD);
  start(250, 4000);
  CHECK_EQ_INT(s.l.output.state, FRAY_OPERATIONAL);
  CHECK(s.l.output.cuts_total > 0);
  loop_command(&s.l, FRAY_VERB_STOP);
  for (int n = 0; n < 40; ++n) {
    CHECK_EQ_INT(tick(), LOOP_TICKED);
    say_poses(3000);
  }
  CHECK_EQ_INT(s.l.output.state, FRAY_READY);
  /* nothing that has a protected form is said in plain */
  static const dictionary_message protected[] = {MESSAGE_COMMAND, MESSAGE_ACK, MESSAGE_POSE_LEFT,
                                                 MESSAGE_FORCE_LEFT, MESSAGE_FORCE_RIGHT};
  for (int n = 0; n < 5; ++n) CHECK_EQ_INT(sim_own(0, dictionary_id(protected[n], 0), 0), 0);
  CHECK_EQ_INT(sim_own(0, dictionary_id(MESSAGE_FORCE_LEFT_AUTH, 0), 0), ticks);
  CHECK_EQ_INT(sim_own(0, dictionary_id(MESSAGE_ACK_AUTH, 0), 0), 2);
  CHECK_EQ_INT(sim_own(0, dictionary_id(MESSAGE_COMMAND_AUTH, 0), 0), 1);
  CHECK_EQ_INT(sim_own(0, dictionary_id(MESSAGE_SYNC, 0), 0), ticks);
  const unseal_counts counts = replays(&again);
  CHECK_EQ_INT(counts.refused, 0);
  printf("figure auth_session %u ticks, %u springs cut, %u frames with a good tag (asked: tears, verifies)\n",
         ticks, s.l.output.cuts_total, counts.good);
  fixture_close(&again);
  end();
}

/* What the board refuses is said in the next tick, sealed as it was: each lane still rises. */
static void refused_frames_stay_in_order(void) {
  fixture again;
  fixture_file(&s.f, "tests/bus/scenes/sheet.scene", NULL);
  fixture_file(&again, "tests/bus/scenes/sheet.scene", NULL);
  protect(&key, GUARD_FD);
  start(40, 0);
  for (uint32_t n = 0; n < 40; ++n) {
    if (n % 2 == 0) {
      say_verb(FRAY_VERB_ZERO);
      sim.send_fails = 1 + n / 2 % 3; /* FORCE, FORCE, ACK */
    }
    CHECK_EQ_INT(tick(), LOOP_TICKED);
    CHECK_EQ_INT(s.l.unsent_count, n % 2 == 0 ? 1 + n / 2 % 3 : 0);
    say_poses(0);
  }
  CHECK_EQ_INT(s.l.frames_lost, 0);
  CHECK_EQ_INT(replays(&again).refused, 0);
  fixture_close(&again);
  end();
}

/* What the attacker has seen. */
static frame captured[CAPTURED];
static uint32_t captured_count;
static uint32_t forged, replayed, plain_said, late, dropped;

static void capture(const frame *f) { captured[captured_count++ % CAPTURED] = *f; }

/* One frame of the attacker's; `next`: the device's next one of the lane, not yet said. */
static void attack(uint32_t kind, uint32_t h, const frame *next) {
  frame f = *next;
  const fray_pose pose = {EVIL_X, 0, 0, (uint8_t)(s.counter[h] & 15u), 0};
  switch (kind) {
    case 0: /* the right freshness, another pose, any tag */
      codec_encode_pose(&f, 0, h, &pose);
      f.id = next->id;
      f.fd = next->fd;
      f.length = next->length;
      for (int n = 12; n < 20; ++n) f.data[n] = (uint8_t)below(256);
      break;
    case 1: f.data[below(8)] ^= (uint8_t)(1u << below(8)); break;
    case 2: f.data[12 + below(8)] ^= (uint8_t)(1u << below(8)); break;
    case 3: f.data[11] ^= 0x40; break; /* a freshness of long from now */
    case 4: /* under another key */
      thief.out[1 + h].last = s.l.in.guard->in[1 + h].last + 1;
      codec_encode_pose(&f, 0, h, &pose);
      CHECK(guard_seal(&thief, &f));
      break;
    case 5: /* the other hand's */
      f.id = dictionary_id(dictionary_auth(dictionary_pose(1 - h)), 0);
      break;
    case 6: /* plain */
      codec_encode_pose(&f, 0, h, &pose);
      break;
    default:
      f = captured[below(captured_count < CAPTURED ? captured_count : CAPTURED)];
      break;
  }
  /* the other hand may be ahead by now: then its freshness is old */
  if (kind == 6) ++plain_said;
  if (kind == 7) ++replayed;
  if (kind < 6) ++forged;
  sim_say(&f);
}

/* The newest genuine pose of each hand on the bus; what a tick takes must be it. */
static int32_t genuine_x[FRAY_HANDS];

static void said(uint32_t h, const frame *f, int32_t x) {
  sim_say(f);
  capture(f);
  genuine_x[h] = x;
}

static void hostile_tick(uint32_t n) {
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    const int32_t x = (int32_t)(n % 1000);
    frame f, g, tag;
    (void)make_pose(h, x, &f, &tag);
    for (uint32_t a = below(4); a > 0; --a) attack(below(KINDS), h, &f);
    /* never so many in a row that the hand is stale */
    switch (n < 40 || n % 3 != 0 ? 9u : below(4)) {
      case 0: /* held back behind the next one */
        (void)make_pose(h, x, &g, &tag);
        said(h, &g, x);
        sim_say(&f);
        ++late;
        break;
      case 1: ++dropped; break;
      default: said(h, &f, x); break;
    }
    for (uint32_t a = below(4); a > 0; --a) attack(below(KINDS), h, &f);
  }
}

static void an_attacker_in_a_live_session(void) {
  enum { TICKS = 5000 };
  fixture again;
  uint32_t used = 0, evil = 0;
  forged = replayed = plain_said = late = dropped = captured_count = 0;
  seed = 11;
  session_scene(&s.f, 8, 4, "0.25");
  session_scene(&again, 8, 4, "0.25");
  protect(&key, GUARD_FD);
  say_poses(0);
  capture(&sim.entries[sim.count - 1].f);
  say_verb(FRAY_VERB_START);
  capture(&sim.entries[sim.count - 1].f);
  for (uint32_t n = 0; n < TICKS; ++n) {
    CHECK_EQ_INT(tick(), LOOP_TICKED);
    for (uint32_t h = 0; h < FRAY_HANDS && n > 0; ++h) {
      if (((uint32_t)s.l.input.has_pose >> h & 1u) == 0) continue;
      used += 1;
      evil += s.l.input.pose[h].x != genuine_x[h];
    }
    CHECK_EQ_INT(s.l.input.verb, n == 0 ? FRAY_VERB_START : FRAY_VERB_NONE);
    hostile_tick(n);
  }
  CHECK_EQ_INT(evil, 0);
  CHECK(used > 2 * TICKS * 8 / 10);
  CHECK_EQ_INT(s.l.output.state, FRAY_OPERATIONAL);
  const auth_lane *in = runtime.in;
  (void)tick(); /* what was said after the last one */
  CHECK_EQ_INT(in[0].forged + in[1].forged + in[2].forged + in[0].old + in[1].old + in[2].old,
               forged + replayed + late);
  CHECK(in[1].forged + in[2].forged > forged / 2);
  CHECK(in[0].old + in[1].old + in[2].old >= replayed + late);
  CHECK_EQ_INT(runtime.plain, plain_said);
  CHECK_EQ_INT(runtime.unread, 0);
  CHECK_EQ_INT(in[1].lost + in[2].lost, late + dropped);
  CHECK_EQ_INT(in[1].malformed + in[2].malformed, 0);
  const unseal_counts counts = replays(&again);
  CHECK_EQ_INT(counts.refused, forged + replayed + late + plain_said);
  printf("figure auth_attack %u ticks: %u forged, %u replayed, %u without a tag, %u late; %u used of them "
         "(asked: 0); %u dropped, %u skipped counted\n",
         ticks, forged, replayed, plain_said, late, evil, dropped, in[1].lost + in[2].lost);
  fixture_close(&again);
  end();
}

/* More forged frames than a tick looks at: the work has a bound, the hand goes stale, the sheet rests. */
static void a_flood_of_forged_frames_is_bounded(void) {
  frame f, tag;
  session_scene(&s.f, 8, 4, "0.25");
  protect(&key, GUARD_FD);
  start(160, 500);
  CHECK_EQ_INT(s.l.output.state, FRAY_OPERATIONAL);
  (void)tick();
  const uint32_t before = runtime.in[1].forged;
  for (int n = 0; n < 10; ++n) {
    (void)make_pose(0, 0, &f, &tag);
    f.data[19] ^= 1;
    for (int copies = 0; copies < 200; ++copies) sim_say(&f);
    CHECK_EQ_INT(tick(), LOOP_TICKED);
    CHECK_EQ_INT(runtime.in[1].forged, before + (uint32_t)(n + 1) * GUARD_LOOKS);
  }
  CHECK_EQ_INT(runtime.unread, 10 * (200 - GUARD_LOOKS));
  CHECK_EQ_INT(s.l.output.state, FRAY_SAFE);
  for (int n = 0; n < FADE; ++n) (void)tick();
  CHECK(session_force_is_zero(&s.l.output));
  end();
}

static void a_wrong_key_brings_nothing(void) {
  bus_key b;
  memset(&b, 0, sizeof b);
  session_scene(&s.f, 8, 4, "0.25");
  protect(&other_key, GUARD_FD);
  for (int n = 0; n < 300; ++n) {
    say_poses(100);
    if (n % 50 == 0) say_verb(FRAY_VERB_START);
    CHECK_EQ_INT(tick(), LOOP_TICKED);
    CHECK_EQ_INT(s.l.output.state, FRAY_READY);
    CHECK_EQ_INT(s.l.input.has_pose | s.l.input.verb, 0);
    CHECK(session_force_is_zero(&s.l.output));
  }
  CHECK_EQ_INT(runtime.in[1].forged, 300);
  b.g = runtime;
  CHECK_TEXT(bus_key_complaint(&b), "no tag fits: the other end has another key");
  end();
}

/* What the runtime said comes back to it, and is no operator's word. */
static void the_loops_own_commands(void) {
  size_t at = 0;
  session_scene(&s.f, 8, 4, "0.25");
  protect(&key, GUARD_FD);
  start(160, 500);
  loop_command(&s.l, FRAY_VERB_HALT);
  (void)tick();
  CHECK_EQ_INT(s.l.output.state, FRAY_SAFE);
  while (at < sim.count && !(sim.entries[at].own && sim.entries[at].f.id == 0x020)) ++at;
  CHECK(at < sim.count);
  const frame halt = sim.entries[at].f;
  CHECK_EQ_INT(halt.length, 20);
  CHECK_EQ_INT(halt.data[11], 0x80);
  say_poses(0);
  say_verb(FRAY_VERB_RESET);
  (void)tick();
  CHECK_EQ_INT(s.l.output.state, FRAY_READY);
  sim_say(&halt);
  (void)tick();
  CHECK_EQ_INT(s.l.output.state, FRAY_READY);
  CHECK_EQ_INT(s.l.input.verb, FRAY_VERB_NONE);
  CHECK_EQ_INT(runtime.in[0].old, 1);
  say_verb(FRAY_VERB_HALT); /* an operator still can */
  (void)tick();
  CHECK_EQ_INT(s.l.output.state, FRAY_SAFE);
  end();
}

/* A runtime whose freshness is not stored any more sends no force. */
static void a_spent_lane_sends_nothing(void) {
  session_scene(&s.f, 8, 4, "0.25");
  protect(&key, GUARD_FD);
  runtime.out[1].most = 30;
  start(60, 0);
  CHECK_EQ_INT(sim_own(0, dictionary_id(MESSAGE_FORCE_LEFT_AUTH, 0), 0), 30);
  CHECK_EQ_INT(sim_own(0, dictionary_id(MESSAGE_FORCE_RIGHT_AUTH, 0), 0), 60);
  CHECK_EQ_INT(s.l.unsealed, 30);
  end();
}

/* Classic */

/* A disk that hangs: what is stored is used up, and later there is more. */
static void forces_that_could_not_be_sealed_do_not_come_back(void) {
  session_scene(&s.f, 8, 4, "0.25");
  protect(&key, GUARD_FD);
  start(100, 500);
  CHECK_EQ_INT(s.l.output.state, FRAY_OPERATIONAL);
  const uint32_t most = runtime.out[1].most;
  runtime.out[1].most = runtime.out[1].last;
  for (int n = 0; n < 20; ++n) {
    CHECK_EQ_INT(tick(), LOOP_TICKED);
    say_poses(500);
  }
  CHECK_EQ_INT(s.l.unsealed, 20);
  CHECK_EQ_INT(s.l.output.state, FRAY_SAFE);
  CHECK_EQ_INT(sim_own(0, dictionary_id(MESSAGE_COMMAND_AUTH, 0), 0), 1); /* one HALT */
  runtime.out[1].most = most;
  for (int n = 0; n < 40; ++n) {
    if (n == 20) say_verb(FRAY_VERB_START);
    CHECK_EQ_INT(tick(), LOOP_TICKED);
    say_poses(500);
    CHECK(session_force_is_zero(&s.l.output));
  }
  CHECK_EQ_INT(s.l.unsealed, 20);
  end();
}

static void tags_of_a_long_session(void) {
  fixture again;
  session_scene(&s.f, 8, 4, "0.25");
  session_scene(&again, 8, 4, "0.25");
  protect(&key, GUARD_CLASSIC);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    runtime.watch[h].group.last = hand.group[h].last = 0x1FFF0; /* past 16 bits in the session */
  start(600, 500);
  CHECK_EQ_INT(s.l.output.state, FRAY_OPERATIONAL);
  CHECK_EQ_INT(runtime.watch[0].good + runtime.watch[1].good, 2 * 150);
  CHECK_EQ_INT(runtime.watch[0].bad + runtime.watch[0].missing, 0);
  const unseal_counts counts = replays(&again);
  CHECK_EQ_INT(counts.good, 300);
  CHECK_EQ_INT(counts.refused + counts.dropped, 0);
  fixture_close(&again);
  end();
}

/* The forger says a POSE of the left hand before the device's: its next counter, another place. */
static uint32_t forge_until_safe(void) {
  uint32_t taken = 0;
  for (int n = 0; n < 64 && s.l.output.state != FRAY_SAFE; ++n) {
    const fray_pose evil = {EVIL_X, 0, 0, (uint8_t)((s.counter[0] + 1u) & 15u), 0};
    frame f;
    codec_encode_pose(&f, 0, 0, &evil);
    sim_say(&f);
    say_poses(500);
    CHECK_EQ_INT(tick(), LOOP_TICKED);
    taken += (s.l.input.has_pose & 1u) != 0 && s.l.input.pose[0].x == EVIL_X;
  }
  return taken;
}

static uint32_t ticks_to_zero(void) {
  uint32_t n = 0;
  for (; n < 100 && !session_force_is_zero(&s.l.output); ++n) {
    say_poses(500);
    (void)tick();
  }
  return n;
}

static void a_forger_on_classic_leads_to_safe(void) {
  fixture again;
  bus_key b;
  session_scene(&s.f, 8, 4, "0.25");
  session_scene(&again, 8, 4, "0.25");
  protect(&key, GUARD_CLASSIC);
  start(200, 500);
  CHECK_EQ_INT(s.l.output.state, FRAY_OPERATIONAL);
  CHECK(!session_force_is_zero(&s.l.output));
  const uint32_t poses = runtime.watch[0].poses;
  const uint32_t taken = forge_until_safe();
  CHECK_EQ_INT(s.l.output.state, FRAY_SAFE);
  CHECK_EQ_INT(s.l.output.faults & FRAY_FAULT_HALTED, FRAY_FAULT_HALTED);
  const uint32_t used = runtime.watch[0].poses - poses;
  CHECK(used <= 4 * AUTH_FAILURES_MAX + 3);
  const uint32_t zero = ticks_to_zero();
  CHECK(zero <= FADE);
  /* the forger goes; it stays in SAFE until an operator clears it */
  for (int n = 0; n < 100; ++n) {
    say_poses(500);
    if (n == 50) say_verb(FRAY_VERB_START);
    (void)tick();
    CHECK_EQ_INT(s.l.output.state, FRAY_SAFE);
    CHECK(session_force_is_zero(&s.l.output));
    CHECK_EQ_INT(s.l.input.has_pose & 1u, 0);
  }
  CHECK(runtime.plain >= 100);
  say_verb(FRAY_VERB_RESET);
  for (int n = 0; n < 5; ++n) {
    (void)tick();
    say_poses(500);
  }
  CHECK_EQ_INT(runtime.failed, 0);
  say_verb(FRAY_VERB_START);
  for (int n = 0; n < 60; ++n) {
    (void)tick();
    say_poses(500);
  }
  CHECK_EQ_INT(s.l.output.state, FRAY_OPERATIONAL);
  const unseal_counts counts = replays(&again);
  CHECK(counts.dropped > 0);
  memset(&b, 0, sizeof b);
  b.g = runtime;
  CHECK(bus_key_complaint(&b) == NULL); /* the TAGs before were good */
  printf("figure auth_classic_forger %u forged poses taken, %u used in all before SAFE (bound: 15), force "
         "zero %u ticks later (asked: 10)\n",
         taken, used, zero);
  fixture_close(&again);
  end();
}

static void no_tags_at_all(void) {
  bus_key b;
  memset(&b, 0, sizeof b);
  session_scene(&s.f, 8, 4, "0.25");
  protect(&key, GUARD_CLASSIC);
  session_say(&s, FRAY_VERB_START);
  for (int n = 0; n < 100; ++n) (void)session_tick(&s);
  CHECK_EQ_INT(s.l.output.state, FRAY_SAFE);
  CHECK(session_force_is_zero(&s.l.output));
  b.g = runtime;
  CHECK_TEXT(bus_key_complaint(&b), "no TAG comes: the other end has no key, or no --classic-tags");
  end();
}

int main(void) {
  cmac_key_init(&key, KEY_BYTES);
  cmac_key_init(&other_key, OTHER_BYTES);
  TEST(a_session_tears_and_verifies);
  TEST(refused_frames_stay_in_order);
  TEST(an_attacker_in_a_live_session);
  TEST(a_flood_of_forged_frames_is_bounded);
  TEST(a_wrong_key_brings_nothing);
  TEST(the_loops_own_commands);
  TEST(a_spent_lane_sends_nothing);
  TEST(forces_that_could_not_be_sealed_do_not_come_back);
  TEST(tags_of_a_long_session);
  TEST(a_forger_on_classic_leads_to_safe);
  TEST(no_tags_at_all);
  return test_end();
}
