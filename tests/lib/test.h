/* SPDX-License-Identifier: Apache-2.0 */
/* A test program: plain functions, and a main that runs them and ends with test_end().
 *
 *   static void adds(void) { CHECK_EQ_INT(1 + 1, 2); }
 *   int main(void) { TEST(adds); return test_end(); }
 *
 * A test passes iff none of its checks fails. The last line is `N passed, N failed`. */
#ifndef FRAY_TESTS_LIB_TEST_H
#define FRAY_TESTS_LIB_TEST_H

#include <stdio.h>
#include <string.h>

/* Where every step is checked, as under sanitizers, long tests take one case of so many. */
#ifndef TEST_FEWER
#define TEST_FEWER 1
#endif

static int test_passed, test_failed, test_bad_checks;

static inline void test_run(const char *name, void (*body)(void)) {
  test_bad_checks = 0;
  body();
  if (test_bad_checks != 0) {
    test_failed++;
    printf("FAILED %s\n", name);
  } else {
    test_passed++;
  }
}

static inline int test_end(void) {
  printf("%d passed, %d failed\n", test_passed, test_failed);
  return test_failed != 0;
}

static inline void test_check(int good, const char *text, const char *file, int line) {
  if (good) return;
  test_bad_checks++;
  printf("%s:%d: not true: %s\n", file, line, text);
}

static inline void test_equal_int(long long a, long long b, const char *text, const char *file,
                                  int line) {
  if (a == b) return;
  test_bad_checks++;
  printf("%s:%d: %s: %lld, expected %lld\n", file, line, text, a, b);
}

static inline void test_equal_text(const char *a, const char *b, const char *file, int line) {
  if (strcmp(a, b) == 0) return;
  test_bad_checks++;
  printf("%s:%d:\n  is       \"%s\"\n  expected \"%s\"\n", file, line, a, b);
}

/* Of a variable: what is called with its address where its block ends. */
#define CLOSED_BY(function) __attribute__((cleanup(function)))

#define TEST(function) test_run(#function, function)
#define CHECK(condition) test_check((condition) != 0, #condition, __FILE__, __LINE__)
#define CHECK_EQ_INT(a, b) \
  test_equal_int((long long)(a), (long long)(b), #a, __FILE__, __LINE__)
#define CHECK_TEXT(a, b) test_equal_text(a, b, __FILE__, __LINE__)

#endif
