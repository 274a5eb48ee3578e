#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# images.sh [here|only NAME...|update]: one scene gives the same image, byte for byte, from the scene
# compiler of every compiler and machine, one script the same log, and one run the same pictures in
# every look; and every scene in tests the image of tests/golden/images.txt. `here` makes the images to
# compare with and checks that list, `only` does neither, `update` writes the list. PART=2/8: the second of eight
# parts of the compilers and machines.
. tests/lib/suite.sh
. tests/determinism/configs.sh

work=$FRAY_BUILD/cross/images
golden=tests/golden/images.txt
scenes="tests/scenes/small.scene tests/determinism/torn.scene tests/determinism/bodies.scene tests/determinism/auto_steps.scene
  tests/determinism/matrix8.scene tests/determinism/mirror8.scene tests/determinism/twill16.scene tests/determinism/satin24.scene
  tests/determinism/frayed.scene tests/determinism/allyarn.scene tests/determinism/stretched.scene tests/determinism/membrane_tear.scene tests/determinism/meshes.scene tests/determinism/contact_triangles.scene tests/determinism/blade_cut.scene
  tests/determinism/yarn_collision.scene tests/determinism/triangle_collision.scene tests/determinism/cracked.scene"
list=$(sh tests/part.sh share "${PART:-1/1}" clang-O3 s390x-O2 gcc-id16)
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
  $1 hand -o "$2/torn.log" tests/determinism/torn.hand && make_pictures "$1" "$2"
}

make_pictures() { # PROGRAM FOLDER
  for looks in --strain '--yarn --wire' '--yarn --strain --view -160,20 --focus 0.3,0,0,0.5'; do
    # shellcheck disable=SC2086
    $1 render "$2/torn.img" --log "$2/torn.log" $looks --at 0.3s,0.9s --size 320x240 \
      -o "$2/look$(echo "$looks" | tr -d ' ,.')" >"$2/said.txt" || return 1
  done
}

image_sums() { # CRC BYTES SCENE of every scene in tests; a scene that does not compile has none
  find tests -name '*.scene' | LC_ALL=C sort | while read -r scene; do
    if "$FRAY" scene "$scene" -o "$work/one.img" >"$work/said.txt" 2>&1; then
      echo "$(cksum <"$work/one.img") $scene"
    fi
  done
}

check_sums() {
  image_sums >"$work/sums.txt"
  grep -v '^#' "$golden" >"$work/golden.txt"
  differ=$(diff "$work/golden.txt" "$work/sums.txt" | awk '/^[<>]/ { print $4 }' | sort -u)
  for scene in $differ; do fail "$scene: not the image of $golden"; done
  if [ -z "$differ" ]; then pass; fi
  printf '  %-14s %s\n' host "$(grep -c . "$work/sums.txt") images against $golden"
}

case $mode in
  update)
    image_sums >"$work/sums.txt"
    { grep '^#' "$golden"; cat "$work/sums.txt"; } >"$work/golden.txt"
    cp "$work/golden.txt" "$golden"
    echo "$golden: $(grep -c . "$work/sums.txt") images"
    exit 0 ;;
  only) list="$*" ;;
  *)
    make_all "$FRAY" "$work/here"
    check_sums ;;
esac
if [ "$mode" = here ]; then
  suite_end
  exit
fi
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
