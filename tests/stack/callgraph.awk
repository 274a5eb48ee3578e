# SPDX-License-Identifier: Apache-2.0
# gcc's -fcallgraph-info=su,da; lines out:
#   frame NAME BYTES KIND OBJECTS   as -fstack-usage says; KIND static, dynamic or
#                                   dynamic,bounded; dynamic objects
#   calls FROM TO                   static functions without the path of their file
function quoted(key, text) {
  if (!match($0, key ": \"[^\"]*\"")) return ""
  text = substr($0, RSTART + length(key) + 3, RLENGTH - length(key) - 4)
  return text
}
function plain(name) { sub(/^.*:/, "", name); return name }
/^node:/ {
  label = quoted("label")
  if (!match(label, /\\n[0-9]+ bytes \([a-z,]+\)/)) next
  split(substr(label, RSTART + 2, RLENGTH - 2), part, " ")
  objects = 0
  if (match(label, /[0-9]+ dynamic objects/)) objects = substr(label, RSTART, RLENGTH) + 0
  gsub(/[()]/, "", part[3])
  print "frame", plain(quoted("title")), part[1], part[3], objects
}
/^edge:/ { print "calls", plain(quoted("sourcename")), plain(quoted("targetname")) }
