/* SPDX-License-Identifier: Apache-2.0 */
#define _DEFAULT_SOURCE /* explicit_bzero */

#include "tools/bus/key_file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "platform/files/input_file.h"

enum { DIGITS = 2 * CMAC_KEY, ROOM = DIGITS + 3 /* CR LF, and one too many */ };

static int digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

static int parse(const char *file, const char *text, size_t bytes, uint8_t key[CMAC_KEY],
                 candump_error *error) {
  int any = 0;
  for (size_t n = 0; n < DIGITS; ++n) {
    const int value = n < bytes ? digit(text[n]) : -1;
    if (value < 0) {
      return candump_fail(error, file, 1, (int)n + 1, "%s, expected %d hex digits",
                          n == bytes ? "the file ends here" : "not a hex digit", DIGITS);
    }
    key[n / 2] = (uint8_t)(key[n / 2] << 4 | value);
    any |= value;
  }
  size_t at = DIGITS;
  if (at < bytes && text[at] == '\r') at += 1;
  if (at < bytes && text[at] == '\n') at += 1;
  if (at != bytes || (at > DIGITS && text[at - 1] == '\r')) {
    return candump_fail(error, file, 1, DIGITS + 1,
                        "more after the %d hex digits, expected the end of the file", DIGITS);
  }
  if (!any) return candump_fail(error, file, 1, 1, "a key of zeros, expected a random one");
  return 1;
}

static int check_file(const char *file, int in, candump_error *error) {
  struct stat status;
  if (fstat(in, &status) != 0) {
    return candump_fail(error, file, 0, 0, "cannot be read: %s", strerror(errno));
  }
  if (!S_ISREG(status.st_mode)) {
    return candump_fail(error, file, 0, 0, "not a regular file, expected a key file");
  }
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    return candump_fail(error, file, 0, 0,
                        "others than its owner have rights to this key (mode %04o), expected 0600: "
                        "chmod 600 it, and change the key if it may have been read",
                        (unsigned)(status.st_mode & 07777));
  }
  input_file_remember(&status);
  return 1;
}

static int read_key(const char *file, int in, uint8_t key[CMAC_KEY], candump_error *error) {
  char text[ROOM];
  size_t bytes = 0;
  while (bytes < ROOM) {
    const ssize_t got = read(in, text + bytes, ROOM - bytes);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      return candump_fail(error, file, 0, 0, "cannot be read: %s", strerror(errno));
    }
    if (got == 0) break;
    bytes += (size_t)got;
  }
  const int good = parse(file, text, bytes, key, error);
  explicit_bzero(text, sizeof text);
  return good;
}

int key_file_read(const char *file, uint8_t key[CMAC_KEY], candump_error *error) {
  memset(key, 0, CMAC_KEY);
  /* without O_NONBLOCK a pipe of this name would block before it is refused */
  const int in = open(file, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (in < 0) return candump_fail(error, file, 0, 0, "cannot be opened: %s", strerror(errno));
  const int good = check_file(file, in, error) && read_key(file, in, key, error);
  close(in);
  if (!good) explicit_bzero(key, CMAC_KEY);
  return good;
}
