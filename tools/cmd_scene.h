/* SPDX-License-Identifier: Apache-2.0 */
#ifndef FRAY_TOOLS_CMD_SCENE_H
#define FRAY_TOOLS_CMD_SCENE_H

/* fray scene; argv[0] is the verb. Returns the exit code: 0 good, 1 writing failed, 2 wrong use or
 * unreadable input. */
int cmd_scene(int argc, char **argv);

#endif
