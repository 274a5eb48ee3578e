/* SPDX-License-Identifier: Apache-2.0 */
#ifndef STAND_IN_KERNEL_H
#define STAND_IN_KERNEL_H

#include <stdint.h>

typedef struct {
  int64_t us;
} k_timeout_t;
#define K_USEC(n) ((k_timeout_t){(n)})
#define K_NO_WAIT ((k_timeout_t){0})

struct k_sem {
  unsigned count, limit;
};
int k_sem_init(struct k_sem *sem, unsigned count, unsigned limit);
int k_sem_take(struct k_sem *sem, k_timeout_t timeout);
void k_sem_give(struct k_sem *sem);
int32_t k_sleep(k_timeout_t timeout);
int64_t k_uptime_ticks(void);
static inline uint64_t k_ticks_to_us_floor64(uint64_t ticks) { return ticks; }

#endif
