/* SPDX-License-Identifier: Apache-2.0 */
#ifndef STAND_IN_ATOMIC_H
#define STAND_IN_ATOMIC_H

typedef long atomic_t;
typedef long atomic_val_t;
static inline atomic_val_t atomic_get(const atomic_t *target) { return *target; }
static inline atomic_val_t atomic_set(atomic_t *target, atomic_val_t value) {
  const atomic_val_t before = *target;
  *target = value;
  return before;
}

#endif
