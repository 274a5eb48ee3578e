/* SPDX-License-Identifier: Apache-2.0 */
/* Every operation of rt/base/fx.h, and the vectors built of them, over every value that their
 * comments allow. */
#include "rt/base/random.h"
#include "rt/base/vec.h"
#include "tests/proof/any.h"

/* What is computed is used. */
static int64_t kept;
static void keep(int64_t v) { kept = v; }

static void sums(void) {
  const int32_t a = any32();
  const int32_t b = any32();
  keep(fx_wrap_add(a, b));
  keep(fx_wrap_sub(a, b));
  keep(fx_wrap_shift(a, any_between(0, 31)));
  keep(fx_wrap_mul_u(any_word(), any_word()));
  keep(fx_add(a, b));
  keep(fx_sub(a, b));
  keep(fx_mul(a, b));
  keep(fx_mul_wide(a, b));
  keep(fx_add64(any64(), any64()));
  keep(fx_mul64(any64(), any64()));
  keep(fx_add_saturated(a, b));
  keep(fx_mul_q15(a, b));
  keep(fx_min(a, b));
  keep(fx_max(a, b));
  keep(fx_clamp(a, b, any32()));
  keep(fx_clamp64(any64(), any64(), any64()));
  keep(fx_saturate(any64()));
  keep(fx_magnitude(a));
}

static void shifts(void) {
  const uint32_t s = any_between(1, 31);
  const uint32_t s64 = any_between(1, 63);
  keep(fx_asr(any32(), s));
  keep(fx_asr64(any64(), s64));
  keep(fx_round(any32(), s));
  keep(fx_round64(any64(), s64));
}

static void roots(void) {
  const uint64_t n = any_wide();
  if (n == 0) return;
  for (int steps = FX_ROOT_COARSE; steps <= FX_ROOT_FINE; ++steps) {
    const fx_root r = fx_rsqrt(n, steps);
    /*@ assert r.h <= 31 && r.inverse <= 0x80000000; */
    keep(fx_root_length(r));
    keep(fx_root_unit(r, any32()));
  }
}

static vec3 any_vector(void) { return vec_make(any32(), any32(), any32()); }

static void vectors(void) {
  const vec3 a = any_vector();
  const vec3 b = any_vector();
  keep(vec_add(a, b).x);
  keep(vec_sub(a, b).y);
  keep((int64_t)(vec_squared(a) >> 1));
  keep(vec_dot_unit(a, b));
  keep(vec_scale_unit(a, any32()).z);
}

void operations(void) {
  sums();
  shifts();
  roots();
  vectors();
  keep(random_bits(any_word(), any_word()));
}
