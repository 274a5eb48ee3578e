/* SPDX-License-Identifier: Apache-2.0 */
#define _GNU_SOURCE

#include "tools/bus/live.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "platform/files/output_file.h"
#include "platform/linux/board.h"
#include "platform/linux/realtime.h"
#include "platform/loop.h"
#include "tools/terminal/signals.h"
#include "tools/world/world_workers.h"

enum { FADE_TICKS_MAX = 11000, LOST_TICKS_MAX = 1000, LOST_MS_MAX = 900, DRAIN_US = 200000, DRAIN_LOST_US = 20000 };

/* One session. */
typedef struct {
  loop l;
  const live_options *o;
  bus_key *key; /* NULL: the bus is plain */
  world_workers workers;
  output_file record; /* without a stream: none */
  bus_log log;
  live_start start;
} session_live;

/* Worker threads inherit these settings, and are pinned by world_workers_open(). */
static int prepare(const live_options *o, loop *l, world_workers *c) {
  const int cpu = o->cpu != LIVE_ANY_CPU ? (int)o->cpu : WORKERS_ANY_CPU;
  const int alone = workers_count(l->world, o->workers) == 1;
  if (alone && cpu != WORKERS_ANY_CPU && !realtime_pin(cpu)) return 0;
  if (o->realtime && (!realtime_lock_memory() || !realtime_schedule((int)o->priority))) return 0;
  return world_workers_open(c, l->world, o->workers, alone ? WORKERS_ANY_CPU : cpu);
}

static loop_result run_tick(loop *l, world_workers *c) {
  const loop_result result = loop_receive(l);
  if (result != LOOP_TICKED) return result;
  workers_tick(&c->group, &l->input, &l->output);
  loop_send(l);
  return LOOP_TICKED;
}

static int forces_are_zero(const fray_output *out) {
  for (int h = 0; h < FRAY_HANDS; ++h)
    for (int n = 0; n < 3; ++n)
      if (out->force[h][n] != 0) return 0;
  return 1;
}

/* STOP, then ticks until the forces have faded: the last FORCE is zero. Over a lost bus nothing can be sent. */
static void fade_out(loop *l, world_workers *c) {
  const int64_t period_ns = linux_board.timer.period_ns;
  int64_t lost_ns = linux_board.lost ? period_ns : 0;
  loop_command(l, FRAY_COMMAND_STOP);
  linux_board.stopping = 0;
  for (int ticks = 0, lost = 0; ticks < FADE_TICKS_MAX && lost < LOST_TICKS_MAX;) {
    if (lost_ns != 0 && lost_ns + period_ns > LOST_MS_MAX * INT64_C(1000000)) return;
    const int64_t begun_ns = timer_now_ns();
    if (run_tick(l, c) != LOOP_TICKED) {
      ++lost;
      lost_ns += timer_now_ns() - begun_ns + 1;
      continue;
    }
    ++ticks;
    if (l->command == FRAY_COMMAND_NONE && l->output.state != FRAY_OPERATIONAL &&
        forces_are_zero(&l->output) && l->unsent_count == 0)
      return;
  }
}

/* The hash after the last tick. A bus that is late is given a tenth of a second, a lost one nothing. */
static void send_hash(loop *l) {
  const uint32_t tries = linux_board.lost ? 0 : 1u + fray_get_info(l->world).rate_hz / 10u;
  for (uint32_t n = 0; n < tries; ++n)
    if (loop_close(l) != LOOP_BUS_LOST) return;
  fprintf(stderr, "%s: the bus is lost, the session has no closing SYNC: fray verify needs --cut\n",
          linux_board.can.name);
}

/* The one place where a session ends. */
static void end_session(session_live *s) {
  fade_out(&s->l, &s->workers);
  send_hash(&s->l);
  board_close(linux_board.lost ? DRAIN_LOST_US : DRAIN_US);
}

static void print_log(const session_live *s) {
  const bus_log *log = &s->log;
  if (s->record.stream == NULL) return;
  printf("log          %s: %llu lines lost; a line was on the disk after %.0f ms at most\n", s->o->record,
         (unsigned long long)log->lost, (double)log->worst_ns / 1e6);
}

static void print_bus(const loop *l, const bus_key *key) {
  const port_statistics *p = &l->in.statistics;
  const board *b = &linux_board;
  printf("bus          %s: accepted %u, repeated %u, old %u, lost %u, wrong CRC %u,\n"
         "             wrong length %u, wrong flags %u, wrong field %u, unknown id %u, queue full %u\n",
         b->can.name, p->accepted, p->repeated, p->old, p->lost, p->wrong_crc, p->wrong_length,
         p->wrong_flags, p->wrong_field, p->unknown_id, p->queue_full);
  printf("             kernel drops %u, error frames %" PRIu64 ", sends refused %" PRIu64 ", frames lost %" PRIu64 ", SYNCs lost %u\n",
         b->can.kernel_drops, b->can.error_frames, b->sends_refused, l->frames_lost + b->outputs_lost, l->bus_losses);
  printf("lateness     p50 %.0f us, p99 %.0f us, worst %.0f us; %u ticks missed\n",
         timer_quantile_us(&b->timer, 0.5), timer_quantile_us(&b->timer, 0.99),
         (double)b->timer.worst_ns / 1e3, l->overruns);
  if (key == NULL) return;
  bus_key_print(key, stdout);
  if (l->unsealed != 0) printf("             not sent for want of freshness %u\n", l->unsealed);
}

/* Printed once, and only while all frames of the other end are refused: no force can be late for it. */
static void complain(const bus_key *key, int *told) {
  const char *why = *told ? NULL : bus_key_complaint(key);
  if (why == NULL) return;
  fprintf(stderr, "%s: %s\n", linux_board.can.name, why);
  *told = 1;
}

static int is_over(const session_live *s, uint64_t done) {
  return signals_seen() != 0 || atomic_load(&s->log.closed) != 0 || (s->o->ticks != 0 && done >= s->o->ticks);
}

static void run_ticks(session_live *s) {
  uint64_t done = 0;
  int told = 0;
  while (!is_over(s, done)) {
    if (run_tick(&s->l, &s->workers) == LOOP_TICKED) ++done;
    s->start = live_start_seen(s->start, &s->l.output);
    if (s->key == NULL) continue;
    complain(s->key, &told);
    if (!bus_key_tick(s->key)) break;
  }
}

static int protect(session_live *s) {
  if (s->key == NULL) return 1;
  const fray_info f = fray_get_info(s->l.world);
  if (!bus_key_open(s->key, &s->o->key, AUTH_GATE_RUNTIME, s->o->instance, f.hands)) return 0;
  loop_protect(&s->l, &s->key->g);
  return 1;
}

static int fail(const session_live *s) {
  fprintf(stderr, "%s: cannot be written: %s\n", s->o->record, output_file_reason());
  return 1;
}

/* Returns the exit code. The recording takes its name once the bus is open, so that a wrong interface leaves the
 * last one, and before the first tick, so that it is found after a power cut. */
static int run_on_bus(session_live *s) {
  const uint32_t rate_hz = fray_get_info(s->l.world).rate_hz;
  const int fd = s->key != NULL && !s->o->key.classic_tags;
  bus_log *log = s->record.stream != NULL ? &s->log : NULL;
  if (!board_open(s->o->interface, s->o->instance, rate_hz, fd, log)) return 2;
  if (log != NULL && !output_file_name(&s->record)) {
    const int code = fail(s);
    board_close(0);
    return code;
  }
  timer_begin(&linux_board.timer, rate_hz);
  run_ticks(s);
  end_session(s);
  print_bus(&s->l, s->key);
  print_log(s);
  return 0;
}

static int run_with_workers(session_live *s) {
  if (!prepare(s->o, &s->l, &s->workers)) return 2;
  const int code = run_on_bus(s);
  world_workers_close(&s->workers);
  return code;
}

/* The log's thread starts before the process becomes a real-time one. */
static int open_record(session_live *s) {
  s->record.aside = -1;
  if (s->o->record != NULL && !output_file_open(&s->record, s->o->record)) return !fail(s);
  bus_log_begin(&s->log, s->record.stream != NULL ? fileno(s->record.stream) : -1);
  if (bus_log_start(&s->log)) return 1;
  fprintf(stderr, "%s: no thread for its writer\n", s->o->record);
  return 0;
}

static int close_record(session_live *s, int code) {
  bus_log_end(&s->log);
  if (s->record.stream == NULL || code != 0) {
    output_file_drop(&s->record);
    return code;
  }
  if (!output_file_keep(&s->record)) return fail(s);
  if (s->log.lost == 0 && !s->log.is_unsynced) return 0;
  fprintf(stderr, "%s: %llu lines could not be written%s\n", s->o->record, (unsigned long long)s->log.lost,
          s->log.is_unsynced ? ", the disk confirmed not all of the others" : "");
  return 1;
}

int live_run(fray_world *world, const live_options *o, live_result *result) {
  static session_live s;
  static bus_key key;
  memset(&s, 0, sizeof s);
  s.o = o;
  s.key = o->key.file != NULL ? &key : NULL;
  signals_note(SIGNALS_ALL, &linux_board.stopping);
  int code = 1;
  if (open_record(&s)) {
    code = 2;
    loop_begin(&s.l, world, o->instance);
    if (protect(&s)) {
      code = run_with_workers(&s);
      if (s.key != NULL && !bus_key_close(s.key) && code == 0) code = 1;
    }
  }
  result->last = s.l.output;
  result->start = s.start;
  return close_record(&s, code);
}
