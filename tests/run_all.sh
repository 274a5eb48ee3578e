#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# run_all.sh PROGRAM...: runs the shell suites that SUITES names and the test programs, JOBS at a time; suites that
# share builds one after the other, and these begin first. A line a suite as it ends; the output of a failing one;
# last one line `N passed, N failed`. Tables of hashes, images, symbols, code, stack and cppcheck, and some long suites,
# run in parts: PART, or one that the commit chooses; PART=1/1 runs all.
set -eu
FRAY_BUILD=${BUILD:-build}
FRAY=${FRAY:-$FRAY_BUILD/fray}
RESULTS=$FRAY_BUILD/tests/results
export FRAY FRAY_BUILD RESULTS
PART=${PART:-$(sh tests/part.sh choose - "$(git rev-parse HEAD 2>/dev/null || echo 0)")/8}
export PART
rm -rf "$RESULTS"
mkdir -p "$RESULTS"
: >"$RESULTS/not_run"
: >"$RESULTS/counts"

sh tests/chains.sh "$@" >"$RESULTS/chains"
asked=$(wc -w <"$RESULTS/chains")
grep . "$RESULTS/chains" | xargs -P "${JOBS:-2}" -I CHAIN sh -c '
  set -- $1
  while [ $# -gt 0 ]; do
    case $2 in *.sh) sh tests/run_suite.sh "$1" sh "$2" ;; *) sh tests/run_suite.sh "$1" "$2" ;; esac
    shift 2
  done' one CHAIN || true
cat "$RESULTS/not_run"
awk -v asked=$((asked / 2)) '
  { good += $1; bad += $2 }
  END { bad += asked - NR; printf "%d passed, %d failed\n", good, bad; exit bad != 0 }' "$RESULTS/counts"
