/* SPDX-License-Identifier: Apache-2.0 */
/* A hand that falls silent at 10,000 moments, in virtual time: a device that runs free at a phase of
 * its own against the grid of the ticks, and a cut at any microsecond. */
#include "tests/lib/test.h"
#include "tests/sim/sim_session.h"

enum {
  MOMENTS = 10000,
  CUT_TICKS_MAX = 24,
  STALE_TICKS = 3,
  FADE_TICKS = 10,
  AFTER_TICKS = 12 /* watched when the force has faded */
};

static session s;
static void *memory;

/* The session's world anew from the one save. */
static void reopen(void) {
  fray_error error;
  if (fray_open(s.f.image, s.f.image_bytes, memory, s.f.memory_bytes, &s.f.w, &error) != FRAY_OK)
    fixture_give_up("fray_open", error.what);
  session_begin(&s);
}

typedef struct {
  uint32_t stale_ticks;  /* from the first tick without a pose to SAFE, both counted */
  int64_t zero_us;       /* from the SYNC of the SAFE tick to the first zero FORCE */
  int64_t cut_to_zero_us;
  int loaded;            /* there was a force when the poses ended */
  int bad;
} verdict;

static int64_t first_zero_force_us(size_t from) {
  for (size_t n = from; n < sim.count; ++n) {
    codec_force force;
    const frame *f = &sim.entries[n].f;
    if (codec_decode_force(f, 0, 0, &force) != CODEC_OK) continue;
    if (force.x != 0 || force.y != 0 || force.z != 0) continue;
    if (n + 1 < sim.count && codec_decode_force(&sim.entries[n + 1].f, 0, 1, &force) == CODEC_OK &&
        (force.x | force.y | force.z) == 0)
      return sim.entries[n].time_us;
  }
  return -1;
}

/* One moment. `who`: bit h is set iff hand h falls silent. */
static verdict fall_silent(int64_t phase_us, int64_t cut_us, uint32_t who) {
  verdict v = {0, 0, 0, 0, 0};
  const int64_t begin_us = sim.now_us;
  size_t safe_at = 0;
  uint32_t missing = 0;
  uint32_t safe_tick = 0;
  for (uint32_t tick = 0; safe_tick == 0 || tick < safe_tick + FADE_TICKS + AFTER_TICKS; ++tick) {
    const int64_t pose_us = sim.grid_us + phase_us;
    const int mute = pose_us - begin_us >= cut_us;
    if (sim.now_us < pose_us) sim.now_us = pose_us;
    s.silent = mute ? (uint8_t)who : 0;
    if (safe_tick != 0 && tick >= safe_tick + 4) s.silent = 0; /* poses that come back change nothing */
    if (mute && missing == 0) v.loaded = !session_force_is_zero(&s.l.output);
    s.apart = (int16_t)(s.apart + (tick % 2 == 0 ? 1 : 0));
    session_poses(&s);
    const size_t from = sim.count;
    if (loop_run(&s.l) != LOOP_TICKED) v.bad = 1;
    const fray_output *o = &s.l.output;
    if (safe_tick == 0 && mute) ++missing;
    if (safe_tick == 0 && o->state == FRAY_SAFE) {
      safe_tick = tick;
      safe_at = from;
      v.stale_ticks = missing;
      v.bad |= o->faults != who;
    }
    if (!mute) v.bad |= o->state != FRAY_OPERATIONAL;
    if (safe_tick != 0) v.bad |= o->state != FRAY_SAFE;
    if (safe_tick != 0 && tick >= safe_tick + FADE_TICKS - 1) v.bad |= !session_force_is_zero(o);
    if (tick > 200) break;
  }
  const int64_t zero = first_zero_force_us(safe_at);
  v.bad |= safe_tick == 0 || zero < 0;
  v.zero_us = zero - sim.entries[safe_at].time_us;
  v.cut_to_zero_us = zero - begin_us - cut_us;
  return v;
}

static void hands_that_fall_silent(void) {
  uint64_t seed = 2;
  uint32_t bad = 0;
  uint32_t loaded = 0;
  verdict worst = {0, 0, 0, 0, 0};
  session_scene(&s.f, 8, 4, "0.25");
  session_begin(&s);
  session_start(&s, 160, 60);
  CHECK_EQ_INT(s.l.output.state, FRAY_OPERATIONAL);
  CHECK(!session_force_is_zero(&s.l.output));
  const int16_t apart = s.apart;
  fixture saved;
  fixture_copy(&saved, &s.f);
  fixture_close(&s.f);
  s.f = saved;
  memory = s.f.memory;
  for (uint32_t n = 0; n < MOMENTS; ++n) {
    reopen();
    s.apart = apart;
    const int64_t phase_us = (int64_t)(splitmix64(&seed) % 1000u);
    const int64_t cut_us = (int64_t)(splitmix64(&seed) % (CUT_TICKS_MAX * 1000u));
    const verdict v = fall_silent(phase_us, cut_us, 1u + (uint32_t)(splitmix64(&seed) % 3u));
    bad += v.bad != 0;
    loaded += v.loaded != 0;
    if (v.stale_ticks > worst.stale_ticks) worst.stale_ticks = v.stale_ticks;
    if (v.zero_us > worst.zero_us) worst.zero_us = v.zero_us;
    if (v.cut_to_zero_us > worst.cut_to_zero_us) worst.cut_to_zero_us = v.cut_to_zero_us;
  }
  CHECK_EQ_INT(bad, 0);
  CHECK(worst.stale_ticks <= STALE_TICKS);
  CHECK(worst.zero_us <= 10000);
  CHECK(worst.cut_to_zero_us <= 1000 + 13000); /* the cut falls up to a tick before the first gap */
  CHECK(loaded > MOMENTS * 9 / 10);
  figure("stale_moments", MOMENTS, "", "10000");
  figure("stale_moments_under_force", loaded, "", "most");
  figure("stale_detected_ticks_worst", worst.stale_ticks, "ticks", "3");
  figure("stale_force_zero_worst", (double)worst.zero_us / 1e3, "ms", "10");
  figure("stale_cut_to_zero_worst", (double)worst.cut_to_zero_us / 1e3, "ms", "3 ticks + 10 ms");
  fixture_close(&s.f);
  sim_end();
}

int main(void) {
  TEST(hands_that_fall_silent);
  return test_end();
}
