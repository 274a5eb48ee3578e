#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# cppcheck's misra addon on rt: no rule is broken that misra.md does not list, and none in more
# places. A rule that is listed with more places than there are is named, so that the list can shrink.
. tests/lib/suite.sh

work=$FRAY_BUILD/proof/misra
mkdir -p "$work"
if ! have cppcheck; then
  not_run 'the MISRA rules' cppcheck
  suite_end
  exit
fi

count_rules() { # SOURCE: prints `rule places`
  cppcheck --quiet --std=c11 --addon=misra -I. --suppress=missingIncludeSystem \
    --template='{file}:{line}:{column} {id}' "$1" 2>&1 | grep -E ' misra-c2012-' | sort -u >"$work/places"
  sed 's/.* misra-c2012-//' "$work/places" | sort -V | uniq -c | awk '{ print $2, $1 }'
}

awk -F'|' '/^\| [0-9]+\.[0-9]+ / { gsub(/ /, "", $2); gsub(/[ ,]/, "", $3); print $2, $3 }' \
  tests/proof/misra.md >"$work/listed"
count_rules rt >"$work/found"
rules=0 places=0
while read -r rule count; do
  rules=$((rules + 1)) places=$((places + count))
  allowed=$(awk -v rule="$rule" '$1 == rule { print $2 }' "$work/listed")
  if [ "$count" -le "${allowed:-0}" ]; then
    pass
    if [ "$count" -lt "$allowed" ]; then echo "  rule $rule: $count places, misra.md says $allowed"; fi
  else
    fail "rule $rule: $count places, misra.md allows ${allowed:-none}
$(grep " misra-c2012-$rule\$" "$work/places" | head -n 20)"
  fi
done <"$work/found"
printf '  misra: %d rules are deviated from, in %d places; %d are listed\n' "$rules" "$places" \
  "$(wc -l <"$work/listed")"

printf 'int f(int a);\nint f(int a) { if (a) { a = 1; } return a; }\n' >"$work/bad.c"
if count_rules "$work/bad.c" | grep -q '^14.4 '; then pass; else fail "the addon finds nothing in a bad file"; fi
suite_end
