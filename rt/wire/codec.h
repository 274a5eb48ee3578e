/* SPDX-License-Identifier: Apache-2.0 */
/* Frame <-> message. Every message is 8 bytes, little-endian, with an 11-bit id.
 *
 * A decode writes *out iff it returns CODEC_OK. It takes a CAN FD frame of 8 bytes as it takes
 * a classic one; an encode writes classic frames. `instance` is 0..7, `hand` 0 left or 1 right.
 * Cost: constant; with E2E 64 steps of a CRC. */
#ifndef FRAY_WIRE_CODEC_H
#define FRAY_WIRE_CODEC_H

#include <stdint.h>

#include "rt/fray.h"
#include "rt/wire/frame.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum {
  CODEC_OK = 0,
  CODEC_ID,       /* another id, or a 29-bit one */
  CODEC_FLAGS,    /* a remote request or an error frame */
  CODEC_LENGTH,   /* not 8 bytes */
  CODEC_CRC,      /* E2E: the check byte does not fit */
  CODEC_RESERVED, /* a reserved field is not 0 */
  CODEC_FIELD     /* a value outside its range */
} codec_reason;

/* A constant English phrase for a reason: "a wrong CRC". */
const char *codec_reason_text(codec_reason reason);

/* Opens tick `tick`. */
typedef struct {
  uint32_t tick;
  uint32_t hash; /* low 32 bits of the state's hash after the tick before */
} codec_sync;

/* 0.5 mN a step. */
typedef struct {
  int16_t x, y, z;
  uint8_t counter;  /* its tick & 15 */
  uint8_t consumed; /* counter of the last POSE that the tick consumed, 0 before the first */
} codec_force;

typedef struct {
  uint8_t counter; /* 0..15 */
  uint8_t verb;    /* 1..255; fray_verb, others are answered with FRAY_RESULT_UNKNOWN */
  uint32_t argument; /* no verb has one yet: send 0 */
} codec_command;

/* Its own counter is its tick & 15. */
typedef struct {
  uint8_t command_counter; /* of the COMMAND it answers, 0..15 */
  uint8_t verb;            /* 1..255 */
  uint8_t result;          /* fray_result */
  uint32_t tick;           /* the tick that took the COMMAND */
} codec_ack;

enum { CODEC_TEAR_STRUCTURAL = 1, CODEC_TEAR_TRIANGLES = 2, CODEC_TEAR_CUT = 3 };
typedef struct {
  uint8_t kind;     /* CODEC_TEAR_STRUCTURAL: a structural spring was cut; _TRIANGLES: a triangle sheet
                       tore; _CUT: a blade cut it */
  uint16_t more;    /* how many more in this tick, 65535: that many or more */
  uint32_t element; /* canonical id of the spring, see fray_sheet; the vertex where the sheet tore */
} codec_tear;

typedef struct {
  uint8_t state;        /* fray_state; 0 while the image is being checked */
  uint8_t fill_percent; /* of the fullest pool, 0..100 */
  uint16_t faults;      /* FRAY_FAULT_ bits */
  uint16_t overruns;    /* ticks that came late, saturated */
  uint16_t tears;       /* springs cut in all, saturated */
} codec_status;

void codec_encode_sync(frame *f, uint32_t instance, const codec_sync *in);
void codec_encode_pose(frame *f, uint32_t instance, uint32_t hand, const fray_pose *in);
void codec_encode_force(frame *f, uint32_t instance, uint32_t hand, const codec_force *in);
void codec_encode_command(frame *f, uint32_t instance, const codec_command *in);
void codec_encode_ack(frame *f, uint32_t instance, const codec_ack *in);
void codec_encode_tear(frame *f, uint32_t instance, const codec_tear *in);
void codec_encode_status(frame *f, uint32_t instance, const codec_status *in);

codec_reason codec_decode_sync(const frame *f, uint32_t instance, codec_sync *out);
codec_reason codec_decode_pose(const frame *f, uint32_t instance, uint32_t hand, fray_pose *out);
codec_reason codec_decode_force(const frame *f, uint32_t instance, uint32_t hand,
                                codec_force *out);
codec_reason codec_decode_command(const frame *f, uint32_t instance, codec_command *out);
codec_reason codec_decode_ack(const frame *f, uint32_t instance, codec_ack *out);
codec_reason codec_decode_tear(const frame *f, uint32_t instance, codec_tear *out);
codec_reason codec_decode_status(const frame *f, uint32_t instance, codec_status *out);

/* The parts of a decode, for a port that checks the frame when it arrives and its 8 bytes when
 * the tick comes: id, flags and length; then E2E and fields. */
codec_reason codec_check_frame(const frame *f, uint32_t id);
codec_reason codec_read_pose(const uint8_t *data, uint32_t instance, uint32_t hand,
                             fray_pose *out);
codec_reason codec_read_command(const uint8_t *data, uint32_t instance, codec_command *out);

#ifdef __cplusplus
}
#endif
#endif
