/* SPDX-License-Identifier: Apache-2.0 */
/* What the yarn level takes of a world's memory, as it is printed: what the same sheet takes less without. */
#include "tests/lib/test.h"

#include "tests/lib/world_fixture.h"
#include "tools/analysis/yarn_level.h"

static void open_sheet(fixture *f, const char *yarns) {
  fixture_print(f, "scene level\nrate 1000 Hz\nsubsteps 2\nwoven {\n warps 24\n wefts 16\n spacing 10 /cm\n"
                   " yarns %s\n}\npin row top\nlimits { contacts 500 }\n", yarns);
}

static void it_is_what_yarns_take(void) {
  fixture_scoped with = {0}, without = {0};
  open_sheet(&with, "on");
  open_sheet(&without, "off");
  const size_t more = with.memory_bytes - without.memory_bytes;
  const yarn_level level = yarn_level_of(with.w);
  printf("figure yarn_level %zu bytes, said to be %zu\n", more, level.bytes);
  CHECK(level.bytes <= more + more / 100 && level.bytes >= more - more / 100); /* arrays are aligned */
  CHECK_EQ_INT(yarn_level_of(without.w).bytes, 0);
}

int main(void) {
  TEST(it_is_what_yarns_take);
  return test_end();
}
