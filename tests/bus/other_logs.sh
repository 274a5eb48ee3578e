#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Logs of other tools, both ways: python-can's can_logconvert (.log, .blf, .asc, .trc), and log2asc, asc2log and log2long
# of can-utils read a device's log and a recording of ours; what they write of it gives the same hashes.
. tests/lib/suite.sh

work=$FRAY_BUILD/tests/other_logs
rm -rf "$work"
mkdir -p "$work"
small=tests/scenes/small.scene

"$FRAY" hand -o "$work/small.log" tests/determinism/small.hand
hash=$("$FRAY" run $small --log "$work/small.log" --record "$work/recording.log" | sed -n '$s/^hash \([0-9a-f]*\) .*/\1/p')
cp tests/scenes/two_hands.log "$work/device.log"
"$FRAY" scene tests/scenes/two_hands.scene -o "$work/two_hands.img" >/dev/null
run_device() { "$FRAY" run "$work/two_hands.img" --log "$1" --ticks 300 2>&1 | tail -n 1; }
device=$(run_device "$work/device.log")

# the frames of a strict log, in order: their times, interface and direction are others
frames() { sed -n 's/^([0-9.]*) [^ ]* \([^ ]*\).*/\1/p' "$1" | tr a-f A-F; }
frames "$work/recording.log" >"$work/recording.frames"
frames "$work/device.log" >"$work/device.frames"

# reads NAME: what another tool made of both logs is $work/NAME.device and $work/NAME.recording
reads() {
  said=$("$FRAY" verify "$work/$1.recording" --scene $small 2>&1) || true
  holds "$1, a recording: $said" [ "$said" = "verified 800 ticks, hash $hash" ]
  said=$(run_device "$work/$1.device")
  holds "$1, a device's log: $said, expected $device" [ "$said" = "$device" ]
}
# same NAME: the tool read every frame of ours
same() {
  for log in device recording; do
    frames "$work/$1.$log" >"$work/$1.frames"
    holds "$1: the frames of the $log" cmp -s "$work/$log.frames" "$work/$1.frames"
  done
}

if have can_logconvert; then
  for kind in log blf asc trc; do
    for log in device recording; do
      can_logconvert "$work/$log.log" "$work/$kind.$log.$kind" >"$work/said" 2>&1 &&
        can_logconvert "$work/$kind.$log.$kind" "$work/$kind.$log.back.log" >>"$work/said" 2>&1 ||
        fail "can_logconvert, $kind: $(tail -n 2 "$work/said")"
      mv "$work/$kind.$log.back.log" "$work/$kind.$log"
    done
    holds "python-can marks directions" grep -q ' R$' "$work/$kind.recording"
    same $kind
    reads $kind
  done
else
  not_run "logs of python-can" python3-can
fi

if have log2asc && have asc2log && have log2long; then
  for log in device recording; do
    log2asc -I "$work/$log.log" -O "$work/$log.asc" vcan0
    asc2log -I "$work/$log.asc" -O "$work/asc2log.$log" 2>"$work/said"
    log2long <"$work/$log.log" >"$work/log2long.$log"
    # candump without -L, without and with -t a
    sed 's/^([0-9.]*)//' "$work/log2long.$log" >"$work/candump.$log"
    sed 's/^/ /; s/ vcan0/ vcan0  RX - -/' "$work/log2long.$log" >"$work/candump_tax.$log"
  done
  same asc2log
  for name in asc2log log2long candump_tax; do reads $name; done
  said=$("$FRAY" verify "$work/candump.recording" --scene $small 2>&1) || true
  holds "candump, a recording: $said" [ "$said" = "verified 800 ticks, hash $hash" ]
  said=$("$FRAY" run "$work/two_hands.img" --log "$work/candump.device" 2>&1) || true
  holds "candump, a device's log without times: $said" \
    [ "${said#*candump.device:}" = "1: a frame without a time in a log without SYNCs, expected one of candump -L or -t a" ]
else
  not_run "logs of can-utils" can-utils
fi

# damaged, in each form: line and column
damaged() { # NAME LINE:COLUMN WORDS
  said=$("$FRAY" verify "$work/bad" --scene $small 2>&1) || true
  holds "$1: $said" [ "${said#*bad:}" = "$2: $3" ]
}
sed '7s/$/ X/' "$work/recording.log" >"$work/bad"
damaged "a mark" 7:48 "found 'X', expected 'R' or 'T' (received, sent) after the space"
printf '  vcan0  101   [8]  11 22\n' >"$work/bad"
damaged "columns" 1:26 "found the end of the line, expected a space between two bytes"
suite_end
