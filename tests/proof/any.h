/* SPDX-License-Identifier: Apache-2.0 */
/* Arbitrary values, for Frama-C: whatever these return, the harness must hold. */
#ifndef FRAY_TESTS_PROOF_ANY_H
#define FRAY_TESTS_PROOF_ANY_H

#include <stddef.h>
#include <stdint.h>

/*@ assigns \result \from \nothing;
  @ ensures least <= \result <= most; */
extern uint32_t any_between(uint32_t least, uint32_t most);

extern uint32_t any_word(void);
extern int32_t any32(void);
extern int64_t any64(void);
extern uint64_t any_wide(void);

/*@ requires \valid((uint8_t *)to + (0 .. bytes - 1));
  @ assigns ((uint8_t *)to)[0 .. bytes - 1] \from \nothing;
  @ ensures \initialized((uint8_t *)to + (0 .. bytes - 1)); */
extern void any_bytes(void *to, size_t bytes);

#endif
