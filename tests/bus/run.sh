#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# tests/bus/run.sh [NAME...]: `make bus-test`: the sessions of sessions.sh in one boot of the bed (the
# host where it has vcan, else a guest), and the lateness of the host's own clock beside them.
# FRAY_BUS_SOAK=1, `make bus-soak`: longer.
# tests/bus/run.sh qemu: `make bus-test-qemu`: two emulated controllers; vcan with unpinned queues.
# tests/bus/run.sh keys: the sessions under a key; sessions: the others; bed: the bed itself. `make guests`.
. tests/lib/suite.sh
guest=tests/bus/guest.sh
said=$FRAY_BUILD/tests/bus/said.txt
bare_timer=$FRAY_BUILD/tests/bus/bare_timer
mkdir -p "$FRAY_BUILD/tests/bus"

# NAME...: counts what sessions.sh has counted, and shows it
sessions() {
  code=0
  sh $guest sh tests/bus/sessions.sh "$@" >"$said" 2>&1 || code=$?
  grep -v -E '^[0-9]+ passed, [0-9]+ failed$' "$said" || true
  line=$(grep -E '^[0-9]+ passed, [0-9]+ failed$' "$said" | tail -n 1) || line=''
  if [ -z "$line" ]; then
    fail "the sessions did not end (exit $code)"
    return
  fi
  suite_passed=$((suite_passed + ${line%% passed*}))
  bad=${line##*, }
  suite_failed=$((suite_failed + ${bad%% failed}))
}

plain='twenty workers play stop flood kill trouble flap lateness interop'
case ${1:-} in
  bed) exec sh tests/bus/bed.sh ;;
  sessions) set -- $plain ;;
  keys) set -- key tags stranger again ;;
esac
ready=1
if ! why=$(sh $guest --check 2>&1); then not_run "the bed (${why##*sh: })" 'the packages named' && ready=0; fi
for tool in candump canplayer cansend; do
  have $tool || { not_run "$tool" can-utils && ready=0; }
done
if [ $ready = 1 ]; then
  if [ "${1:-}" = qemu ]; then
    export FRAY_GUEST=qemu FRAY_GUEST_SECONDS="${FRAY_GUEST_SECONDS:-4000}"
    sessions controllers
    FRAY_GUEST_ORDER=0 sessions unpinned
  else
    seconds=10
    if [ "${FRAY_BUS_SOAK:-0}" = 1 ]; then seconds=30; fi
    echo "  figure 1 kHz for $seconds s, host without CAN: bare loop: $("$bare_timer" $seconds)"
    export FRAY_GUEST_SECONDS="${FRAY_GUEST_SECONDS:-6000}"
    sessions "$@"
  fi
fi
suite_end
