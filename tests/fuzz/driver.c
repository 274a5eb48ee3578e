/* SPDX-License-Identifier: Apache-2.0 */
/* Random damage where there is no libFuzzer: driver SECONDS RUNS FOLDER
 * takes a file of FOLDER, damages it in a few places and feeds it, again and again, for so long or, where RUNS is
 * not 0, so often. The case that is being tried lies in FOLDER.last, so that a crash leaves it behind. */
#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);
size_t LLVMFuzzerMutate(uint8_t *data, size_t bytes, size_t room);
/* Where a harness has one. */
__attribute__((weak)) size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t bytes, size_t room, unsigned seed);

enum { SEEDS = 64, ROOM = 1 << 17, NAME = 512 };

static uint8_t *seed[SEEDS];
static size_t seed_bytes[SEEDS];
static uint32_t seeds;
static uint64_t state = 88172645463325252u;

static uint32_t below(uint32_t limit) {
  state ^= state << 13;
  state ^= state >> 7;
  state ^= state << 17;
  return limit == 0 ? 0 : (uint32_t)((state >> 16) % limit);
}

static void load(const char *folder) {
  char path[NAME];
  DIR *d = opendir(folder);
  for (struct dirent *e = d != NULL ? readdir(d) : NULL; e != NULL && seeds < SEEDS; e = readdir(d)) {
    snprintf(path, sizeof path, "%s/%s", folder, e->d_name);
    FILE *in = fopen(path, "rb");
    uint8_t *data = malloc(ROOM);
    if (in == NULL || data == NULL || e->d_name[0] == '.') continue;
    seed_bytes[seeds] = fread(data, 1, ROOM, in);
    seed[seeds++] = data;
    fclose(in);
  }
  if (d != NULL) closedir(d);
}

size_t LLVMFuzzerMutate(uint8_t *to, size_t size, size_t room) {
  static const int32_t edges[] = {0, 1, -1, 0x7FFFFFFF, INT32_MIN, 255, 65535, 16, 64};
  size_t bytes = size;
  (void)room;
  for (uint32_t n = 1 + below(4); n > 0 && bytes > 8; --n) {
    const uint32_t at = below((uint32_t)bytes - 8);
    switch (below(6)) {
      case 0: to[at] = (uint8_t)(to[at] ^ 1u << below(8)); break;
      case 1: to[at] = (uint8_t)below(256); break;
      case 2: memcpy(to + (at & ~3u), &edges[below(9)], 4); break;
      case 3: bytes = below(16) == 0 ? at : bytes; break;
      case 4: memmove(to + at, to + below((uint32_t)bytes - 8), 8); break;
      default:
        memmove(to + at, to + at + 1, bytes - at - 1);
        bytes -= 1;
        break;
    }
  }
  return bytes;
}

static size_t damage(uint8_t *to) {
  const uint32_t from = below(seeds);
  memcpy(to, seed[from], seed_bytes[from]);
  if (LLVMFuzzerCustomMutator != NULL)
    return LLVMFuzzerCustomMutator(to, seed_bytes[from], ROOM, below(UINT32_MAX));
  return LLVMFuzzerMutate(to, seed_bytes[from], ROOM);
}

int main(int argc, char **argv) {
  static uint8_t data[ROOM];
  char last[NAME];
  unsigned long tried = 0;
  if (argc != 4) return 2;
  load(argv[3]);
  if (seeds == 0) return 2;
  snprintf(last, sizeof last, "%s.last", argv[3]);
  const unsigned long runs = strtoul(argv[2], NULL, 10);
  const time_t end = time(NULL) + (time_t)strtol(argv[1], NULL, 10);
  while (runs != 0 ? tried < runs : time(NULL) < end) {
    const size_t bytes = damage(data);
    FILE *out = fopen(last, "wb");
    if (out == NULL || fwrite(data, 1, bytes, out) != bytes || fclose(out) != 0) return 2;
    (void)LLVMFuzzerTestOneInput(data, bytes);
    tried++;
  }
  printf("%lu cases\n", tried);
  return 0;
}
