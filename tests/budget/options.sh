#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# options.sh [update]: bytes of code of rt on the M3 (-O2, 16-bit ids) under each build option, and bytes of
# a 16x16 world with 16-bit and 32-bit ids; `update` writes them to tests/results.tsv.
. tests/lib/suite.sh

work=$FRAY_BUILD/options
mkdir -p "$work"

measure() { # NAME FLAGS...
  name=$1
  shift
  rm -rf "${work:?}/$name"
  # shellcheck disable=SC2046
  set -- $(sh tests/target/target.sh flags m3 | sed "s/-DFRAY_ID_BITS=16/${ids:--DFRAY_ID_BITS=16}/") "$@"
  cc=$1
  shift
  if suite_make BUILD="$work/$name" CC="$cc" AR="${cc%gcc}ar" OPT=-O2 EXTRA="$*" "$work/$name/libfray.a"; then
    bytes=$("${cc%gcc}size" "$work/$name"/rt/*/*.o | awk 'NR > 1 { t += $1 } END { print t }')
    printf '  %-22s %7d bytes of code\n' "$name" "$bytes"
    save "option.$name.code" "$bytes" bytes
    pass
  else
    fail "$name: rt does not build"
  fi
}
save() { [ "$update" != update ] || sh tests/results.sh set "$1" "$2" "$3" 'make options'; }

update=${1:-}
if packages=$(sh tests/target/target.sh needs m3); then
  measure all
  ids=-DFRAY_ID_BITS=32 measure ids_32
  measure no_triangles -DFRAY_TRIANGLES=0
  measure no_yarns -DFRAY_YARNS=0
  measure no_stretch -DFRAY_STRETCH=0
  measure no_cracks -DFRAY_CRACKS=0
  measure no_handles -DFRAY_HANDLES=0
  measure no_meshes -DFRAY_MESHES=0
  measure no_yarn_collision -DFRAY_YARN_COLLISION=0
  measure no_triangle_collision -DFRAY_TRIANGLE_COLLISION=0
  measure checked -DFRAY_CHECKED
  measure wide -DFX_NARROW=0
  bytes=$(arm-none-eabi-size "$work/all/rt/wire/cmac.o" "$work/all/rt/wire/auth.o" "$work/all/rt/wire/auth_gate.o" | awk 'NR > 1 { t += $1 } END { print t }')
  printf '  %-22s %7d bytes of code, which a program with FRAY_NO_AUTH does not link\n' auth "$bytes"
  save option.auth.code "$bytes" bytes
else
  not_run "code by build option" "$packages"
fi

"$FRAY" scene tests/determinism/twill16.scene -o "$work/sixteen.img" >"$work/scene.txt"
cat >"$work/ask.c" <<'ASK'
#include <stdio.h>
#include "rt/fray.h"
static unsigned char image[1 << 20];
int main(void) {
  size_t bytes = 0;
  const size_t length = fread(image, 1, sizeof image, stdin);
  if (fray_memory_size(image, length, &bytes, NULL) != FRAY_OK) return 1;
  printf("%u\n", (unsigned)bytes);
  return 0;
}
ASK
for bits in 16 32; do
  ${CC:-cc} -std=c11 -O1 -I. -DFRAY_ID_BITS=$bits "$work/ask.c" rt/*/*.c -o "$work/ask$bits"
  bytes=$("$work/ask$bits" <"$work/sixteen.img")
  printf '  twill16, %d-bit ids: %d bytes of world\n' $bits "$bytes"
  save "option.ids_$bits.world" "$bytes" bytes
done
suite_end
