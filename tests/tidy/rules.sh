# SPDX-License-Identifier: Apache-2.0
# The rules of tidy.sh, for it to source. Each is a function of its own that is called in the root of a tree and
# prints what breaks it there, a line each; nothing is good. $tidy is the folder of this file, and $work one to
# write to. tests/tidy/examples.sh tries each on a small tree that breaks it.

sources() { # ROOM...: C files of those that the tree has
  for room in "$@"; do
    [ ! -d "$room" ] || find "$room" -name '*.[ch]'
  done | sort
}

# awk over the files whose names come from stdin; none is none
each() { xargs -r awk "$@"; }

# an include that arrows.txt does not allow
rule_arrows() {
  : >"$work/edges"
  sources rt platform tools tests | xargs -r awk -v edges="$work/edges" -f "$tidy/arrows.awk" "$tidy/arrows.txt"
}

# includes, or rooms of arrows.txt, in a circle
rule_circles() {
  rule_arrows >/dev/null
  tsort "$work/edges" 2>&1 >/dev/null | sed 's/^tsort: //' || true
  awk '{ sub(/#.*/, "") } split($0, part, ":") > 1 && part[1] !~ /\*$/ && part[1] != "tests" {
    n = split(part[2], list, " ")
    for (k = 1; k <= n; k++) if (list[k] != "rt") print part[1], list[k] }' "$tidy/arrows.txt" |
    tsort 2>&1 >/dev/null | sed 's/^tsort: /arrows.txt: /' || true
}

# one stem in two rooms of rt, or in one room but for x.c, x.h and x.inl.h: objects and call graphs go by stem
rule_stems() {
  sources rt | awk '{
    n = split($0, part, "/"); stem = tolower(part[n]); sub(/\..*/, "", stem)
    if (tolower(part[n]) !~ /^[a-z0-9_]+(\.c|\.h|\.inl\.h)$/) print $0 ": expected x.c, x.h or x.inl.h"
    if (n > 3) print $0 ": a folder in a room"
    folder = substr($0, 1, length($0) - length(part[n]))
    if (stem in first && first[stem] != folder) print $0 ": the stem " stem " is also in " first[stem]
    first[stem] = folder }'
}

# data are no persons
rule_persons() {
  sources rt platform tools |
    each -v of=comments -v words='who|whom|he|his|him|himself|she|her|hers|herself|nobody|anybody|everybody|somebody|anyone|everyone|someone' -f "$tidy/comments.awk"
}

# words that the tree has left behind, as names in rt
rule_old_words() {
  sources rt | each -v of=code -v words="$(grep -v '^#' "$tidy/old_words.txt" | paste -sd '|')" -f "$tidy/comments.awk"
}

# a source that is named and does not exist: by its path from the root, or from rt
rule_paths() {
  rooms=$(cd rt && echo */ | sed 's#/ *#|#g; s#|$##')
  sources rt platform tools tests |
    xargs -r grep -noE "\\b(rt|platform|tools|tests|$rooms)/[a-z0-9_/]+(\\.inl\\.h|\\.[ch]|\\.md|\\.sh|\\.awk)\\b" |
    while IFS=: read -r file line path; do
      [ -e "$path" ] || [ -e "rt/$path" ] || echo "$file:$line: no file $path"
    done
}

rule_columns() { sources rt | each 'length($0) > 110 { print FILENAME ":" FNR ": " length($0) " columns, at most 110" }'; }

rule_files() {
  sources rt platform tools tests | each '
    function finish() { if (lines > most) print file ": " lines " lines, at most " most }
    FNR == 1 { finish(); file = FILENAME; most = file ~ /^rt\// ? 500 : 600 }
    { lines = FNR }
    END { finish() }'
}

# a function: a line at the margin opens it, its last line is `) {`, and `}` at the margin ends it
rule_functions() {
  sources rt platform tools tests | each '
    FNR == 1 { inside = 0; at = 0 }
    !inside && /^[A-Za-z_]/ { at = FNR; name = $0 }
    !inside && at && /\) \{$/ && name !~ /^(typedef|struct|enum|union|extern "C")/ { inside = 1 }
    /^}/ { if (inside && FNR - at + 1 > 70) print FILENAME ":" at ": " FNR - at + 1 " lines, at most 70"; inside = 0; at = 0 }'
}

# a public function without its contract
rule_contracts() {
  for header in rt/fray.h rt/wire/*.h; do [ ! -f "$header" ] || echo "$header"; done | each -f "$tidy/contract.awk"
}

rule_licences() {
  for room in rt platform tools tests linker .ci Makefile; do
    [ ! -e "$room" ] || find "$room" -type f \( -name '*.[chS]' -o -name '*.sh' -o -name '*.awk' -o -name '*.ld' \
      -o -name '*.scene' -o -name '*.hand' -o -name Makefile -o -name run \)
  done | each '
    function finish() { if (file != "" && !found) print file ": no SPDX line" }
    FNR == 1 { finish(); file = FILENAME; found = 0 }
    FNR <= 3 && /SPDX-License-Identifier: Apache-2.0/ { found = 1 }
    END { finish() }'
}

rules='arrows circles stems persons old_words paths columns files functions contracts licences'
