/* SPDX-License-Identifier: Apache-2.0 */
/* A plugin of QEMU's (API version 1) that counts the instructions of a program by stage of the tick.
 * The program is the product's own code: a stage begins where its function is entered, and ends
 * where the tick itself goes on. A stage that the program does not have counts nothing; one that is
 * entered twice between two marks but stands as once a tick ends the run. At each entry of work_mark() a line is written: the instructions since
 * the last one, of the tick itself, of every stage and of the hash.
 *
 *   -plugin libstage_count.so,stages=FILE,symbols=FILE,out=FILE
 *       stages: stages.txt; symbols: `address size name` a line, as nm -S
 *
 * With `,plain=1` a program needs no stages, and a line is the instructions since the last one.
 *
 * The few functions of the interface that are used are declared here, so that no header is needed. */
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct qemu_plugin_tb;
struct qemu_plugin_insn;
typedef void (*translated_cb)(uint64_t id, struct qemu_plugin_tb *block);
typedef void (*executed_cb)(unsigned cpu, void *data);
void qemu_plugin_register_vcpu_tb_trans_cb(uint64_t id, translated_cb cb);
void qemu_plugin_register_atexit_cb(uint64_t id, void (*cb)(uint64_t id, void *data), void *data);
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *block);
struct qemu_plugin_insn *qemu_plugin_tb_get_insn(const struct qemu_plugin_tb *block, size_t n);
uint64_t qemu_plugin_insn_vaddr(const struct qemu_plugin_insn *insn);
void qemu_plugin_register_vcpu_insn_exec_cb(struct qemu_plugin_insn *insn, executed_cb cb, int flags,
                                            void *data);
void qemu_plugin_register_vcpu_insn_exec_inline(struct qemu_plugin_insn *insn, int operation,
                                                void *counter, uint64_t by);

#define EXPORTED __attribute__((visibility("default")))
EXPORTED int qemu_plugin_version = 1;
EXPORTED int qemu_plugin_install(uint64_t id, const void *info, int argc, char **argv);

/* What is counted apart: of the functions that are the tick itself the first is column 0. */
enum { NAME = 64, STEP = 0, COLUMNS = 64, OUTSIDE = COLUMNS, PLACES, STEPS = 8 };
typedef struct {
  char name[NAME];
  uint64_t begin, end;
} function;

static function column[COLUMNS];
static unsigned columns;
static int once[COLUMNS];         /* it stands as once a tick */
static unsigned entries[COLUMNS]; /* since the last mark */
static function step[STEPS];      /* the tick itself */
static unsigned steps;
static uint64_t mark;
static uint64_t executed, since;
static uint64_t spent[PLACES];
static unsigned place = OUTSIDE;
static FILE *out;
static int plain;

static void move_to(unsigned next) {
  spent[place] += executed - since;
  since = executed;
  place = next;
}

static void entered(unsigned cpu, void *data) {
  (void)cpu;
  const unsigned next = (unsigned)(uintptr_t)data;
  if (next == place) return;
  move_to(next);
  if (next != STEP && ++entries[next] > 1 && once[next]) {
    fprintf(stderr, "stage_count: %s is entered twice in a tick\n", column[next].name);
    exit(3);
  }
}

static void marked(unsigned cpu, void *data) {
  (void)cpu;
  (void)data;
  move_to(OUTSIDE);
  if (plain) fprintf(out, "%llu", (unsigned long long)spent[OUTSIDE]);
  for (unsigned n = 0; n < columns && !plain; ++n) fprintf(out, "%s%llu", n > 0 ? " " : "", (unsigned long long)spent[n]);
  fprintf(out, "\n");
  memset(spent, 0, sizeof spent);
  memset(entries, 0, sizeof entries);
}

static void translated(uint64_t id, struct qemu_plugin_tb *block) {
  (void)id;
  for (size_t n = 0; n < qemu_plugin_tb_n_insns(block); ++n) {
    struct qemu_plugin_insn *insn = qemu_plugin_tb_get_insn(block, n);
    const uint64_t at = qemu_plugin_insn_vaddr(insn);
    if (at == mark) qemu_plugin_register_vcpu_insn_exec_cb(insn, marked, 0, NULL);
    for (unsigned k = 0; k < steps; ++k)
      if (at >= step[k].begin && at < step[k].end) qemu_plugin_register_vcpu_insn_exec_cb(insn, entered, 0, (void *)STEP);
    for (uintptr_t k = 1; k < columns; ++k)
      if (at == column[k].begin && column[k].end != 0) qemu_plugin_register_vcpu_insn_exec_cb(insn, entered, 0, (void *)k);
    qemu_plugin_register_vcpu_insn_exec_inline(insn, 0, &executed, 1);
  }
}

static void ended(uint64_t id, void *data) {
  (void)id;
  (void)data;
  fclose(out);
}

static int read_stages(const char *path) {
  FILE *f = fopen(path, "r");
  char line[256];
  char name[NAME];
  char per[NAME];
  if (f == NULL) return 0;
  while (fgets(line, sizeof line, f) != NULL) {
    if (line[0] == '#' || sscanf(line, "%63s %63s", name, per) != 2) continue;
    const int is_step = strcmp(per, "step") == 0;
    if (is_step && steps < STEPS) memcpy(step[steps++].name, name, NAME);
    if (is_step && steps > 1) continue;
    if (columns == COLUMNS) return 0;
    memcpy(column[columns].name, name, NAME);
    once[columns++] = strcmp(per, "tick") == 0;
  }
  fclose(f);
  return steps > 0 && strcmp(column[STEP].name, step[0].name) == 0;
}

static int read_symbols(const char *path) {
  FILE *f = fopen(path, "r");
  unsigned long long at;
  unsigned long long bytes;
  char name[NAME];
  int good = 1;
  if (f == NULL) return 0;
  while (fscanf(f, "%llx %llx %63s", &at, &bytes, name) == 3) {
    if (strcmp(name, "work_mark") == 0) mark = at;
    for (unsigned n = 0; n < columns + steps; ++n) {
      function *of = n < columns ? &column[n] : &step[n - columns];
      if (strcmp(name, of->name) != 0) continue;
      if (of->end != 0) good = 0; /* two of one name */
      of->begin = at;
      of->end = at + bytes;
    }
  }
  fclose(f);
  return good && mark != 0 && (plain || step[0].end != 0);
}

int qemu_plugin_install(uint64_t id, const void *info, int argc, char **argv) {
  const char *symbols = "";
  const char *stages = "";
  (void)info;
  out = stdout;
  for (int n = 0; n < argc; ++n)
    if (strcmp(argv[n], "plain=1") == 0) plain = 1;
  for (int n = 0; n < argc; ++n) {
    if (strncmp(argv[n], "stages=", 7) == 0) stages = argv[n] + 7;
    if (strncmp(argv[n], "symbols=", 8) == 0) symbols = argv[n] + 8;
    if (strncmp(argv[n], "out=", 4) == 0) out = fopen(argv[n] + 4, "w");
  }
  if (out == NULL || (!plain && !read_stages(stages)) || !read_symbols(symbols)) {
    fprintf(stderr, "stage_count: cannot read the stages or the symbols, or one stands twice, or fray_tick is missing\n");
    return 1;
  }
  qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
  qemu_plugin_register_atexit_cb(id, ended, NULL);
  return 0;
}
