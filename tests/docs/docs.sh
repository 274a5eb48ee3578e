#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# docs.sh [update]: the pages hold. README has at most 1,500 words; links lead somewhere; paths, functions,
# names of the interface and targets of make that pages name exist; blocks run, compile, or are what a file
# says; figures are those of tests/results.tsv and tests/budget/budget.txt. tests/README.md has the rules for
# writers. `update` writes the figures of the results into the pages. Last it tries itself on pages that must be refused, tests/docs/bad.
. tests/lib/suite.sh

root=$PWD
work=$root/$FRAY_BUILD/docs
case $FRAY_BUILD in /*) work=$FRAY_BUILD/docs ;; esac
rm -rf "$work"
mkdir -p "$work/none"
pages=$(find README.md CHANGELOG.md rt platform tools tests -name '*.md' ! -path 'tests/docs/bad/*' | sort)

if [ "${1:-}" = update ]; then
  for page in $pages; do
    awk -v budget=tests/budget/budget.txt -v results=tests/results.tsv -v update=1 -f tests/docs/figures.awk "$page" >"$work/page"
    cmp -s "$work/page" "$page" || { cat "$work/page" >"$page"; echo "$page"; }
  done
  exit 0
fi

# Every word of the sources that could be a name.
find rt platform tools tests -name '*.[chS]' -o -name '*.inl.h' | xargs cat |
  grep -oE '[A-Za-z_][A-Za-z0-9_]+' | LC_ALL=C sort -u >"$work/names"
cat Makefile tests/*/*.sh platform/zephyr/* 2>/dev/null | grep -oE '(FRAY|FX|CONFIG_FRAY)_[A-Z0-9_]+' | LC_ALL=C sort -u >>"$work/names"

# What blocks of a page run in: the tree by links, so that what they write stays here.
scratch_of() { # NAME
  mkdir -p "$work/scratch/$1"
  for entry in rt platform tools tests linker Makefile README.md LICENSE; do ln -sfn "$root/$entry" "$work/scratch/$1/$entry"; done
  case $FRAY_BUILD in /*) ln -sfn "$FRAY_BUILD" "$work/scratch/$1/build" ;; *) ln -sfn "$root/$FRAY_BUILD" "$work/scratch/$1/build" ;; esac
  echo "$work/scratch/$1"
}

exists() { # PAGE PATH: below the page's folder, rt or the root; * as in a shell
  for base in "$(dirname "$1")" . rt; do
    # shellcheck disable=SC2086
    set -- "$1" "$2" $base/$2
    if [ -e "$3" ] || [ -e "$3.c" ]; then return 0; fi
  done
  return 1
}

anchor_of() { awk -v out="$work/none" -f tests/docs/page.awk "$1" | sed -n 's/^heading	//p'; }

# A part of FILE, line for line?
stands_in() { # BLOCK FILE
  awk 'FNR == NR { want[++n] = $0; next } { have[++m] = $0 }
    END { for (i = 0; i + n <= m; ++i) { for (j = 1; j <= n && have[i + j] == want[j]; ++j) {} if (j > n) exit 0 } exit 1 }' "$1" "$2"
}

block() { # PAGE LINE LANGUAGE FILE MARK: prints what is wrong
  case $5 in
  'not run: '*) echo "$1:$2: ${5#not run: }" >>"$work/not_run"; return ;;
  'file: '*)
    if [ ! -f "${5#file: }" ]; then echo "no file ${5#file: }"
    elif ! stands_in "$4" "${5#file: }"; then echo "is not what ${5#file: } says"; fi
    echo >>"$work/held"
    return ;;
  esac
  case $3 in
  text) ;;
  sh)
    echo >>"$work/ran"
    folder=$(scratch_of "$(echo "$1" | tr '/.' '__')")
    if ! (cd "$folder" && ulimit -S -t 300 && CC="${CC:-cc}" MAKEFLAGS='' timeout 6000 sh -eu "$4") </dev/null >"$work/block.txt" 2>&1; then
      echo "does not run: $(tail -n 3 "$work/block.txt" | tr '\n' ' ')"
    fi ;;
  c)
    echo >>"$work/ran"
    code=$4
    case $5 in
    'in: '*)
      sed -e "/^\/\* block \*\/$/r $4" "${5#in: }" >"$4.c"
      code=$4.c ;;
    esac
    if ! ${CC:-cc} -std=c11 -Wall -Wextra -Werror -I. -Itests/install/zephyr/stand_in -fsyntax-only -x c "$code" 2>"$work/block.txt"; then
      echo "does not compile: $(head -n 3 "$work/block.txt" | tr '\n' ' ')"
    fi ;;
  scene)
    echo >>"$work/ran"
    cp "$4" "$4.scene"
    if ! "$FRAY" scene "$4.scene" -o "$work/block.img" >"$work/block.txt" 2>&1; then
      echo "does not compile: $(head -n 2 "$work/block.txt" | tr '\n' ' ')"
    fi ;;
  *) echo "is tagged $3, expected sh, c, scene, text, or a file that has it" ;;
  esac
}

page() { # PAGE: one line for each thing that is wrong
  mkdir -p "$work/blocks"
  rm -f "$work/blocks"/*
  awk -v out="$work/blocks" -f tests/docs/page.awk "$1" >"$work/records"
  tab=$(printf '\t')
  while IFS=$tab read -r kind line rest more mark; do
    case $kind in
    link)
      target=${rest%%#*} anchor=''
      case $rest in http://* | https://* | mailto:*) continue ;; *'#'*) anchor=${rest#*#} ;; esac
      file=$1
      [ -z "$target" ] || file=$(dirname "$1")/$target
      if [ ! -e "$file" ]; then echo "$1:$line: dead link, $rest"
      elif [ -n "$anchor" ] && ! anchor_of "$file" | grep -qx -- "$anchor"; then echo "$1:$line: no heading '#$anchor' in $file"; fi ;;
    path) [ "$1" = CHANGELOG.md ] || exists "$1" "$rest" || echo "$1:$line: no file $rest" ;;
    name)
      [ "$1" = CHANGELOG.md ] && continue
      case $rest in *_) grep -q "^$rest" "$work/names" ;; *) grep -qx "$rest" "$work/names" ;; esac || echo "$1:$line: nothing is called $rest" ;;
    target) grep -q "^${rest}[ :]" Makefile || grep -q "^[a-z$()_ -]* ${rest}:" Makefile || echo "$1:$line: no target $rest in the Makefile" ;;
    block) said=$(block "$1" "$line" "$rest" "$more" "$mark"); [ -z "$said" ] || echo "$1:$line: the block $said" ;;
    bad) echo "$1:$line: $rest" ;;
    esac
  done <"$work/records"
  awk -v budget=tests/budget/budget.txt -v results=tests/results.tsv -v update=0 -f tests/docs/figures.awk "$1" |
    while read -r line text; do echo "$1:$line: $text"; done
}

: >"$work/ran"
: >"$work/held"
: >"$work/not_run"
for name in $pages; do
  wrong=$(page "$name")
  if [ -z "$wrong" ]; then pass; else fail "$wrong"; fi
done
words=$(awk -v out="$work/none" -f tests/docs/page.awk README.md | sed -n 's/^words	//p')
if [ "$words" -le 1500 ]; then pass; else fail "README.md has $words words, at most 1500"; fi

# Each function of the tables and of the screen of rt/README.md is in the file beside it.
stages() { # PAGE: FUNCTION FILE...
  awk -F'|' '/^\| (- )?`/ && $3 ~ /\.[ch]`/ { gsub(/[`,]/, " "); n = split($2, f, " "); for (k = 1; k <= n; k++) if (f[k] ~ /^[a-z_]+_/) print f[k], $3 }
    /^ +[a-z_]+ +[a-z_]+\/[a-z_]+\.c/ { split($0, f, " "); print f[1], f[2] }' "$1"
}
said=$(stages rt/README.md | while read -r function files; do
  (cd rt && grep -qE "^[a-z].*[ *]$function\(" $files) || echo "rt/README.md: no $function() in $files"
done)
if [ -z "$said" ]; then pass; else fail "$said"; fi

# Every scene word that is gone is in the CHANGELOG, with the new one.
sed -n 's/^    {"[a-z]*", "\([a-z_]*\)", "\([a-z_]*\)"},$/\1 \2/p' tools/scene_language/old_words.c 2>/dev/null >"$work/old_words" || true
missing=$(while read -r old new; do grep -q "[\` ]${old}[\` ].*[\` ]${new}[\` ]" CHANGELOG.md || echo "$old, now $new"; done <"$work/old_words")
if [ -z "$missing" ]; then pass; else fail "CHANGELOG.md lacks scene words: $missing"; fi

echo "  $(echo "$pages" | wc -l) pages, README $words words; blocks: $(wc -l <"$work/ran") run, $(wc -l <"$work/held") held against their files, $(wc -l <"$work/not_run") not run"
sed 's/^/  not run /' "$work/not_run"

# Pages that must be refused: their first line says with which words.
for name in tests/docs/bad/*.md; do
  expected=$(sed -n '1s/^<!-- expect: \(.*\) -->$/\1/p' "$name")
  wrong=$(page "$name")
  if [ -n "$expected" ] && echo "$wrong" | grep -qF -- "$expected" && [ "$(echo "$wrong" | wc -l)" -eq 1 ]; then pass; else
    fail "$name: expected '$expected', found '$wrong'"
  fi
done
suite_end
