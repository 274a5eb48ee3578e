/* SPDX-License-Identifier: Apache-2.0 */
/* What the example of platform/zephyr/README.md stands in. */
#include "platform/loop.h"
#include "platform/zephyr/board.h"
#include "tests/install/zephyr/stand_in/driver.h"

#define DT_CHOSEN(name) 0
#define DEVICE_DT_GET(node) (&can)
static const struct device can = {"can0"};

void run(loop *here, fray_world *world);
void run(loop *here, fray_world *world) {
#define l *here
/* block */
#undef l
}
