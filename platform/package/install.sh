#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# install.sh LIBRARY PREFIX [DESTDIR]: the library, its public headers, and what CMake and pkg-config
# need to find them. Everything is read from the project's root, where it is called.
set -eu
library=$1 prefix=$2 root=${3:-}$2
version=$(sed -n 's/^#define FRAY_VERSION "\(.*\)"$/\1/p' rt/fray.h)
headers='rt/fray.h rt/base/bytes.h rt/wire/auth.h rt/wire/cmac.h rt/wire/codec.h rt/wire/dictionary.h
  rt/wire/e2e.h rt/wire/frame.h rt/wire/guard.h rt/wire/port.h rt/wire/queue.h rt/wire/sequence.h
  rt/wire/fray.dbc'

for header in $headers; do
  mkdir -p "$root/include/fray/${header%/*}"
  install -m 644 "$header" "$root/include/fray/$header"
done
mkdir -p "$root/lib/pkgconfig" "$root/lib/cmake/fray"
install -m 644 "$library" "$root/lib/libfray.a"
fill() { # TEMPLATE TO
  sed -e "s|@PREFIX@|$prefix|; s|@VERSION@|$version|; s|@SERIES@|${version%.*}|" "platform/package/$1" >"$2"
}
fill fray.pc.in "$root/lib/pkgconfig/fray.pc"
fill fray-config.cmake.in "$root/lib/cmake/fray/fray-config.cmake"
fill fray-config-version.cmake.in "$root/lib/cmake/fray/fray-config-version.cmake"
