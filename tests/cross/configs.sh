# SPDX-License-Identifier: Apache-2.0
# The machines, compilers and options that must agree. config NAME sets
#   CC AR NM OBJDUMP OPT EXTRA   to build with
#   RUN                          in front of a program of that machine
#   TOOLS, PACKAGES              what it takes, and where Debian has it
# and returns 1 where something of it is missing.
# shellcheck disable=SC2034
CONFIGS_SHORT="gcc-O0 gcc-O2 gcc-O3 gcc-native gcc-id16 clang-O0 clang-O3 i386-O2 s390x-O2 m3-O2"
CONFIGS_FULL="gcc-O0 gcc-O1 gcc-O2 gcc-O3 gcc-Os gcc-native gcc-id16 gcc-checked
  clang-O0 clang-O2 clang-O3 clang-native i386-O0 i386-O2 i386-O3 s390x-O0 s390x-O2 s390x-O3
  m3-O0 m3-O2 m3-O3 m3-Os"

config_machine() { # of the part before the dash
  AR=ar NM=nm OBJDUMP=objdump RUN='' EXTRA='' PACKAGES='' TOOLS=''
  case $1 in
    gcc) CC=gcc TOOLS=gcc PACKAGES=gcc ;;
    clang) CC=clang TOOLS=clang PACKAGES=clang ;;
    i386)
      CC=i686-linux-gnu-gcc AR=i686-linux-gnu-ar NM=i686-linux-gnu-nm
      OBJDUMP=i686-linux-gnu-objdump RUN=qemu-i386-static EXTRA=-static
      TOOLS="$CC $RUN" PACKAGES="gcc-i686-linux-gnu and qemu-user-static" ;;
    s390x)
      CC=s390x-linux-gnu-gcc AR=s390x-linux-gnu-ar NM=s390x-linux-gnu-nm
      OBJDUMP=s390x-linux-gnu-objdump RUN=qemu-s390x-static EXTRA=-static
      TOOLS="$CC $RUN" PACKAGES="gcc-s390x-linux-gnu and qemu-user-static" ;;
    m3)
      AR=arm-none-eabi-ar NM=arm-none-eabi-nm OBJDUMP=arm-none-eabi-objdump
      RUN="sh tests/target/target.sh run m3"
      EXTRA=$(sh tests/target/target.sh flags m3)
      CC=${EXTRA%% *} EXTRA=${EXTRA#* }
      TOOLS="$CC qemu-system-arm" PACKAGES="gcc-arm-none-eabi and qemu-system-arm" ;;
    *) echo "configs.sh: no machine '$1'" >&2; exit 2 ;;
  esac
}

config() {
  config_machine "${1%%-*}"
  case $1 in
    *-native) OPT=-O3 EXTRA="$EXTRA -march=native" ;;
    *-id16) OPT=-O2 EXTRA="$EXTRA -DFRAY_ID_BITS=16" ;;
    *-checked) OPT=-O2 EXTRA="$EXTRA -DFRAY_CHECKED" ;;
    # gcc 12 sees a loop of at most 16 run over 16 bytes there (cmac.c), and nowhere else
    i386-O3 | s390x-O3) OPT=-O3 EXTRA="$EXTRA -Wno-error=stringop-overflow" ;;
    *) OPT=-${1#*-} ;;
  esac
  for tool in $TOOLS; do have "$tool" || return 1; done
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
