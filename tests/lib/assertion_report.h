/* SPDX-License-Identifier: Apache-2.0 */
/* Included before every file of the build of test_assertions: an assertion says where it is, then traps. */
#ifndef FRAY_TESTS_LIB_ASSERTION_REPORT_H
#define FRAY_TESTS_LIB_ASSERTION_REPORT_H

__attribute__((noreturn)) void assertion_report(const char *file, int line);
#define FRAY_ASSERT_FAILED(file, line) assertion_report(file, line)

#endif
