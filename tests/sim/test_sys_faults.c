/* SPDX-License-Identifier: Apache-2.0 */
/* Every system call of the live loop, and of opening its socket, fails in turn: the 1st, 2nd, ... of
 * each kind, once and 50 times in a row, with every plausible errno. Each case ends in a state that the
 * protocol knows, ticks again within 100 ms of the last fault, and the log has every frame that the socket gave, in order. */
#define _GNU_SOURCE /* fileno, dup2 */

#include <errno.h>
#include <linux/can/error.h>
#include <stdlib.h>
#include <unistd.h>

#include "platform/log/candump.h"
#include "tests/lib/test.h"
#include "tests/sim/sys_session.h"

enum {
  POSITIONS = 32,      /* n of the n-th call */
  ROW = 50,
  SETTLED_TICKS = 30,  /* watched after the last fault */
  RUNS_MAX = 2000,
  RECOVERY_US = 100000,
  CALLS_PER_RUN = 60000 /* TIMER_TRIES sleeps and WAITS_PER_SYNC waits, with the tries to read a clock */
};

static const int errors[] = {ENOBUFS, EAGAIN, EINTR, ENETDOWN, EIO, ENOSPC, ENOMEM};
enum { ERRORS = sizeof errors / sizeof *errors };
static const char *const call_names[CALLS] = {"recvmsg", "send", "ppoll", "clock_nanosleep",
                                              "clock_gettime", "write of the log",
                                              "fdatasync of the log", "socket",
                                              "SIOCGIFINDEX", "setsockopt", "getsockopt", "bind",
                                              "close"};

static uint32_t cases, halts, stales, most_missed;
static int64_t worst_recovery_ns;
static const char *in; /* the case, for a message */

static void complain(const char *what, long long is) {
  ++test_bad_checks;
  if (test_bad_checks < 20)
    printf("%s, call %u, %u in a row, %s: %s %lld\n", in, sys.first, sys.length, strerror(sys.error),
           what, is);
}

static void begin(void) {
  if (!sys_session_begin(0)) complain("not opened", 0);
}

/* A tick, then a round of the log's writer. */
static loop_result run(void) {
  const uint64_t before = sys.calls;
  const loop_result result = loop_run(&l);
  (void)bus_log_store(&own_log);
  if (sys.calls - before > CALLS_PER_RUN) complain("calls in one run", (long long)(sys.calls - before));
  return result;
}

static int is_defined_state(void) {
  const uint32_t known = FRAY_FAULT_HALTED | FRAY_FAULT_STALE_LEFT | FRAY_FAULT_STALE_RIGHT;
  if ((l.output.faults & ~known) != 0) return 0;
  return l.output.faults == 0 ? l.output.state == FRAY_OPERATIONAL : l.output.state == FRAY_SAFE;
}

static void begin_warm(void) {
  begin();
  for (int n = 0; n < 5; ++n) (void)run();
}

static void run_ticks(int count) {
  for (int n = 0; n < count; ++n) CHECK_EQ_INT(run(), LOOP_TICKED);
}

/* Makes comments of the marks of gaps, which a reader refuses; returns the lines that they count. */
static uint64_t take_marks(void) {
  const size_t head = sizeof CANDUMP_GAP - 1;
  uint64_t lines = 0;
  for (size_t at = 0; at + head < sys.file_bytes; ++at) {
    if (memcmp(sys.file + at, CANDUMP_GAP, head) != 0) continue;
    CHECK(at == 0 || sys.file[at - 1] == '\n');
    lines += strtoull(sys.file + at + head, NULL, 10);
    memcpy(sys.file + at, "# was", 5);
  }
  return lines;
}

/* The file holds what the socket gave, line by line, but for `lost` lines. */
static void check_log(uint64_t lost) {
  candump_log log;
  candump_error error = {0};
  if (!candump_parse_all("log", sys.file, sys.file_bytes, &log, &error)) {
    complain(error.message, error.line);
    return;
  }
  if (own_log.lost != lost) complain("lines counted as lost", (long long)own_log.lost);
  if (log.count + own_log.lost != sys.rx_taken)
    complain("frames neither in the log nor lost", (long long)sys.rx_taken - (long long)log.count);
  size_t at = 0;
  for (size_t n = 0; n < log.count; ++n, ++at) {
    const frame *f = &log.entries[n].frame;
    while (at < sys.rx_taken && (sys.rx[at].f.id != f->id || memcmp(sys.rx[at].f.data, f->data, 8) != 0 ||
                                 sys.rx[at].at_ns / 1000 != log.entries[n].time_us))
      ++at;
    if (at - n > lost) break;
  }
  if (at > sys.rx_taken || at - log.count > lost) complain("log out of order, line", (long long)at);
  candump_free(&log);
}

static void close_board(void) {
  board_close(20000);
  if (sys.rx_taken != sys.rx_count) complain("frames left unread", (long long)sys.rx_taken);
}

/* Nothing is left unread, and nothing is lost. */
static void end(void) {
  close_board();
  check_log(0);
}

/* Runs until the faults are over and the loop ticks again. */
static void recover(void) {
  uint32_t runs = 0;
  uint32_t in_a_row = 0;
  while (runs++ < RUNS_MAX && (sys.failed < sys.length || in_a_row < SETTLED_TICKS)) {
    const int64_t fault_ns = sys.last_fault_ns;
    const int ticked = run() == LOOP_TICKED && l.input.has_pose == 3;
    in_a_row = ticked && sys.last_fault_ns == fault_ns ? in_a_row + 1 : 0;
    if (in_a_row == 1 && sys.failed == sys.length) {
      const int64_t took_ns = sys.now_ns - sys.last_fault_ns;
      if (took_ns > worst_recovery_ns) worst_recovery_ns = took_ns;
      if (took_ns > RECOVERY_US * 1000LL) complain("us to recover", took_ns / 1000);
    }
  }
  if (runs > RUNS_MAX) complain("no recovery, faults done", sys.failed);
  if (!is_defined_state()) complain("state and faults", l.output.state * 1000 + l.output.faults);
  if (l.output.state == FRAY_SAFE && !session_force_is_zero(&l.output)) complain("a force in state", 3);
  halts += (l.output.faults & FRAY_FAULT_HALTED) != 0;
  stales += (l.output.faults & (FRAY_FAULT_STALE_LEFT | FRAY_FAULT_STALE_RIGHT)) != 0;
  if (l.overruns > most_missed) most_missed = l.overruns;
}

static void one_case(uint32_t kinds, call_kind kind, uint32_t n, uint32_t length, int error) {
  in = call_names[kind];
  ++cases;
  begin_warm();
  sys_fail(kinds, n, length, error);
  recover();
  end();
}

static void every_call_in_turn(void) {
  for (uint32_t kind = 0; kind < CALLS_OF_LOOP; ++kind)
    for (uint32_t e = 0; e < ERRORS; ++e)
      for (uint32_t n = 1; n <= POSITIONS; ++n) {
        one_case(1u << kind, (call_kind)kind, n, 1, errors[e]);
        one_case(1u << kind, (call_kind)kind, n, ROW, errors[e]);
      }
}

/* Two kinds of calls at once. */
static void every_pair(void) {
  for (uint32_t a = 0; a < CALLS_OF_LOOP; ++a)
    for (uint32_t b = a + 1; b < CALLS_OF_LOOP; ++b)
      for (uint32_t e = 0; e < ERRORS; ++e)
        for (uint32_t n = 1; n <= POSITIONS; n += 3) one_case(1u << a | 1u << b, (call_kind)b, n, 2 * ROW, errors[e]);
}

/* From the first call of the loop on, as when it begins with a bus that is down. */
static void from_the_first_call(void) {
  for (uint32_t kind = 0; kind < CALLS_OF_LOOP; ++kind)
    for (uint32_t e = 0; e < ERRORS; ++e) {
      in = call_names[kind];
      ++cases;
      begin();
      sys_fail(1u << kind, 1, ROW, errors[e]);
      recover();
      end();
    }
}

/* Runs with stderr going to a file; returns how much was said there. */
static long opened_quietly(int *opened) {
  FILE *const said = tmpfile();
  const int kept = dup(2);
  if (said == NULL || kept < 0 || dup2(fileno(said), 2) < 0) abort();
  bus_log_begin(&own_log, LOG_FD);
  *opened = board_open("sys0", 0, 1000, 1, &own_log);
  fflush(stderr);
  const long bytes = lseek(fileno(said), 0, SEEK_END);
  (void)dup2(kept, 2);
  (void)close(kept);
  (void)fclose(said);
  return bytes;
}

/* Either it is refused, with words and without a socket left open, or it works without what failed:
 * a larger buffer, a look at the interface. Then, with the fault gone, it opens and ticks. */
static void one_opening(call_kind kind, uint32_t n, int error) {
  in = call_names[kind];
  ++cases;
  sys_begin();
  sys_fail(1u << kind, n, 1, error);
  int opened;
  const long said = opened_quietly(&opened);
  const uint32_t failed = sys.failed;
  const uint32_t buffer = 3; /* setsockopt: filters, FD frames, then this */
  const int may_fail = failed == 0 || kind == CALL_GET_OPTION || kind == CALL_NOW ||
                       (kind == CALL_SET_OPTION && n == buffer);
  if (opened != may_fail) complain("opened", opened);
  if ((said == 0) != opened) complain("bytes said", said);
  if (sys.sockets != (uint32_t)opened) complain("sockets open", sys.sockets);
  board_close(0);
  if (sys.sockets != 0) complain("sockets left open", sys.sockets);
  begin();
  for (int tick = 0; tick < 5; ++tick)
    if (run() != LOOP_TICKED) complain("no tick", tick);
  end();
}

static void while_it_opens(void) {
  const uint32_t before = cases;
  for (uint32_t kind = CALL_NOW; kind < CALLS; ++kind)
    for (uint32_t e = 0; e < ERRORS; ++e)
      for (uint32_t n = 1; n <= 9; ++n) one_opening((call_kind)kind, n, errors[e]);
  in = "interface down";
  sys_begin();
  sys.down = 1;
  int opened;
  CHECK(opened_quietly(&opened) > 0);
  CHECK_EQ_INT(opened, 0);
  CHECK_EQ_INT(sys.sockets, 0);
  figure("sys_fault_cases_opening", cases - before, "", "every call: refused with words, or works");
}

/* While what is still on its way is read, and the log is written out. */
static void in_the_end(void) {
  for (uint32_t kind = 0; kind < CALLS_OF_LOOP; ++kind)
    for (uint32_t e = 0; e < ERRORS; ++e)
      for (uint32_t n = 1; n <= POSITIONS; ++n)
        for (uint32_t length = 1; length <= ROW; length += ROW - 1) {
          in = call_names[kind];
          ++cases;
          begin();
          for (int warm = 0; warm < 5; ++warm) (void)loop_run(&l);
          sys_fail(1u << kind, n, length, errors[e]);
          end();
        }
}

/* SAFE after a fault is left as always. */
static void reset_and_start(void) {
  in = "bus down";
  begin_warm();
  sys_fail(1u << CALL_SEND | 1u << CALL_RECEIVE, 1, ROW, ENETDOWN);
  recover();
  CHECK_EQ_INT(l.output.state, FRAY_SAFE);
  CHECK_EQ_INT(l.output.faults, FRAY_FAULT_HALTED);
  sys_command(FRAY_COMMAND_RESET);
  run_ticks(2);
  CHECK_EQ_INT(l.output.state, FRAY_READY);
  sys_command(FRAY_COMMAND_START);
  run_ticks(20);
  CHECK_EQ_INT(l.output.state, FRAY_OPERATIONAL);
  end();
}

/* Nothing ever works again: every run comes back, no tick is computed without a bus, the end ends. */
static void forever(void) {
  const uint32_t bus = 1u << CALL_RECEIVE | 1u << CALL_SEND | 1u << CALL_POLL;
  const uint32_t time = 1u << CALL_NOW | 1u << CALL_SLEEP;
  const uint32_t sets[] = {1u << CALL_RECEIVE, 1u << CALL_SEND, 1u << CALL_POLL, 1u << CALL_SLEEP,
                           1u << CALL_NOW,     1u << CALL_LOG,  bus,             time,
                           bus | time,         bus | time | 1u << CALL_LOG};
  uint64_t most = 0;
  for (uint32_t n = 0; n < sizeof sets / sizeof *sets; ++n)
    for (uint32_t e = 0; e < ERRORS; ++e) {
      in = "forever";
      ++cases;
      begin_warm();
      const uint64_t tick = l.tick;
      sys_fail(sets[n], 1, UINT32_MAX, errors[e]);
      for (int more = 0; more < 5; ++more) {
        const uint64_t before = sys.calls;
        const loop_result result = run();
        if (sys.calls - before > most) most = sys.calls - before;
        const int bus_gone = (sets[n] & (1u << CALL_RECEIVE | 1u << CALL_SEND)) != 0;
        if (result != (bus_gone ? LOOP_BUS_LOST : LOOP_TICKED)) complain("result", result);
      }
      if ((sets[n] & (1u << CALL_RECEIVE | 1u << CALL_SEND)) != 0 && l.tick != tick)
        complain("ticks without a bus", (long long)(l.tick - tick));
      board_close(20000);
      const uint64_t lost = (sets[n] & 1u << CALL_LOG) != 0 ? own_log.lost : 0;
      check_log(lost);
      if ((sets[n] & (bus | 1u << CALL_LOG)) == 1u << CALL_LOG && lost == 0) complain("lines lost", 0);
    }
  printf("figure sys_calls_of_one_run_worst %llu (asked: a bound; the clock and the sleep both dead)\n",
         (unsigned long long)most);
}

/* The disk is full after any number of bytes: the lines before are whole, and the rest is counted. */
static void full_disk(void) {
  in = "full disk";
  for (int64_t room = 0; room < 1200; room += 7) {
    begin_warm();
    sys.disk_room = room;
    const size_t before = sys.file_bytes;
    run_ticks(20);
    close_board();
    CHECK_EQ_INT(sys.file_bytes - before, room);
    while (sys.file_bytes > 0 && sys.file[sys.file_bytes - 1] != '\n') --sys.file_bytes;
    const uint64_t lost = own_log.lost;
    CHECK(lost > 0);
    check_log(lost);
  }
}

/* A disk that is full for so long that the buffer is too, then has room again. */
static void full_disk_with_room_again(void) {
  in = "full disk, then room";
  begin();
  own_log.room = 1 << 17;
  sys.disk_room = 0;
  run_ticks(1000);
  const uint64_t lost = own_log.lost;
  CHECK(lost > 0);
  sys.disk_room = -1;
  sys.short_write = 1000; /* and takes it in pieces that end within lines */
  run_ticks(1000);
  CHECK(own_log.lost - lost <= 1000);
  sys.short_write = 0;
  close_board();
  CHECK_EQ_INT(take_marks(), own_log.lost);
  check_log(own_log.lost);
}

/* The bus takes SYNCs and confirms none; then it does. */
static void unconfirmed(void) {
  in = "deaf";
  begin_warm();
  const uint64_t tick = l.tick;
  sys.deaf = 1;
  for (int n = 0; n < 20; ++n) {
    const int64_t before_ns = sys.now_ns;
    CHECK_EQ_INT(run(), LOOP_BUS_LOST);
    CHECK(sys.now_ns - before_ns < 4000000); /* the rest of a tick, and 2 ms */
  }
  CHECK_EQ_INT(l.tick, tick);
  sys.deaf = 0;
  run_ticks(10);
  CHECK_EQ_INT(l.output.state, FRAY_SAFE);
  end();
}

/* An interface that goes down takes a FORCE with it that it had accepted: no call fails, and it is counted. */
static void swallowed(void) {
  in = "swallowed";
  begin_warm();
  sys.swallowed = dictionary_id(MESSAGE_FORCE_LEFT, 0);
  run_ticks(3);
  sys.swallowed = 0;
  CHECK_EQ_INT(linux_board.outputs_lost, 2);
  run_ticks(10);
  CHECK_EQ_INT(linux_board.outputs_lost, 3);
  CHECK_EQ_INT(l.frames_lost, 0);
  sys.deaf = 1;
  for (int n = 0; n < 20; ++n) CHECK_EQ_INT(run(), LOOP_BUS_LOST);
  sys.deaf = 0;
  run_ticks(10);
  CHECK_EQ_INT(linux_board.outputs_lost, 3); /* SYNCs are no outputs */
  end();
}

/* Bus-off that ends without an error frame, as `ip link set down; up` ends it. */
static void bus_off_ends_by_an_echo(void) {
  in = "bus-off";
  begin_warm();
  sys_error(CAN_ERR_BUSOFF);
  sys.deaf = 1;
  for (int n = 0; n < 10; ++n) CHECK_EQ_INT(run(), LOOP_BUS_LOST);
  CHECK_EQ_INT(linux_board.can.bus_off, 1);
  sys.deaf = 0;
  uint32_t lost = 0;
  for (int n = 0; n < 20; ++n) lost += run() != LOOP_TICKED;
  CHECK(lost <= 2);
  CHECK_EQ_INT(linux_board.can.bus_off, 0);
  CHECK_EQ_INT(l.output.state, FRAY_SAFE);
  end();
}

int main(void) {
  TEST(prepare);
  TEST(every_call_in_turn);
  TEST(every_pair);
  TEST(from_the_first_call);
  TEST(while_it_opens);
  TEST(in_the_end);
  TEST(reset_and_start);
  TEST(forever);
  TEST(full_disk);
  TEST(full_disk_with_room_again);
  TEST(unconfirmed);
  TEST(swallowed);
  TEST(bus_off_ends_by_an_echo);
  figure("sys_fault_cases", cases, "", "every call, 7 errnos, once and 50 in a row");
  figure("sys_fault_recovery_worst", (double)worst_recovery_ns / 1e6, "ms", "100");
  figure("sys_fault_cases_halted", halts, "", "SAFE after a lost bus");
  figure("sys_fault_cases_stale", stales, "", "SAFE after lost poses");
  figure("sys_fault_ticks_missed_worst", most_missed, "ticks", "stated");
  return sys_session_end();
}
