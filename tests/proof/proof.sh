#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs the proofs one after another; last line `N passed, N failed`, summed.
set -eu
build=${BUILD:-build}
mkdir -p "$build/proof"
passed=0
failed=0
for part in warnings analyzer misra eva; do
  began=$(date +%s)
  echo "== $part"
  code=0
  sh "tests/proof/$part.sh" >"$build/proof/$part.txt" 2>&1 || code=$?
  cat "$build/proof/$part.txt"
  line=$(grep -E '^[0-9]+ passed, [0-9]+ failed$' "$build/proof/$part.txt" | tail -n 1) || line='0 passed, 1 failed'
  passed=$((passed + ${line%% *}))
  bad=${line##*, }
  bad=${bad%% *}
  if [ "$code" -ne 0 ] && [ "$bad" -eq 0 ]; then bad=1; fi
  failed=$((failed + bad))
  echo "== $part: $line, $(($(date +%s) - began)) s"
done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
