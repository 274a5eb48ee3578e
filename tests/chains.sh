#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# chains.sh PROGRAM...: what run_all.sh runs, a line of NAME COMMAND NAME COMMAND... for suites that run one after the
# other: the shell suites that SUITES names, then the programs, in FRAY_BUILD. Without SUITES all, but of PARTED those of
# PART alone.
set -eu
ALL='tidy cppcheck cli workers hashes images symbols stack size budget_rules cmac_constant dbc_readers other_logs install docs adding parts wild'
# in eight parts, of which the last has none
PARTED='adding install workers tests/physics/test_strength_scenes tests/physics/test_yarn_rest tests/physics/test_cantilever tests/physics/test_cloth_strength'

if [ -n "${SUITES:-}" ]; then
  left_out=''
else
  SUITES=$ALL
  # shellcheck disable=SC2086
  due=$(sh tests/part.sh share "$PART" $PARTED)
  left_out=$(for suite in $PARTED; do case " $(echo $due) " in *" $suite "*) ;; *) echo "$suite" ;; esac; done | tr '\n' ' ')
fi
is_left_out() { case " $left_out " in *" $1 "*) ;; *) return 1 ;; esac; }

script_of() {
  for script in "tests/$1.sh" "tests/$1/$1.sh" "tests/determinism/$1.sh" "tests/budget/$1.sh" "tests/proof/$1.sh" "tests/bus/$1.sh"; do
    if [ -f "$script" ]; then
      echo "$script"
      return
    fi
  done
  echo "tests/chains.sh: no suite '$1'" >&2
  exit 2
}

# The suites of WORDS that are asked for
chain() {
  for suite; do
    case " $SUITES " in *" $suite "*) ;; *) continue ;; esac
    if is_left_out "$suite"; then continue; fi
    script=$(script_of "$suite") || exit
    printf '%s %s ' "$suite" "$script"
  done
  echo
}
chain hashes images symbols
chain stack size
chain install docs
for suite in $SUITES; do
  case $suite in hashes | images | symbols | stack | size | install | docs) ;; *) chain "$suite" ;; esac
done
for program; do
  name=${program#"$FRAY_BUILD"/}
  if is_left_out "$name"; then continue; fi
  echo "$name ./${program#./}"
done | sort # physics first, the longest
