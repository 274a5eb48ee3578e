# SPDX-License-Identifier: Apache-2.0
# objdump -d --no-show-raw-insn of a linked program for Thumb or RISC-V; lines out:
#   code ADDRESS NAME       a function, or a label of a helper in assembly
#   push NAME BYTES         what all of its instructions together take from the stack: at least its frame
#   moves NAME              it sets the stack pointer by a register: no bound can be read off
#   call FROM TO            also a jump into another function
#   runs FROM TO            FROM ends without a return: its code runs on into TO
#   jump NAME, pointer NAME by a register: a table or a pointer; through a pointer for sure
function registers(list, n, item, count, ends) {
  gsub(/[{} ]/, "", list)
  n = split(list, item, ",")
  count = 0
  for (; n > 0; --n) {
    if (split(item[n], ends, "-") == 2) { gsub(/[a-z]/, "", ends[1]); gsub(/[a-z]/, "", ends[2]); count += ends[2] - ends[1] + 1 }
    else ++count
  }
  return count
}
function number(text) { sub(/.*#?-/, "", text); gsub(/[^0-9].*/, "", text); return text + 0 }
function hex(text, n, value) {
  value = 0
  for (n = 1; n <= length(text); ++n) value = value * 16 + index("0123456789abcdef", substr(text, n, 1)) - 1
  return value
}
function function_at(address, n) { # they come in the order of their addresses
  for (n = functions; n > 1 && begin[n] > address; --n) {}
  return name_of[n]
}
function open_function(name, address) {
  if (name == at) return
  name_of[++functions] = name
  begin[functions] = hex(address)
  if (at != "" && runs_on) print "runs", at, name
  at = name
  pushed[at] += 0
  runs_on = 1
}

/^[0-9a-f]+ <[^>]+>:$/ {
  name = $2
  gsub(/[<>:]/, "", name)
  open_function(name, $1)
  print "code", $1, name
  next
}
!/^ *[0-9a-f]+:\t/ { next }
{
  split($0, field, "\t")
  what = field[2]
  rest = field[3]
  sub(/ +$/, "", what)
  if (what ~ /^(\.|c?\.?nop)/) next
  runs_on = 1
  if (what == "push" || what ~ /^v?push/) pushed[at] += registers(rest) * (rest ~ /d[0-9]/ ? 8 : 4)
  else if (what ~ /^stmdb/ && rest ~ /^sp!/) { sub(/^[^{]*/, "", rest); pushed[at] += 4 * registers(rest) }
  else if (what ~ /^str/ && rest ~ /\[sp, #-[0-9]+\]!/) pushed[at] += number(rest)
  else if (what ~ /^sub/ && rest ~ /^sp, (sp, )?#/) { sub(/.*#/, "", rest); pushed[at] += rest + 0 }
  else if (what ~ /^(c\.)?addi?/ && rest ~ /^sp,sp,-/) pushed[at] += number(rest)
  else if (what ~ /^auipc/ && rest ~ /^sp,/) print "moves", at
  else if (what ~ /^(add|sub|mov|msr)/ && rest ~ /^(sp|MSP|PSP), *(sp, *)?[a-z]/) print "moves", at
  else if (what ~ /^(add|sub|mv|neg|and|or|lw|li|la)$/ && rest ~ /^sp,[a-z]/) print "moves", at
  if (what == "blx" || what == "jalr") { if (rest !~ /</) print "pointer", at }
  else if (what ~ /^(jr|bx)/ && rest !~ /^(lr|ra)/ && rest !~ /</) print "jump", at
  else if (what ~ /^(mov|ldr|add)/ && rest ~ /^pc,/) print "jump", at
  if (what ~ /^(b|cb|j|tail|call)/ && what !~ /^b(ic|fc|fi|kpt)/ && match($0, /[0-9a-f]+ </)) {
    target = substr($0, RSTART, RLENGTH - 2)
    if (!((at, target) in seen)) { from[++branches] = at; to[branches] = target }
    seen[at, target] = 1
  }
  if (what ~ /^(b|b\.n|b\.w|bx|j|jr|ret|mret|tail)$/ || (what ~ /^(pop|ldm)/ && rest ~ /pc/) || (what ~ /^(mov|ldr)/ && rest ~ /^pc,/))
    runs_on = 0
}
END {
  for (name in pushed) print "push", name, pushed[name]
  for (n = 1; n <= branches; ++n) {
    target = function_at(hex(to[n]))
    if (target != from[n]) print "call", from[n], target
  }
}
