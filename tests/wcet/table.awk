# SPDX-License-Identifier: Apache-2.0
# awk -f stages.awk -f bound.awk -f table.awk MACHINE.bound MACHINE.joined: instructions of a tick on one machine,
# by scene, by stage and by unit, beside their bounds. Fails where a bound does not hold. Figures for the
# budgets go to budget_file: of units in tenths of an instruction.
$1 == "tick" || $1 == "storm" {
  at = 0
  total = 0
  for (k = 1; k <= NF; k++) if ($k == "|") at = k
  for (k = at + 1; k <= NF; k++) total += $k
  phase = $1 == "storm" ? "storm" : ($4 == 0 ? "intact" : "torn")
  n = ++count[scene, phase]
  value[scene, phase, n] = total
  line[scene, phase, n] = substr($0, index($0, "|") + 2)
  w = $5 " " $6 " " $7 " " $8 " " $9 " " $10 " " $11 " " $12 " " $13 " " $14 " " $15
  work[scene, phase, n] = w
}
$1 == "bend" || $1 == "shear" {
  spring_total[$1, scene] = 0
  for (k = 5; k <= NF; k++) spring_total[$1, scene] += $k
  spring_rows[$1, scene] = $3
}
$1 == "BAD" { print; bad = 1 }

# the place of the median (share 0.5) or the worst (share 1)
function place(scene, phase, share,    n, i, j, t, index_of) {
  n = count[scene, phase]
  if (n == 0) return 0
  for (i = 1; i <= n; i++) index_of[i] = i
  for (i = 2; i <= n; i++)
    for (j = i; j > 1 && value[scene, phase, index_of[j]] < value[scene, phase, index_of[j - 1]]; j--) {
      t = index_of[j]; index_of[j] = index_of[j - 1]; index_of[j - 1] = t
    }
  i = int(n * share + 0.999999)
  return index_of[i < 1 ? 1 : i]
}
function stage_of(scene, phase, n, k,    part) {
  split(line[scene, phase, n], part, " ")
  return part[k] + (k == stage_count ? part[k + 1] : 0) # the hash is the report's
}
# by all stages of a unit
function spent_on(scene, phase, n, unit,    k, sum) {
  for (k = 1; k <= stage_count; k++) if (unit_of[name[k]] == unit) sum += stage_of(scene, phase, n, k)
  return sum
}
function counted(scene, phase, n, k,    part) {
  split(work[scene, phase, n], part, " ")
  return part[k]
}
function kilo(v) { return v == 0 ? "-" : sprintf("%.1f", v / 1000) }
function budget(what, v) { printf "work.%s.%s %d %s\n", machine, what, int(v + 0.5), compiler >budget_file }

END {
  if (bad) exit 1
  printf "%s: thousands of instructions a tick\n", machine
  printf "  %-10s %8s %8s %8s %8s %8s %8s %8s %7s %7s\n", "scene", "substeps", "intact", "worst", "torn", "worst", "storm", "bound", "ratio", "events"
  for (s = 1; s <= scenes; s++) {
    c = order[s]
    for (p = 1; p <= 3; p++) {
      ph = p == 1 ? "intact" : (p == 2 ? "torn" : "storm")
      m[ph] = place(c, ph, 0.5); wst[ph] = place(c, ph, 1)
      med[ph] = m[ph] ? value[c, ph, m[ph]] : 0
      top[ph] = wst[ph] ? value[c, ph, wst[ph]] : 0
    }
    worst = top["intact"]; if (top["torn"] > worst) worst = top["torn"]; if (top["storm"] > worst) worst = top["storm"]
    plain = spent_on(c, "intact", m["intact"], "tear_test")
    events = event_bound[c] + test_part[c] - plain
    printf "  %-10s %8d %8s %8s %8s %8s %8s %8s %7.2f %6.1f%%\n", c, steps_of[c], kilo(med["intact"]), kilo(top["intact"]), kilo(med["torn"]), kilo(top["torn"]), kilo(top["storm"]), kilo(bound[c]), bound[c] / worst, 100 * events / bound[c]
    budget(c ".median", med["intact"])
    budget(c ".worst", worst)
    budget(c ".bound", bound[c])
    budget(c ".ratio_percent", 100 * bound[c] / worst)
    budget(c ".events_percent", 100 * events / bound[c])
    if (bound[c] < worst) { print "  FAILED " c ": the bound is below what was observed"; bad = 1 }
    for (k = 1; k <= stage_count; k++)
      for (p = 1; p <= 3; p++) {
        ph = p == 1 ? "intact" : (p == 2 ? "torn" : "storm")
        took = wst[ph] ? stage_of(c, ph, wst[ph], k) : 0
        if (took > bound[c, name[k]]) {
          print "  FAILED " c ": " name[k] " took " took ", bound " bound[c, name[k]]
          bad = 1
        }
      }
  }
  c = shown
  printf "  by stage, %s:\n  %-16s %10s %10s %10s %10s %10s\n", c, "", "intact", "torn", "worst tick", "storm", "bound"
  mi = place(c, "intact", 0.5); mt = place(c, "torn", 0.5); wi = place(c, "intact", 1); wt = place(c, "torn", 1); st = place(c, "storm", 1)
  ph = value[c, "torn", wt] > value[c, "intact", wi] ? "torn" : "intact"
  wx = ph == "torn" ? wt : wi
  for (k = 1; k <= stage_count; k++)
    printf "  %-16s %10d %10d %10d %10d %10d\n", name[k], stage_of(c, "intact", mi, k), stage_of(c, "torn", mt, k), stage_of(c, ph, wx, k), stage_of(c, "storm", st, k), bound[c, name[k]]
  # units: intact median of the scene that is shown; contacts where they were most
  u = counted(c, "intact", mi, 2); units["projection"] = spent_on(c, "intact", mi, "projection") / u
  u = counted(c, "intact", mi, 1)
  units["predicted"] = spent_on(c, "intact", mi, "predicted") / u
  units["finished"] = spent_on("hang_16", "intact", place("hang_16", "intact", 0.5), "finished") / counted("hang_16", "intact", place("hang_16", "intact", 0.5), 1)
  units["tear_test"] = spent_on(c, "intact", mi, "tear_test") / counted(c, "intact", mi, 6)
  units["contact"] = (spent_on(c, "storm", st, "contact") + spent_on(c, "storm", st, "finished") - units["finished"] * counted(c, "storm", st, 1)) / counted(c, "storm", st, 4)
  split(line[c, "intact", mi], part, " ")
  units["hash_word"] = part[stage_count + 1] / (9 * 256 + 40 + 36)
  units["bend"] = spring_total["bend", c] / spring_rows["bend", c]
  units["shear"] = spring_total["shear", c] / spring_rows["shear", c]
  units["over"] = (spent_on(c, "storm", st, "tear_test") - spent_on(c, "intact", mi, "tear_test")) / counted(c, "storm", st, 7)
  printf "  a unit:"
  list = "projection predicted finished bend shear tear_test over contact hash_word"
  n = split(list, each, " ")
  for (k = 1; k <= n; k++) { printf " %s %.1f", each[k], units[each[k]]; budget("unit." each[k] ".tenths", 10 * units[each[k]]) }
  printf "\n"
  exit bad
}
