/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/wild/judge.h"

#include <math.h>

#include "rt/state/crossing.h"
#include "tests/lib/world_fixture.h"
#include "tests/wild/body_depth.h"
#include "tests/wild/random_scene.h"
#include "tools/analysis/energy_table.h"
#include "tools/recording/record.h"
#include "tools/world/kernel.h"

enum { REOPENED_EVERY = 97, WORKERS = 3 };

static const char *const names[JUDGE_MADE] = {
    "another hash by kernel", "another hash by workers or saved",
    "saved and refused",      "the ledger is open",
    "clamp without a fault",  "speed",
    "through a body"};
#define STAGE_NAME(row, text) text,
static const char *const stages[] = {FRAY_ENERGY_STAGE_ROWS(STAGE_NAME)};

const char *judge_name(uint32_t kind) {
  static char text[64];
  if (kind < JUDGE_MADE) return names[kind];
  snprintf(text, sizeof text, "made by %s", stages[kind - JUDGE_MADE]);
  return text;
}

/* The three: watched, with the fastest kernel; scalar; and divided, saved and opened. */
typedef struct {
  fixture watched, scalar, divided;
  fray_parallel *parallel;
  void *parallel_memory;
  body_depth *depth;
  double turned, begun;       /* energy turned over, and what of it was there, J */
  double rounding;            /* what rounding may have made, J */
  double held;                /* by projected links when it began, and since then for springs, J */
  double pressing;            /* net of what presses projected yarns together, so far; units */
  double fastest_body, reach; /* m/s; how far a particle came, m */
  double loaded;              /* what loads gave the vertex that they move most, m/s */
  double cloth_speed;         /* of waves at the strain of a tear, m/s */
  double strain;              /* of elastic yarns that do not tear, at most so far */
  double mass;                /* of the free cloth, kg */
  double net[FRAY_ENERGY_STAGES];     /* by a stage so far, J */
  double excused[FRAY_ENERGY_STAGES]; /* what of it a fault says */
} judged;

static void find(judge_result *r, uint32_t kind, uint32_t tick, double size, double allowed) {
  if ((r->found >> kind & 1u) == 0) r->tick[kind] = tick;
  r->found |= 1u << kind;
  if (size <= r->size[kind]) return;
  r->size[kind] = size;
  r->allowed[kind] = allowed;
}

static double length_of(const int32_t v[3]) {
  return sqrt((double)v[0] * v[0] + (double)v[1] * v[1] + (double)v[2] * v[2]);
}

static double particle_mass(const judged *j, uint32_t p) {
  const fray_world *w = j->watched.w;
  const double unit = j->watched.facts.particle_mass_ng * 1e-12;
  if (world_has_membrane(w)) return unit * w->trimesh.mass[p] / w->membrane.constants->mass_unit;
  return unit * particle_half_masses(w, p) / 2;
}

/* Of the cloth behind a wave of the strain at which it tears, or of a quarter (README.md, "Speed"):
 * strain times sqrt(stiffness / density), along an elastic yarn sqrt(EA / line density); in
 * projected yarns what a link gives back in a substep. */
static double wave_speed(const judged *j) {
  const fray_world *w = j->watched.w;
  const fray_info *f = &j->watched.facts;
  const double lu = f->lu_um * 1e-6;
  const double strain = f->tearing != 0 && f->tear_max_q16 > 0 ? f->tear_max_q16 * 0x1p-16 : 0.25;
  if (!world_has_membrane(w)) {
    const double rest =
        fmax(w->woven.link_classes[CLASS_WEFT].rest, w->woven.link_classes[CLASS_WARP].rest);
    const double spacing = rest * 0x1p-24 * lu;
    if (f->yarn_stiffness_un == 0) return strain * spacing * f->rate_hz * f->substeps;
    return strain * sqrt(f->yarn_stiffness_un * 1e-6 * spacing / (f->particle_mass_ng * 1e-12));
  }
  const double area = w->membrane.constants->mass_unit * 0x1p-30 * lu * lu / 3;
  const double density = f->particle_mass_ng * 1e-12 / area;
  double most = 0; /* N/m */
  for (uint32_t m = 0; m < (uint32_t)w->trimesh.params->materials; ++m)
    for (uint32_t n = 0; n < MATERIAL_ROWS; ++n)
      for (uint32_t k = 0; k < 3; k += 2)
        most = fmax(most, w->membrane.materials[m].stretch[n][k] / 4096.0);
  return 0.25 * sqrt(most / density);
}

/* A link that is longer or shorter by e moves its ends by e / 2 in a substep h, or by its part of that, so to a speed
 * of e / 2h. Four links meet in a crossing of mass m, so together they give m e^2 / h^2 each at most. */
static double held_by_links(const fixture *f) {
  const fray_world *w = f->w;
  const double unit = 0x1p-24 * f->facts.lu_um * 1e-6 * f->facts.rate_hz * f->facts.substeps;
  double sum = 0;
  for (uint32_t n = 0; world_is_projected(w) && n < (uint32_t)w->params->links; ++n) {
    if (w->woven.spring_kind[n] == SPRING_DEAD) continue;
    const link_class *c = &w->woven.link_classes[w->woven.spring_kind[n] & SPRING_CLASS];
    const vec3 d = vec_sub(world_position(w, w->woven.spring_j[n]), world_position(w, w->woven.spring_i[n]));
    const double e = sqrt((double)vec_squared(d)) - c->rest;
    sum += pow(unit * e * (e < 0 ? c->push / 4096.0 : 1), 2);
  }
  return sum * f->facts.particle_mass_ng * 1e-12;
}

/* What links give back in a tick, J (README.md, "Made"): k (g h^2)^2 n^3 / 12 of a spring, k = m gain / (n h^2). */
static double given_for_springs(const fixture *f) {
  const fray_world *w = f->w;
  const double fall = length_of(f->facts.gravity) * energy_table_speed(&f->facts) * f->facts.substeps;
  double gains = 0;
  for (uint32_t n = (uint32_t)w->params->links; world_is_projected(w) && n < w->capacity[POOL_SPRINGS]; ++n) {
    const bend_shear_class *c = &w->woven.bend_shear_classes[w->woven.spring_kind[n] & SPRING_CLASS];
    if (w->woven.spring_kind[n] != SPRING_DEAD) gains += ldexp(c->mantissa, -c->shift);
  }
  return gains * fall * fall / 12 * f->facts.particle_mass_ng * 1e-12;
}

static int open_all(judged *j, const char *text, judge_result *r) {
  scene_error error;
  if (!fixture_compile(&j->watched, "out/wild/wild.scene", text, &error)) {
    if (strstr(error.message, "is not valid: section") != NULL) /* of the compiler's own image */
      find(r, JUDGE_OPENS, 0, 1, 0);
    else
      snprintf(r->refused, sizeof r->refused, "%.250s", error.message);
    return 0;
  }
  fixture_open_image(&j->watched);
  fixture_copy(&j->scalar, &j->watched);
  fixture_copy(&j->divided, &j->watched);
  kernel_use(j->watched.w, NULL);
  kernel_use(j->divided.w, NULL);
  fray_energy_watch(j->watched.w);
  j->held = held_by_links(&j->watched);
  j->depth = body_depth_open(j->watched.w);
  j->cloth_speed = wave_speed(j);
  for (uint32_t p = particles_attached(j->watched.w); p < j->watched.w->p.count; ++p)
    j->mass += particle_mass(j, p);
  return 1;
}

static void open_parallel(judged *j) {
  free(j->parallel_memory);
  const size_t bytes = (fray_parallel_memory_size(j->divided.w, WORKERS) + 63) / 64 * 64;
  j->parallel_memory = aligned_alloc(64, bytes);
  j->parallel = fray_parallel_open(j->divided.w, WORKERS, j->parallel_memory, bytes);
}

static void close_all(judged *j) {
  body_depth_close(j->depth);
  free(j->parallel_memory);
  fixture_close(&j->watched);
  fixture_close(&j->scalar);
  fixture_close(&j->divided);
}

static int is_due(const judged *j, const uint32_t *done, uint32_t worker) {
  const fray_dependency d = fray_parallel_dependency(j->parallel, worker, done[worker]);
  if (d.worker != FRAY_ALL_WORKERS) return done[d.worker] >= d.steps;
  for (uint32_t n = 0; n < WORKERS; ++n)
    if (n != worker && done[n] < d.steps) return 0;
  return 1;
}

/* Workers in turns: the last of those that may go on first, so that steps are taken in another
 * order than by one worker. */
static fray_output divided_tick(judged *j, const fray_input *input) {
  fray_output out;
  uint32_t done[WORKERS] = {0};
  const uint32_t steps = fray_parallel_steps(j->parallel);
  memset(&out, 0, sizeof out);
  for (uint32_t left = steps * WORKERS; left > 0; --left) {
    uint32_t worker = WORKERS;
    for (uint32_t n = 0; n < WORKERS; ++n)
      if (done[n] < steps && is_due(j, done, n)) worker = n;
    if (worker == WORKERS) fixture_give_up("workers", "none may go on");
    fray_parallel_step(j->parallel, worker, done[worker], input, &out);
    ++done[worker];
  }
  return out;
}

/* Saves a world and goes on from there; returns 0 where that is refused. */
static int reopen(fixture *f) {
  fixture next;
  fray_error error;
  memset(&next, 0, sizeof next);
  next.image_bytes = fray_save_bytes(f->w);
  next.image = malloc(next.image_bytes);
  if (next.image == NULL || fray_save(f->w, next.image, next.image_bytes) != next.image_bytes)
    fixture_give_up("fray_save", "did not save");
  if (fray_memory_size(next.image, next.image_bytes, &next.memory_bytes, &error) == FRAY_OK) {
    next.memory_bytes = (next.memory_bytes + 63) / 64 * 64;
    next.memory = aligned_alloc(64, next.memory_bytes);
    if (fray_open(next.image, next.image_bytes, next.memory, next.memory_bytes, &next.w, &error) ==
        FRAY_OK) {
      next.facts = fray_get_info(next.w);
      fixture_close(f);
      *f = next;
      kernel_use(f->w, NULL);
      return 1;
    }
  }
  fixture_close(&next);
  return 0;
}

static fray_input input_of(const judged *j, const judge_run *run, uint32_t tick) {
  fray_input input = fixture_idle;
  const double seconds = (double)tick / j->watched.facts.rate_hz;
  input.has_pose = (uint8_t)j->watched.facts.hands;
  if (input.has_pose != 0 && tick == 0) input.command = FRAY_COMMAND_START;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    int16_t at[3];
    random_scene_pose(run->seed, run->number, h, fmax(0, seconds - 0.2), at);
    input.pose[h].x = at[0];
    input.pose[h].y = at[1];
    input.pose[h].z = at[2];
    input.pose[h].counter = (uint8_t)((tick + 1u) & 15u);
  }
  return input;
}

/* ---- judges of motion ---- */

static double sum_of(const fray_energy_account *a, uint32_t n) {
  return (double)a->made[n] - (double)a->lost[n];
}

/* What a stage made less what it lost. A projected link stores nothing, and draws at rest; what holds its
 * ends takes that back. So where links are projected, they and pushes of bodies are judged by what all that
 * moves positions in a substep has made, and elastic steps with their damping (README.md, "Made"). */
static double net_of(const judged *j, const fray_energy_account *a, uint32_t n) {
  const double net = sum_of(a, n);
  if (n == FRAY_ENERGY_STEPS && !world_is_projected(j->watched.w))
    return net + fmin(sum_of(a, FRAY_ENERGY_DAMPING), 0);
  if (!world_is_projected(j->watched.w) || (n != FRAY_ENERGY_LIMITS && n != FRAY_ENERGY_CONTACT)) return net;
  return sum_of(a, FRAY_ENERGY_LIMITS) + sum_of(a, FRAY_ENERGY_CONTACT) +
         fmin(sum_of(a, FRAY_ENERGY_SLIP), 0) + fmin(sum_of(a, FRAY_ENERGY_SELF_COLLISION), 0);
}

/* A membrane's strain beyond the largest has a force and no energy, and a body that is driven through what another
 * holds leaves it behind: what steps, or contact, make in such a tick says nothing. `taken` by what presses yarns
 * together is left out of what pushes make. Every other stage, and every other tick, is judged as ever. */
static double excused_net(judged *j, uint32_t n, double net, double taken, uint32_t faults) {
  const int is_membrane = world_has_membrane(j->watched.w);
  const uint32_t excuse = n == FRAY_ENERGY_STEPS && is_membrane ? FRAY_FAULT_OVERSTRETCHED
                          : n == FRAY_ENERGY_CONTACT            ? FRAY_FAULT_CONTACT_UNRESOLVED
                                                                : 0u;
  const double made = fmax(0, net - j->net[n]);
  if ((faults & excuse) != 0) j->excused[n] += made;
  if (n == FRAY_ENERGY_SELF_COLLISION) j->excused[n] += fmin(made, taken);
  j->net[n] = net;
  return net - j->excused[n];
}

/* By what presses projected yarns together in the tick, where pushes part them (README.md, "Made"). */
static double taken_by_pressing(judged *j, const fray_energy_account *a) {
  if (!world_is_projected(j->watched.w)) return 0;
  const double pressing =
      sum_of(a, FRAY_ENERGY_LIMITS) + sum_of(a, FRAY_ENERGY_CONTACT) + sum_of(a, FRAY_ENERGY_STEPS);
  const double taken = fmax(0, j->pressing - pressing);
  j->pressing = pressing;
  return taken;
}

/* Of yarns, in a substep. */
static double elastic_steps(const fray_world *w) {
  return world_has_elastic_yarns(w) ? 1 << w->woven.elastic_params->steps_bits : 1;
}

/* By how many position steps a stage rounds a particle in a substep, at most: four links project it in each
 * iteration, to half a step each. */
static double rounded_steps(const fray_world *w) {
  return world_is_projected(w) ? 2.0 * w->params->iterations : 1;
}

static void judge_energy(judged *j, uint32_t tick, uint32_t faults, judge_result *r) {
  const fray_info *f = &j->watched.facts;
  const fray_energy_account a = fray_energy(j->watched.w);
  const double unit = energy_table_unit(f);
  uint64_t open = 0 - (uint64_t)a.begun; /* sums of large rows are exact in integers alone */
  double elastic = 0;
  double supplied = 0;
  for (uint32_t n = 0; n < FRAY_ENERGY_STORES; ++n) open += (uint64_t)a.stored[n];
  for (uint32_t n = FRAY_STORED_STRETCH; n <= FRAY_STORED_YARNS; ++n)
    elastic += (double)a.stored[n];
  for (uint32_t n = 0; n < FRAY_ENERGY_SUPPLIES; ++n) {
    open -= (uint64_t)a.supplied[n];
    supplied += fabs((double)a.supplied[n]);
  }
  for (uint32_t n = 0; n < FRAY_ENERGY_STAGES; ++n)
    open -= (uint64_t)a.made[n] - (uint64_t)a.lost[n];
  const double is_open = fabs((double)(int64_t)open);
  if (is_open > FRAY_ENERGY_ROUNDING)
    find(r, JUDGE_CLOSES, tick, is_open * unit, FRAY_ENERGY_ROUNDING * unit);
  if (tick == 0) j->begun = (elastic + fabs((double)a.stored[FRAY_STORED_BODIES])) * unit;
  const double moving = (double)a.stored[FRAY_STORED_KINETIC] * unit;
  j->turned = fmax(j->turned, j->begun + (supplied + fabs((double)a.gravity)) * unit);
  j->held += given_for_springs(&j->watched);
  const double speed_step = 0x1p-24 * f->lu_um * 1e-6 * f->rate_hz * f->substeps;
  const double moves = elastic_steps(j->watched.w);
  const double rounds = rounded_steps(j->watched.w);
  j->rounding += f->substeps * (sqrt(2 * fmax(moving, 0) * j->mass) * rounds * speed_step +
                                fmax(pow(moves, 3), pow(rounds, 2)) * j->mass * speed_step * speed_step);
  const double taken = taken_by_pressing(j, &a) * unit;
  for (uint32_t n = 0; n < FRAY_ENERGY_STAGES; ++n) {
    const double net = excused_net(j, n, net_of(j, &a, n) * unit, taken, faults);
    const double held = n == FRAY_ENERGY_LIMITS || n == FRAY_ENERGY_CONTACT ? j->held : 0;
    const double allowed = 0.01 * j->turned + j->rounding + held;
    if (net > allowed) find(r, JUDGE_MADE + n, tick, net, allowed);
  }
}

/* Behind a tick: by loads on a vertex as heavy as it is now. */
static double load_speed(const judged *j) {
  const fray_world *w = j->watched.w;
  const double units = 0x1p-22 * energy_table_speed(&j->watched.facts);
  double most = 0;
  if (!world_has_membrane(w)) return 0;
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
    const elastic_impulse *load = &w->membrane.external_impulse[p];
    const int32_t impulse[3] = {load->x, load->y, load->z};
    most = fmax(most, length_of(impulse) * w->membrane.inverse_mass[p]);
  }
  return most * units * w->membrane.constants->steps * w->params->substeps;
}

/* Of the longest link. */
static double largest_strain(const fray_world *w) {
  double most = 0;
  for (uint32_t n = 0; n < (uint32_t)w->params->links; ++n) {
    if (w->woven.spring_kind[n] == SPRING_DEAD) continue;
    const vec3 d = vec_sub(world_position(w, w->woven.spring_j[n]), world_position(w, w->woven.spring_i[n]));
    const int32_t along[3] = {d.x, d.y, d.z};
    most = fmax(most, length_of(along) / w->woven.link_classes[w->woven.spring_kind[n] & SPRING_CLASS].rest - 1);
  }
  return most;
}

/* What was drawn farther than a quarter held that strain: a membrane that was drawn to three times its length, and
 * elastic yarns that do not tear. */
static double allowed_speed(judged *j, uint32_t tick, uint32_t faults) {
  const fray_info *f = &j->watched.facts;
  const fray_world *w = j->watched.w;
  const double speed = energy_table_speed(f);
  for (uint32_t b = 0; b < f->bodies; ++b) {
    const fray_body v = fray_view_body(w, b);
    j->fastest_body = fmax(j->fastest_body, length_of(v.velocity) * speed);
  }
  const double g = length_of(f->gravity) * speed * f->rate_hz * f->substeps;
  const double fall = fmin(g * (tick + 1.0) / f->rate_hz, sqrt(2 * g * 2 * j->reach));
  const double wind = world_has_membrane(w) ? length_of(w->membrane.constants->wind) * speed : 0;
  j->loaded += load_speed(j);
  if (world_has_elastic_yarns(w) && f->tearing == 0) j->strain = fmax(j->strain, largest_strain(w));
  const int is_drawn = world_has_membrane(w) && (faults & FRAY_FAULT_OVERSTRETCHED) != 0;
  const double cloth = j->cloth_speed * fmax(1, (is_drawn ? 2 : j->strain) / 0.25);
  return 2 * (j->fastest_body + wind + fall + j->loaded + cloth);
}

static void judge_speed(judged *j, uint32_t tick, uint32_t faults, judge_result *r) {
  const fray_particles v = fray_view_particles(j->watched.w);
  const double speed = energy_table_speed(&j->watched.facts);
  const double lu = j->watched.facts.lu_um * 1e-6 * 0x1p-24;
  double fastest = 0;
  int clamped = 0;
  for (uint32_t p = v.attached; p < v.count; ++p) {
    const int32_t velocity[3] = {v.vx[p], v.vy[p], v.vz[p]};
    const int32_t at[3] = {v.x[p], v.y[p], v.z[p]};
    fastest = fmax(fastest, length_of(velocity));
    j->reach = fmax(j->reach, length_of(at) * lu);
    for (uint32_t n = 0; n < 3; ++n)
      clamped |= velocity[n] >= FX_SPEED_MAX || velocity[n] <= -FX_SPEED_MAX;
  }
  const double allowed = allowed_speed(j, tick, r->faults);
  if (fastest * speed > allowed) find(r, JUDGE_SPEED, tick, fastest * speed, allowed);
  if (clamped && (faults & (FRAY_FAULT_OUT_OF_WORLD | FRAY_FAULT_SPEED_LIMIT)) == 0)
    find(r, JUDGE_CLAMP, tick, fastest * speed, 0);
}

static void judge_depth(judged *j, uint32_t tick, uint32_t faults, judge_result *r) {
  const uint32_t excused = FRAY_FAULT_CONTACTS_FULL | FRAY_FAULT_CONTACT_UNRESOLVED |
                           FRAY_FAULT_OUT_OF_WORLD | FRAY_FAULT_SELF_COLLISION_BUDGET |
                           FRAY_FAULT_MESH_QUERY_BUDGET;
  const double deepest = body_depth_update(j->depth, j->watched.w);
  const double allowed = 2.0 * j->watched.facts.thickness;
  const double cm = j->watched.facts.lu_um * 1e-4 * 0x1p-24;
  if (deepest > allowed && (faults & excused) == 0)
    find(r, JUDGE_THROUGH, tick, deepest * cm, allowed * cm);
}

static void judge_hashes(const fray_output *a, const fray_output *b, const fray_output *c,
                         uint32_t tick, judge_result *r) {
  if (a->hash != b->hash || a->faults != b->faults || a->tears_total != b->tears_total)
    find(r, JUDGE_KERNEL, tick, 1, 0);
  if (a->hash != c->hash || a->faults != c->faults || a->tears_total != c->tears_total)
    find(r, JUDGE_WORKERS, tick, 1, 0);
}

/* Faults are sticky; of these each tick says its own. */
static void forget_faults(judged *j) {
  const int32_t keep = ~(int32_t)(FRAY_FAULT_OVERSTRETCHED | FRAY_FAULT_SPEED_LIMIT | FRAY_FAULT_CONTACT_UNRESOLVED);
  j->watched.w->state->faults &= keep;
  j->scalar.w->state->faults &= keep;
  j->divided.w->state->faults &= keep;
}

void judge_scene(const char *text, const judge_run *run, judge_result *r) {
  judged j;
  record log;
  memset(&j, 0, sizeof j);
  memset(r, 0, sizeof *r);
  if (!open_all(&j, text, r)) return;
  open_parallel(&j);
  const fray_info *f = &j.watched.facts;
  if (run->record != NULL)
    record_begin(&log, run->record, 0, f->hands, f->rate_hz, f->tick, fray_hash(j.watched.w));
  r->ticks = (uint64_t)ceil(run->seconds * f->rate_hz);
  for (uint32_t tick = 0; tick < r->ticks; ++tick) {
    const fray_input input = input_of(&j, run, tick);
    forget_faults(&j);
    const fray_output a = fixture_tick(&j.watched, &input);
    const fray_output b = fixture_tick(&j.scalar, &input);
    if (!fray_parallel_holds(j.parallel)) open_parallel(&j);
    const fray_output c = divided_tick(&j, &input);
    if (run->record != NULL) (void)record_tick(&log, &input, &a);
    r->faults |= a.faults;
    judge_hashes(&a, &b, &c, tick, r);
    judge_energy(&j, tick, a.faults, r);
    judge_speed(&j, tick, a.faults, r);
    judge_depth(&j, tick, r->faults, r);
    if (tick % REOPENED_EVERY == REOPENED_EVERY - 1u) {
      if (!reopen(&j.divided)) {
        find(r, JUDGE_OPENS, tick, 1, 0);
        break;
      }
      open_parallel(&j);
    }
    if ((r->found & run->wanted) != 0) break;
  }
  if (run->record != NULL) (void)record_end(&log);
  close_all(&j);
}
