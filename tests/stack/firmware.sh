# SPDX-License-Identifier: Apache-2.0
# The firmware whose stack and code are bounded: firmware NAME OPT [WHAT] builds $stack_work/NAME-OPT.elf
# for a machine of target.sh, with the compiler's call graph beside it: of woven sheets only, or with WHAT,
# `sheets` of triangles, or all that there is, rigid `meshes`, cracks and handles too.
stack_work=$FRAY_BUILD/stack

firmware_cases() {
  mkdir -p "$stack_work"
  for name in small torn; do "$FRAY" hand -o "$stack_work/$name.log" "tests/determinism/$name.hand"; done
  for scene in scenes/small determinism/torn determinism/bodies determinism/frayed; do
    "$FRAY" scene "tests/$scene.scene" -o "$stack_work/${scene#*/}.img" >/dev/null
  done
  suite_make BUILD="$FRAY_BUILD" "$FRAY_BUILD/tests/determinism/emit_cases"
  # the right hand falls silent for 40 ms: STALE, SAFE
  "$FRAY_BUILD/tests/determinism/emit_cases" small "$stack_work/small.img" "$stack_work/small.log" - 800 \
    torn "$stack_work/torn.img" "$stack_work/torn.log" 1:680:720 1050 \
    bodies "$stack_work/bodies.img" - - 600 \
    frayed "$stack_work/frayed.img" - - 300 >"$stack_work/cases.c"
}

firmware() { # NAME OPT [WHAT]
  rm -f "$stack_work/$1-$2.elf"*
  case ${3:-woven} in
    woven) set -- "$1" "$2" "-DFRAY_TRIANGLES=0 -DFRAY_STRETCH=0" ;;
    sheets) set -- "$1" "$2" "-DFRAY_MESHES=0 -DFRAY_CRACKS=0 -Wl,--defsym=code_max=144K" ;;
    meshes) set -- "$1" "$2" -Wl,--defsym=code_max=256K ;;
  esac
  # shellcheck disable=SC2086
  sh tests/target/target.sh build "$1" "$2" "$stack_work/$1-$2.elf" tests/stack/firmware.c \
    "$stack_work/cases.c" platform/loop.c rt/*/*.c -fcallgraph-info=su,da $3
}
