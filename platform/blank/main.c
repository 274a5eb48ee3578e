/* SPDX-License-Identifier: Apache-2.0 */
/* One world on one bus: `fray scene X.scene --emit-c image -o image.c` writes the image. */
#include "platform/bare/bare.h"
#include "platform/loop.h"

extern const uint8_t image[];
extern const uint32_t image_bytes;

enum { CLOCK_HZ = 25000000, WORLD_BYTES = 8192 }; /* your clock; what fray_memory_size() says */

_Alignas(FRAY_ALIGN) static uint8_t memory[WORLD_BYTES];
static loop the_loop;

int main(void) {
  fray_world *world = 0;
  fray_error error;
  if (fray_open(image, image_bytes, memory, sizeof memory, &world, &error) != FRAY_OK) {
    platform_print("the image was refused: expected ");
    platform_print(error.what);
    platform_print("\n");
    return 1;
  }
  loop_begin(&the_loop, world, 0);
  tick_begin(CLOCK_HZ, fray_get_info(world).rate_hz);
  while (loop_run(&the_loop) != LOOP_STOPPED) {
  }
  return 0;
}
