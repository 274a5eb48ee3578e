# SPDX-License-Identifier: Apache-2.0
# awk -v edges=FILE -f arrows.awk arrows.txt SOURCE...: includes that the table does not allow, a line each; to
# edges, for tsort, a line `SOURCE TARGET` for every include.
function strip(line) { sub(/#.*/, "", line); return line }

# is the path in the room (or does it begin with what stands before a *)?
function within(path, room) {
  if (room ~ /\*$/) return index(path, substr(room, 1, length(room) - 1)) == 1
  return index(path, room "/") == 1
}

# may this file include that one? The room of a file is the longest that holds it.
function allowed(from, to,    r, n, k, list, known) {
  if (to == "rt/fray.h") return 1
  for (r = 1; r <= rooms; r++) {
    if (!within(from, room[r])) continue
    known = 1
    if (room[r] !~ /\*$/ && within(to, room[r])) return 1
    n = split(may[r], list, " ")
    for (k = 1; k <= n; k++) if (within(to, list[k])) return 1
  }
  return known || from == "rt/fray.h" ? 0 : -1
}

FILENAME ~ /arrows\.txt$/ {
  line = strip($0)
  at = index(line, ":")
  if (at > 0) { room[++rooms] = substr(line, 1, at - 1); may[rooms] = substr(line, at + 1) }
  next
}

FNR == 1 {
  known = FILENAME == "rt/fray.h"
  for (r = 1; r <= rooms; r++) if (within(FILENAME, room[r])) known = 1
  if (!known) print FILENAME ": arrows.txt does not name its room"
}
/^[ \t]*#[ \t]*include/ {
  target = $0
  sub(/^[ \t]*#[ \t]*include[ \t]*/, "", target)
  if (target ~ /^</ && target !~ /^<(rt|platform|tools|tests)\//) next
  if (target !~ /^"[^"]*\.h"/ && FILENAME ~ /^rt\//) { print FILENAME ":" FNR ": " target ", expected a header in double quotes"; next }
  split(target, part, "\"")
  target = part[2]
  if (target !~ /^(rt|platform|tools|tests)\// || target ~ /\/(\.\.?)?\//) print FILENAME ":" FNR ": " target ", expected a path from the root of the project"
  else if (known && !allowed(FILENAME, target)) print FILENAME ":" FNR ": must not include " target
  print FILENAME, target >edges
}
