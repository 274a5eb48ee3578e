/* SPDX-License-Identifier: Apache-2.0 */
/* Handles: a free body between a hand and the cloth, drawn by a spring and a damper to a proxy that follows
 * the device. haptics/ moves proxies, elastic/step_handles.c the bodies. All tables of 32-bit words. */
#ifndef FRAY_STATE_HANDLE_H
#define FRAY_STATE_HANDLE_H

#include "rt/base/fx.h"
#include "rt/fray.h"
#include "rt/state/params.h"

enum {
  HANDLE_GAIN_BITS = 16,
  HANDLE_SPEED_BITS = 8,
  HANDLE_NONE = MAX_BODIES,     /* the body of a hand without one */
  HANDLE_DELAY_MAX = 4,
  HANDLE_CONTROL_MAX = 2000     /* 0.5 mN: what the passivity controller adds along an axis at most */
};

/* Of a hand.
 *    name              least       most */
#define HANDLE_PARAMS(X) \
  X(body,               0,          HANDLE_NONE) \
  X(spring,             0,          WORD_MAX)  /* Q16: impulse of an elastic step, particle masses times lu
                                                  per substep, for an extension of 1 lu */ \
  X(damping,            0,          WORD_MAX)  /* Q16 particle masses: impulse of it for a relative velocity;
                                                  at most the mass of the body */ \
  X(pose_gain,          1,          WORD_MAX)  /* Q8 of Q24 lu of the proxy for one pose step of 2 um */ \
  X(force_scale,        1,          WORD_MAX)  /* Q16: force at the device over that of the coupling */ \
  X(placed,             0,          1)         /* the device's origin is at `origin`; else by START */ \
  X(delay,              1,          HANDLE_DELAY_MAX) /* ticks from a force to the pose that it has moved */ \
  X(reserve_nj,         0,          WORD_MAX)  /* given to the device before the controller acts */ \
  X(origin_x,           -FX_WORLD_MAX, FX_WORLD_MAX) /* Q24 lu */ \
  X(origin_y,           -FX_WORLD_MAX, FX_WORLD_MAX) \
  X(origin_z,           -FX_WORLD_MAX, FX_WORLD_MAX) \
  X(turn_xx,            -(1 << 30), 1 << 30)   /* Q30: rows are the device's axes in the scene */ \
  X(turn_xy,            -(1 << 30), 1 << 30) \
  X(turn_xz,            -(1 << 30), 1 << 30) \
  X(turn_yx,            -(1 << 30), 1 << 30) \
  X(turn_yy,            -(1 << 30), 1 << 30) \
  X(turn_yz,            -(1 << 30), 1 << 30) \
  X(turn_zx,            -(1 << 30), 1 << 30) \
  X(turn_zy,            -(1 << 30), 1 << 30) \
  X(turn_zz,            -(1 << 30), 1 << 30)

#define HANDLE_STATE(X) \
  X(proxy_x,            -FX_WORLD_MAX, FX_WORLD_MAX) /* Q24 lu */ \
  X(proxy_y,            -FX_WORLD_MAX, FX_WORLD_MAX) \
  X(proxy_z,            -FX_WORLD_MAX, FX_WORLD_MAX) \
  X(anchor_x,           -FX_WORLD_MAX, FX_WORLD_MAX) /* the proxy for a pose that is the datum's */ \
  X(anchor_y,           -FX_WORLD_MAX, FX_WORLD_MAX) \
  X(anchor_z,           -FX_WORLD_MAX, FX_WORLD_MAX) \
  X(before_x,           -32768,     32767)     /* the pose of the last tick */ \
  X(before_y,           -32768,     32767) \
  X(before_z,           -32768,     32767) \
  X(speed_x,            -(1 << 18), 1 << 18)   /* smoothed, Q8 pose steps a tick */ \
  X(speed_y,            -(1 << 18), 1 << 18) \
  X(speed_z,            -(1 << 18), 1 << 18) \
  X(given_low,          WORD_MIN,   WORD_MAX)  /* energy given to the device since START, nJ */ \
  X(given_high,         WORD_MIN,   WORD_MAX) \
  X(most_low,           WORD_MIN,   WORD_MAX)  /* the most that it was */ \
  X(most_high,          WORD_MIN,   WORD_MAX) \
  X(taken_low,          WORD_MIN,   WORD_MAX)  /* what the controller took */ \
  X(taken_high,         WORD_MIN,   WORD_MAX) \
  HANDLE_SENT(X, 0) HANDLE_SENT(X, 1) HANDLE_SENT(X, 2) HANDLE_SENT(X, 3)

/* A force that was sent n ticks before the last one. */
#define HANDLE_SENT(X, n) \
  X(sent_x_##n,         -32767,     32767) \
  X(sent_y_##n,         -32767,     32767) \
  X(sent_z_##n,         -32767,     32767)

typedef struct {
  int32_t body, spring, damping, pose_gain, force_scale, placed, delay, reserve_nj;
  int32_t origin[3], turn[9];
} handle_params;

typedef struct {
  int32_t proxy[3], anchor[3], before[3], speed[3];
  int32_t given[2], most[2], taken[2];
  int32_t sent[HANDLE_DELAY_MAX][3];
} handle_state;

enum {
#define X(name, least, most) +1
  HANDLE_PARAM_WORDS = 0 HANDLE_PARAMS(X),
  HANDLE_STATE_WORDS = 0 HANDLE_STATE(X)
#undef X
};
_Static_assert(sizeof(handle_params) == 4u * HANDLE_PARAM_WORDS, "a table of words");
_Static_assert(sizeof(handle_state) == 4u * HANDLE_STATE_WORDS, "a table of words");

/* Of one tick. */
typedef struct {
  int32_t from[3], to[3]; /* the proxy's way, Q24 lu */
  int64_t at[3];          /* where it is on it: Q28 lu */
  int64_t impulse[3];     /* what the body gained from it, Q28 lu per substep */
#if FRAY_ENERGY
  int32_t speed[3];                /* of the body when the elastic step began, Q28 */
  int64_t by_spring[3], by_damper[3]; /* what it gained from them in that step */
#endif
} handle_motion;

/* From the body, Q28 lu, to its proxy. What is beyond 8 lu along an axis does not count: there the force is
 * constant. */
static inline int32_t handle_extension(int64_t proxy, int64_t body) {
  return fx_saturate(proxy - body);
}

/* Impulse of the spring in an elastic step, Q28. */
static inline int64_t handle_spring_impulse(const handle_params *k, int32_t extension) {
  return fx_round64(fx_mul_wide(extension, k->spring), HANDLE_GAIN_BITS);
}

#endif
