#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# tests/bus/bed.sh: does the test bed of the bus work on this machine? Boots each guest that it can have,
# checks vcan0, can-utils, the emulated controllers, and what guest.sh promises; prints the times.
cd "$(dirname "$0")/../.."
. tests/lib/suite.sh
guest=tests/bus/guest.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset FRAY_GUEST FRAY_GUEST_CPUS FRAY_GUEST_ORDER
export FRAY_GUEST_SECONDS=2000 # but for what tries this itself

expect() { # WHAT GOT EXPECTED
  if [ "$2" = "$3" ]; then pass; else fail "$1: \`$2\`, expected \`$3\`"; fi
}
seconds_of() { # COMMAND...: its wall time, in s
  began=$(date +%s%N)
  "$@" >/dev/null 2>&1 || true
  echo "$((($(date +%s%N) - began) / 1000000))" | awk '{ printf "%.2f", $1 / 1000 }'
}
count_checks() { # the lines of guest/tools.sh
  while IFS= read -r line; do
    case $line in
      'ok '*) pass ;;
      'bad '*) fail "$bed: ${line#bad }" ;;
      *) echo "  $bed: $line" ;;
    esac
  done <"$1"
}

promises() { # what guest.sh says of itself
  code=0
  text="it's \"\$HOME\" \\ x" sh $guest sh -c \
    'printf "%s|" "$text" "$@" "$(pwd)" "$FRAY_GUEST"; echo error >&2; (setsid sleep 100 &); exit 7' sh "a  b" '' \
    >"$work/out" 2>"$work/err" || code=$?
  expect "$bed: exit status" "$code" 7
  expect "$bed: words, environment, folder" "$(cat "$work/out")" "it's \"\$HOME\" \\ x|a  b||$(pwd)|host|"
  expect "$bed: the error stream" "$(cat "$work/err")" error
  head -c 300000 /dev/urandom >"$work/bytes"
  expect "$bed: 300 kB to a slow reader" \
    "$(sh $guest cat "$work/bytes" | { dd bs=1 count=1 2>/dev/null && sleep 2 && cat; } | cksum)" "$(cksum <"$work/bytes")"
  limit=$(echo "$first" | awk '{ print int(2 * $1) + 3 }')
  until [ -e "$work/began" ] || [ "$limit" -gt 1000 ]; do # enough to boot, on a busy machine too
    code=0
    FRAY_GUEST_SECONDS=$limit sh $guest sh -c "echo began >'$work/began'; sync; while :; do :; done" >/dev/null 2>&1 || code=$?
    limit=$((2 * limit))
  done
  expect "$bed: the time limit" "$code $(cat "$work/began" 2>&1)" '124 began'
  rm -f "$work/began"
}

tools=''
have candump || tools=no
if [ -n "$tools" ]; then not_run 'can-utils in the guest' can-utils; fi
for bed in host qemu 'qemu with 2 CPUs'; do
  export FRAY_GUEST="${bed%% *}" FRAY_GUEST_CPUS=1
  case $bed in *' 2 CPUs') FRAY_GUEST_CPUS=2 ;; esac
  if ! reason=$(sh $guest --check 2>&1); then
    # that a kernel has no vcan is no fault of the machine's; it is what the guest is for
    if [ $FRAY_GUEST = host ]; then
      echo '  host: no vcan in this kernel'
    else
      not_run "the guest, $bed" "${reason##*--no-install-recommends }"
    fi
    continue
  fi
  # a folder of temporary files of its own, to see that nothing stays in it
  TMPDIR=$work/tmp && mkdir -p "$TMPDIR" && export TMPDIR
  first=$(seconds_of sh $guest true)
  echo "  $bed: \`true\` in $first s, again $(seconds_of sh $guest true) s"
  promises
  unset TMPDIR
  expect "$bed: files left behind" "$(ls -A "$work/tmp")" ''
  if [ -z "$tools" ]; then
    option=''
    if [ $FRAY_GUEST = qemu ]; then option=controllers; fi
    code=0
    sh $guest sh tests/bus/guest/tools.sh $option >"$work/checks" 2>"$work/err" || code=$?
    count_checks "$work/checks"
    expect "$bed: tools.sh" "$code $(head -c 300 "$work/err")" '0 '
  fi
done
suite_end
