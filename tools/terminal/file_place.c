/* SPDX-License-Identifier: Apache-2.0 */
#define _POSIX_C_SOURCE 200809L

#include "tools/terminal/file_place.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { ROOM = 4096 };

const char *file_place_name(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash != NULL ? slash + 1 : path;
}

int file_place_is_standard_output(const char *path) {
  struct stat of_path, printed;
  return stat(path, &of_path) == 0 && fstat(STDOUT_FILENO, &printed) == 0 && of_path.st_dev == printed.st_dev &&
         of_path.st_ino == printed.st_ino && !S_ISCHR(printed.st_mode);
}

/* Without what names the same folder again: slashes and dots at its end. */
static void trim(char path[ROOM]) {
  for (size_t n = strlen(path); n > 1; path[n] = 0) {
    const int is_dot = path[n - 1] == '.' && path[n - 2] == '/';
    if (path[n - 1] != '/' && !is_dot) break;
    --n;
  }
}

static int copy(const char *path, char to[ROOM]) {
  if (snprintf(to, ROOM, "%s", path) >= ROOM) return 0;
  trim(to);
  return 1;
}

/* Cuts the last name off a trimmed path: what stays is its folder. */
static void cut_name(char path[ROOM]) {
  char *slash = strrchr(path, '/');
  if (slash == NULL)
    strcpy(path, ".");
  else
    slash[slash == path ? 1 : 0] = 0;
  trim(path);
}

int file_place_is_in(const char *path, const char *folder) {
  char own[ROOM];
  if (!copy(path, own)) return 0;
  cut_name(own);
  return file_place_is_one(own, folder);
}

/* Goes up until both are there, or one of them alone. */
int file_place_is_one(const char *a, const char *b) {
  char x[ROOM], y[ROOM];
  if (!copy(a, x) || !copy(b, y)) return strcmp(a, b) == 0;
  for (;;) {
    struct stat of_x, of_y;
    const int found = (stat(x, &of_x) == 0) + (stat(y, &of_y) == 0);
    if (found == 1) return 0;
    if (found == 2)
      return (S_ISREG(of_x.st_mode) || S_ISDIR(of_x.st_mode)) && of_x.st_dev == of_y.st_dev && of_x.st_ino == of_y.st_ino;
    if (strcmp(x, y) == 0) return 1;
    if (strcmp(file_place_name(x), file_place_name(y)) != 0) return 0;
    cut_name(x);
    cut_name(y);
  }
}
