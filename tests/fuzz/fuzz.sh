#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# fuzz.sh SECONDS [RUNS [TARGET...]]: damaged images (their CRC and hashes mended), logs, scenes, scripts and OBJ
# files, SECONDS each or, where RUNS is not 0, so many executions each, in JOBS processes, under sanitizers and
# FRAY_CHECKED; with libFuzzer where clang has it, else with tests/fuzz/driver.c. A crash leaves its input in
# BUILD/fuzz/. Corpora stay there for the next time.
. tests/lib/suite.sh
seconds=${1:-60} runs=${2:-0}
[ $# -lt 2 ] || shift 2
[ $# -gt 0 ] || set -- image candump scene obj
work=$FRAY_BUILD/fuzz jobs=1
[ "$runs" -eq 0 ] || jobs=${JOBS:-$(nproc 2>/dev/null || echo 2)}
rm -rf "$work/seeds"
mkdir -p "$work/seeds/image" "$work/seeds/candump" "$work/seeds/scene" "$work/seeds/obj"

# worlds of every kind, at tick 0, and torn: as small as a feature allows, so that 200 ticks take milliseconds; and
# longer ones, which are taken rarely
for path in tests/fuzz/tiny/*.seed tests/fuzz/seeds/*.scene; do
  case $path in
    *.seed) name=$(basename "$path" .seed) ;;
    *) name=long_$(basename "$path" .scene) ;;
  esac
  "$FRAY" scene "$path" -o "$work/seeds/image/$name.img" >/dev/null
  "$FRAY" run "$path" --ticks 40 --save "$work/seeds/image/${name}_torn.img" >/dev/null
done
"$FRAY" hand -o "$work/small.log" tests/determinism/small.hand
"$FRAY" run tests/scenes/small.scene --log "$work/small.log" --ticks 300 --record "$work/recording" >/dev/null
head -n 40 "$work/small.log" >"$work/seeds/candump/device.log"
head -n 60 "$work/recording" >"$work/seeds/candump/recording.log"
printf '(1.000000) can0 123#R4\n(1.000000) can0 123##5AABB\n(1.5) x 20000004#0000000000000000\n# c\n' \
  >"$work/seeds/candump/kinds.log"
# other tools' forms: python-can and asc2log, candump without -L
sed 's/$/ R/' "$work/seeds/candump/recording.log" >"$work/seeds/candump/directions.log"
printf '%s\n' "  can0  123   [8]  11 22 33 44 55 66 77 88" " (1.000000)  can0  RX B -  123  [02]  AA BB" \
  "(2.000000)  can0  12345678   [4]  remote request" "  can0  123   [2]  41 5D   'A]'" \
  "  can0  20000004   [8]  00 00 00 00 00 00 00 00   ERRORFRAME" >"$work/seeds/candump/columns.log"
cp tests/scenes/*.scene tests/scenes/*.hand tests/determinism/*.scene tests/determinism/*.hand "$work/seeds/scene/"
for path in tests/fuzz/seeds/*.scene tests/fuzz/tiny/*.seed; do cp "$path" "$work/seeds/scene/small_$(basename "$path")"; done
cp tests/scenes/meshes/*.obj "$work/seeds/obj/"

# with clang and its fuzzer, or with any compiler and our driver
echo 'int LLVMFuzzerTestOneInput(const char *d, unsigned long n); int LLVMFuzzerTestOneInput(const char *d, unsigned long n) { return n > 1 ? d[0] == 0 : 0; }' >"$work/probe.c"
if have clang && clang -fsanitize=fuzzer,address "$work/probe.c" -o "$work/probe" 2>/dev/null; then
  CC=clang link=-fsanitize=fuzzer driver=''
  # comparisons are not traced: twice as slow, and the harness damages fields by their ranges
  flags="-fsanitize=address,undefined -fno-sanitize-recover=all -fsanitize=fuzzer-no-link -fno-sanitize-coverage=trace-cmp"
else
  echo "not run: libFuzzer needs clang and libclang-rt-14-dev; damaging at random instead, coverage is not counted"
  CC=${CC:-cc} flags="-fsanitize=address,undefined -fno-sanitize-recover=all" link='' driver=tests/fuzz/driver.c
  if ! $CC $flags "$work/probe.c" -c -o "$work/probe.o" 2>/dev/null; then flags=''; fi
fi
flags="$flags -DFRAY_CHECKED"
suite_make BUILD="$work/$CC" CC="$CC" OPT=-O1 EXTRA="$flags" WIDE=-fno-sanitize=all "$work/$CC/libfray.a" "$work/$CC/libtools.a"

# One process of a target: NAME JOB
feed() {
  mkdir -p "$work/case_$1_$2"
  if [ -n "$driver" ]; then
    FRAY_FUZZ_CASE="$work/case_$1_$2" "$work/fuzz_$1" "$seconds" $(((runs + jobs - 1) / jobs)) "$work/seeds/$1"
  elif [ "$runs" -eq 0 ]; then
    FRAY_FUZZ_CASE="$work/case_$1_$2" "$work/fuzz_$1" -max_total_time="$seconds" $limits "$work/corpus_$1" "$work/seeds/$1"
  else
    FRAY_FUZZ_CASE="$work/case_$1_$2" "$work/fuzz_$1" -runs=$(((runs + jobs - 1) / jobs)) -reload=0 $limits "$work/corpus_$1" "$work/seeds/$1"
  fi
}

for name; do
  # entropic: a schedule of the corpus that takes a tenth of the time and more as it grows; fuzz_image has its own
  limits="-entropic=0 -timeout=60 -report_slow_units=60 -rss_limit_mb=2048 -max_len=40000 -artifact_prefix=$work/crash_$name-"
  # shellcheck disable=SC2086
  $CC -std=gnu11 -O1 -g -I. $flags $link "tests/fuzz/fuzz_$name.c" $driver "$work/$CC/libtools.a" \
    "$work/$CC/libfray.a" -lm -o "$work/fuzz_$name"
  mkdir -p "$work/corpus_$name"
  job=0
  while [ "$job" -lt "$jobs" ]; do
    (
      code=0
      feed "$name" "$job" >"$work/${name}_$job.txt" 2>&1 || code=$?
      echo "$code" >"$work/${name}_$job.code"
    ) &
    job=$((job + 1))
  done
  wait
  job=0
  while [ "$job" -lt "$jobs" ]; do
    code=$(cat "$work/${name}_$job.code")
    found=$(grep -m 3 -E 'ERROR|runtime error|SUMMARY|ABRT' "$work/${name}_$job.txt" || true)
    if [ "$code" -eq 0 ]; then pass; else fail "fuzz_$name: exit $code: $found"; fi
    job=$((job + 1))
  done
  awk -v name="$name" '
    /^tally / { runs += $2; ran += $4; whole += $8; ticks += $(NF - 1) }
    match($0, / cov: [0-9]+/) { edges = substr($0, RSTART + 6, RLENGTH - 6) + 0; if (edges > most) most = edges }
    END {
      long = name == "image" ? sprintf(" (%d of them for 200 ticks, %d ticks)", whole, ticks) : ""
      printf "  %s: %d executions, %d accepted and run%s, coverage %s\n", name, runs, ran, long,
             most ? most " edges" : "not counted"
    }' "$work/${name}_"*.txt
done
suite_end
