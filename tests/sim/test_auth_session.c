/* SPDX-License-Identifier: Apache-2.0 */
/* The loop under a key, with a device that has it and an attacker who has not: what is forged,
 * replayed, held back or left away is never used, and stands in the right counter; the log of it all
 * replays to the same hashes. */
#include <stdlib.h>

#include "tests/lib/rfc4493_key.h"
#include "tests/lib/test.h"
#include "tests/sim/session_replay.h"
#include "tools/bus/bus_key.h"
#include "tools/recording/unseal.h"

enum { EVIL_X = 30000, KINDS = 8, FADE = 10, CAPTURED = 4096 };

static const uint8_t OTHER_BYTES[16] = {1};
static cmac_key key, other_key;

static session s;
static auth_gate runtime, hand, thief;
static uint64_t seed;

static uint32_t below(uint32_t n) { return (uint32_t)(splitmix64(&seed) % n); }

static void protect(const cmac_key *device_key, auth_gate_form form) {
  session_begin(&s);
  auth_gate_init(&runtime, &key, form, AUTH_GATE_RUNTIME, 0, s.f.facts.hands);
  auth_gate_init(&hand, device_key, form, AUTH_GATE_DEVICE, 0, 0);
  auth_gate_init(&thief, &other_key, form, AUTH_GATE_DEVICE, 0, 0);
  loop_protect(&s.l, &runtime);
  session_ticks = 0;
}

static void begin(const cmac_key *device_key, auth_gate_form form) {
  session_scene(&s.f, 8, 4, "0.25");
  protect(device_key, form);
}

static void end(void) {
  fixture_close(&s.f);
  sim_end();
}

static loop_result tick(void) { return session_hashed_tick(&s); }

/* What the device says next of this hand, sealed; classic: its TAG to *tag, iff 1. */
static int make_pose(uint32_t h, int32_t x, frame *f, frame *tag) {
  s.counter[h] = (uint8_t)((s.counter[h] + 1u) & 15u);
  const fray_pose pose = {(int16_t)x, 0, 0, s.counter[h], 0};
  codec_encode_pose(f, 0, h, &pose);
  CHECK(auth_gate_seal(&hand, f));
  return auth_gate_tag(&hand, f, tag);
}

static void say_poses(int32_t apart) {
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    frame f, tag;
    const int tagged = make_pose(h, h == 0 ? -apart : apart, &f, &tag);
    sim_inject(&f);
    if (tagged) sim_inject(&tag);
  }
}

static void say_verb(uint8_t verb) {
  frame f;
  s.command = (uint8_t)((s.command + 1u) & 15u);
  const codec_command command = {s.command, verb, 0};
  codec_encode_command(&f, 0, &command);
  CHECK(auth_gate_seal(&hand, &f));
  sim_inject(&f);
}

/* Ticks with the hands so far apart. */
static void stay(int32_t count, int32_t apart) {
  for (int32_t n = 0; n < count; ++n) {
    CHECK_EQ_INT(tick(), LOOP_TICKED);
    say_poses(apart);
  }
}

/* START, the hands go apart in `count` ticks. */
static void start(int32_t count, int32_t apart) {
  say_poses(0);
  say_verb(FRAY_COMMAND_START);
  for (int32_t n = 0; n < count; ++n) {
    CHECK_EQ_INT(tick(), LOOP_TICKED);
    say_poses(n < 20 ? 0 : apart * (n - 20) / count);
  }
}
static void run_up(int32_t count, int32_t apart) {
  start(count, apart);
  CHECK_EQ_INT(s.l.output.state, FRAY_OPERATIONAL);
}

/* The log of the bus, unsealed, gives the same inputs: a second world the same hashes. */
static unseal_counts replays(void) {
  candump_log log;
  unseal_counts counts = {0, 0, 0};
  session_end_log(&s, &log);
  if (runtime.form == AUTH_GATE_FD)
    unseal_fd("sim", &log, &key, 0, &counts, NULL);
  else
    unseal_classic("sim", &log, &key, 0, s.f.facts.hands, &counts, NULL);
  (void)session_replay(&s, &log);
  return counts;
}

/* CAN FD */

static void a_session_tears_and_verifies(void) {
  fixture_file(&s.f, "tests/bus/scenes/sheet.scene", NULL);
  protect(&key, AUTH_GATE_FD);
  run_up(250, 4000);
  CHECK(s.l.output.tears_total > 0);
  loop_command(&s.l, FRAY_COMMAND_STOP);
  stay(40, 3000);
  CHECK_EQ_INT(s.l.output.state, FRAY_READY);
  /* nothing that has a protected form is said in plain */
  static const dictionary_message protected[] = {MESSAGE_COMMAND, MESSAGE_ACK, MESSAGE_POSE_LEFT,
                                                 MESSAGE_FORCE_LEFT, MESSAGE_FORCE_RIGHT};
  for (int n = 0; n < 5; ++n) CHECK_EQ_INT(sim_own(0, dictionary_id(protected[n], 0), 0), 0);
  CHECK_EQ_INT(sim_own(0, dictionary_id(MESSAGE_FORCE_LEFT_AUTH, 0), 0), session_ticks);
  CHECK_EQ_INT(sim_own(0, dictionary_id(MESSAGE_ACK_AUTH, 0), 0), 2);
  CHECK_EQ_INT(sim_own(0, dictionary_id(MESSAGE_COMMAND_AUTH, 0), 0), 1);
  CHECK_EQ_INT(sim_own(0, dictionary_id(MESSAGE_SYNC, 0), 0), session_ticks);
  const unseal_counts counts = replays();
  CHECK_EQ_INT(counts.refused, 0);
  printf("figure auth_session %u ticks, %u springs broken, %u frames with a good tag (asked: tears, verifies)\n",
         session_ticks, s.l.output.tears_total, counts.good);
  end();
}

/* What the board refuses is said in the next tick, sealed as it was: each lane still rises. */
static void refused_frames_stay_in_order(void) {
  fixture_file(&s.f, "tests/bus/scenes/sheet.scene", NULL);
  protect(&key, AUTH_GATE_FD);
  run_up(40, 0);
  for (uint32_t n = 0; n < 40; ++n) {
    if (n % 2 == 0) {
      say_verb(FRAY_COMMAND_ZERO);
      sim.send_fails = 1 + n / 2 % 3; /* FORCE, FORCE, ACK */
    }
    CHECK_EQ_INT(tick(), LOOP_TICKED);
    CHECK_EQ_INT(s.l.unsent_count, n % 2 == 0 ? 1 + n / 2 % 3 : 0);
    say_poses(0);
  }
  CHECK_EQ_INT(s.l.frames_lost, 0);
  CHECK_EQ_INT(replays().refused, 0);
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
      thief.out[1 + h].last = s.l.in.gate->in[1 + h].last + 1;
      codec_encode_pose(&f, 0, h, &pose);
      CHECK(auth_gate_seal(&thief, &f));
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
  sim_inject(&f);
}

/* The newest genuine pose of each hand on the bus; what a tick takes must be it. */
static int32_t genuine_x[FRAY_HANDS];

static void said(uint32_t h, const frame *f, int32_t x) {
  sim_inject(f);
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
        sim_inject(&f);
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
  uint32_t used = 0, evil = 0;
  forged = replayed = plain_said = late = dropped = captured_count = 0;
  seed = 11;
  begin(&key, AUTH_GATE_FD);
  say_poses(0);
  capture(&sim.entries[sim.count - 1].f);
  say_verb(FRAY_COMMAND_START);
  capture(&sim.entries[sim.count - 1].f);
  for (uint32_t n = 0; n < TICKS; ++n) {
    CHECK_EQ_INT(tick(), LOOP_TICKED);
    for (uint32_t h = 0; h < FRAY_HANDS && n > 0; ++h) {
      if (((uint32_t)s.l.input.has_pose >> h & 1u) == 0) continue;
      used += 1;
      evil += s.l.input.pose[h].x != genuine_x[h];
    }
    CHECK_EQ_INT(s.l.input.command, n == 0 ? FRAY_COMMAND_START : FRAY_COMMAND_NONE);
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
  CHECK_EQ_INT(runtime.over_budget, 0);
  CHECK_EQ_INT(in[1].lost + in[2].lost, late + dropped);
  CHECK_EQ_INT(in[1].malformed + in[2].malformed, 0);
  const unseal_counts counts = replays();
  CHECK_EQ_INT(counts.refused, forged + replayed + late + plain_said);
  printf("figure auth_attack %u ticks: %u forged, %u replayed, %u without a tag, %u late; %u used of them "
         "(asked: 0); %u dropped, %u skipped counted\n",
         session_ticks, forged, replayed, plain_said, late, evil, dropped, in[1].lost + in[2].lost);
  end();
}

/* More forged frames than a tick looks at: the work has a bound, the hand goes stale, the sheet rests. */
static void a_flood_of_forged_frames_is_bounded(void) {
  frame f, tag;
  begin(&key, AUTH_GATE_FD);
  run_up(160, 500);
  (void)tick();
  const uint32_t before = runtime.in[1].forged;
  for (int n = 0; n < 10; ++n) {
    (void)make_pose(0, 0, &f, &tag);
    f.data[19] ^= 1;
    for (int copies = 0; copies < 200; ++copies) sim_inject(&f);
    CHECK_EQ_INT(tick(), LOOP_TICKED);
    CHECK_EQ_INT(runtime.in[1].forged, before + (uint32_t)(n + 1) * AUTH_GATE_TAGS_PER_TICK);
  }
  CHECK_EQ_INT(runtime.over_budget, 10 * (200 - AUTH_GATE_TAGS_PER_TICK));
  CHECK_EQ_INT(s.l.output.state, FRAY_SAFE);
  for (int n = 0; n < FADE; ++n) (void)tick();
  CHECK(session_force_is_zero(&s.l.output));
  end();
}

static void a_wrong_key_brings_nothing(void) {
  bus_key b = {0};
  begin(&other_key, AUTH_GATE_FD);
  for (int n = 0; n < 300; ++n) {
    say_poses(100);
    if (n % 50 == 0) say_verb(FRAY_COMMAND_START);
    CHECK_EQ_INT(tick(), LOOP_TICKED);
    CHECK_EQ_INT(s.l.output.state, FRAY_READY);
    CHECK_EQ_INT(s.l.input.has_pose | s.l.input.command, 0);
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
  begin(&key, AUTH_GATE_FD);
  run_up(160, 500);
  loop_command(&s.l, FRAY_COMMAND_HALT);
  (void)tick();
  CHECK_EQ_INT(s.l.output.state, FRAY_SAFE);
  while (at < sim.count && !(sim.entries[at].own && sim.entries[at].f.id == 0x020)) ++at;
  CHECK(at < sim.count);
  const frame halt = sim.entries[at].f;
  CHECK_EQ_INT(halt.length, 20);
  CHECK_EQ_INT(halt.data[11], 0x80);
  say_poses(0);
  say_verb(FRAY_COMMAND_RESET);
  (void)tick();
  CHECK_EQ_INT(s.l.output.state, FRAY_READY);
  sim_inject(&halt);
  (void)tick();
  CHECK_EQ_INT(s.l.output.state, FRAY_READY);
  CHECK_EQ_INT(s.l.input.command, FRAY_COMMAND_NONE);
  CHECK_EQ_INT(runtime.in[0].old, 1);
  say_verb(FRAY_COMMAND_HALT); /* an operator still can */
  (void)tick();
  CHECK_EQ_INT(s.l.output.state, FRAY_SAFE);
  end();
}

/* A runtime whose freshness is not stored any more sends no force. */
static void a_spent_lane_sends_nothing(void) {
  begin(&key, AUTH_GATE_FD);
  runtime.out[1].max = 30;
  start(60, 0);
  CHECK_EQ_INT(sim_own(0, dictionary_id(MESSAGE_FORCE_LEFT_AUTH, 0), 0), 30);
  CHECK_EQ_INT(sim_own(0, dictionary_id(MESSAGE_FORCE_RIGHT_AUTH, 0), 0), 60);
  CHECK_EQ_INT(s.l.unsealed, 30);
  end();
}

/* Classic */

/* A disk that hangs: what is stored is used up, and later there is more. */
static void forces_that_could_not_be_sealed_do_not_come_back(void) {
  begin(&key, AUTH_GATE_FD);
  run_up(100, 500);
  const uint32_t max = runtime.out[1].max;
  runtime.out[1].max = runtime.out[1].last;
  stay(20, 500);
  CHECK_EQ_INT(s.l.unsealed, 20);
  CHECK_EQ_INT(s.l.output.state, FRAY_SAFE);
  CHECK_EQ_INT(sim_own(0, dictionary_id(MESSAGE_COMMAND_AUTH, 0), 0), 1); /* one HALT */
  runtime.out[1].max = max;
  for (int n = 0; n < 40; ++n) {
    if (n == 20) say_verb(FRAY_COMMAND_START);
    stay(1, 500);
    CHECK(session_force_is_zero(&s.l.output));
  }
  CHECK_EQ_INT(s.l.unsealed, 20);
  end();
}

static void tags_of_a_long_session(void) {
  begin(&key, AUTH_GATE_CLASSIC);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    runtime.monitor[h].group.last = hand.group[h].last = 0x1FFF0; /* past 16 bits in the session */
  run_up(600, 500);
  CHECK_EQ_INT(runtime.monitor[0].good + runtime.monitor[1].good, 2 * 150);
  CHECK_EQ_INT(runtime.monitor[0].bad + runtime.monitor[0].missing, 0);
  const unseal_counts counts = replays();
  CHECK_EQ_INT(counts.good, 300);
  CHECK_EQ_INT(counts.refused + counts.dropped, 0);
  end();
}

/* The forger says a POSE of the left hand before the device's: its next counter, another place. */
static uint32_t forge_until_safe(void) {
  uint32_t taken = 0;
  for (int n = 0; n < 64 && s.l.output.state != FRAY_SAFE; ++n) {
    const fray_pose evil = {EVIL_X, 0, 0, (uint8_t)((s.counter[0] + 1u) & 15u), 0};
    frame f;
    codec_encode_pose(&f, 0, 0, &evil);
    sim_inject(&f);
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
  bus_key b = {0};
  begin(&key, AUTH_GATE_CLASSIC);
  run_up(200, 500);
  CHECK(!session_force_is_zero(&s.l.output));
  const uint32_t poses = runtime.monitor[0].poses;
  const uint32_t taken = forge_until_safe();
  CHECK_EQ_INT(s.l.output.state, FRAY_SAFE);
  CHECK_EQ_INT(s.l.output.faults & FRAY_FAULT_HALTED, FRAY_FAULT_HALTED);
  const uint32_t used = runtime.monitor[0].poses - poses;
  CHECK(used <= 4 * AUTH_FAILURES_MAX + 3);
  const uint32_t zero = ticks_to_zero();
  CHECK(zero <= FADE);
  /* the forger goes; it stays in SAFE until an operator clears it */
  for (int n = 0; n < 100; ++n) {
    say_poses(500);
    if (n == 50) say_verb(FRAY_COMMAND_START);
    (void)tick();
    CHECK_EQ_INT(s.l.output.state, FRAY_SAFE);
    CHECK(session_force_is_zero(&s.l.output));
    CHECK_EQ_INT(s.l.input.has_pose & 1u, 0);
  }
  CHECK(runtime.plain >= 100);
  say_verb(FRAY_COMMAND_RESET);
  stay(5, 500);
  CHECK_EQ_INT(runtime.failed, 0);
  say_verb(FRAY_COMMAND_START);
  stay(60, 500);
  CHECK_EQ_INT(s.l.output.state, FRAY_OPERATIONAL);
  const unseal_counts counts = replays();
  CHECK(counts.dropped > 0);
  b.g = runtime;
  CHECK(bus_key_complaint(&b) == NULL); /* the TAGs before were good */
  printf("figure auth_classic_forger %u forged poses taken, %u used in all before SAFE (bound: 15), force "
         "zero %u ticks later (asked: 10)\n",
         taken, used, zero);
  end();
}

static void no_tags_at_all(void) {
  bus_key b = {0};
  begin(&key, AUTH_GATE_CLASSIC);
  session_command(&s, FRAY_COMMAND_START);
  for (int n = 0; n < 100; ++n) (void)session_tick(&s);
  CHECK_EQ_INT(s.l.output.state, FRAY_SAFE);
  CHECK(session_force_is_zero(&s.l.output));
  b.g = runtime;
  CHECK_TEXT(bus_key_complaint(&b), "no TAG comes: the other end has no key, or no --classic-tags");
  end();
}

int main(void) {
  cmac_key_init(&key, RFC4493_KEY);
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
