/* SPDX-License-Identifier: Apache-2.0 */
#ifndef FRAY_TOOLS_CMD_RUN_H
#define FRAY_TOOLS_CMD_RUN_H

/* fray run; argv[0] is the verb. Returns the exit code: 0 good, 1 the run failed, 2 wrong use or
 * unreadable input. */
int cmd_run(int argc, char **argv);

#endif
