# SPDX-License-Identifier: Apache-2.0
# The deepest stack below each of `roots`. `tops` (" NAME NAME ") set the stack to its top. Reads the
# lines of callgraph.awk and disassembly.awk, and those of nm (ADDRESS TYPE NAME). Without disassembly
# the compiler's graph alone is walked, and what it has no frame of is named. Lines out:
#   bound ROOT BYTES, path BYTES NAME HOW    its deepest path, from the root down
#   helper NAME BYTES                        frames read off the instructions
#   outside NAME                             called, and nobody knows its frame
#   compared FUNCTIONS EQUAL                 frames of the compiler beside the instructions
#   FAILED WHY
function known(name) { return linked ? (name in code) : (name in frame) }
function canonical(name) { return name in address && address[name] in named ? named[address[name]] : name }
function add_call(from, to) {
  if ((from, to) in seen) return
  seen[from, to] = 1
  calls[from] = calls[from] " " to
}
function frame_of(name) { return name in frame && frame[name] > pushed[name] ? frame[name] : pushed[name] + 0 }
function complain(text) { if (!(text in said)) print "FAILED " text; said[text] = 1 }

# Everything that a bound must not contain.
function check(name) {
  if (name in frame && (kind[name] == "dynamic" || objects[name] > 0)) complain("a frame that is not static: " name)
  if (!(name in frame) && name in moves && index(tops, " " name " ") == 0) complain("a frame that nobody knows: " name)
  if (!(name in frame) && name in jumps) complain("an indirect jump: " name)
  if (name in pointers) complain("an indirect call that is not resolved: " name)
}
function depth(name, list, n, k, child, below, most) {
  if (name in total) return total[name]
  if (name in walking) {
    complain("recursion: " name)
    return 0
  }
  walking[name] = 1
  check(name)
  most = 0
  n = split(calls[name], list, " ")
  for (k = 1; k <= n; ++k) {
    child = list[k]
    below = depth(child)
    if (below > most) { most = below; next_of[name] = child }
  }
  delete walking[name]
  total[name] = most + frame_of(name)
  return total[name]
}
function print_path(root, name) {
  print "bound", root, depth(root)
  for (name = root; name != ""; name = next_of[name])
    print "path", frame_of(name), name, name in frame ? "" : "(from its instructions)"
}

$1 == "code" { code[$3] = 1; named[$2] = $3; linked = 1 }
$1 == "push" { pushed[$2] = $3 }
$1 == "moves" { moves[$2] = 1 }
$1 == "jump" { jumps[$2] = 1 }
$1 == "pointer" { pointers[$2] = 1 }
$1 == "frame" {
  if (!($2 in frame) || $3 > frame[$2]) frame[$2] = $3
  if (kind[$2] != "dynamic") kind[$2] = $4 # a dynamic,bounded one says its most
  objects[$2] += $5
}
$1 == "call" || $1 == "calls" || $1 == "runs" { edge_kind[++edges] = $1; from[edges] = $2; to[edges] = $3 }
$1 ~ /^[0-9a-f]+$/ && $2 ~ /^[tTwW]$/ && NF == 3 { address[$3] = $1 }
END {
  for (n = 1; n <= edges; ++n) {
    if (edge_kind[n] == "runs" && from[n] in frame) continue # behind a call that does not return
    target = canonical(to[n])
    if (target == "__indirect_call") pointers[from[n]] = 1
    else if (known(target)) add_call(from[n], target)
    else if (!linked && !(target in outside)) { outside[target] = 1; print "outside", target }
    else if (linked && edge_kind[n] == "call") complain("a call into nowhere: " from[n] " to " target)
  }
  count = split(roots, root, " ")
  for (n = 1; n <= count; ++n) {
    if (!known(root[n])) complain("no function " root[n])
    else print_path(root[n])
  }
  for (name in total) {
    if (!(name in frame)) print "helper", name, frame_of(name)
    else if (linked && pushed[name] < frame[name] && !(name in moves))
      complain("the compiler says " frame[name] " bytes, the instructions " pushed[name] ": " name)
    else if (linked) { ++compared; equal += pushed[name] == frame[name] }
  }
  if (linked) print "compared", compared + 0, equal + 0
}
