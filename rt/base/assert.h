/* SPDX-License-Identifier: Apache-2.0 */
/* FRAY_ASSERT: a precondition or an invariant. It traps in builds with FRAY_ASSERTIONS (the sanitizers) or
 * FRAY_CHECKED (`make checked`, the fuzzers), which traps on sums and products out of their range too; in
 * releases it is not evaluated and costs nothing. Bad input is never an assertion: images, frames and
 * arguments get an error. A build may define FRAY_ASSERT_FAILED(file, line), a call that does not return, in
 * place of the trap. */
#ifndef FRAY_BASE_ASSERT_H
#define FRAY_BASE_ASSERT_H

#ifndef FRAY_ASSERT_FAILED
#define FRAY_ASSERT_FAILED(file, line) __builtin_trap()
#endif

#if defined(FRAY_CHECKED) || defined(FRAY_ASSERTIONS)
#define FRAY_ASSERT(condition) \
  do { \
    if (!(condition)) FRAY_ASSERT_FAILED(__FILE__, __LINE__); \
  } while (0)
#else
#define FRAY_ASSERT(condition) ((void)sizeof((condition) ? 1 : 0))
#endif

#endif
