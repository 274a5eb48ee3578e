#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# budget.sh PREFIX MEASURED [update]: compares measured figures (lines `NAME VALUE COMPILER`) with the
# lines of tests/budget/budget.txt whose names begin with PREFIX. More than 1 % above its budget, or
# above what is asked of it, fails; more than 1 % below says to tighten. Figures of another version
# of a compiler are not compared. `update` writes the figures as the new budgets: commit them, and
# say why. Where PART is not 1/1, only what was measured is compared, and a figure may be missing.
. tests/lib/suite.sh

prefix=$1
measured=$2
budgets=${BUDGETS:-tests/budget/budget.txt}
work=$FRAY_BUILD/budget
mkdir -p "$work"

awk -v p="$prefix" 'index($1, p) == 1 { print $3 }' "$measured" | sort -u | while read -r compiler; do
  echo "$compiler $("$compiler" --version | head -n 1)"
done >"$work/versions"

if [ "${3:-}" = update ]; then
  {
    grep '^#' "$budgets"
    { grep '^compiler ' "$budgets" || true; sed 's/^/compiler /' "$work/versions"; } |
      awk '{ last[$2] = $0 } END { for (c in last) print last[c] }' | sort
    awk -v p="$prefix" '/^#/ || $1 == "compiler" || NF == 0 { next }
      FNR == NR { if (index($1, p) != 1) print; asked[$1] = $4; next }
      index($1, p) == 1 { print $1, $2, $3 (asked[$1] != "" ? " " asked[$1] : "") }' \
      "$budgets" "$measured" | LC_ALL=C sort
  } >"$work/new"
  mv "$work/new" "$budgets"
  echo "$budgets: $(awk -v p="$prefix" 'index($1, p) == 1' "$budgets" | wc -l) figures of $prefix written"
  awk -v p="$prefix" 'index($1, p) == 1 && $4 != "" && $2 > $4 { print $1 " " $2 ", at most " $4 " are asked"; over = 1 } END { exit over }' \
    "$budgets"
  exit
fi

if [ "${PART:-1/1}" != 1/1 ]; then
  awk 'NR == FNR { measured[$1] = 1; next } /^#/ || $1 == "compiler" || $1 in measured' "$measured" "$budgets" >"$work/part$prefix"
  budgets=$work/part$prefix
  if ! grep -q "^$prefix" "$measured"; then
    suite_end
    exit
  fi
fi
awk -v prefix="$prefix" -v versions="$work/versions" -v budgets="$budgets" -f tests/budget/budget.awk \
  "$work/versions" "$budgets" "$measured" >"$work/result"
while read -r mark text; do
  case $mark in
    ok) pass ;;
    asked) pass; echo "  $text" ;;
    shrunk) pass; echo "  $text  tighten the budget" ;;
    other) not_run "budgets of $prefix (not compared: other compiler)" "$text" ;;
    *) fail "budget, $mark: $text" ;;
  esac
done <"$work/result"
[ -s "$work/result" ] || fail "no budget begins with $prefix"
suite_end
