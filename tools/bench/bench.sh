#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# bench.sh [OUT [update]]: every scene through `fray bench`; OUT/bench.json has all figures, OUT/bench.md
# tables; `update` writes those of the pages to tests/results.tsv. TICKS=N cuts every scene short, to try the script.
set -eu
FRAY=${FRAY:-build/fray}
out=${1:-out}
parts=$out/bench
mkdir -p "$parts"
rm -f "$parts"/*.json "$parts/rows" "$parts/tearing"

bench() { # NAME ARGUMENT...
  name=$1
  shift
  "$FRAY" bench "$@" --json "$parts/$name.json" --rows "$parts/rows"
}
scene() { # NAME TICKS [LOG]
  bench "$1" "tests/scenes/$1.scene" --ticks "${TICKS:-$2}" ${3:+--log "$3"}
}

bench 0_sheets --ticks "${TICKS:-200}"
scene two_hands 5000 tests/scenes/two_hands.log
scene corner_load 1300
scene thrown_ball 600
scene bars_apart 1300
scene cube 600
scene mirror 1000
scene weight 1000
scene small 1000
bench 9_sweep --sweep
# the parts of a tick of sheets that two hands tear, in a table of their own
for name in cloth banknote; do
  file=tests/scenes/haptics/$name
  "$FRAY" bench "$file.scene" --log "$file.log" --ticks "${TICKS:-1800}" --json "$parts/8_$name.json" --rows "$parts/tearing"
done

{
  echo '['
  first=1
  for part in "$parts"/*.json; do
    [ $first = 1 ] || echo ','
    first=0
    cat "$part"
  done
  echo ']'
} >"$out/bench.json"

rows() { sed -n "s/^$1 //p" "${2:-$parts/rows}"; }
{
  "$FRAY" bench --machine
  echo
  echo '| scene | substeps | kernel | us a tick | x real time | strain | springs | predict, finish | contacts | tear, cut | rest |'
  echo '|---|---|---|---|---|---|---|---|---|---|---|'
  rows tick
  echo
  echo 'Nanoseconds a projection; in brackets the ratios to the two AVX2 float loops, by ids and in runs:'
  echo
  echo '| scene | rows | float plain | coloured | AVX2 by ids | AVX2 in runs | scalar | avx2 | avx512 | neon |'
  echo '|---|---|---|---|---|---|---|---|---|---|'
  rows projection
  echo
  rows line | sed 's/^/Hanging sheets, 4 substeps, kernel /'
  echo
  echo '| crossings | us a tick | ns a crossing | bytes a crossing | and in the image |'
  echo '|---|---|---|---|---|'
  rows sweep
  echo
  echo 'Sheets that two hands tear, milliseconds a tick, mean and in brackets the worst:'
  echo
  echo '| scene | phase | kernel | collision | deformation | tearing | rest | total |'
  echo '|---|---|---|---|---|---|---|---|'
  rows tearing "$parts/tearing" | sed 's/, \([a-z ]*\) | \([a-z0-9]*\) |/ | \1 | \2 |/'
} >"$out/bench.md"
echo "$out/bench.json, $out/bench.md"

# `update`: the figures of the pages
[ "${2:-}" = update ] || exit 0
set_figure() { sh tests/results.sh set "$1" "$2" "$3" 'make bench UPDATE=update'; }
key_of() { echo "$1" | sed 's/^ *//; s/ *$//; s/, [0-9]* x [0-9]*$//; s/^sheet /hanging /; s/ /_/g'; }
rows tick | while IFS='|' read -r _ scene substeps kernel _ times _; do
  key=bench.$(key_of "$scene")
  set_figure "$key.substeps" "$(echo "$substeps" | tr -d ' ')" ''
  set_figure "$key.$(echo "$kernel" | tr -d ' ')" "$(echo "$times" | tr -d ' ')" 'x real time'
done
rows projection | while IFS='|' read -r _ scene _ _ _ _ _ scalar avx2 avx512 _; do
  case $scene in *'long runs'*) continue ;; esac
  key=bench.$(key_of "$scene")
  # each column: ns (ratio by ids, ratio in runs); the last kernel that ran has the ratios
  for kernel in scalar avx2 avx512; do
    eval "column=\$$kernel"
    # shellcheck disable=SC2086,SC2154
    set -- $(echo "$column" | tr -d '(),')
    [ "${1:--}" != - ] || continue
    set_figure "$key.ns.$kernel" "$1" ns
    [ $# -lt 3 ] || { set_figure "$key.by_ids" "$2" ''; set_figure "$key.in_runs" "$3" ''; }
  done
done
sed -n 's/^line [a-z0-9]*: \([0-9.]*\) ns.*R2 \([0-9.]*\)$/\1 \2/p' "$parts/rows" | tail -n 1 | while read -r ns r2; do
  set_figure bench.growth.ns_a_crossing_and_tick_1k_to_250k_crossings.value "$ns" ns
  set_figure bench.growth.r2_of_the_line.value "$r2" ''
done
