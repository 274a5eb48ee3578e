#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Ticks shared by 1, 2, 4 and 8 workers: every scene of tests/scenes is run by one and recorded, and
# the recording verified, tick by tick, by the others; a save by two goes on with four.
# workers.sh race: the same in short under clang's thread sanitizer, and that it sees a race.
. tests/lib/suite.sh

work=$FRAY_BUILD/tests/workers.d
rm -rf "$work"
mkdir -p "$work"

inputs() { # SCENE: options of the log that drives it
  case $1 in
    two_hands) echo "--log tests/scenes/two_hands.log" ;;
    small) echo "--log $work/small.log" ;;
  esac
}

# NAME TICKS WORKERS...
verify() {
  name=$1 ticks=$2
  shift 2
  image=$work/$name.img
  if [ ! -f "$image" ]; then "$FRAY" scene "tests/scenes/$name.scene" -o "$image" >/dev/null; fi
  # shellcheck disable=SC2046
  "$FRAY" run "$image" $(inputs "$name") --ticks "$ticks" --record "$work/run.log" >"$work/said"
  hash=$(tail -n 1 "$work/said" | cut -d ' ' -f 2)
  for count in "$@"; do
    if "$FRAY" verify "$work/run.log" --scene "$image" --workers "$count" >"$work/verified" 2>&1 &&
      grep -qx "verified $ticks ticks, hash $hash" "$work/verified"; then
      pass
    else
      fail "$name, $count workers: $(tail -n 3 "$work/verified")"
    fi
  done
  echo "  $name: $(tail -n 1 "$work/said")"
}

goes_on() {
  image=$work/two_hands.img log=tests/scenes/two_hands.log
  "$FRAY" run "$image" --ticks 40 --workers 2 --save "$work/half.img" >/dev/null
  "$FRAY" run "$work/half.img" --ticks 60 --workers 4 --save "$work/end.img" >/dev/null
  "$FRAY" run "$image" --ticks 100 --save "$work/whole.img" >/dev/null
  if cmp -s "$work/end.img" "$work/whole.img"; then pass; else fail "saved by 2 workers, gone on with 4"; fi
}

refuses() { # WORDS OPTIONS...
  words=$1
  shift
  if "$FRAY" "$@" >"$work/said" 2>&1; then fail "$*: is taken"; return; fi
  if grep -qF -- "$words" "$work/said"; then pass; else fail "$*: does not say '$words'"; fi
}

every_scene() {
  "$FRAY" hand -o "$work/small.log" tests/determinism/small.hand
  verify two_hands 200 2 4 8
  verify small 500 2 4 8
  verify mirror 300 2 4 8
  verify hanging 50 2 4 8
  verify bars_apart 40 2 4 8
  verify corner_load 40 2 4 8
  verify thrown_ball 30 2 8
  verify cube 30 2 8
  verify weight 60 2 8
  verify mirror 50 0 3 5 16
  goes_on
  refuses "--workers '17', expected a number from 0 to 16" run "$work/small.img" --workers 17
  refuses "--workers 'two'" verify "$work/run.log" --scene "$work/small.img" --workers two
}

# The sanitizer must see what the plan forbids: a copy of it whose passes follow one block too close.
race() {
  if ! have clang; then
    not_run "the thread sanitizer" clang
    return
  fi
  thread="BUILD=$FRAY_BUILD/thread CC=clang OPT=-O1 EXTRA=-fsanitize=thread"
  program=$FRAY_BUILD/thread/tests/unit/test_workers
  # shellcheck disable=SC2086
  suite_make $thread "$program" "$FRAY_BUILD/thread/fray"
  export TSAN_OPTIONS=halt_on_error=1
  if "$program" >"$work/said" 2>&1; then pass; else fail "test_workers: $(grep -v '^$' "$work/said" | head -n 20)"; fi
  FRAY=$FRAY_BUILD/thread/fray
  verify mirror 120 2 4
  verify bars_apart 6 2
  sed 's/(block - par->block_from\[worker\]) + 1u;/(block - par->block_from[worker]);/' \
    rt/workers/schedule.c >"$work/schedule.c"
  if cmp -s rt/workers/schedule.c "$work/schedule.c"; then fail "nothing was changed in a copy of schedule.c"; return; fi
  # shellcheck disable=SC2046
  clang -std=gnu11 -O1 -g -fsanitize=thread -I. "$work/schedule.c" tests/unit/test_workers.c \
    "$FRAY_BUILD/thread/libtools.a" "$FRAY_BUILD/thread/libfray.a" -lm -pthread -o "$work/race"
  if "$work/race" >"$work/said" 2>&1; then
    fail "the sanitizer sees no race where there is one"
  elif grep -q 'ThreadSanitizer: data race' "$work/said"; then
    pass
  else
    fail "a race: $(head -n 5 "$work/said")"
  fi
}

if [ "${1:-}" = race ]; then race; else every_scene; fi
suite_end
