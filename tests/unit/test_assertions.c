/* SPDX-License-Identifier: Apache-2.0 */
/* Assertions of every room of rt. Each case below makes a call twice, in a process of its own: as it should be,
 * which returns; then with one precondition or invariant broken, which the assertion of the file named stops.
 * That is in the build with tests/lib/assertion_report.h (see the Makefile); in any other this program proves
 * that assertions are evaluated iff the build has them. */
#define _POSIX_C_SOURCE 200809L
#include "rt/base/assert.h"
#include "tests/lib/test.h"

static void is_evaluated_in_builds_with_assertions_only(void) {
  int times = 0;
  FRAY_ASSERT(++times > 0);
#if defined(FRAY_CHECKED) || defined(FRAY_ASSERTIONS)
  CHECK_EQ_INT(times, 1);
#else
  CHECK_EQ_INT(times, 0);
#endif
}

#ifdef FRAY_TESTS_LIB_ASSERTION_REPORT_H

#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "rt/base/arena.h"
#include "rt/base/coulomb.h"
#include "rt/base/random.h"
#include "rt/contact/contact.h"
#include "rt/geometry/ccd.h"
#include "rt/geometry/closest_point.h"
#include "rt/haptics/haptics.h"
#include "rt/image/state_hash.h"
#include "rt/integrate/integrate.h"
#include "rt/membrane/membrane.h"
#include "rt/self_collision/self_collision.h"
#include "rt/self_collision/triangle_collision.h"
#include "rt/self_collision/yarn_collision.h"
#include "rt/self_collision/patches.h"
#include "rt/simd/simd.h"
#include "rt/state/crossing.h"
#include "rt/state/rigid_mesh.h"
#include "rt/tick/tick.h"
#include "rt/trimesh/trimesh_split.h"
#include "rt/wire/auth_gate.h"
#include "rt/wire/e2e.h"
#include "rt/wire/port.h"
#include "rt/workers/parallel.h"
#include "rt/woven/tear_queue.h"
#include "rt/woven/woven.h"
#include "tests/lib/simd_kernels.h"
#include "tests/lib/world_fixture.h"

static int report_pipe[2];

void assertion_report(const char *file, int line) {
  (void)line;
  if (write(report_pipe[1], file, strlen(file)) < 0) _exit(2);
  __builtin_trap();
}

/* Opened once; every case has a copy, as it is a process. The last two have ticked. */
static fixture woven, wide, yarns, membrane;
static const fray_input idle;
static fray_output output;

/* ---- base ---- */

static void arena_has_room(int broken) {
  _Alignas(ARENA_ALIGN) static uint8_t bytes[32];
  arena a = {bytes, sizeof bytes, 0};
  (void)arena_take(&a, broken ? 3 : 2, ARENA_ALIGN);
}
static void draw_has_a_range(int broken) { (void)random_between(1, 2, broken ? 5 : 3, 4); }
static void friction_is_not_negative(int broken) {
  (void)coulomb_limited(vec_make(1, 2, 3), 1 << 16, broken ? -1 : 1);
}
static void hashed_words_exist(int broken) {
  static const int32_t words[1];
  hash h;
  hash_begin(&h);
  hash_words(&h, broken ? NULL : words, 1);
}

/* ---- geometry ---- */

static void thickness_is_not_negative(int broken) {
  static const ccd_path edge[2] = {{{0, 0, 0}, {0, 0, 0}}, {{FX_LU, 0, 0}, {FX_LU, 0, 0}}};
  ccd_contact c;
  (void)ccd_edges(edge, edge, broken ? -1 : 1, &c);
}
static void searched_face_is_narrow(int broken) {
  const closest_face f = {{broken ? 4 << CLOSEST_BITS : 1, 0, 0}, {1, 1, 0}, {0, 1, 1}};
  (void)closest_point_find(&f, CLOSEST_TRIANGLE);
}

/* ---- state ---- */

/* A vertex with a closed ring of three triangles or more. */
static uint32_t inner_vertex(trimesh_ring *ring) {
  for (uint32_t p = particles_attached(membrane.w); p < membrane.w->p.count; ++p) {
    trimesh_ring_of(&membrane.w->trimesh, p, ring);
    if (ring->closed != 0 && ring->count > 2) return p;
  }
  _exit(3);
}

static void one_ring_is_in_order(int broken) {
  trimesh_ring ring;
  const uint32_t vertex = inner_vertex(&ring);
  index_t *neighbour = membrane.w->trimesh.triangle[ring.triangle[1]].neighbour;
  const uint32_t next = trimesh_next(ring.corner[1]), previous = trimesh_previous(ring.corner[1]);
  const index_t swapped = neighbour[next];
  if (broken) neighbour[next] = neighbour[previous];
  if (broken) neighbour[previous] = swapped;
  trimesh_ring_of(&membrane.w->trimesh, vertex, &ring);
}

static uint32_t split_crossing(void) {
  for (uint32_t c = 0; c < yarns.w->capacity[POOL_CROSSINGS]; ++c)
    if (crossing_state_at(yarns.w, c) != FRAY_WHOLE) return c;
  _exit(3);
}
static void whole_crossing_is_split_first(int broken) {
  const uint32_t c = split_crossing();
  if (broken) yarns.w->woven.crossing_state[c] = FRAY_WHOLE;
  crossing_set_state(yarns.w, c, FRAY_DISCONNECTED);
}
static void pending_crossings_are_counted(int broken) {
  crossing_set_pending(yarns.w, split_crossing(), 1);
  if (broken) yarns.w->woven.yarn_counts->pending = 0;
  crossing_set_pending(yarns.w, split_crossing(), 0);
}
static void mesh_exists(int broken) {
  (void)rigid_mesh_at(membrane.w, rigid_mesh_count(membrane.w) - (broken ? 0 : 1));
}

/* ---- simd ---- */

static void batch_shares_no_particle(int broken) {
  fray_kernel found[SIMD_KERNELS];
  fray_world *w = wide.w;
  uint32_t b = 0;
  if (simd_kernels(found) != 0) (void)fray_set_kernel(w, found[0]);
  while (w->woven.batches[b].attached != BATCH_FREE || w->woven.batches[b].count < 2) ++b;
  const uint32_t row = (uint32_t)w->woven.batches[b].first;
  if (broken) w->woven.spring_i[row + 1] = w->woven.spring_j[row];
  strain_limit_apply(w);
}
static void loop_ends_after_its_first(int broken) {
  const particle_arrays *p = &woven.w->p;
  (void)simd_velocity(FRAY_KERNEL_SCALAR, p->x, p->qx, p->vx, broken ? 5 : 4, 4);
}
static void kernel_exists(int broken) {
  (void)simd_drag((fray_kernel)(broken ? SIMD_KERNELS + 1 : 0), woven.w->p.vx, 0, 1, 0);
}

/* ---- image ---- */

static void viewed_spring_exists(int broken) {
  (void)fray_view_spring(woven.w, FRAY_BEND, woven.facts.springs[FRAY_BEND] - (broken ? 0 : 1));
}
static void saved_state_has_its_topology(int broken) {
  const size_t bytes = fray_save_bytes(woven.w);
  if (broken) woven.w->woven.spring_kind[0] = SPRING_DEAD;
  if (fray_save(woven.w, malloc(bytes), bytes) != bytes) _exit(3);
}
static void hashed_particles_are_in_use(int broken) {
  hash axes[3];
  for (uint32_t n = 0; n < 3; ++n) hash_begin(&axes[n]);
  state_hash_axes(woven.w, HASHED_POSITIONS, axes, 0, woven.w->p.count + (broken ? 1 : 0));
}

/* ---- integrate ---- */

static void substep_is_of_this_tick(int broken) {
  bodies_advance(woven.w, woven.facts.substeps - (broken ? 0 : 1));
}
static void attached_particles_are_carried(int broken) {
  particles_advance_range(woven.w, particles_attached(woven.w) - (broken ? 1 : 0), woven.w->p.count);
}

/* ---- woven ---- */

static void push_tear(fray_world *w, uint32_t spring, uint32_t excess) {
  const torn_spring found = {spring, excess};
  tear_queue_push(w, found);
}
static void tear_queue_is_in_order(int broken) {
  push_tear(woven.w, 10, 7);
  push_tear(woven.w, 40, 5);
  if (broken) woven.w->woven.tear_queue[0].excess = 9;
  spring_break_apply(woven.w);
}
static void tear_queue_is_within_its_capacity(int broken) {
  if (broken) woven.w->woven.tear_count = (uint32_t)woven.w->params->tears_max + 1;
  push_tear(woven.w, 10, 7);
}
static void torn_spring_is_alive(int broken) {
  push_tear(woven.w, 10, 7);
  if (broken) world_kill_spring(woven.w, 10);
  spring_break_apply(woven.w);
}
static void particles_are_within_their_pool(int broken) {
  if (broken) woven.w->p.count = woven.w->capacity[POOL_PARTICLES] + 1;
  damp_begin(woven.w);
}
static void slip_is_of_yarns(int broken) { yarn_slip_apply(broken ? woven.w : yarns.w); }

/* ---- trimesh ---- */

static void divided_triangle_exists(int broken) {
  uint32_t added;
  const uint32_t t = broken ? triangles_in_use(membrane.w) : 0;
  (void)trimesh_divide_triangle(membrane.w, t, 1 << 14, 1 << 14, &added);
}
static void split_vertices_are_within_their_pool(int broken) {
  uint32_t added;
  if (broken) membrane.w->p.count = membrane.w->capacity[POOL_PARTICLES] + 1;
  for (uint32_t t = 0; t < triangles_in_use(membrane.w); ++t)
    if (trimesh_divide_triangle(membrane.w, t, 21845, 21845, &added) == TRIMESH_DONE) return;
  _exit(3);
}

/* ---- membrane ---- */

static void triangle_has_an_area(int broken) {
  if (broken) membrane.w->trimesh.area[3] = 0;
  membrane_stress_update(membrane.w);
}
static void vertex_has_a_triangle(int broken) {
  if (broken) membrane.w->trimesh.mass[3] = 0;
  membrane_gains_update(membrane.w);
}
static void folds_are_edges(int broken) {
  if (broken) membrane.w->membrane.fold_count = 3 * triangles_in_use(membrane.w);
  bend_force_add(membrane.w, BEND_STEP);
}

/* ---- contact ---- */

static void contacts_are_within_their_pool(int broken) {
  fray_world *w = membrane.w;
  w->contact.count = broken ? w->capacity[POOL_CONTACTS] + 1 : 0;
  contact_primitives_range(w, 0, w->contact.count);
}
static void contact_has_a_particle(int broken) {
  fray_world *w = membrane.w;
  w->contact.list[0] = (contact){w->p.count - (broken ? 0 : 1), 0, {CONTACT_APART}, {0, 0, 0}};
  w->contact.count = 1;
  contact_update_velocity(w);
}

/* ---- self_collision ---- */

static void pair_of_patches_is_two(int broken) { (void)patches_pair(membrane.w, broken ? 1 : 0, 1); }
static void listed_pair_is_in_the_list(int broken) {
  triangle_pair_list *l = membrane.w->tri.list;
  l->active = 0;
  if (l->pairs == 0) _exit(3);
  triangle_collision_check(membrane.w, broken ? l->pairs : 0);
}
static void pairs_are_within_their_pool(int broken) {
  if (broken) membrane.w->tri.list->pairs = membrane.w->capacity[POOL_TRIANGLE_PAIRS] + 1;
  patches_follow(membrane.w);
}
static void triangle_pair_is_in_order(int broken) {
  triangle_pair *pair = &membrane.w->tri.pairs[0];
  if (broken) pair->triangle[1] = pair->triangle[0];
  (void)triangle_collision_push(membrane.w, pair);
}
static void zones_lead_to_their_root(int broken) {
  impact_zones_begin(membrane.w);
  if (broken) membrane.w->self.zone_of[2] = 5;
  (void)impact_zones_of(membrane.w, 2);
}
static void yarn_pair_is_of_living_springs(int broken) {
  self_pair pair = {0, (index_t)((uint32_t)yarns.w->params->links - 1u), 0, 0};
  impact_zones_begin(yarns.w);
  if (broken) yarns.w->woven.spring_kind[0] = SPRING_DEAD;
  (void)yarn_collision_push(yarns.w, &pair);
}

/* ---- haptics ---- */

static void ramp_is_at_most_one(int broken) {
  if (broken) woven.w->state->ramp = (1 << 16) + 1;
  haptic_device_update(woven.w, &idle);
}
static void let_out_force_has_a_share(int broken) {
  if (broken) woven.w->state->ramp = -1;
  haptic_force_update(woven.w, output.force);
}

/* ---- tick ---- */

static void tick_has_an_input(int broken) { fray_tick(woven.w, broken ? NULL : &idle, &output); }
static void loop_is_of_its_model(int broken) {
  tick_start(woven.w, &output);
  tick_woven(broken ? membrane.w : woven.w);
}
static void tick_ends_within_its_pools(int broken) {
  if (broken) woven.w->contact.count = woven.w->capacity[POOL_CONTACTS] + 1;
  tick_report(woven.w, &output);
}

/* ---- workers ---- */

static fray_parallel *schedule(void) {
  const size_t bytes = (fray_parallel_memory_size(wide.w, 2) + 63) / 64 * 64;
  fray_parallel *par = fray_parallel_open(wide.w, 2, aligned_alloc(64, bytes), bytes);
  if (par == NULL || par->block_count == 0) _exit(3);
  return par;
}
static void step_is_of_a_worker(int broken) { fray_parallel_step(schedule(), broken ? 2 : 0, 0, &idle, &output); }
static void dependency_is_of_a_step(int broken) {
  fray_parallel *par = schedule();
  (void)fray_parallel_dependency(par, 1, fray_parallel_steps(par) - (broken ? 0 : 1));
}
static void blocks_are_within_their_array(int broken) {
  fray_parallel *par = schedule();
  (void)block_plan_holds(wide.w, par->blocks, broken ? BLOCKS_MAX + 1 : par->block_count);
}
static void partition_has_its_springs(int broken) {
  fray_parallel *par = schedule();
  const spring_batch *batch = &wide.w->woven.batches[wide.w->params->link_batches];
  for (int32_t spring = batch->first; broken && spring < batch->first + batch->count; ++spring)
    wide.w->woven.spring_j[spring] = (index_t)(wide.w->p.count + 1);
  spring_partition_make(par);
}

/* ---- wire ---- */

static cmac_key key;
static frame f;

static void queue_is_read_within_its_items(int broken) {
  static queue q;
  q.count = broken ? 0 : 1;
  (void)queue_at(&q, 0);
}
static void queue_is_within_its_capacity(int broken) {
  static queue q;
  q.count = QUEUE_CAPACITY + (broken ? 1 : 0);
  (void)queue_add(&q);
}
static void queue_drops_what_it_has(int broken) {
  static queue q;
  queue_drop(&q, broken ? 1 : 0);
}
static void instances_are_eight(int broken) { (void)dictionary_id(MESSAGE_SYNC, broken ? 8 : 7); }
static void message_exists(int broken) { (void)dictionary_length((dictionary_message)(MESSAGES - !broken)); }
static void hands_are_two(int broken) { (void)dictionary_pose(broken ? 2 : 1); }
static void checked_bytes_have_a_checksum(int broken) { (void)e2e_check(f.data, broken ? 1 : 2, 1); }
static void sent_faults_are_known(int broken) {
  const codec_status now = {FRAY_SAFE, 0, broken ? 1u << 15 : 0, 0, 0};
  codec_encode_status(&f, 0, &now);
}
static void pose_counter_has_four_bits(int broken) {
  const fray_pose pose = {0, 0, 0, broken ? 16 : 15, 0};
  codec_encode_pose(&f, 0, 0, &pose);
}
static void sequence_has_four_bits(int broken) {
  static sequence s;
  (void)sequence_take(&s, broken ? 16 : 15);
}
static void sender_has_a_rate(int broken) {
  static port_sender s;
  port_sender_init(&s, 0, 1, broken ? 0 : 1000);
}
static void sender_has_a_status_period(int broken) {
  static port_sender s;
  port_sender_init(&s, 0, 1, 1000);
  s.has_sent = 1;
  if (broken) s.status_ticks = 0;
  (void)port_encode(&s, &output, (frame[PORT_OUT]){{0}});
}
static void pose_is_of_a_hand_in_use(int broken) {
  static port p;
  static fray_input input;
  port_init(&p, 0, broken ? 1 : 3, NULL);
  queue_add(&p.pending)->lane = 1;
  port_take(&p, &input);
}
static void lane_has_a_key(int broken) {
  static auth_lane lane;
  auth_lane_init(&lane, broken ? NULL : &key, MESSAGE_ACK, 0, 0);
}
static void monitor_fails_at_its_level(int broken) {
  static auth_monitor monitor;
  auth_monitor_init(&monitor, &key, 0, 0, 0);
  monitor.failed = broken ? 1 : 0;
  (void)auth_monitor_check(&monitor, &f);
}
static void gate_has_its_lanes(int broken) {
  static auth_gate g;
  frame plain;
  auth_gate_init(&g, &key, AUTH_GATE_FD, AUTH_GATE_RUNTIME, 0, 3);
  if (broken) g.in_count = AUTH_GATE_IN + 1;
  (void)auth_gate_receive(&g, &f, &plain);
}
static void tagged_bytes_exist(int broken) {
  uint8_t tag[CMAC_BLOCK];
  cmac_tag(&key, broken ? NULL : f.data, 1, tag);
}

/* ---- every case, whole and broken ---- */

/* The status of a process that makes the call; `said`: the file of the assertion that stopped it. */
static int run_case(void (*call)(int broken), int broken, char said[256]) {
  int status = -1;
  memset(said, 0, 256);
  CHECK(pipe(report_pipe) == 0);
  fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    (void)signal(SIGILL, SIG_DFL);
    (void)signal(SIGTRAP, SIG_DFL);
    call(broken);
    _exit(0);
  }
  close(report_pipe[1]);
  CHECK(child > 0 && waitpid(child, &status, 0) == child);
  CHECK(read(report_pipe[0], said, 255) >= 0);
  close(report_pipe[0]);
  return status;
}

static void check_case(void (*call)(int broken), const char *name, const char *file) {
  char said[256];
  int status = run_case(call, 0, said);
  const int passes = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  if (!passes) printf("%s: does not pass as it should be: %s\n", name, said);
  CHECK(passes);
  status = run_case(call, 1, said);
  const int stopped = WIFSIGNALED(status) && (WTERMSIG(status) == SIGILL || WTERMSIG(status) == SIGTRAP) &&
                      strstr(said, file) != NULL;
  if (!stopped) printf("%s: broken, not stopped by %s: %s\n", name, file, said);
  CHECK(stopped);
}

#define CASE(call, file) check_case(call, #call, "rt/" file)

static void base(void) {
  CASE(arena_has_room, "base/arena.h");
  CASE(draw_has_a_range, "base/random.h");
  CASE(friction_is_not_negative, "base/coulomb.h");
  CASE(hashed_words_exist, "base/hash.c");
}

static void geometry(void) {
  CASE(thickness_is_not_negative, "geometry/ccd.c");
  CASE(searched_face_is_narrow, "geometry/closest_point.c");
}

static void state_room(void) {
  CASE(one_ring_is_in_order, "state/trimesh.c");
  CASE(whole_crossing_is_split_first, "state/crossing.c");
  CASE(pending_crossings_are_counted, "state/crossing.c");
  CASE(mesh_exists, "state/rigid_mesh.c");
}

static void simd(void) {
  fray_kernel found[SIMD_KERNELS];
  if (simd_kernels(found) != 0) CASE(batch_shares_no_particle, "simd/spring_lanes.inl.h");
  CASE(loop_ends_after_its_first, "simd/particle_loops.h");
  CASE(kernel_exists, "simd/simd.h");
}

static void image(void) {
  CASE(viewed_spring_exists, "image/view.c");
  CASE(saved_state_has_its_topology, "image/image.c");
  CASE(hashed_particles_are_in_use, "image/state_hash.c");
}

static void integrate(void) {
  CASE(substep_is_of_this_tick, "integrate/bodies.c");
  CASE(attached_particles_are_carried, "integrate/particles.c");
}

static void woven_room(void) {
  CASE(tear_queue_is_in_order, "woven/spring_break.c");
  CASE(tear_queue_is_within_its_capacity, "woven/tear_queue.h");
  CASE(torn_spring_is_alive, "woven/spring_break.c");
  CASE(particles_are_within_their_pool, "woven/damp.c");
  CASE(slip_is_of_yarns, "woven/yarn_slip.c");
}

static void trimesh_room(void) {
  CASE(divided_triangle_exists, "trimesh/trimesh_refine.c");
  CASE(split_vertices_are_within_their_pool, "trimesh/trimesh_refine.c");
}

static void membrane_room(void) {
  CASE(triangle_has_an_area, "membrane/membrane_stress.c");
  CASE(vertex_has_a_triangle, "membrane/membrane_gains.c");
  CASE(folds_are_edges, "membrane/bend_force.c");
}

static void contact_room(void) {
  CASE(contacts_are_within_their_pool, "contact/contact_primitives.c");
  CASE(contact_has_a_particle, "contact/contact_velocity.c");
}

static void self_collision(void) {
  CASE(pair_of_patches_is_two, "self_collision/patches.h");
  CASE(listed_pair_is_in_the_list, "self_collision/triangle_collision_test.c");
  CASE(pairs_are_within_their_pool, "self_collision/patches.c");
  CASE(triangle_pair_is_in_order, "self_collision/triangle_collision_pair.c");
  CASE(zones_lead_to_their_root, "self_collision/impact_zones.c");
  CASE(yarn_pair_is_of_living_springs, "self_collision/yarn_collision_pair.c");
}

static void haptics(void) {
  CASE(ramp_is_at_most_one, "haptics/haptic_device.c");
  CASE(let_out_force_has_a_share, "haptics/haptic_force.c");
}

static void tick(void) {
  CASE(tick_has_an_input, "tick/tick.c");
  CASE(loop_is_of_its_model, "tick/tick_woven.c");
  CASE(tick_ends_within_its_pools, "tick/tick_report.c");
}

static void workers(void) {
  CASE(step_is_of_a_worker, "workers/parallel.c");
  CASE(dependency_is_of_a_step, "workers/schedule.c");
  CASE(blocks_are_within_their_array, "workers/block_plan.c");
  CASE(partition_has_its_springs, "workers/spring_partition.c");
}

static void wire(void) {
  CASE(queue_is_read_within_its_items, "wire/queue.h");
  CASE(queue_is_within_its_capacity, "wire/queue.h");
  CASE(queue_drops_what_it_has, "wire/queue.h");
  CASE(instances_are_eight, "wire/dictionary.h");
  CASE(message_exists, "wire/dictionary.h");
  CASE(hands_are_two, "wire/dictionary.h");
  CASE(checked_bytes_have_a_checksum, "wire/e2e.c");
  CASE(sent_faults_are_known, "wire/codec.c");
  CASE(pose_counter_has_four_bits, "wire/codec.c");
  CASE(sequence_has_four_bits, "wire/sequence.c");
  CASE(sender_has_a_rate, "wire/port.c");
  CASE(sender_has_a_status_period, "wire/port.c");
  CASE(pose_is_of_a_hand_in_use, "wire/port.c");
  CASE(lane_has_a_key, "wire/auth.c");
  CASE(monitor_fails_at_its_level, "wire/auth.c");
  CASE(gate_has_its_lanes, "wire/auth_gate.c");
  CASE(tagged_bytes_exist, "wire/cmac.c");
}

static void open_worlds(void) {
  fixture_file(&woven, "tests/scenes/small.scene", NULL);
  fixture_hanging(&wide, 32, 32, 2, "0 s", "0 %", "0 /s");
  fixture_file(&yarns, "tests/determinism/yarn_collision.scene", "yarns on", "yarns all", NULL);
  fixture_file(&membrane, "tests/determinism/triangle_collision.scene", NULL);
  for (uint32_t n = 0; n < 20; ++n) (void)fixture_tick(&yarns, &idle);
  for (uint32_t n = 0; n < 20; ++n) (void)fixture_tick(&membrane, &idle);
}

static void what_is_broken_is_stopped(void) {
  open_worlds();
  TEST(base);
  TEST(geometry);
  TEST(state_room);
  TEST(simd);
  TEST(image);
  TEST(integrate);
  TEST(woven_room);
  TEST(trimesh_room);
  TEST(membrane_room);
  TEST(contact_room);
  TEST(self_collision);
  TEST(haptics);
  TEST(tick);
  TEST(workers);
  TEST(wire);
}

#endif

int main(void) {
  TEST(is_evaluated_in_builds_with_assertions_only);
#ifdef FRAY_TESTS_LIB_ASSERTION_REPORT_H
  what_is_broken_is_stopped();
#endif
  return test_end();
}
