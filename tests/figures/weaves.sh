#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# weaves.sh [SCENE TICKS]: tears a sheet in plain and in twill weave with SEEDS (20) seeds each, and prints
# how much each frays. Without a scene the ranges of the open weave's width must not meet. UPDATE=update writes the
# figures to tests/results.tsv.
. tests/lib/suite.sh

scene=${1:-tests/scenes/figures/weaves.scene}
ticks=${2:-450}
seeds=${SEEDS:-20}
work=${BUILD:-build}/weaves
mkdir -p "$work"

# WEAVE SEED: fray, width of the open weave
measure() {
  sed "s#^  weave .*#  weave $1#; s/^seed .*/seed $2/" "$scene" >"$work/weave.scene"
  "$FRAY" run "$work/weave.scene" --ticks "$ticks" >"$work/weave.txt" || return 1
  sed -n 's/^fray  *\([0-9.]*\) .* open \([0-9.]*\) cm wide$/\1 \2/p' "$work/weave.txt"
}

# COLUMN FILE: least, mean, most
range() {
  awk -v column="$1" '{ v = $column; sum += v; if (NR == 1 || v < least) least = v; if (v > most) most = v }
    END { printf "%.3f %.3f %.3f\n", least, sum / NR, most }' "$2"
}

printf '%s, %s ticks, %s seeds\n' "$scene" "$ticks" "$seeds"
printf '%-10s  %-32s  %s\n' weave 'loose ends, cm a cm of tear' 'open weave, cm wide'
for weave in plain 'twill 2/2'; do
  list=$work/$(echo "$weave" | tr -d ' /').txt
  : >"$list"
  seed=1
  while [ "$seed" -le "$seeds" ]; do
    measure "$weave" "$seed" >>"$list"
    seed=$((seed + 1))
  done
  if [ "$(grep -c . "$list")" -eq "$seeds" ]; then pass; else fail "$weave: a run has no measure"; fi
  printf '%-10s  %-32s  %s\n' "$weave" "$(range 1 "$list")" "$(range 2 "$list")"
  if [ "${UPDATE:-}" = update ]; then
    key=weaves.$(basename "$scene" .scene)_$(echo "$weave" | tr ' /' '__')
    sh tests/results.sh set "$key.loose_ends" "$(range 1 "$list")" cm/cm 'make weaves UPDATE=update'
    sh tests/results.sh set "$key.open" "$(range 2 "$list")" cm 'make weaves UPDATE=update'
  fi
done
if [ $# -eq 0 ]; then
  widest=$(range 2 "$work/plain.txt" | cut -d ' ' -f 3)
  narrowest=$(range 2 "$work/twill22.txt" | cut -d ' ' -f 1)
  holds "plain weave opens to $widest cm, twill from $narrowest cm on" \
    awk -v a="$widest" -v b="$narrowest" 'BEGIN { exit !(a < b) }'
fi
suite_end
