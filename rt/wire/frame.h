/* SPDX-License-Identifier: Apache-2.0 */
/* One frame of a CAN bus, classic or FD, as every port and log hands it over. */
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
  uint8_t rtr;      /* 1: a request, length says how much is asked for, data is void */
  uint8_t error;    /* 1: not from the bus, the controller reports an error */
  uint8_t fd;       /* 0: classic; else FRAME_FD and what goes with it */
  uint8_t length;   /* 0..8, FD: 0..8, 12, 16, 20, 24, 32, 48, 64 */
  uint8_t data[FRAME_DATA];
} frame;

#endif
