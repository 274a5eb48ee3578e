# SPDX-License-Identifier: Apache-2.0
# For tidy.sh to source: each rule of rules.sh on small trees that break it, and on one that does not. An example is
# a tree in $work/examples; `breaks RULE WORDS` says that the rule must refuse the tree, in these words.

example() { # starts a tree that breaks no rule, and goes to its root
  rm -rf "$work/examples"
  mkdir -p "$work/examples"
  cd "$work/examples"
  file rt/woven/damp.h 'int damp(int a);'
  file rt/woven/damp.c '#include "rt/woven/damp.h"' 'int damp(int a) {' '  return a;' '}'
  file rt/wire/frame.h '/* Contract: Context: thread. */' '#ifndef H' '' '/* Cost: constant. a: any. */' 'int frame_of(int a);' '#endif'
}
file() { # PATH LINE...: a file with a licence and these lines
  path=$work/examples/$1
  shift
  mkdir -p "$(dirname "$path")"
  printf '%s\n' '/* SPDX-License-Identifier: Apache-2.0 */' "$@" >"$path"
}
lines() { awk -v n="$1" -v text="$2" 'BEGIN { while (n-- > 0) print text }'; }

accepts() { # RULE
  said=$(rule_"$1")
  if [ -z "$said" ]; then pass; else fail "tidy: $1 refuses a tree without fault: $said"; fi
}
breaks() { # RULE WORDS: exactly one line, with these words
  said=$(rule_"$1")
  case $said in
    *"
"*) fail "tidy: $1 says more than one line of one fault: $said" ;;
    *"$2"*) pass ;;
    *) fail "tidy: $1 does not find '$2' in its example: $said" ;;
  esac
}
forbids() { # FILE TARGET: an arrow
  example
  file "$1" "#include \"$2\""
  breaks arrows "$1:2: must not include $2"
}
allows() { # FILE TARGET
  example
  file "$1" "#include \"$2\""
  accepts arrows
}

try_arrows() {
  forbids rt/woven/damp.c rt/membrane/wind.h
  forbids rt/membrane/wind.c rt/woven/damp.h
  forbids rt/membrane/wind.c rt/contact/collider.h
  forbids rt/contact/collider.c rt/membrane/wind.h
  forbids rt/haptics/haptic_force.c rt/woven/damp.h
  forbids rt/state/world.c rt/simd/simd.h
  forbids rt/simd/avx2.c rt/woven/damp.h
  forbids rt/self_collision/triangle_collision.c rt/woven/yarn_slip.h
  forbids rt/self_collision/impact_zones.c rt/tick/tick.h
  forbids rt/tick/tick.c rt/wire/codec.h
  forbids rt/wire/codec.c rt/state/world.h
  forbids rt/base/hash.c rt/state/world.h
  forbids rt/fray.h rt/base/fx.h
  forbids platform/loop.c rt/tick/tick.h
  forbids tools/scene_language/lexer.c tools/scene_compiler/draft.h
  forbids tools/bus/live.c tools/recording/replay.h
  forbids tools/bench/bench.c tools/cmd/cmd.h
  forbids tools/world/world.c tests/lib/test.h
  allows rt/membrane/blade_cut.c rt/contact/collider.h
  allows rt/self_collision/yarn_collision.c rt/woven/yarn_slip.h
  allows rt/contact/collider.c rt/fray.h
  allows rt/workers/schedule.c rt/tick/tick.h
  allows tools/main.c tools/cmd/cmd.h
  example
  file rt/cloth/cloth.c '#include "rt/fray.h"'
  breaks arrows 'arrows.txt does not name its room'
  example
  file rt/woven/slip.c '#include "damp.h"'
  breaks arrows 'expected a path from the root'
  for target in '#include "rt/woven/../membrane/wind.h"' '#include "rt/woven//damp.h"'; do
    file rt/woven/slip.c "$target"
    breaks arrows 'expected a path from the root'
  done
  for target in '#include <rt/membrane/wind.h>' '#include OTHER' '#include "rt/membrane/wind.c"'; do
    file rt/woven/slip.c "$target"
    breaks arrows 'expected a header in double quotes'
  done
  for target in ' #  include "rt/membrane/wind.h"' '#include"rt/membrane/wind.h"'; do
    file rt/woven/slip.c "$target"
    breaks arrows 'must not include rt/membrane/wind.h'
  done
}

try_circles() {
  example
  accepts circles
  file rt/woven/a.h '#include "rt/woven/b.h"'
  file rt/woven/b.h '#include "rt/woven/a.h"'
  said=$(rule_circles)
  case $said in *loop*rt/woven/a.h*) pass ;; *) fail "tidy: a circle of includes is not found: $said" ;; esac
}

try_names_and_words() {
  example
  file rt/membrane/damp.c 'int other;'
  breaks stems 'the stem damp is also in rt/membrane/'
  example
  file rt/membrane/wind.inl.h 'int other;'
  file rt/membrane/wind.h 'int other;'
  accepts stems
  file rt/contact/wind.c 'int other;'
  breaks stems 'the stem wind is also in rt/contact/'

  example
  file rt/woven/slip.c '/* "it" is here' '   and Who is there */' 'int who; // a comment' "char quote = '\"'; const char *his = \"/* him */\";"
  breaks persons 'rt/woven/slip.c:3: who'
  file rt/woven/slip.c '/* the one */ int a; // nobody'
  breaks persons 'rt/woven/slip.c:2: nobody'
  file rt/woven/slip.c '/* whole; white; this; whoever */'
  accepts persons

  example
  file rt/woven/slip.c '/* selves_run */' 'int selves_run(void);'
  breaks old_words 'rt/woven/slip.c:3: selves_run'

  example
  file rt/woven/slip.c '/* as in woven/damp.c, rt/woven/damp.h; stdio.h */' '#include <sys/none.h>'
  accepts paths
  file rt/woven/slip.c '/* twin: rt/woven/slips.inl.h */'
  breaks paths 'rt/woven/slip.c:2: no file rt/woven/slips.inl.h'
}

try_sizes() {
  example
  accepts columns
  lines 110 x | tr -d '\n' | sed 's/$/\n/' >>rt/woven/damp.h
  accepts columns
  lines 111 x | tr -d '\n' | sed 's/$/\n/' >>rt/woven/damp.h
  breaks columns 'rt/woven/damp.h:4: 111 columns'

  example
  accepts files
  lines 500 '' >rt/woven/long.c
  lines 600 '' >tools_long.c
  mkdir tools && mv tools_long.c tools/long.c
  accepts files
  lines 1 '' >>rt/woven/long.c
  breaks files 'rt/woven/long.c: 501 lines'
  rm rt/woven/long.c
  lines 1 '' >>tools/long.c
  breaks files 'tools/long.c: 601 lines'

  example
  { echo 'static int of(int a,' && echo '              int b) {' && lines 67 '  a += b;' && echo '}'; } >>rt/woven/damp.c
  accepts functions
  { echo 'static int of(int a,' && echo '              int b) {' && lines 68 '  a += b;' && echo '}'; } >>rt/woven/damp.c
  breaks functions 'rt/woven/damp.c:76: 71 lines'
}

contract() { file rt/wire/codec.h "$@" '#endif'; }
try_contracts() {
  example
  accepts contracts
  contract '/* A head. */' '#ifndef H' '/* Cost: constant. */' 'int of(void);'
  said=$(rule_contracts)
  case $said in *'no Contract'*'no Context:'*) pass ;; *) fail "tidy: a header without a contract is not found: $said" ;; esac
  head='/* Contract, where a function does not say otherwise: Context: thread. hand: 0..1. */'
  contract "$head" '#ifndef H' '/* Cost: one copy. */' 'int of(const char *text);'
  breaks contracts "the head's contract has no NULL:"
  contract "$head" '#ifndef H' '' 'int of(uint32_t hand);'
  breaks contracts 'rt/wire/codec.h:5: of has no contract above it'
  contract "$head" '#ifndef H' '/* Cost: constant. */' '' 'int of(uint32_t hand);'
  breaks contracts 'of has no contract above it'
  contract "$head" '#ifndef H' '/* The hand. */' 'int of(uint32_t hand);' 'int that(void);' '/* Cost: constant. */' 'int other(void);'
  said=$(rule_contracts)
  case $said in *'of has no Cost:'*'that has no Cost:'*) pass ;; *) fail "tidy: a function without a cost is not found: $said" ;; esac
  contract "$head" '#ifndef H' '/* Cost: constant. */' 'static inline int of(uint32_t hand,' '                     uint32_t body) {' '  return 0;' '}'
  breaks contracts 'of: no range of body'
  contract "$head" '#ifndef H' '/* Cost: constant. body < bodies; row: any. */' 'int of(uint32_t hand, uint32_t body, int row);' \
    'uint32_t other(uint32_t body);' 'typedef enum { A, B } letter;' 'extern const int data[2];'
  accepts contracts
}

try_licences() {
  example
  accepts licences
  echo 'int a;' >rt/woven/slip.c
  breaks licences 'rt/woven/slip.c: no SPDX line'
}

try_rules() {
  root=$PWD
  for set in arrows circles names_and_words sizes contracts licences; do
    try_"$set"
    cd "$root"
  done
  rm -rf "$work/examples"
}
