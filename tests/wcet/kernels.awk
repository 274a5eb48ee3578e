# SPDX-License-Identifier: Apache-2.0
# awk -f stages.awk -f kernels.awk SCALAR.joined WIDE.joined: instructions of intact ticks of hands_16 by stage, the
# mean, under the scalar code and under a wide kernel.
BEGIN { name[stage_count + 1] = hash_name }
FNR == 1 { file++ }
$1 == "tick" && $2 == "hands_16" && $4 == 0 {
  ticks[file]++
  split(substr($0, index($0, "|") + 2), part, " ")
  for (k = 1; k <= stage_count + 1; k++) sum[file, k] += part[k]
}
END {
  if (ticks[1] == 0 || ticks[1] != ticks[2]) { print "no ticks to compare"; exit 1 }
  printf "m55, hands_16, %d intact ticks:%11s %10s %7s\n", ticks[1], "scalar", "helium", "ratio"
  for (k = 1; k <= stage_count + 1; k++) {
    for (f = 1; f <= 2; f++) { mean[f] = sum[f, k] / ticks[f]; total[f] += mean[f] }
    if (mean[1] == 0 && mean[2] == 0) continue # not in this build
    printf "  %-24s %15.0f %10.0f %7.2f\n", name[k], mean[1], mean[2], mean[1] / mean[2]
  }
  printf "  %-24s %15.0f %10.0f %7.2f\n", "tick", total[1], total[2], total[1] / total[2]
}
