# SPDX-License-Identifier: Apache-2.0
# The machines, compilers and options that must agree. config NAME sets
#   CC AR NM OBJDUMP OPT EXTRA   to build with
#   RUN                          in front of a program of that machine
#   MACHINE IS_BARE              its name, bits and byte order; no operating system
#   CASES LIMITS                 all or tiny: what fits; options that say how much memory and time
#   RESTORED                     how often the second run is saved and opened again
#   KERNEL                       the wide kernel that the replay must use, if any
#   TOOLS, PACKAGES              what it takes, and where Debian has it
# and returns 1 where something of it is missing.
# shellcheck disable=SC2034
# in four parts; what a part of CONFIGS_SHORT builds, the same part of the lists of images.sh and symbols.sh uses again
CONFIGS_SHORT="clang-O3 s390x-O2 gcc-id16 m3-O2 gcc-O0 gcc-native gcc-narrow"
CONFIGS_FULL="gcc-O0 gcc-O1 gcc-O2 gcc-O3 gcc-Os gcc-native gcc-id16 gcc-narrow gcc-checked
  clang-O0 clang-O2 clang-O3 clang-Os clang-native
  i386-O0 i386-O2 i386-O3 armhf-O0 armhf-O2 armhf-O3 aarch64-O0 aarch64-O2 aarch64-O3
  riscv64-O0 riscv64-O2 riscv64-O3 powerpc-O0 powerpc-O2 powerpc-O3 s390x-O0 s390x-O2 s390x-O3
  mips-O0 mips-O2 mips-O3
  m0-O2 m0-Os m3-O0 m3-O2 m3-O3 m3-Os m4f-O2 m4f-O3 m7f-O2 m7f-O3 m33-O2 m33-Os m55-O2
  r5f-O2 r5f-O3 rv32-O2 rv32-Os microbit-O2 microbit-Os
  gcc-avx2 gcc-avx512 clang-avx2 clang-avx512 aarch64-neon m55-mve"
# where the whole command is built too, and its images compared
CONFIGS_IMAGES="gcc-O0 gcc-O3 gcc-id16 clang-O3 i386-O2 armhf-O2 aarch64-O2 riscv64-O2 powerpc-O2
  s390x-O2 mips-O2"
# where what `make run` records is verified
CONFIGS_RUN="clang-O3 s390x-O2"

# TRIPLET QEMU MACHINE...: a Linux machine under qemu-user
config_foreign() {
  CC=$1-gcc AR=$1-ar NM=$1-nm OBJDUMP=$1-objdump RUN=qemu-$2-static EXTRA=-static
  TOOLS="$CC $RUN" PACKAGES="gcc-$1 and qemu-user-static"
  shift 2
  MACHINE="$*"
}

# NAME of tests/target/target.sh: a machine without an operating system
config_bare() {
  PACKAGES=$(sh tests/target/target.sh needs "$1") || MISSING=yes
  EXTRA=$(sh tests/target/target.sh flags "$1")
  CC=${EXTRA%% *} EXTRA=${EXTRA#* }
  AR=${CC%gcc}ar NM=${CC%gcc}nm OBJDUMP=${CC%gcc}objdump
  RUN="sh tests/target/target.sh run $1"
  case $1 in
    r5f) MACHINE='cortex-r5f 32 little' ;;
    rv32) MACHINE='rv32imac 32 little' ;;
    microbit) MACHINE='microbit,m0 32 little' ;;
    *) MACHINE="cortex-$1 32 little" ;;
  esac
  IS_BARE=yes
  # 16 KiB of RAM, 2 of them the stack, too few for membranes: one image is saved, once, and its world runs from there
  if [ "$1" = microbit ]; then
    CASES=tiny RESTORED=once
    LIMITS="-DFRAY_TRIANGLES=0 -DREPLAY_MEMORY=6144 -DREPLAY_SAVED=7424 -DREPLAY_SAVED_IMAGES=1"
    EXTRA="$EXTRA -DFRAY_TRIANGLES=0"
  fi
}

# FLAG...: of this machine's processor
config_cpu() {
  for flag in "$@"; do
    grep -qsw "$flag" /proc/cpuinfo && continue
    PACKAGES="a processor with $flag" MISSING=yes
  done
}

config_machine() { # of the part before the dash
  AR=ar NM=nm OBJDUMP=objdump RUN='' EXTRA='' PACKAGES='' TOOLS='' MISSING=no
  MACHINE='x86-64 64 little' IS_BARE=no CASES=all LIMITS='' RESTORED=often KERNEL=''
  case $1 in
    gcc) CC=gcc TOOLS=gcc PACKAGES=gcc ;;
    clang) CC=clang TOOLS=clang PACKAGES=clang ;;
    i386) config_foreign i686-linux-gnu i386 i386 32 little ;;
    armhf) config_foreign arm-linux-gnueabihf arm armv7-a 32 little ;;
    aarch64) config_foreign aarch64-linux-gnu aarch64 aarch64 64 little ;;
    riscv64) config_foreign riscv64-linux-gnu riscv64 rv64gc 64 little ;;
    powerpc) config_foreign powerpc-linux-gnu ppc powerpc 32 big ;;
    s390x) config_foreign s390x-linux-gnu s390x s390x 64 big ;;
    mips) config_foreign mips-linux-gnu mips mips32r2 32 big ;;
    m0 | m3 | m4f | m7f | m33 | m55 | r5f | rv32 | microbit) config_bare "$1" ;;
    *) echo "configs.sh: no machine '$1'" >&2; exit 2 ;;
  esac
}

config() {
  config_machine "${1%%-*}"
  case $1 in
    *-native) OPT=-O3 EXTRA="$EXTRA -march=native" ;;
    *-id16) OPT=-O2 EXTRA="$EXTRA -DFRAY_ID_BITS=16" ;;
    *-narrow) OPT=-O2 EXTRA="$EXTRA -DFX_NARROW=1 -DFX_NO_LONG_MULTIPLY=1" ;;
    *-checked) OPT=-O2 EXTRA="$EXTRA -DFRAY_CHECKED" ;;
    *-avx2) OPT=-O3 KERNEL=AVX2; config_cpu avx2 ;;
    *-avx512) OPT=-O3 KERNEL=AVX512; config_cpu avx512f avx512bw avx512dq avx512vl ;;
    *-neon) OPT=-O3 KERNEL=NEON ;;
    *-mve) OPT=-O2 KERNEL=HELIUM ;;
    # gcc 12 sees a loop of at most 16 run over 16 bytes there (cmac.c), and nowhere else
    i386-O3 | s390x-O3 | powerpc-O3 | riscv64-O3 | mips-O3)
      OPT=-O3 EXTRA="$EXTRA -Wno-error=stringop-overflow" ;;
    # an emulator takes minutes for it
    gcc-O0 | clang-O0) OPT=-O0 ;;
    *-O0) OPT=-O0 RESTORED=no LIMITS="$LIMITS -DREPLAY_RESTORED=0" ;;
    *) OPT=-${1#*-} ;;
  esac
  if [ -n "$KERNEL" ]; then LIMITS="$LIMITS -DREPLAY_KERNEL=FRAY_KERNEL_$KERNEL"; fi
  for tool in $TOOLS; do have "$tool" || MISSING=yes; done
  [ "$MISSING" = no ]
}

# config_make NAME TARGET...: builds below $FRAY_BUILD/cross/NAME; config NAME comes first.
config_make() {
  config_folder=$FRAY_BUILD/cross/$1
  shift
  config_targets=''
  for target in "$@"; do config_targets="$config_targets $config_folder/$target"; done
  # shellcheck disable=SC2086
  suite_make BUILD="$config_folder" CC="$CC" AR="$AR" OPT="$OPT" EXTRA="$EXTRA" $config_targets
}
