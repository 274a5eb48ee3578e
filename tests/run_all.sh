#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# run_all.sh PROGRAM...: runs the test programs, then the shell suites that SUITES names. One line a
# suite as it goes; the output of a failing one; last one line `N passed, N failed`.
set -eu
SUITES=${SUITES:-tidy cli workers hashes images symbols stack size budget_rules cmac_constant dbc_readers consumer}
FRAY_BUILD=${BUILD:-build}
FRAY=${FRAY:-$FRAY_BUILD/fray}
export FRAY FRAY_BUILD
mkdir -p "$FRAY_BUILD/tests"
log=$FRAY_BUILD/tests/last.txt
missing=$FRAY_BUILD/tests/not_run.txt
: >"$missing"
passed=0
failed=0

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

# NAME COMMAND...
run_suite() {
  name=$1
  shift
  began=$(date +%s)
  code=0
  "$@" >"$log" 2>&1 || code=$?
  seconds=$(($(date +%s) - began))
  line=$(grep -E '^[0-9]+ passed, [0-9]+ failed$' "$log" | tail -n 1) || line=''
  good=$(echo "$line" | sed 's/ passed.*//')
  bad=$(echo "$line" | sed 's/.*, \([0-9]*\) failed/\1/')
  note=''
  if [ -z "$line" ]; then
    good=0 bad=1 note=" (no result line, exit $code)"
  elif [ "$code" -ne 0 ] && [ "$bad" -eq 0 ]; then
    bad=1 note=" (exit $code)"
  fi
  passed=$((passed + good))
  failed=$((failed + bad))
  printf '%-34s %6d passed %4d failed %5d s%s\n' "$name" "$good" "$bad" "$seconds" "$note"
  if [ "$bad" -ne 0 ]; then tail -n 60 "$log" | sed 's/^/    /'; else grep '^  [^ ]' "$log" || true; fi
  grep '^not run: ' "$log" >>"$missing" || true
}

for program in "$@"; do run_suite "${program#"$FRAY_BUILD"/}" "./${program#./}"; done
for suite in $SUITES; do run_suite "$suite" sh "$(script_of "$suite")"; done
cat "$missing"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
