#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The shape of the sources: includes point downwards and never in a circle, files of 600 lines at
# most, functions of 70, a licence line everywhere; cppcheck finds nothing in rt.
. tests/lib/suite.sh

work=$FRAY_BUILD/tidy
mkdir -p "$work"
find rt platform tools tests -name '*.[ch]' | sort >"$work/sources"

# floors: rt/fray.h 0, base 1, wire 2, model and wide 3, stage 4, run and share 5, platform 6, tools 7,
# tests 8
xargs awk '
  function floor(path) {
    if (path == "rt/fray.h") return 0
    if (path ~ /^rt\/base\//) return 1
    if (path ~ /^rt\/wire\//) return 2
    if (path ~ /^rt\/(model|wide)\//) return 3
    if (path ~ /^rt\/stage\//) return 4
    if (path ~ /^rt\/(run|share)\//) return 5
    if (path ~ /^platform\//) return 6
    if (path ~ /^tools\//) return 7
    if (path ~ /^tests\//) return 8
    return -1
  }
  /^#include "/ {
    split($2, part, "\"")
    target = part[2]
    if (floor(target) < 0) print FILENAME ":" FNR ": " target ", expected a path from the root of the project"
    else if (floor(target) > floor(FILENAME)) print FILENAME ":" FNR ": points upwards, to " target
    else if (floor(target) == 2 && floor(FILENAME) > 2 && floor(FILENAME) < 6) print FILENAME ":" FNR ": the world does not know the bus, " target
    print FILENAME, target >edges
  }' edges="$work/edges" <"$work/sources" >"$work/arrows"
if [ ! -s "$work/arrows" ]; then pass; else fail "arrows: $(cat "$work/arrows")"; fi
if tsort "$work/edges" >/dev/null 2>"$work/circle"; then pass; else fail "includes in a circle: $(cat "$work/circle")"; fi

long=$(xargs wc -l <"$work/sources" | awk '$2 != "total" && $1 > 600 { print $2 ": " $1 " lines, at most 600" }')
if [ -z "$long" ]; then pass; else fail "$long"; fi

# a function: a line at the margin opens it, its last line is `) {`, and `}` at the margin ends it
long=$(xargs awk '
  FNR == 1 { inside = 0; at = 0 }
  !inside && /^[A-Za-z_]/ { at = FNR; name = $0 }
  !inside && at && /\) \{$/ && name !~ /^(typedef|struct|enum|union|extern "C")/ { inside = 1 }
  /^}/ { if (inside && FNR - at + 1 > 70) print FILENAME ":" at ": " FNR - at + 1 " lines, at most 70"; inside = 0; at = 0 }
  ' <"$work/sources")
if [ -z "$long" ]; then pass; else fail "$long"; fi

bare=$(
  find rt platform tools tests linker .ci Makefile -type f \( -name '*.[chS]' -o -name '*.sh' -o -name '*.ld' \
    -o -name '*.scene' -o -name '*.hand' -o -name Makefile -o -name run \) | while read -r file; do
    head -n 3 "$file" | grep -q 'SPDX-License-Identifier: Apache-2.0' || echo "$file"
  done
)
if [ -z "$bare" ]; then pass; else fail "no SPDX line: $bare"; fi

# shiftTooManyBitsSigned: fx_asr shifts values that are not negative, in both of its branches
if have cppcheck; then
  if cppcheck -j "${JOBS:-2}" --quiet --std=c11 --enable=warning,performance,portability --inline-suppr -I. \
    --suppress=missingIncludeSystem --suppress=shiftTooManyBitsSigned --error-exitcode=1 rt 2>"$work/cppcheck"; then
    pass
  else
    fail "cppcheck: $(cat "$work/cppcheck")"
  fi
else
  not_run cppcheck cppcheck
fi
suite_end
