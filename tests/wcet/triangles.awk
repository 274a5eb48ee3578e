# SPDX-License-Identifier: Apache-2.0
# awk -f stages.awk -f bound.awk -f triangles.awk X.bound X.joined: the most that each stage of a membrane took in a
# tick, beside its bound. Fails where a bound does not hold, and where nothing tore.
$1 == "tick" || $1 == "storm" {
  for (k = 1; k <= NF; k++) if ($k == "|") at = k
  total = 0
  for (k = 1; k <= stage_count; k++) {
    took = $(at + k) + (k == stage_count ? $(at + k + 1) : 0) # the hash is the report's
    total += took
    if (took > most_taken[k]) most_taken[k] = took
  }
  if (total > worst) worst = total
  if ($4 != 0) torn++
}
$1 == "BAD" { print; bad = 1 }
END {
  printf "  membrane, m3, instructions: %-14s %10s %10s\n", "", "worst tick", "bound"
  for (k = 1; k <= stage_count; k++) {
    printf "  %-47s %10d %10d\n", name[k], most_taken[k], bound[scene, name[k]]
    if (most_taken[k] > bound[scene, name[k]]) { print "  FAILED " name[k] ": above its bound"; bad = 1 }
  }
  printf "  %-47s %10d %10d, %d ticks torn\n", "tick", worst, bound[scene], torn
  exit bad || torn == 0
}
