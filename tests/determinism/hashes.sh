#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# hashes.sh [short|full|update|only NAME...]: the same hash and the same outputs after every tick, on
# every machine, with every compiler and option of configs.sh, as tests/golden says. One row a
# configuration, JOBS of them at a time.
# `full` compares what the command makes on other machines too: images, and a run of `make run`. PART=2/8: the
# second of eight parts of the configurations of `short` or `full`.
# `update` writes tests/golden anew from gcc -O2: a commit of its own, that says why.
. tests/lib/suite.sh
. tests/determinism/configs.sh

mode=${1:-short}
[ $# -eq 0 ] || shift
work=$FRAY_BUILD/cross/replay
golden=tests/golden
id_header=rt/image/physics_id.h
cases="small torn bodies matrix8 mirror8 auto_steps twill16 satin24 frayed allyarn stretched membrane_tear meshes contact_triangles blade_cut yarn_collision triangle_collision cracked"
tiny="small matrix8 mirror8" # what 16 KiB of RAM hold
mkdir -p "$work"

case_scene() { case $1 in small) echo tests/scenes/small.scene ;; *) echo "tests/determinism/$1.scene" ;; esac; }
case_ticks() {
  case $1 in
    small) echo 800 ;; torn) echo 1050 ;; bodies) echo 600 ;; # frozen
    matrix8) echo 400 ;; mirror8 | auto_steps) echo 60 ;; twill16) echo 500 ;; satin24) echo 300 ;;
    frayed | cracked) echo 300 ;; allyarn) echo 150 ;; stretched) echo 250 ;; membrane_tear) echo 250 ;; meshes) echo 200 ;; contact_triangles | yarn_collision) echo 150 ;; blade_cut) echo 120 ;; triangle_collision) echo 300 ;;
  esac
}

# HAND:FROM:TO: ticks without poses of that hand, which lead to SAFE
case_silence() { case $1 in torn) echo 1:680:720 ;; twill16) echo 0:300:340 ;; *) echo - ;; esac; }

write_table() { # FILE CASE...
  table=$1 words=''
  shift
  for name in "$@"; do
    log=$work/$name.log
    [ -f "$log" ] || log=-
    words="$words $name $work/$name.img $log $(case_silence "$name") $(case_ticks "$name")"
  done
  # shellcheck disable=SC2086
  "$FRAY_BUILD/tests/determinism/emit_cases" $words >"$work/new.c"
  # keep the old one where nothing changed, so that nothing is built again
  cmp -s "$work/new.c" "$table" || cp "$work/new.c" "$table"
}

prepare() {
  for name in $cases; do
    "$FRAY" scene "$(case_scene "$name")" -o "$work/$name.img" >/dev/null
    [ ! -f "tests/determinism/$name.hand" ] || "$FRAY" hand -o "$work/$name.log" "tests/determinism/$name.hand"
  done
  suite_make BUILD="$FRAY_BUILD" "$FRAY_BUILD/tests/determinism/emit_cases"
  # shellcheck disable=SC2086
  write_table "$work/cases.c" $cases
  # shellcheck disable=SC2086
  write_table "$work/cases_tiny.c" $tiny
  # shellcheck disable=SC2086
}

# NAME MAIN PROGRAM [LIBRARY]: MAIN.c with the cases, rt and the machine's port
link_program() {
  library=${4:-$FRAY_BUILD/cross/$1/libfray.a}
  table=$work/cases.c
  [ "$CASES" = all ] || table=$work/cases_$CASES.c
  # shellcheck disable=SC2086
  if [ "$IS_BARE" = yes ]; then
    sh tests/target/target.sh build "${1%%-*}" "$OPT" "$3" $LIMITS "tests/determinism/$2.c" "$table" \
      tests/target/port_bare.c "$library" -Wl,-Map="$3.map" -Wl,--defsym=code_max=512K # all of rt, at -O0 too
  else
    $CC -std=c11 -Wall -Wextra -Werror -I. $OPT $EXTRA $LIMITS "tests/determinism/$2.c" "$table" \
      tests/determinism/port_stdio.c "$library" -o "$3"
  fi
}

build() { # NAME: the program is $work/NAME
  config_make "$1" libfray.a && link_program "$1" replay_main "$work/$1"
}

run_program() { # PROGRAM OUT
  # shellcheck disable=SC2086
  # seconds of the processor: how busy the machine is does not enter
  (ulimit -S -t 600 && TARGET_SECONDS=600 timeout 12000 $RUN "$1") >"$2" 2>&1 </dev/null || echo "exit $?" >>"$2"
}

# Golden files in the form that replay_main prints.
expected() { # CASE...
  for name in "$@"; do
    echo "case $name"
    grep -v '^#' "$golden/$name.txt"
    echo "restored same"
  done
  echo end
}

# expected, found: `N same`: ticks compared; or where they part: `N CASE TICK hash|output`, or
# `N CASE LINE` for what is not a tick
compare() {
  awk 'NR == FNR { want[NR] = $0; lines = NR; next }
       bad != "" { next }
       FNR > lines || $0 != want[FNR] {
         split(want[FNR], w, " ")
         is_tick = $1 ~ /^[0-9]+$/ && $1 == w[1]
         bad = name " " (is_tick ? $1 " " ($2 != w[2] ? "hash" : "output") : $0)
         next
       }
       $1 == "case" { name = $2 }
       $1 ~ /^[0-9]+$/ { ticks++ }
       END { if (bad == "" && FNR < lines) bad = name " the end is missing"
             printf "%d %s\n", ticks, bad == "" ? "same" : bad }' "$1" "$2"
}

# NAME CASE TICK: the first word of the state, or output, that is not that of this machine's own build
first_difference() {
  at="-DREPLAY_DUMP_CASE=\"$2\" -DREPLAY_DUMP_TICK=$3"
  own=$work/$1.own other=$work/$1.other
  {
    (RUN='' CC=${HOST_CC:-cc} OPT=-O2 EXTRA=$at CASES=all LIMITS='' IS_BARE=no
     link_program host dump_main "$own" "$FRAY_BUILD/libfray.a" && run_program "$own" "$own.txt") &&
      LIMITS="$LIMITS $at" && link_program "$1" dump_main "$other" && run_program "$other" "$other.txt"
  } 2>"$work/$1.dump.err" || { echo "no state to compare: see $work/$1.dump.err"; return; }
  diff "$other.txt" "$own.txt" | awk '/^</ && found == "" { found = substr($0, 3) }
    /^</ { n++ } /^>/ && own == "" { own = $NF }
    END { if (n == 0) print "this machine'"'"'s own build has the same words there"
          else printf "%s, here %s; %d words differ\n", found, own, n }'
}

row() { printf '  %-13s %-11s %4s %-6s  %-20s %5s  %-6s  %-8s  %-6s  %s\n' "$@"; }

check_hashes() { # NAME: sets ticks, result, same; the configuration is set
  ticks=0 same=no result="does not build"
  build "$1" || return 0
  run_program "$work/$1" "$work/$1.out"
  said="restored same"
  [ "$RESTORED" != no ] || said="restored not run"
  sed "/^memory /d; s/^$said\$/restored same/" "$work/$1.out" >"$work/$1.txt"
  result=$(compare "$work/expected_$CASES.txt" "$work/$1.txt")
  ticks=${result%% *} result=${result#* }
  if [ "$result" = same ]; then
    same=yes
    return
  fi
  case $result in
    *" hash" | *" output")
      # shellcheck disable=SC2086
      set -- "$1" $result
      result="case $2, tick $3: $4 differs; $(first_difference "$1" "$2" "$3")" ;;
    *) result="case $result" ;;
  esac
}

is_in() { # NAME LIST
  for one in $2; do [ "$one" != "$1" ] || return 0; done
  return 1
}

# NAME: how many images and logs are the same, out of how many
check_images() {
  is_in "$1" "$CONFIGS_IMAGES" || { echo -; return; }
  sh tests/determinism/images.sh only "$1" >"$work/$1.images" 2>&1 || true
  awk '/^FAILED/ { print > "/dev/stderr" }
       /^[0-9]+ passed, [0-9]+ failed$/ { good = $1; all = $1 + $3 } END { print good + 0 "/" all + 0 }' \
    "$work/$1.images"
}

check_config() {
  if ! config "$1"; then
    # shellcheck disable=SC2086
    row "$1" $MACHINE "$CC $OPT" - - - - "not run"
    not_run "hashes of $1" "$PACKAGES"
    return
  fi
  machine=$MACHINE
  compiler="${CC##*-} $($CC -dumpfullversion 2>/dev/null || $CC -dumpversion) $OPT"
  case $1 in *-native | *-id16 | *-checked) compiler="$compiler ${1#*-}" ;; esac
  check_hashes "$1"
  images=-
  if [ "$mode" = full-one ]; then images=$(check_images "$1"); fi
  note=''
  if [ "$CASES" = tiny ]; then note="; of the cases only $tiny fit"; fi
  # shellcheck disable=SC2086
  row "$1" $machine "$compiler" "$ticks" "$same" "$RESTORED" "$images" "$result$note"
  if [ "$result" = same ]; then pass; else fail "hashes of $1: $result"; fi
  case $images in
    -) ;;
    "${images#*/}/${images#*/}") pass ;;
    *) fail "images of $1: $images; $(grep -m 1 ^FAILED "$work/$1.images" || true)" ;;
  esac
  if [ "$mode" = full-one ] && is_in "$1" "$CONFIGS_RUN"; then check_run "$1"; fi
}

# The id of the physics: cksum of all ticks in tests/golden. Not of their last lines: saved images hold the id.
folded_id() {
  for name in $(printf '%s\n' $cases | LC_ALL=C sort); do grep '^[0-9]' "$golden/$name.txt"; done |
    cksum | awk '{ printf "0x%08X\n", $1 }'
}
stated_id() { sed -n 's/^#define PHYSICS_ID \(0x[0-9A-F]*\)u$/\1/p' "$id_header"; }

check_id() {
  if [ "$(stated_id)" = "$(folded_id)" ]; then
    pass
  else
    fail "$id_header has $(stated_id), tests/golden calls for $(folded_id): make golden-update"
  fi
}

update_golden() {
  config gcc-O2 && build gcc-O2
  "$work/gcc-O2" | grep -v '^memory ' >"$work/gcc-O2.txt"
  for name in $cases; do
    {
      echo "# After every tick: the hash of the state, a digest of the outputs. Made by make golden-update."
      awk -v name="$name" '$1 == "case" { on = $2 == name; next } $1 == "restored" { on = 0 } on' \
        "$work/gcc-O2.txt"
    } >"$golden/$name.txt"
    written=$(grep -c '^[0-9]' "$golden/$name.txt")
    echo "$golden/$name.txt: $written ticks"
    [ "$written" = "$(case_ticks "$name")" ] || fail "$name: $written ticks, expected $(case_ticks "$name")"
  done
}

# Once more where the id changed, for the images that hold it.
update() {
  update_golden
  id=$(folded_id)
  [ "$(stated_id)" != "$id" ] || return 0
  sed "s/ 0x[0-9A-F]*u$/ ${id}u/" "$id_header" >"$work/physics_id.h"
  cp "$work/physics_id.h" "$id_header"
  echo "$id_header: $id"
  suite_make BUILD="$FRAY_BUILD" "$FRAY"
  prepare
  update_golden
}

# NAME: what `make run` recorded, verified there; the configuration is set
check_run() {
  two=$work/two_hands
  config_make "$1" fray || { fail "two_hands on $1: the command does not build"; return; }
  # shellcheck disable=SC2086
  if said=$($RUN "$FRAY_BUILD/cross/$1/fray" verify "$two.log" --scene "$two.img" 2>&1); then
    pass
  else
    fail "two_hands on $1: $said"
  fi
  # shellcheck disable=SC2086
  row "$1" $MACHINE "$compiler" "$(echo "$said" | awk '{ print $2 }')" - - - "$said"
}

prepare_run() {
  two=$work/two_hands
  "$FRAY" scene tests/scenes/two_hands.scene -o "$two.img" >/dev/null
  "$FRAY" run "$two.img" --log tests/scenes/two_hands.log --record "$two.log" >/dev/null
}

check_altered_run() {
  "$FRAY_BUILD/tests/cli/alter" pose "$two.log" 1500 0 1 >"$work/pose.log"
  said=$("$FRAY" verify "$work/pose.log" --scene "$two.img") || true
  case $said in
    "tick 1500 differs"*) pass ;;
    *) fail "one bit of a pose of tick 1500 changed: $said" ;;
  esac
}

# Each in a process of its own, JOBS at a time; their rows come in the order of the list.
check_list() { # NAME...
  for name in "$@"; do rm -f "$work/$name.row"; done
  printf '%s\n' "$@" | FRAY="$FRAY" BUILD="$FRAY_BUILD" xargs -P "${JOBS:-2}" -I NAME sh -c '
    sh tests/determinism/hashes.sh "$1" "$3" >"$2/$3.part" 2>"$2/$3.err" || true
    mv "$2/$3.part" "$2/$3.row"' check "$mode-one" "$work" NAME &
  workers=$!
  for name in "$@"; do
    while [ ! -f "$work/$name.row" ] && kill -0 "$workers" 2>/dev/null; do sleep 0.2; done
    if [ ! -f "$work/$name.row" ]; then fail "$name: no result"; continue; fi
    grep -Ev '^[0-9]+ passed, [0-9]+ failed$' "$work/$name.row" || true
    counts=$(awk '/^[0-9]+ passed, [0-9]+ failed$/ { print $1, $3 }' "$work/$name.row")
    if [ -z "$counts" ]; then
      fail "$name: it ended early: $(tail -n 1 "$work/$name.err")"
      continue
    fi
    suite_passed=$((suite_passed + ${counts% *}))
    suite_failed=$((suite_failed + ${counts#* }))
  done
  wait "$workers" || true
  for name in "$@"; do cat "$work/$name.row"; done | awk '
    $3 ~ /^(32|64)$/ && / yes +(often|once|no) / { n++; bits += $3 == 32; big += $4 == "big" }
    END { printf "  the same in %d configurations: %d of 32 bits, %d big-endian\n", n, bits, big }'
}

case $mode in
  update)
    prepare
    update
    sh tests/determinism/images.sh update
    exit $((suite_failed != 0)) ;;
  *-one)
    check_config "$1"
    suite_end
    exit ;;
esac
prepare
# shellcheck disable=SC2086
{
  expected $cases >"$work/expected_all.txt"
  expected $tiny >"$work/expected_tiny.txt"
}
check_id
row configuration machine bits order "compiler, options" ticks hashes reopened images \
  "against tests/golden"
case $mode in
  only) check_list "$@" ;;
  short) check_list $(sh tests/part.sh share "${PART:-1/1}" $CONFIGS_SHORT) ;;
  full)
    prepare_run
    # images of the host, against which the other machines' are compared
    if sh tests/determinism/images.sh here; then pass; else fail "images of the host"; fi
    check_list $(sh tests/part.sh share "${PART:-1/1}" $CONFIGS_FULL)
    check_altered_run ;;
esac
suite_end
