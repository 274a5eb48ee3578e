#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# cppcheck's misra addon on rt, on a copy, for it writes beside its sources: every rule that is broken
# is listed in misra.md with the number of its places.
. tests/lib/suite.sh

work=$FRAY_BUILD/proof/misra
mkdir -p "$work/said" # what was found in files that have not changed
suite_needs 'the MISRA rules' cppcheck cppcheck

count_rules() { # SOURCE: prints `rule places`
  (cd "$work" && cppcheck --cppcheck-build-dir=said -j "${JOBS:-2}" --quiet --std=c11 --addon=misra -I. \
    --suppress=missingIncludeSystem --template='{file}:{line}:{column} {id}' "$1" 2>&1) | grep -E ' misra-c2012-' | sort -u >"$work/places"
  sed 's/.* misra-c2012-//' "$work/places" | sort -V | uniq -c | awk '{ print $2, $1 }'
}

awk -F'|' '/^\| [0-9]+\.[0-9]+ / { gsub(/ /, "", $2); gsub(/[ ,]/, "", $3); print $2, $3 }' \
  tests/proof/misra.md >"$work/listed"
rm -rf "$work/rt"
cp -r rt "$work/rt"
count_rules rt >"$work/found"
rules=0 places=0
for rule in $(awk '{ print $1 }' "$work/listed" "$work/found" | sort -Vu); do
  count=$(awk -v rule="$rule" '$1 "" == rule { print $2 }' "$work/found")
  listed=$(awk -v rule="$rule" '$1 "" == rule { print $2 }' "$work/listed")
  rules=$((rules + 1)) places=$((places + ${count:-0}))
  holds "rule $rule: ${count:-0} places, misra.md says ${listed:-none}
$(grep " misra-c2012-$rule\$" "$work/places" | head -n 20)" [ "${count:-0}" = "${listed:-0}" ]
done
printf '  misra: %d rules are deviated from, in %d places; %d are listed\n' "$rules" "$places" \
  "$(wc -l <"$work/listed")"

printf 'int f(int a);\nint f(int a) { if (a) { a = 1; } return a; }\n' >"$work/bad.c"
if count_rules bad.c | grep -q '^14.4 '; then pass; else fail "the addon finds nothing in a bad file"; fi
suite_end
