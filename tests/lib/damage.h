/* SPDX-License-Identifier: Apache-2.0 */
/* Images that are damaged, their CRC put right. */
#ifndef FRAY_TESTS_LIB_DAMAGE_H
#define FRAY_TESTS_LIB_DAMAGE_H

#include "rt/base/bytes.h"
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"

FIXTURE void damage_mend(fixture *f) {
  bytes_store32(f->image + 4 * IMAGE_CRC_WORD, bytes_crc32(f->image + IMAGE_CRC_FROM, f->image_bytes - IMAGE_CRC_FROM));
}

FIXTURE fray_status damage_open(fixture *f, fray_world **w, fray_error *error) {
  damage_mend(f);
  return fray_open(f->image, f->image_bytes, f->memory, f->memory_bytes, w, error);
}

/* Where a section of so many words begins; 0: there is none. */
FIXTURE size_t damage_section_at(const fixture *f, uint32_t section, uint32_t words) {
  for (size_t n = 4 * IMAGE_HEADER_WORDS; n + 4 * IMAGE_DIRECTORY_WORDS <= f->image_bytes; n += 4 * IMAGE_DIRECTORY_WORDS) {
    const uint8_t *entry = f->image + n;
    if (bytes_load32(entry) == section && bytes_load32(entry + 4) == 4 && bytes_load32(entry + 8) == words)
      return bytes_load32(entry + 12);
  }
  return 0;
}

/* Each bit of the section flipped: refused, with its name, or another world that runs. Returns how often it was
 * refused. */
FIXTURE uint32_t damage_each_bit(fixture *f, uint32_t section, uint32_t words) {
  const size_t at = damage_section_at(f, section, words);
  uint32_t refused = 0;
  CHECK(at != 0);
  for (size_t bit = 0; at != 0 && bit < (size_t)words * 32; ++bit) {
    uint8_t *byte = &f->image[at + bit / 8];
    fray_world *w;
    fray_error error;
    *byte = (uint8_t)(*byte ^ 1u << bit % 8);
    if (damage_open(f, &w, &error) == FRAY_OK) {
      fray_output out;
      for (uint32_t tick = 0; tick < 3; ++tick) fray_tick(w, &fixture_idle, &out);
    } else {
      CHECK_EQ_INT(error.section, section);
      CHECK(error.what != NULL);
      ++refused;
    }
    *byte = (uint8_t)(*byte ^ 1u << bit % 8);
  }
  return refused;
}

#endif
