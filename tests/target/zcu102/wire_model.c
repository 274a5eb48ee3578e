/* SPDX-License-Identifier: Apache-2.0 */
/* Two controllers on a bus at 1 Mbit/s, behind the functions of platform/zcu102/can.h. A frame
 * takes its bits, stuffed as badly as can be; the lower id goes first; what nobody acknowledges is
 * sent again at once. As in the part, a message that has been tried once goes out before any other
 * of its controller, the high-priority buffer too. There are no error states. */
#include "tests/target/zcu102/wire.h"

#include "platform/zcu102/can.h"
#include "platform/zcu102/cpu.h"
#include "platform/zcu102/gic.h"
#include "platform/zcu102/timer.h"
#include "rt/base/bytes.h"
#include "tests/target/zcu102/device.h"

enum { NODES = 2, GICD_ISPENDR = 0x200 };
static const uintptr_t distributor = 0xF9010000u;
static const uint32_t lines[NODES] = {GIC_CAN0, GIC_CAN1};

typedef enum { TRIES_NONE, TRIES_FIRST, TRIES_FIFO } tries;

typedef struct {
  uint32_t first, count;
  can_message messages[CAN_FIFO];
} fifo;

typedef struct {
  fifo out, in;
  can_message priority;
  uint32_t priority_full;
  tries tried; /* what goes out next, whatever comes */
  uint32_t ids[CAN_FILTERS], id_count;
  uint32_t events, enabled, joined;
} node;

static node nodes[NODES];
static struct {
  const node *sender; /* 0: the bus is idle */
  uint64_t ends;
  uint64_t busy_us;
  uint32_t early, crossed;
} bus;

static node *node_of(uintptr_t base) { return &nodes[base == CAN0_BASE ? 0 : 1]; }

static int fifo_add(fifo *f, const can_message *m) {
  if (f->count == CAN_FIFO) return 0;
  bytes_copy(&f->messages[(f->first + f->count) % CAN_FIFO], m, sizeof *m);
  ++f->count;
  return 1;
}
static void fifo_drop(fifo *f) {
  f->first = (f->first + 1u) % CAN_FIFO;
  --f->count;
}

/* Here a message is the frame's id, its length and its bytes in their order. */
static void from_frame(const frame *f, can_message *m) {
  m->id = f->id;
  m->dlc = f->length;
  m->data1 = bytes_load32(f->data);
  m->data2 = bytes_load32(f->data + 4);
}
void can_to_frame(const can_message *m, frame *f) {
  bytes_zero(f, sizeof *f);
  f->id = m->id;
  f->length = (uint8_t)m->dlc;
  bytes_store32(f->data, m->data1);
  bytes_store32(f->data + 4, m->data2);
}

/* 34 bits and the data are stuffed, one in four after the first; 13 bits are not. */
static uint32_t bits_of(const can_message *m) {
  const uint32_t stuffed = 34u + 8u * m->dlc;
  return stuffed + (stuffed - 1u) / 4u + 13u;
}

static void interrupt(const node *n) {
  const uint32_t line = lines[n - nodes];
  if ((n->events & n->enabled) != 0)
    device_write(distributor, GICD_ISPENDR + line / 32 * 4, 1u << line % 32);
}

static const can_message *next_of(node *n) {
  if (!n->joined) return 0;
  if (n->tried == TRIES_NONE && n->priority_full) n->tried = TRIES_FIRST;
  if (n->tried == TRIES_NONE && n->out.count != 0) n->tried = TRIES_FIFO;
  if (n->tried == TRIES_NONE) return 0;
  return n->tried == TRIES_FIRST ? &n->priority : &n->out.messages[n->out.first];
}

static void begin_frame(uint64_t now) {
  const can_message *wins = 0;
  bus.sender = 0;
  for (uint32_t n = 0; n < NODES; ++n) {
    const can_message *m = next_of(&nodes[n]);
    if (m == 0 || (wins != 0 && m->id >= wins->id)) continue;
    wins = m;
    bus.sender = &nodes[n];
  }
  if (wins == 0) return;
  bus.ends = now + timer_counts(bits_of(wins));
  bus.busy_us += bits_of(wins);
  device_wake(bus.ends);
}

static int passes(const node *n, const can_message *m) {
  for (uint32_t k = 0; k < n->id_count; ++k)
    if (n->ids[k] == m->id) return 1;
  return n->id_count == 0;
}

static uint32_t deliver(const node *sender, const can_message *m) {
  uint32_t heard = 0;
  for (uint32_t k = 0; k < NODES; ++k) {
    node *n = &nodes[k];
    if (n == sender || !n->joined) continue;
    ++heard;
    if (!passes(n, m)) continue;
    n->events |= fifo_add(&n->in, m) ? (uint32_t)CAN_RXOK : (uint32_t)CAN_RXOFLW;
    interrupt(n);
  }
  return heard;
}

static void end_frame(void) {
  node *n = &nodes[bus.sender - nodes];
  if (!n->joined) return;
  const can_message *m = n->tried == TRIES_FIRST ? &n->priority : &n->out.messages[n->out.first];
  if (deliver(n, m) == 0) return;
  if (n->tried == TRIES_FIRST) {
    n->priority_full = 0;
  } else {
    fifo_drop(&n->out);
    if (n == &nodes[0] && n->priority_full) ++bus.crossed;
  }
  n->tried = TRIES_NONE;
  n->events |= CAN_TXOK;
  interrupt(n);
}

uint64_t wire_step(uint64_t now) {
  if (bus.sender != 0 && now >= bus.ends) {
    end_frame();
    begin_frame(now);
  }
  return bus.sender != 0 ? bus.ends : now + timer_counts(WIRE_QUIET_US);
}

uint32_t wire_early(void) { return bus.early; }
uint32_t wire_crossed(void) { return bus.crossed; }
uint64_t wire_busy_us(void) { return bus.busy_us; }

/* Programs and interrupts both come here. */
static uint64_t enter(void) {
  const uint64_t before = CPU_READ(daif);
  cpu_mask_interrupts();
  return before;
}
static void leave(uint64_t before) {
  if (bus.sender == 0) begin_frame(timer_now());
  CPU_WRITE(daif, before);
}

void can_begin(uintptr_t base, const uint32_t *ids, uint32_t count, uint32_t events) {
  node *n = node_of(base);
  bytes_zero(n, sizeof *n);
  for (uint32_t k = 0; k < count; ++k) n->ids[k] = ids[k];
  n->id_count = count;
  n->enabled = events;
  n->joined = 1;
}

void can_join(uintptr_t base) {
  const uint64_t before = enter();
  node_of(base)->joined = 1;
  leave(before);
}

void can_leave(uintptr_t base) { node_of(base)->joined = 0; }

uint32_t can_take_events(uintptr_t base, uint32_t events) {
  node *n = node_of(base);
  const uint32_t found = n->events & events;
  n->events &= ~found;
  return found;
}

int can_send(uintptr_t base, const frame *f) {
  const uint64_t before = enter();
  can_message m;
  from_frame(f, &m);
  const int sent = fifo_add(&node_of(base)->out, &m);
  leave(before);
  return sent;
}

void can_send_first(uintptr_t base, const frame *f) {
  const uint64_t before = enter();
  node *n = node_of(base);
  from_frame(f, &n->priority);
  n->priority_full = 1;
  leave(before);
}

int can_first_waits(uintptr_t base) { return node_of(base)->priority_full != 0; }

int can_receive(uintptr_t base, can_message *m) {
  node *n = node_of(base);
  if (n == &nodes[0] && n->priority_full) ++bus.early;
  if (n->in.count == 0) return 0;
  bytes_copy(m, &n->in.messages[n->in.first], sizeof *m);
  fifo_drop(&n->in);
  return 1;
}
