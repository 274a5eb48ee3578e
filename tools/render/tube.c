/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/tube.h"

#include "tools/render/portable_math.h"

enum {
  AT = 0,
  NORMAL = 3,
  ALONG = 6,
  SMOOTH = 9,
  OPEN = 12,
  ROUND = 13,
  LENGTH = 14,
  LOAD = 15,
  ALPHA = 16,
  LOOSE = 17,
  TUBE_ATTRIBUTES = 18
};
_Static_assert((int)TUBE_ATTRIBUTES <= (int)CANVAS_ATTRIBUTES, "a vertex has room");

static v3 vector_of(const float *a) { return (v3){a[0], a[1], a[2]}; }

static canvas_sample shade_tube(const void *context, const float *a, int front) {
  const tube *t = context;
  (void)front;
  const v3 at = vector_of(a + AT);
  const v3 towards = camera_towards(t->cam, at);
  const float open = a[OPEN] * a[OPEN] * (3.0f - 2.0f * a[OPEN]);
  const float ply = portable_wave(a[LENGTH] / t->ply + a[ROUND]);
  const rgb own = t->strain ? cloth_strain_colour(a[LOAD]) : t->colour;
  const rgb colour = rgb_scale(own, 1.0f + (0.08f + 0.12f * a[LOOSE]) * t->texture * ply);
  const fibre f = {.colour = colour,
                   .along = v3_unit(vector_of(a + ALONG)),
                   .normal = v3_unit(vector_of(a + NORMAL)),
                   .smooth = v3_unit(vector_of(a + SMOOTH)),
                   .open = 0.18f + 0.82f * open,
                   .thread = 0.30f + 0.35f * a[LOOSE],
                   .gloss = 0.10f};
  return (canvas_sample){lighting_shade_fibre(t->light, &f, at, towards), a[ALPHA]};
}

void tube_shape(tube *t, uint32_t sides) {
  t->sides = sides;
  for (uint32_t n = 0; n < sides; n++) {
    const double turn = 6.28318530717959 * (double)n / (double)sides;
    t->cosine[n] = (float)portable_cos(turn);
    t->sine[n] = (float)portable_sin(turn);
  }
}

static void put(float *a, v3 v) {
  a[0] = v.x;
  a[1] = v.y;
  a[2] = v.z;
}

/* Fills the ring's vertices; 0 if one is behind the camera. */
static int place(const tube *t, const tube_ring *r, canvas_vertex *out) {
  const v3 side = v3_unit(v3_cross(r->along, r->up)), up = v3_cross(side, r->along);
  const v3 towards = camera_towards(t->cam, r->at);
  const v3 facing = v3_scale(up, v3_dot(up, towards) < 0.0f ? -1.0f : 1.0f);
  for (uint32_t n = 0; n <= t->sides; n++) {
    const float x = t->cosine[n % t->sides], y = t->sine[n % t->sides];
    const v3 at = v3_add_scaled(v3_add_scaled(r->at, side, x * r->wide), up, y * r->thick);
    /* Shaded rounder than it is: a flat yarn is a bundle of round ones. */
    const v3 normal = v3_add_scaled(v3_scale(side, x * (1.0f - 0.3f * r->tight)), up, y);
    float *a = out[n].a;
    put(a + AT, at);
    put(a + NORMAL, normal);
    put(a + ALONG, r->along);
    put(a + SMOOTH, v3_add_scaled(v3_scale(normal, 1.0f - r->tight), facing, r->tight));
    a[OPEN] = clamp01(1.0f - 0.5f * r->tight + 0.5f * v3_dot(v3_unit(normal), r->away));
    a[ROUND] = (float)n / (float)t->sides;
    a[LENGTH] = r->length;
    a[LOAD] = r->load;
    a[ALPHA] = r->alpha;
    a[LOOSE] = 1.0f - r->tight;
    if (!camera_project(t->cam, at, out + n)) return 0;
  }
  return 1;
}

/* What faces away is behind what faces the viewer: left out. */
static void draw_facet(const tube *t, const canvas_vertex *a, const canvas_vertex *b,
                       const canvas_vertex *c) {
  const float area = (b->x - a->x) * (c->y - a->y) - (c->x - a->x) * (b->y - a->y);
  if (area > 0.0f)
    canvas_triangle(t->c, a, b, c, TUBE_ATTRIBUTES, t->light ? shade_tube : NULL, t);
}

void tube_add(tube *t, const tube_ring *ring) {
  const canvas_vertex *before = t->ring[t->now];
  canvas_vertex *now = t->ring[t->now ^ 1];
  const int joined = t->has_ring;
  t->has_ring = place(t, ring, now);
  t->now ^= 1;
  if (!joined || !t->has_ring) return;
  for (uint32_t n = 0; n < t->sides; n++) {
    draw_facet(t, before + n, before + n + 1, now + n);
    draw_facet(t, before + n + 1, now + n + 1, now + n);
  }
}
