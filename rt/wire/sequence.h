/* SPDX-License-Identifier: Apache-2.0 */
/* The counters of one hand's POSE, modulo 16: new, repeated, or old.
 *
 * New is what is 1 to 8 ahead of the last accepted one; 9 to 15 ahead is a frame that was overtaken
 * and comes too late, so a swapped pair or a delayed frame never moves a hand back. Three old ones
 * in a row, each one more than the one before, are a device that began anew: the third is new.
 *
 * It knows nothing of ticks, so a replay of the same frames in the same order says the same. */
#ifndef FRAY_WIRE_SEQUENCE_H
#define FRAY_WIRE_SEQUENCE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { SEQUENCE_AHEAD = 8, SEQUENCE_RESTART = 3 };

typedef struct {
  uint8_t last;     /* counter of the last new one */
  uint8_t old_next; /* what would go on with the old ones */
  uint8_t old_run;  /* how many old ones in a row */
} sequence;

typedef enum { SEQUENCE_NEW, SEQUENCE_REPEATED, SEQUENCE_OLD } sequence_result;

/* `last`: 0 at tick 0, so a device's first POSE has counter 1. */
void sequence_begin(sequence *s, uint8_t last);

/* How far a counter, 0..15, is ahead of the last one: 0..15. */
uint32_t sequence_ahead(const sequence *s, uint8_t counter);

/* Takes a counter, 0..15. Cost: constant. */
sequence_result sequence_take(sequence *s, uint8_t counter);

#ifdef __cplusplus
}
#endif
#endif
