/* SPDX-License-Identifier: Apache-2.0 */
/* A board with a recording in flash as its bus: the first program to run on new hardware. The inputs of every
 * tick come from the recording, and every frame that the loop sends is compared with it; SYNC carries the
 * hash, so a port that ends without a difference computed every tick to the bit.
 *
 * The recording is in the order that `fray run --record` writes: inputs, SYNC, outputs of each
 * tick, and a closing SYNC. It is of instance 0. STATUS may differ in its count of overruns. */
#ifndef FRAY_PLATFORM_PLAYBACK_PLAYER_H
#define FRAY_PLATFORM_PLAYBACK_PLAYER_H

#include "platform/loop.h"

/* Ten bytes in flash; every message has eight bytes of data. */
typedef struct {
  uint16_t id;
  uint8_t data[DICTIONARY_LENGTH];
} player_frame;

typedef struct {
  const player_frame *frames;
  uint32_t count, at;
  uint32_t ticks;           /* SYNCs that the loop sent */
  uint32_t different;       /* frames that differ from the recording */
  uint32_t first_different; /* the tick of the first of them */
  uint32_t began;           /* counts of the clock from the tick's due time to its start */
  uint32_t worst;           /* counts of the clock that the longest tick took */
} player;

extern player playback;

/* Begins the tick (platform/bare/bare.h) too. The frames stay the caller's. */
void player_begin(const player_frame *frames, uint32_t count, uint32_t clock_hz, uint32_t rate_hz);

/* Compares the last hash with the closing SYNC. Returns the number of frames that differed in all. */
uint32_t player_end(const loop *l);

#endif
