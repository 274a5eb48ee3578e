#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# images.sh [here|only NAME...]: one scene gives the same image, byte for byte, from the scene
# compiler of every compiler and machine, and one script the same log. `here` makes those to compare
# with, `only` does not make them again.
. tests/lib/suite.sh
. tests/cross/configs.sh

work=$FRAY_BUILD/cross/images
scenes="tests/scenes/small.scene tests/cross/torn.scene tests/cross/bodies.scene tests/cross/found.scene
  tests/cross/matrix8.scene tests/cross/mirror8.scene tests/cross/twill16.scene tests/cross/satin24.scene"
list="gcc-O0 gcc-id16 clang-O3 i386-O2 s390x-O2"
mode=${1:-short}
[ $# -eq 0 ] || shift
mkdir -p "$work"

make_all() { # PROGRAM FOLDER
  mkdir -p "$2"
  for scene in $scenes; do
    # shellcheck disable=SC2086
    $1 scene "$scene" -o "$2/$(basename "$scene" .scene).img" >"$2/said.txt" || return 1
  done
  # shellcheck disable=SC2086
  $1 hand -o "$2/torn.log" tests/cross/torn.hand
}

if [ "$mode" = only ]; then list="$*"; else make_all "$FRAY" "$work/here"; fi
[ "$mode" != here ] || exit 0
for name in $list; do
  if ! config "$name"; then
    not_run "images of $name" "$PACKAGES"
    continue
  fi
  rm -rf "${work:?}/$name"
  if ! config_make "$name" fray || ! make_all "$RUN $FRAY_BUILD/cross/$name/fray" "$work/$name"; then
    fail "images of $name: not made"
    continue
  fi
  for file in "$work/here"/*.img "$work/here/torn.log"; do
    if cmp "$file" "$work/$name/$(basename "$file")"; then pass; else fail "$name: $file"; fi
  done
  printf '  %-14s %s\n' "$name" "$(find "$work/$name" -name '*.img' | wc -l) images and a log compared"
done
suite_end
