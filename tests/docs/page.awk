# SPDX-License-Identifier: Apache-2.0
# One page of Markdown in, records out, fields apart by tabs:
#   words N | heading ANCHOR | link LINE TARGET | path LINE PATH | name LINE IDENTIFIER | target LINE TARGET
#   block LINE LANGUAGE FILE MARK      its text is in FILE, below `out`
#   bad LINE WORDS
function emit(kind, rest) { printf "%s\t%s\n", kind, rest }

function slug(text) {
  gsub(/`/, "", text)
  gsub(/\]\([^)]*\)/, "", text)
  text = tolower(text)
  gsub(/[^a-z0-9 _-]/, "", text)
  gsub(/ /, "-", text)
  return text
}

function links(text,   target) {
  while (match(text, /\]\([^)]+\)/)) {
    target = substr(text, RSTART + 2, RLENGTH - 3)
    emit("link", FNR "\t" target)
    text = substr(text, RSTART + RLENGTH)
  }
}

# What stands between back quotes: paths, functions, names of the interface, targets of make.
function code_span(text,   rest) {
  if (text ~ /^(rt|platform|tools|tests|linker)\/[A-Za-z0-9_.*\/-]*$/) emit("path", FNR "\t" text)
  else if (text ~ /^[a-z0-9_]+\/[A-Za-z0-9_.*\/-]*\.(c|h|sh|md|awk|ld|dbc|tsv|S|txt|scene|hand|log)$/ && text !~ /^(out|build)\//)
    emit("path", FNR "\t" text)
  rest = text
  if (text ~ /^[a-z][a-z0-9_]*\(\)$/) {
    emit("name", FNR "\t" substr(text, 1, length(text) - 2))
    rest = ""
  }
  while (match(rest, /(FRAY|FX|fray)_[A-Za-z0-9_]+/)) {
    emit("name", FNR "\t" substr(rest, RSTART, RLENGTH))
    rest = substr(rest, RSTART + RLENGTH)
  }
  if (match(text, /^make [a-z][a-z-]*/)) emit("target", FNR "\t" substr(text, 6, RLENGTH - 5))
}

BEGIN { mark = ""; blocks = 0; fence = ""; blank = 1; list = 0 }

fence != "" {
  line = $0
  sub("^" indent, "", line)
  if (line ~ /^```[ ]*$/) {
    emit("block", from "\t" fence "\t" file "\t" mark)
    close(file)
    fence = ""
    mark = ""
  } else {
    print line >file
    words += NF
  }
  blank = 0
  next
}

/^ *~~~/ && !tildes++ { emit("bad", FNR "\ta fence of ~~~, expected ```") }

/^ *```/ {
  match($0, /^ */)
  indent = substr($0, 1, RLENGTH)
  fence = substr($0, RLENGTH + 4)
  if (fence == "") { fence = "text"; emit("bad", FNR "\ta fence without a language") }
  from = FNR
  file = out "/" ++blocks
  printf "" >file
  next
}

/^ *<!-- (not run|file|in): .* -->$/ {
  mark = $0
  sub(/^ *<!-- /, "", mark)
  sub(/ -->$/, "", mark)
  blank = 0
  next
}

/^[ ]*$/ { blank = 1; next }

{
  if ($0 ~ /^ *([-*]|[0-9]+\.) /) list = 1
  else if ($0 !~ /^ /) list = 0
  if (blank && $0 ~ (list ? "^       " : "^    ") && $0 !~ /^ *([-*]|[0-9]+\.) /)
    emit("bad", FNR "\tan indented block, expected ``` and its language")
  blank = 0
  if (mark != "") { emit("bad", FNR "\t'" mark "' with no block below it"); mark = "" }
  if ($0 ~ /^#+ /) {
    text = $0
    sub(/^#+ /, "", text)
    emit("heading", slug(text))
  }
  text = $0
  gsub(/<!--[^>]*-->/, "", text)
  words += split(text, none, /[ \t|]+/)
  plain = ""
  while ((at = index(text, "`")) > 0) {
    plain = plain substr(text, 1, at - 1) "x"
    text = substr(text, at + 1)
    end = index(text, "`")
    if (end == 0) break
    code_span(substr(text, 1, end - 1))
    text = substr(text, end + 1)
  }
  links(plain text)
}

END {
  if (fence != "") emit("bad", from "\ta block without an end")
  emit("words", words + 0)
}
