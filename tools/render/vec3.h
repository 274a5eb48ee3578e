/* SPDX-License-Identifier: Apache-2.0 */
/* Float vectors for pictures. Lengths are millimetres, y is up. */
#ifndef FRAY_TOOLS_RENDER_VEC3_H
#define FRAY_TOOLS_RENDER_VEC3_H

#include <math.h>

typedef struct {
  float x, y, z;
} v3;

static inline v3 v3_add(v3 a, v3 b) { return (v3){a.x + b.x, a.y + b.y, a.z + b.z}; }
static inline v3 v3_sub(v3 a, v3 b) { return (v3){a.x - b.x, a.y - b.y, a.z - b.z}; }
static inline v3 v3_scale(v3 a, float s) { return (v3){a.x * s, a.y * s, a.z * s}; }
static inline v3 v3_add_scaled(v3 a, v3 b, float s) {
  return (v3){a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}
static inline float v3_dot(v3 a, v3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline v3 v3_cross(v3 a, v3 b) {
  return (v3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline float v3_length(v3 a) { return sqrtf(v3_dot(a, a)); }
static inline v3 v3_unit(v3 a) { return v3_scale(a, 1.0f / (v3_length(a) + 1e-12f)); }
static inline float clamp01(float v) { return v < 0.0f ? 0.0f : v > 1.0f ? 1.0f : v; }

#endif
