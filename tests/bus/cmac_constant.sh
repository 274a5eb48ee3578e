#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The cipher takes the same time for every key and message:
#   - callgrind counts the instructions of each of 40 calls with other keys and messages: one figure;
#   - memcheck, told that keys and messages are undefined, sees no branch and no address that depends
#     on them, so neither branches nor caches can tell them.
# Both for what gcc and clang make of it. A build with a leak in it must be seen by both.
. tests/lib/suite.sh

calls=40
work=$FRAY_BUILD/bus/cmac
rm -rf "$work"
mkdir -p "$work"
sources="rt/wire/cmac.c rt/wire/auth.c rt/wire/dictionary.c rt/base/bytes.c tests/bus/cmac_constant.c"

# The linker binds at the start: else the first call of memcpy would be dearer.
build() { # NAME COMPILER OPTION...
  out=$1
  shift
  # shellcheck disable=SC2086 # a list of files
  "$@" -std=c11 -gdwarf-4 -I. -Wall -Wextra -Werror -Wl,-z,now -o "$work/$out" $sources
}

# One line a call: its instructions. A dump follows every call of the function.
count_calls() { # PROGRAM FUNCTION
  rm -f "$work"/dump.*
  valgrind --tool=callgrind --callgrind-out-file="$work/dump" --toggle-collect="$2" --dump-after="$2" \
    "$work/$1" count $calls >"$work/log" 2>&1 || return 1
  cat "$work"/dump.* | sed -n 's/^\(summary\|totals\): //p' | awk '$1 > 0' | head -n $calls
}

figure_of() { # PROGRAM FUNCTION: the figure, or the different figures
  count_calls "$1" "$2" >"$work/counts" || { echo "valgrind fails: $(tail -n 1 "$work/log")"; return; }
  [ "$(wc -l <"$work/counts")" -eq $calls ] || { echo "$(wc -l <"$work/counts") calls seen"; return; }
  sort -nu "$work/counts" | tr '\n' ' ' | sed 's/ $//'
}

follows() { valgrind --error-exitcode=9 "$work/$1" follow >"$work/$1.memcheck" 2>&1; }

check() { # NAME
  figure=$(figure_of "$1" measured)
  case $figure in
    *[!0-9]* | '') fail "$1: instructions differ by key or message: $figure" ;;
    *) pass ;;
  esac
  if follows "$1"; then pass; else fail "$1: a branch or an address depends on a secret: $(cat "$work/$1.memcheck")"; fi
  printf '  %-10s %s instructions in each of %d calls; a key %s, a protected frame %s, a TAG %s\n' "$1" "$figure" $calls \
    "$(figure_of "$1" measured_key)" "$(figure_of "$1" measured_open)" "$(figure_of "$1" measured_tag)"
}

if ! have valgrind || ! have gcc || [ ! -e /usr/include/valgrind/memcheck.h ]; then
  not_run "the cipher's time" valgrind
  suite_end
  exit
fi

if build leaks gcc -O2 -DCMAC_LEAKS; then
  case $(figure_of leaks measured) in
    *[!0-9]*) pass ;;
    *) fail "a branch on a key is not seen in the instructions" ;;
  esac
  if follows leaks; then fail "a look-up by a key is not seen by memcheck"; else pass; fi
else
  fail "the build with a leak"
fi
for option in -O1 -O3; do
  if build "gcc$option" gcc $option; then check "gcc$option"; else fail "gcc $option does not build"; fi
  have clang || { not_run "the cipher's time as clang makes it" clang; continue; }
  if build "clang$option" clang $option; then check "clang$option"; else fail "clang $option does not build"; fi
done
suite_end
