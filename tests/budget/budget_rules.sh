#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The rules of budget.sh, tried on budgets of its own.
. tests/lib/suite.sh

work=$FRAY_BUILD/budget_rules
mkdir -p "$work"

# NAME EXIT WORDS MEASURED...: one figure `a.one`, budget 1000, at most 2000 asked
try() {
  name=$1 code=$2 words=$3
  shift 3
  printf '%s\n' "$@" >"$work/measured"
  found=0
  PART=${part:-1/1} CI=${ci:-false} BUILD=$FRAY_BUILD/budget_rules BUDGETS=$work/budgets sh tests/budget/budget.sh a. "$work/measured" >"$work/said" 2>&1 ||
    found=$?
  if [ "$found" -eq "$code" ] && grep -qF "$words" "$work/said"; then
    pass
  else
    fail "$name: exit $found, expected $code and the words '$words': $(cat "$work/said")"
  fi
}

printf '#!/bin/sh\necho a compiler, version 1\n' >"$work/compiler"
chmod +x "$work/compiler"
compiler=$PWD/$work/compiler
case $work in /*) compiler=$work/compiler ;; esac
printf '# told\ncompiler %s a compiler, version 1\na.one 1000 %s 2000\nb.two 7 %s\n' \
  "$compiler" "$compiler" "$compiler" >"$work/budgets"

try "as it was" 0 "+0.0 %" "a.one 1000 $compiler"
try "1 % more" 0 "+1.0 %" "a.one 1010 $compiler"
try "more than 1 % more" 1 "FAILED budget, grown: a.one" "a.one 1011 $compiler"
try "more than 1 % less" 0 "tighten the budget" "a.one 989 $compiler"
try "not measured" 1 "FAILED budget, gone: a.one" "a.two 5 $compiler"
part=2/4
try "not measured, in a part" 0 "" ""
part=
try "in no budget" 1 "FAILED budget, new: a.two" "a.one 1000 $compiler" "a.two 5 $compiler"
try "over what is asked" 1 "FAILED budget, over: a.one" "a.one 2001 $compiler"

printf '#!/bin/sh\necho a compiler, version 2\n' >"$work/compiler"
try "another compiler" 0 "not compared: other compiler" "a.one 1500 $compiler"
try "another compiler, over what is asked" 1 "FAILED budget, over: a.one" "a.one 2001 $compiler"
ci=true FRAY_LOCAL=0
export FRAY_LOCAL
try "another compiler where CI=true" 1 "not compared: other compiler" "a.one 1000 $compiler"

ci=false
sed -i '/^compiler /d' "$work/budgets"
try "a compiler without a line" 1 "FAILED budget, unnamed: no line 'compiler" "a.one 1000 $compiler"

update() { BUILD=$FRAY_BUILD/budget_rules BUDGETS=$work/budgets sh tests/budget/budget.sh a. "$work/measured" update; }
printf 'a.one 2001 %s\n' "$compiler" >"$work/measured"
if update >"$work/said" 2>&1 || ! grep -q "a.one 2001, at most 2000 are asked" "$work/said"; then
  fail "update, over what is asked: $(cat "$work/said")"
else
  pass
fi
printf 'a.one 1000 %s\n' "$compiler" >"$work/measured"
update >/dev/null
if grep -qx "a.one 1000 $compiler 2000" "$work/budgets" && grep -qx "b.two 7 $compiler" "$work/budgets" &&
  grep -qx "compiler $compiler a compiler, version 2" "$work/budgets"; then
  pass
else
  fail "update: $(cat "$work/budgets")"
fi
suite_end
