/* SPDX-License-Identifier: Apache-2.0 */
#include "platform/loop.h"

#include "rt/base/bytes.h"

void loop_begin(loop *l, fray_world *world, uint32_t instance) {
  const fray_facts f = fray_describe(world);
  bytes_zero(l, sizeof *l);
  l->world = world;
  l->tick = f.tick;
  l->hash = (uint32_t)(fray_hash(world) & 0xFFFFFFFFu);
  port_init(&l->in, instance, f.hands, f.consumed);
  port_sender_init(&l->out, instance, f.hands, f.rate_hz);
  l->out.contacts_max = fray_limits(world).contacts;
}

void loop_protect(loop *l, guard *g) { l->in.guard = g; }

/* 0: its lane of freshness is spent, it never goes out. */
static int loop_seal(loop *l, frame *f) {
  if (!GUARD_SET(l->in.guard) || guard_seal(l->in.guard, f)) return 1;
  ++l->unsealed;
  if (l->output.state == FRAY_OPERATIONAL) l->halt = 1; /* forces must not come back by themselves */
  return 0;
}

void loop_command(loop *l, uint8_t verb) { l->command = verb; }

/* The verb is said on the bus first, so that a log of the bus holds every input. */
static void say_command(loop *l) {
  frame f;
  l->command_counter = (uint8_t)((l->command_counter + 1u) & 15u);
  const codec_command command = {l->command_counter, l->command, 0};
  codec_encode_command(&f, l->out.instance, &command);
  if (!loop_seal(l, &f) || platform_send(&f) != PLATFORM_SENT) return; /* tried again in the next tick */
  l->input.verb = l->command;
  l->input.verb_counter = l->command_counter;
  l->command = FRAY_VERB_NONE;
}

static void drop_unsent(loop *l) {
  l->frames_lost += l->unsent_count;
  l->unsent_count = 0;
}

/* Once more, and before what is newer: a FORCE, ACK or TEAR that is missing on the bus makes a tick
 * that no listener can replay. */
static void send_unsent(loop *l) {
  for (uint32_t n = 0; n < l->unsent_count; ++n)
    if (platform_send(&l->unsent[n]) != PLATFORM_SENT) l->frames_lost += 1;
  l->unsent_count = 0;
}

static void send_outputs(loop *l) {
  l->out.overruns = (uint16_t)(l->overruns < 65535u ? l->overruns : 65535u);
  const uint32_t count = port_encode(&l->out, &l->output, l->unsent);
  for (uint32_t n = 0; n < count; ++n) {
    frame *f = &l->unsent[n];
    if (!loop_seal(l, f) || platform_send(f) == PLATFORM_SENT) continue;
    if (l->unsent_count != n) bytes_copy(&l->unsent[l->unsent_count], f, sizeof *f);
    l->unsent_count += 1;
  }
}

static void obey_reset(loop *l) {
  const fray_output *out = &l->output;
  if (!GUARD_SET(l->in.guard) || out->acked != FRAY_VERB_RESET || out->result != FRAY_RESULT_OK) return;
  guard_clear(l->in.guard);
}

loop_result loop_take(loop *l) {
  const codec_sync sync = {l->tick, l->hash};
  frame f;
  const int32_t missed = platform_wait();
  if (missed < 0) return LOOP_STOPPED;
  l->overruns += (uint32_t)missed;
  if (GUARD_SET(l->in.guard)) guard_tick(l->in.guard);
  codec_encode_sync(&f, l->out.instance, &sync);
  if (platform_sync(&f, &l->in) != PLATFORM_SENT) {
    ++l->bus_losses;
    l->halt = 1;
    drop_unsent(l); /* a force of before must not be the first word after */
    return LOOP_BUS_LOST;
  }
  port_take(&l->in, &l->input);
  if (GUARD_SET(l->in.guard) && guard_alarm(l->in.guard)) l->halt = 1;
  if (l->halt != 0) l->command = FRAY_VERB_HALT;
  if (l->command != FRAY_VERB_NONE) say_command(l);
  send_unsent(l); /* now or never: also when HALT has to wait */
  if (l->halt != 0 && l->input.verb != FRAY_VERB_HALT) return LOOP_BUS_LOST;
  l->halt = 0;
  return LOOP_TICKED;
}

void loop_give(loop *l) {
  obey_reset(l);
  l->tick = l->output.tick + 1u;
  l->hash = (uint32_t)(l->output.hash & 0xFFFFFFFFu);
  send_outputs(l);
}

loop_result loop_run(loop *l) {
  const loop_result result = loop_take(l);
  if (result != LOOP_TICKED) return result;
  fray_tick(l->world, &l->input, &l->output);
  loop_give(l);
  return LOOP_TICKED;
}
