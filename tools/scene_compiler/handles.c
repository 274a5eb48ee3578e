/* SPDX-License-Identifier: Apache-2.0 */
/* Handles: constants of their springs and dampers for the elastic steps of the membrane, and where
 * their devices are in the scene. */
#include "tools/scene_compiler/draft.h"

enum { COUPLING_DAMPING_TICKS = 6 };

static const scene_body *handle_of(const draft *d, uint32_t h, uint32_t *body) {
  for (uint32_t n = 0; n < d->scene->body_count; ++n)
    if (d->scene->bodies[n].is_handle && d->scene->bodies[n].hand == h) {
      *body = n;
      return &d->scene->bodies[n];
    }
  return NULL;
}

int draft_has_handles(const draft *d) {
  uint32_t unused;
  return handle_of(d, 0, &unused) != NULL || handle_of(d, 1, &unused) != NULL;
}

/* k h^2 / M of an elastic step is at most a quarter: with the cloth beside it far from 4, where it
 * is unstable. */
static int check_stiffness(const draft *d, const scene_body *b, uint32_t block, exact step) {
  const exact most = exact_div(exact_div(exact_mul(b->mass, exact_make(1, 4)), step), step);
  char bound[SOURCE_VALUE];
  if (exact_compare(b->coupling, most) <= 0) return 1;
  return draft_expected(d, block, "coupling",
                        "at most %s with this mass and %u elastic steps a tick",
                        draft_value(d, block, "coupling", UNIT_STIFFNESS, most, -1, bound),
                        d->substeps * d->elastic_steps);
}

/* Of the spring k h' h / m, with steps h' of substeps h: what an extension gives in a step. Of the
 * damper the impulse that ends a step at 1 / (1 + b h' / M) of its speed: less than all, so it
 * never turns it round. */
static int couple(const draft *d, const scene_body *b, uint32_t block, handle_params *k) {
  const exact one = exact_make(1, 1);
  const exact substep = exact_make(1, (int64_t)d->scene->rate_hz * d->substeps);
  const exact step = exact_div(substep, exact_make(d->elastic_steps, 1));
  const exact spring =
      exact_div(exact_mul(exact_mul(b->coupling, step), substep), d->particle_mass);
  const exact damping = exact_compare(b->coupling_damping, exact_make(0, 1)) < 0
                            ? exact_make(COUPLING_DAMPING_TICKS, d->scene->rate_hz)
                            : b->coupling_damping;
  const exact drawn = exact_mul(exact_mul(b->coupling, damping), step); /* g */
  const exact share = exact_div(one, exact_add(one, exact_div(drawn, b->mass)));
  return check_stiffness(d, b, block, step) &&
         draft_fixed_point(d, draft_given(block, "coupling", UNIT_STIFFNESS, b->coupling), spring,
                           HANDLE_GAIN_BITS, 0, INT32_MAX, &k->spring) &&
         draft_fixed_point(d, draft_given(block, "coupling_damping", UNIT_TIME, damping),
                           exact_div(exact_mul(drawn, share), d->particle_mass), HANDLE_GAIN_BITS,
                           0, INT32_MAX, &k->damping);
}

static int place_device(const draft *d, const scene_body *b, uint32_t block, handle_params *k) {
  const exact step = exact_mul(exact_make(2, d->lu_um), b->hand_scale);
  vec3 origin = {0, 0, 0};
  if (b->has_hand_offset && !draft_place(d, block, "hand_offset", b->hand_offset, &origin))
    return 0;
  k->placed = b->has_hand_offset;
  k->origin[0] = origin.x;
  k->origin[1] = origin.y;
  k->origin[2] = origin.z;
  return draft_turn(d, block, "hand_rotate", &b->hand_rotation, k->turn) &&
         draft_fixed_point(d, draft_given(block, "hand_scale", UNIT_NONE, b->hand_scale), step,
                           FX_POSITION_BITS + 8, 1, INT32_MAX, &k->pose_gain) &&
         draft_fixed_point(d, draft_given(block, "force_scale", UNIT_NONE, b->force_scale),
                           b->force_scale, 16, 1, INT32_MAX, &k->force_scale);
}

int draft_handles(const draft *d, fray_world *w) {
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    handle_params *k = &WRITABLE(handle_params, w->handles.constants)[h];
    uint32_t n = 0;
    const scene_body *b = handle_of(d, h, &n);
    k->body = b != NULL ? (int32_t)n : HANDLE_NONE;
    k->pose_gain = k->force_scale = k->delay = 1;
    if (b == NULL) continue;
    k->delay = (int32_t)d->scene->hands.delay;
    for (uint32_t a = 0; a < 3; ++a)
      w->handles.states[h].proxy[a] = w->handles.states[h].anchor[a] = d->body[n].start[a];
    if (!couple(d, b, BLOCK_BODY + n, k) || !place_device(d, b, BLOCK_BODY + n, k) ||
        !draft_fixed_point(
            d, draft_given(BLOCK_HANDS, "energy_reserve", UNIT_ENERGY, d->scene->hands.reserve),
            exact_mul(d->scene->hands.reserve, exact_make(1000000000, 1)), 0, 0, INT32_MAX,
            &k->reserve_nj))
      return 0;
  }
  return 1;
}
