# SPDX-License-Identifier: Apache-2.0
# awk -f contract.awk HEADER...: what the contracts of a public header's functions lack, a line each. README.md of
# tests says what a contract is.
function finish_head() {
  if (functions == 0) return
  if (head !~ /Contract/) print file ": the head has no Contract"
  if (head !~ /Context:/) print file ": the head's contract has no Context:"
  if (pointers && head !~ /NULL:/) print file ": the head's contract has no NULL:"
}
function ranged(text, word) { return (" " text) ~ ("[^A-Za-z0-9_]" word "( <| <=| >=|: *[^ ])") }

function check(line, at,    name, list, n, k, part, m) {
  functions++
  name = line
  sub(/\(.*/, "", name)
  sub(/.*[ *]/, "", name)
  if (comment == "") { print file ":" at ": " name " has no contract above it"; return }
  if (comment !~ /Cost:/) print file ":" at ": " name " has no Cost:"
  sub(/^[^(]*\(/, "", line)
  sub(/\)[^)]*$/, "", line)
  n = split(line, list, ",")
  for (k = 1; k <= n; k++) {
    if (list[k] ~ /[*[]/) { pointers = 1; continue }
    m = split(list[k], part, " ")
    if (part[m - 1] ~ /^(u?int(8|16|32|64)_t|int|unsigned)$/ && !ranged(comment " " head, part[m]))
      print file ":" at ": " name ": no range of " part[m]
  }
}

FNR == 1 {
  if (file != "") finish_head()
  file = FILENAME
  head = comment = gathered = ""
  functions = pointers = body = inside = 0
  before_guard = 1
}

# comments at the margin: those before the guard are the head
inside || /^\/\*/ {
  if (!inside && !joined) comment = ""
  comment = comment " " $0
  if (before_guard) head = head " " $0
  inside = index($0, "*/") == 0
  joined = !inside
  next
}
/^#ifndef/ { before_guard = 0 }
body { if (/^}/) body = 0; next }

gathered != "" || /^(static inline |extern )?[A-Za-z_][A-Za-z0-9_ *]*[ *][a-z][a-z0-9_]*\(/ {
  if (gathered == "") { if (/^(typedef|return|enum|struct [a-z_]* \{)/) next; began = FNR }
  gathered = gathered " " $0
  if (gathered ~ /;$/ || gathered ~ /\{$/ || gathered ~ /\}$/) {
    body = gathered ~ /\{$/
    sub(/\{.*/, "", gathered)
    check(gathered, began)
    gathered = ""
  }
  joined = 0
  next
}
{ comment = ""; joined = 0 }
END { finish_head() }
