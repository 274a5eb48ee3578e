/* SPDX-License-Identifier: Apache-2.0 */
/* fray info: the contents of an image and the bound of the work of a tick. */
#include "tools/cmd/cmd.h"

#include <inttypes.h>
#include <stdio.h>

#include "rt/state/rigid_body.h"
#include "tools/world/world_file.h"
#include "tools/terminal/options.h"
#include "tools/analysis/scaled_stiffness.h"
#include "tools/analysis/yarn_level.h"

static void print_usage(FILE *out) {
  fprintf(out, "usage: fray info X.img|X.scene [--pools]\n\n"
               "Prints the cloth, rates, bodies, bytes, and the bound of the work of one tick.\n\n"
               "  --pools   also every pool of the image and of the memory, with its elements and bytes\n\n"
               "exit: 0 good, 2 wrong use or unreadable input\n");
}

static double centimetres(const fray_info *f, int32_t q24) {
  return q24 / 16777216.0 * f->lu_um / 10000.0;
}

static void print_membrane(const fray_world *w, const fray_info *f) {
  const fray_particles p = fray_view_particles(w);
  printf("membrane   %u triangles of %u, %.4f cm thick\n", f->triangles, f->triangles_max,
         centimetres(f, f->thickness));
  printf("vertices   %u of %u, %u attached, %.6f g for a regular one; 1 lu = %u um\n", p.count,
         f->particles_max, p.attached, f->particle_mass_ng * 1e-9, f->lu_um);
  printf("rate       %u Hz, %u substeps of %u elastic steps; at tick %" PRIu64 "\n", f->rate_hz, f->substeps,
         f->elastic_steps, f->tick);
  char scaled[SCALED_STIFFNESS_TEXT];
  printf("stiffness  %s\n", scaled_stiffness_text(f, scaled) ? scaled : "of the material");
  if (f->self_pairs_max != 0)
    printf("collision  of triangles among themselves: %.4f cm apart, at most %u pairs near each other\n",
           centimetres(f, f->self_thickness), f->self_pairs_max);
}

static void print_woven(const fray_world *w, const fray_info *f) {
  const fray_weave s = fray_view_weave(w);
  const fray_particles p = fray_view_particles(w);
  printf("woven      %u warps x %u wefts, weave repeat %u x %u, %.4f cm thick\n", s.warps, s.wefts,
         s.weave_columns, s.weave_rows, centimetres(f, f->thickness));
  printf("particles  %u of %u, %u attached, %.6f g each; 1 lu = %u um\n", p.count, f->particles_max,
         p.attached, f->particle_mass_ng * 1e-9, f->lu_um);
  printf("rate       %u Hz, %u substeps, %u iterations; at tick %" PRIu64 "\n", f->rate_hz, f->substeps,
         f->iterations, f->tick);
  if (f->tearing != 0)
    printf("tearing    at %.2f to %.2f %% strain, at most %u springs a tick\n", f->tear_min_q16 / 655.36,
           f->tear_max_q16 / 655.36, f->tears_max);
  else
    printf("tearing    off\n");
  if (f->yarn_stiffness_un != 0)
    printf("stretch    EA of a yarn %.6g N, damping time %.6g us, %u elastic steps a substep\n",
           f->yarn_stiffness_un * 1e-6, f->yarn_damping_ns * 1e-3, f->yarn_steps);
  if (f->splits_max != 0)
    printf("yarns      %s; split at %.2f to %.2f %% strain, at most %u a tick; disconnected at %.4f cm\n",
           f->all_yarn != 0 ? "everywhere" : "where it tears", f->split_min_q16 / 655.36,
           f->split_max_q16 / 655.36, f->splits_max, centimetres(f, f->disconnect_distance));
  if (f->self_pairs_max != 0)
    printf("collision  of yarns among themselves: %.4f cm apart, at most %u pairs near each other\n",
           centimetres(f, f->self_thickness), f->self_pairs_max);
  yarn_level_print(w, stdout);
}

static void print_springs(const fray_info *f) {
  static const char *const names[3] = {"structural", "bend", "shear"};
  for (int n = 0; n < 3; ++n)
    printf("springs    %-10s %8u in %4u batches\n", names[n], f->springs[n], f->batches[n]);
}

static void print_mesh(const fray_world *w, uint32_t b) {
  fray_mesh m;
  uint32_t sharp_points = 0;
  uint32_t sharp_edges = 0;
  if (!fray_view_mesh(w, b, &m)) return;
  for (uint32_t n = 0; n < m.points; ++n) sharp_points += m.point[5 * n + 3] != 0;
  for (uint32_t n = 0; n < m.edges; ++n) sharp_edges += m.edge[5 * n + 4] != 0;
  printf("           %u points, %u edges, %u triangles; sharp: %u points, %u edges\n", m.points,
         m.edges, m.faces, sharp_points, sharp_edges);
}

static const char *shape_name(fray_shape shape) {
  switch (shape) {
    case FRAY_ANCHOR: break;
#define X(name, word, radius, halves, primitive, collider) case FRAY_##name: return word;
    SHAPES(X)
#undef X
  }
  return "anchor";
}

static void print_bodies(const fray_world *w, const fray_info *f) {
  static const char *const motions[] = {"fixed", "on a path", "follows a hand", "free"};
  for (uint32_t b = 0; b < f->bodies; ++b) {
    const fray_body v = fray_view_body(w, b);
    printf("body       %-7s %-14s at %.3f %.3f %.3f cm\n", shape_name(v.shape), motions[v.motion],
           centimetres(f, v.position[0]), centimetres(f, v.position[1]),
           centimetres(f, v.position[2]));
    print_mesh(w, b);
  }
}

static void print_pools(const fray_world *w) {
  fray_pool pool;
  printf("\n%-26s %9s %6s %10s\n", "pool", "elements", "bytes", "total");
  for (uint32_t n = 0; fray_view_pool(w, n, &pool); ++n)
    printf("%-26s %9u %6u %10u%s\n", pool.name, pool.count, pool.element_bytes,
           pool.count * pool.element_bytes,
           pool.in_place ? "  used in the image" : (pool.constant ? "  constant" : ""));
}

static void print_work(const fray_world *w) {
  const fray_work max = fray_work_bound(w);
  printf("work of a tick, at most: %u particle steps, %u projections, %u springs, %u contacts,\n"
         "    %u broad phase tests, %u tear tests, %u over their threshold, %u tears,\n"
         "    %u transitions, %u splits, %u slips, %u yarn forces,\n"
         "    %u element forces, %u bend forces, %u tear candidates,\n"
         "    %u mesh tests, %u mesh boxes, %u mesh CCD tests,\n"
         "    %u self-collision box tests, %u pairs, %u CCD tests\n",
         max.particle_steps, max.projections, max.springs, max.contacts, max.broad_phase_tests,
         max.tear_tests, max.over_threshold, max.tears, max.transitions, max.splits, max.slips,
         max.yarn_forces, max.element_forces, max.bend_forces, max.tear_candidates, max.mesh_tests,
         max.mesh_boxes, max.mesh_ccd, max.self_box_tests, max.self_pairs, max.self_ccd);
}

int cmd_info(int argc, char **argv) {
  const char *file = NULL;
  int pools = 0;
  struct world_file o;
  const option table[] = {{"--pools", NULL, NULL, &pools, 0, 0}};
  const options_result wish = options_parse(argc, argv, table, 1, &file);
  if (wish == OPTIONS_HELP || (wish == OPTIONS_GOOD && file == NULL)) {
    print_usage(wish == OPTIONS_HELP ? stdout : stderr);
    return wish == OPTIONS_HELP ? 0 : 2;
  }
  if (wish == OPTIONS_WRONG || world_file_open(file, &o, stderr) != 0) return 2;
  const fray_info f = fray_get_info(o.world);
  if (f.triangles != 0) {
    print_membrane(o.world, &f);
  } else {
    print_woven(o.world, &f);
    print_springs(&f);
  }
  print_bodies(o.world, &f);
  printf("bytes      image %zu, memory %zu\n", o.image_bytes, o.memory_bytes);
  print_work(o.world);
  if (pools) print_pools(o.world);
  world_file_close(&o);
  return 0;
}
