/* SPDX-License-Identifier: Apache-2.0 */
#define _GNU_SOURCE
#define FRAY_SYS_FAULTS

#include "tests/sim/sys_faults.h"

#include <linux/can.h>
#include <linux/can/raw.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>

#include "platform/linux/sys.h"
#include "rt/wire/codec.h"

enum { CALL_NS = 1000, ECHO_NS = 60000, ANSWER_NS = 100000 };

kernel sys;

void sys_begin(void) {
  char *const file = sys.file != NULL ? sys.file : malloc(KERNEL_FILE);
  if (file == NULL) abort();
  memset(&sys, 0, offsetof(kernel, rx));
  sys.rx_count = sys.rx_taken = sys.last_sync_tick = 0;
  sys.has_sync = sys.counter = sys.command = 0;
  sys.file_bytes = 0;
  sys.file = file;
  sys.now_ns = 5000000000;
  sys.disk_room = -1;
  sys.call_ns = CALL_NS;
}

void sys_end(void) {
  free(sys.file);
  sys.file = NULL;
}

void sys_fail(uint32_t kinds, uint32_t n, uint32_t length, int error) {
  sys.kinds = kinds;
  sys.first = n;
  sys.length = length;
  sys.number = 0;
  sys.error = error;
  sys.failed = 0;
}

/* Whether the signal comes before this time. It is raised then. */
static int is_signalled(int64_t until_ns) {
  if (sys.signal_ns == 0 || sys.signal_ns > until_ns) return 0;
  if (sys.now_ns < sys.signal_ns) sys.now_ns = sys.signal_ns;
  sys.signal_ns = 0;
  (void)raise(sys.signal);
  return 1;
}

static int fails(call_kind kind) {
  sys.now_ns += sys.call_ns;
  ++sys.calls;
  (void)is_signalled(sys.now_ns);
  if ((sys.kinds >> kind & 1u) == 0) return 0;
  ++sys.number;
  if (sys.number < sys.first || sys.number - sys.first >= sys.length) return 0;
  ++sys.failed;
  sys.last_fault_ns = sys.now_ns;
  errno = sys.error;
  return 1;
}

static int passes(const frame *f) {
  if (f->error || sys.filters == 0) return 1;
  for (uint32_t n = 0; n < sys.filters; ++n)
    if ((f->id & sys.filter[n].mask) == (sys.filter[n].id & sys.filter[n].mask)) return 1;
  return 0;
}

/* Into the order of time; what comes at the same time, in the order of the calls. */
static void bring(const frame *f, int own, int64_t after_ns) {
  if (!passes(f)) return;
  if (sys.rx_count == KERNEL_FRAMES) abort();
  const int64_t at_ns = sys.now_ns + after_ns;
  uint32_t n = sys.rx_count++;
  for (; n > sys.rx_taken && sys.rx[n - 1].at_ns > at_ns; --n) sys.rx[n] = sys.rx[n - 1];
  sys.rx[n].f = *f;
  sys.rx[n].own = (uint8_t)own;
  sys.rx[n].at_ns = at_ns;
}

void sys_inject(const frame *f, int64_t after_ns) { bring(f, 0, after_ns); }

void sys_command(uint8_t verb) {
  frame f;
  sys.command = (uint8_t)((sys.command + 1u) & 15u);
  const codec_command command = {sys.command, verb, 0};
  codec_encode_command(&f, 0, &command);
  bring(&f, 0, 0);
}

void sys_error(uint32_t class) {
  frame f = {0};
  f.id = class;
  f.error = 1;
  f.length = 8;
  /* after what is still on its way */
  const int64_t last_ns = sys.rx_count > sys.rx_taken ? sys.rx[sys.rx_count - 1].at_ns : 0;
  bring(&f, 0, last_ns > sys.now_ns ? last_ns - sys.now_ns : 0);
}

/* The device: one pose a hand for each new SYNC. */
static void answer(const frame *f) {
  codec_sync sync;
  if (codec_decode_sync(f, 0, &sync) != CODEC_OK) return;
  if (sys.has_sync && sync.tick == sys.last_sync_tick) return;
  sys.has_sync = 1;
  sys.last_sync_tick = sync.tick;
  sys.counter = (uint8_t)((sys.counter + 1u) & 15u);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    frame pose;
    const fray_pose at = {0, 0, 0, sys.counter, 0};
    codec_encode_pose(&pose, 0, h, &at);
    bring(&pose, 0, ANSWER_NS);
  }
}

int sys_socket(int domain, int type, int protocol) {
  if (fails(CALL_SOCKET)) return -1;
  if (domain != PF_CAN || type != SOCK_RAW || protocol != CAN_RAW) abort();
  ++sys.sockets;
  return KERNEL_FD;
}

int sys_interface_index(int fd, struct ifreq *request) {
  if (fails(CALL_INTERFACE)) return -1;
  if (fd != KERNEL_FD || strcmp(request->ifr_name, "sys0") != 0) abort();
  request->ifr_ifindex = 7;
  return 0;
}

int sys_interface_mtu(int fd, struct ifreq *request) {
  if (fails(CALL_INTERFACE)) return -1;
  if (fd != KERNEL_FD) abort();
  request->ifr_mtu = CANFD_MTU;
  return 0;
}

int sys_set_option(int fd, int level, int name, const void *value, socklen_t bytes) {
  struct can_filter filters[KERNEL_FILTERS];
  if (fails(CALL_SET_OPTION)) return -1;
  if (fd != KERNEL_FD || bytes > sizeof filters) abort();
  if (level != SOL_CAN_RAW || name != CAN_RAW_FILTER) return 0;
  memcpy(filters, value, bytes);
  sys.filters = bytes / sizeof filters[0];
  for (uint32_t n = 0; n < sys.filters; ++n) {
    sys.filter[n].id = filters[n].can_id;
    sys.filter[n].mask = filters[n].can_mask;
  }
  return 0;
}

int sys_get_option(int fd, int level, int name, void *value, socklen_t *bytes) {
  const int fault = sys.down ? ENETDOWN : 0;
  if (fails(CALL_GET_OPTION)) return -1;
  if (fd != KERNEL_FD || level != SOL_SOCKET || name != SO_ERROR || *bytes < sizeof fault) abort();
  memcpy(value, &fault, sizeof fault);
  return 0;
}

int sys_bind(int fd, const struct sockaddr *address, socklen_t bytes) {
  struct sockaddr_can can;
  if (fails(CALL_BIND)) return -1;
  if (fd != KERNEL_FD || bytes != sizeof can) abort();
  memcpy(&can, address, sizeof can);
  if (can.can_family != AF_CAN || can.can_ifindex != 7) abort();
  return 0;
}

/* Linux closes a descriptor also where close() fails. */
int sys_close(int fd) {
  if (fd != KERNEL_FD || sys.sockets == 0) abort();
  --sys.sockets;
  return fails(CALL_CLOSE) ? -1 : 0;
}

ssize_t sys_send(int fd, const void *data, size_t bytes) {
  struct canfd_frame raw;
  frame f = {0};
  if (fails(CALL_SEND)) return -1;
  if (fd != KERNEL_FD) abort();
  memset(&raw, 0, sizeof raw);
  memcpy(&raw, data, bytes);
  f.id = raw.can_id & CAN_SFF_MASK;
  f.length = raw.len;
  memcpy(f.data, raw.data, 8);
  if (sys.deaf || (sys.swallowed != 0 && f.id == sys.swallowed)) return (ssize_t)bytes;
  bring(&f, 1, ECHO_NS);
  answer(&f);
  return (ssize_t)bytes;
}

static void put_time(struct msghdr *message, int64_t at_ns) {
  struct timeval when = {(time_t)(at_ns / 1000000000), (suseconds_t)(at_ns % 1000000000 / 1000)};
  struct cmsghdr *const c = CMSG_FIRSTHDR(message);
  c->cmsg_level = SOL_SOCKET;
  c->cmsg_type = SO_TIMESTAMP;
  c->cmsg_len = CMSG_LEN(sizeof when);
  memcpy(CMSG_DATA(c), &when, sizeof when);
  message->msg_controllen = CMSG_SPACE(sizeof when);
}

static int has_frame(void) {
  return sys.rx_taken < sys.rx_count && sys.rx[sys.rx_taken].at_ns <= sys.now_ns;
}

ssize_t sys_recvmsg(int fd, struct msghdr *message) {
  struct can_frame raw;
  if (fails(CALL_RECEIVE)) return -1;
  if (fd != KERNEL_FD) abort();
  if (!has_frame()) {
    errno = EAGAIN;
    return -1;
  }
  ++sys.reads;
  const uint32_t n = sys.rx_taken++;
  memset(&raw, 0, sizeof raw);
  raw.can_id = sys.rx[n].f.id | (sys.rx[n].f.error ? CAN_ERR_FLAG : 0);
  raw.len = sys.rx[n].f.length;
  memcpy(raw.data, sys.rx[n].f.data, 8);
  memcpy(message->msg_iov[0].iov_base, &raw, sizeof raw);
  message->msg_flags = sys.rx[n].own ? MSG_CONFIRM | MSG_DONTROUTE : 0;
  put_time(message, sys.rx[n].at_ns);
  return (ssize_t)sizeof raw;
}

int sys_poll(struct pollfd *fds, nfds_t count, const struct timespec *timeout) {
  (void)count;
  if (fails(CALL_POLL)) return -1;
  const int64_t end_ns = sys.now_ns + (int64_t)timeout->tv_sec * 1000000000 + timeout->tv_nsec;
  if (!has_frame() && sys.rx_taken < sys.rx_count && sys.rx[sys.rx_taken].at_ns <= end_ns)
    sys.now_ns = sys.rx[sys.rx_taken].at_ns;
  if (!has_frame()) {
    sys.now_ns = end_ns;
    return 0;
  }
  fds[0].revents = POLLIN;
  return 1;
}

int sys_sleep_until(const struct timespec *when) {
  if (fails(CALL_SLEEP)) return -1;
  const int64_t end_ns = (int64_t)when->tv_sec * 1000000000 + when->tv_nsec;
  errno = EINTR;
  if (sys.now_ns < end_ns && is_signalled(end_ns)) return -1;
  if (sys.now_ns < end_ns) sys.now_ns = end_ns;
  return 0;
}

int sys_now(struct timespec *now) {
  if (fails(CALL_NOW)) return -1;
  now->tv_sec = (time_t)(sys.now_ns / 1000000000);
  now->tv_nsec = (long)(sys.now_ns % 1000000000);
  return 0;
}

ssize_t sys_log(int fd, const char *text, size_t bytes) {
  (void)fd;
  if (fails(CALL_LOG)) return -1;
  if (sys.disk_room == 0) {
    errno = ENOSPC;
    return -1;
  }
  if (sys.disk_room > 0 && bytes > (size_t)sys.disk_room) bytes = (size_t)sys.disk_room;
  if (sys.short_write != 0 && bytes > sys.short_write) bytes = sys.short_write;
  if (sys.disk_room > 0) sys.disk_room -= (int64_t)bytes;
  if (sys.file_bytes + bytes > KERNEL_FILE) abort();
  memcpy(sys.file + sys.file_bytes, text, bytes);
  sys.file_bytes += bytes;
  return (ssize_t)bytes;
}

int sys_log_sync(int fd) {
  (void)fd;
  if (fails(CALL_LOG_SYNC)) return -1;
  sys.now_ns += sys.sync_ns;
  return 0;
}
