/* SPDX-License-Identifier: Apache-2.0 */
/* Overflows its stack on purpose: the guard must end it with a fault. */
#include "platform/platform.h"

int deeper(int depth);

__attribute__((noinline)) int deeper(int depth) {
  volatile char frame_of_it[200];
  frame_of_it[0] = (char)depth;
  return depth == 0 ? 0 : deeper(depth - 1) + frame_of_it[0];
}

int main(void) { return deeper(100000) & 1; }
