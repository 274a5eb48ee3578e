# SPDX-License-Identifier: Apache-2.0
# awk -v clock=HZ -v cycles=N -f bound.awk -f largest.awk MACHINE.bound LIMITS: of the hanging sheets
# RATE_WARPS in LIMITS, for each rate the largest whose bound fits into 80 % of a tick.
END {
  split("1000 500 240", rate, " ")
  for (r = 1; r <= 3; r++) {
    best = 0
    for (s = 1; s <= scenes; s++) {
      split(order[s], part, "_")
      if (part[1] == rate[r] && bound[order[s]] * cycles <= 0.8 * clock / rate[r] && part[2] > best) {
        best = part[2]
        steps = steps_of[order[s]]
      }
    }
    printf " %16s", (best > 0 ? best " x " best " (" steps ")" : "-")
  }
  printf "\n"
}
