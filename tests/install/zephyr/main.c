/* SPDX-License-Identifier: Apache-2.0 */
/* A user's program under the module: 1000 ticks on the bus. A device in it answers each SYNC with a
 * POSE; the bus is down for 10 ticks of them. */
#include <stdio.h>
#include <string.h>

#include "platform/loop.h"
#include "platform/zephyr/board.h"
#include "tests/install/zephyr/stand_in/driver.h"

extern const uint8_t image[];
extern const uint32_t image_bytes;
static _Alignas(FRAY_ALIGN) uint8_t memory[256 * 1024];
static unsigned syncs, forces;
static uint8_t counter;

void driver_sent(const struct can_frame *sent) {
  if (sent->id == 0x181) ++forces;
  if (sent->id != 0x080) return;
  ++syncs;
  frame f;
  counter = (uint8_t)((counter + 1u) & 15u);
  const fray_pose pose = {0, 0, 0, counter, 0};
  codec_encode_pose(&f, 0, 0, &pose);
  struct can_frame out = {f.id, f.length, 0, {0}};
  memcpy(out.data, f.data, 8);
  driver_receive(&out);
}

int main(void) {
  static const struct device can = {"can0"};
  static loop l;
  fray_world *world;
  fray_error error;
  unsigned ticks = 0, lost = 0;
  if (fray_open(image, image_bytes, memory, sizeof memory, &world, &error) != FRAY_OK) return 1;
  loop_begin(&l, world, 0);
  if (board_begin(&can) != 0) return 2;
  while (ticks < 1000) {
    driver_down = ticks == 500 && lost < 10;
    const loop_result result = loop_run(&l);
    if (result == LOOP_STOPPED) return 3;
    if (result == LOOP_TICKED) ++ticks; else ++lost;
  }
  const frame sealed = {.id = 0x181, .fd = FRAME_FD, .length = 24};
  if (platform_send(&sealed) == PLATFORM_SENT) return 5;
  board_stop();
  if (loop_run(&l) != LOOP_STOPPED) return 4;
  printf("ticks %u lost %u syncs %u poses %u forces %u overruns %u halts %d\n", ticks, lost, syncs,
         (unsigned)l.in.statistics.accepted, forces, (unsigned)l.overruns, l.output.state == FRAY_SAFE);
  return 0;
}
