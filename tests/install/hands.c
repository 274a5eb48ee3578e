/* SPDX-License-Identifier: Apache-2.0 */
/* Two hands pull a cloth apart: poses in, forces out, every error handled. */
#include <stdio.h>

#include "rt/fray.h"

extern const uint8_t image[]; /* fray scene two_hands.scene --emit-c image -o image.c */
extern const uint32_t image_bytes;
static _Alignas(FRAY_ALIGN) uint8_t memory[2 * 1024 * 1024];

/* Your device goes here: where the hand is, 2 um a step. This one pulls apart at 20 cm/s. */
static fray_pose read_pose(unsigned hand, unsigned tick) {
  const int pulled = tick < 200 ? 0 : (int)(tick - 200) * 100;
  const fray_pose pose = {.x = (int16_t)(hand == 0 ? -pulled : pulled), .counter = (tick + 1) & 15};
  return pose;
}

/* And here: what the hand is to feel, 0.5 mN a step. */
static void set_force(unsigned hand, unsigned tick, const int16_t force[3]) {
  if (tick % 100 == 99) printf("%3u ms, hand %u: %7.1f mN\n", tick + 1, hand, force[0] * 0.5);
}

int main(void) {
  fray_world *world;
  fray_error error;
  if (fray_open(image, image_bytes, memory, sizeof memory, &world, &error) != FRAY_OK) {
    fprintf(stderr, "image refused, section %u element %u: expected %s\n", (unsigned)error.section,
            (unsigned)error.index, error.what);
    return 1;
  }
  const uint8_t hands = (uint8_t)fray_get_info(world).hands;
  for (unsigned tick = 0; tick < 500; ++tick) { /* once a period of fray_get_info(world).rate_hz */
    fray_input input = {.has_pose = hands};
    fray_output output;
    for (unsigned hand = 0; hand < FRAY_HANDS; ++hand) input.pose[hand] = read_pose(hand, tick);
    if (tick == 20) input.command = FRAY_COMMAND_START;
    fray_tick(world, &input, &output);
    for (unsigned hand = 0; hand < FRAY_HANDS; ++hand) set_force(hand, tick, output.force[hand]);
    if (output.work.tears != 0) printf("%3u ms: %u springs tear\n", tick + 1, (unsigned)output.work.tears);
    if (output.answered != FRAY_COMMAND_NONE && output.result != FRAY_RESULT_OK) return 2;
    if (output.state == FRAY_SAFE) {
      fprintf(stderr, "safe stop, faults %03x\n", (unsigned)output.faults);
      return 3; /* forces are zero until FRAY_COMMAND_RESET, then START */
    }
  }
  printf("hash %016llx\n", (unsigned long long)fray_hash(world));
  return 0;
}
