/* SPDX-License-Identifier: Apache-2.0 */
/* image_validate() on a world whose every word is arbitrary, and the views of one that it accepts.
 * Of one shape: WARPS, WEFTS, SPARE particles, HELD of them, LINK_, BEND_ and SHEAR_BATCHES, KEYS;
 * with SPLITS a tick of sheets with yarns.
 * Every array is as long as its pool and stands alone, so that one step too far is seen.
 * What counts_fit() compares with the capacities is given, for anything else is refused there
 * (counts()). How many rows the first batch of links has is gone through, value by value, and so
 * that every batch after it begins where it must. */
#include "rt/image/image.h"
#include "rt/image/validate.c"
#include "tests/proof/any.h"

#ifndef SPLITS
#define SPLITS 0
#endif

enum {
  CROSSINGS = WARPS * WEFTS,
  PARTICLES = CROSSINGS + SPARE,
  LINKS = WEFTS * (WARPS - 1) + WARPS * (WEFTS - 1),
  BENDS = WEFTS * (WARPS - 2) + WARPS * (WEFTS - 2),
  SHEARS = 2 * (WARPS - 1) * (WEFTS - 1),
  TWICE = SPLITS != 0 ? 2 : 1,
  ROWS = LINKS + BENDS + TWICE * SHEARS,
  BATCHES = LINK_BATCHES + BEND_BATCHES + TWICE * SHEAR_BATCHES,
  CLASSES = SPLITS != 0 ? CLASS_WARP + 1 : 2,
  BODIES = 2,
  CONTACTS = 2
};

static params fixed;
static state moving;
static index_t crossing[CROSSINGS], home[ROWS], row_of[ROWS], row_i[ROWS], row_j[ROWS];
static uint8_t row_class[ROWS];
static spring_batch batches[BATCHES];
static link_class links[CLASSES];
static bend_shear_class springs[CLASSES];
static uint8_t grip_body[HELD];
static int32_t grip_x[HELD], grip_y[HELD], grip_z[HELD];
static rigid_body bodies[BODIES];
static keyframe keys[KEYS];
static body_state body_states[BODIES];
static int32_t x[PARTICLES], y[PARTICLES], z[PARTICLES];
static int32_t vx[PARTICLES], vy[PARTICLES], vz[PARTICLES];
static int8_t rx[PARTICLES], ry[PARTICLES], rz[PARTICLES];
static int32_t qx[PARTICLES], qy[PARTICLES], qz[PARTICLES];
static yarn_params yarns;
static yarn_state yarn_words;
static uint8_t couple[CROSSINGS];
static index_t warp_at[CROSSINGS], place[PARTICLES];
static body_motion motion[BODIES];
static contact contacts[CONTACTS];
static torn_spring cuts[MAX_BREAKS];

static fray_world world = {
    .features.yarns = SPLITS != 0,
    .capacity = {1, 1, PARTICLES, HELD, CROSSINGS, ROWS, BATCHES, CLASSES, CLASSES, BODIES, KEYS,
                 CONTACTS, MAX_BREAKS, SPLITS},
    .params = &fixed, .woven.crossing_particle = crossing, .woven.canonical_id = home, .woven.spring_of = row_of, .woven.batches = batches,
    .woven.link_classes = links, .woven.bend_shear_classes = springs, .p.attach_body = grip_body, .p.attach_x = grip_x,
    .p.attach_y = grip_y, .p.attach_z = grip_z, .rigid.bodies = bodies, .rigid.keyframes = keys, .state = &moving,
    .p.x = x, .p.y = y, .p.z = z, .p.vx = vx, .p.vy = vy, .p.vz = vz, .p.rx = rx, .p.ry = ry, .p.rz = rz,
    .woven.spring_i = row_i, .woven.spring_j = row_j, .woven.spring_kind = row_class, .rigid.states = body_states,
    .woven.yarn_constants = &yarns, .woven.yarn_counts = &yarn_words, .woven.crossing_state = couple, .woven.warp_particle = warp_at, .woven.crossing_of = place,
    .p.qx = qx, .p.qy = qy, .p.qz = qz, .rigid.motion = motion, .contact.list = contacts, .woven.tear_queue = cuts};

#define ANY(array) any_bytes(&array, sizeof array)

static void any_world(void) {
  ANY(fixed); ANY(moving); ANY(crossing); ANY(home); ANY(row_of); ANY(row_i); ANY(row_j);
  ANY(row_class); ANY(batches); ANY(links); ANY(springs); ANY(grip_body); ANY(grip_x); ANY(grip_y);
  ANY(grip_z); ANY(bodies); ANY(keys); ANY(body_states); ANY(x); ANY(y); ANY(z); ANY(vx); ANY(vy);
  ANY(vz); ANY(rx); ANY(ry); ANY(rz); ANY(qx); ANY(qy); ANY(qz); ANY(motion); ANY(contacts);
  ANY(cuts); ANY(yarns); ANY(yarn_words); ANY(couple); ANY(warp_at); ANY(place);
}

/* Any scalars at all: what does not fit the capacities goes no further than this. */
void counts(void) {
  fray_error error;
  any_world();
  if (words_in_range(world.params, params_ranges, PARAM_WORDS, IN_PARAMS, &error))
    (void)counts_fit(&world, &error);
  (void)words_in_range(world.state, state_ranges, STATE_WORDS, IN_STATE, &error);
}

static void views(void) {
  fray_pool pool;
  (void)fray_get_info(&world);
  (void)fray_work_bound(&world);
  (void)fray_view_particles(&world);
  (void)fray_view_weave(&world);
  (void)fray_view_spring(&world, FRAY_STRUCTURAL, any_between(0, LINKS - 1));
  (void)fray_view_spring(&world, FRAY_SHEAR, any_between(0, SHEARS - 1));
  (void)fray_view_body(&world, any_between(0, BODIES - 1));
  (void)fray_crossing_particle(&world, any_between(0, CROSSINGS - 1));
  (void)fray_yarn_particle(&world, any_between(0, CROSSINGS - 1), FRAY_WARP);
  (void)fray_crossing_state_at(&world, any_between(0, CROSSINGS - 1));
  (void)fray_hash(&world);
}

static void validate(int32_t link_rows, int32_t keys_of_first) {
  fray_error error;
  any_world();
  fixed.warps = WARPS;
  fixed.wefts = WEFTS;
  fixed.link_batches = LINK_BATCHES;
  fixed.bend_batches = BEND_BATCHES;
  fixed.shear_batches = SHEAR_BATCHES;
  batches[0].count = link_rows;
  /* as fray_open() has it */
  world.p.count = (uint32_t)fixed.particles + (SPLITS != 0 ? (uint32_t)yarn_words.split : 0u);
  bodies[0].keyframes = keys_of_first;
  bodies[1].keyframes = KEYS - keys_of_first;
  if (image_validate(&world, &error) == FRAY_OK) views();
}

/* Bodies share out the keys in every way in turn; where each begins in them is arbitrary. */
void worlds(void) {
  for (int32_t n = 0; n <= LINKS; ++n) validate(n, n % (KEYS + 1));
  validate(-1 - (int32_t)any_between(0, 0x7FFFFFFF), 0);
  validate(LINKS + 1 + (int32_t)any_between(0, 0x7FFFFFFF - LINKS - 1), 0);
}
