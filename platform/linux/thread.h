/* SPDX-License-Identifier: Apache-2.0 */
#ifndef FRAY_PLATFORM_LINUX_THREAD_H
#define FRAY_PLATFORM_LINUX_THREAD_H

#include <pthread.h>
#include <stddef.h>

/* Starts run(with) with all signals blocked, which are the caller's, on a stack of so many bytes: small, since a
 * real-time process locks it. Returns 0 where the system has none left. Any thread may call it. */
int thread_start(pthread_t *thread, size_t stack_bytes, void *(*run)(void *), void *with);

#endif
