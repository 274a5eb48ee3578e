#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# man.sh FRAY VERSION: the man page of the command, from what `fray --help` and `fray COMMAND --help` print.
set -eu
fray=$1 version=$2

# text as it stands: roff reads no escape and no request in it
text() {
  echo .EX
  sed -e 's/\\/\\e/g' -e 's/-/\\-/g' -e 's/`/\\(ga/g' -e "s/'/\\\\(aq/g" -e 's/^\./\\\&./'
  echo .EE
}

what=$(sed -n 's/^Description: //p' platform/package/fray.pc.in)
printf '.TH FRAY 1 "" "fray %s" "User Commands"\n.SH NAME\nfray \\- %s\n.SH SYNOPSIS\n' "$version" "$(echo "$what" | sed 's/-/\\-/g')"
"$fray" --help | text
"$fray" --help | sed -n 's/^  \([a-z][a-z]*\)   *[a-z].*/\1/p' | while read -r name; do
  printf '.SH FRAY %s\n' "$(echo "$name" | tr a-z A-Z)"
  "$fray" "$name" --help | text
done
