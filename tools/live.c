/* SPDX-License-Identifier: Apache-2.0 */
#define _GNU_SOURCE

#include "tools/live.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "platform/linux/board.h"
#include "platform/linux/realtime.h"
#include "platform/loop.h"
#include "tools/crew.h"

/* A kill loses what the log has not written: 4 KiB are 14 ticks of two hands. */
enum { FADE_TICKS_MAX = 11000, LOST_MAX = 1000, DRAIN_US = 200000, LOG_WRITE = 1 << 12 };

static volatile sig_atomic_t asked_to_stop;

static void ask_to_stop(int signal_number) {
  (void)signal_number;
  asked_to_stop = 1;
}

static void catch_signals(void) {
  struct sigaction action;
  memset(&action, 0, sizeof action);
  action.sa_handler = ask_to_stop;
  (void)sigaction(SIGINT, &action, NULL);
  (void)sigaction(SIGTERM, &action, NULL);
  asked_to_stop = 0;
}

/* The threads of a crew inherit what is set before, and are pinned by it. */
static int prepare(const live_options *o, loop *l, crew *c) {
  const int cpu = o->cpu != LIVE_ANY_CPU ? (int)o->cpu : TEAM_ANY_CPU;
  const int alone = team_size(l->world, o->workers) == 1;
  if (alone && cpu != TEAM_ANY_CPU && !realtime_pin(cpu)) return 0;
  if (o->realtime && (!realtime_lock_memory() || !realtime_schedule((int)o->priority))) return 0;
  return crew_open(c, l->world, o->workers, alone ? TEAM_ANY_CPU : cpu);
}

static loop_result run_tick(loop *l, crew *c) {
  const loop_result result = loop_take(l);
  if (result != LOOP_TICKED) return result;
  team_tick(&c->team, &l->input, &l->output);
  loop_give(l);
  return LOOP_TICKED;
}

static int forces_are_zero(const fray_output *out) {
  for (int h = 0; h < FRAY_HANDS; ++h)
    for (int n = 0; n < 3; ++n)
      if (out->force[h][n] != 0) return 0;
  return 1;
}

/* STOP, then ticks until the forces have faded: the device's last word from us is zero. */
static void fade_out(loop *l, crew *c) {
  loop_command(l, FRAY_VERB_STOP);
  for (int ticks = 0, lost = 0; ticks < FADE_TICKS_MAX && lost < LOST_MAX;) {
    if (run_tick(l, c) != LOOP_TICKED) {
      ++lost;
      continue;
    }
    ++ticks;
    if (l->command == FRAY_VERB_NONE && l->output.state != FRAY_OPERATIONAL &&
        forces_are_zero(&l->output) && l->unsent_count == 0)
      return;
  }
}

static void print_bus(const loop *l, const bus_key *key) {
  const port_statistics *p = &l->in.statistics;
  const board *b = &linux_board;
  printf("bus          %s: accepted %u, repeated %u, old %u, lost %u, wrong CRC %u,\n"
         "             wrong length %u, wrong flags %u, wrong field %u, unknown id %u, queue full %u\n",
         b->can.name, p->accepted, p->repeated, p->old, p->lost, p->wrong_crc, p->wrong_length,
         p->wrong_flags, p->wrong_field, p->unknown_id, p->queue_full);
  printf("             kernel drops %u, error frames %u, sends refused %u, frames lost %u, SYNCs lost %u\n",
         b->can.kernel_drops, b->can.error_frames, b->sends_refused, l->frames_lost, l->bus_losses);
  printf("lateness     p50 %.0f us, p99 %.0f us, worst %.0f us; %u ticks missed\n",
         timer_quantile_us(&b->timer, 0.5), timer_quantile_us(&b->timer, 0.99),
         (double)b->timer.worst_ns / 1e3, l->overruns);
  if (key == NULL) return;
  bus_key_print(key, stdout);
  if (l->unsealed != 0) printf("             not sent for want of freshness %u\n", l->unsealed);
}

/* One word, and only while nothing of the other end is used: no force can be late for it. */
static void complain(const bus_key *key, int *told) {
  const char *why = *told ? NULL : bus_key_complaint(key);
  if (why == NULL) return;
  fprintf(stderr, "%s: %s\n", linux_board.can.name, why);
  *told = 1;
}

static void run_ticks(loop *l, const live_options *o, bus_key *key, crew *c) {
  uint32_t done = 0;
  int told = 0;
  while (!asked_to_stop && (o->ticks == 0 || done < o->ticks)) {
    if (run_tick(l, c) == LOOP_TICKED) ++done;
    if (key == NULL) continue;
    complain(key, &told);
    if (!bus_key_tick(key)) break;
  }
  fade_out(l, c);
}

static int protect(loop *l, const live_options *o, bus_key *key) {
  if (o->key.file == NULL) return 1;
  const fray_facts f = fray_describe(l->world);
  if (!bus_key_open(key, &o->key, GUARD_RUNTIME, o->instance, f.hands)) return 0;
  loop_protect(l, &key->g);
  return 1;
}

/* Returns the exit code. */
static int run_with(loop *l, const live_options *o, bus_key *key, crew *c, int log_fd) {
  const int fd = key != NULL && !o->key.classic_tags;
  if (!board_open(o->interface, o->instance, fray_describe(l->world).rate_hz, fd, log_fd)) return 2;
  /* only now: a wrong interface must not cost the last recording */
  if (log_fd >= 0 && ftruncate(log_fd, 0) != 0) linux_board.log.lost = 1;
  linux_board.log.write_at = LOG_WRITE;
  run_ticks(l, o, key, c);
  board_close(DRAIN_US);
  print_bus(l, key);
  return 0;
}

static int run_on_board(loop *l, const live_options *o, bus_key *key, int log_fd) {
  static crew c;
  if (!prepare(o, l, &c)) return 2;
  const int code = run_with(l, o, key, &c, log_fd);
  crew_close(&c);
  return code;
}

int live_run(fray_world *world, const live_options *o, fray_output *last) {
  static loop l;
  static bus_key key_of_bus;
  bus_key *key = o->key.file != NULL ? &key_of_bus : NULL;
  int log_fd = -1;
  if (o->record != NULL) {
    log_fd = open(o->record, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (log_fd < 0) {
      fprintf(stderr, "%s: cannot be written: %s\n", o->record, strerror(errno));
      return 1;
    }
  }
  catch_signals();
  int code = 2;
  loop_begin(&l, world, o->instance);
  if (protect(&l, o, key)) {
    code = run_on_board(&l, o, key, log_fd);
    *last = l.output;
    if (key != NULL && !bus_key_close(key) && code == 0) code = 1;
  }
  const int closed = log_fd < 0 || close(log_fd) == 0;
  if (code != 0 || (closed && linux_board.log.lost == 0)) return code;
  fprintf(stderr, "%s: %llu lines could not be written\n", o->record,
          (unsigned long long)linux_board.log.lost);
  return 1;
}
