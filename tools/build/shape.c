/* SPDX-License-Identifier: Apache-2.0 */
/* Where things are at tick 0: bodies with their axes, crossings with their folds, and which body
 * holds which crossing. */
#include "tools/build/draft.h"

/* Rows of a turn by 2 atan(t) about one axis, Q30. */
static int turned_axes(const draft *d, const scene_body *b, int32_t axes[9]) {
  const exact one = exact_make(1, 1);
  for (uint32_t n = 0; n < 9; ++n) axes[n] = n % 4 == 0 ? 1 << 30 : 0;
  if (b->turn.axis < 0) return 1;
  const exact t = b->turn.half_tangent;
  const exact t2 = exact_mul(t, t);
  const exact whole = exact_add(one, t2);
  int64_t c;
  int64_t s;
  if (!exact_to_fixed(exact_div(exact_sub(one, t2), whole), 30, &c) ||
      !exact_to_fixed(exact_div(exact_add(t, t), whole), 30, &s))
    return draft_refuse(d, b->line, "turn: an angle that cannot be held");
  const uint32_t u = (uint32_t)(b->turn.axis + 1) % 3u;
  const uint32_t v = (uint32_t)(b->turn.axis + 2) % 3u;
  axes[3 * u + u] = (int32_t)c;
  axes[3 * u + v] = (int32_t)s;
  axes[3 * v + u] = (int32_t)-s;
  axes[3 * v + v] = (int32_t)c;
  return 1;
}

static int size_body(draft *d, const scene_body *b, body *k) {
  const exact half = exact_make(1, 2);
  if (b->shape == FRAY_BALL || b->shape == FRAY_BAR)
    if (!draft_length(d, b->line, b->radius, &k->radius)) return 0;
  for (uint32_t n = 0; n < (b->shape == FRAY_BOX ? 3u : (b->shape == FRAY_BAR ? 1u : 0u)); ++n)
    if (!draft_length(d, b->line, exact_mul(b->size[n], half), &k->half[n])) return 0;
  if (k->radius > 16 * FX_LU || k->half[0] > 16 * FX_LU || k->half[1] > 16 * FX_LU ||
      k->half[2] > 16 * FX_LU)
    return draft_refuse(d, b->line, "%s: expected half sizes of at most %u mm", b->name,
                        16u * d->lu_um / 1000u);
  if (b->shape == FRAY_MESH) return draft_mesh_of(d, (uint32_t)(k - d->body));
  for (uint32_t n = 0; n < 3; ++n) {
    int64_t reach = k->radius;
    for (uint32_t a = 0; a < 3; ++a)
      reach += fx_round64((int64_t)fx_magnitude(k->axes[3 * a + n]) * k->half[a], 30);
    k->reach[n] = (int32_t)reach;
  }
  return 1;
}

static int draft_body(draft *d, uint32_t n) {
  const scene_body *b = &d->scene->bodies[n];
  body *k = &d->body[n];
  vec3 home;
  int64_t fixed;
  k->shape = (int32_t)b->shape;
  k->motion = (int32_t)b->motion;
  k->hand = (int32_t)b->hand;
  k->key_first = (int32_t)b->key_first;
  k->keys = (int32_t)b->keys;
  if (!draft_place(d, b->line, b->at, &home) || !turned_axes(d, b, k->axes) || !size_body(d, b, k))
    return 0;
  k->home[0] = home.x;
  k->home[1] = home.y;
  k->home[2] = home.z;
  if (!exact_to_fixed(b->friction, 16, &fixed) || fixed < 0 || fixed > 16 << 16)
    return draft_refuse(d, b->line, "friction: expected 0 to 16");
  k->friction = (int32_t)fixed;
  if (b->motion == FRAY_FREE) {
    if (!exact_to_fixed(exact_div(d->particle_mass, b->mass), 30, &fixed) || fixed > 1 << 30)
      return draft_refuse(d, b->line, "mass: expected at least the mass of one crossing");
    k->yield = (int32_t)fixed;
  }
  return 1;
}

int draft_bodies(draft *d) {
  for (uint32_t n = 0; n < d->scene->body_count; ++n)
    if (!draft_body(d, n)) return 0;
  d->bodies = d->scene->body_count;
  if (d->scene->pin_count != 0) {
    if (d->bodies == LIMIT_BODIES)
      return draft_refuse(d, d->scene->pins[0].line, "pin: expected at most %d bodies beside pins",
                          LIMIT_BODIES - 1);
    for (uint32_t n = 0; n < 9; n += 4) d->body[d->bodies].axes[n] = 1 << 30;
    ++d->bodies;
  }
  return 1;
}

/* Along the weft: from the middle outwards, folded so that every piece keeps its length. With an
 * even count the middle piece lies flat, so that the sheet is its own mirror image. */
static int fold_offsets(const draft *d, uint32_t steps_out, int64_t *along, int64_t *up) {
  const scene *s = d->scene;
  const exact cosine = exact_sub(exact_make(1, 1), s->sheet.gather);
  const int even = d->grid.warps % 2 == 0;
  const exact flat = exact_mul(s->sheet.warp_spacing, exact_make(even, 2));
  const uint32_t pieces = (d->grid.warps - 1) / (2 * s->sheet.pleats);
  const uint32_t fold = pieces > 0 ? pieces : 1;
  int64_t cosine_q30;
  int32_t rises = 0;
  exact x = exact_mul(exact_mul(s->sheet.warp_spacing, cosine), exact_make(steps_out, 1));
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
  const exact half = exact_mul(exact_mul(s->sheet.weft_spacing, d->lu_per_cm), exact_make(1, 2));
  if (!fold_offsets(d, steps_out, &along, &up) ||
      !exact_to_fixed(exact_mul(half, exact_make(-down, 1)), FX_POSITION_BITS, &across) ||
      along > FX_WORLD_MAX || across > FX_WORLD_MAX || across < -FX_WORLD_MAX)
    return draft_refuse(d, s->sheet.line, "sheet: larger than the world");
  if (side < 0) along = -along;
  if (!draft_place(d, s->sheet.line, s->sheet.at, &centre)) return 0;
  const int64_t x = centre.x + along;
  const int64_t y = centre.y + (s->sheet.vertical ? across : up);
  const int64_t z = centre.z + (s->sheet.vertical ? up : -across);
  const int64_t edge = FX_WORLD_MAX;
  if (x > edge || x < -edge || y > edge || y < -edge || z > edge || z < -edge)
    return draft_refuse(d, s->sheet.line, "sheet: reaches outside of the world of %u mm",
                        120u * d->lu_um / 1000u);
  d->place[j * d->grid.warps + i] = vec_make((int32_t)x, (int32_t)y, (int32_t)z);
  return 1;
}

/* Distance from a body's surface, Q24 lu, negative inside. */
static int64_t distance(const body *k, vec3 at) {
  const vec3 d = vec_sub(at, vec_make(k->home[0], k->home[1], k->home[2]));
  int32_t local[3];
  for (uint32_t n = 0; n < 3; ++n)
    local[n] = vec_dot_unit(d, vec_make(k->axes[3 * n], k->axes[3 * n + 1], k->axes[3 * n + 2]));
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

static void grip_crossings(draft *d, const uint32_t *column, const uint32_t *row) {
  for (uint32_t n = 0; n < d->scene->body_count; ++n) {
    const scene_body *b = &d->scene->bodies[n];
    int64_t grip;
    if (!b->has_grip || !exact_to_fixed(exact_mul(b->grip, d->lu_per_cm), FX_POSITION_BITS, &grip))
      continue;
    for (uint32_t c = 0; c < d->crossings; ++c)
      if (d->holder[c] == DRAFT_FREE && distance(&d->body[n], d->place[c]) <= grip)
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

/* A light body that holds many crossings would be thrown about by them. */
static int check_loads(const draft *d) {
  for (uint32_t n = 0; n < d->scene->body_count; ++n) {
    const scene_body *b = &d->scene->bodies[n];
    uint32_t held = 0;
    for (uint32_t c = 0; c < d->crossings; ++c) held += d->holder[c] == n;
    if (b->has_grip && held == 0)
      return draft_refuse(d, b->line, "%s: grips no crossing; expected the sheet within its grip",
                          b->name);
    if (b->motion == FRAY_FREE &&
        exact_compare(b->mass, exact_mul(d->particle_mass, exact_make(8 * (int64_t)held, 1))) < 0)
      return draft_refuse(d, b->line,
                          "mass: expected at least 8 times the mass of the %u crossings it holds",
                          held);
  }
  return 1;
}

int draft_holders(draft *d, const uint32_t *column, const uint32_t *row) {
  for (uint32_t c = 0; c < d->crossings; ++c) d->holder[c] = DRAFT_FREE;
  grip_crossings(d, column, row);
  d->held = 0;
  for (uint32_t c = 0; c < d->crossings; ++c) d->held += d->holder[c] != DRAFT_FREE;
  return check_loads(d);
}

int draft_crossings(draft *d) {
  for (uint32_t j = 0; j < d->grid.wefts; ++j)
    for (uint32_t i = 0; i < d->grid.warps; ++i)
      if (!place_crossing(d, i, j)) return 0;
  return draft_holders(d, NULL, NULL);
}
