/* SPDX-License-Identifier: Apache-2.0 */
/* A session of 200 frames with one fault at every position: what the port counts, and what it gives to
 * the ticks. Poses of both hands, and commands.
 *
 * Of a swapped pair of poses, and of one that comes 2 to 8 frames late, the late one counts as lost
 * and then as old; a tick never gets it. Commands are taken in whatever order they come: operators
 * come and go, each is answered. There the way back looks like a round of 16 that was lost. */
#include "rt/wire/codec.h"
#include "rt/wire/dictionary.h"
#include "rt/wire/port.h"
#include "tests/lib/test.h"

enum { FRAMES = 200, LANES = 3, COMMANDS = 2, ROUND = 16 };

static port p;
static uint32_t old; /* of the session that ends with counted() */
static uint32_t ticks_given, lane;
static long sessions;

static void encode(frame *f, uint32_t number) {
  const uint8_t counter = (uint8_t)((number + 1) & 15u);
  if (lane == COMMANDS) {
    const codec_command command = {counter, FRAY_COMMAND_START, 0};
    codec_encode_command(f, 0, &command);
  } else {
    const fray_pose pose = {(int16_t)number, 0, 0, counter, 0};
    codec_encode_pose(f, 0, lane, &pose);
  }
}

static void say(uint32_t number) {
  frame f;
  encode(&f, number);
  port_push(&p, &f);
}

/* Returns the number of the frame that the tick got, or -1: none. */
static int tick(void) {
  fray_input input;
  port_take(&p, &input);
  const int got = lane == COMMANDS ? input.command != 0 : input.has_pose != 0;
  ticks_given += (uint32_t)got;
  if (!got) return -1;
  return lane == COMMANDS ? input.command_counter : input.pose[lane].x;
}

static void begin(void) {
  port_init(&p, 0, 3, NULL);
  ticks_given = 0;
  old = 0;
  ++sessions;
}

static void counted(uint32_t accepted, uint32_t lost, uint32_t repeated, uint32_t wrong_crc,
                    uint32_t given) {
  const port_statistics *s = &p.statistics;
  CHECK_EQ_INT(s->accepted, accepted);
  CHECK_EQ_INT(s->lost, lost);
  CHECK_EQ_INT(s->repeated, repeated);
  CHECK_EQ_INT(s->old, old);
  CHECK_EQ_INT(s->wrong_crc, wrong_crc);
  CHECK_EQ_INT(s->wrong_length + s->wrong_flags + s->wrong_field + s->unknown_id + s->queue_full, 0);
  CHECK_EQ_INT(ticks_given, given);
}

static void no_fault(void) {
  for (lane = 0; lane < LANES; ++lane) {
    begin();
    for (uint32_t n = 0; n < FRAMES; ++n) {
      say(n);
      CHECK_EQ_INT(tick(), lane == COMMANDS ? (int)((n + 1) & 15u) : (int)n);
    }
    counted(FRAMES, 0, 0, 0, FRAMES);
  }
}

static void lost(void) {
  for (lane = 0; lane < LANES; ++lane)
    for (uint32_t at = 0; at < FRAMES; ++at) {
      begin();
      for (uint32_t n = 0; n < FRAMES; ++n) {
        if (n != at) say(n);
        CHECK_EQ_INT(tick() < 0, n == at);
      }
      counted(FRAMES - 1, at < FRAMES - 1, 0, 0, FRAMES - 1); /* nobody saw a last one missing */
    }
}

/* Poses: 2..7 in a row are counted. After 8..15 those that follow look old, at most two of them, or
 * repeat the last one; then the next is taken. Commands: 15 look like a repetition, fewer are counted.
 * 16 look like none, 17 like one. */
static void lost_in_a_row(void) {
  for (lane = 0; lane < LANES; ++lane)
    for (uint32_t length = 2; length <= 17; ++length)
      for (uint32_t at = 0; at + length + 3 < FRAMES; ++at) {
        begin();
        for (uint32_t n = 0; n < FRAMES; ++n) {
          if (n < at || n >= at + length) say(n);
          (void)tick();
        }
        const int unclear = length <= 15 && length >= (lane == COMMANDS ? 15 : 8);
        const uint32_t again = unclear && length >= 13;
        old = !unclear ? 0 : length < 14 ? 2 : 15 - length;
        const uint32_t seen = unclear ? 0 : length < 16 ? length : length - 16;
        const uint32_t accepted = FRAMES - length - again - old;
        counted(accepted, seen, again, 0, accepted);
      }
}

/* In the same tick, in the next, and up to 14 frames later. */
static void repeated(void) {
  for (lane = 0; lane < LANES; ++lane)
    for (uint32_t at = 0; at < FRAMES; ++at)
      for (int same_tick = 0; same_tick < 2; ++same_tick) {
        begin();
        for (uint32_t n = 0; n < FRAMES; ++n) {
          if (!same_tick && n > 0 && n - 1 == at) say(at);
          say(n);
          if (same_tick && n == at) say(n);
          CHECK(tick() >= 0);
          if (lane == COMMANDS && n == FRAMES - 1) (void)tick(); /* what waits for its own tick */
        }
        if (!same_tick && at == FRAMES - 1) say(at);
        (void)tick();
        counted(FRAMES, 0, 1, 0, FRAMES);
      }
}

static void swapped(void) {
  for (lane = 0; lane < LANES; ++lane)
    for (uint32_t at = 0; at + 1 < FRAMES; ++at) {
      begin();
      for (uint32_t n = 0; n < FRAMES; ++n) {
        say(n == at ? at + 1 : n == at + 1 ? at : n);
        const int got = tick();
        if (lane != COMMANDS) CHECK_EQ_INT(got, n == at ? (int)at + 1 : n == at + 1 ? -1 : (int)n);
      }
      old = lane != COMMANDS;
      if (lane != COMMANDS) counted(FRAMES - 1, 1, 0, 0, FRAMES - 1);
      else counted(FRAMES, at + 2 < FRAMES ? ROUND : ROUND - 1, 0, 0, FRAMES);
    }
}

/* Held back by `late` frames, behind those; every frame in a tick of its own. A pose that comes more
 * than 8 late could as well be one of the next round: 7 lost, and those after it look old. */
static void delayed(void) {
  for (lane = 0; lane < LANES; ++lane)
    for (uint32_t late = 2; late < (lane == COMMANDS ? 15 : 8); ++late)
      for (uint32_t at = 0; at + late < FRAMES; ++at) {
        begin();
        for (uint32_t n = 0; n < FRAMES; ++n) {
          if (n != at) say(n);
          const int got = tick();
          if (lane != COMMANDS) CHECK_EQ_INT(got, n == at ? -1 : (int)n);
          if (n == at + late) {
            say(at);
            CHECK_EQ_INT(tick() < 0, lane != COMMANDS);
          }
        }
        const int ended = at + late == FRAMES - 1;
        old = lane != COMMANDS;
        if (lane != COMMANDS) counted(FRAMES - 1, 1, 0, 0, FRAMES - 1);
        else counted(FRAMES, ended ? ROUND - late : ROUND, 0, 0, FRAMES);
      }
}

/* A hand that ends and is started again says 1, 2, 3 ...: the third is taken at the latest, or the
 * fourth where the third repeats the last of before. */
static void begun_anew(void) {
  for (lane = 0; lane < COMMANDS; ++lane)
    for (uint32_t at = 1; at < FRAMES - 4; ++at) {
      begin();
      uint32_t dropped = 0;
      for (uint32_t n = 0; n < FRAMES; ++n) {
        say(n < at ? n : n - at);
        if (tick() < 0) ++dropped;
      }
      const uint32_t ahead = (1 + 16 - (at & 15u)) & 15u; /* of its first counter */
      CHECK_EQ_INT(dropped, ahead == 0 ? 1 : ahead <= 8 ? 0 : ahead == 14 ? 3 : 2);
    }
}

/* By a tick, together with the next: one tick without, the next has the newest. Nothing is lost. */
static void delayed_by_a_tick(void) {
  for (lane = 0; lane < COMMANDS; ++lane)
    for (uint32_t at = 0; at + 1 < FRAMES; ++at) {
      begin();
      for (uint32_t n = 0; n < FRAMES; ++n) {
        if (n == at + 1) say(at);
        if (n != at) say(n);
        CHECK_EQ_INT(tick(), n == at ? -1 : (int)n);
      }
      counted(FRAMES, 0, 0, 0, FRAMES - 1);
    }
}

static void damaged(void) {
  for (lane = 0; lane < LANES; ++lane)
    for (uint32_t at = 0; at < FRAMES; ++at) {
      begin();
      for (uint32_t n = 0; n < FRAMES; ++n) {
        frame f;
        encode(&f, n);
        if (n == at) f.data[at % 8] ^= (uint8_t)(1u << (at / 8 % 8));
        port_push(&p, &f);
        CHECK_EQ_INT(tick() < 0, n == at);
      }
      counted(FRAMES - 1, at < FRAMES - 1, 0, 1, FRAMES - 1);
    }
}

int main(void) {
  TEST(no_fault);
  TEST(lost);
  TEST(lost_in_a_row);
  TEST(repeated);
  TEST(swapped);
  TEST(delayed);
  TEST(begun_anew);
  TEST(delayed_by_a_tick);
  TEST(damaged);
  printf("figure e2e_sessions %ld sessions of %d frames, one fault each (asked: every position)\n",
         sessions, FRAMES);
  printf("figure e2e_restart_poses_dropped %d at most (a hand that counts from 1 again)\n",
         SEQUENCE_RESTART);
  return test_end();
}
