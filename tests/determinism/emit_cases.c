/* SPDX-License-Identifier: Apache-2.0 */
/* emit NAME IMAGE LOG|- SILENCE|- TICKS ...: writes the table of cases.h to stdout, on the host.
 * The inputs of a device log become one fray_input a tick, as `fray run` would give them. SILENCE
 * is HAND:FROM:TO: poses of hand 0 or 1 that did not come in ticks FROM to TO - 1. They are taken
 * out here, so that no rule of the port on counters can change what the cases are given. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/recording/session.h"

enum { WORDS = 5 }; /* of a case */

typedef struct {
  unsigned hand, from, to;
} silence;

static void print_bytes(const char *name, const uint8_t *bytes, size_t count) {
  printf("_Alignas(16) static const uint8_t image_%s[%zu] = {", name, count);
  for (size_t n = 0; n < count; ++n) printf("%s%u,", n % 24 == 0 ? "\n" : "", bytes[n]);
  printf("\n};\n");
}

static void print_input(fray_input i, uint32_t tick, const silence *silent) {
  if (tick >= silent->from && tick < silent->to) {
    memset(&i.pose[silent->hand], 0, sizeof i.pose[0]);
    i.has_pose = (uint8_t)(i.has_pose & ~(1u << silent->hand));
  }
  printf("  {%u, {", i.has_pose);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    printf("{%d,%d,%d,%u,%u},", i.pose[h].x, i.pose[h].y, i.pose[h].z, i.pose[h].counter,
           i.pose[h].buttons);
  printf("}, %u, %u},\n", i.command, i.command_counter);
}

static int print_case(char **word) {
  session s;
  silence silent = {0, 0, 0};
  if (word[3][0] != '-' &&
      sscanf(word[3], "%u:%u:%u", &silent.hand, &silent.from, &silent.to) != 3)
    return 0;
  if (silent.hand >= FRAY_HANDS) return 0;
  const int has_log = word[2][0] != '-';
  if (session_open(&s, word[1], &(session_log){.file = has_log ? word[2] : NULL}, 0) != 0) return 0;
  print_bytes(word[0], s.world_file.image, s.world_file.image_bytes);
  printf("static const fray_input inputs_%s[%" PRIu32 "] = {\n", word[0], s.log.count + 1);
  for (uint32_t n = 0; n <= s.log.count; ++n) print_input(*session_input(&s, n), n, &silent);
  printf("};\n");
  session_close(&s);
  return 1;
}

int main(int argc, char **argv) {
  if (argc < 2 || (argc - 1) % WORDS != 0) {
    fprintf(stderr, "usage: emit NAME IMAGE LOG|- SILENCE|- TICKS ...\n");
    return 2;
  }
  printf("#include \"tests/determinism/cases.h\"\n");
  for (int n = 1; n < argc; n += WORDS)
    if (!print_case(argv + n)) return 2;
  printf("const replay_case replay_cases[] = {\n");
  for (int n = 1; n < argc; n += WORDS)
    printf("  {\"%s\", image_%s, sizeof image_%s, inputs_%s, sizeof inputs_%s / sizeof(fray_input), "
           "%s},\n",
           argv[n], argv[n], argv[n], argv[n], argv[n], argv[n + WORDS - 1]);
  printf("};\nconst uint32_t replay_case_count = %d;\n", (argc - 1) / WORDS);
  return fflush(stdout) == 0 ? 0 : 1;
}
