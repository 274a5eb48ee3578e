#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The results file, tests/results.tsv: KEY VALUE UNIT COMMAND VERSION, tabs between them, sorted by key.
#   results.sh set KEY VALUE UNIT COMMAND   writes one figure; VERSION is FRAY_VERSION and the commit
#   PROGRAM | results.sh figures NAME       writes NAME.FIGURE of each line `figure FIGURE VALUE UNIT` of a test program
#   results.sh get KEY                      prints its value, or that of tests/budget/budget.txt
# Measuring scripts call `set` when they are asked to update. RESULTS_FILE names another file.
set -eu
file=${RESULTS_FILE:-tests/results.tsv}

case ${1:-} in
set)
  [ $# -eq 5 ] || { echo 'results.sh set KEY VALUE UNIT COMMAND' >&2; exit 2; }
  version=$(sed -n 's/^#define FRAY_VERSION "\(.*\)"/\1/p' rt/fray.h)
  commit=$(git rev-parse --short=7 HEAD 2>/dev/null || echo release)
  {
    grep '^#' "$file" || true
    {
      grep -v '^#' "$file" | awk -F '\t' -v key="$2" '$1 != key' || true
      printf '%s\t%s\t%s\t%s\t%s\n' "$2" "$3" "$4" "$5" "$version $commit"
    } | LC_ALL=C sort
  } >"$file.new"
  mv "$file.new" "$file"
  ;;
figures)
  # the unit is one word; `(asked: ...)` follows it
  sed -n 's/^figure \([A-Za-z0-9_.]*\) \(-*[0-9][0-9.e+-]*\) *\([^ (]*\).*/\1 \2 \3/p' | while read -r name value unit; do
    sh "$0" set "$2.$name" "$value" "${unit:--}" "make test, $2"
  done
  ;;
get)
  awk -v key="$2" 'FNR == 1 { ++files } /^#/ { next }
    { split($0, part, files == 1 ? "\t" : " ") } part[1] == key { print part[2]; found = 1; exit }
    END { exit !found }' "$file" tests/budget/budget.txt
  ;;
*)
  echo 'results.sh set KEY VALUE UNIT COMMAND, figures NAME, or get KEY' >&2
  exit 2
  ;;
esac
