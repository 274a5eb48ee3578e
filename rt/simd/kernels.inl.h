/* SPDX-License-Identifier: Apache-2.0 */
/* All kernels of one instruction set: included once by its SET.c, after lanes_SET.h, which defines
 *
 *  LANES, LANES_ALL        how many 32-bit lanes, and a bit for each
 *  lanes, lane_mask        the types; operations are lanes_NAME(), those of masks mask_NAME()
 *  LANES_RUNS_UNROLLED     a group of springs with up to so many runs (spring_lanes.inl.h) has unrolled code
 *  LANES_RUNS_MAX          with up to so many a loop over runs, with more it is gathered; default: as many
 *  LANES_GROUPS            so many groups of springs are computed side by side; undefined: one
 *  LANES_UNROLL_3          a pragma for loops over x, y, z, against small arrays in memory
 *  LANES_TABLE_WORDS       lanes_lookup() takes words of a table of this size; undefined: there is none
 *  LANES_HAVE_HALVES       two runs of LANES / 2 are loaded and stored as halves
 *  LANES_HAVE_STORE_RUN    lanes_store_run(): a run of lanes without a masked store
 *  LANES_HAVE_64           lanes64 and records: without them the kernels below are the scalar code
 *  LANES_NO_BROAD_PHASE    the scalar broad phase is faster
 *
 * Shift counts are 1 to 31. Bit n of mask_bits() and mask_range() is lane n. Masked loads and stores touch
 * no lane that is off; lanes_load_ids_first() and lanes_load_kinds_first() touch the first `count` elements
 * only. */
#ifndef FRAY_SIMD_KERNELS_INL_H
#define FRAY_SIMD_KERNELS_INL_H

#include "rt/simd/bend_force_lanes.inl.h"
#include "rt/simd/bend_prepare_lanes.inl.h"
#include "rt/simd/bend_shear_lanes.inl.h"
#include "rt/simd/ground_contact_lanes.inl.h"
#include "rt/simd/hash_lanes.inl.h"
#include "rt/simd/membrane_force_lanes.inl.h"
#include "rt/simd/membrane_step_lanes.inl.h"
#include "rt/simd/membrane_stress_lanes.inl.h"
#include "rt/simd/strain_limit_lanes.inl.h"
#include "rt/simd/tear_scan_lanes.inl.h"
#include "rt/simd/wind_lanes.inl.h"

#ifdef LANES_NO_BROAD_PHASE
#define near_box_lanes_run simd_maybe
#define near_plane_lanes_run simd_maybe
#else
#define near_box_lanes_run(...) broad_phase_any_near(0, __VA_ARGS__)
#define near_plane_lanes_run(...) broad_phase_any_near(1, __VA_ARGS__)
#endif

#ifndef LANES_HAVE_64
#define bend_normals_lanes_run simd_none
#define bend_folds_lanes_run simd_none
#define bend_moments_lanes_run simd_none
#define bend_joints_lanes_run simd_none
#define bend_corners_lanes_run simd_none
#define bend_stiffness_lanes_run simd_none
#define bend_geometry_lanes_run simd_none
#define membrane_force_lanes_run simd_none
#define membrane_step_lanes_run simd_none
#define membrane_stress_lanes_run simd_none
#define wind_lanes_run simd_none
#endif

#if !defined(LANES_HAVE_64) || !FRAY_CRACKS
#define corotational_force_lanes_run simd_none
#define corotational_stress_lanes_run simd_none
#endif

#define SIMD_DEFINE(set, name, parameters, arguments, ...) \
  uint32_t simd_##name##_##set parameters { return name##_lanes_run arguments; }
#define SIMD_DEFINE_LOOP(set, name, parameters, arguments) \
  uint32_t simd_##name##_##set parameters { return loop_##name arguments; }
#define SIMD_DEFINE_SET(set) \
  SIMD_LOOPS(SIMD_DEFINE_LOOP, set) SIMD_PREFIXES(SIMD_DEFINE, set) SIMD_SEARCHES(SIMD_DEFINE, set)

#endif
