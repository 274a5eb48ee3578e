/* SPDX-License-Identifier: Apache-2.0 */
/* Tags written by hand come from `openssl mac -cipher AES-128-CBC ... CMAC` over bytes typed in, not
 * from this code. The key is that of RFC 4493. */
#include "rt/wire/auth.h"

#include "rt/wire/codec.h"
#include "tests/lib/rfc4493_key.h"
#include "tests/lib/splitmix64.h"
#include "tests/lib/test.h"

static cmac_key key, other_key;
static uint64_t random_state = 1;

/* For choices of the tests. */
static uint32_t random_below(uint32_t n) { return (uint32_t)(splitmix64(&random_state) % n); }

static void check_frame(const frame *f, uint32_t id, const char *data) {
  char text[41] = "";
  for (int n = 0; n < f->length && n < 20; ++n) snprintf(text + 2 * n, 3, "%02X", f->data[n]);
  CHECK_EQ_INT(f->id, id);
  CHECK_EQ_INT(f->extended | f->rtr | f->error, 0);
  CHECK_TEXT(text, data);
}

static frame pose_frame(uint32_t instance, uint32_t hand, uint32_t counter, int x) {
  frame f;
  const fray_pose pose = {(int16_t)x, 0, 0, (uint8_t)(counter & 15u), 0};
  codec_encode_pose(&f, instance, hand, &pose);
  return f;
}

/* CAN FD */

static void sealed_frames(void) {
  auth_lane lane;
  frame f;
  const codec_command command = {1, FRAY_COMMAND_START, 0};
  auth_lane_init(&lane, &key, MESSAGE_COMMAND, 0, 0);
  codec_encode_command(&f, 0, &command);
  CHECK_EQ_INT(auth_seal(&lane, &f), AUTH_OK);
  CHECK_EQ_INT(f.fd, FRAME_FD | FRAME_FD_BRS);
  CHECK_EQ_INT(f.length, 20);
  check_frame(&f, 0x020, "EC01010000000000" "01000000" "1A7E6F6E190A0D72");

  const fray_pose pose = {1, -254, -32768, 3, 10};
  auth_lane_init(&lane, &key, MESSAGE_POSE_LEFT, 0, 0x12345677);
  codec_encode_pose(&f, 0, 0, &pose);
  CHECK_EQ_INT(auth_seal(&lane, &f), AUTH_OK);
  check_frame(&f, 0x109, "28A3010002FF0080" "78563412" "CFD4B5BF447B45B3");
  CHECK_EQ_INT(lane.last, 0x12345678);
}

static void every_protected_message_goes_through(void) {
  static const dictionary_message PLAIN[] = {MESSAGE_COMMAND,   MESSAGE_ACK,
                                             MESSAGE_POSE_LEFT, MESSAGE_POSE_RIGHT,
                                             MESSAGE_FORCE_LEFT, MESSAGE_FORCE_RIGHT};
  for (int n = 0; n < 6; ++n) {
    for (uint32_t instance = 0; instance < 8; ++instance) {
      auth_lane sender, receiver;
      frame plain = {0}, f, out;
      plain.id = dictionary_id(PLAIN[n], instance);
      plain.length = 8;
      for (int b = 0; b < 8; ++b) plain.data[b] = (uint8_t)(16 * n + b);
      auth_lane_init(&sender, &key, PLAIN[n], instance, 0);
      auth_lane_init(&receiver, &key, PLAIN[n], instance, 0);
      f = plain;
      CHECK_EQ_INT(auth_seal(&sender, &f), AUTH_OK);
      CHECK_EQ_INT(auth_open(&receiver, &f, &out), AUTH_OK);
      CHECK(memcmp(&out, &plain, sizeof out) == 0);
      CHECK_EQ_INT(auth_strip(&f, instance, &out), 1);
      CHECK(memcmp(&out, &plain, sizeof out) == 0);
      CHECK_EQ_INT(auth_strip(&f, (instance + 1) % 8, &out), 0);
      CHECK_EQ_INT(auth_strip(&plain, instance, &out), 0);
      CHECK_EQ_INT(receiver.accepted, 1);
    }
  }
}

/* An attacker who can only leave the tag away gets nowhere. */
static void plain_and_malformed_frames_are_refused(void) {
  auth_lane sender, receiver;
  frame good = pose_frame(0, 0, 1, 5), out = {0}, f;
  auth_lane_init(&sender, &key, MESSAGE_POSE_LEFT, 0, 0);
  auth_lane_init(&receiver, &key, MESSAGE_POSE_LEFT, 0, 0);
  CHECK_EQ_INT(auth_open(&receiver, &good, &out), AUTH_ID);
  f = good;
  f.id = 0x109;
  CHECK_EQ_INT(auth_open(&receiver, &f, &out), AUTH_LENGTH);
  CHECK_EQ_INT(auth_seal(&sender, &f), AUTH_ID);
  f = good;
  f.length = 7;
  CHECK_EQ_INT(auth_seal(&sender, &f), AUTH_LENGTH);
  CHECK_EQ_INT(auth_seal(&sender, &good), AUTH_OK);
  for (unsigned length = 0; length <= 64; ++length) {
    f = good;
    f.length = (uint8_t)length;
    if (length != 20) CHECK_EQ_INT(auth_open(&receiver, &f, &out), AUTH_LENGTH);
  }
  f = good;
  f.extended = 1;
  CHECK_EQ_INT(auth_open(&receiver, &f, &out), AUTH_ID);
  f = good;
  f.rtr = 1;
  CHECK_EQ_INT(auth_open(&receiver, &f, &out), AUTH_FLAGS);
  f = good;
  f.error = 1;
  CHECK_EQ_INT(auth_open(&receiver, &f, &out), AUTH_FLAGS);
  f = good;
  f.fd = 0;
  CHECK_EQ_INT(auth_open(&receiver, &f, &out), AUTH_LENGTH);
  CHECK_EQ_INT(out.length, 0);
  CHECK_EQ_INT(receiver.malformed, 2 + 64 + 4);
  CHECK_EQ_INT(receiver.last, 0);
  CHECK_EQ_INT(auth_open(&receiver, &good, &good), AUTH_OK);
  check_frame(&good, 0x101, "DD01050000000000");
}

static void a_lane_of_another_message_takes_nothing(void) {
  auth_lane lane;
  frame f = {0}, out;
  auth_lane_init(&lane, &key, MESSAGE_SYNC, 0, 0);
  f.id = dictionary_id(MESSAGE_SYNC, 0);
  f.length = 8;
  CHECK_EQ_INT(auth_seal(&lane, &f), AUTH_ID);
  f.length = 20;
  f.fd = FRAME_FD;
  CHECK_EQ_INT(auth_open(&lane, &f, &out), AUTH_ID);
}

static void freshness_gaps_and_order(void) {
  auth_lane sender, receiver;
  frame sent[4], out;
  auth_lane_init(&sender, &key, MESSAGE_POSE_LEFT, 0, 0);
  auth_lane_init(&receiver, &key, MESSAGE_POSE_LEFT, 0, 0);
  for (uint32_t n = 0; n < 4; ++n) {
    sent[n] = pose_frame(0, 0, n + 1, 0);
    CHECK_EQ_INT(auth_seal(&sender, &sent[n]), AUTH_OK);
  }
  CHECK_EQ_INT(auth_open(&receiver, &sent[2], &out), AUTH_OK);
  CHECK_EQ_INT(receiver.lost, 2);
  CHECK_EQ_INT(auth_open(&receiver, &sent[2], &out), AUTH_OLD);
  CHECK_EQ_INT(auth_open(&receiver, &sent[0], &out), AUTH_OLD);
  CHECK_EQ_INT(auth_open(&receiver, &sent[1], &out), AUTH_OLD);
  CHECK_EQ_INT(auth_open(&receiver, &sent[3], &out), AUTH_OK);
  CHECK_EQ_INT(receiver.old, 3);
  CHECK_EQ_INT(receiver.accepted, 2);
}

/* The operator's COMMANDs and the runtime's own: neither takes the other's, nor its own again. */
static void two_lanes_of_commands(void) {
  auth_lane operators, own, listens;
  frame f, out;
  const codec_command command = {1, FRAY_COMMAND_STOP, 0};
  auth_lane_init(&operators, &key, MESSAGE_COMMAND, 0, AUTH_RUNTIME_FIRST - 2);
  auth_lane_init(&own, &key, MESSAGE_COMMAND, 0, AUTH_RUNTIME_FIRST);
  auth_lane_init(&listens, &key, MESSAGE_COMMAND, 0, 0);
  codec_encode_command(&f, 0, &command);
  CHECK_EQ_INT(auth_seal(&own, &f), AUTH_OK);
  CHECK_EQ_INT(f.data[8], 1);
  CHECK_EQ_INT(f.data[11], 0x80);
  CHECK_EQ_INT(auth_open(&listens, &f, &out), AUTH_OLD);
  codec_encode_command(&f, 0, &command);
  CHECK_EQ_INT(auth_seal(&operators, &f), AUTH_OK);
  CHECK_EQ_INT(auth_open(&listens, &f, &out), AUTH_OK);
  codec_encode_command(&f, 0, &command);
  CHECK_EQ_INT(auth_seal(&operators, &f), AUTH_SPENT);
}

static void freshness_never_wraps(void) {
  auth_lane sender, receiver;
  frame f = pose_frame(0, 0, 1, 0), last, out;
  auth_lane_init(&sender, &key, MESSAGE_POSE_LEFT, 0, UINT32_MAX - 1);
  auth_lane_init(&receiver, &key, MESSAGE_POSE_LEFT, 0, 0);
  last = f;
  CHECK_EQ_INT(auth_seal(&sender, &last), AUTH_OK);
  CHECK_EQ_INT(auth_open(&receiver, &last, &out), AUTH_OK);
  CHECK_EQ_INT(receiver.lost, UINT32_MAX - 1);
  CHECK_EQ_INT(auth_seal(&sender, &f), AUTH_SPENT);
  CHECK_EQ_INT(f.length, 8);
  CHECK_EQ_INT(auth_open(&receiver, &last, &out), AUTH_OLD);
  auth_lane_init(&sender, &key, MESSAGE_POSE_LEFT, 0, 0);
  CHECK_EQ_INT(auth_seal(&sender, &f), AUTH_OK);
  CHECK_EQ_INT(auth_open(&receiver, &f, &out), AUTH_OLD);
}

static void resets(void) {
  auth_lane sender, receiver;
  frame f[3], out;
  auth_lane_init(&sender, &key, MESSAGE_POSE_LEFT, 0, 0);
  auth_lane_init(&receiver, &key, MESSAGE_POSE_LEFT, 0, 0);
  for (uint32_t n = 0; n < 3; ++n) {
    f[n] = pose_frame(0, 0, n + 1, 0);
    CHECK_EQ_INT(auth_seal(&sender, &f[n]), AUTH_OK);
    CHECK_EQ_INT(auth_open(&receiver, &f[n], &out), AUTH_OK);
  }
  /* a sender that forgot is refused until it is past; one that stored goes on */
  auth_lane_init(&sender, &key, MESSAGE_POSE_LEFT, 0, 0);
  for (uint32_t n = 0; n < 4; ++n) {
    frame again = pose_frame(0, 0, n, 0);
    CHECK_EQ_INT(auth_seal(&sender, &again), AUTH_OK);
    CHECK_EQ_INT(auth_open(&receiver, &again, &out), n < 3 ? AUTH_OLD : AUTH_OK);
  }
  /* a receiver that stored refuses what was accepted; with a new key all of it; and one that forgot
   * under the old key takes it again: the reason why `last` must be stored */
  auth_lane_init(&receiver, &key, MESSAGE_POSE_LEFT, 0, receiver.last);
  CHECK_EQ_INT(auth_open(&receiver, &f[2], &out), AUTH_OLD);
  auth_lane_init(&receiver, &other_key, MESSAGE_POSE_LEFT, 0, 0);
  CHECK_EQ_INT(auth_open(&receiver, &f[2], &out), AUTH_FORGED);
  auth_lane_init(&receiver, &key, MESSAGE_POSE_LEFT, 0, 0);
  CHECK_EQ_INT(auth_open(&receiver, &f[2], &out), AUTH_OK);
}

static void random_tag(frame *f) {
  for (int n = 12; n < 20; ++n) f->data[n] = (uint8_t)random_below(256);
}

static void flip_bits(frame *f, int first_bit, int bits, uint32_t most) {
  frame before = *f;
  const uint32_t flips = 1 + random_below(most);
  do {
    *f = before;
    for (uint32_t n = 0; n < flips; ++n) {
      const int bit = first_bit + (int)random_below((uint32_t)bits);
      f->data[bit / 8] ^= (uint8_t)(1 << bit % 8);
    }
  } while (memcmp(f->data, before.data, 20) == 0);
}

enum { LANES = 4 };
static auth_lane senders[LANES], receivers[LANES];

/* The lane that the forged form of a genuine frame of lane `from` is given to. */
static uint32_t forge(frame *f, uint32_t kind, uint32_t from) {
  const uint32_t to = (from + 1 + random_below(LANES - 1)) % LANES;
  switch (kind) {
    case 0: random_tag(f); return from;
    case 1: flip_bits(f, 0, 160, 3); return from;      /* anywhere */
    case 2: flip_bits(f, 96, 64, 64); return from;     /* only in the tag */
    case 3: f->id = receivers[to].id; return to;       /* another lane's id */
    case 4: flip_bits(f, 0, 96, 8); random_tag(f); return from;
    default: { /* sealed with another key */
      auth_lane lane = senders[from];
      lane.key = &other_key;
      lane.last -= 1;
      *f = pose_frame(from / 2, from % 2, lane.last, 0);
      CHECK_EQ_INT(auth_seal(&lane, f), AUTH_OK);
      return from;
    }
  }
}

/* Six forgeries of each of 150,000 frames, and each frame again: 1,050,000 in all. Genuine frames
 * between them are all accepted. */
static void a_million_forged_and_replayed_frames(void) {
  enum { ROUNDS = 150000, KINDS = 6 };
  int refused = 0, accepted = 0, genuine = 0;
  frame out, early = {0};
  for (uint32_t n = 0; n < LANES; ++n) {
    const dictionary_message message = dictionary_pose(n % 2);
    auth_lane_init(&senders[n], &key, message, n / 2, n * 1000);
    auth_lane_init(&receivers[n], &key, message, n / 2, 0);
  }
  for (uint32_t round = 0; round < ROUNDS; ++round) {
    const uint32_t from = random_below(LANES);
    frame f = pose_frame(from / 2, from % 2, round, (int)random_below(60000) - 30000);
    CHECK_EQ_INT(auth_seal(&senders[from], &f), AUTH_OK);
    for (uint32_t kind = 0; kind < KINDS; ++kind) {
      frame forged = f;
      const uint32_t to = forge(&forged, kind, from);
      const auth_reason reason = auth_open(&receivers[to], &forged, &out);
      refused += reason == AUTH_OLD || reason == AUTH_FORGED;
      accepted += reason == AUTH_OK;
    }
    genuine += auth_open(&receivers[from], &f, &out) == AUTH_OK;
    if (round == 0) early = f;
    const frame *replayed = round % 2 == 0 || early.id != f.id ? &f : &early;
    refused += auth_open(&receivers[from], replayed, &out) == AUTH_OLD;
  }
  CHECK_EQ_INT(genuine, ROUNDS);
  CHECK_EQ_INT(accepted, 0);
  CHECK_EQ_INT(refused, ROUNDS * (KINDS + 1));
  uint32_t counted = 0;
  for (uint32_t n = 0; n < LANES; ++n) counted += receivers[n].forged + receivers[n].old;
  CHECK_EQ_INT(counted, ROUNDS * (KINDS + 1));
  printf("figure auth_fd_hostile %d forged or replayed frames, %d accepted (asked: 1000000, 0)\n",
         refused + accepted, accepted);
}

/* Classic */

static auth_group sender;
static auth_monitor watch;

static void begin(uint32_t instance, uint32_t hand, uint32_t last) {
  auth_group_init(&sender, &key, instance, hand, last);
  auth_monitor_init(&watch, &key, instance, hand, last);
}

/* Four poses and their TAG, as they are sent. */
static void make_group(uint32_t instance, uint32_t hand, uint32_t first, frame out[5]) {
  for (uint32_t n = 0; n < 4; ++n) {
    out[n] = pose_frame(instance, hand, first + n, (int)((first + n) & 0x7FFF));
    CHECK_EQ_INT(auth_group_add(&sender, &out[n], &out[4]), n == 3);
  }
}

static auth_verdict take_group(const frame *frames, int count) {
  auth_verdict last = AUTH_MONITOR_OTHER;
  for (int n = 0; n < count; ++n) last = auth_monitor_check(&watch, &frames[n]);
  return last;
}

static void tag_frames(void) {
  static const struct {
    uint32_t freshness;
    const char *data;
  } VECTORS[] = {{0x00010000, "0000CD844E81DA5D"},
                 {0x00010001, "01005B9318149A27"},
                 {0x0000FFFF, "FFFF19568CE61764"},
                 {0x00000001, "01009F0C5A934395"}};
  for (int n = 0; n < 4; ++n) {
    frame f[5];
    begin(3, 1, VECTORS[n].freshness - 1);
    make_group(3, 1, 1, f);
    check_frame(&f[3], 0x132, "4C04040000000000");
    check_frame(&f[4], 0x332, VECTORS[n].data);
    CHECK_EQ_INT(f[4].fd, 0);
    CHECK_EQ_INT(take_group(f, 5), AUTH_MONITOR_GOOD);
    CHECK_EQ_INT(watch.group.last, VECTORS[n].freshness);
    CHECK_EQ_INT(watch.poses, 4);
  }
}

static void a_long_good_run(void) {
  begin(0, 0, 0xFFF0); /* past the 16 bits that are sent */
  for (uint32_t n = 0; n < 100000; ++n) {
    frame f[5];
    make_group(0, 0, 4 * n + 1, f);
    CHECK_EQ_INT(take_group(f, 4), AUTH_MONITOR_POSE);
    CHECK_EQ_INT(auth_monitor_check(&watch, &f[4]), AUTH_MONITOR_GOOD);
  }
  CHECK_EQ_INT(watch.group.last, 0xFFF0 + 100000);
  CHECK_EQ_INT(watch.bad + watch.missing, 0);
}

static void frames_of_others_do_not_count(void) {
  frame f[5], g = {0};
  begin(0, 0, 0);
  make_group(0, 0, 1, f);
  CHECK_EQ_INT(take_group(f, 2), AUTH_MONITOR_POSE);
  g = pose_frame(0, 1, 1, 0);
  CHECK_EQ_INT(auth_monitor_check(&watch, &g), AUTH_MONITOR_OTHER);
  g = pose_frame(1, 0, 1, 0);
  CHECK_EQ_INT(auth_monitor_check(&watch, &g), AUTH_MONITOR_OTHER);
  g = f[2];
  g.rtr = 1;
  CHECK_EQ_INT(auth_monitor_check(&watch, &g), AUTH_MONITOR_OTHER);
  g = f[4];
  g.extended = 1;
  CHECK_EQ_INT(auth_monitor_check(&watch, &g), AUTH_MONITOR_OTHER);
  CHECK_EQ_INT(take_group(f + 2, 3), AUTH_MONITOR_GOOD);
}

static void three_bad_tags_fail_the_lane(void) {
  frame f[5];
  begin(0, 0, 0);
  for (uint32_t n = 0; n < 3; ++n) {
    make_group(0, 0, 4 * n + 1, f);
    f[4].data[2] ^= 1;
    CHECK_EQ_INT(take_group(f, 4), AUTH_MONITOR_POSE);
    CHECK_EQ_INT(auth_monitor_check(&watch, &f[4]), n < 2 ? AUTH_MONITOR_BAD : AUTH_MONITOR_FAILED);
  }
  make_group(0, 0, 13, f);
  CHECK_EQ_INT(take_group(f, 1), AUTH_MONITOR_FAILED);
  CHECK_EQ_INT(take_group(f, 5), AUTH_MONITOR_FAILED);
  CHECK_EQ_INT(watch.poses, 12);
  auth_monitor_clear(&watch);
  make_group(0, 0, 17, f);
  CHECK_EQ_INT(take_group(f, 5), AUTH_MONITOR_GOOD);
}

static void three_missing_tags_fail_the_lane(void) {
  begin(0, 0, 0);
  for (uint32_t n = 1; n <= 13; ++n) {
    const frame f = pose_frame(0, 0, n, 0);
    CHECK_EQ_INT(auth_monitor_check(&watch, &f), n < 13 ? AUTH_MONITOR_POSE : AUTH_MONITOR_FAILED);
  }
  CHECK_EQ_INT(watch.missing, 3);
  CHECK_EQ_INT(watch.poses, 12);
}

static void a_lost_frame_does_not_fail_the_lane(void) {
  begin(0, 0, 0);
  for (uint32_t lost = 0; lost < 5; ++lost) {
    for (uint32_t n = 0; n < 100; ++n) {
      frame f[5];
      make_group(0, 0, 4 * n + 1, f);
      for (uint32_t at = 0; at < 5; ++at) {
        if (n != 50 || at != lost) auth_monitor_check(&watch, &f[at]);
      }
    }
    CHECK_EQ_INT(watch.failed, 0);
    CHECK_EQ_INT(watch.level, 0);
  }
  CHECK_EQ_INT(watch.bad, 4);
  CHECK_EQ_INT(watch.missing, 1);
  CHECK_EQ_INT(watch.good, 495);
}

/* Without the level, a forger who lets every third group pass would never be noticed. */
static void failures_between_good_tags_add_up(void) {
  for (uint32_t period = 2; period < 40; ++period) {
    uint32_t used = 0;
    begin(0, 0, 0);
    for (uint32_t n = 0; n < 2000 && !watch.failed; ++n) {
      frame f[5];
      make_group(0, 0, 4 * n + 1, f);
      if (n % period == 0) {
        f[1] = pose_frame(0, 0, n, 9999); /* instead of the genuine one */
        used += 1;
      }
      take_group(f, 5);
    }
    CHECK_EQ_INT(watch.failed, period < 17);
    if (period == 16) CHECK_EQ_INT(used, 33);
  }
}

static void freshness_of_tags(void) {
  frame f[5];
  /* 65536 ahead is the most that 16 bits can tell */
  for (uint32_t ahead = 65535; ahead <= 65537; ++ahead) {
    begin(0, 0, 0x12345);
    sender.last = 0x12345 + ahead - 1;
    make_group(0, 0, 1, f);
    CHECK_EQ_INT(take_group(f, 5), ahead <= 65536 ? AUTH_MONITOR_GOOD : AUTH_MONITOR_BAD);
  }
  /* replayed at once, and after the 16 bits have come round */
  begin(0, 0, 0);
  make_group(0, 0, 1, f);
  CHECK_EQ_INT(take_group(f, 5), AUTH_MONITOR_GOOD);
  CHECK_EQ_INT(take_group(f, 5), AUTH_MONITOR_BAD);
  watch.group.last = 0x10000;
  CHECK_EQ_INT(take_group(f, 5), AUTH_MONITOR_BAD);
  /* a sender that forgot fails */
  begin(0, 0, 0);
  watch.group.last = 500;
  for (uint32_t n = 0; n < 3; ++n) {
    make_group(0, 0, 1, f);
    take_group(f, 5);
  }
  CHECK_EQ_INT(watch.failed, 1);
}

static void a_spent_lane_fails(void) {
  frame f[5];
  begin(0, 0, UINT32_MAX - 1);
  make_group(0, 0, 1, f);
  CHECK_EQ_INT(take_group(f, 5), AUTH_MONITOR_GOOD);
  CHECK_EQ_INT(watch.group.last, UINT32_MAX);
  CHECK_EQ_INT(take_group(f, 5), AUTH_MONITOR_BAD);
  for (uint32_t n = 0; n < 4; ++n) {
    f[n] = pose_frame(0, 0, n, 0);
    CHECK_EQ_INT(auth_group_add(&sender, &f[n], &f[4]), 0);
  }
  CHECK_EQ_INT(sender.last, UINT32_MAX);
}

/* A hand at rest sends the same four poses again and again: a TAG counts for those that came. */
static void a_tag_without_its_poses(void) {
  frame f[5];
  begin(0, 0, 0);
  make_group(0, 0, 1, f);
  CHECK_EQ_INT(take_group(f, 5), AUTH_MONITOR_GOOD);
  make_group(0, 0, 1, f);
  CHECK_EQ_INT(take_group(f + 4, 1), AUTH_MONITOR_BAD);
  make_group(0, 0, 1, f);
  CHECK_EQ_INT(take_group(f, 3), AUTH_MONITOR_POSE);
  CHECK_EQ_INT(take_group(f + 4, 1), AUTH_MONITOR_BAD);
}

/* What a forger does to a group; all of them must give a bad TAG. */
static void spoil(uint32_t kind, frame f[5], const frame before[5]) {
  switch (kind) {
    case 0: for (int n = 2; n < 8; ++n) f[4].data[n] = (uint8_t)random_below(256); break;
    case 1: flip_bits(&f[4], 0, 64, 4); break;
    case 2: flip_bits(&f[random_below(4)], 0, 64, 4); break;
    case 3: f[4] = before[4]; break;                        /* an old TAG */
    case 4: memcpy(f, before, 5 * sizeof *f); break;        /* an old group */
    case 5: f[random_below(4)] = before[random_below(4)]; break; /* an old pose */
    case 6: { const frame swap = f[0]; f[0] = f[3]; f[3] = swap; break; }
    default: f[4].data[random_below(2)] ^= (uint8_t)(1u << random_below(8)); break;
  }
}

static void a_million_frames_of_forged_groups(void) {
  enum { GROUPS = 200001 };
  frame before[5] = {0};
  int accepted = 0, genuine = 0;
  begin(0, 0, 0);
  make_group(0, 0, 1, before);
  CHECK_EQ_INT(take_group(before, 5), AUTH_MONITOR_GOOD);
  for (uint32_t n = 1; n < GROUPS; ++n) {
    frame f[5], forged[5];
    make_group(0, 0, 4 * n + 1, f);
    memcpy(forged, f, sizeof forged);
    spoil(n % 8, forged, before);
    accepted += take_group(forged, 5) == AUTH_MONITOR_GOOD;
    auth_monitor_clear(&watch);
    genuine += take_group(f, 5) == AUTH_MONITOR_GOOD;
    memcpy(before, f, sizeof before);
  }
  CHECK_EQ_INT(accepted, 0);
  CHECK_EQ_INT(genuine, GROUPS - 1);
  CHECK_EQ_INT(watch.bad, GROUPS - 1);
  printf("figure auth_classic_hostile %d frames of forged or replayed groups, %d groups accepted "
         "(asked: 0)\n",
         5 * (GROUPS - 1), accepted);
}

/* TAGs of the other hand, of another instance, and of another key. */
static void tags_of_other_lanes(void) {
  static const uint32_t OTHERS[3][2] = {{0, 1}, {1, 0}, {0, 0}};
  for (int n = 0; n < 3; ++n) {
    frame f[5];
    auth_monitor_init(&watch, &key, 0, 0, 0);
    auth_group_init(&sender, n == 2 ? &other_key : &key, OTHERS[n][0], OTHERS[n][1], 0);
    make_group(OTHERS[n][0], OTHERS[n][1], 1, f);
    for (int at = 0; at < 4; ++at) f[at].id = watch.group.pose_id;
    f[4].id = watch.group.tag_id;
    CHECK_EQ_INT(take_group(f, 5), AUTH_MONITOR_BAD);
  }
}

int main(void) {
  static const uint8_t OTHER[16] = {1};
  cmac_key_init(&key, RFC4493_KEY);
  cmac_key_init(&other_key, OTHER);
  TEST(sealed_frames);
  TEST(every_protected_message_goes_through);
  TEST(plain_and_malformed_frames_are_refused);
  TEST(a_lane_of_another_message_takes_nothing);
  TEST(freshness_gaps_and_order);
  TEST(two_lanes_of_commands);
  TEST(freshness_never_wraps);
  TEST(resets);
  TEST(a_million_forged_and_replayed_frames);
  TEST(tag_frames);
  TEST(a_long_good_run);
  TEST(frames_of_others_do_not_count);
  TEST(three_bad_tags_fail_the_lane);
  TEST(three_missing_tags_fail_the_lane);
  TEST(a_lost_frame_does_not_fail_the_lane);
  TEST(failures_between_good_tags_add_up);
  TEST(freshness_of_tags);
  TEST(a_spent_lane_fails);
  TEST(a_tag_without_its_poses);
  TEST(a_million_frames_of_forged_groups);
  TEST(tags_of_other_lanes);
  return test_end();
}
