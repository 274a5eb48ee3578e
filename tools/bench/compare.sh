#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# compare.sh BASE [SCENE...]: this commit beside the commit BASE. Seconds of `make run` in fresh clones of both,
# then each scene's time of a tick, in RUNS (7) alternating runs of TICKS (300) ticks: the ratio of the medians.
# Without SCENE: all scenes of both with one name in tests/scenes. KERNEL picks one; the fastest is the default.
set -eu
base=${1:?compare.sh BASE [SCENE...]}
shift
here=$PWD
work=${BUILD:-build}/compare
git rev-parse -q --verify "$base^{commit}" >/dev/null || { echo "compare.sh: no commit $base" >&2; exit 2; }
rm -rf "$work"
mkdir -p "$work"
work=$(cd "$work" && pwd)
for side in base head; do
  git clone -q "$here" "$work/$side"
done
git -C "$work/base" checkout -q --detach "$base"

seconds() { # SIDE: of `make run` from nothing
  from=$(date +%s)
  make -C "$work/$1" run >"$work/$1.log" 2>&1 || { tail -n 5 "$work/$1.log" >&2; exit 1; }
  echo $(($(date +%s) - from))
}
before=$(seconds base)
after=$(seconds head)
echo "make run in a fresh clone: $before s before, $after s now"

tick() { # SIDE SCENE: microseconds of a tick, appended to SIDE.SCENE
  log=tests/scenes/$2.log
  rm -f "$work/rows"
  (
    cd "$work/$1"
    [ -f "$log" ] || log=
    build/fray bench "tests/scenes/$2.scene" ${log:+--log "$log"} ${KERNEL:+--kernel "$KERNEL"} \
      --workers 1 --ticks "${TICKS:-300}" --rows "$work/rows"
  ) >/dev/null
  sed -n 's/^tick //p' "$work/rows" | awk -F '|' 'NR == 1 || $5 < least { least = $5 } END { print least + 0 }' \
    >>"$work/$1.$2"
}
median() { sort -n "$1" | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }

if [ $# -eq 0 ]; then
  for f in tests/scenes/*.scene; do
    if [ -f "$work/base/$f" ]; then set -- "$@" "$(basename "$f" .scene)"; fi
  done
fi
printf '%-20s %10s %10s %7s\n' scene 'us before' 'us now' ratio
for scene; do
  run=0
  while [ $run -lt "${RUNS:-7}" ]; do
    tick base "$scene"
    tick head "$scene"
    run=$((run + 1))
  done
  printf '%s %s %s\n' "$scene" "$(median "$work/base.$scene")" "$(median "$work/head.$scene")" |
    awk '{ printf "%-20s %10.1f %10.1f %7.3f\n", $1, $2, $3, $3 / $2 }'
done
