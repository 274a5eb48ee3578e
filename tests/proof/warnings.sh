#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# rt and the loop, with every warning an error, by every compiler and for every target; then the
# public headers in C++. One line a target.
. tests/lib/suite.sh

work=$FRAY_BUILD/proof/warnings
mkdir -p "$work"
warn='-Wall -Wextra -Wconversion -Wshadow -Wundef -Werror'
root=$PWD
sources=$(for file in rt/*/*.c platform/loop.c; do echo "$root/$file"; done)

# NAME PACKAGE COMPILER OPTIONS...
compile() {
  name=$1 package=$2 compiler=$3
  shift 3
  if ! have "$compiler"; then
    not_run "warnings of $name" "$package"
    return
  fi
  bad=0
  for ids in 32 16; do
    # shellcheck disable=SC2086
    (cd "$work" && "$compiler" -std=c11 -O2 -I"$root" $warn -DFRAY_ID_BITS=$ids "$@" -c $sources) \
      >"$work/$name.txt" 2>&1 || bad=1
    if [ $bad -ne 0 ]; then break; fi
  done
  printf '  %-16s %s\n' "$name" "$([ $bad -eq 0 ] && echo 'no warning' || echo warnings)"
  if [ $bad -eq 0 ]; then pass; else fail "$name: $(head -n 12 "$work/$name.txt")"; fi
}

compile x86-64-gcc gcc gcc
compile x86-64-gcc-O3 gcc gcc -O3
compile x86-64-clang clang clang
compile x86-64-checked gcc gcc -DFRAY_CHECKED
compile i386 gcc-i686-linux-gnu i686-linux-gnu-gcc
compile armhf gcc-arm-linux-gnueabihf arm-linux-gnueabihf-gcc
compile aarch64 gcc-aarch64-linux-gnu aarch64-linux-gnu-gcc
compile riscv64 gcc-riscv64-linux-gnu riscv64-linux-gnu-gcc
compile powerpc gcc-powerpc-linux-gnu powerpc-linux-gnu-gcc
compile s390x gcc-s390x-linux-gnu s390x-linux-gnu-gcc
compile mips gcc-mips-linux-gnu mips-linux-gnu-gcc

arm() { # NAME OPTIONS...
  part=$1
  shift
  compile "$part" gcc-arm-none-eabi arm-none-eabi-gcc -mthumb -ffreestanding "$@"
}
arm cortex-m0 -mcpu=cortex-m0
arm cortex-m3 -mcpu=cortex-m3
arm cortex-m4f -mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16
arm cortex-m7f -mcpu=cortex-m7 -mfloat-abi=hard -mfpu=fpv5-d16
arm cortex-m33 -mcpu=cortex-m33
arm cortex-r5f -mcpu=cortex-r5 -mfloat-abi=hard -mfpu=vfpv3-d16
compile rv32imac gcc-riscv64-unknown-elf riscv64-unknown-elf-gcc -march=rv32imac -mabi=ilp32 -ffreestanding

# C++: fray.h alone with the strictest warnings. The others have inline functions, whose casts are
# C's on purpose.
plus() { # COMPILER
  if ! have "$1"; then
    not_run "headers with $1" "${1%++}++"
    return
  fi
  # shellcheck disable=SC2086
  if "$1" -std=c++17 -I. $warn -pedantic -Wold-style-cast -Wzero-as-null-pointer-constant \
    -fsyntax-only tests/proof/fray_header.cpp >"$work/$1.txt" 2>&1; then pass; else
    fail "$1, fray.h: $(head -n 12 "$work/$1.txt")"
  fi
  for standard in c++11 c++20; do
    # shellcheck disable=SC2086
    if "$1" -std=$standard -I. $warn -pedantic -fsyntax-only tests/proof/public_headers.cpp \
      >"$work/$1.txt" 2>&1; then pass; else fail "$1 $standard: $(head -n 12 "$work/$1.txt")"; fi
  done
  # shellcheck disable=SC2086
  if "$1" -std=c++17 -I. $warn tests/proof/public_headers.cpp "$FRAY_BUILD/libfray.a" \
    -o "$work/$1" >"$work/$1.txt" 2>&1 && "$work/$1"; then pass; else
    fail "$1: the headers do not link with the library, or the program fails: $(head -n 12 "$work/$1.txt")"
  fi
  printf '  %-16s public headers parse, link and run\n' "$1"
}
if [ ! -f "$FRAY_BUILD/libfray.a" ]; then suite_make "$FRAY_BUILD/libfray.a" BUILD="$FRAY_BUILD"; fi
plus g++
plus clang++

# The rules must find what they look for.
printf 'int f(long a);\nint f(long a) { int b = 1; { int b = 2; (void)b; } return a + b; }\n' >"$work/bad.c"
# shellcheck disable=SC2086
if gcc -std=c11 $warn -c "$work/bad.c" -o "$work/bad.o" 2>/dev/null; then fail "a bad file compiles"; else pass; fi
suite_end
