#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# figures.sh [NAME...]: runs the scenes of list.txt, or some of them, and writes their pictures to
# out/figures/NAME and a contact sheet of each to out/figures/NAME.png. Every scene must tear and fray, and
# must not fray with its yarns off; without its shear lock, as the paper has it, it is printed beside; its work
# keeps to the image's bound, and events to a quarter of it; its contact sheet is the same to the byte a second
# time, with scalar kernels. Sheets of triangles must tear,
# or stay whole where the list says so, without a fault, and give the same contact sheet. Where two hands tear one, its
# log is what `fray hand` makes of the script beside it, and the force has three phases: an elastic rise, R2 at least
# 0.98; a peak; a plateau at 20 to 80 % of it that varies by at most 20 %. out/figures/NAME_force.png plots both hands.
# SIZE is WIDTHxHEIGHT.
# UPDATE=update writes the figures to tests/results.tsv.
. tests/lib/suite.sh

list=tests/figures/list.txt
out=out/figures
size=${SIZE:-1600x900}
work=$FRAY_BUILD/figures
mkdir -p "$out" "$work"

for name in "$@"; do
  if ! grep -q "^$name " "$list"; then
    echo "figures.sh: no figure '$name' in $list" >&2
    exit 2
  fi
done

# The number that PATTERN marks in the last run's summary.
said() { sed -n "s/^$1.*/\\1/p" "$work/run.txt"; }
# EXPRESSION: whether it holds
is_true() { awk "BEGIN { exit !($1) }"; }

render() { # OUT [OPTION...]
  to=$1
  shift
  # shellcheck disable=SC2086
  "$FRAY" render "$scene" $input --at "$at" --for "$length" --view "$view" --focus "$focus" \
    --size "$size" $styles "$@" -o "$to" </dev/null >"$work/render.txt"
}

run() { # SCENE
  # shellcheck disable=SC2086
  "$FRAY" run "$1" $input --ticks "${length%ms}" </dev/null >"$work/run.txt"
}

pictures() { # twice: with the best kernels, with scalar ones
  rm -rf "${out:?}/$name" "$work/again"
  render "$out/$name" && render "$work/again" --kernel scalar || return 1
  mv "$out/$name/sheet.png" "$out/$name.png"
}

one_figure() {
  run "$scene" || return 1
  fray=$(said 'fray *\([0-9.]*\) cm of loose')
  open=$(said 'fray .* open \([0-9.]*\) cm wide')
  tears=$(sed -n 's/^hash .* tears \([0-9]*\) .*/\1/p' "$work/run.txt")
  intact=$(said 'work intact .* worst \([0-9.]*\) times')
  torn=$(said 'work torn .* worst \([0-9.]*\) times')
  events=$(said 'work worst .*; events \([0-9.]*\) %')
  events_most=$(said 'work worst .* at most \([0-9.]*\) %')
  beyond=$(said 'work worst .*; \([0-9]*\) ticks beyond')
  sed 's/^  yarns on$/  yarns off/' "$scene" >"$work/off.scene"
  run "$work/off.scene" || return 1
  off=$(said 'fray *\([0-9.]*\) cm of loose')
  sed '/^  shear_lock /d' "$scene" >"$work/paper.scene"
  run "$work/paper.scene" || return 1
  paper=$(said 'fray *\([0-9.]*\) cm of loose')
  pictures
}

# The figures of the line of a hand in the last run's summary.
phases() { # HAND
  sed -n "s/^tearing *$1 *rise .*, R2 \([0-9.]*\); peak \([0-9.]*\) N .* goes on at \([0-9.]*\) N, \([0-9.]*\) % .* by \([0-9.]*\) %/\1 \2 \3 \4 \5/p" \
    "$work/run.txt"
}

one_cloth() {
  # shellcheck disable=SC2086
  "$FRAY" run "$scene" $input ${input:+--report "$work/report"} --ticks "${length%ms}" </dev/null >"$work/run.txt" || return 1
  if [ -n "$input" ]; then
    "$FRAY" hand -o "$work/hand.log" "${log%.log}.hand" && cp "$work/report/tearing.png" "$out/${name}_force.png" || return 1
  fi
  tears=$(sed -n 's/^hash .* tears \([0-9]*\) .*/\1/p' "$work/run.txt")
  faults=$(sed -n 's/^hash .* faults \([0-9]*\).*/\1/p' "$work/run.txt")
  pictures
}

judge_cloth() {
  printf '%-13s %6s\n' "$name" "$tears"
  holds "$name: tears $tears ${fate:-torn}, faults $faults" is_true "($tears > 0) == (\"$fate\" != \"whole\") && $faults == 0"
  holds "$name: another picture" cmp -s "$out/$name.png" "$work/again/sheet.png"
  [ -z "$input" ] || judge_hands
}

judge_hands() {
  holds "$name: its log is not that of its script" cmp -s "$log" "$work/hand.log"
  for hand in left right; do
    # shellcheck disable=SC2046
    set -- $(phases $hand)
    [ $# -eq 5 ] || { fail "$name: no phases of a tear at the $hand hand"; continue; }
    printf '  %-5s rise R2 %s, peak %s N, goes on at %s N, %s %% of it, varies by %s %%\n' "$hand" "$@"
    holds "$name, $hand: R2 $1" is_true "$1 >= 0.98"
    holds "$name, $hand: goes on at $4 % of the peak" is_true "$4 >= 20 && $4 <= 80"
    holds "$name, $hand: varies by $5 %" is_true "$5 <= 20"
    save "$hand.rise_r2" "$1" ''
    save "$hand.peak" "$2" N
    save "$hand.plateau" "$3" N
    save "$hand.share" "$4" %
    save "$hand.variation" "$5" %
  done
}

save() { # COLUMN VALUE UNIT
  [ "${UPDATE:-}" != update ] || sh tests/results.sh set "figures.$name.$1" "$2" "$3" 'make figures UPDATE=update'
}

judge() {
  save tears "$tears" ''
  save loose_ends "$fray" cm/cm
  save open "$open" cm
  save off "$off" cm/cm
  save paper "$paper" cm/cm
  save intact "$intact" ''
  save torn "$torn" ''
  save events "$events of $events_most %" ''
  printf '%-13s %6s %6s %6s %7s %7s %8s %8s %9s\n' "$name" "$tears" "$fray" "$paper" "$open" "$off" "$intact" "$torn" \
    "$events of $events_most"
  holds "$name: does not tear or fray" is_true "$tears > 0 && $fray > 0.1"
  holds "$name: frays without yarns" is_true "$off == 0"
  holds "$name: work" is_true "$beyond == 0 && $events_most <= 25"
  holds "$name: another picture" cmp -s "$out/$name.png" "$work/again/sheet.png"
}

echo '                     loose ends, of    open  without   worst of median      events, %'
echo '                     this the paper'
printf '%-13s %6s %6s %6s %7s %7s %8s %8s %9s\n' figure tears cm/cm cm/cm cm yarns intact torn 'of bound'
while read -r name scene log times focus view looks fate; do
  case $name in '' | '#'*) continue ;; esac
  case " $* " in *" $name "* | '  ') ;; *) continue ;; esac
  case $scene in
  *:*)
    sed "s/^  material .*/  material ${scene#*:}/" "${scene%%:*}" >"$work/$name.scene"
    scene=$work/$name.scene
    ;;
  esac
  input=''
  if [ "$log" != - ]; then input="--log $log"; fi
  at=$(echo "$times" | sed 's/,/ms,/g')ms
  length=${times##*,}ms
  styles=''
  if [ "$looks" != - ]; then styles="--$(echo "$looks" | sed 's/,/ --/g')"; fi
  if grep -q '^membrane' "$scene"; then
    if one_cloth; then judge_cloth; else fail "$name: no run or no pictures"; fi
  elif one_figure; then
    judge
  else
    fail "$name: no run or no pictures"
  fi
done <"$list"
suite_end
