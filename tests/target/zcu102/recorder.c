/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/target/zcu102/recorder.h"

#include "platform/zcu102/console.h"

enum { FRAMES = 100000, SECOND_US = 1000000 };

typedef struct {
  uint64_t time_us;
  uint16_t id;
  uint8_t length;
  uint8_t data[FRAME_DATA_CLASSIC];
} recorded;

__attribute__((section(".trace"))) static recorded frames[FRAMES];
static uint32_t count;

void recorder_add(const frame *f, uint64_t time_us) {
  if (count < FRAMES) {
    recorded *r = &frames[count];
    r->time_us = time_us;
    r->id = (uint16_t)f->id;
    r->length = f->length;
    for (uint32_t n = 0; n < f->length; ++n) r->data[n] = f->data[n];
  }
  ++count;
}

static void print_frame(const recorded *r) {
  platform_print("(");
  console_number(r->time_us / SECOND_US, 10);
  platform_print(".");
  console_number(r->time_us % SECOND_US, 6);
  platform_print(") can1 ");
  console_hex(r->id, 3);
  platform_print("#");
  for (uint32_t n = 0; n < r->length; ++n) console_hex(r->data[n], 2);
  platform_print("\n");
}

int recorder_print(void) {
  const uint32_t kept = count < FRAMES ? count : (uint32_t)FRAMES;
  for (uint32_t n = 0; n < kept; ++n) print_frame(&frames[n]);
  return kept == count;
}
