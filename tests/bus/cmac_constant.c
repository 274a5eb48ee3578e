/* SPDX-License-Identifier: Apache-2.0 */
/* For cmac_constant.sh. `count N`: measured() N times, each with another key and message, some of
 * them extreme; callgrind counts each call alone. `follow`: memcheck is told that key and message
 * are undefined, so it reports each branch and each address that depends on them.
 * With -DCMAC_LEAKS a table look-up by a secret and a branch on one are put in, which must be seen. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <valgrind/memcheck.h>

#include "rt/wire/auth.h"

static uint8_t key_bytes[CMAC_KEY];
static frame sealed;
static cmac_key key;
static auth_lane lane;
static auth_monitor watch;
static uint32_t result;

#ifdef CMAC_LEAKS
static const uint8_t TABLE[256] = {1, 2, 3};
static volatile uint8_t leak;
#endif

/* Everything that touches a secret: the schedule, a frame that is opened, a TAG that is checked. */
__attribute__((noinline)) void measured(void);
void measured(void) {
  uint8_t tag[CMAC_BLOCK];
  cmac_key_init(&key, key_bytes);
  cmac_tag(&key, sealed.data, 12, tag);
  result = cmac_differs(tag, sealed.data + 12, 8);
  cmac_tag(&key, watch.group.poses[0], sizeof watch.group.poses, tag);
  result |= cmac_differs(tag, sealed.data, 16);
#ifdef CMAC_LEAKS
  leak = TABLE[key_bytes[0]];
  if ((key_bytes[1] & 1) != 0) leak = (uint8_t)(leak + 1);
#endif
}

/* The figures of the README: one frame each. */
__attribute__((noinline)) void measured_open(void);
void measured_open(void) {
  frame out;
  result |= (uint32_t)auth_open(&lane, &sealed, &out);
}
__attribute__((noinline)) void measured_tag(void);
void measured_tag(void) {
  frame tag;
  memset(&tag, 0, sizeof tag);
  tag.id = watch.group.tag_id;
  tag.length = 8;
  tag.data[0] = 1;
  result |= (uint32_t)auth_monitor_check(&watch, &tag);
}
__attribute__((noinline)) void measured_key(void);
void measured_key(void) { cmac_key_init(&key, key_bytes); }

static void fill(uint8_t *to, size_t bytes, unsigned n) {
  for (size_t b = 0; b < bytes; ++b) {
    to[b] = n == 0 ? 0 : n == 1 ? 0xFF : n < 10 ? (uint8_t)(1u << (n - 2)) : (uint8_t)rand();
  }
}

static void count(unsigned calls) {
  for (unsigned n = 0; n < calls; ++n) {
    srand(n);
    fill(key_bytes, sizeof key_bytes, n);
    fill(sealed.data, 20, (n * 7) % calls);
    fill(watch.group.poses[0], sizeof watch.group.poses, (n * 3) % calls);
    measured();
    auth_lane_init(&lane, &key, MESSAGE_POSE_LEFT, 0, 0);
    sealed.id = lane.id;
    sealed.length = 20;
    sealed.fd = FRAME_FD;
    sealed.data[8] |= 1;
    measured_open();
    measured_key();
    auth_monitor_init(&watch, &key, 0, 0, 0);
    fill(watch.group.poses[0], sizeof watch.group.poses, n);
    watch.group.count = AUTH_GROUP;
    measured_tag();
  }
}

static void follow(void) {
  (void)VALGRIND_MAKE_MEM_UNDEFINED(key_bytes, sizeof key_bytes);
  (void)VALGRIND_MAKE_MEM_UNDEFINED(sealed.data, sizeof sealed.data);
  (void)VALGRIND_MAKE_MEM_UNDEFINED(watch.group.poses, sizeof watch.group.poses);
  measured();
  (void)VALGRIND_MAKE_MEM_DEFINED(&result, sizeof result);
}

int main(int argc, char **argv) {
  if (argc > 2 && strcmp(argv[1], "count") == 0) {
    count((unsigned)atoi(argv[2]));
  } else if (argc > 1 && strcmp(argv[1], "follow") == 0) {
    follow();
  } else {
    fprintf(stderr, "usage: cmac_constant count N | follow\n");
    return 2;
  }
  printf("%d\n", result != 0);
  return 0;
}
