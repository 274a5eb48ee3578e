#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# fuzz.sh SECONDS: damaged images (their CRC mended), logs, scenes, scripts and OBJ files, SECONDS each, under
# sanitizers and FRAY_CHECKED; with libFuzzer where clang has it, else with tests/fuzz/driver.c.
# A crash leaves its input in BUILD/fuzz/.
. tests/lib/suite.sh
seconds=${1:-60}
work=$FRAY_BUILD/fuzz
rm -rf "$work/seeds"
mkdir -p "$work/seeds/image" "$work/seeds/candump" "$work/seeds/scene" "$work/seeds/obj"

"$FRAY" scene tests/scenes/small.scene -o "$work/seeds/image/small.img" >/dev/null
"$FRAY" scene tests/cross/bodies.scene -o "$work/seeds/image/bodies.img" >/dev/null
"$FRAY" scene tests/cross/allyarn.scene -o "$work/seeds/image/allyarn.img" >/dev/null
"$FRAY" scene tests/cross/meshes.scene -o "$work/seeds/image/meshes.img" >/dev/null
for case in frayed:150 stretched:150 rag:60 crumpled:90 pressed:60 slashed:60 folded:150; do
  "$FRAY" run "tests/cross/${case%:*}.scene" --ticks "${case#*:}" --save "$work/seeds/image/${case%:*}.img" >/dev/null
done
"$FRAY" hand -o "$work/small.log" tests/cross/small.hand
"$FRAY" run "$work/seeds/image/small.img" --log "$work/small.log" --ticks 300 \
  --save "$work/seeds/image/torn.img" --record "$work/recording" >/dev/null
head -n 40 "$work/small.log" >"$work/seeds/candump/device.log"
head -n 60 "$work/recording" >"$work/seeds/candump/recording.log"
printf '(1.000000) can0 123#R4\n(1.000000) can0 123##5AABB\n(1.5) x 20000004#0000000000000000\n# c\n' \
  >"$work/seeds/candump/kinds.log"
cp tests/scenes/*.scene tests/scenes/*.hand tests/cross/*.scene tests/cross/*.hand "$work/seeds/scene/"
cp tests/scenes/meshes/*.obj "$work/seeds/obj/"

# with clang and its fuzzer, or with any compiler and our driver
echo 'int LLVMFuzzerTestOneInput(const char *d, unsigned long n); int LLVMFuzzerTestOneInput(const char *d, unsigned long n) { return n > 1 ? d[0] == 0 : 0; }' >"$work/probe.c"
if have clang && clang -fsanitize=fuzzer,address "$work/probe.c" -o "$work/probe" 2>/dev/null; then
  CC=clang flags="-fsanitize=address,undefined -fno-sanitize-recover=all -fsanitize=fuzzer-no-link" link=-fsanitize=fuzzer driver=''
else
  echo "not run: libFuzzer needs clang and libclang-rt-14-dev; damaging at random instead"
  CC=${CC:-cc} flags="-fsanitize=address,undefined -fno-sanitize-recover=all" link='' driver=tests/fuzz/driver.c
  if ! $CC $flags "$work/probe.c" -c -o "$work/probe.o" 2>/dev/null; then flags=''; fi
fi
flags="$flags -DFRAY_CHECKED"
suite_make BUILD="$work/$CC" CC="$CC" OPT=-O1 EXTRA="$flags" WIDE=-fno-sanitize=all "$work/$CC/libfray.a" "$work/$CC/libtools.a"
for name in image candump scene obj; do
  # shellcheck disable=SC2086
  $CC -std=gnu11 -O1 -g -I. $flags $link "tests/fuzz/fuzz_$name.c" $driver "$work/$CC/libtools.a" \
    "$work/$CC/libfray.a" -lm -o "$work/fuzz_$name"
  mkdir -p "$work/corpus_$name"
  code=0
  if [ -n "$driver" ]; then
    "$work/fuzz_$name" "$seconds" "$work/seeds/$name" >"$work/$name.txt" 2>&1 || code=$?
  else
    "$work/fuzz_$name" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2048 -max_len=40000 -use_value_profile=1 \
      -artifact_prefix="$work/crash_$name-" "$work/corpus_$name" "$work/seeds/$name" >"$work/$name.txt" 2>&1 || code=$?
  fi
  if [ $code -eq 0 ]; then pass; else fail "fuzz_$name: exit $code: $(grep -m 3 -E 'ERROR|runtime error|SUMMARY|ABRT' "$work/$name.txt")"; fi
  echo "  $name: $(tail -n 1 "$work/$name.txt")"
done
suite_end
