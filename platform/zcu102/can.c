/* SPDX-License-Identifier: Apache-2.0 */
#include "platform/zcu102/can.h"

#include "platform/zcu102/cpu.h"

enum { /* offsets */
  SRR = 0x00,       /* software reset: SRST, CEN */
  MSR = 0x04,       /* mode: all zero is normal */
  BRPR = 0x08,      /* baud rate prescaler */
  BTR = 0x0C,       /* bit timing */
  SR = 0x18,        /* status */
  ISR = 0x1C,       /* interrupt status, enable, clear */
  IER = 0x20,
  ICR = 0x24,
  TXFIFO_ID = 0x30, /* four words each: id, length, data; the last one sends */
  TXHPB_ID = 0x40,
  RXFIFO_ID = 0x50,
  AFR = 0x60,       /* which acceptance filters are on */
  AFMR1 = 0x64,     /* mask and id, eight bytes a filter */
  AFIR1 = 0x68
};
enum { WORD_DLC = 0x4, WORD_DATA1 = 0x8, WORD_DATA2 = 0xC };
enum { SRR_SRST = 1 << 0, SRR_CEN = 1 << 1 };
enum { SR_CONFIG = 1 << 0, SR_TXBFLL = 1 << 9, SR_TXFLL = 1 << 10, SR_ACFBSY = 1 << 11 };
enum { ID_SHIFT = 21, ID_REMOTE = 1 << 20, ID_EXTENDED = 1 << 19, DLC_SHIFT = 28 };
enum { EVENTS = 0x7FFF }; /* all of ISR */
enum { TRIES = 100000 }; /* of a bit that the controller sets within a few of its clocks */

/* 100 MHz / 5 is 20 quanta a bit: 1 sync, 15 before the sample point (80 %), 4 behind it. */
enum { PRESCALER = 5, BEFORE = 15, BEHIND = 4, JUMP = 4 };

static void wait_for(uintptr_t base, uint32_t bit, uint32_t value) {
  for (uint32_t n = 0; n < TRIES && (device_read(base, SR) & bit) != value; ++n) {
  }
}

static void set_filters(uintptr_t base, const uint32_t *ids, uint32_t count) {
  device_write(base, AFR, 0);
  wait_for(base, SR_ACFBSY, 0);
  for (uint32_t n = 0; n < count; ++n) {
    device_write(base, AFMR1 + 8 * n, (uint32_t)FRAME_ID_MAX << ID_SHIFT | ID_EXTENDED);
    device_write(base, AFIR1 + 8 * n, ids[n] << ID_SHIFT);
  }
  device_write(base, AFR, (1u << count) - 1u);
}

void can_begin(uintptr_t base, const uint32_t *ids, uint32_t count, uint32_t events) {
  device_write(base, SRR, SRR_SRST);
  wait_for(base, SR_CONFIG, SR_CONFIG);
  device_write(base, MSR, 0);
  device_write(base, BRPR, PRESCALER - 1);
  device_write(base, BTR, (JUMP - 1) << 7 | (BEHIND - 1) << 4 | (BEFORE - 1));
  set_filters(base, ids, count < CAN_FILTERS ? count : (uint32_t)CAN_FILTERS);
  device_write(base, ICR, EVENTS);
  device_write(base, IER, events);
  can_join(base);
}

void can_join(uintptr_t base) {
  device_write(base, SRR, SRR_CEN);
  wait_for(base, SR_CONFIG, 0);
}

void can_leave(uintptr_t base) {
  device_write(base, SRR, 0);
  wait_for(base, SR_CONFIG, SR_CONFIG);
}

/* Cleared before they are acted on: one that comes meanwhile interrupts again. */
uint32_t can_take_events(uintptr_t base, uint32_t events) {
  const uint32_t found = device_read(base, ISR) & events;
  device_write(base, ICR, found);
  return found;
}

/* Byte 0 is the highest of its word. */
static uint32_t pack(const uint8_t *data, uint32_t length) {
  uint32_t word = 0;
  for (uint32_t n = 0; n < 4; ++n) word = word << 8 | (n < length ? data[n] : 0u);
  return word;
}

static void unpack(uint32_t word, uint8_t *data) {
  for (uint32_t n = 0; n < 4; ++n) data[n] = (uint8_t)(word >> (24u - 8u * n) & 0xFFu);
}

static void write_message(uintptr_t base, uint32_t offset, const frame *f) {
  const uint32_t length = f->length < FRAME_DATA_CLASSIC ? f->length : (uint32_t)FRAME_DATA_CLASSIC;
  device_write(base, offset, (f->id & FRAME_ID_MAX) << ID_SHIFT);
  device_write(base, offset + WORD_DLC, length << DLC_SHIFT);
  device_write(base, offset + WORD_DATA1, pack(f->data, length));
  device_write(base, offset + WORD_DATA2, pack(f->data + 4, length > 4 ? length - 4 : 0));
}

/* SR says it on the part; QEMU has it in ISR only. */
int can_send(uintptr_t base, const frame *f) {
  device_write(base, ICR, CAN_TXFLL);
  if ((device_read(base, SR) & SR_TXFLL) != 0) return 0;
  if ((device_read(base, ISR) & CAN_TXFLL) != 0) return 0;
  write_message(base, TXFIFO_ID, f);
  return 1;
}

void can_send_first(uintptr_t base, const frame *f) { write_message(base, TXHPB_ID, f); }

int can_first_waits(uintptr_t base) { return (device_read(base, SR) & SR_TXBFLL) != 0; }

int can_receive(uintptr_t base, can_message *m) {
  device_write(base, ICR, CAN_RXNEMP); /* set again at once where a message is left */
  if ((device_read(base, ISR) & CAN_RXNEMP) == 0) return 0;
  m->id = device_read(base, RXFIFO_ID);
  m->dlc = device_read(base, RXFIFO_ID + WORD_DLC);
  m->data1 = device_read(base, RXFIFO_ID + WORD_DATA1);
  m->data2 = device_read(base, RXFIFO_ID + WORD_DATA2);
  return 1;
}

void can_to_frame(const can_message *m, frame *f) {
  const uint32_t length = m->dlc >> DLC_SHIFT;
  f->extended = (m->id & ID_EXTENDED) != 0;
  f->id = f->extended ? (m->id >> ID_SHIFT) << 18 | (m->id >> 1 & 0x3FFFFu) : m->id >> ID_SHIFT;
  f->rtr = (m->id & (f->extended ? 1u : (uint32_t)ID_REMOTE)) != 0;
  f->error = 0;
  f->fd = 0;
  f->length = (uint8_t)(length < FRAME_DATA_CLASSIC ? length : (uint32_t)FRAME_DATA_CLASSIC);
  unpack(m->data1, f->data);
  unpack(m->data2, f->data + 4);
}
