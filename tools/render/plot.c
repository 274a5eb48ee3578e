/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/plot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/render/font.h"
#include "tools/render/portable_math.h"

enum { INK = 0x30363D, FAINT = 0xDDE1E5, PAPER = 0xFFFFFF, MARK = 0xB04A4A };

typedef struct {
  canvas *c;
  const plot *p;
  float x0, y0, x1, y1; /* the frame */
  double low_x, high_x, low_y, high_y;
  float unit;
} plot_job;

uint32_t plot_colour(uint32_t n) {
  static const uint32_t colours[PLOT_SERIES_MAX] = {0x1F6FB5, 0xE0742F, 0x2F9E74, 0xB0468C,
                                                    0x7A6A4F, 0x4FB3CF, 0xC9A227, 0x5B5F97};
  return colours[n % PLOT_SERIES_MAX];
}

plot_ticks plot_choose_ticks(double low, double high, uint32_t max) {
  plot_ticks t = {low, 1.0, 0, 0};
  if (max < 2) max = 2;
  if (max > PLOT_TICKS_MAX) max = PLOT_TICKS_MAX;
  if (!isfinite(low) || !isfinite(high) || !(high > low)) return t;
  static const double parts[3] = {1.0, 2.0, 5.0};
  const int power = portable_decade((high - low) / max) - 1;
  for (int round = 0; round < 12; round++) {
    const double step = parts[round % 3] * portable_power(10.0, power + round / 3);
    const double first = ceil(low / step - 1e-9), last = floor(high / step + 1e-9);
    if (last - first + 1.0 > max) continue;
    t.step = step;
    t.first = first * step + 0.0; /* no minus zero */
    t.count = last >= first ? (uint32_t)(last - first) + 1 : 0;
    t.decimals = power + round / 3 < 0 ? -(power + round / 3) : 0;
    return t;
  }
  return t;
}

void plot_columns(const double *y, size_t points, uint32_t columns, double *low, double *high) {
  for (uint32_t c = 0; c < columns; c++) {
    low[c] = INFINITY;
    high[c] = -INFINITY;
    if (points == 0) continue;
    const size_t from = (size_t)((double)c / columns * (double)(points - 1));
    size_t to = (size_t)((double)(c + 1) / columns * (double)(points - 1));
    if (to >= points) to = points - 1;
    for (size_t k = from; k <= to; k++) {
      if (!isfinite(y[k])) continue;
      if (y[k] < low[c]) low[c] = y[k];
      if (y[k] > high[c]) high[c] = y[k];
    }
  }
}

static void find_ranges(plot_job *k) {
  const plot *p = k->p;
  k->low_x = p->x_first;
  k->high_x = p->x_first + p->x_step * (double)(p->points > 1 ? p->points - 1 : 1);
  k->low_y = p->y_from_zero ? 0.0 : INFINITY;
  k->high_y = p->y_from_zero ? 0.0 : -INFINITY;
  for (uint32_t s = 0; s < p->series_count; s++) {
    for (size_t n = 0; n < p->points; n++) {
      const double y = p->series[s].y[n];
      if (!isfinite(y)) continue;
      k->low_y = fmin(k->low_y, y);
      k->high_y = fmax(k->high_y, y);
    }
  }
  if (!(k->low_y <= k->high_y)) k->low_y = k->high_y = 0.0;
  const double size = fmax(fabs(k->low_y), fabs(k->high_y));
  if (k->high_y - k->low_y <= 1e-9 * size || size == 0.0) {
    /* A constant: a frame around it, not noise blown up to full height. */
    const double room = size > 0.0 ? 0.1 * size : 1.0;
    k->high_y += room;
    if (!p->y_from_zero || k->low_y < 0.0) k->low_y -= room;
  } else {
    const double room = 0.06 * (k->high_y - k->low_y);
    k->high_y += room;
    if (!p->y_from_zero || k->low_y < 0.0) k->low_y -= room;
  }
}

static float screen_x(const plot_job *k, double x) {
  return k->x0 + (k->x1 - k->x0) * (float)((x - k->low_x) / (k->high_x - k->low_x));
}

static float screen_y(const plot_job *k, double y) {
  return k->y1 - (k->y1 - k->y0) * (float)((y - k->low_y) / (k->high_y - k->low_y));
}

/* 12500 with a step of 500 is shorter as 12.5k: amounts get a suffix, never an exponent. */
static void tick_text(char *text, size_t room, double v, const plot_ticks *t, double greatest) {
  if (v == 0.0) {
    snprintf(text, room, "0");
  } else if (greatest >= 1e9) {
    snprintf(text, room, "%.6gG", v / 1e9);
  } else if (greatest >= 1e6) {
    snprintf(text, room, "%.6gM", v / 1e6);
  } else if (greatest >= 1e4) {
    snprintf(text, room, "%.6gk", v / 1e3);
  } else if (t->decimals > 6) {
    snprintf(text, room, "%.3g", v);
  } else {
    snprintf(text, room, "%.*f", t->decimals, v);
  }
}

static void draw_axes(const plot_job *k, uint32_t x_most, uint32_t y_most) {
  char text[40];
  const float u = k->unit;
  const rgb ink = rgb_hex(INK), faint = rgb_hex(FAINT);
  const plot_ticks tx = plot_choose_ticks(k->low_x, k->high_x, x_most);
  const plot_ticks ty = plot_choose_ticks(k->low_y, k->high_y, y_most > 5 ? y_most : 5);
  for (uint32_t n = 0; n < tx.count; n++) {
    const double v = tx.first + tx.step * n;
    const float x = screen_x(k, v);
    canvas_line(k->c, x, k->y0, x, k->y1, u, faint, 1.0f);
    tick_text(text, sizeof text, v, &tx, fmax(fabs(k->low_x), fabs(k->high_x)));
    font_draw(k->c, x, k->y1 + 6 * u, u, text, ink, FONT_CENTRE);
  }
  for (uint32_t n = 0; n < ty.count; n++) {
    const double v = ty.first + ty.step * n;
    const float y = screen_y(k, v);
    const int zero = fabs(v) < 1e-9 * ty.step;
    canvas_line(k->c, k->x0, y, k->x1, y, u, zero ? rgb_hex(0xA9B0B7) : faint, 1.0f);
    tick_text(text, sizeof text, zero ? 0.0 : v, &ty, fmax(fabs(k->low_y), fabs(k->high_y)));
    font_draw(k->c, k->x0 - 6 * u, y - 3.5f * u, u, text, ink, FONT_RIGHT);
  }
}

static void draw_marks(const plot_job *k) {
  const float u = k->unit;
  const rgb colour = rgb_hex(MARK);
  float free_from = k->x0;
  float last_line = -INFINITY;
  for (size_t n = 0; n < k->p->mark_count; n++) {
    const plot_mark *m = k->p->marks + n;
    if (!(m->x >= k->low_x && m->x <= k->high_x)) continue;
    const float x = screen_x(k, m->x);
    if (x - last_line >= 2.0f * u) {
      canvas_line(k->c, x, k->y0, x, k->y1, u, colour, 0.30f);
      last_line = x;
    }
    if (!m->label) continue;
    const float width = font_width(m->label, u);
    if (x + 3 * u < free_from || x + 3 * u + width > k->x1) continue;
    font_draw(k->c, x + 3 * u, k->y0 + 4 * u, u, m->label, colour, FONT_LEFT);
    free_from = x + 9 * u + width;
  }
}

static void draw_points(const plot_job *k, const plot_series *s, rgb colour) {
  const float width = 1.5f * k->unit;
  for (size_t n = 0; n < k->p->points; n++) {
    if (!isfinite(s->y[n])) continue;
    const float x = screen_x(k, k->p->x_first + k->p->x_step * (double)n), y = screen_y(k, s->y[n]);
    if (n > 0 && isfinite(s->y[n - 1])) {
      const float bx = screen_x(k, k->p->x_first + k->p->x_step * (double)(n - 1));
      canvas_line(k->c, bx, screen_y(k, s->y[n - 1]), x, y, width, colour, 1.0f);
    } else {
      canvas_disc(k->c, x, y, 0.5f * width, colour, 1.0f);
    }
  }
}

static void draw_series(const plot_job *k, const plot_series *s) {
  const rgb colour = rgb_hex(s->colour);
  const uint32_t columns = (uint32_t)(k->x1 - k->x0);
  if (k->p->points <= columns || columns < 2) {
    draw_points(k, s, colour);
    return;
  }
  double *low = malloc(columns * sizeof *low), *high = malloc(columns * sizeof *high);
  if (low && high) {
    plot_columns(s->y, k->p->points, columns, low, high);
    for (uint32_t c = 0; c < columns; c++) {
      if (low[c] > high[c]) continue;
      const float x = k->x0 + (float)c + 0.5f;
      canvas_line(k->c, x, screen_y(k, low[c]), x, screen_y(k, high[c]), 1.5f * k->unit, colour,
                  1.0f);
    }
  }
  free(low);
  free(high);
}

/* In one row above the frame, from the right: it never covers a line. */
static void draw_legend(const plot_job *k) {
  const float u = k->unit;
  float x = k->x1;
  for (uint32_t s = k->p->series_count; s-- > 0;) {
    const plot_series *one = k->p->series + s;
    if (!one->label) continue;
    x -= font_width(one->label, u);
    font_draw(k->c, x, k->y0 - 14 * u, u, one->label, rgb_hex(INK), FONT_LEFT);
    canvas_line(k->c, x - 18 * u, k->y0 - 10.5f * u, x - 6 * u, k->y0 - 10.5f * u, 2.5f * u,
                rgb_hex(one->colour), 1.0f);
    x -= 32 * u;
  }
}

void plot_draw(canvas *c, plot_area area, const plot *p) {
  plot_job k = {.c = c, .p = p};
  k.unit = fmaxf(1.0f, roundf((area.x1 - area.x0) / 800.0f));
  const float u = k.unit;
  canvas_box(c, area.x0, area.y0, area.x1, area.y1, rgb_hex(PAPER), 1.0f);
  k.x0 = area.x0 + 68 * u;
  k.x1 = area.x1 - 20 * u;
  k.y0 = area.y0 + 36 * u;
  k.y1 = area.y1 - (p->x_label ? 34 : 22) * u;
  if (k.x1 - k.x0 < 16 * u || k.y1 - k.y0 < 16 * u) return;
  find_ranges(&k);
  draw_axes(&k, (uint32_t)((k.x1 - k.x0) / (70 * u)), (uint32_t)((k.y1 - k.y0) / (19 * u)));
  draw_marks(&k);
  for (uint32_t s = 0; s < p->series_count; s++) draw_series(&k, p->series + s);
  const rgb ink = rgb_hex(INK);
  canvas_line(c, k.x0, k.y0, k.x0, k.y1, u, ink, 1.0f);
  canvas_line(c, k.x0, k.y1, k.x1, k.y1, u, ink, 1.0f);
  draw_legend(&k);
  if (p->title) font_draw(c, k.x0, area.y0 + 10 * u, u, p->title, ink, FONT_LEFT);
  if (p->x_label) font_draw(c, k.x1, k.y1 + 20 * u, u, p->x_label, ink, FONT_RIGHT);
  if (p->y_label) font_draw_upwards(c, area.x0 + 8 * u, 0.5f * (k.y0 + k.y1), u, p->y_label, ink);
}
