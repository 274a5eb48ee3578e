/* SPDX-License-Identifier: Apache-2.0 */
/* fray info: what an image holds and what a tick of it costs. */
#include "tools/cmd_info.h"

#include <stdio.h>

#include "tools/open.h"
#include "tools/options.h"
#include "tools/yarn_level.h"

static void print_usage(FILE *out) {
  fprintf(out, "usage: fray info X.img|X.scene\n\n"
               "Prints the sheet, rates, memory plan, batches, and the most work of one tick.\n\n"
               "exit: 0 good, 2 wrong use or unreadable input\n");
}

static double centimetres(const fray_facts *f, int32_t q24) {
  return q24 / 16777216.0 * f->lu_um / 10000.0;
}

static void print_triangles(const fray_world *w, const fray_facts *f) {
  const fray_particles p = fray_view_particles(w);
  printf("triangles  %u of %u, %.4f cm thick\n", f->triangles, f->triangles_max, centimetres(f, f->thickness));
  printf("vertices   %u of %u, %u held, %.6f g for a regular one; 1 lu = %u um\n", p.count, f->particles_max,
         p.held, f->particle_mass_ng * 1e-9, f->lu_um);
  printf("rate       %u Hz, %u substeps, %u inner steps in each; at tick %u\n", f->rate_hz, f->substeps,
         f->inner_steps, f->tick);
  if (f->stiffness_q30 != 1 << 30)
    printf("stiffness  scaled down to %.4g of the measured one, for the steps that 'inner_steps' allows; tears "
           "go by the scaled stress\n", f->stiffness_q30 / 1073741824.0);
  else
    printf("stiffness  as measured\n");
  if (f->pairs_max != 0)
    printf("layers     triangles keep %.4f cm apart, at most %u pairs of their parts near each other\n",
           centimetres(f, f->self_thickness), f->pairs_max);
}

static void print_sheet(const fray_world *w, const fray_facts *f) {
  const fray_sheet s = fray_view_sheet(w);
  const fray_particles p = fray_view_particles(w);
  printf("sheet      %u warps x %u wefts, weave repeat %u x %u, %.4f cm thick\n", s.warps, s.wefts,
         s.weave_columns, s.weave_rows, centimetres(f, f->thickness));
  printf("particles  %u of %u, %u held, %.6f g each; 1 lu = %u um\n", p.count, f->particles_max,
         p.held, f->particle_mass_ng * 1e-9, f->lu_um);
  printf("rate       %u Hz, %u substeps, %u sweeps; at tick %u\n", f->rate_hz, f->substeps,
         f->sweeps, f->tick);
  if (f->tearing != 0)
    printf("tearing    %.2f to %.2f %% strain, at most %u cuts a tick\n", f->tear_min_q16 / 655.36,
           f->tear_max_q16 / 655.36, f->cuts_max);
  else
    printf("tearing    off\n");
  if (f->stretch_un != 0)
    printf("stretch    %.6g N a yarn for each strain, damped %.6g us; %u inner steps a substep;\n"
           "           projection holds from %.2f %% strain on\n",
           f->stretch_un * 1e-6, f->stretch_damping_ns * 1e-3, f->stretch_steps,
           f->stretch_limit_q16 / 655.36);
  if (f->splits_max != 0)
    printf("yarns      %s; split at %.2f to %.2f %% strain, at most %u a tick; apart at %.4f cm\n",
           f->all_yarn != 0 ? "everywhere" : "where it tears", f->transition_min_q16 / 655.36,
           f->transition_max_q16 / 655.36, f->splits_max, centimetres(f, f->loose_max));
  if (f->pairs_max != 0)
    printf("selves     yarns keep %.4f cm apart, at most %u pairs near each other a tick\n",
           centimetres(f, f->self_thickness), f->pairs_max);
  yarn_level_print(w, stdout);
}

static void print_rows(const fray_facts *f) {
  static const char *const names[3] = {"structural", "bend", "shear"};
  for (int n = 0; n < 3; ++n)
    printf("rows       %-10s %8u in %4u batches\n", names[n], f->rows[n], f->batches[n]);
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

static void print_bodies(const fray_world *w, const fray_facts *f) {
  static const char *const shapes[] = {"anchor", "ball", "box", "bar", "plane", "mesh"};
  static const char *const motions[] = {"fixed", "on a path", "follows a hand", "free"};
  for (uint32_t b = 0; b < f->bodies; ++b) {
    const fray_body v = fray_view_body(w, b);
    printf("body       %-6s %-14s at %.3f %.3f %.3f cm\n", shapes[v.shape], motions[v.motion],
           centimetres(f, v.position[0]), centimetres(f, v.position[1]),
           centimetres(f, v.position[2]));
    print_mesh(w, b);
  }
}

static void print_pools(const fray_world *w, size_t image_bytes, size_t memory_bytes) {
  fray_pool pool;
  printf("\n%-14s %9s %6s %10s\n", "pool", "elements", "bytes", "total");
  for (uint32_t n = 0; fray_view_pool(w, n, &pool); ++n)
    printf("%-14s %9u %6u %10u%s\n", pool.name, pool.count, pool.element_bytes,
           pool.count * pool.element_bytes,
           pool.in_place ? "  used in the image" : (pool.constant ? "  constant" : ""));
  printf("image %zu bytes, memory %zu bytes\n", image_bytes, memory_bytes);
}

static void print_work(const fray_world *w) {
  const fray_work most = fray_limits(w);
  printf("\nmost work of a tick: %u predictions, %u projections, %u springs, %u contact tests,\n"
         "                     %u gathers, %u tear tests, %u over, %u cuts\n"
         "                     %u transitions, %u splits, %u slips, %u stretches,\n"
         "                     %u pulls, %u folds, %u lines\n"
         "                     %u mesh tests, %u mesh boxes, %u mesh sweeps\n"
         "                     %u self visits, %u self pairs, %u self sweeps\n",
         most.predictions, most.projections, most.springs, most.contacts, most.gathers,
         most.tear_tests, most.over, most.cuts, most.transitions, most.splits, most.slips,
         most.stretches, most.pulls, most.folds, most.lines, most.mesh_tests,
         most.mesh_boxes, most.mesh_sweeps, most.self_visits, most.self_pairs, most.self_sweeps);
}

int cmd_info(int argc, char **argv) {
  const char *file = NULL;
  struct opened o;
  const options_result wish = options_parse(argc, argv, NULL, 0, &file);
  if (wish == OPTIONS_HELP || (wish == OPTIONS_GOOD && file == NULL)) {
    print_usage(wish == OPTIONS_HELP ? stdout : stderr);
    return wish == OPTIONS_HELP ? 0 : 2;
  }
  if (wish == OPTIONS_WRONG || world_open_file(file, &o, stderr) != 0) return 2;
  const fray_facts f = fray_describe(o.world);
  if (f.triangles != 0) {
    print_triangles(o.world, &f);
  } else {
    print_sheet(o.world, &f);
    print_rows(&f);
  }
  print_bodies(o.world, &f);
  print_pools(o.world, o.image_bytes, o.memory_bytes);
  print_work(o.world);
  world_close(&o);
  return 0;
}
