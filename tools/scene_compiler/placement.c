/* SPDX-License-Identifier: Apache-2.0 */
/* Places at tick 0: bodies with their axes, crossings with their pleats, and the body to which each crossing
 * is attached. */
#include "rt/contact/shape.h"
#include "tools/scene_compiler/draft.h"

/* By 2 atan(t) about one axis. */
int draft_turn(const draft *d, uint32_t block, const char *key, const scene_rotation *by, int32_t axes[9]) {
  const exact one = exact_make(1, 1);
  for (uint32_t n = 0; n < 9; ++n) axes[n] = n % 4 == 0 ? 1 << 30 : 0;
  if (by->axis < 0) return 1;
  const exact t = by->half_tangent;
  const exact t2 = exact_mul(t, t);
  const exact whole = exact_add(one, t2);
  int64_t c;
  int64_t s;
  if (!exact_to_fixed(exact_div(exact_sub(one, t2), whole), 30, &c) ||
      !exact_to_fixed(exact_div(exact_add(t, t), whole), 30, &s))
    return draft_expected(d, block, key, "an angle of fewer digits");
  const uint32_t u = (uint32_t)(by->axis + 1) % 3u;
  const uint32_t v = (uint32_t)(by->axis + 2) % 3u;
  axes[3 * u + u] = (int32_t)c;
  axes[3 * u + v] = (int32_t)s;
  axes[3 * v + u] = (int32_t)-s;
  axes[3 * v + v] = (int32_t)c;
  return 1;
}

/* An extent of `parts` half sizes. */
static int half_size(const draft *d, uint32_t body, const char *key, exact extent, int parts, int32_t *half) {
  const exact lu = exact_mul(exact_div(extent, exact_make(parts, 1)), d->lu_per_cm);
  char most[SOURCE_VALUE];
  int64_t fixed;
  if (exact_to_fixed(lu, FX_POSITION_BITS, &fixed) && fixed <= 16 * FX_LU) {
    *half = (int32_t)fixed;
    return 1;
  }
  return draft_expected(d, BLOCK_BODY + body, key, "at most %s with cloth as fine as this",
                        draft_value(d, BLOCK_BODY + body, key, UNIT_LENGTH,
                                    exact_div(exact_make(16 * (int64_t)parts, 1), d->lu_per_cm), -1, most));
}

static int size_body(draft *d, const scene_body *b, rigid_body *k) {
  const uint32_t body = (uint32_t)(k - d->body);
  const char *size = b->shape == FRAY_CAPSULE ? "length" : "size";
  if (!half_size(d, body, "radius", b->radius, 1, &k->radius)) return 0;
  for (uint32_t n = 0; n < 3; ++n)
    if (!half_size(d, body, size, b->size[n], 2, &k->half[n])) return 0;
  if (body_is_mesh(k)) return draft_rigid_mesh_load(d, body);
  for (uint32_t n = 0; n < 3; ++n) {
    int64_t reach = k->radius;
    for (uint32_t a = 0; a < 3; ++a)
      reach += fx_round64((int64_t)fx_magnitude(k->axes[3 * a + n]) * k->half[a], 30);
    k->aabb_half[n] = (int32_t)reach;
  }
  return 1;
}

static int place_start(const draft *d, uint32_t n, vec3 *start) {
  const scene_body *b = &d->scene->bodies[n];
  if (b->motion == FRAY_PATH) return draft_keyframe(d, BLOCK_BODY + n, &d->scene->keys[b->key_first], start);
  return draft_position(d, BLOCK_BODY + n, b->at, start);
}

static int draft_body(draft *d, uint32_t n) {
  const scene_body *b = &d->scene->bodies[n];
  rigid_body *k = &d->body[n];
  char least[SOURCE_VALUE];
  vec3 start;
  int64_t fixed;
  k->shape = (int32_t)b->shape;
  k->motion = (int32_t)b->motion;
  k->hand = (int32_t)b->hand;
  k->keyframe_first = (int32_t)b->key_first;
  k->keyframes = (int32_t)b->keys;
  if (!place_start(d, n, &start) || !draft_turn(d, BLOCK_BODY + n, "rotate", &b->rotation, k->axes) ||
      !size_body(d, b, k))
    return 0;
  k->start[0] = start.x;
  k->start[1] = start.y;
  k->start[2] = start.z;
  if (!exact_to_fixed(b->friction, 16, &fixed) || fixed < 0 || fixed > 16 << 16)
    return draft_expected(d, BLOCK_BODY + n, "friction", "a number of fewer digits");
  k->friction = (int32_t)fixed;
  if (b->is_handle && !d->scene->membrane.present)
    return draft_expected(d, BLOCK_BODY + n, "mass", "a membrane where a hand moves a body with mass");
  if (b->motion == FRAY_FREE) {
    if (!exact_to_fixed(exact_div(d->particle_mass, b->mass), 30, &fixed) || fixed > 1 << 30)
      return draft_expected(d, BLOCK_BODY + n, "mass", "at least %s, the mass of one %s",
                            draft_value(d, BLOCK_BODY + n, "mass", UNIT_MASS, d->particle_mass, 1, least),
                            d->scene->membrane.present ? "vertex" : "crossing");
    k->mass_ratio = (int32_t)fixed;
  }
  return 1;
}

int draft_place_bodies(draft *d) {
  for (uint32_t n = 0; n < d->scene->body_count; ++n)
    if (!draft_body(d, n)) return 0;
  d->bodies = d->scene->body_count;
  if (d->scene->pin_count != 0) {
    if (d->bodies == MAX_BODIES)
      return draft_refuse(d, d->scene->pins[0].place,
                          "found a pin beside %d bodies, expected at most %d beside pins", MAX_BODIES,
                          MAX_BODIES - 1);
    for (uint32_t n = 0; n < 9; n += 4) d->body[d->bodies].axes[n] = 1 << 30;
    ++d->bodies;
  }
  return 1;
}

/* Along the weft, from the middle outwards, folded such that every piece keeps its length. With an even
 * number of warps the middle piece is flat, so that the cloth is symmetric. */
static int fold_offsets(const draft *d, uint32_t steps_out, int64_t *along, int64_t *up) {
  const scene *s = d->scene;
  const exact cosine = exact_sub(exact_make(1, 1), s->woven.gather);
  const int even = d->grid.warps % 2 == 0;
  const exact flat = exact_mul(s->woven.warp_spacing, exact_make(even, 2));
  const uint32_t pieces = (d->grid.warps - 1) / (2 * s->woven.pleats);
  const uint32_t fold = pieces > 0 ? pieces : 1;
  int64_t cosine_q30;
  int32_t rises = 0;
  exact x = exact_mul(exact_mul(s->woven.warp_spacing, cosine), exact_make(steps_out, 1));
  x = exact_mul(exact_add(x, flat), d->lu_per_cm);
  if (!exact_to_fixed(x, FX_POSITION_BITS, along) || !exact_to_fixed(cosine, 30, &cosine_q30))
    return 0;
  const uint32_t sine =
      exact_sqrt(((uint64_t)1 << 60) - (uint64_t)(cosine_q30 * cosine_q30));
  for (uint32_t n = 0; n < steps_out; ++n) rises += (n + fold / 2) / fold % 2 == 0 ? 1 : -1;
  *up = fx_round64((int64_t)rises * d->spacing[0] * (int64_t)sine, 30);
  return 1;
}

static int place_crossing(draft *d, uint32_t i, uint32_t j) {
  const scene *s = d->scene;
  const int32_t side = 2 * (int32_t)i - (int32_t)(d->grid.warps - 1); /* < 0 on the left */
  const uint32_t steps_out = fx_magnitude(side) / 2u;
  const int64_t down = 2 * (int64_t)j - (d->grid.wefts - 1);
  int64_t along;
  int64_t up;
  int64_t across;
  vec3 centre;
  const exact half = exact_mul(exact_mul(s->woven.weft_spacing, d->lu_per_cm), exact_make(1, 2));
  if (!fold_offsets(d, steps_out, &along, &up) ||
      !exact_to_fixed(exact_mul(half, exact_make(-down, 1)), FX_POSITION_BITS, &across) ||
      along > FX_WORLD_MAX || across > FX_WORLD_MAX || across < -FX_WORLD_MAX)
    return draft_outside(d);
  if (side < 0) along = -along;
  if (!draft_position(d, BLOCK_CLOTH, s->woven.at, &centre)) return 0;
  const int64_t x = centre.x + along;
  const int64_t y = centre.y + (s->woven.vertical ? across : up);
  const int64_t z = centre.z + (s->woven.vertical ? up : -across);
  const int64_t edge = FX_WORLD_MAX;
  if (x > edge || x < -edge || y > edge || y < -edge || z > edge || z < -edge)
    return draft_outside(d);
  d->place[j * d->grid.warps + i] = vec_make((int32_t)x, (int32_t)y, (int32_t)z);
  return 1;
}

/* Distance from a body's surface, Q24 lu, negative inside. */
static int64_t distance(const rigid_body *k, vec3 at) {
  const vec3 d = vec_sub(at, vec_make(k->start[0], k->start[1], k->start[2]));
  int32_t local[3];
  for (uint32_t n = 0; n < 3; ++n)
    local[n] = vec_dot_unit(d, vec_make(k->axes[3 * n], k->axes[3 * n + 1], k->axes[3 * n + 2]));
  if (k->shape == FRAY_PLANE) return local[1];
  uint64_t outside2 = 0;
  int64_t inside = INT64_MIN;
  for (uint32_t n = 0; n < 3; ++n) {
    const int64_t over = (int64_t)fx_magnitude(local[n]) - k->half[n];
    if (over > inside) inside = over;
    if (over > 0) outside2 += (uint64_t)(over * over);
  }
  const int64_t gap = outside2 > 0 ? (int64_t)exact_sqrt(outside2) : (inside < 0 ? inside : 0);
  return gap - k->radius;
}

static void attach_crossings(draft *d, const uint32_t *column, const uint32_t *row) {
  for (uint32_t n = 0; n < d->scene->body_count; ++n) {
    const scene_body *b = &d->scene->bodies[n];
    int64_t attach_within;
    if (!b->has_attach ||
        !exact_to_fixed(exact_mul(b->attach_within, d->lu_per_cm), FX_POSITION_BITS, &attach_within))
      continue;
    for (uint32_t c = 0; c < d->crossings; ++c)
      if (d->holder[c] == DRAFT_FREE && distance(&d->body[n], d->place[c]) <= attach_within)
        d->holder[c] = (uint8_t)n;
  }
  for (uint32_t n = 0; n < d->scene->pin_count; ++n) {
    const scene_pin *p = &d->scene->pins[n];
    const uint8_t by = (uint8_t)(p->by < SCENE_BODIES ? p->by : d->bodies - 1);
    for (uint32_t c = 0; c < d->crossings; ++c) {
      const uint32_t i = column != NULL ? column[c] : c % d->grid.warps;
      const uint32_t j = row != NULL ? row[c] : c / d->grid.warps;
      if (i >= p->i0 && i <= p->i1 && j >= p->j0 && j <= p->j1 && d->holder[c] == DRAFT_FREE)
        d->holder[c] = by;
    }
  }
}

/* How near the cloth is, or what a pin names that others hold. */
static int refuse_attachment(const draft *d, uint32_t n) {
  char away[SOURCE_VALUE];
  int64_t nearest = INT64_MAX;
  for (uint32_t c = 0; c < d->crossings; ++c) {
    const int64_t gap = distance(&d->body[n], d->place[c]);
    if (gap < nearest) nearest = gap;
  }
  if (source_find(&d->scene->source, BLOCK_BODY + n, "attach_within") == NULL)
    return draft_refuse(d, d->scene->source.block[BLOCK_BODY + n],
                        "found no cloth for '%s' to hold, expected a pin by it of what no other holds",
                        d->scene->bodies[n].name);
  draft_value(d, BLOCK_BODY + n, "attach_within", UNIT_LENGTH,
              exact_div(exact_make(nearest, FX_LU), d->lu_per_cm), 0, away);
  return draft_expected(d, BLOCK_BODY + n, "attach_within", "free cloth within it: the nearest is at %s",
                        away);
}

/* Many attached crossings would be unstable on a light body. */
static int check_loads(const draft *d) {
  for (uint32_t n = 0; n < d->scene->body_count; ++n) {
    const scene_body *b = &d->scene->bodies[n];
    char least[SOURCE_VALUE];
    uint32_t held = 0;
    for (uint32_t c = 0; c < d->crossings; ++c) held += d->holder[c] == n;
    if (b->has_attach && held == 0)
      return refuse_attachment(d, n);
    if (b->motion == FRAY_FREE &&
        exact_compare(b->mass, exact_mul(d->particle_mass, exact_make(8 * (int64_t)held, 1))) < 0)
      return draft_expected(d, BLOCK_BODY + n, "mass", "at least %s, 8 times that of the %u %s that it holds",
                            draft_value(d, BLOCK_BODY + n, "mass", UNIT_MASS,
                                        exact_mul(d->particle_mass, exact_make(8 * (int64_t)held, 1)), 1,
                                        least),
                            held, d->scene->membrane.present ? "vertices" : "crossings");
  }
  return 1;
}

static int refuse_inside(const draft *d, uint32_t n, uint32_t c, int64_t depth, const uint32_t *column) {
  const uint32_t block = BLOCK_BODY + n;
  const vec3 at = d->place[c];
  const exact lu = exact_mul(d->lu_per_cm, exact_make(FX_LU, 1));
  char deep[SOURCE_VALUE];
  char where[3][SOURCE_VALUE];
  draft_value(d, block, "at", UNIT_LENGTH, exact_div(exact_make(depth, 1), lu), 0, deep);
  const char *key = d->scene->bodies[n].motion == FRAY_PATH ? "move" : "at";
  if (column == NULL)
    return draft_expected(d, block, key,
                          "a place beside the cloth: at tick 0 warp %u, weft %u is %s inside of it",
                          c % d->grid.warps, c / d->grid.warps, deep);
  return draft_expected(
      d, block, key, "a place beside the cloth: at tick 0 its vertex at %s, %s, %s is %s inside of it",
      draft_value(d, block, "at", UNIT_LENGTH, exact_div(exact_make(at.x, 1), lu), 0, where[0]),
      draft_value(d, block, "at", UNIT_LENGTH, exact_div(exact_make(at.y, 1), lu), 0, where[1]),
      draft_value(d, block, "at", UNIT_LENGTH, exact_div(exact_make(at.z, 1), lu), 0, where[2]), deep);
}

/* Cloth that begins inside of a body would be thrown out of it in the first tick. */
static int check_inside(const draft *d, const uint32_t *column) {
  int64_t slack;
  if (!exact_to_fixed(exact_mul(d->scene->woven.thickness, d->lu_per_cm), FX_POSITION_BITS, &slack)) return 1;
  for (uint32_t n = 0; n < d->scene->body_count; ++n) {
    const vec3 start = vec_of(d->body[n].start);
    int64_t most = slack;
    uint32_t deepest = d->crossings;
    for (uint32_t c = 0; c < d->crossings && body_is_primitive(&d->body[n]); ++c) {
      vec3 normal;
      if (d->holder[c] != DRAFT_FREE) continue;
      const int32_t depth = shape_depth(&d->body[n], vec_sub(d->place[c], start), 0, &normal);
      if (depth <= most) continue;
      most = depth;
      deepest = c;
    }
    if (deepest < d->crossings) return refuse_inside(d, n, deepest, most, column);
  }
  return 1;
}

int draft_attach(draft *d, const uint32_t *column, const uint32_t *row) {
  for (uint32_t c = 0; c < d->crossings; ++c) d->holder[c] = DRAFT_FREE;
  attach_crossings(d, column, row);
  d->attached = 0;
  for (uint32_t c = 0; c < d->crossings; ++c) d->attached += d->holder[c] != DRAFT_FREE;
  return check_loads(d) && check_inside(d, column);
}

int draft_place_crossings(draft *d) {
  for (uint32_t j = 0; j < d->grid.wefts; ++j)
    for (uint32_t i = 0; i < d->grid.warps; ++i)
      if (!place_crossing(d, i, j)) return 0;
  return draft_attach(d, NULL, NULL);
}
