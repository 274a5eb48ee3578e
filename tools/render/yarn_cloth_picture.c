/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/yarn_cloth_picture.h"

#include <stdlib.h>

#include "tools/render/tube.h"
#include "tools/render/yarn_axes.h"
#include "tools/render/yarn_touch.h"

/* In spacings: half the width of a yarn that lies in cloth, the radius of one that hangs loose. */
static const float half_width = 0.53f, loose_radius = 0.29f;
/* Where a yarn slides on another one: how flat it is, and how far off its own line, in its thickness. */
static const float slid_tight = 0.6f, slid_lift = 0.6f;
/* Runs with fewer pieces are lint, unless a whole crossing holds them. */
enum { LINT_PIECES = 2 };
/* How far a yarn goes on behind its last crossing: where it is torn, and at the sheet's rim. */
static const float torn_length = 0.75f, rim_length = 0.42f;
enum { TIP_RINGS = 6 };

/* A yarn's end, drawn last: what lies behind it must be there to shine through. */
typedef struct {
  tube_ring base;
  rgb colour;
  float distance;
  uint32_t number; /* in the order they were met */
  int torn;
} yarn_end;

typedef struct {
  const picture_source *source;
  const cloth_style *style;
  yarn_axes axes;
  tube pen;
  uint32_t pieces; /* rings a spring */
  yarn_touches touches; /* of the yarn that is drawn */
  yarn_end *ends;
  size_t end_count, end_room;
  int failed;
} weave_job;

/* What holds along a yarn as it is drawn. */
typedef struct {
  yarn_path path;
  float length;
  v3 up; /* of the last ring: up to a sign, so that a tube is not twisted in itself */
} walker;

static float load_at(const yarn_path *path, uint32_t point) {
  const picture_source *s = path->axes->source;
  float max = -1.0f;
  if (point > 0 && yarn_path_joined(path, point - 1))
    max = s->load[yarn_path_spring(path, point - 1)];
  if (yarn_path_joined(path, point)) max = fmaxf(max, s->load[yarn_path_spring(path, point)]);
  return max;
}

static void keep_end(weave_job *k, const tube_ring *base, float sign, int torn) {
  if (k->end_count == k->end_room) {
    const size_t room = k->end_room ? 2 * k->end_room : 256;
    yarn_end *grown = realloc(k->ends, room * sizeof *grown);
    if (!grown) {
      k->failed = 1;
      return;
    }
    k->ends = grown;
    k->end_room = room;
  }
  yarn_end *e = k->ends + k->end_count;
  *e = (yarn_end){*base, k->pen.colour, 0.0f, (uint32_t)k->end_count, torn};
  e->base.along = v3_scale(base->along, sign);
  const v3 d = v3_sub(base->at, k->pen.cam->eye);
  e->distance = -v3_dot(d, k->pen.cam->back);
  ++k->end_count;
}

static int is_whole(const weave_job *k, uint32_t crossing) { return !k->source->split[crossing]; }

/* 1: flat, as in cloth, 0: a thread in the air, or the end of one. */
static float tight_at(const weave_job *k, const yarn_path *path, uint32_t point) {
  float touch = 0.0f;
  if (is_whole(k, yarn_path_crossing(path, point))) return 1.0f;
  const int ends = (point > 0 && !yarn_path_joined(path, point - 1)) ||
                   (point + 1 < path->count && !yarn_path_joined(path, point));
  if (!ends) (void)yarn_touches_at(&k->touches, (float)point, &touch);
  return slid_tight * touch;
}

/* The ring at a point of a yarn, or, at `s` of the way to the next point, between the two. */
static tube_ring ring_between(const weave_job *k, walker *w, uint32_t point, float s) {
  const yarn_path *path = &w->path;
  const yarn_axes *axes = path->axes;
  const uint32_t here = yarn_path_crossing(path, point);
  const uint32_t there = s > 0.0f ? yarn_path_crossing(path, point + 1) : here;
  const float soft = s * s * (3.0f - 2.0f * s);
  const float tight =
      tight_at(k, path, point) * (1.0f - soft) + (s > 0.0f ? tight_at(k, path, point + 1) : 0.0f) * soft;
  v3 other = axes->normal[there];
  const v3 away_here = v3_scale(axes->normal[here], yarn_axes_side(axes, path->axis, here));
  const v3 away_there = v3_scale(other, yarn_axes_side(axes, path->axis, there));
  if (v3_dot(other, axes->normal[here]) < 0.0f) other = v3_scale(other, -1.0f);
  float touch = 0.0f;
  const v3 slid = yarn_touches_at(&k->touches, (float)point + s, &touch);
  const float whole_here = is_whole(k, here) ? 1.0f - s : 0.0f, whole_there = is_whole(k, there) ? s : 0.0f;
  v3 up = v3_add_scaled(v3_scale(axes->normal[here], whole_here), other, whole_there);
  up = v3_add_scaled(up, slid, v3_dot(slid, w->up) < 0.0f ? -1.0f : 1.0f);
  if (v3_dot(up, w->up) < 0.0f) up = v3_scale(up, -1.0f);
  w->up = v3_unit(v3_add_scaled(v3_scale(w->up, 1.0f - tight), up, tight + 1e-3f));
  const float spacing = k->source->spacing, flat = axes->apart;
  const float crimp = 1.0f - 0.25f * s * (1.0f - s);
  tube_ring r = {.up = w->up, .tight = tight, .alpha = 1.0f, .length = w->length};
  r.wide = spacing * (half_width * crimp * tight + loose_radius * (1.0f - tight));
  r.thick = flat * tight + spacing * loose_radius * (1.0f - tight);
  r.at = v3_scale(slid, slid_lift * r.thick); /* to where the spline is */
  r.away = v3_add(slid, v3_scale(away_here, is_whole(k, here) ? 1.0f - soft : 0.0f));
  r.away = v3_add_scaled(r.away, away_there, is_whole(k, there) ? soft : 0.0f);
  r.load = load_at(path, point);
  if (s > 0.0f) r.load = r.load * (1.0f - s) + load_at(path, point + 1) * s;
  return r;
}

static yarn_path partner_of(const walker *w, uint32_t crossing) {
  const picture_source *s = w->path.axes->source;
  const uint32_t number = w->path.axis == AXIS_WARP ? crossing / s->warps : crossing % s->warps;
  return yarn_path_of(w->path.axes, 1 - w->path.axis, number);
}

/* A crossing where the yarn is torn on both sides is a yarn of no length, which shows only where it still
 * lies on a partner. */
static int stray_shows(const weave_job *k, const walker *w, uint32_t point) {
  const uint32_t crossing = yarn_path_crossing(&w->path, point);
  const yarn_path partner = partner_of(w, crossing);
  const uint32_t at = w->path.number;
  return is_whole(k, crossing) &&
         (yarn_path_joined(&partner, at) || (at > 0 && yarn_path_joined(&partner, at - 1)));
}

/* It has no tangent: it lies across its partner. */
static v3 stray_direction(const walker *w, uint32_t point) {
  const uint32_t crossing = yarn_path_crossing(&w->path, point);
  const yarn_path partner = partner_of(w, crossing);
  const v3 along = yarn_path_tangent(&partner, w->path.number);
  const v3 across = v3_cross(w->path.axes->normal[crossing], along);
  return v3_length(across) > 1e-6f ? v3_unit(across) : (v3){0.7071068f, 0.0f, 0.7071068f};
}

/* Whether the run that begins at a point is long enough, or a part of whole cloth. */
static int shows(const weave_job *k, const walker *w, uint32_t point) {
  uint32_t end = point;
  int held = 0;
  if (!yarn_path_joined(&w->path, point)) return stray_shows(k, w, point);
  while (yarn_path_joined(&w->path, end)) ++end;
  for (uint32_t n = point; n <= end; n++) held |= is_whole(k, yarn_path_crossing(&w->path, n));
  return held || end - point >= LINT_PIECES;
}

/* How the wave of touches changes along a yarn, for a spacing. */
static v3 slope_of(const weave_job *k, float place) {
  const float step = 1.0f / 32.0f;
  float touch = 0.0f;
  const v3 before = yarn_touches_at(&k->touches, place - step, &touch);
  const v3 behind = yarn_touches_at(&k->touches, place + step, &touch);
  return v3_scale(v3_sub(behind, before), 0.5f / step);
}

static void draw_piece(weave_job *k, walker *w, uint32_t point, v3 from, v3 to, v3 out, v3 in) {
  const float length = v3_length(v3_sub(to, from));
  const float begun = w->length;
  for (uint32_t n = 1; n <= k->pieces; n++) {
    const float s = (float)n / (float)k->pieces, s2 = s * s, s3 = s2 * s;
    w->length = begun + length * s;
    tube_ring r = ring_between(k, w, point, s);
    v3 at = v3_scale(from, 2 * s3 - 3 * s2 + 1);
    at = v3_add_scaled(at, out, s3 - 2 * s2 + s);
    at = v3_add_scaled(at, to, 3 * s2 - 2 * s3);
    r.at = v3_add(r.at, v3_add_scaled(at, in, s3 - s2));
    v3 along = v3_scale(v3_sub(to, from), 6 * s - 6 * s2);
    along = v3_add_scaled(along, out, 3 * s2 - 4 * s + 1);
    along = v3_add_scaled(along, slope_of(k, (float)point + s), slid_lift * r.thick);
    r.along = v3_unit(v3_add_scaled(along, in, 3 * s2 - 2 * s));
    tube_add(&k->pen, &r);
    if (n == k->pieces && !yarn_path_joined(&w->path, point + 1)) {
      const uint32_t spring = yarn_path_spring(&w->path, point + 1);
      keep_end(k, &r, 1.0f, spring != UINT32_MAX);
    }
  }
}

static void draw_yarn(weave_job *k, int axis, uint32_t number) {
  walker w = {.path = yarn_path_of(&k->axes, axis, number)};
  v3 at = yarn_path_at(&w.path, 0), tangent = yarn_path_tangent(&w.path, 0);
  int shown = 0;
  k->pen.colour = cloth_yarn_colour(k->style, axis == AXIS_WARP, number);
  yarn_touches_read(&k->touches, &w.path);
  for (uint32_t n = 0; n < w.path.count; n++) {
    const int joined = yarn_path_joined(&w.path, n);
    const int begins = n == 0 || !yarn_path_joined(&w.path, n - 1);
    if (begins) shown = shows(k, &w, n);
    if (begins && shown) {
      w.up = k->axes.normal[yarn_path_crossing(&w.path, n)];
      tube_ring r = ring_between(k, &w, n, 0.0f);
      r.at = v3_add(r.at, at);
      r.along = joined ? v3_unit(tangent) : stray_direction(&w, n);
      tube_begin(&k->pen);
      tube_add(&k->pen, &r);
      keep_end(k, &r, -1.0f, n > 0);
      if (!joined) keep_end(k, &r, 1.0f, n + 1 < w.path.count);
    }
    if (n + 1 == w.path.count) break;
    const v3 next = yarn_path_at(&w.path, n + 1), next_tangent = yarn_path_tangent(&w.path, n + 1);
    if (joined && shown) draw_piece(k, &w, n, at, next, tangent, next_tangent);
    at = next;
    tangent = next_tangent;
  }
}

/* Torn: bends a little, thins, fades. At the rim: ends bluntly. */
static void draw_end(weave_job *k, const yarn_end *e) {
  const float length = k->source->spacing * (e->torn ? torn_length : rim_length);
  const v3 side = v3_unit(v3_cross(e->base.along, e->base.up));
  const uint32_t seed = e->number * 2u + 40503u;
  const float left = 0.5f * (cloth_random(seed) - 0.5f);
  const float lift = 0.5f * (cloth_random(seed + 1u) - 0.5f);
  v3 bend = v3_add_scaled(v3_scale(side, left), e->base.up, lift);
  if (!e->torn) bend = (v3){0, 0, 0};
  k->pen.colour = e->colour;
  tube_begin(&k->pen);
  for (int n = 0; n <= TIP_RINGS; n++) {
    const float q = (float)n / TIP_RINGS;
    tube_ring r = e->base;
    r.at = v3_add_scaled(v3_add_scaled(r.at, r.along, length * q), bend, length * q * q);
    r.along = v3_unit(v3_add_scaled(r.along, bend, 2.0f * q));
    r.length += length * q;
    const float round = sqrtf(1.0f - q * q * q * q);
    const float size = e->torn ? 1.0f - 0.80f * q : fmaxf(round, 0.05f);
    r.wide *= size;
    r.thick *= size;
    if (e->torn) {
      r.alpha = clamp01(1.25f * (1.0f - q));
      r.wide += (loose_radius * k->source->spacing - r.wide) * 0.5f * q;
      r.tight *= 1.0f - q;
      r.away = v3_scale(r.away, 1.0f - q);
    }
    tube_add(&k->pen, &r);
  }
}

static int farther_first(const void *a, const void *b) {
  const yarn_end *x = a, *y = b;
  if (x->distance != y->distance) return x->distance > y->distance ? -1 : 1;
  return x->number < y->number ? -1 : x->number > y->number;
}

/* How many pixels lie from yarn to yarn, on average. */
static float spacing_pixels(const weave_job *k) {
  const bounds b = picture_source_bounds(k->source);
  return k->source->spacing *
         camera_pixels(k->pen.cam, v3_scale(v3_add(b.low, b.high), 0.5f));
}

int yarn_cloth_picture_draw(canvas *c, const camera *cam, const lighting *light,
                       const picture_source *source, const cloth_style *style) {
  weave_job k = {.source = source, .style = style};
  if (source->warps == 0 || source->wefts == 0) return 1;
  k.pen = (tube){.c = c, .cam = cam, .light = light, .strain = style->strain};
  k.pen.ply = 0.6f * source->spacing;
  const uint32_t points = source->warps > source->wefts ? source->warps : source->wefts;
  k.touches.list = malloc(points * sizeof *k.touches.list);
  if (!k.touches.list || !yarn_axes_open(&k.axes, source)) {
    free(k.touches.list);
    return 0;
  }
  const float pixels = light ? spacing_pixels(&k) : 1.0f;
  k.pieces = pixels < 4.0f ? 2 : pixels < 16.0f ? 4 : 8;
  k.pen.texture = clamp01((pixels - 3.0f) / 8.0f);
  tube_shape(&k.pen, pixels < 4.0f ? 6 : pixels < 16.0f ? 8 : 12);
  for (int axis = 0; axis < AXES; axis++)
    for (uint32_t n = 0; n < yarn_paths(source, axis); n++) draw_yarn(&k, axis, n);
  if (k.end_count > 0) qsort(k.ends, k.end_count, sizeof *k.ends, farther_first);
  for (size_t n = 0; n < k.end_count; n++) draw_end(&k, k.ends + n);
  free(k.ends);
  free(k.touches.list);
  yarn_axes_close(&k.axes);
  return !k.failed;
}
