/* SPDX-License-Identifier: Apache-2.0 */
/* A whole firmware: an image in flash whose constants are used in place, a recording in flash for
 * a bus, the loop of platform/loop.c at the image's rate. It prints
 *
 *   ticks N different N first TICK overruns N owed N|- worst US world BYTES flash BYTES
 *   stack BYTES of BYTES                                                     (in one line)
 *
 * flash: constants that the world did not have to copy; owed: overruns by a second clock, where the
 * board has one. Exit status 0 iff nothing differed and every overrun was counted. */
#include "platform/bare/bare.h"
#include "platform/playback/player.h"
#include "rt/base/bytes.h"
#include "rt/image/image.h"

extern const uint8_t image[];
extern const uint32_t image_bytes;
extern const player_frame recording[];
extern const uint32_t recording_count;

enum { HEADER = 4 * IMAGE_HEADER_WORDS }; /* what fray_memory_size() reads of an image */

_Alignas(FRAY_ALIGN) static uint8_t memory[FIRMWARE_WORLD];
static loop the_loop;

static void print_number(const char *name, uint32_t value) {
  platform_print(name);
  bare_print_number(value);
}

/* A copy of the header where no constant can be used in place tells what copying would take. */
static uint32_t bytes_in_flash(size_t world_bytes) {
  static uint8_t header[HEADER + 4];
  uint8_t *odd = header + (((uintptr_t)header & 1u) == 0);
  size_t copied = 0;
  bytes_copy(odd, image, HEADER);
  if (fray_memory_size(odd, image_bytes, &copied, 0) != FRAY_OK) return 0;
  return (uint32_t)(copied - world_bytes);
}

/* Beside the tick's own count, at the tick's clock. */
#if defined TARGET_CMSDK_TIMER
static volatile uint32_t *const second = (volatile uint32_t *)TARGET_CMSDK_TIMER;
static void second_begin(void) {
  second[1] = UINT32_MAX; /* downwards from there */
  second[2] = UINT32_MAX;
  second[0] = 1;
}
static uint32_t second_now(void) { return UINT32_MAX - second[1]; }
#elif defined TARGET_NRF51_TIMER
static volatile uint32_t *const second = (volatile uint32_t *)TARGET_NRF51_TIMER;
enum { START = 0x000, CAPTURE = 0x040, BITMODE = 0x508, PRESCALER = 0x510, CAPTURED = 0x540 };
static void second_begin(void) {
  second[BITMODE / 4] = 3; /* 32 bits */
  second[PRESCALER / 4] = 0;
  second[START / 4] = 1;
}
static uint32_t second_now(void) {
  second[CAPTURE / 4] = 1;
  return second[CAPTURED / 4];
}
#elif defined TARGET_MTIME
static void second_begin(void) {}
static uint32_t second_now(void) { return *(volatile uint32_t *)TARGET_MTIME; }
#endif
#if defined TARGET_CMSDK_TIMER || defined TARGET_NRF51_TIMER || defined TARGET_MTIME
#define SECOND_CLOCK
#endif

static int run(fray_world *world, uint32_t world_bytes) {
  loop *l = &the_loop;
  const uint32_t rate = fray_get_info(world).rate_hz;
  const uint32_t turn = TARGET_CLOCK_HZ / rate;
  int all_counted = 1;
  loop_begin(l, world, 0);
#ifdef SECOND_CLOCK
  second_begin();
  const uint32_t first = second_now();
  uint32_t last = first;
#endif
  player_begin(recording, recording_count, TARGET_CLOCK_HZ, rate);
  while (loop_run(l) == LOOP_TICKED) {
#ifdef SECOND_CLOCK
    last = second_now() - tick_spent(); /* when the tick was due */
#endif
  }
  const uint32_t different = player_end(l);
  print_number("ticks ", playback.ticks);
  print_number(" different ", different);
  print_number(" first ", playback.first_different);
  print_number(" overruns ", l->overruns);
#ifdef SECOND_CLOCK
  const uint32_t owed = (last - first + turn / 2u) / turn - playback.ticks;
  print_number(" owed ", owed);
  all_counted = owed == l->overruns;
#else
  platform_print(" owed -");
#endif
  print_number(" worst ", (uint32_t)((uint64_t)playback.worst * (1000000u / rate) / turn));
  print_number(" world ", world_bytes);
  print_number(" flash ", bytes_in_flash(world_bytes));
  print_number(" stack ", bare_stack_used());
  print_number(" of ", bare_stack_bytes());
  platform_print("\n");
  return different == 0 && all_counted ? 0 : 1;
}

int main(void) {
  size_t bytes = 0;
  fray_world *world = 0;
  fray_error error;
  if (fray_memory_size(image, image_bytes, &bytes, &error) == FRAY_OK &&
      fray_open(image, image_bytes, memory, sizeof memory, &world, &error) == FRAY_OK) {
#ifdef FIRMWARE_KERNEL
    if (!fray_set_kernel(world, FIRMWARE_KERNEL)) return 2;
#endif
    return run(world, (uint32_t)bytes);
  }
  platform_print("refused: expected ");
  platform_print(error.what);
  print_number(", world ", (uint32_t)bytes);
  platform_print("\n");
  return 2;
}
