/* SPDX-License-Identifier: Apache-2.0 */
#include "platform/zcu102/board.h"

#include "platform/platform.h"
#include "platform/zcu102/can.h"
#include "platform/zcu102/console.h"
#include "platform/zcu102/cpu.h"
#include "platform/zcu102/gic.h"
#include "platform/zcu102/mmu.h"
#include "platform/zcu102/semihost.h"
#include "rt/wire/dictionary.h"

enum { EXIT_FAULT = 99 };
static const uint64_t paint = 0x5A5A5A5A5A5A5A5Aull; /* of start.S */

extern const uint64_t stack_first[], stack_top[];

board zcu102_board;

/* What the interrupt and platform_sync() share; outside of the interrupt it is touched with
 * interrupts masked, or when nothing is awaited. */
static struct {
  uint32_t outstanding;        /* a SYNC is in the high-priority buffer */
  uint32_t awaited;            /* and platform_sync() waits for it */
  volatile uint32_t confirmed;
  uint32_t count;              /* the input: what the FIFO held when it was sent */
  can_message input[CAN_FIFO];
} latch;

void board_open(uint32_t instance, uint32_t rate_hz) {
  const uint32_t ids[] = {dictionary_id(MESSAGE_COMMAND, instance),
                          dictionary_id(MESSAGE_POSE_LEFT, instance),
                          dictionary_id(MESSAGE_POSE_RIGHT, instance)};
  can_begin(CAN0_BASE, ids, sizeof ids / sizeof ids[0], CAN_TXOK | CAN_RXOFLW | CAN_BSOFF);
  gic_enable(GIC_CAN0, BOARD_PRIORITY_CAN);
  gic_enable(GIC_TIMER_VIRTUAL, BOARD_PRIORITY_TIMER);
  timer_begin(&zcu102_board.grid, rate_hz);
}

/* The tick boundary. The next frame of the bus ends 47 bits after the SYNC at the earliest, a POSE
 * or COMMAND 111: what is read in less than 47 us from then on came before. */
static void confirm(void) {
  latch.outstanding = 0;
  if (!latch.awaited) {
    ++zcu102_board.late;
    return;
  }
  while (latch.count < CAN_FIFO && can_receive(CAN0_BASE, &latch.input[latch.count])) ++latch.count;
  latch.awaited = 0;
  latch.confirmed = 1;
}

/* TXOK may be a FORCE that was still waiting; the SYNC has been sent when its buffer is empty. */
static void can_interrupt(void) {
  const uint32_t events = can_take_events(CAN0_BASE, CAN_TXOK | CAN_RXOFLW | CAN_BSOFF);
  if ((events & CAN_TXOK) != 0 && latch.outstanding && !can_first_waits(CAN0_BASE)) confirm();
  if ((events & CAN_RXOFLW) != 0) ++zcu102_board.overflows;
  if ((events & CAN_BSOFF) != 0) ++zcu102_board.bus_offs;
}

__attribute__((weak)) void board_other_interrupt(uint32_t id) {
  (void)id;
  ++zcu102_board.unexpected;
}

void board_interrupt(void) {
  const uint32_t taken = gic_take();
  const uint32_t id = taken & 0x3FFu;
  if (id >= GIC_NONE) return;
  if (id == GIC_CAN0) {
    can_interrupt();
  } else if (id == GIC_TIMER_VIRTUAL) {
    timer_interrupt();
  } else {
    board_other_interrupt(id);
  }
  gic_done(taken);
}

int32_t platform_wait(void) {
  if (zcu102_board.stopping) return -1;
  return timer_wait(&zcu102_board.grid);
}

/* A SYNC without a confirmation stays in its buffer, and the controller goes on trying. */
static void begin_sync(const frame *sync) {
  cpu_mask_interrupts();
  latch.count = 0;
  latch.confirmed = 0;
  latch.awaited = 1;
  if (!latch.outstanding) can_send_first(CAN0_BASE, sync);
  latch.outstanding = 1;
  cpu_allow_interrupts();
}

static uint32_t end_sync(void) {
  cpu_mask_interrupts();
  latch.awaited = 0;
  cpu_allow_interrupts();
  return latch.confirmed;
}

platform_result platform_sync(const frame *sync, port *p) {
  const uint64_t end = timer_now() + timer_counts(PLATFORM_CONFIRM_US);
  begin_sync(sync);
  timer_sleep(end, &latch.confirmed);
  if (!end_sync()) return PLATFORM_LOST;
  for (uint32_t n = 0; n < latch.count; ++n) {
    frame f;
    can_to_frame(&latch.input[n], &f);
    port_push(p, &f);
  }
  if (latch.count > zcu102_board.drained_most) zcu102_board.drained_most = latch.count;
  return PLATFORM_SENT;
}

/* A sealed frame is CAN FD, which this controller does not have: half of it must not look like a message. */
platform_result platform_send(const frame *f) {
  if (f->fd == 0 && can_send(CAN0_BASE, f)) return PLATFORM_SENT;
  ++zcu102_board.sends_dropped;
  return PLATFORM_LOST;
}

uint32_t board_stack_used(void) {
  const uint64_t *at = stack_first;
  while ((uintptr_t)at < (uintptr_t)stack_top && *at == paint) ++at;
  return (uint32_t)((uintptr_t)stack_top - (uintptr_t)at);
}
uint32_t board_stack_bytes(void) {
  return (uint32_t)((uintptr_t)stack_top - (uintptr_t)stack_first);
}

void board_main(void) {
  mmu_begin();
  console_begin();
  cpu_allow_aborts();
  gic_begin();
  cpu_allow_interrupts();
  platform_exit(main());
}

static void print_fault(uint64_t kind, uint64_t syndrome, uint64_t at, uint64_t address) {
  platform_print("fault ");
  console_number(kind, 1);
  platform_print(" esr ");
  console_hex(syndrome, 8);
  platform_print(" at ");
  console_hex(at, 16);
  platform_print(" address ");
  console_hex(address, 16);
  platform_print("\n");
}

/* As bare_fault(): neither a console nor an exit that faults may loop for ever. */
void board_fault(uint64_t kind, uint64_t syndrome, uint64_t at, uint64_t address) {
  static uint32_t faults;
  const uint32_t before = faults++;
  if (before == 0) print_fault(kind, syndrome, at, address);
  if (before <= 1) platform_exit(EXIT_FAULT);
  for (;;) cpu_sleep();
}
