#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# tests/bus/run.sh [NAME...]: `make bus-test`: the sessions of sessions.sh, dealt to as many guests as there are
# cores (GUESTS=4), and the lateness of the host's own clock beside them. FRAY_BUS_SOAK=1, `make bus-soak`: longer.
# tests/bus/run.sh qemu: `make bus-test-qemu`: two emulated controllers; vcan with unpinned queues.
# tests/bus/run.sh keys: the sessions under a key; sessions: the others; bed: the bed itself. `make guests`.
. tests/lib/suite.sh
guest=tests/bus/guest.sh
guests=${GUESTS:-$(nproc)}
said=$FRAY_BUILD/tests/bus/said
bare_timer=$FRAY_BUILD/tests/bus/bare_timer
mkdir -p "$FRAY_BUILD/tests/bus"

# NAME...: in the guests to which they are dealt; counts what sessions.sh has counted, and shows it
sessions() {
  rm -f "$said".*
  for k in $(seq "$guests"); do
    names=$(sh tests/part.sh share "$k/$guests" "$@")
    # shellcheck disable=SC2086
    if [ -n "$names" ]; then sh $guest sh tests/bus/sessions.sh $names >"$said.$k" 2>&1 || echo "exit $?" >>"$said.$k" & fi
  done
  wait
  for out in "$said".*; do
    grep -v -E '^[0-9]+ passed, [0-9]+ failed$' "$out" || true
    line=$(grep -E '^[0-9]+ passed, [0-9]+ failed$' "$out" | tail -n 1) || line=''
    if [ -z "$line" ]; then
      fail "the sessions did not end"
      continue
    fi
    suite_passed=$((suite_passed + ${line%% passed*}))
    bad=${line##*, }
    suite_failed=$((suite_failed + ${bad%% failed}))
  done
}

plain='twenty workers arms play stop flood kill trouble flap lateness interop'
keyed='key tags stranger again'
case ${1:-} in
  bed) exec sh tests/bus/bed.sh ;;
  # shellcheck disable=SC2086
  '') set -- $plain $keyed ;;
  # shellcheck disable=SC2086
  sessions) set -- $plain ;;
  # shellcheck disable=SC2086
  keys) set -- $keyed ;;
esac
ready=1
if ! why=$(sh $guest --check 2>&1); then not_run "the bed (${why##*sh: })" 'the packages named' && ready=0; fi
for tool in candump canplayer cansend; do
  have $tool || { not_run "$tool" can-utils && ready=0; }
done
if [ $ready = 1 ]; then
  export FRAY_GUEST_SECONDS="${FRAY_GUEST_SECONDS:-1200}"
  if [ "${1:-}" = qemu ]; then
    sessions controllers
    FRAY_GUEST_CPUS=2 FRAY_GUEST_ORDER=0 sessions unpinned
  else
    seconds=10
    if [ "${FRAY_BUS_SOAK:-0}" = 1 ]; then seconds=30; fi
    echo "  figure 1 kHz for $seconds s, host without CAN: bare loop: $("$bare_timer" $seconds)"
    sessions "$@"
  fi
fi
suite_end
