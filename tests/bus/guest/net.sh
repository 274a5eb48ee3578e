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
for name in can0 can1; do
  if [ -e /sys/class/net/$name ]; then ip link set $name up type can bitrate 1000000; fi
done
