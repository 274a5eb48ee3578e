/* SPDX-License-Identifier: Apache-2.0 */
/* The key of the authenticated bus (rt/wire/auth.h), in a file: 32 hex digits of either case, then
 * at most one end of line, nothing else. `umask 077; openssl rand -hex 16 >bus.key` makes one. */
#ifndef FRAY_TOOLS_BUS_KEY_FILE_H
#define FRAY_TOOLS_BUS_KEY_FILE_H

#include <stdint.h>

#include "platform/log/candump.h"
#include "rt/wire/cmac.h"

/* Returns 1, or 0 with *error; then the key is all zeros. Refused: anything but a regular file, any
 * right of group or others, a key of zeros. No message quotes the file. */
int key_file_read(const char *file, uint8_t key[CMAC_KEY], candump_error *error);

#endif
