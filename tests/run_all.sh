#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# run_all.sh PROGRAM...: runs the shell suites that SUITES names and the test programs, JOBS at a time; suites that
# share builds one after the other, and these begin first. A line a suite as it ends; the output of a failing one;
# last one line `N passed, N failed`. Tables of hashes, images, symbols, code, stack and cppcheck run in parts: PART,
# or one that the commit chooses; PART=1/1 runs them whole.
set -eu
SUITES=${SUITES:-tidy cppcheck cli workers hashes images symbols stack size budget_rules cmac_constant dbc_readers other_logs install docs adding parts wild}
FRAY_BUILD=${BUILD:-build}
FRAY=${FRAY:-$FRAY_BUILD/fray}
RESULTS=$FRAY_BUILD/tests/results
export FRAY FRAY_BUILD RESULTS
PART=${PART:-$(sh tests/part.sh choose - "$(git rev-parse HEAD 2>/dev/null || echo 0)")/4}
export PART
rm -rf "$RESULTS"
mkdir -p "$RESULTS"
: >"$RESULTS/not_run"
: >"$RESULTS/counts"

script_of() {
  for script in "tests/$1.sh" "tests/$1/$1.sh" "tests/determinism/$1.sh" "tests/budget/$1.sh" "tests/proof/$1.sh" "tests/bus/$1.sh"; do
    if [ -f "$script" ]; then
      echo "$script"
      return
    fi
  done
  echo "tests/run_all.sh: no suite '$1'" >&2
  exit 2
}

# The suites of WORDS that are asked for: a line, NAME SCRIPT of each
chain() {
  for suite; do
    case " $SUITES " in *" $suite "*) ;; *) continue ;; esac
    script=$(script_of "$suite") || exit
    printf '%s %s ' "$suite" "$script"
  done
  echo
}
chains() {
  chain hashes images symbols
  chain stack size
  chain install docs
  for suite in $SUITES; do
    case $suite in hashes | images | symbols | stack | size | install | docs) ;; *) chain "$suite" ;; esac
  done
  for program; do echo "${program#"$FRAY_BUILD"/} ./${program#./}"; done | sort # physics first, the longest
}
chains "$@" >"$RESULTS/chains"
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
