# SPDX-License-Identifier: Apache-2.0
# For sessions.sh, which sources it: sessions under a key. CAN FD, with an attacker who replays the
# session before and says forged frames; TAGs on classic CAN, with a forger; and what does not fit.

make_keys() {
  ticks_wanted='--ticks 230'
  (umask 077 && echo 2b7e151628aed2a6abf7158809cf4f3c >"$work/bus.key" && echo 000102030405060708090a0b0c0d0e0f >"$work/other.key")
  rm -f "$work"/*.lanes
}
# SESSION SCRIPT OPTION...: both ends with the key and what they keep of it
keyed_session() {
  keyed=$1 script=$2
  shift 2
  start_log "$keyed"
  start_hand "$keyed" "$script" --key "$work/bus.key" --freshness "$work/hand.lanes" "$@"
  # shellcheck disable=SC2086 # no word or two
  start_fray "$keyed" $ticks_wanted --record "$work/$keyed.own" --key "$work/bus.key" --freshness "$work/run.lanes" "$@"
}
end_keyed_session() {
  end_fray "$1"
  end_hand
  stop_log "$1"
}
keyed_until_torn() { # SESSION [OPTION]: a guest that stood still for 2 ms has lost its bus
  for attempt in 1 2 3 4 5 6 7 8; do
    keyed_session "$1" tear ${2:+"$2"}
    end_keyed_session "$1"
    cuts=$(number "$1" 'breaks      ')
    if [ "$cuts" -gt 0 ]; then break; fi
  done
}
verify_keyed() { "$fray" verify "$1" --scene "$work/sheet.img" --key "$work/bus.key" >"$work/verify.out" 2>&1; } # LOG
verifies_keyed() { # SESSION LOG
  if ! verify_keyed "$2" || ! is "$(verified_hash)" "$(hash_of "$1")"; then
    echo "    $(head -n 3 "$work/verify.out"); the run: $(tail -n 1 "$work/$1.out")"
    keep "$1"
    return 1
  fi
}
lane() { # SESSION LANE WORD: `LANE: 229 good, 0 skipped, ...`
  sed -n "s/^ *$2: //p" "$work/$1.out" | tr ',' '\n' | sed -n "s/^ *\([0-9]*\) $3.*/\1/p" | head -n 1
}
kept_at() { sed -n "s/^sent $2 //p" "$work/$1.lanes"; } # END ID
not_used() { sed -n 's/.* good tag, \([0-9]*\) others.*/\1/p' "$work/verify.out"; }

# ---- 11: CAN FD
test_key() {
  make_keys
  keyed_until_torn key
  figure "key: CAN FD, $(lane key POSE_LEFT_AUTH good) and $(lane key POSE_RIGHT_AUTH good) poses, $cuts springs broken (attempt $attempt), lateness $(lateness key)"
  holds "key: the sheet tears" [ "$cuts" -gt 0 ]
  holds "key: candump's log verifies" verifies_keyed key "$work/key.can"
  holds "key: every frame in it is used" is "$(not_used)" 0
  holds "key: fray's own log verifies" verifies_keyed key "$work/key.own"
  holds "key: nothing protected goes in plain" sh -c "! grep -qE ' (010|011|10[12]|18[12])#[^#]' '$work/key.can'"
  holds "key: without the key it is refused" refused "was recorded under a key, expected --key FILE" \
    "$fray" verify "$work/key.can" --scene "$work/sheet.img"
  holds "key: with another it is refused" refused "no tag of this log fits" \
    "$fray" verify "$work/key.can" --scene "$work/sheet.img" --key "$work/other.key"
  sent=$(kept_at hand 109)

  # once more, from the kept freshness: the attacker plays the first session's device, and forges
  # not the runtime's own STOP: this session's is its last frame, so before it an earlier one would fit the log
  grep -E ' (10[9A]|020)##' "$work/key.can" | grep -vE ' 020##5.{22}[89A-F]' >"$work/replayed.log"
  ticks_wanted='' # until the attacker has said it all
  keyed_session attack tear
  # every lane has spoken: a log does not say where the lanes were, see README of rt/wire, Logs
  for id in 109 10A 020; do until_seen attack 1 "^$id##"; done
  "$fray" hand --can "$device_bus" "$work/hold.hand" --patience 0 --drop 1000 --flood 200 --key "$work/other.key" >"$work/forger.out" 2>&1 &
  forger=$!
  canplayer -I "$work/replayed.log" "$bus=$bus" >"$work/canplayer.out" 2>&1 || fail "canplayer: $(cat "$work/canplayer.out")"
  # a flood has as many of these as forged frames
  until_seen attack 1000 '^4..#' || fail "key, attacked: the forger does not come through"
  kill "$forger" 2>/dev/null || true
  wait "$forger" || true
  kill "$fray_pid"
  end_fray attack
  end_hand
  stop_log attack
  old=$(($(lane attack POSE_LEFT_AUTH old) + $(lane attack POSE_RIGHT_AUTH old) + $(lane attack COMMAND_AUTH old)))
  forged=$(($(lane attack POSE_LEFT_AUTH forged) + $(lane attack POSE_RIGHT_AUTH forged) + $(lane attack COMMAND_AUTH forged)))
  holds "key, attacked: candump's log verifies" verifies_keyed attack "$work/attack.can"
  figure "key, attacked: $old replayed and $forged forged frames reached fray, none used; verify left out $(not_used), the first: $(sed -n '1s/.*attack.can//p' "$work/verify.out")"
  holds "key, attacked: the replayed frames are counted as old: $old" [ "$old" -gt 100 ]
  holds "key, attacked: the forged frames are counted: $forged" [ "$forged" -gt 100 ]
  holds "key, attacked: verify leaves out what was not used" [ "$(not_used)" -ge $((old + forged)) ]
  holds "key, attacked: freshness goes on: $sent, then $(kept_at hand 109)" [ "$(kept_at hand 109)" -gt "$sent" ]
}

# ---- 12: classic CAN
ever() { awk -v id="$2" -v from="$3" -v want="$4" '$3 ~ "^" id "#" && substr($3, from, length(want)) == want { found = 1 } END { exit !found }' "$work/$1.can"; } # SESSION ID PLACE DIGITS
# SESSION: one hand has a pose for each SYNC, a second one makes them more
surplus_poses() { awk '$3 ~ /^101#/ { ++n } $3 ~ /^080#/ { --n } END { print n + 0 }' "$work/$1.can"; }
forged_poses() { [ "$(surplus_poses "$1")" -ge "$2" ]; } # SESSION COUNT
test_tags() {
  make_keys
  keyed_until_torn tags --classic-tags
  figure "tags: classic CAN, $(lane tags TAG_LEFT good) and $(lane tags TAG_RIGHT good) TAGs good, $(lane tags TAG_LEFT bad) and $(lane tags TAG_RIGHT bad) bad, $cuts springs broken (attempt $attempt)"
  holds "tags: the sheet tears" [ "$cuts" -gt 0 ]
  holds "tags: candump's log verifies with the key" verifies_keyed tags "$work/tags.can"
  holds "tags: candump's log verifies without it" verifies tags "$work/tags.can"
  holds "tags: with another key it is refused" refused "no TAG of this log fits" \
    "$fray" verify "$work/tags.can" --scene "$work/sheet.img" --key "$work/other.key"

  sed '/^command/d' "$work/tear.hand" >"$work/forger.hand" # a RESET of his would clear it
  start_log forger
  start_hand forger hold --key "$work/bus.key" --freshness "$work/hand.lanes" --classic-tags
  start_fray forger --record "$work/forger.own" --key "$work/bus.key" --freshness "$work/run.lanes" --classic-tags
  until_seen forger 7 '^010#' || fail "tags, forged: the hand has not said its last RESET" # hold.hand has seven commands
  until_seen forger 1 "$a_force" || true
  "$fray" hand --can "$device_bus" "$work/forger.hand" --patience 0 >"$work/forger.hand2.out" 2>&1 &
  forger=$!
  surplus=$(surplus_poses forger)
  until_true forged_poses forger $((surplus + 40)) || fail "tags, forged: the forger does not come through"
  kill "$forger" 2>/dev/null || true
  wait "$forger" || true
  kill "$fray_pid"
  end_keyed_session forger
  facts forger end
  figure "tags, forged: TAG_LEFT $(lane forger TAG_LEFT good) good, $(lane forger TAG_LEFT bad) bad, $(lane forger TAG_LEFT missing) missing, then HALTED and SAFE; forces at the end zero: $quiet"
  holds "tags, forged: the lane has failed" grep -q 'missing: failed' "$work/forger.out"
  holds "tags, forged: SAFE" ever forger 701 5 03
  holds "tags, forged: HALTED stands in STATUS" [ $((bits / 32 % 2)) -eq 1 ]
  holds "tags, forged: the forces are zero" is "$quiet" 1
  holds "tags, forged: candump's log verifies" verifies_keyed forger "$work/forger.can"
}

# ---- 13: another key, no CAN FD
test_stranger() {
  make_keys
  start_log stranger
  start_hand stranger tear --key "$work/other.key"
  start_fray stranger --ticks 150 --key "$work/bus.key"
  end_keyed_session stranger
  figure "another key: $(lane stranger POSE_LEFT_AUTH forged) poses forged, $(lane stranger POSE_LEFT_AUTH good) good"
  holds "stranger: no pose is used" is "$(lane stranger POSE_LEFT_AUTH good)" 0
  holds "stranger: never OPERATIONAL" sh -c "! grep -q ' 701#02' '$work/stranger.can'"
  holds "stranger: never a force" sh -c "! awk '\$3 ~ /^18[9A]##/ { print substr(\$3, 11, 12) }' '$work/stranger.can' | grep -qv '^000000000000\$'"
  for side in stranger.out stranger.hand.out; do
    holds "stranger: $side says why" grep -q 'no tag fits: the other end has another key' "$work/$side"
  done
  ip link add vcan8 type vcan
  ip link set vcan8 mtu 16 up
  holds "run --key: an interface without CAN FD" refused "vcan8: takes classic frames only (mtu 16), expected CAN FD, mtu 72" \
    "$fray" run "$work/sheet.img" --can vcan8 --key "$work/bus.key"
  holds "hand --key: an interface without CAN FD" refused "vcan8: takes classic frames only" \
    "$fray" hand --can vcan8 "$work/tear.hand" --key "$work/bus.key"
  start_log stranger # --classic-tags needs none
  start_hand stranger tear --key "$work/bus.key" --classic-tags
  holds "run --classic-tags: goes without CAN FD" "$fray" run "$work/sheet.img" --can vcan8 --ticks 5 --key "$work/bus.key" --classic-tags >/dev/null 2>&1
  end_hand
  stop_log stranger
  ip link del vcan8
}

# ---- 14: kill -9 under a key, and on again from the kept freshness; the hand has not ended
forces_kept() { [ -e "$work/run.lanes" ] && [ "$(sed -n 's/^sent 189 //p' "$work/run.lanes")" -gt "$1" ]; }
test_again() {
  make_keys
  ticks_wanted=''
  keyed_session again hold
  until_true forces_kept 10000 || fail "again: the freshness is not stored while it runs"
  kill -9 "$fray_pid"
  wait "$fray_pid" 2>/dev/null || true
  kept_ahead=$(kept_at run 189)
  used=$(grep -c ' 189##' "$work/again.can")
  sleep 0.1
  start_fray again --ticks 200 --record "$work/again.own" --key "$work/bus.key" --freshness "$work/run.lanes"
  end_keyed_session again
  cp "$work/again.hand.out" "$work/felt.out"
  figure "kill -9 under a key: $used forces sent, $kept_ahead kept; on again: $(lane again POSE_LEFT_AUTH good) poses good, $(lane again POSE_LEFT_AUTH old) old; the hand felt $(lane felt FORCE_LEFT_AUTH good), $(lane felt FORCE_LEFT_AUTH old) old, $(lane felt FORCE_LEFT_AUTH skipped) skipped"
  holds "again: what is kept is ahead of what was sent" [ "$kept_ahead" -ge "$used" ]
  holds "again: the hand's poses are taken" [ "$(lane again POSE_LEFT_AUTH good)" -gt 50 ]
  holds "again: the hand takes no force for an old one" is "$(lane felt FORCE_LEFT_AUTH old)" 0
  holds "again: and those after the kill" [ "$(lane felt FORCE_LEFT_AUTH good)" -gt "$used" ]
  holds "again: the second log verifies" verifies_keyed again "$work/again.own"
}
