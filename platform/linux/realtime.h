/* SPDX-License-Identifier: Apache-2.0 */
/* Requests to Linux that keep a process on time. Each returns 1, or 0 after a message to stderr that names
 * the missing permission. */
#ifndef FRAY_PLATFORM_LINUX_REALTIME_H
#define FRAY_PLATFORM_LINUX_REALTIME_H

int realtime_schedule(int priority); /* SCHED_FIFO, 1..99 */
int realtime_lock_memory(void);      /* mlockall, and a prefaulted stack */
int realtime_pin(int cpu);

#endif
