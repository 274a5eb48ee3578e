/* SPDX-License-Identifier: Apache-2.0 */
#define _GNU_SOURCE

#include "platform/linux/realtime.h"

#include <errno.h>
#include <sched.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>

enum { STACK_BYTES = 256 * 1024 };

static int refuse(const char *what, const char *needs) {
  fprintf(stderr, "%s: %s; needs %s\n", what, strerror(errno), needs);
  return 0;
}

int realtime_schedule(int priority) {
  struct sched_param wish;
  memset(&wish, 0, sizeof wish);
  wish.sched_priority = priority;
  if (sched_setscheduler(0, SCHED_FIFO, &wish) == 0) return 1;
  return refuse("real-time scheduling", "CAP_SYS_NICE, or an rtprio limit (ulimit -r)");
}

int realtime_lock_memory(void) {
  volatile unsigned char stack[STACK_BYTES];
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0)
    return refuse("locking memory", "CAP_IPC_LOCK, or a memlock limit (ulimit -l)");
  for (unsigned n = 0; n < STACK_BYTES; n += 4096) stack[n] = 0;
  return stack[0] == 0;
}

int realtime_pin(int cpu) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET((unsigned)cpu, &set);
  if (sched_setaffinity(0, sizeof set, &set) == 0) return 1;
  return refuse("pinning to a CPU", "a CPU that this process may use");
}
