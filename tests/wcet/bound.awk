# SPDX-License-Identifier: Apache-2.0
# -f stages.awk -f bound.awk FILES: from the lines of longest.c (`fixed`, `loop`) and of limits.h (`limits`) the bound
# of each case's tick: bound[case], bound[case, stage]; event_bound[case] is the part for contacts,
# cuts, splits and the list of springs to cut, without the tests for tearing, which are test_part[case].
# what NAME of loops.txt says of the case
function rounds(what) {
  if (what == "substeps") return substeps
  if (what == "sweeps") return sweeps * substeps
  if (what == "yarns" || what == "spares") return what == "yarns" ? yarns : yarns * spares
  if (what == "slips") return slips
  # four directions a contact, and over each disconnected crossing from both sides; with elastic yarns so much
  # again for each of four neighbours
  if (what == "grips") return (stretches != 0) * 4 * spares
  if (what == "neighbour_steps") return (stretches != 0 ? 40 : 8) * yarns * spares
  if (what == "splits") return splits
  # a crossing is marked once in a tick, and unmarked where it is split
  if (what == "marks") return yarns * (crossings + splits)
  if (what == "crossings") return yarns * crossings
  if (what == "strain_tests") return yarns * most["tear_tests"]
  if (what == "spread_steps") return splits * (warps + wefts)
  # a light and a whole end: a spare particle makes two light ones, of two links along each yarn
  if (what == "light_links") return least(4 * spares * sweeps * substeps, most["projections"] - held_projections)
  # of four bend springs, and four diagonals twice
  if (what == "other_springs") return springs_held + least(12 * spares * pulls, most["springs"] - springs_held)
  if (what == "weighings") return yarns * damping
  if (what == "weighed") return yarns * damping * (particles - held)
  if (what == "axis_weighed") return 6 * yarns * damping * (particles - held)
  if (what == "stretches") return stretches
  if (what == "stretch_steps") return inner_steps * substeps
  if (what == "batch_pulls") return (stretches != 0) * 2 * link_batches * inner_steps * substeps
  if (what == "pull_held") return (stretches != 0) * 3 * held * substeps
  if (what == "pull_free") return (stretches != 0) * 3 * most["predictions"]
  if (what == "inner_moves") return 3 * inner_steps * (most["predictions"] + held * substeps)
  # scenes of `make work` have no shear lock
  if (what == "locked") return 0
  # nor sweeps
  if (what == "pieces" || what == "halvings" || what == "looks") return 0
  if (what == "batch_sweeps") return link_batches * sweeps * substeps
  if (what == "spring_batches") return spring_batches
  if (what == "springs") return most["springs"]
  if (what == "projections_free") return most["projections"] - held_projections
  if (what == "projections_held") return held_projections
  # of triangles all of a substep but its end is in inner steps
  if (what == "axis_predictions") return 3 * (triangles ? (particles - held) * substeps : most["predictions"])
  if (what == "axis_places") return 3 * (triangles ? particles - held : most["predictions"] / substeps)
  if (what == "gathers") return most[what] - pulls * planes * (particles - held)
  if (what == "contact_steps") return contact_steps
  if (what == "contacts" || what == "tear_tests" || what == "cuts") return most[what]
  if (what == "plane_gathers") return pulls * planes * (particles - held)
  if (what == "enlisted") return pulls * (most["contacts"] / substeps + bodies)
  if (what == "bodies") return bodies
  if (what == "gathered_bodies") return bodies * pulls
  if (what == "body_steps") return bodies * substeps
  if (what == "body_updates") return bodies * substeps * (1 + (stretches != 0) * inner_steps)
  if (what == "plane_tests") return free_bodies * planes * substeps
  if (what == "held_steps") return held * substeps
  if (what == "damped") return damping ? particles - held : 0
  if (what == "axis_damped") return damping ? 6 * (particles - held) : 0
  if (what == "axis_dragged") return drag ? 3 * (particles - held) : 0
  if (what == "strong_springs") return strong ? most["springs"] : 0
  if (what == "dampings") return damping
  # a link that is cut takes its kind out of the row of kinds, one that is split may be of any
  if (what == "kind_changes") return yarns ? most["tear_tests"] : kind_changes
  if (what == "overstretched_tests") return overstretched * links
  if (what == "overstretched_kinds") return overstretched * (yarns ? links : kind_changes)
  if (what == "free_bodies") return free_bodies
  if (what == "tethered") return overstretched * crossings * free_bodies
  if (what == "paths") return paths
  if (what == "once") return hands
  if (what == "mirrored") return mirrored ? most["tear_tests"] : 0
  if (what == "keys") return keys
  # a lane's words by two; what is left of it is a part of its loop over lanes
  if (what == "hash_pairs") return rounds("hash_words") / 2
  if (what == "hash_byte_pairs") return 3 * particles / 2
  if (what == "hash_words") return 6 * particles + 40 + 12 * bodies + yarns * (5 + 6 * spares) + (triangles ? 13 + 18 * triangles : 0)
  if (what == "zeroed") return cleared_bytes + motion_bytes * bodies + (triangles ? 32 * particles + 16 * triangles : 0) + overstretched * particles
  if (what == "zeroed_words") return (cleared_bytes + motion_bytes * bodies) / 4 + 64 + (triangles ? 8 * particles + 4 * triangles : 0) + overstretched * particles / 4
  # the n-th that enters a heap rises by log2 n at most; once that is full one sinks between two below it
  if (what == "rise_steps") return rises
  if (what == "sink_steps") return (most["tear_tests"] > cuts_max ? most["tear_tests"] - cuts_max : 0) * depth
  if (what == "triangles") return triangles
  if (what == "creases") return triangles * 3 / 2
  if (what == "limit_triangles") return triangles * substeps
  if (what == "load_triangles") return 4 * triangles
  if (what == "cloths") return cloths
  if (what == "vertices") return (triangles != 0) * particles
  if (what == "free_vertices") return (triangles != 0) * (particles - held)
  if (what == "held") return (triangles != 0) * held
  if (what == "tried_vertices") return cloths * (particles - held)
  # at each of three corners a side and the middle
  if (what == "lines") return 6 * triangles
  if (what == "sheet_steps") return sheet_inner * substeps
  if (what == "pulls") return triangles * sheet_inner * substeps
  # angles are found twice more where triangles are pressed; an eighth of the triangles follows
  if (what == "folds") return triangles * 3 / 2 * (folds * substeps + 2)
  if (what == "bend_triangles") return triangles * (folds * substeps + 2)
  if (what == "begun_vertices") return (triangles != 0) * particles * (substeps + 2)
  if (what == "followed") return triangles * 9 / 8
  if (what == "summed_vertices") return particles * sheet_inner * substeps
  if (what == "inner_bodies") return bodies * all_inner * substeps
  if (what == "inner_planes") return free_bodies * planes * all_inner * substeps
  if (what == "limited_edges") return 2 * limited * 3 * triangles * sheet_inner * substeps # lengths, rates
  if (what == "constraints") return constraints
  if (what == "held_pulls") return held * all_inner * substeps
  if (what == "vertices_pulled") return (particles - held) * sheet_inner * substeps
  if (what == "ended_vertices") return (triangles != 0) * (particles - held) * substeps
  print "bound.awk: no count " what >"/dev/stderr"
  exit 2
}
function least(a, b) { return a < b ? a : b }
# contacts of elastic yarns act in each elastic step; they are a stage of their own there, too
function is_inner(stage, loop) { return stage == "yarn_stretch_run" && (loop == "slips" || loop == "spares") }
# only worlds with such yarns call these
function is_called(stage) {
  return !(stage == "yarn_stretch_run" && stretches == 0 || stage == "yarn_slip_apply" && yarns == 0)
}
function times(stage) {
  if (stage == "yarn_slip_apply" && stretches != 0) return substeps * inner_steps
  if (stage == "bodies_update_velocity" && stretches != 0) return substeps * (1 + inner_steps)
  if (stage == "bend_shear_apply" || stage == "contact_gather") return pulls
  return per[stage] == "substep" ? substeps : 1
}

$1 == "fixed" { fixed[$2] = $3; next }
$1 == "loop" { loops++; loop_stage[loops] = $2; loop_name[loops] = $3; loop_cost[loops] = $4; next }

$1 == "limits" {
  scene = $2
  order[++scenes] = scene
  substeps = $4; sweeps = $5; particles = $6; held = $7; link_batches = $11; spring_batches = $12
  free_bodies = $14; bodies = $13 + $14; planes = $15; cuts_max = $16
  drag = $18; damping = $19; keys = $20; held_projections = $21
  strong = $22; springs_held = $33; paths = $34; mirrored = $35; hands = $36
  cleared_bytes = $23; motion_bytes = $24
  yarns = $37; spares = $38; slips = $39; splits = $40; all_yarn = $41
  warps = $3; wefts = $42; stretches = $43; inner_steps = $44; crossings = $3 * $42; particles += spares
  all_inner = triangles != 0 ? sheet_inner : stretches != 0 ? inner_steps : 0
  pulls = stretches != 0 ? substeps : 1 # of bend and shear springs, and broad phases
  spring_batches *= pulls; springs_held *= pulls
  triangles = $45; sheet_inner = $46; folds = $47; cloths = $48; kind_changes = $49; limited = $50; constraints = $51; links = $8; overstretched = $52
  most["predictions"] = $25; most["projections"] = $26; most["springs"] = $27; most["contacts"] = $28
  contact_steps = (stretches != 0) * most["contacts"] # of elastic yarns in each elastic step
  if (stretches != 0) most["contacts"] /= inner_steps
  most["gathers"] = $29; most["tear_tests"] = $30; most["cuts"] = $32
  if (triangles != 0) most["tear_tests"] = most["cuts"] = 0 # those of rows
  depth = rises = 0
  for (room = 2; room <= cuts_max; room *= 2) { depth += room < cuts_max; rises += cuts_max - room + 1 }
  for (k = 1; k <= stage_count; k++) bound[scene, name[k]] = fixed[name[k]] * times(name[k]) * is_called(name[k])
  event_bound[scene] = 0
  for (k = 1; k <= stage_count; k++) if (event_kind[name[k]] == "fixed") event_bound[scene] += fixed[name[k]]
  for (k = 1; k <= loops; k++) {
    cost = loop_cost[k] * rounds(loop_name[k]) * !is_inner(loop_stage[k], loop_name[k]) * is_called(loop_stage[k])
    bound[scene, loop_stage[k]] += cost
    if (loop_name[k] == "contacts" || loop_name[k] == "cuts" || loop_name[k] ~ /_steps$/ && event_kind[loop_stage[k]] == "steps" || loop_name[k] == "splits")
      event_bound[scene] += cost
    if (loop_name[k] == "tear_tests") test_bound = cost
  }
  test_part[scene] = test_bound
  for (k = 1; k <= stage_count; k++) bound[scene] += bound[scene, name[k]]
  steps_of[scene] = substeps
  # an elastic step goes on behind these: their counts have that, too
  if (stretches != 0) bound[scene, "yarn_slip_apply"] += bound[scene, "yarn_stretch_run"]
  if (stretches != 0) bound[scene, "bodies_update_velocity"] += bound[scene, "yarn_stretch_run"]
}

