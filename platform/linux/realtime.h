/* SPDX-License-Identifier: Apache-2.0 */
/* What a process asks of Linux to be on time. Each returns 1, or 0 after a message to stderr that
 * says which permission is missing. */
#ifndef FRAY_LINUX_REALTIME_H
#define FRAY_LINUX_REALTIME_H

int realtime_schedule(int priority); /* SCHED_FIFO, 1..99 */
int realtime_lock_memory(void);      /* mlockall, and a prefaulted stack */
int realtime_pin(int cpu);

#endif
