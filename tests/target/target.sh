#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Bare-metal machines: how to build for one, and how to run it in QEMU.
#
#   target.sh list                      the names
#   target.sh needs NAME                the Debian packages; exit status 1 where one is missing
#   target.sh flags NAME                the compiler and its flags for this machine
#   target.sh build NAME OPT OUT FILE.c|FILE.S|FILE.o|FILE.a|-OPTION...
#                                       with start-up, tick, console and memory functions; the whole
#                                       memory of the board, and 8 KiB of stack
#   target.sh firmware NAME OPT OUT ... the same within the budgets of linker/NAME.ld
#   target.sh run NAME X.elf [QEMU OPTION...]
#                                       console to stdout, exit status through (152: more than
#                                       TARGET_SECONDS of the processor's time, 300 unless told; 124: 20 times
#                                       as long by the clock)
#   target.sh clock NAME                counts a second of its tick's clock in QEMU
set -eu
root=$(CDPATH='' cd -- "$(dirname -- "$0")/../.." && pwd)

usage() { sed -n '/^#   target/,/^set/p' "$0" | sed 's/^# \{0,3\}//; /^set/d' >&2; exit 2; }

cortexm() { # CPU QEMU-OPTIONS
  compiler=arm-none-eabi-gcc qemu=qemu-system-arm
  packages="gcc-arm-none-eabi and qemu-system-arm"
  machine_flags="$1 -mthumb"
  start="platform/cortexm/vectors.c platform/cortexm/systick.c platform/bare/semihost.c"
  machine_options="$2 $semihosting -kernel"
}

machine() { # NAME
  name=$1 code_all=0x24000 stack_all=0x2000 ram_all=0x400000
  semihosting="-serial null -chardev stdio,id=console -semihosting-config enable=on,target=native,chardev=console"
  case $name in
    m0) cortexm -mcpu=cortex-m0 \
      "-M microbit -global nrf51-soc.flash-size=0x400000 -global nrf51-soc.sram-size=0x400000"
      clock=16000000 ;;
    microbit) cortexm -mcpu=cortex-m0 "-M microbit"
      clock=16000000 ram_all=0x4000 stack_all=0x800 ;;
    m3) cortexm -mcpu=cortex-m3 "-M mps2-an385"; clock=25000000 ;;
    m4f) cortexm "-mcpu=cortex-m4 -mfpu=fpv4-sp-d16 -mfloat-abi=hard" "-M mps2-an386"
      clock=25000000 ;;
    m7f) cortexm "-mcpu=cortex-m7 -mfpu=fpv5-d16 -mfloat-abi=hard" "-M mps2-an500"
      clock=25000000 ;;
    m33) cortexm "-mcpu=cortex-m33 -mfpu=fpv5-sp-d16 -mfloat-abi=hard" "-M mps2-an505"
      clock=20000000 ;;
    # gcc 12 gives a constant mask of lanes as all of them (where a loop does not negate the last two of four
    # words): no vectors of its own
    m55) cortexm "-mcpu=cortex-m55 -mfloat-abi=hard -fno-tree-vectorize" "-M mps3-an547"
      clock=32000000 ram_all=0x80000 code_all=0x20000 ;;
    r5f)
      compiler=arm-none-eabi-gcc qemu=qemu-system-arm clock=1000000000
      packages="gcc-arm-none-eabi and qemu-system-arm"
      machine_flags="-mcpu=cortex-r5 -mfpu=vfpv3-d16 -mfloat-abi=hard -marm"
      start="platform/cortexr/start.S platform/cortexr/cycles.c platform/bare/semihost.c"
      machine_options="-M none -cpu cortex-r5f -m 16M $semihosting -device loader,cpu-num=0,file=" ;;
    rv32)
      compiler=riscv64-unknown-elf-gcc qemu=qemu-system-riscv32 clock=10000000
      packages="gcc-riscv64-unknown-elf and qemu-system-misc"
      machine_flags="-march=rv32imac -mabi=ilp32 -misa-spec=2.2"
      start="platform/rv32/start.S platform/rv32/mtimer.c platform/rv32/uart16550.c"
      machine_options="-M virt -m 16M -bios none -serial stdio -kernel" ;;
    *) echo "target.sh: no machine '$name'; there are: $names" >&2; exit 2 ;;
  esac
  flags="$machine_flags -std=c11 -ffreestanding -ffunction-sections -fdata-sections -fno-common"
  flags="$flags -DFRAY_ID_BITS=16 -DTARGET_CLOCK_HZ=${clock}u"
}
names="m0 m3 m4f m7f m33 m55 r5f rv32 microbit"

build() { # OPT OUT FILE...
  opt=$1 out=$2
  shift 2
  sources=''
  for file in $start platform/bare/start.c platform/bare/memory.c; do
    sources="$sources $root/$file"
  done
  # gcc 12 sees a loop of at most 16 run over 16 bytes there (cmac.c), and nowhere else
  [ "$opt" != -O3 ] || budgets="$budgets -Wno-stringop-overflow"
  # shellcheck disable=SC2086
  "$compiler" $flags -I"$root" -ffile-prefix-map="$root"=. -Wall -Wextra -Wconversion -Wshadow -Wundef -Werror "$opt" $budgets \
    -Wl,--start-group "$@" $sources -lgcc -Wl,--end-group -nostdlib -nostartfiles -static \
    -Wl,--gc-sections,--build-id=none,--no-warn-rwx-segments \
    -L"$root/linker" -T "$root/linker/$name.ld" -o "$out"
}

run() { # X.elf OPTION...
  elf=$1
  shift
  case $machine_options in
    *=) set -- "$machine_options$elf" "$@" ;;
    *) set -- "$machine_options $elf" "$@" ;;
  esac
  first=$1
  shift
  # shellcheck disable=SC2086
  ulimit -S -t "${TARGET_SECONDS:-300}"
  exec timeout $((20 * ${TARGET_SECONDS:-300})) "$qemu" $first -display none -monitor none "$@" </dev/null
}

[ $# -ge 1 ] || usage
verb=$1
shift
case $verb in
  list) echo "$names" ;;
  needs | flags | clock) [ $# -eq 1 ] || usage; machine "$1" ;;
  build | firmware) [ $# -ge 4 ] || usage; machine "$1"; shift ;;
  run) [ $# -ge 2 ] || usage; machine "$1"; shift ;;
  *) usage ;;
esac
case $verb in
  needs)
    echo "$packages"
    command -v "$compiler" >/dev/null && command -v "$qemu" >/dev/null ;;
  flags) echo "$compiler $flags" ;;
  clock) echo "$clock" ;;
  build)
    budgets="-Wl,--defsym=code_max=$code_all,--defsym=ram_max=$ram_all,--defsym=stack_max=$stack_all"
    build "$@" ;;
  firmware) budgets=''; build "$@" ;;
  run) run "$@" ;;
esac
