/* SPDX-License-Identifier: Apache-2.0 */
/* What the worlds of the cases take on a small machine, as the runtime accounts for it. Prints
 *
 *   world NAME BYTES          fray_bytes()
 *   pool NAME ARRAY BYTES PLACE   PLACE: ram, or flash for what is used in the image
 *   loop BYTES                what the loop and its port take beside a world */
#include "platform/loop.h"
#include "tests/cross/cases.h"

enum { MEMORY = 768 * 1024 };
static _Alignas(FRAY_ALIGN) uint8_t memory[MEMORY];

static void print_number(const char *label, uint32_t v) {
  char text[11];
  uint32_t at = 10;
  text[at] = 0;
  do {
    text[--at] = (char)('0' + v % 10u);
    v /= 10u;
  } while (v != 0);
  port_print(label);
  port_print(text + at);
}

static int print_case(const cross_case *c) {
  fray_world *world = 0;
  size_t bytes = 0;
  fray_pool pool;
  if (fray_bytes(c->image, c->image_bytes, &bytes, 0) != FRAY_OK ||
      fray_open(c->image, c->image_bytes, memory, MEMORY, &world, 0) != FRAY_OK)
    return 0;
  port_print("world ");
  port_print(c->name);
  print_number(" ", (uint32_t)bytes);
  for (uint32_t n = 0; fray_view_pool(world, n, &pool); ++n) {
    port_print("\npool ");
    port_print(c->name);
    port_print(" ");
    port_print(pool.name);
    print_number(" ", pool.count * pool.element_bytes);
    port_print(pool.in_place ? " flash" : " ram");
  }
  port_print("\n");
  return 1;
}

int main(void) {
  int good = 1;
  for (uint32_t n = 0; n < cross_case_count; ++n) good = print_case(&cross_cases[n]) && good;
  print_number("loop ", sizeof(loop));
  port_print("\n");
  return good ? 0 : 1;
}
