/* SPDX-License-Identifier: Apache-2.0 */
/* Every system call of the live loop, by one name each. A build with FRAY_SYS_FAULTS lets tests
 * make the n-th call fail; otherwise these are the calls themselves. */
#ifndef FRAY_LINUX_SYS_H
#define FRAY_LINUX_SYS_H

#include <errno.h>
#include <poll.h>
#include <sched.h>
#include <stdio.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#ifdef FRAY_SYS_FAULTS
/* Returns 0, or the errno that this call fails with. tests/bus/sys_faults.c. */
int sys_fault(const char *call);
#define SYS_FAULT(call) \
  do { \
    const int fault_ = sys_fault(call); \
    if (fault_ != 0) { \
      errno = fault_; \
      return -1; \
    } \
  } while (0)
#else
#define SYS_FAULT(call) ((void)0)
#endif

static inline ssize_t sys_recvmsg(int fd, struct msghdr *message) {
  SYS_FAULT("recvmsg");
  return recvmsg(fd, message, MSG_DONTWAIT);
}
static inline ssize_t sys_write(int fd, const void *data, size_t bytes) {
  SYS_FAULT("write");
  return write(fd, data, bytes);
}
static inline int sys_poll(struct pollfd *fds, nfds_t count, const struct timespec *timeout) {
  SYS_FAULT("poll");
  return ppoll(fds, count, timeout, NULL);
}
static inline int sys_sleep_until(const struct timespec *when) {
  SYS_FAULT("clock_nanosleep");
  const int fault = clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, when, NULL);
  if (fault == 0) return 0;
  errno = fault;
  return -1;
}
static inline int sys_now(struct timespec *now) {
  SYS_FAULT("clock_gettime");
  return clock_gettime(CLOCK_MONOTONIC, now);
}
static inline int sys_log(FILE *log, const char *text, size_t bytes) {
  SYS_FAULT("log");
  return fwrite(text, 1, bytes, log) == bytes ? 0 : -1;
}
static inline int sys_flush(FILE *log) {
  SYS_FAULT("flush");
  return fflush(log);
}

#endif
