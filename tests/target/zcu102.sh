#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# zcu102.sh: whole sessions on two emulated CAN controllers. The runtime is bare metal on CAN 0 of a
# ZCU102 in QEMU, a scripted device on CAN 1 records the bus; `fray verify` holds every recording
# against the same image on the host. The counter of the emulated core advances one nanosecond an
# instruction, so a run is the same each time. A second program has a bus with bits and acknowledges.
. tests/lib/suite.sh

work=$FRAY_BUILD/target/zcu102
here=tests/target/zcu102
elf=$work/session.elf
model=$work/model.elf
mkdir -p "$work"

suite_needs "CAN sessions on a ZCU102" "gcc-aarch64-linux-gnu and qemu-system-arm" aarch64-linux-gnu-gcc qemu-system-aarch64

target_flags="-std=c11 -O2 -g -I. -Wall -Wextra -Wconversion -Wshadow -Wundef -Werror -ffreestanding
  -mcpu=cortex-a53 -mgeneral-regs-only -mstrict-align -fno-pic -fno-pie -fno-stack-protector
  -fno-asynchronous-unwind-tables -ffunction-sections -fdata-sections"

build() {
  suite_make BUILD="$FRAY_BUILD" "$FRAY_BUILD/tests/determinism/emit_cases" "$FRAY_BUILD/tests/cli/alter"
  "$FRAY" scene $here/session.scene -o "$work/session.img" >/dev/null
  "$FRAY" hand -o "$work/script.log" $here/session.hand
  "$FRAY_BUILD/tests/determinism/emit_cases" session "$work/session.img" "$work/script.log" - 800 >"$work/cases.c"
  link "$elf" platform/zcu102/can.c $here/wire_qemu.c
  link "$model" $here/wire_model.c
}

common() {
  for file in platform/zcu102/*.c $here/*.c; do
    case $file in */can.c | */wire_*) ;; *) echo "$file" ;; esac
  done
}
link() { # OUT FILE...: with everything that does not depend on the bus
  out=$1
  shift
  # the session has no membrane
  # shellcheck disable=SC2046,SC2086
  aarch64-linux-gnu-gcc $target_flags -DFRAY_TRIANGLES=0 -nostdlib -static -no-pie -Wl,--gc-sections -Wl,--build-id=none \
    -Wl,-Map="$out.map" -T linker/zcu102.ld rt/*/*.c platform/loop.c platform/bare/memory.c platform/zcu102/start.S \
    $(common) "$work/cases.c" "$@" -lgcc -o "$out"
}

# NAME PLAN [MACHINE_OPTION [QEMU_OPTION...]]: $work/NAME.out has the facts, NAME.can the bus; sets $status
run() {
  name=$1 plan=$2 machine=${3:-}
  shift 2
  if [ $# -gt 0 ]; then shift; fi
  status=0
  QEMU_AUDIO_DRV=none limited qemu-system-aarch64 -M "xlnx-zcu102,canbus0=bus,canbus1=bus$machine" \
    -object can-bus,id=bus -m 256M -display none -monitor none -serial "file:$work/$name.uart" "$@" \
    -d guest_errors -D "$work/$name.errors" \
    -semihosting-config enable=on,target=native,arg="$plan" -kernel "$elf" \
    >"$work/$name.qemu" 2>&1 </dev/null || status=$?
  grep '^(' "$work/$name.uart" >"$work/$name.can" || true
  grep -v '^(' "$work/$name.uart" >"$work/$name.out" || true
}
limited() { (ulimit -S -t 300 && exec timeout 6000 "$@"); } # of the processor's time
# recording, into nothing, for the same reason as in targets.sh; a recording takes one core
counted="sleep=off,rr=record,rrfile=/dev/null -smp 1"
exact="-icount shift=0,$counted"
exact_run() { # PLAN: under its own name, verified, without a fault of the controllers
  # shellcheck disable=SC2086
  run "$1" "$1" "" $exact
  verifies "$1"
  clean "$1"
}

of() { awk -v key="$2" '$1 == key { print $2 }' "$work/$1.out"; } # NAME KEY
is() { # NAME KEY VALUE
  found=$(of "$1" "$2")
  holds "$1: $2 is '$found', expected $3" [ "$found" = "$3" ]
}
from_to() { # NAME KEY LEAST MOST
  found=$(of "$1" "$2")
  holds "$1: $2 is '$found', expected $3 to $4" awk -v n="$found" -v least="$3" -v most="$4" \
    'BEGIN { exit !(n != "" && n + 0 >= least + 0 && n + 0 <= most + 0) }'
}
has() { # NAME PATTERN WHAT: a frame of the bus
  holds "$1: no $3 on the bus" grep -Eq " can1 $2\$" "$work/$1.can"
}
# The host computes the same hash after every tick, from the image and what the bus carried.
verifies() { # NAME
  if [ "$status" -ne 0 ]; then fail "$1: exit $status: $(grep -v module "$work/$1.qemu" | tail -n 3)"; fi
  said=$("$FRAY" verify "$work/$1.can" --scene "$work/session.img" 2>&1) || true
  hash=$(of "$1" hash | tr A-F a-f)
  holds "$1: the target's hash is $hash; verify: $said" [ "$said" = "verified $(of "$1" ticks) ticks, hash $hash" ]
}
# Nothing that no plan asks for; and no use of the controllers that QEMU has a complaint about.
clean() { # NAME
  refutes "$1: the controllers are used wrongly" grep -i can "$work/$1.errors"
  for key in bad gaps dropped unexpected; do is "$1" $key 0; done
}
in_time() { for key in overruns losses off_tick zeroed; do is "$1" $key 0; done; } # NAME

# Of a recording: from the first SYNC to the last; SYNCs that are not 1000 us after the one before, but
# for the log's last digit; microseconds from SYNC to FORCE at most and in the middle, frames a tick at
# most.
timing() { # NAME
  awk '
    { gsub(/[().]/, "", $1); us = $1 + 0; split($3, part, "#") }
    part[1] == "080" { if (n++ == 0) first = us; else { off += us - sync < 999 || us - sync > 1001; if (frames > most) most = frames } sync = us; frames = 0 }
    { ++frames }
    part[1] == "182" { took[us - sync]++; ++forces; if (us - sync > worst) worst = us - sync }
    END { for (t = 0; t <= worst; ++t) { seen += took[t]; if (seen * 2 >= forces) break }
          printf "span_ms %d\noff_grid %d\nworst %d\nmedian %d\nframes %d\n", (sync - first + 500) / 1000, off, worst, t, most }' "$work/$1.can" >>"$work/$1.out"
}

figure() { printf '  %-8s %s\n' "$1" "$2"; }

test_session() {
  exact_run session
  in_time session
  timing session
  is session off_grid 0
  is session ticks 800
  is session accepted 1601 # two poses in all ticks but the first, three COMMANDs
  is session operational 17 # sixteen good poses, the first in the second tick
  is session state 2
  is session overflows 0
  from_to session force 18 60
  from_to session peak 20 6000
  from_to session cuts 1 400
  has session '200#01.*' TEAR
  has session '011#....010003000000' "ACK of START"
  figure session "$(of session ticks) ticks, $(of session cuts) springs broken, peak force $(of session peak) x 0.5 mN; SYNC to FORCE median $(of session median) us, worst $(of session worst) us at 1 ns an instruction; $(of session frames) frames a tick at most; stack $(of session stack) of $(of session stack_bytes) bytes"
}

# The first entry into EL1 from each of the levels that a loader may leave us in.
test_levels() {
  for level in virtualization secure; do
    # shellcheck disable=SC2086
    run $level session ,$level=on $exact
    verifies $level
    in_time $level
    if cmp -s "$work/session.can" "$work/$level.can"; then
      pass
    else
      is $level hash "$(of session hash)"
    fi
  done
}

# 16 ns an instruction: no tick is done in time, each is counted, none is computed twice or left out.
test_slow() {
  # shellcheck disable=SC2086
  run slow session "" -icount shift=4,$counted
  verifies slow
  clean slow
  is slow hash "$(of session hash)"
  is slow off_tick 0
  timing slow
  # a period is a tick or a miss, and nothing is caught up; ticks that miss begin late, by one at most
  from_to slow overruns $(($(of slow span_ms) - 801)) $(($(of slow span_ms) - 798))
  has slow '701#02......[^0].......' "STATUS with overruns"
  figure slow "$(of slow ticks) ticks at 62.5 MHz and an instruction a cycle, $(of slow overruns) missed, the same hash"
}

# In the time of the host, which is no time to hold anybody to.
test_host_time() {
  run host session
  verifies host
  figure host "in the host's time: $(of host overruns) ticks missed, $(of host losses) SYNCs lost"
}

test_silent() {
  exact_run silent
  in_time silent
  is silent safe 334 # SYNC 330 has no answer; the third tick without a pose latches
  from_to silent quiet 335 344 # ten ticks of fading
  has silent '701#03..0300........' "STATUS SAFE, stale"
  from_to silent again 460 520
  figure silent "SAFE in tick $(($(of silent safe) - 1)), no force from tick $(($(of silent quiet) - 1)) on; OPERATIONAL again in tick $(($(of silent again) - 1))"
}

# The SYNC stands in the controller; no tick is computed; HALT once it is through.
test_off() {
  for plan in off late; do
    exact_run $plan
    is $plan losses 10
    is $plan safe 331
    is $plan quiet 0 # not one tick of force in SAFE
    is $plan zeroed 1
    from_to $plan zeroed_us 3000 3250
    has $plan '010#....0500........' "COMMAND HALT"
    has $plan '701#03..2000........' "STATUS SAFE, halted"
    from_to $plan again 450 520
  done
  is off late 0
  is off syncs 601 # the last one closes the recording
  is late late 1
  is late syncs 602
  figure off "$(of off losses) SYNCs of 2 ms lost, no tick in them; the device drops its force after $(of off zeroed_us) us; HALT, SAFE in tick $(($(of off safe) - 1))"
}

test_flood() {
  exact_run flood
  in_time flood
  is flood drained 64
  is flood wrong_crc 64
  is flood safe 0
  from_to flood overflows 1 16
  figure flood "80 frames before a SYNC: $(of flood drained) read, overflow seen $(of flood overflows) time(s)"
}

test_full() {
  run full full
  is full sent 64
  is full dropped 16
  is full again 1
}

# The same program on a bus that takes its time and needs an acknowledge.
test_model() {
  qemu_elf=$elf elf=$model
  # shellcheck disable=SC2086
  run paced session "" $exact
  timing paced
  # shellcheck disable=SC2086
  run alone alone "" $exact
  elf=$qemu_elf
  verifies paced
  clean paced
  in_time paced
  is paced hash "$(of session hash)"
  is paced early 0
  verifies alone
  clean alone
  is alone early 0
  from_to alone crossed 1 1000
  from_to alone losses 9 11
  is alone safe 331
  is alone quiet 0
  from_to alone zeroed_us 3000 3250
  has alone '010#....0500........' "COMMAND HALT"
  figure paced "1 Mbit/s: $(($(of paced busy_us) / 10 / $(of paced ticks))).$(($(of paced busy_us) / $(of paced ticks) % 10)) % load; SYNC to FORCE median $(of paced median) us, worst $(of paced worst) us"
  figure alone "nobody acknowledges for 21 ms: $(of alone losses) SYNCs lost, SAFE in tick $(($(of alone safe) - 1)); $(of alone crossed) frames of CAN 0 confirmed while a SYNC waited behind them"
}

stops() { # PLAN PATTERN: by this fault
  run "$1" "$1"
  holds "$1: exit $status: $(cat "$work/$1.out")" [ "$status $(grep -c "$2" "$work/$1.out")" = '99 1' ]
}
test_guards() {
  stops stack 'fault 4 esr 9600004[0-9A-F] .*address 0000000000180'
  stops flash '^fault 4 esr 9600004F'
}

# One bit of one pose of what the bus carried: it must not pass.
test_refused() {
  "$FRAY_BUILD/tests/cli/alter" pose "$work/session.can" 300 0 1 >"$work/altered.can"
  if said=$("$FRAY" verify "$work/altered.can" --scene "$work/session.img" 2>&1); then
    fail "one bit of a pose changed: $said"
  else
    pass
  fi
}

if ! build; then
  fail "sessions on a ZCU102: it does not build"
  suite_end
  exit
fi
for name_of_test in session levels slow host_time silent off flood full model guards refused; do
  "test_$name_of_test"
done
figure code "$(aarch64-linux-gnu-size -A "$elf" | awk '/^\.(text|rodata|stack|bss) / { printf "%s %d  ", $1, $2 }')"
suite_end
