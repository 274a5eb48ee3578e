#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# adding.sh: rt/ADDING.md is right about rigid shapes. puck.patch adds one, a puck, to a copy of the tree: it changes the
# files that the page's table names and no other. With any one of them missed the copy must not build, or fail
# test_puck.c; with all of them it must pass, and `fray info` name the shape.
. tests/lib/suite.sh

case $FRAY_BUILD in /*) work=$FRAY_BUILD/adding ;; *) work=$PWD/$FRAY_BUILD/adding ;; esac
copy=$work/copy
rm -rf "$work"
mkdir -p "$copy/tests/unit" "$copy/build"
cp -R rt platform tools Makefile "$copy"
cp -R tests/lib tests/adding "$copy/tests"
cp tests/adding/test_puck.c "$copy/tests/unit"
# what this build has compiled: make compiles what includes a changed file, and no more
(cd "$FRAY_BUILD" && find rt tools platform -name '*.[od]' -exec cp --parents -t "$copy/build" {} +)

listed=$(sed -n '/^## A rigid shape/,/^## A spring/s/^| `\([^`]*\)` |.*/\1/p' rt/ADDING.md)
changed=$(sed -n 's/^+++ b\///p' tests/adding/puck.patch)
if [ "$(echo "$listed" | sort)" = "$(echo "$changed" | sort)" ]; then pass; else
  fail "rt/ADDING.md lists $(echo $listed), a shape changes $(echo $changed)"
fi

add() { # FILE: its part of the patch
  awk -v file="a/$1" '/^--- / { on = $2 == file } on' tests/adding/puck.patch | patch -s -d "$copy" -p1 >&2
}
make_copy() { MAKEFLAGS='' "${MAKE_COMMAND:-make}" -C "$copy" -s -j "${JOBS:-2}" BUILD=build OPT=-O1 DEBUG= "$@"; }
follows() { # first the files that the compiler finds missed
  (make_copy build/tools/cmd/cmd_info.o build/tools/render/body_picture.o &&
    make_copy build/fray build/tests/unit/test_puck &&
    cd "$copy" && build/tests/unit/test_puck) >"$work/said.txt" 2>&1
}

if have patch; then
  for file in $changed; do add "$file"; done
  for file in $listed; do
    cp "$file" "$copy/$file"
    if follows; then fail "a shape without its lines in $file passes"; else
      pass
      echo "  without $file: $(grep -m 1 -E 'error:|not true:|expected' "$work/said.txt" | cut -c 1-100)"
    fi
    add "$file"
  done
  if follows; then pass; else fail "with all of $(echo $changed): $(tail -n 20 "$work/said.txt")"; fi
  grep -E '^(deepest|height|[0-9.]+ and)' "$work/said.txt" | sed 's/^/  /'
  if "$copy/build/fray" info tests/adding/puck.scene | grep -q '^body *puck *free'; then pass; else fail "fray info does not name a puck"; fi
else
  not_run adding patch
fi
suite_end
