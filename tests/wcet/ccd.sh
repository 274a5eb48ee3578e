#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# ccd.sh: instructions of continuous collision detection (rt/geometry/ccd.h) on small targets: of calls by
# family of pairs (tests/physics/moving_pairs.h), and the bound of any call, from the longest paths of the
# compiled code. MACHINES="m3 rv32" picks.
. tests/lib/suite.sh

work=$FRAY_BUILD/work
machines=${MACHINES:-m0 m3 rv32}
mkdir -p "$work"
suite_make BUILD="$FRAY_BUILD" "$FRAY_BUILD/tests/wcet/longest_path"
${CC:-cc} -std=c11 -O2 -Wall -Wextra -Werror -shared -fPIC tests/wcet/stage_count.c \
  -o "$work/stage_count.so"

count() { # MACHINE
  elf=$work/sweep_$1.elf
  sh tests/target/target.sh build "$1" -O2 "$elf" -g tests/wcet/ccd_main.c \
    tests/target/port_bare.c rt/base/*.c rt/geometry/*.c || return 1
  case $1 in rv32) tools=riscv64-unknown-elf ;; *) tools=arm-none-eabi ;; esac
  $tools-nm -S "$elf" | awk 'NF == 4 { print $1, $2, $4 }' >"$work/sweep_$1.symbols"
  sh tests/target/target.sh run "$1" "$elf" >"$work/sweep_$1.lines" -plugin \
    "$work/stage_count.so,plain=1,symbols=$work/sweep_$1.symbols,out=$work/sweep_$1.counts" || return 1
  $tools-objdump -d -l --no-show-raw-insn "$elf" >"$work/sweep_$1.dis"
  cat tests/wcet/ccd_loops.txt tests/wcet/loops_m0.txt >"$work/ccd_loops.txt"
  "$FRAY_BUILD/tests/wcet/longest_path" "$work/ccd_loops.txt" . ccd_edges ccd_point_triangle \
    <"$work/sweep_$1.dis" >"$work/sweep_$1.bound"
}
constant() { sed -n "s/^ *$1 = \([0-9]*\),.*/\1/p" rt/geometry/ccd.c; }

for machine in $machines; do
  if ! packages=$(sh tests/target/target.sh needs "$machine"); then
    not_run "sweep on $machine" "$packages"
  elif ! count "$machine"; then
    fail "sweep on $machine: it does not build or run: $(tail -n 3 "$work/sweep_$machine.lines")"
  else
    if awk -v machine="$machine" -v halvings="$(constant HALVINGS)" -v looks="$(constant LOOKS)" '
      FILENAME ~ /bound$/ {
        rounds = $1 == "fixed" ? 1 : $3 == "halvings" ? halvings : $3 == "looks" ? looks : 1 + halvings + looks
        bound[$2] += rounds * $NF
        next
      }
      FILENAME ~ /counts$/ { if (FNR % 2 == 0) spent[++pieces] = $1; next }
      $3 == "none" || $3 == "contact" {
        k = $1 " " $2
        if (!(k in seen)) { seen[k] = 1; name[++names] = k }
        v = spent[++line]
        calls[k, $3]++; sum[k, $3] += v; sum[k] += v; calls[k]++
        if (v > most[k, $3]) most[k, $3] = v
        if (v > worst) worst = v
      }
      END {
        printf "  %s, instructions: %-28s %5s | %5s %7s | %5s %7s\n", machine, "family", "mean", "none", "worst", "hit", "worst"
        for (n = 1; n <= names; n++) {
          k = name[n]
          printf "  %-46s %5d | %5d %7d | %5d %7d\n", k, sum[k] / calls[k], \
            calls[k, "none"] ? sum[k, "none"] / calls[k, "none"] : 0, most[k, "none"], \
            calls[k, "contact"] ? sum[k, "contact"] / calls[k, "contact"] : 0, most[k, "contact"]
        }
        limit = bound["ccd_edges"]
        if (bound["ccd_point_triangle"] > limit) limit = bound["ccd_point_triangle"]
        printf "  %s: worst seen %d, bound of any call %d\n", machine, worst, limit
        exit worst > limit || names == 0
      }' "$work/sweep_$machine.bound" "$work/sweep_$machine.counts" "$work/sweep_$machine.lines"; then
      pass
    else
      fail "sweep on $machine: a call above its bound"
    fi
  fi
done
suite_end
