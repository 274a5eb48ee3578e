/* SPDX-License-Identifier: Apache-2.0 */
/* A user's program: opens the image that it was built with and runs 100 ticks. */
#include <stdio.h>

#include "rt/fray.h"
#include "rt/wire/port.h"

extern const uint8_t image[];
extern const uint32_t image_bytes;
static _Alignas(FRAY_ALIGN) uint8_t memory[256 * 1024];

int main(void) {
  fray_world *world;
  fray_error error;
  port in;
  if (fray_open(image, image_bytes, memory, sizeof memory, &world, &error) != FRAY_OK) {
    printf("refused: %s\n", error.what);
    return 1;
  }
  port_init(&in, 0, fray_get_info(world).hands, NULL);
  for (int n = 0; n < 100; ++n) {
    fray_input input;
    fray_output output;
    port_take(&in, &input);
    fray_tick(world, &input, &output);
  }
  printf("%016llx\n", (unsigned long long)fray_hash(world));
  return 0;
}
