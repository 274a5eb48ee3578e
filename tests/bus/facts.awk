# SPDX-License-Identifier: Apache-2.0
# What a candump log of instance 0 says, as one line of NAME=VALUE for the shell. -v what=
#   end   ticks, tears, fault bits of the last STATUS, and whether the last FORCE of each hand is zero
#   stop  the poses end: ticks without one until STALE, and from there until every force is zero
#   halt  after a lost bus the runtime says HALT: forces that are not zero from there until START is
#         accepted; of the last HALT, whether there were forces before it, and any after START
function digit(c) { return index("0123456789ABCDEF", c) - 1 }
function byte(data, n) { return digit(substr(data, 2 * n + 1, 1)) * 16 + digit(substr(data, 2 * n + 2, 1)) }
function when(stamp) { return substr(stamp, 2, length(stamp) - 2) + 0 }
function has(bits, bit) { return int(bits / bit) % 2 }
BEGIN { zero[1] = zero[2] = 1; start_us = -1 }
/^\(/ {
  split($3, part, "#")
  id = part[1]
  data = part[2]
  seconds = when($1)
  if (id == "080") {
    ++ticks
  }
  if (id == "010" && byte(data, 2) == 5) { ++halts; back = 1; started = again = 0; forced_before = forced_now }
  if (id == "101" || id == "102") { last_pose = ticks; pose_seconds = seconds; stale = 0; forced = forced_now }
  if (id == "181" || id == "182") {
    hand = id - 180
    zero[hand] = substr(data, 5) == "000000000000"
    if (!zero[hand]) {
      forced_now = 1
      if (back && !started) ++wrong
      if (started) ++again
    } else if (zero[1] && zero[2]) forced_now = 0
    if (!(zero[1] && zero[2])) { quiet = 0 } else if (!quiet) { quiet = ticks; quiet_seconds = seconds }
  }
  if (id == "200") ++tears
  if (id == "701") {
    bits = byte(data, 2) + 256 * byte(data, 3)
    all = all < bits ? bits : all
    if (!stale && has(bits, 1) + has(bits, 2)) { stale = ticks; stale_seconds = seconds }
    if (back && has(bits, 32) && byte(data, 0) == 3) halted = 1
  }
  if (id == "011" && byte(data, 2) == 1 && byte(data, 3) == 0 && back) started = 1
}
END {
  if (what == "end") printf "ticks=%d tears=%d bits=%d quiet=%d\n", ticks, tears, bits, zero[1] && zero[2]
  if (what == "stop")
    printf "forced=%d stale_ticks=%d stale_ms=%.2f zero_ticks=%d zero_ms=%.2f\n", forced, stale - last_pose - 1,
      (stale_seconds - pose_seconds) * 1000, quiet - stale, (quiet_seconds - stale_seconds) * 1000
  if (what == "halt") printf "halts=%d halted=%d wrong=%d forced_before=%d again=%d\n", halts, halted, wrong, forced_before, again
}
