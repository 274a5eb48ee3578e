#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# images.sh [here|only NAME...]: one scene gives the same image, byte for byte, from the scene
# compiler of every compiler and machine, one script the same log, and one run the same pictures in
# every look. `here` makes those to compare with, `only` does not make them again.
. tests/lib/suite.sh
. tests/cross/configs.sh

work=$FRAY_BUILD/cross/images
scenes="tests/scenes/small.scene tests/cross/torn.scene tests/cross/bodies.scene tests/cross/found.scene
  tests/cross/matrix8.scene tests/cross/mirror8.scene tests/cross/twill16.scene tests/cross/satin24.scene
  tests/cross/frayed.scene tests/cross/allyarn.scene tests/cross/stretched.scene tests/cross/rag.scene tests/cross/meshes.scene tests/cross/pressed.scene tests/cross/slashed.scene
  tests/cross/crumpled.scene tests/cross/folded.scene"
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
  $1 hand -o "$2/torn.log" tests/cross/torn.hand && make_pictures "$1" "$2"
}

make_pictures() { # PROGRAM FOLDER
  for looks in --strain '--yarn --wire' '--yarn --strain --view -160,20 --focus 0.3,0,0,0.5'; do
    # shellcheck disable=SC2086
    $1 render "$2/torn.img" --log "$2/torn.log" $looks --at 0.3s,0.9s --size 320x240 \
      -o "$2/look$(echo "$looks" | tr -d ' ,.')" >"$2/said.txt" || return 1
  done
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
  files=$(cd "$work/here" && find . -name '*.img' -o -name '*.png' -o -name torn.log)
  for file in $files; do
    if cmp "$work/here/$file" "$work/$name/$file"; then pass; else fail "$name: $file"; fi
  done
  printf '  %-14s %s\n' "$name" "$(find "$work/$name" -name '*.img' | wc -l) images, $(find "$work/$name" -name '*.png' | wc -l) pictures and a log compared"
done
suite_end
