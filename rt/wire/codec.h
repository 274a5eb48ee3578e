/* SPDX-License-Identifier: Apache-2.0 */
/* Frame <-> message. Every message is 8 bytes, little-endian, with an 11-bit id.
 *
 * A decode accepts any frame, and a CAN FD frame of 8 bytes as a classic one; an encode writes classic
 * frames.
 *
 * Contract of all functions here. Context: any thread or interrupt, at the same time too: nothing is kept.
 * NULL: never. instance: 0..7, a runtime on the bus. hand: 0 is left, 1 is right. An encode is given values
 * in the ranges below. A decode writes *out iff it returns CODEC_OK; any other reason is its error. */
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

/* A constant English phrase for a reason, "a wrong CRC"; never NULL. Cost: constant. */
const char *codec_reason_text(codec_reason reason);

/* Starts tick `tick`. */
typedef struct {
  uint32_t tick; /* its low 32 bits */
  uint32_t hash; /* low 32 bits of the state's hash after the tick before */
} codec_sync;

/* 0.5 mN a step. */
typedef struct {
  int16_t x, y, z;
  uint8_t counter;  /* its tick & 15 */
  uint8_t consumed; /* counter of the last POSE that the tick consumed, 0 before the first */
} codec_force;

typedef struct {
  uint8_t counter;   /* 0..15 */
  uint8_t command;   /* 1..255: fray_command; others are answered with FRAY_RESULT_UNKNOWN */
  uint32_t argument; /* no command has one yet: send 0 */
} codec_command;

/* Its own counter is its tick & 15. */
typedef struct {
  uint8_t command_counter; /* 0..15: of the COMMAND that it answers */
  uint8_t command;         /* 1..255: as in that COMMAND */
  uint8_t result;          /* fray_result */
  uint32_t tick;           /* low 32 bits of that which took the COMMAND */
} codec_ack;

enum { CODEC_TEAR_STRUCTURAL = 1, CODEC_TEAR_TRIANGLES = 2, CODEC_TEAR_CUT = 3 };
typedef struct {
  uint8_t kind;     /* CODEC_TEAR_STRUCTURAL: a structural spring broke; _TRIANGLES: a membrane tore; _CUT: a
                       blade cut it */
  uint16_t more;    /* how many more in this tick; 65535: that many or more */
  uint32_t element; /* canonical id of the spring, see fray_weave, or the vertex where the membrane tore */
} codec_tear;

typedef struct {
  uint8_t state;        /* fray_state; 0 while the image is being checked */
  uint8_t fill_percent; /* of the fullest pool, 0..100 */
  uint16_t faults;      /* FRAY_FAULT_ bits, within FRAY_FAULTS_ALL */
  uint16_t overruns;    /* ticks that came late, saturated */
  uint16_t tears;       /* breaks, tears and cuts in all, saturated */
} codec_status;

/* Before the first SYNC of a session, and before that of every tick whose low 32 bits are 0. */
typedef struct {
  uint32_t physics;   /* PHYSICS_ID of the runtime: equal ids, equal hashes */
  uint32_t tick_high; /* high 32 bits of the next tick */
} codec_identity;

/* Writes a whole SYNC. Cost: constant. */
void codec_encode_sync(frame *f, uint32_t instance, const codec_sync *in);
/* Writes a whole POSE. Cost: 64 steps of a CRC. */
void codec_encode_pose(frame *f, uint32_t instance, uint32_t hand, const fray_pose *in);
/* Writes a whole FORCE. Cost: 64 steps of a CRC. */
void codec_encode_force(frame *f, uint32_t instance, uint32_t hand, const codec_force *in);
/* Writes a whole COMMAND. Cost: 64 steps of a CRC. */
void codec_encode_command(frame *f, uint32_t instance, const codec_command *in);
/* Writes a whole ACK. Cost: 64 steps of a CRC. */
void codec_encode_ack(frame *f, uint32_t instance, const codec_ack *in);
/* Writes a whole TEAR. Cost: constant. */
void codec_encode_tear(frame *f, uint32_t instance, const codec_tear *in);
/* Writes a whole STATUS. Cost: constant. */
void codec_encode_status(frame *f, uint32_t instance, const codec_status *in);
/* Writes a whole IDENTITY. Cost: constant. */
void codec_encode_identity(frame *f, uint32_t instance, const codec_identity *in);

/* Reads SYNC. Cost: constant. */
codec_reason codec_decode_sync(const frame *f, uint32_t instance, codec_sync *out);
/* Reads POSE. Cost: 64 steps of a CRC. */
codec_reason codec_decode_pose(const frame *f, uint32_t instance, uint32_t hand, fray_pose *out);
/* Reads FORCE. Cost: 64 steps of a CRC. */
codec_reason codec_decode_force(const frame *f, uint32_t instance, uint32_t hand, codec_force *out);
/* Reads COMMAND. Cost: 64 steps of a CRC. */
codec_reason codec_decode_command(const frame *f, uint32_t instance, codec_command *out);
/* Reads ACK. Cost: 64 steps of a CRC. */
codec_reason codec_decode_ack(const frame *f, uint32_t instance, codec_ack *out);
/* Reads TEAR. Cost: constant. */
codec_reason codec_decode_tear(const frame *f, uint32_t instance, codec_tear *out);
/* Reads STATUS. Cost: constant. */
codec_reason codec_decode_status(const frame *f, uint32_t instance, codec_status *out);
/* Reads IDENTITY. Cost: constant. */
codec_reason codec_decode_identity(const frame *f, uint32_t instance, codec_identity *out);

/* The two parts of a decode, for a port that checks a frame when it arrives and reads its 8 bytes in the
 * tick. */

/* Id, flags and length. id: 0..0x7FF, the id expected. Cost: constant. */
codec_reason codec_check_frame(const frame *f, uint32_t id);
/* E2E check and fields of the 8 bytes of a POSE. Cost: 64 steps of a CRC. */
codec_reason codec_read_pose(const uint8_t *data, uint32_t instance, uint32_t hand, fray_pose *out);
/* E2E check and fields of the 8 bytes of a COMMAND. Cost: 64 steps of a CRC. */
codec_reason codec_read_command(const uint8_t *data, uint32_t instance, codec_command *out);

#ifdef __cplusplus
}
#endif
#endif
