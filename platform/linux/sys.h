/* SPDX-License-Identifier: Apache-2.0 */
/* Every system call of the live loop and of opening its socket, by one name each. A build with
 * FRAY_SYS_FAULTS leaves them to a test (tests/sim/sys_faults.c), which simulates a kernel in virtual time;
 * any call of it can fail. */
#ifndef FRAY_PLATFORM_LINUX_SYS_H
#define FRAY_PLATFORM_LINUX_SYS_H

#include <errno.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#ifdef FRAY_SYS_FAULTS
int sys_socket(int domain, int type, int protocol);
int sys_interface_index(int fd, struct ifreq *request);
int sys_interface_mtu(int fd, struct ifreq *request);
int sys_set_option(int fd, int level, int name, const void *value, socklen_t bytes);
int sys_get_option(int fd, int level, int name, void *value, socklen_t *bytes);
int sys_bind(int fd, const struct sockaddr *address, socklen_t bytes);
int sys_close(int fd);
ssize_t sys_recvmsg(int fd, struct msghdr *message);
ssize_t sys_send(int fd, const void *data, size_t bytes);
int sys_poll(struct pollfd *fds, nfds_t count, const struct timespec *timeout);
int sys_sleep_until(const struct timespec *when);
int sys_now(struct timespec *now);
ssize_t sys_log(int fd, const char *text, size_t bytes);
int sys_log_sync(int fd);
#else
static inline int sys_socket(int domain, int type, int protocol) {
  return socket(domain, type, protocol);
}
static inline int sys_interface_index(int fd, struct ifreq *request) {
  return ioctl(fd, SIOCGIFINDEX, request);
}
static inline int sys_interface_mtu(int fd, struct ifreq *request) {
  return ioctl(fd, SIOCGIFMTU, request);
}
static inline int sys_set_option(int fd, int level, int name, const void *value, socklen_t bytes) {
  return setsockopt(fd, level, name, value, bytes);
}
static inline int sys_get_option(int fd, int level, int name, void *value, socklen_t *bytes) {
  return getsockopt(fd, level, name, value, bytes);
}
static inline int sys_bind(int fd, const struct sockaddr *address, socklen_t bytes) {
  return bind(fd, address, bytes);
}
static inline int sys_close(int fd) { return close(fd); }
static inline ssize_t sys_recvmsg(int fd, struct msghdr *message) {
  return recvmsg(fd, message, MSG_DONTWAIT);
}
/* Never waits for room: with a long queue (txqueuelen) the socket's own buffer is the first to fill. */
static inline ssize_t sys_send(int fd, const void *data, size_t bytes) {
  return send(fd, data, bytes, MSG_DONTWAIT);
}
static inline int sys_poll(struct pollfd *fds, nfds_t count, const struct timespec *timeout) {
  return ppoll(fds, count, timeout, NULL);
}
static inline int sys_sleep_until(const struct timespec *when) {
  const int fault = clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, when, NULL);
  if (fault == 0) return 0;
  errno = fault;
  return -1;
}
static inline int sys_now(struct timespec *now) { return clock_gettime(CLOCK_MONOTONIC, now); }
static inline ssize_t sys_log(int fd, const char *text, size_t bytes) {
  return write(fd, text, bytes);
}
static inline int sys_log_sync(int fd) { return fdatasync(fd); }
#endif

#endif
