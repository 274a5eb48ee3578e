#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Run in a guest by bed.sh: vcan0 and can-utils on it; with `controllers`, can0 and can1 too. A line a
# check, `ok WHAT` or `bad WHAT`; other lines are figures.
set -u
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1

check() { # WHAT COMMAND...
  what=$1
  shift
  if "$@" >check.txt 2>&1; then echo "ok $what"; else echo "bad $what: $(head -c 200 check.txt | tr '\n' ' ')"; fi
}
# FILE INTERFACE FRAMES: candump -L into FILE, back when the kernel has it on its list of receivers
listen() {
  timeout 900 candump -L -n "$3" "$2" >"$1" &
  listener=$!
  tries=0
  until grep -qs " $2 " /proc/net/can/rcvlist_all || [ $tries -eq 1000 ]; do
    tries=$((tries + 1))
    sleep 0.02
  done
}
frames() { cut -d' ' -f3 "$1"; } # what was on the bus, without time and interface
same_frames() { [ -s "$1" ] && [ "$(frames "$1")" = "$(frames "$2")" ]; }

has_line() { grep -q "$@"; }
lines() { [ "$(wc -l <"$1")" -eq "$2" ]; }

echo "kernel $(uname -r), $(nproc) CPU, up $(cut -d' ' -f1 /proc/uptime) s"
ip -details link show vcan0 >link.txt
check 'vcan0 is up' has_line 'vcan0: <.*UP' link.txt
check 'vcan0 takes FD frames, mtu 72' has_line 'mtu 72' link.txt

listen sent.log vcan0 20
cangen vcan0 -n 20 -g 1 -I r -L r -D r
wait $listener
check 'cangen to candump, 20 frames' lines sent.log 20
listen played.log vcan0 20
canplayer -I sent.log vcan0=vcan0
wait $listener
check 'canplayer plays the same frames' same_frames sent.log played.log

listen one.log vcan0 2
cansend vcan0 123#DEADBEEF
cansend vcan0 124#R
wait $listener
check 'cansend, data frame' has_line ' 123#DEADBEEF' one.log
check 'cansend, remote frame' has_line ' 124#R' one.log
bytes=$(seq -f %02g -s '' 10 73)
listen fd.log vcan0 1
cansend vcan0 "123##1$bytes"
wait $listener
check 'an FD frame of 64 bytes passes' has_line -E " 123##[15]$bytes" fd.log

ip link add vcan1 mtu 72 type vcan && ip link set vcan1 up
cangw -A -s vcan0 -d vcan1 -e -f 123:7FF -m SET:D:0.0.1122334455667788 >gateway.txt 2>&1
listen gateway.log vcan1 1
cansend vcan0 123#00000000AABBCCDD
wait $listener
check 'cangw alters a frame on its way' has_line '#1122334455667788' gateway.log
cangw -F >/dev/null 2>&1
ip link del vcan1

if [ "${1:-}" = controllers ]; then
  check 'its CPUs' [ "$(nproc)" -eq "$FRAY_GUEST_CPUS" ]
  ip -details link show can0 >link.txt
  check 'can0 is up at 1 Mbit/s' has_line 'bitrate 1000000 ' link.txt
  listen right.log can1 3
  cansend can0 123#DEADBEEF
  cansend can0 1F334455#1122334455667788
  cansend can0 124#R
  wait $listener
  check 'can0 to can1: 11-bit, 29-bit, remote' [ "$(frames right.log | tr '\n' ' ')" = '123#DEADBEEF 1F334455#1122334455667788 124#R ' ]
  listen left.log can0 200
  taskset -c 0 cangen can1 -n 200 -g 1 -I i -L 8 -D i
  wait $listener
  check 'can1 to can0: 200 frames' lines left.log 200
  check 'can1 to can0: in order' sh -c "cut -d' ' -f3 left.log | cut -d'#' -f1 | sort -c"
fi
