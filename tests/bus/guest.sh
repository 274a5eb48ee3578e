#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# tests/bus/guest.sh COMMAND [ARG...]: runs COMMAND where vcan0 is up, in a throw-away Linux guest, for which
# no kernel with CAN is needed (a container, a cloud machine): the host's / is its /, so paths, the
# current folder, the environment and the user (root) stay; both streams and the exit status come
# back; the input is empty. Exit 124: the time limit; 125: no guest, the reason is printed.
# tests/bus/guest.sh --check: says what is missing, boots nothing.
#   FRAY_GUEST          qemu, also unset: vcan0, and can0 and can1, emulated controllers on one 1 Mbit/s bus
#                       host: a new network namespace of this kernel, where it has vcan (root), in real time
#   FRAY_GUEST_CPUS     1; its clock counts instructions, a billion a second, and nothing else: how busy the host
#                       is does not enter, and idle time takes none. 2: in the host's time
#   FRAY_GUEST_SECONDS  300 of the processor's time, then it is killed; one that sleeps for ever, after sixty times
#                       as long by the clock. FRAY_GUEST=host: by the clock
#   FRAY_GUEST_MEMORY   512M
#   FRAY_GUEST_ORDER    1; 0: vcan0 as it comes, receivers on several CPUs see several orders
PACKAGES="busybox-static iproute2 can-utils qemu-system-x86 linux-image-amd64 cpio xz-utils"
set -eu
environment=$(export -p) # before a variable of this script takes the name of one of the caller's

here=$(cd "$(dirname "$0")" && pwd -P)
store=$(dirname "$(dirname "$here")")/build/guest # what is made once: the unpacked kernel
seconds=${FRAY_GUEST_SECONDS:-300}
memory=${FRAY_GUEST_MEMORY:-512M}
order=${FRAY_GUEST_ORDER:-1}
cpus=${FRAY_GUEST_CPUS:-1}
qemu_modules='virtio_ring virtio virtio_pci_modern_dev virtio_pci_legacy_dev virtio_pci virtio_console
  netfs fscache 9pnet 9pnet_virtio 9p can-dev vcan can can-raw can-bcm can-gw can-isotp sja1000 kvaser_pci'

say() { echo "tests/bus/guest.sh: $*" >&2; }
die() {
  say "$*"
  exit 125
}

host_has_vcan() { # tried in a namespace of its own: nothing is left on the host
  unshare --net --mount -- ip link add vcan0 type vcan >/dev/null 2>&1
}

# The newest kernel that is installed with the emulated controller's driver (the cloud kernels have no CAN).
find_kernel() {
  for folder in /lib/modules/*; do
    if [ -r "/boot/vmlinuz-${folder##*/}" ] && [ -n "$(find "$folder" -name kvaser_pci.ko)" ]; then
      echo "${folder##*/}"
    fi
  done | sort -V | tail -n 1
}

missing=''
need() { # PROGRAM PACKAGE
  command -v "$1" >/dev/null 2>&1 || missing="$missing $2"
}
check() {
  need ip iproute2
  case $kind in
    host) host_has_vcan || die "FRAY_GUEST=host: \`ip link add type vcan\` does not work here (root? CONFIG_CAN_VCAN?)" ;;
    qemu)
      need qemu-system-x86_64 qemu-system-x86
      need cpio cpio
      need xz xz-utils
      need /bin/busybox busybox-static
      release=$(find_kernel)
      [ -n "$release" ] || missing="$missing linux-image-amd64"
      ;;
    *) die "FRAY_GUEST=$kind, expected host or qemu" ;;
  esac
  [ -z "$missing" ] || die "no $kind guest; Debian 12 has it: apt-get install --no-install-recommends$missing"
}

# COMMAND as a script of its own: what the guest runs is then the same for every kind.
write_command() {
  quoted() { printf '%s\n' "$1" | sed "s/'/'\\\\''/g; 1s/^/'/; \$s/\$/'/"; }
  printf '%s\n' "$environment"
  echo 'export FRAY_GUEST=host' # guest.sh inside the guest
  printf 'cd '
  quoted "$(pwd)"
  echo '[ $? -eq 0 ] || exit 126'
  printf 'set --'
  for word; do
    printf ' '
    quoted "$word" | sed '$s/$/ \\/'
  done
  printf '\n"$@"\nexit $?\n'
}

# QEMU starts an unpacked kernel two seconds sooner: emulated, the unpacking is slow. The Linux boot
# protocol gives the place: setup_sects at 0x1f1, payload_offset and payload_length at 0x248.
unpack_kernel() {
  image=/boot/vmlinuz-$release
  kernel=$store/vmlinux-$release
  [ -s "$kernel" ] && return
  mkdir -p "$store"
  sectors=$(od -An -tu1 -j497 -N1 "$image")
  offset=$(od -An -tu4 -j584 -N4 "$image")
  if tail -c "+$(((sectors + 1) * 512 + offset + 1))" "$image" | xz -dc --single-stream >"$run/vmlinux" 2>/dev/null; then
    mv "$run/vmlinux" "$kernel"
  else
    kernel=$image # not packed with xz: slower, no worse
  fi
}

# The first root: enough to mount the host's. Modules are numbered in the order to load them.
make_first_root() {
  mkdir -p "$run/root/bin" "$run/root/dev" "$run/root/host" "$run/root/modules"
  cp /bin/busybox "$run/root/bin/busybox"
  cp "$here/guest/first.sh" "$run/root/init"
  chmod 755 "$run/root/init"
  number=100
  for module in $qemu_modules; do
    file=$(find "/lib/modules/$release/kernel" -name "$module.ko" | head -n 1)
    if [ -n "$file" ]; then cp "$file" "$run/root/modules/$number-$module.ko"; fi
    number=$((number + 1))
  done
  (cd "$run/root" && find . | cpio --quiet -o -H newc) >"$run/first.cpio" || die "cannot make the first root"
}

# Each start_KIND ends in exec; its process leads the group of all that it starts (timeout sees to
# that), and dies if this script is killed. A guest writes its streams to the files out and err: not to
# the caller's, whose modes a console would change, nor to a pipe, since QEMU stops for ever at a pipe
# that nobody reads (`| head`), and drops what a slow reader has not taken when it powers off.
limited() { exec setpriv --pdeathsig TERM timeout -k 2 "$by_the_clock" "$@"; }

start_host() {
  # sh has made SIGINT and SIGQUIT ignored in what it runs aside; COMMAND should not see that
  limited env --default-signal=INT,QUIT unshare --net --mount --pid --fork --kill-child --mount-proc -- \
    sh -c 'mount -t sysfs sysfs /sys && sh "$1/guest/net.sh" "$3" && sh "$2/command"
           echo $? >"$2/status"' sh "$here" "$run" "$order"
}

start_qemu() {
  # no_timer_check: in the host's time, where the host is busy, Linux finds no timer and panics
  case $cpus in
    1) clock='-accel tcg,thread=single,tb-size=256 -icount shift=0,sleep=off' ;;
    *) clock='-accel tcg,thread=multi,tb-size=256' ;;
  esac
  # shellcheck disable=SC2086
  limited prlimit --cpu="$seconds:$((seconds + 2))" --core=0 qemu-system-x86_64 $clock -cpu max -smp "$cpus" -m "$memory" \
    -M pc,usb=off,vmport=off -nodefaults -no-user-config -display none -no-reboot -serial "file:$run/console" \
    -kernel "$kernel" -initrd "$run/first.cpio" -append "console=ttyS0 quiet panic=-1 nokaslr mitigations=off \
      no_timer_check random.trust_cpu=on initcall_blacklist=crypto_kdf108_init,init_kprobe_trace fray_init=$here/guest/init.sh \
      fray_run=$run fray_order=$order fray_streams=/dev/vport1p1,/dev/vport1p2" \
    -fsdev local,id=host,path=/,security_model=none,multidevs=remap -device virtio-9p-pci,fsdev=host,mount_tag=host \
    -device virtio-serial-pci -chardev "file,id=o,path=$run/out" -device virtserialport,chardev=o,nr=1 \
    -chardev "file,id=e,path=$run/err" -device virtserialport,chardev=e,nr=2 \
    -object can-bus,id=bus -device kvaser_pci,canbus=bus -device kvaser_pci,canbus=bus >"$run/monitor" 2>&1
}

run=''
guest=''
readers=''
clean_up() {
  code=$?
  trap - EXIT INT TERM HUP
  if [ -n "$guest" ]; then
    kill -TERM "$guest" 2>/dev/null && sleep 0.2
    kill -KILL -- "-$guest" 2>/dev/null || true
  fi
  if [ -n "$readers" ]; then kill $readers 2>/dev/null || true; fi
  if [ -n "$run" ]; then rm -rf "$run"; fi
  exit "$code"
}

case $cpus in 1 | 2) ;; *) die "FRAY_GUEST_CPUS=$cpus, expected 1 or 2" ;; esac
case $seconds in '' | *[!0-9]*) die "FRAY_GUEST_SECONDS=$seconds, expected a whole number" ;; esac
[ $# -gt 0 ] || { sed -n '3,18s/^# \{0,1\}//p' "$0" && exit 2; }
kind=${FRAY_GUEST:-qemu}
by_the_clock=$seconds
if [ "$kind" = qemu ]; then by_the_clock=$((60 * seconds)); fi
check
if [ "$1" = --check ]; then exit 0; fi

trap clean_up EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
trap 'exit 129' HUP
run=$(mktemp -d "${TMPDIR:-/tmp}/fray-guest.XXXXXX")
case $here$run in *[[:space:],]*) die "a kernel's command line takes no path with a space or a comma: $here, $run" ;; esac
write_command "$@" >"$run/command"
if [ "$kind" = qemu ]; then unpack_kernel && make_first_root; fi

: >"$run/out"
: >"$run/err"
began=$(date +%s)
"start_$kind" &
guest=$!
if [ $kind != host ]; then
  tail -c +1 -f -s 0.1 --pid=$guest "$run/out" 2>/dev/null &
  readers=$!
  tail -c +1 -f -s 0.1 --pid=$guest "$run/err" >&2 2>/dev/null &
  readers="$readers $!"
fi
ended=0
wait "$guest" 2>/dev/null || ended=$?
kill -KILL -- "-$guest" 2>/dev/null || true
guest=''
for reader in $readers; do wait "$reader" || true; done # they end when the guest has
readers=''

late=0
if [ $(($(date +%s) - began)) -ge "$by_the_clock" ]; then late=1; fi
if [ $ended = 152 ] || [ $late$ended = 1124 ] || [ $late$ended = 1137 ]; then # 152: SIGXCPU
  say "killed after $seconds s (FRAY_GUEST_SECONDS)"
  exit 124
fi
if [ -s "$run/status" ]; then exit "$(cat "$run/status")"; fi
cat "$run/console" "$run/monitor" >&2 2>/dev/null || true
die "the $kind guest ended (status $ended) without an exit status of COMMAND"
