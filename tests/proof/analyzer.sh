#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# gcc -fanalyzer on rt and platform: no findings.
. tests/lib/suite.sh

work=$FRAY_BUILD/proof/analyzer
mkdir -p "$work"
suite_needs "gcc's analyzer" gcc gcc
count=0
for file in rt/*/*.c platform/loop.c platform/files/*.c platform/log/*.c platform/linux/*.c; do
  # A kernel that is one function takes minutes and 6 GB. As many functions it does not; but there the
  # analyzer loses what loops of three fill. What is not filled stops every build (-Wmaybe-uninitialized).
  case $file in
    rt/simd/*) many='-Dalways_inline=unused -Wno-analyzer-use-of-uninitialized-value' ;;
    *) many='' ;;
  esac
  # shellcheck disable=SC2086
  gcc -std=c11 -I. -O2 -fanalyzer $many -c "$file" -o "$work/out.o" 2>"$work/findings.txt" || true
  if [ ! -s "$work/findings.txt" ]; then pass; else fail "$file: $(head -n 6 "$work/findings.txt")"; fi
  count=$((count + 1))
done
printf '  gcc -fanalyzer: %d files\n' "$count"

printf '#include <stdlib.h>\nint f(void);\nint f(void) { int *p = malloc(4); *p = 1; return *p; }\n' >"$work/bad.c"
gcc -fanalyzer -c "$work/bad.c" -o "$work/out.o" 2>"$work/findings.txt" || true
if grep -q 'Wanalyzer' "$work/findings.txt"; then pass; else fail "the analyzer finds nothing in a leak"; fi
suite_end
