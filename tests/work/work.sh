#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# work.sh: instructions per tick on small targets, by stage; the bound of the worst tick, derived from
# the longest paths of the compiled code and the limits of the image, beside the worst tick that was
# seen; the largest sheets that hold a rate. MACHINES="m3 rv32" picks.
. tests/lib/suite.sh

work=$FRAY_BUILD/work
machines=${MACHINES:-m0 m3 m4f m7f m33 rv32}
stages="devices_run damp_run springs_run stress_run rip_run slash_run weigh_run blow_run collide_gather predict_run
  strain_run limit_run slip_run collide_run meshes_begin meshes_run selves_begin selves_run layers_begin layers_run transition_run split_run tear_run cut_run finish_run force_run
  report_run"
cases=$work/cases.c
mkdir -p "$work"

cuts_of() { case $1 in 8) echo 2 ;; 16) echo 8 ;; *) echo 16 ;; esac; }
scene() { # TEMPLATE N RATE NAME
  half=$(awk -v n="$2" 'BEGIN { printf "%.4f", (n - 1) / 24 }')
  sed -e "s/@N@/$2/g" -e "s/@HALF@/$half/g" -e "s/@RATE@/$3/" -e "s/@CONTACTS@/$(($2 * $2 / 20))/" \
    -e "s/@CUTS@/$(cuts_of "$2")/" -e "s/@SPARES@/$(($2 * $2 / 4))/" "tests/work/$1.scene.in" >"$work/$4.scene"
  "$FRAY" scene "$work/$4.scene" -o "$work/$4.img" >"$work/$4.said"
}

prepare() {
  suite_make BUILD="$FRAY_BUILD" "$FRAY_BUILD/tests/cross/emit" "$FRAY_BUILD/tests/work/limits_of" \
    "$FRAY_BUILD/tests/work/longest"
  "$FRAY" hand -o "$work/hands.log" tests/work/hands.hand
  set --
  for n in 8 16 24; do
    scene hang $n 1000 hang_$n
    scene hands $n 1000 hands_$n
    set -- "$@" hang_$n "$work/hang_$n.img" - - 40 \
      hands_$n "$work/hands_$n.img" "$work/hands.log" - 300
  done
  for n in 8 16; do
    scene yarns $n 1000 yarns_$n
    set -- "$@" yarns_$n "$work/yarns_$n.img" "$work/hands.log" - 300
  done
  scene stretch 8 1000 stretch_8
  set -- "$@" stretch_8 "$work/stretch_8.img" "$work/hands.log" - 300
  "$FRAY_BUILD/tests/cross/emit" "$@" >"$work/cases.c"
  ${CC:-cc} -std=c11 -O2 -Wall -Wextra -Werror -shared -fPIC tests/work/stage_count.c \
    -o "$work/stage_count.so"
}

count_pieces() { # MACHINE NAME OPTION...: pieces and their instructions in NAME.joined
  machine=$1 name=$2 elf=$work/$2.elf
  shift 2
  sh tests/target/target.sh build "$machine" -O2 "$elf" -g "$@" tests/work/work_main.c tests/target/port_bare.c \
    "$cases" rt/base/*.c rt/model/*.c rt/stage/*.c rt/run/*.c rt/wide/*.c || return 1
  case $machine in rv32) tools=riscv64-unknown-elf ;; *) tools=arm-none-eabi ;; esac
  compiler=$tools-gcc
  $tools-nm -S "$elf" | awk 'NF == 4 { print $1, $2, $4 }' >"$work/$name.symbols"
  sh tests/target/target.sh run "$machine" "$elf" >"$work/$name.lines" -plugin \
    "$work/stage_count.so,symbols=$work/$name.symbols,out=$work/$name.counts" || return 1
  awk -f tests/work/join.awk "$work/$name.counts" "$work/$name.lines" >"$work/$name.joined"
}

count() { # MACHINE NAME OPTION...: pieces in NAME.joined, the bounds of its stages in NAME.bound
  count_pieces "$@" || return 1
  $tools-objdump -d -l --no-show-raw-insn "$elf" >"$work/$name.dis"
  cat tests/work/loops.txt tests/work/sweep_loops.txt > "$work/loops.txt"
  if [ "$machine" = m0 ]; then cat tests/work/loops_m0.txt >>"$work/loops.txt"; fi
  # the step alone: its stages cost nothing
  for stage in $stages; do echo "$stage | | cost 0"; done | cat "$work/loops.txt" - >"$work/step.txt"
  # shellcheck disable=SC2086
  {
    "$FRAY_BUILD/tests/work/longest" "$work/loops.txt" . $stages <"$work/$name.dis" &&
      "$FRAY_BUILD/tests/work/longest" "$work/step.txt" . fray_tick <"$work/$name.dis"
  } >"$work/$name.bound"
}

check() { # MACHINE
  if ! packages=$(sh tests/target/target.sh needs "$1"); then
    not_run "work on $1" "$packages"
    return
  fi
  if ! count "$1" "$1" -DFRAY_TRIANGLES=0; then
    fail "work on $1: it does not build, run or measure: $(tail -n 3 "$work/$1.lines")"
  elif awk -v machine="$1" -v compiler="$compiler" -v shown=hands_16 -v budget_file="$work/$1.budget" \
    -f tests/work/bound.awk \
    -f tests/work/table.awk "$work/$1.bound" "$work/$1.joined"; then
    pass
  else
    fail "work on $1"
  fi
}

# Clocks, and cycles for an instruction that a core of its kind takes about: assumed, not measured.
largest() {
  sheets=''
  for rate in 1000 500 240; do
    for n in 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28; do
      scene hang $n $rate ${rate}_$n
      sheets="$sheets ${rate}_$n $work/${rate}_$n.img"
    done
  done
  # shellcheck disable=SC2086
  "$FRAY_BUILD/tests/work/limits_of" $sheets >"$work/sheets.txt"
  echo "  largest hanging sheet that fits 80 % of a tick (substeps, as the scene compiler finds them), 12"
  echo "  yarns/cm, no bodies; by the bound of any tick, and by the measured units of an intact sheet:"
  printf '  %-34s %14s %14s %14s\n' "" "1 kHz" "500 Hz" "240 Hz"
  for row in "m0 64 1.3" "m4f 64 1.4" "m4f 168 1.4" "m33 168 1.4" "rv32 168 1.4" "m7f 480 1.0"; do
    # shellcheck disable=SC2086
    set -- $row
    [ -s "$work/$1.budget" ] || continue
    for kind in bound intact; do
      printf '  %-34s' "$1 at $2 MHz, $3 cycles, $kind"
      awk -v clock="${2}000000" -v cycles="$3" -v kind=$kind -f tests/work/bound.awk \
        -f tests/work/largest.awk "$work/$1.bound" "$work/$1.budget" "$work/sheets.txt"
    done
  done
}

# The M55's vector extension beside its scalar code, in instructions: by stage, in the median tick of hands_16.
helium() {
  if ! packages=$(sh tests/target/target.sh needs m55); then
    not_run "work on m55" "$packages"
    return
  fi
  if count_pieces m55 m55_scalar -DFRAY_TRIANGLES=0 && count_pieces m55 m55_helium -DFRAY_TRIANGLES=0 -DWORK_KERNEL=FRAY_KERNEL_HELIUM &&
    awk -f tests/work/kernels.awk "$work/m55_scalar.joined" "$work/m55_helium.joined"; then
    pass
  else
    fail "work on m55, scalar beside helium: it does not build or run"
  fi
}

# Triangle sheets: the stages of a sheet that tears, beside their bounds.
triangles() {
  if ! packages=$(sh tests/target/target.sh needs m3); then
    not_run "work of triangles on m3" "$packages"
    return
  fi
  "$FRAY" scene tests/work/triangles.scene -o "$work/triangles.img" >"$work/triangles.said"
  "$FRAY_BUILD/tests/cross/emit" triangles "$work/triangles.img" - - 100 >"$work/cases_triangles.c"
  cases=$work/cases_triangles.c
  if count m3 m3_triangles -DFRAY_MESHES=0 && awk -f tests/work/bound.awk -f tests/work/triangles.awk \
    "$work/m3_triangles.bound" "$work/m3_triangles.joined"; then
    pass
  else
    fail "work of triangles on m3"
  fi
  cases=$work/cases.c
}

# The tools must find what they look for: a loop that nobody named, and a bound that is too low.
check_the_checks() {
  [ -s "$work/m3.dis" ] || return 0
  grep -v '^project_free ' tests/work/loops.txt >"$work/unnamed.txt"
  if "$FRAY_BUILD/tests/work/longest" "$work/unnamed.txt" . strain_run <"$work/m3.dis" >/dev/null 2>&1; then
    fail "a loop without a rule is not found"
  else
    pass
  fi
  sed 's/^loop strain_run projections_free .*/loop strain_run projections_free 90/' "$work/m3.bound" >"$work/low.bound"
  if awk -v machine=low -v compiler=- -v shown=hands_16 -v budget_file=/dev/null -f tests/work/bound.awk \
    -f tests/work/table.awk "$work/low.bound" "$work/m3.joined" >/dev/null; then
    fail "a bound below what was seen is not found"
  else
    pass
  fi
}

prepare
rm -f "$work"/*.budget
for machine in $machines; do check "$machine"; done
largest
helium
triangles
check_the_checks
if sh tests/work/sweep.sh; then pass; else fail "sweeps"; fi
for machine in $machines; do
  [ -s "$work/$machine.budget" ] || continue
  if sh tests/budget.sh "work.$machine." "$work/$machine.budget" ${1:+"$1"}; then pass; else fail "budgets of work on $machine"; fi
done
suite_end
