/* SPDX-License-Identifier: Apache-2.0 */
#define _POSIX_C_SOURCE 200809L
#include "tools/bus/key_file.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "platform/files/input_file.h"
#include "tests/lib/rfc4493_key.h"
#include "tests/lib/test.h"

static char folder[] = "/tmp/fray_key_XXXXXX";
static char path[64];
static candump_error error;
static uint8_t key[16];

static int read_text(const char *text, size_t bytes, mode_t mode) {
  FILE *out = fopen(path, "wb");
  if (out == NULL || fwrite(text, 1, bytes, out) != bytes || fclose(out) != 0 ||
      chmod(path, mode) != 0) {
    perror(path);
    exit(1);
  }
  memset(&error, 0, sizeof error);
  memset(key, 0xEE, sizeof key);
  const int good = key_file_read(path, key, &error);
  unlink(path);
  return good;
}

static int zeros(void) {
  int sum = 0;
  for (int n = 0; n < 16; ++n) sum += key[n];
  return sum == 0;
}

#define READ(text) read_text(text, sizeof text - 1, 0600)
#define DIGITS "2b7e151628aed2a6abf7158809cf4f3c"

static void good_files(void) {
  CHECK(READ(DIGITS));
  CHECK(memcmp(key, RFC4493_KEY, 16) == 0);
  CHECK(READ(DIGITS "\n"));
  CHECK(memcmp(key, RFC4493_KEY, 16) == 0);
  CHECK(READ(DIGITS "\r\n"));
  CHECK(READ("2B7E151628AED2A6ABF7158809CF4F3C\n"));
  CHECK(memcmp(key, RFC4493_KEY, 16) == 0);
  CHECK(read_text(DIGITS "\n", 33, 0400));
}

/* So that no output of the command goes over it. */
static void is_an_input(void) {
  struct stat status;
  FILE *out = fopen(path, "wb");
  CHECK(out != NULL && fputs(DIGITS, out) >= 0 && fclose(out) == 0 && chmod(path, 0600) == 0);
  CHECK(key_file_read(path, key, &error));
  CHECK(stat(path, &status) == 0 && input_file_was_read(&status));
  unlink(path);
}

static void bad_texts(void) {
  CHECK(!READ(""));
  CHECK_EQ_INT(error.column, 1);
  CHECK_TEXT(error.message, "the file ends here, expected 32 hex digits");
  CHECK(!READ("2b7e151628aed2a6abf7158809cf4f3\n"));
  CHECK_EQ_INT(error.column, 32);
  CHECK_TEXT(error.message, "not a hex digit, expected 32 hex digits");
  CHECK(!READ("0x2b7e151628aed2a6abf7158809cf4f"));
  CHECK_EQ_INT(error.column, 2);
  CHECK(!READ(" " DIGITS));
  CHECK(!READ(DIGITS " "));
  CHECK_TEXT(error.message, "more after the 32 hex digits, expected the end of the file");
  CHECK(!READ(DIGITS "0"));
  CHECK(!READ(DIGITS "\n\n"));
  CHECK(!READ(DIGITS "\r"));
  CHECK(!READ(DIGITS "\r\n\n"));
  CHECK(!READ(DIGITS "\n# bus"));
  CHECK(!read_text(DIGITS "\0", 33, 0600));
  CHECK(zeros());
  CHECK(!READ("00000000000000000000000000000000\n"));
  CHECK_TEXT(error.message, "a key of zeros, expected a random one");
}

static void files_that_others_have_rights_to(void) {
  static const mode_t MODES[] = {0640, 0604, 0620, 0601, 0644, 0660, 0666, 0777};
  for (int n = 0; n < 8; ++n) {
    CHECK(!read_text(DIGITS, 32, MODES[n]));
    CHECK(zeros());
  }
  CHECK(!read_text(DIGITS, 32, 0644));
  CHECK_TEXT(error.message,
             "others than its owner have rights to this key (mode 0644), expected 0600: chmod 600 "
             "it, and change the key if it may have been read");
  CHECK(strstr(error.message, "2b7e") == NULL);
}

static void no_files(void) {
  memset(key, 0xEE, sizeof key);
  CHECK(!key_file_read("/tmp/fray_key_that_is_not_there", key, &error));
  CHECK_TEXT(error.message, "cannot be opened: No such file or directory");
  CHECK(zeros());
  CHECK(!key_file_read(folder, key, &error));
  CHECK_TEXT(error.message, "not a regular file, expected a key file");
  CHECK(mkfifo(path, 0600) == 0);
  CHECK(!key_file_read(path, key, &error));
  CHECK_TEXT(error.message, "not a regular file, expected a key file");
  unlink(path);
}

int main(void) {
  if (mkdtemp(folder) == NULL) {
    perror(folder);
    return 1;
  }
  snprintf(path, sizeof path, "%s/bus.key", folder);
  TEST(good_files);
  TEST(is_an_input);
  TEST(bad_texts);
  TEST(files_that_others_have_rights_to);
  TEST(no_files);
  rmdir(folder);
  return test_end();
}
