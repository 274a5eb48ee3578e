#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# assertions.sh [ROOT]: of each room of rt how many functions it has (those that macros make are not counted), how
# many of these have an assertion, and how many assertions there are (FRAY_ASSERT, and in base FX_ASSERT). `make lines`.
set -eu
cd "${1:-.}"

count() { # ROOM
  find "rt/$1" -type f -name '*.[ch]' | sort | xargs awk -v room="$1" '
    FNR == 1 { head = ""; inside = has = 0 }
    /^ *F(RAY|X)_ASSERT\(/ { asserts++; has = 1 }
    inside { if (/^}/) { inside = 0; with += has } next }
    # a definition begins in column 1; its head ends with the brace after its parameters
    /^[A-Za-z_]/ || head != "" {
      head = head $0
      if (match(head, /\)[ \t]*\{/) && substr(head, 1, RSTART) !~ /=/) {
        functions++
        has = 0
        inside = head !~ /\}[ \t]*(\/\*.*)?$/
        head = ""
      } else if (head ~ /[;{}\\][ \t]*(\/\*.*)?$/) head = ""
    }
    END { printf "  %-14s %9d %9d %10d\n", room, functions, with, asserts }'
}

printf '  %-14s %9s %9s %10s\n' '' functions asserting assertions
for room in rt/*/; do count "$(basename "$room")"; done |
  awk '{ print; for (k = 2; k <= NF; k++) sum[k] += $k } END { printf "  %-14s %9d %9d %10d\n", "all", sum[2], sum[3], sum[4] }'
