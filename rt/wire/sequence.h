/* SPDX-License-Identifier: Apache-2.0 */
/* The counters of one hand's POSE, modulo 16: new, repeated, or old.
 *
 * A counter 1 to 8 ahead of the last accepted one is new; 9 to 15 ahead belongs to a frame that was overtaken
 * on its way and is too old, so a swapped pair or a delayed frame never moves a hand back. Three old counters
 * in a row, each one more than the one before, are a device that started again: the third is new.
 *
 * No tick enters here, so a replay of the same frames in the same order gives the same results.
 *
 * Contract of all functions here. Context: any thread or interrupt, one at a time for each sequence.
 * NULL: never. Errors: none. */
#ifndef FRAY_WIRE_SEQUENCE_H
#define FRAY_WIRE_SEQUENCE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { SEQUENCE_AHEAD = 8, SEQUENCE_RESTART = 3 };

typedef struct {
  uint8_t last;     /* 0..15: the last counter that was new */
  uint8_t old_next; /* 0..15: the counter that would continue the run of old ones */
  uint8_t old_run;  /* 0 to SEQUENCE_RESTART - 1: old counters in a row */
} sequence;

typedef enum { SEQUENCE_NEW, SEQUENCE_REPEATED, SEQUENCE_OLD } sequence_result;

/* Starts a sequence. last: 0 at tick 0, so that a device's first POSE has counter 1; its low four bits count.
 * Cost: constant. */
void sequence_begin(sequence *s, uint8_t last);

/* How far a counter is ahead of the last one: 0..15. counter <= 15. Cost: constant. */
uint32_t sequence_ahead(const sequence *s, uint8_t counter);

/* Judges a counter and remembers it. counter <= 15. Cost: constant. */
sequence_result sequence_take(sequence *s, uint8_t counter);

#ifdef __cplusplus
}
#endif
#endif
