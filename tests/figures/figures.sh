#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# figures.sh [NAME...]: runs the scenes of list.txt, or some of them, and writes their pictures to
# out/figures/NAME and a contact sheet of each to out/figures/NAME.png. Every scene must tear.
# SIZE is WIDTHxHEIGHT of the pictures.
. tests/lib/suite.sh

list=tests/figures/list.txt
out=out/figures
size=${SIZE:-1600x900}
mkdir -p "$out"

for name in "$@"; do
  if ! grep -q "^$name " "$list"; then
    echo "figures.sh: no figure '$name' in $list" >&2
    exit 2
  fi
done

printf '%-14s %9s %9s %7s %6s\n' figure yarns simulated seconds tears
while read -r name scene log length frames focus view looks; do
  case $name in '' | '#'*) continue ;; esac
  case " $* " in *" $name "* | '  ') ;; *) continue ;; esac
  wishes="--for $length --frames $frames --view $view --size $size --$(echo "$looks" | sed 's/,/ --/g')"
  if [ "$log" != - ]; then wishes="$wishes --log $log"; fi
  if [ "$focus" != - ]; then wishes="$wishes --focus $focus"; fi
  rm -rf "${out:?}/$name"
  began=$(date +%s)
  # shellcheck disable=SC2086
  if ! said=$("$FRAY" render "$scene" $wishes -o "$out/$name" </dev/null); then
    fail "$name: no pictures"
    continue
  fi
  mv "$out/$name/sheet.png" "$out/$name.png"
  tears=$(echo "$said" | sed -n 's/.* \([0-9]*\) tears$/\1/p')
  yarns=$(sed -n 's/^ *warps //p' "$scene")x$(sed -n 's/^ *wefts //p' "$scene")
  printf '%-14s %9s %9s %7s %6s\n' "$name" "$yarns" "$length" $(($(date +%s) - began)) "$tears"
  if [ "${tears:-0}" -gt 0 ]; then pass; else fail "$name: nothing tears"; fi
done <"$list"
suite_end
