/* SPDX-License-Identifier: Apache-2.0 */
#include "platform/playback/player.h"

#include "platform/bare/bare.h"
#include "rt/base/bytes.h"
#include "rt/wire/dictionary.h"

enum { STATUS_OVERRUNS = 4 }; /* a 16-bit field of STATUS, see rt/wire/README.md */

player playback;

void player_begin(const player_frame *frames, uint32_t count, uint32_t clock_hz,
                  uint32_t rate_hz) {
  bytes_zero(&playback, sizeof playback);
  playback.frames = frames;
  playback.count = count;
  tick_begin(clock_hz, rate_hz);
}

static void differs(void) {
  if (playback.different == 0) playback.first_different = playback.ticks - 1u;
  ++playback.different;
}

static int same(const player_frame *said, const uint8_t *data) {
  const int status = said->id == dictionary_id(MESSAGE_STATUS, 0);
  for (uint32_t n = 0; n < DICTIONARY_LENGTH; ++n) {
    if (status && n / 2u == STATUS_OVERRUNS / 2) continue;
    if (said->data[n] != data[n]) return 0;
  }
  return 1;
}

static void compare_sync(const uint8_t *data) {
  if (playback.at == playback.count || !same(&playback.frames[playback.at], data)) differs();
  if (playback.at < playback.count) ++playback.at;
}

static void push(port *p, const player_frame *said) {
  frame f;
  bytes_zero(&f, sizeof f);
  f.id = said->id;
  f.length = DICTIONARY_LENGTH;
  bytes_copy(f.data, said->data, sizeof said->data);
  port_push(p, &f);
}

/* At the end only the closing SYNC is left. */
int32_t platform_wait(void) {
  const uint32_t took = playback.ticks > 0 ? tick_spent() - playback.began : 0u;
  /* an emulator in its host's time may show the clock before its interrupt: less than nothing */
  if (took > playback.worst && took <= INT32_MAX) playback.worst = took;
  if (playback.at + 1u >= playback.count) return -1;
  const int32_t missed = tick_wait();
  playback.began = tick_spent();
  return missed;
}

/* A frame before the SYNC is input, or one that the loop should have sent. */
platform_result platform_sync(const frame *sync, port *p) {
  ++playback.ticks;
  for (; playback.at < playback.count; ++playback.at) {
    const player_frame *said = &playback.frames[playback.at];
    const dictionary_message message = dictionary_find(said->id, 0);
    if (message == MESSAGE_SYNC) break;
    if (message == MESSAGE_POSE_LEFT || message == MESSAGE_POSE_RIGHT ||
        message == MESSAGE_COMMAND)
      push(p, said);
    else
      differs();
  }
  compare_sync(sync->data);
  return PLATFORM_SENT;
}

platform_result platform_send(const frame *f) {
  const player_frame *said = &playback.frames[playback.at];
  if (playback.at == playback.count || said->id != f->id) {
    differs();
    return PLATFORM_SENT;
  }
  if (!same(said, f->data)) differs();
  ++playback.at;
  return PLATFORM_SENT;
}

uint32_t player_end(const loop *l) {
  const codec_sync sync = {(uint32_t)(l->tick & UINT32_MAX), l->hash};
  frame f;
  codec_encode_sync(&f, 0, &sync);
  compare_sync(f.data);
  if (playback.at != playback.count) differs();
  return playback.different;
}
