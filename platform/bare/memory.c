/* SPDX-License-Identifier: Apache-2.0 */
/* The functions that a freestanding compiler may call for copies and initialisers; nothing else of a libc. */
#include <stddef.h>
#include <stdint.h>

#include "platform/bare/bare.h"

void *memcpy(void *restrict to, const void *restrict from, size_t bytes);
void *memmove(void *to, const void *from, size_t bytes);
void *memset(void *to, int value, size_t bytes);
int memcmp(const void *a, const void *b, size_t bytes);

/* the compiler's own type for words that may be anything */
typedef uint32_t __attribute__((may_alias)) any_word;

BARE_LOOP void *memcpy(void *restrict to, const void *restrict from, size_t bytes) {
  unsigned char *t = to;
  const unsigned char *f = from;
  if ((((uintptr_t)t | (uintptr_t)f) & 3u) == 0)
    for (; bytes >= 4; bytes -= 4, t += 4, f += 4)
      *(any_word *)(void *)t = *(const any_word *)(const void *)f;
  while (bytes-- > 0) *t++ = *f++;
  return to;
}

BARE_LOOP void *memmove(void *to, const void *from, size_t bytes) {
  unsigned char *t = to;
  const unsigned char *f = from;
  if ((uintptr_t)t <= (uintptr_t)f)
    for (size_t n = 0; n < bytes; ++n) t[n] = f[n];
  else
    while (bytes-- > 0) t[bytes] = f[bytes];
  return to;
}

BARE_LOOP void *memset(void *to, int value, size_t bytes) {
  unsigned char *t = to;
  const uint32_t word = (uint32_t)(unsigned char)value * 0x01010101u;
  if (((uintptr_t)t & 3u) == 0)
    for (; bytes >= 4; bytes -= 4, t += 4) *(any_word *)(void *)t = word;
  while (bytes-- > 0) *t++ = (unsigned char)value;
  return to;
}

BARE_LOOP int memcmp(const void *a, const void *b, size_t bytes) {
  const unsigned char *p = a;
  const unsigned char *q = b;
  for (size_t n = 0; n < bytes; ++n)
    if (p[n] != q[n]) return p[n] < q[n] ? -1 : 1;
  return 0;
}
