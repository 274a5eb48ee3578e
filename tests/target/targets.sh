#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# targets.sh build|test: whole firmwares for every bare-metal machine, within the budgets of linker/;
# `test` runs them in QEMU too, at a stated instruction rate under its virtual clock, and tries the
# guards of stack, budgets and recording. MACHINES="m3 rv32" picks.
. tests/lib/suite.sh

mode=${1:-test}
work=$FRAY_BUILD/target
target="sh tests/target/target.sh"
machines_all=${MACHINES:-$($target list)}
mkdir -p "$work"

# name, scene, hand, bytes for the world, machines
firmwares() {
  echo "small tests/scenes/small.scene tests/determinism/small.hand 5648 $machines_all"
  echo "sixteen tests/target/sixteen.scene tests/determinism/small.hand 18816 $(only "m0 m3 m4f m7f m33 m55 r5f rv32")"
  echo "minute tests/target/minute.scene tests/target/minute.hand 5648 $(only 'm3 rv32')"
}
only() { for name in $machines_all; do case " $1 " in *" $name "*) echo "$name" ;; esac; done | tr '\n' ' '; } # of MACHINES

# The timer that counts beside the tick, where there is one; and no sleep, see systick.c.
extra_of() { # MACHINE
  printf '%s ' -DFRAY_TRIANGLES=0 -DFRAY_STRETCH=0 # none of these firmwares has a membrane, or elastic yarns
  if [ "$1" = rv32 ]; then printf '%s ' -DFRAY_YARNS=0; fi # for speed they do not fit; for size its minute is late
  case $1 in
    m0) echo "-DSYSTICK_SPIN -DTARGET_NRF51_TIMER=0x40008000" ;;
    m3 | m4f | m7f) echo "-DSYSTICK_SPIN -DTARGET_CMSDK_TIMER=0x40000000" ;;
    m33) echo "-DSYSTICK_SPIN -DTARGET_CMSDK_TIMER=0x50000000" ;;
    m55) echo "-DSYSTICK_SPIN" ;;
    rv32) echo "-DTARGET_MTIME=0x0200BFF8" ;;
  esac
}

# Armv6-M and A32 take more bytes for the same, and the M55 has Helium's kernels beside the scalar code: for speed
# they would not fit in 64 KiB.
opt_of() { # MACHINE
  case $1 in
    m0 | microbit | m55 | r5f) echo -Os ;;
    *) echo -O2 ;;
  esac
}

keep_same() { # NEW FILE: so that nothing is built again where nothing changed
  if cmp -s "$1" "$2"; then rm "$1"; else mv "$1" "$2"; fi
}

prepare() { # NAME SCENE HAND: image and recording as C
  suite_make BUILD="$FRAY_BUILD" "$FRAY_BUILD/tests/target/tape"
  "$FRAY" scene "$2" --emit-c image -o "$work/new" >/dev/null
  keep_same "$work/new" "$work/$1.image.c"
  "$FRAY" hand -o "$work/$1.log" "$3"
  "$FRAY" run "$2" --log "$work/$1.log" --record "$work/$1.rec" >/dev/null
  "$FRAY_BUILD/tests/target/tape" "$work/$1.rec" >"$work/new"
  keep_same "$work/new" "$work/$1.tape.c"
}

# MACHINE FILE.c...: their objects, with every warning that rt is held to
objects() {
  machine=$1
  shift
  machine_flags=$($target flags "$machine")
  machine_compiler=${machine_flags%% *}
  built=''
  for file in "$@"; do built="$built $work/$machine/${file%.c}.o"; done
  # shellcheck disable=SC2086
  suite_make BUILD="$work/$machine" CC="$machine_compiler" AR="${machine_compiler%gcc}ar" OPT="$(opt_of "$machine")" \
    EXTRA="${machine_flags#* } $(extra_of "$machine")" "$work/$machine/libfray.a" $built
}

build() { # NAME MACHINE WORLD IMAGE TAPE: $work/NAME-MACHINE.elf
  objects "$2" platform/loop.c platform/playback/player.c "$4" "$5" || return 1
  # shellcheck disable=SC2046,SC2086
  $target firmware "$2" "$(opt_of "$2")" "$work/$1-$2.elf" tests/target/firmware.c $(extra_of "$2") \
    -DFIRMWARE_WORLD="$3" $built "$work/$2/libfray.a" -Wl,-Map="$work/$1-$2.map"
}

symbol() { # ELF NAME: decimal
  printf '%d' "0x$($nm "$1" | awk -v name="$2" '$3 == name { print $1 }')"
}

sizes() { # NAME MACHINE WORLD
  elf=$work/$1-$2.elf
  machine_flags=$($target flags "$2")
  nm=${machine_flags%% *}
  nm=${nm%gcc}nm
  stack=$(symbol "$elf" stack_first)
  code=$(($(symbol "$elf" text_last) - $(symbol "$elf" text_first)))
  constants=$(($(symbol "$elf" rodata_last) - $(symbol "$elf" text_last)))
  ram=$(($(symbol "$elf" bss_last) - stack))
  printf '  %-9s %-9s %8d %10d %8d %8d %8d %8d %8d\n' "$1" "$2" "$code" \
    "$(symbol "$elf" budget_code)" "$constants" "$3" $(($(symbol "$elf" stack_top) - stack)) "$ram" "$(symbol "$elf" budget_ram)"
}

build_all() {
  printf '  %-9s %-9s %8s %10s %8s %8s %8s %8s %8s\n' firmware machine code "at most" constants world \
    stack RAM "at most"
  firmwares | while read -r name scene hand world machines; do
    prepare "$name" "$scene" "$hand"
    for machine in $machines; do
      if ! $target needs "$machine" >/dev/null; then
        not_run "firmware $name of $machine" "$($target needs "$machine")"
      elif build "$name" "$machine" "$world" "$work/$name.image.c" "$work/$name.tape.c"; then
        sizes "$name" "$machine" "$world"
      else
        echo "FAILED firmware $name of $machine: it does not build"
      fi
    done
  done >"$work/sizes.txt"
  cat "$work/sizes.txt"
  suite_failed=$(grep -c '^FAILED' "$work/sizes.txt" || true)
}

field() { # NAME: the word behind it in $said
  echo "$said" | awk -v name="$1" '{ for (n = 1; n < NF; ++n) if ($n == name) print $(n + 1) }'
}

# Recording, into nothing: else the thread that runs an emulated timer can be kept from it by the host, after it has
# taken the timer off its list, and the core runs past it: a tick then comes late by the emulated clock.
exact=sleep=off,rr=record,rrfile=/dev/null

# NAME MACHINE SHIFT in-time|late|-: an instruction takes 2^SHIFT ns; SHIFT host: the host's time
run() {
  code=0
  if [ "$3" = host ]; then
    mips=host
    said=$($target run "$2" "$work/$1-$2.elf" 2>&1) || code=$?
  else
    mips=$((1000 >> $3))
    said=$($target run "$2" "$work/$1-$2.elf" -icount "shift=$3,$exact" 2>&1) || code=$?
  fi
  overruns=$(field overruns)
  verdict=good
  [ "$code" -eq 0 ] || verdict="exit $code"
  [ "$(field different)" = 0 ] || verdict="frames differ from tick $(field first) on"
  [ "$(field ticks)" = "$(grep -c ' 080#' "$work/$1.rec" | awk '{ print $1 - 1 }')" ] ||
    verdict="not all ticks: $said"
  [ "${4}" != in-time ] || [ "$overruns" = 0 ] || verdict="late at the stated rate"
  [ "${4}" != late ] || [ "${overruns:-0}" -gt 0 ] || verdict="no overrun at a rate that is too low"
  [ "$(field flash)" != 0 ] || verdict="no constant is used in place"
  printf '  %-9s %-9s %5s %7s %9s %6s %8s %8s %6s/%-5s %s\n' "$1" "$2" "$mips" "$(field ticks)" \
    "$overruns" "$(field owed)" "$(field worst)" "$(field flash)" "$(field stack)" "$(field of)" \
    "$verdict"
  if [ "$verdict" = good ]; then pass; else fail "$1 on $2 at $mips MIPS: $verdict"; fi
}

run_firmwares() { # MACHINE
  if [ "$1" = microbit ]; then
    run small microbit host -
    return
  fi
  run small "$1" 0 in-time
  run small "$1" 4 late
  run sixteen "$1" 0 -
  case $1 in m3 | rv32) run minute "$1" 2 in-time ;; esac
}

check_guards() { # MACHINE
  for opt in -O0 -O1; do
    code=0
    $target firmware "$1" "$opt" "$work/overflow-$1.elf" tests/target/overflow.c
    said=$($target run "$1" "$work/overflow-$1.elf") || code=$?
    case "$code $said" in
      "99 fault "*) pass ;;
      *) fail "a stack that overflows on $1, $opt: exit $code, $said" ;;
    esac
    printf '  overflow  %-9s %s exit %d, %s\n' "$1" "$opt" "$code" "$said"
  done
}

# All machines at a time: each is a process of its own, with a clock of its own.
run_all() {
  started=''
  for machine in $machines_all; do
    if ! $target needs "$machine" >/dev/null; then
      not_run "firmware on $machine" "$($target needs "$machine")"
      continue
    fi
    started="$started $machine"
    echo "0 1" >"$work/$machine.counts" # of one that does not end
    (
      suite_passed=0 suite_failed=0
      run_firmwares "$machine"
      check_guards "$machine"
      echo "$suite_passed $suite_failed" >"$work/$machine.counts"
    ) >"$work/$machine.said" &
  done
  wait
  echo
  printf '  %-9s %-9s %5s %7s %9s %6s %8s %8s %12s\n' firmware machine MIPS ticks overruns owed \
    "worst us" "in flash" stack
  for machine in $started; do
    cat "$work/$machine.said"
    read -r good bad <"$work/$machine.counts"
    suite_passed=$((suite_passed + good))
    suite_failed=$((suite_failed + bad))
  done
}

# A Cortex-M locks up in a fault of its fault handler, and only a watchdog helps it.
check_console() {
  for machine in $(only 'r5f rv32'); do
    $target needs "$machine" >/dev/null || continue
    code=0
    $target firmware "$machine" -O2 "$work/console.elf" tests/target/console_faults.c -Wl,--wrap=platform_print
    said=$(TARGET_SECONDS=20 $target run "$machine" "$work/console.elf") || code=$?
    if [ "$code $said" = "99 " ]; then pass; else fail "a console that faults on $machine: exit $code, $said"; fi
  done
}

# MESSAGE C-TEXT: a program that must not link on the M3
check_refused() {
  echo "$2" >"$work/refused.c"
  if said=$($target firmware m3 -O1 "$work/refused.elf" "$work/refused.c" 2>&1); then
    fail "it links: $1"
  else
    case $said in
      *"$1"*) pass ;;
      *) fail "expected '$1': $said" ;;
    esac
  fi
}

check_budgets() {
  check_refused "stack and data are larger than budget_ram" \
    'char large[65000]; int main(void) { return large[1]; }'
  check_refused "code is larger than budget_code" \
    'int main(void) { __asm__ volatile(".space 70000"); return 0; }'
  check_refused "an allocator was linked" \
    'void *malloc(unsigned n); void *malloc(unsigned n) { return (void *)n; }
     int main(void) { return malloc(1) != 0; }'
}

# A recording with one bit of one pose changed is not what the loop computes.
check_recording() {
  "$FRAY_BUILD/tests/cli/alter" pose "$work/small.rec" 400 1 1 >"$work/altered.rec"
  "$FRAY_BUILD/tests/target/tape" "$work/altered.rec" >"$work/altered.tape.c"
  build altered m3 5648 "$work/small.image.c" "$work/altered.tape.c"
  code=0
  said=$($target run m3 "$work/altered-m3.elf" -icount "shift=0,$exact") || code=$?
  case "$code $(field first)" in
    "1 40"[0-2]) pass ;;
    *) fail "a pose of tick 400 changed: exit $code, $said" ;;
  esac
  echo "  altered   m3: exit $code, $said"
}

# The command that platform/README.md tells, on the blank board.
check_blank() {
  awk '/^ +arm-none-eabi-gcc/ { on = 1 } on { print } on && !/\\$/ { exit }' platform/README.md \
    >"$work/blank.sh"
  cp "$work/small.image.c" "$work/image.c"
  if said=$(OUT=$work sh -eu "$work/blank.sh" 2>&1) && [ -z "$said" ] && [ -s "$work/blank.elf" ]; then
    pass
  else
    fail "platform/blank does not build as platform/README.md says: $said"
  fi
  sed 's/ORIGIN = 0x20000000, LENGTH = 16K/ORIGIN = 0x20000400, LENGTH = 15K/' platform/blank/board.ld >"$work/off.ld"
  sed "s|-T platform/blank/board.ld|-T $work/off.ld|" "$work/blank.sh" >"$work/off.sh"
  if said=$(OUT=$work sh -eu "$work/off.sh" 2>&1); then
    fail "it links: RAM that begins in the middle of the guard's region"
  else
    case $said in
      *"no region guards the stack"*) pass ;;
      *) fail "expected 'no region guards the stack': $said" ;;
    esac
  fi
}

build_all
if [ "$mode" = test ]; then
  run_all
  check_console
  if [ -n "$(only m3)" ] && $target needs m3 >/dev/null; then
    check_budgets
    check_recording
    check_blank
  fi
  suite_end
fi
[ "$suite_failed" -eq 0 ]
