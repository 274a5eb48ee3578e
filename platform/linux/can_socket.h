/* SPDX-License-Identifier: Apache-2.0 */
/* A raw SocketCAN socket: non-blocking, with exact filters, its own frames echoed back, error
 * frames, and the kernel's drop counter. */
#ifndef FRAY_PLATFORM_LINUX_CAN_SOCKET_H
#define FRAY_PLATFORM_LINUX_CAN_SOCKET_H

#include <stdint.h>

#include "rt/wire/frame.h"

enum { CAN_SOCKET_FILTERS = 64 };

typedef struct {
  int fd;
  char name[16];         /* of the interface */
  uint8_t bus_off;       /* seen bus-off and no restart yet */
  uint8_t down;          /* the interface is down or gone */
  uint32_t kernel_drops; /* frames that the kernel dropped for want of buffer, since open; its count wraps */
  uint64_t error_frames;
  uint32_t send_full;    /* ENOBUFS and EAGAIN */
  uint32_t faults;       /* any other failed call */
} can_socket;

typedef struct {
  uint16_t ids[CAN_SOCKET_FILTERS]; /* 11-bit ids to receive; count 0: everything */
  uint32_t count;
  int fd;                           /* 1: CAN FD frames too */
  int sends_fd;                     /* 1: refuse an interface that does not send CAN FD */
} can_setting;

typedef enum {
  CAN_NOTHING,  /* no frame now */
  CAN_RECEIVED, /* a frame of another node */
  CAN_ECHO,     /* one of this socket's own: it is on the bus */
  CAN_ERROR     /* an error frame; bus_off and down are up to date */
} can_event;

/* Returns 1, or 0 after a message to stderr that says what to do. */
int can_open(can_socket *s, const char *interface, const can_setting *setting);
void can_close(can_socket *s);

/* One frame, without waiting; its kernel time in microseconds since 1970 to *time_us. */
can_event can_receive(can_socket *s, frame *f, int64_t *time_us);

/* Waits until a frame can be read, at most `timeout_us`. Returns 1 iff one can, 0 after the time,
 * -1 when a signal or a fault cut it short. */
int can_wait(can_socket *s, int64_t timeout_us);

/* Returns 1 iff the kernel took it. 0: queue full, interface down (counted). */
int can_send(can_socket *s, const frame *f);

#endif
