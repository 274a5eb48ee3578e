#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# What `make install` puts there and `make uninstall` removes: the library, linked each way (static, shared; by CMake, by
# pkg-config), the program of rt/EMBED.md, the command, its man page, its completion. And a Zephyr module on a stand-in for Zephyr.
. tests/lib/suite.sh

root=$PWD
work=$root/$FRAY_BUILD/consumer
case $FRAY_BUILD in /*) work=$FRAY_BUILD/consumer ;; esac
rm -rf "$work"
mkdir -p "$work"
"$FRAY" scene tests/scenes/small.scene -o "$work/small.c" --emit-c image >"$work/scene.txt"
"$FRAY" run tests/scenes/small.scene --ticks 100 >"$work/run.txt" 2>/dev/null
expected=$(sed -n 's/^hash \([0-9a-f]*\) ticks 100 .*/\1/p' "$work/run.txt")

# The tree is installed for /opt/fray below DESTDIR, then moved to where it is used.
if suite_make install PREFIX=/opt/fray DESTDIR="$work/stage" BUILD="$FRAY_BUILD"; then pass; else fail "make install"; fi
if grep -q '^prefix=/opt/fray$' "$work/stage/opt/fray/lib/pkgconfig/fray.pc" && [ ! -e "$work/stage/lib" ]; then pass; else fail "DESTDIR is in what was installed"; fi
suite_make install PREFIX="$work/installed" BUILD="$FRAY_BUILD" || fail "make install"

# Each header by itself, with nothing of this tree to fall back on.
for header in "$work"/installed/include/fray/rt/*.h "$work"/installed/include/fray/rt/*/*.h; do
  if (cd "$work" && ${CC:-cc} -std=c11 -fsyntax-only -I installed/include/fray -x c "$header") 2>"$work/header.txt"; then pass; else
    fail "$header: $(head -n 3 "$work/header.txt")"
  fi
done

runs() { # WORDS PROGRAM
  found=$("$2") || { fail "$1: exit $?, $found"; return; }
  if [ "$found" = "$expected" ]; then pass; else fail "$1: hash $found, expected $expected"; fi
  printf '  %-12s hash %s after 100 ticks\n' "$1" "$found"
}

if have cmake; then
  for prefix in "$work/installed" "$work/stage/opt/fray"; do
    rm -rf "$work/cmake"
    if cmake -S tests/install/cmake -B "$work/cmake" -DCMAKE_PREFIX_PATH="$prefix" \
      -DCONSUMER_IMAGE="$work/small.c" >"$work/cmake.txt" 2>&1 &&
      cmake --build "$work/cmake" >>"$work/cmake.txt" 2>&1; then
      runs cmake "$work/cmake/consumer"
      runs 'cmake shared' "$work/cmake/consumer_shared"
    else
      fail "cmake: $(tail -n 12 "$work/cmake.txt")"
    fi
  done
  sed 's/fray [0-9.]*/fray 0.0/' tests/install/cmake/CMakeLists.txt >"$work/CMakeLists.txt"
  if cmake -S "$work" -B "$work/old" -DCMAKE_PREFIX_PATH="$work/installed" >"$work/cmake.txt" 2>&1; then
    fail "cmake: another version is taken"
  elif grep -q 'with requested version "0.0"' "$work/cmake.txt"; then
    pass
  else
    fail "cmake: expected a word on the version: $(tail -n 12 "$work/cmake.txt")"
  fi
else
  not_run "the consumer with CMake" cmake
fi

library=$work/installed/lib
version=$(sed -n 's/^#define FRAY_VERSION "\(.*\)"$/\1/p' rt/fray.h)
series=${version%.*}
holds "the shared library's name" [ "$(readlink -f "$library/libfray.so")" = "$library/libfray.so.$version" ]
holds "the soname" [ "$(readelf -d "$library/libfray.so" | sed -n 's/.*SONAME.*\[\(.*\)\]/\1/p')" = "libfray.so.$series" ]
nm -D --defined-only "$library/libfray.so" | awk '$2 != "A" { sub(/@.*/, "", $3); print $3 }' >"$work/exported"
grep -rohE '[a-z][a-z0-9_]*' "$work/installed/include" | sort -u >"$work/declared"
holds "the shared library has public functions" [ "$(wc -l <"$work/exported")" -gt 60 ]
refutes "and no others: $(grep -vxFf "$work/declared" "$work/exported" | head -n 3)" grep -qvxFf "$work/declared" "$work/exported"
if ${CC:-cc} -std=c11 -I "$work/installed/include/fray" tests/install/main.c "$work/small.c" "$library/libfray.a" -o "$work/static" 2>"$work/static.txt"; then
  runs static "$work/static"
else
  fail "static: $(head -n 3 "$work/static.txt")"
fi

installed=$work/installed/bin/fray
holds "the installed command" [ "$("$installed" --version 2>&1 | awk '{ sub(/,/, "", $2); print $1, $2 }')" = "fray $version" ]
if have man; then
  MANPAGER=cat MANWIDTH=100 LC_ALL=C.UTF-8 man --warnings -l "$work/installed/share/man/man1/fray.1" >"$work/man.txt" 2>"$work/man.err" || true
  refutes "man -l: $(head -n 3 "$work/man.err")" [ -s "$work/man.err" ]
  for name in '' scene run verify hand render info bench; do
    # shellcheck disable=SC2086
    "$installed" $name --help | sed 's/^ *//; s/ *$//' >"$work/help.txt"
    sed 's/^ *//; s/ *$//' "$work/man.txt" | grep -vxFf - "$work/help.txt" >"$work/lacks.txt" || true
    if [ -s "$work/help.txt" ] && [ ! -s "$work/lacks.txt" ]; then pass; else fail "the man page lacks of fray $name --help: $(head -n 3 "$work/lacks.txt")"; fi
  done
else
  not_run "the man page" man-db
fi

# WORDS EXPECTED: what bash offers for the last word
completes() {
  # shellcheck disable=SC2016
  found=$(PATH=$work/installed/bin:$PATH bash -c '. "$1"; COMP_WORDS=($2); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _fray; echo "${COMPREPLY[*]}"' \
    bash "$work/installed/share/bash-completion/completions/fray" "$1") || found="exit $?"
  holds "completion of '$1': '$found', expected '$2'" [ "$found" = "$2" ]
}
if have bash; then
  completes 'fray ver' verify
  completes 'fray r' 'run render'
  completes 'fray run --rec' --record
  completes 'fray verify --sc' --scene
  completes 'fray hand --dr' --drop
  completes 'fray run small.sc' ''
else
  not_run completion bash
fi

if have pkg-config; then
  export LD_LIBRARY_PATH="$library" # pkg-config takes the shared one
  if PKG_CONFIG_PATH=$work/installed/lib/pkgconfig suite_make -C tests/install/pkgconfig \
    IMAGE="$work/small.c" OUT="$work/by_pkgconfig" 2>"$work/pkgconfig.txt"; then
    runs pkg-config "$work/by_pkgconfig"
    holds "pkg-config: the shared library" sh -c "ldd '$work/by_pkgconfig' | grep -q 'libfray.so.$series => $library/'"
  else
    fail "pkg-config: $(cat "$work/pkgconfig.txt")"
  fi
  # the program of rt/EMBED.md: two hands tear a cloth; a cut image is refused with a reason
  "$FRAY" scene tests/scenes/two_hands.scene -o "$work/two_hands.c" --emit-c image >"$work/scene.txt"
  sed 's/ image_bytes = .*/ image_bytes = 100;/' "$work/two_hands.c" >"$work/cut.c"
  for name in two_hands cut; do
    # shellcheck disable=SC2046
    ${CC:-cc} -std=c11 -Wall -Wextra -Werror tests/install/hands.c "$work/$name.c" -o "$work/$name" \
      $(PKG_CONFIG_PATH=$work/installed/lib/pkgconfig pkg-config --cflags --libs fray) 2>"$work/hands.txt" ||
      fail "hands.c: $(head -n 3 "$work/hands.txt")"
  done
  if "$work/two_hands" >"$work/hands.txt" && grep -q 'springs tear' "$work/hands.txt"; then pass; else fail "hands.c: $(tail -n 2 "$work/hands.txt")"; fi
  code=0
  "$work/cut" >"$work/hands.txt" 2>&1 || code=$?
  if [ $code -eq 1 ] && grep -q '^image refused, section 0' "$work/hands.txt"; then pass; else fail "hands.c takes a cut image: exit $code"; fi
  unset LD_LIBRARY_PATH
else
  not_run "the consumer with pkg-config" pkg-config
fi

if have cmake; then
  "$FRAY" scene tests/determinism/torn.scene -o "$work/hands.c" --emit-c image >"$work/scene.txt"
  if cmake -S tests/install/zephyr -B "$work/zephyr" -DFRAY="$root" -DCONSUMER_IMAGE="$work/hands.c" \
    >"$work/zephyr.txt" 2>&1 && cmake --build "$work/zephyr" >>"$work/zephyr.txt" 2>&1; then
    found=$("$work/zephyr/consumer") || fail "zephyr: exit $?"
    echo "  zephyr       $found"
    if [ "$found" = 'ticks 1000 lost 10 syncs 1000 poses 1000 forces 1000 overruns 0 halts 1' ]; then pass; else
      fail "zephyr: $found"
    fi
  else
    fail "zephyr: $(tail -n 20 "$work/zephyr.txt")"
  fi
else
  not_run "the Zephyr module" cmake
fi

# a PREFIX that would not work is refused, whatever it holds, and nothing is written or run; DESTDIR may be any folder
mkdir -p "$work/odd"
for verb in install uninstall; do
  # shellcheck disable=SC2016
  for prefix in "$work/odd/a b/c d" "$work/odd/a&touch $work/odd/ran" "$work/odd/a;b" "$work/odd/a|b" "$work/odd/a\"b" "$work/odd/a'b" \
    "$work/odd/\$\$HOME" "$work/odd/a\\b" odd/relative ./odd -odd; do
    refutes "make $verb PREFIX='$prefix' is taken" suite_make "$verb" PREFIX="$prefix" BUILD="$FRAY_BUILD" 2>"$work/odd.txt"
    holds "make $verb PREFIX='$prefix' says: $(head -n 2 "$work/odd.txt")" grep -qF 'expected for PREFIX an absolute path of letters, digits and /._+~@-' "$work/odd.txt"
  done
done
refutes "make install DESTDIR=-x is taken" suite_make install PREFIX=/opt DESTDIR=-x BUILD="$FRAY_BUILD" 2>"$work/odd.txt"
holds "what odd places made: $(ls -A "$work/odd") $(ls -d odd ./-* 2>/dev/null)" [ -z "$(ls -A "$work/odd")$(ls -d odd ./-* 2>/dev/null)" ]
# shellcheck disable=SC2016
stage="$work/odd/it's a&b \$\$HOME" kept=$work/odd/it\'s\ a\&b\ \$HOME
suite_make install PREFIX=/opt/c++_1.0~rc@x DESTDIR="$stage" BUILD="$FRAY_BUILD" || fail "make install, DESTDIR=$stage"
holds "DESTDIR of odd characters" grep -qx 'prefix=/opt/c++_1.0~rc@x' "$kept/opt/c++_1.0~rc@x/lib/pkgconfig/fray.pc"
suite_make uninstall PREFIX=/opt/c++_1.0~rc@x DESTDIR="$stage" BUILD="$FRAY_BUILD" || fail "make uninstall, DESTDIR=$stage"
holds "make uninstall, DESTDIR=$stage leaves $(find "$kept" ! -type d)" [ -z "$(find "$kept" ! -type d)" ]

# what others have put there stays
touch "$work/stage/opt/fray/lib/other.so" "$work/stage/opt/fray/include/fray/mine.h"
suite_make uninstall PREFIX=/opt/fray DESTDIR="$work/stage" BUILD="$FRAY_BUILD" || fail "make uninstall"
left=$(cd "$work/stage" && find . ! -type d | sort | tr '\n' ' ')
holds "uninstall leaves: $left" [ "$left" = './opt/fray/include/fray/mine.h ./opt/fray/lib/other.so ' ]
holds "uninstall leaves a folder of fray's" [ ! -e "$work/stage/opt/fray/lib/cmake/fray" ]
suite_end
