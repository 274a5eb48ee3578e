/* SPDX-License-Identifier: Apache-2.0 */
/* The tick of platform/bare/bare.h by SysTick. */
#ifndef FRAY_PLATFORM_CORTEXM_SYSTICK_H
#define FRAY_PLATFORM_CORTEXM_SYSTICK_H

void systick_handler(void);

#endif
