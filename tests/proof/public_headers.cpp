/* SPDX-License-Identifier: Apache-2.0 */
/* Every header that a user may include, in C++; linked with the library as C built it. */
#include "platform/loop.h"
#include "platform/platform.h"
#include "rt/fray.h"
#include "rt/wire/auth.h"
#include "rt/wire/cmac.h"
#include "rt/wire/codec.h"
#include "rt/wire/dictionary.h"
#include "rt/wire/e2e.h"
#include "rt/wire/frame.h"
#include "rt/wire/auth_gate.h"
#include "rt/wire/port.h"
#include "rt/wire/queue.h"
#include "rt/wire/sequence.h"

int main() {
  frame f{};
  fray_pose pose{1, -2, 3, 4, 5};
  fray_pose back{};
  codec_encode_pose(&f, 0, 0, &pose);
  if (codec_decode_pose(&f, 0, 0, &back) != CODEC_OK || back.y != -2) return 1;
  port p;
  port_init(&p, 0, 1, nullptr);
  port_push(&p, &f);
  fray_input input;
  port_take(&p, &input);
  if (input.has_pose != 1 || input.pose[0].counter != 4) return 2;
  sequence s;
  sequence_begin(&s, 4);
  if (sequence_take(&s, 5) != SEQUENCE_NEW) return 3;
  const uint8_t secret[CMAC_KEY] = {};
  cmac_key key;
  auth_gate g;
  frame plain;
  cmac_key_init(&key, secret);
  auth_gate_init(&g, &key, AUTH_GATE_FD, AUTH_GATE_RUNTIME, 0, 1);
  if (auth_gate_receive(&g, &f, &plain) != nullptr || g.plain != 1) return 4;
  size_t bytes = 0;
  fray_error error{};
  return fray_memory_size(f.data, sizeof f.data, &bytes, &error) == FRAY_TRUNCATED ? 0 : 5;
}
