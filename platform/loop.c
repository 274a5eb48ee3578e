/* SPDX-License-Identifier: Apache-2.0 */
#include "platform/loop.h"

#include "rt/base/assert.h"
#include "rt/base/bytes.h"
#include "rt/wire/dictionary.h"

void loop_begin(loop *l, fray_world *world, uint32_t instance) {
  FRAY_ASSERT(l != NULL && world != NULL && instance < DICTIONARY_INSTANCES);
  const fray_info f = fray_get_info(world);
  bytes_zero(l, sizeof *l);
  l->world = world;
  l->tick = f.tick;
  l->identify = 1;
  l->hash = (uint32_t)(fray_hash(world) & UINT32_MAX);
  port_init(&l->in, instance, f.hands, f.consumed);
  port_sender_init(&l->out, instance, f.hands, f.rate_hz);
  l->out.contacts_max = fray_work_bound(world).contacts;
}

static void loop_count(uint32_t *counter, uint32_t by) {
  *counter = *counter > UINT32_MAX - by ? UINT32_MAX : *counter + by;
}

void loop_protect(loop *l, auth_gate *g) { l->in.gate = g; }

/* Returns 0 iff the frame can never be sent: its lane of freshness is spent. */
static int loop_seal(loop *l, frame *f) {
  if (!AUTH_GATE_SET(l->in.gate) || auth_gate_seal(l->in.gate, f)) return 1;
  loop_count(&l->unsealed, 1);
  if (l->output.state == FRAY_OPERATIONAL) l->halt = 1; /* forces must not come back by themselves */
  return 0;
}

void loop_command(loop *l, uint8_t command) {
  FRAY_ASSERT(l != NULL && command != FRAY_COMMAND_NONE);
  l->command = command;
}

/* The command goes over the bus first, so that a log of the bus has every input. */
static void send_command(loop *l) {
  FRAY_ASSERT(l->command != FRAY_COMMAND_NONE);
  frame f;
  l->command_counter = (uint8_t)((l->command_counter + 1u) & 15u);
  const codec_command command = {l->command_counter, l->command, 0};
  codec_encode_command(&f, l->out.instance, &command);
  if (!loop_seal(l, &f) || platform_send(&f) != PLATFORM_SENT) return; /* tried again in the next tick */
  l->input.command = l->command;
  l->input.command_counter = l->command_counter;
  l->command = FRAY_COMMAND_NONE;
}

static void drop_unsent(loop *l) {
  loop_count(&l->frames_lost, l->unsent_count);
  l->unsent_count = 0;
}

/* Sends them again, before newer ones: a FORCE, ACK or TEAR that is missing on the bus makes a tick that
 * no listener can replay. */
static void send_unsent(loop *l) {
  FRAY_ASSERT(l->unsent_count <= PORT_OUT);
  for (uint32_t n = 0; n < l->unsent_count; ++n)
    if (platform_send(&l->unsent[n]) != PLATFORM_SENT) loop_count(&l->frames_lost, 1);
  l->unsent_count = 0;
}

static void send_outputs(loop *l) {
  FRAY_ASSERT(l->unsent_count == 0);
  l->out.overruns = (uint16_t)(l->overruns < 65535u ? l->overruns : 65535u);
  const uint32_t count = port_encode(&l->out, &l->output, l->unsent);
  for (uint32_t n = 0; n < count; ++n) {
    frame *f = &l->unsent[n];
    if (!loop_seal(l, f) || platform_send(f) == PLATFORM_SENT) continue;
    if (l->unsent_count != n) bytes_copy(&l->unsent[l->unsent_count], f, sizeof *f);
    l->unsent_count += 1;
  }
}

static void handle_reset(loop *l) {
  const fray_output *out = &l->output;
  if (!AUTH_GATE_SET(l->in.gate)) return;
  if (out->answered != FRAY_COMMAND_RESET || out->result != FRAY_RESULT_OK) return;
  auth_gate_clear(l->in.gate);
}

/* Refused, it is tried again before the next SYNC. */
__attribute__((noinline)) static void send_identity(loop *l) {
  const codec_identity identity = {fray_physics_id(), (uint32_t)(l->tick >> 32)};
  frame f;
  codec_encode_identity(&f, l->out.instance, &identity);
  if (platform_send(&f) == PLATFORM_SENT) l->identify = 0;
}

/* Waits for the tick and sends its SYNC. */
static loop_result begin_tick(loop *l) {
  FRAY_ASSERT(l != NULL && l->world != NULL);
  const codec_sync sync = {(uint32_t)(l->tick & UINT32_MAX), l->hash};
  frame f;
  const int32_t missed = platform_wait();
  if (missed < 0) return LOOP_STOPPED;
  loop_count(&l->overruns, (uint32_t)missed);
  if (AUTH_GATE_SET(l->in.gate)) auth_gate_begin_tick(l->in.gate);
  if (l->identify != 0) send_identity(l);
  codec_encode_sync(&f, l->out.instance, &sync);
  if (platform_sync(&f, &l->in) == PLATFORM_SENT) return LOOP_TICKED;
  loop_count(&l->bus_losses, 1);
  l->halt = 1;
  drop_unsent(l); /* an old force must not be the first one after the loss */
  return LOOP_BUS_LOST;
}

loop_result loop_receive(loop *l) {
  const loop_result result = begin_tick(l);
  if (result != LOOP_TICKED) return result;
  port_take(&l->in, &l->input);
  if (AUTH_GATE_SET(l->in.gate) && auth_gate_alarm(l->in.gate)) l->halt = 1;
  if (l->halt != 0) l->command = FRAY_COMMAND_HALT;
  if (l->command != FRAY_COMMAND_NONE) send_command(l);
  send_unsent(l); /* the last chance of these frames, also when HALT could not be sent */
  if (l->halt != 0 && l->input.command != FRAY_COMMAND_HALT) return LOOP_BUS_LOST;
  l->halt = 0;
  return LOOP_TICKED;
}

loop_result loop_close(loop *l) {
  const loop_result result = begin_tick(l);
  if (result == LOOP_TICKED) send_unsent(l);
  return result;
}

void loop_send(loop *l) {
  FRAY_ASSERT(l->output.tick == l->tick);
  handle_reset(l);
  l->tick = l->output.tick + 1u;
  if ((l->tick & UINT32_MAX) == 0) l->identify = 1;
  l->hash = (uint32_t)(l->output.hash & 0xFFFFFFFFu);
  send_outputs(l);
}

loop_result loop_run(loop *l) {
  const loop_result result = loop_receive(l);
  if (result != LOOP_TICKED) return result;
  fray_tick(l->world, &l->input, &l->output);
  loop_send(l);
  return LOOP_TICKED;
}
