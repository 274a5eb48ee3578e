#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# What `make install` puts below PREFIX, read from the project's root, where it is called:
#   install.sh install BUILD PREFIX [DESTDIR]     the command, its man page and completion; the library, static
#                                                 and shared, its headers, what CMake and pkg-config need
#   install.sh uninstall BUILD PREFIX [DESTDIR]   removes the same files, and the folders that are fray's alone
#   install.sh exports LIBRARY                    a linker's version script: the functions that the headers declare
#   install.sh version | series                   0.5.0 | 0.5, what a soname holds: before 1.0 a minor version may
#                                                 change the interface
set -eu
version=$(sed -n 's/^#define FRAY_VERSION "\(.*\)"$/\1/p' rt/fray.h)
series=${version%.*}
headers='rt/fray.h rt/base/assert.h rt/base/bytes.h rt/wire/auth.h rt/wire/cmac.h rt/wire/codec.h rt/wire/dictionary.h
  rt/wire/e2e.h rt/wire/frame.h rt/wire/auth_gate.h rt/wire/port.h rt/wire/queue.h rt/wire/sequence.h'

put() { # MODE FILE PATH
  if [ $verb = uninstall ]; then rm -f "$root/$3"; else install -D -m "$1" "$2" "$root/$3"; fi
}
link() { # TO PATH
  if [ $verb = uninstall ]; then rm -f "$root/$2"; else ln -sf "$1" "$root/$2"; fi
}
fill() { # TEMPLATE PATH
  sed -e "s|@PREFIX@|$prefix|; s|@VERSION@|$version|; s|@SERIES@|$series|" "platform/package/$1" >"$filled"
  put 644 "$filled" "$2"
}

files() {
  put 755 "$build/fray" bin/fray
  if [ $verb = install ]; then sh platform/package/man.sh "$build/fray" "$version" >"$filled"; fi
  put 644 "$filled" share/man/man1/fray.1
  put 644 platform/package/fray.bash share/bash-completion/completions/fray
  for header in $headers rt/wire/fray.dbc; do put 644 "$header" "include/fray/$header"; done
  put 644 "$build/libfray.a" lib/libfray.a
  put 755 "$build/libfray.so" "lib/libfray.so.$version"
  link "libfray.so.$version" "lib/libfray.so.$series"
  link "libfray.so.$series" lib/libfray.so
  fill fray.pc.in lib/pkgconfig/fray.pc
  fill fray-config.cmake.in lib/cmake/fray/fray-config.cmake
  fill fray-config-version.cmake.in lib/cmake/fray/fray-config-version.cmake
}

# It stands in files that pkg-config and shells read; DESTDIR stands in none.
check() {
  case $prefix in
  *[!A-Za-z0-9/._+~@-]*) ;;
  /*) case $root in -*) ;; *) return 0 ;; esac ;;
  esac
  echo "install.sh: PREFIX '$prefix', DESTDIR '${root%"$prefix"}': expected for PREFIX an absolute path of letters, digits and /._+~@-, for DESTDIR a path" >&2
  exit 2
}

verb=$1
case $verb in
version) echo "$version" ;;
series) echo "$series" ;;
exports)
  echo 'FRAY { global:'
  # shellcheck disable=SC2086
  grep -ohE '[a-z][a-z0-9_]*' $headers | sort -u >"$2.words"
  ${NM:-nm} -g --defined-only "$2" | awk 'NF == 3 { print $3 }' | sort -u | comm -12 - "$2.words" | sed 's/$/;/'
  echo '  local: *;'
  echo '};' ;;
install | uninstall)
  build=$2 prefix=$3 root=${4:-}$3
  check
  filled=$(mktemp)
  trap 'rm -f "$filled"' EXIT
  files
  [ $verb = install ] || for folder in include/fray lib/cmake/fray; do
    [ ! -d "$root/$folder" ] || find "$root/$folder" -depth -type d -exec rmdir --ignore-fail-on-non-empty {} +
  done ;;
*) echo "install.sh: '$verb', expected install, uninstall, exports, version or series" >&2; exit 2 ;;
esac
