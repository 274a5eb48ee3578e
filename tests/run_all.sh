#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# run_all.sh PROGRAM...: runs the test programs, JOBS at a time, then the shell suites that SUITES names,
# one by one: they share builds. A line a suite as it ends; the output of a failing one; last one line
# `N passed, N failed`.
set -eu
SUITES=${SUITES:-tidy cli workers hashes images symbols stack size budget_rules cmac_constant dbc_readers consumer}
FRAY_BUILD=${BUILD:-build}
FRAY=${FRAY:-$FRAY_BUILD/fray}
RESULTS=$FRAY_BUILD/tests/results
export FRAY FRAY_BUILD RESULTS
rm -rf "$RESULTS"
mkdir -p "$RESULTS"
: >"$RESULTS/not_run"
: >"$RESULTS/counts"

script_of() {
  for script in "tests/$1.sh" "tests/$1/$1.sh" "tests/cross/$1.sh" "tests/bus/$1.sh"; do
    if [ -f "$script" ]; then
      echo "$script"
      return
    fi
  done
  echo "tests/run_all.sh: no suite '$1'" >&2
  exit 2
}

suites=0
[ $# -eq 0 ] || printf '%s\n' "$@" | xargs -P "${JOBS:-2}" -I PROGRAM sh -c '
  sh tests/run_suite.sh "${1#"$FRAY_BUILD"/}" "./${1#./}"' one PROGRAM || true
for suite in $SUITES; do
  script=$(script_of "$suite")
  sh tests/run_suite.sh "$suite" sh "$script"
  suites=$((suites + 1))
done
cat "$RESULTS/not_run"
awk -v asked=$(($# + suites)) '
  { good += $1; bad += $2 }
  END { bad += asked - NR; printf "%d passed, %d failed\n", good, bad; exit bad != 0 }' "$RESULTS/counts"
