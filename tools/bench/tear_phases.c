/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/bench/tear_phases.h"

#include <stddef.h>
#include <string.h>

const char *const tear_part_labels[TEAR_PARTS] = {"collision", "deformation", "tearing", "rest", "total"};
const char *const tear_phase_labels[TEAR_PHASES] = {"before the first tear", "while it tears"};

static tear_part part_of(int stage) {
  switch (stage) {
    case TIMED_GATHER:
    case TIMED_TRIANGLE_COLLISION:
    case TIMED_CONTACT_VERTICES:
    case TIMED_CONTACT_PRIMITIVES: return TEAR_COLLISION;
    case TIMED_GAINS:
    case TIMED_WIND:
    case TIMED_ADVANCE:
    case TIMED_ELASTIC:
    case TIMED_VELOCITY: return TEAR_DEFORMATION;
    case TIMED_STRESS:
    case TIMED_MEMBRANE_TEAR:
    case TIMED_CRACK:
    case TIMED_BLADE_CUT: return TEAR_TEARING;
    default: return TEAR_REST;
  }
}

tear_phase tear_phase_of(const float *stage_ns, uint32_t first, uint32_t end) {
  tear_phase p;
  memset(&p, 0, sizeof p);
  for (uint32_t tick = first; tick < end; ++tick) {
    double part_ns[TEAR_PARTS] = {0};
    for (int n = 0; n < TIMED_COUNT; ++n) {
      const double ns = (double)stage_ns[(size_t)tick * TIMED_COUNT + (size_t)n];
      part_ns[part_of(n)] += ns;
      part_ns[TEAR_TOTAL] += ns;
    }
    for (int n = 0; n < TEAR_PARTS; ++n) {
      p.mean_ns[n] += part_ns[n] / (end - first);
      if (part_ns[n] > p.worst_ns[n]) p.worst_ns[n] = part_ns[n];
    }
  }
  p.ticks = end > first ? end - first : 0;
  return p;
}
