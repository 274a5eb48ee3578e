/* SPDX-License-Identifier: Apache-2.0 */
/* The one reader of a command's input: a whole file in memory. It takes regular files and pipes up to a limit, and
 * refuses what has no end or no content: devices, folders, pipes without a writer. It remembers the files that
 * it read, so that no output goes over one (output_file.h).
 *
 * Context: one thread. NULL: never. Hosts only. */
#ifndef FRAY_PLATFORM_FILES_INPUT_FILE_H
#define FRAY_PLATFORM_FILES_INPUT_FILE_H

#include <stddef.h>
#include <stdint.h>
#include <sys/stat.h>

enum { INPUT_FILE_WHY = 160 };

#define INPUT_FILE_WORLD_MAX (UINT64_C(1) << 30)   /* bytes of an image; the largest that rt can open has less */
#define INPUT_FILE_SCRIPT_MAX (UINT64_C(1) << 24)  /* of a text that people write */
#define INPUT_FILE_LOG_MAX (UINT64_C(1) << 36)
#define INPUT_FILE_PIPE_MAX (UINT64_C(1) << 30)    /* of a pipe, whatever it holds */

/* A malloc'ed copy with a 0 after its end, of at most `most` bytes. NULL with *why: what was found and what was
 * expected, to be put behind the path. Cost: linear in the file. most: any. */
uint8_t *input_file_read(const char *path, uint64_t most, size_t *bytes, char why[INPUT_FILE_WHY]);

/* Notes a file that was read in another way. */
void input_file_remember(const struct stat *status);

/* Whether this is a file that was read. Of more than 64 files, the first 64. */
int input_file_was_read(const struct stat *status);

#endif
