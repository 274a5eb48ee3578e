/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/cloth_style.h"

#include "tools/render/vec3.h"

cloth_style cloth_style_default(cloth_look look) {
  cloth_style s = {.look = look,
                   .warp = rgb_hex(0x3D75A8),
                   .weft = rgb_hex(0x86AFCB),
                   .back = {1.28f, 0.86f, 0.74f},
                   .base = rgb_hex(0xC2188F),
                   .split = rgb_hex(0x00A6CC),
                   .stress_full = 100.0f};
  if (look == LOOK_YARN) {
    s.warp = rgb_hex(0x4A7BAB);
    s.weft = rgb_hex(0x9CBAD2);
  }
  return s;
}

rgb cloth_strain_colour(float load) {
  const rgb white = rgb_hex(0xF0EEEA), red = rgb_hex(0xC81E1E), blue = rgb_hex(0x2456B8);
  return load >= 0.0f ? rgb_mix(white, red, clamp01(load)) : rgb_mix(white, blue, clamp01(-load));
}

float cloth_random(uint32_t n) {
  n = (n ^ 61u) * 0x9E3779B1u;
  n = (n ^ (n >> 15)) * 0x85EBCA6Bu;
  return (float)(n >> 16 & 1023u) / 1023.0f;
}

rgb cloth_yarn_colour(const cloth_style *style, int warp, uint32_t number) {
  const float tone = 0.93f + 0.14f * cloth_random(number * 2u + (warp ? 1u : 0u));
  return rgb_scale(warp ? style->warp : style->weft, tone);
}
