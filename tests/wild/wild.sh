#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# wild.sh: a few short random scenes, judged by what holds of every world today: hashes by kernel, by workers, saved
# and opened, and a ledger that closes.
. tests/lib/suite.sh
suite_make BUILD="$FRAY_BUILD" "$FRAY_BUILD/tests/wild/wild"

for seed in 1 2; do
  if "$FRAY_BUILD/tests/wild/wild" "$seed" 10 0.15 short; then pass; else fail "random scenes of seed $seed"; fi
done
suite_end
