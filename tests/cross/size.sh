#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Bytes of code of rt by machine; on the Cortex-M3 also what a program of it takes, and the deepest
# frames. `fray info` prints the memory of one scene.
. tests/lib/suite.sh
. tests/cross/configs.sh

total() { # LIBRARY: text data bss
  "${NM%nm}size" "$1" | awk 'NR > 1 { t += $1; d += $2; b += $3 } END { printf "%8d %6d %6d\n", t, d, b }'
}
printf '  %-10s %8s %6s %6s   rt\n' "" code data bss
for name in gcc-O2 gcc-O3 gcc-Os i386-O2 s390x-O2 m3-O2 m3-Os; do
  config "$name" || { not_run "size of $name" "$PACKAGES"; continue; }
  config_make "$name" libfray.a
  printf '  %-10s %s\n' "$name" "$(total "$FRAY_BUILD/cross/$name/libfray.a")"
done
if config m3-O2; then
  frames=$FRAY_BUILD/cross/frames
  mkdir -p "$frames"
  for file in rt/*/*.c; do
    # shellcheck disable=SC2086
    $CC -std=c11 -O2 $EXTRA -I. -fstack-usage -c "$file" -o "$frames/$(basename "$file" .c).o"
  done
  echo "  deepest frames on m3-O2, bytes:"
  cat "$frames"/*.su | awk -F'[\t:]' '{ print $5, $4 }' | sort -rn | head -n 5 | sed 's/^/    /'
  program=$FRAY_BUILD/cross/replay/m3-O2
  if [ -f "$program" ] && [ -f "$program.out" ]; then
    echo "  memory of a world on m3-O2, bytes:"
    awk '$1 == "case" { name = $2 } $1 == "memory" { printf "    %-8s %d\n", name, $2 }' "$program.out"
  fi
fi
