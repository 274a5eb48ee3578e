/* SPDX-License-Identifier: Apache-2.0 */
#ifndef FRAY_TESTS_WCET_LONGEST_PATH_H
#define FRAY_TESTS_WCET_LONGEST_PATH_H

#include <stdint.h>

enum { NAME = 64, FILE_NAME = 128, FUNCTIONS_MAX = 1024, RULES_MAX = 512, LOOPS_MAX = 64, NEXT_MAX = 24 };

typedef enum {
  INSN_OTHER, INSN_BRANCH, INSN_JUMP, INSN_CALL, INSN_RETURN, INSN_MAY_RETURN, INSN_SWITCH, INSN_DATA
} insn_kind;

typedef struct {
  uint32_t at, target;
  insn_kind kind;
  char owner[NAME]; /* the function that the source line belongs to, inlined or not */
  char file[FILE_NAME];
  int line;
} insn;

/* An instruction as a node of its function's graph. */
typedef struct {
  int next[NEXT_MAX], next_count;
  char back[NEXT_MAX]; /* this way leads back to the head of a loop */
  char seen, header;
  long cost, distance;
} node;

typedef struct {
  char owner[NAME], text[128], count[NAME];
  int each, loose;
  long cost;
} rule;

typedef struct {
  int header, size, first_test;
  char *in;
  rule *rule;
  long round; /* longest way round, in instructions */
} loop;

typedef struct {
  char name[NAME];
  int first, count; /* in the code */
  node *nodes;
  int *order, order_count;
  loop loops[LOOPS_MAX];
  int loop_count, state, stamp;
  long fixed;
} function;

#endif
