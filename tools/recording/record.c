/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/recording/record.h"

#include <string.h>

#include "platform/log/candump.h"

int64_t record_time_us(uint64_t tick, uint32_t rate_hz) {
  const int64_t rate = rate_hz;
  /* Rounded up, so that floor(time * rate) gives the tick back. */
  const int64_t part = ((int64_t)(tick % rate_hz) * 1000000 + rate - 1) / rate;
  return RECORD_EPOCH_US + (int64_t)(tick / rate_hz) * 1000000 + part;
}

void record_begin(record *r, FILE *out, uint32_t instance, uint32_t hands, uint32_t rate_hz,
                  uint64_t tick, uint64_t hash) {
  memset(r, 0, sizeof *r);
  r->out = out;
  r->rate_hz = rate_hz == 0 ? 1 : rate_hz;
  r->first = tick;
  r->hash = (uint32_t)(hash & 0xFFFFFFFFu);
  port_sender_init(&r->sender, instance, hands, rate_hz);
}

static void record_frame(record *r, const frame *f) {
  const int64_t time_us = record_time_us(r->ticks, r->rate_hz);
  if (!candump_write(r->out, RECORD_INTERFACE, time_us, f)) r->failed = 1;
}

/* The first frame of the session, and of every tick whose low 32 bits are 0. */
static void record_identity(record *r) {
  const uint64_t tick = r->first + r->ticks;
  const codec_identity identity = {fray_physics_id(), (uint32_t)(tick >> 32)};
  frame f;
  if (r->ticks > 0 && (tick & UINT32_MAX) != 0) return;
  codec_encode_identity(&f, r->sender.instance, &identity);
  record_frame(r, &f);
}

static void record_sync(record *r) {
  const codec_sync sync = {(uint32_t)((r->first + r->ticks) & UINT32_MAX), r->hash};
  frame f;
  codec_encode_sync(&f, r->sender.instance, &sync);
  record_frame(r, &f);
}

static void record_input(record *r, const fray_input *input, const fray_output *output) {
  frame f;
  if (input->command != FRAY_COMMAND_NONE) {
    const codec_command command = {input->command_counter, input->command, 0};
    codec_encode_command(&f, r->sender.instance, &command);
    record_frame(r, &f);
  }
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    if ((input->has_pose & r->sender.hands & 1u << h) == 0) continue;
    const uint8_t counter = input->pose[h].counter & 15u;
    if (r->started ? counter == r->consumed[h] : r->first == 0 && counter == 0) r->failed = 1;
    if (counter != output->consumed[h]) r->failed = 1;
    codec_encode_pose(&f, r->sender.instance, h, &input->pose[h]);
    record_frame(r, &f);
  }
}

int record_tick(record *r, const fray_input *input, const fray_output *output) {
  frame frames[PORT_OUT];
  record_identity(r);
  record_input(r, input, output);
  record_sync(r);
  const uint32_t count = port_encode(&r->sender, output, frames);
  for (uint32_t n = 0; n < count; ++n) record_frame(r, &frames[n]);
  r->hash = (uint32_t)(output->hash & 0xFFFFFFFFu);
  r->ticks += 1;
  r->started = 1;
  memcpy(r->consumed, output->consumed, sizeof r->consumed);
  return !r->failed;
}

int record_end(record *r) {
  record_identity(r);
  record_sync(r);
  if (fflush(r->out) != 0) r->failed = 1;
  return !r->failed;
}
