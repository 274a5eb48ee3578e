# SPDX-License-Identifier: Apache-2.0
# For other awk programs: stages.txt as arrays. name[k] is the k-th column, per[name], event_kind[name], unit_of[name] what
# stands beside it; stage_count columns have a bound, the hash is one more behind them.
BEGIN {
  stage_file = "tests/wcet/stages.txt"
  while ((getline stage_line < stage_file) > 0) {
    if (stage_line ~ /^#/ || split(stage_line, stage_part, " ") < 4) continue
    if (stage_part[2] == "step" && stage_count > 0) continue
    if (stage_part[2] == "hash") hash_name = stage_part[1]
    else name[++stage_count] = stage_part[1]
    per[stage_part[1]] = stage_part[2]
    event_kind[stage_part[1]] = stage_part[3]
    unit_of[stage_part[1]] = stage_part[4]
  }
  close(stage_file)
  if (stage_count == 0 || hash_name == "") { print "stages.awk: no stages in " stage_file >"/dev/stderr"; exit 2 }
}
