# SPDX-License-Identifier: Apache-2.0
# awk -v clock=HZ -v cycles=N -v kind=bound|intact -f stages.awk -f bound.awk -f largest.awk MACHINE.bound
# MACHINE.budget LIMITS: of the hanging sheets RATE_WARPS in LIMITS, for each rate the largest whose
# tick fits into 80 % of its time: by its bound, or an intact one by the measured units.
/^work\./ { n = split($1, part, "."); if (part[3] == "unit") unit[part[4]] = $2 / 10; next }
$1 == "limits" {
  sheet = $2
  cost = most["predictions"] * (unit["predicted"] + unit["finished"])
  cost += most["projections"] * unit["projection"] + $9 * unit["bend"] + $10 * unit["shear"]
  cost += most["tear_tests"] * unit["tear_test"] + (9 * particles + 40) * unit["hash_word"]
  intact[sheet] = cost + (drag ? 3 * 14 * (particles - held) : 0)
}
END {
  split("1000 500 240", rate, " ")
  for (r = 1; r <= 3; r++) {
    best = 0
    for (s = 1; s <= scenes; s++) {
      split(order[s], part, "_")
      cost = kind == "bound" ? bound[order[s]] : intact[order[s]]
      if (part[1] != rate[r] || cost * cycles > 0.8 * clock / rate[r] || part[2] + 0 <= best) continue
      best = part[2] + 0
      steps = steps_of[order[s]]
    }
    printf " %14s", (best > 0 ? best " x " best " (" steps ")" : "-")
  }
  printf "\n"
}
