#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# lines.sh [ROOT]: lines of C, shell and awk below rt, platform, tools and tests of a tree: of code, of assertions
# (statements that begin with FRAY_ASSERT or _Static_assert), of comments, blank. A line with code and a comment
# is code. `make lines`.
set -eu
cd "${1:-.}"

count() { # ROOM
  find "$1" -type f \( -name '*.[chS]' -o -name '*.cpp' -o -name '*.sh' -o -name '*.awk' \) | sort | xargs awk -v room="$1" '
    FNR == 1 { inside = asserting = 0; files++; c = FILENAME ~ /\.([chS]|cpp)$/ }
    /^[ \t]*$/ { blank++; next }
    !c { if (/^[ \t]*#/) comments++; else code++; next }
    {
      # what is outside of comments; quotes do not hide a comment mark in this tree but in tests of the lexer
      rest = $0
      text = ""
      while (rest != "") {
        if (inside) {
          at = index(rest, "*/")
          rest = at ? substr(rest, at + 2) : ""
          inside = at == 0
        } else {
          at = match(rest, /\/\*|\/\/|"([^"\\]|\\.)*"/)
          if (at == 0) { text = text rest; break }
          text = text substr(rest, 1, at - 1)
          mark = substr(rest, at, RLENGTH)
          rest = substr(rest, at + RLENGTH)
          if (mark == "//") break
          if (mark == "/*") inside = 1
          else text = text "\"\""
        }
      }
      if (text ~ /^[ \t]*$/) comments++
      else if (asserting || text ~ /^[ \t]*(FRAY_ASSERT|_Static_assert|static_assert)\(/) {
        asserts++
        asserting = text !~ /;[ \t]*$/
      } else code++
    }
    END { printf "  %-10s %6d %8d %10d %9d %7d\n", room, files, code, asserts, comments, blank }'
}

printf '  %-10s %6s %8s %10s %9s %7s\n' '' files code assertions comments blank
for room in rt platform tools tests; do count "$room"; done |
  awk '{ print; for (k = 2; k <= NF; k++) sum[k] += $k }
       END { printf "  %-10s %6d %8d %10d %9d %7d\n", "all", sum[2], sum[3], sum[4], sum[5], sum[6] }'
