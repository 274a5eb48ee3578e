/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "tests/lib/test.h"
#include "tools/render/canvas.h"
#include "tools/render/plot.h"

static int near(double a, double b) { return fabs(a - b) <= 1e-9 * (1.0 + fabs(b)); }

static void ticks_are_round(void) {
  plot_ticks t = plot_choose_ticks(0.0, 1.0, 6);
  CHECK(near(t.first, 0.0));
  CHECK(near(t.step, 0.2));
  CHECK_EQ_INT(t.count, 6);
  CHECK_EQ_INT(t.decimals, 1);
  t = plot_choose_ticks(-3.2, 4.1, 5);
  CHECK(near(t.first, -2.0));
  CHECK(near(t.step, 2.0));
  CHECK_EQ_INT(t.count, 4);
  CHECK_EQ_INT(t.decimals, 0);
  t = plot_choose_ticks(0.0, 25120.0, 4);
  CHECK(near(t.step, 10000.0));
  CHECK_EQ_INT(t.count, 3);
  t = plot_choose_ticks(12.34, 12.36, 5);
  CHECK(near(t.first, 12.34));
  CHECK(near(t.step, 0.005));
  CHECK_EQ_INT(t.count, 5);
  CHECK_EQ_INT(t.decimals, 3);
}

static void ticks_keep_their_bound(void) {
  for (uint32_t most = 2; most <= PLOT_TICKS_MAX; most++) {
    for (int k = -60; k < 60; k++) {
      const double low = 0.37 * k, high = low + pow(1.7, k / 3.0);
      const plot_ticks t = plot_choose_ticks(low, high, most);
      CHECK(t.count <= most);
      CHECK(t.step > 0.0);
      const double room = 1e-6 * t.step;
      if (t.count) CHECK(t.first >= low - room && t.first + t.step * (t.count - 1) <= high + room);
      /* Not sparser than the next finer step would force. */
      CHECK((high - low) / t.step >= (most - 1.0) / 2.5 - 1.0);
    }
  }
}

static void ticks_of_nothing(void) {
  CHECK_EQ_INT(plot_choose_ticks(1.0, 1.0, 5).count, 0);
  CHECK_EQ_INT(plot_choose_ticks(2.0, 1.0, 5).count, 0);
  CHECK_EQ_INT(plot_choose_ticks(NAN, 1.0, 5).count, 0);
  CHECK_EQ_INT(plot_choose_ticks(0.0, INFINITY, 5).count, 0);
}

static void columns_by_hand(void) {
  const double y[9] = {0, 5, 1, 2, -4, 3, 3, NAN, 9};
  double low[4], high[4];
  plot_columns(y, 9, 4, low, high);
  /* Parts 0-2, 2-4, 4-6, 6-8. */
  const double expected_low[4] = {0, -4, -4, 3}, expected_high[4] = {5, 2, 3, 9};
  for (int c = 0; c < 4; c++) {
    CHECK(near(low[c], expected_low[c]));
    CHECK(near(high[c], expected_high[c]));
  }
  plot_columns(y + 7, 1, 1, low, high);
  CHECK(low[0] > high[0]);
  plot_columns(y, 0, 2, low, high);
  CHECK(low[0] > high[0] && low[1] > high[1]);
}

static void columns_lose_no_spike(void) {
  enum { POINTS = 100003, COLUMNS = 617 };
  double *y = calloc(POINTS, sizeof *y);
  double low[COLUMNS], high[COLUMNS];
  CHECK(y != NULL);
  for (size_t at = 0; y && at < POINTS; at += 7717) {
    y[at] = 1.0;
    plot_columns(y, POINTS, COLUMNS, low, high);
    int seen = 0;
    for (int c = 0; c < COLUMNS; c++) seen += high[c] > 0.5;
    CHECK(seen == 1 || seen == 2);
    y[at] = 0.0;
  }
  free(y);
}

/* Draws inside its area only, whatever the values are. */
static void drawing_stays_inside(void) {
  double y[500];
  for (int k = 0; k < 500; k++) y[k] = k % 50 == 7 ? NAN : k % 60 == 3 ? -1e12 : 1e3 * sin(k * 0.1);
  const plot_mark marks[3] = {{-5, "before"}, {2.0, "a mark"}, {1e30, "after"}};
  for (size_t points = 0; points <= 500; points = points ? points * 5 : 4) {
    canvas c;
    CHECK(canvas_open(&c, 400, 200, 1));
    plot p = {.title = "title", .x_label = "s", .y_label = "N", .x_step = 0.01, .points = points};
    p.series[p.series_count++] = (plot_series){"one", y, plot_colour(0)};
    p.marks = marks;
    p.mark_count = 3;
    plot_draw(&c, (plot_area){100, 40, 400, 190}, &p);
    int outside = 0, inside = 0;
    for (uint32_t row = 0; row < 200; row++)
      for (uint32_t column = 0; column < 400; column++) {
        const int drawn = c.light[3 * (row * 400 + column) + 1] != 0;
        if (column < 100 || row < 40 || row >= 190) outside += drawn;
        else inside += drawn;
      }
    CHECK_EQ_INT(outside, 0);
    CHECK(inside > 10000);
    canvas_close(&c);
  }
}

int main(void) {
  TEST(ticks_are_round);
  TEST(ticks_keep_their_bound);
  TEST(ticks_of_nothing);
  TEST(columns_by_hand);
  TEST(columns_lose_no_spike);
  TEST(drawing_stays_inside);
  return test_end();
}
