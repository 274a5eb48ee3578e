#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Three users of the installed library: CMake, pkg-config, a Zephyr module on a stand-in for Zephyr.
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
    if cmake -S tests/consumer/cmake -B "$work/cmake" -DCMAKE_PREFIX_PATH="$prefix" \
      -DCONSUMER_IMAGE="$work/small.c" >"$work/cmake.txt" 2>&1 &&
      cmake --build "$work/cmake" >>"$work/cmake.txt" 2>&1; then
      runs cmake "$work/cmake/consumer"
    else
      fail "cmake: $(tail -n 12 "$work/cmake.txt")"
    fi
  done
  sed 's/fray [0-9.]*/fray 0.0/' tests/consumer/cmake/CMakeLists.txt >"$work/CMakeLists.txt"
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

if have pkg-config; then
  if PKG_CONFIG_PATH=$work/installed/lib/pkgconfig suite_make -C tests/consumer/pkgconfig \
    IMAGE="$work/small.c" OUT="$work/by_pkgconfig" 2>"$work/pkgconfig.txt"; then
    runs pkg-config "$work/by_pkgconfig"
  else
    fail "pkg-config: $(cat "$work/pkgconfig.txt")"
  fi
else
  not_run "the consumer with pkg-config" pkg-config
fi

if have cmake; then
  "$FRAY" scene tests/cross/torn.scene -o "$work/hands.c" --emit-c image >"$work/scene.txt"
  if cmake -S tests/consumer/zephyr -B "$work/zephyr" -DFRAY="$root" -DCONSUMER_IMAGE="$work/hands.c" \
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
suite_end
