#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# weaves.sh [SCENE TICKS]: tears a sheet of four weaves with SEEDS (20) seeds each, with and without the paper's rule
# (`spread_splits`), and prints how much each frays. Without the rule means must be in the order of the weaves, and
# of plain weave and satin not even the intervals of the means, at 95 %, may meet. UPDATE=update writes the figures to
# tests/results.tsv.
. tests/lib/suite.sh

seeds=${SEEDS:-20}
work=${BUILD:-build}/weaves
mkdir -p "$work"

# SCENE TICKS RULE WEAVE FILE: a line a seed
measure() {
  seed=1
  while [ "$seed" -le "$seeds" ]; do
    sed "s#^  weave .*#  weave $4#; s#^  yarns on#&\n  spread_splits $3#; s/^seed .*/seed $seed/" "$1" >"$work/weave.scene"
    "$FRAY" run "$work/weave.scene" --ticks "$2" >"$work/weave.txt" || return 1
    sed -n 's/^fray  *\([0-9.]*\) .*/\1/p' "$work/weave.txt"
    seed=$((seed + 1))
  done >"$5"
}

# FILE: mean, half the interval of the mean at 95 %
interval() {
  awk '{ sum += $1; squares += $1 * $1 }
    END { mean = sum / NR; v = NR > 1 ? (squares - NR * mean * mean) / (NR - 1) : 0
          printf "%.3f %.3f\n", mean, 1.96 * sqrt((v > 0 ? v : 0) / NR) }' "$1"
}

# SCENE TICKS RULE
compare() {
  name=$(basename "$1" .scene)
  line=''
  list=$work/$name.$3.txt
  : >"$list"
  for weave in plain 'twill 2/1' 'twill 3/1' 'satin 8'; do
    measure "$1" "$2" "$3" "$weave" "$work/seeds.txt" || true
    if [ "$(grep -c . "$work/seeds.txt")" -eq "$seeds" ]; then pass; else fail "$name, $weave: a run has no measure"; fi
    interval "$work/seeds.txt" >>"$list"
    found=$(tail -n 1 "$list")
    line="$line$(printf '%14s' "${found% *} +-${found#* }")"
    [ "${UPDATE:-}" != update ] || sh tests/results.sh set "weaves.${name}_$(echo "$weave" | tr ' /' '__').$3" \
      "$(echo "$found" | sed 's/ / +- /')" cm/cm 'make weaves UPDATE=update'
  done
  printf '%-16s %-4s %s\n' "$name" "$3" "$line"
}

printf 'cm of loose ends a cm of tear, %s seeds: mean, 95 %% of the mean\n' "$seeds"
printf '%-16s %-4s %14s%14s%14s%14s\n' scene rule plain 'twill 2/1' 'twill 3/1' 'satin 8'
if [ $# -gt 0 ]; then set -- "$1 ${2:-450}"; else
  set -- 'tests/scenes/strip.scene 600' 'tests/scenes/figures/figure7_plain.scene 450' 'tests/scenes/figures/figure11c.scene 450'
fi
for run; do
  compare "${run% *}" "${run#* }" off
  holds "$name: without the rule means are in order" \
    awk 'NR > 1 && $1 < last { bad = 1 } { last = $1 } END { exit bad }' "$list"
  holds "$name: intervals of plain weave and satin are apart" \
    awk 'NR == 1 { end = $1 + $2 } NR == 4 { exit !(end < $1 - $2) }' "$list"
  compare "${run% *}" "${run#* }" on
done
suite_end
