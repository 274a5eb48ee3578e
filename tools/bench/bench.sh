#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# bench.sh [OUT]: every scene through `fray bench`; OUT/bench.json has all figures, OUT/bench.md the
# tables of the README. TICKS=N cuts every scene short, to try the script.
set -eu
FRAY=${FRAY:-build/fray}
out=${1:-out}
parts=$out/bench
mkdir -p "$parts"
rm -f "$parts"/*.json "$parts/rows"

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

rows() { sed -n "s/^$1 //p" "$parts/rows"; }
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
} >"$out/bench.md"
echo "$out/bench.json, $out/bench.md"
