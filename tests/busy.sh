#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# busy.sh [GOAL|NAME=VALUE...]: runs goals of make, one after the other, beside BUSY (20) processes that never rest, at
# their own niceness; TIMES=3 in a row. `make busy GOALS="bus-test target-test"`. A line a goal; what failed is kept in
# build/busy. Last line `N passed, N failed`, summed.
set -eu
BUILD=${BUILD:-build}
[ $# -gt 0 ] || set -- test can-test target-test bus-test bus-test-qemu
out=$BUILD/busy
mkdir -p "$out"
busy=''
passed=0
failed=0
end() {
  # shellcheck disable=SC2086
  [ -z "$busy" ] || kill $busy 2>/dev/null || true
  busy=''
}
trap end EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

goals='' variables=''
for word; do
  case $word in *=*) variables="$variables $word" ;; *) goals="$goals $word" ;; esac
done
# shellcheck disable=SC2086
${MAKE_COMMAND:-make} $variables programs >"$out/build.txt" 2>&1 || { tail -n 20 "$out/build.txt"; exit 1; }
n=0
while [ $n -lt "${BUSY:-20}" ]; do
  # in the session of the suites, since the kernel gives each session (autogroup) the same share; it ends with
  # this script, however that ends
  sh -c 'while kill -0 "$1" 2>/dev/null; do :; done' busy $$ &
  busy="$busy $!"
  n=$((n + 1))
done
n=0
while [ $n -lt "${TIMES:-1}" ]; do
  n=$((n + 1))
  for goal in $goals; do
    log=$out/$goal.$n.txt
    began=$(date +%s) code=0
    # shellcheck disable=SC2086
    ${MAKE_COMMAND:-make} $variables "$goal" >"$log" 2>&1 || code=$?
    line=$(grep -E '^[0-9]+ passed, [0-9]+ failed$' "$log" | tail -n 1) || line=''
    good=0 bad=1
    [ -z "$line" ] || good=${line%% passed*} bad=${line##*, }
    bad=${bad%% failed}
    if [ "$code" -ne 0 ] && [ "$bad" -eq 0 ]; then bad=1; fi
    printf '%d: %-16s %5d passed %4d failed %6d s\n' $n "$goal" "$good" "$bad" $(($(date +%s) - began))
    grep -a '^ *FAILED' "$log" || true
    if [ "$bad" -eq 0 ]; then rm "$log"; else echo "    kept in $log"; fi
    passed=$((passed + good))
    failed=$((failed + bad))
  done
done
end
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
