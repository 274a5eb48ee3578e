/* SPDX-License-Identifier: Apache-2.0 */
#define _POSIX_C_SOURCE 200809L
#include "platform/linux/freshness.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "rt/wire/codec.h"
#include "tests/lib/rfc4493_key.h"
#include "tests/lib/test.h"

static const uint8_t OTHER_BYTES[16] = {1};
static cmac_key key, other_key;
static char folder[] = "/tmp/fray_freshness_XXXXXX";
static char path[64], kept[80], beside[80];
static freshness store;
static auth_gate g;
static candump_error error;

static int begin_with(const cmac_key *k, auth_gate_form form, auth_gate_end end) {
  memset(&error, 0, sizeof error);
  auth_gate_init(&g, k, form, end, 0, 3);
  return freshness_open(&store, path, &g, k, &error);
}

static int begin(void) { return begin_with(&key, AUTH_GATE_FD, AUTH_GATE_DEVICE); }

static uint32_t seal(uint32_t times) {
  uint32_t sealed = 0;
  for (uint32_t n = 0; n < times; ++n) {
    frame f;
    const fray_pose pose = {0, 0, 0, (uint8_t)(n & 15u), 0};
    codec_encode_pose(&f, 0, 0, &pose);
    sealed += (uint32_t)auth_gate_seal(&g, &f);
  }
  return sealed;
}

static char *text(void) {
  static char buffer[1024];
  FILE *in = fopen(path, "rb");
  memset(buffer, 0, sizeof buffer);
  if (in == NULL) return buffer;
  (void)!fread(buffer, 1, sizeof buffer - 1, in);
  fclose(in);
  return buffer;
}

static void put(const char *words) {
  FILE *out = fopen(path, "wb");
  if (out == NULL || fputs(words, out) < 0 || fclose(out) != 0) exit(1);
}

static void until_allowed(uint32_t max) {
  const struct timespec pause = {0, 20000000};
  for (int n = 0; n < 500 && g.out[1].max != max; ++n) {
    freshness_exchange(&store);
    (void)nanosleep(&pause, NULL);
  }
}

/* The tag of this text is from `openssl mac -cipher AES-128-CBC ... CMAC`. */
static void a_new_file(void) {
  unlink(path);
  CHECK(begin());
  CHECK_EQ_INT(store.is_new, 1);
  CHECK_EQ_INT(g.out[1].max, 10000);
  CHECK(strncmp(text(), "fray freshness 1\ndevice fd instance 0\naccepted 021 0\naccepted 189 0\n"
                        "accepted 18A 0\nsent 020 10000\nsent 109 10000\nsent 10A 10000\ntag ", 122) == 0);
  struct stat status;
  CHECK(stat(path, &status) == 0 && (status.st_mode & 0777) == 0600);
  CHECK_EQ_INT(seal(7), 7);
  CHECK(freshness_close(&store));
  CHECK_TEXT(text(), "fray freshness 1\ndevice fd instance 0\naccepted 021 0\naccepted 189 0\n"
                     "accepted 18A 0\nsent 020 0\nsent 109 7\nsent 10A 0\n"
                     "tag 3387414BCEC670AA1235433EB304A6F4\n");
}

static void a_clean_end_goes_on(void) {
  CHECK(begin());
  CHECK_EQ_INT(store.is_new, 0);
  CHECK_EQ_INT(g.out[1].last, 7);
  CHECK_EQ_INT(g.out[1].max, 10007);
  g.in[1].last = 123;
  CHECK(freshness_close(&store));
  CHECK(begin());
  CHECK_EQ_INT(g.in[1].last, 123);
  CHECK(freshness_close(&store));
}

/* Nothing above what the file says is sent; the writer goes ahead. */
static void a_sender_waits_for_its_store(void) {
  CHECK(begin());
  CHECK_EQ_INT(seal(20000), 10000);
  until_allowed(20007);
  CHECK_EQ_INT(g.out[1].max, 20007);
  CHECK(strstr(text(), "sent 109 20007\n") != NULL);
  CHECK_EQ_INT(seal(20000), 10000);
  CHECK(freshness_close(&store));
}

/* kill -9 at any moment: what was sent is never sent again, the file is whole. */
static void after_a_kill(void) {
  for (int round = 0; round < 20; ++round) {
    int way[2];
    uint32_t sent = 0, last = 0;
    if (pipe(way) != 0) exit(1);
    const pid_t child = fork();
    if (child == 0) {
      const struct timespec pause = {0, 200000};
      if (!begin()) _exit(1);
      for (;;) {
        (void)seal(50);
        freshness_exchange(&store);
        if (write(way[1], &g.out[1].last, 4) != 4) _exit(1);
        (void)nanosleep(&pause, NULL);
      }
    }
    const struct timespec life = {0, 5000000 + round * 7000000};
    close(way[1]);
    (void)nanosleep(&life, NULL);
    (void)kill(child, SIGKILL);
    (void)waitpid(child, NULL, 0);
    while (read(way[0], &last, 4) == 4) sent = last;
    close(way[0]);
    CHECK(begin());
    CHECK(g.out[1].last >= sent);
    CHECK(freshness_close(&store));
  }
}

static void files_that_do_not_fit(void) {
  char good[1024];
  unlink(path);
  CHECK(begin() && freshness_close(&store));
  memcpy(good, text(), sizeof good);
  CHECK(!begin_with(&other_key, AUTH_GATE_FD, AUTH_GATE_DEVICE));
  CHECK(strstr(error.message, "was written under another key, or altered") != NULL);
  CHECK(!begin_with(&key, AUTH_GATE_FD, AUTH_GATE_RUNTIME));
  CHECK(strstr(error.message, "not of this end of the bus, expected 'runtime fd instance 0'") != NULL);
  CHECK(!begin_with(&key, AUTH_GATE_CLASSIC, AUTH_GATE_DEVICE));
  CHECK(strstr(error.message, "expected 'device classic instance 0'") != NULL);
  CHECK_TEXT(text(), good); /* what was refused is left alone */
  char *number = strstr(good, "sent 109 0");
  CHECK(number != NULL);
  if (number != NULL) number[9] = '1';
  put(good);
  CHECK(!begin());
  for (size_t bytes = 0; bytes < strlen(good); bytes += 13) {
    good[strlen(good) - 1] = 0;
    put(good);
    CHECK(!begin());
  }
  put("");
  CHECK(!begin());
  put("4294967295\n4294967295\n4294967296 9999999999999999999999\n\n\n\n\n\n\n\n");
  CHECK(!begin());
}

static void a_spent_key(void) {
  unlink(path);
  CHECK(begin());
  g.out[2].last = UINT32_MAX;
  CHECK(freshness_close(&store));
  CHECK(!begin());
  CHECK_TEXT(error.message, "no freshness is left under this key, expected a new key and a new file");
  unlink(path);
  CHECK(begin());
  g.out[0].last = AUTH_RUNTIME_FIRST - 5; /* the operator's half of COMMAND */
  CHECK(freshness_close(&store));
  CHECK(begin());
  CHECK_EQ_INT(g.out[0].max, AUTH_RUNTIME_FIRST - 1);
  CHECK(freshness_close(&store));
}

/* From open to close, through the stores in between. */
static void one_process_a_file(void) {
  static freshness second;
  auth_gate another;
  auth_gate_init(&another, &key, AUTH_GATE_FD, AUTH_GATE_DEVICE, 0, 3);
  unlink(path);
  CHECK(begin());
  CHECK(!freshness_open(&second, path, &another, &key, &error));
  CHECK(strstr(error.message, "another process stores its freshness here") != NULL);
  CHECK_EQ_INT(seal(6000), 6000);
  until_allowed(16000);
  CHECK_EQ_INT(g.out[1].max, 16000);
  CHECK(!freshness_open(&second, path, &another, &key, &error));
  CHECK(freshness_close(&store));
  CHECK(freshness_open(&second, path, &another, &key, &error));
  CHECK_EQ_INT(another.out[1].last, 6000);
  CHECK(freshness_close(&second));
}

static void what_cannot_be_written(void) {
  char words[64];
  snprintf(words, sizeof words, "%s", path);
  snprintf(path, sizeof path, "%s/no/such", folder);
  CHECK(!begin());
  CHECK_TEXT(error.message, "cannot be written: No such file or directory");
  snprintf(path, sizeof path, "%s", words);
  unlink(path);
  CHECK(begin());
  CHECK(rename(path, kept) == 0 && mkdir(path, 0700) == 0); /* from now on nothing can be stored */
  (void)seal(6000);
  const struct timespec pause = {0, 20000000};
  for (int n = 0; n < 500 && freshness_failed(&store) == 0; ++n) {
    freshness_exchange(&store);
    (void)nanosleep(&pause, NULL);
  }
  CHECK(freshness_failed(&store) != 0);
  CHECK_EQ_INT(seal(20000), 4000); /* as far as the file says */
  CHECK(!freshness_close(&store));
  CHECK(rmdir(path) == 0 && rename(kept, path) == 0);
  CHECK(begin());
  CHECK_EQ_INT(g.out[1].last, 10000);
  CHECK(freshness_close(&store));
}

static int second_opens(const char *file) {
  static freshness second;
  static auth_gate another;
  auth_gate_init(&another, &key, AUTH_GATE_FD, AUTH_GATE_DEVICE, 0, 3);
  memset(&error, 0, sizeof error);
  if (!freshness_open(&second, file, &another, &key, &error)) return 0;
  (void)freshness_close(&second);
  return 1;
}

/* Two names would be two locks: the same freshness twice under one key. */
static void one_name_a_file(void) {
  char soft[80], hard[80], by_folder[96];
  struct stat status;
  snprintf(soft, sizeof soft, "%s/soft", folder);
  snprintf(hard, sizeof hard, "%s/hard", folder);
  snprintf(by_folder, sizeof by_folder, "%s/linked", folder);
  (void)unlink(path);
  CHECK(symlink("lanes", soft) == 0 && symlink(".", by_folder) == 0);
  CHECK(!second_opens(soft));
  CHECK_TEXT(error.message, "is a symbolic link, expected the file itself, which one end uses");
  CHECK(access(path, F_OK) != 0);
  CHECK(begin());
  CHECK(!second_opens(soft));
  CHECK(lstat(soft, &status) == 0 && S_ISLNK(status.st_mode));
  snprintf(by_folder, sizeof by_folder, "%s/linked/lanes", folder);
  CHECK(!second_opens(by_folder)); /* the same name, by another way */
  CHECK(strstr(error.message, "another process stores its freshness here") != NULL);
  CHECK(link(path, hard) == 0);
  CHECK(!second_opens(hard));
  CHECK(freshness_close(&store)); /* the name is a new file's */
  CHECK(unlink(hard) == 0 && link(path, hard) == 0);
  CHECK(!second_opens(hard));
  CHECK_TEXT(error.message, "has 2 names (hard links), expected one, which one end uses");
  CHECK(!second_opens(path));
  CHECK(unlink(hard) == 0);
  CHECK(second_opens(path));
  CHECK(second_opens(by_folder));
  snprintf(by_folder, sizeof by_folder, "%s/linked", folder);
  (void)unlink(soft);
  (void)unlink(by_folder);
}

/* Two ends that begin at once, without a file: one of them may send. */
static void one_of_two_that_begin(void) {
  for (int round = 0; round < 20; ++round) {
    int way[2];
    char go = 0;
    (void)unlink(path);
    if (pipe(way) != 0) exit(1);
    pid_t child[2];
    int good = 0;
    for (int n = 0; n < 2; ++n) {
      child[n] = fork();
      if (child[n] != 0) continue;
      const struct timespec life = {0, 20000000};
      if (read(way[0], &go, 1) != 1 || !begin()) _exit(1);
      (void)nanosleep(&life, NULL);
      _exit(0); /* as killed: what it sent is as the file says, at most */
    }
    if (write(way[1], "go", 2) != 2) exit(1);
    for (int n = 0; n < 2; ++n) {
      int status = 1;
      (void)waitpid(child[n], &status, 0);
      good += status == 0;
    }
    close(way[0]);
    close(way[1]);
    const uint32_t allowed = (uint32_t)(good * FRESHNESS_AHEAD);
    if (good == 0) continue;
    CHECK(begin());
    CHECK_EQ_INT(g.out[1].last, allowed);
    CHECK(freshness_close(&store));
  }
}

/* A file that was put in the place of the one that is held is another end's. */
static void a_file_that_was_put_there(void) {
  (void)unlink(path);
  CHECK(begin());
  CHECK(rename(path, kept) == 0);
  put("precious");
  CHECK(!freshness_close(&store));
  CHECK_EQ_INT(freshness_failed(&store), ESTALE);
  CHECK_TEXT(text(), "precious");
  CHECK(rename(kept, path) == 0);
  CHECK(begin());
  CHECK_EQ_INT(g.out[1].last, 10000);
  CHECK(freshness_close(&store));
}

static void what_cannot_begin_leaves_nothing(void) {
  auth_gate_init(&g, &key, AUTH_GATE_FD, AUTH_GATE_DEVICE, 0, 3);
  (void)unlink(path);
  g.out[2].last = UINT32_MAX;
  CHECK(!freshness_open(&store, path, &g, &key, &error));
  CHECK(access(path, F_OK) != 0);
}

/* What has a name beside it is someone's: it is neither removed nor written through. */
static void what_stands_beside(void) {
  char line[16] = "";
  FILE *out = fopen(beside, "w");
  CHECK(out != NULL && fputs("precious", out) >= 0 && fclose(out) == 0);
  (void)unlink(path);
  CHECK(begin());
  CHECK(freshness_close(&store));
  FILE *in = fopen(beside, "r");
  CHECK(in != NULL && fgets(line, sizeof line, in) != NULL && fclose(in) == 0);
  CHECK_TEXT(line, "precious");
  (void)unlink(beside);
  (void)alarm(20); /* a pipe that is opened for reading waits for a writer */
  (void)unlink(path);
  CHECK(mkfifo(path, 0600) == 0);
  CHECK(!begin());
  CHECK_TEXT(error.message, "is not a regular file, expected a file of freshness");
  (void)alarm(0);
  (void)unlink(path);
}

/* What killed processes left. */
static void remove_folder(void) {
  DIR *names = opendir(folder);
  for (struct dirent *d = names != NULL ? readdir(names) : NULL; d != NULL; d = readdir(names)) {
    char name[400];
    snprintf(name, sizeof name, "%s/%s", folder, d->d_name);
    (void)unlink(name);
  }
  if (names != NULL) closedir(names);
  rmdir(folder);
}

int main(void) {
  if (mkdtemp(folder) == NULL) return 1;
  snprintf(path, sizeof path, "%s/lanes", folder);
  snprintf(kept, sizeof kept, "%s.kept", path);
  snprintf(beside, sizeof beside, "%s.new", path);
  cmac_key_init(&key, RFC4493_KEY);
  cmac_key_init(&other_key, OTHER_BYTES);
  TEST(a_new_file);
  TEST(a_clean_end_goes_on);
  TEST(a_sender_waits_for_its_store);
  TEST(after_a_kill);
  TEST(files_that_do_not_fit);
  TEST(a_spent_key);
  TEST(one_process_a_file);
  TEST(what_cannot_be_written);
  TEST(one_name_a_file);
  TEST(one_of_two_that_begin);
  TEST(a_file_that_was_put_there);
  TEST(what_cannot_begin_leaves_nothing);
  TEST(what_stands_beside);
  remove_folder();
  return test_end();
}
