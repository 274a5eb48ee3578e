#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# cppcheck.sh: cppcheck finds nothing in rt. PART=2/8: in the second of eight parts of its rooms.
. tests/lib/suite.sh

suite_needs 'cppcheck of rt' cppcheck cppcheck
work=$FRAY_BUILD/cppcheck # keeps what was found in files that have not changed, headers and all
mkdir -p "$work"
rooms=$(sh tests/part.sh share "${PART:-1/1}" rt/*/) || exit

# PATH...; shiftTooManyBitsSigned: fx_asr shifts values that are not negative, in both of its branches
finds_nothing() {
  cppcheck --cppcheck-build-dir="$work" -j "${JOBS:-2}" --quiet --std=c11 --enable=warning,performance,portability --inline-suppr -I. \
    --suppress=missingIncludeSystem --suppress=shiftTooManyBitsSigned --error-exitcode=1 "$@" 2>"$work/said.txt"
}
printf 'int past(void);\nint past(void) {\n  int a[2] = {0, 0};\n  return a[2];\n}\n' >"$work/bad.c"
refutes "cppcheck finds nothing in a bad file" finds_nothing "$work/bad.c"
# shellcheck disable=SC2086
if finds_nothing $rooms; then pass; else fail "cppcheck: $(cat "$work/said.txt")"; fi
suite_end
