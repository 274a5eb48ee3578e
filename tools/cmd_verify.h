/* SPDX-License-Identifier: Apache-2.0 */
#ifndef FRAY_TOOLS_CMD_VERIFY_H
#define FRAY_TOOLS_CMD_VERIFY_H

/* fray verify; argv[0] is the verb. Returns the exit code: 0 good, 1 the run differs or is not
 * complete, 2 wrong use or unreadable input. */
int cmd_verify(int argc, char **argv);

#endif
