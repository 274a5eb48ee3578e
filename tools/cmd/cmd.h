/* SPDX-License-Identifier: Apache-2.0 */
/* The commands of fray; argv[0] is the command. Each returns the exit code: 0 good, 1 a run differs or
 * failed, or writing failed, 2 wrong use or unreadable input. */
#ifndef FRAY_TOOLS_CMD_CMD_H
#define FRAY_TOOLS_CMD_CMD_H

int cmd_bench(int argc, char **argv);
int cmd_hand(int argc, char **argv);
int cmd_info(int argc, char **argv);
int cmd_render(int argc, char **argv);
int cmd_run(int argc, char **argv);
int cmd_scene(int argc, char **argv);
int cmd_verify(int argc, char **argv);

#endif
