# SPDX-License-Identifier: Apache-2.0
# awk -v words=REGEX -v of=comments|code -f comments.awk SOURCE...: lines on which one of the words stands, whole
# and in any case: `of` says whether in comments or in code (strings are neither).
FNR == 1 { inside = 0 }
{
  comment = code = ""
  rest = $0
  while (rest != "") {
    if (inside) {
      at = index(rest, "*/")
      comment = comment " " (at ? substr(rest, 1, at - 1) : rest)
      rest = at ? substr(rest, at + 2) : ""
      inside = at == 0
    } else if (match(rest, /\/\*|\/\/|"|'/)) {
      code = code substr(rest, 1, RSTART - 1) " "
      mark = substr(rest, RSTART, RLENGTH)
      rest = substr(rest, RSTART + RLENGTH)
      if (mark == "/*") inside = 1
      else if (mark == "//") { comment = comment " " rest; rest = "" }
      else {
        # to the quote that ends it, past those that a backslash escapes
        while (rest != "" && substr(rest, 1, 1) != mark) rest = substr(rest, substr(rest, 1, 1) == "\\" ? 3 : 2)
        rest = substr(rest, 2)
      }
    } else { code = code rest; rest = "" }
  }
  text = of == "comments" ? comment : code
  n = split(tolower(text), word, /[^a-z0-9_]+/)
  for (k = 1; k <= n; k++) if (word[k] ~ ("^(" words ")$")) print FILENAME ":" FNR ": " word[k]
}
