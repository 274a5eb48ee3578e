/* SPDX-License-Identifier: Apache-2.0 */
/* Validates every value of a loaded image, in time linear in the image, so that the stages can rely on
 * ranges, on ids that exist and on independent springs in each batch. */
#include "rt/base/hash.h"
#include "rt/image/image.h"
#include "rt/image/state_hash.h"
#include "rt/state/crossing.h"
#include "rt/state/rigid_mesh.h"

#define X(name, min, max) {min, max},
static const word_range params_ranges[PARAM_WORDS] = {PARAMS(X)};
static const word_range state_ranges[STATE_WORDS] = {STATE(X)};
static const word_range yarn_params_ranges[YARN_PARAM_WORDS] = {YARN_PARAMS(X)};
static const word_range yarn_state_ranges[YARN_STATE_WORDS] = {YARN_STATE(X)};
static const word_range elastic_params_ranges[YARN_ELASTIC_PARAM_WORDS] = {YARN_ELASTIC_PARAMS(X)};
static const word_range self_params_ranges[SELF_PARAM_WORDS] = {SELF_PARAMS(X)};
#undef X

/* Section ids, as in image_arrays. */
enum {
  IN_PARAMS = 1, IN_STATE, IN_LINKS, IN_SPRINGS, IN_BATCHES, IN_CROSSING, IN_HOME, IN_ROW_OF,
  IN_ROW_I, IN_ROW_J, IN_CLASS, IN_X, IN_Y, IN_Z, IN_VX, IN_RX = 18, IN_GRIP_BODY = 21, IN_GRIP_X,
  IN_BODIES = 25, IN_BODY_STATES, IN_KEYS, IN_YARNS, IN_YARN_STATE, IN_COUPLE, IN_WARP_AT, IN_PLACE,
  IN_STRETCH, IN_PULLS,
  IN_SELVES = 49, IN_MESHES = 50, IN_BLADES, IN_LAYERS
};

int image_bad(fray_error *error, uint32_t section, uint32_t index, const char *what) {
  return image_refuse(error, FRAY_BAD_FIELD, section, index, what) == FRAY_OK;
}

static int bad_batch(fray_error *error, uint32_t batch, const char *what) {
  return image_refuse(error, FRAY_BAD_BATCH, IN_BATCHES, batch, what) == FRAY_OK;
}

int image_words_in_range(const void *table, const word_range *ranges, uint32_t count, uint32_t section,
                         fray_error *error) {
  const int32_t *words = (const int32_t *)table;
  for (uint32_t n = 0; n < count; ++n)
    if (words[n] < ranges[n].least || words[n] > ranges[n].most)
      return image_bad(error, section, n, "a word in its range, see the tables in rt/state");
  return 1;
}

/* A membrane has no crossings, springs or yarns. */
static int membrane_counts_fit(const fray_world *w) {
  const params *p = w->params;
  const uint32_t *have = w->capacity;
  return have[POOL_CROSSINGS] == 0 && have[POOL_SPRINGS] == 0 && have[POOL_BATCHES] == 0 &&
         have[POOL_SPLITS] == 0 && p->warps == 0 && p->wefts == 0 && p->links == 0 && p->bends == 0 &&
         p->shears == 0 && p->link_batches == 0 && p->bend_batches == 0 && p->shear_batches == 0;
}

static int counts_fit(const fray_world *w, fray_error *error) {
  const params *p = w->params;
  const yarn_grid grid = world_yarn_grid(w);
  const uint32_t crossings = grid.warps * grid.wefts;
  const uint32_t *have = w->capacity;
  /* every diagonal of a world with yarns has a shadow row, in batches of their own */
  const uint32_t twice = world_has_yarns(w) ? 2 : 1;
  const int woven =
      p->warps >= 2 && p->wefts >= 2 && crossings == have[POOL_CROSSINGS] &&
      (uint32_t)p->particles >= crossings && (uint32_t)p->links == yarn_grid_links(grid) &&
      (uint32_t)p->bends == yarn_grid_bends(grid) && (uint32_t)p->shears == yarn_grid_shears(grid) &&
      (uint32_t)p->links + (uint32_t)p->bends + twice * (uint32_t)p->shears == have[POOL_SPRINGS] &&
      (uint32_t)p->link_batches + (uint32_t)p->bend_batches + twice * (uint32_t)p->shear_batches ==
          have[POOL_BATCHES];
  const int fit =
      (world_has_membrane(w) ? membrane_counts_fit(w) : woven) &&
      (uint32_t)p->particles <= have[POOL_PARTICLES] && w->p.count <= have[POOL_PARTICLES] &&
      (uint32_t)p->attached == have[POOL_ATTACHED] && p->attached <= p->particles &&
      (uint32_t)p->bodies == have[POOL_BODIES] && (uint32_t)p->tears_max == have[POOL_BREAKS] &&
      have[POOL_LINK_CLASSES] >= 1 && have[POOL_BEND_SHEAR_CLASSES] >= 1;
  if (!fit) return image_bad(error, IN_PARAMS, 0, "counts that agree with the header's capacities");
  if (p->tear_max < p->tear_min) return image_bad(error, IN_PARAMS, 0, "tear_max at least tear_min");
  if (p->attached != 0 && p->bodies == 0) return image_bad(error, IN_PARAMS, 0, "a body that holds");
  return 1;
}

static int link_is(const link_class *c, link_class expected) {
  return c->rest == expected.rest && c->push == expected.push && c->r2 == expected.r2 &&
         c->n_max == expected.n_max && c->inverse == expected.inverse;
}

static int link_follows(const link_class *c) { return link_is(c, link_class_make(c->rest, c->push)); }
static int lock_good(const fray_world *w, fray_error *error) {
  const link_class *const lock = &w->woven.link_classes[CLASS_LOCK];
  const int fits = w->capacity[POOL_LINK_CLASSES] == CLASSES_WITH_LOCK &&
                   w->capacity[POOL_BEND_SHEAR_CLASSES] <= CLASS_SHEAR_HALF + 1;
  if (!fits || world_has_membrane(w) || world_has_elastic_yarns(w))
    return image_bad(error, IN_LINKS, CLASS_LOCK, "two classes of a shear lock, not of elastic yarns");
  return (lock->rest >= LOCK_UNITS_MIN << LINK_SHIFT && lock->rest <= LINK_UNITS_MAX << LINK_SHIFT &&
          link_is(&lock[0], link_class_of_lock(lock->rest)) && link_is(&lock[1], lock[0])) ||
         image_bad(error, IN_LINKS, CLASS_LOCK, "a diagonal of 128 to 8191 direction units, twice");
}

static int link_classes_good(const fray_world *w, fray_error *error) {
  const uint32_t classes = w->capacity[POOL_LINK_CLASSES];
  for (uint32_t n = 1; n < classes && n < CLASS_LOCK; ++n) {
    const link_class *c = &w->woven.link_classes[n];
    if (c->rest < LINK_UNITS_MIN << LINK_SHIFT || c->rest > LINK_UNITS_MAX << LINK_SHIFT)
      return image_bad(error, IN_LINKS, n, "a rest length of 1024 to 8191 direction units");
    if (c->push < 0 || c->push > 4096)
      return image_bad(error, IN_LINKS, n, "a share of 0 to 4096");
    if (!link_follows(c))
      return image_bad(error, IN_LINKS, n, "constants that follow from the rest length");
  }
  return !world_has_shear_lock(w) || lock_good(w, error);
}

static int spring_classes_good(const fray_world *w, fray_error *error) {
  for (uint32_t n = 1; n < w->capacity[POOL_BEND_SHEAR_CLASSES]; ++n) {
    const bend_shear_class *c = &w->woven.bend_shear_classes[n];
    const int gain_good = c->mantissa == 0 || (c->mantissa >= 1 << 15 && c->mantissa < 1 << 16);
    if (c->rest < BEND_SHEAR_REST_MIN || c->rest > BEND_SHEAR_REST_MAX || !gain_good || c->shift < 17 ||
        c->shift > 46 || (c->compression_only | 1) != 1)
      return image_bad(error, IN_SPRINGS, n,
                 "a rest length of 2^-11 to 1/4 lu, a gain below 1/2, a flag of 0 or 1");
    const bend_shear_class expected =
        bend_shear_class_make(c->rest, c->mantissa, c->shift, c->compression_only);
    if (c->mantissa != expected.mantissa || c->down != expected.down || c->r2 != expected.r2 ||
        c->inactive_r2 != expected.inactive_r2 || c->inverse != expected.inverse ||
        c->gain != expected.gain || c->scale != expected.scale)
      return image_bad(error, IN_SPRINGS, n, "constants that follow from the rest length and the gain");
  }
  return 1;
}

static int gain_good(int32_t mantissa, int32_t scale) {
  return (mantissa == 0 || (mantissa >= YARN_ELASTIC_PULL_MIN &&
                            mantissa - YARN_ELASTIC_PULL_MIN < YARN_ELASTIC_PULL_MIN)) &&
         scale >= YARN_ELASTIC_SCALE_MIN && scale <= YARN_ELASTIC_SCALE_MAX;
}

static int elastic_yarns_good(const fray_world *w, fray_error *error) {
  if (!image_words_in_range(w->woven.elastic_params, elastic_params_ranges, YARN_ELASTIC_PARAM_WORDS,
                            IN_STRETCH, error))
    return 0;
  if (w->capacity[POOL_YARN_GAINS] != w->capacity[POOL_LINK_CLASSES])
    return image_bad(error, IN_PULLS, 0, "as many classes as links have");
  for (uint32_t n = 1; n < w->capacity[POOL_YARN_GAINS]; ++n) {
    const yarn_gain *c = &w->woven.yarn_gains[n];
    if (!gain_good(c->pull, c->pull_scale) || !gain_good(c->push, c->push_scale) || c->damping < 0 ||
        c->damping > YARN_ELASTIC_DAMPING_MAX)
      return image_bad(error, IN_PULLS, n, "gains of 30 bits and a shift, a damping to 1");
  }
  return 1;
}

static int orthonormal(const int32_t axes[9]) {
  for (uint32_t a = 0; a < 3; ++a)
    for (uint32_t b = a; b < 3; ++b) {
      int64_t dot = 0;
      for (uint32_t n = 0; n < 3; ++n) {
        if (axes[3 * a + n] < -(1 << 30) || axes[3 * a + n] > 1 << 30) return 0;
        dot += fx_asr64((int64_t)axes[3 * a + n] * axes[3 * b + n], 30);
      }
      const int64_t off = dot - (a == b ? (int64_t)1 << 30 : 0);
      if (off < -4096 || off > 4096) return 0;
    }
  return 1;
}

#define GRIP_MAX FX_WORLD_MAX /* position + grip stays below 2^31, and predict clamps it */

static int is_in_world(const int32_t *at) { return vec_is_within(vec_of(at), FX_WORLD_MAX); }

static int body_sizes_good(const rigid_body *k) {
  const int32_t size_max = 16 * FX_LU;
  if (k->radius < 0 || k->radius > size_max) return 0;
  for (uint32_t n = 0; n < 3; ++n)
    if (k->half[n] < 0 || k->half[n] > size_max || k->aabb_half[n] < 0 ||
        k->aabb_half[n] > 4 * size_max - 1)
      return 0;
  return 1;
}

static int body_good(const fray_world *w, const rigid_body *k) {
  const int32_t keys = (int32_t)w->capacity[POOL_KEYS];
  if (k->shape < FRAY_ANCHOR || k->shape >= SHAPES_END || k->motion < FRAY_FIXED ||
      k->motion > FRAY_FREE || k->hand < 0 || k->hand >= FRAY_HANDS)
    return 0;
  if (k->friction < 0 || k->friction > 16 << 16 || k->mass_ratio < 0 || k->mass_ratio > 1 << 30) return 0;
  if (k->mass_ratio != 0 && k->motion != FRAY_FREE) return 0;
  if (k->motion == FRAY_HAND && (w->params->hands >> k->hand & 1) == 0) return 0;
  if (k->keyframes < 0 || k->keyframes > keys || k->keyframe_first < 0 ||
      k->keyframe_first > keys - k->keyframes)
    return 0;
  if (k->keyframes == 0 && k->motion == FRAY_PATH) return 0;
  return body_sizes_good(k) && is_in_world(k->start) && orthonormal(k->axes);
}

static int keys_good(const fray_world *w, const rigid_body *k) {
  for (int32_t n = 0; n < k->keyframes; ++n) {
    const keyframe *key = &w->rigid.keyframes[k->keyframe_first + n];
    if (key->tick < 0 || !is_in_world(key->position)) return 0;
    if (n > 0 && key->tick <= w->rigid.keyframes[k->keyframe_first + n - 1].tick) return 0;
  }
  return 1;
}

static int bodies_good(const fray_world *w, fray_error *error) {
  int32_t hands = 0;
  if (world_has_handles(w) && !handles_validate(w, &hands, error)) return 0;
  for (uint32_t b = 0; b < w->capacity[POOL_BODIES]; ++b) {
    const body_state *s = &w->rigid.states[b];
    if (!body_good(w, &w->rigid.bodies[b])) return image_bad(error, IN_BODIES, b, "a body in its ranges");
    if (!keys_good(w, &w->rigid.bodies[b])) return image_bad(error, IN_KEYS, b, "keys with rising ticks");
    if (w->rigid.bodies[b].motion == FRAY_HAND) {
      const int32_t hand = 1 << w->rigid.bodies[b].hand;
      if ((hands & hand) != 0) return image_bad(error, IN_BODIES, b, "one body a hand");
      hands |= hand;
    }
    int good = is_in_world(s->position);
    for (uint32_t n = 0; n < 3; ++n)
      good = good && s->remainder[n] >= -8 && s->remainder[n] <= 8 && s->fraction[n] >= 0 &&
             s->fraction[n] < 1 << 30 && s->velocity[n] > INT32_MIN;
    if (!good) return image_bad(error, IN_BODY_STATES, b, "a body's state in its ranges");
  }
  if (hands != w->params->hands) return image_bad(error, IN_PARAMS, 0, "hands as the bodies have them");
  return 1;
}

static int rigid_meshes_good(const fray_world *w, fray_error *error) {
  for (uint32_t b = 0; b < w->capacity[POOL_BODIES] && !world_has_rigid_meshes(w); ++b)
    if (body_is_mesh(&w->rigid.bodies[b]))
      return image_bad(error, IN_BODIES, b, "no body that is a mesh where there are none");
  if (!world_has_rigid_meshes(w)) return 1;
  const char *wrong = rigid_mesh_error(w);
  return wrong == NULL || image_bad(error, IN_MESHES, 0, wrong);
}

static int yarn_collision_good(const fray_world *w, fray_error *error) {
  return image_words_in_range(w->self.constants, self_params_ranges, SELF_PARAM_WORDS, IN_SELVES, error) &&
         (!world_has_membrane(w) || image_bad(error, IN_SELVES, 0, "woven cloth"));
}

static int triangle_collision_good(const fray_world *w, fray_error *error) {
  return image_words_in_range(w->self.constants, self_params_ranges, SELF_PARAM_WORDS, IN_LAYERS, error) &&
         (world_has_membrane(w) || image_bad(error, IN_LAYERS, 0, "a membrane"));
}

/* And says which meshes are sharp. */
static int blades_good(fray_world *w, fray_error *error) {
  if (!world_has_membrane(w) || !world_has_rigid_meshes(w))
    return image_bad(error, IN_BLADES, 0, "blades where there are triangles and meshes only");
  if (w->membrane.blades->tears_max < 1 || w->membrane.blades->tears_max > MAX_BREAKS)
    return image_bad(error, IN_BLADES, 0, "1 to 64 cuts in a tick");
  for (uint32_t n = 0; n < BLADE_CLOTHS; ++n)
    if (w->membrane.blades->speed[n] < BLADE_NEVER || w->membrane.blades->speed[n] > BLADE_SPEED_MAX)
      return image_bad(error, IN_BLADES, 1 + n, "a speed of 0 to 60 lu a tick, or -1");
  w->rigid.sharp_meshes = 0;
  for (uint32_t n = 0; n < rigid_mesh_count(w); ++n)
    if (rigid_mesh_is_sharp(w, n)) w->rigid.sharp_meshes |= 1u << n;
  return 1;
}

static int particles_good(const fray_world *w, fray_error *error) {
  for (uint32_t p = 0; p < w->capacity[POOL_PARTICLES]; ++p) {
    const int32_t at[3] = {w->p.x[p], w->p.y[p], w->p.z[p]};
    for (uint32_t n = 0; n < 3; ++n)
      if (at[n] < -FX_EDGE_MAX || at[n] > FX_EDGE_MAX)
        return image_bad(error, IN_X + n, p, "a position within 62 lu");
    const int32_t speed[3] = {w->p.vx[p], w->p.vy[p], w->p.vz[p]};
    for (uint32_t n = 0; n < 3; ++n)
      if (speed[n] < -FX_SPEED_MAX || speed[n] > FX_SPEED_MAX)
        return image_bad(error, IN_VX + n, p, "a velocity within 4 lu per substep");
    if (w->p.rx[p] < -8 || w->p.rx[p] > 8 || w->p.ry[p] < -8 || w->p.ry[p] > 8 || w->p.rz[p] < -8 ||
        w->p.rz[p] > 8)
      return image_bad(error, IN_RX, p, "a remainder of -8 to 8");
  }
  for (uint32_t p = 0; p < particles_attached(w); ++p) {
    if (w->p.attach_body[p] >= (uint32_t)w->params->bodies)
      return image_bad(error, IN_GRIP_BODY, p, "a body that exists");
    const int32_t grip[3] = {w->p.attach_x[p], w->p.attach_y[p], w->p.attach_z[p]};
    for (uint32_t n = 0; n < 3; ++n)
      if (grip[n] < -GRIP_MAX || grip[n] > GRIP_MAX)
        return image_bad(error, IN_GRIP_X + n, p, "a place within 60 lu of the body");
  }
  return 1;
}

/* Every crossing has a particle of its own; `seen` is scratch. */
static int crossings_good(const fray_world *w, fray_error *error) {
  const uint32_t particles = (uint32_t)w->params->particles;
  int32_t *seen = w->p.seen;
  for (uint32_t n = 0; n < w->capacity[POOL_PARTICLES]; ++n) seen[n] = 0;
  for (uint32_t n = 0; n < w->capacity[POOL_CROSSINGS]; ++n)
    if (w->woven.crossing_particle[n] >= particles || seen[w->woven.crossing_particle[n]]++ != 0)
      return image_bad(error, IN_CROSSING, n, "a particle in use, each once");
  return 1;
}

/* A row is its canonical row: of the same family, between the particles of the same crossings. */
static int spring_is_canonical(const fray_world *w, uint32_t row) {
  uint32_t i;
  uint32_t j;
  if (world_has_yarns(w)) {
    crossing_spring_ends(w, row, &i, &j);
  } else {
    uint32_t a;
    uint32_t b;
    yarn_grid_ends(world_yarn_grid(w), w->woven.canonical_id[row], &a, &b);
    i = w->woven.crossing_particle[a];
    j = w->woven.crossing_particle[b];
  }
  return (w->woven.spring_i[row] == i && w->woven.spring_j[row] == j) ||
         (w->woven.spring_i[row] == j && w->woven.spring_j[row] == i);
}

static uint32_t family_of(const fray_world *w, uint32_t row) {
  const uint32_t links = (uint32_t)w->params->links;
  return row < links ? 0u : (row < links + (uint32_t)w->params->bends ? 1u : 2u);
}

static int ids_good(const fray_world *w, fray_error *error) {
  const uint32_t particles = w->p.count;
  const uint32_t rows = w->capacity[POOL_SPRINGS];
  const uint32_t links = (uint32_t)w->params->links;
  const uint32_t link_classes = world_has_shear_lock(w) ? CLASS_LOCK : w->capacity[POOL_LINK_CLASSES];
  for (uint32_t row = 0; row < rows; ++row) {
    const uint32_t classes = row < links ? link_classes : w->capacity[POOL_BEND_SHEAR_CLASSES];
    if (w->woven.spring_i[row] >= particles || w->woven.spring_j[row] >= particles ||
        w->woven.spring_i[row] == w->woven.spring_j[row])
      return image_bad(error, IN_ROW_I, row, "two different particles in use");
    if (!world_has_yarns(w) && w->woven.spring_kind[row] != SPRING_DEAD &&
        w->woven.spring_kind[row] >= classes)
      return image_bad(error, IN_CLASS, row, "a class that exists");
    if (w->woven.canonical_id[row] >= rows || w->woven.spring_of[w->woven.canonical_id[row]] != row)
      return image_bad(error, IN_HOME, row, "a canonical spring, each once");
  }
  return 1;
}

/* Rows of a batch share no particle (but for attached ones, which no spring moves), and ends are held as
 * the batch says. `seen` holds the last batch that used a particle. */
static int batch_good(const fray_world *w, uint32_t b, int32_t *seen) {
  const spring_batch *batch = &w->woven.batches[b];
  const uint32_t held = particles_attached(w);
  const uint32_t first = (uint32_t)batch->first;
  for (uint32_t row = first; row < first + (uint32_t)batch->count; ++row) {
    const uint32_t ends[2] = {w->woven.spring_i[row], w->woven.spring_j[row]};
    const int32_t kind = (ends[0] < held) + (ends[1] < held);
    if (kind != batch->attached || (kind == BATCH_ATTACHED && ends[0] >= held)) return 0;
    for (uint32_t n = 0; n < 2; ++n) {
      if (ends[n] < held) continue;
      if (seen[ends[n]] == (int32_t)b) return 0;
      seen[ends[n]] = (int32_t)b;
    }
  }
  return 1;
}

static int batches_good(const fray_world *w, fray_error *error) {
  const params *p = w->params;
  const uint32_t ends[3] = {(uint32_t)p->links, (uint32_t)(p->links + p->bends),
                            w->capacity[POOL_SPRINGS]};
  const uint32_t batches[3] = {(uint32_t)p->link_batches, (uint32_t)p->bend_batches,
                               w->capacity[POOL_BATCHES] -
                                   (uint32_t)(p->link_batches + p->bend_batches)};
  int32_t *seen = w->p.seen;
  for (uint32_t n = 0; n < w->capacity[POOL_PARTICLES]; ++n) seen[n] = -1;
  uint32_t row = 0;
  uint32_t b = 0;
  for (uint32_t family = 0; family < 3; ++family) {
    const uint32_t last = b + batches[family];
    for (; b < last; ++b) {
      const spring_batch *batch = &w->woven.batches[b];
      if (batch->first != (int32_t)row || batch->count < 0 ||
          (uint32_t)batch->count > ends[family] - row)
        return bad_batch(error, b, "batches without gaps or overlap");
      if (!batch_good(w, b, seen))
        return bad_batch(error, b, "springs that share no particle, attached as the batch says");
      row += (uint32_t)batch->count;
    }
    if (row != ends[family])
      return bad_batch(error, b, "batches that cover their family");
  }
  return 1;
}

static int canonical_ids_good(const fray_world *w, fray_error *error) {
  for (uint32_t row = 0; row < w->capacity[POOL_SPRINGS]; ++row)
    if (family_of(w, row) != family_of(w, w->woven.canonical_id[row]) || !spring_is_canonical(w, row))
      return image_bad(error, IN_HOME, row, "the canonical spring of its family and its crossings");
  return 1;
}

static int yarns_good(const fray_world *w, fray_error *error) {
  const params *p = w->params;
  const yarn_params *y = w->woven.yarn_constants;
  if (!image_words_in_range(y, yarn_params_ranges, YARN_PARAM_WORDS, IN_YARNS, error) ||
      !image_words_in_range(w->woven.yarn_counts, yarn_state_ranges, YARN_STATE_WORDS, IN_YARN_STATE, error))
    return 0;
  if ((uint32_t)p->particles != w->capacity[POOL_CROSSINGS])
    return image_bad(error, IN_YARNS, 0, "a particle for each crossing");
  if (w->capacity[POOL_LINK_CLASSES] <= CLASS_WARP ||
      w->capacity[POOL_BEND_SHEAR_CLASSES] <= CLASS_SHEAR_HALF)
    return image_bad(error, IN_SPRINGS, 0, "the classes of springs at split crossings");
  if (y->split_max < y->split_min || y->split_min >= p->tear_min ||
      (int64_t)y->split_max - y->split_min > (int64_t)p->tear_max - p->tear_min)
    return image_bad(error, IN_YARNS, 0, "strains of transition below those of tearing");
  return 1;
}

/* One crossing; `seen` marks the spare particles in use. */
static int crossing_good(const fray_world *w, uint32_t c, int32_t *seen) {
  const uint32_t byte = w->woven.crossing_state[c];
  const uint32_t warp = w->woven.warp_particle[c];
  const uint32_t left = crossing_state_at(w, c) == FRAY_LOOSE ? CROSSING_LEFT : 0;
  if ((byte & ~(uint32_t)(CROSSING_STATE | CROSSING_PENDING | left)) != 0 ||
      w->woven.crossing_of[w->woven.crossing_particle[c]] != c)
    return 0;
  if ((byte & CROSSING_PENDING) != 0 &&
      (crossing_is_attached(w, c) ||
       (crossing_state_at(w, c) != FRAY_WHOLE && crossing_state_at(w, c) != FRAY_CONNECTED)))
    return 0;
  if (crossing_state_at(w, c) == FRAY_WHOLE) return warp == w->woven.crossing_particle[c];
  if (crossing_is_attached(w, c) ||
      (crossing_state_at(w, c) == FRAY_CONNECTED && w->woven.yarn_constants->all_yarn == 0))
    return 0;
  return warp >= (uint32_t)w->params->particles && warp < w->p.count && seen[warp]++ == 0 &&
         w->woven.crossing_of[warp] == c;
}

static int split_crossings_good(const fray_world *w, fray_error *error) {
  int32_t counts[4] = {0, 0, 0, 0};
  int32_t wanted = 0;
  int32_t *seen = w->p.seen;
  const yarn_state *s = w->woven.yarn_counts;
  for (uint32_t p = 0; p < w->capacity[POOL_PARTICLES]; ++p) {
    seen[p] = 0;
    if (w->woven.crossing_of[p] >= w->capacity[POOL_CROSSINGS] ||
        (p >= w->p.count && w->woven.crossing_of[p] != 0))
      return image_bad(error, IN_PLACE, p, "a crossing, 0 for a spare particle that is not in use");
  }
  for (uint32_t c = 0; c < w->capacity[POOL_CROSSINGS]; ++c) {
    if (!crossing_good(w, c, seen)) return image_bad(error, IN_COUPLE, c, "a crossing and its particles");
    ++counts[crossing_state_at(w, c)];
    wanted += (w->woven.crossing_state[c] & CROSSING_PENDING) != 0;
  }
  if (counts[FRAY_CONNECTED] != s->connected || counts[FRAY_LOOSE] != s->loose ||
      counts[FRAY_DISCONNECTED] != s->disconnected || wanted != s->pending ||
      s->connected + s->loose + s->disconnected != s->split)
    return image_bad(error, IN_YARN_STATE, 0, "counts of the crossings by state");
  return 1;
}

/* Rows have the kind that their ends call for, and a diagonal has its shadow iff an end has split. */
static int kinds_good(const fray_world *w, fray_error *error) {
  const uint32_t shears = (uint32_t)w->params->shears;
  for (uint32_t row = 0; row < w->capacity[POOL_SPRINGS]; ++row) {
    const uint32_t kind = w->woven.spring_kind[row];
    if (kind == SPRING_DEAD) continue;
    if (w->woven.spring_kind[row] != crossing_spring_kind(w, row))
      return image_bad(error, IN_CLASS, row, "the kind that its ends call for");
    if ((kind & SPRING_CLASS) != CLASS_SHEAR_HALF ||
        w->woven.canonical_id[row] < yarn_grid_springs(world_yarn_grid(w)))
      continue;
    if ((kind & SPRING_HALF_MASS) == 0 ||
        w->woven.spring_kind[w->woven.spring_of[w->woven.canonical_id[row] - shears]] == SPRING_DEAD)
      return image_bad(error, IN_CLASS, row, "the second spring of a living diagonal with a split end");
  }
  return 1;
}

static int topology_good(const fray_world *w, fray_error *error) {
  const int good = state_pair(w->state->topology) == world_topology(w);
  return good || image_bad(error, IN_STATE, 2, "the hash of the topology");
}

static int hash_good(const fray_world *w, fray_error *error) {
  return fray_hash(w) == state_hash(w) || image_bad(error, IN_STATE, 6, "the hash of the state");
}

fray_status image_validate(fray_world *w, fray_error *error) {
  fray_error found = {FRAY_BAD_FIELD, 0, 0, ""};
  const int good =
      image_words_in_range(w->params, params_ranges, PARAM_WORDS, IN_PARAMS, &found) &&
      image_words_in_range(w->state, state_ranges, STATE_WORDS, IN_STATE, &found) && counts_fit(w, &found) &&
      (!world_has_yarns(w) || yarns_good(w, &found)) &&
      (!world_has_membrane(w) || trimesh_validate(w, &found)) && link_classes_good(w, &found) &&
      (!world_has_elastic_yarns(w) || elastic_yarns_good(w, &found)) && spring_classes_good(w, &found) &&
      bodies_good(w, &found) && rigid_meshes_good(w, &found) &&
      (!world_has_yarn_collision(w) || yarn_collision_good(w, &found)) &&
      (!world_has_triangle_collision(w) || triangle_collision_good(w, &found)) &&
      (!world_has_blades(w) || blades_good(w, &found)) && particles_good(w, &found) &&
      crossings_good(w, &found) && (!world_has_yarns(w) || split_crossings_good(w, &found)) &&
      ids_good(w, &found) && batches_good(w, &found) && canonical_ids_good(w, &found) &&
      (!world_has_yarns(w) || (kinds_good(w, &found) && yarn_contacts_validate(w, &found))) &&
      topology_good(w, &found) && hash_good(w, &found);
  if (good) return FRAY_OK;
  if (error != NULL) *error = found;
  return found.status;
}
