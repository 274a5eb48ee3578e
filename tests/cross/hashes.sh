#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# hashes.sh [short|full|update]: the same hash and the same outputs after every tick, on every
# machine, with every compiler and option of configs.sh, as tests/golden says.
# `update` writes tests/golden anew from gcc -O2: a commit of its own, that says why.
. tests/lib/suite.sh
. tests/cross/configs.sh

mode=${1:-short}
work=$FRAY_BUILD/cross/replay
golden=tests/golden
cases="small torn bodies"
mkdir -p "$work"

# Time, interface, id#data: the right hand of `torn` is silent for 40 ms, and its COMMANDs go on.
silence() { awk '!($3 ~ /^102#/ && $1 >= "(1000000000.680000)" && $1 < "(1000000000.720000)")'; }

prepare() {
  "$FRAY" hand -o "$work/small.log" tests/cross/small.hand
  "$FRAY" hand -o "$work/torn.all.log" tests/cross/torn.hand
  silence <"$work/torn.all.log" >"$work/torn.log"
  "$FRAY" scene tests/scenes/small.scene -o "$work/small.img" >/dev/null
  "$FRAY" scene tests/cross/torn.scene -o "$work/torn.img" >/dev/null
  "$FRAY" scene tests/cross/bodies.scene -o "$work/bodies.img" >/dev/null
  suite_make BUILD="$FRAY_BUILD" "$FRAY_BUILD/tests/cross/emit"
  "$FRAY_BUILD/tests/cross/emit" small "$work/small.img" "$work/small.log" 800 \
    torn "$work/torn.img" "$work/torn.log" 1050 bodies "$work/bodies.img" - 600 >"$work/new.c"
  # keep the old one where nothing changed, so that nothing is built again
  cmp -s "$work/new.c" "$work/cases.c" || cp "$work/new.c" "$work/cases.c"
}

build() { # NAME: the program is $work/NAME
  config_make "$1" libfray.a || return 1
  library=$FRAY_BUILD/cross/$1/libfray.a
  case $1 in
    m3-*)
      sh tests/target/target.sh build m3 "$OPT" "$work/$1" tests/cross/replay_main.c \
        "$work/cases.c" tests/target/port_bare.c "$library" -Wl,-Map="$work/$1.map" ;;
    *)
      # shellcheck disable=SC2086
      $CC -std=c11 -Wall -Wextra -Werror -I. $OPT $EXTRA tests/cross/replay_main.c "$work/cases.c" \
        tests/cross/port_stdio.c "$library" -o "$work/$1" ;;
  esac
}

# Golden files in the form that replay_main prints.
expected() {
  for name in $cases; do
    echo "case $name"
    grep -v '^#' "$golden/$name.txt"
    echo "restored same"
  done
  echo end
}

# expected, found: `N` ticks compared and `same`, or where they part
compare() {
  awk 'NR == FNR { want[NR] = $0; lines = NR; next }
       FNR > lines || $0 != want[FNR] { if (bad == "") bad = name " " $1 " " $2; next }
       $1 == "case" { name = $2 }
       $1 ~ /^[0-9]+$/ { if (bad == "") ticks++ }
       END { if (bad == "" && FNR < lines) bad = "the end is missing"
             printf "%d %s\n", ticks, bad == "" ? "same" : "first difference: " bad }' "$1" "$2"
}

row() { printf '  %-14s %10s  %s\n' "$1" "$2" "$3"; }

check_config() {
  if ! config "$1"; then
    row "$1" - "not run"
    not_run "hashes of $1" "$PACKAGES"
    return
  fi
  if ! build "$1"; then
    row "$1" - "does not build"
    fail "hashes of $1: it does not build"
    return
  fi
  # shellcheck disable=SC2086
  timeout 300 $RUN "$work/$1" >"$work/$1.out" 2>&1 </dev/null || echo "exit $?" >>"$work/$1.out"
  grep -v '^memory ' "$work/$1.out" >"$work/$1.txt" || true
  result=$(compare "$work/expected.txt" "$work/$1.txt")
  row "$1" "${result%% *}" "${result#* }"
  case $result in
    *" same") pass ;;
    *) fail "hashes of $1: ${result#* }" ;;
  esac
}

update() {
  config gcc-O2 && build gcc-O2
  "$work/gcc-O2" | grep -v '^memory ' >"$work/gcc-O2.txt"
  for name in $cases; do
    {
      echo "# After every tick: the hash of the state, a digest of the outputs. Made by make golden-update."
      awk -v name="$name" '$1 == "case" { on = $2 == name; next } $1 == "restored" { on = 0 } on' \
        "$work/gcc-O2.txt"
    } >"$golden/$name.txt"
    echo "$golden/$name.txt: $(grep -c '^[0-9]' "$golden/$name.txt") ticks"
  done
}

# What `make run` records, verified on other machines: full only, it takes minutes.
check_run() {
  two=$work/two_hands
  "$FRAY" scene tests/scenes/two_hands.scene -o "$two.img" >/dev/null
  "$FRAY" run "$two.img" --log tests/scenes/two_hands.log --record "$two.log" >/dev/null
  for name in gcc-O0 clang-O3 i386-O2 s390x-O2; do
    config "$name" || { not_run "verify two_hands on $name" "$PACKAGES"; continue; }
    config_make "$name" fray
    if said=$($RUN "$FRAY_BUILD/cross/$name/fray" verify "$two.log" --scene "$two.img"); then
      pass
    else
      fail "two_hands on $name: $said"
    fi
    row "$name" two_hands "$said"
  done
  "$FRAY_BUILD/tests/cli/alter" pose "$two.log" 1500 0 1 >"$work/pose.log"
  said=$("$FRAY" verify "$work/pose.log" --scene "$two.img") || true
  case $said in
    "tick 1500 differs"*) pass ;;
    *) fail "one bit of a pose of tick 1500 changed: $said" ;;
  esac
}

prepare
if [ "$mode" = update ]; then
  update
  exit 0
fi
expected >"$work/expected.txt"
row configuration ticks "every tick against tests/golden"
list=$CONFIGS_SHORT
[ "$mode" = short ] || list=$CONFIGS_FULL
for name in $list; do check_config "$name"; done
[ "$mode" = short ] || check_run
suite_end
