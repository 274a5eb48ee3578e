/* SPDX-License-Identifier: Apache-2.0 */
/* The whole of it for a stack bound: runtime, wire, loop, start-up and a board whose bus is in flash.
 * On the painted stack every case goes through the loop with whatever calls deep: poses, commands, a
 * flood of frames, a lost bus, RESET and START after it, tears, contacts, a save and an open every
 * SAVE_EVERY ticks; the first case once more under a key. Prints for each
 *
 *   case NAME ticks N state S cuts N lost N resets N refused N [tags N]
 *
 * and last `stack BYTES`: what was touched of it, from its top. */
#include "platform/bare/bare.h"
#include "platform/loop.h"
#include "rt/base/bytes.h"
#include "rt/wire/codec.h"
#include "tests/determinism/cases.h"

#ifndef FIRMWARE_MEMORY
#define FIRMWARE_MEMORY 24576
#endif
#ifndef FIRMWARE_SAVES
#define FIRMWARE_SAVES 2 /* buffers; none on the smallest, and no room for a key */
#endif
enum {
  MEMORY = FIRMWARE_MEMORY,
  SAVE_EVERY = 64,
  WAIT_EVERY = 16, /* ticks are 1 ms, and need not be waited for */
  FLOOD_TICK = 30,
  FLOOD = 300,
  LATE_TICK = 40,
  LOST_TICK = 400, /* twice in a row; RESET and START follow */
  RESET_TICK = 410,
  START_TICK = 420
};

static struct {
  const replay_case *now;
  uint32_t tick;
  uint32_t losses;
  uint32_t resets;
  uint32_t bits; /* of what was sent: nothing is computed for nobody */
  uint8_t command_counter;
} board;

static loop running;
static _Alignas(FRAY_ALIGN) uint8_t memory[FIRMWARE_SAVES > 0 ? 2 : 1][MEMORY];
#if FIRMWARE_SAVES > 0
static _Alignas(FRAY_ALIGN) uint8_t saved[2][MEMORY];
#endif

int32_t platform_wait(void) {
  if (board.tick >= board.now->ticks) return -1;
  if (board.tick == LATE_TICK) return 2;
  return board.tick % WAIT_EVERY == 0 ? tick_wait() : 0;
}

static void send_command(port *p, uint8_t verb) {
  frame f;
  board.command_counter = (uint8_t)((board.command_counter + 1u) & 15u);
  const codec_command command = {board.command_counter, verb, 0};
  codec_encode_command(&f, 0, &command);
  port_push(p, &f);
  if (verb == FRAY_COMMAND_RESET) ++board.resets;
}

#if FIRMWARE_SAVES > 0
static struct {
  cmac_key key;
  auth_gate runtime;
  auth_gate device;
} tags;

static void tags_begin(void) {
  static const uint8_t key[CMAC_KEY] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
  const uint32_t hands = (1u << FRAY_HANDS) - 1u;
  cmac_key_init(&tags.key, key);
  auth_gate_init(&tags.runtime, &tags.key, AUTH_GATE_CLASSIC, AUTH_GATE_RUNTIME, 0, hands);
  auth_gate_init(&tags.device, &tags.key, AUTH_GATE_CLASSIC, AUTH_GATE_DEVICE, 0, hands);
  loop_protect(&running, &tags.runtime);
}

static void say_tag(port *p, const frame *pose) {
  frame tag;
  if (p->gate != 0 && auth_gate_tag(&tags.device, pose, &tag)) port_push(p, &tag);
}
#else
static void tags_begin(void) {}
static void say_tag(port *p, const frame *pose) {
  (void)p;
  (void)pose;
}
#endif

static void say_poses(port *p, const fray_input *input) {
  frame f;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    if ((input->has_pose & 1u << h) == 0) continue;
    codec_encode_pose(&f, 0, h, &input->pose[h]);
    port_push(p, &f);
    say_tag(p, &f);
  }
}

/* Damaged ones, foreign ones, and more than the queue takes. */
static void flood(port *p) {
  frame f;
  const fray_pose pose = {0, 0, 0, 3, 0};
  for (uint32_t n = 0; n < FLOOD; ++n) {
    codec_encode_pose(&f, 0, n & 1u, &pose);
    if (n % 3 == 0) f.data[7] ^= 1u;
    if (n % 16 == 0) f.id += 7;
    port_push(p, &f);
  }
}

platform_result platform_sync(const frame *sync, port *p) {
  board.bits ^= sync->data[4];
  if (board.tick == LOST_TICK && board.losses < 2) {
    ++board.losses;
    return PLATFORM_LOST;
  }
  const uint32_t tick = board.tick++;
  if (tick == FLOOD_TICK) flood(p);
  if (tick == RESET_TICK) send_command(p, FRAY_COMMAND_RESET);
  if (tick == START_TICK) send_command(p, FRAY_COMMAND_START);
  if (tick >= board.now->input_count) return PLATFORM_SENT;
  const fray_input *input = &board.now->inputs[tick];
  if (input->command != FRAY_COMMAND_NONE) send_command(p, input->command);
  say_poses(p, input);
  return PLATFORM_SENT;
}

platform_result platform_send(const frame *f) {
  board.bits ^= f->data[0];
  return PLATFORM_SENT;
}

static void print_number(const char *label, uint32_t v) {
  platform_print(label);
  bare_print_number(v);
}

static fray_world *open_world(const uint8_t *image, size_t bytes, uint32_t at) {
  fray_world *world = 0;
  size_t needed = 0;
  if (fray_memory_size(image, bytes, &needed, 0) != FRAY_OK || needed > MEMORY) return 0;
  return fray_open(image, bytes, memory[at], MEMORY, &world, 0) == FRAY_OK ? world : 0;
}

#if FIRMWARE_SAVES > 0
/* A damaged image is refused before and behind its CRC. */
static uint32_t refusals(void) {
  uint32_t refused = 0;
  fray_error error;
  fray_world *world = 0;
  for (uint32_t bytes = 0; bytes < 4; ++bytes)
    refused += fray_open(saved[0], bytes * 60u, memory[1], MEMORY, &world, &error) != FRAY_OK;
  saved[0][200] ^= 1u;
  refused += fray_open(saved[0], MEMORY, memory[1], MEMORY, &world, &error) != FRAY_OK;
  return refused;
}

static fray_world *save_and_open(const fray_world *world) {
  const uint32_t at = board.tick / SAVE_EVERY & 1u;
  const size_t bytes = fray_save(world, saved[at], MEMORY);
  return open_world(saved[at], bytes, 1u - at);
}
#else
static uint32_t refusals(void) { return 0; }
static fray_world *save_and_open(fray_world *world) { return world; }
#endif

static int run_case(const replay_case *c, int under_key) {
  fray_world *world = open_world(c->image, c->image_bytes, 0);
  if (world == 0) return 0;
  board.now = c;
  board.tick = board.losses = board.resets = 0;
  loop_begin(&running, world, 0);
  if (under_key) tags_begin();
  while (loop_run(&running) != LOOP_STOPPED) {
    if (board.tick % SAVE_EVERY != SAVE_EVERY - 1u) continue;
    running.world = save_and_open(running.world);
    if (running.world == 0) return 0;
  }
  platform_print("case ");
  platform_print(c->name);
  print_number(" ticks ", (uint32_t)running.tick);
  print_number(" state ", running.output.state);
  print_number(" cuts ", running.output.tears_total);
  print_number(" lost ", running.bus_losses);
  print_number(" resets ", board.resets);
  print_number(" refused ", refusals());
  if (running.in.gate != 0) print_number(" tags ", running.in.gate->monitor[0].good);
  platform_print("\n");
  return 1;
}

int main(void) {
  int good = 1;
  tick_begin(TARGET_CLOCK_HZ, 1000);
  for (uint32_t n = 0; n < replay_case_count; ++n) good = run_case(&replay_cases[n], 0) && good;
  if (FIRMWARE_SAVES > 0) good = run_case(&replay_cases[0], 1) && good;
  print_number("stack ", bare_stack_used());
  platform_print("\n");
  return good ? 0 : 1;
}
