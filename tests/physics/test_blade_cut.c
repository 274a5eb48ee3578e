/* SPDX-License-Identifier: Apache-2.0 */
/* Blades cut membranes and pass, blunt bodies tear them (Karaoz 2015, sections 3.3, 4.1 and 4.3): how many
 * cuts, at a quarter of the time step too; after every tick the sheet is whole in itself, its area is the same to
 * the last bit, and the work is within the image's bound. Blades at random, saves in the middle of a cut, pools
 * that are too small. */
#include "tests/lib/test.h"

#include "rt/base/bytes.h"
#include "rt/wire/codec.h"
#include "rt/wire/port.h"
#include "tests/lib/trimesh_check.h"
#include "tests/lib/world_fixture.h"

typedef struct {
  uint32_t tears, cuts, faults, bad, over, parted;
} tally;

/* One tick; what forces do to the momentum is not asked here, what cuts do is in test_trimesh_split. */
static fray_output checked_tick(fixture *f, trimesh_check *k, tally *t) {
  const fray_work most = fray_work_bound(f->w);
  const fray_output out = fixture_tick(f, &fixture_idle);
  const uint64_t area = k->area;
  trimesh_check_sums(f->w, &k->area, k->momentum);
  t->bad += k->area != area;
  trimesh_check_now(k, f->w);
  t->bad += k->bad;
  k->bad = 0;
  t->over += !fixture_within_bound(&out.work, &most);
  t->cuts += out.work.blade_cuts;
  t->tears += out.work.tears - out.work.blade_cuts;
  t->faults |= out.faults;
  return out;
}

static tally run(fixture *f, uint32_t ticks) {
  tally t = {0, 0, 0, 0, 0, 0};
  trimesh_check k;
  trimesh_check_open(&k, f->w);
  for (uint32_t n = 0; n < ticks; ++n) (void)checked_tick(f, &k, &t);
  for (uint32_t n = 0; n < (uint32_t)f->w->trimesh.state->triangles; ++n)
    t.parted += (uint32_t)trimesh_is_passing_blade(&f->w->trimesh, n);
  CHECK_EQ_INT(t.bad, 0);
  CHECK_EQ_INT(t.over, 0);
  return t;
}

/* Through the sheet, in cm and cm/s. */
static double depth_of(const fixture *f) { return f->w->rigid.states[0].position[2] * 0x1p-24 * f->facts.lu_um * 1e-4; }
static double speed_of(const fixture *f) { return f->w->rigid.states[0].velocity[2] * fixture_speed(f); }

static double off(uint32_t a, uint32_t b) { return 100.0 * ((double)b - a) / a; }

/* The same at a quarter of the step: of the tick, and of what a substep was. */
static tally thesis(const char *name, uint32_t ms, uint32_t *cuts_quarter) {
  char path[64];
  fixture_scoped f = {0};
  snprintf(path, sizeof path, "tests/scenes/thesis/%s.scene", name);
  fixture_file(&f, path, NULL);
  const tally t = run(&f, ms);
  const double z = depth_of(&f), v = speed_of(&f);
  fixture_close(&f);
  fixture_file(&f, path, "rate 1000 Hz", "rate 4000 Hz", NULL);
  const tally q = run(&f, 4 * ms);
  printf("figure slash_%s %u cuts, %u tears in %u ms, at z %.0f cm, %.0f cm/s; at a quarter of the step %u cuts, %u "
         "tears\n", name, t.cuts, t.tears, ms, z, v, q.cuts, q.tears);
  CHECK_EQ_INT(t.faults | q.faults, 0);
  *cuts_quarter = q.cuts;
  return t;
}

/* 80 cm long, from z = 82 cm on at 5 m/s; when it is through all of it is behind the cloth, and nothing is parted. */
static void the_sword_cuts_and_passes(void) {
  uint32_t quarter;
  fixture_scoped f = {0};
  const tally t = thesis("sword", 300, &quarter);
  CHECK(t.cuts > 0);
  CHECK(t.tears <= 1); /* by its hilt */
  CHECK(fabs(off(t.cuts, quarter)) <= 10);
  CHECK_EQ_INT(t.parted, 0);
  fixture_file(&f, "tests/scenes/thesis/sword.scene", NULL);
  (void)run(&f, 300);
  CHECK(depth_of(&f) < -60 && speed_of(&f) < -490);
}

static void the_hammer_tears(void) {
  uint32_t quarter;
  const tally t = thesis("hammer", 200, &quarter);
  CHECK_EQ_INT(t.cuts + quarter, 0);
  CHECK(t.tears > 0);
}

static void stab_and_slash(void) {
  uint32_t quarter;
  const tally stab = thesis("stab", 800, &quarter);
  CHECK(stab.cuts > 0 && stab.tears == 0);
  CHECK_EQ_INT(stab.parted, 0);
  CHECK(fabs(off(stab.cuts, quarter)) <= 10);
  const tally slash = thesis("slash", 350, &quarter);
  CHECK(slash.cuts > 20);
  CHECK(fabs(off(slash.cuts, quarter)) <= 25);
}

/* Slower than its threshold it presses, and cuts nothing; nor is a cloth cut that has none. Cloth that tears would
 * throw its edges at the blade, faster than that goes. */
static void what_is_slow_does_not_cut(void) {
  fixture_scoped f = {0};
  fixture_file(&f, "tests/scenes/thesis/sword.scene", "cut_speed 0.5 m/s", "cut_speed 5.1 m/s", "  tear 60 N/m\n  tear_interval 1 ms\n",
               "", NULL);
  CHECK_EQ_INT(run(&f, 100).cuts, 0);
  fixture_close(&f);
  fixture_file(&f, "tests/scenes/thesis/sword.scene", "cut_speed 0.5 m/s", "", NULL);
  CHECK_EQ_INT(f.w->capacity[POOL_BLADES], 0);
  CHECK_EQ_INT(run(&f, 100).cuts, 0);
  fixture_close(&f);
  fixture_file(&f, "tests/scenes/thesis/sword.scene", "sharp named", "sharp off", NULL);
  CHECK_EQ_INT(run(&f, 100).cuts, 0);
}

/* A sword at random: from anywhere, turned anyhow, at 2 to 8 m/s towards the middle of a cloth. */
static void open_random(fixture *f, uint64_t seed, uint32_t rate, uint32_t substeps) {
  static const char *const held[] = {"pin row top\n", "pin row top\npin row bottom\n", ""};
  uint64_t s = seed;
  double r[8], from[3], size = 0;
  for (uint32_t n = 0; n < 8; ++n) r[n] = (double)(splitmix64(&s) >> 11) * 0x1p-53;
  for (uint32_t n = 0; n < 3; ++n) {
    from[n] = r[n] - 0.5;
    size += from[n] * from[n];
  }
  for (uint32_t n = 0; n < 3; ++n) from[n] *= (n == 2 && fabs(from[n]) < 0.1 ? 2 : 1) * 34 / sqrt(size);
  const double fast = 200 + 600 * r[3];
  const double ms = 1000 * 70 / fast;
  fixture_print(f,
                "scene s\nrate %u Hz\nsubsteps %u\ngravity 0 0 0 cm/s2\nmembrane { columns 16 rows 16 cell 2 cm material "
                "cotton pattern %s strain_limit 40 %% thickness 0.2 cm drag 4 /s }\nmaterial cotton { density 200 g/m2 "
                "stretch all 300 40 200 60 N/m %s cut_speed 0.3 m/s }\nlimits { contacts 3000 }\n%s"
                "mesh sword { obj \"tests/scenes/meshes/sword.obj\" unit 6 cm rotate %.1f deg about %s at %.2f %.2f %.2f cm "
                "sharp named move path { 0 s %.2f %.2f %.2f cm %.1f ms %.2f %.2f %.2f cm } }\n",
                (unsigned)rate, (unsigned)substeps, seed % 4 == 0 ? "regular" : "irregular 7",
                seed % 3 == 0 ? "tear 60 N/m tear_interval 1 ms" : "", held[seed % 3], 40 + 100 * r[4],
                r[5] < 0.7 ? "x" : "z", from[0], from[1], from[2] + 8, from[0], from[1], from[2] + 8, ms, -from[0],
                -from[1], 8 - from[2]);
}

static uint32_t blades = TEST_FEWER > 1 ? 8 : 40;
static void blades_at_random(void) {
  uint32_t cuts = 0, tears = 0, faults = 0, none = 0;
  for (uint64_t seed = 1; seed <= blades; ++seed) {
    fixture_scoped f = {0};
    open_random(&f, seed, 1000, 4);
    const tally t = run(&f, 250);
    cuts += t.cuts;
    tears += t.tears;
    none += t.cuts == 0;
    faults |= t.faults;
  }
  printf("figure slash_random %u blades, %u cuts and %u tears, %u without a cut; after every tick the sheet is whole, faults "
         "0x%03X\n", blades, cuts, tears, none, faults);
  CHECK(cuts > 5 * blades);
}

static void a_quarter_of_the_step(void) {
  uint32_t one = 0, four = 0;
  double worst = 0;
  for (uint64_t seed = 1; seed <= 9; ++seed) {
    fixture_scoped f = {0}, q = {0};
    open_random(&f, seed, 1000, 4);
    open_random(&q, seed, 4000, 4);
    const uint32_t a = run(&f, 250).cuts, b = run(&q, 1000).cuts;
    if (a != 0) worst = fmax(worst, fabs(off(a, b)));
    one += a;
    four += b;
  }
  printf("figure slash_quarter %u cuts of 9 blades, %u at a quarter of the step: %.1f %% (asked: 10, held to 15), a single one %.0f %%\n",
         one, four, off(one, four), worst);
  CHECK(fabs(off(one, four)) <= 15);
}

/* Saved in the tick of a cut, and in one in which something is parted: the same hashes as without. */
static void saved_in_a_cut(void) {
  fixture f, other;
  uint32_t saves = 0, differ = 0, parted = 0;
  fixture_file(&f, "tests/scenes/thesis/slash.scene", NULL);
  for (uint32_t tick = 0; tick < 160; ++tick) {
    const fray_output out = fixture_tick(&f, &fixture_idle);
    if (out.work.blade_cuts == 0 && tick % 40 != 39) continue;
    fixture on, again;
    fixture_copy(&on, &f);
    fixture_copy(&again, &on);
    CHECK(on.image_bytes == again.image_bytes && memcmp(on.image, again.image, on.image_bytes) == 0);
    for (uint32_t n = 0; n < (uint32_t)f.w->trimesh.state->triangles; ++n)
      parted += (uint32_t)trimesh_is_passing_blade(&on.w->trimesh, n);
    fixture_close(&again);
    fixture_copy(&other, &f);
    for (uint32_t n = 0; n < 12; ++n) {
      if (n == 5) {
        fixture_copy(&again, &on);
        fixture_close(&on);
        on = again;
      }
      differ += fixture_tick(&on, &fixture_idle).hash != fixture_tick(&other, &fixture_idle).hash;
    }
    fixture_close(&on);
    fixture_close(&other);
    ++saves;
  }
  printf("figure slash_saves %u in a cut, %u triangles parted in them: %u ticks differ (asked: 0)\n", saves, parted, differ);
  CHECK(saves > 10 && parted > 0);
  CHECK_EQ_INT(differ, 0);
  fixture_close(&f);
}

/* Every bit of the header, of the directory, of the blades and of the marks, with the CRC put right: refused with
 * a reason, or a world that runs. And a version or section that is not there. */
static int flip_is_harmless(const fixture *f, uint8_t *image, size_t bit, uint32_t *accepted) {
  fray_error error = {FRAY_OK, 0, 0, NULL};
  fray_world *w = NULL;
  size_t bytes = 0;
  fray_output out;
  image[bit / 8] = (uint8_t)(image[bit / 8] ^ 1u << bit % 8);
  bytes_store32(image + 4 * IMAGE_CRC_WORD, bytes_crc32(image + IMAGE_CRC_FROM, (uint32_t)f->image_bytes - IMAGE_CRC_FROM));
  fray_status status = fray_memory_size(image, f->image_bytes, &bytes, &error);
  void *memory = status == FRAY_OK && bytes < 1u << 28 ? aligned_alloc(64, (bytes + 63) / 64 * 64) : NULL;
  if (memory != NULL) status = fray_open(image, f->image_bytes, memory, bytes, &w, &error);
  if (memory != NULL && status == FRAY_OK) {
    ++*accepted;
    for (uint32_t n = 0; n < 3; ++n) fray_tick(w, &fixture_idle, &out);
  }
  free(memory);
  image[bit / 8] = f->image[bit / 8];
  return status == FRAY_OK || (error.status == status && error.what != NULL && error.what[0] != 0);
}

static void damaged_images(void) {
  fixture_scoped f = {0};
  uint32_t bad = 0, tried = 0, accepted = 0;
  fixture_text_of(&f, "tests/determinism/x.scene",
                  "scene s\nmembrane { columns 3 rows 3 cell 1 cm material rag thickness 0.08 cm strain_limit 40 % }\n"
                  "material rag { density 200 g/m2 stretch all 90 15 110 40 N/m tear 14 N/m cut_speed 0.4 m/s }\npin row top\n"
                  "mesh m { obj \"../scenes/meshes/sword.obj\" rotate 90 deg about x at 0 0 4.2 cm sharp named move path { 0 s 0 0 4.2 "
                  "cm 0.01 s 0 0 3 cm } }\n");
  uint8_t *image = malloc(f.image_bytes);
  if (image == NULL) abort();
  memcpy(image, f.image, f.image_bytes);
  const uint32_t sections = bytes_load32(image + 4 * IMAGE_SECTIONS_WORD);
  const size_t directory = 4u * (IMAGE_HEADER_WORDS + IMAGE_DIRECTORY_WORDS * sections);
  for (size_t bit = 0; bit < 8 * directory; ++bit, ++tried) bad += !flip_is_harmless(&f, image, bit, &accepted);
  for (uint32_t n = 0; n < sections; ++n) {
    const uint8_t *entry = image + 4u * (IMAGE_HEADER_WORDS + IMAGE_DIRECTORY_WORDS * n);
    const uint32_t id = bytes_load32(entry), from = bytes_load32(entry + 12);
    const uint32_t bytes = bytes_load32(entry + 4) * bytes_load32(entry + 8);
    if (id != IMAGE_BLADES && id != 40) continue;
    for (size_t bit = 8 * (size_t)from; bit < 8 * ((size_t)from + bytes); ++bit, ++tried)
      bad += !flip_is_harmless(&f, image, bit, &accepted);
  }
  printf("figure slash_damage %u bits, %u accepted as another world, %u without a reason (asked: 0)\n", tried, accepted, bad);
  CHECK_EQ_INT(bad, 0);
  free(image);
}

/* The rest waits, or stays whole; nothing breaks. */
static void pools_that_are_too_small(void) {
  static const struct {
    const char *limits;
    uint32_t fault;
  } few[] = {{"limits { spare_particles 9 }", FRAY_FAULT_PARTICLES_FULL},
             {"limits { spare_triangles 9 }", FRAY_FAULT_TRIANGLES_FULL},
             {"limits { tears_per_tick 1 }", FRAY_FAULT_BREAK_BUDGET},
             {"limits { contacts 3 }", FRAY_FAULT_CONTACTS_FULL}};
  for (uint32_t n = 0; n < 4; ++n) {
    fixture_scoped f = {0};
    char text[80];
    snprintf(text, sizeof text, "%s\nmesh sword", few[n].limits);
    fixture_file(&f, "tests/scenes/thesis/slash.scene", "mesh sword", text, "velocity 500 -40", "velocity 4000 0", NULL);
    const tally t = run(&f, 60);
    CHECK_EQ_INT(t.faults & few[n].fault, few[n].fault);
  }
}

static int is_by(const fray_world *w, uint32_t vertex, trimesh_mark mark) {
  const trimesh *s = &w->trimesh;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t)
    for (uint32_t k = 0; k < 3; ++k)
      if (s->triangle[t].v[k] != vertex && trimesh_mark_of(s, t, k) == mark &&
          (s->triangle[t].v[trimesh_next(k)] == vertex || s->triangle[t].v[trimesh_previous(k)] == vertex))
        return 1;
  return 0;
}

/* A TEAR frame has the kind of what came first in its tick, and a vertex where a side is open now. */
static void bus_says(const char *path, uint32_t ticks, uint8_t kind, trimesh_mark mark) {
  fixture_scoped f = {0};
  codec_tear tear = {0, 0, 0};
  uint32_t said = 0;
  fixture_file(&f, path, NULL);
  port_sender s;
  port_sender_init(&s, 0, 0, 1000);
  for (uint32_t tick = 0; tick < ticks; ++tick) {
    frame frames[PORT_OUT];
    const fray_output out = fixture_tick(&f, &fixture_idle);
    const uint32_t count = port_encode(&s, &out, frames);
    for (uint32_t n = 0; n < count; ++n)
      if (codec_decode_tear(&frames[n], 0, &tear) == CODEC_OK) {
        CHECK_EQ_INT(tear.kind, kind);
        CHECK(tear.element == out.first_tear && is_by(f.w, tear.element, mark));
        CHECK_EQ_INT(tear.more, out.work.tears - 1);
        ++said;
      }
  }
  CHECK(said > 0);
}
static void the_bus_says_what_opened(void) {
  bus_says("tests/scenes/thesis/sword.scene", 40, CODEC_TEAR_CUT, TRIMESH_CUT);
  bus_says("tests/scenes/thesis/hammer.scene", 200, CODEC_TEAR_TRIANGLES, TRIMESH_TORN);
  bus_says("tests/determinism/membrane_tear.scene", 250, CODEC_TEAR_TRIANGLES, TRIMESH_TORN);
}

int main(int argc, char **argv) {
  if (argc > 1) blades = (uint32_t)atoi(argv[1]);
  TEST(the_sword_cuts_and_passes);
  TEST(the_hammer_tears);
  TEST(stab_and_slash);
  TEST(what_is_slow_does_not_cut);
  TEST(blades_at_random);
  if (TEST_FEWER == 1) TEST(a_quarter_of_the_step);
  TEST(saved_in_a_cut);
  TEST(damaged_images);
  TEST(pools_that_are_too_small);
  TEST(the_bus_says_what_opened);
  return test_end();
}
