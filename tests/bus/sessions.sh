#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# sessions.sh [NAME...]: live sessions on vcan0, to be run where guest.sh runs them (root, vcan0 up).
# NAME: twenty workers arms play stop flood kill trouble flap lateness interop key tags stranger again,
# and in QEMU controllers or unpinned. A `figure` line says what was measured, a check what must hold;
# no check is about the machine's speed. README.md says more.
. tests/lib/suite.sh

here=tests/bus
work=$(mktemp -d /dev/shm/fray-bus.XXXXXX)
fray=$work/fray
kept=$FRAY_BUILD/tests/bus/failed
bare_timer=$FRAY_BUILD/tests/bus/bare_timer
flood_facts=$FRAY_BUILD/tests/bus/flood_facts
log_until=$FRAY_BUILD/tests/bus/log_until
cp "$FRAY" "$fray" # others read it too, see interop
chmod 755 "$work" "$fray"
trap 'rm -rf "$work"' EXIT
# Before fray (80), whatever it waits for: on a slow machine fray alone is late, and candump loses nothing.
chrt --rr --pid 84 $$
fray_cpu=''
soak=${FRAY_BUS_SOAK:-0}
flood_ticks=500
if [ "$soak" = 1 ]; then flood_ticks=10000; fi
bus=vcan0       # fray's interface
device_bus=vcan0 # the hands' and candump's

figure() { echo "  figure $*"; }
is() { [ "$1" = "$2" ] || { echo "    found '$1', expected '$2'"; return 1; }; }
between() { [ "$1" -ge "$2" ] && [ "$1" -le "$3" ] || { echo "    found $1, expected $2 to $3"; return 1; }; }
number() { sed -n "s/.*$2 \([0-9][0-9]*\).*/\1/p" "$work/$1.out" | head -n 1; } # SESSION WORDS
hash_of() { sed -n 's/^hash \([0-9a-f]*\) .*/\1/p' "$work/$1.out"; }
facts() { eval "$(awk -v what="$2" -f $here/facts.awk "$work/$1.can")"; } # sets the shell's variables
until_true() { # COMMAND...: for minutes, if the machine is that busy
  read -r began_up _ </proc/uptime
  until "$@"; do
    read -r now_up _ </proc/uptime
    if [ $((${now_up%.*} - ${began_up%.*})) -gt 3000 ]; then return 1; fi
    sleep 0.05
  done
}

make_scene() { # RATE SUBSTEPS
  rate=$1 substeps=$2
  sed "s/^rate .*/rate $rate Hz/; s/^substeps .*/substeps $substeps/" $here/scenes/sheet.scene >"$work/sheet.scene"
  for script in tear hold slow; do sed "s/^rate .*/rate $rate Hz/" $here/scenes/$script.hand >"$work/$script.hand"; done
  "$fray" scene "$work/sheet.scene" -o "$work/sheet.img" >/dev/null
}

# ---- the three parts of a session: each leaves its process id in a variable
log_pid=''
hand_pid=''
fray_pid=''
listeners() { grep -c "^ *$device_bus " "/proc/net/can/rcvlist_$1"; } # LIST: `all`, or `sff` with exact filters
more_listen() { [ "$(listeners "$1")" -gt "$listening" ]; }
# Until the log has COUNT frames that match LIKE, from the first on that matches AFTER, or SYNCS more SYNCs
# without it: the bus is the clock here.
within() { # SYNCS SESSION COUNT LIKE [AFTER]
  most=$1 seen_in=$work/$2.can
  shift 2
  "$log_until" "$seen_in" "$most" "$@"
}
until_seen() { within - "$@"; } # SESSION COUNT LIKE [AFTER]
a_force='^18[12]#.{4}0*[1-9A-F]' # that is not zero
start_log() { # SESSION
  listening=$(listeners all) || true
  candump -L -r 8000000 "$device_bus" >"$work/$1.can" 2>"$work/$1.candump" &
  log_pid=$!
  until_true more_listen all || fail "$1: candump does not listen on $device_bus"
}
drained() {
  before=$after
  after=$(wc -c <"$work/$1.can")
  [ "$before" = "$after" ]
}
stop_log() { # SESSION: when nothing more comes
  after=''
  sleep 0.1
  until_true drained "$1" || true
  kill "$log_pid"
  wait "$log_pid" || true
}
# A device is a machine of its own: on one CPU it goes before fray, or a tick that the host lets stand still
# for a period would find no answer to its SYNC.
start_hand() { # SESSION SCRIPT OPTION...
  session=$1 script=$2
  shift 2
  listening=$(listeners sff) || true
  chrt --fifo 85 "$fray" hand --can "$device_bus" "$work/$script.hand" --patience 0 "$@" >"$work/$session.hand.out" 2>&1 &
  hand_pid=$!
  until_true more_listen sff || fail "$session: the hands do not listen: $(cat "$work/$session.hand.out")"
}
start_fray() { # SESSION OPTION...
  session=$1
  shift
  "$fray" run "$work/sheet.img" --can "$bus" --realtime ${fray_cpu:+--cpu $fray_cpu} "$@" >"$work/$session.out" 2>&1 &
  fray_pid=$!
}
fray_ticks() { [ -s "$work/$1.can" ] || ! kill -0 "$fray_pid" 2>/dev/null; }
end_fray() { # SESSION [STATUS]: checks the exit status
  code=0
  wait "$fray_pid" || code=$?
  [ "$code" -eq "${2:-0}" ] || fail "$1: fray run: exit $code, expected ${2:-0}: $(tail -n 3 "$work/$1.out")"
}
end_hand() {
  kill -CONT "$hand_pid" 2>/dev/null || true
  kill "$hand_pid" 2>/dev/null || true
  wait "$hand_pid" 2>/dev/null || true
}
session() { # SESSION SCRIPT TICKS HAND_OPTION...
  name=$1 script=$2 ticks_wanted=$3
  shift 3
  start_log "$name"
  start_hand "$name" "$script" "$@"
  start_fray "$name" --ticks "$ticks_wanted" --record "$work/$name.own"
  end_fray "$name"
  end_hand
  stop_log "$name"
}
verify() { "$fray" verify "$1" --scene "$work/sheet.img" >"$work/verify.out" 2>&1; } # LOG
keep() { # SESSION: what it left, for whoever looks into a failure
  mkdir -p "$kept"
  cp "$work/$1".* "$work/sheet.img" "$kept/"
  echo "    kept in $kept"
}
verified_hash() { sed -n 's/^verified .*hash //p' "$work/verify.out"; }
verifies() { # SESSION LOG: and ends where the run ended
  if ! verify "$2"; then
    echo "    $(head -n 2 "$work/verify.out")"
    keep "$1"
    return 1
  fi
  is "$(verified_hash)" "$(hash_of "$1")" || {
    echo "    $(tail -n 1 "$work/verify.out"); the run: $(tail -n 1 "$work/$1.out")"
    keep "$1"
    return 1
  }
}

# ---- 1: two hands tear the sheet; candump's log verifies; twenty times
test_twenty() {
  torn=0 lost=0 good=0 tears_least=9999
  for n in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
    session twenty tear 230
    if verifies twenty "$work/twenty.can"; then good=$((good + 1)); else fail "session $n: candump's log"; fi
    verifies twenty "$work/twenty.own" || fail "session $n: fray's own log"
    cuts=$(number twenty 'breaks      ')
    losses=$(number twenty 'SYNCs lost')
    if [ "$cuts" -gt 0 ]; then torn=$((torn + 1)); fi
    if [ "$cuts" -lt "$tears_least" ]; then tears_least=$cuts; fi
    if [ "$losses" -gt 0 ]; then lost=$((lost + 1)); fi
    if [ "$losses" -eq 0 ] && [ "$cuts" -eq 0 ]; then fail "session $n: nothing tore, though the bus was there"; fi
  done
  figure "20 sessions on $bus, $rate Hz, 230 ticks: candump's log verified in $good, torn in $torn (least $tears_least springs), SYNCs lost in $lost"
  holds "twenty: some session tears the sheet" [ "$torn" -gt 0 ]
  holds "twenty: every candump log verifies" is "$good" 20
}

# ---- 2: three workers share the ticks, more than there are CPUs
test_workers() {
  make_scene 100 30
  start_log workers
  start_hand workers tear
  start_fray workers --ticks 95 --record "$work/workers.own" --workers 3
  end_fray workers
  end_hand
  stop_log workers
  figure "3 workers, $rate Hz: $(number workers 'breaks      ') springs broken, $(number workers 'SYNCs lost') SYNCs lost"
  holds "workers: candump's log verifies" verifies workers "$work/workers.can"
  holds "workers: fray's own log verifies" verifies workers "$work/workers.own"
}

# ---- arms: two hold a cloth by handles; their own account beside fray's meters
sum_uj() { sed -n "s/$1 \(-*[0-9.]*\) mJ.*/\1/p" "$2" | awk '{ sum += $1 * 1000 } END { printf "%.0f", sum }'; } # WORDS FILE
test_arms() {
  for rate in 1000 500 250; do
    sed "s/^rate .*/rate $rate Hz/" $here/scenes/held.scene >"$work/held.scene"
    sed "s/^rate .*/rate $rate Hz/" $here/scenes/arms.hand >"$work/arms.hand"
    "$fray" scene "$work/held.scene" -o "$work/sheet.img" >/dev/null
    for attempt in 1 2 3 4 5 6 7 8; do
      session arms arms $((rate * 4))
      if [ "$(number arms 'SYNCs lost')" -eq 0 ]; then break; fi
    done
    arms_gave=$(sum_uj '^arm .* gave' "$work/arms.hand.out")
    were_given=$(sum_uj '^device .* was given' "$work/arms.out")
    figure "two arms, $rate Hz, 4 s: they gave $arms_gave uJ; by fray's meters $((-were_given)) (attempt $attempt)"
    holds "arms: they gave energy, and got none" [ "$arms_gave" -gt 100 ]
    holds "arms: meters agree to 1 %" between $((-were_given)) $((arms_gave * 99 / 100)) $((arms_gave * 101 / 100))
    holds "arms: the controller took nothing" is "$(grep -c 'controller took 0.000 mJ' "$work/arms.out")" 2
    holds "arms: candump's log verifies" verifies arms "$work/arms.can"
  done
}

# ---- 3: canplayer plays a recording's device frames into a live fray
test_play() {
  make_scene 100 30 # canplayer is late by a millisecond or two: a short tick would often have no pose
  session source slow 295
  # of the commands only the hand's START: STOP at the end is fray's own. The times go back to the even grid
  # of the ticks: those that this machine let stand still would be stood still for twice
  awk '/ 080#/ { ++n }
    $3 ~ /^10[12]#/ || ($3 ~ /^010#....01/ && !seen++) { printf "(%.6f) %s %s\n", 1000 + n / 100, $2, $3 }' \
    "$work/source.own" >"$work/play.log"
  for attempt in 1 2 3 4 5; do
    start_log play
    start_fray play --ticks 380 --record "$work/play.own"
    until_true fray_ticks play
    canplayer -I "$work/play.log" vcan0=vcan0 >"$work/canplayer.out" 2>&1 || fail "canplayer: $(cat "$work/canplayer.out")"
    end_fray play
    stop_log play
    cuts=$(number play 'breaks      ')
    faults=$(sed -n 's/^hash.* faults //p' "$work/play.out")
    # a guest that stood still for 2 ms may lose its bus: that is no matter of canplayer
    if [ "$(number play 'SYNCs lost')" -ne 0 ]; then continue; fi
    holds "play: no fault but STALE: $faults" [ "$faults" -le 3 ]
    if [ "$cuts" -gt 0 ]; then break; fi
  done
  figure "canplayer: $(wc -l <"$work/play.log") device frames, $cuts springs broken, faults $faults (attempt $attempt)"
  holds "play: the sheet tears" [ "$cuts" -gt 0 ]
  holds "play: candump's log verifies" verifies play "$work/play.can"
}

# ---- 4: the hands fall silent
test_stop() {
  make_scene 500 12 # 10 ms are a whole number of ticks
  for signal in STOP KILL; do
    for attempt in 1 2 3 4 5 6 7 8; do
      start_log stop
      start_hand stop hold
      start_fray stop --record "$work/stop.own"
      within 1000 stop 1 "$a_force" || true
      kill -$signal "$hand_pid" || fail "stop: the hands have ended: $(cat "$work/stop.hand.out")"
      within 1000 stop 20 '^080#' '^701#03' || true
      kill "$fray_pid"
      end_fray stop
      kill -KILL "$hand_pid" 2>/dev/null || true # one that goes on would answer what it has missed
      wait "$hand_pid" 2>/dev/null || true
      stop_log stop
      facts stop stop
      if [ "$forced" -eq 1 ] && [ "$(number stop 'SYNCs lost')" -eq 0 ]; then break; fi
    done
    figure "SIG$signal of the hands: STALE after $stale_ticks ticks ($stale_ms ms after the last POSE), forces zero $zero_ticks ticks ($zero_ms ms) later (attempt $attempt)"
    holds "stop: there was a force to fade" is "$forced" 1
    holds "stop: STALE in the third tick without a POSE" is "$stale_ticks" 3
    holds "stop: force zero within 10 ms, that is 5 ticks, of STALE: $zero_ticks" \
      [ "$zero_ticks" -ge 0 -a "$zero_ticks" -le 5 ]
    holds "stop: candump's log verifies" verifies stop "$work/stop.can"
  done
}

# ---- 5: another process floods the bus
count_of() { sed -n "s/.*[ ,]$2 \([0-9]*\)[,;]*.*/\1/p" "$work/$1.out" | head -n 1; }
lateness() { sed -n 's/^lateness *//p' "$work/$1.out"; }
sum_of() { # SESSION COUNTER...: what the port has counted
  session=$1 sum=0
  shift
  for counter; do sum=$((sum + $(count_of "$session" "$counter"))); done
  echo "$sum"
}
# All of this is in fray's own log and counters: how fast the machine is does not enter.
judge_flood() { # KIND
  eval "$("$flood_facts" "$work/$1.own")"
  sum=$(sum_of "$1" accepted repeated old 'wrong CRC' 'wrong length' 'wrong flags' 'wrong field')
  crc=$(count_of "$1" 'wrong CRC')
  figure "$1: $taken POSEs and COMMANDs read in $ticks ticks, at most $busiest for one, $crowded ticks left some for the next; $good good, $crc with a wrong CRC, queue full $(count_of "$1" 'queue full'); a pose in $consumed ticks, later than one tick in $behind"
  figure "$1: fray: $(lateness "$1"); SYNCs lost $(count_of "$1" 'SYNCs lost'), kernel drops $(count_of "$1" 'kernel drops')"
  figure "$1: bare loop beside it: $(cat "$work/bare.out")"
  holds "$1: no foreign id passes the filters" is "$foreign $(count_of "$1" 'unknown id')" '0 0'
  full=$(count_of "$1" 'queue full')
  holds "$1: every frame read is looked at, waits, or found the queue full" is $((sum + full)) $((taken - waiting))
  holds "$1: what is good is accepted, repeated or old" between \
    "$(sum_of "$1" accepted repeated old)" $((good - waiting - full)) "$good"
  holds "$1: a pose waits for one tick at most" is "$behind" 0
  holds "$1: the recording verifies" verifies "$1" "$work/$1.own"
}
test_flood() {
  for kind in quiet flood; do
    start_hand $kind tear
    if [ $kind = flood ]; then # its own poses are all dropped: it only floods
      chrt --fifo 75 "$fray" hand --can "$device_bus" "$here/scenes/flooder.hand" --patience 0 --drop 1000 --flood 20000 >"$work/flooder.out" 2>&1 &
      flooder=$!
    fi
    "$bare_timer" $((flood_ticks / rate)) $rate >"$work/bare.out" &
    bare=$!
    start_fray $kind --ticks $flood_ticks --record "$work/$kind.own"
    end_fray $kind
    end_hand
    if [ $kind = flood ]; then
      kill "$flooder"
      wait "$flooder" || true
    fi
    wait $bare
    judge_flood $kind
  done
  figure "flood: $(sed -n 's/.* \([0-9]*\) flooded.*/\1/p' "$work/flooder.out") frames in $flood_ticks ticks of $((1000 / rate)) ms, and while fray began and ended"
  "$fray" hand --can "$device_bus" "$here/scenes/flooder.hand" --patience 500 --drop 1000 --flood 20000 >"$work/alone.out" 2>&1 || true
  holds "flood: a tenth of a second's without a SYNC" is "$(sed -n 's/.* \([0-9]*\) flooded.*/\1/p' "$work/alone.out")" 2000
  # at the rate that this machine gives; test_sys_flood has the asked one exactly
  holds "flood: there was one, of a damaged frame a tick at least: $crc" [ "$crc" -ge $flood_ticks ]
}

# ---- 6: kill -9 while recording
test_kill() {
  times=30
  if [ "$soak" = 1 ]; then times=200; fi
  empty=0 good=0 in_log=0 lost=0 lost_most=0 bytes_cut=0
  awk -v n=$times 'BEGIN { srand(7); for (; n > 0; --n) print int(12 + 125 * rand()) }' >"$work/moments" # in ticks
  start_log kill
  while read -r moment; do
    rm -f "$work/kill.own"
    start_hand kill tear
    before=$(grep -c ' 080#' "$work/kill.can") || true
    start_fray kill --record "$work/kill.own"
    until_seen kill $((before + moment)) '^080#' || fail "kill: fray does not go on: $(cat "$work/kill.out")"
    kill -9 "$fray_pid"
    wait "$fray_pid" 2>/dev/null || true
    end_hand
    syncs=$(sed -n 's/.*: \([0-9]*\) SYNCs.*/\1/p' "$work/kill.hand.out")
    if [ ! -s "$work/kill.own" ]; then
      empty=$((empty + 1))
      continue
    fi
    if "$fray" verify "$work/kill.own" --scene "$work/sheet.img" --cut >"$work/verify.out" 2>&1; then
      good=$((good + 1))
      ticks=$(sed -n 's/^verified \([0-9]*\) .*/\1/p' "$work/verify.out")
      # the last SYNC opens a tick that is not whole; one that was sent twice is one
      whole=$(($(sed -n 's/.* 080#\(........\)........$/\1/p' "$work/kill.own" | sort -u | wc -l) - 1))
      is "$ticks" "$whole" || fail "kill at tick $moment: not every whole tick was taken"
      in_log=$((in_log + ticks))
      lost=$((lost + syncs - ticks))
      if [ $((syncs - ticks)) -gt $lost_most ]; then lost_most=$((syncs - ticks)); fi
    else
      fail "kill at tick $moment: $(head -n 2 "$work/verify.out")"
    fi
  done <"$work/moments"
  stop_log kill
  figure "kill -9 at $times moments: $good logs accepted with --cut, $empty still empty; $in_log ticks in the logs, $lost lost, at most $lost_most of one run"
  holds "kill: every log that is not empty is accepted" is $((good + empty)) "$times"
  holds "kill: few logs are empty" [ "$empty" -lt $((times / 2)) ]
}

# ---- 7: bad devices
test_trouble() {
  session trouble tear 750 --drop 50 --repeat 50 --reorder 30 --corrupt 50 --seed 5
  poses=$(sed -n 's/.*: \([0-9]*\) SYNCs.*/\1/p' "$work/trouble.hand.out")
  poses=$((poses * 2))
  figure "trouble: of $poses poses 5 % dropped, 5 % repeated, 3 % swapped, 5 % damaged: accepted $(count_of trouble accepted), repeated $(count_of trouble repeated), old $(count_of trouble old), lost $(count_of trouble lost), wrong CRC $(count_of trouble 'wrong CRC')"
  holds "trouble: candump's log verifies" verifies trouble "$work/trouble.can"
  holds "trouble: fray's own log verifies" verifies trouble "$work/trouble.own"
  # half to twice of what was asked; of a swapped pair one is lost and then old
  holds "trouble: wrong CRC" between "$(count_of trouble 'wrong CRC')" $((poses / 40)) $((poses / 10))
  holds "trouble: repeated" between "$(count_of trouble repeated)" $((poses / 40)) $((poses / 10))
  holds "trouble: old" between "$(count_of trouble old)" $((poses * 3 / 200)) $((poses * 6 / 100))
  holds "trouble: lost" between "$(count_of trouble lost)" $((poses * 13 / 200)) $((poses * 26 / 100))
}

# ---- 8: the interface goes and comes back; then SIGTERM
command_frame() { # N: the operator's n-th command
  sed -n "$1p" "$work/operator.log" | cut -d' ' -f3
}
test_flap() {
  "$fray" hand -o "$work/operator.all" $here/scenes/operator.hand
  grep ' 010#' "$work/operator.all" | tail -n 12 >"$work/operator.log"
  bad=0 verified=0 wrong_all=0 wrong_runs=0 forced_runs=0 resumed=0 cut_off=0 times=4
  if [ "$soak" = 1 ]; then times=10; fi
  for n in $(seq $times); do
    start_log flap # ends with the interface: candump gives up
    start_hand flap hold
    start_fray flap --record "$work/flap.own"
    until_true fray_ticks flap
    within 500 flap 1 "$a_force" || true
    first_log=$log_pid
    sleep "0.0$n"
    # by turns while fray sleeps, so that the next frame is a SYNC, and in the middle of a tick, whose FORCE it takes with it
    if [ $((n % 2)) = 1 ]; then chrt --other 0 ip link set $bus down; else ip link set $bus down; fi
    sleep 0.2
    ip link set $bus up
    kill "$first_log" 2>/dev/null || true
    wait "$first_log" 2>/dev/null || true
    start_log again
    until_seen again 20 '^080#' || fail "flap: no SYNC after the return: $(cat "$work/flap.out")"
    # RESET, START, said again as an operator would: who stands still for 2 ms loses the bus once more, and what was
    # said in between
    for attempt in 1 3 5 7 9 11; do
      cansend $bus "$(command_frame $attempt)"
      within 50 again 1 '^011#....03' || continue
      cansend $bus "$(command_frame $((attempt + 1)))"
      if within 500 again 1 "$a_force"; then break; fi
    done
    within 0 again 1 '^011#....03' || fail "flap: no ACK of RESET"
    kill -TERM "$fray_pid"
    end_fray flap
    end_hand
    stop_log again
    cp "$work/flap.own" "$work/flap.can"
    facts flap halt
    if [ "$halts" -lt 1 ] || [ "$halted" -ne 1 ]; then
      bad=$((bad + 1))
      fail "flap $n: $halts HALTs, HALTED and SAFE $halted"
      keep flap
    fi
    wrong_all=$((wrong_all + wrong))
    forced_runs=$((forced_runs + forced_before))
    if [ "$wrong" -gt 0 ]; then wrong_runs=$((wrong_runs + 1)); fi
    if [ "$again" -gt 0 ]; then resumed=$((resumed + 1)); fi
    # a force that the interface took with it is not on the bus: then the log is refused, and says so
    if [ "$(count_of flap 'frames lost')" -eq 0 ]; then
      if verifies flap "$work/flap.own"; then verified=$((verified + 1)); else fail "flap $n: the log"; fi
    elif verify "$work/flap.own"; then
      holds "flap $n: accepted, then with the run's hash" is "$(verified_hash)" "$(hash_of flap)"
    else
      figure "flap $n: $(count_of flap 'frames lost') frames lost, refused: $(head -n 1 "$work/verify.out" | sed "s|$work/||")"
      holds "flap $n: refused for want of a frame" grep -Eq 'FORCE|ACK|TEAR|STATUS' "$work/verify.out"
      cut_off=$((cut_off + 1))
    fi
    facts flap end
    if [ "$quiet" -ne 1 ]; then fail "flap $n: SIGTERM: the last forces are not zero"; else pass; fi
    if [ -n "$(tail -c 1 "$work/flap.own")" ]; then fail "flap $n: SIGTERM: the log ends in half a line"; fi
  done
  figure "interface down and up, $times runs: HALT and SAFE in $((times - bad)), logs verified $verified, cut off by it $cut_off, forces before it in $forced_runs, $wrong_all FORCE frames not zero after the return in $wrong_runs runs, forces again after RESET and START in $resumed"
  holds "flap: HALT and SAFE in every run" is "$bad" 0
  holds "flap: no force after the return until START" is "$wrong_all" 0
  holds "flap: there were forces before it in some run" [ "$forced_runs" -gt 0 ]
  holds "flap: RESET and START bring it back in some run" [ "$resumed" -gt 0 ]
  holds "flap: some log verifies" [ "$verified" -gt 0 ]
}

# ---- 9: lateness at 1 kHz beside a bare loop
test_lateness() {
  seconds=10
  if [ "$soak" = 1 ]; then seconds=30; fi
  make_scene 1000 12
  "$bare_timer" $seconds >"$work/bare.out" &
  bare=$!
  start_fray late --ticks $((seconds * 1000)) --record "$work/late.own"
  end_fray late
  wait $bare
  figure "1 kHz for $seconds s, guest: fray: $(lateness late)"
  figure "1 kHz for $seconds s, guest: bare loop beside it: $(cat "$work/bare.out")"
  figure "1 kHz for $seconds s, guest: SYNCs lost $(count_of late 'SYNCs lost')"
  holds "lateness: the recording verifies" verifies late "$work/late.own"
}

# ---- 10: other tools, and what cannot be opened
refused() { # WORDS COMMAND...: exit 2, and says so
  words=$1
  shift
  code=0
  timeout 3000 "$@" >"$work/refused.out" 2>&1 || code=$?
  is "$code" 2 && grep -qF -- "$words" "$work/refused.out" && return
  echo "    $(head -n 3 "$work/refused.out")"
  return 1
}
test_interop() {
  start_log interop
  listening=$(listeners all) || true
  candump -t a -x -a vcan0 >"$work/interop.columns" &
  columns_pid=$!
  until_true more_listen all || fail "interop: a second candump does not listen"
  start_fray interop --record "$work/interop.own"
  until_true fray_ticks interop
  cansend vcan0 010#EC01010000000000
  until_seen interop 1 '^080#' '^011#' || true
  cansend vcan0 010#ED01010000000000 # a wrong check
  until_seen interop 3 '^080#' '^010#ED' || true
  kill "$fray_pid"
  end_fray interop
  stop_log interop
  kill "$columns_pid"
  wait "$columns_pid" || true
  ack=$(awk '$3 ~ /^011#..1.01/ { print $3 }' "$work/interop.can")
  figure "interop: cansend 010#EC01010000000000 is answered with $ack"
  holds "interop: one ACK, START, OK" is "$(echo "$ack" | cut -c 7,9-12)" 10100
  holds "interop: a wrong check is counted" is "$(count_of interop 'wrong CRC')" 1
  holds "interop: candump's log verifies" verifies interop "$work/interop.can"
  holds "interop: what candump prints in columns verifies" verifies interop "$work/interop.columns"
  holds "interop: it ends with a closing SYNC" [ "$(grep -oE ' (080|181)#' "$work/interop.own" | tail -n 1)" = ' 080#' ]
  for tool in run hand; do
    file=$work/sheet.img
    if [ $tool = hand ]; then file=$work/tear.hand; fi
    holds "$tool: no such interface" refused "can9: no such interface" "$fray" $tool --can can9 "$file"
    holds "$tool: a name that is too long" refused "no such interface" "$fray" $tool --can vcan0vcan0vcan0vcan0 "$file"
    holds "$tool: not a CAN interface" refused "lo: " "$fray" $tool --can lo "$file"
    ip link add vcan7 type vcan
    holds "$tool: an interface that is down" refused "vcan7: " "$fray" $tool --can vcan7 "$file"
    ip link del vcan7
  done
  holds "run: no permission" refused "real-time scheduling: " setpriv --reuid=65534 --clear-groups --inh-caps=-all \
    --bounding-set=-all "$fray" run "$work/sheet.img" --can vcan0 --realtime
}

# ---- 2: in QEMU
overruns() { cat /sys/class/net/can1/statistics/rx_over_errors; }
test_controllers() {
  bus=can0 device_bus=can1
  fray_cpu=0 # where the interrupts are, see guest/net.sh
  make_scene 100 30
  good=0 torn=0 differ=0 whole=0
  for n in 1 2 3 4 5 6 7 8 9 10 11 12; do
    if [ "$n" -gt 5 ] && [ "$whole" -gt 0 ]; then break; fi
    runs=$n
    over=$(overruns)
    session controllers tear 95
    over=$(($(overruns) - over))
    figure "controllers $n: $(lateness controllers); SYNCs lost $(count_of controllers 'SYNCs lost'), can1 overrun $over times"
    verifies controllers "$work/controllers.own" || fail "controllers $n: fray's own log"
    sed 's/.* //' "$work/controllers.own" >"$work/order.own"
    sed 's/.* //' "$work/controllers.can" >"$work/order.can"
    if ! cmp -s "$work/order.own" "$work/order.can"; then differ=$((differ + 1)); fi
    if [ "$(number controllers 'breaks      ')" -gt 0 ]; then torn=$((torn + 1)); fi
    # what the controller has missed, candump has missed
    if [ "$over" -eq 0 ]; then
      whole=$((whole + 1))
      if verifies controllers "$work/controllers.can"; then good=$((good + 1)); fi
    elif verify "$work/controllers.can"; then
      holds "controllers $n: a log with a gap, accepted, then with the run's hash" is "$(verified_hash)" "$(hash_of controllers)"
    else
      figure "controllers $n: refused: $(head -n 1 "$work/verify.out" | sed "s|$work/||")"
    fi
  done
  figure "two controllers, $rate Hz, $runs sessions: $whole whole logs of the device's side, $good verified, another order than fray's own in $differ, torn in $torn"
  holds "controllers: every whole log of the device's side verifies" is "$good" "$whole"
  holds "controllers: some log is whole" [ "$whole" -gt 0 ]
  holds "controllers: the sheet tears" [ "$torn" -gt 0 ]
}
# Frames that two CPUs send at once come in one order to one receiver and in another to the next: so
# the hands are on a CPU of their own, run free, and flood a little. A flood's frames do not matter.
relevant() { sed -n 's/^.* //; /^4..#/!p' "$work/unpinned.$1" >"$work/order.$1"; }
test_unpinned() {
  fray_cpu=0
  make_scene 100 30
  good=0 refused=0 differ=0 torn=0
  for n in 1 2 3 4 5 6; do
    start_log unpinned
    if [ $((n % 2)) = 1 ]; then start_hand unpinned tear; else start_hand unpinned tear --free --flood 4000; fi
    taskset -p -c 1 "$hand_pid" >/dev/null
    start_fray unpinned --ticks 95 --record "$work/unpinned.own"
    end_fray unpinned
    end_hand
    stop_log unpinned
    for log in can own; do relevant $log; done
    if ! cmp -s "$work/order.own" "$work/order.can"; then differ=$((differ + 1)); fi
    if [ "$(number unpinned 'breaks      ')" -gt 0 ]; then torn=$((torn + 1)); fi
    for log in can own; do
      if verify "$work/unpinned.$log"; then
        good=$((good + 1))
        holds "unpinned $n: accepted, then with the run's hash" is "$(verified_hash)" "$(hash_of unpinned)"
      else
        refused=$((refused + 1))
        figure "unpinned $n: refused: $(head -n 1 "$work/verify.out" | sed "s|$work/||")"
        holds "unpinned $n: refused with a reason" [ -s "$work/verify.out" ]
      fi
    done
  done
  figure "vcan, queues as they come, $rate Hz: 12 logs, $good verified with the run's hash, $refused refused; another order in $differ of 6, torn in $torn"
  holds "unpinned: some logs have another order" [ "$differ" -gt 0 ]
}

. $here/auth.sh
for test_name; do
  began=$(date +%s)
  make_scene 250 12
  "test_$test_name"
  echo "  took $test_name $(($(date +%s) - began)) s"
done
suite_end
