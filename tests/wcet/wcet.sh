#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# work.sh: instructions per tick on small targets, by stage; the bound of the worst tick, derived from
# the longest paths of the compiled code and the limits of the image, beside the worst tick that was
# seen; the largest sheets that hold a rate. MACHINES="m3 rv32" picks.
. tests/lib/suite.sh

work=$FRAY_BUILD/work
machines=${MACHINES:-m0 m3 m4f m7f m33 rv32}
# stages.txt without the tick and the hash
stages=$(awk '/^[a-z]/ && ($2 == "tick" || $2 == "substep") { print $1 }' tests/wcet/stages.txt)
# all of rt but the bus and the workers
rooms="rt/base/*.c rt/geometry/*.c rt/state/*.c rt/simd/*.c rt/image/*.c rt/trimesh/*.c rt/integrate/*.c
  rt/woven/*.c rt/elastic/*.c rt/membrane/*.c rt/contact/*.c rt/self_collision/*.c rt/haptics/*.c rt/tick/*.c"
cases=$work/cases.c
mkdir -p "$work"

cuts_of() { case $1 in 8) echo 2 ;; 16) echo 8 ;; *) echo 16 ;; esac; }
scene() { # TEMPLATE N RATE NAME
  half=$(awk -v n="$2" 'BEGIN { printf "%.4f", (n - 1) / 24 }')
  sed -e "s/@N@/$2/g" -e "s/@HALF@/$half/g" -e "s/@RATE@/$3/" -e "s/@CONTACTS@/$(($2 * $2 / 20))/" \
    -e "s/@CUTS@/$(cuts_of "$2")/" -e "s/@SPARES@/$(($2 * $2 / 4))/" "tests/wcet/$1.scene.in" >"$work/$4.scene"
  "$FRAY" scene "$work/$4.scene" -o "$work/$4.img" >"$work/$4.said"
}

prepare() {
  suite_make BUILD="$FRAY_BUILD" "$FRAY_BUILD/tests/determinism/emit_cases" "$FRAY_BUILD/tests/wcet/print_loop_limits" \
    "$FRAY_BUILD/tests/wcet/longest_path"
  "$FRAY" hand -o "$work/hands.log" tests/wcet/hands.hand
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
  "$FRAY_BUILD/tests/determinism/emit_cases" "$@" >"$work/cases.c"
  ${CC:-cc} -std=c11 -O2 -Wall -Wextra -Werror -shared -fPIC tests/wcet/stage_count.c \
    -o "$work/stage_count.so"
}

count_pieces() { # MACHINE NAME OPTION...: pieces and their instructions in NAME.joined
  machine=$1 name=$2 elf=$work/$2.elf
  shift 2
  sh tests/target/target.sh build "$machine" -O2 "$elf" -g "$@" tests/wcet/tick_main.c tests/target/port_bare.c \
    "$cases" $rooms || return 1
  case $machine in rv32) tools=riscv64-unknown-elf ;; *) tools=arm-none-eabi ;; esac
  compiler=$tools-gcc
  $tools-nm -S "$elf" | awk 'NF == 4 { print $1, $2, $4 }' >"$work/$name.symbols"
  sh tests/target/target.sh run "$machine" "$elf" >"$work/$name.lines" -plugin \
    "$work/stage_count.so,stages=tests/wcet/stages.txt,symbols=$work/$name.symbols,out=$work/$name.counts" || return 1
  awk -f tests/wcet/join.awk "$work/$name.counts" "$work/$name.lines" >"$work/$name.joined"
}

count() { # MACHINE NAME OPTION...: pieces in NAME.joined, the bounds of its stages in NAME.bound
  count_pieces "$@" || return 1
  $tools-objdump -d -l --no-show-raw-insn "$elf" >"$work/$name.dis"
  cat tests/wcet/loops.txt tests/wcet/ccd_loops.txt > "$work/loops.txt"
  if [ "$machine" = m0 ]; then cat tests/wcet/loops_m0.txt >>"$work/loops.txt"; fi
  # the step alone: its stages cost nothing
  present=$(for stage in $stages; do awk -v name="$stage" '$3 == name { print name; exit }' "$work/$name.symbols"; done)
  for stage in $present; do echo "$stage | | cost 0"; done | cat "$work/loops.txt" - >"$work/step.txt"
  # shellcheck disable=SC2086
  {
    "$FRAY_BUILD/tests/wcet/longest_path" "$work/loops.txt" . $present <"$work/$name.dis" &&
      "$FRAY_BUILD/tests/wcet/longest_path" "$work/step.txt" . fray_tick <"$work/$name.dis"
  } >"$work/$name.bound"
}

check() { # MACHINE
  has_target "$1" "work on $1" || return 0
  count "$1" "$1" -DFRAY_TRIANGLES=0 || {
    fail "work on $1: it does not build, run or measure: $(tail -n 3 "$work/$1.lines")"
    return
  }
  holds "work on $1" awk -v machine="$1" -v compiler="$compiler" -v shown=hands_16 -v budget_file="$work/$1.budget" \
    -f tests/wcet/stages.awk -f tests/wcet/bound.awk \
    -f tests/wcet/table.awk "$work/$1.bound" "$work/$1.joined"
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
  "$FRAY_BUILD/tests/wcet/print_loop_limits" $sheets >"$work/sheets.txt"
  echo "  largest hanging sheet that fits 80 % of a tick (substeps, as the scene compiler finds them), 12"
  echo "  yarns/cm, no bodies; by the bound of any tick, and by the measured units of an intact sheet:"
  printf '  %-34s %14s %14s %14s\n' "" "1 kHz" "500 Hz" "240 Hz"
  for row in "m0 64 1.3" "m4f 64 1.4" "m4f 168 1.4" "m33 168 1.4" "rv32 168 1.4" "m7f 480 1.0"; do
    # shellcheck disable=SC2086
    set -- $row
    [ -s "$work/$1.budget" ] || continue
    for kind in bound intact; do
      printf '  %-34s' "$1 at $2 MHz, $3 cycles, $kind"
      awk -v clock="${2}000000" -v cycles="$3" -v kind=$kind -f tests/wcet/stages.awk -f tests/wcet/bound.awk \
        -f tests/wcet/largest.awk "$work/$1.bound" "$work/$1.budget" "$work/sheets.txt"
    done
  done
}

# The M55's vector extension beside its scalar code, in instructions: by stage, in the median tick of hands_16.
helium() {
  has_target m55 "work on m55" || return 0
  if count_pieces m55 m55_scalar -DFRAY_TRIANGLES=0 && count_pieces m55 m55_helium -DFRAY_TRIANGLES=0 -DWORK_KERNEL=FRAY_KERNEL_HELIUM &&
    awk -f tests/wcet/stages.awk -f tests/wcet/kernels.awk "$work/m55_scalar.joined" "$work/m55_helium.joined"; then
    pass
  else
    fail "work on m55, scalar beside helium: it does not build or run"
  fi
}

# Membranes: the stages of a sheet that tears, beside their bounds.
triangles() {
  has_target m3 "work of triangles on m3" || return 0
  "$FRAY" scene tests/wcet/triangles.scene -o "$work/triangles.img" >"$work/triangles.said"
  "$FRAY_BUILD/tests/determinism/emit_cases" triangles "$work/triangles.img" - - 100 >"$work/cases_triangles.c"
  cases=$work/cases_triangles.c
  if count m3 m3_triangles -DFRAY_MESHES=0 -DFRAY_CRACKS=0 && awk -f tests/wcet/stages.awk -f tests/wcet/bound.awk -f tests/wcet/triangles.awk \
    "$work/m3_triangles.bound" "$work/m3_triangles.joined"; then
    pass
  else
    fail "work of triangles on m3"
  fi
  cases=$work/cases.c
}

# The tools must find what they look for: a loop without a rule, a bound that is too low, and a stage that
# stands as once a tick but is called in every substep.
check_the_checks() {
  [ -s "$work/m3.dis" ] || return 0
  grep -v '^project_free ' tests/wcet/loops.txt >"$work/unnamed.txt"
  if "$FRAY_BUILD/tests/wcet/longest_path" "$work/unnamed.txt" . strain_limit_apply <"$work/m3.dis" >/dev/null 2>&1; then
    fail "a loop without a rule is not found"
  else
    pass
  fi
  sed 's/^loop strain_limit_apply projections_free .*/loop strain_limit_apply projections_free 90/' "$work/m3.bound" >"$work/low.bound"
  if awk -v machine=low -v compiler=- -v shown=hands_16 -v budget_file=/dev/null -f tests/wcet/stages.awk -f tests/wcet/bound.awk \
    -f tests/wcet/table.awk "$work/low.bound" "$work/m3.joined" >/dev/null; then
    fail "a bound below what was seen is not found"
  else
    pass
  fi
  sed 's/ substep / tick    /' tests/wcet/stages.txt >"$work/stages_once.txt"
  if sh tests/target/target.sh run m3 "$work/m3.elf" -plugin \
    "$work/stage_count.so,stages=$work/stages_once.txt,symbols=$work/m3.symbols,out=$work/once.counts" >"$work/once.lines" 2>&1; then
    fail "a stage that is called more than once a tick is not found"
  else
    pass
  fi
}

# A stage that was renamed would be a column of zeros, and its cost its neighbour's.
check_stages() {
  for stage in $(awk '/^[a-z]/ { if ($2 != "step" || seen++ == 0) print $1 }' tests/wcet/stages.txt); do
    if grep -rqE --include='*.c' "^[a-z].*[ *]$stage\(" rt; then pass; else fail "stages.txt: rt defines no $stage"; fi
  done
}

# A rule of a loop that was renamed no longer fits, and its cost goes where another rule puts it.
check_rules() {
  find rt platform/bare -name '*.[ch]' -exec cat {} + | awk '
    FNR == NR { if ($0 !~ /^#/ && NF) rule[++rules] = $0; next }
    { all = $0 }
    END {
      for (n = 1; n <= rules; n++) {
        names = text = rule[n]
        sub(/ *[|][^|]*$/, "", text)        # the count
        if (text ~ /[|]$/ || text !~ / [|] /) text = ""
        sub(/^[^|]*[|] */, "", text)
        if (text != "" && !index(all, text)) print rule[n]
        if (match(names, / [|] /)) names = substr(names, 1, RSTART - 1)
        count = split(names, name, /[@|]/)
        for (k = 1; k <= count; k++) if (!index(all, name[k] "(")) print rule[n] ": " name[k]
      }
    }' tests/wcet/loops.txt RS='\001' - >"$work/stale.txt"
  if [ ! -s "$work/stale.txt" ]; then pass; else fail "loops.txt: in no source: $(cat "$work/stale.txt")"; fi
}

prepare
check_stages
check_rules
rm -f "$work"/*.budget
for machine in $machines; do check "$machine"; done
largest
helium
triangles
check_the_checks
if sh tests/wcet/ccd.sh; then pass; else fail "sweeps"; fi
for machine in $machines; do
  [ -s "$work/$machine.budget" ] || continue
  if sh tests/budget/budget.sh "work.$machine." "$work/$machine.budget" ${1:+"$1"}; then pass; else fail "budgets of work on $machine"; fi
done
suite_end
