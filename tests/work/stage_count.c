/* SPDX-License-Identifier: Apache-2.0 */
/* A plugin of QEMU's (API version 1) that counts the instructions of a program by stage of the tick.
 * The program is the product's own code: a stage begins where its function is entered, and ends
 * where fray_tick goes on. At each entry of work_mark() a line is written: the instructions since
 * the last one, of fray_tick itself and of every stage.
 *
 *   -plugin libstage_count.so,symbols=FILE,out=FILE     symbols: `address size name` a line, as nm -S
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

/* What is counted apart; the first is fray_tick itself, the last is what lies outside of a tick. */
static const char *const names[] = {
    "fray_tick",  "devices_run", "damp_run",       "springs_run", "stress_run", "rip_run", "slash_run",
    "weigh_run",  "blow_run",    "collide_gather", "predict_run", "strain_run", "limit_run",
    "slip_run",   "collide_run", "meshes_begin", "meshes_run", "selves_begin", "selves_run",
    "layers_begin", "layers_run", "transition_run", "split_run", "tear_run", "cut_run",
    "finish_run", "force_run",   "report_run",     "world_hash"};
enum { STEP, STAGES = sizeof names / sizeof names[0], OUTSIDE = STAGES, PLACES };

static uint64_t entry[STAGES];
static uint64_t step_end, mark;
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
  if (next != place) move_to(next);
}

static void marked(unsigned cpu, void *data) {
  (void)cpu;
  (void)data;
  move_to(OUTSIDE);
  if (plain) fprintf(out, "%llu", (unsigned long long)spent[OUTSIDE]);
  for (unsigned n = 0; n < STAGES && !plain; ++n) fprintf(out, "%s%llu", n > 0 ? " " : "", (unsigned long long)spent[n]);
  fprintf(out, "\n");
  memset(spent, 0, sizeof spent);
}

static void translated(uint64_t id, struct qemu_plugin_tb *block) {
  (void)id;
  for (size_t n = 0; n < qemu_plugin_tb_n_insns(block); ++n) {
    struct qemu_plugin_insn *insn = qemu_plugin_tb_get_insn(block, n);
    const uint64_t at = qemu_plugin_insn_vaddr(insn);
    if (at == mark) qemu_plugin_register_vcpu_insn_exec_cb(insn, marked, 0, NULL);
    if (at >= entry[STEP] && at < step_end)
      qemu_plugin_register_vcpu_insn_exec_cb(insn, entered, 0, NULL);
    for (uintptr_t k = 1; k < STAGES; ++k)
      if (at == entry[k]) qemu_plugin_register_vcpu_insn_exec_cb(insn, entered, 0, (void *)k);
    qemu_plugin_register_vcpu_insn_exec_inline(insn, 0, &executed, 1);
  }
}

static void ended(uint64_t id, void *data) {
  (void)id;
  (void)data;
  fclose(out);
}

static int read_symbols(const char *path) {
  FILE *f = fopen(path, "r");
  unsigned long long at;
  unsigned long long bytes;
  char name[64];
  unsigned found = 0;
  if (f == NULL) return 0;
  while (fscanf(f, "%llx %llx %63s", &at, &bytes, name) == 3) {
    if (strcmp(name, "work_mark") == 0) mark = at;
    for (unsigned n = 0; n < STAGES; ++n)
      if (strcmp(name, names[n]) == 0) {
        entry[n] = at;
        if (n == STEP) step_end = at + bytes;
        ++found;
      }
  }
  fclose(f);
  return mark != 0 && (plain || found == STAGES);
}

int qemu_plugin_install(uint64_t id, const void *info, int argc, char **argv) {
  const char *symbols = "";
  (void)info;
  out = stdout;
  for (int n = 0; n < argc; ++n)
    if (strcmp(argv[n], "plain=1") == 0) plain = 1;
  for (int n = 0; n < argc; ++n) {
    if (strncmp(argv[n], "symbols=", 8) == 0) symbols = argv[n] + 8;
    if (strncmp(argv[n], "out=", 4) == 0) out = fopen(argv[n] + 4, "w");
  }
  if (out == NULL || !read_symbols(symbols)) {
    fprintf(stderr, "stage_count: cannot read the symbols, or one of them is missing\n");
    return 1;
  }
  qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
  qemu_plugin_register_atexit_cb(id, ended, NULL);
  return 0;
}
