/* SPDX-License-Identifier: Apache-2.0 */
#ifndef FRAY_TOOLS_CMD_BENCH_H
#define FRAY_TOOLS_CMD_BENCH_H

/* fray bench; argv[0] is the verb. Returns the exit code: 0 good, 1 out of memory, 2 wrong use or
 * unreadable input. */
int cmd_bench(int argc, char **argv);

#endif
