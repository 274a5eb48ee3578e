/* SPDX-License-Identifier: Apache-2.0 */
/* What the worlds of the cases take on a small machine, as the runtime accounts for it. Prints
 *
 *   world NAME BYTES          fray_memory_size()
 *   pool NAME ARRAY BYTES PLACE   PLACE: ram, or flash for what is used in the image
 *   loop BYTES                what the loop and its port take beside a world */
#include "platform/loop.h"
#include "tests/determinism/line.h"

enum { MEMORY = 768 * 1024 };
static _Alignas(FRAY_ALIGN) uint8_t memory[MEMORY];

static int print_case(const replay_case *c) {
  fray_world *world = 0;
  size_t bytes = 0;
  fray_pool pool;
  line l = {.length = 0};
  if (fray_memory_size(c->image, c->image_bytes, &bytes, 0) != FRAY_OK ||
      fray_open(c->image, c->image_bytes, memory, MEMORY, &world, 0) != FRAY_OK)
    return 0;
  add_text(&l, "world ");
  add_text(&l, c->name);
  add_text(&l, " ");
  add_number(&l, (uint32_t)bytes);
  print_line(&l);
  for (uint32_t n = 0; fray_view_pool(world, n, &pool); ++n) {
    add_text(&l, "pool ");
    add_text(&l, c->name);
    add_text(&l, " ");
    add_text(&l, pool.name);
    add_text(&l, " ");
    add_number(&l, pool.count * pool.element_bytes);
    add_text(&l, pool.in_place ? " flash" : " ram");
    print_line(&l);
  }
  return 1;
}

int main(void) {
  int good = 1;
  line l = {.length = 0};
  for (uint32_t n = 0; n < replay_case_count; ++n) good = print_case(&replay_cases[n]) && good;
  add_text(&l, "loop ");
  add_number(&l, sizeof(loop));
  print_line(&l);
  return good ? 0 : 1;
}
