#!/bin/busybox sh
# SPDX-License-Identifier: Apache-2.0
# Process 1 of the QEMU guest, in its first root: loads the modules, goes over to the host's files.
/bin/busybox mount -t devtmpfs dev /dev
for module in /modules/*; do /bin/busybox insmod "$module"; done
tries=0
until /bin/busybox mount -t 9p -o trans=virtio,version=9p2000.L,msize=262144,cache=loose,access=client host /host; do
  tries=$((tries + 1))
  if [ $tries -eq 50 ]; then /bin/busybox poweroff -f; fi
  /bin/busybox usleep 20000
done
/bin/busybox umount /dev
exec /bin/busybox switch_root /host "$fray_init"
