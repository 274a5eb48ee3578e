# SPDX-License-Identifier: Apache-2.0
# For shell suites; source it, then call suite_begin NAME, pass, fail, not_run, and last suite_end.
# A tool that is missing is a failure where CI=true, unless FRAY_LOCAL=1; elsewhere it is named, with
# the Debian package that has it, in a line `not run: WHAT needs PACKAGE`.
set -eu

suite_passed=0
suite_failed=0

pass() { suite_passed=$((suite_passed + 1)); }
fail() {
  suite_failed=$((suite_failed + 1))
  echo "FAILED $*"
}
holds() { # WHAT COMMAND...: one check
  claim=$1
  shift
  if "$@"; then pass; else fail "$claim"; fi
}
refutes() { # WHAT COMMAND...: one check, of what must not hold
  claim=$1
  shift
  if "$@"; then fail "$claim"; else pass; fi
}
# A failure where CI=true: .ci/run installs it all. A processor it cannot install.
not_run() { # WHAT PACKAGE
  echo "not run: $1 needs $2"
  case $2 in "a processor "*) return ;; esac
  if [ "${CI:-}" = true ] && [ "${FRAY_LOCAL:-0}" != 1 ]; then fail "$1: $2 is missing"; fi
}
has_target() { # MACHINE WHAT: whether target.sh can build and run it; else says so
  packages=$(sh tests/target/target.sh needs "$1") || { not_run "$2" "$packages" && return 1; }
}
suite_needs() { # WHAT PACKAGE TOOL...: ends the suite where a tool is missing
  needing=$1 package=$2
  shift 2
  for tool; do
    have "$tool" || { not_run "$needing" "$package" && suite_end; exit; }
  done
}
suite_end() {
  echo "$suite_passed passed, $suite_failed failed"
  [ "$suite_failed" -eq 0 ]
}

# The compiler's options and this suite's must not meet those of the make that called it.
suite_make() { MAKEFLAGS='' MFLAGS='' "${MAKE_COMMAND:-make}" -j "${JOBS:-2}" --no-print-directory -s "$@" >/dev/null; }

have() { command -v "$1" >/dev/null 2>&1; }

FRAY_BUILD=${BUILD:-build}
FRAY=${FRAY:-$FRAY_BUILD/fray}
