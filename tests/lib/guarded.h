/* SPDX-License-Identifier: Apache-2.0 */
/* Arrays that end (or begin) where the next page may not be touched; what is left of their own pages
 * holds a pattern. */
#ifndef FRAY_TESTS_LIB_GUARDED_H
#define FRAY_TESTS_LIB_GUARDED_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

typedef struct {
  uint8_t *pages; /* between two that fault */
  size_t pages_bytes;
  uint8_t *at; /* the array */
  size_t bytes;
} guarded;

enum { GUARDED_PATTERN = 0xA5 };

/* Where every read is checked, tests take a part of their cases. */
#if defined(__SANITIZE_ADDRESS__)
#define GUARDED_SLOW 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(undefined_behavior_sanitizer)
#define GUARDED_SLOW 1
#endif
#endif
#ifndef GUARDED_SLOW
#define GUARDED_SLOW 0
#endif

static inline guarded guarded_make(size_t most_bytes) {
  guarded g;
  const size_t page = (size_t)sysconf(_SC_PAGESIZE);
  g.pages_bytes = (most_bytes + page - 1) / page * page;
  uint8_t *all = (uint8_t *)mmap(NULL, g.pages_bytes + 2 * page, PROT_NONE,
                                 MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  g.pages = all + page;
  g.at = g.pages;
  g.bytes = 0;
  if (all == MAP_FAILED || mprotect(g.pages, g.pages_bytes, PROT_READ | PROT_WRITE) != 0) {
    perror("guarded.h: mmap");
    exit(2);
  }
  memset(g.pages, GUARDED_PATTERN, g.pages_bytes);
  return g;
}

/* Room for `bytes` at one end of the pages; the last array's place gets the pattern again. */
static inline void *guarded_place(guarded *g, size_t bytes, int at_end) {
  memset(g->at, GUARDED_PATTERN, g->bytes);
  g->bytes = bytes;
  g->at = at_end ? g->pages + g->pages_bytes - bytes : g->pages;
  return g->at;
}

static inline int guarded_intact(const guarded *g) {
  const uint8_t *from = g->at == g->pages ? g->at + g->bytes : g->pages;
  const size_t bytes = g->pages_bytes - g->bytes;
  if (bytes == 0) return 1;
  return from[0] == GUARDED_PATTERN && memcmp(from, from + 1, bytes - 1) == 0;
}

#endif
