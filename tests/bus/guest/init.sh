#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Process 1 of the guest, on the host's files. The kernel's command line gives fray_run (the run's
# folder), fray_order and fray_streams (two devices, out and err).
[ $$ -eq 1 ] && [ -n "$fray_run" ] || { echo 'init.sh: not in a guest' >&2 && exit 1; }
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
mount -t devtmpfs dev /dev
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mkdir -p /dev/pts /dev/shm
mount -t devpts -o ptmxmode=666 devpts /dev/pts
mount -t tmpfs -o mode=1777 shm /dev/shm
ln -s /proc/self/fd /dev/fd
ln -s fd/0 /dev/stdin
ln -s fd/1 /dev/stdout
ln -s fd/2 /dev/stderr
echo fray-guest >/proc/sys/kernel/hostname

finish() { # the host reads the status only after sync
  sync
  /bin/busybox poweroff -f
}
sh "${0%/*}/net.sh" "$fray_order" || finish

# COMMAND writes to pipes, since it would take the devices for a terminal.
out=${fray_streams%,*}
err=${fray_streams#*,}
tries=0
until [ -e "$out" ] && [ -e "$err" ] || [ $tries -eq 100 ]; do
  tries=$((tries + 1))
  sleep 0.02
done
exec 3>"$out" 4>"$err" || finish
mkfifo /dev/fray-out /dev/fray-err
cat /dev/fray-out >&3 &
cat /dev/fray-err >&4 &
# All that COMMAND leaves running dies with its process namespace; so the pipes end, and cat.
unshare --mount --pid --fork --kill-child --mount-proc -- sh "$fray_run/command" \
  </dev/null >/dev/fray-out 2>/dev/fray-err 3>&- 4>&-
status=$?
wait
exec 3>&- 4>&- # the last close of a console waits until it is written out
echo $status >"$fray_run/status"
finish
