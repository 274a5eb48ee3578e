#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# run_suite.sh NAME COMMAND...: runs one suite; prints its line, or the output of a failing one. Its
# counts go to $RESULTS/counts, what it could not run to $RESULTS/not_run.
set -eu
name=$1
shift
log=$(mktemp "$RESULTS/log.XXXXXX")
said=$log.said
trap 'rm -f "$log" "$said"' EXIT

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
{
  printf '%-34s %6d passed %4d failed %5d s%s\n' "$name" "$good" "$bad" "$seconds" "$note"
  if [ "$bad" -ne 0 ]; then tail -n 60 "$log" | sed 's/^/    /'; else grep '^  [^ ]' "$log" || true; fi
} >"$said"

# suites that run side by side do not mix their lines
exec 9>"$RESULTS/lock"
flock 9
cat "$said"
echo "$good $bad" >>"$RESULTS/counts"
grep '^not run: ' "$log" >>"$RESULTS/not_run" || true
