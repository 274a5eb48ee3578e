/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/target/zcu102/device.h"

#include "platform/zcu102/board.h"
#include "platform/zcu102/can.h"
#include "platform/zcu102/cpu.h"
#include "platform/zcu102/gic.h"
#include "rt/base/bytes.h"
#include "rt/wire/codec.h"
#include "rt/wire/dictionary.h"
#include "tests/target/zcu102/recorder.h"
#include "tests/target/zcu102/wire.h"

enum { STEP_US = 250, SILENCE_US = 3000, INSTANCE = 0, CNTP_ENABLE = 1 };

device_report device_felt;

static struct {
  const device_plan *plan;
  const fray_input *script;
  uint32_t count;
  uint64_t step_at, wake_at; /* counts: its own next step; when the timer interrupts */
  uint64_t off_until; /* 0: all are on the bus, or nothing is to happen any more */
  uint32_t off_done;
  uint64_t felt_at; /* counts; 0: no force is felt */
  uint8_t counter[FRAY_HANDS], newest[FRAY_HANDS], command;
  uint8_t felt[FRAY_HANDS], has_felt[FRAY_HANDS];
} self;

static void send_frame(const frame *f) {
  recorder_add(f, timer_us(timer_now()));
  if (!can_send(CAN1_BASE, f)) ++device_felt.bad;
}

static const fray_input *answer_to(uint32_t sync) {
  return &self.script[sync < self.count ? sync : self.count - 1];
}

static void say_poses(const fray_input *in) {
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    frame f;
    fray_pose pose;
    bytes_copy(&pose, &in->pose[h], sizeof pose);
    self.counter[h] = (uint8_t)((self.counter[h] + 1u) & 15u);
    pose.counter = self.counter[h];
    codec_encode_pose(&f, INSTANCE, h, &pose);
    send_frame(&f);
  }
}

static void send_command(uint8_t verb) {
  frame f;
  self.command = (uint8_t)((self.command + 1u) & 15u);
  const codec_command command = {self.command, verb, 0};
  codec_encode_command(&f, INSTANCE, &command);
  send_frame(&f);
}

static void flood(void) {
  frame f;
  const fray_pose pose = {0, 0, 0, 0, 0};
  codec_encode_pose(&f, INSTANCE, 0, &pose);
  f.data[0] ^= 0xFFu;
  for (uint32_t n = 0; n < DEVICE_FLOOD; ++n) send_frame(&f);
}

static int is_silent(uint32_t sync) {
  const device_plan *p = self.plan;
  return p->silent_from != 0 && sync >= p->silent_from && sync - p->silent_from < p->silent_for;
}

static void hear_sync(const frame *f) {
  codec_sync sync;
  if (codec_decode_sync(f, INSTANCE, &sync) != CODEC_OK) {
    ++device_felt.bad;
    return;
  }
  const uint32_t number = device_felt.syncs++;
  bytes_copy(self.newest, self.counter, sizeof self.newest);
  const fray_input *in = answer_to(number);
  if (in->command != FRAY_COMMAND_NONE && number < self.count) send_command(in->command);
  if (self.plan->flood_at != 0 && number == self.plan->flood_at) {
    flood();
  } else if (!is_silent(number)) {
    say_poses(in);
  }
}

static void feel(const frame *f, uint32_t hand) {
  codec_force force;
  if (codec_decode_force(f, INSTANCE, hand, &force) != CODEC_OK) {
    ++device_felt.bad;
    return;
  }
  if (self.has_felt[hand] && force.counter != ((self.felt[hand] + 1u) & 15u)) ++device_felt.gaps;
  if (force.consumed != self.newest[hand]) ++device_felt.off_tick;
  self.has_felt[hand] = 1;
  self.felt[hand] = force.counter;
  self.felt_at = timer_now();
  const int16_t axes[3] = {force.x, force.y, force.z};
  bytes_copy(device_felt.force[hand], axes, sizeof axes);
  ++device_felt.forces;
}

static void hear(const frame *f) {
  recorder_add(f, timer_us(timer_now()));
  switch (dictionary_find(f->id, INSTANCE)) {
    case MESSAGE_SYNC: hear_sync(f); break;
    case MESSAGE_FORCE_LEFT: feel(f, 0); break;
    case MESSAGE_FORCE_RIGHT: feel(f, 1); break;
    default: break;
  }
}

static void can_interrupt(void) {
  can_message m;
  (void)can_take_events(CAN1_BASE, CAN_RXOK);
  for (uint32_t n = 0; n < CAN_FIFO && can_receive(CAN1_BASE, &m); ++n) {
    frame f;
    can_to_frame(&m, &f);
    hear(&f);
  }
}

static void drop_force(uint64_t now) {
  if (self.felt_at == 0 || now - self.felt_at < timer_counts(SILENCE_US)) return;
  const uint32_t after_us = (uint32_t)timer_us(now - self.felt_at);
  if (after_us > device_felt.zeroed_us) device_felt.zeroed_us = after_us;
  bytes_zero(device_felt.force, sizeof device_felt.force);
  self.felt_at = 0;
  ++device_felt.zeroed;
}

/* QEMU's controllers need nobody to acknowledge a frame. There CAN 0 itself is taken off the bus:
 * what it sends waits, and no confirmation comes. */
static void cut_bus(uint64_t now) {
  const device_plan *p = self.plan;
  if (p->off_from != 0 && !self.off_done && device_felt.syncs >= p->off_from) {
    self.off_done = 1;
    self.off_until = p->off_us != 0 ? now + timer_counts(p->off_us) : 0;
    can_leave(p->off_base);
  }
  if (self.off_until != 0 && now >= self.off_until) {
    self.off_until = 0;
    can_join(p->off_base);
  }
}

void device_wake(uint64_t at) {
  if (at >= self.wake_at) return;
  self.wake_at = at;
  CPU_WRITE(cntp_cval_el0, at);
}

static void step(void) {
  const uint64_t now = timer_now();
  self.wake_at = UINT64_MAX;
  device_wake(wire_step(now));
  if (now >= self.step_at) {
    self.step_at = now + timer_counts(STEP_US);
    drop_force(now);
    cut_bus(now);
  }
  device_wake(self.step_at);
}

void board_other_interrupt(uint32_t id) {
  if (id == GIC_CAN1) {
    can_interrupt();
  } else if (id == GIC_TIMER_PHYSICAL || id == GIC_TIMER_SECURE) {
    step();
  } else {
    ++zcu102_board.unexpected;
  }
}

void simulated_device_begin(const device_plan *plan, const fray_input *script, uint32_t count) {
  self.plan = plan;
  self.script = script;
  self.count = count;
  can_begin(CAN1_BASE, 0, 0, CAN_RXOK);
  gic_enable(GIC_CAN1, BOARD_PRIORITY_OTHER);
  gic_enable(GIC_TIMER_PHYSICAL, BOARD_PRIORITY_OTHER);
  gic_enable(GIC_TIMER_SECURE, BOARD_PRIORITY_OTHER);
  self.wake_at = UINT64_MAX;
  self.step_at = timer_now() + timer_counts(STEP_US);
  device_wake(self.step_at);
  CPU_WRITE(cntp_ctl_el0, CNTP_ENABLE);
}
