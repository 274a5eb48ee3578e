#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# tidy.sh: the shape of the sources, by the rules of rules.sh, each of them tried on examples first; and cppcheck
# finds nothing in rt. RULES="arrows stems" picks; PART=2/4: cppcheck in the second of four parts of rt's rooms.
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

# shiftTooManyBitsSigned: fx_asr shifts values that are not negative, in both of its branches
if [ -n "${RULES:-}" ]; then
  :
elif have cppcheck; then
  known=$FRAY_BUILD/cppcheck # what it found in files that have not changed, headers and all
  mkdir -p "$known"
  # shellcheck disable=SC2046
  if cppcheck --cppcheck-build-dir="$known" -j "${JOBS:-2}" --quiet --std=c11 --enable=warning,performance,portability --inline-suppr -I. \
    --suppress=missingIncludeSystem --suppress=shiftTooManyBitsSigned --error-exitcode=1 $(sh tests/part.sh share "${PART:-1/1}" rt/*/) 2>"$work/cppcheck"; then
    pass
  else
    fail "cppcheck: $(cat "$work/cppcheck")"
  fi
else
  not_run cppcheck cppcheck
fi
suite_end
