#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# tidy.sh: the shape of the sources, by the rules of rules.sh, each of them tried on examples first.
# RULES="arrows stems" picks.
. tests/lib/suite.sh

tidy=$PWD/tests/tidy
mkdir -p "$FRAY_BUILD/tidy"
work=$(cd "$FRAY_BUILD/tidy" && pwd)
. "$tidy/rules.sh"
. "$tidy/examples.sh"

for rule in ${RULES:-}; do
  case " $(echo $rules) " in
    *" $rule "*) ;;
    *) echo "tidy: found RULES=$rule, expected of: $(echo $rules)" >&2; exit 2 ;;
  esac
done
try_rules
for rule in ${RULES:-$rules}; do
  rule_"$rule" >"$work/$rule"
  if [ ! -s "$work/$rule" ]; then
    pass
  else
    fail "$rule: $(wc -l <"$work/$rule") places, the first 40 of $work/$rule:"
    head -n 40 "$work/$rule"
  fi
done
suite_end
