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
#include "rt/wire/port.h"

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
  size_t bytes = 0;
  fray_error error{};
  return fray_bytes(f.data, sizeof f.data, &bytes, &error) == FRAY_TRUNCATED ? 0 : 3;
}
