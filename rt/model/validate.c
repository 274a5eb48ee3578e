/* SPDX-License-Identifier: Apache-2.0 */
/* Every value of a loaded image is checked here, in time linear in the image, so that the stages
 * can rely on ranges, on ids that exist and on batches whose rows are independent. */
#include "rt/base/hash.h"
#include "rt/model/couples.h"
#include "rt/model/image.h"
#include "rt/model/mesh.h"

static const word_range params_ranges[PARAM_WORDS] = {
#define X(name, least, most) {least, most},
    PARAMS(X)
#undef X
};
static const word_range state_ranges[STATE_WORDS] = {
#define X(name, least, most) {least, most},
    STATE(X)
#undef X
};

static const word_range yarn_params_ranges[YARN_PARAM_WORDS] = {
#define X(name, least, most) {least, most},
    YARN_PARAMS(X)
#undef X
};
static const word_range yarn_state_ranges[YARN_STATE_WORDS] = {
#define X(name, least, most) {least, most},
    YARN_STATE(X)
#undef X
};

static const word_range stretch_params_ranges[STRETCH_PARAM_WORDS] = {
#define X(name, least, most) {least, most},
    STRETCH_PARAMS(X)
#undef X
};

static const word_range selves_params_ranges[SELVES_PARAM_WORDS] = {
#define X(name, least, most) {least, most},
    SELVES_PARAMS(X)
#undef X
};

/* Section ids, as in image_arrays. */
enum {
  IN_PARAMS = 1, IN_STATE, IN_LINKS, IN_SPRINGS, IN_BATCHES, IN_CROSSING, IN_HOME, IN_ROW_OF,
  IN_ROW_I, IN_ROW_J, IN_CLASS, IN_X, IN_Y, IN_Z, IN_VX, IN_RX = 18, IN_GRIP_BODY = 21, IN_GRIP_X,
  IN_BODIES = 25, IN_BODY_STATES, IN_KEYS, IN_YARNS, IN_YARN_STATE, IN_COUPLE, IN_WARP_AT, IN_PLACE,
  IN_STRETCH, IN_PULLS, IN_LIMITS,
  IN_SELVES = 49, IN_MESHES = 50, IN_BLADES, IN_LAYERS
};

static int bad(fray_error *error, uint32_t section, uint32_t index, const char *what) {
  (void)image_refuse(error, FRAY_BAD_FIELD, section, index, what);
  return 0;
}

static int bad_batch(fray_error *error, uint32_t batch, const char *what) {
  (void)image_refuse(error, FRAY_BAD_BATCH, IN_BATCHES, batch, what);
  return 0;
}

static int words_in_range(const void *table, const word_range *ranges, uint32_t count,
                          uint32_t section, fray_error *error) {
  const int32_t *words = (const int32_t *)table;
  for (uint32_t n = 0; n < count; ++n)
    if (words[n] < ranges[n].least || words[n] > ranges[n].most)
      return bad(error, section, n, "a word in its range, see model/params.h");
  return 1;
}

/* A triangle sheet has no crossings, rows or yarns. */
static int sheet_counts_fit(const fray_world *w) {
  const params *p = w->params;
  const uint32_t *have = w->capacity;
  return have[POOL_CROSSINGS] == 0 && have[POOL_ROWS] == 0 && have[POOL_BATCHES] == 0 &&
         have[POOL_SPLITS] == 0 && p->warps == 0 && p->wefts == 0 && p->links == 0 && p->bends == 0 &&
         p->shears == 0 && p->link_batches == 0 && p->bend_batches == 0 && p->shear_batches == 0;
}

static int counts_fit(const fray_world *w, fray_error *error) {
  const params *p = w->params;
  const weave grid = world_weave(w);
  const uint32_t crossings = grid.warps * grid.wefts;
  const uint32_t *have = w->capacity;
  /* every diagonal of a world with yarns has a shadow row, in batches of their own */
  const uint32_t twice = world_has_yarns(w) ? 2 : 1;
  const int woven =
      p->warps >= 2 && p->wefts >= 2 && crossings == have[POOL_CROSSINGS] &&
      (uint32_t)p->particles >= crossings && (uint32_t)p->links == weave_links(grid) &&
      (uint32_t)p->bends == weave_bends(grid) && (uint32_t)p->shears == weave_shears(grid) &&
      (uint32_t)p->links + (uint32_t)p->bends + twice * (uint32_t)p->shears == have[POOL_ROWS] &&
      (uint32_t)p->link_batches + (uint32_t)p->bend_batches + twice * (uint32_t)p->shear_batches ==
          have[POOL_BATCHES];
  const int fit =
      (world_has_sheet(w) ? sheet_counts_fit(w) : woven) &&
      (uint32_t)p->particles <= have[POOL_PARTICLES] && w->particles <= have[POOL_PARTICLES] &&
      (uint32_t)p->held == have[POOL_HELD] && p->held <= p->particles &&
      (uint32_t)p->bodies == have[POOL_BODIES] && (uint32_t)p->cuts_max == have[POOL_CUTS] &&
      have[POOL_LINK_CLASSES] >= 1 && have[POOL_SPRING_CLASSES] >= 1;
  if (!fit) return bad(error, IN_PARAMS, 0, "counts that agree with the header's capacities");
  if (p->tear_max < p->tear_min) return bad(error, IN_PARAMS, 0, "tear_max at least tear_min");
  if (p->held != 0 && p->bodies == 0) return bad(error, IN_PARAMS, 0, "a body that holds");
  return 1;
}

static int link_classes_good(const fray_world *w, fray_error *error) {
  for (uint32_t n = 1; n < w->capacity[POOL_LINK_CLASSES]; ++n) {
    const link_class *c = &w->links[n];
    const link_class expected = link_class_make(c->rest, c->push);
    if (c->rest < LINK_UNITS_MIN << LINK_SHIFT || c->rest > LINK_UNITS_MAX << LINK_SHIFT)
      return bad(error, IN_LINKS, n, "a rest length of 1024 to 8191 direction units");
    if (c->push < 0 || c->push > 4096)
      return bad(error, IN_LINKS, n, "a share of 0 to 4096");
    if (c->r2 != expected.r2 || c->n_max != expected.n_max || c->inverse != expected.inverse)
      return bad(error, IN_LINKS, n, "constants that follow from the rest length");
  }
  return 1;
}

static int spring_classes_good(const fray_world *w, fray_error *error) {
  for (uint32_t n = 1; n < w->capacity[POOL_SPRING_CLASSES]; ++n) {
    const spring_class *c = &w->springs[n];
    const int gain_good = c->mantissa == 0 || (c->mantissa >= 1 << 15 && c->mantissa < 1 << 16);
    if (c->rest < SPRING_REST_MIN || c->rest > SPRING_REST_MAX || !gain_good || c->shift < 17 || c->shift > 46 ||
        (c->compression_only | 1) != 1)
      return bad(error, IN_SPRINGS, n,
                 "a rest length of 2^-11 to 1/4 lu, a gain below 1/2, a flag of 0 or 1");
    const spring_class expected =
        spring_class_make(c->rest, c->mantissa, c->shift, c->compression_only);
    if (c->mantissa != expected.mantissa || c->down != expected.down || c->r2 != expected.r2 ||
        c->idle != expected.idle || c->inverse != expected.inverse || c->pull != expected.pull || c->scale != expected.scale)
      return bad(error, IN_SPRINGS, n, "constants that follow from the rest length and the gain");
  }
  return 1;
}

static int gain_good(int32_t mantissa, int32_t scale) {
  return (mantissa == 0 || (mantissa >= STRETCH_PULL_LEAST && mantissa - STRETCH_PULL_LEAST < STRETCH_PULL_LEAST)) &&
         scale >= STRETCH_SCALE_LEAST && scale <= STRETCH_SCALE_MOST;
}

static int stretch_good(const fray_world *w, fray_error *error) {
  if (!words_in_range(w->stretch, stretch_params_ranges, STRETCH_PARAM_WORDS, IN_STRETCH, error))
    return 0;
  if (w->capacity[POOL_STRETCH] != w->capacity[POOL_LINK_CLASSES])
    return bad(error, IN_PULLS, 0, "as many classes as links have");
  for (uint32_t n = 1; n < w->capacity[POOL_STRETCH]; ++n) {
    const stretch_class *c = &w->pulls[n];
    const link_class *limit = &w->limits[n];
    const link_class expected = link_class_make(limit->rest, 0);
    if (!gain_good(c->pull, c->pull_scale) || !gain_good(c->push, c->push_scale) || c->damping < 0 ||
        c->damping > STRETCH_DAMPING_MOST)
      return bad(error, IN_PULLS, n, "gains of 30 bits and a shift, a damping to 1");
    if (limit->rest < w->links[n].rest || limit->rest > w->links[n].rest / 4 * 5)
      return bad(error, IN_LIMITS, n, "a length of 1 to 5/4 of the rest length");
    if (limit->r2 != expected.r2 || limit->n_max != expected.n_max ||
        limit->inverse != expected.inverse || limit->push != 0)
      return bad(error, IN_LIMITS, n, "constants that follow from the length");
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

static int place_good(const int32_t *at) {
  for (uint32_t n = 0; n < 3; ++n)
    if (at[n] < -FX_WORLD_MAX || at[n] > FX_WORLD_MAX) return 0;
  return 1;
}

static int body_sizes_good(const body *k) {
  const int32_t size_max = 16 * FX_LU;
  if (k->radius < 0 || k->radius > size_max) return 0;
  for (uint32_t n = 0; n < 3; ++n)
    if (k->half[n] < 0 || k->half[n] > size_max || k->reach[n] < 0 ||
        k->reach[n] > 4 * size_max - 1)
      return 0;
  return 1;
}

static int body_good(const fray_world *w, const body *k) {
  const int32_t keys = (int32_t)w->capacity[POOL_KEYS];
  if (k->shape < FRAY_ANCHOR || k->shape > FRAY_MESH || k->motion < FRAY_FIXED ||
      k->motion > FRAY_FREE || k->hand < 0 || k->hand >= FRAY_HANDS)
    return 0;
  if (k->friction < 0 || k->friction > 16 << 16 || k->yield < 0 || k->yield > 1 << 30) return 0;
  if (k->yield != 0 && k->motion != FRAY_FREE) return 0;
  if (k->motion == FRAY_HAND && (w->params->hands >> k->hand & 1) == 0) return 0;
  if (k->keys < 0 || k->keys > keys || k->key_first < 0 || k->key_first > keys - k->keys) return 0;
  if (k->keys == 0 && k->motion == FRAY_PATH) return 0;
  return body_sizes_good(k) && place_good(k->home) && orthonormal(k->axes);
}

static int keys_good(const fray_world *w, const body *k) {
  for (int32_t n = 0; n < k->keys; ++n) {
    const body_key *key = &w->keys[k->key_first + n];
    if (key->tick < 0 || !place_good(key->position)) return 0;
    if (n > 0 && key->tick <= w->keys[k->key_first + n - 1].tick) return 0;
  }
  return 1;
}

static int bodies_good(const fray_world *w, fray_error *error) {
  int32_t hands = 0;
  for (uint32_t b = 0; b < w->capacity[POOL_BODIES]; ++b) {
    const body_state *s = &w->body_states[b];
    if (!body_good(w, &w->bodies[b])) return bad(error, IN_BODIES, b, "a body in its ranges");
    if (!keys_good(w, &w->bodies[b])) return bad(error, IN_KEYS, b, "keys with rising ticks");
    if (w->bodies[b].motion == FRAY_HAND) {
      if ((hands >> w->bodies[b].hand & 1) != 0) return bad(error, IN_BODIES, b, "one body a hand");
      hands |= 1 << w->bodies[b].hand;
    }
    int good = place_good(s->position);
    for (uint32_t n = 0; n < 3; ++n)
      good = good && s->remainder[n] >= -8 && s->remainder[n] <= 8 && s->fraction[n] >= 0 &&
             s->fraction[n] < 1 << 30 && s->velocity[n] > INT32_MIN;
    if (!good) return bad(error, IN_BODY_STATES, b, "a body's state in its ranges");
  }
  if (hands != w->params->hands) return bad(error, IN_PARAMS, 0, "hands as the bodies have them");
  return 1;
}

static int meshes_good(const fray_world *w, fray_error *error) {
  for (uint32_t b = 0; b < w->capacity[POOL_BODIES] && !world_has_meshes(w); ++b)
    if (w->bodies[b].shape == FRAY_MESH)
      return bad(error, IN_BODIES, b, "no body that is a mesh where there are none");
  if (!world_has_meshes(w)) return 1;
  const char *wrong = mesh_wrong(w);
  return wrong == NULL || bad(error, IN_MESHES, 0, wrong);
}

static int selves_good(const fray_world *w, fray_error *error) {
  if (!words_in_range(w->selves, selves_params_ranges, SELVES_PARAM_WORDS, IN_SELVES, error)) return 0;
  return !world_has_sheet(w) || bad(error, IN_SELVES, 0, "a woven sheet");
}

static int layers_good(const fray_world *w, fray_error *error) {
  if (!words_in_range(w->selves, selves_params_ranges, SELVES_PARAM_WORDS, IN_LAYERS, error)) return 0;
  return world_has_sheet(w) || bad(error, IN_LAYERS, 0, "a sheet of triangles");
}

/* And says which meshes are sharp. */
static int blades_good(fray_world *w, fray_error *error) {
  if (!world_has_sheet(w) || !world_has_meshes(w))
    return bad(error, IN_BLADES, 0, "blades where there are triangles and meshes only");
  if (w->blades->cuts_max < 1 || w->blades->cuts_max > LIMIT_CUTS)
    return bad(error, IN_BLADES, 0, "1 to 64 cuts in a tick");
  for (uint32_t n = 0; n < BLADE_CLOTHS; ++n)
    if (w->blades->speed[n] < BLADE_NEVER || w->blades->speed[n] > BLADE_SPEED_MAX)
      return bad(error, IN_BLADES, 1 + n, "a speed of 0 to 60 lu a tick, or -1");
  w->sharp = 0;
  for (uint32_t n = 0; n < mesh_count(w); ++n)
    if (mesh_is_sharp(w, n)) w->sharp |= 1u << n;
  return 1;
}

static int particles_good(const fray_world *w, fray_error *error) {
  for (uint32_t p = 0; p < w->capacity[POOL_PARTICLES]; ++p) {
    const int32_t at[3] = {w->x[p], w->y[p], w->z[p]};
    /* predict and collide hold particles within 60 lu; projections may push past that, by far
     * less than 2 lu in a substep */
    for (uint32_t n = 0; n < 3; ++n)
      if (at[n] < -FX_WORLD_MAX - 2 * FX_LU || at[n] > FX_WORLD_MAX + 2 * FX_LU)
        return bad(error, IN_X + n, p, "a position within 62 lu");
    const int32_t speed[3] = {w->vx[p], w->vy[p], w->vz[p]};
    for (uint32_t n = 0; n < 3; ++n)
      if (speed[n] < -FX_SPEED_MAX || speed[n] > FX_SPEED_MAX)
        return bad(error, IN_VX + n, p, "a velocity within 4 lu per substep");
    if (w->rx[p] < -8 || w->rx[p] > 8 || w->ry[p] < -8 || w->ry[p] > 8 || w->rz[p] < -8 ||
        w->rz[p] > 8)
      return bad(error, IN_RX, p, "a remainder of -8 to 8");
  }
  for (uint32_t p = 0; p < (uint32_t)w->params->held; ++p) {
    if (w->grip_body[p] >= (uint32_t)w->params->bodies)
      return bad(error, IN_GRIP_BODY, p, "a body that exists");
    const int32_t grip[3] = {w->grip_x[p], w->grip_y[p], w->grip_z[p]};
    for (uint32_t n = 0; n < 3; ++n)
      if (grip[n] < -GRIP_MAX || grip[n] > GRIP_MAX)
        return bad(error, IN_GRIP_X + n, p, "a place within 60 lu of the body");
  }
  return 1;
}

/* Every crossing has a particle of its own; `seen` is scratch. */
static int crossings_good(const fray_world *w, fray_error *error) {
  const uint32_t particles = (uint32_t)w->params->particles;
  int32_t *seen = w->qx; /* not in use between ticks */
  for (uint32_t n = 0; n < w->capacity[POOL_PARTICLES]; ++n) seen[n] = 0;
  for (uint32_t n = 0; n < w->capacity[POOL_CROSSINGS]; ++n)
    if (w->crossing[n] >= particles || seen[w->crossing[n]]++ != 0)
      return bad(error, IN_CROSSING, n, "a particle in use, each once");
  return 1;
}

/* A row is its canonical row: of the same family, between the particles of the same crossings. */
static int row_is_at_home(const fray_world *w, uint32_t row) {
  uint32_t i;
  uint32_t j;
  if (world_has_yarns(w)) {
    couple_ends(w, row, &i, &j);
  } else {
    uint32_t a;
    uint32_t b;
    weave_ends(world_weave(w), w->home[row], &a, &b);
    i = w->crossing[a];
    j = w->crossing[b];
  }
  return (w->row_i[row] == i && w->row_j[row] == j) || (w->row_i[row] == j && w->row_j[row] == i);
}

static uint32_t family_of(const fray_world *w, uint32_t row) {
  const uint32_t links = (uint32_t)w->params->links;
  return row < links ? 0u : (row < links + (uint32_t)w->params->bends ? 1u : 2u);
}

static int ids_good(const fray_world *w, fray_error *error) {
  const uint32_t particles = w->particles;
  const uint32_t rows = w->capacity[POOL_ROWS];
  const uint32_t links = (uint32_t)w->params->links;
  for (uint32_t row = 0; row < rows; ++row) {
    const uint32_t classes =
        row < links ? w->capacity[POOL_LINK_CLASSES] : w->capacity[POOL_SPRING_CLASSES];
    if (w->row_i[row] >= particles || w->row_j[row] >= particles || w->row_i[row] == w->row_j[row])
      return bad(error, IN_ROW_I, row, "two different particles in use");
    if (!world_has_yarns(w) && w->row_class[row] != ROW_DEAD && w->row_class[row] >= classes)
      return bad(error, IN_CLASS, row, "a class that exists");
    if (w->home[row] >= rows || w->row_of[w->home[row]] != row)
      return bad(error, IN_HOME, row, "a canonical row, each once");
  }
  return 1;
}

/* Rows of a batch share no particle (but for held ones, which nobody moves), and ends are held as
 * the batch says. `seen` holds the last batch that used a particle. */
static int batch_good(const fray_world *w, uint32_t b, int32_t *seen) {
  const row_batch *batch = &w->batches[b];
  const uint32_t held = (uint32_t)w->params->held;
  const uint32_t first = (uint32_t)batch->first;
  for (uint32_t row = first; row < first + (uint32_t)batch->count; ++row) {
    const uint32_t ends[2] = {w->row_i[row], w->row_j[row]};
    const int32_t kind = (ends[0] < held) + (ends[1] < held);
    if (kind != batch->held || (kind == BATCH_HELD && ends[0] >= held)) return 0;
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
                            w->capacity[POOL_ROWS]};
  const uint32_t batches[3] = {(uint32_t)p->link_batches, (uint32_t)p->bend_batches,
                               w->capacity[POOL_BATCHES] -
                                   (uint32_t)(p->link_batches + p->bend_batches)};
  int32_t *seen = w->qx; /* not in use between ticks */
  for (uint32_t n = 0; n < w->capacity[POOL_PARTICLES]; ++n) seen[n] = -1;
  uint32_t row = 0;
  uint32_t b = 0;
  for (uint32_t family = 0; family < 3; ++family) {
    const uint32_t last = b + batches[family];
    for (; b < last; ++b) {
      const row_batch *batch = &w->batches[b];
      if (batch->first != (int32_t)row || batch->count < 0 ||
          (uint32_t)batch->count > ends[family] - row)
        return bad_batch(error, b, "batches without gaps or overlap");
      if (!batch_good(w, b, seen))
        return bad_batch(error, b, "rows that share no particle and are held as the batch says");
      row += (uint32_t)batch->count;
    }
    if (row != ends[family])
      return bad_batch(error, b, "batches that cover their family");
  }
  return 1;
}

static int homes_good(const fray_world *w, fray_error *error) {
  for (uint32_t row = 0; row < w->capacity[POOL_ROWS]; ++row)
    if (family_of(w, row) != family_of(w, w->home[row]) || !row_is_at_home(w, row))
      return bad(error, IN_HOME, row, "the canonical row of its family and its crossings");
  return 1;
}

static int yarns_good(const fray_world *w, fray_error *error) {
  const params *p = w->params;
  const yarn_params *y = w->yarns;
  if (!words_in_range(y, yarn_params_ranges, YARN_PARAM_WORDS, IN_YARNS, error) ||
      !words_in_range(w->yarn_state, yarn_state_ranges, YARN_STATE_WORDS, IN_YARN_STATE, error))
    return 0;
  if ((uint32_t)p->particles != w->capacity[POOL_CROSSINGS])
    return bad(error, IN_YARNS, 0, "a particle for each crossing");
  if (w->capacity[POOL_LINK_CLASSES] <= CLASS_LINKS ||
      w->capacity[POOL_SPRING_CLASSES] <= CLASS_SHEAR_HALF)
    return bad(error, IN_SPRINGS, 0, "the classes that split rows have");
  if (y->transition_max < y->transition_min || y->transition_min >= p->tear_min ||
      (int64_t)y->transition_max - y->transition_min > (int64_t)p->tear_max - p->tear_min)
    return bad(error, IN_YARNS, 0, "strains of transition below those of tearing");
  return 1;
}

/* One crossing; `seen` marks the spare particles in use. */
static int couple_good(const fray_world *w, uint32_t c, int32_t *seen) {
  const uint32_t byte = w->couple[c];
  const uint32_t warp = w->warp_at[c];
  if ((byte & ~(uint32_t)(COUPLE_STATE | COUPLE_WANTED)) != 0 || w->place[w->crossing[c]] != c)
    return 0;
  if ((byte & COUPLE_WANTED) != 0 &&
      (couple_is_held(w, c) || (couple_at(w, c) != FRAY_WHOLE && couple_at(w, c) != FRAY_CONNECTED)))
    return 0;
  if (couple_at(w, c) == FRAY_WHOLE) return warp == w->crossing[c];
  if (couple_is_held(w, c) || (couple_at(w, c) == FRAY_CONNECTED && w->yarns->all_yarn == 0))
    return 0;
  return warp >= (uint32_t)w->params->particles && warp < w->particles && seen[warp]++ == 0 &&
         w->place[warp] == c;
}

static int couples_good(const fray_world *w, fray_error *error) {
  int32_t counts[4] = {0, 0, 0, 0};
  int32_t wanted = 0;
  int32_t *seen = w->qx; /* not in use between ticks */
  const yarn_state *s = w->yarn_state;
  for (uint32_t p = 0; p < w->capacity[POOL_PARTICLES]; ++p) {
    seen[p] = 0;
    if (w->place[p] >= w->capacity[POOL_CROSSINGS] || (p >= w->particles && w->place[p] != 0))
      return bad(error, IN_PLACE, p, "a crossing, 0 for a spare particle that is not in use");
  }
  for (uint32_t c = 0; c < w->capacity[POOL_CROSSINGS]; ++c) {
    if (!couple_good(w, c, seen)) return bad(error, IN_COUPLE, c, "a couple and its particles");
    ++counts[couple_at(w, c)];
    wanted += (w->couple[c] & COUPLE_WANTED) != 0;
  }
  if (counts[FRAY_CONNECTED] != s->connected || counts[FRAY_LOOSE] != s->loose ||
      counts[FRAY_DISCONNECTED] != s->disconnected || wanted != s->wanted ||
      s->connected + s->loose + s->disconnected != s->split)
    return bad(error, IN_YARN_STATE, 0, "counts of the couples");
  return 1;
}

/* Rows have the kind that their ends call for, and a diagonal has its shadow iff an end has split. */
static int kinds_good(const fray_world *w, fray_error *error) {
  const uint32_t shears = (uint32_t)w->params->shears;
  for (uint32_t row = 0; row < w->capacity[POOL_ROWS]; ++row) {
    const uint32_t kind = w->row_class[row];
    if (kind == ROW_DEAD) continue;
    if (w->row_class[row] != couple_kind(w, row))
      return bad(error, IN_CLASS, row, "the kind that its ends call for");
    if ((kind & ROW_CLASS) != CLASS_SHEAR_HALF || w->home[row] < weave_rows(world_weave(w))) continue;
    if ((kind & ROW_LIGHT) == 0 || w->row_class[w->row_of[w->home[row] - shears]] == ROW_DEAD)
      return bad(error, IN_CLASS, row, "a shadow of a living diagonal with a split end");
  }
  return 1;
}

static int topology_good(const fray_world *w, fray_error *error) {
  const uint64_t now = world_topology(w);
  if ((uint32_t)w->state->topology[0] != (uint32_t)(now & 0xFFFFFFFFu) ||
      (uint32_t)w->state->topology[1] != (uint32_t)(now >> 32))
    return bad(error, IN_STATE, 4, "the hash of the dead rows");
  return 1;
}

static int hash_good(const fray_world *w, fray_error *error) {
  const uint64_t now = world_hash(w);
  if ((uint32_t)w->state->hash[0] != (uint32_t)(now & 0xFFFFFFFFu) ||
      (uint32_t)w->state->hash[1] != (uint32_t)(now >> 32))
    return bad(error, IN_STATE, 6, "the hash of the state");
  return 1;
}

fray_status image_validate(fray_world *w, fray_error *error) {
  fray_error found = {FRAY_BAD_FIELD, 0, 0, ""};
  const int good =
      words_in_range(w->params, params_ranges, PARAM_WORDS, IN_PARAMS, &found) &&
      words_in_range(w->state, state_ranges, STATE_WORDS, IN_STATE, &found) &&
      counts_fit(w, &found) && (!world_has_yarns(w) || yarns_good(w, &found)) &&
      (!world_has_sheet(w) || sheet_valid(w, &found)) &&
      link_classes_good(w, &found) && (!world_has_stretch(w) || stretch_good(w, &found)) &&
      spring_classes_good(w, &found) && bodies_good(w, &found) && meshes_good(w, &found) &&
      (!world_has_selves(w) || selves_good(w, &found)) &&
      (!world_has_layers(w) || layers_good(w, &found)) && (!world_has_blades(w) || blades_good(w, &found)) &&
      particles_good(w, &found) && crossings_good(w, &found) &&
      (!world_has_yarns(w) || couples_good(w, &found)) && ids_good(w, &found) &&
      batches_good(w, &found) && homes_good(w, &found) &&
      (!world_has_yarns(w) || kinds_good(w, &found)) && topology_good(w, &found) &&
      hash_good(w, &found);
  if (good) return FRAY_OK;
  if (error != NULL) *error = found;
  return found.status;
}
