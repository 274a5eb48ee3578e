/* SPDX-License-Identifier: Apache-2.0 */
/* What figures belong to: the processor's own name, and the compiler. */
#ifndef FRAY_TOOLS_BENCH_MACHINE_H
#define FRAY_TOOLS_BENCH_MACHINE_H

typedef struct {
  char processor[96]; /* of /proc/cpuinfo; "unknown" where it does not say */
  long processors;    /* on line */
  const char *compiler;
} machine;

machine machine_here(void);

#endif
