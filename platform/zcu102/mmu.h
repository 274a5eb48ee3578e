/* SPDX-License-Identifier: Apache-2.0 */
#ifndef FRAY_PLATFORM_ZCU102_MMU_H
#define FRAY_PLATFORM_ZCU102_MMU_H

/* Maps memory flat and turns the caches on: code is read and run, constants are read, data is read
 * and written, devices from 3 GiB up are never run; page 0, the guard under the stack and
 * everything else is not there, and touching it is a fault. Call it once. */
void mmu_begin(void);

#endif
