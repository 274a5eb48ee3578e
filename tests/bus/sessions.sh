#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# sessions.sh [NAME...]: live sessions on vcan0, to be run where guest.sh runs them (root, vcan0 up).
# NAME: twenty play stop flood kill trouble flap lateness interop key tags stranger again (all of them by default), and in
# QEMU controllers or unpinned. A `figure` line says what was measured, a check what must hold;
# no check is about the machine's speed. README.md says more.
. tests/lib/suite.sh

here=tests/bus
work=$(mktemp -d /dev/shm/fray-bus.XXXXXX)
fray=$work/fray
kept=$FRAY_BUILD/tests/bus/failed
bare_timer=$FRAY_BUILD/tests/bus/bare_timer
cp "$FRAY" "$fray" # others read it too, see interop
chmod 755 "$work" "$fray"
trap 'rm -rf "$work"' EXIT
quick=0
if [ "${CI:-}" = true ]; then quick=1; fi
rate=250
substeps=12
bus=vcan0       # fray's interface
device_bus=vcan0 # the hands' and candump's

figure() { echo "  figure $*"; }
# holds WHAT COMMAND...: one check
holds() {
  what=$1
  shift
  if "$@"; then pass; else fail "$what"; fi
}
is() { [ "$1" = "$2" ] || { echo "    found '$1', expected '$2'"; return 1; }; }
number() { sed -n "s/.*$2 \([0-9][0-9]*\).*/\1/p" "$work/$1.out" | head -n 1; } # SESSION WORDS
hash_of() { sed -n 's/^hash \([0-9a-f]*\) .*/\1/p' "$work/$1.out"; }
facts() { eval "$(awk -v what="$2" -f $here/facts.awk "$work/$1.can")"; } # sets the shell's variables
until_true() { # COMMAND...: at most 4 s
  end=$(($(date +%s) + 4))
  until "$@"; do
    if [ "$(date +%s)" -gt $end ]; then return 1; fi
    sleep 0.02
  done
}

make_scene() { # RATE SUBSTEPS
  rate=$1 substeps=$2
  sed "s/^rate .*/rate $rate Hz/; s/^substeps .*/substeps $substeps/" $here/scenes/sheet.scene >"$work/sheet.scene"
  for script in tear hold; do sed "s/^rate .*/rate $rate Hz/" $here/scenes/$script.hand >"$work/$script.hand"; done
  "$fray" scene "$work/sheet.scene" -o "$work/sheet.img" >/dev/null
}

# ---- the three parts of a session: each leaves its process id in a variable
log_pid=''
hand_pid=''
fray_pid=''
listeners() { grep -c "^ *$device_bus " /proc/net/can/rcvlist_all; }
candump_listens() { [ "$(listeners)" -gt "$listening" ]; }
start_log() { # SESSION
  listening=$(listeners) || true
  candump -L -r 8000000 "$device_bus" >"$work/$1.can" 2>"$work/$1.candump" &
  log_pid=$!
  until_true candump_listens || fail "$1: candump does not listen on $device_bus"
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
start_hand() { # SESSION SCRIPT OPTION...
  session=$1 script=$2
  shift 2
  "$fray" hand --can "$device_bus" "$work/$script.hand" --patience 0 "$@" >"$work/$session.hand.out" 2>&1 &
  hand_pid=$!
}
start_fray() { # SESSION OPTION...
  session=$1
  shift
  "$fray" run "$work/sheet.img" --can "$bus" --realtime "$@" >"$work/$session.out" 2>&1 &
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
    cuts=$(number twenty 'springs cut ')
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

# ---- 3: canplayer plays a recording's device frames into a live fray
test_play() {
  session source tear 230
  # of the commands only the hand's START: STOP at the end is fray's own
  awk '$3 ~ /^10[12]#/ || ($3 ~ /^010#....01/ && !seen++)' "$work/source.own" >"$work/play.log"
  for attempt in 1 2 3; do
    start_log play
    start_fray play --ticks 330 --record "$work/play.own"
    until_true fray_ticks play
    canplayer -I "$work/play.log" vcan0=vcan0 >"$work/canplayer.out" 2>&1 || fail "canplayer: $(cat "$work/canplayer.out")"
    end_fray play
    stop_log play
    cuts=$(number play 'springs cut ')
    faults=$(sed -n 's/^hash.* faults //p' "$work/play.out")
    # a guest that stood still for 2 ms has lost its bus: that is no matter of canplayer
    if [ "$(number play 'SYNCs lost')" -eq 0 ] || [ $attempt -eq 3 ]; then break; fi
  done
  figure "canplayer: $(wc -l <"$work/play.log") device frames, $cuts springs cut, faults $faults (attempt $attempt)"
  holds "play: the sheet tears" [ "$cuts" -gt 0 ]
  holds "play: no fault but STALE: $faults" [ "$faults" -le 3 ]
  holds "play: candump's log verifies" verifies play "$work/play.can"
}

# ---- 4: the hands fall silent
forces() { tail -n 60 "$work/$1.can" | awk '$3 ~ /^18[12]#/ { f = substr($3, 9) } END { exit !(f != "" && f != "000000000000") }'; }
test_stop() {
  old_rate=$rate
  make_scene 500 12 # 10 ms are a whole number of ticks
  for signal in STOP KILL; do
    for attempt in 1 2 3 4 5 6 7 8; do
      start_log stop
      start_hand stop hold
      start_fray stop --record "$work/stop.own"
      until_true forces stop || true
      kill -$signal "$hand_pid" || fail "stop: the hands have ended: $(cat "$work/stop.hand.out")"
      sleep 0.3
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
  make_scene "$old_rate" 12
}

# ---- 5: another process floods the bus
poses_in() { grep -c -E ' (101|102|010)#' "$work/$1.own"; }
count_of() { sed -n "s/.*[ ,]$2 \([0-9]*\)[,;]*.*/\1/p" "$work/$1.out" | head -n 1; }
lateness() { sed -n 's/^lateness *//p' "$work/$1.out"; }
sum_of() { # SESSION: everything that the port has counted
  sum=0
  for counter in accepted repeated 'wrong CRC' 'wrong length' 'wrong flags' 'wrong field' 'unknown id' 'queue full'; do
    sum=$((sum + $(count_of "$1" "$counter")))
  done
  echo "$sum"
}
test_flood() {
  for kind in quiet flood; do
    start_hand $kind tear
    device=$hand_pid
    if [ $kind = flood ]; then # its own poses are all dropped: it only floods
      "$fray" hand --can "$device_bus" "$work/hold.hand" --patience 0 --drop 1000 --flood 20000 >"$work/flooder.out" 2>&1 &
      flooder=$!
    fi
    start_fray $kind --ticks 500 --record "$work/$kind.own"
    end_fray $kind
    hand_pid=$device
    end_hand
    if [ $kind = flood ]; then
      kill "$flooder"
      wait "$flooder" || true
    fi
    consumed=$(awk '$3 ~ /^182#/ { c = substr($3, 7, 1); if (c != last) ++n; last = c } END { print n + 0 }' "$work/$kind.own")
    figure "$kind: $(lateness $kind)"
    figure "$kind: right hand's poses consumed in $consumed of 500 ticks, wrong CRC $(count_of $kind 'wrong CRC'), queue full $(count_of $kind 'queue full'), kernel drops $(count_of $kind 'kernel drops'), SYNCs lost $(count_of $kind 'SYNCs lost')"
    pushed=$(poses_in $kind)
    sum=$(sum_of $kind)
    own=$(grep -c ' 010#....0[25]' "$work/$kind.own") || true # fray's STOP and HALT are in the log, not in the port
    holds "$kind: every POSE and COMMAND read is counted or waits in the queue: $pushed read, $own own, $sum counted" \
      [ $((pushed - own - sum)) -ge 0 -a $((pushed - own - sum)) -le 256 ]
    holds "$kind: the recording verifies" verifies $kind "$work/$kind.own"
    holds "$kind: poses are consumed in at least half of the ticks: $consumed" [ "$consumed" -ge 250 ]
  done
  flooded=$(sed -n 's/.* \([0-9]*\) flooded.*/\1/p' "$work/flooder.out")
  figure "flood: $flooded frames in 500 ticks of $((1000 / rate)) ms"
  holds "flood: the damaged frames are counted" [ "$(count_of flood 'wrong CRC')" -gt $((flooded / 4)) ]
}

# ---- 6: kill -9 while recording
test_kill() {
  times=200
  if [ $quick = 1 ]; then times=30; fi
  empty=0 good=0 in_log=0 lost=0 lost_most=0 bytes_cut=0
  awk -v n=$times 'BEGIN { srand(7); for (; n > 0; --n) printf "%.3f\n", 0.05 + 0.5 * rand() }' >"$work/moments"
  while read -r moment; do
    rm -f "$work/kill.own"
    start_hand kill tear
    start_fray kill --record "$work/kill.own"
    sleep "$moment"
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
      is "$ticks" "$whole" || fail "kill at $moment s: not every whole tick was taken"
      in_log=$((in_log + ticks))
      lost=$((lost + syncs - ticks))
      if [ $((syncs - ticks)) -gt $lost_most ]; then lost_most=$((syncs - ticks)); fi
    else
      fail "kill at $moment s: $(head -n 2 "$work/verify.out")"
    fi
  done <"$work/moments"
  figure "kill -9 at $times moments: $good logs accepted with --cut, $empty still empty; $in_log ticks in the logs, $lost lost, at most $lost_most of one run"
  holds "kill: every log that is not empty is accepted" is $((good + empty)) "$times"
  holds "kill: few logs are empty" [ "$empty" -lt $((times / 2)) ]
}

# ---- 7: bad devices
between() { [ "$1" -ge "$2" ] && [ "$1" -le "$3" ] || { echo "    found $1, expected $2 to $3"; return 1; }; }
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
  grep ' 010#' "$work/operator.all" | tail -n 2 >"$work/operator.log"
  bad=0 verified=0 wrong_all=0 wrong_runs=0 forced_runs=0 resumed=0 times=10
  if [ $quick = 1 ]; then times=4; fi
  for n in $(seq $times); do
    start_log flap # ends with the interface: candump gives up
    start_hand flap hold
    start_fray flap --record "$work/flap.own"
    until_true fray_ticks flap
    until_true forces flap || true
    sleep "0.0$n"
    ip link set $bus down
    sleep 0.2
    ip link set $bus up
    sleep 0.3
    if ! kill -0 "$fray_pid" 2>/dev/null; then fail "flap: fray has ended"; fi
    cansend $bus "$(command_frame 1)" # RESET, START
    sleep 0.05
    cansend $bus "$(command_frame 2)"
    sleep 0.4
    kill -TERM "$fray_pid"
    end_fray flap
    end_hand
    kill "$log_pid" 2>/dev/null || true
    wait "$log_pid" 2>/dev/null || true
    cp "$work/flap.own" "$work/flap.can"
    facts flap halt
    if [ "$gaps" -ne 1 ] || [ "$halted" -ne 1 ]; then
      bad=$((bad + 1))
      fail "flap $n: $gaps gaps, HALTED and SAFE $halted"
      keep flap
    fi
    wrong_all=$((wrong_all + wrong))
    forced_runs=$((forced_runs + forced_before))
    if [ "$wrong" -gt 0 ]; then wrong_runs=$((wrong_runs + 1)); fi
    if [ "$again" -gt 0 ]; then resumed=$((resumed + 1)); fi
    if verifies flap "$work/flap.own"; then verified=$((verified + 1)); fi
    facts flap end
    if [ "$quiet" -ne 1 ]; then fail "flap $n: SIGTERM: the last forces are not zero"; else pass; fi
    if [ -n "$(tail -c 1 "$work/flap.own")" ]; then fail "flap $n: SIGTERM: the log ends in half a line"; fi
  done
  figure "interface down and up, $times runs: HALT and SAFE in $((times - bad)), logs verified $verified, forces before it in $forced_runs, $wrong_all FORCE frames not zero after the return in $wrong_runs runs, forces again after RESET and START in $resumed"
  holds "flap: HALT and SAFE in every run" is "$bad" 0
  holds "flap: no force after the return until START" is "$wrong_all" 0
  holds "flap: there were forces before it in some run" [ "$forced_runs" -gt 0 ]
  holds "flap: RESET and START bring it back in some run" [ "$resumed" -gt 0 ]
  holds "flap: every log verifies" is "$verified" $times
}

# ---- 9: lateness at 1 kHz beside a bare loop
test_lateness() {
  seconds=30
  if [ $quick = 1 ]; then seconds=10; fi
  old_rate=$rate
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
  make_scene "$old_rate" 12
}

# ---- 10: other tools, and what cannot be opened
refused() { # WORDS COMMAND...: exit 2, and says so
  words=$1
  shift
  code=0
  timeout 5 "$@" >"$work/refused.out" 2>&1 || code=$?
  is "$code" 2 && grep -qF -- "$words" "$work/refused.out" && return
  echo "    $(head -n 3 "$work/refused.out")"
  return 1
}
test_interop() {
  start_log interop
  start_fray interop --record "$work/interop.own"
  until_true fray_ticks interop
  cansend vcan0 010#EC01010000000000
  sleep 0.2
  cansend vcan0 010#ED01010000000000 # a wrong check
  sleep 0.2
  kill "$fray_pid"
  end_fray interop
  stop_log interop
  ack=$(awk '$3 ~ /^011#..1.01/ { print $3 }' "$work/interop.can")
  figure "interop: cansend 010#EC01010000000000 is answered with $ack"
  holds "interop: one ACK, START, OK" is "$(echo "$ack" | cut -c 7,9-12)" 10100
  holds "interop: a wrong check is counted" is "$(count_of interop 'wrong CRC')" 1
  holds "interop: candump's log verifies" verifies interop "$work/interop.can"
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
  make_scene 100 30
  good=0 torn=0 differ=0 whole=0
  for n in 1 2 3 4 5; do
    over=$(overruns)
    session controllers tear 95
    over=$(($(overruns) - over))
    figure "controllers $n: $(lateness controllers); SYNCs lost $(count_of controllers 'SYNCs lost'), can1 overrun $over times"
    verifies controllers "$work/controllers.own" || fail "controllers $n: fray's own log"
    sed 's/.* //' "$work/controllers.own" >"$work/order.own"
    sed 's/.* //' "$work/controllers.can" >"$work/order.can"
    if ! cmp -s "$work/order.own" "$work/order.can"; then differ=$((differ + 1)); fi
    if [ "$(number controllers 'springs cut ')" -gt 0 ]; then torn=$((torn + 1)); fi
    # an SJA1000 holds 64 bytes: a guest that answers its interrupt too late misses frames, and so does candump
    if [ "$(wc -l <"$work/order.own")" -eq "$(wc -l <"$work/order.can")" ]; then
      whole=$((whole + 1))
      if verifies controllers "$work/controllers.can"; then good=$((good + 1)); fi
    elif verify "$work/controllers.can"; then
      holds "controllers $n: a log with a gap, accepted, then with the run's hash" is "$(verified_hash)" "$(hash_of controllers)"
    else
      figure "controllers $n: $(($(wc -l <"$work/order.own") - $(wc -l <"$work/order.can"))) frames missing, refused: $(head -n 1 "$work/verify.out" | sed "s|$work/||")"
    fi
  done
  figure "two controllers, $rate Hz, 5 sessions: $whole whole logs of the device's side, $good verified, another order than fray's own in $differ, torn in $torn"
  holds "controllers: every whole log of the device's side verifies" is "$good" "$whole"
  holds "controllers: some log is whole" [ "$whole" -gt 0 ]
  holds "controllers: the sheet tears" [ "$torn" -gt 0 ]
}
test_unpinned() {
  make_scene 100 30
  good=0 refused=0 differ=0 torn=0
  for n in 1 2 3 4 5 6; do
    session unpinned tear 95
    sed 's/.* //' "$work/unpinned.own" >"$work/order.own"
    sed 's/.* //' "$work/unpinned.can" >"$work/order.can"
    if ! cmp -s "$work/order.own" "$work/order.can"; then differ=$((differ + 1)); fi
    if [ "$(number unpinned 'springs cut ')" -gt 0 ]; then torn=$((torn + 1)); fi
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
}

. $here/auth.sh
make_scene $rate $substeps
for name in ${*:-twenty play stop flood kill trouble flap lateness interop $auth_tests}; do
  began=$(date +%s)
  "test_$name"
  echo "  took $name $(($(date +%s) - began)) s"
done
suite_end
