/* SPDX-License-Identifier: Apache-2.0 */
/* Worlds that run for ever: around 2^26, 2^31 and 2^32 ticks they do what they do around tick 1,000, to the last
 * bit of all but the tick; images and recordings go across. */
#define _GNU_SOURCE
#include "platform/log/candump.h"
#include "tests/lib/set_tick.h"
#include "tests/lib/world_fixture.h"
#include "tools/recording/record.h"
#include "tools/recording/replay.h"

enum { BEFORE = 1000, AROUND = 2000, SHIFTED = 1000, PREPARED = 60, SILENT_FROM = 998, SILENT_TO = 1010 };

static const uint64_t wraps[] = {UINT64_C(1) << 26, UINT64_C(1) << 31, UINT64_C(1) << 32};
enum { WRAPS = sizeof wraps / sizeof wraps[0] };

/* Hands pull until the left one falls silent just before the wrap; RESET, START, and they pull until it tears. */
static fray_input hands_input(const fixture *f, uint32_t n) {
  const int32_t since = (int32_t)(n < 1100 ? n : n - 1100);
  const int32_t out = since < 30 ? 0 : fx_min((since - 30) * 2, n < 1100 ? 200 : 2000);
  const int32_t at[FRAY_HANDS][3] = {{-out, 0, out / 4}, {out, out / 3, 0}};
  fray_input input = fixture_poses(f, at, n + 1u);
  input.command = since == 0 ? FRAY_COMMAND_START : n == 1050 ? FRAY_COMMAND_RESET : FRAY_COMMAND_NONE;
  if (n >= SILENT_FROM && n < SILENT_TO) input.has_pose = 2;
  return input;
}

#define MEMBRANE(cells, substeps, drag) \
  "scene m\nrate 1000 Hz\nsubsteps " substeps "\nwind 3 0 4 m/s\n" \
  "membrane {\n " cells "\n cell 1 cm\n pattern irregular 3\n material rag\n strain_limit 30 %\n" \
  " drag " drag " /s\n thickness 0.05 cm\n}\n" \
  "material rag { base denim stretch all 150 20 250 60 N/m tear 6 9 12 9 N/m }\npin column left\n" \
  "capsule right {\n radius 0.1 cm\n length 8 cm\n rotate 90 deg about z\n at 3 0 0 cm\n move path { 0 s 3 0 0 cm 0.05 s 3.3 0.1 0 cm }\n" \
  " attach_within 0.02 cm\n}\n"

static void open_hands(fixture *f) {
  fixture_text(f, "scene h\nrate 1000 Hz\nsubsteps 8\ngravity 0 -981 0 cm/s2\nseed 1\n"
                  "woven {\n warps 9\n wefts 8\n spacing 12 /cm\n density 0.1 g/cm2\n tear 6 9 %\n}\n"
                  "sphere left { radius 0.1 cm at -0.3333 0.2917 0 cm move hand left attach_within 0.02 cm }\n"
                  "sphere right { radius 0.1 cm at 0.3333 0.2917 0 cm move hand right attach_within 0.02 cm }\n"
                  "capsule rail { length 1 cm radius 0.1 cm"
                  " move path { 0 s 0 -0.5 0.3 cm 0.05 s 0 -0.2 0.1 cm } }\n");
}
static void open_yarns(fixture *f) {
  fixture_text(f, "scene y\nrate 1000 Hz\nsubsteps 4\nsettle 0.05 s\nwoven {\n warps 9\n wefts 8\n spacing 12 /cm\n"
                  " yarns on\n tear 4 8 %\n}\npin row bottom\ncapsule top {\n radius 0.05 cm\n length 1 cm\n"
                  " at 0 0.2917 0 cm\n attach_within 0.02 cm\n"
                  " move path { 0 s 0 0.2917 0 cm 0.05 s 0 0.31 0 cm }\n}\n");
}
/* Without drag: nothing depends on the tick once the path has ended. */
static void open_membrane(fixture *f) { fixture_text(f, MEMBRANE("columns 6 rows 5", "4", "0")); }
/* Drag is dithered by the number of the elastic step, modulo 2^32. */
static void open_dragged(fixture *f) { fixture_text(f, MEMBRANE("columns 6 rows 3", "128", "1")); }

/* What a run did, so that no case is idle. */
typedef struct {
  uint32_t with_force, safe, tears_before, tears;
} run_facts;

typedef struct {
  uint64_t hash[AROUND];   /* of the state without its tick */
  fray_output last;
  int16_t force[AROUND][FRAY_HANDS][3];
  run_facts facts;
} trace;

static void run_around(const fixture *prepared, int has_hands, uint64_t start, trace *t) {
  fixture_scoped f = {0};
  fixture_copy(&f, prepared);
  set_tick(f.w, start);
  memset(t, 0, sizeof *t);
  for (uint32_t n = 0; n < AROUND; ++n) {
    const fray_input input = has_hands ? hands_input(&f, n) : fixture_idle;
    t->last = fixture_tick(&f, &input);
    CHECK(t->last.tick == start + n && fray_get_info(f.w).tick == start + n + 1u);
    t->hash[n] = hash_without_tick(f.w);
    memcpy(t->force[n], t->last.force, sizeof t->last.force);
    t->facts.with_force += t->last.force[0][0] != 0 && t->last.force[1][0] != 0;
    if (n < BEFORE) t->facts.tears_before = t->last.tears_total;
    t->facts.safe += t->last.state == FRAY_SAFE;
  }
  t->facts.tears = t->last.tears_total;
}

static void compare_around(const char *name, void (*open)(fixture *), int has_hands) {
  static trace reference, here;
  fixture_scoped f = {0};
  uint32_t differ = 0;
  open(&f);
  for (uint32_t n = 0; n < PREPARED; ++n) (void)fixture_tick(&f, &fixture_idle);
  /* the period of the dither in ticks; every wrap is a multiple of it */
  const uint32_t steps = f.facts.substeps * (f.facts.elastic_steps != 0 ? f.facts.elastic_steps : 1u);
  const int dithered = f.facts.elastic_steps != 0 && f.w->params->drag != 0;
  const uint64_t period = (UINT64_C(1) << 32) / steps;
  CHECK(!dithered || ((steps & (steps - 1u)) == 0 && steps >= 128));
  run_around(&f, has_hands, dithered ? period - BEFORE : SHIFTED, &reference);
  for (uint32_t k = 0; k < WRAPS; ++k) {
    run_around(&f, has_hands, wraps[k] - BEFORE, &here);
    for (uint32_t n = 0; n < AROUND; ++n)
      differ += here.hash[n] != reference.hash[n] ||
                memcmp(here.force[n], reference.force[n], sizeof here.force[n]) != 0;
    CHECK(memcmp(&here.facts, &reference.facts, sizeof here.facts) == 0);
  }
  printf("figure long_run_%s %u of %d ticks differ from those around tick %llu (asked: 0); %u with force, %u in SAFE, "
         "%u and %u tears, %u steps a tick\n",
         name, differ, WRAPS * AROUND, (unsigned long long)(dithered ? period : SHIFTED + BEFORE),
         reference.facts.with_force, reference.facts.safe, reference.facts.tears_before,
         reference.facts.tears - reference.facts.tears_before, steps);
  CHECK_EQ_INT(differ, 0);
  CHECK(!has_hands || (reference.facts.with_force > 500 && reference.facts.safe > 20 && reference.facts.tears > 0));
}

static void hands(void) { compare_around("hands", open_hands, 1); }
static void yarns(void) { compare_around("yarns", open_yarns, 0); }
static void membrane(void) { compare_around("membrane", open_membrane, 0); }
static void dragged_membrane(void) { compare_around("dragged_membrane", open_dragged, 0); }

/* A sheet at rest for weeks stays whole, its body where the path ended. */
static void ended_paths_stay(void) {
  for (uint32_t k = 0; k < 2 * WRAPS; ++k) {
    fixture_scoped f = {0};
    if (k < WRAPS)
      fixture_text(&f, "scene w\nrate 1000 Hz\nsubsteps 4\nwoven { warps 10 wefts 10 spacing 12 /cm tear 5 10 % }\n"
                       "pin row bottom\ncapsule top { radius 0.05 cm length 1 cm attach_within 0.02 cm\n"
                       " move path { 0 s 0 0.375 0 cm 0.03 s 0 0.378 0 cm 0.05 s 0 0.3 0 cm } }\n");
    else
      open_membrane(&f);
    for (uint32_t n = 0; n < PREPARED; ++n) (void)fixture_tick(&f, &fixture_idle);
    const uint64_t wrap = wraps[k % WRAPS];
    const fray_body before = fray_view_body(f.w, 0);
    const int32_t tears = f.w->state->tears_total;
    set_tick(f.w, wrap - 10);
    for (uint32_t n = 0; n < 40; ++n) {
      const fray_output out = fixture_tick(&f, &fixture_idle);
      const fray_body body = fray_view_body(f.w, 0);
      CHECK(memcmp(body.position, before.position, sizeof body.position) == 0);
      CHECK_EQ_INT(out.tears_total, tears);
    }
  }
}

/* A path of 2^31 - 1 ticks: under way at 2^26, at its end before 2^31, there at 2^32. */
static void the_longest_path(void) {
  fixture_scoped f = {0};
  fixture_text(&f, "scene p\nrate 1000 Hz\nwoven { warps 4 wefts 4 spacing 12 /cm tear off }\npin row top\n"
                   "sphere s { radius 0.1 cm move path { 0 s 3 0 0 cm 1 s -3 1 2 cm } }\n");
  keyframe *keys = (keyframe *)(uintptr_t)f.w->rigid.keyframes; /* in f.image */
  keys[1].tick = INT32_MAX;
  for (uint32_t k = 0; k < WRAPS; ++k) {
    set_tick(f.w, wraps[k] - 10);
    for (uint32_t n = 0; n < 20; ++n) {
      const uint64_t now = fixture_tick(&f, &fixture_idle).tick + 1u;
      const double share = now < INT32_MAX ? (double)now / INT32_MAX : 1;
      for (uint32_t axis = 0; axis < 3; ++axis) {
        const double from = keys[0].position[axis], to = keys[1].position[axis];
        CHECK(fabs(f.w->rigid.states[0].position[axis] - (from + (to - from) * share)) <= 1);
      }
    }
  }
}

/* Saved a tick before, at and a tick after the wrap, and after each tick then: the same hashes and ticks. */
static void images_across(void) {
  for (uint32_t k = 0; k < 3 * WRAPS; ++k) {
    fixture_scoped f = {0};
    (k % 3 == 0 ? open_hands : k % 3 == 1 ? open_yarns : open_dragged)(&f);
    for (uint32_t n = 0; n < PREPARED; ++n) (void)fixture_tick(&f, &fixture_idle);
    const uint64_t start = wraps[k / 3] - 10;
    set_tick(f.w, start);
    fixture again;
    fixture_copy(&again, &f);
    for (uint32_t n = 0; n < 40; ++n) {
      const fray_input input = k % 3 == 0 ? hands_input(&f, n) : fixture_idle;
      const fray_output expected = fixture_tick(&f, &input), found = fixture_tick(&again, &input);
      CHECK(found.hash == expected.hash && found.tick == start + n);
      if (n < 8 || n > 11) continue;
      fixture copy;
      fixture_copy(&copy, &again);
      fixture_close(&again);
      again = copy;
      CHECK(again.facts.tick == start + n + 1u);
    }
    fixture_close(&again);
  }
}

typedef struct {
  uint64_t hash[40];
  fray_input input[40];
  char *text;
  size_t bytes;
} recorded;

static void record_run(const fixture *prepared, uint64_t start, recorded *r) {
  fixture_scoped f = {0};
  record to;
  fixture_copy(&f, prepared);
  set_tick(f.w, start);
  FILE *out = open_memstream(&r->text, &r->bytes);
  if (out == NULL) fixture_give_up("open_memstream", "no memory");
  record_begin(&to, out, 0, f.facts.hands, f.facts.rate_hz, start, fray_hash(f.w));
  for (uint32_t n = 0; n < 40; ++n) {
    r->input[n] = hands_input(&f, n);
    const fray_output output = fixture_tick(&f, &r->input[n]);
    r->hash[n] = output.hash;
    CHECK(record_tick(&to, &r->input[n], &output));
  }
  CHECK(record_end(&to));
  fclose(out);
}

/* The SYNC of tick `wrap` is cut out: the message has the whole numbers. */
static void refuse_gap(const recorded *r, uint64_t wrap, const replay_setting *setting) {
  char line[16], expected[96];
  candump_log log;
  candump_error error;
  replay run;
  /* as candump writes it: the low word, lowest byte first */
  snprintf(line, sizeof line, "#%02X%02X%02X%02X", (unsigned)(wrap & 255u), (unsigned)(wrap >> 8 & 255u),
           (unsigned)(wrap >> 16 & 255u), (unsigned)(wrap >> 24 & 255u));
  char sync[32];
  snprintf(sync, sizeof sync, "080%s", line);
  char *at = strstr(r->text, sync);
  CHECK(at != NULL);
  if (at == NULL) return;
  while (at > r->text && at[-1] != '\n') --at;
  *at = '#'; /* now a comment */
  snprintf(expected, sizeof expected, "SYNC of tick %llu, expected tick %llu: a SYNC is missing",
           (unsigned long long)(wrap + 1u), (unsigned long long)wrap);
  CHECK(candump_parse_all("run", r->text, r->bytes, &log, &error));
  CHECK(!replay_read("run", &log, setting, &run, &error));
  CHECK_TEXT(error.message, expected);
  candump_free(&log);
}

static void recordings_across(void) {
  fixture_scoped f = {0};
  open_hands(&f);
  for (uint32_t n = 0; n < PREPARED; ++n) (void)fixture_tick(&f, &fixture_idle);
  for (uint32_t k = 0; k < WRAPS; ++k) {
    static recorded r;
    candump_log log;
    candump_error error;
    replay run;
    const uint64_t start = wraps[k] - 10;
    const replay_setting setting = {0, f.facts.hands, f.facts.rate_hz, start, {0, 0}, 0, 0};
    record_run(&f, start, &r);
    CHECK(candump_parse_all("run", r.text, r.bytes, &log, &error));
    const int good = replay_read("run", &log, &setting, &run, &error);
    CHECK(good);
    candump_free(&log);
    if (good) {
      CHECK(run.first == start);
      CHECK_EQ_INT(run.count, 40);
      for (uint32_t n = 0; n < run.count; ++n) {
        CHECK_EQ_INT(run.ticks[n].hash, (uint32_t)(r.hash[n] & UINT32_MAX));
        CHECK_EQ_INT(run.ticks[n].input.has_pose, r.input[n].has_pose);
        CHECK(memcmp(run.ticks[n].input.pose, r.input[n].pose, sizeof r.input[n].pose) == 0);
        CHECK_EQ_INT(run.ticks[n].input.command, r.input[n].command);
      }
      replay_free(&run);
    }
    refuse_gap(&r, wraps[k], &setting);
    free(r.text);
  }
}

static void numbers_from_low_words(void) {
  const uint64_t wrap = UINT64_C(1) << 32;
  CHECK(replay_tick_number(5, 0) == 5 && replay_tick_number(UINT32_MAX, 0) == UINT32_MAX);
  CHECK(replay_tick_number(3, wrap - 2) == wrap + 3 && replay_tick_number(UINT32_MAX, wrap + 2) == wrap - 1);
  CHECK(replay_tick_number(7, 5 * wrap + 9) == 5 * wrap + 7);
}

int main(void) {
  TEST(hands);
  TEST(yarns);
  TEST(membrane);
  TEST(dragged_membrane);
  TEST(ended_paths_stay);
  TEST(the_longest_path);
  TEST(images_across);
  TEST(recordings_across);
  TEST(numbers_from_low_words);
  return test_end();
}
