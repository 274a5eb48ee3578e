#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# size.sh [update]: bytes of code of rt by machine and folder, and of a whole firmware on the M3; RAM
# of a world by array, with every spare and 16-bit ids, as the runtime itself accounts for it; against
# tests/budget and what is asked: a firmware in 64 KiB of code, 16x16 in 64 KiB of RAM, 8x8 with
# everything that runs it in the 16 KiB of a microbit. PART=2/8: the second of eight parts of its rows.
. tests/lib/suite.sh
. tests/stack/firmware.sh

work=$FRAY_BUILD/size
measured=$work/measured.txt
folders="base geometry wire state simd image trimesh integrate woven membrane contact self_collision haptics tick workers"
sheets="8x8 16x16 24x24 80x40"
stack_max=2048 # stack.sh holds it
rows="m0-O2 m0-Os m3-O2 m3-Os m4f-O2 m4f-Os m7f-O2 m7f-Os m33-O2 m33-Os rv32-O2 rv32-Os host-O2 host-Os
  firmware-O2 firmware-Os ram"
mkdir -p "$work"
: >"$measured"

code_row() { printf '  %-8s %7.7s %7.7s %7.7s %7.7s %7.7s %7.7s %7.7s %7.7s %7.7s %7.7s %7.7s %7.7s %7.7s %7.7s %7.7s %7s %5s %5s\n' "$@"; }

compile() { # NAME OPT CC FLAGS...
  folder=$work/$1$2
  made_of="$* $(echo rt/*/*.c)" # an object whose source has moved would be counted
  [ "$(cat "$folder/made_of" 2>/dev/null)" = "$made_of" ] || rm -rf "$folder"
  mkdir -p "$folder"
  echo "$made_of" >"$folder/made_of"
  opt=$2 cc=$3
  shift 3
  suite_make BUILD="$folder" CC="$cc" AR="${cc%gcc}ar" OPT="$opt" EXTRA="$*" "$folder/libfray.a"
}

folder_bytes() { # SIZE FOLDER: code and constants
  "$1" "$2"/*.o | awk 'NR > 1 { t += $1 } END { print t + 0 }'
}

measure_machine() { # NAME OPT
  # shellcheck disable=SC2046
  ! has_target "$1" "size of $1" || measure_code "$1" "$2" $(sh tests/target/target.sh flags "$1")
}

measure_code() { # NAME OPT CC FLAGS...
  what=$1-${2#-} cc=$3
  compile "$@" || { fail "$what: rt does not build"; return; }
  size=${cc%gcc}size
  bytes='' sum=0
  for part in $folders; do
    one=$(folder_bytes "$size" "$folder/rt/$part")
    bytes="$bytes $one"
    sum=$((sum + one))
    [ "$cc" = gcc ] || echo "code.$what.$part $one $cc" >>"$measured"
  done
  data=$("$size" "$folder/libfray.a" | awk 'NR > 1 { d += $2 } END { print d + 0 }')
  bss=$("$size" "$folder/libfray.a" | awk 'NR > 1 { b += $3 } END { print b + 0 }')
  [ "$cc" = gcc ] || echo "code.$what.rt $sum $cc" >>"$measured"
  # shellcheck disable=SC2086
  code_row "$what" $bytes $sum "$data" "$bss"
  if [ "$data" -eq 0 ] && [ "$bss" -eq 0 ]; then pass; else fail "$what: rt has data or bss"; fi
}

# Instructions and constants of the code, start-up and helpers too; images and logs are not in .text.
measure_firmware() { # OPT
  sh tests/target/target.sh needs m3 >/dev/null || return 0
  for what in meshes sheets woven; do
    firmware m3 "$1" $what
    bytes=$(arm-none-eabi-size -A "$stack_work/m3-$1.elf" | awk '$1 == ".text" { print $2 }')
    echo "  m3$1: a whole firmware of $what has $bytes bytes of instructions"
    [ $what = woven ] && of='' || of=_$what
    echo "code.m3$1.firmware$of $bytes arm-none-eabi-gcc" >>"$measured"
  done
}

# Every pool as large as it can be of use: a second particle for each crossing, a contact for each
# particle, the most cuts; two hands and a body to touch.
scene() { # WARPS WEFTS
  cat <<SCENE
scene sheet
rate 1000 Hz
substeps 8
gravity 0 -981 0 cm/s2
woven {
  warps $1
  wefts $2
  spacing 12 /cm
  density 0.25 g/cm2
  thickness 0.01 cm
  structural 6000 g/s2
  bend 5 g/s2
  shear 2 g/s2
  tear 5 10 %
}
sphere left {
  radius 0.1 cm
  at $(half "$1" -) $(half "$2" '') 0 cm
  move hand left
  attach_within 0.02 cm
}
sphere right {
  radius 0.1 cm
  at $(half "$1" '') $(half "$2" '') 0 cm
  move hand right
  attach_within 0.02 cm
}
sphere under {
  radius 0.1 cm
  at 0 -5 0 cm
}
limits {
  spare_particles $(($1 * $2))
  contacts $(($1 * $2 * 2))
  tears_per_tick 64
}
SCENE
}
half() { awk -v n="$1" -v sign="$2" 'BEGIN { printf "%s%.4f", sign, (n - 1) / 24 }'; } # cm

pool_table() { # POOLS
  printf '  %-12s' array
  # shellcheck disable=SC2086
  printf ' %9s' $sheets
  printf '\n'
  awk -v sheets="$sheets" '
    $1 == "world" { total[$2] = $3 }
    $1 == "pool" {
      if (!($3 in known)) order[++arrays] = $3
      known[$3] = 1
      ram[$3, $2] = $5 == "ram" ? $4 : 0
      if ($5 == "ram") { taken[$2] += $4; any[$3] += $4 } else flash[$2] += $4
    }
    function line(label, values, n) { printf "  %-12s", label; for (n = 1; n <= count; ++n) printf " %9d", values[sheet[n]]; printf "\n" }
    END {
      count = split(sheets, sheet, " ")
      for (a = 1; a <= arrays; ++a) {
        if (any[order[a]] == 0) continue
        for (n = 1; n <= count; ++n) one[sheet[n]] = ram[order[a], sheet[n]]
        line(order[a], one)
      }
      for (n = 1; n <= count; ++n) rest[sheet[n]] = total[sheet[n]] - taken[sheet[n]]
      line("world, gaps", rest)
      line("RAM", total)
      line("in flash", flash)
    }' "$1"
}

measure_ram() {
  if ! packages=$(sh tests/target/target.sh needs m3); then
    not_run "RAM of a world" "$packages"
    return
  fi
  set --
  for sheet in $sheets; do
    scene "${sheet%x*}" "${sheet#*x}" >"$work/$sheet.scene"
    "$FRAY" scene "$work/$sheet.scene" -o "$work/$sheet.img" >/dev/null
    set -- "$@" "s$sheet" "$work/$sheet.img" - - 1
  done
  suite_make BUILD="$FRAY_BUILD" "$FRAY_BUILD/tests/determinism/emit_cases"
  "$FRAY_BUILD/tests/determinism/emit_cases" "$@" | sed 's/"s\([0-9]*x[0-9]*\)"/"\1"/' >"$work/sheets.c"
  sh tests/target/target.sh build m3 -O2 "$work/pools.elf" tests/budget/pools.c "$work/sheets.c" \
    tests/target/port_bare.c platform/loop.c rt/*/*.c -DFRAY_TRIANGLES=0 -Wl,--unresolved-symbols=ignore-all ||
    { fail "the program that asks for pools does not build"; return; }
  if sh tests/target/target.sh run m3 "$work/pools.elf" >"$work/pools.txt"; then pass; else fail "pools: $(tail -n 1 "$work/pools.txt")"; fi
  echo "  RAM of a world, bytes, 16-bit ids, every spare, without code for membranes:"
  pool_table "$work/pools.txt"
  awk '$1 == "world" { print "ram." $2, $3, "arm-none-eabi-gcc" } $1 == "loop" { print "ram.loop", $2, "arm-none-eabi-gcc" }' \
    "$work/pools.txt" >>"$measured"
  loop=$(awk '$1 == "loop" { print $2 }' "$work/pools.txt")
  world=$(awk '$2 == "8x8" { print $3; exit }' "$work/pools.txt")
  echo "  8x8 with what runs it: $world world + $loop loop and port + $stack_max stack"
  measure_microbit "$world"
}

# The 8x8 sheet with the whole firmware inside the 16 KiB that the linker script allows, and run.
measure_microbit() { # BYTES of its world
  elf=$work/microbit.elf
  suite_make BUILD="$FRAY_BUILD" "$FRAY_BUILD/tests/determinism/emit_cases"
  "$FRAY_BUILD/tests/determinism/emit_cases" sheet "$work/8x8.img" "$stack_work/torn.log" 1:680:720 1050 >"$work/microbit.c"
  if ! sh tests/target/target.sh firmware microbit -Os "$elf" tests/stack/firmware.c "$work/microbit.c" \
    platform/loop.c rt/*/*.c -DFIRMWARE_MEMORY="$1" -DFIRMWARE_SAVES=0 -DFRAY_TRIANGLES=0 -DFRAY_STRETCH=0; then
    fail "8x8 does not fit a microbit"
    return
  fi
  if sh tests/target/target.sh run microbit "$elf" >"$elf.out"; then pass; else fail "microbit: $(tail -n 1 "$elf.out")"; fi
  all=$(arm-none-eabi-size -A "$elf" | awk '$1 == ".stack" || $1 == ".data" || $1 == ".bss" { t += $2 } END { print t }')
  echo "  8x8 on a microbit: $all bytes of stack, data and world; $(tr '\n' ' ' <"$elf.out")"
  echo "ram.8x8.microbit $all arm-none-eabi-gcc" >>"$measured"
}

# shellcheck disable=SC2086
code_row machine $folders rt data bss
firmware_cases
for row in $(sh tests/part.sh share "${PART:-1/1}" $rows); do
  case $row in
    ram) measure_ram ;;
    firmware-*) measure_firmware "-${row#*-}" ;;
    host-*) ! have gcc || measure_code "$(uname -m)" "-${row#*-}" gcc -fno-pie ;;
    *) measure_machine "${row%-*}" "-${row#*-}" ;;
  esac
done
for prefix in code. ram.; do
  if sh tests/budget/budget.sh $prefix "$measured" ${1:+"$1"}; then pass; else fail "budgets of $prefix"; fi
done
suite_end
