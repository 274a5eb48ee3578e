/* SPDX-License-Identifier: Apache-2.0 */
/* A kernel of a test's own behind platform/linux/sys.h: virtual time, one CAN interface "sys0" that
 * echoes what is sent and filters what is received, a device that answers each SYNC, a file. Every call
 * takes a microsecond, unless told otherwise; any can fail. */
#ifndef FRAY_TESTS_SIM_SYS_FAULTS_H
#define FRAY_TESTS_SIM_SYS_FAULTS_H

#include <stddef.h>
#include <stdint.h>

#include "rt/wire/frame.h"

/* The calls of the loop and of the log's writer, then those that open and close its socket. */
typedef enum {
  CALL_RECEIVE,
  CALL_SEND,
  CALL_POLL,
  CALL_SLEEP,
  CALL_NOW,
  CALL_LOG,
  CALL_LOG_SYNC,
  CALL_SOCKET,
  CALL_INTERFACE,
  CALL_SET_OPTION,
  CALL_GET_OPTION,
  CALL_BIND,
  CALL_CLOSE,
  CALLS
} call_kind;

enum { CALLS_OF_LOOP = CALL_LOG_SYNC + 1 };
enum { KERNEL_FRAMES = 1 << 17, KERNEL_FILE = 1 << 23, KERNEL_FILTERS = 64, KERNEL_FD = 5 };

typedef struct {
  int64_t now_ns, last_fault_ns;
  int64_t call_ns;       /* what a call takes */
  uint64_t calls, reads; /* in all; of these, frames that were asked for */
  /* of the calls of `kinds` (bit k: kind k), those with number first..first + length - 1 fail */
  uint32_t kinds, first, length, number;
  int error;
  uint32_t failed;
  int64_t disk_room;   /* bytes that the file still takes; -1: any number */
  uint32_t short_write; /* so many bytes of a write at most; 0: all */
  int64_t sync_ns;     /* what a fdatasync takes, beside the call */
  int64_t signal_ns;   /* when `signal` comes; 0: none does */
  int signal;
  uint32_t down;       /* the interface: a bound socket says ENETDOWN */
  uint32_t deaf;       /* the bus does not confirm: nothing sent comes back */
  uint32_t swallowed;  /* frames of this id do not come back; 0: all do */
  uint32_t sockets;    /* open */
  uint32_t filters;    /* 0: everything */
  struct {
    uint32_t id, mask;
  } filter[KERNEL_FILTERS];
  /* the interface: what will be received, by time */
  struct {
    frame f;
    int64_t at_ns;
    uint8_t own;
  } rx[KERNEL_FRAMES];
  uint32_t rx_count, rx_taken;
  uint32_t last_sync_tick;
  uint8_t has_sync, counter, command;
  char *file;
  size_t file_bytes;
} kernel;

extern kernel sys;

void sys_begin(void);
void sys_end(void);
/* From now on: the n-th call (from 1) of each of these kinds together, and `length` in a row. */
void sys_fail(uint32_t kinds, uint32_t n, uint32_t length, int error);
/* Another node's frame, so long after now. */
void sys_inject(const frame *f, int64_t after_ns);
/* An operator's COMMAND on the bus, now. */
void sys_command(uint8_t verb);
/* The controller reports an error of this class (linux/can/error.h). */
void sys_error(uint32_t class);

#endif
