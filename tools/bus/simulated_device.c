/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/bus/simulated_device.h"

#include <math.h>
#include <string.h>

#include "rt/base/random.h"
#include "rt/wire/codec.h"

/* An arm that holds a light handle: 300 N/m, damped at 0.7 of critical, 0.15 kg. */
static const double arm_mass = 0.15;
static const double arm_spring = 300.0;
static const double arm_damper = 9.4;
static const double force_max = 8.0;
static const double reach = 0.04;
static const double pose_metres = 2e-6;
static const double force_newtons = 0.5e-3;
enum { SILENT_TICKS = 3, STEPS = 4 };

static void scripted(const simulated_device *d, uint32_t hand, double position[3]) {
  const fray_pose p = script_pose(d->script, hand, d->tick);
  position[0] = p.x * pose_metres;
  position[1] = p.y * pose_metres;
  position[2] = p.z * pose_metres;
}

void simulated_device_begin(simulated_device *d, const script *s, const device_faults *faults) {
  memset(d, 0, sizeof *d);
  d->script = s;
  d->faults = *faults;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    if (s->keys[h] != 0) {
      simulated_handle *handle = &d->handle[h];
      scripted(d, h, handle->position);
      handle->arm = arm_make((double)s->arm_mass_mg * 1e-6, (double)s->arm_stiffness_un * 1e-6, s->arm_delay);
      memcpy(handle->arm.at, handle->position, sizeof handle->arm.at);
      memcpy(handle->arm.aim, handle->position, sizeof handle->arm.aim);
    }
}

void simulated_device_receive(simulated_device *d, const frame *f) {
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    codec_force felt;
    if (codec_decode_force(f, d->script->instance, h, &felt) != CODEC_OK) continue;
    simulated_handle *handle = &d->handle[h];
    handle->silent_ticks = 0;
    handle->force[0] = fmax(-force_max, fmin(force_max, felt.x * force_newtons));
    handle->force[1] = fmax(-force_max, fmin(force_max, felt.y * force_newtons));
    handle->force[2] = fmax(-force_max, fmin(force_max, felt.z * force_newtons));
  }
}

/* Semi-implicit Euler, four steps a tick. */
static void push(simulated_handle *h, const double target[3], double tick_s) {
  const double dt = tick_s / STEPS;
  for (int step = 0; step < STEPS; ++step)
    for (int n = 0; n < 3; ++n) {
      const double pull = arm_spring * (target[n] - h->position[n]) - arm_damper * h->speed[n];
      h->speed[n] += (pull + h->force[n]) / arm_mass * dt;
      h->position[n] += h->speed[n] * dt;
    }
}

/* Of the script's arm, whose goal is the keyframe's place. */
static void push_arm(simulated_handle *h, const double target[3], double tick_s) {
  int16_t force[3];
  int16_t pose[3];
  for (int n = 0; n < 3; ++n) force[n] = (int16_t)lrint(h->force[n] / force_newtons);
  arm_tick(&h->arm, force, target, tick_s, pose);
  memcpy(h->position, h->arm.at, sizeof h->position);
}

static void keep_in_reach(simulated_handle *h) {
  const double r = sqrt(h->position[0] * h->position[0] + h->position[1] * h->position[1] +
                        h->position[2] * h->position[2]);
  if (r <= reach) return;
  for (int n = 0; n < 3; ++n) {
    h->position[n] *= reach / r;
    h->speed[n] = 0.0;
  }
}

static uint32_t draw(simulated_device *d) { return random_bits(d->faults.seed, d->draws++) % 1000u; }

static int16_t to_pose(double metres) {
  return (int16_t)lrint(fmax(-32767.0, fmin(32767.0, metres / pose_metres)));
}

static fray_pose pose_of(simulated_device *d, uint32_t hand) {
  simulated_handle *h = &d->handle[hand];
  double target[3];
  scripted(d, hand, target);
  if (d->faults.rigid != 0) {
    memcpy(h->position, target, sizeof target);
  } else if (d->script->arm_mass_mg != 0) {
    push_arm(h, target, 1.0 / d->script->rate_hz);
  } else {
    push(h, target, 1.0 / d->script->rate_hz);
    keep_in_reach(h);
  }
  fray_pose p = {to_pose(h->position[0]), to_pose(h->position[1]), to_pose(h->position[2]), 0, 0};
  const uint32_t now_ms = (uint32_t)((uint64_t)d->tick * 1000u / d->script->rate_hz);
  if (d->faults.jump_ms != 0 && now_ms >= d->faults.jump_ms) {
    const uint32_t corner = random_bits(d->faults.seed + 1u, d->tick);
    p.x = (corner & 1u) != 0 ? INT16_MAX : INT16_MIN;
    p.y = (corner & 2u) != 0 ? INT16_MAX : INT16_MIN;
    p.z = (corner & 4u) != 0 ? INT16_MAX : INT16_MIN;
  }
  return p;
}

static uint32_t send_commands(simulated_device *d, frame *frames, uint32_t count, uint32_t room) {
  const script *s = d->script;
  while (d->commands < s->commands && count < room &&
         script_tick_at(s, s->command[d->commands].time_us) <= d->tick) {
    const codec_command command = {(uint8_t)((d->commands + 1u) & 15u),
                                   (uint8_t)s->command[d->commands].verb, 0};
    codec_encode_command(&frames[count++], s->instance, &command);
    ++d->commands;
  }
  return count;
}

/* One pose with its faults; at most three frames. */
static uint32_t send_pose(simulated_device *d, uint32_t hand, frame *frames, uint32_t count) {
  simulated_handle *h = &d->handle[hand];
  frame f;
  fray_pose p = pose_of(d, hand);
  h->counter = (uint8_t)((h->counter + 1u) & 15u);
  p.counter = h->counter;
  codec_encode_pose(&f, d->script->instance, hand, &p);
  if (draw(d) < d->faults.drop) return count;
  if (draw(d) < d->faults.corrupt) f.data[2 + draw(d) % 6u] ^= (uint8_t)(1u << draw(d) % 8u);
  if (!h->has_held_back && draw(d) < d->faults.reorder) {
    h->held_back = f;
    h->has_held_back = 1;
    return count;
  }
  frames[count++] = f;
  if (h->has_held_back) {
    frames[count++] = h->held_back;
    h->has_held_back = 0;
  }
  if (draw(d) < d->faults.repeat) frames[count++] = f;
  return count;
}

uint32_t simulated_device_step(simulated_device *d, frame frames[SIMULATED_DEVICE_FRAMES]) {
  const uint32_t now_ms = (uint32_t)((uint64_t)d->tick * 1000u / d->script->rate_hz);
  uint32_t count = send_commands(d, frames, 0, SIMULATED_DEVICE_FRAMES - 3 * FRAY_HANDS);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    if (d->script->keys[h] == 0) continue;
    if (++d->handle[h].silent_ticks > SILENT_TICKS)
      memset(d->handle[h].force, 0, sizeof d->handle[h].force);
    if (d->faults.freeze_ms != 0 && now_ms >= d->faults.freeze_ms) continue;
    count = send_pose(d, h, frames, count);
  }
  ++d->tick;
  return count;
}

int simulated_device_done(const simulated_device *d) { return d->tick >= script_ticks(d->script); }
