#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# parts.sh: what runs in parts is run whole by all of them: the shares of a list, the choice of a part by a commit,
# and each list that the Makefile and the golden table divide. And .ci/run, in a tree with a make of its own, fails
# for a stage that fails, that says nothing, or that was not run, and says which parts are left.
. tests/lib/suite.sh

work=$FRAY_BUILD/parts
rm -rf "$work"
mkdir -p "$work/bin"
part='sh tests/part.sh'

is() { # WHAT FOUND EXPECTED
  if [ "$2" = "$3" ]; then pass; else fail "$1: '$2', expected '$3'"; fi
}
words() { tr '\n' ' ' | sed 's/ $//'; }

is 'part 2 of 3' "$($part share 2/3 a b c d e f g h | words)" 'b e h'
is 'a part of more than there are' "$($part share 3/4 a b)" ''
for bad in 0/4 5/4 2 /4 2/ a/4 2/0 1/2/3 -1/4; do refutes "part '$bad' is taken" $part share $bad a b 2>"$work/said"; done
. tests/determinism/configs.sh
# shellcheck disable=SC2086
for list in "$CONFIGS_FULL" "$CONFIGS_SHORT"; do
  for n in 1 2 3 4 7; do
    k=1
    while [ $k -le $n ]; do $part share $k/$n $list; k=$((k + 1)); done | sort >"$work/all"
    printf '%s\n' $list | sort >"$work/expected"
    holds "the golden table in $n parts" cmp -s "$work/all" "$work/expected"
  done
done

# eight runs of any commits are a cycle, also where the same commit runs again
for hashes in '0000 0000 0000 0000 0000 0000 0000 0000' '0007 0006 fff1 a000 0003 0002 abcd 1111' '1234 9abc 1234 ffff 0000 7777 0000 8888'; do
  rm -f "$work/ran"
  for hash in $hashes; do
    k=$($part choose "$work/ran" "${hash}aaaa")
    $part ran "$work/ran" "$hash" "$k"
  done
  is "the parts of $hashes" "$(cut -d' ' -f2 "$work/ran" | sort | words)" '1 2 3 4 5 6 7 8'
  is 'what is left of a cycle that has ended' "$($part left "$work/ran")" '1 2 3 4 5 6 7 8'
done
is 'the first part is that of the digits' "$($part choose "$work/none" 000cf)" 5
printf 'x 2\nx 4\nx 9\n' >"$work/ran"
is 'what is left' "$($part left "$work/ran")" '1 3 5 6 7 8'

# the lists that make divides: each word once, over all parts
for goal in san guests proof target-test analysis; do
  whole=$(${MAKE_COMMAND:-make} -s --no-print-directory MAKEFLAGS= parts-of-$goal PART=1/1 | words)
  holds "make $goal: its list" [ "$(echo "$whole" | wc -w)" -ge 3 ]
  # shellcheck disable=SC2086
  is "make $goal in four parts" "$(for k in 1 2 3 4; do ${MAKE_COMMAND:-make} -s --no-print-directory MAKEFLAGS= parts-of-$goal PART=$k/4; done | sort | words)" \
    "$(printf '%s\n' $whole | sort | words)"
done

# what make test runs: each suite and program in one part of eight or in all, and all that are asked for by name
chains_of() { FRAY_BUILD=b PART=$1 SUITES=${2:-} sh tests/chains.sh b/tests/physics/test_yarn_rest b/tests/physics/test_one | tr ' ' '\n' | grep .; }
eight='1 2 3 4 5 6 7 8'
for k in $eight; do chains_of $k/8 | sort -u; done | sort | uniq -c | awk '{ print $1 }' | sort -u >"$work/times"
is 'make test: how often a suite or program is in eight parts' "$(words <"$work/times")" '1 8'
is 'make test in eight parts' "$(for k in $eight; do chains_of $k/8; done | sort -u | words)" "$(chains_of 1/1 | sort -u | words)"
is 'make test, a suite of another part by its name' "$(chains_of 3/8 install | head -n 1)" install

# .ci/run where every tool is there and make says what it is told
tree=$work/tree
mkdir -p "$tree/tests/bus" "$tree/.ci"
cp .ci/run "$tree/.ci/run"
cp tests/part.sh tests/results.sh "$tree/tests"
echo 'PACKAGES=""' >"$tree/tests/bus/guest.sh"
printf '#!/bin/sh\necho install ok installed\n' >"$work/bin/dpkg-query"
printf '#!/bin/sh\necho 0000aaaa\n' >"$work/bin/git"
cat >"$work/bin/make" <<'MAKE'
#!/bin/sh
goal=all
for goal; do :; done
echo "$goal $PART" >>goals
case $goal in "$BROKEN") echo "FAILED a thing of $goal"; echo '2 passed, 1 failed'; exit 2 ;; "$MUTE" | all) exit 0 ;; esac
echo '3 passed, 0 failed'
MAKE
chmod +x "$work/bin"/*
bin=$(cd "$work/bin" && pwd)
ci() { # NAME=VALUE...: sets code; $work/said
  code=0
  rm -f "$tree/goals"
  (cd "$tree" && env -u PART -u UPDATE BROKEN=- MUTE=- PATH="$bin:$PATH" "$@" bash .ci/run) >"$work/said" 2>&1 || code=$?
}
says() { if grep -qx -- "$2" "$work/said"; then pass; else fail "$1: no line '$2': $(tail -n 4 "$work/said" | words)"; fi; } # WHAT LINE

ci
is 'CI where all is good' "$code $(tail -n 1 "$work/said")" '0 25 passed, 0 failed'
says 'CI' '==== part 1/8; not run in this cycle, as build/ci/parts says: parts 2 3 4 5 6 7 8'
is 'parts of CI' "$(grep / "$tree/goals" | words)" 'golden 1/8 target-test 1/8 guests 1/4 analysis 1/8'
for k in 2 3 4 5 6; do ci; done
is 'guests of the sixth CI' "$(grep guests "$tree/goals")" 'guests 2/4'
for k in 7 8; do ci; done
says 'the eighth CI' '==== part 8/8; not run in this cycle, as build/ci/parts says: parts 1 2 3 4 5 6 7 8'
rm "$tree/build/ci/parts"
ci BROKEN=golden PART=3
is 'CI with a table that is not golden' "$code $(tail -n 1 "$work/said")" '1 24 passed, 1 failed'
says 'CI names it' 'golden: FAILED a thing of golden'
ci MUTE=analysis PART=3
is 'CI with an analysis that says nothing' "$code $(tail -n 1 "$work/said")" '1 22 passed, 1 failed'
says 'CI, part 3' '==== part 3/8; not run in this cycle, as build/ci/parts says: parts 1 2 4 5 6 7 8'
ci FRAY_CI_SECONDS=1000
is 'CI without time' "$code" 1
says 'CI without time' '==== part 1/8; not run in this cycle, as build/ci/parts says: parts 1 2 4 5 6 7 8'
says 'CI names what was not run' '==== not run: analysis, [0-9]* s of 1000 s are gone'
ci PART=9
is 'CI, a part that is none' "$code" 2
suite_end
