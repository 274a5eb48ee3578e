/* SPDX-License-Identifier: Apache-2.0 */
/* A file that a command writes. It is written beside its name, in the same folder, and renamed when it is whole: a
 * command that fails or is ended leaves the old file as it was, and nothing else. A device or a pipe is written in
 * place.
 *
 * Context: each file one thread; several files may be open in several threads. NULL: never. Hosts only. */
#ifndef FRAY_PLATFORM_FILES_OUTPUT_FILE_H
#define FRAY_PLATFORM_FILES_OUTPUT_FILE_H

#include <stddef.h>
#include <stdio.h>

enum { OUTPUT_FILE_PATH = 4096 };

typedef struct {
  FILE *stream;                  /* NULL: not open */
  char target[OUTPUT_FILE_PATH]; /* the file, where its links lead */
  int aside;                     /* number of its slot of names in use, -1: none, it is written in place */
} output_file;

/* Returns 1, or 0 with errno (EEXIST: it is a file that this command read). Cost: a few system calls. */
int output_file_open(output_file *f, const char *path);
/* Closes it and gives it its name. Returns 1, or 0 with errno where not all of it could be written: the old file
 * is as it was. */
int output_file_keep(output_file *f);
/* Gives it its name and leaves it open, for what must be found after a power cut; also tells the folder's disk.
 * Returns 1, or 0 with errno; aside is then -1 iff it has its name all the same. */
int output_file_name(output_file *f);
/* Closes it, if it is open, and leaves the old file as it was. */
void output_file_drop(output_file *f);
/* All of it at once. Returns 1, or 0 with errno. Cost: linear in bytes. bytes: any. */
int output_file_write(const char *path, const void *data, size_t bytes);

/* What errno says after a failure above. */
const char *output_file_reason(void);
/* Removes all files that are not whole yet. For signal handlers that end the process. */
void output_file_drop_all(void);

#endif
