/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/scene_language/number.h"

#include <stdio.h>

typedef struct {
  int64_t digits;
  int count;
  int fraction; /* how many of them stand behind the point */
} decimal;

static int is_digit(char c) { return c >= '0' && c <= '9'; }

static size_t read_digits(const char *text, size_t bytes, size_t at, int behind_point,
                          decimal *d) {
  while (at < bytes && is_digit(text[at])) {
    if (d->count <= NUMBER_DIGITS) {
      d->count++;
      if (d->count <= NUMBER_DIGITS) {
        d->digits = d->digits * 10 + (text[at] - '0');
        d->fraction += behind_point;
      }
    }
    at++;
  }
  return at;
}

/* An 'e' belongs to the number iff a digit follows it. */
static size_t read_exponent(const char *text, size_t bytes, size_t at, int *exponent) {
  if (at >= bytes || (text[at] != 'e' && text[at] != 'E')) return at;
  size_t digit = at + 1;
  int negative = 0;
  if (digit < bytes && (text[digit] == '-' || text[digit] == '+')) {
    negative = text[digit] == '-';
    digit++;
  }
  if (digit >= bytes || !is_digit(text[digit])) return at;
  int value = 0;
  while (digit < bytes && is_digit(text[digit])) {
    if (value <= NUMBER_EXPONENT) value = value * 10 + (text[digit] - '0');
    digit++;
  }
  *exponent = negative ? -value : value;
  return digit;
}

static exact power_of_ten(int power) {
  int64_t value = 1;
  for (int k = 0; k < power; k++) value *= 10;
  return exact_make(value, 1);
}

number_status number_read(const char *text, size_t bytes, exact *value, size_t *used) {
  decimal d = {0, 0, 0};
  size_t at = 0;
  int negative = 0, exponent = 0;
  *used = 0;
  *value = exact_make(0, 1);
  if (at < bytes && (text[at] == '-' || text[at] == '+')) {
    negative = text[at] == '-';
    at++;
  }
  at = read_digits(text, bytes, at, 0, &d);
  if (at < bytes && text[at] == '.') at = read_digits(text, bytes, at + 1, 1, &d);
  if (d.count == 0) return NUMBER_NONE;
  at = read_exponent(text, bytes, at, &exponent);
  *used = at;
  if (d.count > NUMBER_DIGITS) return NUMBER_LONG;
  if (exponent > NUMBER_EXPONENT || exponent < -NUMBER_EXPONENT) return NUMBER_EXTREME;
  exact result = exact_make(negative ? -d.digits : d.digits, 1);
  result = exact_div(result, power_of_ten(d.fraction));
  if (exponent >= 0) {
    result = exact_mul(result, power_of_ten(exponent));
  } else {
    result = exact_div(result, power_of_ten(-exponent));
  }
  if (!exact_valid(result)) return NUMBER_EXTREME;
  *value = result;
  return NUMBER_GOOD;
}

const char *number_write(exact value, int way, char text[NUMBER_TEXT]) {
  enum { SHOWN = 1000000 };
  int64_t steps = 0;
  int places = NUMBER_DIGITS; /* behind the point */
  snprintf(text, NUMBER_TEXT, "?");
  if (!exact_valid(value)) return text;
  while (places > 0 &&
         (!exact_mul_div(value.numerator, power_of_ten(places).numerator, value.denominator, &steps) ||
          steps >= SHOWN || steps <= -SHOWN))
    places--;
  if (places == 0 && !exact_mul_div(value.numerator, 1, value.denominator, &steps)) return text;
  const exact rounded = exact_make(steps, power_of_ten(places).numerator);
  const int over = exact_compare(rounded, value);
  if (way < 0 && over > 0) steps--;
  if (way > 0 && over < 0) steps++;
  const int64_t one = power_of_ten(places).numerator;
  const int64_t size = steps < 0 ? -steps : steps;
  int length = snprintf(text, NUMBER_TEXT, "%s%lld.%0*lld", steps < 0 ? "-" : "", (long long)(size / one),
                        places, (long long)(size % one));
  while (length > 0 && text[length - 1] == '0') length--;
  if (length > 0 && text[length - 1] == '.') length--;
  text[length] = 0;
  return text;
}
