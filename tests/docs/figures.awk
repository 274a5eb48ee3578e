# SPDX-License-Identifier: Apache-2.0
# figures.awk -v budget=FILE -v results=FILE -v update=0|1 PAGE: holds the figures of a page against the results.
#   NUMBER<!-- KEY -->            the value, thousands may be apart by commas
#   NUMBER<!-- KEY FORMAT -->     KiB: value / 1024; k: value / 1000; tenths: value / 10; 0 to 3: so many decimals
#   <!-- table PREFIX COLUMN... --> above a table: cell n of the row LABEL is PREFIX.LABEL.COLUMN, `-` is text,
#                                 COLUMN:FORMAT as above, _COLUMN follows LABEL without a dot; a row without a label goes on from the one above: LABEL.2, LABEL.3
# A number before a unit of measurement needs a marker, and so does a row of a table whose head has one;
# `<!-- given -->` in the line, or above a table, says that it is a setting, a limit or an example.
# With update=0 it prints what is wrong, `LINE WORDS`; with update=1 the page with the values of the results.
function thousands(n,   sign, text) {
  sign = n ~ /^-/ ? "-" : ""
  sub(/^-/, "", n)
  text = ""
  while (length(n) > 3) {
    text = "," substr(n, length(n) - 2) text
    n = substr(n, 1, length(n) - 3)
  }
  return sign n text
}
function shown(v, format) {
  if (format == "KiB") return sprintf("%.1f", v / 1024)
  if (format == "k") return thousands(sprintf("%.0f", v / 1000))
  if (format ~ /^[0-3]$/) return sprintf("%." format "f", v)
  if (format == "tenths") return sprintf("%.1f", v / 10)
  if (v ~ /^-?[0-9]+$/ && length(v) > 3) return thousands(v)
  return v
}
function same(text, v, format,   a, b) {
  a = text
  b = shown(v, format)
  gsub(/,/, "", a)
  gsub(/,/, "", b)
  return a == b
}
function wrong(words) { if (!update) print FNR, words }

# NUMBER<!-- KEY FORMAT --> in a line: compared, or rewritten
function figures(line,   done, head, key, part, n, number) {
  done = ""
  while (match(line, /<!-- [a-z][A-Za-z0-9_.-]*( (KiB|k|tenths|[0-3]))? -->/)) {
    key = substr(line, RSTART + 5, RLENGTH - 9)
    head = substr(line, 1, RSTART - 1)
    n = split(key, part, " ")
    if (part[1] != "given" && part[1] != "end") {
      number = ""
      if (match(head, /-?[0-9][0-9,.]*$/)) number = substr(head, RSTART, RLENGTH)
      if (!(part[1] in value)) wrong("no key '" part[1] "' in the results")
      else if (number == "") wrong("no number before <!-- " key " -->")
      else {
        if (!same(number, value[part[1]], part[2]))
          wrong(number " for " part[1] ", the results have " shown(value[part[1]], part[2]))
        head = substr(head, 1, length(head) - length(number)) shown(value[part[1]], part[2])
      }
    }
    match(line, /<!-- [a-z][A-Za-z0-9_.-]*( (KiB|k|tenths|[0-3]))? -->/)
    done = done head substr(line, RSTART, RLENGTH)
    line = substr(line, RSTART + RLENGTH)
  }
  return done line
}

function label(text) {
  gsub(/[`*]/, "", text)
  gsub(/^ +| +$/, "", text)
  text = tolower(text)
  gsub(/[ ,\/]+/, "_", text)
  gsub(/[^a-z0-9_.-]/, "", text)
  return text
}

# A row of a table whose columns have keys
function row(line,   cell, n, count, key, text, bold, v, part, name) {
  count = split(line, cell, "|")
  name = label(cell[2])
  if (name != "") { last = name; continued = 1 } else name = last "." ++continued
  for (n = 3; n < count; ++n) {
    if (n - 2 > columns || column[n - 2] == "-") continue
    split(column[n - 2], part, ":")
    key = prefix "." name (part[1] ~ /^_/ ? "" : ".") part[1]
    text = cell[n]
    gsub(/^ +| +$/, "", text)
    if (text == "" || text == "-" && !(update && key in value)) continue
    bold = text ~ /^\*\*/
    gsub(/\*/, "", text)
    if (!(key in value)) { wrong("no key '" key "' in the results"); continue }
    v = value[key]
    if (!same(text, v, part[2])) wrong(text " for " key ", the results have " shown(v, part[2]))
    cell[n] = " " (bold ? "**" : "") shown(v, part[2]) (bold ? "**" : "") " "
  }
  text = cell[1]
  for (n = 2; n <= count; ++n) text = text "|" cell[n]
  return text
}

function unit_left(line,   text) {
  text = line
  gsub(/[0-9][0-9.,]*<!-- [^>]*-->/, "", text)
  gsub(/`[^`]*`/, "", text)
  return text ~ /[0-9] ?(ns|us|KiB|MiB|GiB|instructions|bytes of (code|stack|RAM|memory|world))([^A-Za-z]|$)/ ||
         text ~ /[0-9] (x|times) real time/ || text ~ /[0-9] ms a tick/
}

BEGIN {
  while ((getline line <budget) > 0) {
    if (line ~ /^#/ || line ~ /^compiler/) continue
    split(line, part, " ")
    value[part[1]] = part[2]
  }
  while ((getline line <results) > 0) {
    if (line ~ /^#/) continue
    split(line, part, "\t")
    value[part[1]] = part[2]
  }
  given = keyed = table = head_unit = fence = 0
}

/^ *```/ { fence = !fence; if (update) print; next }
fence { if (update) print; next }

/^ *<!-- table / {
  text = $0
  sub(/^ *<!-- table /, "", text)
  sub(/ -->$/, "", text)
  columns = split(text, column, " ") - 1
  prefix = column[1]
  for (n = 1; n <= columns; ++n) column[n] = column[n + 1]
  keyed = 1
  if (update) print
  next
}
/^ *<!-- given -->$/ { given = 1; if (update) print; next }

/^ *\|/ {
  if (!table) {
    table = 1
    head_unit = $0 ~ /(^|[^A-Za-z])(ns|us|KiB|instructions|real time|measured)([^A-Za-z]|$)/
    if (update) print
    next
  }
  if ($0 ~ /^ *\|[-| :]*$/) { if (update) print; next }
  line = keyed ? row($0) : figures($0)
  if (!keyed && !given && !($0 ~ /<!-- given -->/) && (unit_left($0) || (head_unit && $0 ~ /[0-9]/ && $0 !~ /<!-- /)))
    wrong("a figure without its key: " substr($0, 1, 60))
  if (update) print line
  next
}
{
  if (table || $0 !~ /^ *$/) { table = keyed = given = 0 }
  line = figures($0)
  if ($0 !~ /<!-- given -->/ && unit_left($0)) wrong("a figure without its key: " substr($0, 1, 60))
  if (update) print line
}
