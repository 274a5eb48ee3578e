#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs PROOFS, JOBS at a time, the long ones first; a proof's lines come when it has ended. Last line
# `N passed, N failed`, summed.
set -eu
out=${BUILD:-build}/proof
parts=${PROOFS:-misra eva analyzer warnings}
mkdir -p "$out"
rm -f "$out"/*.said "$out"/*.txt

# shellcheck disable=SC2086
printf '%s\n' $parts | xargs -P "${JOBS:-2}" -I PART sh -c '
  began=$(date +%s)
  code=0
  sh "tests/proof/$1.sh" >"$2/$1.txt" 2>&1 || code=$?
  { echo "== $1"; cat "$2/$1.txt"; echo "== $1: exit $code, $(($(date +%s) - began)) s"; } >"$2/$1.said"
  cat "$2/$1.said"' one PART "$out"

passed=0
failed=0
for part in $parts; do
  line=$(grep -E '^[0-9]+ passed, [0-9]+ failed$' "$out/$part.txt" | tail -n 1)
  line=${line:-0 passed, 1 failed}
  passed=$((passed + ${line%% *}))
  bad=${line##*, }
  bad=${bad%% *}
  if [ "$bad" -eq 0 ] && ! grep -q "^== $part: exit 0," "$out/$part.said"; then bad=1; fi
  failed=$((failed + bad))
done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
