#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# stack.sh [update]: the deepest stack of a whole firmware (start-up, runtime, wire, loop, board,
# helpers of libgcc) by its call graph, machine by machine, against tests/budget; fails on recursion,
# on frames that are not static, on indirect calls, on a frame that the instructions contradict, and
# where the mark on a painted stack is not between 60 and 100 % of the bound. PART=2/8: the second of eight parts
# of its rows.
. tests/lib/suite.sh
. tests/stack/firmware.sh

measured=$stack_work/measured.txt
rows="m0-O2 m3-O2 m33-O2 rv32-O2 m3-Os m3-O2-sheets m3-O2-meshes host m3-Os-sheets m3-Os-meshes"

# An exception pushes this before its handler runs: 8 words and one of alignment, with an FPU 26.
# The tick's may come at the deepest point, and a fault in it.
machine() { # NAME: sets prefix, top, tops, handler, entry
  prefix=arm-none-eabi- top=reset_handler tops=' fault_handler ' handler=systick_handler entry=36
  case $1 in
    m33 | m4f | m7f) entry=108 ;;
    rv32) # the tick wakes and does not interrupt; a trap starts at the top
      prefix=riscv64-unknown-elf- top=reset tops=' reset others trap ' handler='' entry=0 ;;
  esac
}

graph() { # X.elf: its bounds
  "${prefix}objdump" -d --no-show-raw-insn "$1" | awk -f tests/stack/disassembly.awk >"$1.calls"
  "${prefix}nm" "$1" >"$1.names"
  cat "$1"-*.ci | awk -f tests/stack/callgraph.awk |
    awk -v tops="$tops" -v roots="$2" -f tests/stack/deepest.awk - "$1.calls" "$1.names"
}

bound_of() { awk -v root="$1" '$1 == "bound" && $2 == root { print $3 }' "$2"; }
complaints() { # WHAT RESULT
  grep '^FAILED ' "$2" >"$2.bad" || true
  if [ -s "$2.bad" ]; then fail "$1: $(cat "$2.bad")"; else pass; fi
}

print_path() { # ROOT RESULT
  awk -v root="$1" '$1 == "bound" { on = $2 == root; if (on) printf "  %s %d:", $2, $3 }
    $1 == "path" && on { printf " %s %d", $3, $2 } END { printf "\n" }' "$2"
}

row() { printf '  %-9s %9s %9s %9s %9s %9s %9s %9s %6s\n' "$@"; }

measure() { # NAME OPT
  machine "$1"
  what=$1-${2#-}
  elf=$stack_work/$1-$2.elf
  result=$elf.bounds
  has_target "$1" "stack of $what" || return 0
  firmware "$1" "$2" || { fail "$what: the firmware does not build"; return; }
  graph "$elf" "$top main loop_run fray_tick fray_open $handler bare_fault" >"$result" || true
  complaints "$what" "$result"
  handler_bytes=0
  [ -z "$handler" ] || handler_bytes=$(bound_of "$handler" "$result")
  interrupts=$((2 * entry + handler_bytes))
  bound=$(($(bound_of "$top" "$result") + interrupts))
  if sh tests/target/target.sh run "$1" "$elf" >"$elf.out"; then pass; else fail "$what: $(tail -n 1 "$elf.out")"; fi
  mark=$(awk '$1 == "stack" { print $2 }' "$elf.out")
  mark=${mark:-0}
  row "$what" "$(bound_of fray_tick "$result")" "$(bound_of fray_open "$result")" \
    "$(bound_of loop_run "$result")" "$(bound_of main "$result")" "$interrupts" "$bound" "$mark" \
    "$((100 * mark / bound))%"
  if [ "$mark" -le "$bound" ] && [ $((mark * 100)) -ge $((bound * 60)) ]; then
    pass
  else
    fail "$what: a mark of $mark bytes is not between 60 and 100 % of the bound, $bound"
  fi
  {
    echo "stack.$what.bound $bound ${prefix}gcc"
    echo "stack.$what.tick $(bound_of fray_tick "$result") ${prefix}gcc"
    echo "stack.$what.open $(bound_of fray_open "$result") ${prefix}gcc"
  } >>"$measured"
}

# With membranes, by the call graph alone: the cases have none, so no mark would tell.
measure_more() { # NAME OPT WHAT MOST
  machine "$1"
  sh tests/target/target.sh needs "$1" >/dev/null || return 0
  what="$1${2} with $3"
  firmware "$1" "$2" "$3" || { fail "$what: the firmware does not build"; return; }
  elf=$stack_work/$1-$2.elf
  graph "$elf" "$top fray_tick fray_open loop_run main $handler bare_fault" >"$elf.more" || true
  complaints "$what" "$elf.more"
  bound=$(($(bound_of "$top" "$elf.more") + 2 * entry + $(bound_of "$handler" "$elf.more")))
  row "$1$2 $3" "$(bound_of fray_tick "$elf.more")" "$(bound_of fray_open "$elf.more")" \
    "$(bound_of loop_run "$elf.more")" "$(bound_of main "$elf.more")" - "$bound" - -
  if [ "$bound" -le "$4" ]; then pass; else fail "$what: $bound bytes, at most $4"; fi
}

# The frames alone, as gcc tells them; the C library's own are not known.
measure_host() {
  host=$(uname -m)
  have gcc || { not_run "stack of $host" gcc; return; }
  rm -rf "$stack_work/host"
  mkdir -p "$stack_work/host"
  for file in rt/*/*.c platform/loop.c; do
    gcc -std=c11 -O2 -I. -DFRAY_TRIANGLES=0 -fcallgraph-info=su,da -c "$file" -o "$stack_work/host/$(echo "$file" | tr / -).o"
  done
  result=$stack_work/host/bounds
  cat "$stack_work"/host/*.ci | awk -f tests/stack/callgraph.awk |
    awk -v roots="loop_run fray_tick fray_open" -f tests/stack/deepest.awk >"$result"
  complaints "$host" "$result"
  row "$host" "$(bound_of fray_tick "$result")" "$(bound_of fray_open "$result")" \
    "$(bound_of loop_run "$result")" - - - - -
  echo "  $host without: $(awk '$1 == "outside" { print $2 }' "$result" | sort | tr '\n' ' ')"
}

# What must be found is found: NAME WORDS BODY
check_finding() {
  printf 'int main(void);\nvolatile int v;\n%s\n' "$3" >"$stack_work/$1.c"
  rm -f "$stack_work/$1.elf"*
  sh tests/target/target.sh build m3 -O2 "$stack_work/$1.elf" "$stack_work/$1.c" -fcallgraph-info=su,da || true
  graph "$stack_work/$1.elf" main >"$stack_work/$1.found" || true
  if grep -q "^FAILED $2" "$stack_work/$1.found"; then pass; else fail "$1 was not found: $(cat "$stack_work/$1.found")"; fi
}
check_findings() {
  machine m3
  check_finding recursion "recursion: " \
    '__attribute__((noinline)) static int odd(int n); __attribute__((noinline)) static int even(int n) { return n == 0 ? v : odd(n - 1) + v; } static int odd(int n) { return n == 0 ? 0 : even(n - 1) + v; } int main(void) { return even(v); }'
  check_finding dynamic "a frame that is not static: " \
    'static void use(volatile char *p) { *p = 0; } int main(void) { volatile char a[v]; use(a); return a[v / 2]; }'
  check_finding pointer "an indirect call that is not resolved: main" \
    'int (*volatile f)(int); int main(void) { return f(v) + 1; }'
  check_finding tail "an indirect call that is not resolved: main" \
    'int (*volatile f)(int); int main(void) { return f(v); }'
  check_finding assembly "a frame that nobody knows: shrink" \
    '__asm__(".thumb_func\n.type shrink, %function\nshrink: sub sp, r0\nadd sp, r0\nbx lr\n"); int shrink(int n); int main(void) { return shrink(v); }'
}

firmware_cases
: >"$measured"
row machine fray_tick fray_open loop_run main interrupt bound painted mark
rm -f "$stack_work"/*.bounds
# shellcheck disable=SC2086
for row in $(sh tests/part.sh share "${PART:-1/1}" $rows); do
  opt=${row#*-}
  case $row in
    host) measure_host ;;
    *-sheets) measure_more "${row%%-*}" "-${opt%-*}" sheets 2048 ;;
    *-meshes) measure_more "${row%%-*}" "-${opt%-*}" meshes 4096 ;;
    *) measure "${row%-*}" "-$opt" ;;
  esac
done
if sh tests/target/target.sh needs m3 >/dev/null; then
  machine m3
  check_findings
fi
if [ -f "$stack_work/m3--O2.elf.bounds" ]; then
  echo "  deepest paths, m3-O2, bytes:"
  for root in fray_tick fray_open loop_run main; do print_path $root "$stack_work/m3--O2.elf.bounds"; done
fi
if sh tests/budget/budget.sh stack. "$measured" ${1:+"$1"}; then pass; else fail "budgets of the stack"; fi
suite_end
