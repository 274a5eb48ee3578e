/* SPDX-License-Identifier: Apache-2.0 */
/* One frame of a CAN bus, classic or FD, as boards, ports and logs exchange it. Data only. */
#ifndef FRAY_WIRE_FRAME_H
#define FRAY_WIRE_FRAME_H

#include <stdint.h>

enum {
  FRAME_DATA = 64,         /* bytes at most, FD */
  FRAME_DATA_CLASSIC = 8,  /* bytes at most, CAN 2.0 */
  FRAME_ID_MAX = 0x7FF,    /* 11 bits */
  FRAME_ID_EXTENDED_MAX = 0x1FFFFFFF
};

/* Bits of frame.fd; an FD frame always has FRAME_FD. */
enum { FRAME_FD_BRS = 1, FRAME_FD_ESI = 2, FRAME_FD = 4 };

typedef struct {
  uint32_t id;      /* without flag bits; of an error frame: its error class */
  uint8_t extended; /* 1: 29-bit id */
  uint8_t rtr;      /* 1: a remote request; length is the length asked for, data has no meaning */
  uint8_t error;    /* 1: no frame of the bus, but an error report of the controller */
  uint8_t fd;       /* 0: classic; else FRAME_FD and the bits that go with it */
  uint8_t length;   /* 0..8, FD: 0..8, 12, 16, 20, 24, 32, 48, 64 */
  uint8_t data[FRAME_DATA];
} frame;

#endif
