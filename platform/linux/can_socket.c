/* SPDX-License-Identifier: Apache-2.0 */
#define _GNU_SOURCE /* ppoll */

#include "platform/linux/can_socket.h"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>

#include "platform/linux/sys.h"

enum { RECEIVE_BUFFER = 1 << 20 };

static int refuse(can_socket *s, const char *what, const char *hint) {
  fprintf(stderr, "%s: %s: %s%s\n", s->name, what, strerror(errno), hint);
  can_close(s);
  return 0;
}

static int set_filters(const can_socket *s, const can_setting *setting) {
  struct can_filter filters[CAN_SOCKET_FILTERS];
  if (setting->count == 0) return 0;
  for (uint32_t n = 0; n < setting->count; ++n) {
    filters[n].can_id = setting->ids[n];
    filters[n].can_mask = CAN_SFF_MASK | CAN_EFF_FLAG | CAN_RTR_FLAG;
  }
  return sys_set_option(s->fd, SOL_CAN_RAW, CAN_RAW_FILTER, filters,
                        (socklen_t)(setting->count * sizeof filters[0]));
}

static int set_options(const can_socket *s, const can_setting *setting) {
  const int on = 1;
  const int buffer = RECEIVE_BUFFER;
  const can_err_mask_t errors = CAN_ERR_TX_TIMEOUT | CAN_ERR_BUSOFF | CAN_ERR_RESTARTED;
  if (setting->fd &&
      sys_set_option(s->fd, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on) != 0)
    return -1;
  /* as much as is allowed */
  (void)sys_set_option(s->fd, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer);
  return sys_set_option(s->fd, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, &on, sizeof on) != 0 ||
                 sys_set_option(s->fd, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors) != 0 ||
                 sys_set_option(s->fd, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on) != 0 ||
                 sys_set_option(s->fd, SOL_SOCKET, SO_TIMESTAMP, &on, sizeof on) != 0
             ? -1
             : 0;
}

/* Finds the interface and checks that it can send the frames that will be sent. */
static int find_interface(can_socket *s, const can_setting *setting, int *index) {
  struct ifreq request;
  memset(&request, 0, sizeof request);
  snprintf(request.ifr_name, sizeof request.ifr_name, "%s", s->name);
  if (sys_interface_index(s->fd, &request) != 0)
    return refuse(s, "no such interface", "; expected one that `ip link show type can` lists");
  *index = request.ifr_ifindex;
  if (!setting->sends_fd) return 1;
  if (sys_interface_mtu(s->fd, &request) != 0) return refuse(s, "its mtu cannot be read", "");
  if (request.ifr_mtu >= (int)CANFD_MTU) return 1;
  fprintf(stderr,
          "%s: takes classic frames only (mtu %d), expected CAN FD, mtu 72: ip link set IFACE mtu 72, "
          "of a controller also `type can ... dbitrate N fd on`; or --classic-tags\n",
          s->name, request.ifr_mtu);
  can_close(s);
  return 0;
}

int can_open(can_socket *s, const char *interface, const can_setting *setting) {
  struct sockaddr_can address;
  memset(s, 0, sizeof *s);
  memset(&address, 0, sizeof address);
  if ((size_t)snprintf(s->name, sizeof s->name, "%s", interface) >= sizeof s->name) {
    fprintf(stderr, "%s: no such interface; expected a name of at most %d characters\n", interface,
            (int)sizeof s->name - 1);
    s->fd = -1;
    return 0;
  }
  s->fd = sys_socket(PF_CAN, SOCK_RAW, CAN_RAW);
  if (s->fd < 0)
    return refuse(s, "no CAN socket", "; expected a kernel with CAN (modprobe can_raw)");
  if (!find_interface(s, setting, &address.can_ifindex)) return 0;
  address.can_family = AF_CAN;
  if (set_filters(s, setting) != 0 || set_options(s, setting) != 0)
    return refuse(s, "a socket option was refused", "");
  if (sys_bind(s->fd, (const struct sockaddr *)&address, sizeof address) != 0)
    return refuse(s, "cannot be bound", "");
  int fault = 0; /* an interface that is down can be bound, and says so here */
  socklen_t bytes = sizeof fault;
  if (sys_get_option(s->fd, SOL_SOCKET, SO_ERROR, &fault, &bytes) == 0 && fault != 0) {
    errno = fault;
    return refuse(s, "cannot be used", "; expected it to be up: ip link set IFACE up");
  }
  return 1;
}

void can_close(can_socket *s) {
  if (s->fd >= 0) (void)sys_close(s->fd);
  s->fd = -1;
}

static void read_control(can_socket *s, struct msghdr *message, int64_t *time_us) {
  for (struct cmsghdr *c = CMSG_FIRSTHDR(message); c != NULL; c = CMSG_NXTHDR(message, c)) {
    if (c->cmsg_level != SOL_SOCKET) continue;
    if (c->cmsg_type == SO_RXQ_OVFL) memcpy(&s->kernel_drops, CMSG_DATA(c), sizeof(uint32_t));
    if (c->cmsg_type == SO_TIMESTAMP) {
      struct timeval when;
      memcpy(&when, CMSG_DATA(c), sizeof when);
      *time_us = (int64_t)when.tv_sec * 1000000 + when.tv_usec;
    }
  }
}

static void take_frame(const struct canfd_frame *from, ssize_t bytes, frame *f) {
  memset(f, 0, sizeof *f);
  f->extended = (from->can_id & CAN_EFF_FLAG) != 0;
  f->rtr = (from->can_id & CAN_RTR_FLAG) != 0;
  f->error = (from->can_id & CAN_ERR_FLAG) != 0;
  if (bytes == CANFD_MTU) {
    f->fd = FRAME_FD;
    if ((from->flags & CANFD_BRS) != 0) f->fd |= FRAME_FD_BRS;
    if ((from->flags & CANFD_ESI) != 0) f->fd |= FRAME_FD_ESI;
  }
  f->id = from->can_id & (f->error || f->extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  f->length = from->len <= 64 ? from->len : 64;
  memcpy(f->data, from->data, f->length);
}

static void take_error(can_socket *s, const frame *f) {
  ++s->error_frames;
  if ((f->id & CAN_ERR_BUSOFF) != 0) s->bus_off = 1;
  if ((f->id & CAN_ERR_RESTARTED) != 0) s->bus_off = 0;
}

can_event can_receive(can_socket *s, frame *f, int64_t *time_us) {
  struct canfd_frame raw;
  char control[CMSG_SPACE(sizeof(struct timeval)) + CMSG_SPACE(sizeof(uint32_t)) + 64];
  struct iovec part = {&raw, sizeof raw};
  struct msghdr message;
  memset(&message, 0, sizeof message);
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  memset(&raw, 0, sizeof raw);
  *time_us = 0;
  const ssize_t bytes = sys_recvmsg(s->fd, &message);
  if (bytes != CAN_MTU && bytes != CANFD_MTU) {
    if (bytes < 0 && (errno == ENETDOWN || errno == ENODEV || errno == ENXIO))
      s->down = 1;
    else if (bytes >= 0 || (errno != EAGAIN && errno != EINTR))
      ++s->faults;
    return CAN_NOTHING;
  }
  s->down = 0;
  read_control(s, &message, time_us);
  take_frame(&raw, bytes, f);
  if (f->error) {
    take_error(s, f);
    return CAN_ERROR;
  }
  if ((message.msg_flags & MSG_CONFIRM) == 0) return CAN_RECEIVED;
  s->bus_off = 0; /* it was sent: down and up again ends a bus-off without an error frame */
  return CAN_ECHO;
}

int can_wait(can_socket *s, int64_t timeout_us) {
  struct pollfd waiting = {s->fd, POLLIN, 0};
  const struct timespec timeout = {(time_t)(timeout_us / 1000000),
                                   (long)(timeout_us % 1000000 * 1000)};
  const int ready = sys_poll(&waiting, 1, &timeout);
  if (ready < 0 && errno != EINTR) ++s->faults;
  return ready;
}

int can_send(can_socket *s, const frame *f) {
  struct canfd_frame raw;
  memset(&raw, 0, sizeof raw);
  raw.can_id = f->id;
  if (f->extended) raw.can_id |= CAN_EFF_FLAG;
  if (f->rtr) raw.can_id |= CAN_RTR_FLAG;
  raw.len = f->length;
  if ((f->fd & FRAME_FD_BRS) != 0) raw.flags |= CANFD_BRS;
  memcpy(raw.data, f->data, f->length);
  const size_t bytes = f->fd != 0 ? CANFD_MTU : CAN_MTU;
  if (sys_send(s->fd, &raw, bytes) == (ssize_t)bytes) {
    s->down = 0;
    return 1;
  }
  if (errno == ENOBUFS || errno == EAGAIN)
    ++s->send_full;
  else if (errno == ENETDOWN || errno == ENODEV || errno == ENXIO)
    s->down = 1;
  else
    ++s->faults;
  return 0;
}
