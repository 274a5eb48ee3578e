#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# net.sh ORDER: the guest's interfaces: vcan0 (frames of 72 bytes: FD), and the controllers, if any.
set -eu
ip link set lo up
ip link add vcan0 mtu 72 type vcan
# vcan hands a frame to the receivers from the backlog of the CPU that sent it, so that on two CPUs two
# receivers can see two orders, which no wire does. One CPU for the backlog makes it one order; the
# backlog must then be deep, since what does not fit in it is lost without a trace at the socket.
# (netdev_max_backlog is the whole machine's: a namespace of the host cannot see it, and keeps 1000.)
if [ "$1" = 1 ]; then
  cpus=/sys/class/net/vcan0/queues/rx-0/rps_cpus
  deep=/proc/sys/net/core/netdev_max_backlog
  if [ -e $cpus ]; then echo 1 >$cpus; fi
  if [ -e $deep ]; then echo 200000 >$deep; fi
fi
ip link set vcan0 up
# After a long burst the kernel leaves frames to ksoftirqd. On one busy CPU at the lowest priority that
# is when everybody else sleeps: a SYNC then waits for its echo, which no controller makes it do.
for process in /proc/[0-9]*; do
  case $(cat "$process/comm" 2>/dev/null) in
    ksoftirqd/*) chrt --fifo --pid 90 "${process#/proc/}" 2>/dev/null || true ;;
  esac
done
for name in can0 can1; do
  if [ -e /sys/class/net/$name ]; then ip link set $name up type can bitrate 1000000; fi
done
# An SJA1000 holds 64 bytes, five frames. Who sends from the CPU of the interrupts (CPU 0) overruns no
# receiver while the host lets one CPU stand still and the other one run.
for irq in $(sed -n 's/^ *\([0-9]*\):.*can[01].*/\1/p' /proc/interrupts); do
  echo 1 >/proc/irq/"$irq"/smp_affinity || true
done
