/* SPDX-License-Identifier: Apache-2.0 */
/* Where a path of the command line leads, also of a file that is not there yet. */
#ifndef FRAY_TOOLS_TERMINAL_FILE_PLACE_H
#define FRAY_TOOLS_TERMINAL_FILE_PLACE_H

/* Whether both are one file or folder: by device and number; of what is not there, by its name and its folder. No two
 * devices or pipes are. Cost: a few system calls. */
int file_place_is_one(const char *a, const char *b);

/* Whether what is written to `path` goes where standard output goes, into a file or a pipe. */
int file_place_is_standard_output(const char *path);

/* Whether `path` is directly in `folder`. */
int file_place_is_in(const char *path, const char *folder);

/* The last name of `path`. */
const char *file_place_name(const char *path);

#endif
